//! Phases of the Moon by the difference of the apparent longitudes of Moon and Sun (Meeus 1998, chapter 49).

use crate::{
    ephemeris::{Body, Epoch},
    time::Instant,
};
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

/// A phase of the Moon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[expect(missing_docs, reason = "their names say all")]
pub enum MoonPhase {
    NewMoon,
    WaxingCrescent,
    FirstQuarter,
    WaxingGibbous,
    FullMoon,
    WaningGibbous,
    LastQuarter,
    WaningCrescent,
}

impl MoonPhase {
    /// In their order.
    pub const ALL: [MoonPhase; 8] = [
        MoonPhase::NewMoon,
        MoonPhase::WaxingCrescent,
        MoonPhase::FirstQuarter,
        MoonPhase::WaxingGibbous,
        MoonPhase::FullMoon,
        MoonPhase::WaningGibbous,
        MoonPhase::LastQuarter,
        MoonPhase::WaningCrescent,
    ];

    /// Of an instant: the eighth of the month around new Moon, and so on.
    pub fn of(instant: Instant) -> Self {
        let eighth = (longitude_difference_rad(instant) / FRAC_PI_4).round() as usize % 8;
        Self::ALL[eighth]
    }
}

/// A phase at its instant: new Moon, a quarter or full Moon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PhaseEvent {
    /// Which.
    pub phase: MoonPhase,
    /// When.
    pub utc: Instant,
}

/// How far the Moon is ahead of the Sun in apparent longitude, rad, 0..2π.
pub fn longitude_difference_rad(instant: Instant) -> f64 {
    let epoch = Epoch::new(instant);
    let ecliptic_from_cirs = epoch.ecliptic_from_gcrs() * epoch.cirs_from_gcrs().transpose();
    let [moon, sun] = [Body::Moon, Body::Sun].map(|body| {
        let vector = ecliptic_from_cirs * epoch.geocentric_au(body);
        vector.y.atan2(vector.x)
    });
    (moon - sun).rem_euclid(TAU)
}

/// New Moons, quarters and full Moons between two instants, to a second of the positions used.
pub fn phases(from: Instant, until: Instant) -> Vec<PhaseEvent> {
    const STEP_S: f64 = 43_200.0;
    let quarter = |at: Instant| (longitude_difference_rad(at) / FRAC_PI_2) as usize;
    let mut found = Vec::new();
    let (mut start, mut before) = (from, quarter(from));
    while start < until {
        let end = start.plus_s(STEP_S.min(until.unix_s() - start.unix_s()));
        let after = quarter(end);
        if after != before {
            let (mut low, mut high) = (start, end);
            while high.unix_s() - low.unix_s() > 1.0 {
                let middle = low.plus_s(0.5 * (high.unix_s() - low.unix_s()));
                if quarter(middle) == before { low = middle } else { high = middle }
            }
            found.push(PhaseEvent { phase: MoonPhase::ALL[2 * after % 8], utc: high });
        }
        (start, before) = (end, after);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Phases of 2024 as almanacs have them, to the minute.
    #[test]
    fn phases_are_those_of_almanacs() {
        let instant = |text: &str| Instant::parse(text).unwrap();
        let found = phases(instant("2024-04-01T00:00:00Z"), instant("2024-05-01T00:00:00Z"));
        let expected = [
            (MoonPhase::LastQuarter, "2024-04-02T03:15:00Z"),
            (MoonPhase::NewMoon, "2024-04-08T18:21:00Z"),
            (MoonPhase::FirstQuarter, "2024-04-15T19:13:00Z"),
            (MoonPhase::FullMoon, "2024-04-23T23:49:00Z"),
        ];
        assert_eq!(found.len(), expected.len());
        for (event, (phase, utc)) in found.iter().zip(expected) {
            assert_eq!(event.phase, phase);
            let off_s = event.utc.unix_s() - instant(utc).unix_s();
            assert!(off_s.abs() < 90.0, "{utc}: {off_s} s");
            assert_eq!(MoonPhase::of(event.utc), phase);
        }
        assert_eq!(MoonPhase::of(instant("2024-04-12T00:00:00Z")), MoonPhase::WaxingCrescent);
    }
}
