//! A closed curve on the sky and the directions inside it, by the winding number.
//!
//! Its sides are arcs of great circles, the shortest between corners. A direction p is inside where the curve winds around it,
//! with Δ the angle at p from one corner to the next, turning left or right by less than a half turn,
//!
//! ```text
//! (Σ_sides Δ) / 2π ≠ 0
//! ```
//!
//! So curves may pass north, hold the zenith and cross themselves: a loop that is gone around twice or backwards is inside, and
//! so are both loops of an eight.

use crate::{
    error::{PhysicsError, check_range},
    panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, azimuth_rad, elevation_rad},
};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Serialize, Serializer};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Most corners of a curve.
pub const MAX_CORNERS: usize = 1_000;

/// Corners nearer than this are the same, radians.
const SAME_CORNER_RAD: f64 = 1e-9;

/// A closed curve on the sky; its last corner is joined to its first.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyCurve {
    corners: Vec<DVec3>,
    lowest_rad: f64,
}

impl Serialize for SkyCurve {
    /// Its corners as directions in space.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.corners.iter().map(|corner| corner.to_array()))
    }
}

impl SkyCurve {
    /// From corners in order; one equal to the one before it, or a last one equal to the first, adds nothing.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `region`: an angle that is no number, an elevation below 0 or above 90°, fewer than three
    /// different corners, more than [`MAX_CORNERS`], or neighbours on opposite sides of the horizon, between which no arc
    /// is the shortest.
    pub fn new(corners: Vec<Direction>) -> Result<Self, PhysicsError> {
        let refuse = |reason: String| Err(PhysicsError::Invalid { parameter: "region", reason });
        if corners.len() > MAX_CORNERS {
            return refuse(format!("{} corners, at most {MAX_CORNERS} are taken", corners.len()));
        }
        let mut lowest_rad = FRAC_PI_2;
        for corner in &corners {
            if !corner.azimuth_rad.is_finite() {
                return refuse("an azimuth is no number".to_owned());
            }
            check_range("region", corner.elevation_rad, 0.0, FRAC_PI_2 + 1e-12, "rad")?;
            lowest_rad = lowest_rad.min(corner.elevation_rad);
        }
        let mut corners: Vec<DVec3> = corners.into_iter().map(Direction::enu).collect();
        corners.dedup_by(|a, b| a.distance(*b) < SAME_CORNER_RAD);
        while corners.len() > 1 && corners[0].distance(corners[corners.len() - 1]) < SAME_CORNER_RAD {
            corners.pop();
        }
        if corners.len() < 3 {
            return refuse(format!("{} different corners, a curve needs three", corners.len()));
        }
        let next = corners.iter().cycle().skip(1);
        if corners.iter().zip(next).any(|(a, b)| (*a + *b).length() < SAME_CORNER_RAD) {
            return refuse("two neighbouring corners lie on opposite sides of the horizon".to_owned());
        }
        Ok(Self { corners, lowest_rad })
    }

    /// Whether the curve winds around a direction above the horizontal plane.
    pub fn holds(&self, direction: Direction) -> bool {
        // A great circle between two corners above the horizon never sinks below the lower one.
        if direction.elevation_rad < self.lowest_rad {
            return false;
        }
        let here = direction.enu();
        let next = self.corners.iter().cycle().skip(1);
        let turned: f64 = self.corners.iter().zip(next).map(|(a, b)| angle_rad(here, *a, *b)).sum();
        turned.abs() > 0.5 * TAU
    }

    /// For every direction of the panorama grid whether it is inside, `[row][column]`.
    pub fn directions_inside(&self) -> Vec<bool> {
        let direction = |at: usize| Direction {
            azimuth_rad: azimuth_rad(at % AZIMUTH_COUNT),
            elevation_rad: elevation_rad(at / AZIMUTH_COUNT),
        };
        (0..ELEVATION_COUNT * AZIMUTH_COUNT).into_par_iter().map(|at| self.holds(direction(at))).collect()
    }
}

/// The angle at `here` from `a` to `b`, −π..π.
fn angle_rad(here: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (a - here * a.dot(here), b - here * b.dot(here));
    here.dot(a.cross(b)).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(azimuth_deg: f64, elevation_deg: f64) -> Direction {
        Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }
    }

    fn curve(corners_deg: &[(f64, f64)]) -> SkyCurve {
        SkyCurve::new(corners_deg.iter().map(|&(a, e)| at(a, e)).collect()).unwrap()
    }

    /// A curve that passes north contains what lies north.
    #[test]
    fn a_curve_through_north_contains_north() {
        let north = curve(&[(350.0, 10.0), (10.0, 10.0), (10.0, 40.0), (350.0, 40.0)]);
        assert!(north.holds(at(0.0, 20.0)) && north.holds(at(355.0, 30.0)) && north.holds(at(5.0, 30.0)));
        assert!(!north.holds(at(20.0, 20.0)) && !north.holds(at(180.0, 20.0)) && !north.holds(at(0.0, 50.0)));
        // Azimuths beyond a turn are the same ones.
        assert_eq!(
            north.directions_inside(),
            curve(&[(-10.0, 10.0), (370.0, 10.0), (370.0, 40.0), (-10.0, 40.0)]).directions_inside()
        );
    }

    /// A curve around the zenith contains it, and one that touches it is a sector.
    #[test]
    fn a_curve_around_the_zenith_contains_it() {
        let cap: Vec<(f64, f64)> = (0..36).map(|k| (10.0 * f64::from(k), 60.0)).collect();
        let inside = curve(&cap).directions_inside();
        let rows = |inside: &[bool], row: usize| {
            inside[row * AZIMUTH_COUNT..][..AZIMUTH_COUNT].iter().filter(|inside| **inside).count()
        };
        // Row 43 is 61.2° up; between corners the sides rise to 60.1°.
        assert_eq!((rows(&inside, 63), rows(&inside, 43), rows(&inside, 41)), (256, 256, 0));
        let sector = curve(&[(0.0, 90.0), (0.0, 30.0), (90.0, 30.0)]);
        assert!(sector.holds(at(45.0, 80.0)) && !sector.holds(at(225.0, 80.0)));
        // Those on its sides may fall either way.
        assert!((63..=65).contains(&rows(&sector.directions_inside(), 60)));
    }

    /// Both loops of an eight are inside, whichever way it is drawn.
    #[test]
    fn both_loops_of_an_eight_are_inside() {
        let eight = [(0.0, 20.0), (40.0, 40.0), (40.0, 20.0), (0.0, 40.0)];
        let mut backwards = eight;
        backwards.reverse();
        for drawn in [curve(&eight), curve(&backwards)] {
            assert!(drawn.holds(at(4.0, 30.0)) && drawn.holds(at(36.0, 30.0)));
            assert!(!drawn.holds(at(20.0, 24.0)) && !drawn.holds(at(20.0, 40.0)));
        }
    }

    #[test]
    fn what_is_no_curve_is_refused_by_name() {
        let refused = |corners: Vec<Direction>| SkyCurve::new(corners).unwrap_err().to_string();
        assert!(refused(vec![]).contains("region"));
        assert!(refused(vec![at(0.0, 10.0), at(10.0, 10.0), at(0.0, 10.0)]).contains("2 different corners"));
        assert!(refused(vec![at(0.0, 10.0), at(f64::NAN, 10.0), at(5.0, 20.0)]).contains("no number"));
        assert!(refused(vec![at(0.0, -1.0), at(9.0, 10.0), at(5.0, 20.0)]).contains("region"));
        assert!(refused(vec![at(0.0, 0.0), at(180.0, 0.0), at(5.0, 20.0)]).contains("opposite"));
        assert!(refused(vec![at(0.0, 5.0); MAX_CORNERS + 1]).contains("at most"));
    }

    proptest! {
        #[test]
        fn turning_a_curve_turns_what_it_holds(
            corners in prop::collection::vec((0.0f64..360.0, 0.5f64..89.5), 3..9), turns in 0usize..AZIMUTH_COUNT,
        ) {
            let turn_deg = turns as f64 * 360.0 / AZIMUTH_COUNT as f64;
            let turned: Vec<(f64, f64)> = corners.iter().map(|&(a, e)| (a + turn_deg, e)).collect();
            let (Ok(here), Ok(there)) = (
                SkyCurve::new(corners.iter().map(|&(a, e)| at(a, e)).collect()),
                SkyCurve::new(turned.iter().map(|&(a, e)| at(a, e)).collect()),
            ) else { return Ok(()) };
            let (here, there) = (here.directions_inside(), there.directions_inside());
            let differing = (0..here.len()).filter(|&i| {
                let (row, column) = (i / AZIMUTH_COUNT, i % AZIMUTH_COUNT);
                here[i] != there[row * AZIMUTH_COUNT + (column + turns) % AZIMUTH_COUNT]
            });
            // A direction right on a side may fall either way.
            prop_assert!(differing.count() <= 2);
        }
    }
}
