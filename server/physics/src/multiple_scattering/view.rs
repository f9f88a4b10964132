//! Radiance of orders two and more that an observer sees: the source function integrated along the view ray.
//!
//!   b₂₊ = ∫ S·β·e^{−τ} du = Σ_steps S·(T₀ − T₁)     [m⁻² sr⁻¹ per watt]
//!
//! and, where the ray ends at the base of a cloud, what the base reflects of light of all orders. An observer at or
//! above the base sees exactly nothing.

use super::{
    field::SourceField,
    harmonics::{cosines, legendre},
    lanes::{LANES, Lanes, exp_lanes, outputs_from_lanes},
    path::{PathStep, StepPlace, StepRule, StepSum, SteppedPath, track},
    source_function::{DirectionTable, PathSum},
};
use crate::{
    error::{PhysicsError, check_range},
    geometry::EARTH_RADIUS_M,
    simd_dispatch,
    single_source::{RadiancePerWatt, SourceGeometry},
};

/// Steps of a view ray: the first one [m], and a step over the path so far. Far from the observer a step is kilometres long,
/// but over a source the light of the second order peaks as the first does, within about the height at which the ray passes:
/// with whole steps, 18 km away and 100 m up, it was wrong by factors of up to three, depending on the middle of the step.
const VIEW_STRIDE: StepRule = StepRule { first_m: 40.0, growth: 0.18, parts: 16 };
/// Azimuth intervals of a row's table.
const ROW_AZIMUTHS: usize = 36;
/// How far an altitude may be from the one a field was solved for, metres.
const SAME_ALTITUDE_M: f64 = 1e-3;

/// All rays of one elevation from one observer altitude, through one field: some milliseconds to make, then
/// ten or twenty microseconds a ray.
#[derive(Clone, Debug)]
pub struct ViewRow<'a> {
    field: &'a SourceField,
    path: SteppedPath,
    table: DirectionTable,
}

impl<'a> ViewRow<'a> {
    /// The row at `elevation_rad`, 0..=π/2.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `elevation` or `observer_altitude` (from the field's ground to
    /// 20 km).
    pub fn new(
        field: &'a SourceField,
        observer_altitude_m: f64,
        elevation_rad: f64,
    ) -> Result<Self, PhysicsError> {
        let path = view_path(field, observer_altitude_m, elevation_rad)?;
        // r·sin(zenith angle) is the same all along a straight ray.
        let across_m = (EARTH_RADIUS_M + observer_altitude_m) * elevation_rad.cos();
        let cos_zenith: Vec<f64> = field
            .grid
            .layer_m()
            .iter()
            .map(|&z| {
                let sine = across_m / (EARTH_RADIUS_M + z.max(observer_altitude_m));
                (1.0 - sine * sine).max(0.0).sqrt()
            })
            .collect();
        let table = field.source.table(&field.grid, &cos_zenith, ROW_AZIMUTHS);
        Ok(Self { field, path, table })
    }

    /// Radiance of orders two and more per watt, m⁻² sr⁻¹, `[band][lobe]`: the source `distance_m` of arc away,
    /// the ray `relative_azimuth_rad` beside it.
    pub fn radiance_per_watt(&self, distance_m: f64, relative_azimuth_rad: f64) -> RadiancePerWatt {
        // Azimuth 0 is towards the source: against the outward direction of the field.
        let (sine, cosine) = relative_azimuth_rad.sin_cos();
        let mut sum = [0.0f32; LANES];
        sum_steps(self, distance_m, -cosine, sine, &mut sum);
        self.field.add_base(&self.path, (distance_m, -cosine, sine), &mut sum);
        outputs_from_lanes(&sum.map(f64::from))
    }
}

simd_dispatch! {
    /// Adds the light of a row's steps: the source `distance_m` away, azimuth from its outward direction.
    fn sum_steps(
        row: &ViewRow<'_>,
        distance_m: f64,
        cos_azimuth: f64,
        sin_azimuth: f64,
        sum: &mut Lanes,
    ) = sum_steps_body;
}

#[inline(always)]
fn sum_steps_body(row: &ViewRow<'_>, distance_m: f64, cos_azimuth: f64, sin_azimuth: f64, sum: &mut Lanes) {
    let ViewRow { field, path, table } = row;
    let mut along = PathSum { source: &field.source, table, grid: &field.grid, sum: *sum };
    let start = (distance_m, cos_azimuth, sin_azimuth);
    path.for_each_step(&field.grid, field.setting.source_altitude_m, start, &mut along);
    *sum = along.sum;
}

impl SourceField {
    /// Adds the light of the base at the end of a ray that starts at `(distance_m, cos_azimuth, sin_azimuth)`.
    fn add_base(&self, path: &SteppedPath, start: (f64, f64, f64), sum: &mut Lanes) {
        let (Some(base), Some(end)) = (&self.base, &path.end) else { return };
        let (from_source_m, _) = track(start.0, start.1, start.2, end.arc_m);
        let Some(ring) = self.grid.ring_at(from_source_m) else { return };
        let value = base.at(ring);
        for lane in 0..LANES {
            sum[lane] += end.through[lane] * value[lane];
        }
    }

    /// Radiance of orders two and more per watt, m⁻² sr⁻¹, `[band][lobe]` as in
    /// [`crate::single_source::radiance_per_watt_of`], which gives the first order: the sum of both is the sky.
    ///
    /// Sums the moments at every step: a fraction of a millisecond. [`ViewRow`] is for many rays.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `source_altitude` if the field was solved for another one, `elevation` or
    /// `observer_altitude` as [`ViewRow::new`].
    pub fn radiance_per_watt(
        &self,
        geometry: &SourceGeometry,
        relative_azimuth_rad: f64,
        elevation_rad: f64,
    ) -> Result<RadiancePerWatt, PhysicsError> {
        let solved_m = self.setting.source_altitude_m;
        check_range(
            "source_altitude",
            geometry.source_altitude_m,
            solved_m - SAME_ALTITUDE_M,
            solved_m + SAME_ALTITUDE_M,
            "m",
        )?;
        let path = view_path(self, geometry.observer_altitude_m, elevation_rad)?;
        let (sine, cosine) = relative_azimuth_rad.sin_cos();
        let mut along = WithoutTable { field: self, sum: [0.0; LANES] };
        let start = (geometry.distance_m, -cosine, sine);
        path.for_each_step(&self.grid, solved_m, start, &mut along);
        let mut sum = along.sum;
        self.add_base(&path, start, &mut sum);
        Ok(outputs_from_lanes(&sum.map(f64::from)))
    }
}

/// Sums the moments of the field at every step.
struct WithoutTable<'a> {
    field: &'a SourceField,
    sum: Lanes,
}

impl StepSum for WithoutTable<'_> {
    #[inline(always)]
    fn add(&mut self, step: &PathStep, at: StepPlace) {
        let SourceField { grid, source, .. } = self.field;
        let Some(ring) = at.ring else { return };
        let degree = source.degree;
        let polar: Vec<f32> = legendre(degree, step.cos_zenith).iter().map(|&p| p as f32).collect();
        let azimuthal: Vec<f32> =
            cosines(degree, f64::from(at.cos_azimuth)).iter().map(|&c| c as f32).collect();
        let mut shape: Lanes = [0.0; LANES];
        for (point, weight) in grid.corners(ring, step.layer.between) {
            let corner = source.shape_at(point, &polar, &azimuthal);
            for lane in 0..LANES {
                shape[lane] += weight * corner[lane];
            }
        }
        let mean = exp_lanes(&source.ln_mean_at(grid, ring, &step.layer));
        for lane in 0..LANES {
            self.sum[lane] += step.weight[lane] * mean[lane] * shape[lane].max(0.0);
        }
    }
}

fn view_path(
    field: &SourceField,
    observer_altitude_m: f64,
    elevation_rad: f64,
) -> Result<SteppedPath, PhysicsError> {
    check_range("elevation", elevation_rad, 0.0, std::f64::consts::FRAC_PI_2 + 1e-9, "rad")?;
    check_range("observer_altitude", observer_altitude_m, field.setting.ground_altitude_m, 20_000.0, "m")?;
    let cloud = field.setting.atmosphere.cloud();
    if cloud.is_some_and(|cloud| observer_altitude_m >= cloud.altitude_m()) {
        return Ok(SteppedPath::dark());
    }
    let cos_zenith = elevation_rad.sin().min(1.0);
    Ok(SteppedPath::new(&field.setting, &field.grid, observer_altitude_m, cos_zenith, VIEW_STRIDE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Lobe, Turbidity,
        atmosphere::Atmosphere,
        multiple_scattering::{Resolution, SourceSetting},
    };

    /// A ray low over a far lamp meets a peak that is narrower than its steps there: what it sees must not
    /// depend on where their middles lie.
    #[test]
    fn far_zenith_light_falls_evenly() {
        let atmosphere = Atmosphere::new(Turbidity::new(2.5).unwrap());
        let setting = SourceSetting::new(atmosphere, 0.0, 0.0, 0.15).unwrap();
        let field = SourceField::solve(setting, &Resolution::coarse());
        let elevation_rad = 0.7f64.to_radians();
        let row = ViewRow::new(&field, 102.0, elevation_rad).unwrap();
        let oblique = Lobe::Oblique.index();
        let logs: Vec<f64> = (0..40)
            .map(|step| {
                let distance_m = 12_000.0 * 1.03f64.powi(step);
                let of_row = row.radiance_per_watt(distance_m, 0.0)[1][oblique];
                let geometry =
                    SourceGeometry { distance_m, source_altitude_m: 0.0, observer_altitude_m: 102.0 };
                let of_ray = field.radiance_per_watt(&geometry, 0.0, elevation_rad).unwrap()[1][oblique];
                assert!((of_row / of_ray - 1.0).abs() < 0.03, "{distance_m} m: {of_row:e}, {of_ray:e}");
                of_row.ln()
            })
            .collect();
        for (step, three) in logs.windows(3).enumerate() {
            let curvature = three[0] - 2.0 * three[1] + three[2];
            assert!(three[2] < three[1] && curvature.abs() < 0.02, "step {step}: {three:?}");
        }
    }

    #[test]
    fn both_forms_of_the_loops_give_the_same_bits() {
        let atmosphere = Atmosphere::new(Turbidity::new(3.0).unwrap());
        let setting = SourceSetting::new(atmosphere, 300.0, 0.0, 0.15).unwrap();
        let field = SourceField::solve(setting, &Resolution::coarse());
        let mut lit = 0;
        for elevation_deg in [0.7f64, 20.0, 80.0] {
            let row = ViewRow::new(&field, 0.0, elevation_deg.to_radians()).unwrap();
            for (distance_m, azimuth_rad) in [(300.0, 0.1f64), (20_000.0, 1.0), (150_000.0, 3.0)] {
                let (sine, cosine) = azimuth_rad.sin_cos();
                let (mut chosen, mut plain): (Lanes, Lanes) = ([0.0; LANES], [0.0; LANES]);
                sum_steps(&row, distance_m, -cosine, sine, &mut chosen);
                sum_steps_body(&row, distance_m, -cosine, sine, &mut plain);
                assert_eq!(chosen.map(f32::to_bits), plain.map(f32::to_bits));
                lit += chosen.iter().filter(|value| **value > 0.0).count();
            }
        }
        assert!(lit >= 9 * 8, "{lit} values are lit");
    }
}
