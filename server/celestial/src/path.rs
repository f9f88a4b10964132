//! The way of a body over a day: Lagrange interpolation of its place in the system of date, and what it crosses (bisection).

use crate::{
    ephemeris::{Body, Epoch, Stand, Topocentric},
    site::Site,
    time::Instant,
};
use glam::DVec3;

/// Places that a path is interpolated between.
const NODES: usize = 8;
/// Seconds between them: 26 hours and a quarter in all.
const STEP_S: f64 = 3.75 * 3_600.0;
/// Seconds between the altitudes in which crossings are looked for.
const SCAN_S: f64 = 600.0;
/// Crossings are found to so many seconds.
const TOLERANCE_S: f64 = 0.05;

/// Where a body is over a site for 26 hours; within 0.1″ of its ephemeris.
#[derive(Clone, Debug)]
pub struct Path {
    site: Site,
    start: Instant,
    /// From the Earth's centre in the system of date, au.
    geocentric_au: [DVec3; NODES],
}

/// A value passes through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// When.
    pub at: Instant,
    /// Whether the value grows.
    pub is_rising: bool,
}

/// The epochs that paths from an instant on are made of, so that several bodies share them.
#[derive(Clone, Debug)]
pub struct PathEpochs([Epoch; NODES]);

impl PathEpochs {
    /// From an instant on.
    pub fn new(start: Instant) -> Self {
        Self(std::array::from_fn(|node| Epoch::new(start.plus_s(STEP_S * node as f64))))
    }

    /// The way of a body over a site.
    pub fn path(&self, site: Site, body: Body) -> Path {
        let geocentric_au = std::array::from_fn(|node| self.0[node].geocentric_au(body));
        Path { site, start: self.0[0].instant(), geocentric_au }
    }
}

impl Path {
    /// Where the observer has the body.
    pub fn at(&self, instant: Instant) -> Topocentric {
        Stand::new(self.site, instant).topocentric(self.geocentric_au(instant))
    }

    /// From the Earth's centre, au.
    pub fn geocentric_au(&self, instant: Instant) -> DVec3 {
        let place = (instant.unix_s() - self.start.unix_s()) / STEP_S;
        let mut sum = DVec3::ZERO;
        for (node, vector) in self.geocentric_au.iter().enumerate() {
            let weight: f64 = (0..NODES)
                .filter(|other| *other != node)
                .map(|other| (place - other as f64) / (node as f64 - other as f64))
                .product();
            sum += *vector * weight;
        }
        sum
    }
}

/// Where a value that changes slowly passes through zero between two instants, in their order. Two crossings that are nearer to each
/// other than the steps of the search are found by the extremum between them.
pub fn crossings(from: Instant, until: Instant, value: impl Fn(Instant) -> f64) -> Vec<Crossing> {
    let span_s = until.unix_s() - from.unix_s();
    let count = (span_s / SCAN_S).ceil().max(1.0) as usize;
    let at = |step: usize| from.plus_s(span_s * step as f64 / count as f64);
    let values: Vec<f64> = (0..=count).map(|step| value(at(step))).collect();
    let mut found = Vec::new();
    for step in 0..count {
        let (before, after) = (values[step], values[step + 1]);
        if (before > 0.0) != (after > 0.0) {
            found.push(bisected(at(step), at(step + 1), &value));
            continue;
        }
        // Does the value turn between the neighbours of this step?
        let sign = if before > 0.0 { 1.0 } else { -1.0 };
        let earlier = values[step.saturating_sub(1)] * sign;
        let later = values[(step + 2).min(count)] * sign;
        let (near, far) = (before * sign, after * sign);
        if near <= earlier && far <= later {
            let turn = lowest(at(step), at(step + 1), |instant| sign * value(instant));
            if sign * value(turn) < 0.0 {
                found.push(bisected(at(step), turn, &value));
                found.push(bisected(turn, at(step + 1), &value));
            }
        }
    }
    found
}

/// The crossing between two instants at which the value has two signs.
fn bisected(mut from: Instant, mut until: Instant, value: &impl Fn(Instant) -> f64) -> Crossing {
    let is_rising = value(until) > 0.0;
    while until.unix_s() - from.unix_s() > TOLERANCE_S {
        let middle = from.plus_s(0.5 * (until.unix_s() - from.unix_s()));
        if (value(middle) > 0.0) == is_rising {
            until = middle;
        } else {
            from = middle;
        }
    }
    Crossing { at: until, is_rising }
}

/// Where a value with one minimum between two instants is lowest, by golden sections.
pub fn lowest(from: Instant, until: Instant, value: impl Fn(Instant) -> f64) -> Instant {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (from.unix_s(), until.unix_s());
    let at = |seconds: f64| from.plus_s(seconds - from.unix_s());
    while high - low > 1.0 {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if value(at(left)) < value(at(right)) { high = right } else { low = left }
    }
    at(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ephemeris::Positions;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// The path of the quickest body, the Moon, and of the Sun: 0.1″ at most beside the ephemeris.
        #[test]
        fn paths_are_the_ephemeris(
            days in -25_000.0..47_000.0_f64, hours in 0.0..26.0_f64, latitude in -90.0..90.0_f64,
        ) {
            let start = Instant::from_unix_s(days * 86_400.0).unwrap();
            let site = Site::new(latitude, 30.0, 500.0).unwrap();
            let epochs = PathEpochs::new(start);
            let at = start.plus_s(hours * 3_600.0);
            for body in [Body::Sun, Body::Moon] {
                let exact = Positions::new(site, at).of(body).enu_au;
                let off_arcsec = epochs.path(site, body).at(at).enu_au.angle_between(exact).to_degrees() * 3_600.0;
                prop_assert!(off_arcsec < 0.1, "{body:?} {off_arcsec}");
            }
        }

        /// Every crossing of a wave is found, also two within a minute of each other.
        #[test]
        fn crossings_are_all_found(phase in 0.0..6.3_f64, level in -1.001..1.001_f64) {
            let start = Instant::from_unix_s(1e9).unwrap();
            let wave = |at: Instant| {
                ((at.unix_s() - start.unix_s()) / 86_400.0 * std::f64::consts::TAU + phase).sin() - level
            };
            let found = crossings(start, start.plus_s(86_400.0), wave);
            if level.abs() < 0.999_999 {
                prop_assert!(found.len() == 2 || found.len() == 1, "{}", found.len());
            }
            for crossing in &found {
                prop_assert!(wave(crossing.at).abs() < 1e-5);
            }
            for pair in found.windows(2) {
                prop_assert!(pair[0].at <= pair[1].at && pair[0].is_rising != pair[1].is_rising);
            }
            if level.abs() > 1.0 {
                prop_assert!(found.is_empty());
            }
        }
    }
}
