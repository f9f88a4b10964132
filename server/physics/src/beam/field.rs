//! The field of scattered light of a beam, by successive orders of scattering (van de Hulst 1948).

use super::{
    air::BeamAir,
    grid::{Bands, Between, GATHERED, GATHERED_AZIMUTHS, GATHERED_ZENITHS, Grid, STORED, STORED_AZIMUTHS},
    path::{Bearing, COARSE, DarkPath, FINE, GroundEnd, LitPath},
    sunlight::Sunlight,
};
use crate::{
    bands::BAND_COUNT,
    error::{PhysicsError, check_range},
    multiple_scattering::DEFAULT_GROUND_ALBEDO,
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
    simd::exponential,
    simd_dispatch,
};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Orders are followed until one adds less than this share of the source function anywhere.
const TOLERANCE: f64 = 0.01;
/// No more orders than this; the rest is summed as a geometric series.
const MAX_ORDERS: usize = 20;
/// Largest ratio of that series.
const MAX_TAIL_RATIO: f32 = 0.9;
/// Convergence is tested at rings up to here, radians.
const CONVERGED_TO_RAD: f64 = 112.0 * PI / 180.0;
/// Radiance that stands for darkness, sr⁻¹.
const DARKNESS: f32 = 1e-30;

/// What a beam goes through, and the ground below.
#[derive(Clone, Debug)]
pub struct BeamSetting {
    /// The air.
    pub air: BeamAir,
    /// Lambertian albedo of the ground at sea level, 0..=1, the same in all bands.
    pub ground_albedo: f64,
}

impl BeamSetting {
    /// Over a ground of the usual albedo.
    pub fn new(air: BeamAir) -> Self {
        Self { air, ground_albedo: DEFAULT_GROUND_ALBEDO }
    }

    /// Over another ground.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `ground_albedo`.
    pub fn over(self, ground_albedo: f64) -> Result<Self, PhysicsError> {
        check_range("ground_albedo", ground_albedo, 0.0, 1.0, "")?;
        Ok(Self { ground_albedo, ..self })
    }
}

/// ln of a source function over extinction, `[layer][ring][stored direction]`.
#[derive(Clone, Debug)]
struct SourceFunction {
    log: Vec<Bands>,
}

/// ln of the radiance of the ground, sr⁻¹, `[ring]`.
#[derive(Clone, Debug)]
struct Ground {
    log: Vec<Bands>,
}

/// Scattered light of a beam of unit irradiance outside the air, all orders, at every zenith angle of its source up to 112°.
#[derive(Clone, Debug)]
pub struct BeamField {
    setting: BeamSetting,
    sunlight: Sunlight,
    grid: Grid,
    source: SourceFunction,
    ground: Ground,
    orders: usize,
}

/// Altitude of the ground and of the sphere that throws the Earth's shadow, metres.
pub(super) const GROUND_M: f64 = 0.0;

impl BeamField {
    /// Solves the field. Runs on the current rayon pool; the result does not depend on the number of threads.
    pub fn solve(setting: BeamSetting) -> Self {
        let sunlight = Sunlight::new(&setting.air);
        let grid = Grid::new(&setting.air, GROUND_M);
        let mut ground = direct_ground(&setting, &sunlight, &grid);
        let mut radiance = first_radiance(&setting, &sunlight, &grid, &ground);
        let dark_paths = paths(&grid, |altitude_m, cosine| {
            DarkPath::new(&setting.air, &grid, GROUND_M, altitude_m, cosine, COARSE)
        });
        let mut total = vec![[0.0f32; BAND_COUNT]; grid.point_count() * STORED];
        let mut total_ground = vec![[0.0f64; BAND_COUNT]; grid.ring_count()];
        let mut before = vec![[0.0f32; BAND_COUNT]; grid.point_count()];
        let mut orders = 1;
        loop {
            let mut scattered = scatter(&grid, &radiance);
            let reflected = reflect(&setting, &grid, &radiance);
            ground = Ground::new(&reflected);
            let means = means(&scattered);
            orders += 1;
            add(&mut total, &scattered);
            let last = orders == MAX_ORDERS || largest_share(&grid, &means, &total) < TOLERANCE;
            for (total, reflected) in total_ground.iter_mut().zip(&reflected) {
                total.iter_mut().zip(reflected).for_each(|(total, reflected)| *total += reflected);
            }
            if last {
                add_tail(&mut scattered, &before, &means);
                add(&mut total, &scattered);
                break;
            }
            before = means;
            let function = SourceFunction::new(&scattered);
            radiance = transport(&grid, &function, &ground, &dark_paths);
        }
        let source = SourceFunction::new(&total);
        Self { setting, sunlight, grid, source, ground: Ground::new(&total_ground), orders }
    }

    /// What the field was solved for.
    pub fn setting(&self) -> &BeamSetting {
        &self.setting
    }

    /// How many orders were followed; the rest is a geometric series.
    pub fn orders(&self) -> usize {
        self.orders
    }

    /// Share of the beam that reaches a place unscattered, per band: irradiance at right angles to it over that outside the
    /// air. 0 below the horizon. `zenith_angle_rad` is the source's true one.
    pub fn transmittance(&self, altitude_m: f64, zenith_angle_rad: f64) -> [f64; BAND_COUNT] {
        self.sunlight.at(altitude_m.max(GROUND_M), zenith_angle_rad.cos())
    }

    /// True zenith angle of the source at which its beam is cut off by the ground, radians.
    pub fn shadow_rad(&self, altitude_m: f64) -> f64 {
        self.sunlight.shadow_rad(altitude_m.max(GROUND_M))
    }

    /// One elevation of an observer's sky. Observers below sea level count as there.
    pub fn view(&self, observer_altitude_m: f64, elevation_rad: f64) -> BeamView<'_> {
        let (altitude_m, cos_zenith) = (observer_altitude_m.max(GROUND_M), elevation_rad.sin());
        let air = &self.setting.air;
        BeamView {
            field: self,
            cos_zenith,
            lit: LitPath::new(air, &self.sunlight, GROUND_M, altitude_m, cos_zenith, FINE),
            dark: DarkPath::new(air, &self.grid, GROUND_M, altitude_m, cos_zenith, COARSE),
        }
    }
}

/// One elevation of an observer's sky.
#[derive(Clone, Debug)]
pub struct BeamView<'a> {
    field: &'a BeamField,
    cos_zenith: f64,
    lit: LitPath,
    dark: DarkPath,
}

impl BeamView<'_> {
    /// Light scattered once, for unit irradiance outside the air, sr⁻¹. The source is at a true zenith angle, and the view
    /// `azimuth_rad` away from its azimuth.
    pub fn first_order_per_sr(&self, source_zenith_rad: f64, azimuth_rad: f64) -> [f64; BAND_COUNT] {
        let bearing = Bearing::new(source_zenith_rad, azimuth_rad.cos());
        once_scattered(&self.lit, &self.field.sunlight, &bearing, self.cos_zenith).map(f64::from)
    }

    /// Scattered light of all orders; the rest as [`Self::first_order_per_sr`].
    pub fn radiance_per_sr(&self, source_zenith_rad: f64, azimuth_rad: f64) -> [f64; BAND_COUNT] {
        let bearing = Bearing::new(source_zenith_rad, azimuth_rad.cos());
        let first = once_scattered(&self.lit, &self.field.sunlight, &bearing, self.cos_zenith);
        let later = along(&self.field.grid, &self.field.source, &self.field.ground, &self.dark, &bearing);
        std::array::from_fn(|band| f64::from(first[band]) + f64::from(later[band]))
    }
}

/// Light scattered once along a ray, sr⁻¹.
#[inline(always)]
fn once_scattered(path: &LitPath, light: &Sunlight, bearing: &Bearing, cos_zenith: f64) -> Bands {
    let [molecules, aerosol] = path.scattered(light, bearing);
    let cosine = bearing.cos_scattering(cos_zenith);
    let (m, a) = (rayleigh_per_sr(cosine) as f32, henyey_greenstein_per_sr(cosine, AEROSOL_ASYMMETRY) as f32);
    std::array::from_fn(|band| m * molecules[band] + a * aerosol[band])
}

fn log_of(value: Bands) -> Bands {
    value.map(|value| value.max(DARKNESS).ln())
}

impl SourceFunction {
    fn new(values: &[Bands]) -> Self {
        Self { log: values.par_iter().map(|&value| log_of(value)).collect() }
    }
}

impl Ground {
    fn new(radiance: &[[f64; BAND_COUNT]]) -> Self {
        Self { log: radiance.iter().map(|value| log_of(value.map(|value| value as f32))).collect() }
    }

    #[inline(always)]
    fn at(&self, grid: &Grid, end: &GroundEnd, bearing: &Bearing) -> Bands {
        let cosine = end.cos_arc * bearing.cos_source as f32
            + end.sin_arc * (bearing.sin_source * bearing.cos_azimuth) as f32;
        let ring = grid.ring_at(cosine.clamp(-1.0, 1.0).acos());
        let (near, far) = (self.log[ring.lower], self.log[ring.lower + 1]);
        std::array::from_fn(|band| {
            end.through[band] * exponential(near[band] + ring.weight * (far[band] - near[band]))
        })
    }
}

/// Radiance of the ground under the beam itself.
fn direct_ground(setting: &BeamSetting, light: &Sunlight, grid: &Grid) -> Ground {
    let lit = |&zenith: &f64| {
        let factor = setting.ground_albedo / PI * zenith.cos().max(0.0);
        light.at(GROUND_M, zenith.cos()).map(|light| factor * light)
    };
    Ground::new(&grid.ring_rad.iter().map(lit).collect::<Vec<_>>())
}

/// Rays of every layer's gathered zenith angles, `[layer][zenith]`.
fn paths<P: Send>(grid: &Grid, path: impl Fn(f64, f64) -> P + Sync) -> Vec<Vec<P>> {
    grid.layer_m
        .par_iter()
        .zip(&grid.directions)
        .map(|(&altitude_m, directions)| {
            let zeniths = directions.iter().step_by(GATHERED_AZIMUTHS);
            zeniths.map(|direction| path(altitude_m, direction.cos_zenith)).collect()
        })
        .collect()
}

/// Light of one ray from the direction that is gathered.
fn gathered(grid: &Grid, radiance: impl Fn(usize, usize, &Bearing, f64) -> Bands + Sync) -> Vec<Bands> {
    let mut found = vec![[0.0; BAND_COUNT]; grid.point_count() * GATHERED];
    found.par_chunks_mut(GATHERED).enumerate().for_each(|(point, out)| {
        let (layer, ring) = (point / grid.ring_count(), point % grid.ring_count());
        for (index, (out, direction)) in out.iter_mut().zip(&grid.directions[layer]).enumerate() {
            let bearing = Bearing::new(grid.ring_rad[ring], direction.cos_azimuth);
            *out = radiance(layer, index / GATHERED_AZIMUTHS, &bearing, direction.cos_zenith);
        }
    });
    found
}

/// Light scattered once or reflected by the ground, from every direction at every place.
fn first_radiance(setting: &BeamSetting, light: &Sunlight, grid: &Grid, ground: &Ground) -> Vec<Bands> {
    let paths = paths(grid, |altitude_m, cosine| {
        LitPath::new(&setting.air, light, GROUND_M, altitude_m, cosine, FINE)
    });
    gathered(grid, |layer, zenith, bearing, cos_zenith| {
        let path = &paths[layer][zenith];
        let mut radiance = once_scattered(path, light, bearing, cos_zenith);
        if let Some(end) = path.end() {
            let ground = ground.at(grid, end, bearing);
            radiance.iter_mut().zip(ground).for_each(|(radiance, ground)| *radiance += ground);
        }
        radiance
    })
}

/// Light of the next order from every direction at every place.
fn transport(grid: &Grid, source: &SourceFunction, ground: &Ground, paths: &[Vec<DarkPath>]) -> Vec<Bands> {
    debug_assert!(paths.iter().all(|layer| layer.len() == 2 * GATHERED_ZENITHS));
    gathered(grid, |layer, zenith, bearing, _| along(grid, source, ground, &paths[layer][zenith], bearing))
}

simd_dispatch! {
    /// The source function along a ray, and the ground at its end, sr⁻¹.
    fn along(
        grid: &Grid,
        source: &SourceFunction,
        ground: &Ground,
        path: &DarkPath,
        bearing: &Bearing,
    ) -> Bands = along_body;
}

#[inline(always)]
fn along_body(
    grid: &Grid,
    source: &SourceFunction,
    ground: &Ground,
    path: &DarkPath,
    bearing: &Bearing,
) -> Bands {
    let (cos_source, sin_source) = (bearing.cos_source as f32, bearing.sin_source as f32);
    let across = sin_source * bearing.cos_azimuth as f32;
    let rings = grid.ring_count();
    let mut sum = [0.0; BAND_COUNT];
    for step in &path.steps {
        let cosine = (step.cos_arc * cos_source + step.sin_arc * across).clamp(-1.0, 1.0);
        let ring = grid.ring_at(cosine.acos());
        let sine = (1.0 - cosine * cosine).max(1e-12).sqrt();
        let cos_azimuth = (step.cos_arc * across - step.sin_arc * cos_source) / sine;
        let place =
            cos_azimuth.clamp(-1.0, 1.0).acos() * ((STORED_AZIMUTHS - 1) as f32 / std::f32::consts::PI);
        let azimuth = Between::even(place, STORED_AZIMUTHS);
        let mut log = [0.0; BAND_COUNT];
        for (layer, layer_weight) in both(step.layer) {
            for (ring, ring_weight) in both(ring) {
                for (zenith, zenith_weight) in both(step.zenith) {
                    let first = (layer * rings + ring) * STORED + zenith * STORED_AZIMUTHS + azimuth.lower;
                    let weight = layer_weight * ring_weight * zenith_weight;
                    let (low, high) = (&source.log[first], &source.log[first + 1]);
                    let (low_weight, high_weight) =
                        (weight * (1.0 - azimuth.weight), weight * azimuth.weight);
                    for band in 0..BAND_COUNT {
                        log[band] += low_weight * low[band] + high_weight * high[band];
                    }
                }
            }
        }
        for band in 0..BAND_COUNT {
            sum[band] += step.weight[band] * exponential(log[band]);
        }
    }
    if let Some(end) = &path.end {
        let ground = ground.at(grid, end, bearing);
        for band in 0..BAND_COUNT {
            sum[band] += ground[band];
        }
    }
    sum
}

#[inline(always)]
fn both(between: Between) -> [(usize, f32); 2] {
    [(between.lower, 1.0 - between.weight), (between.lower + 1, between.weight)]
}

/// The source function over extinction of the next order.
fn scatter(grid: &Grid, radiance: &[Bands]) -> Vec<Bands> {
    let mut scattered = vec![[0.0; BAND_COUNT]; grid.point_count() * STORED];
    scattered
        .par_chunks_mut(STORED)
        .zip(radiance.par_chunks(GATHERED))
        .enumerate()
        .for_each(|(point, (out, light))| scatter_place(grid, point, light, out));
    scattered
}

simd_dispatch! {
    /// See [`Grid::scattered`].
    fn scatter_place(grid: &Grid, point: usize, light: &[Bands], out: &mut [Bands]) = scatter_place_body;
}

#[inline(always)]
fn scatter_place_body(grid: &Grid, point: usize, light: &[Bands], out: &mut [Bands]) {
    grid.scattered(point, light, out);
}

/// Radiance of the ground under light of one order, sr⁻¹, `[ring]`.
fn reflect(setting: &BeamSetting, grid: &Grid, radiance: &[Bands]) -> Vec<[f64; BAND_COUNT]> {
    let factor = setting.ground_albedo / PI;
    radiance
        .chunks_exact(GATHERED)
        .take(grid.ring_count())
        .map(|light| grid.flux_down(light).map(|flux| factor * flux))
        .collect()
}

/// Mean over stored directions at every place.
fn means(values: &[Bands]) -> Vec<Bands> {
    let mean = |place: &[Bands]| -> Bands {
        std::array::from_fn(|band| place.iter().map(|value| value[band]).sum::<f32>() / STORED as f32)
    };
    values.par_chunks(STORED).map(mean).collect()
}

fn add(total: &mut [Bands], part: &[Bands]) {
    total.par_iter_mut().zip(part).for_each(|(total, part)| {
        total.iter_mut().zip(part).for_each(|(total, part)| *total += part);
    });
}

/// Largest share of one order in the sum, over places up to [`CONVERGED_TO_RAD`] and bands.
fn largest_share(grid: &Grid, part: &[Bands], total: &[Bands]) -> f64 {
    let mut largest = 0.0f32;
    for (point, (part, total)) in part.iter().zip(means(total)).enumerate() {
        if grid.ring_rad[point % grid.ring_count()] <= CONVERGED_TO_RAD {
            for band in 0..BAND_COUNT {
                largest = largest.max(part[band] / total[band].max(DARKNESS));
            }
        }
    }
    f64::from(largest)
}

/// Makes the last order the sum of a geometric series of all after it, with the ratio of the last two.
fn add_tail(last: &mut [Bands], before: &[Bands], mean: &[Bands]) {
    for ((place, before), mean) in last.chunks_exact_mut(STORED).zip(before).zip(mean) {
        let factor: Bands = std::array::from_fn(|band| {
            let ratio = (mean[band] / before[band].max(DARKNESS)).clamp(0.0, MAX_TAIL_RATIO);
            ratio / (1.0 - ratio)
        });
        for value in place {
            value.iter_mut().zip(factor).for_each(|(value, factor)| *value *= factor);
        }
    }
}
