//! Dual-tree sums over all lights at every place, against the direct sum over places and pixels.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use skyglow_physics::GeoPoint;
use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources};
use skyglow_scene::{
    Area, AzimuthFactor, Change, ChangeStep, Edit, Observers, PlaceKernel, PlaceLattice, RING_COUNT, Scene,
    SumWay, UniformAxis, ring_distance_m,
};

/// About what a light does to the zenith: falls ever faster with distance, less from above and behind a skyline.
fn brightening(altitude_m: f64, distance_m: f64, offset_m: f64, blocking: f64) -> f64 {
    let distance_km = distance_m.max(250.0) / 1000.0;
    let near = distance_km.powf(-1.2) / (1.0 + distance_km / 6.0).powf(1.4);
    near * (-altitude_m / 2500.0 - distance_km / 150.0).exp()
        * (1.0 + 0.3 * (offset_m / 800.0).tanh())
        * (1.0 - 0.11 * blocking)
}

fn kernel(skylines: bool) -> PlaceKernel {
    let (altitudes, offsets) =
        (UniformAxis::between(0.0, 4000.0, 250.0, 99), UniformAxis::between(-4000.0, 4000.0, 50.0, 999));
    let blocking_count = if skylines { BLOCKING_COUNT } else { 1 };
    let mut values = Vec::new();
    for altitude in 0..altitudes.count {
        for ring in 0..RING_COUNT {
            for offset in 0..offsets.count {
                let at = |blocking: usize| {
                    let (altitude_m, offset_m) = (altitudes.node_m(altitude), offsets.node_m(offset));
                    brightening(altitude_m, ring_distance_m(ring), offset_m, blocking as f64) as f32
                };
                values.extend((0..blocking_count).map(at));
            }
        }
    }
    PlaceKernel::new(altitudes, offsets, blocking_count, values).unwrap()
}

/// The same between rings, as polar grids and tables have it: linear in the logarithm of the distance.
fn on_rings(altitude_m: f64, distance_m: f64, offset_m: f64) -> f64 {
    let log = |distance_m: f64| (distance_m.max(250.0) / 250.0).ln();
    let ring = (log(distance_m) / log(300_000.0) * (RING_COUNT - 1) as f64).min((RING_COUNT - 1) as f64);
    let below = (ring as usize).min(RING_COUNT - 2);
    let [low, high] =
        [below, below + 1].map(|ring| brightening(altitude_m, ring_distance_m(ring), offset_m, 0.0));
    low + (ring - below as f64) * (high - low)
}

/// The direct sum, pixels near by split as the reference does.
fn direct_sum(scene: &Scene, place: GeoPoint, altitude_m: f64) -> f64 {
    let pixels = scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M);
    let one = |source: &skyglow_physics::PointSource| {
        source.flux_dnb_w * on_rings(altitude_m, source.distance_m, source.altitude_m - altitude_m)
    };
    point_sources(place, &pixels).iter().map(one).sum()
}

/// The sum over the polar grid, which knows skylines.
fn polar_sum(scene: &Scene, place: GeoPoint, altitude_m: f64) -> f64 {
    let polar = scene.polar_grid_with_ratio(place, true, 0.0);
    let one = |cell: &skyglow_scene::PolarCell| {
        let offset_m = f64::from(cell.altitude_m) - altitude_m;
        let distance_m = ring_distance_m(cell.ring as usize);
        f64::from(cell.flux_dnb_w) * brightening(altitude_m, distance_m, offset_m, f64::from(cell.blocking))
    };
    polar.cells.iter().map(one).sum()
}

fn sums(scene: &Scene, lattice: PlaceLattice, hides: bool) -> (Vec<f32>, Vec<f32>) {
    sums_by(SumWay::DualTree, scene, lattice, hides)
}

fn sums_by(way: SumWay, scene: &Scene, lattice: PlaceLattice, hides: bool) -> (Vec<f32>, Vec<f32>) {
    let kernels: Vec<PlaceKernel> = scene.fixtures().iter().map(|_| kernel(hides)).collect();
    let observers = everywhere(scene, lattice);
    let sums = scene.sum_at_places(&observers, &kernels, hides, way, &|_: f64| true).unwrap();
    (sums, observers.altitudes_m)
}

fn everywhere(scene: &Scene, lattice: PlaceLattice) -> Observers {
    let ground_m = scene.ground_altitudes_m(lattice);
    Observers::everywhere(lattice, ground_m.iter().map(|ground_m| ground_m + 2.0).collect())
}

/// Relative errors at places of a lattice, ascending.
fn errors(
    scene: &Scene,
    step_of_places: usize,
    hides: bool,
    reference: impl Fn(&Scene, GeoPoint, f64) -> f64,
) -> Vec<f64> {
    let lattice = scene.place_lattice(usize::MAX);
    assert_eq!(lattice.step, 1);
    let start = std::time::Instant::now();
    let (sums, altitudes_m) = sums(scene, lattice, hides);
    println!("{} places in {:.2} s", lattice.len(), start.elapsed().as_secs_f64());
    let mut errors: Vec<f64> = (0..lattice.len())
        .step_by(step_of_places)
        .filter_map(|at| {
            let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
            let expected = reference(scene, scene.pixel_center(column, row), f64::from(altitudes_m[at]));
            // Where there is nothing there is to be nothing.
            if expected == 0.0 {
                (sums[at] != 0.0).then_some(f64::INFINITY)
            } else {
                Some((f64::from(sums[at]) / expected - 1.0).abs())
            }
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize];
    println!(
        "{} places: {:.2e} median, {:.2e} 99 %, {:.2e} largest",
        errors.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    errors
}

fn assert_small(errors: &[f64], median: f64, largest: f64) {
    let (middle, last) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    assert!(middle <= median && last <= largest, "{middle} {last}");
}

/// Dual-tree sums match the direct sums over all pixels.
#[test]
fn dual_tree_sums_match_direct_sums() {
    // Mid latitudes, the antimeridian, far north.
    for (west, north) in [(36.0, 1.0), (178.7, -15.0), (20.0, 70.0)] {
        let mut raster = TestRaster::scattered(640, 500);
        raster.geotransform = [west, STEP, 0.0, north, 0.0, -STEP];
        let scene = TestStore::new().scene(&raster);
        assert_small(&errors(&scene, 9_973, false, direct_sum), 1e-3, 4e-3);
    }
}

/// Waves by the azimuth of the light sum up as they do one by one, whatever their sign.
#[test]
fn waves_match_direct_sums() {
    for (west, north) in [(36.0, 1.0), (178.7, -15.0), (20.0, 70.0)] {
        let mut raster = TestRaster::scattered(300, 260);
        raster.geotransform = [west, STEP, 0.0, north, 0.0, -STEP];
        let scene = TestStore::new().scene(&raster);
        let lattice = scene.place_lattice(usize::MAX);
        let observers = everywhere(&scene, lattice);
        for (order, to_north, to_east) in [(1u8, 1.0f32, 0.0f32), (1, 0.0, 1.0), (2, 1.0, 0.0), (2, 0.0, 1.0)]
        {
            let factor = AzimuthFactor::Wave { order, north: to_north, east: to_east };
            let kernels = [PlaceKernel::of_waves([(&kernel(false), factor)]).unwrap()];
            let sum = |way| scene.sum_at_places(&observers, &kernels, false, way, &|_: f64| true).unwrap();
            let ways = [sum(SumWay::DualTree), sum(SumWay::Convolution)];
            let mut largest = 0f64;
            for at in (0..lattice.len()).step_by(3_989) {
                let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                let (place, altitude_m) =
                    (scene.pixel_center(column, row), f64::from(observers.altitudes_m[at]));
                let pixels = scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M);
                let [mut even, mut wave] = [0.0; 2];
                for source in point_sources(place, &pixels) {
                    let offset_m = source.altitude_m - altitude_m;
                    let one = source.flux_dnb_w * on_rings(altitude_m, source.distance_m, offset_m);
                    let (sin, cos) = (f64::from(order) * source.azimuth_rad).sin_cos();
                    even += one;
                    wave += one * (f64::from(to_north) * cos + f64::from(to_east) * sin);
                }
                for sums in &ways {
                    largest = largest.max((f64::from(sums[at]) - wave).abs() / even);
                }
            }
            println!("{north} {order} {to_north}: {largest:.2e}");
            assert!(largest <= 8e-3, "{north} {order} {to_north}: {largest}");
        }
    }
}

/// A dark place far from the only town has the town's light.
#[test]
fn a_distant_town_lights_a_dark_place() {
    let raster = TestRaster::new(900, 500, |c, r| if c < 12 && r < 9 { 30.0 } else { 0.0 });
    let scene = TestStore::new().scene(&raster);
    // At 300 km it ends: what a place just there has of it hangs on which of its pixels are nearer.
    let nearer = |scene: &Scene, place: GeoPoint, altitude_m: f64| {
        let all = direct_sum(scene, place, altitude_m);
        let reach_m = MAX_SOURCE_DISTANCE_M - 10_000.0;
        if scene.source_pixels_within(place, reach_m).len() == 12 * 9 { all } else { f64::NAN }
    };
    let errors: Vec<f64> =
        errors(&scene, 1_409, false, nearer).into_iter().filter(|error| error.is_finite()).collect();
    assert!(errors.len() > 150, "{}", errors.len());
    assert_small(&errors, 2e-3, 8e-3);
}

/// The dual-tree sum holds on a projected grid and with large pixels too.
#[test]
fn projected_grids_and_large_pixels_are_summed() {
    let mut projected = TestRaster::scattered(300, 260);
    projected.geotransform = [500_000.0, 700.0, 0.0, 5_100_000.0, 0.0, -700.0];
    projected.epsg = Some(32632);
    let mut large = TestRaster::scattered(120, 90);
    large.geotransform = [10.0, 0.1, 0.0, 50.0, 0.0, -0.1];
    for raster in [projected, large] {
        let scene = TestStore::new().scene(&raster);
        assert_small(&errors(&scene, 1_009, false, direct_sum), 2e-3, 1e-2);
    }
}

#[test]
fn hills_raise_observers_and_hide_lights() {
    let test_store = TestStore::new();
    let mut hills = TestRaster::new(420, 420, |c, r| {
        let (x, y) = (c as f64 / 17.0, r as f64 / 23.0);
        900.0 + 700.0 * x.sin() * y.cos() + 250.0 * (3.1 * x + y).sin()
    });
    let step = 1.0 / 120.0;
    hills.geotransform = [36.9, step, 0.0, -0.9, 0.0, -step];
    let path = test_store.path("hills.tif");
    hills.write_f32(&path);
    let scene =
        test_store.scene_with(&TestRaster::scattered(400, 400), |options| options.terrain = vec![path]);
    assert_small(&errors(&scene, 2_503, false, direct_sum), 2e-3, 1e-2);
    let hidden = errors(&scene, 2_503, true, polar_sum);
    assert_small(&hidden, 3e-3, 2e-2);
    // Convolutions and what skylines take from them have the same sums.
    let lattice = scene.place_lattice(usize::MAX);
    let [tree, convolution] =
        [SumWay::DualTree, SumWay::Convolution].map(|way| sums_by(way, &scene, lattice, true).0);
    let mut differences: Vec<f64> = tree
        .iter()
        .zip(&convolution)
        .map(|(tree, convolution)| (f64::from(*convolution) / f64::from(*tree) - 1.0).abs())
        .collect();
    differences.sort_by(f64::total_cmp);
    assert_small(&differences, 3e-3, 3e-2);
    // The negative control: what is hidden shows.
    let seen = errors(&scene, 2_503, false, polar_sum);
    assert!(
        seen[seen.len() / 2] > 3.0 * hidden[hidden.len() / 2],
        "{} {}",
        seen[seen.len() / 2],
        hidden[hidden.len() / 2]
    );
}

#[test]
fn a_dimmed_scene_has_the_sums_of_its_own_lights() {
    let scene = TestStore::new().scene(&TestRaster::scattered(400, 300));
    let corners = [[37.3, -1.3], [38.1, -1.3], [38.1, -1.9], [37.3, -1.9], [37.3, -1.3]];
    let area = Area::Polygons(vec![vec![corners.to_vec()]]);
    let edit = Edit { area, change: Change::Alter { factor: 0.1, lamp: None, emission: None } };
    let (dimmed, _) = scene.changed(&[ChangeStep::Painted(vec![edit])], "test").unwrap();
    assert_small(&errors(&dimmed, 4_001, false, direct_sum), 1e-3, 4e-3);
    let lattice = scene.place_lattice(usize::MAX);
    let ((before, _), (after, _)) = (sums(&scene, lattice, false), sums(&dimmed, lattice, false));
    assert!(before.iter().zip(&after).all(|(before, after)| after < before));
}

/// Coarser lattices have the sums at the centres of their blocks; a dark or cancelled one has none.
#[test]
fn coarse_lattices_sum_at_block_centres() {
    let scene = TestStore::new().scene(&TestRaster::scattered(300, 200));
    let lattice = scene.place_lattice(5_000);
    assert_eq!((lattice.step, lattice.columns, lattice.rows), (4, 75, 50));
    let (sums, altitudes_m) = sums(&scene, lattice, false);
    for (column, row) in [(0u32, 0u32), (74, 49), (31, 17)] {
        let (x, y) = (f64::from(4 * column + 2), f64::from(4 * row + 2));
        let middle = place(-1.0 - STEP * y, 37.0 + STEP * x);
        let expected = direct_sum(&scene, middle, 2.0);
        let got = f64::from(sums[(row * 75 + column) as usize]);
        assert!((got / expected - 1.0).abs() < 4e-3, "{got} {expected}");
    }
    // Nobody can be where there is no altitude.
    let mut nowhere = altitudes_m.clone();
    nowhere[75 * 20..75 * 30].fill(f32::NAN);
    let (observers, tree) = (Observers::everywhere(lattice, nowhere.clone()), SumWay::DualTree);
    let parts = scene.sum_at_places(&observers, &[kernel(false)], false, tree, &|_: f64| true).unwrap();
    assert!(nowhere.iter().zip(&parts).all(|(altitude_m, sum)| altitude_m.is_nan() == sum.is_nan()));
    let observers = Observers::everywhere(lattice, altitudes_m);
    assert!(scene.sum_at_places(&observers, &[kernel(false)], false, tree, &|_: f64| false).is_none());
    let edit = Edit {
        area: Area::Polygons(vec![vec![vec![
            [36.0, -3.0],
            [39.0, -3.0],
            [39.0, 0.0],
            [36.0, 0.0],
            [36.0, -3.0],
        ]]]),
        change: Change::Alter { factor: 0.0, lamp: None, emission: None },
    };
    let (dark, _) = scene.changed(&[ChangeStep::Painted(vec![edit])], "dark").unwrap();
    let kernels: Vec<PlaceKernel> = dark.fixtures().iter().map(|_| kernel(false)).collect();
    let sums = dark.sum_at_places(&observers, &kernels, false, tree, &|_: f64| true).unwrap();
    assert!(sums.iter().all(|sum| *sum == 0.0));
}

/// A raster whose corners are off the world, in equal-area meridians that bend towards the poles: places there have no sum, and those
/// beside the edge of the world have theirs.
#[test]
fn places_off_the_world_have_no_sum() {
    let mut raster = TestRaster::scattered(240, 200);
    let step_m = 10_000.0;
    // A sinusoidal grid near 180 degrees east and 60 degrees north; beyond the edge of the world it is dark.
    for (at, value) in raster.values.iter_mut().enumerate() {
        let (x, y) = (8_900_000.0 + step_m * (at % 240) as f64, 7_600_000.0 - step_m * (at / 240) as f64);
        let edge = std::f64::consts::PI * 6_371_007.181 * (y / 6_371_007.181).cos();
        if x > edge - 2.0 * step_m {
            *value = 0.0;
        }
    }
    raster.geotransform = [8_900_000.0, step_m, 0.0, 7_600_000.0, 0.0, -step_m];
    raster.epsg = None;
    let test_store = TestStore::new();
    let path = test_store.path("light.tif");
    raster.write_f32(&path);
    let mut dataset = gdal::Dataset::open_ex(
        &path,
        gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE, ..Default::default() },
    )
    .unwrap();
    let crs = "+proj=sinu +lon_0=0 +R=6371007.181 +units=m +no_defs";
    dataset.set_spatial_ref(&gdal::spatial_ref::SpatialRef::from_proj4(crs).unwrap()).unwrap();
    dataset.close().unwrap();
    let mut options = skyglow_scene::IngestOptions::new(path);
    options.replace = true;
    let Ok(metadata) = test_store.ingest(&options) else { panic!("the raster is refused") };
    let scene = test_store.store.open(&metadata.id).unwrap();
    let lattice = scene.place_lattice(usize::MAX);
    let (sums, altitudes_m) = sums(&scene, lattice, false);
    let nowhere = sums.iter().filter(|sum| sum.is_nan()).count();
    assert!(nowhere > 100 && nowhere < sums.len() / 2, "{nowhere}");
    let mut compared = 0;
    for at in (0..lattice.len()).step_by(397) {
        assert_eq!(sums[at].is_nan(), altitudes_m[at].is_nan());
        if sums[at].is_nan() {
            continue;
        }
        let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
        let place = scene.lattice_place(lattice, column, row);
        let expected = direct_sum(&scene, place, f64::from(altitudes_m[at]));
        assert!(
            (f64::from(sums[at]) / expected - 1.0).abs() < 0.02,
            "{column} {row}: {} {expected}",
            sums[at]
        );
        compared += 1;
    }
    assert!(compared > 40, "{compared}");
}
