//! From a scene and changes to the layers of lights of the changed scene.

use super::canvas::{Canvas, ChangeError, PaintedLight};
use super::edits::ChangeStep;
use crate::grid::Grid;
use crate::light_layer::{LightLayer, Lights};
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::morton;
use crate::removed_lights::RemovedLights;
use crate::skyline_of_light::skyline_of_light;
use crate::skyline_tiles::TileGround;
use crate::skylines::{Skyline, Skylines};
use crate::terrain::Terrain;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use skyglow_physics::GeoPoint;
use skyglow_physics::source_pixel::upward_flux_dnb_w;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Effect of changes on a scene's lights.
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

/// The parts of a scene that changes are applied to.
pub(crate) struct Base<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) mask: &'a ValidMask,
    /// The lights of the raster.
    pub(crate) layer: &'a LightLayer,
    pub(crate) terrain: &'a Terrain,
    pub(crate) calibration: f64,
}

impl Base<'_> {
    fn tile_ground(&self) -> TileGround<'_> {
        self.layer.lights.tile_ground(self.grid, self.terrain, self.calibration)
    }

    /// The layers of lights of the scene with changes, one step after the other.
    pub(crate) fn changed(
        &self,
        steps: &[ChangeStep],
    ) -> Result<(Vec<LightLayer>, ChangeSummary), ChangeError> {
        let light = self.layer.open_light(self.grid, self.calibration);
        let mut canvas = Canvas::new(self.grid, self.mask, light, self.layer.lights.knows_skylines());
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
        let base = &self.layer.lights;
        let flux_dnb_w = |code: u64, radiance: f64| {
            let (column, row) = morton::decode(code);
            self.calibration * upward_flux_dnb_w(radiance, self.grid.area_m2(column, row))
        };
        let mut removed = Vec::new();
        let mut of_fixture: Vec<Vec<(u64, f32, Option<usize>)>> = vec![Vec::new(); fixtures.len()];
        for (code, lights) in &touched {
            let index = base.pixels.codes.binary_search(code).ok();
            let before = index.map(|index| base.pixels.radiance_nw_cm2_sr[index]);
            removed.extend(index);
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
            removed: (!removed.is_empty())
                .then(|| Arc::new(RemovedLights::new(&base.pyramid, base.pixels.len(), &removed))),
            ..self.layer.clone()
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
            layers.push(LightLayer { lights, first_number: first, removed: None, fixture });
        }
        Ok((layers, summary))
    }

    /// Altitude and skyline of new lights by code, computed once for all fixtures.
    fn new_sites(&self, touched: &[(u64, Vec<PaintedLight>)]) -> HashMap<u64, (f32, Skyline)> {
        let base = &self.layer.lights;
        let is_new = |(code, lights): &&(u64, Vec<PaintedLight>)| {
            !lights.is_empty() && base.pixels.codes.binary_search(code).is_err()
        };
        let site = |(code, _): &(u64, Vec<PaintedLight>)| {
            let (column, row) = morton::decode(*code);
            let place = GeoPoint::from_vector(self.grid.center(column, row));
            let altitude_m = self.terrain.ground(place).altitude_m() as f32;
            let pixel = LitPixels {
                codes: vec![*code].into(),
                radiance_nw_cm2_sr: vec![1.0].into(),
                altitude_m: vec![altitude_m].into(),
            };
            let skyline = match base.knows_skylines() {
                true => skyline_of_light(self.terrain, self.grid, &pixel, 0, None),
                false => Skyline::default(),
            };
            (*code, (altitude_m, skyline))
        };
        let new: Vec<&(u64, Vec<PaintedLight>)> = touched.iter().filter(is_new).collect();
        let find = || new.into_par_iter().map(site).collect();
        // On threads of their own, so that other requests are not delayed.
        match horizon_threads() {
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
        let base = &self.layer.lights;
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
        let known = |index: usize| match (&base.skylines, &base.tiles) {
            (Some(known), _) => known.skyline(index),
            (None, Some(tiles)) => tiles.skyline(&self.tile_ground(), index),
            (None, None) => Skyline::default(),
        };
        let skylines = base.knows_skylines().then(|| {
            let mut skylines = Skylines::default();
            for (code, _, index) in lights {
                skylines.push(&index.map_or_else(|| site(*code).1, known));
            }
            skylines
        });
        Lights::new(self.grid, pixels, skylines, self.calibration)
    }
}

/// Threads that compute the skylines of new lights: half of the cores; None where the system gives none.
fn horizon_threads() -> Option<&'static ThreadPool> {
    static THREADS: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let build = || {
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
        ThreadPoolBuilder::new().num_threads(cores.div_ceil(2)).build().ok()
    };
    THREADS.get_or_init(build).as_ref()
}
