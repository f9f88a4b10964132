//! Towns of a made-up planet. Their sizes follow a power law (Zipf: how many are larger than a size is inverse to it), they lie
//! on land, in clusters, and shine most in their middle.

use super::geotiff::GlobalGrid;
use super::relief::{REGION_DEG, Relief};
use skyglow_physics::value_noise::octaves;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::f64::consts::{PI, TAU};

/// All light within this of the region's middle is the same in every size, km.
pub(super) const REGION_RADIUS_KM: f64 = 400.0;
/// Lit pixels that a town has, at least and at most.
const TOWN_PIXELS: [f64; 2] = [4.0, 30_000.0];
/// No town has its middle higher, metres.
const HIGHEST_TOWN_M: f64 = 2_500.0;
/// A town reaches farther than the circle of its area by this factor at most.
const RAGGED: f64 = 1.4;
/// Seed of the region's own towns.
const REGION_SEED: u64 = 4_608;
/// Places that are tried for a town before the planet counts as full.
const MAX_TRIES: u64 = 100_000;

/// The middle of the region that is the same in every size.
pub(super) fn region_middle() -> GeoPoint {
    GeoPoint::from_rad_unchecked(REGION_DEG[0].to_radians(), REGION_DEG[1].to_radians())
}

/// Repeatable numbers (SplitMix64; Steele et al. 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In 0..1.
    fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A town.
struct Town {
    /// Middle, in columns and rows.
    at: [f64; 2],
    /// Radius of the circle of its area, metres.
    radius_m: f64,
    peak_nw_cm2_sr: f64,
    seed: u64,
}

/// All towns, by the rows that they reach.
pub(super) struct TownMap {
    grid: GlobalGrid,
    towns: Vec<Town>,
    /// Numbers of the towns that reach a row, for blocks of [`ROWS`] rows.
    by_rows: Vec<Vec<u32>>,
}

/// Rows of a block of `by_rows`.
const ROWS: u32 = 64;

impl TownMap {
    /// Towns of so many pixels together, some of them in the region that is the same in every size.
    ///
    /// Fails where the region alone has more, and where the land is full.
    pub(super) fn new(
        grid: GlobalGrid,
        relief: &Relief,
        lit: u64,
        region_lit: u64,
        seed: u64,
    ) -> Result<Self, String> {
        let others = lit.checked_sub(region_lit).ok_or("--lit is less than --region-lit")?;
        let middle = region_middle();
        let region = |numbers: &mut Numbers| {
            let distance_m = 1e3 * REGION_RADIUS_KM * numbers.part().sqrt();
            middle.destination(TAU * numbers.part(), distance_m)
        };
        let anywhere = |numbers: &mut Numbers| loop {
            let latitude_rad = (2.0 * numbers.part() - 1.0).asin();
            let place = GeoPoint::from_rad_unchecked(latitude_rad, TAU * numbers.part());
            // No town outside reaches into the region.
            let reach_m = 1e3 * REGION_RADIUS_KM + grid.pixel_m() * RAGGED * (TOWN_PIXELS[1] / PI).sqrt();
            if place.unit_vector().angle_between(middle.unit_vector()) * EARTH_RADIUS_M > reach_m {
                return place;
            }
        };
        let mut towns = Vec::new();
        fill(&mut towns, grid, relief, region_lit, Numbers(REGION_SEED), region)?;
        fill(&mut towns, grid, relief, others, Numbers(seed), anywhere)?;
        let mut by_rows = vec![Vec::new(); grid.height.div_ceil(ROWS) as usize];
        for (number, town) in (0..).zip(&towns) {
            let [first, last] = town.rows(grid);
            for block in first / ROWS..=last / ROWS {
                by_rows[block as usize].push(number);
            }
        }
        Ok(Self { grid, towns, by_rows })
    }

    pub(super) fn len(&self) -> usize {
        self.towns.len()
    }

    /// Lights the pixels of some whole rows; where towns meet the brighter counts.
    pub(super) fn paint(&self, first_row: u32, radiances: &mut [f32]) {
        let width = self.grid.width as usize;
        let rows = (radiances.len() / width) as u32;
        let blocks = first_row / ROWS..=(first_row + rows - 1) / ROWS;
        let mut numbers: Vec<u32> = self.by_rows[*blocks.start() as usize..=*blocks.end() as usize].concat();
        numbers.sort_unstable();
        numbers.dedup();
        for number in numbers {
            let town = &self.towns[number as usize];
            let [first, last] = town.rows(self.grid);
            for row in first.max(first_row)..=last.min(first_row + rows - 1) {
                let line = &mut radiances[(row - first_row) as usize * width..][..width];
                town.paint(self.grid, row, line);
            }
        }
    }
}

/// Adds towns of so many pixels together.
fn fill(
    towns: &mut Vec<Town>,
    grid: GlobalGrid,
    relief: &Relief,
    lit: u64,
    mut numbers: Numbers,
    place: impl Fn(&mut Numbers) -> GeoPoint,
) -> Result<(), String> {
    let mut left = lit as f64;
    while left > 0.0 {
        let [least, most] = TOWN_PIXELS;
        let pixels = (1.0 / (1.0 / least - numbers.part() * (1.0 / least - 1.0 / most))).min(left.max(1.0));
        let mut tries = 0..MAX_TRIES;
        let found = tries.find_map(|_| {
            let place = place(&mut numbers);
            let (latitude_deg, longitude_deg) = (place.latitude_deg(), place.longitude_deg());
            // People live where others do.
            let density = octaves((longitude_deg + 180.0) / 2.0, (latitude_deg + 90.0) / 2.0, 4, 503);
            let altitude_m = relief.altitude_m(latitude_deg, longitude_deg);
            let is_home = numbers.part() < (1.4 * density).powi(4)
                && altitude_m > 0.0
                && altitude_m < HIGHEST_TOWN_M
                && latitude_deg.abs() < 72.0;
            is_home.then_some([latitude_deg, longitude_deg])
        });
        let [latitude_deg, longitude_deg] = found.ok_or("there is no land left for towns")?;
        let pixel_m2 = grid.pixel_m().powi(2) * latitude_deg.to_radians().cos();
        towns.push(Town {
            at: grid.position(latitude_deg, longitude_deg),
            radius_m: (pixels * pixel_m2 / PI).sqrt(),
            peak_nw_cm2_sr: 4.0 * pixels.cbrt().min(40.0),
            seed: numbers.next() >> 16,
        });
        left -= pixels;
    }
    Ok(())
}

impl Town {
    /// First and last row that it may reach.
    fn rows(&self, grid: GlobalGrid) -> [u32; 2] {
        let reach = RAGGED * self.radius_m / grid.pixel_m() + 1.0;
        [self.at[1] - reach, self.at[1] + reach].map(|row| (row.max(0.0) as u32).min(grid.height - 1))
    }

    /// Lights its pixels of a row. The pixel in its middle is always lit.
    fn paint(&self, grid: GlobalGrid, row: u32, line: &mut [f32]) {
        let pixel_m = grid.pixel_m();
        let wide_m = pixel_m * grid.latitude_deg(row).to_radians().cos().max(0.05);
        let north_m = (f64::from(row) + 0.5 - self.at[1]) * pixel_m;
        let reach = RAGGED * self.radius_m / wide_m + 1.0;
        let first = (self.at[0] - reach).max(0.0) as usize;
        let last = ((self.at[0] + reach) as usize).min(line.len() - 1);
        for (column, radiance) in line.iter_mut().enumerate().take(last + 1).skip(first) {
            let east_m = (column as f64 + 0.5 - self.at[0]) * wide_m;
            let grain_m = (0.5 * self.radius_m).max(1.0);
            let edge = 0.6 + 0.8 * octaves(east_m / grain_m + 64.0, north_m / grain_m + 64.0, 2, self.seed);
            let out = east_m.hypot(north_m) / (self.radius_m * edge);
            let is_middle = row == self.at[1] as u32 && column == self.at[0] as usize;
            if out < 1.0 || is_middle {
                let light = 0.5 + self.peak_nw_cm2_sr * (1.0 - out * out).max(0.0).powf(1.5);
                *radiance = radiance.max(light as f32);
            }
        }
    }
}
