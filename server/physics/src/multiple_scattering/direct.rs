//! Direct light: what reaches a point of the air unscattered.

use super::{optics::columns_to_space_m, setting::SourceSetting};
use crate::{
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
};
use glam::DVec3;

/// Direct light of the source at a point above its horizon plane: f/d² per lobe [m⁻²] and the columns from the
/// source [m]. `from_source` is S→P.
pub(super) fn direct_light(
    setting: &SourceSetting,
    source_density: [f64; 2],
    from_source: DVec3,
    altitude_m: f64,
    density: [f64; 2],
) -> ([f64; LOBE_COUNT], [f64; 2]) {
    let distance2 = from_source.length_squared();
    let distance = distance2.sqrt();
    let cos_at_source = from_source.z / distance;
    let radius = EARTH_RADIUS_M + altitude_m;
    // (centre→P)·(S→P) = S·(S→P) + d².
    let source_radius = EARTH_RADIUS_M + setting.source_altitude_m;
    let cos_here = ((source_radius * from_source.z + distance2) / (radius * distance)).clamp(0.0, 1.0);
    let out = columns_to_space_m(setting.source_altitude_m, cos_at_source.max(0.0), source_density);
    let rest = columns_to_space_m(altitude_m, cos_here, density);
    let lobes = lobe_intensities_per_sr(cos_at_source).map(|f| f / distance2);
    (lobes, [(out[0] - rest[0]).max(0.0), (out[1] - rest[1]).max(0.0)])
}
