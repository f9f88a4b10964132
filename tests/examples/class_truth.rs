//! The truth of the classes of places, every lobe apart, for the `class_accuracy` example.
//!
//! `class_truth OUT_DIR TURBIDITIES DIRECTIONS [later] [CLASS...]`: one packed JSON file for a class, an observer and a turbidity; files
//! that are there are kept, or with `later` their first order. TURBIDITIES such as `2.5,6`. The first order is the sum over every source by quadrature, later
//! orders come from fields solved for every altitude of sources, ten core-seconds each.

use skyglow_physics::{Turbidity, direct_sum::stratified_samples};
use skyglow_tests::{
    class_scenes::{Class, ClassScene},
    lobe_sum::{PreparedSky, fields, truth},
    lobe_truth::{LobeTruth, file_name},
};
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, out, turbidities, directions, rest @ ..] = arguments.as_slice() else {
        return Err("usage: class_truth OUT_DIR TURBIDITIES DIRECTIONS [later] [CLASS...]".into());
    };
    let (later, classes) = match rest {
        [first, classes @ ..] if first == "later" => (true, classes),
        classes => (false, classes),
    };
    let out = Path::new(out);
    std::fs::create_dir_all(out)?;
    let samples = stratified_samples(directions.parse()?);
    let named = |name: &String| Class::from_name(name).ok_or(format!("there is no class {name}"));
    let asked: Vec<Class> = if classes.is_empty() {
        Class::ALL.to_vec()
    } else {
        classes.iter().map(named).collect::<Result<_, _>>()?
    };
    let scenes: Vec<ClassScene> = asked.into_iter().flat_map(Class::scenes).collect();
    for turbidity in turbidities.split(',') {
        let turbidity = Turbidity::new(turbidity.parse()?)?;
        let mut kept = fields(turbidity);
        for ClassScene { class, observer_altitude_m, sources } in &scenes {
            let path = out.join(file_name(class.name(), *observer_altitude_m, turbidity.value()));
            if path.exists() && !later {
                continue;
            }
            let before = path.exists().then(|| LobeTruth::read(&path)).transpose()?;
            let sky = PreparedSky {
                name: class.name(),
                place_deg: None,
                observer_altitude_m: *observer_altitude_m,
                sources,
                flux_dnb_w: sources.iter().map(|source| source.flux_dnb_w).sum(),
            };
            truth(&sky, turbidity, &samples, &mut kept, before)?.write(&path)?;
        }
    }
    Ok(())
}
