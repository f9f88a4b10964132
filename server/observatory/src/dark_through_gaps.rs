//! The dark reference where clouds hide part of it.

use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, EvenSky, Gaps, Horizon, NaturalLight, NaturalSky, NodeLight,
    Panorama, Response, SeenSky, SkyPart,
    natural_sky::meter_weight,
    panorama::{elevation_rad, solid_angle_sr},
};
use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::Arc,
};

/// The dark reference as it comes through gaps, and through clouds.
pub(crate) struct DarkThroughGaps {
    parts: Vec<SkyPart>,
    seen: SeenSky,
    /// Mean of what comes straight from stars over the field of a Sky Quality Meter at the zenith.
    stars: Vec<NodeLight>,
}

impl DarkThroughGaps {
    pub(crate) fn new(dark: &EvenSky, gaps: &Gaps, horizon: &Horizon, responses: &[Response]) -> Self {
        let part = |light: &NodeLight| {
            let mut kernel = Panorama::dark();
            let planes = kernel.samples_mut().chunks_exact_mut(ELEVATION_COUNT * AZIMUTH_COUNT);
            for (plane, value) in planes.zip(light.kernel) {
                plane.fill(value as f32);
            }
            gaps.put_before(&mut kernel, [0.0; BAND_COUNT]);
            horizon.darken(&mut kernel);
            SkyPart { light: Arc::clone(&light.light), kernel }
        };
        // Stars themselves are points between the clouds; what clouds let through of their light is a part of the sky.
        let behind = |light: &NodeLight| {
            let mut kernel = Panorama::dark();
            gaps.put_before(&mut kernel, light.kernel.map(|value| PI * value));
            horizon.darken(&mut kernel);
            SkyPart { light: Arc::clone(&light.light), kernel }
        };
        let parts: Vec<SkyPart> =
            dark.background.iter().map(part).chain(dark.stars.iter().map(behind)).collect();
        let share = share_in_meter(gaps, horizon);
        let star = |light: &NodeLight| {
            let mut kernel = [0.0; BAND_COUNT];
            kernel.iter_mut().zip(light.kernel).for_each(|(sum, value)| *sum = share * value);
            NodeLight { light: Arc::clone(&light.light), kernel }
        };
        let stars = dark.stars.iter().map(star).collect();
        let seen = SeenSky::of(&parts, responses);
        Self { parts, seen, stars }
    }

    /// What the responses see of it.
    pub(crate) fn seen(&self) -> &SeenSky {
        &self.seen
    }

    pub(crate) fn as_natural_sky(&self) -> NaturalSky<'_> {
        NaturalSky::ThroughGaps(NaturalLight {
            parts: &self.parts,
            seen: &self.seen,
            points: &self.stars,
            beams: &[],
        })
    }
}

/// Share of gaps in the visible field of a Sky Quality Meter at the zenith; 0 where nothing of the field is visible.
fn share_in_meter(gaps: &Gaps, horizon: &Horizon) -> f64 {
    let (mut sum, mut field) = (0.0, 0.0);
    for row in 0..ELEVATION_COUNT {
        let weight = meter_weight(FRAC_PI_2 - elevation_rad(row)) * solid_angle_sr(row);
        for column in (0..AZIMUTH_COUNT).filter(|column| !horizon.hides_sample(row, *column)) {
            sum += weight * gaps.share(row, column);
            field += weight;
        }
    }
    if field > 0.0 { sum / field } else { 0.0 }
}
