//! Which night, or which month of nights.

use super::sky::read_sky_at_night;
use crate::{
    error::AppError,
    facts::SourceFacts,
    format::rounded,
    parameters::{self as p, Parameter, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use skyglow_celestial::{Calendar, CalendarDate, CelestialError, Instant, Night, Site};
use skyglow_observatory::{SkyRequest, SkyTime};
use skyglow_scene::SceneId;

/// Reads the parameters of a night and finds it, at sea level.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn night(query: Option<&str>) -> Result<Night, AppError> {
    let mut reader = Reader::new(query, p::NightParameters::ALL);
    let site = read_site(&mut reader);
    let date = read_required(&mut reader, &p::DATE, CalendarDate::parse);
    reader.finish()?;
    let (Some(site), Some(date)) = (site, date) else { return Err(neither()) };
    Ok(Night::of(site, date))
}

/// A night over a place of a scene.
#[derive(Clone, Debug)]
pub struct SceneNight {
    /// The sky without a time, of which the artificial light is that of all hours.
    pub sky: SkyRequest,
    /// When it is dark.
    pub night: Night,
    /// Radio flux of the Sun at 10.7 cm, solar flux units.
    pub solar_flux_sfu: f64,
}

impl SceneNight {
    /// The hours of UTC from noon to noon.
    pub fn hours(&self) -> Vec<SkyTime> {
        const HOUR_S: f64 = 3_600.0;
        let first = (self.night.from_utc.unix_s() / HOUR_S).ceil();
        let last = (self.night.until_utc.unix_s() / HOUR_S).floor();
        (0..=(last - first) as u32)
            .filter_map(|hour| Instant::from_unix_s((first + f64::from(hour)) * HOUR_S).ok())
            .map(|instant| SkyTime { instant, solar_flux_sfu: self.solar_flux_sfu })
            .collect()
    }
}

/// Reads the parameters of a night over a place of a scene.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn scene_night(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<SceneNight, AppError> {
    let mut reader = Reader::new(query, p::SceneNightParameters::ALL);
    let date = read_required(&mut reader, &p::DATE, CalendarDate::parse);
    let sky = read_sky_at_night(&mut reader, scene, facts);
    reader.finish()?;
    let (Some(date), Some((sky, solar_flux_sfu))) = (date, sky) else { return Err(neither()) };
    let site = Site::new(rounded(sky.place.latitude_deg()), rounded(sky.place.longitude_deg()), 0.0);
    let night = Night::of(site.map_err(AppError::internal)?, date);
    Ok(SceneNight { sky, night, solar_flux_sfu })
}

/// Reads the parameters of a month of nights and finds them, at sea level.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn nights(query: Option<&str>) -> Result<Calendar, AppError> {
    let mut reader = Reader::new(query, p::NightsParameters::ALL);
    let site = read_site(&mut reader);
    let month =
        read_required(&mut reader, &p::MONTH, |text| CalendarDate::month(text).map(|_| text.to_owned()));
    reader.finish()?;
    let (Some(site), Some(month)) = (site, month) else { return Err(neither()) };
    Calendar::of(site, &month).map_err(AppError::internal)
}

fn neither() -> AppError {
    AppError::internal("a night was neither read nor refused")
}

fn read_site(reader: &mut Reader) -> Option<Site> {
    let (latitude_deg, longitude_deg) = (reader.required_number(&p::LAT), reader.required_number(&p::LON));
    Site::new(latitude_deg?, longitude_deg?, 0.0).ok()
}

fn read_required<T>(
    reader: &mut Reader,
    parameter: &Parameter,
    read: impl Fn(&str) -> Result<T, CelestialError>,
) -> Option<T> {
    let code = match reader.text(parameter).map(read) {
        Some(Ok(value)) => return Some(value),
        None => ValidationCode::Missing,
        Some(Err(CelestialError::OutsideYears(_))) => ValidationCode::NotAllowed,
        Some(Err(_)) => ValidationCode::Malformed,
    };
    reader.fail(parameter, code, None, None);
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mistakes<T>(read: Result<T, AppError>) -> Vec<(String, ValidationCode)> {
        let error = read.err().unwrap();
        error.field_errors().iter().map(|error| (error.parameter.clone(), error.code)).collect()
    }

    #[test]
    fn nights_are_read_and_refused_by_name() {
        let read = night(Some("lat=46&lon=8.5&date=2026-08-12")).unwrap();
        assert!(read.date.to_string() == "2026-08-12" && read.dark_hours > 3.0);
        assert_eq!(nights(Some("lat=46&lon=8.5&month=2026-02")).unwrap().nights.len(), 28);
        let named = |name: &str, code| vec![(name.to_owned(), code)];
        assert_eq!(mistakes(night(Some("lat=46&lon=8"))), named("date", ValidationCode::Missing));
        for date in ["2026-02-30", "tonight", "2026-08"] {
            let got = mistakes(night(Some(&format!("lat=46&lon=8&date={date}"))));
            assert_eq!(got, named("date", ValidationCode::Malformed), "{date}");
        }
        let late = mistakes(nights(Some("lat=46&lon=8&month=2200-01")));
        assert_eq!(late, named("month", ValidationCode::NotAllowed));
        assert_eq!(
            mistakes(nights(Some("lat=91&lon=8&month=2026-01"))),
            named("lat", ValidationCode::NotAllowed)
        );
    }
}
