//! What every number of a sky depends on.

use super::{DarkReferenceAnswer, SceneReference, site::ground_warning};
use crate::{
    facts::{KindFacts, SourceFacts},
    format::rounded,
};
use serde::Serialize;
use skyglow_observatory::{
    InfluenceMap, InfluenceRequest, LightsUnderClouds, Measure, ObserverHeight, RenderContext, SkyRequest,
};
use skyglow_physics::{
    BAND_COUNT, BrokenClouds, CloudBase, Emission, EmissionKeep, GarstangLaw, Lamp, LampKind, LampPreset,
    Lobe, Response, spectrum::Colour,
};
use skyglow_scene::{ChangeId, Ground, SceneMetadata};
use std::collections::BTreeMap;
use utoipa::ToSchema;

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
    /// Named lamps of a mix with their shares of the lumens; null for others.
    pub mix: Option<BTreeMap<String, f64>>,
    /// Flux in R, G, B (600–700, 500–600, 400–500 nm) per flux weighted by the satellite's response. A satellite sees no blue: the
    /// lamp is an assumption.
    pub flux_per_dnb_flux: [f64; 3],
    /// Lumens per watt that the satellite sees.
    pub lumens_per_dnb_watt: f64,
    /// Scotopic over photopic flux; null without visible light.
    pub scotopic_photopic_ratio: Option<f64>,
    /// Correlated colour temperature, K; null where it has none.
    pub colour_temperature_k: Option<f64>,
}

impl From<&Lamp> for LampAnswer {
    fn from(lamp: &Lamp) -> Self {
        let spectrum = lamp.light().spectrum();
        let colour = Colour::of(spectrum);
        // A lamp may be named more than once.
        let shares = |shares: &Vec<(LampPreset, f64)>| {
            let mut sums = BTreeMap::new();
            shares
                .iter()
                .for_each(|(lamp, share)| *sums.entry(lamp.name().to_owned()).or_insert(0.0) += share);
            sums
        };
        Self {
            preset: lamp.preset().map(|preset| preset.name().to_owned()),
            mix: match lamp.kind() {
                LampKind::Mix(parts) => Some(shares(parts)),
                _ => None,
            },
            flux_per_dnb_flux: lamp.flux_per_dnb_flux(),
            lumens_per_dnb_watt: spectrum.lumens(),
            scotopic_photopic_ratio: colour.map(|colour| colour.scotopic_photopic_ratio),
            colour_temperature_k: colour.and_then(|colour| colour.temperature_k),
        }
    }
}

/// What sees the sky.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ResponseAnswer {
    /// Its name, or `custom` for a curve of the user's own.
    pub name: String,
    /// Unit of what it sees.
    pub unit: String,
}

impl From<&Response> for ResponseAnswer {
    fn from(response: &Response) -> Self {
        Self { name: response.name().to_owned(), unit: response.unit().to_owned() }
    }
}

/// Where lights send their light that have no emission of their own. Weights of the lobes sum to 1.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EmissionAnswer {
    /// The preset's name, or null.
    pub preset: Option<String>,
    /// F of Garstang's law, the share of the lamps' light that goes above the horizon directly; null where weights were
    /// given themselves.
    pub direct_uplight: Option<f64>,
    /// G of the law, the share of the rest that the ground sends back; null as `direct_uplight`.
    pub ground_reflectance: Option<f64>,
    /// cos ψ / π.
    pub lambert: f64,
    /// Garstang's low-angle term.
    pub horizon: f64,
    /// Falchi's third function.
    pub oblique: f64,
    /// What the satellite's radiance L says of every light: `flux` (π·L) or `nadir_radiance`.
    #[schema(value_type = String)]
    pub keep: EmissionKeep,
    /// Flux per π·L: 1 with `flux`, 1/`lambert` with `nadir_radiance`.
    pub flux_factor: f64,
}

impl From<Emission> for EmissionAnswer {
    fn from(emission: Emission) -> Self {
        let (mix, law) = (emission.mix(), emission.law());
        let weights = mix.weights();
        Self {
            preset: emission.name().map(str::to_owned),
            direct_uplight: law.map(GarstangLaw::direct_uplight),
            ground_reflectance: law.map(GarstangLaw::ground_reflectance),
            lambert: weights[Lobe::Lambert.index()],
            horizon: weights[Lobe::Horizon.index()],
            oblique: weights[Lobe::Oblique.index()],
            keep: emission.keep(),
            flux_factor: emission.flux_factor(),
        }
    }
}

/// Covered share of the disc of 300 km from which on nothing is said of what is not covered.
const ENOUGH_COVERAGE: f64 = 0.9;

/// What every number depends on.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct Assumptions {
    /// The scene.
    pub scene: SceneReference,
    /// Id of the scenario or plan that changes its lights; null for the scene as it is.
    pub scenario: Option<String>,
    /// Where the observer is.
    pub observer: ObserverAnswer,
    /// Covered share of the disc of 300 km around the place; light outside the raster is unknown, not absent.
    pub coverage: f64,
    /// Factor on the raster's radiances.
    pub calibration: f64,
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// Vertical optical depth above the observer at 680, 590, 510 and 440 nm.
    pub local_optical_depth: [f64; BAND_COUNT],
    /// `single`: first order alone; `multiple`: all orders, with light that the ground sends back.
    pub scattering: String,
    /// Lambertian albedo of that ground; null where scattering is single.
    pub ground_albedo: Option<f64>,
    /// The lamp.
    pub lamp: LampAnswer,
    /// What sees the sky, where it is not the light-adapted eye.
    pub response: ResponseAnswer,
    /// The emission.
    pub emission: EmissionAnswer,
    /// `none`, or the altitude of the base of a closed layer of cloud in metres above sea level.
    pub clouds: String,
    /// Albedo of that base from below, of light that goes straight up; null where there are no clouds.
    pub cloud_albedo: Option<f64>,
    /// Optical depth of the drops that have this albedo; null where there are no clouds.
    pub cloud_optical_depth: Option<f64>,
    /// Share of that layer that is cloud; null where there are no clouds.
    pub cloud_cover: Option<f64>,
    /// Which pattern of clouds; null for the mean of all, and where the layer is closed.
    pub cloud_pattern: Option<u32>,
    /// What stands for the natural sky where no time is asked for.
    pub dark_reference: DarkReferenceAnswer,
    /// The time that the natural sky is of; absent where none was asked for, and it is the dark reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// Radio flux of the Sun at 10.7 cm that its airglow goes with, solar flux units; absent where no time and no night is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solar_flux_sfu: Option<f64>,
    /// Whether terrain hides the sky below the observer's horizon: false with `terrain=off` and in a scene without
    /// terrain.
    pub terrain_occlusion: bool,
    /// Whether light counts only above the skyline that its source sees towards the observer: false where
    /// `terrain_occlusion` is, and where the scene or the packs know no skylines, which `warnings` then says.
    pub hidden_lights: bool,
    /// Upward flux within 300 km of the place, DNB watts, calibration included; that of the whole scene is
    /// `flux_dnb_w` in its report.
    pub flux_within_300_km_dnb_w: f64,
    /// Basis functions used.
    pub basis_count: usize,
    /// With `tolerance`: the relative difference to the sky of all basis functions is at most this, in the norm over the
    /// open sky and the worst band; 0 with all of them, null without `tolerance`.
    pub basis_error_bound: Option<f64>,
    /// What rendered: `gpu`, `lavapipe` or `cpu`.
    pub executor: String,
    /// What the numbers had to do without, one sentence each: light outside the raster, ground that the terrain does not
    /// have, skylines that the scene or the packs do not know, natural light above its tables, stars behind clouds.
    pub warnings: Vec<String>,
}

impl Assumptions {
    /// Those of a map of influences, which is always found on the processor.
    pub fn of_influences(request: &InfluenceRequest, map: &InfluenceMap, facts: &SourceFacts) -> Self {
        let mut assumptions = Self::new(&request.sky, map.scene(), &map.context, facts);
        assumptions.executor = "cpu".to_owned();
        if request.measure == Measure::Norm && assumptions.terrain_occlusion {
            let what = "norms are over the open sky: of what terrain hides they leave out lights and no sky";
            assumptions.warnings.push(what.to_owned());
        }
        assumptions
    }

    /// Those of a sky.
    pub fn new(
        request: &SkyRequest,
        scene: &SceneMetadata,
        context: &RenderContext,
        facts: &SourceFacts,
    ) -> Self {
        let kind = facts.kind(request);
        Self {
            scene: scene.into(),
            scenario: request.scenario.as_ref().map(ChangeId::to_string),
            observer: ObserverAnswer {
                latitude_deg: rounded(request.place.latitude_deg()),
                longitude_deg: rounded(request.place.longitude_deg()),
                altitude_m: context.altitude_m,
                terrain_altitude_m: context.ground.known_altitude_m(),
            },
            coverage: context.coverage,
            calibration: context.calibration,
            turbidity: request.turbidity.value(),
            local_optical_depth: context.local_optical_depth,
            scattering: request.scattering.name().to_owned(),
            ground_albedo: kind.and_then(|kind| kind.ground_albedo),
            lamp: (&request.lamp).into(),
            response: (&request.response).into(),
            emission: request.emission.into(),
            clouds: request.cloud_base_m.map_or_else(|| "none".to_owned(), |base_m| base_m.to_string()),
            cloud_albedo: facts.cloud_albedo(request),
            cloud_optical_depth: facts.cloud_albedo(request).map(CloudBase::optical_depth),
            cloud_cover: request.cloud_base_m.map(|_| request.broken_clouds.map_or(1.0, BrokenClouds::cover)),
            cloud_pattern: request.broken_clouds.and_then(BrokenClouds::pattern),
            dark_reference: DarkReferenceAnswer::new(&context.dark, &request.response),
            time: request.time.map(|time| time.instant.to_rfc3339()),
            solar_flux_sfu: request.time.map(|time| time.solar_flux_sfu),
            terrain_occlusion: request.terrain_hides && scene.terrain,
            hidden_lights: hides_lights(request.terrain_hides, scene, kind),
            flux_within_300_km_dnb_w: context.flux_dnb_w,
            basis_count: context.basis_count,
            basis_error_bound: context.basis_error_bound,
            executor: facts.executor.clone(),
            warnings: sky_warnings(request, scene, context, facts),
        }
    }
}

/// What a sky had to do without, one sentence each. An eye above sea level does not ask for the ground, but may be in it.
fn sky_warnings(
    request: &SkyRequest,
    scene: &SceneMetadata,
    context: &RenderContext,
    facts: &SourceFacts,
) -> Vec<String> {
    let ground = match request.observer_height {
        ObserverHeight::AboveGround(_) => ground_warning(scene, context.ground),
        ObserverHeight::AboveSea(altitude_m) => below_ground_warning(altitude_m, context.ground),
    };
    let skyline = open_lights_warning(request.terrain_hides, scene, facts.kind(request));
    let lamps = context.lamps_not_met.iter().map(|lamp| lamp_warning(*lamp, &request.lamp));
    let high = high_warning(context.altitude_m, facts);
    let [above_lights, at_clouds] = context.under_clouds.as_ref().map_or([None, None], overcast_warnings);
    let words = [
        coverage_warning(context.coverage),
        ground,
        skyline,
        high,
        cloud_warning(request),
        above_lights,
        at_clouds,
    ];
    words.into_iter().flatten().chain(lamps).collect()
}

/// What is said where much of the light around is unknown.
fn coverage_warning(coverage: f64) -> Option<String> {
    (coverage < ENOUGH_COVERAGE).then(|| {
        format!(
            "light is known for {:.0} % of the 300 km around: what lies outside the raster is unknown, not absent, and \
             the sky may be brighter than this",
            100.0 * coverage
        )
    })
}

/// What is said where a scenario replaces lamps that are not there.
fn lamp_warning(from: LampPreset, asked: &Lamp) -> String {
    let all = asked.preset().map_or("of their own kind", LampPreset::name);
    let from = from.name();
    format!(
        "the scenario replaces {from} lamps, but where it does there are none of them: the lamps of the scene are taken to be \
         {all}, as `lamp` says"
    )
}

/// What is said of an eye more than a metre below the ground.
fn below_ground_warning(altitude_m: f64, ground: Ground) -> Option<String> {
    let depth_m = ground.known_altitude_m()? - altitude_m;
    (depth_m > 1.0).then(|| {
        format!(
            "the observer is {depth_m:.0} m below the ground: the sky is what air there would show without it"
        )
    })
}

/// What is said of an eye above the tables of the natural sky.
fn high_warning(altitude_m: f64, facts: &SourceFacts) -> Option<String> {
    let highest_m = facts.celestial_highest_m.filter(|highest_m| altitude_m > *highest_m)?;
    Some(format!("the natural sky is that of {highest_m:.0} m above the sea: its tables end there"))
}

/// What is said under clouds, where some numbers are not what their names lead one to think.
fn cloud_warning(request: &SkyRequest) -> Option<String> {
    request.cloud_base_m?;
    let said = match request.broken_clouds {
        None => {
            "natural light comes through the clouds as far as they do not reflect it, in all directions alike; there is neither \
             Bortle class nor limiting magnitude"
        }
        Some(_) => {
            "natural light comes through the gaps between the clouds, and through the clouds as far as they do not reflect it; \
             there is neither Bortle class nor limiting magnitude"
        }
    };
    Some(said.to_owned())
}

/// Above the lights nearby by more than this, metres, low skies of tables under clouds are less exact (`docs/accuracy.md#overcast`).
const LESS_EXACT_ABOVE_M: f64 = 100.0;

/// From this share of the light around on, what is higher than tables know lights matters.
const MUCH_AT_CLOUDS: f64 = 0.01;

/// What is said where tables under clouds are known to be less exact: of low skies, and of lights at the clouds.
fn overcast_warnings(lights: &LightsUnderClouds) -> [Option<String>; 2] {
    let LightsUnderClouds { above_lights_m, at_clouds } = *lights;
    let low_sky = (above_lights_m > LESS_EXACT_ABOVE_M).then(|| {
        format!(
            "the observer is {above_lights_m:.0} m above the lights nearby: there, directions in the lowest 10° of an overcast sky are \
             mostly 10 to 30 % off, single ones up to 90 %"
        )
    });
    let lights_at_clouds = (at_clouds > MUCH_AT_CLOUDS).then(|| {
        format!(
            "{:.0} % of the light around is less than 100 m below the base of the clouds: tables know no lights there; the \
             sky can be 15 % off, single directions 20 to 40 %",
            100.0 * at_clouds
        )
    });
    [low_sky, lights_at_clouds]
}

/// Whether light counts only above the skyline that its source sees towards the observer.
pub(super) fn hides_lights(terrain_hides: bool, scene: &SceneMetadata, kind: Option<&KindFacts>) -> bool {
    terrain_hides && scene.light_skylines && kind.and_then(|kind| kind.why_open).is_none()
}

/// What is said where terrain is wanted and lights behind it are nevertheless seen.
pub(super) fn open_lights_warning(
    terrain_hides: bool,
    scene: &SceneMetadata,
    kind: Option<&KindFacts>,
) -> Option<String> {
    // Without terrain there is nothing to hide behind.
    if !terrain_hides || !scene.terrain {
        return None;
    }
    let reason = match kind.and_then(|kind| kind.why_open) {
        Some(reason) => reason,
        None if scene.lacks_light_skylines() => "the scene was stored before skylines were: ingest it again",
        None => return None,
    };
    Some(format!("lights behind ridges count as if they were not: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// High above near lights, and with lights at the clouds, tables under clouds are less exact, which is said there alone.
    #[test]
    fn errors_under_clouds_are_told() {
        let said = |above_lights_m, at_clouds| {
            overcast_warnings(&LightsUnderClouds { above_lights_m, at_clouds }).map(Option::unwrap_or_default)
        };
        assert_eq!(said(100.0, 0.01), ["", ""]);
        assert_eq!(said(-300.0, 0.0), ["", ""]);
        let [low_sky, lights] = said(248.4, 0.234);
        assert!(
            low_sky.contains("248 m above the lights nearby") && low_sky.contains("lowest 10°"),
            "{low_sky}"
        );
        assert!(lights.starts_with("23 % of the light around"), "{lights}");
    }
}
