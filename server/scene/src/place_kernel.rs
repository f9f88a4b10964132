//! A point-source kernel as a table with multilinear interpolation: what one DNB watt adds to a number of the sky at a place,
//! such as its luminance at the zenith.

use crate::polar_grid::{RING_COUNT, log_distance};
use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M};

/// Evenly spaced nodes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformAxis {
    /// The lowest node.
    pub first_m: f64,
    /// From one to the next; above 0.
    pub step_m: f64,
    /// How many; at least 2.
    pub count: usize,
}

impl UniformAxis {
    /// From `first_m` to `last_m` by steps of `step_m` or less, of which there are `max_steps` at most; one step where both are the same.
    pub fn between(first_m: f64, last_m: f64, step_m: f64, max_steps: usize) -> Self {
        let range_m = (last_m - first_m).max(0.0);
        let steps = (range_m / step_m).ceil().clamp(1.0, max_steps.max(1) as f64);
        let step_m = if range_m > 0.0 { range_m / steps } else { step_m };
        Self { first_m, step_m, count: 1 + steps as usize }
    }

    /// Node `index`, metres.
    pub fn node_m(&self, index: usize) -> f64 {
        self.first_m + self.step_m * index as f64
    }

    /// The node below a place and the weight of the next; what lies beyond an end counts as there.
    #[inline(always)]
    pub(crate) fn position(&self, at_m: f32) -> (usize, f32) {
        let place = ((at_m - self.first_m as f32) / self.step_m as f32).clamp(0.0, (self.count - 1) as f32);
        let below = (place as usize).min(self.count - 2);
        (below, place - below as f32)
    }

    /// The weight of a node at a place; 0 for no number.
    #[inline(always)]
    pub(crate) fn weight(&self, node: usize, at_m: f32) -> f32 {
        let (below, up) = self.position(at_m);
        match node {
            _ if at_m.is_nan() => 0.0,
            _ if node == below => 1.0 - up,
            _ if node == below + 1 => up,
            _ => 0.0,
        }
    }
}

/// What one DNB watt adds to a number at a place, by the place's altitude, distance, height of the light over the place and
/// the light's skyline. Linear between its nodes, in ln(distance) as polar grids have it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceKernel {
    /// Altitudes of the place, metres above sea level.
    altitudes: UniformAxis,
    /// Height of the light over the place, metres.
    offsets: UniformAxis,
    /// Blocking angles: 1, the open sky, or all.
    blocking_count: usize,
    /// `[altitude][ring][offset][blocking]`, per DNB watt.
    values: Vec<f32>,
}

/// A distance on the rings of a polar grid: the ring below and the weight of the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingPosition {
    ring: usize,
    out: f32,
}

impl RingPosition {
    /// Of a squared distance, m²: nearer than 250 m counts as there. None beyond 300 km, and for no number.
    #[inline(always)]
    pub(crate) fn of_square(square_m2: f32) -> Option<Self> {
        const MAX_DISTANCE_M2: f32 = (MAX_SOURCE_DISTANCE_M * MAX_SOURCE_DISTANCE_M) as f32;
        if square_m2.is_nan() || square_m2 > MAX_DISTANCE_M2 {
            return None;
        }
        const PER_NEAREST_M2: f32 = (1.0 / (MIN_SOURCE_DISTANCE_M * MIN_SOURCE_DISTANCE_M)) as f32;
        Some(Self::of_log(0.5 * (square_m2 * PER_NEAREST_M2).max(1.0).ln()))
    }

    /// Of ln(distance/250 m), at least 0.
    #[inline(always)]
    fn of_log(log: f32) -> Self {
        let rings_per_log =
            (RING_COUNT - 1) as f32 / (MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M).ln() as f32;
        let place = (log * rings_per_log).min((RING_COUNT - 1) as f32);
        let ring = (place as usize).min(RING_COUNT - 2);
        Self { ring, out: place - ring as f32 }
    }

    /// Of a ring itself.
    pub(crate) fn node(ring: usize) -> Self {
        let below = ring.min(RING_COUNT - 2);
        Self { ring: below, out: (ring - below) as f32 }
    }

    /// The ring below and the weight of the next.
    pub(crate) fn parts(self) -> (usize, f32) {
        (self.ring, self.out)
    }

    /// ln(distance/250 m).
    #[inline(always)]
    pub(crate) fn log_distance(self) -> f64 {
        let log_step = log_distance(MAX_SOURCE_DISTANCE_M) / (RING_COUNT - 1) as f64;
        (self.ring as f64 + f64::from(self.out)) * log_step
    }
}

impl PlaceKernel {
    /// From its values, `[altitude][ring][offset][blocking]`, per DNB watt; None where their number does not fit.
    ///
    /// * `blocking_count`: 1 for the open sky alone, or [`BLOCKING_COUNT`].
    pub fn new(
        altitudes: UniformAxis,
        offsets: UniformAxis,
        blocking_count: usize,
        values: Vec<f32>,
    ) -> Option<Self> {
        let fits = altitudes.count >= 2
            && offsets.count >= 2
            && (blocking_count == 1 || blocking_count == BLOCKING_COUNT)
            && values.len() == altitudes.count * RING_COUNT * offsets.count * blocking_count;
        fits.then_some(Self { altitudes, offsets, blocking_count, values })
    }

    /// The altitudes of places.
    pub fn altitudes(&self) -> UniformAxis {
        self.altitudes
    }

    /// Whether it knows lights behind skylines.
    pub(crate) fn knows_skylines(&self) -> bool {
        self.blocking_count > 1
    }

    /// Per DNB watt at a node of the axis of altitudes.
    ///
    /// * `offset_m`: height of the light over the place.
    /// * `blocking`: place on the axis of blocking angles, 0..=7.
    #[inline(always)]
    pub(crate) fn at(&self, altitude: usize, ring: RingPosition, offset_m: f32, blocking: f32) -> f32 {
        let (below, up) = self.offsets.position(offset_m);
        let of_ring = |ring: usize| {
            let start = ((altitude * RING_COUNT + ring) * self.offsets.count + below) * self.blocking_count;
            if self.blocking_count == 1 {
                let values = &self.values[start..start + 2];
                return values[0] + up * (values[1] - values[0]);
            }
            let lower = (blocking as usize).min(BLOCKING_COUNT - 2);
            let along = blocking - lower as f32;
            let values = &self.values[start + lower..start + lower + BLOCKING_COUNT + 2];
            let of_offset = |first: usize| values[first] + along * (values[first + 1] - values[first]);
            let (low, high) = (of_offset(0), of_offset(BLOCKING_COUNT));
            low + up * (high - low)
        };
        let (near, far) = (of_ring(ring.ring), of_ring(ring.ring + 1));
        near + ring.out * (far - near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar_grid::ring_distance_m;

    #[test]
    fn nodes_are_found_and_between_them_it_is_linear() {
        let axis = |first_m, step_m, count| UniformAxis { first_m, step_m, count };
        let (altitudes, offsets) = (axis(100.0, 250.0, 3), axis(-200.0, 100.0, 5));
        let value = |altitude: usize, ring: usize, offset: usize, blocking: usize| {
            (altitude * 1000 + ring * 5 + offset * 40 + blocking * 3) as f32
        };
        for blocking_count in [1, BLOCKING_COUNT] {
            let mut values = Vec::new();
            for altitude in 0..3 {
                for ring in 0..RING_COUNT {
                    for offset in 0..5 {
                        values.extend((0..blocking_count).map(|e| value(altitude, ring, offset, e)));
                    }
                }
            }
            let kernel = PlaceKernel::new(altitudes, offsets, blocking_count, values.clone()).unwrap();
            assert!(PlaceKernel::new(altitudes, offsets, blocking_count, values[1..].to_vec()).is_none());
            for (ring, distance_m) in [0, 7, 100, 191].map(|ring| (ring, ring_distance_m(ring) as f32)) {
                let place = RingPosition::of_square(distance_m * distance_m * 0.999_999).unwrap();
                assert!((place.log_distance() - log_distance(f64::from(distance_m))).abs() < 1e-4);
                let blocking = if blocking_count == 1 { 0.0 } else { 6.5 };
                let got = kernel.at(2, place, -130.0, blocking);
                let wanted = value(2, ring, 0, 0) as f64 + 40.0 * 0.7 + 3.0 * f64::from(blocking);
                assert!((f64::from(got) - wanted).abs() < 0.02, "{got} {wanted}");
            }
            let near = RingPosition::of_square(0.0).unwrap();
            assert_eq!(kernel.at(0, near, -900.0, 0.0), value(0, 0, 0, 0));
            assert_eq!(kernel.at(0, near, 900.0, 0.0), value(0, 0, 4, 0));
        }
        assert!(RingPosition::of_square(300_100f32.powi(2)).is_none());
        assert!(RingPosition::of_square(f32::NAN).is_none());
        assert_eq!(UniformAxis::between(-30.0, 75.0, 50.0, 9), axis(-30.0, 35.0, 4));
        assert_eq!(UniformAxis::between(5.0, 5.0, 50.0, 9).count, 2);
        for range_m in (1..2_000).map(|i| 7.77 * f64::from(i)) {
            let axis = UniformAxis::between(-3.3, range_m - 3.3, 50.0, 255);
            assert!(axis.count <= 256 && (axis.node_m(axis.count - 1) - range_m + 3.3).abs() < 1e-6);
        }
    }
}
