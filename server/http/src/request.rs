//! Typed requests from query strings.

use crate::{
    accept::Format,
    error::ApiError,
    parameters::{self as p, ParameterSet},
    problem::Mistake,
    reader::Reader,
    source::{EyeHeight, SkyQuery, SourceFacts},
};
use skyglow_display::{Colormap, ColourRange, PictureOptions, Projection, Scale, Sky, Style};
use skyglow_physics::{EmissionMix, GeoPoint, Lamp, LampPreset, Turbidity};
use skyglow_scene::SceneId;

/// A scene's id from a path; a text that is none names no scene.
///
/// # Errors
/// [`ApiError::UnknownScene`].
pub fn scene_id(text: &str) -> Result<SceneId, ApiError> {
    SceneId::parse(text).map_err(|_| ApiError::UnknownScene { id: crate::problem::echo(text) })
}

/// Checks that there are no parameters.
///
/// # Errors
/// [`ApiError::Parameters`] naming all that are there.
pub fn no_parameters(query: Option<&str>) -> Result<(), ApiError> {
    Reader::new(query, p::NoParameters::ALL).finish()
}

/// Reads the parameters of a place.
///
/// # Errors
/// [`ApiError::Parameters`].
pub fn place(query: Option<&str>) -> Result<GeoPoint, ApiError> {
    let mut reader = Reader::new(query, p::PlaceParameters::ALL);
    let place = read_place(&mut reader);
    reader.finish()?;
    place.ok_or_else(|| ApiError::internal("a place was neither read nor refused"))
}

/// Reads the parameters of a sky and which light is shown.
///
/// # Errors
/// [`ApiError::Parameters`] with every mistake.
pub fn sky(query: Option<&str>, scene: SceneId, facts: &SourceFacts) -> Result<(SkyQuery, Sky), ApiError> {
    let mut reader = Reader::new(query, p::SkyParameters::ALL);
    let sky = read_sky(&mut reader, scene, facts);
    let light = read_light(&mut reader);
    reader.finish()?;
    Ok((sky.ok_or_else(|| ApiError::internal("a sky was neither read nor refused"))?, light))
}

/// How a panorama is to be shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Picture options; width and height are those given or the projection's own.
    pub options: PictureOptions,
    /// Width and height of a raster: those given or the raw grid's.
    pub raster_size_px: (u32, u32),
}

/// Reads the parameters of a panorama in a format.
///
/// # Errors
/// [`ApiError::Parameters`] with every mistake; what means nothing for the format is as good as unknown.
pub fn panorama(
    query: Option<&str>,
    scene: SceneId,
    facts: &SourceFacts,
    format: Format,
) -> Result<(SkyQuery, View), ApiError> {
    let mut reader = Reader::new(query, p::PanoramaParameters::ALL);
    only_what_means_something(&mut reader, format);
    let sky = read_sky(&mut reader, scene, facts);
    let view = read_view(&mut reader);
    reader.finish()?;
    Ok((sky.ok_or_else(|| ApiError::internal("a sky was neither read nor refused"))?, view))
}

fn only_what_means_something(reader: &mut Reader, format: Format) {
    let known = format.parameters();
    let names: Vec<&str> = known.iter().map(|parameter| parameter.name).collect();
    for parameter in p::PanoramaParameters::ALL.iter().filter(|parameter| !names.contains(&parameter.name)) {
        if reader.text(parameter).is_some() {
            let message = Some(format!("means nothing for {}", format.media_type()));
            reader.fail(parameter, Mistake::UnknownParameter, message, Some(names.join(", ")));
        }
    }
}

fn read_place(reader: &mut Reader) -> Option<GeoPoint> {
    let (latitude_deg, longitude_deg) = (reader.required_number(&p::LAT), reader.required_number(&p::LON));
    GeoPoint::from_deg(latitude_deg?, longitude_deg?).ok()
}

fn read_light(reader: &mut Reader) -> Sky {
    match reader.choice(&p::SKY) {
        Some("total") => Sky::Total,
        _ => Sky::Artificial,
    }
}

fn read_sky(reader: &mut Reader, scene: SceneId, facts: &SourceFacts) -> Option<SkyQuery> {
    let place = read_place(reader);
    let eye_height = read_eye_height(reader, facts);
    let turbidity = read_turbidity(reader, facts);
    let lamp = read_lamp(reader);
    let emission = read_emission(reader);
    let basis = read_basis(reader, facts);
    read_what_is_not_there_yet(reader);
    reader.is_fine().then_some(())?;
    Some(SkyQuery { scene, place: place?, eye_height, turbidity: turbidity?, lamp, emission, basis })
}

fn read_eye_height(reader: &mut Reader, facts: &SourceFacts) -> EyeHeight {
    let height_m = reader.number_of_any_size(&p::HEIGHT);
    let altitude_m = reader.number_of_any_size(&p::ALTITUDE);
    if reader.text(&p::HEIGHT).is_some() && reader.text(&p::ALTITUDE).is_some() {
        let message = Some("excludes `height`, which is given too".to_owned());
        reader.fail(&p::ALTITUDE, Mistake::Conflict, message, Some("one of the two".to_owned()));
    }
    let maximum_m = facts.altitude_range_m.1;
    if let Some(altitude_m) = altitude_m {
        if altitude_m > maximum_m {
            let allowed = format!("0 to {maximum_m} m above sea level; below 0 counts as 0");
            reader.fail(&p::ALTITUDE, Mistake::OutOfRange, None, Some(allowed));
        }
        return EyeHeight::AboveSea(altitude_m.max(0.0));
    }
    if let Some(height_m) = height_m {
        let allowed = || Some(format!("0 to {maximum_m} m, less the altitude of the ground"));
        if height_m < 0.0 {
            reader.fail(&p::HEIGHT, Mistake::NotAllowed, None, allowed());
        } else if height_m > maximum_m {
            // Too high over any ground: the same mistake as too high over this one, which the scene knows.
            reader.fail(&p::HEIGHT, Mistake::OutOfRange, None, allowed());
        }
    }
    EyeHeight::AboveGround(height_m.unwrap_or(2.0))
}

fn read_basis(reader: &mut Reader, facts: &SourceFacts) -> Option<usize> {
    let basis = reader.whole_number_of_any_size(&p::BASIS)?;
    let allowed = Some(format!("a whole number from 1 to {}", facts.basis_count));
    if basis < 1 {
        reader.fail(&p::BASIS, Mistake::NotAllowed, None, allowed);
        return None;
    }
    let basis = usize::try_from(basis).unwrap_or(usize::MAX);
    if basis > facts.basis_count {
        let message = Some("is more than is resident".to_owned());
        reader.fail(&p::BASIS, Mistake::NotResident, message, allowed);
    }
    Some(basis)
}

fn read_turbidity(reader: &mut Reader, facts: &SourceFacts) -> Option<Turbidity> {
    let (minimum, maximum) = facts.turbidity_range;
    let given = reader.number_of_any_size(&p::TURBIDITY);
    if reader.text(&p::TURBIDITY).is_some() && given.is_none() {
        return None;
    }
    let value = given.unwrap_or(Turbidity::default().value());
    if !(minimum..=maximum).contains(&value) {
        let allowed = format!("{minimum} to {maximum}");
        reader.fail(&p::TURBIDITY, Mistake::OutOfRange, None, Some(allowed));
        return None;
    }
    match Turbidity::new(value) {
        Ok(turbidity) => Some(turbidity),
        Err(_) => {
            reader.fail(&p::TURBIDITY, Mistake::OutOfRange, None, None);
            None
        }
    }
}

fn read_lamp(reader: &mut Reader) -> Lamp {
    let Some(text) = reader.text(&p::LAMP) else { return Lamp::default() };
    let lamp = LampPreset::from_name(text).map(LampPreset::lamp);
    let lamp = lamp.or_else(|| Reader::three_numbers(text).and_then(|fluxes| Lamp::custom(fluxes).ok()));
    if lamp.is_none() {
        reader.fail(&p::LAMP, Mistake::NotAllowed, None, None);
    }
    lamp.unwrap_or_default()
}

fn read_emission(reader: &mut Reader) -> EmissionMix {
    let Some(text) = reader.text(&p::EMISSION) else { return EmissionMix::default() };
    let mix = EmissionMix::from_name(text)
        .or_else(|| Reader::three_numbers(text).and_then(|weights| EmissionMix::new(weights).ok()));
    if mix.is_none() {
        reader.fail(&p::EMISSION, Mistake::NotAllowed, None, None);
    }
    mix.unwrap_or_default()
}

/// Parameters whose only possible value, for now, is what the answer says anyway.
fn read_what_is_not_there_yet(reader: &mut Reader) {
    if reader.choice(&p::SCATTERING) == Some("multiple") {
        reader.fail(&p::SCATTERING, Mistake::NotResident, None, Some("single".to_owned()));
    }
    if reader.text(&p::CLOUDS).is_some_and(|clouds| clouds != "none") {
        reader.fail(&p::CLOUDS, Mistake::NotSupportedYet, None, None);
    }
    reader.choice(&p::TERRAIN);
    for parameter in [&p::TOLERANCE, &p::SCENARIO] {
        if reader.text(parameter).is_some() {
            reader.fail(parameter, Mistake::NotSupportedYet, None, None);
        }
    }
}

fn read_view(reader: &mut Reader) -> View {
    let projection = read_projection(reader);
    let style = read_style(reader);
    let sky = read_light(reader);
    let (width_px, height_px) = (reader.integer(&p::WIDTH), reader.integer(&p::HEIGHT_PX));
    let legend = reader.choice(&p::LEGEND) != Some("off");
    let sized = |own: (u32, u32)| (width_px.unwrap_or(own.0), height_px.unwrap_or(own.1));
    let picture_size_px = sized(projection.default_picture_size_px());
    View {
        options: PictureOptions {
            projection,
            style,
            width_px: picture_size_px.0,
            height_px: picture_size_px.1,
            legend,
            sky,
        },
        raster_size_px: sized(projection.default_raster_size_px()),
    }
}

/// Notes parameters that say nothing under the choice made: silence would hide a slip.
fn only_with(reader: &mut Reader, parameters: &[&p::Parameter], choice: &str) {
    for parameter in parameters {
        if reader.text(parameter).is_some() {
            let message = Some(format!("means nothing without {choice}"));
            reader.fail(parameter, Mistake::Conflict, message, Some(format!("with {choice} alone")));
        }
    }
}

fn read_projection(reader: &mut Reader) -> Projection {
    let named = reader.choice(&p::PROJECTION);
    let azimuth_deg = reader.number(&p::AZIMUTH);
    let elevation_deg = reader.number(&p::ELEVATION);
    let fov_deg = reader.number(&p::FOV);
    if named == Some("perspective") {
        return Projection::Perspective {
            azimuth_deg: azimuth_deg.unwrap_or(0.0),
            elevation_deg: elevation_deg.unwrap_or(skyglow_display::options::DEFAULT_ELEVATION_DEG),
            fov_deg: fov_deg.unwrap_or(skyglow_display::options::DEFAULT_FOV_DEG),
        };
    }
    only_with(reader, &[&p::AZIMUTH, &p::ELEVATION, &p::FOV], "projection=perspective");
    if named == Some("fisheye") { Projection::Fisheye } else { Projection::Equirectangular }
}

fn read_style(reader: &mut Reader) -> Style {
    let realistic = reader.choice(&p::STYLE) == Some("realistic");
    let colormap = reader.choice(&p::COLORMAP).and_then(Colormap::from_name).unwrap_or_default();
    let scale = match reader.choice(&p::SCALE) {
        Some("magnitude") => Scale::Magnitude,
        _ => Scale::Luminance,
    };
    let exposure_ev = reader.number(&p::EXPOSURE);
    let default = ColourRange::of(scale);
    let min = reader.number_of_any_size(&p::MIN).unwrap_or(default.min);
    let max = reader.number_of_any_size(&p::MAX).unwrap_or(default.max);
    if realistic {
        only_with(reader, &[&p::COLORMAP, &p::SCALE, &p::MIN, &p::MAX], "style=false_colour");
        return Style::Realistic { exposure_ev: exposure_ev.unwrap_or(0.0) };
    }
    only_with(reader, &[&p::EXPOSURE], "style=realistic");
    let range = ColourRange { scale, min, max };
    if let Err(error) = range.check() {
        // The end that the error names; where both are fine alone, the one that was given.
        let given_max = reader.text(&p::MAX).is_some();
        let parameter = match &error {
            skyglow_display::DisplayError::OutOfRange { option: "max", .. } => &p::MAX,
            skyglow_display::DisplayError::EmptyRange { .. } if given_max => &p::MAX,
            _ => &p::MIN,
        };
        reader.fail(parameter, Mistake::NotAllowed, Some(error.to_string()), None);
    }
    Style::FalseColour { colormap, range }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts() -> SourceFacts {
        SourceFacts {
            executor: "cpu".into(),
            adapter: "none".into(),
            turbidity_range: (1.5, 6.0),
            altitude_range_m: (0.0, 6000.0),
            basis_count: 64,
            pack_checksums: "x".into(),
        }
    }

    fn read(query: &str) -> Result<(SkyQuery, View), ApiError> {
        read_as(query, Format::Png)
    }

    fn read_as(query: &str, format: Format) -> Result<(SkyQuery, View), ApiError> {
        panorama(Some(query), SceneId::parse("demo").unwrap(), &facts(), format)
    }

    fn refused(query: &str) -> (String, Vec<(String, Mistake)>) {
        let error = read(query).unwrap_err();
        let problem = error.problem();
        (problem.kind, problem.errors.into_iter().map(|e| (e.parameter, e.code)).collect())
    }

    #[test]
    fn the_defaults_are_those_of_the_interface() {
        let (sky, view) = read("lat=-1&lon=36").unwrap();
        assert_eq!(sky.eye_height, EyeHeight::AboveGround(2.0));
        assert_eq!(sky.turbidity, Turbidity::default());
        assert_eq!(sky.lamp, LampPreset::Mixed.lamp());
        assert_eq!(sky.emission, EmissionMix::garstang());
        assert_eq!(sky.basis, None);
        assert_eq!(view.options, PictureOptions::new(Projection::Equirectangular));
        assert_eq!(view.raster_size_px, (256, 64));
    }

    #[test]
    fn turbidity_0_and_100_and_altitude_9000_are_out_of_range_with_the_range() {
        for query in ["turbidity=0", "turbidity=100", "altitude=9000"] {
            let error = read(&format!("lat=-1&lon=36&{query}")).unwrap_err();
            let problem = error.problem();
            assert_eq!((problem.status, problem.kind.as_str()), (422, "/problems/out-of-range"), "{query}");
            let allowed = &problem.errors[0].allowed;
            assert!(allowed.contains("1.5 to 6") || allowed.contains("0 to 6000 m"), "{allowed}");
        }
    }

    #[test]
    fn a_height_is_refused_by_its_own_name_below_the_ground_and_above_the_tables() {
        for (query, status, code) in
            [("height=-1", 400, Mistake::NotAllowed), ("height=200000", 422, Mistake::OutOfRange)]
        {
            let problem = read(&format!("lat=-1&lon=36&{query}")).unwrap_err().problem();
            assert_eq!((problem.status, problem.errors[0].code), (status, code), "{query}");
            assert_eq!(problem.errors[0].parameter, "height");
            assert!(problem.errors[0].allowed.starts_with("0 to 6000 m"), "{problem:?}");
        }
        assert!(read("lat=-1&lon=36&height=6000").is_ok());
    }

    #[test]
    fn altitudes_below_the_sea_count_as_0() {
        let (sky, _) = read("lat=-1&lon=36&altitude=-430").unwrap();
        assert_eq!(sky.eye_height, EyeHeight::AboveSea(0.0));
    }

    #[test]
    fn what_is_not_built_yet_is_said_to_be_so() {
        let (kind, errors) = refused("lat=-1&lon=36&clouds=1500&tolerance=0.01&scenario=abc");
        assert_eq!(kind, "/problems/not-supported-yet");
        assert_eq!(errors.len(), 3);
        assert_eq!(refused("lat=-1&lon=36&scattering=multiple").0, "/problems/not-resident");
        assert_eq!(refused("lat=-1&lon=36&basis=128").0, "/problems/not-resident");
        for fine in ["clouds=none", "scattering=single", "terrain=on", "terrain=off", "basis=64"] {
            assert!(read(&format!("lat=-1&lon=36&{fine}")).is_ok(), "{fine}");
        }
    }

    #[test]
    fn a_basis_of_any_wrong_size_is_refused_with_what_is_resident() {
        for (basis, code) in [
            ("0", Mistake::NotAllowed),
            ("-3", Mistake::NotAllowed),
            ("65", Mistake::NotResident),
            ("5000", Mistake::NotResident),
        ] {
            let problem = read(&format!("lat=-1&lon=36&basis={basis}")).unwrap_err().problem();
            assert_eq!(problem.errors[0].code, code, "{basis}");
            assert_eq!(problem.errors[0].allowed, "a whole number from 1 to 64", "{basis}");
        }
        assert_eq!(refused("lat=-1&lon=36&basis=6.5").1, [("basis".to_owned(), Mistake::Malformed)]);
    }

    #[test]
    fn what_means_nothing_for_a_format_is_refused_there_by_name() {
        let colours = [
            "style=realistic",
            "colormap=grey",
            "scale=magnitude",
            "min=16",
            "max=24",
            "exposure=1",
            "legend=off",
        ];
        let shape = ["projection=fisheye", "width=64", "height_px=64"];
        let refused = |parameter: &str, format: Format| {
            let problem = read_as(&format!("lat=-1&lon=36&{parameter}"), format).err()?.problem();
            let named = parameter.split('=').next() == Some(problem.errors[0].parameter.as_str());
            assert!(named && problem.errors[0].message.contains(format.media_type()), "{problem:?}");
            assert!(problem.errors[0].allowed.contains("turbidity"), "{problem:?}");
            Some(problem.errors[0].code)
        };
        for format in [Format::Exr, Format::Tiff] {
            for parameter in colours {
                assert_eq!(refused(parameter, format), Some(Mistake::UnknownParameter), "{parameter}");
            }
            for parameter in shape {
                assert_eq!(refused(parameter, format), None, "{parameter}");
            }
        }
        for parameter in colours.iter().chain(&shape) {
            assert_eq!(refused(parameter, Format::Json), Some(Mistake::UnknownParameter), "{parameter}");
        }
        assert!(read_as("lat=-1&lon=36&sky=total&basis=8", Format::Json).is_ok());
    }

    #[test]
    fn all_mistakes_of_sky_and_picture_come_in_one_answer() {
        let (kind, errors) =
            refused("lon=400&turbidity=x&lamp=candle&style=pretty&fov=3&min=5&max=1&nonsense=1");
        assert_eq!(kind, "/problems/bad-parameters");
        let names: Vec<&str> = errors.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["nonsense", "lat", "lon", "turbidity", "lamp", "fov", "style", "max"]);
    }

    #[test]
    fn height_and_altitude_exclude_each_other() {
        let (_, errors) = refused("lat=-1&lon=36&height=2&altitude=1000");
        assert_eq!(errors, [("altitude".to_owned(), Mistake::Conflict)]);
    }

    #[test]
    fn lamps_and_emissions_may_be_given_as_numbers() {
        let (sky, _) = read("lat=-1&lon=36&lamp=0.1,0.2,0.3&emission=1,1,2").unwrap();
        assert_eq!(sky.lamp.flux_per_dnb_flux, [0.1, 0.2, 0.3]);
        assert_eq!(sky.emission.weights(), [0.25, 0.25, 0.5]);
        for bad in
            ["lamp=0,0,0", "lamp=1,2", "lamp=-1,1,1", "emission=0,0,0", "emission=a", "emission=1,2,-1"]
        {
            assert_eq!(refused(&format!("lat=-1&lon=36&{bad}")).0, "/problems/bad-parameters", "{bad}");
        }
    }
}
