//! Energy balance of each order of scattering.
//!
//! What is scattered (and reflected by the ground and the base of a cloud) as light of one order is extinguished in
//! the air, arrives at the ground or at the base of a cloud, or leaves through the top, which a cloud closes. Of what is
//! extinguished a part is scattered on as the next order.
//!
//! Extinction and arrival are counted where light arrives (from radiance on the grid), escape where it is
//! emitted (from the source function): the balance checks both ends of the transport.

use super::{
    budget::DirectBudget,
    grid::{FieldGrid, LinearStencil},
    lanes::{LANES, outputs_from_lanes},
    log_field::LogField,
    radiance::Radiance,
    setting::SourceSetting,
    source_function::USED_LANES,
};
use crate::{
    atmosphere::AEROSOL_ALBEDO, emission::LOBE_COUNT, geometry::EARTH_RADIUS_M,
    single_source::RadiancePerWatt,
};
use std::f64::consts::PI;

/// Power of the light of one order, W per watt of the source (which emits less than that behind a skyline). Light
/// that goes beyond 420 km from the source is in none of the sums but the first two.
#[derive(Clone, Debug)]
pub struct OrderPower {
    /// Number of times this light was scattered or reflected by the ground or the base of a cloud; 0 is direct light.
    pub order: usize,
    pub(super) sent_w: [f64; LANES],
    pub(super) extinguished_w: [f64; LANES],
    pub(super) scattered_on_w: [f64; LANES],
    pub(super) at_ground_w: [f64; LANES],
    pub(super) at_base_w: [f64; LANES],
    /// What ground and base reflect.
    pub(super) returned_w: [f64; LANES],
    pub(super) escaped_w: [f64; LANES],
}

impl OrderPower {
    /// The balance of direct light.
    pub(super) fn of_direct(budget: &DirectBudget) -> Self {
        Self {
            order: 0,
            sent_w: budget.emitted_w,
            extinguished_w: std::array::from_fn(|lane| budget.scattered_w[lane] + budget.absorbed_w[lane]),
            scattered_on_w: budget.scattered_w,
            at_ground_w: [0.0; LANES],
            at_base_w: budget.at_base_w,
            returned_w: budget.returned_w,
            escaped_w: budget.escaped_w,
        }
    }

    /// What became light of this order: scattered in the air and reflected by the ground and the base of a cloud,
    /// `[band][lobe]`.
    pub fn sent_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.sent_w)
    }

    /// What the air scatters or absorbs of it.
    pub fn extinguished_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.extinguished_w)
    }

    /// What of the extinguished light is scattered on.
    pub fn scattered_on_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.scattered_on_w)
    }

    /// What arrives at the ground.
    pub fn at_ground_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.at_ground_w)
    }

    /// What arrives at the base of a cloud; 0 under a clear sky.
    pub fn at_base_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.at_base_w)
    }

    /// What leaves through the top of the air; 0 under a cloud.
    pub fn escaped_w(&self) -> RadiancePerWatt {
        outputs_from_lanes(&self.escaped_w)
    }

    /// (extinguished + at the ground + at the base + escaped)/sent − 1, `[band][lobe]`.
    pub fn imbalance(&self) -> RadiancePerWatt {
        outputs_from_lanes(&std::array::from_fn(|lane| {
            let mut gone = self.extinguished_w[lane] + self.at_ground_w[lane] + self.escaped_w[lane];
            gone += self.at_base_w[lane];
            if self.sent_w[lane] > 0.0 { gone / self.sent_w[lane] - 1.0 } else { 0.0 }
        }))
    }
}

/// The balance of one order from its radiance on the grid.
pub(super) fn field_power(
    setting: &SourceSetting,
    grid: &FieldGrid,
    radiance: &Radiance,
    order: usize,
    scattered_w: [f64; LANES],
    returned_w: [f64; LANES],
    escaped_w: [f64; LANES],
) -> OrderPower {
    let mut power = OrderPower {
        order,
        sent_w: std::array::from_fn(|lane| scattered_w[lane] + returned_w[lane]),
        extinguished_w: [0.0; LANES],
        scattered_on_w: [0.0; LANES],
        at_ground_w: [0.0; LANES],
        at_base_w: [0.0; LANES],
        returned_w: [0.0; LANES],
        escaped_w,
    };
    let (beta_m, beta_a) =
        (setting.atmosphere.molecule_extinction_per_m(), setting.atmosphere.aerosol_extinction_per_m());
    let fluence = LogField::new(
        grid,
        (0..grid.point_count()).map(|point| radiance.moments.mean(point).map(|mean| 4.0 * PI * mean)),
    );
    grid.for_each_volume(|ring, layer, altitude_m, volume_m3| {
        let density = super::optics::relative_densities(altitude_m);
        let light = fluence.at(ring, layer);
        for (lane, light) in light.iter().enumerate().take(USED_LANES) {
            let band = lane / LOBE_COUNT;
            let (m, a) = (beta_m[band] * density[0], beta_a[band] * density[1]);
            power.extinguished_w[lane] += (m + a) * light * volume_m3;
            power.scattered_on_w[lane] += (m + AEROSOL_ALBEDO * a) * light * volume_m3;
        }
    });
    let down = LogField::new(grid, radiance.down_flux.iter().copied());
    let stretch = (1.0 + setting.ground_altitude_m / EARTH_RADIUS_M).powi(2);
    grid.for_each_area(|ring, area_m2| {
        let arriving = down.at(ring, LinearStencil { lower: 0, upper_weight: 0.0 });
        for (sum, arriving) in power.at_ground_w.iter_mut().zip(arriving).take(USED_LANES) {
            *sum += arriving * area_m2 * stretch;
        }
    });
    power.returned_w = power.at_ground_w.map(|w| w * setting.ground_albedo);
    if let Some(cloud) = setting.atmosphere.cloud() {
        let up = LogField::new(grid, radiance.up_flux.iter().copied());
        let top = LinearStencil { lower: grid.layer_count() - 1, upper_weight: 0.0 };
        let stretch = (1.0 + cloud.altitude_m() / EARTH_RADIUS_M).powi(2);
        grid.for_each_area(|ring, area_m2| {
            for (sum, arriving) in power.at_base_w.iter_mut().zip(up.at(ring, top)).take(USED_LANES) {
                *sum += arriving * area_m2 * stretch;
            }
        });
        for (returned, arriving) in power.returned_w.iter_mut().zip(power.at_base_w) {
            *returned += arriving * cloud.diffuse_albedo();
        }
    }
    power
}
