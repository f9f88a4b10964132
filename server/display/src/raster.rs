//! Linear radiance in a projection, for programs.

use crate::{
    error::DisplayError,
    options::{Projection, check_size},
    projection::View,
};
use skyglow_physics::{
    Horizon, Response, SeenSky,
    sampler::{Sampler, taps},
    spectrum::RGB_BANDS,
};
use std::borrow::Cow;

/// Radiance in a projection, zenith at the top. A pixel is found when it is asked for: the largest raster takes no memory for its
/// floats, and encoders ask for a strip at a time.
#[derive(Clone, Debug)]
pub struct FloatRaster<'a> {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    seen: Cow<'a, SeenSky>,
    response: Option<&'a Response>,
    horizon: &'a Horizon,
    view: View,
}

impl FloatRaster<'_> {
    /// Radiance in R, G, B of a pixel, W m⁻² sr⁻¹, then the value of [`Self::response`] in its unit, or 0 without one; 0 where terrain
    /// hides the sky; None where the projection shows no direction of the upper hemisphere.
    pub fn samples(&self, x: u32, y: u32) -> Option<[f32; 4]> {
        let direction = self.view.direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5)?;
        if self.horizon.hides(direction) {
            return taps(direction).map(|_| [0.0; 4]);
        }
        let plane = |band: &Response| self.seen.seen_by(band).unwrap_or_default();
        let [r, g, b] = RGB_BANDS.each_ref().map(plane);
        let Some(response) = self.response else {
            let [r, g, b] = Sampler::new([r, g, b]).values(direction)?;
            return Some([r as f32, g as f32, b as f32, 0.0]);
        };
        let samples = Sampler::new([r, g, b, plane(response)]).values(direction)?;
        Some(samples.map(|sample| sample as f32))
    }

    /// Whose values are beside R, G, B.
    pub fn response(&self) -> Option<&Response> {
        self.response
    }

    /// Whether every pixel shows a direction of the upper hemisphere.
    pub fn is_all_sky(&self) -> bool {
        let has_sky = |x: u32, y: u32| {
            let direction = self.view.direction_at(f64::from(x) + 0.5, f64::from(y) + 0.5);
            direction.is_some_and(|direction| taps(direction).is_some())
        };
        (0..self.height_px).all(|y| (0..self.width_px).all(|x| has_sky(x, y)))
    }
}

/// The radiance of a sky in R, G, B, which [`RGB_BANDS`] see, and what a response sees where one is given, in a projection.
/// Equirectangular 256 × 64 gives the grid's own values. Below `horizon` all are 0.
///
/// # Errors
/// [`DisplayError`] naming the size or angle out of its range.
pub fn raster<'a>(
    seen: &'a SeenSky,
    horizon: &'a Horizon,
    projection: Projection,
    (width_px, height_px): (u32, u32),
    response: Option<&'a Response>,
) -> Result<FloatRaster<'a>, DisplayError> {
    check_size(width_px, height_px)?;
    projection.check()?;
    let mut wanted = RGB_BANDS.iter().chain(response);
    if let Some(band) = wanted.find(|band| seen.seen_by(band).is_none()) {
        return Err(DisplayError::NotSeen { response: band.name() });
    }
    Ok(FloatRaster {
        width_px,
        height_px,
        seen: seen.without_ground(horizon),
        response,
        horizon,
        view: View::new(projection, width_px, height_px),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::bands_sky;
    use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT};

    /// The default raster is the grid turned upside down bit for bit.
    #[test]
    fn the_default_raster_is_the_flipped_grid() {
        let sky = bands_sky(|i| 1e-9 * (i as f32 + 1.0));
        let size = Projection::Equirectangular.default_raster_size_px();
        let flat = Horizon::flat();
        let raster = raster(&sky, &flat, Projection::Equirectangular, size, None).unwrap();
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let pixel = raster.samples(column as u32, (ELEVATION_COUNT - 1 - row) as u32);
                for band in 0..3 {
                    let sample = sky.plane(band)[row * AZIMUTH_COUNT + column];
                    assert_eq!(pixel.unwrap()[band], sample, "{band} {row} {column}");
                }
            }
        }
        assert!(raster.is_all_sky());
    }

    /// Ground is 0 in a raster and the default raster has the grid's own mask.
    #[test]
    fn ground_is_0_in_rasters_by_the_grids_mask() {
        let elevations = (0..AZIMUTH_COUNT).map(|column| 0.002 * column as f64).collect();
        let horizon = Horizon::new(elevations).unwrap();
        let hidden = |i: usize| horizon.hides_sample(i / AZIMUTH_COUNT % ELEVATION_COUNT, i % AZIMUTH_COUNT);
        let seen = bands_sky(|i| if hidden(i) { 0.0 } else { 1e-6 });
        let size = Projection::Equirectangular.default_raster_size_px();
        let raster = raster(&seen, &horizon, Projection::Equirectangular, size, None).unwrap();
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let pixel = raster.samples(column as u32, (ELEVATION_COUNT - 1 - row) as u32);
                let is_dark = pixel.unwrap() == [0.0; 4];
                assert_eq!(is_dark, horizon.hides_sample(row, column), "{row} {column}");
            }
        }
    }
}
