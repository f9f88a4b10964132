//! Requests of OGC API – EDR (19-086r6) and Maps (20-058): where, which numbers, and the conditions of any sky.

use super::{
    area::BoundedArea,
    sky::{Conditions, has_celestial_tables, read_conditions, read_eye_height, read_time},
    wkt,
};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{Parameter, ParameterSet, SOLAR_FLUX},
    quantities::{MAP_QUANTITIES, MapQuantity, Quantity, SKY_QUANTITIES},
    reader::Reader,
    standard_parameters as p,
    validation::ValidationCode,
};
use skyglow_celestial::{Instant, heavens::DEFAULT_SOLAR_FLUX_SFU};
use skyglow_observatory::{BrightnessRequest, MapMeasure, ObserverHeight, SkyRequest, SkyTime};
use skyglow_physics::GeoPoint;
use skyglow_scene::SceneId;

/// Points of a trajectory at most.
const MAX_TRAJECTORY_POINTS: usize = 100;
/// Entries of a list where nobody says how many.
const DEFAULT_LIST_LIMIT: u32 = 10;
/// Width of a map where nobody says its size, pixels.
const DEFAULT_MAP_PX: f64 = 1024.0;

/// A position, and which numbers of its sky.
#[derive(Clone, Debug)]
pub struct PositionRequest {
    /// The sky.
    pub sky: SkyRequest,
    /// Longitude and latitude as they came, degrees.
    pub position: [f64; 2],
    /// The numbers.
    pub quantities: Vec<&'static Quantity>,
}

/// A path, and which numbers of the skies along it.
#[derive(Clone, Debug)]
pub struct TrajectoryRequest {
    /// The skies, point by point: all of one scene, with one scenario.
    pub skies: Vec<SkyRequest>,
    /// Longitudes and latitudes as they came, degrees.
    pub positions: Vec<[f64; 2]>,
    /// The numbers.
    pub quantities: Vec<&'static Quantity>,
}

/// An area, and which numbers of the maps that cover it.
#[derive(Clone, Debug)]
pub struct AreaRequest {
    /// The maps: one for each measure that the numbers are of.
    pub maps: Vec<BrightnessRequest>,
    /// The area.
    pub area: BoundedArea,
    /// The numbers.
    pub quantities: Vec<&'static MapQuantity>,
}

/// A map as a picture.
#[derive(Clone, Debug)]
pub struct MapRequest {
    /// What it shows.
    pub map: BrightnessRequest,
    /// West, south, east, north, degrees, where they are given; east is beyond west, perhaps beyond 180.
    bbox_deg: Option<[f64; 4]>,
    width_px: Option<u32>,
    height_px: Option<u32>,
}

/// Reads the format of a document, which may be named.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn document_format(query: Option<&str>) -> Result<(), AppError> {
    let mut reader = Reader::new(query, p::DocumentParameters::ALL);
    reader.choice(&p::DOCUMENT_FORMAT);
    reader.finish()
}

/// Reads how many processes are listed at most.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn process_limit(query: Option<&str>) -> Result<usize, AppError> {
    let mut reader = Reader::new(query, p::ProcessListParameters::ALL);
    let limit = reader.integer(&p::LIST_LIMIT);
    reader.choice(&p::DOCUMENT_FORMAT);
    reader.finish()?;
    Ok(limit.unwrap_or(DEFAULT_LIST_LIMIT) as usize)
}

/// Reads the parameters of a position.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn position(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<PositionRequest, AppError> {
    let mut reader = Reader::new(query, p::PositionParameters::ALL);
    let position = coords(&mut reader, &p::POINT_COORDS, wkt::point);
    let asked = read_asked(&mut reader, facts, false);
    reader.finish()?;
    let unread = || AppError::internal("a position was neither read nor refused");
    let (position, asked) = position.zip(asked).ok_or_else(unread)?;
    let sky = asked.sky(scene, position, asked.time).ok_or_else(unread)?;
    Ok(PositionRequest { sky, position, quantities: asked.quantities })
}

/// Reads the parameters of a trajectory.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn trajectory(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<TrajectoryRequest, AppError> {
    let mut reader = Reader::new(query, p::TrajectoryParameters::ALL);
    let line = coords(&mut reader, &p::LINE_COORDS, wkt::line);
    let is_timed = line.as_ref().is_some_and(|line| line.iter().any(|at| at.measure.is_some()));
    let asked = read_asked(&mut reader, facts, is_timed);
    let mut refuse = |message: String, code| reader.fail(&p::LINE_COORDS, code, Some(message), None);
    let mut times = Vec::new();
    if let Some(line) = &line {
        if !(2..=MAX_TRAJECTORY_POINTS).contains(&line.len()) {
            refuse(format!("has {} points", line.len()), ValidationCode::NotAllowed);
        }
        for at in line {
            let instant = at.measure.map(|unix_s| Instant::from_unix_s(unix_s.round()));
            match instant.transpose() {
                Ok(instant) => times.push(instant),
                Err(error) => {
                    refuse(format!("has a measure that is no time: {error}"), ValidationCode::NotAllowed)
                }
            }
        }
        if is_timed
            && times.windows(2).any(|pair| pair[0].map(Instant::unix_s) > pair[1].map(Instant::unix_s))
        {
            refuse("goes back in time".to_owned(), ValidationCode::NotAllowed);
        }
    }
    reader.finish()?;
    let unread = || AppError::internal("a trajectory was neither read nor refused");
    let (line, asked) = line.zip(asked).ok_or_else(unread)?;
    let time_of = |instant: Option<Instant>| {
        let of_point = |instant| SkyTime { instant, solar_flux_sfu: asked.solar_flux_sfu };
        instant.map(of_point).or(asked.time)
    };
    let one = |(at, instant): (&wkt::Measured, &Option<Instant>)| {
        asked.sky(scene.clone(), at.position, time_of(*instant))
    };
    let skies: Option<Vec<SkyRequest>> = line.iter().zip(&times).map(one).collect();
    let positions = line.iter().map(|at| at.position).collect();
    Ok(TrajectoryRequest { skies: skies.ok_or_else(unread)?, positions, quantities: asked.quantities })
}

/// Reads the parameters of an area.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn area(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<AreaRequest, AppError> {
    let mut reader = Reader::new(query, p::AreaParameters::ALL);
    read_form(&mut reader, &p::COVERAGE_FORMAT);
    let polygons = coords(&mut reader, &p::AREA_COORDS, wkt::polygons);
    let area = polygons.and_then(|polygons| match BoundedArea::of_polygons(&polygons) {
        Ok(area) => Some(area),
        Err(reason) => {
            reader.fail(&p::AREA_COORDS, ValidationCode::Malformed, Some(reason.to_string()), None);
            None
        }
    });
    let quantities =
        read_names(&mut reader, &p::AREA_PARAMETER_NAME, MAP_QUANTITIES, |quantity| quantity.name);
    let conditions = read_conditions(&mut reader, facts);
    reader.finish()?;
    let read = area.zip(quantities).zip(conditions);
    let ((area, mut quantities), conditions) =
        read.ok_or_else(|| AppError::internal("an area was neither read nor refused"))?;
    if quantities.is_empty() {
        quantities =
            MAP_QUANTITIES.iter().filter(|quantity| quantity.measure == MapMeasure::Zenith).collect();
    }
    let measures = [MapMeasure::Zenith, MapMeasure::Mean, MapMeasure::Horizontal].into_iter();
    let measures = measures.filter(|measure| quantities.iter().any(|quantity| quantity.measure == *measure));
    let maps = measures.map(|measure| conditions.clone().over_all(scene.clone(), measure, facts.max_places));
    Ok(AreaRequest { maps: maps.collect(), area, quantities })
}

/// Reads the parameters of a map as a picture.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn map(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<MapRequest, AppError> {
    let mut reader = Reader::new(query, p::MapParameters::ALL);
    read_form(&mut reader, &p::MAP_FORMAT);
    let bbox_deg = reader.text(&p::BBOX).map(bbox);
    if bbox_deg == Some(None) {
        reader.fail(&p::BBOX, ValidationCode::Malformed, None, None);
    }
    let [width_px, height_px] = [&p::MAP_WIDTH, &p::MAP_HEIGHT].map(|side| reader.integer(side));
    let measure = super::brightness::read_map_measure(&mut reader);
    let conditions = read_conditions(&mut reader, facts);
    reader.finish()?;
    let conditions = conditions.ok_or_else(|| AppError::internal("a map was neither read nor refused"))?;
    let map = conditions.over_all(scene, measure, facts.max_places);
    Ok(MapRequest { map, bbox_deg: bbox_deg.flatten(), width_px, height_px })
}

impl MapRequest {
    /// West, south, east, north that are shown, degrees, and how many pixels wide and high.
    ///
    /// * `bounds`: of the scene.
    ///
    /// # Errors
    /// [`AppError::Parameters`] for a part of the world that has nothing of the scene.
    pub fn frame(&self, bounds: [f64; 4]) -> Result<([f64; 4], [u32; 2]), AppError> {
        let [west, south, east, north] = bounds;
        let whole = [west, south, if west > east { east + 360.0 } else { east }, north];
        let shown = self.bbox_deg.unwrap_or(whole);
        if !super::area::meet(shown, bounds) {
            let [west, south, east, north] = bounds;
            return Err(AppError::parameter(
                p::BBOX.name,
                shown.map(|edge| edge.to_string()).join(","),
                format!(
                    "a part of the scene, which reaches from west {west} south {south} to east {east} north {north}"
                ),
                "shows nothing of the scene".to_owned(),
                ValidationCode::NotAllowed,
            ));
        }
        let aspect = (shown[2] - shown[0]) / (shown[3] - shown[1]);
        let side = |pixels: f64| (pixels.round() as u32).clamp(1, p::MAX_MAP_PX);
        let size = match (self.width_px, self.height_px) {
            (Some(width), Some(height)) => [width, height],
            (Some(width), None) => [width, side(f64::from(width) / aspect)],
            (None, Some(height)) => [side(f64::from(height) * aspect), height],
            (None, None) if aspect >= 1.0 => [DEFAULT_MAP_PX as u32, side(DEFAULT_MAP_PX / aspect)],
            (None, None) => [side(DEFAULT_MAP_PX * aspect), DEFAULT_MAP_PX as u32],
        };
        Ok((shown, size))
    }
}

/// What the skies of a position or a path have in common.
struct Asked {
    quantities: Vec<&'static Quantity>,
    conditions: Conditions,
    height: ObserverHeight,
    time: Option<SkyTime>,
    solar_flux_sfu: f64,
}

impl Asked {
    fn sky(
        &self,
        scene: SceneId,
        [longitude, latitude]: [f64; 2],
        time: Option<SkyTime>,
    ) -> Option<SkyRequest> {
        let place = GeoPoint::from_deg(latitude, longitude).ok()?;
        Some(SkyRequest { time, ..self.conditions.over(scene, place, self.height) })
    }
}

/// * `is_timed`: whether the coordinates have times of their own.
fn read_asked(reader: &mut Reader, facts: &SourceFacts, is_timed: bool) -> Option<Asked> {
    read_form(reader, &p::COVERAGE_FORMAT);
    let quantities = read_names(reader, &p::PARAMETER_NAME, SKY_QUANTITIES, |quantity| quantity.name);
    let height = read_eye_height(reader, facts);
    let conditions = read_conditions(reader, facts);
    let turbidity = conditions.as_ref().map(Conditions::turbidity);
    let (time, solar_flux_sfu) = if is_timed {
        if reader.text(&p::DATETIME).is_some() {
            let message = Some("excludes the times M of `coords`".to_owned());
            reader.fail(&p::DATETIME, ValidationCode::Conflict, message, Some("one of the two".to_owned()));
        }
        has_celestial_tables(reader, &p::LINE_COORDS, facts, turbidity);
        (None, reader.number(&SOLAR_FLUX).unwrap_or(DEFAULT_SOLAR_FLUX_SFU))
    } else {
        (read_time(reader, &p::DATETIME, facts, turbidity)?, DEFAULT_SOLAR_FLUX_SFU)
    };
    let quantities = match quantities? {
        none if none.is_empty() => SKY_QUANTITIES.iter().collect(),
        some => some,
    };
    Some(Asked { quantities, conditions: conditions?, height, time, solar_flux_sfu })
}

/// The names of the system of coordinates and of the format, of which there is one each.
fn read_form(reader: &mut Reader, format: &Parameter) {
    reader.choice(&p::CRS);
    reader.choice(format);
}

fn coords<T>(
    reader: &mut Reader,
    parameter: &Parameter,
    read: impl Fn(&str) -> Result<T, wkt::WktError>,
) -> Option<T> {
    let Some(text) = reader.text(parameter) else {
        reader.fail(parameter, ValidationCode::Missing, None, None);
        return None;
    };
    match read(text) {
        Ok(geometry) => Some(geometry),
        Err(reason) => {
            reader.fail(parameter, ValidationCode::Malformed, Some(reason.to_string()), None);
            None
        }
    }
}

/// Numbers by their names; empty where none is named, None where a name is unknown.
fn read_names<T>(
    reader: &mut Reader,
    parameter: &Parameter,
    known: &'static [T],
    name_of: impl Fn(&T) -> &'static str,
) -> Option<Vec<&'static T>> {
    let Some(text) = reader.text(parameter) else { return Some(Vec::new()) };
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    let is_known = |name: &&str| known.iter().any(|one| name_of(one) == *name);
    if !names.iter().all(is_known) {
        let allowed = known.iter().map(name_of).collect::<Vec<_>>().join(", ");
        reader.fail(parameter, ValidationCode::NotAllowed, None, Some(allowed));
        return None;
    }
    Some(known.iter().filter(|one| names.contains(&name_of(one))).collect())
}

/// Four edges, the eastern one counted on beyond the antimeridian.
fn bbox(text: &str) -> Option<[f64; 4]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let [west, south, east, north] = <[f64; 4]>::try_from(numbers?).ok()?;
    let is_longitude = |degrees: f64| (-180.0..=360.0).contains(&degrees);
    let is_latitude = |degrees: f64| (-90.0..=90.0).contains(&degrees);
    let is_box = is_longitude(west) && is_longitude(east) && is_latitude(south) && is_latitude(north);
    let east = if west > east { east + 360.0 } else { east };
    (is_box && south < north && west < east && east - west <= 360.0).then_some([west, south, east, north])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;

    fn scene() -> SceneId {
        SceneId::parse("demo").unwrap()
    }

    fn mistakes<T: std::fmt::Debug>(asked: Result<T, AppError>) -> Vec<(String, ValidationCode)> {
        let refused = asked.unwrap_err();
        refused.field_errors().iter().map(|error| (error.parameter.clone(), error.code)).collect()
    }

    #[test]
    fn a_position_is_that_of_a_sky() {
        let query = "coords=POINT(8.79%2046.17)&parameter-name=bortle_class,zenith_luminance_cd_m2&turbidity=3&height=10";
        let asked = position(Some(query), scene(), &facts()).unwrap();
        assert_eq!(asked.sky.observer_height, ObserverHeight::AboveGround(10.0));
        assert!((asked.sky.place.latitude_deg() - 46.17).abs() < 1e-9 && asked.position == [8.79, 46.17]);
        let names: Vec<&str> = asked.quantities.iter().map(|quantity| quantity.name).collect();
        assert_eq!(names, ["zenith_luminance_cd_m2", "bortle_class"]);
        let all = position(Some("coords=POINT(8 46)&crs=CRS84"), scene(), &facts()).unwrap();
        assert_eq!((all.quantities.len(), all.sky.time), (SKY_QUANTITIES.len(), None));
    }

    #[test]
    fn what_cannot_be_meant_is_named() {
        let of = |query: &str| mistakes(position(Some(query), scene(), &facts()));
        assert_eq!(of(""), [("coords".to_owned(), ValidationCode::Missing)]);
        assert_eq!(of("coords=POINT(8)"), [("coords".to_owned(), ValidationCode::Malformed)]);
        assert_eq!(of("coords=POINT(8 46)&crs=EPSG:3857"), [("crs".to_owned(), ValidationCode::NotAllowed)]);
        assert_eq!(of("coords=POINT(8 46)&f=netCDF"), [("f".to_owned(), ValidationCode::NotAllowed)]);
        let (name, code) = ("parameter-name".to_owned(), ValidationCode::NotAllowed);
        assert_eq!(of("coords=POINT(8 46)&parameter-name=wind"), [(name, code)]);
        let interval = "coords=POINT(8 46)&datetime=2026-01-01T00:00:00Z/2026-01-02T00:00:00Z";
        assert_eq!(of(interval), [("datetime".to_owned(), ValidationCode::Malformed)]);
    }

    #[test]
    fn a_path_has_times_of_its_own_or_one() {
        let of = |query: &str| trajectory(Some(query), scene(), &facts());
        let plain = of("coords=LINESTRING(8 46,9 46)").unwrap();
        assert!(plain.skies.iter().all(|sky| sky.time.is_none()) && plain.positions.len() == 2);
        let timed = of("coords=LINESTRING M(8 46 1785000000,9 46 1785000600)&solar_flux=150");
        let times: Vec<SkyTime> = timed.unwrap().skies.iter().filter_map(|sky| sky.time).collect();
        assert_eq!(
            (times.len(), times[1].instant.unix_s(), times[1].solar_flux_sfu),
            (2, 1_785_000_600.0, 150.0)
        );
        let coords = ("coords".to_owned(), ValidationCode::NotAllowed);
        assert_eq!(
            mistakes(of("coords=LINESTRING M(8 46 1785000600,9 46 1785000000)")),
            std::slice::from_ref(&coords)
        );
        assert_eq!(mistakes(of("coords=LINESTRING(8 46)")), std::slice::from_ref(&coords));
        let long = format!("coords=LINESTRING({}8 46)", "8 46,".repeat(MAX_TRAJECTORY_POINTS));
        assert_eq!(mistakes(of(&long)), [coords]);
        let both = "coords=LINESTRING M(8 46 1785000000,9 46 1785000600)&datetime=2026-07-25T00:00:00Z";
        assert_eq!(mistakes(of(both)), [("datetime".to_owned(), ValidationCode::Conflict)]);
    }

    #[test]
    fn an_area_asks_for_the_maps_it_needs() {
        let square = "coords=POLYGON((8 46,9 46,9 47,8 46))";
        let of = |end: &str| area(Some(&format!("{square}{end}")), scene(), &facts()).unwrap();
        let measures = |asked: &AreaRequest| asked.maps.iter().map(|map| map.measure).collect::<Vec<_>>();
        let zenith = of("");
        assert_eq!((measures(&zenith), zenith.quantities.len()), (vec![MapMeasure::Zenith], 2));
        let two = of("&parameter-name=horizontal_illuminance_lx,zenith_luminance_cd_m2");
        assert_eq!(measures(&two), [MapMeasure::Zenith, MapMeasure::Horizontal]);
        let open = mistakes(area(Some("coords=POLYGON((8 46,9 46,9 47))"), scene(), &facts()));
        assert_eq!(open, [("coords".to_owned(), ValidationCode::Malformed)]);
    }

    #[test]
    fn a_map_has_the_shape_of_what_it_shows() {
        let of = |query: &str| map(Some(query), scene(), &facts()).unwrap();
        let alps = [5.0, 43.0, 16.0, 48.0];
        assert_eq!(of("").frame(alps).unwrap(), (alps, [1024, 465]));
        assert_eq!(
            of("bbox=8,46,9,47&height=100").frame(alps).unwrap(),
            ([8.0, 46.0, 9.0, 47.0], [100, 100])
        );
        let fiji = [176.0, -20.0, -178.0, -15.0];
        assert_eq!(of("bbox=179,-18,-179,-17").frame(fiji).unwrap().0, [179.0, -18.0, 181.0, -17.0]);
        let elsewhere = of("bbox=-70,46,-69,47").frame(alps).unwrap_err();
        assert!(elsewhere.detail().contains("nothing of the scene"), "{}", elsewhere.detail());
        for bad in [
            "bbox=8,46,9",
            "bbox=8,47,9,46",
            "bbox=8,46,8,47",
            "bbox=a,b,c,d",
            "width=0",
            "width=5000",
            "f=jpeg",
        ] {
            assert!(map(Some(bad), scene(), &facts()).is_err(), "{bad}");
        }
    }
}
