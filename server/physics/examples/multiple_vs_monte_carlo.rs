//! Multiple scattering by the solver beside light traced backward or forward.
//!
//! cargo run --release -p skyglow-physics --example multiple_vs_monte_carlo -- [key=value …]
//!   turbidity=2,4  distance_km=1,2,5,10,20,50  band=R,G,B  lobe=lambert[,horizon,oblique]
//!   directions=ten|wide|mitsuba  paths=65536  resolution=table|reference|coarse  source_m=0  observer_m=0
//!   lamp_radius_m=0 (with truth=forward: a disc instead of a point; first order and solver are means over its points)
//!   albedo=0.15  cloud_base_m=1000 (none: a clear sky)  cloud_albedo=0.5
//!   seed=1  rows=yes|no  orders=yes|no  truth=monte_carlo|forward|reference
//!   speed=yes|no (how long a row and a ray take)
//!   and any field of `Resolution` by its name
//!
//! A line a direction: the first order, the total by both, the solver's relative error of the total and the
//! standard error of the Monte Carlo total (first order by quadrature in both). Then the statistics by lobe
//! and distance, by lobe and band, and by lobe, and the same with what the Monte Carlo's own noise explains taken off:
//! mean |e| and 99th percentile of max(|e| − 2σ, 0). With truth=reference the finest field takes the tracer's place: how far the solver has
//! converged, without noise.

use skyglow_physics::{
    Atmosphere, BAND_COUNT, Band, CloudBase, LOBE_COUNT, Lobe, Turbidity,
    multiple_scattering::{
        DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow,
        monte_carlo::{Detector, Estimate, ForwardTracer, Tracer},
    },
    single_source::{SourceGeometry, radiance_per_watt_of},
};
use std::{collections::HashMap, error::Error, time::Instant};

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

struct Options(HashMap<String, String>);

impl Options {
    fn text(&self, key: &str, default: &str) -> String {
        self.0.get(key).cloned().unwrap_or_else(|| default.to_owned())
    }

    fn numbers(&self, key: &str, default: &str) -> Result<Vec<f64>, Box<dyn Error>> {
        self.text(key, default).split(',').map(|part| Ok(part.parse()?)).collect()
    }

    fn number(&self, key: &str, default: f64) -> Result<f64, Box<dyn Error>> {
        Ok(self.text(key, &default.to_string()).parse()?)
    }

    fn names<T: Copy>(&self, key: &str, default: &str, all: &[(&str, T)]) -> Result<Vec<T>, Box<dyn Error>> {
        self.text(key, default)
            .split(',')
            .map(|part| {
                let found = all.iter().find(|(name, _)| *name == part);
                found.map(|found| found.1).ok_or_else(|| format!("{key}: {part} is unknown").into())
            })
            .collect()
    }
}

#[derive(Default)]
struct Statistics {
    errors: Vec<f64>,
    beyond_noise: Vec<f64>,
    noise: Vec<f64>,
    signed: f64,
}

impl Statistics {
    fn add(&mut self, error: f64, noise: f64) {
        self.errors.push(error.abs());
        self.beyond_noise.push((error.abs() - 2.0 * noise).max(0.0));
        self.noise.push(noise);
        self.signed += error;
    }

    fn print(&self, name: &str) {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let percentile = |values: &[f64]| {
            let mut sorted = values.to_vec();
            sorted.sort_by(f64::total_cmp);
            sorted
                .get((sorted.len().saturating_sub(1) as f64 * 0.99).round() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        println!(
            "{name:28} n {:4}  bias {:+6.2} %  mean {:5.2} %  p99 {:6.2} %  MC noise {:5.2} %  beyond 2 sigma: mean {:5.2} %  p99 {:6.2} %",
            self.errors.len(),
            100.0 * self.signed / self.errors.len().max(1) as f64,
            100.0 * mean(&self.errors),
            100.0 * percentile(&self.errors),
            100.0 * mean(&self.noise),
            100.0 * mean(&self.beyond_noise),
            100.0 * percentile(&self.beyond_noise),
        );
    }
}

/// Statistics by name, in the order of their first error.
#[derive(Default)]
struct Groups(Vec<(String, Statistics)>);

impl Groups {
    fn add(&mut self, name: String, error: f64, noise: f64) {
        let index = self.0.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
            self.0.push((name, Statistics::default()));
            self.0.len() - 1
        });
        self.0[index].1.add(error, noise);
    }

    fn print(&self) {
        for (name, statistics) in &self.0 {
            statistics.print(name);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options(
        std::env::args()
            .skip(1)
            .filter_map(|arg| arg.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned())))
            .collect(),
    );
    let named = options.names(
        "resolution",
        "table",
        &[
            ("table", Resolution::table()),
            ("reference", Resolution::reference()),
            ("coarse", Resolution::coarse()),
        ],
    )?[0];
    let whole = |key: &str, default: usize| -> Result<usize, Box<dyn Error>> {
        Ok(options.text(key, &default.to_string()).parse()?)
    };
    let resolution = Resolution {
        ring_step: options.number("ring_step", named.ring_step)?,
        layer_cuts: whole("layer_cuts", named.layer_cuts)?,
        first_degree: whole("first_degree", named.first_degree)?,
        later_degree: whole("later_degree", named.later_degree)?,
        first_polar: whole("first_polar", named.first_polar)?,
        first_around: whole("first_around", named.first_around)?,
        first_along: whole("first_along", named.first_along)?,
        polar_per_hemisphere: whole("polar_per_hemisphere", named.polar_per_hemisphere)?,
        azimuths: whole("azimuths", named.azimuths)?,
        tolerance: options.number("tolerance", named.tolerance)?,
        max_orders: whole("max_orders", named.max_orders)?,
    };
    let bands = options.names("band", "R,G,B", &[("R", Band::R), ("G", Band::G), ("B", Band::B)])?;
    let lobes = options.names(
        "lobe",
        "lambert",
        &[("lambert", Lobe::Lambert), ("horizon", Lobe::Horizon), ("oblique", Lobe::Oblique)],
    )?;
    let directions: &[(f64, f64)] =
        options.names("directions", "ten", &[("ten", &TEN[..]), ("mitsuba", &MITSUBA[..])])?[0];
    let (source_altitude_m, observer_altitude_m) =
        (options.number("source_m", 0.0)?, options.number("observer_m", 0.0)?);
    let albedo = options.number("albedo", DEFAULT_GROUND_ALBEDO)?;
    let (paths, seed) = (options.number("paths", 65_536.0)? as u64, options.number("seed", 1.0)? as u64);
    let lamp_radius_m = options.number("lamp_radius_m", 0.0)?;
    let use_rows = options.text("rows", "yes") == "yes";
    let tell_orders = options.text("orders", "no") == "yes";
    let cloud = match options.text("cloud_base_m", "none").as_str() {
        "none" => None,
        base_m => {
            Some(CloudBase::new(base_m.parse()?, options.number("cloud_albedo", CloudBase::DEFAULT_ALBEDO)?)?)
        }
    };
    // By distance, all bands together; by band and by lobe alone, all distances together, of which those beyond 50 km
    // are told apart.
    let (mut by_distance, mut by_band, mut by_lobe) =
        (Groups::default(), Groups::default(), Groups::default());
    for turbidity in options.numbers("turbidity", "2,4")? {
        let atmosphere = Atmosphere::new(Turbidity::new(turbidity)?).under(cloud);
        let setting =
            SourceSetting::for_observer(atmosphere, source_altitude_m, observer_altitude_m, albedo)?;
        let started = Instant::now();
        let field = SourceField::solve(setting, &resolution);
        let solve_s = started.elapsed().as_secs_f64();
        let truth = options.text("truth", "monte_carlo");
        let finest = (truth == "reference").then(|| SourceField::solve(setting, &Resolution::reference()));
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
        let distances_km = options.numbers("distance_km", "1,2,5,10,20,50")?;
        // One forward run a band serves all distances and directions.
        let detectors: Vec<Detector> = distances_km
            .iter()
            .flat_map(|km| directions.iter().map(move |&(az, el)| (km * 1e3, az, el)))
            .map(|(distance_m, az, el)| Detector {
                geometry: SourceGeometry { distance_m, source_altitude_m, observer_altitude_m },
                relative_azimuth_rad: az.to_radians(),
                elevation_rad: el.to_radians(),
            })
            .collect();
        let caught: Vec<Vec<Estimate>> = if truth == "forward" {
            bands
                .iter()
                .map(|band| {
                    let tracer = ForwardTracer::new(setting, *band).with_lamp_radius_m(lamp_radius_m);
                    tracer.estimate(&detectors, paths, seed)
                })
                .collect()
        } else {
            Vec::new()
        };
        if options.text("speed", "no") == "yes" {
            tell_speed(&field, observer_altitude_m)?;
        }
        println!("# T  km  band lobe  az  el  first  total(solver)  total(MC)  MC/first  error%  noise%");
        for (distance_index, &distance_km) in distances_km.iter().enumerate() {
            let geometry =
                SourceGeometry { distance_m: distance_km * 1e3, source_altitude_m, observer_altitude_m };
            for (band_index, band) in bands.iter().enumerate() {
                let tracer = Tracer::new(setting, *band, &geometry);
                for (direction_index, &(azimuth_deg, elevation_deg)) in directions.iter().enumerate() {
                    let (azimuth, elevation) = (f64::to_radians(azimuth_deg), f64::to_radians(elevation_deg));
                    let row = ViewRow::new(&field, observer_altitude_m, elevation)?;
                    let (mut first, mut higher) =
                        ([[0.0; LOBE_COUNT]; BAND_COUNT], [[0.0; LOBE_COUNT]; BAND_COUNT]);
                    let points = disc_points(lamp_radius_m, geometry.distance_m);
                    for &(distance_m, beside_rad) in &points {
                        let (geometry, azimuth) =
                            (SourceGeometry { distance_m, ..geometry }, azimuth + beside_rad);
                        let once = radiance_per_watt_of(&atmosphere, &geometry, azimuth, elevation, 1e-6);
                        let more = if use_rows {
                            row.radiance_per_watt(distance_m, azimuth)
                        } else {
                            field.radiance_per_watt(&geometry, azimuth, elevation)?
                        };
                        let share = 1.0 / points.len() as f64;
                        for (b, f) in (0..BAND_COUNT).flat_map(|b| (0..LOBE_COUNT).map(move |f| (b, f))) {
                            first[b][f] += share * once[b][f];
                            higher[b][f] += share * more[b][f];
                        }
                    }
                    let traced = match truth.as_str() {
                        "reference" => None,
                        "forward" => {
                            Some(caught[band_index][distance_index * directions.len() + direction_index])
                        }
                        _ => Some(tracer.estimate(azimuth, elevation, paths, seed)),
                    };
                    let finest = match &finest {
                        None => None,
                        Some(finest) => Some(finest.radiance_per_watt(&geometry, azimuth, elevation)?),
                    };
                    for lobe in &lobes {
                        let (b, f) = (band.index(), lobe.index());
                        let (true_higher, true_error) = match (&traced, &finest) {
                            (Some(traced), _) => {
                                (traced.radiance_per_m2_sr[f], traced.standard_error_per_m2_sr[f])
                            }
                            (None, Some(finest)) => (finest[b][f], 0.0),
                            (None, None) => (f64::NAN, 0.0),
                        };
                        let total = first[b][f] + true_higher;
                        let solved = first[b][f] + higher[b][f];
                        let (error, noise) = (solved / total - 1.0, true_error / total);
                        println!(
                            "{turbidity:3} {distance_km:5} {band:?} {:8} {azimuth_deg:4} {elevation_deg:3}  {:.4e}  {solved:.4e}  {total:.4e}  {:8.3}  {:+7.2}  {:6.2}",
                            lobe.name(),
                            first[b][f],
                            total / first[b][f],
                            100.0 * error,
                            100.0 * noise
                        );
                        if let (true, Some(traced)) = (tell_orders, &traced) {
                            println!(
                                "#   first order of the tracer: {:+.2} %",
                                100.0 * (traced.by_order_per_m2_sr[0][f] / first[b][f] - 1.0)
                            );
                            let orders: Vec<String> = traced
                                .by_order_per_m2_sr
                                .iter()
                                .map(|order| format!("{:.3e}", order[f]))
                                .collect();
                            println!("#   orders 1, 2, …: {}", orders.join(" "));
                        }
                        let (name, reach) =
                            (lobe.name(), if distance_km > 50.0 { "far" } else { "to 50 km" });
                        by_distance.add(format!("T {turbidity}, {name}, {distance_km} km"), error, noise);
                        by_band.add(format!("T {turbidity}, {name}, {band:?}, {reach}"), error, noise);
                        by_lobe.add(format!("T {turbidity}, {name}, {reach}"), error, noise);
                    }
                }
            }
        }
    }
    for groups in [&by_distance, &by_band, &by_lobe] {
        println!();
        groups.print();
    }
    Ok(())
}

/// Times rows and rays.
fn tell_speed(field: &SourceField, observer_altitude_m: f64) -> Result<(), Box<dyn Error>> {
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
