//! Linear radiance in a projection, for programs.

use crate::{
    error::DisplayError,
    ground::without_ground,
    options::{Projection, Sky, check_size},
    projection::View,
    sampler::Sampler,
};
use skyglow_physics::{BAND_COUNT, Horizon, Panorama};

/// Radiance in a projection, W m⁻² sr⁻¹, zenith at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatRaster {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// `[y][x][band]`, bands R, G, B; 0 where terrain hides the sky and where the projection shows none.
    pub radiance_w_m2_sr: Vec<[f32; BAND_COUNT]>,
    /// `[y][x]`: whether the pixel shows a direction of the upper hemisphere, be it sky or ground that hides it.
    pub has_sky: Vec<bool>,
}

impl FloatRaster {
    /// Position of a pixel in both vectors.
    pub fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width_px as usize + x as usize
    }
}

/// Samples a panorama in a projection. Equirectangular 256 × 64 gives the grid's own values. Below `horizon` radiance
/// is 0, the natural sky included.
///
/// # Errors
/// [`DisplayError`] naming the size or angle out of its range.
pub fn raster(
    panorama: &Panorama,
    horizon: &Horizon,
    projection: Projection,
    (width_px, height_px): (u32, u32),
    sky: Sky,
) -> Result<FloatRaster, DisplayError> {
    check_size(width_px, height_px)?;
    projection.check()?;
    let panorama = without_ground(panorama, horizon);
    let sampler = Sampler::new(&panorama, sky.added_radiance_w_m2_sr());
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
            let radiance = view.direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5).and_then(|direction| {
                let radiance = sampler.radiance_w_m2_sr(direction)?;
                Some(if horizon.hides(direction) { [0.0; BAND_COUNT] } else { radiance })
            });
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

    /// The default raster is the grid turned upside down bit for bit.
    #[test]
    fn the_default_raster_is_the_flipped_grid() {
        let samples = (0..Panorama::LEN).map(|i| 1e-9 * (i as f32 + 1.0)).collect();
        let panorama = Panorama::from_samples(samples).unwrap();
        let size = Projection::Equirectangular.default_raster_size_px();
        let raster =
            raster(&panorama, &Horizon::flat(), Projection::Equirectangular, size, Sky::Artificial).unwrap();
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

    /// Ground is 0 in a raster of the total sky and the default raster has the grid's own mask.
    #[test]
    fn ground_is_0_in_rasters_by_the_grids_mask() {
        let elevations = (0..AZIMUTH_COUNT).map(|column| 0.002 * column as f64).collect();
        let horizon = Horizon::new(elevations).unwrap();
        let mut panorama = Panorama::from_samples(vec![1e-6; Panorama::LEN]).unwrap();
        horizon.darken(&mut panorama);
        let size = Projection::Equirectangular.default_raster_size_px();
        for sky in [Sky::Artificial, Sky::Total] {
            let raster = raster(&panorama, &horizon, Projection::Equirectangular, size, sky).unwrap();
            for row in 0..ELEVATION_COUNT {
                for column in 0..AZIMUTH_COUNT {
                    let pixel = raster.index(column as u32, (ELEVATION_COUNT - 1 - row) as u32);
                    let is_dark = raster.radiance_w_m2_sr[pixel] == [0.0; BAND_COUNT];
                    assert_eq!(is_dark, horizon.hides_sample(row, column), "{row} {column}");
                    assert!(raster.has_sky[pixel]);
                }
            }
        }
    }
}
