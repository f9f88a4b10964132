//! Whose light it is: shares of named places and of areas in a sky.

use super::{Assumptions, PartAnswer, measure_name};
use crate::{format::rounded, request::NamedArea};
use serde::Serialize;
use skyglow_observatory::{InfluenceMap, Measure, Part, Shares};
use skyglow_physics::{GeoPoint, geometry::LocalFrame};
use utoipa::ToSchema;

/// A named place with the part of its lights.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlaceShare {
    /// Place in the list, from 1.
    pub rank: usize,
    /// Its name.
    pub name: String,
    /// Inhabitants, where known.
    pub population: Option<u64>,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Its distance from the observer along the ground, metres.
    pub distance_m: f64,
    /// Its azimuth from the observer, degrees clockwise from north.
    pub azimuth_deg: f64,
    /// What its lights do.
    #[serde(flatten)]
    pub part: PartAnswer,
}

/// Whose artificial light a sky is, by named places. The shares of all that is listed, of `other_places` and of `elsewhere` add up to 1.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SharesAnswer {
    /// What the numbers depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// `zenith`, `mean`, `horizontal` or `region`.
    pub measure: String,
    /// Unit of influences.
    pub unit: String,
    /// The sky's own value of the measure: artificial light alone.
    pub total: f64,
    /// The named places with the largest shares, the largest first.
    pub places: Vec<PlaceShare>,
    /// Named places with lights that are not listed.
    pub other_places_count: usize,
    /// All of those together.
    pub other_places: PartAnswer,
    /// Lights that are near no named place.
    pub elsewhere: PartAnswer,
}

/// An area with the part of the lights in it.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AreaShare {
    /// Place in the list, from 1.
    pub rank: usize,
    /// Its feature in the body, from 1.
    pub feature: usize,
    /// Its name.
    pub name: String,
    /// What the lights in it do.
    #[serde(flatten)]
    pub part: PartAnswer,
}

/// Whose artificial light a sky is, by areas. The shares of areas that do not overlap and of `outside` add up to 1.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AreaSharesAnswer {
    /// What the numbers depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// `zenith`, `mean`, `horizontal` or `region`.
    pub measure: String,
    /// Unit of influences.
    pub unit: String,
    /// The sky's own value of the measure: artificial light alone.
    pub total: f64,
    /// All areas, the largest share first.
    pub areas: Vec<AreaShare>,
    /// Lights in none of them.
    pub outside: PartAnswer,
    /// Lit pixels that lie in more than one area, and count for each.
    pub shared_pixels: u64,
}

/// Indices of parts, that of the most influence first.
fn ranked(parts: &[Part], keep: impl Fn(&Part) -> bool) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).filter(|&at| keep(&parts[at])).collect();
    order.sort_by(|&a, &b| parts[b].influence.total_cmp(&parts[a].influence));
    order
}

impl SharesAnswer {
    /// The answer from a map and its shares by [`InfluenceMap::by_town`].
    pub fn new(
        assumptions: Assumptions,
        map: &InfluenceMap,
        measure: &Measure,
        shares: &Shares,
        observer: GeoPoint,
        limit: usize,
    ) -> Self {
        let total = map.total().influence;
        let order = ranked(&shares.of_each, |part| part.pixels > 0);
        let (listed, others) = order.split_at(limit.min(order.len()));
        let frame = LocalFrame::at(observer);
        let place = |(at, &index): (usize, &usize)| {
            let place = &map.open_scene().places()[index];
            let (latitude_deg, longitude_deg) = (place.latitude_deg, place.longitude_deg);
            let to = GeoPoint::from_rad_unchecked(latitude_deg.to_radians(), longitude_deg.to_radians());
            let bearing = frame.bearing_to(to.unit_vector());
            PlaceShare {
                rank: at + 1,
                name: place.name.clone(),
                population: place.population,
                latitude_deg: rounded(latitude_deg),
                longitude_deg: rounded(longitude_deg),
                distance_m: bearing.distance_m,
                azimuth_deg: bearing.azimuth_rad.to_degrees(),
                part: PartAnswer::new(shares.of_each[index], total),
            }
        };
        let other = others.iter().map(|&index| shares.of_each[index]).fold(Part::default(), Part::with);
        let mut assumptions = assumptions;
        if map.open_scene().places().is_empty() {
            assumptions.warnings.push(NO_PLACES.to_owned());
        }
        Self {
            unit: measure.unit(&assumptions.response.unit),
            assumptions,
            measure: measure_name(measure).to_owned(),
            total,
            places: listed.iter().enumerate().map(place).collect(),
            other_places_count: others.len(),
            other_places: PartAnswer::new(other, total),
            elsewhere: PartAnswer::new(shares.of_nobody, total),
        }
    }
}

/// Said where there is nobody whose light it could be.
const NO_PLACES: &str =
    "the scene has no named places: ingest it with `--places`, or post areas with names instead";

impl AreaSharesAnswer {
    /// The answer from a map and its shares by [`InfluenceMap::by_area`].
    pub fn new(
        mut assumptions: Assumptions,
        map: &InfluenceMap,
        measure: &Measure,
        shares: &Shares,
        areas: &[NamedArea],
    ) -> Self {
        let total = map.total().influence;
        let beyond = areas.iter().filter(|area| area.area.check_within(map.scene().bounds).is_err()).count();
        if beyond > 0 {
            let count = areas.len();
            assumptions
                .warnings
                .push(format!("{beyond} of {count} areas lie outside the scene: their lights are not known"));
        }
        if shares.shared_pixels > 0 {
            assumptions
                .warnings
                .push("areas overlap: their shares count common lights more than once".to_owned());
        }
        let area = |(at, index): (usize, usize)| AreaShare {
            rank: at + 1,
            feature: index + 1,
            name: areas[index].name.clone(),
            part: PartAnswer::new(shares.of_each[index], total),
        };
        Self {
            unit: measure.unit(&assumptions.response.unit),
            assumptions,
            measure: measure_name(measure).to_owned(),
            total,
            areas: ranked(&shares.of_each, |_| true).into_iter().enumerate().map(area).collect(),
            outside: PartAnswer::new(shares.of_nobody, total),
            shared_pixels: shares.shared_pixels,
        }
    }
}
