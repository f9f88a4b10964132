//! Shares as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    answers::{AreaShare, AreaSharesAnswer, Assumptions, PartAnswer, PlaceShare, SharesAnswer},
    error::AppError,
    influence_file::{InfluenceFileError, csv_table, feature_collection, with_unit},
    parquet_table::{self, ParquetTable},
    request::{AreaSharesRequest, SharesRequest, area_features},
};
use serde::Serialize;
use serde_json::{Map, Value, json};
use skyglow_observatory::{InfluenceMap, Watch};

/// A format of shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharesFormat {
    /// JSON, with what they depend on.
    Json,
    /// A table whose shares add up to 1.
    Csv,
    /// The same table, in Parquet.
    Parquet,
    /// The places as points, or the areas as they were posted, with their shares.
    GeoJson,
}

impl SharesFormat {
    /// Its media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            SharesFormat::Json => "application/json",
            SharesFormat::Csv => "text/csv",
            SharesFormat::Parquet => parquet_table::MEDIA_TYPE,
            SharesFormat::GeoJson => "application/geo+json",
        }
    }
}

/// Shares by named places, and by areas.
#[derive(Clone, Debug)]
pub enum SharesQuestion {
    /// By the scene's named places.
    Places(SharesRequest),
    /// By areas.
    Areas(AreaSharesRequest),
}

/// What is answered.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum SharesOutcome {
    /// By the scene's named places.
    Places(Box<SharesAnswer>),
    /// By areas.
    Areas(Box<AreaSharesAnswer>),
}

/// A row of the table of named places; the last two have no rank.
#[derive(Clone, Debug, Default, Serialize)]
struct PlaceRow {
    rank: Option<usize>,
    name: String,
    population: Option<u64>,
    latitude_deg: Option<f64>,
    longitude_deg: Option<f64>,
    distance_m: Option<f64>,
    azimuth_deg: Option<f64>,
    share: f64,
    influence: f64,
    flux_dnb_w: f64,
    pixels: u64,
}

/// A row of the table of areas; the last has no rank.
#[derive(Clone, Debug, Default, Serialize)]
struct AreaRow {
    rank: Option<usize>,
    feature: Option<usize>,
    name: String,
    share: f64,
    influence: f64,
    flux_dnb_w: f64,
    pixels: u64,
}

impl SharesQuestion {
    /// Adds up a map of influences. Takes milliseconds, and as long as there are areas over areas.
    ///
    /// # Errors
    /// [`AppError::EngineDown`] where `watch` ended it.
    pub fn answer(
        &self,
        assumptions: Assumptions,
        map: &InfluenceMap,
        watch: &Watch<'_>,
    ) -> Result<SharesOutcome, AppError> {
        Ok(match self {
            Self::Places(SharesRequest { request, limit }) => {
                let shares = map.by_town(watch)?;
                let (measure, observer) = (&request.measure, request.sky.place);
                let answer = SharesAnswer::new(assumptions, map, measure, &shares, observer, *limit);
                SharesOutcome::Places(Box::new(answer))
            }
            Self::Areas(AreaSharesRequest { request, areas }) => {
                let boundaries: Vec<_> = areas.iter().map(|area| &area.area.boundary).collect();
                let shares = map.by_area(&boundaries, watch)?;
                let answer = AreaSharesAnswer::new(assumptions, map, &request.measure, &shares, areas);
                SharesOutcome::Areas(Box::new(answer))
            }
        })
    }
}

impl SharesOutcome {
    /// What the numbers depend on.
    pub fn assumptions(&self) -> &Assumptions {
        match self {
            Self::Places(answer) => &answer.assumptions,
            Self::Areas(answer) => &answer.assumptions,
        }
    }

    /// As a file.
    ///
    /// * `areas`: the body that the question came with, which has the shapes of areas; empty for places.
    ///
    /// # Errors
    /// [`InfluenceFileError`], only by a defect.
    pub fn encode(&self, format: SharesFormat, areas: &[u8]) -> Result<Vec<u8>, InfluenceFileError> {
        match (format, self) {
            (SharesFormat::Json, answer) => Ok(serde_json::to_vec(answer)?),
            (SharesFormat::Csv, Self::Places(answer)) => {
                Ok(with_unit(&csv_table(place_rows(answer))?, &answer.unit))
            }
            (SharesFormat::Csv, Self::Areas(answer)) => {
                Ok(with_unit(&csv_table(area_rows(answer))?, &answer.unit))
            }
            (SharesFormat::Parquet, Self::Places(answer)) => {
                parquet(place_rows(answer), &answer.unit, &answer.assumptions)
            }
            (SharesFormat::Parquet, Self::Areas(answer)) => {
                parquet(area_rows(answer), &answer.unit, &answer.assumptions)
            }
            (SharesFormat::GeoJson, Self::Places(answer)) => {
                let place = |place: &PlaceShare| [place.longitude_deg, place.latitude_deg];
                geojson(feature_collection(answer.places.clone(), place)?, answer)
            }
            (SharesFormat::GeoJson, Self::Areas(answer)) => {
                geojson(areas_with_shares(answer, areas)?, answer)
            }
        }
    }
}

/// The areas as they were posted, with their own properties beside the shares, the largest first.
fn areas_with_shares(
    answer: &AreaSharesAnswer,
    areas: &[u8],
) -> Result<Map<String, Value>, InfluenceFileError> {
    let mut features: Vec<_> = area_features(areas)?.into_iter().map(Some).collect();
    let feature = |area: &AreaShare| -> Result<Option<Value>, serde_json::Error> {
        let Value::Object(shares) = serde_json::to_value(area)? else { return Ok(None) };
        let posted = features.get_mut(area.feature - 1).and_then(Option::take);
        posted.map(|posted| serde_json::to_value(posted.with(shares))).transpose()
    };
    let features: Vec<Option<Value>> = answer.areas.iter().map(feature).collect::<Result<_, _>>()?;
    let features: Vec<Value> = features.into_iter().flatten().collect();
    let collection = [("type", json!("FeatureCollection")), ("features", json!(features))];
    Ok(collection.map(|(name, value)| (name.to_owned(), value)).into_iter().collect())
}

/// Features, and beside them what else the answer says: sums of what is in none of them, and what they depend on.
fn geojson(
    mut collection: Map<String, Value>,
    answer: &impl Serialize,
) -> Result<Vec<u8>, InfluenceFileError> {
    if let Value::Object(facts) = serde_json::to_value(answer)? {
        let listed = |name: &str| name == "places" || name == "areas";
        collection.extend(facts.into_iter().filter(|(name, _)| !listed(name)));
    }
    Ok(serde_json::to_vec(&collection)?)
}

fn parquet(
    rows: Vec<impl Serialize>,
    unit: &str,
    assumptions: &Assumptions,
) -> Result<Vec<u8>, InfluenceFileError> {
    let mut table = ParquetTable::default();
    for row in rows {
        table.add(&serde_json::to_vec(&row)?)?;
    }
    let assumptions = serde_json::to_string(assumptions)?;
    let notes = [("influence_unit", unit), ("assumptions", &assumptions)];
    Ok(table.encode(&["rank", "feature", "name", "share"], &notes)?)
}

fn place_rows(answer: &SharesAnswer) -> Vec<PlaceRow> {
    let sum = |name: &str, part: &PartAnswer| PlaceRow {
        name: name.to_owned(),
        share: part.share,
        influence: part.influence,
        flux_dnb_w: part.flux_dnb_w,
        pixels: part.pixels,
        ..PlaceRow::default()
    };
    let places = answer.places.iter().map(|place| PlaceRow {
        rank: Some(place.rank),
        population: place.population,
        latitude_deg: Some(place.latitude_deg),
        longitude_deg: Some(place.longitude_deg),
        distance_m: Some(place.distance_m),
        azimuth_deg: Some(place.azimuth_deg),
        ..sum(&place.name, &place.part)
    });
    let rest = [sum("other places", &answer.other_places), sum("elsewhere", &answer.elsewhere)];
    places.chain(rest).collect()
}

fn area_rows(answer: &AreaSharesAnswer) -> Vec<AreaRow> {
    let row = |rank: Option<usize>, feature: Option<usize>, name: &str, part: &PartAnswer| AreaRow {
        rank,
        feature,
        name: name.to_owned(),
        share: part.share,
        influence: part.influence,
        flux_dnb_w: part.flux_dnb_w,
        pixels: part.pixels,
    };
    let areas =
        answer.areas.iter().map(|area| row(Some(area.rank), Some(area.feature), &area.name, &area.part));
    areas.chain([row(None, None, "outside", &answer.outside)]).collect()
}
