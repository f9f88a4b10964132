//! Joins rasters: each has the samples around it of those that lie there.

use super::border::Border;
use super::raster::TerrainRaster;
use glam::DVec3;
use skyglow_physics::GeoPoint;

/// Gives every level of every raster the samples around it. Where several rasters lie, the first counts. The coarsest are joined first:
/// at the edge of a coarser one a finer one then sees it as it is beside the finer one.
pub(super) fn join(rasters: &mut [TerrainRaster]) {
    let caps: Vec<_> = rasters.iter().map(|raster| raster.grid().cap()).collect();
    let mut order: Vec<usize> = (0..rasters.len()).collect();
    order.sort_by(|a, b| rasters[*b].sample_size_m().total_cmp(&rasters[*a].sample_size_m()));
    for at in order {
        let (center, radius_rad) = caps[at];
        let is_near =
            |(other, other_rad): &(DVec3, f64)| center.angle_between(*other) <= radius_rad + other_rad;
        let near: Vec<&TerrainRaster> =
            rasters.iter().zip(&caps).filter(|(_, cap)| is_near(cap)).map(|(raster, _)| raster).collect();
        let borders =
            (0..rasters[at].level_count()).map(|level| border_of(&rasters[at], level, &near)).collect();
        // There may be thousands of rasters, and each would keep the tiles along its edges.
        near.iter().for_each(|raster| raster.forget_tiles());
        rasters[at].set_borders(borders);
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
                assert!(worst_rad.to_degrees() < 0.03, "{overlap} {at:?}: {}", worst_rad.to_degrees());
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

    /// Files of different resolution that meet continue a slope: 3 samples of the fine one are one of the coarse one.
    #[test]
    fn a_slope_goes_on_in_a_coarser_file() {
        let plane = |longitude_deg: f64| (30_000.0 * (longitude_deg - 7.0)) as f32;
        let axes = |west_deg: f64, step_deg: f64| GeographicAxes {
            first_longitude_deg: west_deg,
            first_latitude_deg: 46.5,
            longitude_step_deg: step_deg,
            latitude_step_deg: -step_deg,
        };
        let file = |west_deg: f64, step_deg: f64, size: u32| {
            let height_m = move |column: u32, _: u32| plane(west_deg + (f64::from(column) + 0.5) * step_deg);
            layer(Grid::geographic(axes(west_deg, step_deg), size, size), height_m)
        };
        for fine_first in [true, false] {
            let mut rasters = vec![file(7.0, 0.001, 120), file(7.12, 0.01, 12)];
            if !fine_first {
                rasters.reverse();
            }
            let terrain = Terrain::joined(rasters);
            for longitude_deg in [7.1185, 7.1195, 7.119_99, 7.120_01, 7.121, 7.123, 7.126] {
                let found_m = terrain.elevation_m(place(46.45, longitude_deg)).unwrap();
                let wanted_m = f64::from(plane(longitude_deg));
                assert!(
                    (found_m - wanted_m).abs() < 0.3,
                    "{fine_first} {longitude_deg}: {found_m} {wanted_m}"
                );
            }
        }
    }

    /// Where a finer raster differs from the one around it, half of that lies within its own edge.
    #[test]
    fn a_finer_raster_keeps_half_of_a_step() {
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
