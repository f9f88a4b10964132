//! The truth of the classes of places, every lobe apart, for the `class_accuracy` example.
//!
//! `class_truth OUT_DIR TURBIDITIES DIRECTIONS [CLASS...]`: one packed JSON file for a class, an observer and a turbidity; files
//! that are there are kept. TURBIDITIES such as `2.5,6`. The first order is the sum over every source by quadrature, later
//! orders come from fields solved for every altitude of sources, ten core-seconds each.

use skyglow_physics::{Turbidity, direct_sum::stratified_samples};
use skyglow_tests::{
    class_scenes::{Class, ClassScene},
    lobe_sum::{AskedSky, fields, truth},
    lobe_truth::file_name,
};
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, out, turbidities, directions, classes @ ..] = arguments.as_slice() else {
        return Err("usage: class_truth OUT_DIR TURBIDITIES DIRECTIONS [CLASS...]".into());
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
            if path.exists() {
                continue;
            }
            let sky = AskedSky {
                name: class.name(),
                place_deg: None,
                observer_altitude_m: *observer_altitude_m,
                sources,
                flux_dnb_w: sources.iter().map(|source| source.flux_dnb_w).sum(),
            };
            truth(&sky, turbidity, &samples, &mut kept)?.write(&path)?;
        }
    }
    Ok(())
}
