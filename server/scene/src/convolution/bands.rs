//! Bands of distance, each on a raster of its own fineness, that fade into one another.

use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;

/// Pixels around a place that stand by themselves at their own altitudes.
const NEAREST_PIXELS: f64 = 5.0;
/// Cells of a level that its band reaches: it fades out over the outer half of them.
const REACH_CELLS: f64 = 32.0;
/// Cells that the outermost band reaches at most.
const MAX_REACH_CELLS: f64 = 96.0;
/// Smallest and largest step of the altitudes of places and of lights, metres; between them it is this part of the distance.
const MIN_STEP_M: f64 = 50.0;
const MAX_PLACE_STEP_M: f64 = 250.0;
const MAX_LIGHT_STEP_M: f64 = 250.0;
const STEP_PER_DISTANCE: f64 = 0.07;

/// Where a band begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edge {
    /// At a distance, metres.
    Sharp(f64),
    /// Between half of a distance and all of it, metres.
    Smooth(f64),
}

impl Edge {
    /// The part of a light at a distance that lies beyond the edge, 0..=1.
    fn beyond(self, distance_m: f64) -> f64 {
        match self {
            Self::Sharp(at_m) => f64::from(u8::from(distance_m >= at_m)),
            Self::Smooth(end_m) => {
                let along = (2.0 * distance_m / end_m - 1.0).clamp(0.0, 1.0);
                along * along * along * (10.0 + along * (6.0 * along - 15.0))
            }
        }
    }

    fn first_m(self) -> f64 {
        match self {
            Self::Sharp(at_m) => at_m,
            Self::Smooth(end_m) => 0.5 * end_m,
        }
    }

    fn last_m(self) -> f64 {
        match self {
            Self::Sharp(at_m) | Self::Smooth(at_m) => at_m,
        }
    }
}

/// Lights at some distances of a place, on cells of 2^level × 2^level pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub(super) level: u32,
    from: Edge,
    to: Edge,
}

impl Band {
    /// The bands of a raster with pixels of a size; the shares of all of them add up to 1 at every distance up to 300 km.
    pub(super) fn all(pixel_m: f64) -> Vec<Self> {
        let cell_m = |level: u32| pixel_m * f64::from(1 << level);
        let top =
            (0..16).find(|&level| MAX_SOURCE_DISTANCE_M <= MAX_REACH_CELLS * cell_m(level)).unwrap_or(16);
        let nearest = Edge::Sharp(NEAREST_PIXELS * pixel_m);
        let edge = |level: u32| Edge::Smooth(REACH_CELLS * cell_m(level));
        let of_level = |level: u32| Self {
            level,
            from: if level == 0 { nearest } else { edge(level - 1) },
            to: if level == top { Edge::Sharp(f64::INFINITY) } else { edge(level) },
        };
        std::iter::once(Self { level: 0, from: Edge::Sharp(0.0), to: nearest })
            .chain((0..=top).map(of_level))
            .filter(|band| band.from.first_m() <= MAX_SOURCE_DISTANCE_M)
            .collect()
    }

    /// The part of a light at a distance that it has, 0..=1.
    pub(super) fn share(&self, distance_m: f64) -> f64 {
        self.from.beyond(distance_m) * (1.0 - self.to.beyond(distance_m))
    }

    /// It has nothing of lights farther than this, metres.
    pub(super) fn reach_m(&self) -> f64 {
        self.to.last_m().min(MAX_SOURCE_DISTANCE_M)
    }

    /// Pixels along a side of its cells.
    pub(super) fn cell_pixels(&self) -> u32 {
        1 << self.level
    }

    /// Steps of the altitudes of places and of lights, metres.
    pub(super) fn steps_m(&self) -> [f64; 2] {
        let step_m = STEP_PER_DISTANCE * self.from.first_m();
        [MAX_PLACE_STEP_M, MAX_LIGHT_STEP_M].map(|most_m| step_m.clamp(MIN_STEP_M, most_m))
    }
}

/// Weights of four evenly spaced cells at a place 0..=1 between the middle two (Lagrange): cubics come out as they are.
pub(super) fn cubic_weights(t: f64) -> [f32; 4] {
    let (before, after, last) = (t + 1.0, t - 1.0, t - 2.0);
    [-t * after * last / 6.0, before * after * last / 2.0, -before * t * last / 2.0, before * t * after / 6.0]
        .map(|weight| weight as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At every distance up to 300 km the bands together have all of a light.
    #[test]
    fn bands_share_all_light() {
        for pixel_m in [30.0, 463.0, 930.0, 4_000.0, 90_000.0] {
            let bands = Band::all(pixel_m);
            for distance_m in (0..3_000).map(|at| 100.0 * f64::from(at)) {
                let sum: f64 = bands.iter().map(|band| band.share(distance_m)).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{pixel_m} {distance_m}: {sum}");
                let beyond = bands.iter().filter(|band| distance_m > band.reach_m());
                assert!(beyond.map(|band| band.share(distance_m)).sum::<f64>() == 0.0);
            }
        }
    }

    #[test]
    fn weights_of_cells_are_cubic() {
        let f = |x: f64| 1.0 + x * (0.5 - x * (0.3 - 0.2 * x));
        for t in [0.0, 0.25, 0.5, 0.9] {
            let values = [-1.0, 0.0, 1.0, 2.0].map(f);
            let sum: f64 = cubic_weights(t).iter().zip(values).map(|(w, v)| f64::from(*w) * v).sum();
            assert!((sum - f(t)).abs() < 1e-6);
        }
    }
}
