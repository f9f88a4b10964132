//! The samples just outside of a raster, taken from the rasters that lie there: half a sample at an edge is bilinear with them, so that
//! files that meet have no seam. A raster around the whole Earth meets itself.

use super::raster::TerrainRaster;
use skyglow_physics::GeoPoint;

/// The ring of samples around a level of a raster, metres; NaN where nothing lies there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Border {
    width: usize,
    height: usize,
    /// The rows above and below, with corners, then the columns to the left and right.
    heights_m: Vec<f32>,
}

impl Border {
    /// Of stored samples; None where they are not as many as the level's size asks for.
    pub(super) fn of_samples((width, height): (usize, usize), heights_m: Vec<f32>) -> Option<Self> {
        let fits = heights_m.len() == 2 * (width + 2) + 2 * height;
        fits.then_some(Self { width, height, heights_m })
    }

    /// The heights, to store.
    pub(super) fn samples(&self) -> &[f32] {
        &self.heights_m
    }

    /// Columns and rows of the samples, in their order: −1 and the level's width and height are outside.
    fn positions((width, height): (usize, usize)) -> impl Iterator<Item = (i64, i64)> {
        let (width, height) = (width as i64, height as i64);
        let rows =
            [-1, height].into_iter().flat_map(move |row| (-1..=width).map(move |column| (column, row)));
        rows.chain([-1, width].into_iter().flat_map(move |column| (0..height).map(move |row| (column, row))))
    }

    /// A sample next to the level, metres; NaN where there is none.
    pub(super) fn height_m(&self, column: i64, row: i64) -> f32 {
        let (width, height) = (self.width as i64, self.height as i64);
        let is_near = (-1..=width).contains(&column) && (-1..=height).contains(&row);
        let line = width + 2;
        let at = match (column, row) {
            (_, -1) => column + 1,
            (_, row) if row == height => line + column + 1,
            (-1, _) => 2 * line + row,
            (column, _) if column == width => 2 * line + height + row,
            _ => return f32::NAN,
        };
        if is_near { self.heights_m[at as usize] } else { f32::NAN }
    }

    /// The samples that are no void, with their columns and rows.
    pub(super) fn known(&self) -> impl Iterator<Item = (i64, i64, f32)> {
        let all = Self::positions((self.width, self.height)).zip(&self.heights_m);
        all.filter(|(_, height_m)| height_m.is_finite())
            .map(|((column, row), &height_m)| (column, row, height_m))
    }
}

/// Gives every level of every raster the samples around it. Where several rasters lie, the first counts.
pub(super) fn join(rasters: &mut [TerrainRaster]) {
    let caps: Vec<_> = rasters.iter().map(|raster| raster.grid().cap()).collect();
    let borders: Vec<Vec<Option<Border>>> = rasters
        .iter()
        .zip(&caps)
        .map(|(raster, (center, radius_rad))| {
            let is_near = |(other, other_rad): &(glam::DVec3, f64)| {
                center.angle_between(*other) <= radius_rad + other_rad
            };
            let near: Vec<&TerrainRaster> =
                rasters.iter().zip(&caps).filter(|(_, cap)| is_near(cap)).map(|(raster, _)| raster).collect();
            let borders = (0..raster.level_count()).map(|level| border_of(raster, level, &near)).collect();
            // There may be thousands of rasters, and each would keep the tiles along its edges.
            near.iter().for_each(|raster| raster.forget_tiles());
            borders
        })
        .collect();
    for (raster, borders) in rasters.iter_mut().zip(borders) {
        raster.set_borders(borders);
    }
}

/// None where nothing lies around the raster.
fn border_of(raster: &TerrainRaster, level: usize, near: &[&TerrainRaster]) -> Option<Border> {
    let (level, size) = raster.level_size(level);
    let samples = f64::from(1u32 << level);
    let resolution_m = samples * raster.sample_size_m();
    let height_m = |(column, row): (i64, i64)| {
        let point = raster.grid().point((column as f64 + 0.5) * samples, (row as f64 + 0.5) * samples);
        let place = point.is_finite().then(|| GeoPoint::from_vector(point))?;
        near.iter().find_map(|other| other.overview_m(place, resolution_m))
    };
    let heights_m: Vec<f32> =
        Border::positions(size).map(|at| height_m(at).map_or(f32::NAN, |height_m| height_m as f32)).collect();
    let is_known = heights_m.iter().any(|height_m| height_m.is_finite());
    is_known.then(|| Border::of_samples(size, heights_m)).flatten()
}

#[cfg(test)]
mod tests {
    use super::super::elevation::Terrain;
    use super::super::synthetic_ground::{STEP_DEG, grid, hills_m, layer, place};
    use crate::grid::{GeographicAxes, Grid};
    use crate::sections::{self, Sections};

    const SIZE: u32 = 100;

    /// One raster of 200 × 200 samples, and the same in four files that meet, or overlap by a sample as those of SRTM do.
    fn whole_and_parts(overlap: u32) -> (Terrain, Terrain) {
        let hills = |west: u32, north: u32| move |column, row| hills_m(west + column, north + row, 4);
        let whole = Terrain::new(vec![layer(grid(7.0, 47.0, 2 * SIZE), hills(0, 0))]);
        let part = |(west, north): (u32, u32)| {
            let (west_deg, north_deg) =
                (7.0 + f64::from(west) * STEP_DEG, 47.0 - f64::from(north) * STEP_DEG);
            layer(grid(west_deg, north_deg, SIZE + overlap), hills(west, north))
        };
        let parts = [(0, 0), (SIZE, 0), (0, SIZE), (SIZE, SIZE)].map(part);
        (whole, Terrain::joined(parts.into()))
    }

    /// In files that meet or overlap elevations, slopes and horizons are those of one file, at the seams too, to the tenth of a metre that
    /// tiles are stored in (slopes over a sample, whose size is that of the file's middle); read back too.
    #[test]
    fn files_that_meet_have_no_seam() {
        for overlap in [0, 1] {
            let (whole, parts) = whole_and_parts(overlap);
            let bytes = sections::pack(&parts.to_sections()).unwrap();
            let read = Terrain::from_sections(&Sections::parse(&bytes).unwrap(), None).unwrap();
            for number in 0..4_000 {
                let spread =
                    |step: f64, width_deg: f64| width_deg * ((f64::from(number) * step).fract() - 0.5);
                let far = spread(0.754_877_666, 1.8);
                let near = spread(0.569_840_291, 2.5 * STEP_DEG);
                let at = if number % 2 == 0 {
                    place(46.0 + far, 8.0 + near)
                } else {
                    place(46.0 + near, 8.0 + far)
                };
                let wanted_m = whole.elevation_m(at).unwrap();
                for terrain in [&parts, &read] {
                    let found_m = terrain.elevation_m(at).unwrap();
                    assert!((found_m - wanted_m).abs() < 0.11, "{overlap} {at:?}: {found_m} {wanted_m}");
                }
                let (found, wanted) = (parts.slope(at), whole.slope(at));
                assert!(
                    (found.steepness_rad - wanted.steepness_rad).abs() < 2e-3,
                    "{overlap} {at:?}: {found:?} {wanted:?}"
                );
            }
            for at in [place(46.0, 8.0), place(46.004, 7.6), place(45.3, 8.003)] {
                let altitude_m = whole.elevation_m(at).unwrap() + 2.0;
                let [found, wanted] = [&parts, &whole].map(|terrain| terrain.horizon(at, altitude_m));
                let pairs = found.elevations_rad().iter().zip(wanted.elevations_rad());
                let worst_rad = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst_rad.to_degrees() < 0.02, "{overlap} {at:?}: {}", worst_rad.to_degrees());
            }
        }
    }

    /// Without a neighbour an edge sample reaches to the edge, as ever, and nothing is stored for it.
    #[test]
    fn a_raster_alone_keeps_its_edges() {
        let alone = |join: bool| {
            let rasters = vec![layer(grid(7.0, 47.0, SIZE), |column, row| hills_m(column, row, 4))];
            if join { Terrain::joined(rasters) } else { Terrain::new(rasters) }
        };
        let stored = [true, false].map(|join| sections::pack(&alone(join).to_sections()).unwrap());
        assert!(stored[0] == stored[1]);
        let edge = alone(true);
        let at = |longitude_deg| edge.elevation_m(place(46.495, longitude_deg)).unwrap();
        assert!((at(7.0) - at(7.005)).abs() < 1e-6);
    }

    /// A raster around the whole Earth has no seam where it meets itself.
    #[test]
    fn the_antimeridian_is_no_seam() {
        let axes = GeographicAxes {
            first_longitude_deg: -180.0,
            first_latitude_deg: 10.0,
            longitude_step_deg: 1.0,
            latitude_step_deg: -1.0,
        };
        let world = layer(Grid::geographic(axes, 360, 20), |column, _| if column == 0 { 100.0 } else { 0.0 });
        let terrain = Terrain::joined(vec![world]);
        // Sample centres are at 179.5° and −179.5°.
        for (longitude_deg, wanted_m) in
            [(179.5, 0.0), (179.75, 25.0), (-180.0, 50.0), (-179.75, 75.0), (-179.5, 100.0)]
        {
            let found_m = terrain.elevation_m(place(0.0, longitude_deg)).unwrap();
            assert!((found_m - wanted_m).abs() < 1e-3, "{longitude_deg}: {found_m}");
        }
    }

    /// Beside a coarser raster around it a finer one ends without a cliff.
    #[test]
    fn a_finer_raster_joins_the_one_around_it() {
        let fine = layer(grid(7.5, 46.5, SIZE), |_, _| 1_000.0);
        let axes = GeographicAxes {
            first_longitude_deg: 6.0,
            first_latitude_deg: 48.0,
            longitude_step_deg: 0.1,
            latitude_step_deg: -0.1,
        };
        let coarse = layer(Grid::geographic(axes, 40, 40), |_, _| 1_100.0);
        let terrain = Terrain::joined(vec![fine, coarse]);
        let at = |longitude_deg| terrain.elevation_m(place(46.0, longitude_deg)).unwrap();
        assert!((at(7.505) - 1_000.0).abs() < 1e-3 && (at(7.499) - 1_100.0).abs() < 1e-3);
        assert!((at(7.5 + 1e-9) - 1_050.0).abs() < 1e-2, "{}", at(7.5 + 1e-9));
    }
}
