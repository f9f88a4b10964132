//! The JSON answers and their schemas.

use crate::source::{EyeHeight, RenderedSky, SiteFacts, SkyQuery, SourceFacts};
use serde::Serialize;
use skyglow_display::Sky;
use skyglow_physics::{
    AZIMUTH_COUNT, Band, ELEVATION_COUNT, EmissionMix, GeoPoint, Lamp, Lobe, Panorama, SkyQuantities,
};
use skyglow_scene::{Ground, Place, SceneMetadata};
use utoipa::ToSchema;

/// A scene.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SceneAnswer {
    /// Its name in URLs.
    pub id: String,
    /// Its name for people.
    pub title: String,
    /// West, south, east, north, degrees; west > east across the antimeridian.
    pub bounds: [f64; 4],
    /// The raster's own grid.
    pub grid: GridAnswer,
    /// Short name of the CRS.
    pub crs: String,
    /// Factor on the raster's radiances.
    pub calibration: f64,
    /// What the ingest saw: counts of lit, zero, negative, NaN, infinite, no-data and capped pixels with examples,
    /// the range, terrain under the lights, warnings.
    #[schema(value_type = Object)]
    pub report: serde_json::Value,
    /// Side of a square with the area of the middle pixel, metres.
    pub pixel_size_m: f64,
    /// Pixels with light.
    pub lit_pixels: u64,
    /// When the radiances were taken.
    pub date: Option<String>,
    /// Whom to credit.
    pub attribution: Option<String>,
    /// True for made-up light that only shows what the program does.
    pub illustrative: bool,
    /// Whether the scene has terrain.
    pub terrain: bool,
    /// Number of named places.
    pub places_count: u64,
    /// Hash over all that the scene holds.
    pub version: String,
}

/// A raster's grid.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct GridAnswer {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// GDAL's six coefficients.
    pub geotransform: [f64; 6],
    /// The CRS as WKT.
    pub crs_wkt: String,
}

impl From<SceneMetadata> for SceneAnswer {
    fn from(scene: SceneMetadata) -> Self {
        Self {
            id: scene.id.into(),
            title: scene.title,
            bounds: scene.bounds,
            grid: GridAnswer {
                width: scene.grid.width,
                height: scene.grid.height,
                geotransform: scene.grid.geotransform,
                crs_wkt: scene.grid.crs_wkt,
            },
            crs: scene.crs,
            calibration: scene.calibration,
            report: serde_json::to_value(scene.report).unwrap_or_default(),
            pixel_size_m: scene.pixel_size_m,
            lit_pixels: scene.lit_pixels,
            date: scene.date,
            attribution: scene.attribution,
            illustrative: scene.illustrative,
            terrain: scene.terrain,
            places_count: scene.places_count,
            version: scene.version,
        }
    }
}

/// A named place.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlaceAnswer {
    /// Its name.
    pub name: String,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east, −180..180.
    pub longitude_deg: f64,
    /// Inhabitants, where known.
    pub population: Option<u64>,
}

impl From<Place> for PlaceAnswer {
    fn from(place: Place) -> Self {
        Self {
            name: place.name,
            latitude_deg: place.latitude_deg,
            longitude_deg: place.longitude_deg,
            population: place.population,
        }
    }
}

/// The scene that an answer was made from.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SceneReference {
    /// Its name in URLs.
    pub id: String,
    /// Hash over all that it holds.
    pub version: String,
    /// True for made-up light.
    pub illustrative: bool,
    /// Whom to credit.
    pub attribution: Option<String>,
}

impl From<&SceneMetadata> for SceneReference {
    fn from(scene: &SceneMetadata) -> Self {
        Self {
            id: scene.id.to_string(),
            version: scene.version.clone(),
            illustrative: scene.illustrative,
            attribution: scene.attribution.clone(),
        }
    }
}

/// Says where the altitude of the ground comes from if not from the terrain there.
fn ground_warning(scene: &SceneMetadata, ground: Ground) -> Option<String> {
    match ground {
        Ground::Here { .. } => None,
        Ground::Nearest { distance_m, .. } => Some(format!(
            "the terrain has no data at this place: the ground is taken from the nearest terrain, {:.1} km away",
            distance_m / 1e3
        )),
        Ground::Unknown if scene.terrain => Some(
            "the terrain has no data within 5 km of this place: the ground is taken at sea level".to_owned(),
        ),
        Ground::Unknown => Some("the scene has no terrain: the ground is taken at sea level".to_owned()),
    }
}

/// What a sky had to do without, one sentence each. An eye above sea level does not ask for the ground.
pub fn sky_warnings(query: &SkyQuery, scene: &SceneMetadata, ground: Ground) -> Vec<String> {
    match query.eye_height {
        EyeHeight::AboveGround(_) => ground_warning(scene, ground).into_iter().collect(),
        EyeHeight::AboveSea(_) => Vec::new(),
    }
}

/// What is at a place.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SiteAnswer {
    /// The scene.
    pub scene: SceneReference,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude of the ground, metres, at least 0: where the terrain has a gap, that of the nearest terrain
    /// within 5 km; null where there is none, then 0 counts.
    pub terrain_altitude_m: Option<f64>,
    /// Radiance of the raster's pixel there, nW cm⁻² sr⁻¹; 0 where dark, null without data.
    pub radiance_nw_cm2_sr: Option<f64>,
    /// Factor on the raster's radiances (not in `radiance_nw_cm2_sr`).
    pub calibration: f64,
    /// West, south, east, north of the scene, degrees.
    pub bounds: [f64; 4],
    /// What is not as it should be there, one sentence each: ground that the terrain does not have.
    pub warnings: Vec<String>,
}

impl SiteAnswer {
    /// The answer for a place.
    pub fn new(place: GeoPoint, site: &SiteFacts) -> Self {
        Self {
            scene: (&site.scene).into(),
            latitude_deg: place.latitude_deg(),
            longitude_deg: place.longitude_deg(),
            terrain_altitude_m: site.ground.known_altitude_m(),
            radiance_nw_cm2_sr: site.radiance_nw_cm2_sr,
            calibration: site.scene.calibration,
            bounds: site.scene.bounds,
            warnings: ground_warning(&site.scene, site.ground).into_iter().collect(),
        }
    }
}

/// Where the observer is.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ObserverAnswer {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude of the eye above sea level, metres.
    pub altitude_m: f64,
    /// Altitude of the ground, metres, at least 0: where the terrain has a gap, that of the nearest terrain
    /// within 5 km; null where there is none, then 0 counts.
    pub terrain_altitude_m: Option<f64>,
}

/// A lamp.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct LampAnswer {
    /// The preset's name, or null for a custom lamp.
    pub preset: Option<String>,
    /// Flux in R, G, B per flux weighted by the satellite's response. A satellite sees no blue: the lamp is
    /// an assumption.
    pub flux_per_dnb_flux: [f64; 3],
}

impl From<Lamp> for LampAnswer {
    fn from(lamp: Lamp) -> Self {
        Self {
            preset: lamp.preset.map(|preset| preset.name().to_owned()),
            flux_per_dnb_flux: lamp.flux_per_dnb_flux,
        }
    }
}

/// Weights of the emission lobes; they sum to 1.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EmissionAnswer {
    /// cos ψ / π.
    pub lambert: f64,
    /// Garstang's low-angle term.
    pub horizon: f64,
    /// Falchi's third function.
    pub oblique: f64,
}

impl From<EmissionMix> for EmissionAnswer {
    fn from(mix: EmissionMix) -> Self {
        let weights = mix.weights();
        Self {
            lambert: weights[Lobe::Lambert.index()],
            horizon: weights[Lobe::Horizon.index()],
            oblique: weights[Lobe::Oblique.index()],
        }
    }
}

/// What every number depends on.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct Assumptions {
    /// The scene.
    pub scene: SceneReference,
    /// Where the observer is.
    pub observer: ObserverAnswer,
    /// Covered share of the disc of 300 km around the place; light outside the raster is unknown, not absent.
    pub coverage: f64,
    /// Factor on the raster's radiances.
    pub calibration: f64,
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// Vertical optical depth above the observer in R, G, B.
    pub local_optical_depth: [f64; 3],
    /// `single` or `multiple`.
    pub scattering: String,
    /// The lamp.
    pub lamp: LampAnswer,
    /// The emission.
    pub emission: EmissionAnswer,
    /// `none`: clouds are not modelled yet.
    pub clouds: String,
    /// Whether terrain hides lights and sky: not yet.
    pub terrain_occlusion: bool,
    /// Upward flux within 300 km of the place, DNB watts, calibration included; that of the whole scene is
    /// `flux_dnb_w` in its report.
    pub flux_within_300_km_dnb_w: f64,
    /// Basis functions used.
    pub basis_count: usize,
    /// What rendered: `gpu`, `lavapipe` or `cpu`.
    pub executor: String,
    /// What the numbers had to do without, one sentence each: ground that the terrain does not have.
    pub warnings: Vec<String>,
}

impl Assumptions {
    /// Those of a rendered sky.
    pub fn new(query: &SkyQuery, scene: &SceneMetadata, sky: &RenderedSky, facts: &SourceFacts) -> Self {
        Self {
            scene: scene.into(),
            observer: ObserverAnswer {
                latitude_deg: query.place.latitude_deg(),
                longitude_deg: query.place.longitude_deg(),
                altitude_m: sky.altitude_m,
                terrain_altitude_m: sky.ground.known_altitude_m(),
            },
            coverage: sky.coverage,
            calibration: sky.calibration,
            turbidity: query.turbidity.value(),
            local_optical_depth: sky.local_optical_depth,
            scattering: "single".to_owned(),
            lamp: query.lamp.into(),
            emission: query.emission.into(),
            clouds: "none".to_owned(),
            terrain_occlusion: false,
            flux_within_300_km_dnb_w: sky.flux_dnb_w,
            basis_count: sky.basis_count,
            executor: facts.executor.clone(),
            warnings: sky_warnings(query, scene, sky.ground),
        }
    }
}

/// The numbers of a sky. Luminances are artificial light alone unless the name says `total`, which adds a
/// uniform natural sky of 22.0 mag arcsec⁻². Magnitudes are null for a sky without light.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct QuantitiesAnswer {
    /// Mean within 5° of the zenith, cd m⁻².
    pub zenith_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// With the natural sky, cd m⁻².
    pub zenith_total_luminance_cd_m2: f64,
    /// With the natural sky, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: f64,
    /// Artificial over natural luminance at the zenith.
    pub ratio_to_natural: f64,
    /// As a Sky Quality Meter at the zenith sees it (Gaussian, FWHM 20°), cd m⁻².
    pub sqm_luminance_cd_m2: f64,
    /// What such a meter reads with the natural sky, mag arcsec⁻².
    pub sqm_total_brightness_mag_arcsec2: f64,
    /// Mean over the upper hemisphere, cd m⁻².
    pub mean_luminance_cd_m2: f64,
    /// Horizontal illuminance, lx.
    pub horizontal_illuminance_lx: f64,
    /// With the natural sky, lx.
    pub horizontal_total_illuminance_lx: f64,
    /// Largest luminance, cd m⁻².
    pub brightest_luminance_cd_m2: f64,
    /// Its azimuth, degrees clockwise from north.
    pub brightest_azimuth_deg: f64,
    /// Its elevation, degrees.
    pub brightest_elevation_deg: f64,
    /// Bortle class of the total at the zenith, 1..=9.
    pub bortle_class: u8,
    /// Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2).
    pub naked_eye_limit_mag: f64,
    /// Radiance at the zenith in R, G, B, W m⁻² sr⁻¹.
    pub zenith_radiance_w_m2_sr: [f64; 3],
}

impl From<&SkyQuantities> for QuantitiesAnswer {
    fn from(quantities: &SkyQuantities) -> Self {
        // Taken apart by name, so that a quantity added to the model is not forgotten here.
        let SkyQuantities {
            zenith_luminance_cd_m2,
            zenith_brightness_mag_arcsec2,
            zenith_total_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2,
            ratio_to_natural,
            sqm_luminance_cd_m2,
            sqm_total_brightness_mag_arcsec2,
            mean_luminance_cd_m2,
            horizontal_illuminance_lx,
            horizontal_total_illuminance_lx,
            brightest_luminance_cd_m2,
            brightest_azimuth_deg,
            brightest_elevation_deg,
            bortle_class,
            naked_eye_limit_mag,
            zenith_radiance_w_m2_sr,
        } = *quantities;
        Self {
            zenith_luminance_cd_m2,
            zenith_brightness_mag_arcsec2,
            zenith_total_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2,
            ratio_to_natural,
            sqm_luminance_cd_m2,
            sqm_total_brightness_mag_arcsec2,
            mean_luminance_cd_m2,
            horizontal_illuminance_lx,
            horizontal_total_illuminance_lx,
            brightest_luminance_cd_m2,
            brightest_azimuth_deg,
            brightest_elevation_deg,
            bortle_class,
            naked_eye_limit_mag,
            zenith_radiance_w_m2_sr,
        }
    }
}

/// The numbers alone.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SkyAnswer {
    /// What they depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// The numbers.
    pub sky: QuantitiesAnswer,
}

/// The grid of a panorama.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PanoramaGrid {
    /// Columns.
    pub azimuth_count: usize,
    /// Rows.
    pub elevation_count: usize,
    /// Azimuth of column 0, degrees clockwise from north.
    pub azimuth_first_deg: f64,
    /// Degrees from column to column.
    pub azimuth_step_deg: f64,
    /// Elevation of row 0, the lowest, degrees.
    pub elevation_first_deg: f64,
    /// Degrees from row to row.
    pub elevation_step_deg: f64,
}

/// A panorama's samples and numbers.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PanoramaAnswer {
    /// What it depends on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// Where the samples are.
    pub grid: PanoramaGrid,
    /// Wavelengths of the bands R, G, B, nm.
    pub bands_nm: [f64; 3],
    /// Unit of the samples.
    pub unit: String,
    /// Which light the samples hold: `artificial` or `total`.
    pub light: Light,
    /// `radiance[band][row][column]`.
    pub radiance: Vec<Vec<Vec<f32>>>,
    /// Elevation below which the terrain hides the sky, by column, degrees: 0 everywhere while
    /// `terrain_occlusion` is false.
    pub horizon_deg: Vec<f64>,
    /// The numbers.
    pub sky: QuantitiesAnswer,
}

/// Which light.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Light {
    /// Artificial light alone.
    Artificial,
    /// With the natural sky.
    Total,
}

impl PanoramaAnswer {
    /// The answer for a rendered sky.
    pub fn new(assumptions: Assumptions, sky: &RenderedSky, light: Sky) -> Self {
        let added = light.added_radiance_w_m2_sr() as f32;
        let samples = sky.panorama.samples();
        let row_of = |band: usize, row: usize| -> Vec<f32> {
            let start = Panorama::index(band, row, 0);
            samples[start..start + AZIMUTH_COUNT].iter().map(|radiance| radiance + added).collect()
        };
        Self {
            assumptions,
            grid: PanoramaGrid {
                azimuth_count: AZIMUTH_COUNT,
                elevation_count: ELEVATION_COUNT,
                azimuth_first_deg: 0.0,
                azimuth_step_deg: 360.0 / AZIMUTH_COUNT as f64,
                elevation_first_deg: 0.5 * 90.0 / ELEVATION_COUNT as f64,
                elevation_step_deg: 90.0 / ELEVATION_COUNT as f64,
            },
            bands_nm: Band::ALL.map(Band::wavelength_nm),
            unit: "W m-2 sr-1".to_owned(),
            light: match light {
                Sky::Artificial => Light::Artificial,
                Sky::Total => Light::Total,
            },
            radiance: (0..Band::ALL.len())
                .map(|band| (0..ELEVATION_COUNT).map(|row| row_of(band, row)).collect())
                .collect(),
            horizon_deg: vec![0.0; AZIMUTH_COUNT],
            sky: (&sky.quantities).into(),
        }
    }
}

/// A resident table pack.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AtmosphereAnswer {
    /// Its turbidity.
    pub turbidity: f64,
    /// `single` or `multiple`.
    pub scattering: String,
    /// Wavelengths of the bands, nm.
    pub bands_nm: Vec<f64>,
    /// Lowest and highest observer altitude, metres.
    pub observer_altitude_m: [f64; 2],
    /// Lowest and highest source altitude, metres.
    pub source_altitude_m: [f64; 2],
    /// Nearest and farthest source, metres.
    pub distance_m: [f64; 2],
    /// Basis functions.
    pub basis_count: usize,
    /// Checksum of the pack.
    pub checksum: String,
    /// Measured relative error of the images of single sources.
    #[schema(value_type = Option<Object>)]
    pub measured_error: Option<serde_json::Value>,
}

/// TileJSON 3.0.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct TileJson {
    /// `3.0.0`.
    pub tilejson: String,
    /// The layer.
    pub name: String,
    /// What the colours mean.
    pub description: String,
    /// Whom to credit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attribution: Option<String>,
    /// The scene's version.
    pub version: String,
    /// `xyz`.
    pub scheme: String,
    /// URL templates with `{z}`, `{x}`, `{y}`.
    pub tiles: Vec<String>,
    /// Lowest zoom level.
    pub minzoom: u8,
    /// Highest zoom level with detail of its own.
    pub maxzoom: u8,
    /// West, south, east, north, degrees.
    pub bounds: [f64; 4],
    /// Longitude, latitude and zoom level to start at.
    pub center: [f64; 3],
}

/// Whether the server lives or is ready.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct HealthAnswer {
    /// `ok`, or `starting` while tables or device are not ready.
    pub status: String,
    /// What renders: `gpu`, `lavapipe` or `cpu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub executor: Option<String>,
}
