//! How much of a light's flux counts under clouds: all of it where tables know sources as high, none at the base and above.
//!
//! Tables end [`CLOUD_CLEARANCE_M`] below a base, and a source nearer to it counts as one there. All that it sends up meets the cloud
//! however near it is; but what it sends along the base meets it far away under a small angle, so the cloud there has light in
//! proportion to the source's depth below it (inverse-square law: I·depth/distance³). What an observer at a depth of his own has of
//! both is taken from the flat layer without air: of the spot above the source I·depth_o²/distance⁴, of the cloud above himself
//! I·depth/distance³. So that the share is (depth_o²/distance + depth)/(depth_o²/distance + clearance).

use skyglow_scene::{PolarCell, ring_distance_m};
use skyglow_tables::clouds::CLOUD_CLEARANCE_M;

/// Share of a cell's flux that counts, and d ln(share)/d(altitude), m⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightShare {
    /// 0..=1.
    pub share: f32,
    /// At most 0: the higher, the less.
    pub log_slope_per_m: f64,
}

impl LightShare {
    const ALL: Self = Self { share: 1.0, log_slope_per_m: 0.0 };
    const NONE: Self = Self { share: 0.0, log_slope_per_m: 0.0 };

    /// For an observer at an altitude under clouds with a base at `cloud_altitude_m`, metres above sea level; infinite under a
    /// clear sky.
    pub fn of(cell: &PolarCell, observer_altitude_m: f64, cloud_altitude_m: f64) -> Self {
        let depth_m = cloud_altitude_m - f64::from(cell.altitude_m);
        if cell.flux_dnb_w <= 0.0 || depth_m <= 0.0 {
            return Self::NONE;
        }
        if depth_m >= CLOUD_CLEARANCE_M {
            return Self::ALL;
        }
        let spot_m = (cloud_altitude_m - observer_altitude_m).powi(2) / ring_distance_m(cell.ring as usize);
        Self {
            share: ((spot_m + depth_m) / (spot_m + CLOUD_CLEARANCE_M)) as f32,
            log_slope_per_m: -1.0 / (spot_m + depth_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BASE_M: f64 = 1_500.0;

    fn share(ring: u32, altitude_m: f32, observer_altitude_m: f64) -> LightShare {
        let cell = PolarCell { ring, flux_dnb_w: 1.0, altitude_m, blocking: 0 };
        LightShare::of(&cell, observer_altitude_m, BASE_M)
    }

    /// All of it where tables know it and under a clear sky, none at the base and above, and of no light nothing.
    #[test]
    fn it_goes_from_all_to_none() {
        assert_eq!(share(90, 1_400.0, 1_000.0), LightShare::ALL);
        assert_eq!([1_500.0, 1_501.0].map(|z| share(90, z, 1_000.0)), [LightShare::NONE; 2]);
        let cell = |flux_dnb_w| PolarCell { ring: 3, flux_dnb_w, altitude_m: 9e3, blocking: 0 };
        assert_eq!(LightShare::of(&cell(1.0), 0.0, f64::INFINITY), LightShare::ALL);
        assert_eq!(LightShare::of(&cell(0.0), 0.0, f64::INFINITY), LightShare::NONE);
        // Far away it is the depth; close by all of the spot above the light is seen.
        assert!((share(191, 1_450.0, 1_000.0).share - 0.5).abs() < 0.01);
        assert!(share(0, 1_450.0, 1_000.0).share > 0.95);
    }

    proptest! {
        /// The slope is that of the logarithm.
        #[test]
        fn its_slope_is_its_derivative(ring in 0u32..192, depth_m in 3.0..99.0f32, observer_m in 0.0..1_400.0f64) {
            let at = |step_m: f32| share(ring, BASE_M as f32 - depth_m + step_m, observer_m);
            let difference = f64::from((at(0.5).share / at(-0.5).share).ln());
            let slope = at(0.0).log_slope_per_m;
            prop_assert!((difference / slope - 1.0).abs() < 0.02, "{difference} {slope}");
            prop_assert!(slope < 0.0 && (0.0..=1.0).contains(&at(0.0).share));
        }
    }
}
