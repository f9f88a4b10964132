//! Horizons as planetarium and imaging programs read them: Stellarium's polygonal landscapes (Stellarium User Guide, "Landscapes") and
//! N.I.N.A.'s custom horizons.

use skyglow_observatory::RenderedSky;
use skyglow_physics::{AZIMUTH_COUNT, GeoPoint, Horizon, panorama::azimuth_rad};
use skyglow_scene::SceneMetadata;
use std::{
    fmt::Write as _,
    io::{Cursor, Write as _},
};
use zip::{DateTime, ZipWriter, result::ZipError, write::SimpleFileOptions};

/// A format of horizons. Both have a line for each point, azimuth and altitude in degrees, and comments after a `#`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HorizonFormat {
    /// Stellarium closes the polygon itself.
    Stellarium,
    /// N.I.N.A. interpolates from 0 to 360 degrees, both of which are there.
    Nina,
}

/// Magnitudes by which an optical depth of 1 dims.
const MAGNITUDES_PER_OPTICAL_DEPTH: f64 = 1.0857;
/// The spectral nodes on either side of Johnson's V (590 and 510 around 545 nm) and the weight of the first, by the logarithm of
/// wavelength.
const NODES_AROUND_V: (usize, usize, f64) = (1, 2, 0.455);

/// The text of a horizon.
///
/// * `eye_m`: altitude of the eye, metres above sea level.
pub fn horizon_text(
    format: HorizonFormat,
    scene: &SceneMetadata,
    place: GeoPoint,
    eye_m: f64,
    horizon: &Horizon,
) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    line(format!(
        "# Horizon at latitude {:.5}, longitude {:.5}, eye {eye_m:.0} m above sea level",
        place.latitude_deg(),
        place.longitude_deg()
    ));
    line(format!(
        "# From the terrain of scene {} ({}), by Skyglow; without refraction",
        scene.id,
        one_line(&scene.title)
    ));
    if let Some(credit) = &scene.attribution {
        line(format!("# Credit: {}", one_line(credit)));
    }
    line("# Azimuth from true north through east, altitude; degrees".to_owned());
    let mut point = |azimuth_deg: f64, elevation_rad: f64| {
        line(format!("{azimuth_deg:.5} {:.3}", elevation_rad.to_degrees()));
    };
    let elevations_rad = horizon.elevations_rad();
    for (column, &elevation_rad) in elevations_rad.iter().enumerate().take(AZIMUTH_COUNT) {
        point(azimuth_rad(column).to_degrees(), elevation_rad);
    }
    if format == HorizonFormat::Nina {
        point(360.0, elevations_rad.first().copied().unwrap_or(0.0));
    }
    text
}

/// A landscape for Stellarium as a zip archive that it installs: the horizon, where it is, how bright artificial light makes its sky,
/// and how much its air dims stars.
///
/// # Errors
/// [`ZipError`], only by a defect.
pub fn stellarium_landscape(
    scene: &SceneMetadata,
    place: GeoPoint,
    sky: &RenderedSky,
) -> Result<Vec<u8>, ZipError> {
    let eye_m = sky.context.altitude_m;
    let horizon = horizon_text(HorizonFormat::Stellarium, scene, place, eye_m, &sky.horizon);
    let folder = format!("skyglow_{:.4}_{:.4}", place.latitude_deg(), place.longitude_deg());
    // The same request gives the same bytes: no time of today.
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [("landscape.ini", &landscape_ini(scene, place, sky)), ("horizon.txt", &horizon)] {
        archive.start_file(format!("{folder}/{name}"), options)?;
        archive.write_all(text.as_bytes())?;
    }
    Ok(archive.finish()?.into_inner())
}

fn landscape_ini(scene: &SceneMetadata, place: GeoPoint, sky: &RenderedSky) -> String {
    let (latitude_deg, longitude_deg) = (place.latitude_deg(), place.longitude_deg());
    let half = |deg: f64, letters: [char; 2]| format!("{:.4} {}", deg.abs(), letters[usize::from(deg < 0.0)]);
    let name = format!("Skyglow {} {}", half(latitude_deg, ['N', 'S']), half(longitude_deg, ['E', 'W']));
    let mut description =
        format!("Horizon and sky brightness from scene {}: {}", scene.id, one_line(&scene.title));
    // Once is enough: the title or the credit of made-up light may say it already.
    let says_so = |text: &str| text.to_lowercase().contains("illustrative");
    if scene.illustrative && !says_so(&scene.title) {
        description.push_str(" (illustrative, not measured)");
    }
    for (label, words) in [(" - light of ", &scene.date), (" - ", &scene.attribution)] {
        if let Some(words) = words {
            let words = one_line(words);
            let said = if scene.illustrative { words.trim_start_matches("Illustrative: ") } else { &words };
            let _ = write!(description, "{label}{said}");
        }
    }
    let depths = sky.context.local_optical_depth;
    let (red, green, weight) = NODES_AROUND_V;
    let depth = (weight * depths[red].ln() + (1.0 - weight) * depths[green].ln()).exp();
    // A horizon with a corner at exactly 0 or 180 degrees is drawn badly: Stellarium's own landscapes turn theirs as little.
    format!(
        "[landscape]\n\
         name = {name}\n\
         author = Skyglow\n\
         description = {description}\n\
         type = polygonal\n\
         polygonal_horizon_list = horizon.txt\n\
         polygonal_horizon_list_mode = azDeg_altDeg\n\
         polygonal_angle_rotatez = 0.00001\n\
         ground_color = .12,.13,.10\n\
         \n\
         [location]\n\
         planet = Earth\n\
         name = {name}\n\
         latitude = {}\n\
         longitude = {}\n\
         altitude = {:.0}\n\
         light_pollution_luminance = {:.4e}\n\
         atmospheric_extinction_coefficient = {:.3}\n\
         atmospheric_pressure = -1\n",
        sexagesimal(latitude_deg),
        sexagesimal(longitude_deg),
        sky.context.altitude_m,
        sky.quantities.zenith_luminance_cd_m2,
        MAGNITUDES_PER_OPTICAL_DEPTH * depth,
    )
}

/// Degrees as Stellarium writes them: +48d29'18.0".
fn sexagesimal(deg: f64) -> String {
    let tenths = (deg.abs() * 36_000.0).round();
    let (degrees, rest) = ((tenths / 36_000.0).floor(), tenths % 36_000.0);
    let (minutes, seconds) = ((rest / 600.0).floor(), rest % 600.0 / 10.0);
    let sign = if deg < 0.0 { '-' } else { '+' };
    format!("{sign}{degrees:.0}d{minutes:.0}'{seconds:.1}\"")
}

/// Words that stay on their line and begin no comment.
fn one_line(words: &str) -> String {
    let plain = words.replace([';', '#'], ",");
    plain
        .split(|c: char| c.is_whitespace() || c.is_control())
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_sexagesimal_to_tenths() {
        assert_eq!(sexagesimal(48.488_333_333), "+48d29'18.0\"");
        assert_eq!(sexagesimal(-0.000_28), "-0d0'1.0\"");
        assert_eq!(sexagesimal(-1.999_999_99), "-2d0'0.0\"");
        assert_eq!(one_line("a;\n[location] #b"), "a, [location] ,b");
    }
}
