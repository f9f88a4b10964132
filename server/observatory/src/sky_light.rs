//! Light of the sky that ground has, and that the air before it adds (`docs/model.md#lit-ground`).

use crate::sky::RenderedSky;
use glam::DVec3;
use skyglow_physics::{
    AZIMUTH_COUNT, Direction, ELEVATION_COUNT, SKY_RESPONSES, SeenLight, SeenSky, Slope,
    lit_slopes::LitSlopes, panorama::solid_angle_sr, sampler::Sampler,
};
use skyglow_scene::SeenGround;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Along a ridge the lowest visible row of the sky jumps; so many columns to either side are one.
const RIDGE_COLUMNS: usize = 4;

/// Light of the sky that comes to the ground and from the horizon.
pub(crate) struct SkyLight {
    slopes: LitSlopes<4>,
    /// Moon and Sun: towards them, and their illuminance across.
    pub(crate) discs: Vec<(DVec3, SeenLight)>,
    /// Of level ground.
    pub(crate) level: SeenLight,
    /// Just above the ground, by column.
    horizon: Vec<SeenLight>,
    /// In every direction, without ground before it.
    seen: SeenSky,
}

impl SkyLight {
    /// Of artificial light, or `in_total` of the natural sky too.
    pub(crate) fn new(sky: &RenderedSky, in_total: bool) -> Self {
        let total = in_total.then(|| sky.seen_in_total());
        let seen: &SeenSky = total.as_ref().unwrap_or(&sky.seen);
        let night = sky.night.as_ref().filter(|_| total.is_some());
        let points = night.map(|night| night.points()).unwrap_or_default();
        let discs = night.map(|night| night.discs()).unwrap_or_default();
        let discs: Vec<_> =
            discs.iter().map(|disc| (disc.point.direction.enu(), disc.point.illuminance_lx)).collect();
        let plane = |i: usize| seen.seen_by(&SKY_RESPONSES[i]).unwrap_or_default();
        let with_points: [Vec<f32>; 4] = std::array::from_fn(|i| {
            let mut plane = plane(i).to_vec();
            for point in &points {
                add_beam(&mut plane, point.direction, point.illuminance_lx[i]);
            }
            plane
        });
        let slopes = LitSlopes::of_planes(with_points.each_ref().map(Vec::as_slice));
        let filled = seen.without_ground(&sky.horizon).into_owned();
        // The lowest row is that just above the ground.
        let lowest_row = |seen: &SeenSky| -> Vec<SeenLight> {
            let planes = SKY_RESPONSES.each_ref().map(|of| seen.seen_by(of).unwrap_or_default());
            let value = |plane: &[f32], column| plane.get(column).copied().map_or(0.0, f64::from);
            (0..AZIMUTH_COUNT).map(|column| planes.map(|plane| value(plane, column))).collect()
        };
        let artificial = lowest_row(&sky.seen.without_ground(&sky.horizon));
        let natural: Vec<SeenLight> =
            lowest_row(&filled).iter().zip(&artificial).map(|(all, lamps)| minus(all, lamps)).collect();
        let (artificial, natural_columns) = match &sky.air_before_ground {
            None => (&artificial, RIDGE_COLUMNS),
            // The natural sky has its clouds in it, many of which the air sees.
            Some(air) => (air, AZIMUTH_COUNT / 8),
        };
        let (artificial, natural) =
            (mean_around(artificial, RIDGE_COLUMNS), mean_around(&natural, natural_columns));
        let horizon = artificial.iter().zip(&natural).map(|(lamps, natural)| plus(lamps, natural)).collect();
        let level = [0.0; 4];
        let mut light = Self { slopes, discs, level, horizon, seen: filled };
        light.level = light.illuminance(Slope::default(), DVec3::Z);
        light
    }

    /// From the sky alone, lx.
    fn illuminance(&self, slope: Slope, normal: DVec3) -> SeenLight {
        let mut light = self.slopes.illuminance(slope.steepness_rad, slope.downhill_azimuth_rad);
        for (towards, lx) in &self.discs {
            let cosine = towards.dot(normal).max(0.0);
            light.iter_mut().zip(lx).for_each(|(sum, lx)| *sum += cosine * lx);
        }
        light
    }

    /// Luminance of ground of an albedo that the sky lights, and ground of the same before it.
    pub(crate) fn sent_by(&self, ground: &SeenGround, albedo: f64) -> SeenLight {
        let normal = ground.slope.normal();
        let from_sky = self.illuminance(ground.slope, normal);
        // A slope sees as much of level ground as it misses of the sky.
        let share = 0.5 * (1.0 - normal.z) * albedo;
        std::array::from_fn(|i| albedo / PI * (from_sky[i] + share * self.level[i]))
    }

    /// Of the sky in a direction, without points of light.
    pub(crate) fn sky(&self, direction: Direction) -> SeenLight {
        let planes = SKY_RESPONSES.each_ref().map(|of| self.seen.seen_by(of));
        let [Some(x), Some(y), Some(z), Some(scotopic)] = planes else { return SeenLight::default() };
        Sampler::new([x, y, z, scotopic]).values(direction).unwrap_or_default()
    }

    /// Of the sky just above the ground.
    pub(crate) fn at_horizon(&self, azimuth_rad: f64) -> SeenLight {
        let column = azimuth_rad.rem_euclid(TAU) / TAU * AZIMUTH_COUNT as f64;
        let weight = column - column.floor();
        let left = column as usize % AZIMUTH_COUNT;
        let (from, to) = (&self.horizon[left], &self.horizon[(left + 1) % AZIMUTH_COUNT]);
        std::array::from_fn(|i| from[i] + weight * (to[i] - from[i]))
    }
}

/// Means over as many columns to either side.
fn mean_around(columns: &[SeenLight], each_side: usize) -> Vec<SeenLight> {
    let (all, count) = (columns.len(), 2 * each_side + 1);
    let around = |column: usize| (0..count).map(move |step| (column + all - each_side + step) % all);
    let mean = |column: usize, i: usize| around(column).map(|at| columns[at][i]).sum::<f64>() / count as f64;
    (0..all).map(|column| std::array::from_fn(|i| mean(column, i))).collect()
}

fn plus(a: &SeenLight, b: &SeenLight) -> SeenLight {
    std::array::from_fn(|i| a[i] + b[i])
}

fn minus(a: &SeenLight, b: &SeenLight) -> SeenLight {
    std::array::from_fn(|i| a[i] - b[i])
}

/// A beam from a direction as light of the cell that holds it.
fn add_beam(plane: &mut [f32], direction: Direction, illuminance_lx: f64) {
    let row = direction.elevation_rad / FRAC_PI_2 * ELEVATION_COUNT as f64;
    if row < 0.0 {
        return;
    }
    let row = (row as usize).min(ELEVATION_COUNT - 1);
    let column = (direction.azimuth_rad.rem_euclid(TAU) / TAU * AZIMUTH_COUNT as f64).round() as usize;
    if let Some(value) = plane.get_mut(row * AZIMUTH_COUNT + column % AZIMUTH_COUNT) {
        *value += (illuminance_lx / solid_angle_sr(row)) as f32;
    }
}
