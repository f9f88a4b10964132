//! Painted scenarios.

use super::SceneReference;
use crate::format::rfc3339;
use serde::Serialize;
use skyglow_observatory::ScenarioRecord;
use skyglow_physics::{Lamp, LampKind, spectrum::wavelength_nm};
use skyglow_scene::{Area, Change, ChangeId, Edit, Listed, Outline, Scenario};
use utoipa::ToSchema;

/// A scenario in a list.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ScenarioEntry {
    /// Its id, which every query takes as `scenario`.
    pub id: String,
    /// Its name for people.
    pub title: Option<String>,
    /// The scenario or plan that it goes on from.
    pub base: Option<String>,
    /// When it was kept, RFC 3339 UTC.
    pub created: String,
    /// Number of its edits.
    pub edit_count: usize,
}

impl ScenarioEntry {
    /// The entry of a scenario.
    pub fn new(id: &ChangeId, scenario: &Scenario, created_unix_s: u64) -> Self {
        Self {
            id: id.to_string(),
            title: scenario.title.clone(),
            base: scenario.base.as_ref().map(ChangeId::to_string),
            created: rfc3339(created_unix_s),
            edit_count: scenario.edits.len(),
        }
    }

    /// The same as a list has it; None where it is none of a scenario.
    pub fn of_listed(listed: Listed) -> Option<Self> {
        let Outline::Scenario { title, edit_count } = listed.outline else { return None };
        let base = listed.base.as_ref().map(ChangeId::to_string);
        let created = rfc3339(listed.created_unix_s);
        Some(Self { id: listed.id.to_string(), title, base, created, edit_count })
    }
}

/// An edit as it was understood.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EditAnswer {
    /// Its area as GeoJSON: a MultiPolygon, or of a stroke the MultiPoint of its points.
    #[schema(value_type = Object)]
    pub area: serde_json::Value,
    /// Radius of the brush, metres; null for polygons.
    pub radius_m: Option<f64>,
    /// Factor on the lights that are there; null where light is added.
    pub factor: Option<f64>,
    /// Radiance that is added, nW cm⁻² sr⁻¹.
    pub add_radiance_nw_cm2_sr: Option<f64>,
    /// New lamps: a preset's name, or fluxes in R, G, B.
    #[schema(value_type = Option<Object>)]
    pub lamp: Option<serde_json::Value>,
    /// Which lamps they replace; null for all.
    pub lamp_from: Option<String>,
    /// What stays the same when lamps are replaced: `luminous_flux` or `dnb_flux`.
    pub keep: Option<String>,
    /// Weights of lambert, horizon and oblique; null for as before.
    pub emission: Option<[f64; 3]>,
    /// Lit pixels in its area.
    pub lit_pixels: u64,
}

impl EditAnswer {
    /// The answer of an edit.
    pub(crate) fn new(edit: &Edit, lit_pixels: u64) -> Self {
        let (area, radius_m) = match &edit.area {
            Area::Polygons(polygons) => {
                (serde_json::json!({"type": "MultiPolygon", "coordinates": polygons}), None)
            }
            Area::Brush { points, radius_m } => {
                (serde_json::json!({"type": "MultiPoint", "coordinates": points}), Some(*radius_m))
            }
        };
        let empty = Self {
            area,
            radius_m,
            factor: None,
            add_radiance_nw_cm2_sr: None,
            lamp: None,
            lamp_from: None,
            keep: None,
            emission: None,
            lit_pixels,
        };
        match &edit.change {
            Change::Alter { factor, lamp, emission } => Self {
                factor: Some(*factor),
                lamp: lamp.as_ref().map(|change| lamp_value(&change.to)),
                lamp_from: lamp.as_ref().and_then(|change| change.from).map(|from| from.name().to_owned()),
                keep: lamp.as_ref().map(|change| change.preserved.name().to_owned()),
                emission: emission.map(|mix| mix.weights()),
                ..empty
            },
            Change::Add { radiance_nw_cm2_sr, lamp, emission } => Self {
                add_radiance_nw_cm2_sr: Some(*radiance_nw_cm2_sr),
                lamp: lamp.as_ref().map(lamp_value),
                emission: emission.map(|mix| mix.weights()),
                ..empty
            },
        }
    }
}

/// A lamp as a request would name it.
fn lamp_value(lamp: &Lamp) -> serde_json::Value {
    match lamp.kind() {
        LampKind::Preset(preset) => preset.name().into(),
        LampKind::Bands(flux_per_dnb_flux) => flux_per_dnb_flux.to_vec().into(),
        LampKind::Mix(shares) => {
            let parts: Vec<String> =
                shares.iter().map(|(lamp, share)| format!("{}:{share}", lamp.name())).collect();
            parts.join(",").into()
        }
        LampKind::Spectrum(samples) => {
            let parts =
                samples.iter().enumerate().map(|(at, value)| format!("{}:{value}", wavelength_nm(at)));
            parts.collect::<Vec<_>>().join(",").into()
        }
    }
}

/// A scenario and what it does to its scene.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ScenarioAnswer {
    /// What the list says of it.
    #[serde(flatten)]
    pub entry: ScenarioEntry,
    /// The scene.
    pub scene: SceneReference,
    /// Its edits, in order.
    pub edits: Vec<EditAnswer>,
    /// Pixels whose light differs from the scene's, with what the scenario goes on from.
    pub changed_pixels: u64,
    /// Pixels lit that were dark.
    pub new_pixels: u64,
    /// Upward flux of all those before, DNB watts, calibration included.
    pub flux_before_dnb_w: f64,
    /// And after; of replaced lamps what the satellite would have to see of the old ones.
    pub flux_after_dnb_w: f64,
}

impl ScenarioAnswer {
    /// The answer of a scenario.
    pub fn new(id: &ChangeId, record: &ScenarioRecord) -> Self {
        let ScenarioRecord { scenario, summary, scene, created_unix_s } = record;
        let edits = scenario.edits.iter().zip(&summary.lit_pixels_in_edit);
        Self {
            entry: ScenarioEntry::new(id, scenario, *created_unix_s),
            scene: scene.into(),
            edits: edits.map(|(edit, lit_pixels)| EditAnswer::new(edit, *lit_pixels)).collect(),
            changed_pixels: summary.changed_pixels,
            new_pixels: summary.new_pixels,
            flux_before_dnb_w: summary.flux_before_dnb_w,
            flux_after_dnb_w: summary.flux_after_dnb_w,
        }
    }
}
