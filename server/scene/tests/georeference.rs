//! Rasters in projections, rotated, south-up, across the antimeridian and over the pole.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};
use skyglow_physics::geometry::spherical_quadrilateral_area_m2;
use skyglow_physics::source_pixel::upward_flux_dnb_w;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// Places of pixel positions by GDAL itself.
fn places(raster: &TestRaster, positions: &[(f64, f64)]) -> Vec<GeoPoint> {
    let g = raster.geotransform;
    let reference = |epsg| {
        let mut crs = SpatialRef::from_epsg(epsg).unwrap();
        crs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
        crs
    };
    let by = CoordTransform::new(&reference(raster.epsg.unwrap()), &reference(4326)).unwrap();
    let (mut x, mut y): (Vec<f64>, Vec<f64>) =
        positions.iter().map(|(c, r)| (g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5])).unzip();
    by.transform_coords(&mut x, &mut y, &mut []).unwrap();
    x.iter()
        .zip(&y)
        .map(|(lon, lat)| GeoPoint::from_rad_unchecked(lat.to_radians(), lon.to_radians()))
        .collect()
}

/// Compares corners, areas, flux and look-ups with GDAL's own transform of every lit pixel.
fn check_against_gdal(raster: &TestRaster, around: GeoPoint, radius_m: f64) {
    let scene = TestStore::new().scene(raster);
    let (width, _) = raster.size;
    let mut pixels = scene.source_pixels_within(around, radius_m);
    let (mut flux, mut count) = (0.0, 0);
    for (index, value) in raster.values.iter().enumerate().filter(|(_, v)| **v > 0.0) {
        let (c, r) = ((index % width) as f64, (index / width) as f64);
        let corners = places(raster, &[(c, r), (c + 1.0, r), (c + 1.0, r + 1.0), (c, r + 1.0)]);
        let vectors: [_; 4] = std::array::from_fn(|i| corners[i].unit_vector());
        flux += upward_flux_dnb_w(f64::from(*value as f32), spherical_quadrilateral_area_m2(vectors));
        let center = vectors.iter().copied().sum::<glam::DVec3>().normalize();
        let nearest = pixels
            .iter()
            .enumerate()
            .min_by(|a, b| a.1.center().distance(center).total_cmp(&b.1.center().distance(center)))
            .unwrap();
        let size_m = EARTH_RADIUS_M * vectors[0].distance(vectors[2]) / 2f64.sqrt();
        for (found, expected) in nearest.1.corners.iter().zip(&vectors) {
            let miss_m = EARTH_RADIUS_M * found.distance(*expected);
            assert!(miss_m < 0.02 * size_m, "pixel {c} {r}: a corner is {miss_m} m off");
        }
        let found = scene.radiance_nw_cm2_sr(GeoPoint::from_vector(center)).unwrap();
        assert!((found - value).abs() < 1e-5 * value);
        let index = nearest.0;
        pixels.swap_remove(index);
        count += 1;
    }
    assert!(pixels.is_empty() && count == scene.metadata().lit_pixels);
    assert!((scene.metadata().report.flux_dnb_w / flux - 1.0).abs() < 1e-3, "{flux}");
    assert!((scene.polar_grid(around, false).flux_dnb_w / flux - 1.0).abs() < 1e-3);
}

#[test]
fn utm_pixels_lie_where_gdal_has_them() {
    let mut raster = TestRaster::scattered(180, 130);
    raster.epsg = Some(32632);
    raster.geotransform = [400_000.0, 500.0, 0.0, 5_150_000.0, 0.0, -500.0];
    check_against_gdal(&raster, places(&raster, &[(90.0, 65.0)])[0], 2e5);
}

/// A rotated raster and a south-up raster are read in their right places.
#[test]
fn rotated_and_south_up_rasters_are_placed() {
    let mut raster = TestRaster::scattered(90, 70);
    raster.geotransform = [37.0, 0.7 * STEP, 0.5 * STEP, -1.0, 0.4 * STEP, -0.8 * STEP];
    check_against_gdal(&raster, place(-1.1, 37.2), 2e5);
    raster.geotransform = [37.0, STEP, 0.0, -1.0, 0.0, STEP];
    check_against_gdal(&raster, place(-0.9, 37.2), 2e5);
    raster.geotransform = [37.0, -STEP, 0.0, -1.0, 0.0, -STEP];
    check_against_gdal(&raster, place(-1.1, 36.8), 2e5);
}

#[test]
fn polar_stereographic_over_the_pole_works() {
    let mut raster = TestRaster::scattered(120, 120);
    raster.epsg = Some(3413);
    raster.geotransform = [-60_000.0, 1000.0, 0.0, 60_000.0, 0.0, -1000.0];
    check_against_gdal(&raster, place(90.0, 0.0), 2e5);
    let bounds = TestStore::new().scene(&raster).metadata().bounds;
    assert_eq!((bounds[0], bounds[2], bounds[3]), (-180.0, 180.0, 90.0));
}

#[test]
fn another_datum_is_shifted_to_wgs84() {
    let mut raster = TestRaster::scattered(60, 60);
    // ED50: about a hundred metres off in Italy.
    raster.epsg = Some(4230);
    raster.geotransform = [9.0, STEP, 0.0, 45.5, 0.0, -STEP];
    check_against_gdal(&raster, place(45.4, 9.1), 2e5);
}

#[test]
fn a_wide_projection_is_kept_by_a_fine_lattice() {
    let mut raster = TestRaster::scattered(700, 500);
    for (index, value) in raster.values.iter_mut().enumerate() {
        if index % 7 != 0 {
            *value = 0.0;
        }
    }
    // LAEA Europe at 5 km: the whole continent.
    raster.epsg = Some(3035);
    raster.geotransform = [2_500_000.0, 5000.0, 0.0, 4_500_000.0, 0.0, -5000.0];
    let scene = TestStore::new().scene(&raster);
    let mut flux = 0.0;
    for (index, value) in raster.values.iter().enumerate().filter(|(_, v)| **v > 0.0) {
        let (c, r) = ((index % 700) as f64, (index / 700) as f64);
        let corners = places(&raster, &[(c, r), (c + 1.0, r), (c + 1.0, r + 1.0), (c, r + 1.0)]);
        let vectors: [_; 4] = std::array::from_fn(|i| corners[i].unit_vector());
        flux += upward_flux_dnb_w(f64::from(*value as f32), spherical_quadrilateral_area_m2(vectors));
        let center = vectors.iter().copied().sum::<glam::DVec3>().normalize();
        let found = scene.radiance_nw_cm2_sr(GeoPoint::from_vector(center)).unwrap();
        assert!((found - value).abs() < 1e-5 * value, "{c} {r}");
    }
    assert!((scene.metadata().report.flux_dnb_w / flux - 1.0).abs() < 1e-3);
}

/// Bounds across the antimeridian and of a full circle.
#[test]
fn bounds_at_the_antimeridian_and_full_circle() {
    let mut raster = TestRaster::scattered(480, 60);
    raster.geotransform = [179.0, STEP, 0.0, -17.0, 0.0, -STEP];
    let test_store = TestStore::new();
    let scene = test_store.scene(&raster);
    let [west, _, east, _] = scene.metadata().bounds;
    assert!((west - 179.0).abs() < 1e-9 && (east + 179.0).abs() < 1e-9);
    assert!(scene.contains(place(-17.1, -179.5)) && scene.contains(place(-17.1, 179.5)));
    assert!(!scene.contains(place(-17.1, 0.0)));
    // Pixel centres on the antimeridian, as EOG's global composites have them.
    raster.geotransform = [-180.5, 0.752, 0.0, 10.0, 0.0, -STEP];
    assert_eq!(test_store.scene(&raster).metadata().bounds[0], -180.0);
}
