//! Linear radiance in a projection, for programs.

use crate::{
    error::DisplayError,
    options::{Projection, Sky, check_size},
    projection::View,
    sampler::Sampler,
};
use skyglow_physics::{BAND_COUNT, Panorama};

/// Radiance in a projection, W m⁻² sr⁻¹, zenith at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatRaster {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// `[y][x][band]`, bands R, G, B; 0 where there is no sky.
    pub radiance_w_m2_sr: Vec<[f32; BAND_COUNT]>,
    /// `[y][x]`: whether the pixel shows sky.
    pub has_sky: Vec<bool>,
}

impl FloatRaster {
    /// Position of a pixel in both vectors.
    pub fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width_px as usize + x as usize
    }
}

/// Samples a panorama in a projection. Equirectangular 256 × 64 gives the grid's own values.
///
/// # Errors
/// [`DisplayError`] naming the size or angle out of its range.
pub fn raster(
    panorama: &Panorama,
    projection: Projection,
    (width_px, height_px): (u32, u32),
    sky: Sky,
) -> Result<FloatRaster, DisplayError> {
    check_size(width_px, height_px)?;
    projection.check()?;
    let sampler = Sampler::new(panorama, sky.added_radiance_w_m2_sr());
    let view = View::new(projection, width_px, height_px);
    let length = width_px as usize * height_px as usize;
    let mut raster = FloatRaster {
        width_px,
        height_px,
        radiance_w_m2_sr: Vec::with_capacity(length),
        has_sky: Vec::with_capacity(length),
    };
    for y in 0..height_px {
        for x in 0..width_px {
            let radiance = view
                .direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5)
                .and_then(|direction| sampler.radiance_w_m2_sr(direction));
            raster.has_sky.push(radiance.is_some());
            raster.radiance_w_m2_sr.push(radiance.unwrap_or_default().map(|l| l as f32));
        }
    }
    Ok(raster)
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT};

    #[test]
    fn the_default_raster_is_the_grid_turned_upside_down_bit_for_bit() {
        let samples = (0..Panorama::LEN).map(|i| 1e-9 * (i as f32 + 1.0)).collect();
        let panorama = Panorama::from_samples(samples).unwrap();
        let size = Projection::Equirectangular.default_raster_size_px();
        let raster = raster(&panorama, Projection::Equirectangular, size, Sky::Artificial).unwrap();
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let pixel = raster.index(column as u32, (ELEVATION_COUNT - 1 - row) as u32);
                for band in 0..BAND_COUNT {
                    let sample = panorama.samples()[Panorama::index(band, row, column)];
                    assert_eq!(raster.radiance_w_m2_sr[pixel][band], sample, "{band} {row} {column}");
                }
            }
        }
        assert!(raster.has_sky.iter().all(|&sky| sky));
    }
}
