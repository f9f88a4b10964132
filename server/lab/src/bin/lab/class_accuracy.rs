//! Classes of places, and places, against their reference solutions.

use crate::arguments::Outcome;
use skyglow_lab::{
    class_errors::{class_grid, errors_of_sky, skies_of},
    lobe_reference::LobeReference,
    setup::engine_with,
    sky_errors::{SkyErrors, mixes},
};
use skyglow_physics::{BAND_COUNT, EmissionMix, GeoPoint};
use skyglow_render::Engine;
use skyglow_scene::{PolarGrid, SceneId, SceneStore};
use std::{
    collections::BTreeMap,
    error::Error,
    path::{Path, PathBuf},
};

/// What is wanted of the mean, the 99th percentile, the zenith and the horizontal illuminance, and their names.
const LIMITS: [(f64, &str); 4] = [(0.01, "mean"), (0.05, "99 %"), (0.005, "zenith"), (0.005, "horizontal")];

/// Whole skies of classes of places by the engine on the processor against their reference solutions: sampling,
/// interpolation and compression all count. For every class, and every mix of lobes in it, the worst over observers and
/// turbidities of the mean, the 99th percentile, the zenith and the horizontal illuminance, and which limit is missed. A
/// class is lit such that its zenith is as bright as the natural sky, places as their raster says.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of packs.
    packs: PathBuf,
    /// Folder of files of `class-reference` and `place-reference`.
    references: PathBuf,
    /// Basis functions.
    #[arg(long)]
    basis: Option<usize>,
    /// Folder of scenes, for places in them.
    #[arg(long)]
    data: Option<PathBuf>,
    /// How many of the worst directions of each sky are printed.
    #[arg(long, default_value_t = 0)]
    worst: usize,
    /// A line for each sky too.
    #[arg(long)]
    every: bool,
}

pub(crate) fn run(options: &Arguments) -> Outcome {
    let engine = engine_with(&options.packs)?;
    println!("# all in %: mean, 99 %, zenith, horizontal illuminance; limits 1, 5, 0.5, 0.5");
    let mut worst: BTreeMap<(String, &str), SkyErrors> = BTreeMap::new();
    for path in LobeReference::files_in(&options.references)? {
        let reference = LobeReference::read(&path)?;
        let polar = polar_grid(&reference, options.data.as_deref())?;
        for (mix, emission) in mixes() {
            let errors = errors_of_sky(&engine, &reference, &polar, emission, options.basis)?;
            if options.every {
                let sky = format!(
                    "{} {:.0} m T {:.2}",
                    reference.name, reference.observer_altitude_m, reference.turbidity
                );
                print_line(&sky, mix, errors);
            }
            if options.worst > 0 {
                print_directions(&engine, &reference, &polar, emission, options)?;
            }
            let most = worst.entry((reference.name.clone(), mix)).or_default();
            most.iter_mut().zip(errors).for_each(|(most, error)| *most = larger(*most, error));
        }
    }
    println!("# the worst over observers and turbidities");
    let mut classes: BTreeMap<&str, SkyErrors> = BTreeMap::new();
    for ((name, mix), errors) in &worst {
        print_line(name, mix, *errors);
        let most = classes.entry(name).or_default();
        most.iter_mut().zip(errors).for_each(|(most, error)| *most = larger(*most, *error));
    }
    println!("# the worst over mixes too");
    for (name, errors) in classes {
        print_line(name, "all", errors);
    }
    Ok(())
}

/// The directions of a sky that are most off.
fn print_directions(
    engine: &Engine,
    reference: &LobeReference,
    polar: &PolarGrid,
    emission: EmissionMix,
    options: &Arguments,
) -> Result<(), Box<dyn Error>> {
    let [fast, exact] = skies_of(engine, reference, polar, emission, options.basis)?;
    let errors = fast.iter().zip(&exact).map(|(fast, exact)| {
        let errors: [f64; BAND_COUNT] = std::array::from_fn(|band| 100.0 * (fast[band] / exact[band] - 1.0));
        errors
    });
    let mut directions: Vec<_> = reference.samples.iter().zip(errors).collect();
    let most = |errors: &[f64; BAND_COUNT]| errors.iter().fold(0f64, |most, error| most.max(error.abs()));
    directions.sort_by(|a, b| most(&b.1).total_cmp(&most(&a.1)));
    for (&(row, column), errors) in directions.into_iter().take(options.worst) {
        println!(
            "    row {row:2}, column {column:3}: {}",
            errors.map(|error| format!("{error:+.2}")).join(", ")
        );
    }
    Ok(())
}

/// The one farther from 0.
fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

fn print_line(name: &str, mix: &str, errors: SkyErrors) {
    let missed: Vec<&str> = LIMITS
        .iter()
        .zip(errors)
        .filter(|((limit, _), error)| error.abs() > *limit)
        .map(|((_, name), _)| *name)
        .collect();
    let [mean, p99, zenith, horizontal] = errors.map(|error| 100.0 * error);
    println!("{name:36} {mix:9} {mean:7.3} {p99:8.3} {zenith:+8.3} {horizontal:+8.3}  {}", missed.join(", "));
}

/// The light that the engine gets.
fn polar_grid(reference: &LobeReference, data: Option<&Path>) -> Result<PolarGrid, Box<dyn Error>> {
    let grid = match reference.place_deg {
        Some([latitude_deg, longitude_deg]) => {
            let data = data.ok_or("a reference of a place in a scene: --data is missing")?;
            let scene = SceneStore::new(data).open(&SceneId::parse(&reference.name)?)?;
            scene.polar_grid(GeoPoint::from_deg(latitude_deg, longitude_deg)?, false)
        }
        None => class_grid(reference)?,
    };
    if (grid.flux_dnb_w / reference.flux_dnb_w - 1.0).abs() > 1e-3 {
        return Err(format!(
            "{}: {} DNB watts, the reference has {}",
            reference.name, grid.flux_dnb_w, reference.flux_dnb_w
        )
        .into());
    }
    Ok(grid)
}
