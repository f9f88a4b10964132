//! The log-polar grid: the light around an observer by azimuth, logarithm of distance and blocking angle, splatted linearly onto
//! its nodes (cloud-in-cell). A sky is rendered from it (`docs/model.md#polar-grid`).

use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M};
use skyglow_physics::{GeoPoint, PointSource};
use std::ops::Range;

/// Azimuth columns; column i is centred on i·360/256 degrees.
pub const AZIMUTH_COLUMN_COUNT: usize = 256;
/// Distance rings, evenly spaced in the logarithm from 250 m to 300 km.
pub const RING_COUNT: usize = 192;

/// Distance of a ring, metres: 250·1200^(ring/191).
pub fn ring_distance_m(ring: usize) -> f64 {
    let fraction = ring as f64 / (RING_COUNT - 1) as f64;
    MIN_SOURCE_DISTANCE_M * (MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M).powf(fraction)
}

/// ln of a distance [m] over 250 m, the nearest that a source counts as.
pub(crate) fn log_distance(distance_m: f64) -> f64 {
    (distance_m / MIN_SOURCE_DISTANCE_M).ln()
}

/// Light by azimuth and distance around an observer; only lit cells are stored.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarGrid {
    /// The place that it was made for.
    pub observer: GeoPoint,
    /// Cells of column i are `cells[azimuth_start[i]..azimuth_start[i + 1]]`; 257 offsets.
    pub azimuth_start: Vec<u32>,
    /// Lit cells, by column, then by ring, then by blocking angle.
    pub cells: Vec<PolarCell>,
    /// Lights under an open sky as points, in addition to their part in the cells: cells spread a light over columns and rings, which
    /// would show in the sky near its direction.
    pub near: Vec<NearLight>,
    /// Flux of all cells, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Part of the 300 km disc around the observer for which there is data, 0..=1.
    pub coverage: f64,
}

/// A point of light where it is: a piece of a pixel, a pixel, or far away a block of them. Points of one pixel come one after the
/// other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearLight {
    /// Number of its pixel in the scene, or of the first of a block.
    pub number: u32,
    /// Number of pixels that it represents, with consecutive numbers.
    pub pixel_count: u32,
    /// Radians clockwise from north, 0..=2π.
    pub azimuth_rad: f32,
    /// Distance along the ground, metres, at least 250.
    pub distance_m: f32,
    /// Altitude, metres above the sphere.
    pub altitude_m: f32,
    /// Upward flux of it that is under an open sky, DNB watts.
    pub flux_dnb_w: f32,
}

impl NearLight {
    /// None where it is not under an open sky at all, and where there is no light.
    #[inline(always)]
    pub(crate) fn of(numbers: Range<u32>, light: PlacedLight) -> Option<Self> {
        let open = 1.0 - light.blocking;
        (open > 0.0 && light.flux_dnb_w > 0.0).then(|| Self {
            number: numbers.start,
            pixel_count: numbers.end - numbers.start,
            azimuth_rad: light.azimuth_rad as f32,
            distance_m: (MIN_SOURCE_DISTANCE_M * light.log_distance.max(0.0).exp()) as f32,
            altitude_m: light.altitude_m as f32,
            flux_dnb_w: (light.flux_dnb_w * open) as f32,
        })
    }
}

/// One lit cell: the light of a column and a ring whose skyline towards the observer is at one blocking angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PolarCell {
    /// Ring index, 0..192; its distance is [`ring_distance_m`].
    pub ring: u32,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f32,
    /// Flux-weighted mean altitude of the sources, metres above the sphere.
    pub altitude_m: f32,
    /// Index of the blocking angle in [`BLOCKING_ANGLES_DEG`](skyglow_physics::blocking::BLOCKING_ANGLES_DEG), 0..8;
    /// 0 is the open sky.
    pub blocking: u32,
}

/// Flux and flux × altitude.
type Light = [f64; 2];

/// The light of one cell by the index of its blocking angle.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct BlockedCell([[f32; 2]; BLOCKING_COUNT]);

impl PolarGrid {
    /// The grid of point sources around a place, each with its place on the axis of blocking angles (the node and the
    /// weight that [`blocking_position`](skyglow_physics::blocking::blocking_position) gives, added); nearer than 250 m
    /// counts as there, beyond 300 km is left out. For measuring: a scene makes its own.
    pub fn from_sources(observer: GeoPoint, sources: impl IntoIterator<Item = (PointSource, f64)>) -> Self {
        let mut accumulator = PolarAccumulator::new();
        let sources = sources.into_iter().filter(|(s, _)| s.distance_m <= MAX_SOURCE_DISTANCE_M);
        for (number, (source, blocking)) in (0..).zip(sources) {
            let light = PlacedLight {
                azimuth_rad: source.azimuth_rad,
                log_distance: log_distance(source.distance_m),
                altitude_m: source.altitude_m,
                blocking,
                flux_dnb_w: source.flux_dnb_w,
            };
            accumulator.add(light);
            accumulator.push_near(number..number + 1, light);
        }
        accumulator.finish(observer, 1.0)
    }

    /// A grid of the lit cells of all columns.
    pub(crate) fn from_parts(
        observer: GeoPoint,
        parts: &[LitCells],
        near: Vec<NearLight>,
        flux_dnb_w: f64,
        coverage: f64,
    ) -> Self {
        let mut azimuth_start = vec![0];
        azimuth_start.extend(parts.iter().flat_map(|part| &part.counts).scan(0, |end, count| {
            *end += count;
            Some(*end)
        }));
        let cells = parts.iter().map(|part| part.cells.as_slice()).collect::<Vec<_>>().concat();
        Self { observer, azimuth_start, cells, near, flux_dnb_w, coverage }
    }

    /// Bytes of its lists of lights.
    pub fn byte_count(&self) -> usize {
        size_of_val(self.cells.as_slice()) + size_of_val(self.near.as_slice())
    }

    /// The same light, multiplied by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.cells.iter_mut().for_each(|cell| cell.flux_dnb_w *= factor as f32);
        self.near.iter_mut().for_each(|light| light.flux_dnb_w *= factor as f32);
        self.flux_dnb_w *= factor;
        self
    }
}

/// Some columns of a polar grid being filled.
pub(crate) struct PolarAccumulator {
    /// column × RING_COUNT of the first of its columns: what lies elsewhere is not added.
    first: usize,
    /// Light under an open sky, at [column × RING_COUNT + ring] from the first on.
    open: Vec<Light>,
    /// Where a cell's light behind skylines is in `blocked`, plus 1; 0 where it has none. Empty until there is some,
    /// so that a scene without skylines costs nothing.
    blocked_at: Vec<u32>,
    /// Light by the index of its blocking angle; that of index 0 stays dark here. In f32, so that a cell is one line of
    /// the processor's cache: good to 1e-6.
    blocked: Vec<BlockedCell>,
    near: Vec<NearLight>,
    /// Of all lights given to it, wherever they are.
    flux_dnb_w: f64,
    axes: PolarAxes,
}

/// A point of light where it belongs on the grid's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLight {
    /// Radians clockwise from north, 0..=2π.
    pub(crate) azimuth_rad: f64,
    /// As [`log_distance`] has it, clamped to the rings.
    pub(crate) log_distance: f64,
    /// Metres above the sphere.
    pub(crate) altitude_m: f64,
    /// The place of its skyline on the axis of blocking angles, 0..=7: the node and the weight that
    /// [`blocking_position`](skyglow_physics::blocking::blocking_position) gives, added; 0 is the open sky.
    pub(crate) blocking: f64,
    /// Upward flux, DNB watts.
    pub(crate) flux_dnb_w: f64,
}

/// Where positions lie on the grid's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolarAxes {
    columns_per_rad: f64,
    rings_per_log: f64,
}

impl PolarAxes {
    pub(crate) fn new() -> Self {
        Self {
            columns_per_rad: AZIMUTH_COLUMN_COUNT as f64 / std::f64::consts::TAU,
            rings_per_log: (RING_COUNT - 1) as f64 / (MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M).ln(),
        }
    }

    /// The two columns around an azimuth.
    #[inline(always)]
    pub(crate) fn columns(&self, azimuth_rad: f64) -> [usize; 2] {
        let first = (azimuth_rad * self.columns_per_rad) as usize;
        [first % AZIMUTH_COLUMN_COUNT, (first + 1) % AZIMUTH_COLUMN_COUNT]
    }

    /// The four places `column × RING_COUNT + ring` around a position with their weights, which sum to 1: linear in azimuth
    /// and in ln(distance). Arguments as in [`PlacedLight`].
    #[inline(always)]
    pub(crate) fn shares(&self, azimuth_rad: f64, log_distance: f64) -> [(usize, f64); 4] {
        let column = azimuth_rad * self.columns_per_rad;
        let ring = (log_distance * self.rings_per_log).clamp(0.0, (RING_COUNT - 1) as f64);
        let inner = (ring as usize).min(RING_COUNT - 2);
        let (along, out) = (column - column.floor(), ring - inner as f64);
        let [first, second] = self.columns(azimuth_rad).map(|column| column * RING_COUNT + inner);
        [
            (first, (1.0 - along) * (1.0 - out)),
            (first + 1, (1.0 - along) * out),
            (second, along * (1.0 - out)),
            (second + 1, along * out),
        ]
    }
}

/// The two blocking angles around a place on their axis with their weights, which sum to 1.
#[inline(always)]
pub(crate) fn blocking_shares(blocking: f64) -> [(usize, f64); 2] {
    let lower = (blocking as usize).min(BLOCKING_COUNT - 2);
    let up = (blocking - lower as f64).min(1.0);
    [(lower, 1.0 - up), (lower + 1, up)]
}

impl PolarAccumulator {
    /// All columns.
    pub(crate) fn new() -> Self {
        Self::of_columns(0..AZIMUTH_COLUMN_COUNT)
    }

    pub(crate) fn of_columns(columns: Range<usize>) -> Self {
        Self {
            first: columns.start * RING_COUNT,
            open: vec![[0.0; 2]; columns.len() * RING_COUNT],
            blocked_at: Vec::new(),
            blocked: Vec::new(),
            near: Vec::new(),
            flux_dnb_w: 0.0,
            axes: PolarAxes::new(),
        }
    }

    /// Spreads a point of light over the two nearest columns and the two nearest rings, linearly in azimuth
    /// and in ln(distance), and over the two nearest blocking angles, so that flux and mean position stay.
    #[inline(always)]
    pub(crate) fn add(&mut self, light: PlacedLight) {
        for (at, weight) in self.axes.shares(light.azimuth_rad, light.log_distance) {
            let flux_dnb_w = light.flux_dnb_w * weight;
            let Some(open) = self.open.get_mut(at.wrapping_sub(self.first)) else { continue };
            if light.blocking > 0.0 {
                self.add_blocked(at - self.first, light.altitude_m, light.blocking, flux_dnb_w);
            } else {
                add_light(open, flux_dnb_w, light.altitude_m);
            }
        }
        self.flux_dnb_w += light.flux_dnb_w;
    }

    /// Stores a point of light of pixels where it is under an open sky.
    #[inline(always)]
    pub(crate) fn push_near(&mut self, numbers: Range<u32>, light: PlacedLight) {
        self.near.extend(NearLight::of(numbers, light));
    }

    /// Adds light to one cell at the two blocking angles around `blocking`, above 0.
    fn add_blocked(&mut self, at: usize, altitude_m: f64, blocking: f64, flux_dnb_w: f64) {
        let [(lower, open_weight), (_, up)] = blocking_shares(blocking);
        if self.blocked_at.is_empty() {
            self.blocked_at = vec![0; self.open.len()];
            self.blocked.reserve(self.open.len() / 4);
        }
        if self.blocked_at[at] == 0 {
            self.blocked.push(BlockedCell([[0.0; 2]; BLOCKING_COUNT]));
            self.blocked_at[at] = self.blocked.len() as u32;
        }
        let BlockedCell(cell) = &mut self.blocked[self.blocked_at[at] as usize - 1];
        let (low, high) = (flux_dnb_w * open_weight, flux_dnb_w * up);
        if lower == 0 {
            add_light(&mut self.open[at], low, altitude_m);
        } else {
            add_blocked_light(&mut cell[lower], low, altitude_m);
        }
        add_blocked_light(&mut cell[lower + 1], high, altitude_m);
    }

    /// The grid of the lit cells.
    pub(crate) fn finish(self, observer: GeoPoint, coverage: f64) -> PolarGrid {
        let lit = self.lit();
        PolarGrid::from_parts(observer, &[lit], self.near, self.flux_dnb_w, coverage)
    }

    /// The lit cells of its columns.
    pub(crate) fn lit(&self) -> LitCells {
        let mut lit = LitCells { counts: Vec::with_capacity(AZIMUTH_COLUMN_COUNT), cells: Vec::new() };
        for (column, lights) in self.open.chunks_exact(RING_COUNT).enumerate() {
            let before = lit.cells.len();
            let mut keep = |ring: usize, blocking: usize, &[flux_dnb_w, flux_altitude]: &Light| {
                if flux_dnb_w > 0.0 {
                    lit.cells.push(PolarCell {
                        ring: ring as u32,
                        flux_dnb_w: flux_dnb_w as f32,
                        altitude_m: (flux_altitude / flux_dnb_w) as f32,
                        blocking: blocking as u32,
                    });
                }
            };
            for (ring, light) in lights.iter().enumerate() {
                keep(ring, 0, light);
                let blocked = self.blocked_at.get(column * RING_COUNT + ring).filter(|&&at| at > 0);
                if let Some(&at) = blocked {
                    for (blocking, light) in self.blocked[at as usize - 1].0.iter().enumerate() {
                        keep(ring, blocking, &light.map(f64::from));
                    }
                }
            }
            lit.counts.push((lit.cells.len() - before) as u32);
        }
        lit
    }
}

/// The lit cells of some columns.
pub(crate) struct LitCells {
    /// Cells of each column.
    counts: Vec<u32>,
    cells: Vec<PolarCell>,
}

fn add_light(light: &mut Light, flux_dnb_w: f64, altitude_m: f64) {
    light[0] += flux_dnb_w;
    light[1] += flux_dnb_w * altitude_m;
}

fn add_blocked_light(light: &mut [f32; 2], flux_dnb_w: f64, altitude_m: f64) {
    light[0] += flux_dnb_w as f32;
    light[1] += (flux_dnb_w * altitude_m) as f32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rings_run_from_250_m_to_300_km_by_3_8_percent() {
        assert!((ring_distance_m(0) - 250.0).abs() < 1e-9);
        assert!((ring_distance_m(RING_COUNT - 1) - 300_000.0).abs() < 1e-6);
        let step = ring_distance_m(100) / ring_distance_m(99);
        assert!((step - 1.0378).abs() < 1e-4, "{step}");
    }

    /// A source beyond 300 km is left out; one nearer than 250 m counts as at 250 m.
    #[test]
    fn distances_are_limited_to_250_m_and_300_km() {
        let here = GeoPoint::from_rad_unchecked(0.2, 0.3);
        let grid = |distance_m| {
            let source = PointSource { azimuth_rad: 1.0, distance_m, altitude_m: 40.0, flux_dnb_w: 5.0 };
            PolarGrid::from_sources(here, [(source, 0.0)])
        };
        for beyond_m in [300_000.001, 400_000.0, f64::INFINITY, f64::NAN] {
            let dark = grid(beyond_m);
            assert!(dark.cells.is_empty() && dark.flux_dnb_w == 0.0, "{beyond_m}");
        }
        assert_eq!(grid(300_000.0).flux_dnb_w, 5.0);
        assert_eq!(grid(0.0), grid(250.0));
        assert_ne!(grid(260.0), grid(250.0));
    }

    proptest! {
        /// Splatting a point of light conserves its flux, azimuth, distance, altitude and blocking angle.
        #[test]
        fn splatting_conserves_the_moments_of_a_point(
            azimuth in 0.0f64..std::f64::consts::TAU, log in 0.0f64..1.0, altitude in 0.0f64..5_000.0,
            blocking in prop_oneof![Just(0.0f64), Just(7.0), 0.0f64..7.0],
        ) {
            let distance_m = 250.0 * 1200f64.powf(log);
            let mut accumulator = PolarAccumulator::new();
            accumulator.add(PlacedLight {
                azimuth_rad: azimuth,
                log_distance: log_distance(distance_m),
                altitude_m: altitude,
                blocking,
                flux_dnb_w: 3.0,
            });
            let grid = accumulator.finish(GeoPoint::from_rad_unchecked(0.0, 0.0), 1.0);
            let (mut flux, mut east, mut north, mut ring, mut skyline) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for column in 0..AZIMUTH_COLUMN_COUNT {
                let (start, end) = (grid.azimuth_start[column], grid.azimuth_start[column + 1]);
                for cell in &grid.cells[start as usize..end as usize] {
                    let w = f64::from(cell.flux_dnb_w);
                    let angle = column as f64 * std::f64::consts::TAU / AZIMUTH_COLUMN_COUNT as f64;
                    flux += w;
                    east += w * angle.sin();
                    north += w * angle.cos();
                    ring += w * f64::from(cell.ring);
                    skyline += w * f64::from(cell.blocking);
                    prop_assert!((f64::from(cell.altitude_m) - altitude).abs() < 1e-3 * (1.0 + altitude));
                }
            }
            prop_assert!((flux - 3.0).abs() < 1e-6);
            prop_assert!((ring / flux - 191.0 * log).abs() < 1e-4);
            prop_assert!((skyline / flux - blocking).abs() < 1e-5);
            prop_assert!(grid.cells.iter().all(|cell| (f64::from(cell.blocking) - blocking).abs() < 1.0));
            let turn = (east.atan2(north) - azimuth).sin();
            prop_assert!(turn.abs() < 1e-5, "{turn}");
        }
    }
}
