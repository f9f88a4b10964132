//! The lamps' colour, what the satellite sees of them, and the points of their Gauss rules (`docs/model.md#spectra`).

use crate::arguments::Outcome;
use skyglow_physics::spectrum::{Colour, LampSpectrum, Response, SpectralRule};

/// A table of the lamps whose spectra are known: temperature, scotopic ratio, lumens per DNB watt, and the points of the Gauss rule of
/// each response.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run(_: &Arguments) -> Outcome {
    let names: Vec<&str> = Response::ALL.iter().map(|response| response.name()).collect();
    println!("| lamp | K | scotopic/photopic | lm per DNB watt | points of {} |", names.join(", "));
    println!("|---|---|---|---|---|");
    for lamp in LampSpectrum::ALL {
        let spectrum = lamp.spectrum();
        let colour = Colour::of(&spectrum).ok_or("a lamp gives light")?;
        let watt = spectrum.per_dnb_watt(0.0).ok_or("the satellite sees every lamp")?;
        let points: Vec<String> = Response::ALL
            .iter()
            .map(|response| SpectralRule::new(&watt, &response.curve()).point_count().to_string())
            .collect();
        println!(
            "| `{}` | {} | {:.2} | {:.0} | {} |",
            lamp.name(),
            colour.temperature_k.map_or_else(|| "none".to_owned(), |temperature| format!("{temperature:.0}")),
            colour.scotopic_photopic_ratio,
            watt.lumens(),
            points.join(" ")
        );
    }
    Ok(())
}
