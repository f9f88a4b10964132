//! One source as a pack has it.

use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, LOBE_COUNT, interpolation::Stencil, panorama::azimuth_rad};
use skyglow_tables::{OffsetAxis, ResidentTables, curvature::log_scale_at, resident::FREQUENCY_COUNT};

/// Coefficients of one source on ring 0 over the basis, scale included, lobes mixed, `[band][basis]`.
fn coefficients(
    observers: Stencil,
    axis: &OffsetAxis,
    offset_m: f64,
    basis_count: usize,
    lobes: [f64; LOBE_COUNT],
    node: impl Fn(usize, usize, usize, usize) -> (f64, Vec<f64>),
) -> Vec<Vec<f64>> {
    let position = axis.position(offset_m);
    let low = (position as usize).min(axis.count - 2);
    let upper_weight = position - low as f64;
    let mut bands = vec![vec![0.0; basis_count]; BAND_COUNT];
    for (band, out) in bands.iter_mut().enumerate() {
        for (lobe, emission) in (0..LOBE_COUNT).zip(lobes).filter(|(_, emission)| *emission > 0.0) {
            // Observers are mixed node by node, then nodes weighed, as an engine does.
            let at =
                |offset: usize| -> f64 { observers.sum(|observer| node(observer, lobe, band, offset).0) };
            let log_scale = log_scale_at(axis, position, at);
            let mut shape = [vec![0.0; basis_count], vec![0.0; basis_count]];
            for (side, shape) in shape.iter_mut().enumerate() {
                for (observer, weight) in observers {
                    let (_, coefficients) = node(observer, lobe, band, low + side);
                    for (sum, c) in shape.iter_mut().zip(&coefficients) {
                        *sum += weight * c;
                    }
                }
            }
            let scale = emission * log_scale.exp();
            for (k, out) in out.iter_mut().enumerate() {
                *out += scale * (shape[0][k] * (1.0 - upper_weight) + shape[1][k] * upper_weight);
            }
        }
    }
    bands
}

/// The same from a pack at one angle of the tables, 0 the open sky.
pub fn coefficients_at(
    tables: &ResidentTables,
    angle: usize,
    observer_m: f64,
    offset_m: f64,
    lobes: [f64; LOBE_COUNT],
) -> Vec<Vec<f64>> {
    let values = |log: f32, shape: &[half::f16]| {
        (f64::from(log), shape.iter().map(|c| f64::from(c.to_f32())).collect::<Vec<_>>())
    };
    match (&tables.blocked, angle.checked_sub(1)) {
        (Some(blocked), Some(angle)) => {
            let observers = Stencil::lagrange(&blocked.observer_altitude_m, observer_m);
            let count = blocked.basis_count;
            coefficients(
                observers,
                &blocked.offset_axis[angle][0],
                offset_m,
                count,
                lobes,
                |observer, lobe, band, offset| {
                    let log_scale =
                        blocked.log_scale[blocked.scale_index(observer, angle, lobe, band, 0, offset)];
                    let node = blocked.shape_index(observer, angle, lobe, band, 0, offset);
                    values(log_scale, &blocked.shape[node * count..(node + 1) * count])
                },
            )
        }
        _ => {
            let observers = Stencil::lagrange(&tables.observer_altitude_m, observer_m);
            let count = tables.basis_count;
            coefficients(
                observers,
                &tables.offset_axis[0],
                offset_m,
                count,
                lobes,
                |observer, lobe, band, offset| {
                    let log_scale = tables.log_scale[tables.scale_index(observer, lobe, band, 0, offset)];
                    let node = tables.shape_index(observer, lobe, band, 0, offset);
                    values(log_scale, &tables.shape[node * count..(node + 1) * count])
                },
            )
        }
    }
}

/// B_k at a row and column from its spectrum.
pub fn basis_sample(tables: &ResidentTables, k: usize, row: usize, column: usize) -> f64 {
    let spectrum = &tables.basis_spectrum[tables.spectrum_index(k, row, 0)..][..FREQUENCY_COUNT];
    let sum: f64 = spectrum
        .iter()
        .enumerate()
        .map(|(f, &value)| {
            let copies = if f == 0 || f == FREQUENCY_COUNT - 1 { 1.0 } else { 2.0 };
            copies * f64::from(value) * (f as f64 * azimuth_rad(column)).cos()
        })
        .sum();
    sum / AZIMUTH_COUNT as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{
        Atmosphere, Band, Turbidity,
        single_source::{SourceGeometry, radiance_per_watt_of},
    };
    use skyglow_tables::{Clouds, Pack};
    use std::path::Path;

    /// Overhead, an observer high above a near light sees the cloud that it lights: the first order, and some more from later ones.
    /// With every sample of an image weighed by its own size alone, packs had a third of it.
    #[test]
    fn clouds_over_near_lights_are_bright() {
        let lambert = [1.0, 0.0, 0.0];
        for base_m in [800, 1_500, 3_000] {
            let name = format!("turbidity-2.50-multiple-clouds-{base_m}.skyglow");
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
            let pack = Pack::open(&folder.join(name)).unwrap();
            let clouds = Clouds::new(base_m, 0.5).unwrap();
            let air = Atmosphere::new(Turbidity::new(2.5).unwrap()).under(Some(clouds.base()));
            for (distance_m, share) in [(250.0, 0.85), (400.0, 0.6), (1_000.0, 0.85), (1_000.0, 0.4)] {
                let observer_altitude_m = share * clouds.ceiling_m();
                let geometry = SourceGeometry { distance_m, source_altitude_m: 200.0, observer_altitude_m };
                let tables = pack.resident(&[distance_m]);
                let offset_m = 200.0 - observer_altitude_m;
                let coefficients = coefficients_at(&tables, 0, observer_altitude_m, offset_m, lambert);
                let of_band = &coefficients[Band::MIDDLE.index()];
                let functions = of_band.iter().enumerate();
                let found: f64 = functions.map(|(k, c)| c * basis_sample(&tables, k, 63, 64)).sum();
                let (azimuth, elevation) = (azimuth_rad(64), skyglow_physics::panorama::elevation_rad(63));
                let first = radiance_per_watt_of(&air, &geometry, azimuth, elevation, 1e-6);
                let ratio = found / first[Band::MIDDLE.index()][0];
                assert!(
                    (1.07..1.25).contains(&ratio),
                    "{base_m} {distance_m} {observer_altitude_m}: {ratio}"
                );
            }
        }
    }
}
