//! In which directions the low sky is dark.

use skyglow_physics::{
    AZIMUTH_COUNT, ELEVATION_COUNT, Horizon,
    panorama::{azimuth_rad, elevation_rad, solid_angle_sr},
};
use std::f64::consts::PI;

/// The low sky ends here, radians above the horizontal plane.
const HIGHEST_RAD: f64 = PI / 6.0;
/// Columns that a direction is the mean of: 15°.
const COLUMNS: usize = 11;
/// Narrowest range of clean directions, columns: 15°.
const NARROWEST: usize = 11;
/// A direction is clean where artificial light is at most this part of the natural sky overhead.
const CLEAN_PART: f64 = 0.5;

/// Artificial light low in the sky, by direction. A direction is the mean over 15° of azimuth and the lowest 30° of the visible sky.
#[derive(Clone, Debug, PartialEq)]
pub struct LowSky {
    /// Azimuth of the darkest direction, degrees clockwise from north, and its luminance, cd m⁻².
    pub darkest: (f64, f64),
    /// The same of the brightest.
    pub brightest: (f64, f64),
    /// Ranges of clean directions, first and last azimuth in degrees, of 15° or more; the last is below the first across north.
    pub clean: Vec<[f64; 2]>,
}

/// The low sky of artificial luminance, `[row][column]`, cd m⁻², under a natural sky so bright overhead, cd m⁻²; None where terrain
/// hides all of it.
pub fn low_sky(luminance_cd_m2: &[f32], natural_cd_m2: f64, horizon: &Horizon) -> Option<LowSky> {
    let rows: Vec<usize> = (0..ELEVATION_COUNT).filter(|&row| elevation_rad(row) <= HIGHEST_RAD).collect();
    let column = |column: usize| {
        let visible = rows.iter().filter(|row| !horizon.hides_sample(**row, column));
        visible.fold((0.0, 0.0), |(sum, weights), &row| {
            let weight = solid_angle_sr(row);
            let value = luminance_cd_m2.get(row * AZIMUTH_COUNT + column).copied().unwrap_or_default();
            (sum + weight * f64::from(value), weights + weight)
        })
    };
    let columns: Vec<(f64, f64)> = (0..AZIMUTH_COUNT).map(column).collect();
    let mean = |at: usize| {
        let near = (0..COLUMNS).map(|k| columns[(at + AZIMUTH_COUNT + k - COLUMNS / 2) % AZIMUTH_COUNT]);
        let (sum, weights) = near.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        (weights > 0.0).then(|| sum / weights)
    };
    let means: Vec<Option<f64>> = (0..AZIMUTH_COUNT).map(mean).collect();
    let seen = || means.iter().enumerate().filter_map(|(at, mean)| Some((at, (*mean)?)));
    let direction = |(at, mean): (usize, f64)| (azimuth_rad(at).to_degrees(), mean);
    let clean_cd_m2 = CLEAN_PART * natural_cd_m2;
    let is_clean: Vec<bool> = means.iter().map(|mean| mean.is_some_and(|mean| mean <= clean_cd_m2)).collect();
    Some(LowSky {
        darkest: direction(seen().min_by(|a, b| a.1.total_cmp(&b.1))?),
        brightest: direction(seen().max_by(|a, b| a.1.total_cmp(&b.1))?),
        clean: ranges(&is_clean),
    })
}

/// Ranges around the circle in which all is so, degrees.
fn ranges(is_so: &[bool]) -> Vec<[f64; 2]> {
    let count = is_so.len();
    let Some(start) = is_so.iter().position(|so| !so) else { return vec![[0.0, 360.0]] };
    let (mut ranges, mut first) = (Vec::new(), None);
    for at in (start..=start + count).map(|at| at % count) {
        match (is_so[at], first) {
            (true, None) => first = Some(at),
            (false, Some(begin)) => {
                let length = (at + count - begin) % count;
                if length >= NARROWEST {
                    let last = (begin + length - 1) % count;
                    ranges.push([begin, last].map(|column| azimuth_rad(column).to_degrees()));
                }
                first = None;
            }
            _ => {}
        }
    }
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    const NATURAL_CD_M2: f64 = 2e-4;

    /// A sky with a glow around an azimuth.
    fn glow(azimuth_deg: f64, halfwidth_deg: f64) -> Vec<f32> {
        let bright = |index: usize| {
            let away = (azimuth_rad(index % AZIMUTH_COUNT).to_degrees() - azimuth_deg + 540.0)
                .rem_euclid(360.0)
                - 180.0;
            if away.abs() <= halfwidth_deg { 1e-2 } else { 1e-6 }
        };
        (0..AZIMUTH_COUNT * ELEVATION_COUNT).map(bright).collect()
    }

    /// All but the glow is clean, also across north; a narrow gap between glows is not.
    #[test]
    fn directions_away_from_a_glow_are_clean() {
        let low = low_sky(&glow(180.0, 30.0), NATURAL_CD_M2, &Horizon::flat()).unwrap();
        assert_eq!(low.clean.len(), 1);
        let [first, last] = low.clean[0];
        assert!((first - 218.0).abs() < 3.0 && (last - 142.0).abs() < 3.0, "{low:?}");
        assert!((low.brightest.0 - 180.0).abs() < 30.0 && low.brightest.1 > 9e-3 && low.darkest.1 < 2e-6);
        assert_eq!(low_sky(&glow(0.0, 0.0), NATURAL_CD_M2, &Horizon::flat()).unwrap().clean.len(), 1);
        assert!(low_sky(&glow(0.0, 170.0), NATURAL_CD_M2, &Horizon::flat()).unwrap().clean.is_empty());
        let dark = vec![1e-7; AZIMUTH_COUNT * ELEVATION_COUNT];
        assert_eq!(low_sky(&dark, NATURAL_CD_M2, &Horizon::flat()).unwrap().clean, [[0.0, 360.0]]);
    }

    /// What terrain hides does not count; where it hides all of the low sky there is none.
    #[test]
    fn hidden_glow_does_not_count() {
        let wall = |from: usize, to: usize| {
            let rad = |column: usize| if (from..to).contains(&column) { 1.0 } else { 0.0 };
            Horizon::new((0..AZIMUTH_COUNT).map(rad).collect()).unwrap()
        };
        let low = low_sky(&glow(180.0, 20.0), NATURAL_CD_M2, &wall(100, 156)).unwrap();
        assert!(low.brightest.1 < 2e-6, "{low:?}");
        assert_eq!(low_sky(&glow(180.0, 20.0), NATURAL_CD_M2, &wall(0, AZIMUTH_COUNT)), None);
    }
}
