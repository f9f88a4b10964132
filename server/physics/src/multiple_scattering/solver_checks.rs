//! Checks of the solver that hold under a clear sky and below clouds alike.

use super::{
    SourceField, SourceSetting, ViewRow,
    monte_carlo::{Detector, Estimate, ForwardTracer, Tracer},
};
use crate::{
    BAND_COUNT, Band, LOBE_COUNT,
    single_source::{SourceGeometry, radiance_per_watt_of},
};

/// The band that light is traced in.
pub(super) const TRACED: Band = Band::MIDDLE;

/// Observer and source at sea level.
pub(super) fn at(distance_m: f64) -> SourceGeometry {
    SourceGeometry { distance_m, source_altitude_m: 0.0, observer_altitude_m: 0.0 }
}

/// What is sent of every order is found again: direct light by quadrature; later orders on the coarse grid, counted at
/// both ends of the transport.
pub(super) fn check_balance(field: &SourceField) {
    assert!(field.powers().len() >= 6);
    for power in field.powers() {
        let tolerance = if power.order == 0 { 1e-4 } else { 0.03 };
        for (band, lobes) in power.imbalance().iter().enumerate() {
            for (lobe, imbalance) in lobes.iter().enumerate() {
                assert!(imbalance.abs() < tolerance, "order {} {band} {lobe}: {imbalance}", power.order);
            }
        }
    }
}

/// A row of the sky is mirror symmetric and what the sum of moments gives, at distances [m] and azimuths [rad].
pub(super) fn check_rows(field: &SourceField, places: [(f64, f64); 3]) {
    for elevation in [0.1f64, 0.6, 1.5] {
        let row = ViewRow::new(field, 0.0, elevation).unwrap();
        for (distance_m, azimuth) in places {
            let left = row.radiance_per_watt(distance_m, azimuth);
            let right = row.radiance_per_watt(distance_m, -azimuth);
            let exact = field.radiance_per_watt(&at(distance_m), azimuth, elevation).unwrap();
            for band in 0..BAND_COUNT {
                for lobe in 0..LOBE_COUNT {
                    assert!(left[band][lobe] > 0.0 && left[band][lobe].is_finite());
                    assert!((left[band][lobe] / right[band][lobe] - 1.0).abs() < 1e-5);
                    let error = left[band][lobe] / exact[band][lobe] - 1.0;
                    assert!(error.abs() < 0.02, "{distance_m} {azimuth} {elevation}: {error}");
                }
            }
        }
    }
}

/// Detectors at every distance [m] for every direction (relative azimuth, elevation) [rad].
pub(super) fn detectors(distances_m: &[f64], directions: &[(f64, f64)]) -> Vec<Detector> {
    let of = |distance_m: f64| {
        directions.iter().map(move |&(relative_azimuth_rad, elevation_rad)| Detector {
            geometry: at(distance_m),
            relative_azimuth_rad,
            elevation_rad,
        })
    };
    distances_m.iter().flat_map(|&distance_m| of(distance_m)).collect()
}

/// All orders of the `lambert` lobe in one band are what light traced forward gives, within `tolerance` and four times the
/// tracer's own standard error, which is `max_noise` at most; the first order alone would not be.
pub(super) fn check_against_traced_light(
    field: &SourceField,
    detectors: &[Detector],
    paths: u64,
    tolerance: f64,
    max_noise: f64,
) {
    let traced = ForwardTracer::new(*field.setting(), TRACED).estimate(detectors, paths, 7);
    for (detector, traced) in detectors.iter().zip(&traced) {
        let (azimuth, elevation) = (detector.relative_azimuth_rad, detector.elevation_rad);
        let more =
            field.radiance_per_watt(&detector.geometry, azimuth, elevation).unwrap()[TRACED.index()][0];
        let air = &field.setting().atmosphere;
        let first =
            radiance_per_watt_of(air, &detector.geometry, azimuth, elevation, 1e-6)[TRACED.index()][0];
        let total = first + traced.radiance_per_m2_sr[0];
        let noise = traced.standard_error_per_m2_sr[0] / total;
        let error = (first + more) / total - 1.0;
        assert!(noise < max_noise, "{detector:?}: {noise}");
        assert!(error.abs() < tolerance + 4.0 * noise, "{detector:?}: {error} with noise {noise}");
        // The tracer's own first order against the quadrature.
        let check = traced.by_order_per_m2_sr[0][0] / first - 1.0;
        assert!(check.abs() < 0.1, "{detector:?}: first order {check}");
        // Without the later orders the check fails.
        assert!((first / total - 1.0).abs() > tolerance + 4.0 * noise, "{detector:?}");
    }
}

/// Light traced backward and forward in a direction (relative azimuth, elevation) [rad] agrees in every lobe within four standard errors, which are at most `max_noise`
/// of the radiance; both estimates are returned.
pub(super) fn check_both_tracers(
    setting: SourceSetting,
    geometry: SourceGeometry,
    (relative_azimuth_rad, elevation_rad): (f64, f64),
    backward_paths: u64,
    max_noise: f64,
) -> [Estimate; 2] {
    let detector = Detector { geometry, relative_azimuth_rad, elevation_rad };
    let tracer = Tracer::new(setting, TRACED, &geometry);
    let b = tracer.estimate(relative_azimuth_rad, elevation_rad, backward_paths, 3);
    let f = ForwardTracer::new(setting, TRACED).estimate(&[detector], 60_000, 3)[0];
    for lobe in 0..LOBE_COUNT {
        let difference = b.radiance_per_m2_sr[lobe] - f.radiance_per_m2_sr[lobe];
        let noise = b.standard_error_per_m2_sr[lobe].hypot(f.standard_error_per_m2_sr[lobe]);
        assert!(difference.abs() < 4.0 * noise, "lobe {lobe}: {b:?} {f:?}");
        assert!(noise < max_noise * b.radiance_per_m2_sr[lobe], "lobe {lobe}: {b:?} {f:?}");
    }
    [b, f]
}
