//! The reference solution, first order: the sum over every point source, each by converged quadrature (paper Eq. 3,
//! `docs/model.md#reference`).
//!
//! L(θ, φ) = Σ_i Φ_i · b(θ − θ_i, φ; r_i, h_i, h_o). Slow and simple on purpose: nothing is skipped, merged or
//! tabulated but the optical columns (good to 1e-9). Every fast path is measured against it.

use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    blocked_source::BlockedSource,
    emission::EmissionMix,
    panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Panorama, azimuth_rad, elevation_rad},
    single_source::{SourceGeometry, cut_mixed_radiance_per_watt, radiance_per_watt},
    source_pixel::PointSource,
};
use rayon::prelude::*;

/// Relative tolerance of every integral of the reference solution.
pub const REFERENCE_TOLERANCE: f64 = 1e-6;

/// Sky radiance [W m⁻² sr⁻¹] at each direction, `[direction][atmosphere × band]`, every source under an open sky.
///
/// `flux_per_dnb_flux` is the lamp's s_b. `N` must be the number of atmospheres times [`BAND_COUNT`].
/// Parallel over directions; the order of summation is fixed, so the result does not depend on threads.
/// `advance` is called once a direction.
pub fn direct_sum<const N: usize>(
    atmospheres: &[Atmosphere],
    sources: &[PointSource],
    observer_altitude_m: f64,
    emission: EmissionMix,
    flux_per_dnb_flux: [f64; BAND_COUNT],
    directions: &[Direction],
    advance: &(dyn Fn() + Sync),
) -> Vec<[f64; N]> {
    let open: Vec<BlockedSource> = sources.iter().copied().map(BlockedSource::open).collect();
    cut_direct_sum(atmospheres, &open, observer_altitude_m, emission, flux_per_dnb_flux, directions, advance)
}

/// As [`direct_sum`], each source's lobe cut all around at its own skyline. With all angles 0 it equals that sum.
pub fn cut_direct_sum<const N: usize>(
    atmospheres: &[Atmosphere],
    sources: &[BlockedSource],
    observer_altitude_m: f64,
    emission: EmissionMix,
    flux_per_dnb_flux: [f64; BAND_COUNT],
    directions: &[Direction],
    advance: &(dyn Fn() + Sync),
) -> Vec<[f64; N]> {
    directions
        .par_iter()
        .map(|direction| {
            let mut sum = [0.0; N];
            for BlockedSource { source, blocking_rad } in sources {
                let geometry = SourceGeometry {
                    distance_m: source.distance_m,
                    source_altitude_m: source.altitude_m,
                    observer_altitude_m,
                };
                let per_watt: [f64; N] = cut_mixed_radiance_per_watt(
                    atmospheres,
                    &geometry,
                    emission,
                    *blocking_rad,
                    direction.azimuth_rad - source.azimuth_rad,
                    direction.elevation_rad,
                    REFERENCE_TOLERANCE,
                );
                for (slot, value) in per_watt.into_iter().enumerate() {
                    sum[slot] += source.flux_dnb_w * flux_per_dnb_flux[slot % BAND_COUNT] * value;
                }
            }
            advance();
            sum
        })
        .collect()
}

/// As [`direct_sum`] with each lobe apart, `[direction][atmosphere × band × lobe]`, for flux in watts of the band: no lamp.
/// Every lobe of every source to a relative `tolerance`.
pub fn direct_sum_by_lobe<const N: usize>(
    atmospheres: &[Atmosphere],
    sources: &[PointSource],
    observer_altitude_m: f64,
    directions: &[Direction],
    tolerance: f64,
) -> Vec<[f64; N]> {
    directions
        .par_iter()
        .map(|direction| {
            let mut sum = [0.0; N];
            for source in sources {
                let geometry = SourceGeometry {
                    distance_m: source.distance_m,
                    source_altitude_m: source.altitude_m,
                    observer_altitude_m,
                };
                let azimuth_rad = direction.azimuth_rad - source.azimuth_rad;
                let per_watt: [f64; N] = radiance_per_watt(
                    atmospheres,
                    &geometry,
                    azimuth_rad,
                    direction.elevation_rad,
                    tolerance,
                    0.0,
                );
                sum.iter_mut().zip(per_watt).for_each(|(sum, value)| *sum += source.flux_dnb_w * value);
            }
            sum
        })
        .collect()
}

/// A grid sample: (row, column) of the panorama.
pub type GridSample = (usize, usize);

/// The direction of a grid sample.
pub fn grid_direction((row, column): GridSample) -> Direction {
    Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) }
}

/// About `count` grid samples, stratified over azimuth and elevation: an eighth of them in the lowest row
/// (the horizon), a sixteenth in the highest (the zenith), the rest spread evenly over all rows and columns.
/// Deterministic; sorted; without repetitions (at most rows × columns).
pub fn stratified_samples(count: usize) -> Vec<GridSample> {
    let count = count.min(AZIMUTH_COUNT * ELEVATION_COUNT);
    let mut chosen = std::collections::BTreeSet::new();
    let mut row_samples = |row: usize, n: usize| {
        for i in 0..n.min(AZIMUTH_COUNT) {
            chosen.insert((row, i * AZIMUTH_COUNT / n.min(AZIMUTH_COUNT)));
        }
    };
    row_samples(0, (count / 8).max(1));
    row_samples(ELEVATION_COUNT - 1, (count / 16).max(1));
    // The R₂ sequence (Roberts 2018) fills the rest evenly for any count.
    let mut i = 0u32;
    while chosen.len() < count {
        i += 1;
        let spread = |ratio: f64, n: usize| ((f64::from(i) * ratio).fract() * n as f64) as usize;
        chosen.insert((
            spread(0.754_877_666_246_692_8, ELEVATION_COUNT),
            spread(0.569_840_290_998_053_3, AZIMUTH_COUNT),
        ));
    }
    chosen.into_iter().collect()
}

/// The whole sky from the radiance [W m⁻² sr⁻¹] at some grid samples: exact there, between them the mean weighted
/// by 1 / γ⁴ (Shepard 1968), γ being (nearly) the angle to the sample. Dark without samples.
pub fn panorama_between(samples: &[GridSample], radiance_w_m2_sr: &[[f64; BAND_COUNT]]) -> Panorama {
    let known: Vec<_> =
        samples.iter().map(|&sample| grid_direction(sample).enu()).zip(radiance_w_m2_sr).collect();
    let mut panorama = Panorama::dark();
    for row in 0..ELEVATION_COUNT {
        for column in 0..AZIMUTH_COUNT {
            let here = grid_direction((row, column)).enu();
            let (mut sum, mut total) = ([0.0; BAND_COUNT], 0.0);
            for (direction, bands) in &known {
                // |a − b|² of unit vectors is about γ²; the small addend lets a sample's own value win.
                let weight = 1.0 / (here.distance_squared(*direction).powi(2) + 1e-20);
                total += weight;
                sum.iter_mut().zip(*bands).for_each(|(sum, value)| *sum += weight * value);
            }
            for (band, sum) in sum.into_iter().enumerate().filter(|_| total > 0.0) {
                panorama.samples_mut()[Panorama::index(band, row, column)] = (sum / total) as f32;
            }
        }
    }
    panorama
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LOBE_COUNT, Turbidity, single_source::radiance_per_watt_of};
    use proptest::prelude::*;

    /// Another flux in every band.
    const FLUX_PER_DNB_FLUX: [f64; BAND_COUNT] = [0.4, 0.5, 0.3, 0.1];

    fn source(azimuth_rad: f64, distance_m: f64, flux_dnb_w: f64) -> PointSource {
        PointSource { azimuth_rad, distance_m, altitude_m: 120.0, flux_dnb_w }
    }

    fn sum(sources: &[PointSource], directions: &[Direction]) -> Vec<[f64; BAND_COUNT]> {
        direct_sum(
            &[Atmosphere::new(Turbidity::default())],
            sources,
            300.0,
            EmissionMix::garstang(),
            FLUX_PER_DNB_FLUX,
            directions,
            &|| (),
        )
    }

    const VIEW: Direction = Direction { azimuth_rad: 0.9, elevation_rad: 0.4 };

    /// Skylines of no height change no bit, and higher ones leave less, down to darkness.
    #[test]
    fn higher_skylines_leave_less() {
        let sources = [source(0.2, 9_000.0, 5e6), source(2.0, 60_000.0, 4e7)];
        let directions = [VIEW, Direction { azimuth_rad: 3.0, elevation_rad: 0.05 }];
        let behind = |skylines_deg: [f64; 2]| -> Vec<[f64; BAND_COUNT]> {
            let blocked = sources
                .iter()
                .zip(skylines_deg)
                .map(|(&source, angle_deg)| BlockedSource { source, blocking_rad: angle_deg.to_radians() });
            cut_direct_sum(
                &[Atmosphere::new(Turbidity::default())],
                &blocked.collect::<Vec<_>>(),
                300.0,
                EmissionMix::garstang(),
                FLUX_PER_DNB_FLUX,
                &directions,
                &|| (),
            )
        };
        let open = sum(&sources, &directions);
        assert_eq!(behind([0.0, 0.0]), open);
        let steps = [0.0, 0.3, 2.0, 9.0, 40.0, 89.0].map(|angle_deg| behind([angle_deg; 2]));
        for pair in steps.windows(2) {
            for (lower, higher) in pair[0].iter().flatten().zip(pair[1].iter().flatten()) {
                // Low directions away from the sources show nothing of what is emitted steeply upwards.
                assert!(higher < lower || *higher == 0.0, "{lower} {higher}");
            }
        }
        assert!(steps[3][0].iter().all(|value| *value > 0.0));
        // Each source has its own skyline: with one dark the other is left, as if it stood alone.
        assert_eq!(behind([90.0, 0.0]), sum(&sources[1..], &directions));
        assert!(behind([90.0, 90.0]).iter().flatten().all(|value| *value == 0.0));
    }

    #[test]
    fn one_source_is_its_flux_times_lamp_times_lobes() {
        let got = sum(&[source(0.2, 20_000.0, 5e6)], &[VIEW])[0];
        let per_watt = radiance_per_watt_of(
            &Atmosphere::new(Turbidity::default()),
            &SourceGeometry { distance_m: 20_000.0, source_altitude_m: 120.0, observer_altitude_m: 300.0 },
            0.7,
            0.4,
            1e-9,
        );
        let weights = EmissionMix::garstang().weights();
        for band in 0..BAND_COUNT {
            let mixed: f64 = (0..LOBE_COUNT).map(|lobe| weights[lobe] * per_watt[band][lobe]).sum();
            let expected = 5e6 * FLUX_PER_DNB_FLUX[band] * mixed;
            assert!((got[band] / expected - 1.0).abs() < 1e-6, "{band}");
        }
    }

    #[test]
    fn lobes_apart_add_up_to_their_mix() {
        let sources = [source(0.2, 9_000.0, 5e6), source(2.0, 60_000.0, 4e7)];
        let atmosphere = Atmosphere::new(Turbidity::default());
        let by_lobe: Vec<[f64; BAND_COUNT * LOBE_COUNT]> =
            direct_sum_by_lobe(&[atmosphere], &sources, 300.0, &[VIEW], 1e-7);
        let (mixed, lamp) = (sum(&sources, &[VIEW])[0], FLUX_PER_DNB_FLUX);
        for band in 0..BAND_COUNT {
            let lobes = &by_lobe[0][band * LOBE_COUNT..][..LOBE_COUNT];
            let weights = EmissionMix::garstang().weights();
            let added: f64 = lobes.iter().zip(weights).map(|(value, weight)| value * weight).sum();
            assert!((lamp[band] * added / mixed[band] - 1.0).abs() < 2e-6, "{band}");
            assert!((lobes[0] / lobes[1] - 1.0).abs() > 0.01);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// The sum is linear in the sources and turns with them.
        #[test]
        fn sum_is_linear_and_turns_with_the_sources(
            a1 in 0.0f64..6.2, a2 in 0.0f64..6.2, r1 in 250.0f64..3e5, r2 in 250.0f64..3e5, turn in 0.0f64..6.2,
        ) {
            let (one, two) = (source(a1, r1, 1e6), source(a2, r2, 3e7));
            let both = sum(&[one, two], &[VIEW])[0];
            let first = sum(&[one], &[VIEW])[0];
            let second = sum(&[two], &[VIEW])[0];
            let turned = sum(
                &[source(a1 + turn, r1, 1e6), source(a2 + turn, r2, 3e7)],
                &[Direction { azimuth_rad: VIEW.azimuth_rad + turn, ..VIEW }],
            )[0];
            for band in 0..BAND_COUNT {
                prop_assert!((both[band] - first[band] - second[band]).abs() <= 1e-12 * both[band]);
                prop_assert!((both[band] - turned[band]).abs() <= 1e-9 * both[band]);
            }
        }
    }

    /// The interpolated sky equals the samples where they are and is close to a smooth sky elsewhere.
    #[test]
    fn interpolated_sky_is_exact_at_samples() {
        let glow = |sample: GridSample| {
            let direction = grid_direction(sample);
            let value = 1e-6 * (-2.0 * direction.elevation_rad).exp() * (1.5 + direction.azimuth_rad.cos());
            std::array::from_fn::<_, BAND_COUNT, _>(|band| (band + 1) as f64 * value)
        };
        let samples = stratified_samples(500);
        let radiance: Vec<_> = samples.iter().copied().map(glow).collect();
        let panorama = panorama_between(&samples, &radiance);
        for (&(row, column), bands) in samples.iter().zip(&radiance) {
            for (band, value) in bands.iter().enumerate() {
                assert!((panorama.radiance_w_m2_sr(band, row, column) / value - 1.0).abs() < 1e-6);
            }
        }
        let mut errors: Vec<f64> = (0..AZIMUTH_COUNT * ELEVATION_COUNT)
            .map(|i| (i / AZIMUTH_COUNT, i % AZIMUTH_COUNT))
            .map(|(row, column)| panorama.radiance_w_m2_sr(1, row, column) / glow((row, column))[1] - 1.0)
            .map(f64::abs)
            .collect();
        errors.sort_by(f64::total_cmp);
        assert!(errors[errors.len() / 2] < 0.05, "{}", errors[errors.len() / 2]);
        assert!(panorama_between(&[], &[]).samples().iter().all(|&value| value == 0.0));
    }

    /// Stratified samples contain the horizon and the zenith and never repeat.
    #[test]
    fn stratified_samples_never_repeat() {
        for count in [1, 16, 500, 20_000] {
            let samples = stratified_samples(count);
            assert!(samples.len() >= count.min(AZIMUTH_COUNT * ELEVATION_COUNT));
            assert!(samples.iter().any(|s| s.0 == 0) && samples.iter().any(|s| s.0 == ELEVATION_COUNT - 1));
            assert!(samples.windows(2).all(|pair| pair[0] < pair[1]));
        }
        assert_eq!(stratified_samples(20_000).len(), AZIMUTH_COUNT * ELEVATION_COUNT);
    }
}
