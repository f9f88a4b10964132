//! Light traced through clouds: beside the solver where there are none and where they are a lid, and beside the asymptotic theory of
//! thick layers.

use super::{super::CloudMatter, *};
use crate::{
    Atmosphere, BAND_COUNT, CloudBase, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, ViewRow},
    single_source::{SourceGeometry, mixed_radiance_per_watt},
};

const BASE_M: f64 = 1_000.0;

fn setting(turbidity: f64, ground_albedo: f64) -> SourceSetting {
    let air = Atmosphere::new(Turbidity::new(turbidity).unwrap());
    SourceSetting::new(air, 0.0, 0.0, ground_albedo).unwrap()
}

fn point(distance_m: f64) -> Town {
    Town { distance_m, radius_m: 0.0, emission: EmissionMix::new([0.9, 0.1, 0.0]).unwrap() }
}

/// All orders of a point of light by the solver, mean over azimuths.
fn solved(field: &SourceField, town: &Town, elevation_rad: f64) -> f64 {
    let (air, band, azimuths) = (field.setting().atmosphere, Band::MIDDLE.index(), 12);
    let row = ViewRow::new(field, 0.0, elevation_rad).unwrap();
    let geometry =
        SourceGeometry { distance_m: town.distance_m, source_altitude_m: 0.0, observer_altitude_m: 0.0 };
    let at = |azimuth: i32| {
        let azimuth_rad = PI * (f64::from(azimuth) + 0.5) / f64::from(azimuths);
        let first: [f64; BAND_COUNT] =
            mixed_radiance_per_watt(&[air], &geometry, town.emission, azimuth_rad, elevation_rad, 1e-4);
        let later = row.radiance_per_watt(town.distance_m, azimuth_rad)[band];
        first[band] + later.iter().zip(town.emission.weights()).map(|(a, b)| a * b).sum::<f64>()
    };
    (0..azimuths).map(at).sum::<f64>() / f64::from(azimuths)
}

/// Light traced without clouds and under a closed lid is that of the solver, within 3 % and four standard errors.
#[test]
fn traced_light_agrees_with_the_solver() {
    let clear = setting(2.0, DEFAULT_GROUND_ALBEDO);
    let lid = CloudField::closed(BASE_M, CloudMatter::Lid { albedo: 0.5 }).unwrap();
    for clouds in [None, Some(lid)] {
        let cloud = clouds.as_ref().map(|_| CloudBase::lambertian(BASE_M, 0.5).unwrap());
        let under = SourceSetting { atmosphere: clear.atmosphere.under(cloud), ..clear };
        let field = SourceField::solve(under, &Resolution::coarse());
        let tracer = CloudTracer::new(clear, clouds, Band::MIDDLE, 0.0);
        for (distance_m, elevation_rad) in [(2e3, 1.5), (2e3, 0.4), (10e3, 0.8)] {
            let expected = solved(&field, &point(distance_m), elevation_rad);
            let traced = tracer.estimate(&point(distance_m), elevation_rad, 60_000, 5);
            let [error, noise] =
                [traced.radiance_per_m2_sr / expected - 1.0, traced.standard_error_per_m2_sr / expected];
            assert!(noise < 0.05, "{distance_m} {elevation_rad}: {noise}");
            assert!(error.abs() < 0.03 + 4.0 * noise, "{distance_m} {elevation_rad}: {error} {noise}");
        }
    }
}

/// A thick closed layer over even light reflects what asymptotic theory says (King 1987): 1 − K(µ)/(¾(1 − g)τ + 1.07) at the zenith,
/// with K(µ) ≈ 3/7·(1 + 2µ).
#[test]
fn thick_layers_reflect_by_asymptotic_theory() {
    let town = Town { distance_m: 0.0, radius_m: 15e3, emission: EmissionMix::lambert() };
    let flux_per_m2 = 1.0 / (PI * town.radius_m * town.radius_m);
    for optical_depth in [15.0, 40.0] {
        let clouds = CloudField::closed(1_500.0, CloudMatter::Drops { thickness_m: 300.0, optical_depth });
        let tracer = CloudTracer::new(setting(1.0, 0.0), clouds.ok(), Band::LONGEST, 0.0);
        let traced = tracer.estimate(&town, 0.5 * PI, 100_000, 3);
        let albedo = traced.radiance_per_m2_sr * PI / flux_per_m2;
        let noise = traced.standard_error_per_m2_sr * PI / flux_per_m2;
        let expected = 1.0 - 9.0 / 7.0 / (0.75 * (1.0 - DROP_ASYMMETRY) * optical_depth + 1.07);
        assert!(noise < 0.05, "{noise}");
        assert!(
            (albedo - expected).abs() < 0.03 + 4.0 * noise,
            "{optical_depth}: {albedo} {expected} {noise}"
        );
    }
}

/// Clouds without drops change nothing, half a cover is between none and all, and threads do not matter.
#[test]
fn covers_are_between_clear_and_closed() {
    let drops = |optical_depth| {
        CloudField::closed(1_500.0, CloudMatter::Drops { thickness_m: 400.0, optical_depth }).unwrap()
    };
    let clear = setting(2.5, DEFAULT_GROUND_ALBEDO);
    let zenith = |clouds: Option<CloudField>| {
        CloudTracer::new(clear, clouds, Band::MIDDLE, 0.0).estimate(&point(3e3), 0.5 * PI, 20_000, 11)
    };
    let [none, empty, half, all] =
        [None, Some(drops(0.0)), Some(drops(15.0).of_patterns(0.5, 200.0).unwrap()), Some(drops(15.0))]
            .map(zenith);
    let noise = none.standard_error_per_m2_sr.hypot(empty.standard_error_per_m2_sr);
    assert!((none.radiance_per_m2_sr - empty.radiance_per_m2_sr).abs() < 4.0 * noise);
    assert!(1.3 * none.radiance_per_m2_sr < half.radiance_per_m2_sr);
    assert!(1.3 * half.radiance_per_m2_sr < all.radiance_per_m2_sr);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| zenith(Some(drops(15.0)))), all);
}
