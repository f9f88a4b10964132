//! What is read and what is refused.

use super::*;
use crate::{
    facts::KindFacts,
    validation::{Refusal, ValidationCode},
};
use skyglow_display::{PictureOptions, Projection};
use skyglow_observatory::ObserverHeight;
use skyglow_physics::{BrokenClouds, Emission, GarstangLaw, LampPreset, Turbidity};
use skyglow_tables::{Clouds, Scattering};

pub(super) fn facts() -> SourceFacts {
    SourceFacts {
        max_places: 1000,
        executor: "cpu".into(),
        adapter: "none".into(),
        kinds: vec![kind(Scattering::Single, (1.5, 6.0), 64)],
        any_cloud_albedo: None,
        altitude_range_m: (0.0, 6000.0),
        celestial_turbidity_range: Some((1.5, 6.0)),
        celestial_highest_m: Some(4500.0),
        pack_checksums: "x".into(),
    }
}

fn kind(scattering: Scattering, turbidity_range: (f64, f64), basis_count: usize) -> KindFacts {
    let unserved = Vec::new();
    KindFacts {
        clouds: None,
        scattering,
        turbidity_range,
        unserved,
        basis_count,
        ground_albedo: None,
        why_open: None,
        checksums: String::new(),
    }
}

fn read(query: &str) -> Result<(SkyRequest, PictureRequest), AppError> {
    read_as(query, Format::Png)
}

fn read_as(query: &str, format: Format) -> Result<(SkyRequest, PictureRequest), AppError> {
    panorama(Some(query), SceneId::parse("demo").unwrap(), &facts(), format)
}

fn refused(query: &str) -> (Refusal, Vec<(String, ValidationCode)>) {
    let error = read(query).unwrap_err();
    let errors = error.field_errors();
    (Refusal::of(errors), errors.iter().map(|e| (e.parameter.clone(), e.code)).collect())
}

#[test]
fn the_defaults_are_those_of_the_interface() {
    let (sky, view) = read("lat=-1&lon=36").unwrap();
    assert_eq!(sky.observer_height, ObserverHeight::AboveGround(2.0));
    assert_eq!(sky.turbidity, Turbidity::default());
    assert_eq!(sky.lamp, LampPreset::Mixed.lamp());
    assert_eq!(sky.emission, Emission::from(GarstangLaw::MODERN_CITY));
    assert_eq!((sky.scattering, sky.basis), (Scattering::Single, None));
    assert!(sky.terrain_hides && !read("lat=-1&lon=36&terrain=off").unwrap().0.terrain_hides);
    assert_eq!(view.options, PictureOptions::new(Projection::Equirectangular));
    assert_eq!(view.raster_size_px, (256, 64));
}

/// Where a pack is left out, what it alone could serve is refused with what is there.
#[test]
fn a_hole_in_turbidity_is_refused() {
    let mut facts = facts();
    facts.kinds[0].unserved = vec![(2.0, 4.75)];
    let read = |turbidity: &str| {
        let query = format!("lat=-1&lon=36&turbidity={turbidity}");
        panorama(Some(&query), SceneId::parse("demo").unwrap(), &facts, Format::Png)
    };
    assert!(["1.5", "2", "4.75", "6"].iter().all(|turbidity| read(turbidity).is_ok()));
    let error = read("2.5").unwrap_err();
    let error = &error.field_errors()[0];
    assert_eq!((error.allowed.as_str(), error.code), ("1.5 to 2, 4.75 to 6", ValidationCode::OutOfRange));
    assert!(error.message.contains("damaged"), "{}", error.message);
    facts.kinds[0].unserved = vec![(1.5, 4.75), (4.75, 6.0)];
    assert_eq!(facts.kinds[0].turbidities(), "1.5, 4.75, 6");
}

/// Turbidity 0 and 100 and altitude 9000 are out of range with the range.
#[test]
fn out_of_range_is_refused_with_the_range() {
    for query in ["turbidity=0", "turbidity=100", "altitude=9000"] {
        let error = read(&format!("lat=-1&lon=36&{query}")).unwrap_err();
        let errors = error.field_errors();
        assert_eq!(Refusal::of(errors), Refusal::OutOfRange, "{query}");
        let allowed = &errors[0].allowed;
        assert!(allowed.contains("1.5 to 6") || allowed.contains("0 to 6000 m"), "{allowed}");
    }
}

/// A height is refused by its own name below the ground and above the tables.
#[test]
fn a_height_is_refused_by_its_own_name() {
    for (query, refusal, code) in [
        ("height=-1", Refusal::BadParameters, ValidationCode::NotAllowed),
        ("height=200000", Refusal::OutOfRange, ValidationCode::OutOfRange),
    ] {
        let error = read(&format!("lat=-1&lon=36&{query}")).unwrap_err();
        let errors = error.field_errors();
        assert_eq!((Refusal::of(errors), errors[0].code), (refusal, code), "{query}");
        assert_eq!(errors[0].parameter, "height");
        assert!(errors[0].allowed.starts_with("0 to 6000 m"), "{errors:?}");
    }
    assert!(read("lat=-1&lon=36&height=6000").is_ok());
}

#[test]
fn altitudes_below_the_sea_count_as_0() {
    let (sky, _) = read("lat=-1&lon=36&altitude=-430").unwrap();
    assert_eq!(sky.observer_height, ObserverHeight::AboveSea(0.0));
}

#[test]
fn what_is_not_resident_is_said_to_be_so() {
    let (kind, errors) = refused("lat=-1&lon=36&scenario=abc");
    assert_eq!(kind, Refusal::BadParameters);
    assert_eq!(errors.len(), 1);
    let (sky, _) = read("lat=-1&lon=36&scenario=p-0123456789abcdef0123").unwrap();
    assert!(sky.scenario.unwrap().is_plan());
    assert_eq!(refused("lat=-1&lon=36&scattering=multiple").0, Refusal::NotResident);
    assert_eq!(refused("lat=-1&lon=36&basis=128").0, Refusal::NotResident);
    for fine in ["clouds=none", "scattering=single", "terrain=on", "terrain=off", "basis=64"] {
        assert!(read(&format!("lat=-1&lon=36&{fine}")).is_ok(), "{fine}");
    }
}

/// Clouds are those that tables are resident for.
#[test]
fn clouds_are_those_that_are_resident() {
    let errors = read("lat=-1&lon=36&clouds=1500").unwrap_err().field_errors().to_vec();
    assert_eq!((errors[0].parameter.as_str(), errors[0].code), ("clouds", ValidationCode::NotResident));
    assert!(errors[0].allowed.contains("precompute --turbidity 2.5 --cloud-base 1500`"), "{errors:?}");
    let mut facts = facts();
    let under = |base_m, scattering, range| KindFacts {
        clouds: Some(Clouds::new(base_m, 0.5).unwrap()),
        ..kind(scattering, range, 32)
    };
    facts.kinds.push(under(1_000, Scattering::Multiple, (2.5, 2.5)));
    facts.kinds.push(under(2_000, Scattering::Single, (2.0, 3.0)));
    let read = |query: &str| {
        panorama(Some(&format!("lat=-1&lon=36{query}")), SceneId::parse("demo").unwrap(), &facts, Format::Png)
    };
    let (sky, view) = read("&clouds=2000&sky=total&turbidity=3").unwrap();
    assert_eq!((sky.cloud_base_m, sky.scattering), (Some(2_000), Scattering::Single));
    assert_eq!(view.options.sky, Sky::Total);
    assert_eq!(read("&clouds=2000").unwrap().1.options.sky, Sky::Artificial);
    // Maps know a closed layer too, in artificial light.
    let map = |query: &str| brightness(Some(query), SceneId::parse("demo").unwrap(), &facts);
    assert_eq!(map("clouds=2000&measure=horizontal").unwrap().cloud_base_m, Some(2_000));
    let errors = map("clouds=2000&sky=total").unwrap_err().field_errors().to_vec();
    assert_eq!(
        (errors.len(), errors[0].parameter.as_str(), errors[0].code),
        (1, "sky", ValidationCode::Conflict)
    );
    assert!(map("clouds=2000&cloud_cover=0.5").is_err());
    // The best resident is that of a clear sky, whatever comes after it.
    assert_eq!(read("").unwrap().0.scattering, Scattering::Single);
    for (query, allowed) in [
        (
            "&clouds=1500",
            "none, 1000, 2000; `skyglow precompute --turbidity 2.5 --cloud-base 1500` makes a pack for this base",
        ),
        ("&clouds=low", "none, or a whole number from 200 to 12000 m"),
        ("&clouds=100", "none, or a whole number from 200 to 12000 m"),
        ("&clouds=1000.5", "none, or a whole number from 200 to 12000 m"),
        ("&clouds=2000&scattering=multiple", "single"),
        ("&clouds=1000&turbidity=3", "2.5 to 2.5 with multiple scattering under clouds at 1000 m"),
    ] {
        let errors = read(query).unwrap_err().field_errors().to_vec();
        assert_eq!((errors.len(), errors[0].allowed.as_str()), (1, allowed), "{query}");
        let makes = errors[0].message.contains("--turbidity 3 --cloud-base 1000");
        assert_eq!(makes, query.ends_with("turbidity=3"), "{}", errors[0].message);
    }
}

/// Broken clouds need a layer, and packs for the sky between them.
#[test]
fn broken_clouds_need_a_layer_and_a_clear_sky() {
    let mut facts = facts();
    let under = |base_m, range| KindFacts {
        clouds: Some(Clouds::new(base_m, 0.5).unwrap()),
        ..kind(Scattering::Single, range, 32)
    };
    facts.kinds.push(under(1_000, (2.0, 9.0)));
    let read = |query: &str| {
        panorama(Some(&format!("lat=-1&lon=36{query}")), SceneId::parse("demo").unwrap(), &facts, Format::Png)
    };
    let broken = |query: &str| read(query).unwrap().0.broken_clouds;
    let with_clouds = |query: &str| broken(&format!("&clouds=1000{query}"));
    assert_eq!((with_clouds(""), with_clouds("&cloud_cover=1&cloud_pattern=2")), (None, None));
    assert_eq!(with_clouds("&cloud_cover=0.25"), BrokenClouds::new(0.25, None).ok());
    // A layer without a cloud is a clear sky.
    let clear = read("&clouds=1000&cloud_cover=0&cloud_pattern=7").unwrap().0;
    assert_eq!((clear.cloud_base_m, clear.broken_clouds), (None, None));
    assert_eq!(read("&clouds=1000&cloud_cover=0.5&sky=total").unwrap().1.options.sky, Sky::Total);
    for (query, parameter, code) in [
        ("&cloud_cover=0.5", "cloud_cover", ValidationCode::Conflict),
        ("&clouds=none&cloud_cover=0.5", "cloud_cover", ValidationCode::Conflict),
        ("&clouds=1000&cloud_pattern=1", "cloud_pattern", ValidationCode::Conflict),
        ("&clouds=1000&cloud_cover=1.5", "cloud_cover", ValidationCode::NotAllowed),
        ("&clouds=1000&cloud_cover=0.5&cloud_pattern=0", "cloud_pattern", ValidationCode::NotAllowed),
        ("&clouds=1000&cloud_cover=0.5&turbidity=8.5", "cloud_cover", ValidationCode::NotResident),
    ] {
        let errors = read(query).unwrap_err().field_errors().to_vec();
        assert_eq!(
            (errors.len(), errors[0].parameter.as_str(), errors[0].code),
            (1, parameter, code),
            "{query}"
        );
    }
}

/// The default scattering is the best resident and sets the ranges.
#[test]
fn the_default_scattering_is_the_best_resident() {
    let mut facts = facts();
    facts.kinds.push(kind(Scattering::Multiple, (2.0, 5.0), 32));
    let read = |query: &str| {
        panorama(Some(&format!("lat=-1&lon=36{query}")), SceneId::parse("demo").unwrap(), &facts, Format::Png)
    };
    let asked = |query: &str| read(query).unwrap().0.scattering;
    assert_eq!((asked(""), asked("&scattering=multiple")), (Scattering::Multiple, Scattering::Multiple));
    assert_eq!(asked("&scattering=single&turbidity=5.5&basis=64"), Scattering::Single);
    for (query, allowed) in [
        ("&turbidity=5.5", "2 to 5 with multiple scattering"),
        ("&scattering=single&turbidity=6.5", "1.5 to 6 with single scattering"),
        ("&basis=33", "a whole number from 1 to 32 with multiple scattering"),
    ] {
        assert_eq!(read(query).unwrap_err().field_errors()[0].allowed, allowed, "{query}");
    }
}

/// Scattering that is refused does not refuse what depends on it.
#[test]
fn refused_scattering_is_the_only_mistake() {
    for (scattering, code, allowed) in [
        ("multiple", ValidationCode::NotResident, "single"),
        ("double", ValidationCode::NotAllowed, "single, multiple"),
    ] {
        let query = format!("lat=-1&lon=36&scattering={scattering}&turbidity=9&basis=200");
        let errors = read(&query).unwrap_err().field_errors().to_vec();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!((errors[0].code, errors[0].allowed.as_str()), (code, allowed));
    }
}

/// A basis of any wrong size is refused with what is resident.
#[test]
fn a_wrong_basis_is_refused_with_the_range() {
    for (basis, code) in [
        ("0", ValidationCode::NotAllowed),
        ("-3", ValidationCode::NotAllowed),
        ("65", ValidationCode::NotResident),
        ("5000", ValidationCode::NotResident),
    ] {
        let errors = read(&format!("lat=-1&lon=36&basis={basis}")).unwrap_err().field_errors().to_vec();
        assert_eq!(errors[0].code, code, "{basis}");
        assert_eq!(errors[0].allowed, "a whole number from 1 to 64", "{basis}");
    }
    assert_eq!(refused("lat=-1&lon=36&basis=6.5").1, [("basis".to_owned(), ValidationCode::Malformed)]);
}

/// A tolerance out of range or beside a basis is refused by name.
#[test]
fn a_wrong_tolerance_is_refused_by_name() {
    let (sky, _) = read("lat=-1&lon=36&tolerance=0.05").unwrap();
    assert_eq!((sky.tolerance, sky.basis), (Some(0.05), None));
    assert_eq!(read("lat=-1&lon=36").unwrap().0.tolerance, None);
    for (query, code, allowed) in [
        ("tolerance=0", ValidationCode::NotAllowed, "0.0001 to 0.5"),
        ("tolerance=0.51", ValidationCode::NotAllowed, "0.0001 to 0.5"),
        ("tolerance=few", ValidationCode::Malformed, "0.0001 to 0.5"),
        ("tolerance=0.05&basis=8", ValidationCode::Conflict, "one of the two"),
    ] {
        let errors = read(&format!("lat=-1&lon=36&{query}")).unwrap_err().field_errors().to_vec();
        assert_eq!((errors.len(), errors[0].parameter.as_str()), (1, "tolerance"), "{query}");
        assert_eq!((errors[0].code, errors[0].allowed.as_str()), (code, allowed), "{query}");
    }
}

/// What means nothing for a format is refused there by name.
#[test]
fn what_a_format_does_not_use_is_refused() {
    let colours = [
        "style=realistic",
        "colormap=grey",
        "scale=magnitude",
        "min=16",
        "max=24",
        "exposure=1",
        "adaptation=0.01",
        "ground=dark",
        "dynamic_range=standard",
        "legend=off",
    ];
    let shape = ["projection=fisheye", "width=64", "height_px=64"];
    let refused = |parameter: &str, format: Format| {
        let errors = read_as(&format!("lat=-1&lon=36&{parameter}"), format).err()?.field_errors().to_vec();
        let named = parameter.split('=').next() == Some(errors[0].parameter.as_str());
        assert!(named && errors[0].message.contains(format.media_type()), "{errors:?}");
        assert!(errors[0].allowed.contains("turbidity"), "{errors:?}");
        Some(errors[0].code)
    };
    for format in [Format::Exr, Format::Tiff] {
        for parameter in colours {
            assert_eq!(refused(parameter, format), Some(ValidationCode::UnknownParameter), "{parameter}");
        }
        for parameter in shape {
            assert_eq!(refused(parameter, format), None, "{parameter}");
        }
    }
    for parameter in colours.iter().chain(&shape) {
        assert_eq!(refused(parameter, Format::Json), Some(ValidationCode::UnknownParameter), "{parameter}");
    }
    assert!(read_as("lat=-1&lon=36&sky=total&basis=8", Format::Json).is_ok());
    // The numbers of a sky tell artificial light from all of it: there is nothing to choose.
    let numbers = |query: &str| sky(Some(query), SceneId::parse("demo").unwrap(), &facts());
    assert!(numbers("lat=-1&lon=36&time=2026-08-20T23:16:00Z").is_ok());
    let error = numbers("lat=-1&lon=36&sky=artificial").unwrap_err();
    let [mistake] = error.field_errors() else { panic!("{error:?}") };
    assert_eq!((mistake.parameter.as_str(), mistake.code), ("sky", ValidationCode::UnknownParameter));
}

/// Ground in light is for the colours of eye and camera, and for terrain that counts.
#[test]
fn lit_ground_needs_colours_and_terrain() {
    for (query, expected) in [
        ("ground=lit", Some("style=realistic or style=eye")),
        ("ground=snow&style=false_colour", Some("style=realistic or style=eye")),
        ("ground=lit&style=eye&terrain=off", Some("terrain=on")),
        ("ground=dark&terrain=off", None),
        ("ground=lit&style=eye", None),
        ("ground=water&style=eye", None),
        ("ground=water", Some("style=realistic or style=eye")),
        ("ground=snow&style=realistic&terrain=on", None),
    ] {
        let errors = read(&format!("lat=-1&lon=36&{query}")).err().map(|error| error.field_errors().to_vec());
        let found = errors.as_ref().map(|errors| {
            assert_eq!((errors.len(), errors[0].parameter.as_str()), (1, "ground"), "{query}");
            assert_eq!(errors[0].code, ValidationCode::Conflict);
            errors[0].message.as_str()
        });
        assert_eq!(found.is_some(), expected.is_some(), "{query}");
        assert!(found.is_none_or(|found| found.contains(expected.unwrap())), "{query}: {found:?}");
    }
}

/// A high dynamic range is of a PNG in the colours of eye and camera.
#[test]
fn hdr_needs_colours_of_light_and_png() {
    let hdr = |query: &str, format| {
        let view = read_as(&format!("lat=-1&lon=36&dynamic_range=hdr{query}"), format);
        view.map(|(_, view)| view.options.dynamic_range).map_err(|error| error.field_errors().to_vec())
    };
    for style in ["&style=eye", "&style=realistic"] {
        assert_eq!(hdr(style, Format::Png).unwrap(), skyglow_display::DynamicRange::High);
        let errors = hdr(style, Format::WebP).unwrap_err();
        assert_eq!(errors[0].code, ValidationCode::UnknownParameter);
    }
    let errors = hdr("", Format::Png).unwrap_err();
    assert_eq!((errors.len(), errors[0].parameter.as_str()), (1, "dynamic_range"));
    assert_eq!(errors[0].code, ValidationCode::Conflict);
}

/// All mistakes of sky and picture come in one answer.
#[test]
fn all_mistakes_come_in_one_answer() {
    let (kind, errors) = refused("lon=400&turbidity=x&lamp=candle&style=pretty&fov=3&min=5&max=1&nonsense=1");
    assert_eq!(kind, Refusal::BadParameters);
    let names: Vec<&str> = errors.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["nonsense", "lat", "lon", "turbidity", "lamp", "fov", "style", "max"]);
}

#[test]
fn height_and_altitude_exclude_each_other() {
    let (_, errors) = refused("lat=-1&lon=36&height=2&altitude=1000");
    assert_eq!(errors, [("altitude".to_owned(), ValidationCode::Conflict)]);
}

#[test]
fn lamps_and_emissions_may_be_given_as_numbers() {
    let (sky, _) = read("lat=-1&lon=36&lamp=0.1,0.2,0.3&emission=1,1,2").unwrap();
    assert_eq!(sky.lamp, skyglow_physics::Lamp::custom([0.1, 0.2, 0.3]).unwrap());
    assert_eq!(sky.emission.mix().weights(), [0.25, 0.25, 0.5]);
    for bad in ["lamp=0,0,0", "lamp=1,2", "lamp=-1,1,1", "emission=0,0,0", "emission=a", "emission=1,2,-1"] {
        assert_eq!(refused(&format!("lat=-1&lon=36&{bad}")).0, Refusal::BadParameters, "{bad}");
    }
}
