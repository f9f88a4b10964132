//! Celestial tables: skies of a beam of unit irradiance from outside the air, one table a turbidity, in a file beside the
//! pack of lamps' skies (`docs/model.md#beams`).
//!
//! What is stored is ln of the radiance over the phase function of the air as a whole, which is smooth over
//! directions and zenith angles, in whole steps.

mod file;
mod make;
pub mod manifest;

pub use make::{CelestialOptions, precompute_celestial};

use manifest::{CelestialAxes, CelestialManifest};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama, Turbidity,
    beam::BeamAir,
    interpolation::{MAX_STENCIL, Stencil},
    multiple_scattering::DEFAULT_GROUND_ALBEDO,
    panorama::{azimuth_rad, elevation_rad},
};
use std::{
    f64::consts::{FRAC_PI_2, PI, TAU},
    sync::Arc,
};

/// ln of one step of the stored numbers: half a step is an error of 0.1 %.
const LOG_STEP: f64 = 1.0 / 512.0;

/// Skies of a beam of unit irradiance at one turbidity.
#[derive(Clone, Debug)]
pub struct CelestialTable {
    manifest: CelestialManifest,
    zenith_angle_rad: Vec<f64>,
    elevation_node_rad: Vec<f64>,
    /// 0, 1, 2, …, one a point of the direct beam.
    direct_place: Vec<f64>,
    air: BeamAir,
    /// `[observer_altitude][zenith_angle][band][elevation][azimuth]`, steps.
    scattered: Vec<i16>,
    /// ln of the optical depth, `[observer_altitude][point][band]`.
    direct: Vec<f32>,
    /// True zenith angle at which the beam is cut off, `[observer_altitude]`.
    shadow_rad: Vec<f32>,
    is_synthetic: bool,
}

/// The four azimuth nodes around an azimuth and their weights; the sky is even about 0 and 180°.
fn azimuth_stencil(from_source_rad: f64, count: usize) -> [(usize, f32); MAX_STENCIL] {
    let folded = (from_source_rad + PI).rem_euclid(TAU) - PI;
    let place = folded.abs() / PI * (count - 1) as f64;
    let lower = (place as usize).min(count - 2);
    let t = place - lower as f64;
    let last = count as isize - 1;
    let node = |offset: isize| {
        let index = (lower as isize + offset).abs();
        (if index > last { 2 * last - index } else { index }) as usize
    };
    [
        (node(-1), (-t * (t - 1.0) * (t - 2.0) / 6.0) as f32),
        (node(0), ((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0) as f32),
        (node(1), (-(t + 1.0) * t * (t - 2.0) / 2.0) as f32),
        (node(2), ((t + 1.0) * t * (t - 1.0) / 6.0) as f32),
    ]
}

impl CelestialTable {
    fn from_parts(
        manifest: CelestialManifest,
        turbidity: Turbidity,
        scattered: Vec<i16>,
        direct: Vec<f32>,
        shadow_rad: Vec<f32>,
        is_synthetic: bool,
    ) -> Self {
        let radians = |degrees: &[f64]| degrees.iter().map(|angle| angle.to_radians()).collect();
        Self {
            zenith_angle_rad: radians(&manifest.axes.zenith_angle_deg),
            elevation_node_rad: radians(&manifest.axes.elevation_deg),
            direct_place: (0..manifest.axes.direct_count).map(|point| point as f64).collect(),
            air: BeamAir::new(turbidity),
            manifest,
            scattered,
            direct,
            shadow_rad,
            is_synthetic,
        }
    }

    /// A table of a plausible, plain sky made by a formula, with the sample points of real ones: for tests that need any.
    pub fn synthetic(turbidity: Turbidity) -> Self {
        let axes = CelestialAxes::full();
        let mut manifest =
            CelestialManifest::new(turbidity.value(), DEFAULT_GROUND_ALBEDO, axes.clone(), LOG_STEP);
        manifest.checksum = format!("synthetic {}", turbidity.value());
        let mut scattered = Vec::with_capacity(axes.sample_counts().iter().product());
        for altitude_m in &axes.observer_altitude_m {
            for zenith in &axes.zenith_angle_deg {
                for band in 0..BAND_COUNT {
                    for elevation in &axes.elevation_deg {
                        let thick = -1.0 - altitude_m / 8e3 - 0.01 * elevation + 0.2 * band as f64;
                        // Darker by a factor of ten for every two degrees below the horizon, to a floor.
                        let dusk = -(zenith - 90.0).clamp(0.0, 16.0) * 1.15;
                        let step = ((thick + dusk) / LOG_STEP).round() as i16;
                        scattered.extend((0..axes.azimuth_count).map(|_| step));
                    }
                }
            }
        }
        let direct = (0..axes.observer_altitude_m.len() * axes.direct_count * BAND_COUNT)
            .map(|index| {
                let point = index / BAND_COUNT % axes.direct_count;
                (0.3 / (1.0 - point as f32 / (axes.direct_count as f32 - 0.5))).ln()
            })
            .collect();
        let shadow_rad = vec![1.58; axes.observer_altitude_m.len()];
        Self::from_parts(manifest, turbidity, scattered, direct, shadow_rad, true)
    }

    /// The table of a turbidity between those of others, which have the same sample points, by the weights of an interpolation: what is
    /// stored is blended, and the phase function is that of the turbidity itself.
    pub fn between(tables: &[Arc<Self>], weights: &[f64], turbidity: Turbidity) -> Self {
        let first = &tables[0];
        let manifest = CelestialManifest {
            turbidity: turbidity.value(),
            checksum: String::new(),
            ..first.manifest.clone()
        };
        let scattered =
            blended(tables, weights, |table| table.scattered.iter().map(|steps| f32::from(*steps)));
        Self::from_parts(
            manifest,
            turbidity,
            scattered.into_iter().map(|steps| steps.round() as i16).collect(),
            blended(tables, weights, |table| table.direct.iter().copied()),
            blended(tables, weights, |table| table.shadow_rad.iter().copied()),
            first.is_synthetic,
        )
    }

    /// Bytes held.
    pub fn byte_count(&self) -> usize {
        size_of_val(&self.scattered[..]) + size_of_val(&self.direct[..])
    }

    /// What the table is.
    pub fn manifest(&self) -> &CelestialManifest {
        &self.manifest
    }

    /// Whether it is made by a formula, for tests.
    pub fn is_synthetic(&self) -> bool {
        self.is_synthetic
    }

    /// Turbidity at sea level.
    pub fn turbidity(&self) -> f64 {
        self.manifest.turbidity
    }

    /// BLAKE3 of the data, hexadecimal.
    pub fn checksum(&self) -> &str {
        &self.manifest.checksum
    }

    /// Zenith angles of the source with a sky of their own, radians, ascending: true ones, not refracted.
    pub fn zenith_angle_rad(&self) -> &[f64] {
        &self.zenith_angle_rad
    }

    /// Lowest and highest observer of the table, m.
    pub fn altitude_range_m(&self) -> (f64, f64) {
        let altitudes = &self.manifest.axes.observer_altitude_m;
        (altitudes[0], altitudes[altitudes.len() - 1])
    }

    /// Radiance per unit irradiance outside the air, sr⁻¹, of a beam from a zenith angle of [`Self::zenith_angle_rad`] and
    /// azimuth 0 (north): scattered light of all orders, without the direct beam. An observer's altitude beyond those of
    /// the table counts as the nearest; a node beyond the last as the last.
    pub fn node_sky(&self, node: usize, observer_altitude_m: f64) -> Panorama {
        let node = node.min(self.zenith_angle_rad.len() - 1);
        self.sky(Stencil::single(node), self.zenith_angle_rad[node], 0.0, observer_altitude_m)
    }

    /// The same at any true zenith angle and azimuth (radians clockwise from north) of the source, by cubic interpolation of the
    /// logarithm between zenith angles. Dark beyond the last one.
    pub fn beam_sky(&self, zenith_angle_rad: f64, azimuth_rad: f64, observer_altitude_m: f64) -> Panorama {
        let last = self.zenith_angle_rad[self.zenith_angle_rad.len() - 1];
        if zenith_angle_rad > last + 1e-9 {
            return Panorama::dark();
        }
        let zenith = Stencil::lagrange_or_node(&self.zenith_angle_rad, zenith_angle_rad, 1e-12);
        self.sky(zenith, zenith_angle_rad, azimuth_rad, observer_altitude_m)
    }

    /// Radiance at the zenith of [`Self::node_sky`], sr⁻¹ by band, whatever the beam's azimuth.
    pub fn node_zenith(&self, node: usize, observer_altitude_m: f64) -> [f64; BAND_COUNT] {
        let axes = &self.manifest.axes;
        let (altitude_m, altitude) = self.altitude(observer_altitude_m);
        let elevation = Stencil::lagrange(&self.elevation_node_rad, FRAC_PI_2);
        let phase = self.air.mixed_phase(altitude_m).per_sr(self.zenith_angle_rad[node].cos());
        std::array::from_fn(|band| {
            let steps = altitude.sum(|altitude| {
                let image = (altitude * self.zenith_angle_rad.len() + node) * BAND_COUNT + band;
                let first = image * axes.direction_count();
                elevation.sum(|row| f64::from(self.scattered[first + row * axes.azimuth_count]))
            });
            phase[band] * (LOG_STEP * steps).exp()
        })
    }

    /// Share of a beam from a true zenith angle that reaches an observer unscattered and unabsorbed, per band; 0 below the
    /// horizon. It is of irradiance at right angles to the beam: refraction, which flattens the Sun, dims it at the horizon.
    pub fn transmittance(&self, zenith_angle_rad: f64, observer_altitude_m: f64) -> [f64; BAND_COUNT] {
        let altitudes = &self.manifest.axes.observer_altitude_m;
        let altitude = Stencil::lagrange(altitudes, observer_altitude_m);
        // The horizon's dip grows as the root of the altitude.
        let linear = linear_stencil(altitudes, observer_altitude_m);
        let dip = |node: usize| f64::from(self.shadow_rad[node] - self.shadow_rad[0]).powi(2);
        let dip2: f64 = linear.iter().map(|&(node, weight)| weight * dip(node)).sum();
        let shadow_rad = f64::from(self.shadow_rad[0]) + dip2.sqrt();
        if zenith_angle_rad > shadow_rad {
            return [0.0; BAND_COUNT];
        }
        let count = self.manifest.axes.direct_count;
        let place =
            (1.0 - (1.0 - zenith_angle_rad.max(0.0) / shadow_rad).max(0.0).sqrt()) * (count - 1) as f64;
        let point = Stencil::lagrange(&self.direct_place, place);
        std::array::from_fn(|band| {
            let at = |node: usize, point: usize| {
                f64::from(self.direct[(node * count + point) * BAND_COUNT + band])
            };
            let log_depth = altitude.sum(|node| point.sum(|point| at(node, point)));
            (-log_depth.exp()).exp()
        })
    }

    fn sky(
        &self,
        zenith: Stencil,
        zenith_angle_rad: f64,
        source_azimuth_rad: f64,
        observer_altitude_m: f64,
    ) -> Panorama {
        let axes = &self.manifest.axes;
        let (altitude_m, altitude) = self.altitude(observer_altitude_m);
        let steps = self.steps_at(&altitude, &zenith);
        let stencils: Vec<[(usize, f32); MAX_STENCIL]> = (0..AZIMUTH_COUNT)
            .map(|column| azimuth_stencil(azimuth_rad(column) - source_azimuth_rad, axes.azimuth_count))
            .collect();
        let cos_azimuth: Vec<f64> =
            (0..AZIMUTH_COUNT).map(|column| (azimuth_rad(column) - source_azimuth_rad).cos()).collect();
        let (sin_source, cos_source) = zenith_angle_rad.sin_cos();
        let phase_of = self.air.mixed_phase(altitude_m);
        // The sky is even about its source: towards the north half of it is the rest.
        let columns = if source_azimuth_rad == 0.0 { AZIMUTH_COUNT / 2 + 1 } else { AZIMUTH_COUNT };
        let rows: Vec<[[f32; AZIMUTH_COUNT]; BAND_COUNT]> = (0..ELEVATION_COUNT)
            .into_par_iter()
            .map(|row| {
                let (sin_elevation, cos_elevation) = elevation_rad(row).sin_cos();
                let nodes = self.row_steps(&steps, elevation_rad(row));
                let mut out = [[0.0; AZIMUTH_COUNT]; BAND_COUNT];
                for column in 0..columns {
                    let cosine =
                        sin_elevation * cos_source + cos_elevation * sin_source * cos_azimuth[column];
                    let phase = phase_of.per_sr(cosine.clamp(-1.0, 1.0));
                    for (band, out) in out.iter_mut().enumerate() {
                        let nodes = &nodes[band * axes.azimuth_count..][..axes.azimuth_count];
                        let steps: f32 =
                            stencils[column].iter().map(|&(node, weight)| weight * nodes[node]).sum();
                        out[column] = phase[band] as f32 * (LOG_STEP as f32 * steps).exp();
                    }
                }
                for out in &mut out {
                    for column in columns..AZIMUTH_COUNT {
                        out[column] = out[AZIMUTH_COUNT - column];
                    }
                }
                out
            })
            .collect();
        let mut panorama = Panorama::dark();
        let samples = panorama.samples_mut();
        for (row, bands) in rows.iter().enumerate() {
            for (band, values) in bands.iter().enumerate() {
                samples[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT].copy_from_slice(values);
            }
        }
        panorama
    }

    /// An observer's altitude within those of the table, and the ones around it.
    fn altitude(&self, observer_altitude_m: f64) -> (f64, Stencil) {
        let altitudes = &self.manifest.axes.observer_altitude_m;
        let altitude_m = observer_altitude_m.clamp(altitudes[0], altitudes[altitudes.len() - 1]);
        (altitude_m, Stencil::lagrange_or_node(altitudes, altitude_m, 1e-6))
    }

    /// Steps between altitudes and zenith angles, `[band][elevation][azimuth]`.
    fn steps_at(&self, altitude: &Stencil, zenith: &Stencil) -> Vec<f32> {
        let image = BAND_COUNT * self.manifest.axes.direction_count();
        let mut sum = vec![0.0f32; image];
        for (altitude, altitude_weight) in altitude {
            for (node, zenith_weight) in zenith {
                let weight = (altitude_weight * zenith_weight) as f32;
                let first = (altitude * self.zenith_angle_rad.len() + node) * image;
                if weight == 0.0 {
                    continue;
                }
                for (sum, &steps) in sum.iter_mut().zip(&self.scattered[first..first + image]) {
                    *sum += weight * f32::from(steps);
                }
            }
        }
        sum
    }

    /// Steps at an elevation, `[band][azimuth]`.
    fn row_steps(&self, steps: &[f32], elevation_rad: f64) -> Vec<f32> {
        let axes = &self.manifest.axes;
        let azimuths = axes.azimuth_count;
        let stencil = Stencil::lagrange(&self.elevation_node_rad, elevation_rad.clamp(0.0, FRAC_PI_2));
        let mut nodes = vec![0.0f32; BAND_COUNT * azimuths];
        for (band, nodes) in nodes.chunks_exact_mut(azimuths).enumerate() {
            for (elevation, weight) in stencil {
                let row = (band * axes.elevation_deg.len() + elevation) * azimuths;
                for (node, steps) in nodes.iter_mut().zip(&steps[row..row + azimuths]) {
                    *node += weight as f32 * steps;
                }
            }
        }
        nodes
    }
}

/// Sums of what tables hold by weights.
fn blended<'a, Values: Iterator<Item = f32>>(
    tables: &'a [Arc<CelestialTable>],
    weights: &[f64],
    of: impl Fn(&'a CelestialTable) -> Values,
) -> Vec<f32> {
    let mut sums = vec![0.0; of(&tables[0]).count()];
    for (table, weight) in tables.iter().zip(weights) {
        sums.iter_mut().zip(of(table)).for_each(|(sum, value)| *sum += *weight as f32 * value);
    }
    sums
}

/// Two neighbours and their weights; beyond the ends the end.
fn linear_stencil(nodes: &[f64], x: f64) -> [(usize, f64); 2] {
    let last = nodes.len() - 1;
    if last == 0 {
        return [(0, 1.0), (0, 0.0)];
    }
    let upper = nodes.partition_point(|&node| node <= x).clamp(1, last);
    let weight = ((x - nodes[upper - 1]) / (nodes[upper] - nodes[upper - 1])).clamp(0.0, 1.0);
    [(upper - 1, 1.0 - weight), (upper, weight)]
}

#[cfg(test)]
mod tests;
