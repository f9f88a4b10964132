//! The relief of a made-up planet: continents, mountain ranges and hills by fractal noise on the plane of longitude and latitude. The
//! antimeridian, where that plane ends, and the poles are sea, which is at 0.

use skyglow_physics::value_noise::{octaves, ridges};

/// Where the sum of the octaves is above this there is land.
const SHORE: f64 = 0.54;
/// The sum of octaves rises by this from the shore to where the land is as high as it gets.
const SHORE_WIDTH: f64 = 0.06;
/// Middle of a mountainous region that is land whatever the noise says, degrees.
pub(super) const REGION_DEG: [f64; 2] = [46.0, 8.0];

/// The relief; it knows nothing but its formula.
pub(super) struct Relief;

/// 0 below `low`, 1 above `high`, smooth in between.
fn step(low: f64, high: f64, value: f64) -> f64 {
    let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

impl Relief {
    pub(super) fn new() -> Self {
        Self
    }

    /// Metres above the sea, 0 on it.
    pub(super) fn altitude_m(&self, latitude_deg: f64, longitude_deg: f64) -> f64 {
        let [north, east] = [latitude_deg - REGION_DEG[0], longitude_deg - REGION_DEG[1]];
        let region = (-(north * north + 0.5 * east * east) / 30.0).exp();
        let edge = step(170.0, 178.0, longitude_deg.abs()) + step(74.0, 80.0, latitude_deg.abs());
        let [x, y] = [longitude_deg + 180.0, latitude_deg + 90.0];
        let continent = octaves(x / 38.0, y / 28.0, 6, 101) + 0.35 * region - edge;
        if continent <= SHORE {
            return 0.0;
        }
        let inland = step(SHORE, SHORE + SHORE_WIDTH, continent);
        let ranges = step(0.5, 0.72, octaves(x / 13.0, y / 11.0, 3, 211) + 0.2 * region);
        let plains_m = 20.0 + 260.0 * octaves(x / 0.6, y / 0.5, 5, 401);
        if ranges == 0.0 {
            return 1.0 + inland * plains_m;
        }
        let ridges_m = 4_800.0 * ranges * (0.1 + 0.9 * ridges(x / 1.5, y / 1.1, 7, 307));
        1.0 + inland * (plains_m + ridges_m)
    }
}
