//! Darker places near a place (`docs/model.md#darker`): the zenith's brightness on a lattice around it, and of that a few places far
//! enough from each other, picked greedily.

use crate::{
    brightness_request::BrightnessRequest, error::ObservatoryError, observatory::Observatory,
    scene_view::SceneView, watch::Watch,
};
use rayon::prelude::*;
use skyglow_physics::{GeoPoint, geometry::LocalFrame};
use skyglow_scene::{Ground, Observers, PlaceLattice, Scene};
use std::time::{Duration, Instant};

/// Places along the radius of the circle that is looked at.
const PLACES_PER_RADIUS: f64 = 60.0;
/// Least distance from one place that is looked at to the next, metres.
const LEAST_STEP_M: f64 = 250.0;
/// Artificial light that is worth going for is at most this part of that here.
const MOST_OF_HERE: f64 = 0.9;
/// Nearer circles, parts of the radius, of each of which the darkest place is named too.
const CIRCLES: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
/// Least distance between the darkest places of two circles, and between others, parts of the radius.
const APART: [f64; 2] = [0.1, 0.25];
/// A place is much nearer than another at most at this part of its distance.
const MUCH_NEARER: f64 = 0.7;
/// Elevation below which ground at one level all around may be the sea, metres.
const SEA_M: f64 = 0.5;
/// Largest difference of elevations that are level, metres.
const LEVEL_M: f64 = 0.05;

/// A request for darker places near a place.
#[derive(Clone, Debug, PartialEq)]
pub struct DarkerRequest {
    /// Where, two metres above the ground.
    pub place: GeoPoint,
    /// How far one would go, metres.
    pub within_m: f64,
    /// Places named at most.
    pub count: usize,
    /// Under which sky; its `max_places` means nothing.
    pub brightness: BrightnessRequest,
}

/// What is known of the ground at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Footing {
    /// The terrain has a value there.
    Land,
    /// The same, and those around it are at the very same level: a lake, or a plain.
    Level,
    /// The terrain is level and not above the sea there, or has a gap.
    SeaOrGap,
    /// The scene has no terrain.
    Unknown,
}

/// A darker place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DarkerPlace {
    /// Where.
    pub place: GeoPoint,
    /// From the place asked for, metres along the ground.
    pub distance_m: f64,
    /// From the place asked for, radians clockwise from north.
    pub azimuth_rad: f64,
    /// What it stands on.
    pub footing: Footing,
    /// Artificial light at the zenith by the lattice, over that at the place asked for.
    pub ratio: f64,
}

/// The darker places, and what was looked at.
#[derive(Clone, Debug, Default)]
pub struct DarkerPlaces {
    /// The darkest first.
    pub places: Vec<DarkerPlace>,
    /// Places on land that were compared.
    pub compared: usize,
    /// Places left out as sea or gaps in the terrain.
    pub sea_or_gap: usize,
    /// Places left out as higher than the packs reach.
    pub too_high: usize,
    /// From one place that was compared to the next, metres.
    pub step_m: f64,
    /// How long each step took.
    pub steps: Vec<(&'static str, Duration)>,
}

/// A place of the lattice.
#[derive(Clone, Copy)]
struct Candidate {
    place: GeoPoint,
    distance_m: f64,
    azimuth_rad: f64,
    footing: Footing,
    value: f32,
}

impl Observatory {
    /// The darkest places near a place that are far enough from each other. Takes tenths of a second. Not for asynchronous threads.
    ///
    /// # Errors
    /// As [`Observatory::brightness_in`], and [`ObservatoryError::OutsideScene`].
    pub fn darker_in(
        &self,
        view: &SceneView,
        request: &DarkerRequest,
        watch: &Watch<'_>,
    ) -> Result<DarkerPlaces, ObservatoryError> {
        let mut steps = Vec::new();
        let mut clock = Instant::now();
        let mut step = |name: &'static str| {
            steps.push((name, clock.elapsed()));
            clock = Instant::now();
        };
        view.site(request.place)?;
        let scene = view.scene();
        let wanted_m = (request.within_m / PLACES_PER_RADIUS).max(LEAST_STEP_M);
        let Some(lattice) = scene.place_window(request.place, request.within_m, wanted_m) else {
            return Ok(DarkerPlaces::default());
        };
        let mut candidates = candidates(scene, lattice, request);
        let eye_m = |candidate: &Option<Candidate>| {
            candidate.map_or(f32::NAN, |it| self.eye_m(&request.brightness, it.value))
        };
        let altitudes_m: Vec<f32> = candidates.iter().map(eye_m).collect();
        step("ground");
        let note = |done: f64| watch(done);
        let sums = self.seen_at(
            scene,
            &request.brightness,
            &Observers::everywhere(lattice, altitudes_m),
            &note,
            &mut step,
        )?;
        for (candidate, value) in candidates.iter_mut().zip(sums) {
            if let Some(candidate) = candidate {
                candidate.value = value;
            }
        }
        let inside: Vec<Candidate> = candidates.into_iter().flatten().collect();
        let here = inside
            .iter()
            .filter(|it| !it.value.is_nan())
            .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
        let here = here.map_or(0.0, |here| f64::from(here.value));
        let (land, sea): (Vec<Candidate>, Vec<Candidate>) =
            inside.into_iter().partition(|it| it.footing != Footing::SeaOrGap);
        let (land, too_high): (Vec<Candidate>, Vec<Candidate>) =
            land.into_iter().partition(|it| !it.value.is_nan());
        let places = picked(&land, request, here);
        step("choice");
        Ok(DarkerPlaces {
            places,
            compared: land.len(),
            sea_or_gap: sea.len(),
            too_high: too_high.len(),
            step_m: f64::from(lattice.step) * scene.metadata().pixel_size_m,
            steps,
        })
    }
}

/// The places of a lattice within reach, each with the altitude of its ground as its value.
fn candidates(scene: &Scene, lattice: PlaceLattice, request: &DarkerRequest) -> Vec<Option<Candidate>> {
    let frame = LocalFrame::at(request.place);
    let columns = lattice.columns as usize;
    let grounds: Vec<Option<(GeoPoint, Ground)>> = (0..lattice.len())
        .into_par_iter()
        .map(|index| {
            let place = scene.lattice_place(lattice, (index % columns) as u32, (index / columns) as u32);
            // Off the world there is none.
            place.latitude_rad().is_finite().then(|| (place, scene.ground(place)))
        })
        .collect();
    let level_with = |index: usize, elevation_m: f64| {
        let (column, row) = (index % columns, index / columns);
        let rows = row.saturating_sub(1)..(row + 2).min(lattice.rows as usize);
        let mut around = rows.flat_map(|row| {
            (column.saturating_sub(1)..(column + 2).min(columns)).map(move |column| row * columns + column)
        });
        around.all(|near| match grounds[near] {
            Some((_, Ground::Here { elevation_m: of_near })) => (of_near - elevation_m).abs() < LEVEL_M,
            _ => false,
        })
    };
    let footing = |index: usize, ground: Ground| match ground {
        _ if !scene.metadata().terrain => Footing::Unknown,
        Ground::Here { elevation_m } if level_with(index, elevation_m) => match elevation_m < SEA_M {
            true => Footing::SeaOrGap,
            false => Footing::Level,
        },
        Ground::Here { .. } => Footing::Land,
        Ground::Nearest { .. } | Ground::Unknown => Footing::SeaOrGap,
    };
    let candidate = |(index, ground): (usize, &Option<(GeoPoint, Ground)>)| {
        let (place, ground) = (*ground)?;
        let bearing = frame.bearing_to(place.unit_vector());
        (bearing.distance_m <= request.within_m).then(|| Candidate {
            place,
            distance_m: bearing.distance_m,
            azimuth_rad: bearing.azimuth_rad,
            footing: footing(index, ground),
            value: ground.altitude_m() as f32,
        })
    };
    grounds.par_iter().enumerate().map(candidate).collect()
}

/// The darkest place of every circle, then the next darkest ones but for those that are much farther than one as dark; all apart
/// from each other and darker than here.
fn picked(land: &[Candidate], request: &DarkerRequest, here: f64) -> Vec<DarkerPlace> {
    let mut order: Vec<&Candidate> =
        land.iter().filter(|it| f64::from(it.value) <= MOST_OF_HERE * here).collect();
    // Of equally dark ones the nearest.
    order.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.distance_m.total_cmp(&b.distance_m)));
    let mut picked: Vec<&Candidate> = Vec::new();
    let is_apart = |it: &Candidate, picked: &[&Candidate], apart_m: f64| {
        let frame = LocalFrame::at(it.place);
        picked.iter().all(|other| frame.bearing_to(other.place.unit_vector()).distance_m >= apart_m)
    };
    // Nobody goes far for less than there is nearer.
    let is_worth_it = |it: &Candidate, picked: &[&Candidate]| {
        picked.iter().all(|other| other.value > it.value || other.distance_m > MUCH_NEARER * it.distance_m)
    };
    for circle in CIRCLES {
        let darkest = order.iter().copied().find(|it| it.distance_m <= circle * request.within_m);
        picked.extend(darkest.filter(|it| is_apart(it, &picked, APART[0] * request.within_m)));
    }
    for it in order {
        if is_apart(it, &picked, APART[1] * request.within_m) && is_worth_it(it, &picked) {
            picked.push(it);
        }
    }
    picked.truncate(request.count);
    picked.sort_by(|a, b| a.value.total_cmp(&b.value));
    let place = |it: &Candidate| DarkerPlace {
        place: it.place,
        distance_m: it.distance_m,
        azimuth_rad: it.azimuth_rad,
        footing: it.footing,
        ratio: f64::from(it.value) / here,
    };
    picked.into_iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slope that gets darker northwards, and a dark hollow near by in the south.
    fn slope() -> Vec<Candidate> {
        let here = GeoPoint::from_deg(46.0, 8.0).unwrap();
        let at = |azimuth_deg: f64, distance_m: f64, value: f32| Candidate {
            place: here.destination(azimuth_deg.to_radians(), distance_m),
            distance_m,
            azimuth_rad: azimuth_deg.to_radians(),
            footing: Footing::Land,
            value,
        };
        let north = (0..=60).map(|km| at(0.0, 1e3 * f64::from(km), 1.0 - 0.015 * km as f32));
        north.chain([at(180.0, 12e3, 0.3), at(180.0, 13e3, 0.31), at(90.0, 20e3, 0.95)]).collect()
    }

    fn request(count: usize) -> DarkerRequest {
        let scene = skyglow_scene::SceneId::parse("demo").unwrap();
        DarkerRequest {
            place: GeoPoint::from_deg(46.0, 8.0).unwrap(),
            within_m: 60e3,
            count,
            brightness: BrightnessRequest {
                scene,
                scenario: None,
                turbidity: skyglow_physics::Turbidity::default(),
                scattering: skyglow_tables::Scattering::Multiple,
                cloud_base_m: None,
                lamp: skyglow_physics::Lamp::default(),
                measure: crate::MapMeasure::Zenith,
                light: crate::MapLight::Artificial,
                response: skyglow_physics::Response::Photopic,
                emission: skyglow_physics::Emission::default(),
                terrain_hides: true,
                max_places: 1,
            },
        }
    }

    /// The darkest of every circle, and none that is farther than one as dark in another direction.
    #[test]
    fn darker_places_are_apart_and_of_every_circle() {
        let found = picked(&slope(), &request(10), 1.0);
        let seen: Vec<(i32, i32)> = found
            .iter()
            .map(|it| ((it.distance_m / 1e3).round() as i32, it.azimuth_rad.to_degrees().round() as i32))
            .collect();
        assert_eq!(seen, [(60, 0), (12, 180), (7, 0)]);
        assert!(found.windows(2).all(|two| two[0].ratio <= two[1].ratio));
        assert_eq!(picked(&slope(), &request(2), 1.0).len(), 2);
        assert!(picked(&slope(), &request(5), 0.05).is_empty());
    }
}
