//! Calm water as a mirror: level ground reflects the sky, the land behind it and lamps in the plane of sight (`docs/model.md#lit-ground`).

use skyglow_physics::{
    Direction, EARTH_RADIUS_M, SeenLight, fresnel::water_reflectance, horizon::terrain_elevation_tangent,
};
use skyglow_scene::{GroundLine, SeenGround};

/// Share of the illuminance that calm water sends back from below its surface.
pub(crate) const WATER_ALBEDO: f64 = 0.02;
/// Steepest slope of water along a line: bilinear terrain between equal heights, but for rounding.
const LEVEL: f64 = 1e-7;
/// Water by land cover is no steeper: 1 in 20, for terrain is not level there to the metre.
const STEEPEST_WATER_RAD: f64 = 0.05;
/// So many points in a row have a slope of 0 where there is water.
const LEVEL_POINTS: usize = 3;
/// A lamp stands so far behind the water that it is seen in, metres.
const NEAREST_SHORE_M: f64 = 1.0;
/// Halvings of the distance in which an image lies: to 10⁻⁶ of it.
const HALVINGS: usize = 20;

/// A point of water that is seen.
#[derive(Clone, Copy, Debug)]
struct Water {
    /// Its place in the line.
    at: usize,
    /// tan of the angle between the ray and the water, above 0.
    grazing: f64,
}

/// Water along one azimuth, front to back.
#[derive(Debug, Default)]
pub(crate) struct WaterLine {
    points: Vec<Water>,
    eye_altitude_m: f64,
}

impl WaterLine {
    /// Ground of a line that is as level as lakes and the sea are in terrain models: stretches in which each point is exactly as high as
    /// the next, somewhere with a slope of 0 over so many points. No more than half of it is lit: `is_lit` says so by the place in the line.
    /// Where land cover is known that decides: `share` is of water.
    pub(crate) fn of(
        line: &GroundLine,
        eye_altitude_m: f64,
        is_lit: impl Fn(usize) -> bool,
        share: impl Fn(usize) -> Option<f64>,
    ) -> Self {
        let seen = &line.seen;
        let is_level = |before: &SeenGround, ground: &SeenGround| {
            let apart_m = ground.distance_m - before.distance_m;
            (ground.altitude_m - before.altitude_m).abs() <= LEVEL * apart_m
        };
        let mut is_water = vec![false; seen.len()];
        let mut first = 0;
        for stretch in seen.chunk_by(is_level) {
            let places = first..first + stretch.len();
            first = places.end;
            let flat = stretch.split(|ground| ground.slope.steepness_rad > 0.0).map(<[_]>::len).max();
            let is_flat = flat.is_some_and(|flat| flat >= LEVEL_POINTS);
            // The light of a shore is blurred over water in a satellite's picture.
            if !is_flat || 2 * places.clone().filter(|at| is_lit(*at)).count() > stretch.len() {
                continue;
            }
            is_water[places].fill(true);
        }
        for (at, is_water) in is_water.iter_mut().enumerate() {
            if let Some(share) = share(at) {
                *is_water = share > 0.5 && seen[at].slope.steepness_rad < STEEPEST_WATER_RAD;
            }
        }
        // From the water the eye is as high as the ray is steep.
        let water = (0..seen.len()).filter(|at| is_water[*at]).map(|at| {
            let ground = &seen[at];
            let grazing = terrain_elevation_tangent(ground.altitude_m, eye_altitude_m, ground.distance_m);
            Water { at, grazing }
        });
        Self { points: water.filter(|water| water.grazing > 0.0).collect(), eye_altitude_m }
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Puts what water mirrors into the light of a line, which is as it leaves the ground.
    ///
    /// * `sky`: of a direction above the horizon. `below`: what comes from under the surface.
    /// * `through`: light of ground at a place in the line after the air between that and another place.
    pub(crate) fn mirror(
        &self,
        line: &GroundLine,
        light: &mut [SeenLight],
        sky: impl Fn(Direction) -> SeenLight,
        below: SeenLight,
        through: impl Fn(SeenLight, [usize; 2]) -> SeenLight,
    ) {
        let is_water = |at: &usize| self.points.binary_search_by_key(at, |water| water.at).is_ok();
        let land: Vec<usize> = (0..line.seen.len()).filter(|at| !is_water(at)).collect();
        for water in &self.points {
            let tangent = |at: usize| tangent_from(line, water.at, at);
            // The first land behind that rises to the mirrored ray.
            let behind = &land[land.partition_point(|at| *at < water.at)..];
            let behind = behind.iter().copied().find(|&at| tangent(at) >= water.grazing);
            let elevation_rad = water.grazing.atan();
            let mirrored = match behind {
                Some(at) => {
                    // The ray meets it between that point and the land before it.
                    let before = at - 1;
                    let is_slope = !line.seen[at].is_behind_ridge && before > water.at && !is_water(&before);
                    let weight = if is_slope {
                        let (low, high) = (tangent(before), tangent(at));
                        ((water.grazing - low) / (high - low)).clamp(0.0, 1.0)
                    } else {
                        1.0
                    };
                    let land = std::array::from_fn(|i| {
                        light[before][i] + weight * (light[at][i] - light[before][i])
                    });
                    through(land, [at, water.at])
                }
                None => sky(Direction { azimuth_rad: line.azimuth_rad, elevation_rad }),
            };
            let share = water_reflectance(elevation_rad.sin());
            light[water.at] = std::array::from_fn(|i| share * mirrored[i] + (1.0 - share) * below[i]);
        }
    }

    /// Where a light is seen in the water; None where land before it hides it there.
    pub(crate) fn image(&self, line: &GroundLine, light: MirroredLight) -> Option<Image> {
        let reach_m = match light {
            MirroredLight::Beyond { .. } => f64::INFINITY,
            MirroredLight::At { distance_m, .. } => distance_m - NEAREST_SHORE_M,
        };
        let found = self.points.windows(2).find_map(|pair| {
            let [near, far] = [&pair[0], &pair[1]];
            if far.at != near.at + 1 || line.seen[far.at].is_behind_ridge {
                return None;
            }
            let water_m = line.seen[near.at].altitude_m;
            let to_eye = |at_m: f64| terrain_elevation_tangent(water_m, self.eye_altitude_m, at_m);
            let to_light = |at_m: f64| match light {
                MirroredLight::Beyond { tangent } => tangent + at_m / EARTH_RADIUS_M,
                MirroredLight::At { distance_m, altitude_m } => {
                    terrain_elevation_tangent(water_m, altitude_m, distance_m - at_m)
                }
            };
            // Before its image the ray to the eye is steeper than that to the light, behind it less steep.
            let is_before = |at_m: f64| to_eye(at_m) >= to_light(at_m);
            let (mut low_m, mut high_m) =
                (line.seen[near.at].distance_m, line.seen[far.at].distance_m.min(reach_m));
            if low_m >= high_m || !is_before(low_m) || is_before(high_m) {
                return None;
            }
            for _ in 0..HALVINGS {
                let middle_m = 0.5 * (low_m + high_m);
                *(if is_before(middle_m) { &mut low_m } else { &mut high_m }) = middle_m;
            }
            let towards = to_light(low_m);
            let mut land = (far.at + 1..line.seen.len())
                .take_while(|&at| line.seen[at].distance_m < reach_m)
                .map(|at| tangent_from(line, near.at, at));
            if land.any(|tangent| tangent > towards) {
                return Some(None);
            }
            Some(Some(Image {
                tangent: terrain_elevation_tangent(self.eye_altitude_m, water_m, low_m),
                share: water_reflectance(to_eye(low_m).atan().sin()),
                at: near.at,
            }))
        });
        found.flatten()
    }
}

/// tan of the elevation of a point of a line from another before it, for small angles: it is asked of each pair of water and land.
fn tangent_from(line: &GroundLine, from: usize, at: usize) -> f64 {
    let (from, to) = (&line.seen[from], &line.seen[at]);
    let distance_m = to.distance_m - from.distance_m;
    (to.altitude_m - from.altitude_m) / distance_m - distance_m / (2.0 * EARTH_RADIUS_M)
}

/// A light in water.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image {
    /// tan of its elevation.
    pub(crate) tangent: f64,
    /// Share of its light that the water reflects.
    pub(crate) share: f64,
    /// Place in the line of the water that it is seen in.
    pub(crate) at: usize,
}

/// What is seen in water.
#[derive(Clone, Copy, Debug)]
pub(crate) enum MirroredLight {
    /// A lamp.
    At {
        /// From the eye, metres.
        distance_m: f64,
        /// Metres above sea level.
        altitude_m: f64,
    },
    /// Moon or Sun.
    Beyond {
        /// tan of its elevation.
        tangent: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::Slope;

    const EYE_M: f64 = 10.0;

    /// A lake at 0 m from 100 m to 2 km, and behind it a slope that rises to 300 m at 4 km.
    fn lake() -> GroundLine {
        let ground = |distance_m: f64, altitude_m: f64| SeenGround {
            tangent: terrain_elevation_tangent(EYE_M, altitude_m, distance_m),
            distance_m,
            altitude_m,
            slope: Slope::of_gradient(0.0, if altitude_m > 0.0 { 0.15 } else { 0.0 }),
            is_behind_ridge: false,
        };
        let water = (1..=20).map(|step| ground(100.0 * f64::from(step), 0.0));
        let slope = (1..=20).map(|step| ground(2_000.0 + 100.0 * f64::from(step), 15.0 * f64::from(step)));
        GroundLine { azimuth_rad: 1.0, seen: water.chain(slope).collect() }
    }

    /// Near water mirrors the sky, far water the slope behind it.
    #[test]
    fn it_mirrors_sky_and_land() {
        let line = lake();
        let water = WaterLine::of(&line, EYE_M, |_| false, |_| None);
        assert_eq!(water.points.len(), 20);
        let mut light = vec![[7.0; 4]; line.seen.len()];
        water.mirror(&line, &mut light, |direction| [direction.elevation_rad; 4], [0.0; 4], |light, _| light);
        // 10 m over 100 m: 5.7°, above the slope's 4.3°.
        let grazing = 0.1f64.atan();
        assert!((light[0][1] / (water_reflectance(grazing.sin()) * grazing) - 1.0).abs() < 1e-3, "{light:?}");
        let far = (EYE_M / 1_500.0).atan();
        assert!((light[14][1] / (7.0 * water_reflectance(far.sin())) - 1.0).abs() < 1e-3, "{light:?}");
        assert_eq!(light[25], [7.0; 4]);
    }

    /// A lamp's image is where a plane mirror has it.
    #[test]
    fn lamps_are_seen_where_a_mirror_has_them() {
        let line = lake();
        let water = WaterLine::of(&line, EYE_M, |_| false, |_| None);
        let lamp = MirroredLight::At { distance_m: 2_200.0, altitude_m: 38.0 };
        let Image { tangent, share, .. } = water.image(&line, lamp).unwrap();
        // As deep below the water as it stands above: 48 m below the eye.
        assert!((tangent / (-48.0 / 2_200.0) - 1.0).abs() < 0.02, "{tangent}");
        assert!((0.8..1.0).contains(&share), "{share}");
        // One at 1 m there stands behind the slope before it.
        assert!(water.image(&line, MirroredLight::At { distance_m: 2_650.0, altitude_m: 20.0 }).is_none());
        // The Moon at 5° is seen 5° below the horizontal plane, at 2° the slope of 4.3° hides it, and at 30° there is no water.
        let moon = |tangent| water.image(&line, MirroredLight::Beyond { tangent }).map(|image| image.tangent);
        assert!((moon(0.09).unwrap() / -0.09 - 1.0).abs() < 0.02);
        assert_eq!((moon(0.035), moon(0.577)), (None, None));
    }

    /// Ground that is lit for the most part is no water, nor is what is level at single points.
    #[test]
    fn lit_and_sloping_ground_is_land() {
        let mut line = lake();
        assert_eq!(WaterLine::of(&line, EYE_M, |at| at < 10, |_| None).points.len(), 20);
        assert!(WaterLine::of(&line, EYE_M, |at| at < 11, |_| None).is_empty());
        for ground in line.seen.iter_mut().step_by(2) {
            ground.slope = Slope::of_gradient(0.01, 0.0);
        }
        assert!(WaterLine::of(&line, EYE_M, |_| false, |_| None).is_empty());
    }

    /// Land cover says what is water, whatever is level or lit, but no slope.
    #[test]
    fn land_cover_says_what_is_water() {
        let line = lake();
        let by_cover = |share: fn(usize) -> Option<f64>| {
            WaterLine::of(&line, EYE_M, |_| true, share)
                .points
                .iter()
                .map(|water| water.at)
                .collect::<Vec<_>>()
        };
        assert_eq!(by_cover(|at| Some(if at < 7 { 0.2 } else { 0.9 })), (7..20).collect::<Vec<_>>());
        assert_eq!(by_cover(|at| (at == 3).then_some(1.0)), [3]);
    }
}
