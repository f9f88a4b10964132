//! Reference solutions of the classes of places.

use crate::arguments::{List, Outcome};
use skyglow_lab::{
    class_scenes::{Class, ClassScene},
    lobe_reference::{LobeReference, file_name},
    lobe_sum::{ReferenceSky, fields, reference},
};
use skyglow_physics::{Turbidity, direct_sum::stratified_samples};
use std::path::PathBuf;

/// The reference solutions of the classes of places, every lobe apart, for `class-accuracy`: one packed JSON file for a
/// class, an observer and a turbidity. Files that are there stay. The first order is the sum over every source by
/// quadrature; later orders come from fields solved for every altitude of sources, ten core-seconds each.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder for the files.
    out: PathBuf,
    /// Turbidities, such as `2.5,6`.
    turbidities: List<f64>,
    /// Directions a sky.
    directions: usize,
    /// Solves the later orders of files that are there anew.
    #[arg(long)]
    later: bool,
    /// Classes; all of them if none are named.
    #[arg(value_parser = class)]
    classes: Vec<Class>,
}

fn class(name: &str) -> Result<Class, String> {
    Class::from_name(name)
        .ok_or_else(|| format!("the classes are {}", Class::ALL.map(Class::name).join(", ")))
}

pub(crate) fn run(Arguments { out, turbidities, directions, later, classes }: &Arguments) -> Outcome {
    std::fs::create_dir_all(out)?;
    let samples = stratified_samples(*directions);
    let classes = if classes.is_empty() { &Class::ALL } else { classes.as_slice() };
    let scenes: Vec<ClassScene> = classes.iter().copied().flat_map(Class::scenes).collect();
    for &turbidity in &turbidities.0 {
        let turbidity = Turbidity::new(turbidity)?;
        let mut solved = fields(turbidity);
        for ClassScene { class, observer_altitude_m, sources } in &scenes {
            let path = out.join(file_name(class.name(), *observer_altitude_m, turbidity.value()));
            if path.exists() && !*later {
                continue;
            }
            let before = path.exists().then(|| LobeReference::read(&path)).transpose()?;
            let sky = ReferenceSky {
                name: class.name(),
                place_deg: None,
                observer_altitude_m: *observer_altitude_m,
                sources,
                flux_dnb_w: sources.iter().map(|source| source.flux_dnb_w).sum(),
            };
            reference(&sky, turbidity, &samples, &mut solved, before)?.write(&path)?;
        }
    }
    Ok(())
}
