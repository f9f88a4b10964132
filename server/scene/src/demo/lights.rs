//! Synthetic light: a radial profile around each town, scaled by its population.
//!
//! Peak radiance and radius both grow with the cube root of the population, so that the upward flux is
//! nearly proportional to it, as found for towns in satellite images (0.4 DNB watts per inhabitant here; 0.03 in Kenya in the
//! composite of 2023). The core falls off faster than exponentially; a faint skirt of suburbs and villages surrounds it.

use super::raster_file::RasterSpec;
use super::relief::Relief;
use super::towns::{TOWNS, Town};
use skyglow_physics::GeoPoint;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::value_noise as noise;

/// A town of ten thousand: peak radiance, nW cm⁻² sr⁻¹, and radius of its core, km.
const SMALL_TOWN_PEAK_NW_CM2_SR: f64 = 20.0;
const SMALL_TOWN_RADIUS_KM: f64 = 1.2;
/// Below this a satellite sees nothing, nW cm⁻² sr⁻¹.
const DETECTION_NW_CM2_SR: f64 = 0.8;
/// Brightest the centre of a town gets, nW cm⁻² sr⁻¹.
const MAX_RADIANCE_NW_CM2_SR: f64 = 110.0;
/// The skirt's part of the peak, and its radius in radii of the core.
const SKIRT_PART: f64 = 0.02;
const SKIRT_RADII: f64 = 3.0;

/// Radiances of a raster's pixels, row by row from the north.
pub(super) fn radiances_nw_cm2_sr(spec: &RasterSpec, relief: &Relief) -> Vec<f32> {
    let mut sum = vec![0f64; spec.width * spec.height];
    for town in TOWNS {
        add_town(town, spec, &mut sum);
    }
    let texture = |(value, (latitude_deg, longitude_deg)): (&f64, (f64, f64))| {
        if *value < 0.5 * DETECTION_NW_CM2_SR {
            return 0.0;
        }
        // Built-up land is patchy, the more so away from the centre.
        let patch = noise::octaves(longitude_deg * 55.0, latitude_deg * 80.0, 4, 3);
        let contrast = 1.0 / (1.0 + value / 20.0);
        let radiance = value * (1.0 + contrast * 4.0 * (patch - 0.5)).max(0.0);
        let is_dark = radiance < DETECTION_NW_CM2_SR || relief.is_water(latitude_deg, longitude_deg);
        // Two decimals, as the products have it.
        if is_dark { 0.0 } else { ((radiance * 100.0).round() / 100.0) as f32 }
    };
    sum.iter().zip(spec.centers()).map(texture).collect()
}

fn add_town(town: &Town, spec: &RasterSpec, sum: &mut [f64]) {
    let growth = (f64::from(town.population) / 1e4).cbrt();
    let peak = (SMALL_TOWN_PEAK_NW_CM2_SR * growth).min(MAX_RADIANCE_NW_CM2_SR);
    let radius_km = SMALL_TOWN_RADIUS_KM * growth;
    // Where the skirt is lost below detection.
    let reach_km =
        SKIRT_RADII * radius_km * (SKIRT_PART * peak / (0.25 * DETECTION_NW_CM2_SR)).powf(0.25).max(1.0);
    let reach_deg = reach_km / 111.0;
    let wide_deg = reach_deg / town.latitude_deg.to_radians().cos();
    let column =
        |longitude_deg: f64| ((longitude_deg - spec.west_deg) / spec.step_deg).floor().max(0.0) as usize;
    let row = |latitude_deg: f64| ((spec.north_deg - latitude_deg) / spec.step_deg).floor().max(0.0) as usize;
    let place = |latitude_deg: f64, longitude_deg: f64| {
        GeoPoint::from_rad_unchecked(latitude_deg.to_radians(), longitude_deg.to_radians())
    };
    let frame = LocalFrame::at(place(town.latitude_deg, town.longitude_deg));
    for r in row(town.latitude_deg + reach_deg)..(row(town.latitude_deg - reach_deg) + 1).min(spec.height) {
        for c in
            column(town.longitude_deg - wide_deg)..(column(town.longitude_deg + wide_deg) + 1).min(spec.width)
        {
            let (latitude_deg, longitude_deg) = spec.center(c, r);
            let away_km =
                1e-3 * frame.bearing_to(place(latitude_deg, longitude_deg).unit_vector()).distance_m;
            let radii = away_km / radius_km;
            let core = (-radii.powf(1.3)).exp();
            let skirt = SKIRT_PART / (1.0 + (radii / SKIRT_RADII).powi(2)).powi(2);
            sum[r * spec.width + c] += peak * (core + skirt);
        }
    }
}
