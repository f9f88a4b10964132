//! A ray cut into steps (long characteristics), with all that does not depend on azimuth or on the place of the source.
//!
//! In a spherical atmosphere altitude, extinction and the local zenith angle along a ray depend on its start
//! altitude and zenith angle alone, so one list of steps serves all azimuths and all distances of the source.
//! A step adds S·(T₀ − T₁): the source function times the transmission of the air between.

use super::{
    grid::{FieldGrid, LayerStencil, LinearStencil, TOP_ALTITUDE_M},
    lanes::{Lanes, arccos, lanes_from_bands},
    optics::{SlantPath, optical_depths},
    setting::SourceSetting,
};
use crate::{
    bands::{BAND_COUNT, Band},
    geometry::EARTH_RADIUS_M,
};

/// Rays end where less than this is let through in every band.
const MIN_TRANSMISSION: f64 = 1e-4;
/// Longest step in optical depth of the thickest band.
const MAX_DEPTH: f64 = 0.5;

/// One step, at its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathStep {
    /// Arc over the ground from the start, metres at radius R.
    pub(super) arc_m: f64,
    pub(super) layer: LayerStencil,
    /// Cosine of the zenith angle of the ray here.
    pub(super) cos_zenith: f64,
    /// T at the step's start less T at its end.
    pub(super) weight: Lanes,
}

/// A surface that a ray ends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    Ground,
    /// The base of the cloud.
    Base,
}

/// Where a ray ends on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathEnd {
    pub(super) surface: Surface,
    /// Arc to there, metres.
    pub(super) arc_m: f64,
    /// What the air lets through of the light from there.
    pub(super) through: Lanes,
}

/// How long a step is and where: near the source it is not taken at its middle alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// Altitude of its middle, metres.
    altitude_m: f64,
    /// Its length, metres.
    length_m: f64,
}

/// A step counts as near the source within so many of its own lengths.
const NEAR_LENGTHS: f64 = 2.0;

impl Stretch {
    /// Whether a source `arc_m` of arc away from its middle is so near that the light along it is not that of its middle.
    #[inline(always)]
    pub(super) fn passes(&self, arc_m: f64, source_altitude_m: f64) -> bool {
        let (up_m, near_m) = (self.altitude_m - source_altitude_m, NEAR_LENGTHS * self.length_m);
        arc_m * arc_m + up_m * up_m < near_m * near_m
    }
}

/// A ray's steps, and the ground or the base of a cloud at its end if it gets there.
#[derive(Clone, Debug)]
pub(super) struct SteppedPath {
    pub(super) steps: Vec<PathStep>,
    /// Each of them, and its [`StepRule::parts`] equal parts, one step after another; both empty where there is one.
    pub(super) stretches: Vec<Stretch>,
    pub(super) parts: Vec<PathStep>,
    pub(super) end: Option<PathEnd>,
}

/// How long steps are.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepRule {
    /// First step, metres.
    pub(super) first_m: f64,
    /// Step over path so far.
    pub(super) growth: f64,
    /// Parts into which a step is cut for a source next to it.
    pub(super) parts: usize,
}

impl SteppedPath {
    /// A ray in the dark.
    pub(super) fn dark() -> Self {
        Self { steps: Vec::new(), stretches: Vec::new(), parts: Vec::new(), end: None }
    }

    /// The ray from an altitude, which is not above the base of the cloud, if there is one.
    pub(super) fn new(
        setting: &SourceSetting,
        grid: &FieldGrid,
        altitude_m: f64,
        cos_zenith: f64,
        stride: StepRule,
    ) -> Self {
        let path = SlantPath::new(altitude_m, cos_zenith);
        let ground_m = path.path_down_to_m(setting.ground_altitude_m);
        let cloud = setting.atmosphere.cloud();
        let base_m = cloud.map(|cloud| path.path_to_base_m(cloud.altitude_m()));
        let end_m = ground_m.or(base_m).unwrap_or_else(|| path.path_up_to_m(TOP_ALTITUDE_M));
        let sine = (1.0 - cos_zenith * cos_zenith).max(0.0).sqrt();
        let arc_m = |u: f64| EARTH_RADIUS_M * (u * sine).atan2(EARTH_RADIUS_M + altitude_m + u * cos_zenith);
        let thickest = Band::SHORTEST.index();
        let beta = [
            setting.atmosphere.molecule_extinction_per_m()[thickest],
            setting.atmosphere.aerosol_extinction_per_m()[thickest],
        ];
        let step_between = |from_m: f64, to_m: f64, let_through: [[f64; BAND_COUNT]; 2]| {
            let middle = path.point(0.5 * (from_m + to_m));
            let [before, after] = let_through;
            PathStep {
                arc_m: arc_m(0.5 * (from_m + to_m)),
                layer: grid.layer_stencil(middle.altitude_m),
                cos_zenith: middle.cos_zenith,
                weight: lanes_from_bands(std::array::from_fn(|b| (before[b] - after[b]).max(0.0))),
            }
        };
        let through =
            |columns_m| optical_depths(&setting.atmosphere, columns_m).map(|depth: f64| (-depth).exp());
        let (mut steps, mut stretches, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        let mut from_m = 0.0;
        let mut before = [1.0; BAND_COUNT];
        let mut here = path.point(0.0);
        while from_m < end_m {
            let extinction = beta[0] * here.density[0] + beta[1] * here.density[1];
            let mut height_m = (here.altitude_m - setting.ground_altitude_m).max(0.0);
            if let Some(cloud) = cloud {
                height_m = height_m.min((cloud.altitude_m() - here.altitude_m).max(0.0));
            }
            let rise_m = 0.4 * height_m + 120.0;
            let step_m = (stride.growth * from_m + stride.first_m)
                .min(MAX_DEPTH / extinction)
                .min(rise_m / here.cos_zenith.abs().max(1e-6));
            // No tiny step at the end.
            let to_m = if from_m + 1.3 * step_m >= end_m { end_m } else { from_m + step_m };
            let next = path.point(to_m);
            let after = through(next.columns_m);
            steps.push(step_between(from_m, to_m, [before, after]));
            if stride.parts > 1 {
                let length_m = to_m - from_m;
                stretches
                    .push(Stretch { altitude_m: path.point(from_m + 0.5 * length_m).altitude_m, length_m });
                let mut at_start = (from_m, before);
                for part in 1..=stride.parts {
                    let end_m = from_m + length_m * part as f64 / stride.parts as f64;
                    let at_end = (end_m, through(path.point(end_m).columns_m));
                    parts.push(step_between(at_start.0, end_m, [at_start.1, at_end.1]));
                    at_start = at_end;
                }
            }
            (from_m, before, here) = (to_m, after, next);
            if before.iter().all(|&t| t < MIN_TRANSMISSION) {
                return Self { steps, stretches, parts, end: None };
            }
        }
        let surface = if ground_m.is_some() { Some(Surface::Ground) } else { base_m.map(|_| Surface::Base) };
        let end = surface.map(|surface| {
            // The light of later orders comes from everywhere: by reciprocity a base sends it on as it reflects light of the other way.
            let base = cloud.filter(|_| surface == Surface::Base);
            let towards_start = base.map_or(1.0, |cloud| cloud.diffuse_share(here.cos_zenith));
            PathEnd {
                surface,
                arc_m: arc_m(end_m),
                through: lanes_from_bands(before.map(|t| t * towards_start)),
            }
        });
        Self { steps, stretches, parts, end }
    }

    /// Calls `sum` with the steps, or the parts of those next to the source. `start` is the ray's: its distance from the source's
    /// vertical [m], and cosine and sine of its azimuth from the outward direction.
    #[inline(always)]
    pub(super) fn for_each_step(
        &self,
        grid: &FieldGrid,
        source_altitude_m: f64,
        start: (f64, f64, f64),
        sum: &mut impl StepSum,
    ) {
        // The places of several steps are computed at once.
        for (block, steps) in self.steps.chunks(BLOCK).enumerate() {
            let places = Places::of(grid, start, steps);
            for (at, step) in steps.iter().enumerate() {
                let index = block * BLOCK + at;
                let stretch = self.stretches.get(index);
                if stretch.is_some_and(|stretch| stretch.passes(places.distance_m[at], source_altitude_m)) {
                    let count = self.parts.len() / self.steps.len();
                    for parts in self.parts[index * count..][..count].chunks(BLOCK) {
                        let places = Places::of(grid, start, parts);
                        for (at, part) in parts.iter().enumerate() {
                            sum.add(part, places.at(grid, at));
                        }
                    }
                } else {
                    sum.add(step, places.at(grid, at));
                }
            }
        }
    }
}

/// Receives steps. A trait and not a closure: its method can be forced inline, and code that is not inlined is not compiled
/// with the vectors of its caller.
pub(super) trait StepSum {
    /// A step and where it is.
    fn add(&mut self, step: &PathStep, at: StepPlace);
}

/// Where a step is, seen from the source's vertical.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepPlace {
    /// The rings around it; None beyond the outermost.
    pub(super) ring: Option<LinearStencil>,
    /// Cosine of the azimuth of the ray there from the outward direction.
    pub(super) cos_azimuth: f32,
    /// That azimuth, radians, to 7e-5.
    pub(super) azimuth_rad: f32,
}

/// Steps whose places are found at once.
const BLOCK: usize = 8;

/// The places of some steps.
struct Places {
    distance_m: [f64; BLOCK],
    cos_azimuth: [f32; BLOCK],
    azimuth_rad: [f32; BLOCK],
    /// As [`FieldGrid::ring_position`].
    ring: [f64; BLOCK],
}

impl Places {
    #[inline(always)]
    fn of(
        grid: &FieldGrid,
        (start_m, cos_azimuth, sin_azimuth): (f64, f64, f64),
        steps: &[PathStep],
    ) -> Self {
        let mut arc_m = [0.0; BLOCK];
        arc_m.iter_mut().zip(steps).for_each(|(arc_m, step)| *arc_m = step.arc_m);
        let mut places = Self {
            distance_m: [0.0; BLOCK],
            cos_azimuth: [0.0; BLOCK],
            azimuth_rad: [0.0; BLOCK],
            ring: [0.0; BLOCK],
        };
        for (at, &arc_m) in arc_m.iter().enumerate() {
            let (distance_m, cosine) = track(start_m, cos_azimuth, sin_azimuth, arc_m);
            places.distance_m[at] = distance_m;
            places.cos_azimuth[at] = cosine;
            places.azimuth_rad[at] = arccos(cosine);
            places.ring[at] = grid.ring_position(distance_m);
        }
        places
    }

    #[inline(always)]
    fn at(&self, grid: &FieldGrid, at: usize) -> StepPlace {
        StepPlace {
            ring: grid.between_rings(self.ring[at]),
            cos_azimuth: self.cos_azimuth[at],
            azimuth_rad: self.azimuth_rad[at],
        }
    }
}

/// Where a ray's ground track is after `arc_m`, seen from the source's vertical: distance from it [m], and the
/// cosine of the ray's azimuth there from the outward direction.
///
/// Flat: meridians converge by less than (420 km/R)²/6 = 1e-3 over the grid.
#[inline(always)]
pub(super) fn track(start_m: f64, cos_azimuth: f64, sin_azimuth: f64, arc_m: f64) -> (f64, f32) {
    let (x, y) = (start_m + arc_m * cos_azimuth, arc_m * sin_azimuth);
    let distance_m = (x * x + y * y).sqrt();
    let cosine = (x * cos_azimuth + y * sin_azimuth) / distance_m.max(1e-6);
    (distance_m, cosine as f32)
}
