//! The standard format for skyglow measurements (IDA/NSBM 1.0), as loggers of SQM and TESS write it. Reads what `skyglow.measurements.read_ida`
//! of the Python package reads.

use thiserror::Error;

/// The fields that a reading needs, by their names in the header.
const TIME: &str = "UTC Date & Time";
const BRIGHTNESS: &str = "MSAS";

/// A reading.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reading {
    /// RFC 3339, UTC.
    pub(crate) time: String,
    pub(crate) latitude_deg: f64,
    pub(crate) longitude_deg: f64,
    pub(crate) brightness_mag_arcsec2: f64,
    /// The instrument's id or, without one, its type.
    pub(crate) instrument: String,
}

/// Why a file is not read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(crate) enum IdaError {
    /// Another kind of file.
    #[error("this is no file of the IDA/NSBM format: its first line does not name the standard")]
    NotIda,
    /// A header without its last line.
    #[error("the header has no line `# END OF HEADER`")]
    NoEnd,
    /// The names of the fields lack one that is needed.
    #[error("the header names no fields `{TIME}` and `{BRIGHTNESS}`")]
    NoFields,
    /// Where it was measured.
    #[error("the header's Position is no latitude and longitude: \"{text}\"")]
    Position {
        /// What is there.
        text: String,
    },
    /// A reading that is no number.
    #[error("line {line}: \"{text}\" is no brightness")]
    Brightness {
        /// Number of the line in the file, from 1.
        line: usize,
        /// What is there.
        text: String,
    },
}

/// The readings of a file. Readings of 0, which a meter gives when it saw nothing, are left out, as are empty ones.
pub(crate) fn read_ida(text: &str) -> Result<Vec<Reading>, IdaError> {
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut header: Vec<&str> = Vec::new();
    loop {
        let (number, line) =
            lines.next().ok_or(if header.is_empty() { IdaError::NotIda } else { IdaError::NoEnd })?;
        if number == 0 && !line.to_lowercase().contains("skyglow") {
            return Err(IdaError::NotIda);
        }
        let line = line.trim().trim_start_matches('#').trim();
        if line.eq_ignore_ascii_case("END OF HEADER") {
            break;
        }
        header.push(line);
    }
    let (latitude_deg, longitude_deg) = position(&header)?;
    let instrument =
        ["Instrument ID", "Device type"].into_iter().filter_map(|name| entry(&header, |n| n == name));
    let instrument = instrument.into_iter().find(|text| !text.is_empty()).unwrap_or_default().to_owned();
    let (time_at, brightness_at) = fields(&header)?;
    let mut readings = Vec::new();
    for (number, line) in lines {
        let line = line.split('#').next().unwrap_or_default();
        let fields: Vec<&str> = line.split(';').map(str::trim).collect();
        let [time, brightness] =
            [time_at, brightness_at].map(|at| fields.get(at).copied().unwrap_or_default());
        if brightness.is_empty() {
            continue;
        }
        let brightness_mag_arcsec2: f64 = brightness
            .parse()
            .map_err(|_| IdaError::Brightness { line: number + 1, text: brightness.to_owned() })?;
        if brightness_mag_arcsec2 > 0.0 {
            let (time, instrument) = (rfc3339(time), instrument.clone());
            readings.push(Reading { time, latitude_deg, longitude_deg, brightness_mag_arcsec2, instrument });
        }
    }
    Ok(readings)
}

/// The value of the first entry of the header whose name is wanted.
fn entry<'a>(header: &[&'a str], is_wanted: impl Fn(&str) -> bool) -> Option<&'a str> {
    let entries = header.iter().filter_map(|line| line.split_once(':'));
    entries
        .map(|(name, value)| (name.trim(), value.trim()))
        .find(|(name, _)| is_wanted(name))
        .map(|entry| entry.1)
}

/// Latitude and longitude: the first entry whose name begins with `Position`.
fn position(header: &[&str]) -> Result<(f64, f64), IdaError> {
    // `Position (lat, lon, elev(m)): 46.53, 8.61, 1500`.
    let text = entry(header, |name| name.starts_with("Position")).unwrap_or_default();
    let numbers = text.replace(['(', ')'], "");
    let mut parts = numbers.split(',').map(|part| part.trim().parse::<f64>().ok());
    match (parts.next().flatten(), parts.next().flatten()) {
        (Some(latitude_deg), Some(longitude_deg)) => Ok((latitude_deg, longitude_deg)),
        _ => Err(IdaError::Position { text: text.to_owned() }),
    }
}

/// Which fields of a line are time and brightness: by the last line of the header that names fields.
fn fields(header: &[&str]) -> Result<(usize, usize), IdaError> {
    let line = header.iter().rev().find(|line| line.contains(BRIGHTNESS) && line.contains(','));
    let line = line.ok_or(IdaError::NoFields)?;
    let line = line.strip_prefix("Field names:").unwrap_or(line);
    let at = |name: &str| line.split(',').position(|field| field.trim() == name);
    at(TIME).zip(at(BRIGHTNESS)).ok_or(IdaError::NoFields)
}

/// `2026-08-12T23:00:00.000`, perhaps with a blank in place of the T, is a time in UTC. What is no time is refused where skies are asked for.
fn rfc3339(time: &str) -> String {
    let time = time.replacen(' ', "T", 1);
    let has_zone = time.ends_with('Z') || time.rfind(['+', '-']).is_some_and(|at| at > 10);
    if has_zone { time } else { format!("{time}Z") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files that the tests of the Python package read.
    const SQM: &str = include_str!("../../../../python/tests/data/valley-sqm.dat");
    const TESS: &str = include_str!("../../../../python/tests/data/stars1-tess.dat");

    #[test]
    fn files_of_sky_quality_meters_are_read() {
        let readings = read_ida(SQM).unwrap();
        let brightness: Vec<f64> = readings.iter().map(|reading| reading.brightness_mag_arcsec2).collect();
        assert_eq!(brightness, [21.40, 21.42], "a reading of 0 is none");
        let wanted = Reading {
            time: "2026-08-12T23:10:00.500Z".to_owned(),
            latitude_deg: 46.53,
            longitude_deg: 8.61,
            brightness_mag_arcsec2: 21.42,
            instrument: "SQM-Valley".to_owned(),
        };
        assert_eq!(readings[1], wanted);
    }

    /// Fields lie elsewhere there, and a height is not known.
    #[test]
    fn files_of_tess_are_read() {
        let readings = read_ida(TESS).unwrap();
        assert_eq!(readings.len(), 1);
        assert_eq!((readings[0].latitude_deg, readings[0].longitude_deg), (46.17, 8.79));
        assert_eq!((readings[0].brightness_mag_arcsec2, readings[0].instrument.as_str()), (20.21, "stars1"));
    }

    /// Line ends of Windows, a byte order mark, comments and empty lines among the readings, no instrument's name.
    #[test]
    fn files_from_elsewhere_are_read() {
        let text = format!("\u{feff}{}", SQM.replace("SQM-Valley", "").replace('\n', "\r\n"));
        let text = text.replace("END OF HEADER\r\n", "END OF HEADER\r\n# dew\r\n\r\n");
        let readings = read_ida(&text).unwrap();
        assert_eq!(readings.len(), 2);
        assert_eq!(readings[0].instrument, "SQM-LU-DL");
        assert_eq!(rfc3339("2026-08-12 23:00:00"), "2026-08-12T23:00:00Z");
        assert_eq!(rfc3339("2026-08-12T23:00:00+02:00"), "2026-08-12T23:00:00+02:00");
    }

    #[test]
    fn files_of_other_kinds_are_refused() {
        assert_eq!(read_ida("ID,ObsType\n1,GAN\n"), Err(IdaError::NotIda));
        assert_eq!(read_ida(""), Err(IdaError::NotIda));
        assert_eq!(read_ida(SQM.split("# END").next().unwrap_or_default()), Err(IdaError::NoEnd));
        let position = IdaError::Position { text: "the valley".to_owned() };
        assert_eq!(read_ida(&SQM.replace("46.53, 8.61, 1500", "the valley")), Err(position));
        assert_eq!(read_ida(&SQM.replace("MSAS", "Counts")), Err(IdaError::NoFields));
        let bright = IdaError::Brightness { line: 28, text: "bright".to_owned() };
        assert_eq!(read_ida(&SQM.replace("21.40", "bright")), Err(bright));
    }
}
