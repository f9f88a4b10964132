//! Bodies of scenarios.

use super::{emission::EmissionBody, geojson::BoundaryBody, points::points_schema};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, SeqAccess, Visitor},
};
use skyglow_scene::MAX_EDITS;
use std::marker::PhantomData;
use utoipa::ToSchema;

/// What is painted over a scene.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioBody {
    /// Its name for people, at most 200 characters.
    #[schema(max_length = 200)]
    pub title: Option<String>,
    /// Id of a scenario or plan that it goes on from.
    #[schema(pattern = "^[sp]-[0-9a-f]{20}$")]
    pub base: Option<String>,
    /// The edits, one after the other: 1 to 100.
    #[serde(deserialize_with = "few_edits")]
    #[schema(min_items = 1, max_items = 100, example = json!([{"brush": {"points": [[8.6, 46.5]], "radius_m": 2000.0}, "factor": 0.3}]))]
    pub edits: Vec<EditBody>,
}

/// Reads edits and stops at the first that is too many.
pub(super) fn few_edits<'de, D: Deserializer<'de>, E: Deserialize<'de>>(
    deserializer: D,
) -> Result<Vec<E>, D::Error> {
    struct Few<E>(PhantomData<E>);
    impl<'de, E: Deserialize<'de>> Visitor<'de> for Few<E> {
        type Value = Vec<E>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            write!(f, "1 to {MAX_EDITS} edits")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<E>, A::Error> {
            let mut edits = Vec::new();
            while let Some(edit) = list.next_element()? {
                if edits.len() == MAX_EDITS {
                    return Err(A::Error::custom(format!("there are more than {MAX_EDITS} edits")));
                }
                edits.push(edit);
            }
            Ok(edits)
        }
    }
    deserializer.deserialize_seq(Few(PhantomData))
}

/// One edit: an area, and either a change of the lights there or new light.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EditBody {
    /// A GeoJSON Polygon or MultiPolygon, or a Feature or FeatureCollection of such; this or `brush`. Pixels whose centre is
    /// inside are painted.
    #[schema(value_type = Option<Object>)]
    pub polygon: Option<BoundaryBody>,
    /// A stroke of a brush.
    pub brush: Option<BrushBody>,
    /// Factor on the radiance of the lights that are there, 0 to 1000.
    #[schema(minimum = 0, maximum = 1000)]
    pub factor: Option<f64>,
    /// Their new lamps: a preset's name or three fluxes, for all of them, or which are replaced by which; of added light what it
    /// is.
    pub lamp: Option<LampBody>,
    /// Where they send their light from then on: a preset's name, weights of lambert, horizon and oblique, or shares of
    /// Garstang's law. Their flux stays, or with `emission_keep=nadir_radiance` what the satellite sees.
    pub emission: Option<EmissionBody>,
    /// Radiance added to every pixel, lit or dark, nW cm⁻² sr⁻¹: instead of `factor`.
    pub add_radiance_nw_cm2_sr: Option<f64>,
}

/// A stroke.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BrushBody {
    /// Longitude and latitude of its points, degrees: 1 to 1000.
    #[schema(schema_with = points_schema)]
    pub points: Vec<[f64; 2]>,
    /// Radius, 1 to 50 000 m. The pixels right under the stroke are painted however fine it is.
    #[schema(minimum = 1, maximum = 50_000)]
    pub radius_m: f64,
}

/// A preset's name, or three numbers.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum FixtureBody {
    /// A preset.
    Name(String),
    /// Fluxes in R, G, B per flux that the satellite sees.
    Numbers([f64; 3]),
}

/// Lamps.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum LampBody {
    /// All lamps become this.
    All(FixtureBody),
    /// Some do.
    Replace(ReplaceBody),
}

/// Lamps replaced by others.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReplaceBody {
    /// Preset of those that are replaced; all without. Of `mixed` half are `hps` and half `led_4000k`.
    pub from: Option<String>,
    /// The new ones.
    pub to: FixtureBody,
    /// What stays the same: `luminous_flux` (the default: streets are as bright as before) or `dnb_flux` (what the satellite
    /// sees).
    pub keep: Option<String>,
}

/// An area as a body gives it, for whoever paints or protects.
pub type AreaBody = BoundaryBody;

impl FixtureBody {
    /// As a parameter has it.
    pub(super) fn text(&self) -> String {
        match self {
            FixtureBody::Name(name) => name.clone(),
            FixtureBody::Numbers([a, b, c]) => format!("{a},{b},{c}"),
        }
    }
}
