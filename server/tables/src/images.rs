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

/// Most turbidities computed together.
pub const MAX_TOGETHER: usize = 6;

/// The images at one node of the axes, one set for each atmosphere.
pub fn images_at_node(
    atmospheres: &[Atmosphere],
    axes: &TableAxes,
    observer_altitude: usize,
    distance: usize,
    offset: usize,
) -> Vec<SourceImages> {
    images_of(
        atmospheres,
        &SourceGeometry {
            distance_m: axes.distance_m[distance],
            source_altitude_m: axes.source_altitude_m(observer_altitude, distance, offset),
            observer_altitude_m: axes.observer_altitude_m[observer_altitude],
        },
    )
}

/// The images of any geometry, one set for each atmosphere. Several cost little more than one: rays, columns
/// and angles are shared.
pub fn images_of(atmospheres: &[Atmosphere], geometry: &SourceGeometry) -> Vec<SourceImages> {
    match atmospheres.len() {
        0 => Vec::new(),
        1 => images_together::<OUTPUT_COUNT>(atmospheres, geometry),
        2 => images_together::<{ 2 * OUTPUT_COUNT }>(atmospheres, geometry),
        3 => images_together::<{ 3 * OUTPUT_COUNT }>(atmospheres, geometry),
        4 => images_together::<{ 4 * OUTPUT_COUNT }>(atmospheres, geometry),
        5 => images_together::<{ 5 * OUTPUT_COUNT }>(atmospheres, geometry),
        MAX_TOGETHER => images_together::<{ MAX_TOGETHER * OUTPUT_COUNT }>(atmospheres, geometry),
        _ => {
            let (first, rest) = atmospheres.split_at(MAX_TOGETHER);
            let mut images = images_of(first, geometry);
            images.extend(images_of(rest, geometry));
            images
        }
    }
}

/// `N` is the number of atmospheres times [`OUTPUT_COUNT`].
fn images_together<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
) -> Vec<SourceImages> {
    let nodes = gauss_legendre(NODES_PER_PIECE);
    let weights = scale_weights();
    // [atmosphere][lobe][band][row][column]
    let mut values = vec![0.0f64; N * PIXEL_COUNT];
    let mut mean = [0.0f64; N];
    for row in 0..ELEVATION_COUNT {
        for column in 0..HALF_COLUMN_COUNT {
            let radiance: [f64; N] = radiance_per_watt_fixed(
                atmospheres,
                geometry,
                azimuth_rad(column),
                elevation_rad(row),
                &nodes,
            );
            let pixel = row * HALF_COLUMN_COUNT + column;
            for (slot, value) in radiance.into_iter().enumerate() {
                // Slots are [atmosphere][band][lobe].
                let (atmosphere, rest) = (slot / OUTPUT_COUNT, slot % OUTPUT_COUNT);
                let image = atmosphere * IMAGE_COUNT + image_index(rest % LOBE_COUNT, rest / LOBE_COUNT);
                values[image * PIXEL_COUNT + pixel] = value;
                mean[image] += weights[pixel] * value;
            }
        }
    }
    let lit = |mean: f64| mean > DARK_LOG_SCALE.exp();
    (0..atmospheres.len())
        .map(|atmosphere| {
            let first = atmosphere * IMAGE_COUNT;
            let mean: [f64; IMAGE_COUNT] = std::array::from_fn(|image| mean[first + image]);
            let shape = values[first * PIXEL_COUNT..][..IMAGE_COUNT * PIXEL_COUNT]
                .chunks_exact(PIXEL_COUNT)
                .zip(mean)
                .flat_map(|(image, mean)| {
                    let factor = if lit(mean) { 1.0 / mean } else { 0.0 };
                    image.iter().map(move |value| (value * factor) as f32)
                })
                .collect();
            SourceImages { log_scale: mean.map(|m| if lit(m) { m.ln() } else { DARK_LOG_SCALE }), shape }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::Turbidity;

    #[test]
    fn an_image_over_its_mean_has_mean_one_and_is_brightest_towards_its_source() {
        let atmosphere = Atmosphere::new(Turbidity::default());
        let geometry =
            SourceGeometry { distance_m: 20_000.0, source_altitude_m: 0.0, observer_altitude_m: 0.0 };
        let images = &images_of(&[atmosphere], &geometry)[0];
        let mean: f64 = scale_weights().iter().zip(&images.shape).map(|(w, &x)| w * f64::from(x)).sum();
        assert!((mean - 1.0).abs() < 1e-6);
        // Two atmospheres at once give the same as each alone.
        let clean = Atmosphere::new(Turbidity::new(1.0).unwrap());
        assert_eq!(images_of(&[clean, atmosphere], &geometry)[1].shape, images.shape);
        let low_row = 2 * HALF_COLUMN_COUNT;
        assert!(images.shape[low_row] > 10.0 * images.shape[low_row + HALF_COLUMN_COUNT - 1]);
    }
}
