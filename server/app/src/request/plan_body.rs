//! Bodies of reduction plans, as JSON.

use super::{geojson::BoundaryBody, points::curve_schema};
use serde::Deserialize;
use utoipa::ToSchema;

/// What is to be dimmed for whose sake.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanBody {
    /// `threshold` or `target`.
    #[schema(pattern = "^(threshold|target)$")]
    pub method: String,
    /// Of `threshold`: the site.
    pub site: Option<SiteBody>,
    /// Of `threshold`: `norm`, `zenith`, `mean`, `horizontal` or `region`; the default is `region` where one is given, else
    /// `zenith`.
    #[schema(pattern = "^(norm|zenith|mean|horizontal|region)$")]
    pub measure: Option<String>,
    /// Of `threshold`: a closed curve on the sky, as for influences.
    #[schema(schema_with = curve_schema)]
    pub region: Option<Vec<[f64; 2]>>,
    /// Of `threshold`: pixels of less influence than this are left alone. In the measure's unit, or a percentile over the lit
    /// pixels within reach, such as `"p90"`.
    pub q_a: Option<LevelBody>,
    /// Of `threshold`: pixels of more influence than this are cut by `gamma`, those between by less; the default is `q_a`.
    pub q_b: Option<LevelBody>,
    /// Of `threshold`: the part of the most influential lights that goes, 0 to 1; the default is 1.
    #[schema(minimum = 0, maximum = 1)]
    pub gamma: Option<f64>,
    /// Of `target`: 1 to 16 sites with what each wants.
    #[schema(min_items = 1, max_items = 16)]
    pub sites: Option<Vec<SiteBody>>,
    /// Of `target`: the largest part of a light that may go, 0 to 1; the default is 1.
    #[schema(minimum = 0, maximum = 1)]
    pub max_cut: Option<f64>,
    /// Of `target`: lights in these polygons are left alone.
    #[schema(value_type = Option<Object>)]
    pub protect: Option<BoundaryBody>,
}

/// A site.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SiteBody {
    /// Degrees north.
    #[schema(minimum = -90, maximum = 90)]
    pub lat: f64,
    /// Degrees east.
    #[schema(minimum = -180, maximum = 360)]
    pub lon: f64,
    /// Metres above the ground; the default is 2.
    #[schema(minimum = 0)]
    pub height: Option<f64>,
    /// Metres above sea level, instead.
    pub altitude: Option<f64>,
    /// Of `target`: `zenith` (the default), `mean`, `horizontal` or `region`.
    #[schema(pattern = "^(zenith|mean|horizontal|region)$")]
    pub measure: Option<String>,
    /// Of `target`: a closed curve on the sky.
    #[schema(schema_with = curve_schema)]
    pub region: Option<Vec<[f64; 2]>>,
    /// Of `target`: the measure is to be this at most, in its unit, artificial light alone.
    #[schema(minimum = 0)]
    pub at_most: Option<f64>,
    /// Of `target`: the measure is to be less by this part of what it is, 0 to 1.
    #[schema(minimum = 0, maximum = 1)]
    pub reduce_by: Option<f64>,
}

/// A value of an influence.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum LevelBody {
    /// In the measure's unit.
    Value(f64),
    /// `p0` to `p100`.
    Percentile(String),
}
