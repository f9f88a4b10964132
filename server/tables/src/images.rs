//! Sky images of single sources: the samples that a basis is fitted to.

use crate::axes::TableAxes;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT,
    panorama::{azimuth_rad, elevation_rad, solid_angle_sr},
    quadrature::gauss_legendre,
    single_source::{OUTPUT_COUNT, SourceGeometry, radiance_per_watt_fixed},
};

/// Columns computed of an image: azimuths 0..=180° from the source; the other half mirrors them.
pub const HALF_COLUMN_COUNT: usize = 129;
/// Samples of an image, `[row][column]`.
pub const PIXEL_COUNT: usize = ELEVATION_COUNT * HALF_COLUMN_COUNT;
/// Images of one geometry, `[lobe][band]`.
pub const IMAGE_COUNT: usize = LOBE_COUNT * BAND_COUNT;
/// Gauss–Legendre nodes a smooth piece of a ray: 99 % of the samples are within 1e-3 of the converged
/// integral (half of them within 1e-7).
pub const NODES_PER_PIECE: usize = 7;

/// The images of one geometry, scale and shape apart.
#[derive(Clone, Debug)]
pub struct SourceImages {
    /// ln of the mean over directions 22.5° and more in azimuth from the source [m⁻² sr⁻¹], `[lobe][band]`; [`DARK_LOG_SCALE`] for a dark image.
    pub log_scale: [f64; IMAGE_COUNT],
    /// Image over its mean, `[lobe][band][row][column]`.
    pub shape: Vec<f32>,
}

/// Log scale that stands for no light at all; e⁻³⁰⁰ is zero for every purpose and safe in f32.
pub const DARK_LOG_SCALE: f64 = -300.0;

/// Columns that count for an image's scale: azimuths of 22.5° and more from the source. Looking straight at a
/// source that stands above the horizon, b diverges as one over the angle, so a mean over all samples would
/// jump with whether a sample happens to hit it.
const SCALE_COLUMN: usize = 16;

/// Position of an image in `[lobe][band]` order.
pub const fn image_index(lobe: usize, band: usize) -> usize {
    lobe * BAND_COUNT + band
}

/// Weight of a sample in the scale: its solid angle, mirrored columns counted twice, near the source's azimuth
/// nothing; sums to 1.
fn scale_weights() -> Vec<f64> {
    let mut weights: Vec<f64> = (0..PIXEL_COUNT)
        .map(|p| match p % HALF_COLUMN_COUNT {
            column if column < SCALE_COLUMN => 0.0,
            column if column == HALF_COLUMN_COUNT - 1 => solid_angle_sr(p / HALF_COLUMN_COUNT),
            _ => 2.0 * solid_angle_sr(p / HALF_COLUMN_COUNT),
        })
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    weights
}

/// The images at one node of the axes.
pub fn images_at_node(
    atmosphere: &Atmosphere,
    axes: &TableAxes,
    observer_altitude: usize,
    distance: usize,
    offset: usize,
) -> SourceImages {
    images_of(
        atmosphere,
        &SourceGeometry {
            distance_m: axes.distance_m[distance],
            source_altitude_m: axes.source_altitude_m(observer_altitude, distance, offset),
            observer_altitude_m: axes.observer_altitude_m[observer_altitude],
        },
    )
}

/// The images of any geometry.
pub fn images_of(atmosphere: &Atmosphere, geometry: &SourceGeometry) -> SourceImages {
    let nodes = gauss_legendre(NODES_PER_PIECE);
    let weights = scale_weights();
    let mut values = vec![0.0f64; IMAGE_COUNT * PIXEL_COUNT];
    let mut mean = [0.0f64; IMAGE_COUNT];
    for row in 0..ELEVATION_COUNT {
        for column in 0..HALF_COLUMN_COUNT {
            let radiance: [f64; OUTPUT_COUNT] = radiance_per_watt_fixed(
                std::slice::from_ref(atmosphere),
                geometry,
                azimuth_rad(column),
                elevation_rad(row),
                &nodes,
            );
            for band in 0..BAND_COUNT {
                for lobe in 0..LOBE_COUNT {
                    let image = image_index(lobe, band);
                    let value = radiance[band * LOBE_COUNT + lobe];
                    values[image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column] = value;
                    mean[image] += weights[row * HALF_COLUMN_COUNT + column] * value;
                }
            }
        }
    }
    let lit = |mean: f64| mean > DARK_LOG_SCALE.exp();
    let shape = values
        .chunks_exact(PIXEL_COUNT)
        .zip(mean)
        .flat_map(|(image, mean)| {
            let factor = if lit(mean) { 1.0 / mean } else { 0.0 };
            image.iter().map(move |value| (value * factor) as f32)
        })
        .collect();
    SourceImages { log_scale: mean.map(|m| if lit(m) { m.ln() } else { DARK_LOG_SCALE }), shape }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::Turbidity;

    #[test]
    fn an_image_over_its_mean_has_mean_one_and_is_brightest_towards_its_source() {
        let atmosphere = Atmosphere::new(Turbidity::default());
        let geometry = SourceGeometry { distance_m: 20_000.0, source_altitude_m: 0.0, observer_altitude_m: 0.0 };
        let images = images_of(&atmosphere, &geometry);
        let mean: f64 = scale_weights().iter().zip(&images.shape).map(|(w, &x)| w * f64::from(x)).sum();
        assert!((mean - 1.0).abs() < 1e-6);
        let low_row = 2 * HALF_COLUMN_COUNT;
        assert!(images.shape[low_row] > 10.0 * images.shape[low_row + HALF_COLUMN_COUNT - 1]);
    }
}
