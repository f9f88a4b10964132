//! Gaps by their shares, and the mean of broken clouds by the first order of scattering through layers of cells.

use super::*;
use crate::{
    BAND_COUNT, CloudBase, EmissionMix,
    atmosphere::{Atmosphere, Turbidity},
    single_source::{SourceGeometry, mixed_radiance_per_watt},
};
use proptest::prelude::*;

fn sky_of(value: f32) -> Panorama {
    let mut sky = Panorama::dark();
    sky.samples_mut().fill(value);
    sky
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Every pattern lies between no and full cover, and is the same each time.
    #[test]
    fn patterns_are_shares(cover in 0.0..1.0f64, pattern in 0u32..1000, above_m in 100.0..5_000.0f64) {
        let clouds = BrokenClouds::new(cover, Some(pattern)).unwrap();
        let gaps = clouds.gaps(above_m, 0.5);
        prop_assert!(gaps.shares.iter().all(|share| (0.0..=1.0).contains(share)));
        prop_assert_eq!(&gaps, &clouds.gaps(above_m, 0.5));
    }
}

#[test]
fn cover_is_a_share() {
    for wrong in [-0.1, 1.1, f64::NAN] {
        assert!(BrokenClouds::new(wrong, None).is_err());
    }
}

/// Patterns cover what they say in the mean, each with both clouds and gaps, and differ.
#[test]
fn patterns_have_their_cover_in_the_mean() {
    for cover in [0.2, 0.5, 0.8] {
        let mut mean = 0.0;
        let patterns = 60;
        for pattern in 0..patterns {
            let gaps = BrokenClouds::new(cover, Some(pattern)).unwrap().gaps(1_500.0, 0.5);
            let share =
                gaps.shares.iter().map(|share| f64::from(*share)).sum::<f64>() / gaps.shares.len() as f64;
            mean += (1.0 - share) / f64::from(patterns);
            let clear = gaps.shares.iter().filter(|share| **share > 0.99).count();
            let covered = gaps.shares.iter().filter(|share| **share < 0.01).count();
            assert!(clear.min(covered) > gaps.shares.len() / 100, "{cover} {pattern}: {clear} {covered}");
        }
        assert!((mean - cover).abs() < 0.04, "{cover}: {mean}");
    }
    let pattern = |number| BrokenClouds::new(0.5, Some(number)).unwrap().gaps(1_500.0, 0.5);
    assert_ne!(pattern(1), pattern(2));
}

/// Without cover the sky is clear, with full cover overcast, and between them where there are clouds.
#[test]
fn cover_goes_from_clear_to_overcast() {
    let overcast = sky_of(8.0);
    for (cover, pattern, expected) in
        [(0.0, None, 2.0), (0.0, Some(3), 2.0), (1.0, None, 8.0), (1.0, Some(3), 8.0)]
    {
        let gaps = BrokenClouds::new(cover, pattern).unwrap().gaps(1_000.0, 0.5);
        let mut sky = sky_of(2.0);
        gaps.cover(&mut sky, &overcast);
        assert!(sky.samples().iter().all(|sample| *sample == expected), "{cover} {pattern:?}");
    }
    let gaps = BrokenClouds::new(0.5, Some(3)).unwrap().gaps(1_000.0, 0.5);
    let mut sky = sky_of(2.0);
    gaps.cover(&mut sky, &overcast);
    for row in [10, 40, 63] {
        for column in 0..AZIMUTH_COUNT {
            let value = sky.radiance_w_m2_sr(1, row, column);
            let (least, most) = if gaps.share(row, column) == 0.0 { (8.0, 8.0) } else { (1.0, 8.0) };
            assert!((least..=most).contains(&value), "{value}");
            assert!(gaps.share(row, column) < 1.0 || value <= 2.0, "{value}");
        }
    }
    // An even sky and what it sends through clouds: a quarter of 2 and three quarters of a half of that.
    let mut sky = sky_of(2.0);
    BrokenClouds::new(0.75, None).unwrap().gaps(1_000.0, 0.5).put_before(&mut sky, [0.0; BAND_COUNT]);
    assert!(sky.samples().iter().all(|sample| (sample / 1.25 - 1.0).abs() < 1e-3));
    // A beam of π on level ground lights a closed layer from above: 0.3 comes through.
    let mut sky = sky_of(0.0);
    BrokenClouds::CLOSED.gaps(1_000.0, 0.3).put_before(&mut sky, [PI; BAND_COUNT]);
    assert!(sky.samples().iter().all(|sample| (sample / 0.3 - 1.0).abs() < 1e-6));
}

/// In the mean of all patterns gaps close at a slant for artificial light, and a direction has the same light either way.
#[test]
fn gaps_close_at_a_slant() {
    let clouds = BrokenClouds::new(0.5, None).unwrap();
    let (mut sky, overcast) = (sky_of(2.0), sky_of(8.0));
    clouds.gaps(1_500.0, 0.5).cover(&mut sky, &overcast);
    for row in [1, 10, 63] {
        let expected = clouds.mean_radiance(2.0, 8.0, elevation_rad(row));
        assert!((sky.radiance_w_m2_sr(2, row, 7) / expected - 1.0).abs() < 1e-5, "{row}");
    }
    let [low, high] = [0.05, 1.5].map(|elevation_rad| mean_gap_share(0.5, elevation_rad));
    assert!(low < 0.2 && (high - 0.5).abs() < 0.01, "{low} {high}");
    assert_eq!([mean_gap_share(0.0, 0.1), mean_gap_share(1.0, 0.1)], [1.0, 0.0]);
}

/// A direction has the share of the sample that it lies in.
#[test]
fn directions_have_the_share_of_their_sample() {
    let gaps = BrokenClouds::new(0.5, Some(7)).unwrap().gaps(1_000.0, 0.5);
    for (row, column) in [(0, 0), (20, 255), (63, 128)] {
        let direction = Direction {
            azimuth_rad: crate::panorama::azimuth_rad(column),
            elevation_rad: crate::panorama::elevation_rad(row),
        };
        assert_eq!(gaps.towards(direction), gaps.share(row, column));
    }
}

/// The mean over all patterns, in the first order of scattering: air above the layer is lit through gaps, and seen through others. Clouds
/// are small beside the way between a light and what is lit by it.
#[test]
fn the_mean_is_near_the_first_order() {
    let air = Atmosphere::new(Turbidity::default());
    let (mut sum, mut largest, mut count) = (0.0, 0f64, 0.0);
    for base_m in [1_500.0, 3_000.0] {
        let under = |albedo| air.under(Some(CloudBase::new(base_m, albedo).unwrap()));
        for distance_m in [1_000.0, 5_000.0, 15_000.0, 30_000.0, 60_000.0] {
            let geometry =
                SourceGeometry { distance_m, source_altitude_m: 100.0, observer_altitude_m: 100.0 };
            for azimuth in [0.0, 0.8, 1.6, 3.1] {
                for elevation in [0.1f64, 0.2, 0.4, 0.6, 0.9, 1.2, 1.5] {
                    let [clear, below, overcast] = [air, under(0.0), under(0.5)].map(|air| {
                        let mix = EmissionMix::garstang();
                        mixed_radiance_per_watt::<BAND_COUNT>(
                            &[air],
                            &geometry,
                            mix,
                            azimuth,
                            elevation,
                            1e-4,
                        )[1]
                    });
                    for cover in [0.25, 0.5, 0.75] {
                        let lit = below + (1.0 - cover) * (clear - below);
                        let expected = (1.0 - cover) * lit + cover * overcast;
                        let scale = 1.0 / clear;
                        let gap = through_gap(
                            1.0,
                            (overcast * scale) as f32,
                            cover as f32,
                            share_below(elevation) as f32,
                        );
                        let found = (1.0 - cover) * f64::from(gap) / scale + cover * overcast;
                        let error = (found / expected - 1.0).abs();
                        sum += error;
                        count += 1.0;
                        largest = largest.max(error);
                    }
                }
            }
        }
    }
    println!("{count} cases: mean {:.3}, largest {largest:.3}", sum / count);
    assert!(sum / count < 0.03 && largest < 0.22, "{} {largest}", sum / count);
}

proptest! {
    /// Slopes are derivatives, and with the skies add up to the sky.
    #[test]
    fn slopes_of_covers_add_up(
        clear in 1e-9..1e-6f32, ratio in 0.01..30.0f32, cover in 0.05..0.95f64, pattern in prop::option::of(1u32..9),
    ) {
        let gaps = BrokenClouds::new(cover, pattern).unwrap().gaps(1_500.0, 0.5);
        let [clear, overcast] = [clear, clear * ratio].map(sky_of);
        let slopes = gaps.slopes(&clear, &overcast);
        let covered = |clear: &Panorama, overcast: &Panorama| {
            let mut sky = clear.clone();
            gaps.cover(&mut sky, overcast);
            sky
        };
        let sky = covered(&clear, &overcast);
        let [more_clear, more_overcast] = [&clear, &overcast].map(|sky| sky_of(1.0001 * sky.samples()[0]));
        let (by_clear, by_overcast) = (covered(&more_clear, &overcast), covered(&clear, &more_overcast));
        for at in (0..Panorama::LEN).step_by(997) {
            let [value, clear, overcast] = [&sky, &clear, &overcast].map(|sky| f64::from(sky.samples()[at]));
            let [of_clear, of_overcast] =
                [&slopes.by_clear, &slopes.by_overcast].map(|slopes| f64::from(slopes[at]));
            prop_assert!(((of_clear * clear + of_overcast * overcast) / value - 1.0).abs() < 1e-5);
            for (moved, own, slope) in [(&by_clear, clear, of_clear), (&by_overcast, overcast, of_overcast)] {
                let change = (f64::from(moved.samples()[at]) - value) / (1e-4 * own);
                prop_assert!((change - slope).abs() < 1e-2 * (1.0 + value / own), "{change} {slope}");
            }
        }
    }
}
