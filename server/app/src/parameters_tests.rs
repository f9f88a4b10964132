use super::*;
use proptest::{
    strategy::{Strategy, ValueTree},
    string::string_regex,
    test_runner::TestRunner,
};
use skyglow_display::Colormap;
use skyglow_physics::{CloudBase, LampPreset};
use skyglow_scene::{ChangeId, Cursor};
use skyglow_tables::Scattering;

/// The table names every colour map scattering and lamp that there is.
#[test]
fn the_table_names_every_choice_there_is() {
    let Kind::Choice(scatterings) = SCATTERING.kind else { panic!("not a choice") };
    assert_eq!(scatterings, Scattering::ALL.map(Scattering::name));
    let Kind::Choice(maps) = COLORMAP.kind else { panic!("not a choice") };
    assert_eq!(maps, Colormap::ALL.map(Colormap::name));
    for preset in LampPreset::ALL {
        assert!(LAMP.allowed().contains(preset.name()), "{preset:?}");
    }
}

/// Forms of texts are regular expressions that allow what is allowed.
#[test]
fn patterns_allow_what_is_allowed() {
    let mut runner = TestRunner::deterministic();
    let mut made_by = |parameter: Parameter| {
        let Kind::Text { pattern, .. } = parameter.kind else { panic!("{} is no text", parameter.name) };
        let form = string_regex(pattern.trim_matches(['^', '$'])).unwrap();
        (0..500).map(|_| form.new_tree(&mut runner).unwrap().current()).collect::<Vec<String>>()
    };
    assert!(made_by(SCENARIO).iter().all(|id| ChangeId::parse(id).is_ok()));
    assert!(made_by(AFTER).iter().all(|text| Cursor::parse(text).is_some()));
    assert!(made_by(CLOUDS).iter().all(|text| text == "none" || text.parse::<u32>().is_ok()));
    for parameter in [LAMP, RESPONSE, EMISSION] {
        let made = made_by(parameter);
        assert!(made.iter().any(|text| text == parameter.default), "{}: {made:?}", parameter.name);
    }
}

/// Defaults of the document are those of the code.
#[test]
fn documented_defaults_are_those_of_the_code() {
    let range = skyglow_display::ColourRange::default();
    assert!(MIN.description.contains("1e-5") && range.min == 1e-5);
    assert!(MAX.description.contains("0.1") && range.max == 0.1);
    assert_eq!(FOV.default.parse(), Ok(skyglow_display::options::DEFAULT_FOV_DEG));
    assert_eq!(ELEVATION.default.parse(), Ok(skyglow_display::options::DEFAULT_ELEVATION_DEG));
    assert_eq!(TURBIDITY.default.parse(), Ok(skyglow_physics::Turbidity::default().value()));
    let (lowest_m, highest_m) = (CloudBase::MIN_ALTITUDE_M, CloudBase::MAX_ALTITUDE_M);
    assert!(CLOUDS.allowed().contains(&format!("from {lowest_m} to {highest_m} m")));
}
