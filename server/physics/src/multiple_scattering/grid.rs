//! The grid of places around a source: rings of distance from its vertical by layers of altitude.

use super::lanes::{LANES, Lanes};
use crate::simd::logarithm;
use crate::{cloud::CloudBase, geometry::EARTH_RADIUS_M};

/// Top of the grid above the sphere under a clear sky, metres: 4e-4 of the molecules lie above.
pub(super) const TOP_ALTITUDE_M: f64 = 62_000.0;
/// Outermost ring of the grid, metres of arc.
pub(super) const OUTER_DISTANCE_M: f64 = 420_000.0;
/// Rings are even in x = ln(1 + ρ/`RING_NEAR_M`) + ρ/`RING_FAR_M`: in proportion to distance, but no farther
/// apart than a step of `RING_FAR_M`, as light in haze falls exponentially far from the source.
const RING_NEAR_M: f64 = 60.0;
const RING_FAR_M: f64 = 100_000.0;
/// Distances above and below the source's altitude at which there is a layer, metres.
const LAYER_OFFSETS_M: [f64; 26] = [
    0.0, 30.0, 80.0, 150.0, 250.0, 400.0, 600.0, 850.0, 1_150.0, 1_500.0, 2_000.0, 2_600.0, 3_400.0, 4_400.0,
    5_600.0, 7_000.0, 9_000.0, 11_500.0, 14_500.0, 18_000.0, 22_000.0, 27_000.0, 33_000.0, 40_000.0,
    48_000.0, 56_000.0,
];

/// A source has layers of its own up to this share of their height over the ground. Higher up the ground's layers are as
/// close, and light far away must not depend on the choice: with all of the source's layers it changed by 1.8 % at
/// turbidity 6 when a source at 220 m rose by 28 m, now by at most a tenth of that beyond the effect of the height.
const OWN_SHARE: f64 = 0.5;

/// Second differences of a logarithm over rings above this are edges (of the disc that a lobe lights on a cloud), not curves.
const EDGE_CURVATURE: f32 = 0.2;

/// Places (ρ, z): rings about the source's vertical by layers of altitude. Index `layer · rings + ring`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FieldGrid {
    ring_step: f64,
    ring_m: Vec<f64>,
    layer_m: Vec<f64>,
}

/// A position between two neighbours: the lower index and the weight of the upper one, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LinearStencil {
    pub(super) lower: usize,
    pub(super) upper_weight: f64,
}

/// An altitude among the layers: the two around it, and a cubic over four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LayerStencil {
    pub(super) between: LinearStencil,
    /// Layers below, around and above; the nearest one again where there is none.
    pub(super) layers: [usize; 4],
    /// Their weights, summing to 1.
    pub(super) weights: [f32; 4],
}

/// Weights of f at three places for its slope at the middle one: that of the parabola through them. `before` and `after`
/// are the gaps between them.
fn slope_weights(before: f64, after: f64) -> [f64; 3] {
    let both = before + after;
    [-after / (before * both), (after - before) / (before * after), before / (after * both)]
}

/// x of a ring.
#[inline]
fn ring_coordinate(distance_m: f64) -> f64 {
    (distance_m / RING_NEAR_M).ln_1p() + distance_m / RING_FAR_M
}

/// As [`ring_coordinate`], to 1e-6, for every step of every ray.
#[inline(always)]
fn quick_ring_coordinate(distance_m: f64) -> f64 {
    f64::from(logarithm((1.0 + distance_m / RING_NEAR_M) as f32)) + distance_m / RING_FAR_M
}

/// dx/dρ, m⁻¹.
fn ring_density_per_m(distance_m: f64) -> f64 {
    1.0 / (RING_NEAR_M + distance_m) + 1.0 / RING_FAR_M
}

/// The distance with a given x, metres, by Newton's method; x is concave in ρ, so it climbs to the root from 0.
fn ring_distance_m(coordinate: f64) -> f64 {
    let mut distance_m = 0.0;
    for _ in 0..200 {
        let step_m = (coordinate - ring_coordinate(distance_m)) / ring_density_per_m(distance_m);
        distance_m += step_m;
        if step_m.abs() <= 1e-12 * distance_m {
            break;
        }
    }
    distance_m
}

/// Shifts the values at the rings such that linear interpolation has the mean of the smooth curve through them: lines
/// through the values of a curve are off by a twelfth of its second difference in the mean, always on the same side.
pub(super) fn set_lines_to_mean(ln_by_ring: &mut [Lanes]) {
    let mut before = None;
    for ring in 1..ln_by_ring.len().saturating_sub(1) {
        let here = ln_by_ring[ring];
        let (near, far) = (before.unwrap_or(ln_by_ring[ring - 1]), ln_by_ring[ring + 1]);
        for lane in 0..LANES {
            let curvature = near[lane] - 2.0 * here[lane] + far[lane];
            ln_by_ring[ring][lane] =
                here[lane] - curvature / (12.0 * (1.0 + (curvature / EDGE_CURVATURE).powi(4)));
        }
        before = Some(here);
    }
}

impl FieldGrid {
    /// Rings `ring_step` apart in x; layers dense about the source, the ground and the base of a cloud, which is the
    /// top one then, each gap cut into `layer_cuts` parts.
    pub(super) fn new(
        source_altitude_m: f64,
        ground_altitude_m: f64,
        cloud: Option<CloudBase>,
        ring_step: f64,
        layer_cuts: usize,
    ) -> Self {
        let top_m = cloud.map_or(TOP_ALTITUDE_M, CloudBase::altitude_m);
        let last = (ring_coordinate(OUTER_DISTANCE_M) / ring_step).ceil() as usize;
        let ring_m = (0..=last).map(|k| ring_distance_m(ring_step * k as f64)).collect();
        let mut layers: Vec<f64> = vec![ground_altitude_m, top_m];
        for offset_m in LAYER_OFFSETS_M {
            layers.push(ground_altitude_m + offset_m);
            if offset_m <= OWN_SHARE * (source_altitude_m + offset_m - ground_altitude_m) {
                layers.push(source_altitude_m + offset_m);
            }
            layers.push(source_altitude_m - offset_m);
            // Light changes below a base as it does above a ground.
            if cloud.is_some() && offset_m >= 80.0 {
                layers.push(top_m - offset_m);
            }
        }
        layers.retain(|&z| z >= ground_altitude_m && z <= top_m);
        layers.sort_by(f64::total_cmp);
        // Layers that nearly coincide are merged; the ground, the source's and the top one stay.
        let mut kept: Vec<f64> = Vec::new();
        for z in layers {
            let must = z == source_altitude_m || z == top_m || z == ground_altitude_m;
            match kept.last() {
                Some(&below) if z == below => {}
                Some(&below) => {
                    let mut away = (z - source_altitude_m).abs().min(z - ground_altitude_m);
                    if cloud.is_some() {
                        away = away.min(top_m - z);
                    }
                    let crowded = z - below < (0.2 * away).max(25.0);
                    let replaceable = below != source_altitude_m && below != ground_altitude_m;
                    if must && crowded && replaceable {
                        kept.pop();
                    }
                    if must || !crowded {
                        kept.push(z);
                    }
                }
                None => kept.push(z),
            }
        }
        let mut layer_m = vec![kept[0]];
        for pair in kept.windows(2) {
            for k in 1..=layer_cuts {
                layer_m.push(pair[0] + (pair[1] - pair[0]) * k as f64 / layer_cuts as f64);
            }
        }
        Self { ring_step, ring_m, layer_m }
    }

    /// Step between rings in their coordinate.
    pub(super) fn ring_step(&self) -> f64 {
        self.ring_step
    }

    pub(super) fn ring_count(&self) -> usize {
        self.ring_m.len()
    }

    pub(super) fn layer_count(&self) -> usize {
        self.layer_m.len()
    }

    pub(super) fn point_count(&self) -> usize {
        self.ring_m.len() * self.layer_m.len()
    }

    /// Altitudes of the layers, metres, ascending from the ground.
    pub(super) fn layer_m(&self) -> &[f64] {
        &self.layer_m
    }

    /// (ρ, z) of a place, metres.
    pub(super) fn place_m(&self, point: usize) -> (f64, f64) {
        (self.ring_m[point % self.ring_m.len()], self.layer_m[point / self.ring_m.len()])
    }

    /// Where a distance lies among the rings; None beyond the outermost.
    #[inline(always)]
    pub(super) fn ring_at(&self, distance_m: f64) -> Option<LinearStencil> {
        self.between_rings(self.ring_position(distance_m))
    }

    /// A distance in rings from the source's vertical.
    #[inline(always)]
    pub(super) fn ring_position(&self, distance_m: f64) -> f64 {
        quick_ring_coordinate(distance_m).max(0.0) / self.ring_step
    }

    /// The rings around a position, 0 or more; None beyond the outermost.
    #[inline(always)]
    pub(super) fn between_rings(&self, position: f64) -> Option<LinearStencil> {
        // Through i32, which converts in fewer instructions than usize.
        let lower = position as i32 as usize;
        (lower + 1 < self.ring_m.len())
            .then_some(LinearStencil { lower, upper_weight: position - lower as f64 })
    }

    /// The four points around a place between rings and layers, and their weights.
    #[inline(always)]
    pub(super) fn corners(&self, ring: LinearStencil, layer: LinearStencil) -> [(usize, f32); 4] {
        let (wr, wz) = (ring.upper_weight as f32, layer.upper_weight as f32);
        let first = layer.lower * self.ring_count() + ring.lower;
        [
            (first, (1.0 - wr) * (1.0 - wz)),
            (first + 1, wr * (1.0 - wz)),
            (first + self.ring_count(), (1.0 - wr) * wz),
            (first + self.ring_count() + 1, wr * wz),
        ]
    }

    /// Where an altitude lies among the layers, clamped to the ground and the top.
    pub(super) fn layer_at(&self, altitude_m: f64) -> LinearStencil {
        let upper = self.layer_m.partition_point(|&z| z <= altitude_m).clamp(1, self.layer_m.len() - 1);
        let (low, high) = (self.layer_m[upper - 1], self.layer_m[upper]);
        LinearStencil { lower: upper - 1, upper_weight: ((altitude_m - low) / (high - low)).clamp(0.0, 1.0) }
    }

    /// As [`Self::layer_at`], with a cubic that has at both layers the slope of the parabola through each and its
    /// neighbours; at the ground and the top that of the gap.
    pub(super) fn layer_stencil(&self, altitude_m: f64) -> LayerStencil {
        let between = self.layer_at(altitude_m);
        let (k, t) = (between.lower, between.upper_weight);
        let z = &self.layer_m;
        let gap_m = z[k + 1] - z[k];
        // Hermite's polynomials: values at both ends, slopes at both ends times the gap.
        let (lower, upper) = ((1.0 + 2.0 * t) * (1.0 - t).powi(2), t * t * (3.0 - 2.0 * t));
        let lower_slope_m = t * (1.0 - t).powi(2) * gap_m;
        let upper_slope_m = t * t * (t - 1.0) * gap_m;
        let mut weights = [0.0, lower, upper, 0.0];
        let mut add = |slope_m: f64, first: usize, part: [f64; 3]| {
            for (weight, part) in weights[first..].iter_mut().zip(part) {
                *weight += slope_m * part;
            }
        };
        let of_gap = [-1.0 / gap_m, 1.0 / gap_m, 0.0];
        if k > 0 {
            add(lower_slope_m, 0, slope_weights(z[k] - z[k - 1], gap_m));
        } else {
            add(lower_slope_m, 1, of_gap);
        }
        if k + 2 < z.len() {
            add(upper_slope_m, 1, slope_weights(gap_m, z[k + 2] - z[k + 1]));
        } else {
            add(upper_slope_m, 1, of_gap);
        }
        LayerStencil {
            between,
            layers: [k.saturating_sub(1), k, k + 1, (k + 2).min(z.len() - 1)],
            weights: weights.map(|weight| weight as f32),
        }
    }

    /// ∫ dV over the cells of the grid [m³]: calls `visit(ring, layer, volume)` at Gauss points of every cell.
    pub(super) fn for_each_volume(&self, mut visit: impl FnMut(LinearStencil, LinearStencil, f64, f64)) {
        let nodes = crate::quadrature::gauss_legendre(3);
        for layer in 0..self.layer_m.len() - 1 {
            let (low, high) = (self.layer_m[layer], self.layer_m[layer + 1]);
            for &(x, weight) in &nodes {
                let altitude_m = low + (high - low) * x;
                let stretch = 1.0 + altitude_m / EARTH_RADIUS_M;
                let height = weight * (high - low) * stretch * stretch;
                let layer = LinearStencil { lower: layer, upper_weight: x };
                self.for_each_area(|ring, area_m2| visit(ring, layer, altitude_m, area_m2 * height));
            }
        }
    }

    /// ∫ dA over the sphere of radius R [m²] out to the last ring: `visit(ring, area)` at Gauss points.
    pub(super) fn for_each_area(&self, mut visit: impl FnMut(LinearStencil, f64)) {
        let nodes = crate::quadrature::gauss_legendre(3);
        for ring in 0..self.ring_m.len() - 1 {
            for &(t, weight) in &nodes {
                let distance_m = ring_distance_m(self.ring_step * (ring as f64 + t));
                let width_m = weight * self.ring_step / ring_density_per_m(distance_m);
                let circle_m = std::f64::consts::TAU * EARTH_RADIUS_M * (distance_m / EARTH_RADIUS_M).sin();
                visit(LinearStencil { lower: ring, upper_weight: t }, circle_m * width_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Layers start at the ground, include the source and end at the top.
    #[test]
    fn layers_span_ground_to_top() {
        for (source, ground) in [(0.0, 0.0), (1_700.0, 1_700.0), (2_000.0, 300.0), (420.0, 400.0)] {
            let grid = FieldGrid::new(source, ground, None, 0.2, 1);
            assert_eq!(grid.layer_m[0], ground);
            assert_eq!(*grid.layer_m.last().unwrap(), TOP_ALTITUDE_M);
            assert!(grid.layer_m.contains(&source));
            assert!(grid.layer_m.windows(2).all(|pair| pair[1] > pair[0]));
            assert!(grid.layer_count() < 50, "{}", grid.layer_count());
        }
    }

    /// Lines along a curve have its mean, and edges stay.
    #[test]
    fn lines_at_mean_keep_the_mean() {
        let curve = |x: f64| -1.3 * x - 0.03 * x * x;
        let values: Vec<Lanes> = (0..12).map(|ring| [curve(f64::from(ring)) as f32; LANES]).collect();
        let mean_of_lines = |ln: &[Lanes]| -> f64 {
            ln[2..10].windows(2).map(|pair| 0.5 * f64::from(pair[0][1] + pair[1][1])).sum::<f64>() / 7.0
        };
        let mean = crate::quadrature::integrate_adaptive(2.0, 9.0, 1e-9, 0.0, |x| [curve(x)])[0] / 7.0;
        let mut lines = values.clone();
        set_lines_to_mean(&mut lines);
        let (through, off) = (mean_of_lines(&values) - mean, mean_of_lines(&lines) - mean);
        assert!(off.abs() < 0.05 * through.abs(), "{off} {through}");
        assert_eq!((lines[0], lines[11]), (values[0], values[11]));
        // Twenty times darker from the sixth ring on.
        let edge: Vec<Lanes> = (0..12).map(|ring| [if ring < 6 { 0.0 } else { -3.0 }; LANES]).collect();
        let mut lines = edge.clone();
        set_lines_to_mean(&mut lines);
        let moved = lines.iter().zip(&edge).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
        assert!(moved < 1e-3, "{moved}");
    }

    /// Layers far above a low source are those of the ground.
    #[test]
    fn high_layers_do_not_depend_on_low_sources() {
        let high = |source_m: f64| -> Vec<f64> {
            FieldGrid::new(source_m, 0.0, None, 0.2, 1).layer_m.into_iter().filter(|&z| z > 800.0).collect()
        };
        for source_m in [20.0, 150.0, 222.0, 262.0, 300.0] {
            assert_eq!(high(source_m), high(0.0), "{source_m}");
        }
        assert_ne!(high(1_200.0), high(0.0), "a high source has its own");
    }

    /// The base of a cloud is the top layer, and layers are close below it.
    #[test]
    fn the_cloud_base_is_the_top_layer() {
        for (source, ground, base) in
            [(0.0, 0.0, 200.0), (0.0, 0.0, 1_000.0), (900.0, 300.0, 950.0), (0.0, 0.0, 12_000.0)]
        {
            let cloud = CloudBase::lambertian(base, 0.5).unwrap();
            let grid = FieldGrid::new(source, ground, Some(cloud), 0.2, 1);
            assert_eq!(grid.layer_m[0], ground);
            assert_eq!(*grid.layer_m.last().unwrap(), base);
            assert!(grid.layer_m.contains(&source));
            assert!(grid.layer_m.windows(2).all(|pair| pair[1] - pair[0] > 10.0));
            let below = grid.layer_m[grid.layer_count() - 2];
            assert!(base - below <= 100.0, "{below} below {base}");
            assert!(grid.layer_count() < 45, "{}", grid.layer_count());
        }
    }

    /// Stencils over layers reproduce parabolas inside and lines at the ends.
    #[test]
    fn layer_stencils_reproduce_parabolas() {
        let grid = FieldGrid::new(0.0, 0.0, None, 0.2, 1);
        let at = |altitude_m: f64, f: &dyn Fn(f64) -> f64| -> f64 {
            let stencil = grid.layer_stencil(altitude_m);
            stencil.layers.iter().zip(stencil.weights).map(|(&k, w)| f64::from(w) * f(grid.layer_m[k])).sum()
        };
        for altitude_m in [0.0, 10.0, 30.0, 1_000.0, 1_777.0, 50_000.0, 61_000.0] {
            let line = |z: f64| 3.0 - 1e-3 * z;
            assert!((at(altitude_m, &line) - line(altitude_m)).abs() < 1e-4, "{altitude_m}");
            let parabola = |z: f64| 1.0 + 1e-3 * z - 1e-7 * z * z;
            let error = (at(altitude_m, &parabola) - parabola(altitude_m)).abs();
            assert!(error < 1e-4 || altitude_m > 48_000.0, "{altitude_m}: {error}");
        }
    }

    #[test]
    fn the_volume_of_the_cells_is_that_of_the_cap() {
        let grid = FieldGrid::new(0.0, 0.0, None, 0.2, 1);
        let mut volume = 0.0;
        grid.for_each_volume(|_, _, _, v| volume += v);
        let arc = grid.ring_m.last().unwrap() / EARTH_RADIUS_M;
        let cube = |z: f64| (EARTH_RADIUS_M + z).powi(3);
        let cap = std::f64::consts::TAU * (1.0 - arc.cos()) * (cube(TOP_ALTITUDE_M) - cube(0.0)) / 3.0;
        assert!((volume / cap - 1.0).abs() < 1e-6, "{}", volume / cap);
    }
}
