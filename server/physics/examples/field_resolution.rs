//! What the resolution of the fields of later orders costs: the same light solved finer in one respect at a time.
//!
//! `field_resolution TURBIDITY OBSERVER_M ALTITUDE,… VARIANT,…`: variants `table`, `layers2`, `layers3`, `rings2`, `degrees`,
//! `directions`, `orders`, `reference`; the last one is what the others are compared with. For every altitude of the source
//! and every variant the mean of |difference| and of the difference itself in % of the whole radiance, first order included,
//! by distance; over looks, bands and lobes.

use skyglow_physics::{
    Atmosphere, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting},
};
use std::{error::Error, time::Instant};

mod looks;
use looks::Pair;

fn resolution(variant: &str) -> Result<Resolution, String> {
    let table = Resolution::table();
    Ok(match variant {
        "table" => table,
        "layers2" => Resolution { layer_cuts: 2, ..table },
        "layers3" => Resolution { layer_cuts: 3, ..table },
        "rings2" => Resolution { ring_step: 0.1, ..table },
        "degrees" => Resolution { later_degree: 18, azimuths: 24, ..table },
        "directions" => Resolution { polar_per_hemisphere: 32, ..table },
        "orders" => Resolution { tolerance: 0.005, ..table },
        "reference" => Resolution::reference(),
        _ => return Err(format!("there is no variant {variant}")),
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, turbidity, observer_m, altitudes, variants] = arguments.as_slice() else {
        return Err("usage: field_resolution TURBIDITY OBSERVER_M ALTITUDE,… VARIANT,…".into());
    };
    let atmosphere = Atmosphere::new(Turbidity::new(turbidity.parse()?)?);
    let observer_altitude_m: f64 = observer_m.parse()?;
    for altitude in altitudes.split(',') {
        let altitude_m: f64 = altitude.parse()?;
        let setting =
            SourceSetting::for_observer(atmosphere, altitude_m, observer_altitude_m, DEFAULT_GROUND_ALBEDO)?;
        let pair = Pair { source_altitude_m: altitude_m, observer_altitude_m };
        let first = pair.first(&atmosphere)?;
        let mut solved = Vec::new();
        for variant in variants.split(',') {
            let start = Instant::now();
            let field = SourceField::solve(setting, &resolution(variant)?);
            let seconds = start.elapsed().as_secs_f64();
            let later = pair.later(&field)?;
            println!("# {altitude_m} m, {variant}: {:?} places, {seconds:.0} s", field.size());
            solved.push((variant, later));
        }
        let Some((last, finest)) = solved.pop() else { continue };
        for (variant, later) in solved {
            let parts = later.iter().zip(&finest).zip(&first).map(|((later, finest), first)| {
                let difference = |k: usize| (later[k] - finest[k]) / (finest[k] + first[k]).max(1e-30);
                let count = later.len() as f64;
                let mean = (0..later.len()).map(|k| difference(k).abs()).sum::<f64>() / count;
                let bias = (0..later.len()).map(difference).sum::<f64>() / count;
                format!("{:.2} ({:+.2})", 100.0 * mean, 100.0 * bias)
            });
            println!(
                "{altitude_m:6.0} m, {variant:10} beside {last}: {}",
                parts.collect::<Vec<_>>().join("  ")
            );
        }
    }
    Ok(())
}
