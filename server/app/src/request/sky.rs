//! The parameters of a sky: where, in what air, under which lamps.

use super::{
    emission::read_emission,
    spectra::{read_lamp, read_response},
};
use crate::{
    facts::{KindFacts, SourceFacts},
    parameters as p,
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_celestial::{CelestialError, Instant, heavens::DEFAULT_SOLAR_FLUX_SFU};
use skyglow_display::Sky;
use skyglow_observatory::{BrightnessRequest, MapLight, MapMeasure, ObserverHeight, SkyRequest, SkyTime};
use skyglow_physics::{BrokenClouds, Emission, GeoPoint, Lamp, Response, Turbidity};
use skyglow_scene::{ChangeId, SceneId};
use skyglow_tables::{Clouds, Scattering};

pub(super) fn read_place(reader: &mut Reader) -> Option<GeoPoint> {
    let (latitude_deg, longitude_deg) = (reader.required_number(&p::LAT), reader.required_number(&p::LON));
    GeoPoint::from_deg(latitude_deg?, longitude_deg?).ok()
}

/// Which light; where nobody says, all of it if the sky is that of a time.
pub(super) fn read_light(reader: &mut Reader) -> Sky {
    let has_time = reader.text(&p::TIME).is_some();
    match reader.choice(&p::SKY) {
        Some("total") => Sky::Total,
        None if has_time => Sky::Total,
        _ => Sky::Artificial,
    }
}

/// The time of a parameter; Some(None) where none is given, None where it is refused.
pub(super) fn read_time(
    reader: &mut Reader,
    parameter: &p::Parameter,
    facts: &SourceFacts,
    turbidity: Option<Turbidity>,
) -> Option<Option<SkyTime>> {
    let solar_flux_sfu = reader.number(&p::SOLAR_FLUX).unwrap_or(DEFAULT_SOLAR_FLUX_SFU);
    let Some(text) = reader.text(parameter) else {
        if reader.text(&p::SOLAR_FLUX).is_some() {
            let message = Some(format!("means nothing without `{}`", parameter.name));
            reader.fail(&p::SOLAR_FLUX, ValidationCode::Conflict, message, None);
        }
        return Some(None);
    };
    let instant = match Instant::parse(text).and_then(|time| Instant::from_unix_s(time.unix_s().round())) {
        Ok(instant) => instant,
        Err(error) => {
            let code = match error {
                CelestialError::OutsideYears(_) => ValidationCode::NotAllowed,
                _ => ValidationCode::Malformed,
            };
            reader.fail(parameter, code, None, None);
            return None;
        }
    };
    has_celestial_tables(reader, parameter, facts, turbidity)
        .then_some(Some(SkyTime { instant, solar_flux_sfu }))
}

/// Whether there are tables for the natural sky of a time; where there are none, the parameter that asks for them is refused.
pub(super) fn has_celestial_tables(
    reader: &mut Reader,
    asking: &p::Parameter,
    facts: &SourceFacts,
    turbidity: Option<Turbidity>,
) -> bool {
    let allowed = match facts.celestial_turbidity_range {
        None => {
            "no time: there are no celestial tables beside the packs; `skyglow precompute --part celestial` makes \
             them"
                .to_owned()
        }
        Some((least, most)) if turbidity.is_some_and(|t| !(least..=most).contains(&t.value())) => {
            format!("a time with a turbidity of {least} to {most}, which there are celestial tables for")
        }
        Some(_) => return true,
    };
    reader.fail(asking, ValidationCode::NotResident, None, Some(allowed));
    false
}

/// What a sky is asked with beside the place.
#[derive(Clone, Debug)]
pub(super) struct Conditions {
    scenario: Option<ChangeId>,
    turbidity: Turbidity,
    scattering: Scattering,
    cloud_base_m: Option<u32>,
    broken_clouds: Option<BrokenClouds>,
    lamp: Lamp,
    response: Response,
    emission: Emission,
    basis: Option<usize>,
    tolerance: Option<f64>,
    terrain_hides: bool,
}

impl Conditions {
    /// The sky over a place.
    pub(super) fn over(
        &self,
        scene: SceneId,
        place: GeoPoint,
        observer_height: ObserverHeight,
    ) -> SkyRequest {
        let Self { turbidity, scattering, cloud_base_m, broken_clouds, emission, .. } = *self;
        let Self { basis, tolerance, terrain_hides, .. } = *self;
        SkyRequest {
            scene,
            scenario: self.scenario.clone(),
            place,
            observer_height,
            turbidity,
            scattering,
            cloud_base_m,
            broken_clouds,
            lamp: self.lamp.clone(),
            response: self.response.clone(),
            emission,
            basis,
            tolerance,
            terrain_hides,
            time: None,
        }
    }

    /// The brightness of all places of a scene under them; what means nothing there is left out.
    pub(super) fn over_all(
        self,
        scene: SceneId,
        measure: MapMeasure,
        max_places: usize,
    ) -> BrightnessRequest {
        let light = MapLight::Artificial;
        let Self {
            scenario,
            turbidity,
            scattering,
            cloud_base_m,
            lamp,
            response,
            emission,
            terrain_hides,
            ..
        } = self;
        BrightnessRequest {
            scene,
            scenario,
            turbidity,
            scattering,
            cloud_base_m,
            lamp,
            measure,
            light,
            response,
            emission,
            terrain_hides,
            max_places,
        }
    }

    /// Whether there is a layer of cloud.
    pub(super) fn is_overcast(&self) -> bool {
        self.cloud_base_m.is_some()
    }

    /// The turbidity.
    pub(super) fn turbidity(&self) -> Turbidity {
        self.turbidity
    }

    /// The scenario that it is asked with.
    pub(super) fn scenario(&self) -> Option<&ChangeId> {
        self.scenario.as_ref()
    }
}

/// The conditions; None where something is wrong so far.
pub(super) fn read_conditions(reader: &mut Reader, facts: &SourceFacts) -> Option<Conditions> {
    let scenario = read_scenario(reader);
    let cloud_base_m = read_clouds(reader, facts);
    let kind = cloud_base_m.and_then(|cloud_base_m| read_kind(reader, facts, cloud_base_m));
    let turbidity = read_turbidity(reader, facts, kind);
    let broken_clouds = read_broken_clouds(reader, facts, cloud_base_m, (kind, turbidity));
    let lamp = read_lamp(reader);
    let response = read_response(reader);
    let emission = read_emission(reader);
    let basis = read_basis(reader, facts, kind);
    let tolerance = read_tolerance(reader);
    let terrain_hides = reader.choice(&p::TERRAIN) != Some("off");
    reader.is_fine().then_some(())?;
    // A layer without a cloud is a clear sky: lights behind skylines and Bortle's classes count as they do there.
    let is_clear = broken_clouds.is_some_and(|clouds| clouds.cover() == 0.0);
    Some(Conditions {
        scenario,
        turbidity: turbidity?,
        scattering: kind?.scattering,
        cloud_base_m: cloud_base_m?.filter(|_| !is_clear),
        broken_clouds: broken_clouds.filter(|_| !is_clear),
        lamp,
        response,
        emission,
        basis,
        tolerance,
        terrain_hides,
    })
}

pub(super) fn read_sky(reader: &mut Reader, scene: SceneId, facts: &SourceFacts) -> Option<SkyRequest> {
    let place = read_place(reader);
    let observer_height = read_eye_height(reader, facts);
    let conditions = read_conditions(reader, facts);
    let time = read_time(reader, &p::TIME, facts, conditions.as_ref().map(|conditions| conditions.turbidity));
    Some(SkyRequest { time: time?, ..conditions?.over(scene, place?, observer_height) })
}

/// A sky without a time, and the solar flux of a night over it.
pub(super) fn read_sky_at_night(
    reader: &mut Reader,
    scene: SceneId,
    facts: &SourceFacts,
) -> Option<(SkyRequest, f64)> {
    let place = read_place(reader);
    let observer_height = read_eye_height(reader, facts);
    let conditions = read_conditions(reader, facts);
    let solar_flux_sfu = reader.number(&p::SOLAR_FLUX).unwrap_or(DEFAULT_SOLAR_FLUX_SFU);
    let turbidity = conditions.as_ref().map(|conditions| conditions.turbidity);
    let has_tables = has_celestial_tables(reader, &p::DATE, facts, turbidity);
    let sky = conditions?.over(scene, place?, observer_height);
    has_tables.then_some((sky, solar_flux_sfu))
}

/// The id of a scenario or plan; None where none is given, or it is refused.
pub(super) fn read_scenario(reader: &mut Reader) -> Option<ChangeId> {
    let id = ChangeId::parse(reader.text(&p::SCENARIO)?).ok();
    if id.is_none() {
        reader.fail(&p::SCENARIO, ValidationCode::Malformed, None, None);
    }
    id
}

pub(super) fn read_eye_height(reader: &mut Reader, facts: &SourceFacts) -> ObserverHeight {
    let height_m = reader.number_of_any_size(&p::HEIGHT);
    let altitude_m = reader.number_of_any_size(&p::ALTITUDE);
    if reader.text(&p::HEIGHT).is_some() && reader.text(&p::ALTITUDE).is_some() {
        let message = Some("excludes `height`, which is given too".to_owned());
        reader.fail(&p::ALTITUDE, ValidationCode::Conflict, message, Some("one of the two".to_owned()));
    }
    let maximum_m = facts.altitude_range_m.1;
    if let Some(altitude_m) = altitude_m {
        if altitude_m > maximum_m {
            let allowed = format!("0 to {maximum_m} m above sea level; below 0 counts as 0");
            reader.fail(&p::ALTITUDE, ValidationCode::OutOfRange, None, Some(allowed));
        }
        return ObserverHeight::AboveSea(altitude_m.max(0.0));
    }
    if let Some(height_m) = height_m {
        let allowed = || Some(format!("0 to {maximum_m} m, less the altitude of the ground"));
        if height_m < 0.0 {
            reader.fail(&p::HEIGHT, ValidationCode::NotAllowed, None, allowed());
        } else if height_m > maximum_m {
            // Too high over any ground: the same mistake as too high over this one, which the scene knows.
            reader.fail(&p::HEIGHT, ValidationCode::OutOfRange, None, allowed());
        }
    }
    ObserverHeight::AboveGround(height_m.unwrap_or(2.0))
}

/// The packs that the scattering asks for; None where it is refused, and what depends on it cannot be checked.
fn read_kind<'a>(
    reader: &mut Reader,
    facts: &'a SourceFacts,
    cloud_base_m: Option<u32>,
) -> Option<&'a KindFacts> {
    let Some(name) = reader.choice(&p::SCATTERING) else {
        return reader.text(&p::SCATTERING).is_none().then(|| facts.best_kind(cloud_base_m)).flatten();
    };
    let kind = facts.kinds_under(cloud_base_m).find(|kind| kind.scattering.name() == name);
    if kind.is_none() {
        reader.fail(&p::SCATTERING, ValidationCode::NotResident, None, Some(facts.scatterings(cloud_base_m)));
    }
    kind
}

/// The base of the clouds, Some(None) under a clear sky; None where it is refused.
fn read_clouds(reader: &mut Reader, facts: &SourceFacts) -> Option<Option<u32>> {
    let Some(text) = reader.text(&p::CLOUDS).filter(|text| *text != "none") else { return Some(None) };
    let Some(base_m) = text.parse().ok().filter(|&base_m| Clouds::new(base_m, 0.0).is_ok()) else {
        reader.fail(&p::CLOUDS, ValidationCode::NotAllowed, None, None);
        return None;
    };
    if facts.best_kind(Some(base_m)).is_some() {
        return Some(Some(base_m));
    }
    reader.fail(&p::CLOUDS, ValidationCode::NotResident, None, Some(facts.allowed_clouds(base_m)));
    None
}

/// How much of a layer of cloud is cloud; None where all of it is, there is none, or something is refused.
fn read_broken_clouds(
    reader: &mut Reader,
    facts: &SourceFacts,
    cloud_base_m: Option<Option<u32>>,
    (kind, turbidity): (Option<&KindFacts>, Option<Turbidity>),
) -> Option<BrokenClouds> {
    let (cover, pattern) = (reader.number(&p::CLOUD_COVER), reader.integer(&p::CLOUD_PATTERN));
    let has_cover = reader.text(&p::CLOUD_COVER).is_some();
    let has_gaps = cover.is_some_and(|cover| cover < 1.0);
    for (parameter, needed, is_wrong) in [
        (&p::CLOUD_COVER, &p::CLOUDS, has_gaps && cloud_base_m == Some(None)),
        (&p::CLOUD_PATTERN, &p::CLOUD_COVER, reader.text(&p::CLOUD_PATTERN).is_some() && !has_cover),
    ] {
        if is_wrong {
            let message = Some(format!("means nothing without `{}`", needed.name));
            reader.fail(parameter, ValidationCode::Conflict, message, None);
        }
    }
    let cover = cover.filter(|_| has_gaps)?;
    let (kind, turbidity) = (kind?, turbidity?);
    let mut clear = facts.kinds_under(None).filter(|clear| clear.scattering == kind.scattering);
    if !clear.any(|clear| clear.serves(turbidity.value())) {
        let allowed = "1: there are no packs for the clear sky between clouds".to_owned();
        reader.fail(&p::CLOUD_COVER, ValidationCode::NotResident, None, Some(allowed));
    }
    BrokenClouds::new(cover, pattern).ok()
}

fn read_basis(reader: &mut Reader, facts: &SourceFacts, kind: Option<&KindFacts>) -> Option<usize> {
    let basis = reader.whole_number_of_any_size(&p::BASIS)?;
    let allowed =
        kind.map(|kind| facts.allowed_with(kind, format!("a whole number from 1 to {}", kind.basis_count)));
    if basis < 1 {
        reader.fail(&p::BASIS, ValidationCode::NotAllowed, None, allowed);
        return None;
    }
    let basis = usize::try_from(basis).unwrap_or(usize::MAX);
    if kind.is_some_and(|kind| basis > kind.basis_count) {
        let message = Some("is more than is resident".to_owned());
        reader.fail(&p::BASIS, ValidationCode::NotResident, message, allowed);
    }
    Some(basis)
}

fn read_tolerance(reader: &mut Reader) -> Option<f64> {
    let tolerance = reader.number(&p::TOLERANCE);
    if reader.text(&p::TOLERANCE).is_some() && reader.text(&p::BASIS).is_some() {
        let message = Some("excludes `basis`, which is given too".to_owned());
        reader.fail(&p::TOLERANCE, ValidationCode::Conflict, message, Some("one of the two".to_owned()));
    }
    tolerance
}

fn read_turbidity(reader: &mut Reader, facts: &SourceFacts, kind: Option<&KindFacts>) -> Option<Turbidity> {
    let given = reader.number_of_any_size(&p::TURBIDITY);
    if reader.text(&p::TURBIDITY).is_some() && given.is_none() {
        return None;
    }
    let value = given.unwrap_or(Turbidity::default().value());
    if let Some(kind) = kind
        && !kind.serves(value)
    {
        let (minimum, maximum) = kind.turbidity_range;
        let is_hole = (minimum..=maximum).contains(&value);
        let message = match is_hole {
            true => Some("a table pack for this is damaged and left out".to_owned()),
            false => Turbidity::new(value).ok().and_then(|_| kind.missing_turbidity(value)),
        };
        let allowed = facts.allowed_with(kind, kind.turbidities());
        reader.fail(&p::TURBIDITY, ValidationCode::OutOfRange, message, Some(allowed));
        return None;
    }
    match Turbidity::new(value) {
        Ok(turbidity) => Some(turbidity),
        Err(_) => {
            reader.fail(&p::TURBIDITY, ValidationCode::OutOfRange, None, None);
            None
        }
    }
}
