//! Light on ground as it slopes, under the sky that terrain leaves (`docs/model.md#brightness`).
//!
//! What a slope of normal n receives of the whole sky above the horizontal plane is n·F, with the vector irradiance F = ∫ L v dΩ,
//! whose three parts are sums over all lights. Of that goes what lies below the horizon, or below the slope itself where it rises:
//! ∫ L n·v dΩ over the low sky, from panoramas of places far apart, in parts of their horizontal illuminance, linear in between (in
//! the spirit of irradiance caching, Ward, Rubinstein & Clear 1988).

use crate::{
    brightness_request::{BrightnessRequest, EYE_HEIGHT_M},
    coarse_places::{self, CoarsePlaces},
    error::ObservatoryError,
    natural_places::NaturalPlaces,
    observatory::Observatory,
    sky::{ObserverHeight, SkyRequest},
    sky_below::{COLUMNS_PER_SECTOR, SECTOR_COUNT, SkyBelow},
    surroundings::Surroundings,
};
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::{GeoPoint, SeenSky, SkyPart, panorama::azimuth_rad};
use skyglow_scene::{Observers, PlaceLattice, PlaceWindow, Scene};
use skyglow_tables::clouds::ceiling_m;

/// How far an eye is put below the highest altitude that packs reach, metres: rounding must not put it above.
const BELOW_M: f64 = 0.01;
/// Panoramas at most, about, of a map known as a whole.
const MAX_PANORAMAS: usize = 1_000;

/// The low sky over places, from that of some of them.
#[derive(Debug)]
pub(crate) struct SlopeLight {
    skies: CoarsePlaces<SkyBelow>,
    azimuths_rad: [f64; SECTOR_COUNT],
}

/// A place with what of its sky the terrain hides.
struct Ground<'a> {
    normal: DVec3,
    /// By sector.
    azimuths_rad: &'a [f64; SECTOR_COUNT],
    hidden_rad: [f64; SECTOR_COUNT],
}

impl Ground<'_> {
    /// What it receives of a sky.
    ///
    /// * `irradiance`: the vector irradiance of the whole sky: its part upwards, eastwards and northwards.
    /// * `skies`: around it, with their weights.
    fn receives(&self, irradiance: [f64; 3], skies: &[(&SkyBelow, f64)]) -> f64 {
        let [up, east, north] = irradiance;
        let mut sum = self.normal.z * up + self.normal.x * east + self.normal.y * north;
        for (sector, hidden_rad) in
            self.hidden_rad.into_iter().enumerate().filter(|(_, hidden)| *hidden > 0.0)
        {
            let mut low = [0.0; 2];
            for (sky, weight) in skies {
                let part = sky.up_to(sector, hidden_rad);
                low = [0, 1].map(|at| low[at] + weight * part[at]);
            }
            sum -= up * (self.normal.z * low[0] + self.side(sector) * low[1]);
        }
        sum.max(0.0)
    }

    /// The horizontal part of its normal towards a sector.
    fn side(&self, sector: usize) -> f64 {
        side(self.normal, self.azimuths_rad[sector])
    }
}

fn side(normal: DVec3, azimuth_rad: f64) -> f64 {
    let (sin, cos) = azimuth_rad.sin_cos();
    normal.x * sin + normal.y * cos
}

impl SlopeLight {
    /// For the places of a window. Takes milliseconds of all cores for each panorama.
    ///
    /// # Errors
    /// As [`Observatory::sky`].
    pub(crate) fn new(
        observatory: &Observatory,
        scene: &Scene,
        request: &BrightnessRequest,
        (lattice, window): (PlaceLattice, &PlaceWindow),
    ) -> Result<Self, ObservatoryError> {
        let stride = coarse_places::stride(scene, lattice, MAX_PANORAMAS);
        let skies = CoarsePlaces::new(lattice, window, stride, |column, row| {
            // Under clouds a place above them has the sky of one just below.
            let is_known = observatory.eye_at(scene, request, lattice, [column, row]).is_finite();
            match is_known || request.cloud_base_m.is_some() {
                true => sky_below(observatory, scene, request, scene.lattice_place(lattice, column, row)),
                false => Ok(None),
            }
        })?;
        let middle = 0.5 * (COLUMNS_PER_SECTOR - 1) as f64;
        let azimuths_rad = std::array::from_fn(|sector| {
            azimuth_rad(sector * COLUMNS_PER_SECTOR) + middle * (azimuth_rad(1) - azimuth_rad(0))
        });
        Ok(Self { skies, azimuths_rad })
    }

    /// What the ground receives at every place; NaN where the sums are.
    ///
    /// * `observers`: at places of the window.
    /// * `sums`: the vector irradiance of the open sky there: its part upwards, eastwards and northwards.
    /// * `natural`: what else lights the ground.
    pub(crate) fn values(
        &self,
        scene: &Scene,
        observers: &Observers,
        sums: &[Vec<f32>],
        natural: Option<&NaturalPlaces>,
    ) -> Vec<f32> {
        let [up, east, north] = sums else { return vec![f32::NAN; observers.altitudes_m.len()] };
        let Observers { lattice, window, altitudes_m } = observers;
        let of_place = |index: usize| {
            let irradiance = [up[index], east[index], north[index]].map(f64::from);
            let is_dark = irradiance[0] <= 0.0 && natural.is_none();
            if is_dark || !irradiance.iter().all(|part| part.is_finite()) {
                return up[index];
            }
            let at = window.place(index);
            let (place, eye_m) = (scene.lattice_place(*lattice, at[0], at[1]), f64::from(altitudes_m[index]));
            let normal = scene.slope(place).normal();
            // Where the slope rises its own plane hides the sky too.
            let sights = self
                .azimuths_rad
                .map(|azimuth_rad| (azimuth_rad, (-side(normal, azimuth_rad) / normal.z).max(0.0)));
            let hidden_rad = scene.coarse_horizon(place, eye_m, sights).map(f64::atan);
            let ground = Ground { normal, azimuths_rad: &self.azimuths_rad, hidden_rad };
            let artificial = ground.receives(irradiance, &self.skies.around(at));
            let natural = natural.map_or(0.0, |natural| {
                let sky = natural.sky_at(at, eye_m);
                let discs = sky.discs.iter().filter(|(towards, _)| {
                    let azimuth_rad = towards.x.atan2(towards.y);
                    let [tangent] = scene.coarse_horizon(place, eye_m, [(azimuth_rad, 0.0)]);
                    towards.z >= tangent * towards.truncate().length()
                });
                let straight: f64 = discs.map(|(towards, value)| normal.dot(*towards).max(0.0) * value).sum();
                ground.receives(sky.irradiance, &sky.around) + straight
            });
            (artificial + natural) as f32
        };
        (0..altitudes_m.len()).into_par_iter().map(of_place).collect()
    }
}

/// The low sky at a place.
fn sky_below(
    observatory: &Observatory,
    scene: &Scene,
    request: &BrightnessRequest,
    place: GeoPoint,
) -> Result<Option<SkyBelow>, ObservatoryError> {
    let sky = SkyRequest {
        scene: request.scene.clone(),
        scenario: request.scenario.clone(),
        place,
        observer_height: ObserverHeight::AboveGround(EYE_HEIGHT_M),
        turbidity: request.turbidity,
        scattering: request.scattering,
        cloud_base_m: request.cloud_base_m,
        broken_clouds: None,
        lamp: request.lamp.clone(),
        response: request.response.clone(),
        emission: request.emission,
        basis: None,
        tolerance: None,
        terrain_hides: request.terrain_hides,
        time: None,
    };
    let hides_lights = observatory.hides_lights_of(&sky);
    let below_clouds_m = request.cloud_base_m.map_or(f64::INFINITY, |base_m| ceiling_m(f64::from(base_m)));
    let highest_m = below_clouds_m - EYE_HEIGHT_M - BELOW_M;
    let ground = match scene.ground(place) {
        ground if ground.altitude_m() > highest_m => skyglow_scene::Ground::Here { elevation_m: highest_m },
        ground => ground,
    };
    let surroundings = Surroundings::under_open_sky(ground, scene, &sky, hides_lights);
    let (to_render, _) = surroundings.render_requests(&sky, &observatory.engine.basis_chooser())?;
    let rendered = observatory.engine.render_each_blocking(&to_render)?;
    let lights = surroundings.lights.iter().map(|(fixture, _)| fixture.light(&request.lamp));
    let parts = lights.zip(rendered).map(|(light, rendered)| SkyPart { light, kernel: rendered.panorama });
    let parts: Vec<SkyPart> = parts.collect();
    Ok(SkyBelow::new(SeenSky::of(&parts, std::slice::from_ref(&request.response)).plane(0)))
}
