//! Skies for tests.

use skyglow_physics::{
    AZIMUTH_COUNT, ELEVATION_COUNT, Panorama, Response, SKY_RESPONSES, SeenSky, SkyPart, spectrum::RGB_BANDS,
};
use std::sync::Arc;

/// A sky of light that is the same at every wavelength, with a luminance by row and column, cd m⁻².
pub(crate) fn grey_sky(luminance_cd_m2: impl Fn(usize, usize) -> f64) -> SeenSky {
    lamp_sky(skyglow_physics::LampPreset::Neutral, luminance_cd_m2)
}

/// A sky of a lamp's colour, with a luminance by row and column, cd m⁻².
pub(crate) fn lamp_sky(
    lamp: skyglow_physics::LampPreset,
    luminance_cd_m2: impl Fn(usize, usize) -> f64,
) -> SeenSky {
    let light = Arc::clone(lamp.lamp().light());
    let of_one = light.rule(&Response::Photopic).value([1.0; skyglow_physics::BAND_COUNT]);
    let mut kernel = Panorama::dark();
    for row in 0..ELEVATION_COUNT {
        for column in 0..AZIMUTH_COUNT {
            let value = (luminance_cd_m2(row, column) / of_one) as f32;
            for band in 0..skyglow_physics::BAND_COUNT {
                kernel.samples_mut()[Panorama::index(band, row, column)] = value;
            }
        }
    }
    SeenSky::of(&[SkyPart { light, kernel }], &SKY_RESPONSES)
}

/// A sky of R, G, B from samples in the order of the grid, `[band][row][column]`.
pub(crate) fn bands_sky(value: impl Fn(usize) -> f32) -> SeenSky {
    let count = RGB_BANDS.len() * ELEVATION_COUNT * AZIMUTH_COUNT;
    SeenSky::from_values(RGB_BANDS.to_vec(), (0..count).map(value).collect()).unwrap()
}
