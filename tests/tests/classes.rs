//! Whole skies of classes of places from the packs that come with the program, against stored reference with each lobe apart
//! (`lab class-reference`): the sum over every source, all orders of scattering.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

use skyglow_lab::{
    class_errors::{class_grid, errors_of_sky},
    class_scenes::Class,
    lobe_reference::LobeReference,
    setup::engine_with,
    sky_errors::{SkyErrors, mixes},
};
use skyglow_physics::EmissionMix;
use skyglow_tests::tree;

/// Those with a stored reference.
const TURBIDITIES: [f64; 5] = [1.75, 2.0, 2.5, 4.0, 6.0];

/// Those in which nothing is missed, between packs and at two.
const WITHIN: [f64; 4] = [1.75, 2.0, 2.5, 3.0];

/// Largest mean, 99th percentile, zenith and horizontal illuminance of a class with a mix of lobes. Wanted are 1, 5, 0.5 and
/// 0.5 %; wider ones are of what `docs/accuracy.md` says is missed.
fn limits(class: Class, mix: &str, turbidity: f64) -> SkyErrors {
    let [mean, p99, zenith, horizontal] = match (class, mix) {
        _ if WITHIN.contains(&turbidity) => [1.0, 5.0, 0.5, 0.5],
        // 0.50 at the tables' altitudes; shapes between steps of altitude add 0.03.
        (Class::AbovePlain, "horizon") => [1.0, 5.0, 0.54, 0.5],
        (Class::Valley, "oblique") => [1.0, 5.1, 0.5, 0.5],
        _ => [1.0, 5.0, 0.5, 0.5],
    };
    [0.01 * mean, 0.01 * p99, 0.01 * zenith, 0.01 * horizontal]
}

/// Skies of every class are those of the stored reference solutions.
#[test]
fn class_skies_match_the_stored_reference() {
    let engine = engine_with(&tree::root().join("precomputed")).unwrap();
    let files = LobeReference::files_in(&tree::root().join("tests/reference/classes")).unwrap();
    let mut seen = Vec::new();
    let mut missed = Vec::new();
    for file in files {
        let reference = LobeReference::read(&file).unwrap();
        let class = Class::from_name(&reference.name).unwrap();
        let grid = class_grid(&reference).unwrap();
        assert!(
            (grid.flux_dnb_w / reference.flux_dnb_w - 1.0).abs() < 1e-3,
            "{}: the class has changed; make the reference anew",
            file.display()
        );
        let errors = |emission, basis| errors_of_sky(&engine, &reference, &grid, emission, basis).unwrap();
        let sky =
            format!("{} {:.0} m, T {}", reference.name, reference.observer_altitude_m, reference.turbidity);
        for (mix, emission) in mixes() {
            let found = errors(emission, None);
            let [mean, p99, zenith, horizontal] = found.map(|error| 100.0 * error);
            println!("{sky:38} {mix:9} {mean:6.2} {p99:7.2} {zenith:+6.2} {horizontal:+6.2}");
            let limits = limits(class, mix, reference.turbidity);
            if found.iter().zip(limits).any(|(error, limit)| error.abs() > limit) {
                missed.push(format!("{sky}, {mix}: {found:?}, at most {limits:?}"));
            }
        }
        // The check can fail: an eighth of the functions is too few.
        assert!(
            errors(EmissionMix::garstang(), Some(8))[0] > limits(class, "garstang", reference.turbidity)[0],
            "{sky}"
        );
        seen.push((reference.name, reference.observer_altitude_m, reference.turbidity));
    }
    assert!(missed.is_empty(), "{missed:#?}");
    for scene in Class::ALL.into_iter().flat_map(Class::scenes) {
        for turbidity in TURBIDITIES {
            let sky = (scene.class.name().to_owned(), scene.observer_altitude_m, turbidity);
            assert!(seen.contains(&sky), "there is no reference of {sky:?}");
        }
    }
}
