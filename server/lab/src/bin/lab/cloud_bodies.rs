//! `cloud-bodies`: what clouds add to a town's light, by the program's flat layer and by light traced through clouds as bodies.

use crate::arguments::{List, Outcome};
use clap::ValueEnum;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Band, BrokenClouds, CloudBase, Emission, EmissionMix, PhysicsError, Turbidity,
    multiple_scattering::{
        DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow,
        monte_carlo::{CloudField, CloudMatter, CloudTracer, Town},
    },
    single_source::{SourceGeometry, mixed_radiance_per_watt},
};
use std::{f64::consts::PI, time::Instant};

/// Azimuths of a half turn that means are taken over.
const AZIMUTHS: usize = 16;
/// Rings of lights, and lights a ring, that stand for a town around the observer.
const RINGS: usize = 96;

/// What clouds add to a town's light, mean over azimuths and patterns: the flat layer beside light traced through clouds as bodies.
///
/// A line for every cover, optical depth, distance and elevation: the clear sky, what light traced through clouds adds to it with its
/// standard error, and what the flat layer adds over that. Then the mean error by cover and by distance.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Distances of the light, km; 0 is the middle of a town.
    #[arg(long, default_value = "0,0.5,1,3,10,30")]
    distance_km: List<f64>,
    /// Radius of the town whose middle the distance 0 is, km.
    #[arg(long, default_value_t = 3.0)]
    town_radius_km: f64,
    /// Elevations looked at, degrees.
    #[arg(long, default_value = "90,60,30,15")]
    elevation_deg: List<f64>,
    /// Covers.
    #[arg(long, default_value = "0.25,0.5,0.75,1")]
    cover: List<f64>,
    /// Altitude of the base, metres.
    #[arg(long, default_value_t = 1_500)]
    base_m: u32,
    /// Thickness of the clouds, metres.
    #[arg(long, default_value = "300,600")]
    thickness_m: List<f64>,
    /// Optical depths of the clouds.
    #[arg(long, default_value = "10,20,30")]
    optical_depth: List<f64>,
    /// Flat lids of this albedo instead of bodies: what the formula for gaps has wrong by itself.
    #[arg(long)]
    lid: Option<f64>,
    /// Shapes of clouds.
    #[arg(long, value_enum, default_value_t = Shapes::Patterns)]
    shapes: Shapes,
    /// Size of a cell, metres.
    #[arg(long, default_value_t = 100.0)]
    cell_m: f64,
    /// Albedo of the flat layer that the program has tables of.
    #[arg(long, default_value_t = CloudBase::DEFAULT_ALBEDO)]
    albedo: f64,
    /// Turbidity.
    #[arg(long, default_value_t = 2.5)]
    turbidity: f64,
    /// Wavelength of the band, nm.
    #[arg(long, default_value_t = Band::MIDDLE.wavelength_nm())]
    band_nm: f64,
    /// Paths of an estimate.
    #[arg(long, default_value_t = 65_536)]
    paths: u64,
    /// Seed of the tracer.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shapes {
    /// Those of `cloud_pattern`.
    Patterns,
    /// Squares, each by itself.
    Squares,
}

/// Errors of what clouds add: their sum, that of their amounts, and how many.
#[derive(Clone, Copy, Default)]
struct Errors {
    sum: f64,
    amounts: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        self.sum += error;
        self.amounts += error.abs();
        self.count += 1.0;
    }

    /// Mean and mean amount, per cent.
    fn told(self) -> String {
        format!("{:+.1} ({:.1})", 100.0 * self.sum / self.count, 100.0 * self.amounts / self.count)
    }
}

/// Skies by the solver: clear and under the flat layer.
struct Solved {
    clear: SourceField,
    overcast: SourceField,
    band: Band,
    emission: EmissionMix,
}

impl Solved {
    fn new(arguments: &Arguments, band: Band) -> Result<Self, PhysicsError> {
        let base = CloudBase::new(f64::from(arguments.base_m), arguments.albedo)?;
        let air = Atmosphere::new(Turbidity::new(arguments.turbidity)?);
        let solve = |cloud: Option<CloudBase>| {
            let setting = SourceSetting::new(air.under(cloud), 0.0, 0.0, DEFAULT_GROUND_ALBEDO)?;
            Ok::<_, PhysicsError>(SourceField::solve(setting, &Resolution::table()))
        };
        let emission = Emission::default().mix();
        Ok(Self { clear: solve(None)?, overcast: solve(Some(base))?, band, emission })
    }

    /// A town's light at an elevation, clear and under the flat layer, by azimuth.
    fn skies(&self, town: &Town, elevation_rad: f64) -> Result<Vec<[f64; 2]>, PhysicsError> {
        let distances_m = town.distances_m(RINGS, 1);
        let rows = [
            (&self.clear, ViewRow::new(&self.clear, 0.0, elevation_rad)?),
            (&self.overcast, ViewRow::new(&self.overcast, 0.0, elevation_rad)?),
        ];
        let at = |azimuth: usize| {
            let azimuth_rad = PI * (azimuth as f64 + 0.5) / AZIMUTHS as f64;
            rows.each_ref().map(|(field, row)| {
                let of_light = |distance_m: &f64| {
                    let geometry = SourceGeometry {
                        distance_m: *distance_m,
                        source_altitude_m: 0.0,
                        observer_altitude_m: 0.0,
                    };
                    let air = [field.setting().atmosphere];
                    let (mix, band) = (self.emission, self.band.index());
                    let first: [f64; BAND_COUNT] =
                        mixed_radiance_per_watt(&air, &geometry, mix, azimuth_rad, elevation_rad, 1e-4);
                    let later = row.radiance_per_watt(*distance_m, azimuth_rad)[band];
                    first[band]
                        + later.iter().zip(mix.weights()).map(|(value, weight)| value * weight).sum::<f64>()
                };
                distances_m.iter().map(of_light).sum::<f64>() / distances_m.len() as f64
            })
        };
        let skies: Vec<[f64; 2]> = (0..AZIMUTHS).map(at).collect();
        if town.distance_m > 0.0 {
            return Ok(skies);
        }
        // A town around the observer is alike in every direction, which one light a ring is not.
        let mean = [0, 1].map(|which| skies.iter().map(|sky| sky[which]).sum::<f64>() / AZIMUTHS as f64);
        Ok(vec![mean; AZIMUTHS])
    }
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let band = Band::ALL
        .into_iter()
        .find(|band| band.wavelength_nm() == arguments.band_nm)
        .ok_or("no band has this wavelength")?;
    let started = Instant::now();
    let solved = Solved::new(arguments, band)?;
    println!("# both skies solved in {:.1} s", started.elapsed().as_secs_f64());
    println!(
        "| cover | thickness, m | optical depth | km | elevation | clear, 1/m² sr W | clouds add, over clear | its error, % | \
         flat layer adds, % too much | s |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    let (thicknesses_m, depths) = match arguments.lid {
        Some(_) => (&[0.0][..], &[0.0][..]),
        None => (&arguments.thickness_m.0[..], &arguments.optical_depth.0[..]),
    };
    let mut by_distance =
        vec![vec![Errors::default(); arguments.cover.0.len()]; arguments.distance_km.0.len()];
    for (distance_index, distance_km) in arguments.distance_km.0.iter().enumerate() {
        let radius_m = if *distance_km > 0.0 { 0.0 } else { 1e3 * arguments.town_radius_km };
        let town = Town { distance_m: 1e3 * distance_km, radius_m, emission: solved.emission };
        for elevation_deg in &arguments.elevation_deg.0 {
            let elevation_rad = elevation_deg.to_radians();
            let skies = solved.skies(&town, elevation_rad)?;
            let mean = |of: &dyn Fn(&[f64; 2]) -> f64| skies.iter().map(of).sum::<f64>() / skies.len() as f64;
            let clear = mean(&|sky| sky[0]);
            for (cover_index, cover) in arguments.cover.0.iter().enumerate() {
                let clouds = BrokenClouds::new(*cover, None)?;
                for (thickness_m, optical_depth) in thicknesses_m
                    .iter()
                    .flat_map(|thickness_m| depths.iter().map(move |tau| (*thickness_m, *tau)))
                {
                    let started = Instant::now();
                    let tracer = tracer(arguments, &solved, (*cover, thickness_m, optical_depth))?;
                    let traced = tracer.estimate(&town, elevation_rad, arguments.paths, arguments.seed);
                    let flat =
                        mean(&|[clear, overcast]| clouds.mean_radiance(*clear, *overcast, elevation_rad));
                    let added = traced.radiance_per_m2_sr - clear;
                    let error = (flat - clear) / added - 1.0;
                    by_distance[distance_index][cover_index].add(error);
                    println!(
                        "| {cover} | {thickness_m} | {optical_depth} | {distance_km} | {elevation_deg} | {clear:.3e} | {:.3} | {:.1} | {:+.1} | {:.1} |",
                        added / clear,
                        100.0 * traced.standard_error_per_m2_sr / added.abs(),
                        100.0 * error,
                        started.elapsed().as_secs_f64()
                    );
                }
            }
        }
    }
    let covers: Vec<String> = arguments.cover.0.iter().map(|cover| format!("cover {cover}")).collect();
    println!(
        "\nError of what clouds add, %: mean and, in brackets, mean amount.\n\n| km | {} |",
        covers.join(" | ")
    );
    println!("|---{}|", "|---".repeat(covers.len()));
    for (distance_km, errors) in arguments.distance_km.0.iter().zip(&by_distance) {
        let told: Vec<String> = errors.iter().map(|errors| errors.told()).collect();
        println!("| {distance_km} | {} |", told.join(" | "));
    }
    Ok(())
}

/// The tracer of a cover, thickness [m] and optical depth.
fn tracer(
    arguments: &Arguments,
    solved: &Solved,
    (cover, thickness_m, optical_depth): (f64, f64, f64),
) -> Result<CloudTracer, PhysicsError> {
    let drops = CloudMatter::Drops { thickness_m, optical_depth };
    let matter = arguments.lid.map_or(drops, |albedo| CloudMatter::Lid { albedo });
    let closed = CloudField::closed(f64::from(arguments.base_m), matter)?;
    let field = match arguments.shapes {
        _ if cover >= 1.0 => closed,
        Shapes::Patterns => closed.of_patterns(cover, arguments.cell_m)?,
        Shapes::Squares => closed.of_cells(cover, arguments.cell_m)?,
    };
    Ok(CloudTracer::new(*solved.clear.setting(), Some(field), solved.band, 0.0))
}
