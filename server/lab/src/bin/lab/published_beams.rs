//! Skies of beams beside those of other programs and of measurements, and dusk beside Monte Carlo, as tables.

use crate::arguments::Outcome;
use skyglow_celestial::{Component, bodies::moon_magnitude_v, lights::FULL_MOON_MAGNITUDE_V};
use skyglow_physics::{
    BAND_COUNT, Band, PhysicsError, Response, Turbidity,
    beam::{BeamAir, BeamField, BeamSetting, MoleculeProfile, USUAL_OZONE_DOBSON, monte_carlo::BeamTracer},
    photometry::brightness_mag_arcsec2,
};
use std::f64::consts::FRAC_PI_2;

/// Prints skies of beams beside quadrature, Monte Carlo of another program, measured twilight and moonlight, and this program's Monte
/// Carlo with the Sun down to 12° below the horizon.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Paths of each estimate
    #[arg(default_value_t = 100_000)]
    paths: u64,
    /// One of the tables alone
    #[arg(long)]
    table: Option<Table>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Table {
    Programs,
    Airs,
    Moonlight,
    Dusk,
}

/// V of the night sky over Paranal.
const NIGHT_V: f64 = 21.61;
/// Degrees of the Sun below the horizon and V at the zenith there (Patat et al. 2006).
const TWILIGHT: [(f64, f64); 4] = [(6.0, 13.30), (9.0, 17.00), (12.0, 19.67), (15.0, 21.32)];

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let is_wanted = |table: Table| arguments.table.is_none_or(|only| only == table);
    if is_wanted(Table::Programs) {
        programs(arguments.paths)?;
    }
    if is_wanted(Table::Airs) {
        airs()?;
    }
    if is_wanted(Table::Moonlight) {
        moonlight()?;
        mauna_kea()?;
    }
    if is_wanted(Table::Dusk) {
        dusk(arguments.paths)?;
    }
    Ok(())
}

/// The air of the numbers of other programs: T = 2, molecules exp(−z/8 km), no ozone, straight rays, all bands at 550 nm.
fn former_air(top_m: f64) -> Result<BeamAir, PhysicsError> {
    let profile = MoleculeProfile::Exponential {
        ozone_dobson: 0.0,
        scale_height_m: 8_000.0,
        extinction_550_per_m: 13.558e-6,
        top_m,
    };
    Ok(BeamAir::with_profile(Turbidity::new(2.0)?, profile, false, [550.0; BAND_COUNT]))
}

fn off(found: f64, wanted: f64) -> f64 {
    100.0 * (found / wanted - 1.0)
}

/// Skies of other programs.
fn programs(paths: u64) -> Outcome {
    let setting = BeamSetting::new(former_air(80_000.0)?);
    let field = BeamField::solve(setting.clone());
    first_order(&field)?;
    all_orders(&field, &BeamTracer::new(setting, Band::MIDDLE), paths);
    Ok(())
}

/// First order by quadrature; the ground has no part in it.
fn first_order(field: &BeamField) -> Outcome {
    println!("## First order, T = 2, 550 nm, sea level, beside quadrature\n");
    println!(
        "| view's elevation | source's zenith angle | published, sr-1 | ours | off, % |\n|---|---|---|---|---|"
    );
    for (elevation, zenith, published) in [
        (90.0f64, 30.0f64, 2.616e-2),
        (90.0, 60.0, 8.617e-3),
        (90.0, 85.0, 3.411e-3),
        (90.0, 90.0, 1.276e-3),
        (90.0, 92.0, 4.890e-4),
        (90.0, 94.0, 9.785e-5),
        (90.0, 96.0, 8.107e-6),
        (90.0, 98.0, 1.08e-7),
        (30.0, 60.0, 0.4697),
        (30.0, 90.0, 4.115e-3),
        (30.0, 94.0, 3.833e-4),
    ] {
        let view = field.view(0.0, elevation.to_radians());
        let ours = view.first_order_per_sr(zenith.to_radians(), 0.0)[0];
        println!("| {elevation} | {zenith} | {published:.4e} | {ours:.4e} | {:+.2} |", off(ours, published));
    }
    let higher = BeamField::solve(BeamSetting::new(former_air(90_000.0)?));
    let first = higher.view(0.0, FRAC_PI_2).first_order_per_sr(98f64.to_radians(), 0.0)[0];
    println!("\nAt 98° in air to 90 km instead of 80: {first:.3e} sr-1");
    Ok(())
}

/// All orders by Monte Carlo of another program, and by this program's.
fn all_orders(field: &BeamField, tracer: &BeamTracer, paths: u64) {
    let view = field.view(0.0, FRAC_PI_2);
    println!("\n## All orders, the same air, albedo 0.15, zenith\n");
    println!(
        "| source's zenith angle | published, sr-1 | its error, % | Monte Carlo by rays | its error, % | field | off that, % | off published, % | over first | published |\n|---|---|---|---|---|---|---|---|---|---|"
    );
    for (zenith, published, error, over_first) in [
        (60.0f64, 1.257e-2, 0.2, 1.46),
        (85.0, 5.35e-3, 0.5, 1.56),
        (90.0, 1.867e-3, 0.6, 1.46),
        (92.0, 7.04e-4, 1.1, 1.42),
        (94.0, 1.41e-4, 2.4, 1.51),
        (96.0, 1.47e-5, 8.0, 2.1),
        (98.0, f64::NAN, f64::NAN, 27.0),
    ] {
        let zenith_rad = zenith.to_radians();
        let ours = view.radiance_per_sr(zenith_rad, 0.0)[0];
        let first = view.first_order_per_sr(zenith_rad, 0.0)[0];
        let judged = tracer.estimate_by_rays(0.0, FRAC_PI_2, zenith_rad, 0.0, paths, 1);
        println!(
            "| {zenith} | {published:.3e} | {error} | {:.3e} | {:.1} | {ours:.3e} | {:+.1} | {:+.1} | {:.2} | {over_first} |",
            judged.radiance_per_sr,
            100.0 * judged.standard_error_per_sr / judged.radiance_per_sr,
            off(ours, judged.radiance_per_sr),
            off(ours, published),
            ours / first,
        );
    }
}

/// V of the Sun's scattered light, mag arcsec⁻².
fn sunlit_v(kernel: [f64; BAND_COUNT]) -> f64 {
    let luminance = Component::Sun.light().rule(&Response::JohnsonV).value(kernel);
    brightness_mag_arcsec2(luminance).unwrap_or(f64::INFINITY)
}

fn twilight_air(profile: MoleculeProfile, is_refracting: bool) -> Result<BeamField, PhysicsError> {
    let nodes_nm = Band::ALL.map(Band::wavelength_nm);
    let air = BeamAir::with_profile(Turbidity::new(1.5)?, profile, is_refracting, nodes_nm);
    Ok(BeamField::solve(BeamSetting::new(air)))
}

/// The zenith in several airs, and over Paranal.
fn airs() -> Outcome {
    println!("\n## The zenith 1 634 m high by the air, T = 1.5, V, mag/arcsec²\n");
    println!("| air | Sun 4° down | published | 6° | published |\n|---|---|---|---|---|");
    let exponential = |ozone_dobson: f64| MoleculeProfile::Exponential {
        ozone_dobson,
        scale_height_m: 8_000.0,
        extinction_550_per_m: 0.0973 / 8_000.0,
        top_m: 100_000.0,
    };
    let standard = |ozone_dobson: f64| MoleculeProfile::Standard { ozone_dobson };
    println!("| measured | | 10.67 | | 13.28 |");
    let mut paranal = Vec::new();
    for (name, profile, is_refracting, published) in [
        ("no ozone, molecules exp(-z/8 km)", exponential(0.0), false, ["9.95", "12.65"]),
        ("300 DU, molecules exp(-z/8 km)", exponential(USUAL_OZONE_DOBSON), false, ["10.40", "12.92"]),
        ("300 DU, US Standard", standard(USUAL_OZONE_DOBSON), false, ["11.02", "13.81"]),
        ("the same with refraction", standard(USUAL_OZONE_DOBSON), true, ["", ""]),
        ("260 DU with refraction", standard(260.0), true, ["", ""]),
    ] {
        let field = twilight_air(profile, is_refracting)?;
        let view = field.view(1_634.0, FRAC_PI_2);
        let [four, six] = [94f64, 96.0].map(|deg| sunlit_v(view.radiance_per_sr(deg.to_radians(), 0.0)));
        println!("| {name} | {four:.2} | {} | {six:.2} | {} |", published[0], published[1]);
        if is_refracting {
            let view = field.view(2_635.0, FRAC_PI_2);
            paranal.push(TWILIGHT.map(|(below, _)| {
                let sunlit = sunlit_v(view.radiance_per_sr((90.0 + below).to_radians(), 0.0));
                -2.5 * (10f64.powf(-0.4 * sunlit) + 10f64.powf(-0.4 * NIGHT_V)).log10()
            }));
        }
    }
    println!("\n## The zenith over Paranal, 2 635 m, T = 1.5, V with a night sky of {NIGHT_V}\n");
    println!("| Sun down | measured | 300 DU | off, mag | 260 DU | off, mag |\n|---|---|---|---|---|---|");
    for (at, (below, measured)) in TWILIGHT.into_iter().enumerate() {
        let [one, other] = [0, 1].map(|air: usize| paranal[air][at]);
        println!(
            "| {below}° | {measured:.2} | {one:.2} | {:+.2} | {other:.2} | {:+.2} |",
            one - measured,
            other - measured
        );
    }
    Ok(())
}

/// A full Moon 45° from the zenith over Paranal, by what air and ground are taken for.
#[expect(clippy::approx_constant, reason = "a turbidity")]
fn moonlight() -> Outcome {
    println!("\n## A full Moon (V -13.06) 45° from the zenith over Paranal, V with a night sky of 21.74\n");
    println!("| turbidity | zenith takes, mag | albedo of the ground | V | SkyCalc |\n|---|---|---|---|---|");
    let moon = Component::Moon.light().rule(&Response::JohnsonV);
    // The law's surge at full Moon.
    let irradiance = 1.35;
    for (turbidity, albedo) in [(1.5, 0.15), (3.14, 0.15), (3.14, 0.5)] {
        let setting = BeamSetting::new(BeamAir::new(Turbidity::new(turbidity)?)).over(albedo)?;
        let field = BeamField::solve(setting);
        let through = field.transmittance(2_635.0, 0.0);
        let loss = -2.5 * (moon.value(through) / moon.value([1.0; BAND_COUNT])).log10();
        let kernel = field.view(2_635.0, FRAC_PI_2).radiance_per_sr(45f64.to_radians(), 0.0);
        let v = brightness_mag_arcsec2(moon.value(kernel.map(|value| irradiance * value)))
            .unwrap_or(f64::INFINITY);
        let total = -2.5 * (10f64.powf(-0.4 * v) + 10f64.powf(-0.4 * 21.74)).log10();
        println!("| {turbidity} | {loss:.3} | {albedo} | {total:.2} | 18.01 |");
    }
    Ok(())
}

/// Moonlight beside Krisciunas and Schaefer (1991), table 2, at the altitude that they measured at: the Moon of phase angle 30° at 60°
/// from the zenith, in air that takes 0.172 mag of V.
fn mauna_kea() -> Outcome {
    const ALTITUDE_M: f64 = 2_800.0;
    let moon = Component::Moon.light().rule(&Response::JohnsonV);
    let loss_mag = |turbidity: f64| -> Result<f64, PhysicsError> {
        let depth = BeamAir::new(Turbidity::new(turbidity)?).vertical_optical_depth(ALTITUDE_M);
        let through = moon.value(depth.map(|depth| (-depth).exp())) / moon.value([1.0; BAND_COUNT]);
        Ok(-2.5 * through.log10())
    };
    let (mut low, mut high) = (1.0, 20.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if loss_mag(middle)? < 0.172 { low = middle } else { high = middle }
    }
    let field = BeamField::solve(BeamSetting::new(BeamAir::new(Turbidity::new(low)?)));
    let irradiance = 10f64.powf(-0.4 * (moon_magnitude_v(30.0, 3.844e8, 1.0) - FULL_MOON_MAGNITUDE_V));
    println!("\n## Moonlight at 2 800 m, T = {low:.2}, beside Krisciunas and Schaefer (1991), nL\n");
    println!("| from the Moon | published | ours | off, % |\n|---|---|---|---|");
    for (separation, elevation, azimuth, published) in [
        (5, 35.0f64, 0.0f64, 7216.0),
        (30, 60.0, 0.0, 1160.0),
        (60, 90.0, 0.0, 530.0),
        (90, 60.0, 180.0, 437.0),
        (120, 30.0, 180.0, 818.0),
    ] {
        let view = field.view(ALTITUDE_M, elevation.to_radians());
        let kernel = view.radiance_per_sr(60f64.to_radians(), azimuth.to_radians());
        let v = brightness_mag_arcsec2(moon.value(kernel.map(|value| irradiance * value)))
            .unwrap_or(f64::INFINITY);
        let ours = 34.08 * (20.7233 - 0.92104 * v).exp();
        println!("| {separation}° | {published} | {ours:.0} | {:+.0} |", off(ours, published));
    }
    Ok(())
}

/// The field beside Monte Carlo by whole rays in the air of the tables, the Sun 6 to 12° down.
fn dusk(paths: u64) -> Outcome {
    let setting = BeamSetting::new(BeamAir::new(Turbidity::new(2.5)?));
    let field = BeamField::solve(setting.clone());
    println!("\n## Dusk beside Monte Carlo by rays, {paths} paths, T = 2.5, 1 500 m\n");
    println!(
        "| elevation | source's zenith angle | nm | Monte Carlo, sr-1 | its error, % | first order's share, % | field, % |\n|---|---|---|---|---|---|---|"
    );
    for band in [Band::MIDDLE, Band::SHORTEST] {
        let tracer = BeamTracer::new(setting.clone(), band);
        for (elevation, zenith) in
            [(90.0f64, 96.0f64), (90.0, 98.0), (90.0, 100.0), (90.0, 102.0), (10.0, 98.0), (10.0, 102.0)]
        {
            let [elevation_rad, zenith_rad] = [elevation, zenith].map(f64::to_radians);
            let judged = tracer.estimate_by_rays(1_500.0, elevation_rad, zenith_rad, 0.0, paths, 1);
            let got = field.view(1_500.0, elevation_rad).radiance_per_sr(zenith_rad, 0.0)[band.index()];
            println!(
                "| {elevation} | {zenith} | {} | {:.3e} | {:.1} | {:.2} | {:+.1} |",
                band.wavelength_nm(),
                judged.radiance_per_sr,
                100.0 * judged.standard_error_per_sr / judged.radiance_per_sr,
                100.0 * judged.first_order_per_sr / judged.radiance_per_sr,
                off(got, judged.radiance_per_sr)
            );
        }
    }
    Ok(())
}
