//! From a scene and changes to the scene with those changes.

use super::area::AreaError;
use super::gone::GoneLights;
use super::painting::{Change, ChangeStep, Edit};
use crate::gather::Light;
use crate::light_layer::{LightLayer, Lights};
use crate::light_skyline::skyline_of_light;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::scene::Scene;
use crate::skylines::{Skyline, Skylines};
use rayon::prelude::*;
use skyglow_physics::source_pixel::upward_flux_dnb_w;
use skyglow_physics::{Fixture, GeoPoint, Kept, LampChange};
use std::collections::HashMap;
use std::sync::Arc;
use thiserror::Error;

/// Most pixels that may be lit where there was no light.
pub const MOST_NEW_LIGHTS: usize = 200_000;
/// Radiance above which a pixel is no lamp any more, nW cm⁻² sr⁻¹.
const BRIGHTEST_NW_CM2_SR: f64 = 1e7;

/// Why a scene cannot be changed so.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ChangeError {
    /// An area that is none.
    #[error("edit {number}: {error}")]
    Area {
        /// Which edit of its step, from 1.
        number: usize,
        /// Why.
        error: AreaError,
    },
    /// An area without a pixel of the scene.
    #[error("edit {number} holds no pixel of the scene")]
    Outside {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// More light than any lamp has.
    #[error("edit {number} makes a pixel brighter than {BRIGHTEST_NW_CM2_SR} nW cm-2 sr-1")]
    TooBright {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// Too many pixels lit.
    #[error("more than {MOST_NEW_LIGHTS} dark pixels would be lit")]
    TooManyNewLights,
}

/// What changes do to a scene's lights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChangeSummary {
    /// Lit pixels in the area of each edit of the last painted step, those that edits before it lit included.
    pub lit_pixels_in_edit: Vec<u64>,
    /// Lit pixels whose light differs from the scene's.
    pub changed_pixels: u64,
    /// Pixels lit that were dark.
    pub new_pixels: u64,
    /// Upward flux of the changed pixels before, DNB watts, calibration included.
    pub flux_before_dnb_w: f64,
    /// The same after, of them and of new ones.
    pub flux_after_dnb_w: f64,
}

/// A light of a pixel: radiance, nW cm⁻² sr⁻¹, and the number of its fixture.
type PaintedLight = (f64, usize);

/// Pixels being painted.
struct Canvas<'a> {
    scene: &'a Scene,
    light: Light<'a>,
    fixtures: Vec<Fixture>,
    /// Lights of the touched pixels by code; of the first fixture what the scene had.
    pixels: HashMap<u64, Vec<PaintedLight>>,
    new_count: usize,
}

impl<'a> Canvas<'a> {
    fn new(scene: &'a Scene) -> Self {
        let light = scene.first_layer().light(&scene.grid, scene.metadata.calibration, false);
        Self { scene, light, fixtures: vec![Fixture::default()], pixels: HashMap::new(), new_count: 0 }
    }

    /// The lights of a pixel, as changed so far.
    fn lights_at(&mut self, code: u64) -> &mut Vec<PaintedLight> {
        let pixels = self.light.pixels;
        self.pixels.entry(code).or_insert_with(|| match pixels.codes.binary_search(&code) {
            Ok(index) => vec![(f64::from(pixels.radiance_nw_cm2_sr[index]), 0)],
            Err(_) => Vec::new(),
        })
    }

    fn fixture(&mut self, fixture: Fixture) -> usize {
        match self.fixtures.iter().position(|known| *known == fixture) {
            Some(number) => number,
            None => {
                self.fixtures.push(fixture);
                self.fixtures.len() - 1
            }
        }
    }

    /// Paints; answers the number of lit pixels in the area.
    fn paint(&mut self, number: usize, edit: &Edit) -> Result<u64, ChangeError> {
        let pieces = edit.area.pieces().map_err(|error| ChangeError::Area { number, error })?;
        let mut codes: Vec<u64> = Vec::new();
        let is_new = matches!(edit.change, Change::Add { .. });
        for piece in &pieces {
            if is_new {
                piece.for_each_pixel(&self.scene.grid, |column, row| codes.push(morton::encode(column, row)));
            } else {
                piece.for_each_light(&self.light, |index| codes.push(self.light.pixels.codes[index]));
            }
        }
        if !is_new {
            // Lights that an edit before has lit.
            let lit_before = self.pixels.keys().copied().filter(|code| self.is_new_light(*code));
            let new_lights: Vec<u64> = lit_before.collect();
            codes.extend(new_lights.into_iter().filter(|&code| {
                let (column, row) = morton::decode(code);
                pieces.iter().any(|piece| piece.has_pixel(&self.scene.grid, column, row))
            }));
        }
        codes.sort_unstable();
        codes.dedup();
        if codes.is_empty() && (is_new || !self.meets_raster(&pieces)) {
            return Err(ChangeError::Outside { number });
        }
        let lit =
            codes.iter().filter(|&&code| self.lights_at(code).iter().any(|light| light.0 > 0.0)).count();
        match &edit.change {
            Change::Alter { factor, lamp, emission } => {
                for code in &codes {
                    let lights = self.lights_at(*code).clone();
                    let altered = lights.into_iter().map(|(radiance, of)| {
                        let mut fixture = self.fixtures[of].clone();
                        fixture.lamps.extend(*lamp);
                        fixture.emission = emission.or(fixture.emission);
                        (radiance * factor, self.fixture(fixture))
                    });
                    let mut merged: Vec<PaintedLight> = Vec::new();
                    for (radiance, of) in altered {
                        match merged.iter_mut().find(|light| light.1 == of) {
                            Some(light) => light.0 += radiance,
                            None => merged.push((radiance, of)),
                        }
                    }
                    *self.lights_at(*code) = merged;
                }
            }
            Change::Add { radiance_nw_cm2_sr, lamp, emission } => {
                let lamps = lamp.map(|to| LampChange { from: None, to, kept: Kept::DnbFlux });
                let of = self.fixture(Fixture { lamps: lamps.into_iter().collect(), emission: *emission });
                for code in &codes {
                    let lights = self.lights_at(*code);
                    match lights.iter_mut().find(|light| light.1 == of) {
                        Some(light) => light.0 += radiance_nw_cm2_sr,
                        None => lights.push((*radiance_nw_cm2_sr, of)),
                    }
                }
                self.new_count += codes.len() - lit;
                if self.new_count > MOST_NEW_LIGHTS {
                    return Err(ChangeError::TooManyNewLights);
                }
            }
        }
        let is_too_bright = |code: &u64| self.pixels[code].iter().any(|light| light.0 > BRIGHTEST_NW_CM2_SR);
        if codes.iter().any(is_too_bright) {
            return Err(ChangeError::TooBright { number });
        }
        Ok(lit as u64)
    }

    fn is_new_light(&self, code: u64) -> bool {
        self.light.pixels.codes.binary_search(&code).is_err()
    }

    fn meets_raster(&self, pieces: &[super::area::Piece]) -> bool {
        let mut meets = false;
        for piece in pieces {
            piece.for_each_pixel(&self.scene.grid, |_, _| meets = true);
        }
        meets
    }

    fn dim(&mut self, codes: &[u64], factors: &[f32]) {
        for (code, factor) in codes.iter().zip(factors) {
            self.lights_at(*code).iter_mut().for_each(|light| light.0 *= f64::from(*factor));
        }
    }
}

impl Scene {
    /// The code of a pixel in [`PixelFactors`](super::PixelFactors).
    pub fn pixel_code(column: u32, row: u32) -> u64 {
        morton::encode(column, row)
    }

    /// Column and row of a code.
    pub fn column_and_row_of(code: u64) -> (u32, u32) {
        morton::decode(code)
    }

    /// The scene with changes, one step after the other. What no change touches is shared with this scene; pyramids are made
    /// of the touched lights alone. New lights stand on the terrain and behind its skylines as those of the raster do.
    ///
    /// * `mark`: tells these changes from all others; the version is made from it and the scene's.
    ///
    /// # Errors
    /// [`ChangeError`].
    ///
    /// # Panics
    /// If the scene is a changed one itself: give all steps to the scene that was ingested.
    pub fn changed(&self, steps: &[ChangeStep], mark: &str) -> Result<(Self, ChangeSummary), ChangeError> {
        assert!(self.layers.len() == 1, "steps belong to a scene as it was ingested");
        let mut canvas = Canvas::new(self);
        let mut summary = ChangeSummary::default();
        for step in steps {
            match step {
                ChangeStep::Painted(edits) => {
                    let lit = (1..).zip(edits).map(|(number, edit)| canvas.paint(number, edit));
                    summary.lit_pixels_in_edit = lit.collect::<Result<_, _>>()?;
                }
                ChangeStep::Dimmed(dimmed) => canvas.dim(&dimmed.codes, &dimmed.factors),
            }
        }
        let (fixtures, touched) = canvas.into_touched();
        let base = &self.first_layer().lights;
        let flux_dnb_w = |code: u64, radiance: f64| {
            let (column, row) = morton::decode(code);
            self.metadata.calibration * upward_flux_dnb_w(radiance, self.grid.area_m2(column, row))
        };
        let mut gone = Vec::new();
        let mut of_fixture: Vec<Vec<(u64, f32, Option<usize>)>> = vec![Vec::new(); fixtures.len()];
        for (code, lights) in &touched {
            let index = base.pixels.codes.binary_search(code).ok();
            let before = index.map(|index| base.pixels.radiance_nw_cm2_sr[index]);
            gone.extend(index);
            summary.changed_pixels += u64::from(index.is_some());
            summary.new_pixels += u64::from(index.is_none());
            summary.flux_before_dnb_w +=
                before.map_or(0.0, |radiance| flux_dnb_w(*code, f64::from(radiance)));
            for &(radiance, fixture) in lights {
                summary.flux_after_dnb_w += flux_dnb_w(*code, radiance);
                of_fixture[fixture].push((*code, radiance as f32, index));
            }
        }
        let mut layers = vec![LightLayer {
            gone: (!gone.is_empty())
                .then(|| Arc::new(GoneLights::new(&base.pyramid, base.pixels.len(), &gone))),
            ..self.first_layer().clone()
        }];
        let mut first_number = base.pixels.len();
        for (fixture, lights) in fixtures.into_iter().zip(of_fixture) {
            if lights.is_empty() {
                continue;
            }
            let first = first_number as u32;
            first_number += lights.len();
            let lights = Arc::new(self.lights_of(&lights));
            layers.push(LightLayer { lights, first_number: first, gone: None, fixture });
        }
        let mut metadata = self.metadata.clone();
        metadata.lit_pixels = layers.iter().map(|layer| layer.len() as u64).sum();
        let version = blake3::hash(format!("{} {mark}", self.metadata.version).as_bytes());
        metadata.version = version.to_hex()[..32].to_owned();
        Ok((Self { metadata, layers, ..self.clone() }, summary))
    }

    /// Lights of some pixels, ascending by code: radiance, and index in the first layer of those that it has.
    fn lights_of(&self, lights: &[(u64, f32, Option<usize>)]) -> Lights {
        let base = &self.first_layer().lights;
        let place = |code: u64| {
            let (column, row) = morton::decode(code);
            GeoPoint::from_vector(self.grid.center(column, row))
        };
        let altitude_m = |&(code, _, index): &(u64, f32, Option<usize>)| match index {
            Some(index) => base.pixels.altitude_m[index],
            None => self.terrain.ground(place(code)).altitude_m() as f32,
        };
        let pixels = LitPixels {
            codes: lights.iter().map(|light| light.0).collect(),
            radiance_nw_cm2_sr: lights.iter().map(|light| light.1).collect(),
            altitude_m: lights.iter().map(altitude_m).collect(),
        };
        let skylines = base.skylines.as_ref().map(|known| {
            let skyline = |(position, light): (usize, &(u64, f32, Option<usize>))| match light.2 {
                Some(index) => known.skyline(index),
                None => skyline_of_light(&self.terrain, &self.grid, &pixels, position),
            };
            let found: Vec<Skyline> = lights.par_iter().enumerate().map(skyline).collect();
            let mut skylines = Skylines::default();
            found.iter().for_each(|skyline| skylines.push(skyline));
            skylines
        });
        Lights::new(&self.grid, pixels, skylines, self.metadata.calibration)
    }
}

impl Canvas<'_> {
    /// Fixtures, and the pixels whose lights differ from the scene's, ascending by code, without those that went dark.
    fn into_touched(self) -> (Vec<Fixture>, Vec<(u64, Vec<PaintedLight>)>) {
        let pixels = self.light.pixels;
        let is_changed = |(code, lights): &(u64, Vec<PaintedLight>)| {
            let before = pixels.codes.binary_search(code).ok();
            match before.map(|index| f64::from(pixels.radiance_nw_cm2_sr[index])) {
                Some(before) => lights.as_slice() != [(before, 0)],
                None => !lights.is_empty(),
            }
        };
        let lit = |(code, lights): (u64, Vec<PaintedLight>)| {
            // What f32 does not hold is no light.
            (code, lights.into_iter().filter(|light| light.0 as f32 >= f32::MIN_POSITIVE).collect())
        };
        let mut touched: Vec<_> = self.pixels.into_iter().filter(is_changed).map(lit).collect();
        touched.sort_unstable_by_key(|(code, _)| *code);
        (self.fixtures, touched)
    }
}
