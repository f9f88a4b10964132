//! Ground as it is seen at night: lit by the sky over the observer, by Moon and Sun, and by its own lamps, behind the air in between
//! (`docs/model.md#lit-ground`).

use crate::{
    error::ObservatoryError,
    scene_view::SceneView,
    sky::{RenderedSky, SkyRequest},
    sky_light::SkyLight,
    water::{MirroredLight, WATER_ALBEDO, WaterLine},
};
use rayon::prelude::*;
use skyglow_physics::{
    BAND_COUNT, Direction, EARTH_RADIUS_M, Fixture, GeoPoint, LOBE_COUNT, LitGround, LitLine, Lobe,
    SKY_RESPONSES, SeenLight, SourcePixel,
    aerial_perspective::AirBetween,
    emission::lobe_intensities_per_sr,
    geometry::{LocalFrame, spherical_quadrilateral_area_m2},
    horizon::terrain_elevation_tangent,
    quadrature::R2,
};
use skyglow_scene::{GroundLine, GroundSight, Land, Scene};
use std::f64::consts::PI;

/// Lamps that are farther are not seen by themselves, metres.
const LAMPS_WITHIN_M: f64 = 80_000.0;
/// Lamps that are nearer are not drawn: where they stand is not known so well.
const NEAREST_LAMP_M: f64 = 100.0;
/// A lamp is drawn as wide as this at most.
const LAMP_REACH_RAD: f64 = 0.02;
/// Height of a lamp above the ground, metres.
const LAMP_HEIGHT_M: f64 = 8.0;
/// Light of one lamp, lm, and the part of it that goes up: how many lamps a pixel is divided into.
const LUMENS_OF_LAMP: f64 = 8_000.0;
const UPWARD_SHARE: f64 = 0.17;
/// A pixel is divided into so many at most.
const MAX_LAMPS_OF_PIXEL: f64 = 96.0;
/// Least cosine of the zenith angle at a lamp: a lamp that stands a little higher than the eye is seen too.
const MIN_COS_ZENITH: f64 = 1e-3;

/// What of the ground is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundRequest {
    /// Which part of it.
    pub sight: GroundSight,
    /// Share of light that it reflects where nothing is known of its cover.
    pub albedo: f64,
    /// Whether it lies under snow.
    pub has_snow: bool,
    /// Whether the natural sky lights it too; not under clouds.
    pub in_total: bool,
    /// Whether water is calm, and mirrors: what land cover says is water, and level ground where nothing is known of its cover.
    pub has_water: bool,
}

/// The ground around a sky's observer.
///
/// # Errors
/// [`ObservatoryError::Emission`].
pub fn lit_ground(
    view: &SceneView,
    request: &SkyRequest,
    sky: &RenderedSky,
    wanted: &GroundRequest,
) -> Result<LitGround, ObservatoryError> {
    let scene = view.scene();
    let eye_altitude_m = sky.context.altitude_m;
    let lines = scene.visible_ground(request.place, eye_altitude_m, &wanted.sight);
    let lamps = LampLight::of_scene(scene, request)?;
    let light = SkyLight::new(sky, wanted.in_total);
    let eye = Eye {
        frame: LocalFrame::at(request.place),
        altitude_m: eye_altitude_m,
        air: AirBetween::new(request.turbidity),
    };
    let patches = Patches::new(scene, &lamps);
    // What a view cannot tell apart is one.
    let land_at = |line: &GroundLine, at: usize| -> Option<Land> {
        let distance_m = line.seen[at].distance_m;
        let known = scene.has_land_cover().then(|| eye.place(line.azimuth_rad, distance_m));
        known.and_then(|place| scene.land(place, distance_m * wanted.sight.azimuths.1))
    };
    let water: Vec<WaterLine> = if wanted.has_water {
        let of_line = |line: &GroundLine| {
            let is_lit = |at: usize| {
                let distance_m = line.seen[at].distance_m;
                patches.is_lit(scene, || eye.place(line.azimuth_rad, distance_m))
            };
            WaterLine::of(line, eye_altitude_m, is_lit, |at| land_at(line, at).map(|land| land.water))
        };
        lines.par_iter().map(of_line).collect()
    } else {
        lines.iter().map(|_| WaterLine::default()).collect()
    };
    let lit = |(line, water): (&GroundLine, &WaterLine)| {
        let beyond = light.at_horizon(line.azimuth_rad);
        let behind_air = |sent: SeenLight, through: SeenLight| -> SeenLight {
            std::array::from_fn(|i| sent[i] * through[i] + beyond[i] * (1.0 - through[i]))
        };
        let sent = line.seen.iter().enumerate().map(|(at, ground)| {
            let albedo = land_at(line, at).map_or(wanted.albedo, |land| match wanted.has_snow {
                true => land.albedo_in_snow(),
                false => land.albedo,
            });
            let mut sent = light.sent_by(ground, albedo);
            if ground.distance_m < LAMPS_WITHIN_M {
                patches.add(scene, || eye.place(line.azimuth_rad, ground.distance_m), &mut sent);
            }
            sent
        });
        let mut sent: Vec<SeenLight> = sent.collect();
        if !water.is_empty() {
            let below = light.level.map(|lx| WATER_ALBEDO / PI * lx);
            let towards_water = |sent: SeenLight, [land, water]: [usize; 2]| {
                let [land, water] = [&line.seen[land], &line.seen[water]];
                let altitudes_m = [water.altitude_m.max(0.0), land.altitude_m.max(0.0)];
                behind_air(sent, eye.air.transmittance(altitudes_m, land.distance_m - water.distance_m))
            };
            water.mirror(line, &mut sent, |direction| light.sky(direction), below, towards_water);
        }
        let light = line.seen.iter().zip(sent).map(|(ground, sent)| {
            behind_air(sent, eye.through(ground.altitude_m, ground.distance_m)).map(|value| value as f32)
        });
        LitLine {
            tangents: line.seen.iter().map(|ground| ground.tangent as f32).collect(),
            light: light.collect(),
            is_behind_ridge: line.seen.iter().map(|ground| ground.is_behind_ridge).collect(),
        }
    };
    let (first_azimuth_rad, step_rad, _) = wanted.sight.azimuths;
    let mut ground = LitGround {
        first_azimuth_rad,
        step_rad,
        lines: lines.par_iter().zip(&water).map(lit).collect(),
        lamps: Vec::new(),
    };
    // A lamp just below the picture shines into it.
    let lowest_rad = wanted.sight.lowest_tangent.atan() - LAMP_REACH_RAD;
    let points = lamps.par_iter().flat_map_iter(|lamp| {
        lamp.pixels.iter().flat_map(|pixel| {
            let lamps = lamps_of(scene, &eye, lamp, pixel, &ground, (&lines, &water));
            lamps.into_iter().filter(|(of, _)| of.elevation_rad > lowest_rad)
        })
    });
    let mut points: Vec<_> = points.collect();
    for (towards, lx) in &light.discs {
        let azimuth_rad = towards.x.atan2(towards.y);
        let tangent = towards.z / towards.x.hypot(towards.y);
        let at = ground.line_at(azimuth_rad).filter(|_| tangent > 0.0);
        let image = at.and_then(|at| {
            let image = water[at].image(&lines[at], MirroredLight::Beyond { tangent })?;
            Some((image, lines[at].seen[image.at]))
        });
        if let Some((image, ground)) = image {
            let through = eye.through(ground.altitude_m, ground.distance_m);
            let direction = Direction { azimuth_rad, elevation_rad: image.tangent.atan() };
            points.push((direction, std::array::from_fn(|i| image.share * through[i] * lx[i])));
        }
    }
    ground.lamps = points;
    Ok(ground)
}

/// Where the eye is.
struct Eye {
    frame: LocalFrame,
    altitude_m: f64,
    air: AirBetween,
}

impl Eye {
    fn place(&self, azimuth_rad: f64, distance_m: f64) -> GeoPoint {
        GeoPoint::from_vector(self.frame.along(self.frame.forward(azimuth_rad), distance_m))
    }

    fn through(&self, altitude_m: f64, distance_m: f64) -> SeenLight {
        let path_m = distance_m.hypot(altitude_m - self.altitude_m);
        self.air.transmittance([self.altitude_m, altitude_m.max(0.0)], path_m)
    }
}

/// Lamps of one kind of fixture near the observer.
struct LampLight {
    pixels: Vec<SourcePixel>,
    weights: [f64; LOBE_COUNT],
    /// lm of each watt that the satellite sees, as X, Y, Z and scotopic luminance.
    lumens_per_w: SeenLight,
}

impl LampLight {
    fn of_scene(scene: &Scene, request: &SkyRequest) -> Result<Vec<Self>, ObservatoryError> {
        let of = |(fixture, pixels): (Fixture, Vec<SourcePixel>)| {
            let (mix, factor) = request.emission.of_fixture(&fixture).map_err(ObservatoryError::Emission)?;
            let light = fixture.light(&request.lamp);
            let lumens = |i: usize| light.rule(&SKY_RESPONSES[i]).value([factor; BAND_COUNT]);
            Ok(Self { pixels, weights: mix.weights(), lumens_per_w: std::array::from_fn(lumens) })
        };
        scene.source_pixels_by_fixture(request.place, LAMPS_WITHIN_M).into_iter().map(of).collect()
    }
}

/// Luminance of ground that lamps light themselves, cd m⁻², by pixel: what it sends up evenly.
#[derive(Default)]
struct Patches {
    /// The first column and row, and how many columns there are.
    first: [u32; 2],
    width: usize,
    light: Vec<[f32; 4]>,
}

impl Patches {
    fn new(scene: &Scene, lamps: &[LampLight]) -> Self {
        let mut lit: Vec<([u32; 2], [f64; 4])> = Vec::new();
        for lamp in lamps {
            for pixel in &lamp.pixels {
                let Some((column, row)) = scene.column_and_row_at(GeoPoint::from_vector(pixel.center()))
                else {
                    continue;
                };
                let area_m2 = spherical_quadrilateral_area_m2(pixel.corners).max(1.0);
                let per_m2_sr = lamp.weights[Lobe::Lambert.index()] * pixel.flux_dnb_w / (PI * area_m2);
                lit.push(([column, row], lamp.lumens_per_w.map(|lumens| lumens * per_m2_sr)));
            }
        }
        let end = |axis: usize, of: fn(u32, u32) -> u32| lit.iter().map(|(at, _)| at[axis]).reduce(of);
        let (Some(left), Some(right), Some(top), Some(bottom)) =
            (end(0, u32::min), end(0, u32::max), end(1, u32::min), end(1, u32::max))
        else {
            return Self::default();
        };
        let (width, height) = ((right - left + 1) as usize, (bottom - top + 1) as usize);
        let mut patches = Self { first: [left, top], width, light: vec![[0.0; 4]; width * height] };
        for (at, light) in lit {
            let sum = &mut patches.light[(at[1] - top) as usize * width + (at[0] - left) as usize];
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light as f32);
        }
        patches
    }

    /// Whether the pixel of a place sends up light.
    fn is_lit(&self, scene: &Scene, place: impl Fn() -> GeoPoint) -> bool {
        let position = if self.light.is_empty() { None } else { scene.position_at(place()) };
        let Some((column, row)) = position else { return false };
        let (column, row) = (column - f64::from(self.first[0]), row - f64::from(self.first[1]));
        let height = self.light.len() / self.width;
        let is_inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < height as f64;
        is_inside && self.light[row as usize * self.width + column as usize] != [0.0; 4]
    }

    /// Adds that of a place, bilinear between the middles of pixels.
    fn add(&self, scene: &Scene, place: impl Fn() -> GeoPoint, light: &mut SeenLight) {
        let position = if self.light.is_empty() { None } else { scene.position_at(place()) };
        let Some((column, row)) = position else { return };
        let (column, row) = (column - 0.5 - f64::from(self.first[0]), row - 0.5 - f64::from(self.first[1]));
        let height = self.light.len() / self.width;
        if column <= -1.0 || row <= -1.0 || column >= self.width as f64 || row >= height as f64 {
            return;
        }
        let (s, t) = (column - column.floor(), row - row.floor());
        for (right, down, weight) in [
            (0.0, 0.0, (1.0 - s) * (1.0 - t)),
            (1.0, 0.0, s * (1.0 - t)),
            (0.0, 1.0, (1.0 - s) * t),
            (1.0, 1.0, s * t),
        ] {
            let (column, row) = (column.floor() + right, row.floor() + down);
            if column >= 0.0 && row >= 0.0 && (column as usize) < self.width && (row as usize) < height {
                let patch = self.light[row as usize * self.width + column as usize];
                light.iter_mut().zip(patch).for_each(|(sum, patch)| *sum += weight * f64::from(patch));
            }
        }
    }
}

/// A point of the unit square for each pixel, by the mixing function of SplitMix64 (Steele et al. 2014).
fn start_of(pixel: &SourcePixel) -> [f64; 2] {
    let corner = pixel.corners[0];
    let mut bits =
        corner.x.to_bits() ^ corner.y.to_bits().rotate_left(21) ^ corner.z.to_bits().rotate_left(42);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    [bits >> 32, bits & 0xffff_ffff].map(|half| half as f64 / 4_294_967_296.0)
}

/// Lamps of a pixel that are seen.
fn lamps_of(
    scene: &Scene,
    eye: &Eye,
    lamp: &LampLight,
    pixel: &SourcePixel,
    ground: &LitGround,
    (lines, water): (&[GroundLine], &[WaterLine]),
) -> Vec<(Direction, SeenLight)> {
    let bearing = eye.frame.bearing_to(pixel.center());
    let side_m = EARTH_RADIUS_M * pixel.corners[0].distance(pixel.corners[2]);
    // Half a pixel may reach into the view.
    let half_rad = (side_m / bearing.distance_m.max(NEAREST_LAMP_M)).min(PI);
    let is_in_view = [-half_rad, 0.0, half_rad]
        .iter()
        .any(|away_rad| ground.line_at(bearing.azimuth_rad + away_rad).is_some());
    if !is_in_view {
        return Vec::new();
    }
    // No more than can be told apart.
    let apart = (4.0 * side_m / (bearing.distance_m * ground.step_rad)).max(1.0);
    let lumens = lamp.lumens_per_w[1] * pixel.flux_dnb_w / UPWARD_SHARE;
    let count = (lumens / LUMENS_OF_LAMP).ceil().clamp(1.0, MAX_LAMPS_OF_PIXEL.min(apart));
    let flux_w = pixel.flux_dnb_w / count;
    // Every pixel has a start of its own (Cranley and Patterson 1976): else lamps would stand in rows across pixels.
    let start = start_of(pixel);
    let of = |number: f64| {
        // Where in the pixel it stands.
        let [s, t] = [0, 1].map(|axis| (start[axis] + R2[axis] * (number + 1.0)).fract());
        let [a, b, c, d] = pixel.corners;
        let at = (a * (1.0 - s) * (1.0 - t) + b * s * (1.0 - t) + c * s * t + d * (1.0 - s) * t).normalize();
        let bearing = eye.frame.bearing_to(at);
        let distance_m = bearing.distance_m;
        let at_line = ground.line_at(bearing.azimuth_rad)?;
        let line = lines.get(at_line)?;
        if distance_m < NEAREST_LAMP_M {
            return None;
        }
        let base_m = scene.terrain_altitude_m(GeoPoint::from_vector(at)).unwrap_or(pixel.altitude_m);
        let altitude_m = base_m + LAMP_HEIGHT_M;
        let tangent = terrain_elevation_tangent(eye.altitude_m, altitude_m, distance_m);
        if !line.shows(distance_m, tangent) {
            return None;
        }
        let path_m = distance_m.hypot(altitude_m - eye.altitude_m);
        let cos_zenith = ((eye.altitude_m - altitude_m) / path_m).max(MIN_COS_ZENITH);
        // What the ground sends up evenly is seen as its luminance already.
        let lobes = lobe_intensities_per_sr(cos_zenith);
        let per_sr: f64 = [Lobe::Horizon, Lobe::Oblique]
            .iter()
            .map(|lobe| lamp.weights[lobe.index()] * lobes[lobe.index()])
            .sum();
        let through = eye.through(altitude_m, distance_m);
        let candela_per_m2 = flux_w * per_sr / (path_m * path_m);
        let lx: SeenLight = std::array::from_fn(|i| lamp.lumens_per_w[i] * candela_per_m2 * through[i]);
        let azimuth_rad = bearing.azimuth_rad;
        let direction = Direction { azimuth_rad, elevation_rad: tangent.atan() };
        let image = water[at_line].image(line, MirroredLight::At { distance_m, altitude_m });
        let image = image.map(|image| {
            (Direction { azimuth_rad, elevation_rad: image.tangent.atan() }, lx.map(|lx| image.share * lx))
        });
        Some([Some((direction, lx)), image])
    };
    (0..count as usize).filter_map(|number| of(number as f64)).flatten().flatten().collect()
}
