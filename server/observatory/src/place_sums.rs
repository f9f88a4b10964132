//! Sums over all lights at places: what the packs say each light does to a measure of the open sky, summed and blended between
//! turbidities.

use crate::{
    brightness_request::BrightnessRequest,
    error::ObservatoryError,
    influence::{InfluenceSolver, KernelOf, KernelRange, place_kernel},
    map_measure::{Sum, Table},
    observatory::Observatory,
};
use skyglow_physics::{BAND_COUNT, Fixture, GeoPoint, Horizon, Turbidity};
use skyglow_render::{RenderError, prepare::Prepared, request::RenderRequest};
use skyglow_scene::{
    Observers, PatchStore, PlaceKernel, PlaceLattice, PlaceWindow, PolarGrid, Scene, SumWay,
};
use std::sync::Arc;

/// What each light does to places, by the packs around the turbidity, and how lights are summed.
#[derive(Debug)]
pub(crate) struct Kernels {
    /// By pack, then by sum, of each kind of fixture; without packs there is no light, or no place.
    of_packs: Vec<Vec<Vec<PlaceKernel>>>,
    weights: Vec<f64>,
    sum_count: usize,
    hides: bool,
    way: SumWay,
}

impl Observatory {
    /// What the packs say each light does to places of a lattice.
    ///
    /// * `observers_m`: lowest and highest altitude of the eye over all of it, metres; None where nobody can be.
    ///
    /// # Errors
    /// As [`Observatory::brightness_in`].
    pub(crate) fn kernels(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        (lattice, observers_m): (PlaceLattice, Option<[f32; 2]>),
        way: Option<SumWay>,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Kernels, ObservatoryError> {
        let solver = self.influences.solver(&self.engine);
        let to_render = |turbidity: Turbidity| RenderRequest {
            polar: Arc::new(dark()),
            observer_altitude_m: 0.0,
            turbidity,
            scattering: request.scattering,
            cloud_base_m: request.cloud_base_m,
            emission: request.emission.mix(),
            flux_per_dnb_flux: [1.0; BAND_COUNT],
            basis: None,
        };
        let set = self.engine.table_set();
        let stencil = Prepared::new(&to_render(request.turbidity), &set)?.turbidity_stencil;
        let hides = request.terrain_hides && self.hides_lights(request.kind());
        let way = way.unwrap_or_else(|| scene.way_to_sum(lattice));
        let sums = request.measure.sums();
        let sum_count = sums.len();
        let (Some(observers_m), Some(lights_m)) = (observers_m, scene.light_altitude_range_m()) else {
            return Ok(Kernels { of_packs: Vec::new(), weights: Vec::new(), sum_count, hides, way });
        };
        let range =
            KernelRange { observers_m: observers_m.map(f64::from), lights_m: lights_m.map(f64::from) };
        let mut of_packs = Vec::new();
        for pack in stencil.nodes() {
            let at_pack =
                to_render(Turbidity::new(set.tables()[pack].turbidity).unwrap_or(request.turbidity));
            let mut of_sums = vec![Vec::new(); sum_count];
            for fixture in &scene.fixtures() {
                let (emission, flux_factor) =
                    request.emission.of_fixture(fixture).map_err(ObservatoryError::Emission)?;
                let flux_per_dnb_flux = [flux_factor; BAND_COUNT];
                let of_fixture = RenderRequest { emission, flux_per_dnb_flux, ..at_pack.clone() };
                let seen = Seen { fixture, request, range: &range, hides };
                for (kernels, kernel) in of_sums.iter_mut().zip(seen.kernels(solver, &of_fixture, &sums)?) {
                    kernels.push(kernel);
                }
            }
            of_packs.push(of_sums);
            step("kernel");
        }
        Ok(Kernels { of_packs, weights: stencil.weights().to_vec(), sum_count, hides, way })
    }
}

/// Light of one kind of fixture, what sees it, and where.
struct Seen<'a> {
    fixture: &'a Fixture,
    request: &'a BrightnessRequest,
    range: &'a KernelRange,
    hides: bool,
}

impl Seen<'_> {
    /// The kernels of some sums.
    fn kernels(
        &self,
        solver: &InfluenceSolver,
        to_render: &RenderRequest,
        sums: &[Sum],
    ) -> Result<Vec<PlaceKernel>, ObservatoryError> {
        let rule = self.fixture.light(&self.request.lamp).rule(&self.request.response);
        let mut tables: Vec<(Table, PlaceKernel)> = Vec::new();
        for (table, _) in sums.iter().flatten() {
            if tables.iter().any(|(known, _)| known == table) {
                continue;
            }
            let measure = table.weights(&Horizon::flat());
            let of = match (table, &measure) {
                (Table::Wave(order), _) => KernelOf::Wave(*order),
                (_, Some(measure)) => KernelOf::Measure(measure),
                // Only waves have no weights.
                (_, None) => continue,
            };
            tables.push((*table, place_kernel(solver, to_render, (of, &rule), self.range, self.hides)?));
        }
        let kernel = |sum: &Sum| {
            let parts = sum.iter().filter_map(|(table, factor)| {
                let (_, kernel) = tables.iter().find(|(known, _)| known == table)?;
                Some((kernel, *factor))
            });
            PlaceKernel::of_waves(parts).ok_or_else(|| {
                RenderError::BadPolarGrid { reason: "tables of one sum have other nodes".to_owned() }.into()
            })
        };
        sums.iter().map(kernel).collect()
    }
}

impl Kernels {
    /// How lights are summed.
    pub(crate) fn way(&self) -> SumWay {
        self.way
    }

    /// The sums at some places, one after the other; NaN where the altitude is, and where the store does not want them.
    ///
    /// * `observers`: in a window as of [`Scene::summed_window`].
    ///
    /// # Errors
    /// [`RenderError::Ended`] where the store cancelled it.
    pub(crate) fn sums(
        &self,
        scene: &Scene,
        observers: &Observers,
        store: &dyn PatchStore,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Vec<Vec<f32>>, ObservatoryError> {
        let mut of_packs: Vec<Vec<Vec<f32>>> = Vec::new();
        let parts = self.of_packs.len() * self.sum_count;
        for (pack, of_sums) in self.of_packs.iter().enumerate() {
            let mut of_pack = Vec::new();
            for (sum, kernels) in of_sums.iter().enumerate() {
                let part = OfPart { store, part: pack * self.sum_count + sum, parts };
                let sums = scene.sum_at_places(observers, kernels, self.hides, self.way, &part);
                of_pack.push(sums.ok_or(RenderError::Ended)?);
                step("sums");
            }
            of_packs.push(of_pack);
        }
        Ok(match of_packs.len() {
            0 => vec![
                observers.altitudes_m.iter().map(|altitude_m| altitude_m * 0.0).collect();
                self.sum_count
            ],
            1 => of_packs.swap_remove(0),
            _ => blended(&of_packs, &self.weights),
        })
    }
}

/// The patches of one part of the work among several: a sum by one pack.
struct OfPart<'a> {
    store: &'a dyn PatchStore,
    part: usize,
    parts: usize,
}

impl OfPart<'_> {
    fn number(&self, patch: u64) -> u64 {
        (self.part as u64) << 48 | patch
    }
}

impl PatchStore for OfPart<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.store.load(self.number(patch), count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        self.store.store(self.number(patch), sums, (self.part as f64 + progress) / self.parts as f64)
    }

    fn wants(&self, places: &PlaceWindow) -> bool {
        self.store.wants(places)
    }
}

/// Between packs: of the first sum the logarithms, of the others, which may be below 0, their ratios to the first. 0 where a first
/// one is not above 0.
fn blended(of_packs: &[Vec<Vec<f32>>], weights: &[f64]) -> Vec<Vec<f32>> {
    let Some(first) = of_packs.first() else { return Vec::new() };
    let (sum_count, places) = (first.len(), first.first().map_or(0, Vec::len));
    let mut blended = vec![vec![0f32; places]; sum_count];
    for place in 0..places {
        let firsts = || of_packs.iter().map(|sums| f64::from(sums[0][place]));
        if firsts().any(|first| first <= 0.0) {
            continue;
        }
        let together = firsts().zip(weights).map(|(first, weight)| weight * first.ln()).sum::<f64>().exp();
        blended[0][place] = together as f32;
        for (sum, blended) in blended.iter_mut().enumerate().skip(1) {
            let ratios = of_packs.iter().map(|sums| f64::from(sums[sum][place]) / f64::from(sums[0][place]));
            let ratio: f64 = ratios.zip(weights).map(|(ratio, weight)| weight * ratio).sum();
            blended[place] = (together * ratio) as f32;
        }
    }
    blended
}

/// A grid without light.
fn dark() -> PolarGrid {
    PolarGrid {
        observer: GeoPoint::from_rad_unchecked(0.0, 0.0),
        azimuth_start: vec![0; skyglow_scene::AZIMUTH_COLUMN_COUNT + 1],
        cells: Vec::new(),
        near: Vec::new(),
        flux_dnb_w: 0.0,
        coverage: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first sum is blended by its logarithm, others keep their ratio to it whatever their sign, and darkness stays dark.
    #[test]
    fn sums_are_blended_between_packs() {
        let of_packs = vec![
            vec![vec![1.0, 2.0, f32::NAN], vec![-0.5, 1.0, 0.0]],
            vec![vec![4.0, 0.0, 1.0], vec![-2.0; 3]],
        ];
        let blended = blended(&of_packs, &[0.5, 0.5]);
        assert!((blended[0][0] - 2.0).abs() < 1e-6 && (blended[1][0] + 1.0).abs() < 1e-6);
        assert_eq!((blended[0][1], blended[1][1]), (0.0, 0.0));
        assert!(blended[0][2].is_nan());
    }
}
