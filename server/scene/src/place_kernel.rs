//! A point-source kernel as a table with multilinear interpolation: what one DNB watt adds to a number of the sky at a place,
//! such as its luminance at the zenith.

use crate::polar_grid::{RING_COUNT, log_distance};
use glam::{DVec3, Vec2, Vec3};
use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M};
use std::sync::Arc;

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

/// How what a light does to a place depends on the azimuth in which it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AzimuthFactor {
    /// Not at all.
    Even,
    /// north·cos(m·azimuth) + east·sin(m·azimuth) for an order m.
    Wave {
        /// m, at least 1.
        order: u8,
        /// Weight of the cosine.
        north: f32,
        /// Weight of the sine.
        east: f32,
    },
}

impl AzimuthFactor {
    /// Its value for a light in a horizontal direction, [east, north] of length 1; for a light right below or above no wave has any.
    #[inline(always)]
    pub fn towards(self, direction: Vec2) -> f32 {
        let Vec2 { x: sin, y: cos } = direction;
        match self {
            Self::Even => 1.0,
            Self::Wave { order, north, east } => {
                // De Moivre.
                let (mut wave_cos, mut wave_sin) = (cos, sin);
                for _ in 1..order {
                    (wave_cos, wave_sin) = (wave_cos * cos - wave_sin * sin, wave_cos * sin + wave_sin * cos);
                }
                north * wave_cos + east * wave_sin
            }
        }
    }
}

/// East and north at a place, as unit vectors in the Earth-centred frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Compass([Vec3; 2]);

impl Compass {
    /// At a place by its unit vector; at the poles east is as at longitude 0.
    pub(crate) fn at(up: DVec3) -> Self {
        let east = DVec3::Z.cross(up).try_normalize().unwrap_or(DVec3::Y);
        Self([east.as_vec3(), up.cross(east).as_vec3()])
    }

    /// The horizontal direction, [east, north] of length 1, of what lies away from the place; 0 where it has none.
    #[inline(always)]
    pub(crate) fn towards(&self, away: Vec3) -> Vec2 {
        Vec2::new(self.0[0].dot(away), self.0[1].dot(away)).normalize_or_zero()
    }
}

/// A table of a kernel, and how it counts by azimuth.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    factor: AzimuthFactor,
    /// `[altitude][ring][offset][blocking]`, per DNB watt.
    values: Arc<[f32]>,
}

/// What one DNB watt adds to a number at a place, by the place's altitude, distance, height of the light over the place and
/// the light's skyline, and the azimuth of the light where it counts. Linear between its nodes, in ln(distance) as polar grids have it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceKernel {
    /// Altitudes of the place, metres above sea level.
    altitudes: UniformAxis,
    /// Height of the light over the place, metres.
    offsets: UniformAxis,
    /// Blocking angles: 1, the open sky, or all.
    blocking_count: usize,
    /// At least one; they add up.
    parts: Vec<Part>,
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
        let parts = vec![Part { factor: AzimuthFactor::Even, values: values.into() }];
        fits.then_some(Self { altitudes, offsets, blocking_count, parts })
    }

    /// A sum of kernels that know no azimuth, each with a factor by the azimuth of the light; None where there are none, or for
    /// kernels with other nodes than the first.
    pub fn of_waves<'a>(kernels: impl IntoIterator<Item = (&'a Self, AzimuthFactor)>) -> Option<Self> {
        let mut sum: Option<Self> = None;
        for (kernel, factor) in kernels {
            let parts = kernel.parts.iter().map(|part| Part { factor, values: Arc::clone(&part.values) });
            match &mut sum {
                None => sum = Some(Self { parts: parts.collect(), ..kernel.clone() }),
                Some(sum) if kernel.has_nodes_of(sum) => sum.parts.extend(parts),
                Some(_) => return None,
            }
        }
        sum
    }

    fn has_nodes_of(&self, other: &Self) -> bool {
        (self.altitudes, self.offsets, self.blocking_count)
            == (other.altitudes, other.offsets, other.blocking_count)
    }

    /// Whether the azimuth of a light counts; then sums may be below 0.
    pub(crate) fn knows_azimuth(&self) -> bool {
        self.factors().any(|factor| factor != AzimuthFactor::Even)
    }

    /// How its parts count by azimuth.
    pub(crate) fn factors(&self) -> impl Iterator<Item = AzimuthFactor> {
        self.parts.iter().map(|part| part.factor)
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
    /// * `towards`: the light, [east, north] of length 1; of no account where it knows no azimuth.
    #[inline(always)]
    pub(crate) fn at(
        &self,
        altitude: usize,
        ring: RingPosition,
        offset_m: f32,
        blocking: f32,
        towards: Vec2,
    ) -> f32 {
        match self.blocking_count {
            1 => self.sum_of_parts(altitude, ring, offset_m, towards, &|values: &[f32; 1]| values[0]),
            _ => self.sum_of_parts(altitude, ring, offset_m, towards, &between_blockings(blocking)),
        }
    }

    /// What a skyline takes from that: at most 0 where no azimuth counts.
    #[inline(always)]
    pub(crate) fn hidden(
        &self,
        altitude: usize,
        ring: RingPosition,
        offset_m: f32,
        blocking: f32,
        towards: Vec2,
    ) -> f32 {
        if blocking <= 0.0 || self.blocking_count == 1 {
            return 0.0;
        }
        let behind = between_blockings(blocking);
        self.sum_of_parts(altitude, ring, offset_m, towards, &|values| behind(values) - values[0])
    }

    #[inline(always)]
    fn sum_of_parts<const BLOCKINGS: usize>(
        &self,
        altitude: usize,
        ring: RingPosition,
        offset_m: f32,
        towards: Vec2,
        of_blockings: &impl Fn(&[f32; BLOCKINGS]) -> f32,
    ) -> f32 {
        let Some((first, others)) = self.parts.split_first() else { return 0.0 };
        let mut sum =
            first.factor.towards(towards) * self.of_part(first, altitude, ring, offset_m, of_blockings);
        for part in others {
            sum += part.factor.towards(towards) * self.of_part(part, altitude, ring, offset_m, of_blockings);
        }
        sum
    }

    /// A part by its number at a ring, under an open sky, whatever the azimuth.
    pub(crate) fn on_ring(&self, part: usize, altitude: usize, ring: usize, offset_m: f32) -> f32 {
        let part = self.parts.get(part);
        let ring = RingPosition::node(ring);
        part.map_or(0.0, |part| match self.blocking_count {
            1 => self.of_part(part, altitude, ring, offset_m, &|values: &[f32; 1]| values[0]),
            _ => self.of_part(part, altitude, ring, offset_m, &|values: &[f32; BLOCKING_COUNT]| values[0]),
        })
    }

    /// Linear between heights and rings.
    ///
    /// * `of_blockings`: of the values of all blocking angles, of which there are `BLOCKINGS`.
    #[inline(always)]
    fn of_part<const BLOCKINGS: usize>(
        &self,
        part: &Part,
        altitude: usize,
        ring: RingPosition,
        offset_m: f32,
        of_blockings: &impl Fn(&[f32; BLOCKINGS]) -> f32,
    ) -> f32 {
        let (below, up) = self.offsets.position(offset_m);
        let of_ring = |ring: usize| {
            let start = ((altitude * RING_COUNT + ring) * self.offsets.count + below) * BLOCKINGS;
            let [low, high] = &part.values[start..start + 2 * BLOCKINGS].as_chunks::<BLOCKINGS>().0 else {
                return 0.0;
            };
            let (low, high) = (of_blockings(low), of_blockings(high));
            low + up * (high - low)
        };
        let (near, far) = (of_ring(ring.ring), of_ring(ring.ring + 1));
        near + ring.out * (far - near)
    }
}

/// Linear between the values of blocking angles.
#[inline(always)]
fn between_blockings(blocking: f32) -> impl Fn(&[f32; BLOCKING_COUNT]) -> f32 {
    let lower = (blocking as usize).min(BLOCKING_COUNT - 2);
    let along = blocking - lower as f32;
    move |values| values[lower] + along * (values[lower + 1] - values[lower])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar_grid::ring_distance_m;
    use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

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
                let got = kernel.at(2, place, -130.0, blocking, Vec2::ZERO);
                let wanted = value(2, ring, 0, 0) as f64 + 40.0 * 0.7 + 3.0 * f64::from(blocking);
                assert!((f64::from(got) - wanted).abs() < 0.02, "{got} {wanted}");
            }
            let near = RingPosition::of_square(0.0).unwrap();
            assert_eq!(kernel.at(0, near, -900.0, 0.0, Vec2::ZERO), value(0, 0, 0, 0));
            assert_eq!(kernel.at(0, near, 900.0, 0.0, Vec2::ZERO), value(0, 0, 4, 0));
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

    /// Waves count by the azimuth of the light, as their order says, and kernels with other nodes do not add up.
    #[test]
    fn waves_turn_with_the_light() {
        let axis = UniformAxis { first_m: 0.0, step_m: 100.0, count: 2 };
        let even = |value: f32, axis: UniformAxis| {
            PlaceKernel::new(axis, axis, 1, vec![value; 4 * RING_COUNT]).unwrap()
        };
        let wave = |order: u8, north: f32, east: f32| AzimuthFactor::Wave { order, north, east };
        let (one, two) = (even(1.0, axis), even(2.0, axis));
        let parts = [(&two, AzimuthFactor::Even), (&one, wave(1, 0.5, 0.25)), (&two, wave(2, 0.5, 0.25))];
        let kernel = PlaceKernel::of_waves(parts).unwrap();
        assert!(kernel.knows_azimuth() && !two.knows_azimuth());
        let up = GeoPoint::from_deg(46.0, 8.0).unwrap();
        let compass = Compass::at(up.unit_vector());
        for azimuth_deg in [0.0f64, 30.0, 135.0, 260.0] {
            let azimuth_rad = azimuth_deg.to_radians();
            let away = up.destination(azimuth_rad, 1e4).unit_vector() - up.unit_vector();
            let towards = compass.towards((EARTH_RADIUS_M * away).as_vec3());
            let ring = RingPosition::of_square(1e8).unwrap();
            let (one, two) = (azimuth_rad.sin_cos(), (2.0 * azimuth_rad).sin_cos());
            let wanted = 2.0 + 0.5 * one.1 + 0.25 * one.0 + 2.0 * (0.5 * two.1 + 0.25 * two.0);
            let found = f64::from(kernel.at(0, ring, 0.0, 0.0, towards));
            assert!((found - wanted).abs() < 1e-4, "{azimuth_deg}: {found} {wanted}");
        }
        let other = even(1.0, UniformAxis { step_m: 90.0, ..axis });
        assert!(
            PlaceKernel::of_waves([(&one, AzimuthFactor::Even), (&other, AzimuthFactor::Even)]).is_none()
        );
    }
}
