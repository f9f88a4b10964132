//! Edits applied pixel by pixel: the lights of the touched pixels, painted over the lights of a scene.

use super::area::{AreaError, AreaPart, Budget};
use super::edits::{Change, Edit};
use crate::grid::Grid;
use crate::light_tree::LightTree;
use crate::mask::ValidMask;
use crate::morton;
use skyglow_physics::{Fixture, LampChange, PreservedFlux};
use std::collections::{HashMap, HashSet};
use thiserror::Error;

/// Maximum number of dark pixels that may be lit.
pub const MAX_NEW_LIGHTS: usize = 200_000;
/// The same where each needs a skyline, which takes a millisecond.
pub const MAX_NEW_LIGHTS_WITH_TERRAIN: usize = 10_000;
/// Pixels and lights that all edits together may test, and so many more for every light of the scene: seconds.
const MAX_TESTS: u64 = 20_000_000;
const TESTS_PER_LIGHT: u64 = 5;
/// Maximum number of fixtures in addition to the scene's own: the sky of each is rendered by itself.
const MAX_FIXTURES: usize = 32;
/// Radiance above that of any lamp, nW cm⁻² sr⁻¹.
const MAX_RADIANCE_NW_CM2_SR: f64 = 1e7;

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
    /// An area without a pixel of the scene, or to add light to, without one with data.
    #[error("edit {number} holds no pixel of the scene")]
    Outside {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// More light than any lamp has.
    #[error("edit {number} makes a pixel brighter than {MAX_RADIANCE_NW_CM2_SR} nW cm-2 sr-1")]
    TooBright {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// Too many combinations of lamps and emissions.
    #[error("edit {number} and those before it make more than {MAX_FIXTURES} kinds of lamps and emissions")]
    TooManyFixtures {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// Areas that take too long to paint.
    #[error(
        "edit {number} and those before it look at more pixels than one scenario may: paint less, or with fewer strokes"
    )]
    TooMuch {
        /// Which edit of its step, from 1.
        number: usize,
    },
    /// Too many pixels lit.
    #[error("more than {max} dark pixels would be lit")]
    TooManyNewLights {
        /// Pixels allowed.
        max: usize,
    },
}

/// A light of a pixel: radiance, nW cm⁻² sr⁻¹, and the number of its fixture.
pub(super) type PaintedLight = (f64, usize);

/// Pixels being painted.
pub(super) struct Canvas<'a> {
    grid: &'a Grid,
    mask: &'a ValidMask,
    /// Dark pixels that may be lit.
    max_new_lights: usize,
    light: LightTree<'a>,
    fixtures: Vec<Fixture>,
    /// Lights of the touched pixels by code; of the first fixture what the scene had.
    pixels: HashMap<u64, Vec<PaintedLight>>,
    /// Codes of lit pixels that the scene has dark.
    new: HashSet<u64>,
    budget: Budget,
}

impl<'a> Canvas<'a> {
    /// * `has_skylines`: whether new lights need a horizon profile, which takes a millisecond each.
    pub(super) fn new(grid: &'a Grid, mask: &'a ValidMask, light: LightTree<'a>, has_skylines: bool) -> Self {
        let budget = Budget::new(MAX_TESTS + TESTS_PER_LIGHT * light.pixels.len() as u64);
        let max_new_lights = if has_skylines { MAX_NEW_LIGHTS_WITH_TERRAIN } else { MAX_NEW_LIGHTS };
        let (pixels, new) = Default::default();
        Self { grid, mask, max_new_lights, light, fixtures: vec![Fixture::default()], pixels, new, budget }
    }

    /// The lights of a pixel, as changed so far.
    fn lights_at(&mut self, code: u64) -> &mut Vec<PaintedLight> {
        let pixels = self.light.pixels;
        self.pixels.entry(code).or_insert_with(|| match pixels.codes.binary_search(&code) {
            Ok(index) => vec![(f64::from(pixels.radiance_nw_cm2_sr[index]), 0)],
            Err(_) => Vec::new(),
        })
    }

    fn fixture(&mut self, number: usize, fixture: Fixture) -> Result<usize, ChangeError> {
        if let Some(known) = self.fixtures.iter().position(|known| *known == fixture) {
            return Ok(known);
        }
        if self.fixtures.len() > MAX_FIXTURES {
            return Err(ChangeError::TooManyFixtures { number });
        }
        self.fixtures.push(fixture);
        Ok(self.fixtures.len() - 1)
    }

    /// Applies an edit; returns the number of lit pixels in the area.
    pub(super) fn paint(&mut self, number: usize, edit: &Edit) -> Result<u64, ChangeError> {
        let parts = edit.area.parts().map_err(|error| ChangeError::Area { number, error })?;
        let lit = match &edit.change {
            Change::Alter { factor, lamp, emission } => {
                let codes = self.lit_codes(number, &parts)?;
                // A light of each fixture becomes one of another.
                let mut becomes: HashMap<usize, usize> = HashMap::new();
                for code in &codes {
                    let lights = self.lights_at(*code).clone();
                    let mut altered: Vec<PaintedLight> = Vec::with_capacity(lights.len());
                    for (radiance, of) in lights {
                        let of = match becomes.get(&of) {
                            Some(of) => *of,
                            None => {
                                let mut fixture = self.fixtures[of].clone();
                                lamp.iter().for_each(|change| fixture.replace(change.clone()));
                                fixture.emission = emission.or(fixture.emission);
                                let new = self.fixture(number, fixture)?;
                                becomes.insert(of, new);
                                new
                            }
                        };
                        match altered.iter_mut().find(|light| light.1 == of) {
                            Some(light) => light.0 += radiance * factor,
                            None => altered.push((radiance * factor, of)),
                        }
                    }
                    altered.retain(|light| light.0 > 0.0);
                    if altered.is_empty() {
                        self.new.remove(code);
                    }
                    self.put(number, *code, altered)?;
                }
                codes.len()
            }
            Change::Add { radiance_nw_cm2_sr, lamp, emission } => {
                let lamps =
                    lamp.clone().map(|to| LampChange { from: None, to, preserved: PreservedFlux::DnbFlux });
                let fixture = Fixture { lamps: lamps.into_iter().collect(), emission: *emission };
                let of = self.fixture(number, fixture)?;
                let mut lit = 0;
                for code in self.all_codes(number, &parts)? {
                    let mut lights = self.lights_at(code).clone();
                    lit += usize::from(!lights.is_empty());
                    match lights.iter_mut().find(|light| light.1 == of) {
                        Some(light) => light.0 += radiance_nw_cm2_sr,
                        None => lights.push((*radiance_nw_cm2_sr, of)),
                    }
                    if self.light.pixels.codes.binary_search(&code).is_err() {
                        self.new.insert(code);
                    }
                    self.put(number, code, lights)?;
                }
                if self.new.len() > self.max_new_lights {
                    return Err(ChangeError::TooManyNewLights { max: self.max_new_lights });
                }
                lit
            }
        };
        Ok(lit as u64)
    }

    fn put(&mut self, number: usize, code: u64, lights: Vec<PaintedLight>) -> Result<(), ChangeError> {
        if lights.iter().any(|light| light.0 > MAX_RADIANCE_NW_CM2_SR) {
            return Err(ChangeError::TooBright { number });
        }
        self.pixels.insert(code, lights);
        Ok(())
    }

    /// Codes of the lit pixels in an area, as painted so far, ascending.
    fn lit_codes(&mut self, number: usize, parts: &[AreaPart]) -> Result<Vec<u64>, ChangeError> {
        let (grid, of) = (self.grid, &self.light.pixels.codes);
        let mut codes: Vec<u64> = Vec::new();
        let mut meets = false;
        for part in parts {
            part.for_each_light(&self.light, &mut self.budget, |index| codes.push(of[index]));
            part.for_each_pixel_under_brush(grid, &mut self.budget, |column, row| {
                meets = true;
                codes.push(morton::encode(column, row));
            });
            for &code in &self.new {
                let (column, row) = morton::decode(code);
                if part.has(grid.center(column, row), &mut self.budget) {
                    codes.push(code);
                }
            }
            if self.budget.is_spent() {
                return Err(ChangeError::TooMuch { number });
            }
        }
        if codes.is_empty() && !meets && !self.meets_raster(parts) {
            return Err(ChangeError::Outside { number });
        }
        codes.sort_unstable();
        codes.dedup();
        let (painted, of) = (&self.pixels, &self.light.pixels.codes);
        codes.retain(|code| match painted.get(code) {
            Some(lights) => !lights.is_empty(),
            None => of.binary_search(code).is_ok(),
        });
        Ok(codes)
    }

    /// Codes of all pixels in an area for which the raster has data, ascending.
    fn all_codes(&mut self, number: usize, parts: &[AreaPart]) -> Result<Vec<u64>, ChangeError> {
        let (grid, mask) = (self.grid, self.mask);
        let mut codes: Vec<u64> = Vec::new();
        for part in parts {
            part.for_each_pixel(grid, &mut self.budget, |column, row| {
                codes.push(morton::encode(column, row));
                true
            });
            part.for_each_pixel_under_brush(grid, &mut self.budget, |column, row| {
                codes.push(morton::encode(column, row));
            });
            if self.budget.is_spent() {
                return Err(ChangeError::TooMuch { number });
            }
        }
        codes.sort_unstable();
        codes.dedup();
        codes.retain(|&code| {
            let (column, row) = morton::decode(code);
            mask.is_valid(column, row)
        });
        if codes.is_empty() { Err(ChangeError::Outside { number }) } else { Ok(codes) }
    }

    fn meets_raster(&mut self, parts: &[AreaPart]) -> bool {
        parts.iter().any(|part| part.meets(self.grid, &mut self.budget))
    }

    pub(super) fn dim(&mut self, codes: &[u64], factors: &[f32]) {
        for (code, factor) in codes.iter().zip(factors) {
            self.lights_at(*code).iter_mut().for_each(|light| light.0 *= f64::from(*factor));
        }
    }

    /// Fixtures, and the pixels whose lights differ from the scene's, ascending by code, without those that went dark.
    pub(super) fn into_touched(self) -> (Vec<Fixture>, Vec<(u64, Vec<PaintedLight>)>) {
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
