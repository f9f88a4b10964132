//! From a scene and changes to the scene with those changes.

use super::area::{AreaError, Budget, Piece};
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
use rayon::{ThreadPool, ThreadPoolBuilder};
use skyglow_physics::source_pixel::upward_flux_dnb_w;
use skyglow_physics::{Fixture, GeoPoint, LampChange, PreservedFlux};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// Most pixels that may be lit where there was no light.
pub const MAX_NEW_LIGHTS: usize = 200_000;
/// The same where each has to look around for terrain that hides it, which takes a millisecond.
pub const MAX_NEW_LIGHTS_WITH_TERRAIN: usize = 10_000;
/// Pixels and lights that all edits together may look at, and so many more for every light of the scene: seconds.
const LOOKS: u64 = 20_000_000;
const LOOKS_PER_LIGHT: u64 = 5;
/// Most kinds of fixtures beside the scene's own: the sky of each is rendered by itself.
const MOST_FIXTURES: usize = 32;
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
    /// An area without a pixel of the scene, or to add light to, without one with data.
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
    /// Too many combinations of lamps and emissions.
    #[error("edit {number} and those before it make more than {MOST_FIXTURES} kinds of lamps and emissions")]
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
    #[error("more than {most} dark pixels would be lit")]
    TooManyNewLights {
        /// Pixels allowed.
        most: usize,
    },
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
    /// Codes of lit pixels that the scene has dark.
    new: HashSet<u64>,
    budget: Budget,
}

impl<'a> Canvas<'a> {
    fn new(scene: &'a Scene) -> Self {
        let light = scene.first_layer().light(&scene.grid, scene.metadata.calibration, false);
        let budget = Budget::new(LOOKS + LOOKS_PER_LIGHT * light.pixels.len() as u64);
        let (pixels, new) = Default::default();
        Self { scene, light, fixtures: vec![Fixture::default()], pixels, new, budget }
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
        if self.fixtures.len() > MOST_FIXTURES {
            return Err(ChangeError::TooManyFixtures { number });
        }
        self.fixtures.push(fixture);
        Ok(self.fixtures.len() - 1)
    }

    /// Paints; answers the number of lit pixels in the area.
    fn paint(&mut self, number: usize, edit: &Edit) -> Result<u64, ChangeError> {
        let pieces = edit.area.pieces().map_err(|error| ChangeError::Area { number, error })?;
        let lit = match &edit.change {
            Change::Alter { factor, lamp, emission } => {
                let codes = self.lit_codes(number, &pieces)?;
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
                                lamp.iter().for_each(|change| fixture.replace(*change));
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
                let lamps = lamp.map(|to| LampChange { from: None, to, kept: PreservedFlux::DnbFlux });
                let fixture = Fixture { lamps: lamps.into_iter().collect(), emission: *emission };
                let of = self.fixture(number, fixture)?;
                let mut lit = 0;
                for code in self.all_codes(number, &pieces)? {
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
                let looks_around = self.scene.first_layer().lights.skylines.is_some();
                let most = if looks_around { MAX_NEW_LIGHTS_WITH_TERRAIN } else { MAX_NEW_LIGHTS };
                if self.new.len() > most {
                    return Err(ChangeError::TooManyNewLights { most });
                }
                lit
            }
        };
        Ok(lit as u64)
    }

    fn put(&mut self, number: usize, code: u64, lights: Vec<PaintedLight>) -> Result<(), ChangeError> {
        if lights.iter().any(|light| light.0 > BRIGHTEST_NW_CM2_SR) {
            return Err(ChangeError::TooBright { number });
        }
        self.pixels.insert(code, lights);
        Ok(())
    }

    /// Codes of the lit pixels in an area, as painted so far, ascending.
    fn lit_codes(&mut self, number: usize, pieces: &[Piece]) -> Result<Vec<u64>, ChangeError> {
        let (grid, of) = (&self.scene.grid, &self.light.pixels.codes);
        let mut codes: Vec<u64> = Vec::new();
        let mut meets = false;
        for piece in pieces {
            piece.for_each_light(&self.light, &mut self.budget, |index| codes.push(of[index]));
            piece.for_each_pixel_under_brush(grid, &mut self.budget, |column, row| {
                meets = true;
                codes.push(morton::encode(column, row));
            });
            for &code in &self.new {
                let (column, row) = morton::decode(code);
                if piece.has(grid.center(column, row), &mut self.budget) {
                    codes.push(code);
                }
            }
            if self.budget.is_spent() {
                return Err(ChangeError::TooMuch { number });
            }
        }
        if codes.is_empty() && !meets && !self.meets_raster(pieces) {
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
    fn all_codes(&mut self, number: usize, pieces: &[Piece]) -> Result<Vec<u64>, ChangeError> {
        let (grid, mask) = (&self.scene.grid, &self.scene.mask);
        let mut codes: Vec<u64> = Vec::new();
        for piece in pieces {
            piece.for_each_pixel(grid, &mut self.budget, |column, row| {
                codes.push(morton::encode(column, row));
                true
            });
            piece.for_each_pixel_under_brush(grid, &mut self.budget, |column, row| {
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

    fn meets_raster(&mut self, pieces: &[Piece]) -> bool {
        pieces.iter().any(|piece| piece.meets(&self.scene.grid, &mut self.budget))
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
            summary.new_pixels += u64::from(index.is_none() && !lights.is_empty());
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
        let sites = self.new_sites(&touched);
        let mut first_number = base.pixels.len();
        for (fixture, lights) in fixtures.into_iter().zip(of_fixture) {
            if lights.is_empty() {
                continue;
            }
            let first = first_number as u32;
            first_number += lights.len();
            let lights = Arc::new(self.lights_of(&lights, &sites));
            layers.push(LightLayer { lights, first_number: first, gone: None, fixture });
        }
        let mut metadata = self.metadata.clone();
        metadata.lit_pixels = layers.iter().map(|layer| layer.len() as u64).sum();
        let version = blake3::hash(format!("{} {mark}", self.metadata.version).as_bytes());
        metadata.version = version.to_hex()[..32].to_owned();
        Ok((Self { metadata, layers, ..self.clone() }, summary))
    }

    /// Where new lights stand and what stands around them, by code; found once, whatever shines there.
    fn new_sites(&self, touched: &[(u64, Vec<PaintedLight>)]) -> HashMap<u64, (f32, Skyline)> {
        let base = &self.first_layer().lights;
        let is_new = |(code, lights): &&(u64, Vec<PaintedLight>)| {
            !lights.is_empty() && base.pixels.codes.binary_search(code).is_err()
        };
        let site = |(code, _): &(u64, Vec<PaintedLight>)| {
            let (column, row) = morton::decode(*code);
            let place = GeoPoint::from_vector(self.grid.center(column, row));
            let altitude_m = self.terrain.ground(place).altitude_m() as f32;
            let pixel =
                LitPixels { codes: vec![*code], radiance_nw_cm2_sr: vec![1.0], altitude_m: vec![altitude_m] };
            let skyline = match base.skylines {
                Some(_) => skyline_of_light(&self.terrain, &self.grid, &pixel, 0),
                None => Skyline::default(),
            };
            (*code, (altitude_m, skyline))
        };
        let new: Vec<&(u64, Vec<PaintedLight>)> = touched.iter().filter(is_new).collect();
        let find = || new.into_par_iter().map(site).collect();
        // Not among the threads that answer everybody else.
        match looking_around() {
            Some(threads) => threads.install(find),
            None => find(),
        }
    }

    /// Lights of some pixels, ascending by code: radiance, and index in the first layer of those that it has.
    ///
    /// * `sites`: of the others.
    fn lights_of(
        &self,
        lights: &[(u64, f32, Option<usize>)],
        sites: &HashMap<u64, (f32, Skyline)>,
    ) -> Lights {
        let base = &self.first_layer().lights;
        let site = |code: u64| sites.get(&code).copied().unwrap_or_default();
        let altitude_m = |&(code, _, index): &(u64, f32, Option<usize>)| match index {
            Some(index) => base.pixels.altitude_m[index],
            None => site(code).0,
        };
        let pixels = LitPixels {
            codes: lights.iter().map(|light| light.0).collect(),
            radiance_nw_cm2_sr: lights.iter().map(|light| light.1).collect(),
            altitude_m: lights.iter().map(altitude_m).collect(),
        };
        let skylines = base.skylines.as_ref().map(|known| {
            let mut skylines = Skylines::default();
            for (code, _, index) in lights {
                skylines.push(&index.map_or_else(|| site(*code).1, |index| known.skyline(index)));
            }
            skylines
        });
        Lights::new(&self.grid, pixels, skylines, self.metadata.calibration)
    }
}

/// Threads that look for terrain around new lights: half of the cores; None where the system gives none.
fn looking_around() -> Option<&'static ThreadPool> {
    static THREADS: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let build = || {
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
        ThreadPoolBuilder::new().num_threads(cores.div_ceil(2)).build().ok()
    };
    THREADS.get_or_init(build).as_ref()
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

#[cfg(test)]
#[path = "overlay_tests.rs"]
mod tests;
