use super::*;
use crate::light_pyramid::LightPyramid;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::place_kernel::{AzimuthFactor, RingPosition, UniformAxis};
use crate::polar_grid::{RING_COUNT, ring_distance_m};
use proptest::prelude::*;
use skyglow_physics::GeoPoint;
use skyglow_physics::source_pixel::point_sources;

/// Column, row and radiance.
pub(crate) type Light = (u32, u32, f32);

/// About what a light does to the zenith, by altitude of the place, distance and height of the light over the place.
pub(crate) fn kernel() -> PlaceKernel {
    let altitudes = UniformAxis::between(0.0, 1_500.0, 250.0, 99);
    let offsets = UniformAxis::between(-1_500.0, 1_500.0, 50.0, 99);
    let value = |altitude_m: f64, distance_km: f64, offset_m: f64| {
        let near = distance_km.powf(-1.2) / (1.0 + distance_km / 6.0).powf(1.4);
        near * (-altitude_m / 2500.0 - distance_km / 150.0).exp() * (1.0 + 0.3 * (offset_m / 800.0).tanh())
    };
    let mut values = Vec::new();
    for altitude in 0..altitudes.count {
        for distance_km in (0..RING_COUNT).map(|ring| ring_distance_m(ring) / 1000.0) {
            let of_offset = |at| value(altitudes.node_m(altitude), distance_km, offsets.node_m(at)) as f32;
            values.extend((0..offsets.count).map(of_offset));
        }
    }
    PlaceKernel::new(altitudes, offsets, 1, values).unwrap()
}

/// A raster with its lights, at whose every pixel there is a place on ground of the altitude of the lights there.
pub(crate) struct Region {
    pub(crate) grid: Grid,
    pixels: LitPixels,
    ground_m: fn(u32) -> f32,
}

impl Region {
    pub(crate) fn new(
        [longitude_deg, latitude_deg, step_deg]: [f64; 3],
        [width, height]: [u32; 2],
        lights: &[Light],
        ground_m: fn(u32) -> f32,
    ) -> Self {
        let axes = GeographicAxes {
            first_longitude_deg: longitude_deg,
            first_latitude_deg: latitude_deg,
            longitude_step_deg: step_deg,
            latitude_step_deg: -step_deg,
        };
        let mut pixels = LitPixels::default();
        for &(column, row, radiance) in lights {
            pixels.codes.push(morton::encode(column, row));
            pixels.radiance_nw_cm2_sr.push(radiance);
            pixels.altitude_m.push(ground_m(column));
        }
        pixels.sort();
        Self { grid: Grid::geographic(axes, width, height), pixels, ground_m }
    }

    /// Something made of its sums.
    fn with<T>(&self, make: impl FnOnce(&Convolution<'_>) -> T) -> T {
        self.with_kernel(&kernel(), make)
    }

    fn with_kernel<T>(&self, kernel: &PlaceKernel, make: impl FnOnce(&Convolution<'_>) -> T) -> T {
        let lattice = PlaceLattice::within(self.grid.width, self.grid.height, usize::MAX);
        let altitudes_m: Vec<f32> = (0..lattice.len()).map(|at| self.eye_m(at)).collect();
        self.with_layers(kernel, |layers| {
            make(&Convolution::new(&self.grid, layers, lattice, &altitudes_m).unwrap())
        })
    }

    /// Something made of its lights.
    pub(crate) fn with_layers<T>(
        &self,
        kernel: &PlaceKernel,
        make: impl FnOnce(&[(LightTree<'_>, &PlaceKernel)]) -> T,
    ) -> T {
        let pyramid = LightPyramid::build(&self.grid, &self.pixels, None, 1.0);
        let tree = LightTree {
            grid: &self.grid,
            pixels: &self.pixels,
            pyramid: &pyramid,
            calibration: 1.0,
            skylines: None,
            removed: None,
            first_number: 0,
        };
        make(&[(tree, kernel)])
    }

    fn eye_m(&self, place: usize) -> f32 {
        (self.ground_m)(place as u32 % self.grid.width) + 2.0
    }

    fn sums(&self) -> Vec<f32> {
        self.with(|convolution| convolution.sum(&|_: f64| true).unwrap())
    }

    /// Over all lights one by one, pixels near by split as the reference does.
    fn direct_sum(&self, place: usize, kernel: &PlaceKernel) -> f64 {
        let width = self.grid.width;
        let here = GeoPoint::from_vector(self.grid.center(place as u32 % width, place as u32 / width));
        let eye_m = self.eye_m(place);
        let lights: Vec<_> =
            (0..self.pixels.len()).map(|light| self.pixels.source_pixel(&self.grid, 1.0, light)).collect();
        let (below, up) = kernel.altitudes().position(eye_m);
        let one = |source: &skyglow_physics::PointSource| {
            let ring = RingPosition::of_square((source.distance_m as f32).powi(2)).unwrap();
            let (sin, cos) = source.azimuth_rad.sin_cos();
            let towards = glam::DVec2::new(sin, cos).as_vec2();
            let at = |node| kernel.at(node, ring, source.altitude_m as f32 - eye_m, 0.0, towards);
            source.flux_dnb_w * f64::from(at(below) + up * (at(below + 1) - at(below)))
        };
        point_sources(here, &lights).iter().map(one).sum()
    }
}

/// Lit pixels by a hash of their number.
fn scattered(width: u32, height: u32) -> Vec<Light> {
    let hash = |at: u32| u64::from(at + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33;
    let lit = (0..width * height).filter(|at| hash(*at).is_multiple_of(29));
    lit.map(|at| (at % width, at / width, 0.5 + (hash(at) / 29 % 400) as f32 / 10.0)).collect()
}

/// On one altitude and on two, at pixels and at coarser cells, sums are those over all lights one by one.
#[test]
fn convolutions_match_direct_sums() {
    let kernel = kernel();
    let two: fn(u32) -> f32 = |column| if column / 20 % 2 == 0 { 0.0 } else { 900.0 };
    for (ground_m, latitude_deg, step_deg, most) in [
        ((|_| 0.0) as fn(u32) -> f32, 1.0, 0.02, 4e-3),
        (|_| 0.0, 68.0, 0.02, 4e-3),
        (two, 47.0, 0.02, 1e-2),
        (two, 47.0, 1.0 / 240.0, 1e-2),
    ] {
        let region = Region::new([20.0, latitude_deg, step_deg], [160, 150], &scattered(160, 150), ground_m);
        let sums = region.sums();
        let mut errors: Vec<f64> = (0..sums.len())
            .step_by(97)
            .map(|place| (f64::from(sums[place]) / region.direct_sum(place, &kernel) - 1.0).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        println!("{latitude_deg} {step_deg}: {median:.2e} median, {largest:.2e} largest");
        assert!(median <= 0.25 * most && largest <= most, "{latitude_deg} {step_deg}: {median} {largest}");
    }
}

/// Waves by the azimuth of the light sum up as they do one by one, whatever their sign, to a part of the sum without waves.
#[test]
fn waves_match_direct_sums() {
    let even = kernel();
    for (order, north, east) in [(1, 1.0, 0.0), (1, 0.0, 1.0), (2, 1.0, 0.0), (2, 0.0, 1.0)] {
        let factor = AzimuthFactor::Wave { order, north, east };
        let wave = PlaceKernel::of_waves([(&even, factor)]).unwrap();
        for (latitude_deg, step_deg) in [(47.0, 0.02), (65.0, 0.02), (47.0, 1.0 / 240.0)] {
            let lights = scattered(160, 150);
            let region = Region::new([20.0, latitude_deg, step_deg], [160, 150], &lights, |_| 0.0);
            let sums = region.with_kernel(&wave, |convolution| convolution.sum(&|_: f64| true).unwrap());
            let error = |place: usize| {
                (f64::from(sums[place]) - region.direct_sum(place, &wave)).abs()
                    / region.direct_sum(place, &even)
            };
            let largest = (0..sums.len()).step_by(97).map(error).fold(0.0, f64::max);
            println!("{order} {north} {latitude_deg} {step_deg}: {largest:.2e}");
            assert!(largest <= 8e-3, "{order} {north} {latitude_deg} {step_deg}: {largest}");
        }
    }
}

/// Sums in several strips are those in one, up to the rows that rows of cells take their metres from: in either they are right to
/// 0.06 % of the metres across.
#[test]
fn strips_have_no_seams() {
    let region =
        Region::new([20.0, 61.0, 0.01], [50, 530], &scattered(50, 530), |column| 8.0 * column as f32);
    region.with(|convolution| {
        let strips = convolution.sum(&|_: f64| true).unwrap();
        let whole = TargetRange { columns: 0..50, rows: 0..530 };
        let one = convolution.strip(&convolution.band_sums(), &whole);
        for (place, (a, b)) in strips.iter().zip(&one).enumerate() {
            assert!((a / b - 1.0).abs() < 1e-3, "{place}: {a} {b}");
        }
    });
}

/// A raster over 180 degrees, and one around the Earth, have the sums of any other.
#[test]
fn the_antimeridian_is_no_edge() {
    let lights = scattered(90, 60);
    let at =
        |longitude_deg: f64| Region::new([longitude_deg, -15.0, 0.02], [90, 60], &lights, |_| 0.0).sums();
    for (across, elsewhere) in at(179.2).iter().zip(at(20.0)) {
        assert!((across / elsewhere - 1.0).abs() < 1e-5, "{across} {elsewhere}");
    }
    let around = Region::new([-180.0, 2.5, 0.25], [1440, 20], &[(0, 10, 5.0)], |_| 0.0).sums();
    let row = &around[10 * 1440..11 * 1440];
    assert!(row[1] > 0.0 && row[720] == 0.0);
    for (east, west) in [(1, 1439), (2, 1438), (8, 1432)] {
        assert!((row[east] / row[west] - 1.0).abs() < 1e-4, "{} {}", row[east], row[west]);
    }
}

#[test]
fn a_store_cancels_and_knows_strips() {
    struct Known;
    impl PatchStore for Known {
        fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
            (patch == 0).then(|| vec![7.0; count])
        }
        fn store(&self, patch: u64, _: &[f32], progress: f64) -> bool {
            patch == 1 && progress == 1.0
        }
    }
    let region = Region::new([20.0, 1.0, 0.02], [10, 300], &scattered(10, 300), |_| 0.0);
    region.with(|convolution| {
        assert!(convolution.sum(&|_: f64| false).is_none());
        let sums = convolution.sum(&Known).unwrap();
        assert!(sums[..2_560].iter().all(|sum| *sum == 7.0));
        assert!(sums[2_560..].iter().all(|sum| *sum != 7.0) && sums.len() == 3_000);
    });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// The sums of all lights are the sums of some and of the others, and never below 0.
    #[test]
    fn sums_are_linear_and_not_negative(
        lights in prop::collection::btree_map((0u32..30, 0u32..24), 0.1f32..50.0, 2..40), some in 1usize..39,
    ) {
        let lights: Vec<Light> = lights.into_iter().map(|((column, row), light)| (column, row, light)).collect();
        let some = some.min(lights.len() - 1);
        let ground_m: fn(u32) -> f32 = |_| 130.0;
        let sums = |lights: &[Light]| Region::new([20.0, 40.0, 0.05], [30, 24], lights, ground_m).sums();
        let (all, first, rest) = (sums(&lights), sums(&lights[..some]), sums(&lights[some..]));
        for ((all, first), rest) in all.iter().zip(first).zip(rest) {
            prop_assert!(*all >= 0.0 && first >= 0.0 && rest >= 0.0);
            prop_assert!((all - first - rest).abs() <= 1e-4 * all, "{} {} {}", all, first, rest);
        }
    }
}
