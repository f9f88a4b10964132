//! The field of multiply scattered light around one source, by successive orders of scattering (van de Hulst 1948).

use super::{
    budget::{direct_budget, escaping_w},
    energy::{OrderPower, field_power},
    first_order::FirstOrder,
    gathering::FirstOrderRule,
    grid::{FieldGrid, TOP_ALTITUDE_M},
    harmonics::pair_count,
    lanes::{LANES, Lanes},
    radiance::Radiance,
    setting::{Resolution, SourceSetting},
    source_function::{Moments, SourceFunction, USED_LANES},
    surfaces::{BaseFlux, SurfaceRadiance, Surfaces},
    transport::transport,
};
use rayon::prelude::*;

/// Convergence is tested at places up to this distance, metres.
const CONVERGED_WITHIN_M: f64 = 300_000.0;
/// Largest ratio of the geometric series for the orders left out.
const MAX_TAIL_RATIO: f64 = 0.9;

/// Light of orders two and more around one source of 1 W: what every place of the air emits into every
/// direction, for all bands and lobes, including light reflected by the ground and the base of a cloud.
#[derive(Clone, Debug)]
pub struct SourceField {
    pub(super) setting: SourceSetting,
    pub(super) grid: FieldGrid,
    pub(super) source: SourceFunction,
    /// What the base of a cloud reflects of the light of all orders, itself of orders two and more; None under a
    /// clear sky.
    pub(super) base: Option<SurfaceRadiance>,
    powers: Vec<OrderPower>,
    changes: Vec<f64>,
}

impl SourceField {
    /// Solves the field: first-order light exactly, then order after order until one adds less than
    /// `resolution.tolerance` of the source function anywhere within 300 km; the rest is summed as a geometric
    /// series, place by place.
    ///
    /// The source function far away is a smooth curve over the distance. Runs on the current rayon pool; the result does not
    /// depend on the number of threads.
    pub fn solve(setting: SourceSetting, resolution: &Resolution) -> Self {
        Self::solve_with(setting, resolution, SourceFunction::smooth_over_rings)
    }

    /// As [`Self::solve`], without smoothing over rings.
    #[cfg(test)]
    pub(super) fn as_followed(setting: SourceSetting, resolution: &Resolution) -> Self {
        Self::solve_with(setting, resolution, |source, _| source.clone())
    }

    /// `smooth` is done to the source function of every order and to that of all.
    fn solve_with(
        setting: SourceSetting,
        resolution: &Resolution,
        smooth: impl Fn(&SourceFunction, &FieldGrid) -> SourceFunction,
    ) -> Self {
        let grid = FieldGrid::new(
            setting.source_altitude_m,
            setting.ground_altitude_m,
            setting.atmosphere.cloud(),
            resolution.ring_step,
            resolution.layer_cuts,
        );
        let rule =
            FirstOrderRule::new(resolution.first_polar, resolution.first_around, resolution.first_along);
        let first = FirstOrder::new(&setting, &rule, TOP_ALTITUDE_M);
        let is_clear = setting.atmosphere.cloud().is_none();
        let direct = direct_budget(&setting);
        let mut radiance = first_radiance(&first, &grid, resolution.first_degree);
        let mut powers = vec![OrderPower::of_direct(&direct)];
        let mut escaped_w = direct.once_scattered_escaped_w;
        let mut changes = Vec::new();
        let mut sent_w = direct.scattered_w;
        let mut returned_w = direct.returned_w;
        let mut base_flux = setting.atmosphere.cloud().map(|cloud| (cloud, BaseFlux::dark(&grid)));
        let mut total: Option<Moments> = None;
        let mut before: Option<Moments> = None;
        for order in 1..=resolution.max_orders {
            let power = field_power(&setting, &grid, &radiance, order, sent_w, returned_w, escaped_w);
            (sent_w, returned_w) = (power.scattered_on_w, power.returned_w);
            powers.push(power);
            let surfaces = Surfaces::new(&setting, &grid, &radiance);
            if let Some((_, flux)) = &mut base_flux {
                flux.add(&grid, &radiance);
            }
            let scattered = radiance.moments.scattered(&setting, &grid);
            escaped_w = escaping_w(&setting, &grid, &scattered, returned_w);
            let change = match &mut total {
                None => {
                    total = Some(scattered.clone());
                    1.0
                }
                Some(total) => {
                    total.add(&scattered, |_| [1.0; LANES]);
                    largest_share(&grid, &scattered, total)
                }
            };
            changes.push(change);
            let last = change < resolution.tolerance || order == resolution.max_orders;
            if last {
                if let (Some(total), Some(before)) = (&mut total, &before) {
                    add_tail(total, before, &scattered);
                }
                break;
            }
            let followed = SourceFunction::new(&scattered);
            let function =
                if is_clear { smooth(&followed, &grid) } else { followed }.with_lines_at_mean(&grid);
            before = Some(scattered);
            radiance = transport(&setting, resolution, &grid, &function, &surfaces);
        }
        let followed = SourceFunction::new(&total.unwrap_or_else(|| Moments::dark(&grid, 0)));
        let source = smooth(&followed, &grid).with_lines_at_mean(&grid);
        let base = base_flux.map(|(cloud, flux)| flux.radiance(cloud.diffuse_albedo(), MAX_TAIL_RATIO));
        Self { setting, grid, source, base, powers, changes }
    }

    /// What the field was solved for.
    pub fn setting(&self) -> &SourceSetting {
        &self.setting
    }

    /// Energy balance of each order, from the direct light (order 0) on.
    pub fn powers(&self) -> &[OrderPower] {
        &self.powers
    }

    /// For each order of the source function from the second on: the largest share that it adds to the sum so
    /// far, over all places within 300 km, bands and lobes.
    pub fn changes(&self) -> &[f64] {
        &self.changes
    }

    /// Places of the grid as (rings, layers).
    pub fn size(&self) -> (usize, usize) {
        (self.grid.ring_count(), self.grid.layer_count())
    }
}

pub(super) fn first_radiance(first: &FirstOrder<'_>, grid: &FieldGrid, degree: usize) -> Radiance {
    let places: Vec<_> =
        (0..grid.point_count()).into_par_iter().map(|point| first.at(grid, point, degree)).collect();
    Radiance {
        moments: Moments { degree, values: places.iter().flat_map(|p| p.moments.iter().copied()).collect() },
        down_flux: places.iter().map(|p| p.down_flux).collect(),
        up_flux: places.iter().map(|p| p.up_flux).collect(),
    }
}

/// Largest share of `part` in `total`, mean over directions, over all places within [`CONVERGED_WITHIN_M`] and lanes.
fn largest_share(grid: &FieldGrid, part: &Moments, total: &Moments) -> f64 {
    let mut largest: f64 = 0.0;
    for point in (0..grid.point_count()).filter(|&p| grid.place_m(p).0 <= CONVERGED_WITHIN_M) {
        let (part, total) = (part.mean(point), total.mean(point));
        for lane in 0..USED_LANES {
            if total[lane] > 0.0 {
                largest = largest.max(part[lane] / total[lane]);
            }
        }
    }
    largest
}

/// Adds the orders after `last` as a geometric series with the ratio of the last two.
fn add_tail(total: &mut Moments, before: &Moments, last: &Moments) {
    total.add(last, |point| {
        let (before, last) = (before.mean(point), last.mean(point));
        let tail = |lane: usize| -> f32 {
            if before[lane] <= 0.0 {
                return 0.0;
            }
            let ratio = (last[lane] / before[lane]).clamp(0.0, MAX_TAIL_RATIO);
            (ratio / (1.0 - ratio)) as f32
        };
        let factors: Lanes = std::array::from_fn(tail);
        factors
    });
}

impl Moments {
    fn dark(grid: &FieldGrid, degree: usize) -> Self {
        Self { degree, values: vec![[0.0; LANES]; grid.point_count() * pair_count(degree)] }
    }
}
