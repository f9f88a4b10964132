//! The low sky of a place, added up from the horizontal plane on.

use skyglow_physics::{
    AZIMUTH_COUNT, ELEVATION_COUNT,
    panorama::{cos_sr, projected_sr},
};
use std::f64::consts::FRAC_PI_2;

/// Sectors of azimuth in which a horizon is one angle.
pub(crate) const SECTOR_COUNT: usize = 32;
pub(crate) const COLUMNS_PER_SECTOR: usize = AZIMUTH_COUNT / SECTOR_COUNT;
/// Elevations up to which the sky is added up: the edges of the rows of panoramas.
const EDGE_COUNT: usize = ELEVATION_COUNT + 1;

/// The sky up to each elevation by sector, in parts of the horizontal illuminance: ∫ L sin φ dΩ and ∫ L cos φ dΩ, `[sector][edge]`.
#[derive(Clone, Debug)]
pub(crate) struct SkyBelow(Vec<[f32; 2]>);

impl SkyBelow {
    /// Of what a response sees in every direction, `[row][column]`; None without light.
    pub(crate) fn new(plane: &[f32]) -> Option<Self> {
        let mut edges = vec![[0f64; 2]; SECTOR_COUNT * EDGE_COUNT];
        let mut horizontal = 0.0;
        for sector in 0..SECTOR_COUNT {
            let mut below = [0.0; 2];
            for row in 0..ELEVATION_COUNT {
                let columns = plane[row * AZIMUTH_COUNT + sector * COLUMNS_PER_SECTOR..].iter();
                let sum: f64 = columns.take(COLUMNS_PER_SECTOR).map(|value| f64::from(*value)).sum();
                below[0] += sum * projected_sr(row);
                below[1] += sum * cos_sr(row);
                edges[sector * EDGE_COUNT + row + 1] = below;
            }
            horizontal += below[0];
        }
        let part = |of: [f64; 2]| of.map(|value| (value / horizontal) as f32);
        (horizontal > 0.0).then(|| Self(edges.into_iter().map(part).collect()))
    }

    /// Up to an elevation in a sector.
    pub(crate) fn up_to(&self, sector: usize, elevation_rad: f64) -> [f64; 2] {
        let place = elevation_rad / FRAC_PI_2 * ELEVATION_COUNT as f64;
        let below = (place as usize).min(ELEVATION_COUNT - 1);
        let weight = (place - below as f64).clamp(0.0, 1.0);
        let edges = &self.0[sector * EDGE_COUNT + below..];
        let (low, high) = (edges[0].map(f64::from), edges[1].map(f64::from));
        [0, 1].map(|part| low[part] + weight * (high[part] - low[part]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up to the zenith it is all of a uniform sky: 1 upwards, and 1/SECTOR_COUNT of it in each sector; without light there is none.
    #[test]
    fn a_uniform_sky_adds_up() {
        let sky = SkyBelow::new(&[0.5; ELEVATION_COUNT * AZIMUTH_COUNT]).unwrap();
        for sector in [0, 7, SECTOR_COUNT - 1] {
            let [up, along] = sky.up_to(sector, FRAC_PI_2);
            let part = 1.0 / SECTOR_COUNT as f64;
            assert!(
                (up / part - 1.0).abs() < 1e-5 && (along / part - FRAC_PI_2).abs() < 1e-5,
                "{up} {along}"
            );
            let elevation_rad = 0.3f64;
            let [up, _] = sky.up_to(sector, elevation_rad);
            assert!((up / part / elevation_rad.sin().powi(2) - 1.0).abs() < 1e-3, "{up}");
        }
        assert!(SkyBelow::new(&[0.0; ELEVATION_COUNT * AZIMUTH_COUNT]).is_none());
    }
}
