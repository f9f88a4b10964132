//! A sky request, and the rendered sky that answers it.

use crate::{
    dark_through_gaps::DarkThroughGaps,
    lights_under_clouds::LightsUnderClouds,
    night_sky::{NightSky, SkyTime},
};
use serde::Serialize;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, BrokenClouds, Emission, EvenSky, Gaps, GeoPoint, Horizon, Lamp, LampPreset,
    NaturalSky, Panorama, Response, SKY_RESPONSES, SeenLight, SeenSky, SkyNumbers, SkyPart, SkyQuantities,
    Slope, Turbidity,
};
use skyglow_render::{PassTime, pack_kind::PackKind};
use skyglow_scene::{ChangeId, Ground, SceneId};
use skyglow_tables::Scattering;

/// Where the observer's eye is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum ObserverHeight {
    /// Metres above the ground, as [`Ground`] has it: above sea level where there is no terrain within 5 km.
    AboveGround(f64),
    /// Metres above sea level.
    AboveSea(f64),
}

impl ObserverHeight {
    /// Metres above sea level over a ground.
    pub fn altitude_m(self, ground: Ground) -> f64 {
        match self {
            ObserverHeight::AboveGround(height_m) => ground.altitude_m() + height_m,
            ObserverHeight::AboveSea(altitude_m) => altitude_m,
        }
    }
}

/// A request for one sky.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkyRequest {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights; None for the scene as it is.
    pub scenario: Option<ChangeId>,
    /// The place, in the scene.
    pub place: GeoPoint,
    /// Where the eye is.
    pub observer_height: ObserverHeight,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// Base of the layer of cloud above sea level, metres, of which packs are resident; None under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// How much of that layer is cloud; None where it is closed, and under a clear sky.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken_clouds: Option<BrokenClouds>,
    /// The lamp.
    pub lamp: Lamp,
    /// What sees the sky.
    pub response: Response,
    /// Where lamps send their light, and what of them the satellite's radiance says.
    pub emission: Emission,
    /// Basis functions; None for all, or for as many as the tolerance needs.
    pub basis: Option<usize>,
    /// Relative difference that fewer functions may make where `basis` names no number; None for all functions.
    pub tolerance: Option<f64>,
    /// Whether the scene's terrain hides the sky below the observer's horizon.
    pub terrain_hides: bool,
    /// When, for the natural sky of an instant; None for the dark reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<SkyTime>,
}

impl SkyRequest {
    /// The kind of packs that it is rendered from.
    pub(crate) fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: self.cloud_base_m, scattering: self.scattering }
    }
}

/// What the numbers of a sky or of a map of influences depend on beside the request.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderContext {
    /// Observer's altitude used, metres above sea level, at least 0.
    pub altitude_m: f64,
    /// The ground there.
    pub ground: Ground,
    /// Covered share of the 300 km disc, 0..=1.
    pub coverage: f64,
    /// The scene's calibration factor.
    pub calibration: f64,
    /// Vertical optical depth above the observer at the nodes: 680, 590, 510 and 440 nm.
    pub local_optical_depth: [f64; BAND_COUNT],
    /// Upward flux within 300 km, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// How the lights lie, where tables are of an overcast sky.
    pub under_clouds: Option<LightsUnderClouds>,
    /// Basis functions used.
    pub basis_count: usize,
    /// Where a tolerance was given, the bound of the difference to the sky of all functions
    /// ([`BasisWithin::error_bound`](skyglow_render::BasisWithin::error_bound)).
    pub basis_error_bound: Option<f64>,
    /// The dark reference as it is seen there.
    pub dark: EvenSky,
    /// How the ground lies there; level where terrain is unknown or does not count.
    pub slope: Slope,
    /// Lamps that changes replace around here where there are none of them by then.
    pub lamps_not_met: Vec<LampPreset>,
}

/// A rendered sky.
#[derive(Clone, Debug)]
pub struct RenderedSky {
    /// Its kinds of light with their kernels, 0 below the horizon.
    pub parts: Vec<SkyPart>,
    /// Artificial light as [`SKY_RESPONSES`] and the response of the request see it, 0 below the horizon.
    pub seen: SeenSky,
    /// What sees the sky.
    pub response: Response,
    /// Below it terrain hides the sky; flat where nothing does.
    pub horizon: Horizon,
    /// The natural sky of the instant that was asked for, as it comes through gaps.
    pub night: Option<NightSky>,
    /// Between them clouds hide the natural sky; None under a clear one.
    pub gaps: Option<Gaps>,
    /// Between broken clouds what air before the ground has of artificial light, X, Y, Z and scotopic luminance just above the
    /// ground by column: that of the sky there without the clouds that stand in it. None elsewhere: it is that of the sky.
    pub air_before_ground: Option<Vec<SeenLight>>,
    /// The reported quantities, of the sky above the horizon.
    pub quantities: SkyQuantities,
    /// What its numbers depend on beside the request.
    pub context: RenderContext,
    /// Time of each pass, for the batch it was in; before them `horizon`, where one was computed.
    pub passes: Vec<PassTime>,
}

impl RenderedSky {
    /// The sky of parts over an open horizon, of which what lies below `horizon` becomes dark.
    pub fn new(request: &SkyRequest, parts: Vec<SkyPart>, horizon: Horizon, context: RenderContext) -> Self {
        Self::with_natural(request, parts, horizon, context, (None, None))
    }

    /// The same with the natural sky of an instant, which is dark there already, and with gaps between clouds.
    pub(crate) fn with_natural(
        request: &SkyRequest,
        mut parts: Vec<SkyPart>,
        horizon: Horizon,
        context: RenderContext,
        (night, gaps): (Option<NightSky>, Option<Gaps>),
    ) -> Self {
        parts.iter_mut().for_each(|part| horizon.darken(&mut part.kernel));
        let seen = SeenSky::of(&parts, &responses_of(request));
        let numbers = SkyNumbers {
            parts: &parts,
            seen: &seen,
            horizon: &horizon,
            response: &request.response,
            dark: &context.dark,
            slope: context.slope,
        };
        let quantities = match (&night, &gaps) {
            (Some(night), gaps) => quantities_at(night, gaps.as_ref(), numbers),
            (None, Some(gaps)) => {
                let dark = DarkThroughGaps::new(&context.dark, gaps, &horizon, seen.responses());
                SkyQuantities::with(dark.as_natural_sky(), numbers)
            }
            (None, None) => SkyQuantities::with(NaturalSky::Dark, numbers),
        };
        let response = request.response.clone();
        let (passes, air_before_ground) = (Vec::new(), None);
        Self { parts, seen, response, horizon, night, gaps, air_before_ground, quantities, context, passes }
    }

    /// The quantities of its artificial light with the natural sky of another instant.
    pub(crate) fn quantities_with(&self, night: &NightSky) -> SkyQuantities {
        let numbers = SkyNumbers {
            parts: &self.parts,
            seen: &self.seen,
            horizon: &self.horizon,
            response: &self.response,
            dark: &self.context.dark,
            slope: self.context.slope,
        };
        quantities_at(night, self.gaps.as_ref(), numbers)
    }

    /// What the response of the request sees, `[row][column]`, in its unit.
    pub fn values(&self) -> &[f32] {
        self.seen.seen_by(&self.response).unwrap_or_default()
    }

    /// Bytes of its samples and points.
    pub fn byte_count(&self) -> usize {
        let of = |parts: &[SkyPart], seen: &SeenSky| {
            4 * (parts.len() * Panorama::LEN + seen.responses().len() * Panorama::LEN / BAND_COUNT)
        };
        let air = self.air_before_ground.as_deref().map_or(0, size_of_val);
        let night = self
            .night
            .as_ref()
            .map_or(0, |night| of(night.parts(), night.seen()) + night.points_byte_count());
        of(&self.parts, &self.seen) + night + air
    }

    /// Artificial light and the natural sky by the responses of [`Self::seen`]: that of the instant that was asked for or else the dark
    /// reference, above the horizon, as it comes between clouds and through them.
    pub fn seen_in_total(&self) -> SeenSky {
        let mut seen = self.seen.clone();
        match &self.night {
            Some(night) => seen.add(night.seen()),
            None => self.add_dark(&mut seen),
        }
        seen
    }

    /// What other responses see of artificial light, and where `in_total` of the natural sky too.
    pub fn seen_by(&self, responses: &[Response], in_total: bool) -> SeenSky {
        let mut seen = SeenSky::of(&self.parts, responses);
        match &self.night {
            _ if !in_total => {}
            Some(night) => seen.add(&SeenSky::of(night.parts(), responses)),
            None => self.add_dark(&mut seen),
        }
        seen
    }

    /// Adds the dark reference above the horizon, as it comes between clouds and through them.
    fn add_dark(&self, seen: &mut SeenSky) {
        if let Some(gaps) = &self.gaps {
            let dark = DarkThroughGaps::new(&self.context.dark, gaps, &self.horizon, seen.responses());
            return seen.add(dark.seen());
        }
        for place in 0..seen.responses().len() {
            let added = self.context.dark.value(&seen.responses()[place]) as f32;
            for (row, values) in seen.plane_mut(place).chunks_exact_mut(AZIMUTH_COUNT).enumerate() {
                for (column, value) in values.iter_mut().enumerate() {
                    if !self.horizon.hides_sample(row, column) {
                        *value += added;
                    }
                }
            }
        }
    }
}

/// The quantities with the natural sky of an instant.
fn quantities_at(night: &NightSky, gaps: Option<&Gaps>, numbers: SkyNumbers<'_>) -> SkyQuantities {
    let beams = night.beams(numbers.slope);
    let light = night.natural_light(&beams);
    let natural = if gaps.is_some() { NaturalSky::ThroughGaps(light) } else { NaturalSky::OfInstant(light) };
    SkyQuantities::with(natural, numbers)
}

/// What the numbers and pictures of a request need.
pub(crate) fn responses_of(request: &SkyRequest) -> Vec<Response> {
    let mut responses = SKY_RESPONSES.to_vec();
    if !responses.contains(&request.response) {
        responses.push(request.response.clone());
    }
    responses
}
