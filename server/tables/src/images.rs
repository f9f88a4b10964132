//! Sky images of single sources: the samples that a basis is fitted to.

use crate::{
    layout::{HALF_COLUMN_COUNT, IMAGE_COUNT, PIXEL_COUNT, image_index},
    multiple::MultipleTable,
};
use skyglow_physics::{
    Atmosphere, CloudBase, ELEVATION_COUNT, LOBE_COUNT,
    panorama::{azimuth_rad, elevation_rad, solid_angle_sr},
    quadrature::gauss_legendre,
    single_source::{OUTPUT_COUNT, SourceGeometry, cut_radiance_per_watt_fixed},
};

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

/// Columns that count for an image's scale: azimuths of 22.5° and more from the source. Straight towards a
/// source above the horizon b diverges as one over the angle, so a mean over all samples would
/// jump with whether a sample happens to hit it.
const SCALE_COLUMN: usize = 16;

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

/// Largest number of turbidities computed together.
pub const MAX_TOGETHER: usize = 6;

/// The layer of cloud over atmospheres that are computed together, which is the same over all.
pub(crate) fn cloud_over(atmospheres: &[Atmosphere]) -> Option<CloudBase> {
    atmospheres.first().and_then(Atmosphere::cloud)
}

/// The images of any geometry, one set for each atmosphere. Several cost little more than one: rays, columns
/// and angles are shared. `multiple` is empty for the first order alone, else it holds one table for each
/// atmosphere, whose light is added.
pub fn images_of(
    atmospheres: &[Atmosphere],
    multiple: &[MultipleTable],
    geometry: &SourceGeometry,
) -> Vec<SourceImages> {
    images_with(atmospheres, geometry, 0.0, &|atmosphere, images| {
        if let Some(table) = multiple.get(atmosphere) {
            table.add_to(geometry, images);
        }
    })
}

/// The images of a geometry whose source stands behind a skyline of `blocking_rad`, one set for each atmosphere.
/// `add_later` is given the number of an atmosphere and its first-order images `[image][row][column]` [m⁻² sr⁻¹], and
/// adds all later orders to them.
pub(crate) fn images_with(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    blocking_rad: f64,
    add_later: &dyn Fn(usize, &mut [f64]),
) -> Vec<SourceImages> {
    match atmospheres.len() {
        0 => Vec::new(),
        1 => images_together::<OUTPUT_COUNT>(atmospheres, geometry, blocking_rad, add_later),
        2 => images_together::<{ 2 * OUTPUT_COUNT }>(atmospheres, geometry, blocking_rad, add_later),
        3 => images_together::<{ 3 * OUTPUT_COUNT }>(atmospheres, geometry, blocking_rad, add_later),
        4 => images_together::<{ 4 * OUTPUT_COUNT }>(atmospheres, geometry, blocking_rad, add_later),
        5 => images_together::<{ 5 * OUTPUT_COUNT }>(atmospheres, geometry, blocking_rad, add_later),
        MAX_TOGETHER => {
            images_together::<{ MAX_TOGETHER * OUTPUT_COUNT }>(atmospheres, geometry, blocking_rad, add_later)
        }
        _ => {
            let (first, rest) = atmospheres.split_at(MAX_TOGETHER);
            let mut images = images_with(first, geometry, blocking_rad, add_later);
            images.extend(images_with(rest, geometry, blocking_rad, &|atmosphere, images| {
                add_later(MAX_TOGETHER + atmosphere, images);
            }));
            images
        }
    }
}

/// Columns computed one by one; beyond, every fourth is, and the sky between is smooth in azimuth.
const DENSE_COLUMN_COUNT: usize = 33;
/// Distance of computed columns beyond the dense ones.
const COLUMN_STEP: usize = 4;
/// Where a radiance falls by more than this factor over four computed columns, those between are computed too.
const STEEP_RATIO: f64 = 0.1;
/// Columns that are means over the width of a column of source azimuths: a source of the polar grid stands for
/// light across that width, and a point's value is nearly singular when it lies straight ahead.
pub const NEAR_COLUMN_COUNT: usize = 3;
/// Four-node Gauss–Legendre rule over −½..½, (node, weight), ascending.
pub const ACROSS_COLUMN: [(f64, f64); 4] = [
    (-0.430_568_155_797_026_3, 0.173_927_422_568_726_93),
    (-0.169_990_521_792_428_13, 0.326_072_577_431_273_1),
    (0.169_990_521_792_428_13, 0.326_072_577_431_273_1),
    (0.430_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// One row of every image, `[column]` of `[atmosphere][band][lobe]`, from `radiance` at azimuths [rad].
///
/// Columns of 46° and more are interpolated between every fourth by a cubic: within 4e-3 of the integral for
/// 99 % of the samples, 1.5e-2 at worst where the `oblique` lobe ends.
fn image_row<const N: usize>(radiance: impl Fn(f64) -> [f64; N]) -> Vec<[f64; N]> {
    let exact = |column: usize| -> [f64; N] {
        let azimuth = azimuth_rad(column);
        if column >= NEAR_COLUMN_COUNT {
            return radiance(azimuth);
        }
        let mut sum = [0.0; N];
        for (node, weight) in ACROSS_COLUMN {
            // The image is even, so half of column 0 stands for all of it.
            let weight = match column {
                0 if node < 0.0 => continue,
                0 => 2.0 * weight,
                _ => weight,
            };
            for (sum, value) in sum.iter_mut().zip(radiance(azimuth + node * azimuth_rad(1))) {
                *sum += weight * value;
            }
        }
        sum
    };
    let mut row = vec![[0.0; N]; HALF_COLUMN_COUNT];
    let last = HALF_COLUMN_COUNT - 1;
    let computed =
        (0..DENSE_COLUMN_COUNT).chain((DENSE_COLUMN_COUNT - 1..=last).step_by(COLUMN_STEP).skip(1));
    computed.for_each(|column| row[column] = exact(column));
    for start in (DENSE_COLUMN_COUNT - 1..last).step_by(COLUMN_STEP) {
        let end = start + COLUMN_STEP;
        // Mirrored at 180°.
        let beyond = if end == last { start } else { end + COLUMN_STEP };
        let stencil = [row[start - COLUMN_STEP], row[start], row[end], row[beyond]];
        // Slot by slot, so that an atmosphere's images do not depend on which others are computed with it.
        let steep: [bool; N] = std::array::from_fn(|n| {
            let highest = stencil.iter().map(|value| value[n]).fold(0.0, f64::max);
            stencil.iter().any(|value| value[n] < STEEP_RATIO * highest)
        });
        let any_steep = steep.contains(&true);
        for step in 1..COLUMN_STEP {
            let x = step as f64 / COLUMN_STEP as f64;
            let weights = [
                -x * (x - 1.0) * (x - 2.0) / 6.0,
                (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
                -(x + 1.0) * x * (x - 2.0) / 2.0,
                (x + 1.0) * x * (x - 1.0) / 6.0,
            ];
            let between =
                |n: usize| stencil.iter().zip(weights).map(|(value, weight)| weight * value[n]).sum::<f64>();
            let computed = if any_steep { exact(start + step) } else { [0.0; N] };
            row[start + step] = std::array::from_fn(|n| if steep[n] { computed[n] } else { between(n) });
        }
    }
    row
}

/// `N` is the number of atmospheres times [`OUTPUT_COUNT`].
fn images_together<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    blocking_rad: f64,
    add_later: &dyn Fn(usize, &mut [f64]),
) -> Vec<SourceImages> {
    let nodes = gauss_legendre(NODES_PER_PIECE);
    // [atmosphere][lobe][band][row][column]
    let mut values = vec![0.0f64; N * PIXEL_COUNT];
    for row in 0..ELEVATION_COUNT {
        let radiances: Vec<[f64; N]> = image_row(|azimuth| {
            let elevation = elevation_rad(row);
            cut_radiance_per_watt_fixed(atmospheres, geometry, blocking_rad, azimuth, elevation, &nodes)
        });
        for (column, radiance) in radiances.into_iter().enumerate() {
            let pixel = row * HALF_COLUMN_COUNT + column;
            for (slot, value) in radiance.into_iter().enumerate() {
                // Slots are [atmosphere][band][lobe].
                let (atmosphere, rest) = (slot / OUTPUT_COUNT, slot % OUTPUT_COUNT);
                let image = atmosphere * IMAGE_COUNT + image_index(rest % LOBE_COUNT, rest / LOBE_COUNT);
                values[image * PIXEL_COUNT + pixel] = value;
            }
        }
    }
    for (atmosphere, images) in values.chunks_exact_mut(IMAGE_COUNT * PIXEL_COUNT).enumerate() {
        add_later(atmosphere, images);
    }
    values.chunks_exact(IMAGE_COUNT * PIXEL_COUNT).map(scale_apart).collect()
}

/// Images `[image][row][column]` [m⁻² sr⁻¹] as scale and shape.
fn scale_apart(images: &[f64]) -> SourceImages {
    let weights = scale_weights();
    let mut log_scale = [DARK_LOG_SCALE; IMAGE_COUNT];
    let mut shape = Vec::with_capacity(images.len());
    for (image, log_scale) in images.chunks_exact(PIXEL_COUNT).zip(&mut log_scale) {
        let mean: f64 = weights.iter().zip(image).map(|(weight, value)| weight * value).sum();
        let lit = mean > DARK_LOG_SCALE.exp();
        if lit {
            *log_scale = mean.ln();
        }
        let factor = if lit { 1.0 / mean } else { 0.0 };
        shape.extend(image.iter().map(|value| (value * factor) as f32));
    }
    SourceImages { log_scale, shape }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{Turbidity, single_source::radiance_per_watt_fixed};

    /// An image over its mean has mean one and is brightest towards its source.
    #[test]
    fn shapes_have_mean_one() {
        let atmosphere = Atmosphere::new(Turbidity::default());
        let geometry =
            SourceGeometry { distance_m: 20_000.0, source_altitude_m: 0.0, observer_altitude_m: 0.0 };
        let images = &images_of(&[atmosphere], &[], &geometry)[0];
        let mean: f64 = scale_weights().iter().zip(&images.shape).map(|(w, &x)| w * f64::from(x)).sum();
        assert!((mean - 1.0).abs() < 1e-6);
        // Two atmospheres at once give the same as each alone, far away and in haze too, where rows are steep.
        let (clean, hazy) = (1.0, 6.0);
        let [clean, hazy] = [clean, hazy].map(|t| Atmosphere::new(Turbidity::new(t).unwrap()));
        for distance_m in [20_000.0, 200_000.0] {
            let geometry = SourceGeometry { distance_m, ..geometry };
            let together = images_of(&[clean, hazy], &[], &geometry);
            for (one, both) in [clean, hazy].into_iter().zip(&together) {
                let alone = &images_of(&[one], &[], &geometry)[0];
                assert_eq!((&alone.shape, alone.log_scale), (&both.shape, both.log_scale));
            }
        }
        let low_row = 2 * HALF_COLUMN_COUNT;
        assert!(images.shape[low_row] > 10.0 * images.shape[low_row + HALF_COLUMN_COUNT - 1]);
    }

    /// Columns between those computed are the integrals to five per mille.
    #[test]
    fn interpolated_columns_agree_with_integrals() {
        let atmospheres = [Atmosphere::new(Turbidity::new(6.0).unwrap())];
        let nodes = gauss_legendre(NODES_PER_PIECE);
        for (distance_m, source_altitude_m, observer_altitude_m) in
            [(300.0, 0.0, 0.0), (5_000.0, 1_100.0, 300.0), (30_000.0, 400.0, 1_900.0), (200_000.0, 0.0, 0.0)]
        {
            let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
            let images = &images_of(&atmospheres, &[], &geometry)[0];
            let mut errors = Vec::new();
            for row in (0..ELEVATION_COUNT).step_by(7) {
                for column in DENSE_COLUMN_COUNT..HALF_COLUMN_COUNT {
                    let exact: [f64; OUTPUT_COUNT] = radiance_per_watt_fixed(
                        &atmospheres,
                        &geometry,
                        azimuth_rad(column),
                        elevation_rad(row),
                        &nodes,
                    );
                    for (slot, exact) in exact.into_iter().enumerate() {
                        let image = image_index(slot % LOBE_COUNT, slot / LOBE_COUNT);
                        let scale = images.log_scale[image].exp();
                        let shape = images.shape[image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column];
                        if exact > 1e-4 * scale {
                            errors.push((f64::from(shape) * scale / exact - 1.0).abs());
                        }
                    }
                }
            }
            errors.sort_by(f64::total_cmp);
            assert!(errors.len() > 3_000, "{}", errors.len());
            let (most, worst) = (errors[errors.len() * 99 / 100], errors[errors.len() - 1]);
            println!("{distance_m} m: 99 % within {most:.1e}, all within {worst:.1e}");
            assert!(most < 5e-3 && worst < 2e-2, "{distance_m} m: {most:.1e}, {worst:.1e}");
        }
    }
}
