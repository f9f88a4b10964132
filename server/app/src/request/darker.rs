//! Requests for darker places near a place.

use super::sky::{read_conditions, read_place};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, ParameterSet},
    reader::Reader,
};
use skyglow_observatory::{DarkerRequest, EYE_HEIGHT_M, MapMeasure, ObserverHeight, SkyRequest};
use skyglow_physics::GeoPoint;
use skyglow_scene::SceneId;

/// How far is looked where nobody says, kilometres.
const DEFAULT_WITHIN_KM: f64 = 60.0;
/// Places named where nobody says how many.
const DEFAULT_PLACES: u32 = 6;

/// A search for darker places, and the sky that each of them is asked for.
#[derive(Clone, Debug)]
pub struct DarkerQuestion {
    /// The sky of the place that it is about.
    pub here: SkyRequest,
    /// The search.
    pub search: DarkerRequest,
}

impl DarkerQuestion {
    /// The sky of another place.
    pub fn sky_at(&self, place: GeoPoint) -> SkyRequest {
        SkyRequest { place, ..self.here.clone() }
    }
}

/// Reads the parameters of darker places.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn darker(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<DarkerQuestion, AppError> {
    let mut reader = Reader::new(query, p::DarkerParameters::ALL);
    let place = read_place(&mut reader);
    let conditions = read_conditions(&mut reader, facts);
    let within_km = reader.number(&p::WITHIN_KM).unwrap_or(DEFAULT_WITHIN_KM);
    let count = reader.integer(&p::DARKER_PLACES).unwrap_or(DEFAULT_PLACES) as usize;
    reader.finish()?;
    let read = place.zip(conditions);
    let (place, conditions) =
        read.ok_or_else(|| AppError::internal("a search was neither read nor refused"))?;
    let here = conditions.over(scene.clone(), place, ObserverHeight::AboveGround(EYE_HEIGHT_M));
    let brightness = conditions.over_all(scene, MapMeasure::Zenith, facts.max_places);
    let search = DarkerRequest { place, within_m: 1e3 * within_km, count, brightness };
    Ok(DarkerQuestion { here, search })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;

    /// Sixty kilometres and six places unless said, as the table has it.
    #[test]
    fn the_search_is_read_with_its_defaults() {
        let ask = |query: &str| darker(Some(query), SceneId::parse("demo").unwrap(), &facts());
        let found = ask("lat=46.5&lon=8.6").unwrap();
        assert_eq!((found.search.within_m, found.search.count), (60_000.0, 6));
        assert_eq!((p::WITHIN_KM.default, p::DARKER_PLACES.default), ("60", "6"));
        assert_eq!(found.here.place, found.search.place);
        let found = ask("lat=46.5&lon=8.6&within_km=12.5&limit=2&turbidity=3").unwrap();
        assert_eq!((found.search.within_m, found.search.count), (12_500.0, 2));
        assert_eq!(found.search.brightness.turbidity, found.here.turbidity);
        for bad in ["within_km=1", "within_km=200", "limit=0", "height=3", "time=2026-01-01T00:00:00Z"] {
            assert!(ask(&format!("lat=46.5&lon=8.6&{bad}")).is_err(), "{bad}");
        }
    }
}
