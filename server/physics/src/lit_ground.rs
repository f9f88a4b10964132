//! Ground in light as an eye sees it: what a picture of a landscape is made of (`docs/model.md#lit-ground`).

use crate::panorama::Direction;
use std::f64::consts::TAU;

/// X, Y, Z and scotopic luminance, cd m⁻², or illuminance, lx.
pub type SeenLight = [f64; 4];

/// Ground along one azimuth, front to back and upwards in the view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LitLine {
    /// tan of the elevation of each point, ascending.
    pub tangents: Vec<f32>,
    /// What is seen of each, cd m⁻².
    pub light: Vec<[f32; 4]>,
    /// Whether a ridge lies between its predecessor and a point: nothing is interpolated across it.
    pub is_behind_ridge: Vec<bool>,
}

/// Ground around an eye, and lamps that stand on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LitGround {
    /// Azimuth of the first line, radians clockwise from north.
    pub first_azimuth_rad: f64,
    /// From line to line.
    pub step_rad: f64,
    /// Lines clockwise.
    pub lines: Vec<LitLine>,
    /// Where lamps are seen, and their illuminance of a surface that faces them, lx.
    pub lamps: Vec<(Direction, SeenLight)>,
}

impl LitGround {
    /// What is seen of the ground in a direction; None where there is sky or no line.
    pub fn light(&self, direction: Direction) -> Option<SeenLight> {
        let line = &self.lines[self.line_at(direction.azimuth_rad)?];
        let tangent = direction.elevation_rad.tan() as f32;
        if line.tangents.last().is_none_or(|highest| *highest < tangent) {
            return None;
        }
        let above = line.tangents.partition_point(|of| *of < tangent);
        let here = line.light.get(above)?;
        let before = above.checked_sub(1).filter(|_| !line.is_behind_ridge[above]);
        let Some(before) = before else { return Some(here.map(f64::from)) };
        let (low, high) = (line.tangents[before], line.tangents[above]);
        let weight = if high > low { f64::from((tangent - low) / (high - low)) } else { 1.0 };
        let from = line.light[before];
        Some(std::array::from_fn(|i| f64::from(from[i]) + weight * (f64::from(here[i]) - f64::from(from[i]))))
    }

    /// The line nearest to an azimuth, rad; None where there is none.
    pub fn line_at(&self, azimuth_rad: f64) -> Option<usize> {
        let turns = (azimuth_rad - self.first_azimuth_rad + 0.5 * self.step_rad) * (1.0 / TAU);
        let line = ((turns - turns.floor()) * TAU / self.step_rad) as usize;
        (line < self.lines.len()).then_some(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looking(azimuth_rad: f64, elevation_rad: f64) -> Direction {
        Direction { azimuth_rad, elevation_rad }
    }

    /// Between two points light is interpolated, not across a ridge; above the last there is sky, beside the lines nothing.
    #[test]
    fn light_is_that_of_the_point_in_view() {
        let line = LitLine {
            tangents: vec![-0.5, -0.1, 0.1],
            light: vec![[1.0; 4], [3.0; 4], [9.0; 4]],
            is_behind_ridge: vec![false, false, true],
        };
        let ground = LitGround {
            first_azimuth_rad: 6.2,
            step_rad: 0.1,
            lines: vec![line.clone(), LitLine::default(), line],
            lamps: Vec::new(),
        };
        let at = |azimuth_rad: f64, tangent: f64| {
            ground.light(looking(azimuth_rad, tangent.atan())).map(|light| light[1])
        };
        let close = |found: Option<f64>, expected: f64| {
            assert!((found.unwrap() - expected).abs() < 1e-5, "{found:?} {expected}");
        };
        close(at(6.2, -0.9), 1.0);
        close(at(6.2, -0.3), 2.0);
        close(at(6.2, -0.05), 9.0);
        // Across north.
        close(at(0.12, 0.09), 9.0);
        assert_eq!((at(6.2, 0.2), at(6.3, -0.3), at(1.0, -0.3)), (None, None, None));
    }
}
