use super::*;
use crate::convolution::tests::{Light, Region, kernel};
use std::sync::Mutex;

/// A planet of 15″: 2.9·10⁹ pixels, with towns here and there, one of them at its eastern end.
fn planet() -> Region {
    let towns = [(86_390, 9_100), (45_000, 7_000), (45_300, 7_150), (20_000, 16_000)];
    let lights: Vec<Light> = towns
        .into_iter()
        .flat_map(|(column, row)| (0..64).map(move |at| (column + at % 8, row + at / 8, 1.0 + at as f32)))
        .filter(|(column, ..)| *column < 86_400)
        .collect();
    Region::new([-180.0, 75.0, 1.0 / 240.0], [86_400, 33_600], &lights, |_| 100.0)
}

/// Patches by their numbers, with the bits of their sums.
type StoredPatches = Vec<(u64, Vec<u32>)>;

/// The patches that are stored, by number, with the bits of their sums.
#[derive(Default)]
struct Stored(Mutex<StoredPatches>);

impl PatchStore for Stored {
    fn load(&self, _: u64, _: usize) -> Option<Vec<f32>> {
        None
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        assert!(progress > 0.0 && progress <= 1.0);
        self.0.lock().unwrap().push((patch, sums.iter().map(|sum| sum.to_bits()).collect()));
        true
    }
}

impl Stored {
    fn sorted(self) -> StoredPatches {
        let mut patches = self.0.into_inner().unwrap();
        patches.sort();
        patches
    }
}

/// Sums over the whole patches around a window, on hills that a place's column and row make.
fn sums(region: &Region, around: &PlaceWindow) -> (PlaceWindow, Vec<f32>, StoredPatches) {
    let lattice = PlaceLattice::within(region.grid.width, region.grid.height, usize::MAX);
    let step_m = region.grid.pixel_size_m();
    let window = around.of_whole_blocks(root_side(lattice, step_m), lattice);
    let eye_m = |[column, row]: [u32; 2]| 2.0 + ((column * 7 + row * 13) % 900) as f32;
    let altitudes_m = (0..window.count()).map(|number| eye_m(window.place(number))).collect();
    let observers = Observers { lattice, window, altitudes_m };
    let stored = Stored::default();
    let sums = region.with_layers(&kernel(), |layers| {
        let sources = Sources { grid: &region.grid, layers, sum: SumOf::All };
        sum(&Accumulator { sources, observers: &observers, step_m }, &stored).unwrap()
    });
    (observers.window, sums, stored.sorted())
}

/// A part of a planet's map is found by itself: for all places there would be 11 GB for their altitudes alone. A larger part has
/// the same bits in patches of the same numbers, so that one goes on where another was.
#[test]
fn a_part_of_a_planet_is_found_by_itself() {
    let planet = planet();
    for (columns, rows, is_lit) in [
        (45_010..45_074, 7_010..7_074, true),
        // From beyond the antimeridian.
        (0..64, 9_050..9_114, true),
        // In an ocean nothing shines.
        (70_000..70_064, 20_000..20_064, false),
        (86_336..86_400, 33_536..33_600, false),
    ] {
        let part = PlaceWindow { columns: columns.clone(), rows: rows.clone() };
        let larger = PlaceWindow {
            columns: columns.start.saturating_sub(130)..columns.end,
            rows: rows.start..(rows.end + 300).min(33_600),
        };
        let ((of_part, small, patches), (of_larger, large, more)) =
            (sums(&planet, &part), sums(&planet, &larger));
        assert_eq!(small.len(), of_part.count());
        assert!(of_part.count() <= 4 * 128 * 128 && of_larger.count() > of_part.count(), "{of_part:?}");
        let bits = |sums: Vec<f32>| sums.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        assert!(small.iter().all(|sum| if is_lit { *sum > 0.0 } else { *sum == 0.0 }), "{of_part:?}");
        assert_eq!(bits(of_part.cut(large, &of_larger)), bits(small));
        assert!(patches.iter().all(|patch| more.contains(patch)) && more.len() > patches.len());
    }
}

/// Beyond the reach of all lights whole patches are 0, and no number where nobody can be.
#[test]
fn darkness_is_zero() {
    let lattice = PlaceLattice::within(600, 300, usize::MAX);
    let region = Region::new([0.0, 10.0, 0.05], [600, 300], &[(5, 5, 3.0)], |_| 0.0);
    let mut observers = Observers::everywhere(lattice, vec![2.0; lattice.len()]);
    observers.altitudes_m[lattice.len() - 7] = f32::NAN;
    let step_m = region.grid.pixel_size_m();
    let sums = region.with_layers(&kernel(), |layers| {
        let sources = Sources { grid: &region.grid, layers, sum: SumOf::All };
        sum(&Accumulator { sources, observers: &observers, step_m }, &|_: f64| true).unwrap()
    });
    let reach = |number: usize| {
        let [column, row] = observers.window.place(number);
        let here = lattice.point(&region.grid, f64::from(column), f64::from(row));
        EARTH_RADIUS_M * here.distance(region.grid.center(5, 5))
    };
    for (number, sum) in sums.iter().enumerate() {
        if number == lattice.len() - 7 {
            assert!(sum.is_nan());
        } else if reach(number) > 1.001 * MAX_SOURCE_DISTANCE_M {
            assert_eq!(sum.to_bits(), 0, "{number}");
        } else if reach(number) < 0.999 * MAX_SOURCE_DISTANCE_M {
            assert!(*sum > 0.0, "{number}");
        }
    }
}
