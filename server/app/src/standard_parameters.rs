//! The parameters of OGC APIs, under the names that the standards give them.

use crate::parameters::{
    ALTITUDE, BASIS, CLOUD_COVER, CLOUD_PATTERN, CLOUDS, DIRECT_UPLIGHT, EMISSION, EMISSION_KEEP,
    GROUND_REFLECTANCE, HEIGHT, Kind, LAMP, MAP_MEASURE, Parameter, ParameterSet, RESPONSE, SCATTERING,
    SCENARIO, SOLAR_FLUX, TERRAIN, TOLERANCE, TURBIDITY, parameter_sets, parameters,
};
use utoipa::openapi::path::{Parameter as ApiParameter, ParameterIn};

/// Entries of a list at most.
pub const MAX_LIST_LIMIT: u32 = 10_000;
/// Most pixels of a map along either side.
pub const MAX_MAP_PX: u32 = 2048;

parameters! {
    /// The place, as Well-Known Text (WKT).
    POINT_COORDS = "coords", Kind::Text {
        allowed: "POINT(longitude latitude) in degrees, such as POINT(8.79 46.17)",
        pattern: "^POINT ?\\( ?-?[0-9.]+ -?[0-9.]+ ?\\)$",
    }, "", true;
    /// The area, as Well-Known Text (WKT); holes are left out.
    AREA_COORDS = "coords", Kind::Text {
        allowed: "POLYGON((longitude latitude,...)) or MULTIPOLYGON(((...))) in degrees, closed rings, such as POLYGON((8.5 46,9 46,9 46.5,8.5 46))",
        pattern: "^(MULTI)?POLYGON ?\\(.+\\)$",
    }, "", true;
    /// The path, as Well-Known Text (WKT); M counts seconds since 1970-01-01T00:00:00Z.
    LINE_COORDS = "coords", Kind::Text {
        allowed: "LINESTRING(longitude latitude,...) or LINESTRING M(longitude latitude seconds,...) in degrees, 2 to 100 points, such as LINESTRING(8.79 46.17,8.61 46.53)",
        pattern: "^LINESTRING ?M? ?\\(.+\\)$",
    }, "", true;
    /// Which numbers, by their names in the collection's `parameter_names`, with commas between; the default is all of them.
    PARAMETER_NAME = "parameter-name", Kind::Text {
        allowed: "names in parameter_names of the collection, with commas between",
        pattern: "^[a-z0-9_]+(,[a-z0-9_]+)*$",
    }, "", false;
    /// Which numbers, with commas between. The default is the two of the zenith, which one map has; the others take a map of their own.
    AREA_PARAMETER_NAME = "parameter-name", Kind::Text {
        allowed: "zenith_luminance_cd_m2, zenith_brightness_mag_arcsec2, mean_luminance_cd_m2, horizontal_illuminance_lx, with commas between",
        pattern: "^[a-z0-9_]+(,[a-z0-9_]+)*$",
    }, "", false;
    /// The coordinate reference system of what is asked and answered: longitude and latitude of WGS 84, by one of its names.
    CRS = "crs", Kind::Choice(&[
        "http://www.opengis.net/def/crs/OGC/1.3/CRS84", "https://www.opengis.net/def/crs/OGC/1.3/CRS84", "OGC:CRS84", "CRS84",
    ]), "http://www.opengis.net/def/crs/OGC/1.3/CRS84", false;
    /// The format.
    COVERAGE_FORMAT = "f", Kind::Choice(&["CoverageJSON"]), "CoverageJSON", false;
    /// The format.
    DOCUMENT_FORMAT = "f", Kind::Choice(&["json"]), "json", false;
    /// Entries of the list at most.
    LIST_LIMIT = "limit", Kind::Integer { minimum: 1, maximum: MAX_LIST_LIMIT }, "10", false;
    /// The format.
    MAP_FORMAT = "f", Kind::Choice(&["png"]), "png", false;
    /// When, for the natural sky of that time beside the artificial one: an instant. A plus in a URL is `%2B`.
    DATETIME = "datetime", Kind::Text {
        allowed: skyglow_celestial::time::INSTANTS,
        pattern: "^[0-9]{4}-[0-9]{2}-[0-9]{2}[Tt ][0-9]{2}:[0-9]{2}:[0-9]{2}([.][0-9]{1,9})?([Zz]|[+ -][0-9]{2}:[0-9]{2})$",
    }, "", false;
    /// The part of the world that the map shows; the default is the scene. West may be beyond east, across the antimeridian.
    BBOX = "bbox", Kind::Text {
        allowed: "west,south,east,north in degrees, such as 8,46,9.5,47",
        pattern: "^-?[0-9.]+(,-?[0-9.]+){3}$",
    }, "", false;
    /// Width of the map; the default follows from the height so that a degree is as long either way, or is 1024.
    MAP_WIDTH = "width", Kind::Integer { minimum: 1, maximum: MAX_MAP_PX }, "", false;
    /// Height of the map; the default follows from the width.
    MAP_HEIGHT = "height", Kind::Integer { minimum: 1, maximum: MAX_MAP_PX }, "", false;
}

parameter_sets! {
    /// Those of documents.
    DocumentParameters = [DOCUMENT_FORMAT];
    /// Those of the list of processes.
    ProcessListParameters = [LIST_LIMIT, DOCUMENT_FORMAT];
    /// Those of a position.
    PositionParameters = [
        POINT_COORDS, PARAMETER_NAME, DATETIME, CRS, COVERAGE_FORMAT, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, EMISSION, DIRECT_UPLIGHT,
        GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE, SOLAR_FLUX, SCENARIO,
    ];
    /// Those of a trajectory.
    TrajectoryParameters = [
        LINE_COORDS, PARAMETER_NAME, DATETIME, CRS, COVERAGE_FORMAT, HEIGHT, ALTITUDE, TURBIDITY, SCATTERING, LAMP, EMISSION, DIRECT_UPLIGHT,
        GROUND_REFLECTANCE, EMISSION_KEEP, BASIS, CLOUDS, CLOUD_COVER, CLOUD_PATTERN, TERRAIN, TOLERANCE, SOLAR_FLUX, SCENARIO,
    ];
    /// Those of an area.
    AreaParameters = [
        AREA_COORDS, AREA_PARAMETER_NAME, CRS, COVERAGE_FORMAT, TURBIDITY, SCATTERING, LAMP, EMISSION, DIRECT_UPLIGHT, GROUND_REFLECTANCE,
        EMISSION_KEEP, TERRAIN, SCENARIO,
    ];
    /// Those of a map.
    MapParameters = [
        BBOX, MAP_WIDTH, MAP_HEIGHT, CRS, MAP_FORMAT, MAP_MEASURE, TURBIDITY, SCATTERING, LAMP, RESPONSE, EMISSION, DIRECT_UPLIGHT,
        GROUND_REFLECTANCE, EMISSION_KEEP, TERRAIN, SCENARIO,
    ];
}
