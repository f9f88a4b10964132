//! What the resolution of the solver costs.

use crate::arguments::{List, Outcome, turbidity};
use skyglow_physics::{
    Atmosphere, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting},
    panorama::{azimuth_rad, elevation_rad},
    single_source::{RadiancePerWatt, SourceGeometry, radiance_per_watt_of},
};
use std::{error::Error, time::Instant};

/// Distances of the sources; rows and columns of the directions.
const DISTANCE_M: [f64; 6] = [1_000.0, 4_000.0, 15_000.0, 50_000.0, 100_000.0, 200_000.0];
const ROWS: [usize; 5] = [0, 3, 9, 25, 63];
const COLUMNS: [usize; 5] = [0, 5, 28, 70, 120];

/// A source and an observer at some altitudes, metres.
#[derive(Clone, Copy)]
struct Pair {
    source_altitude_m: f64,
    observer_altitude_m: f64,
}

impl Pair {
    /// First order, m⁻² sr⁻¹ per watt, `[distance][look × band × lobe]`.
    fn first(self, atmosphere: &Atmosphere) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        self.looks(|geometry, azimuth_rad, elevation_rad| {
            Ok(radiance_per_watt_of(atmosphere, geometry, azimuth_rad, elevation_rad, 1e-5))
        })
    }

    /// The later orders of a field, as [`Self::first`].
    fn later(self, field: &SourceField) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        self.looks(|geometry, azimuth_rad, elevation_rad| {
            Ok(field.radiance_per_watt(geometry, azimuth_rad, elevation_rad)?)
        })
    }

    fn looks(
        self,
        value: impl Fn(&SourceGeometry, f64, f64) -> Result<RadiancePerWatt, Box<dyn Error>>,
    ) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        let Self { source_altitude_m, observer_altitude_m } = self;
        let at = |distance_m| {
            let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
            let mut values = Vec::new();
            for (row, column) in ROWS.into_iter().flat_map(|row| COLUMNS.map(|column| (row, column))) {
                values.extend(value(&geometry, azimuth_rad(column), elevation_rad(row))?.as_flattened());
            }
            Ok(values)
        };
        DISTANCE_M.into_iter().map(at).collect()
    }
}

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

/// What the resolution of the fields of later orders costs: the same light solved finer in one respect at a time. For
/// every altitude of the source and every variant the mean of |difference| and of the difference itself in % of the whole
/// radiance, first order included, by distance; over looks, bands and lobes.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// Altitude of the observer, metres.
    observer_m: f64,
    /// Altitudes of the source, metres.
    altitudes: List<f64>,
    /// Of `table`, `layers2`, `layers3`, `rings2`, `degrees`, `directions`, `orders` and `reference`; the last one given is
    /// what the others are compared with.
    variants: List<String>,
}

pub(crate) fn run(Arguments { turbidity, observer_m, altitudes, variants }: &Arguments) -> Outcome {
    let atmosphere = Atmosphere::new(*turbidity);
    let observer_altitude_m = *observer_m;
    for &altitude_m in &altitudes.0 {
        let setting =
            SourceSetting::for_observer(atmosphere, altitude_m, observer_altitude_m, DEFAULT_GROUND_ALBEDO)?;
        let pair = Pair { source_altitude_m: altitude_m, observer_altitude_m };
        let first = pair.first(&atmosphere)?;
        let mut solved = Vec::new();
        for variant in &variants.0 {
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
