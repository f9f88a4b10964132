//! The solver of the later orders against light traced by Monte Carlo.

mod statistics;

use crate::arguments::{List, Outcome};
use clap::ValueEnum;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Band, CloudBase, LOBE_COUNT, Lobe, PhysicsError, Turbidity,
    multiple_scattering::{
        DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow,
        monte_carlo::{Detector, Estimate, ForwardTracer, Tracer},
    },
    single_source::{RadiancePerWatt, SourceGeometry, radiance_per_watt_of},
};
use statistics::Groups;
use std::{error::Error, time::Instant};

/// Multiple scattering by the solver beside light traced backward or forward.
///
/// A line a direction: the first order, the total by both, the solver's relative error of the total and the standard error
/// of the Monte Carlo total (first order by quadrature in both). Then the statistics by lobe and distance, by lobe and
/// band, and by lobe, and the same with what the Monte Carlo's own noise explains taken off: mean |e| and 99th percentile
/// of max(|e| − 2σ, 0).
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidities.
    #[arg(long, default_value = "2,4")]
    turbidity: List<f64>,
    /// Distances of the source, km.
    #[arg(long, default_value = "1,2,5,10,20,50")]
    distance_km: List<f64>,
    /// Bands by their wavelengths, nm; all where none is named.
    #[arg(long)]
    band: Option<List<String>>,
    /// Lobes of lambert, horizon and oblique.
    #[arg(long, default_value = "lambert")]
    lobe: List<String>,
    /// Directions looked at.
    #[arg(long, value_enum, default_value_t = Directions::Ten)]
    directions: Directions,
    /// Paths a direction, or a run of the forward tracer.
    #[arg(long, default_value_t = 65_536)]
    paths: u64,
    /// Resolution of the solver.
    #[arg(long, value_enum, default_value_t = Named::Table)]
    resolution: Named,
    /// A field of the resolution and its value, such as `ring_step=0.1`.
    #[arg(long)]
    set: Vec<String>,
    /// Altitude of the source, metres.
    #[arg(long, default_value_t = 0.0)]
    source_m: f64,
    /// Altitude of the observer, metres.
    #[arg(long, default_value_t = 0.0)]
    observer_m: f64,
    /// With the forward tracer a disc instead of a point; first order and solver are means over its points.
    #[arg(long, default_value_t = 0.0)]
    lamp_radius_m: f64,
    /// Albedo of the ground.
    #[arg(long, default_value_t = DEFAULT_GROUND_ALBEDO)]
    albedo: f64,
    /// Altitude of a cloud base, metres; a clear sky if left out.
    #[arg(long)]
    cloud_base_m: Option<f64>,
    /// Albedo of the cloud.
    #[arg(long, default_value_t = CloudBase::DEFAULT_ALBEDO)]
    cloud_albedo: f64,
    /// Seed of the tracer.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Looks by single rays instead of rows.
    #[arg(long)]
    rays: bool,
    /// Tells the tracer's orders apart.
    #[arg(long)]
    orders: bool,
    /// What the solver is compared with.
    #[arg(long, value_enum, default_value_t = Judge::MonteCarlo)]
    judge: Judge,
    /// Tells how long a row and a ray take.
    #[arg(long)]
    speed: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Directions {
    Ten,
    Mitsuba,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Named {
    Table,
    Reference,
    Coarse,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Judge {
    /// Light traced backward from the observer.
    MonteCarlo,
    /// Light traced forward from the lamp.
    Forward,
    /// The finest field: how far the solver has converged, without noise.
    Reference,
}

/// (azimuth from the source, elevation), degrees.
const TEN: [(f64, f64); 12] = [
    (0.0, 90.0),
    (0.0, 60.0),
    (0.0, 30.0),
    (0.0, 10.0),
    (45.0, 45.0),
    (45.0, 8.0),
    (90.0, 30.0),
    (90.0, 10.0),
    (135.0, 60.0),
    (135.0, 5.0),
    (180.0, 30.0),
    (180.0, 10.0),
];
/// Those of the comparison with Mitsuba.
const MITSUBA: [(f64, f64); 10] = [
    (0.0, 90.0),
    (0.0, 60.0),
    (90.0, 60.0),
    (180.0, 60.0),
    (0.0, 30.0),
    (90.0, 30.0),
    (180.0, 30.0),
    (0.0, 10.0),
    (90.0, 10.0),
    (180.0, 10.0),
];

/// Rings and points a ring for means over a disc.
const DISC_POINTS: (usize, usize) = (6, 12);

/// Points of a disc of light that stand for equal shares of it, as the observer has them: distance [m], and how far their
/// azimuth lies beside that of the disc's centre [rad]. The centre alone for radius 0.
fn disc_points(radius_m: f64, distance_m: f64) -> Vec<(f64, f64)> {
    if radius_m <= 0.0 {
        return vec![(distance_m, 0.0)];
    }
    let (rings, around) = DISC_POINTS;
    let point = |i: usize| {
        let from_centre_m = radius_m * (((i / around) as f64 + 0.5) / rings as f64).sqrt();
        let (sine, cosine) = (((i % around) as f64 + 0.5) / around as f64 * std::f64::consts::TAU).sin_cos();
        let (along_m, across_m) = (distance_m - from_centre_m * cosine, from_centre_m * sine);
        (along_m.hypot(across_m), across_m.atan2(along_m))
    };
    (0..rings * around).map(point).collect()
}

/// The items of those names.
/// Its wavelength, nm.
fn name_of(band: Band) -> String {
    band.wavelength_nm().to_string()
}

fn named<T: Copy>(names: &List<String>, all: &[T], name_of: impl Fn(T) -> String) -> Result<Vec<T>, String> {
    let find = |name: &String| all.iter().copied().find(|item| name_of(*item) == *name);
    names.0.iter().map(|name| find(name).ok_or_else(|| format!("{name} is unknown"))).collect()
}

fn resolution(arguments: &Arguments) -> Result<Resolution, Box<dyn Error>> {
    let mut resolution = match arguments.resolution {
        Named::Table => Resolution::table(),
        Named::Reference => Resolution::reference(),
        Named::Coarse => Resolution::coarse(),
    };
    for text in &arguments.set {
        let (name, value) = text.split_once('=').ok_or("expected FIELD=VALUE")?;
        let count = match name {
            "ring_step" => {
                resolution.ring_step = value.parse()?;
                continue;
            }
            "tolerance" => {
                resolution.tolerance = value.parse()?;
                continue;
            }
            "layer_cuts" => &mut resolution.layer_cuts,
            "first_degree" => &mut resolution.first_degree,
            "later_degree" => &mut resolution.later_degree,
            "first_polar" => &mut resolution.first_polar,
            "first_around" => &mut resolution.first_around,
            "first_along" => &mut resolution.first_along,
            "polar_per_hemisphere" => &mut resolution.polar_per_hemisphere,
            "azimuths" => &mut resolution.azimuths,
            "max_orders" => &mut resolution.max_orders,
            _ => return Err(format!("a resolution has no {name}").into()),
        };
        *count = value.parse()?;
    }
    Ok(resolution)
}

/// What is computed of one turbidity.
struct Setup<'a> {
    arguments: &'a Arguments,
    turbidity: f64,
    setting: SourceSetting,
    field: SourceField,
    finest: Option<SourceField>,
    bands: Vec<Band>,
    lobes: Vec<Lobe>,
    directions: &'static [(f64, f64)],
}

/// Errors by distance, all bands together; by band and by lobe alone, all distances together, of which those beyond 50 km
/// are told apart.
#[derive(Default)]
struct Told {
    by_distance: Groups,
    by_band: Groups,
    by_lobe: Groups,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let resolution = resolution(arguments)?;
    let cloud = arguments
        .cloud_base_m
        .map(|base_m| CloudBase::lambertian(base_m, arguments.cloud_albedo))
        .transpose()?;
    let mut told = Told::default();
    for &turbidity in &arguments.turbidity.0 {
        let atmosphere = Atmosphere::new(Turbidity::new(turbidity)?).under(cloud);
        let setting = SourceSetting::for_observer(
            atmosphere,
            arguments.source_m,
            arguments.observer_m,
            arguments.albedo,
        )?;
        let started = Instant::now();
        let field = SourceField::solve(setting, &resolution);
        let solve_s = started.elapsed().as_secs_f64();
        let finest = (arguments.judge == Judge::Reference)
            .then(|| SourceField::solve(setting, &Resolution::reference()));
        println!(
            "# T {turbidity}: grid {:?}, solved in {:.2} s, largest shares of orders 2, 3, …: {:.4?}",
            field.size(),
            solve_s,
            field.changes()
        );
        for power in field.powers() {
            println!(
                "#   order {:2}: sent {:.5} W, imbalance {:+.4} (G, lambert); all outputs within {:.4}",
                power.order,
                power.sent_w()[1][0],
                power.imbalance()[1][0],
                power.imbalance().iter().flatten().fold(0.0f64, |a, b| a.max(b.abs()))
            );
        }
        if arguments.speed {
            report_speed(&field, arguments.observer_m)?;
        }
        let setup = Setup {
            arguments,
            turbidity,
            setting,
            field,
            finest,
            bands: arguments
                .band
                .as_ref()
                .map_or(Ok(Band::ALL.to_vec()), |bands| named(bands, &Band::ALL, name_of))?,
            lobes: named(&arguments.lobe, &Lobe::ALL, |lobe| lobe.name().to_owned())?,
            directions: match arguments.directions {
                Directions::Ten => &TEN,
                Directions::Mitsuba => &MITSUBA,
            },
        };
        setup.compare(&atmosphere, &mut told)?;
    }
    for groups in [&told.by_distance, &told.by_band, &told.by_lobe] {
        println!();
        groups.print();
    }
    Ok(())
}

impl Setup<'_> {
    /// A source so far away.
    fn geometry(&self, distance_km: f64) -> SourceGeometry {
        SourceGeometry {
            distance_m: distance_km * 1e3,
            source_altitude_m: self.arguments.source_m,
            observer_altitude_m: self.arguments.observer_m,
        }
    }

    /// One forward run a band serves all distances and directions, `[band][distance × direction]`; none for other tracers.
    fn forward(&self) -> Vec<Vec<Estimate>> {
        if self.arguments.judge != Judge::Forward {
            return Vec::new();
        }
        let looks =
            |&km: &f64| self.directions.iter().map(move |&(azimuth, elevation)| (km, azimuth, elevation));
        let detectors: Vec<Detector> = (self.arguments.distance_km.0.iter().flat_map(looks))
            .map(|(distance_km, azimuth_deg, elevation_deg)| Detector {
                geometry: self.geometry(distance_km),
                relative_azimuth_rad: azimuth_deg.to_radians(),
                elevation_rad: elevation_deg.to_radians(),
            })
            .collect();
        let trace = |band: &Band| {
            let tracer =
                ForwardTracer::new(self.setting, *band).with_lamp_radius_m(self.arguments.lamp_radius_m);
            tracer.estimate(&detectors, self.arguments.paths, self.arguments.seed)
        };
        self.bands.iter().map(trace).collect()
    }

    /// First order and later orders by the solver, means over the lamp's disc.
    fn solved(
        &self,
        atmosphere: &Atmosphere,
        geometry: &SourceGeometry,
        azimuth: f64,
        elevation: f64,
    ) -> Result<[RadiancePerWatt; 2], PhysicsError> {
        let row = ViewRow::new(&self.field, self.arguments.observer_m, elevation)?;
        let mut sums = [[[0.0; LOBE_COUNT]; BAND_COUNT]; 2];
        let points = disc_points(self.arguments.lamp_radius_m, geometry.distance_m);
        for &(distance_m, beside_rad) in &points {
            let (geometry, azimuth) = (SourceGeometry { distance_m, ..*geometry }, azimuth + beside_rad);
            let first = radiance_per_watt_of(atmosphere, &geometry, azimuth, elevation, 1e-6);
            let later = if self.arguments.rays {
                self.field.radiance_per_watt(&geometry, azimuth, elevation)?
            } else {
                row.radiance_per_watt(distance_m, azimuth)
            };
            for (sum, values) in sums.iter_mut().zip([first, later]) {
                for (sum, value) in sum.as_flattened_mut().iter_mut().zip(values.as_flattened()) {
                    *sum += value / points.len() as f64;
                }
            }
        }
        Ok(sums)
    }

    /// A line for every distance, band, direction and lobe.
    fn compare(&self, atmosphere: &Atmosphere, told: &mut Told) -> Outcome {
        let Arguments { paths, seed, .. } = self.arguments;
        let caught = self.forward();
        println!("# T  km  band lobe  az  el  first  total(solver)  total(MC)  MC/first  error%  noise%");
        for (distance_index, &distance_km) in self.arguments.distance_km.0.iter().enumerate() {
            let geometry = self.geometry(distance_km);
            for (band_index, band) in self.bands.iter().enumerate() {
                let tracer = Tracer::new(self.setting, *band, &geometry);
                for (direction_index, &(azimuth_deg, elevation_deg)) in self.directions.iter().enumerate() {
                    let (azimuth, elevation) = (f64::to_radians(azimuth_deg), f64::to_radians(elevation_deg));
                    let [first, later] = self.solved(atmosphere, &geometry, azimuth, elevation)?;
                    let traced = match self.arguments.judge {
                        Judge::Reference => None,
                        Judge::Forward => {
                            Some(caught[band_index][distance_index * self.directions.len() + direction_index])
                        }
                        Judge::MonteCarlo => Some(tracer.estimate(azimuth, elevation, *paths, *seed)),
                    };
                    let finest = match &self.finest {
                        None => None,
                        Some(finest) => Some(finest.radiance_per_watt(&geometry, azimuth, elevation)?),
                    };
                    for lobe in &self.lobes {
                        let (b, f) = (band.index(), lobe.index());
                        let (true_later, true_error) = match (&traced, &finest) {
                            (Some(traced), _) => {
                                (traced.radiance_per_m2_sr[f], traced.standard_error_per_m2_sr[f])
                            }
                            (None, Some(finest)) => (finest[b][f], 0.0),
                            (None, None) => (f64::NAN, 0.0),
                        };
                        let (total, solved) = (first[b][f] + true_later, first[b][f] + later[b][f]);
                        let (error, noise) = (solved / total - 1.0, true_error / total);
                        println!(
                            "{:3} {distance_km:5} {} {:8} {azimuth_deg:4} {elevation_deg:3}  {:.4e}  {solved:.4e}  {total:.4e}  {:8.3}  {:+7.2}  {:6.2}",
                            self.turbidity,
                            name_of(*band),
                            lobe.name(),
                            first[b][f],
                            total / first[b][f],
                            100.0 * error,
                            100.0 * noise
                        );
                        if let (true, Some(traced)) = (self.arguments.orders, &traced) {
                            report_orders(traced, f, first[b][f]);
                        }
                        let turbidity = self.turbidity;
                        let (name, reach) =
                            (lobe.name(), if distance_km > 50.0 { "far" } else { "to 50 km" });
                        told.by_distance.add(
                            format!("T {turbidity}, {name}, {distance_km} km"),
                            error,
                            noise,
                        );
                        told.by_band.add(
                            format!("T {turbidity}, {name}, {} nm, {reach}", name_of(*band)),
                            error,
                            noise,
                        );
                        told.by_lobe.add(format!("T {turbidity}, {name}, {reach}"), error, noise);
                    }
                }
            }
        }
        Ok(())
    }
}

/// The tracer's orders of one lobe, and its first beside that by quadrature.
fn report_orders(traced: &Estimate, lobe: usize, first: f64) {
    println!(
        "#   first order of the tracer: {:+.2} %",
        100.0 * (traced.by_order_per_m2_sr[0][lobe] / first - 1.0)
    );
    let orders: Vec<String> =
        traced.by_order_per_m2_sr.iter().map(|order| format!("{:.3e}", order[lobe])).collect();
    println!("#   orders 1, 2, …: {}", orders.join(" "));
}

/// Times rows and rays.
fn report_speed(field: &SourceField, observer_altitude_m: f64) -> Result<(), Box<dyn Error>> {
    let (rows, rays) = (16, 4_000);
    let (mut row_s, mut ray_s, mut sum) = (0.0, 0.0, 0.0);
    for row in 0..rows {
        let elevation = (f64::from(row) + 0.5) / f64::from(rows) * std::f64::consts::FRAC_PI_2;
        let started = Instant::now();
        let row = ViewRow::new(field, observer_altitude_m, elevation)?;
        row_s += started.elapsed().as_secs_f64();
        let started = Instant::now();
        for ray in 0..rays {
            let share = f64::from(ray) / f64::from(rays);
            sum += row.radiance_per_watt(250.0 * 1_200f64.powf(share), 37.0 * share)[1][0];
        }
        ray_s += started.elapsed().as_secs_f64();
    }
    println!(
        "#   a row takes {:.2} ms, a ray {:.2} microseconds (sum {sum:.3e})",
        1e3 * row_s / f64::from(rows),
        1e6 * ray_s / f64::from(rows * rays)
    );
    Ok(())
}
