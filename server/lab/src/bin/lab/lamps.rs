//! The lamps' colour, what the satellite sees of them, and the points of their Gauss rules (`docs/model.md#spectra`).

use crate::arguments::Outcome;
use skyglow_physics::spectrum::{Colour, LampPreset, Response};

/// A table of the lamps whose spectra are known: temperature, scotopic ratio, lumens per DNB watt, and the points of the Gauss rule of
/// each response.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run(_: &Arguments) -> Outcome {
    let names: Vec<&str> = Response::ALL.iter().map(|response| response.name()).collect();
    println!("| lamp | K | scotopic/photopic | lm per DNB watt | points of {} |", names.join(", "));
    println!("|---|---|---|---|---|");
    for lamp in LampPreset::ALL {
        let light = lamp.lamp();
        let light = light.light();
        let colour = Colour::of(light.spectrum()).ok_or("a lamp gives light")?;
        let points: Vec<String> =
            Response::ALL.iter().map(|response| light.rule(response).point_count().to_string()).collect();
        println!(
            "| `{}` | {} | {:.2} | {:.0} | {} |",
            lamp.name(),
            colour.temperature_k.map_or_else(|| "none".to_owned(), |temperature| format!("{temperature:.0}")),
            colour.scotopic_photopic_ratio,
            light.spectrum().lumens(),
            points.join(" ")
        );
    }
    Ok(())
}
