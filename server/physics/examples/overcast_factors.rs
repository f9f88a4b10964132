//! How many times brighter the zenith is below a cloud than under the clear sky, all orders of scattering, in and
//! around a round town.
//!
//! cargo run --release -p skyglow-physics --example overcast_factors -- [key=value …]
//!   radius_km=5,15  base_m=500,1000,2000,4000  turbidity=2.5  cloud_albedo=0.5  ground_albedo=0.15
//!   resolution=table|reference|coarse  ground_m=0
//!
//! The town is a disc of even flux (π·40 nW cm⁻² sr⁻¹), Garstang's mix of lobes, the lamp `mixed`, on level ground.
//! Columns: where the observer stands, the clear zenith in mag arcsec⁻² (artificial light alone), the factor below each
//! base. To compare with: Kyba, Ruhtz, Fischer, Hölker (2011), "Cloud coverage acts as an amplifier for ecological light
//! pollution in urban ecosystems", PLoS ONE 6, e17307, had 10.1 in Berlin and 2.8 at a rural place 32 km from its
//! centre, natural light included in both skies; factors of other places spread widely (Kyba et al. 2015, Sci. Rep. 5,
//! 8409), and far from towns clouds darken the sky (Jechow et al. 2017).

use skyglow_physics::{
    Atmosphere, CloudBase, EmissionMix, LampPreset, Turbidity,
    interpolation::Stencil,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow},
    photometry::{brightness_mag_arcsec2, luminance_cd_m2},
    quadrature::gauss_legendre,
    single_source::{RadiancePerWatt, SourceGeometry, radiance_per_watt_of},
    source_pixel::{NEAREST_SOURCE_M, W_M2_SR_PER_NW_CM2_SR},
};
use std::{collections::HashMap, error::Error, f64::consts::PI};

/// Distances of the sources that are computed, even in the logarithm.
const DISTANCES: usize = 60;
const FARTHEST_M: f64 = 130_000.0;
/// Radiance of the town as a satellite sees it.
const TOWN_NW_CM2_SR: f64 = 40.0;
/// From the edge outwards, metres.
const OUTSIDE_M: [f64; 4] = [10e3, 20e3, 40e3, 80e3];

/// Zenith luminance of a source over its distance: ln of cd m⁻² per DNB watt at ln of metres.
struct Zenith {
    ln_distance: Vec<f64>,
    ln_luminance: Vec<f64>,
}

impl Zenith {
    fn new(
        atmosphere: Atmosphere,
        albedo: f64,
        ground_m: f64,
        resolution: &Resolution,
    ) -> Result<Self, Box<dyn Error>> {
        let setting = SourceSetting::for_observer(atmosphere, ground_m, ground_m, albedo)?;
        let field = SourceField::solve(setting, resolution);
        let row = ViewRow::new(&field, ground_m, 0.5 * PI)?;
        let (mut ln_distance, mut ln_luminance) = (Vec::new(), Vec::new());
        for k in 0..DISTANCES {
            let share = k as f64 / (DISTANCES - 1) as f64;
            let distance_m = NEAREST_SOURCE_M * (FARTHEST_M / NEAREST_SOURCE_M).powf(share);
            let geometry =
                SourceGeometry { distance_m, source_altitude_m: ground_m, observer_altitude_m: ground_m };
            let first = radiance_per_watt_of(&atmosphere, &geometry, 0.0, 0.5 * PI, 1e-6);
            let later = row.radiance_per_watt(distance_m, 0.0);
            ln_distance.push(distance_m.ln());
            ln_luminance.push((luminance(&first) + luminance(&later)).max(1e-300).ln());
        }
        Ok(Self { ln_distance, ln_luminance })
    }

    fn at(&self, distance_m: f64) -> f64 {
        let distances = Stencil::lagrange(&self.ln_distance, distance_m.ln());
        distances.sum(|node| self.ln_luminance[node]).exp()
    }

    /// Over a disc [cd m⁻² for 1 W m⁻²] whose centre is `center_m` away: ring by ring about the observer.
    fn of_disc(&self, radius_m: f64, center_m: f64) -> f64 {
        let half_turn = |r: f64| {
            if r + center_m <= radius_m {
                return PI;
            }
            let cosine = (r * r + center_m * center_m - radius_m * radius_m) / (2.0 * r * center_m);
            cosine.clamp(-1.0, 1.0).acos()
        };
        // What is nearer counts as at the nearest distance.
        let mut sum =
            NEAREST_SOURCE_M * NEAREST_SOURCE_M * half_turn(NEAREST_SOURCE_M) * self.at(NEAREST_SOURCE_M);
        let edges = [NEAREST_SOURCE_M, (radius_m - center_m).abs(), center_m, center_m + radius_m];
        let mut edges = edges.map(|edge| edge.max(NEAREST_SOURCE_M));
        edges.sort_by(f64::total_cmp);
        for pair in edges.windows(2) {
            for (x, weight) in gauss_legendre(64) {
                // Even in the logarithm.
                let r = pair[0] * (pair[1] / pair[0]).powf(x);
                sum += weight * r * r * (pair[1] / pair[0]).ln() * 2.0 * half_turn(r) * self.at(r);
            }
        }
        sum
    }
}

/// Luminance [cd m⁻² per DNB watt] of the mix of lobes and the lamp.
fn luminance(radiance: &RadiancePerWatt) -> f64 {
    let (weights, lamp) = (EmissionMix::garstang().weights(), LampPreset::Mixed.lamp());
    luminance_cd_m2(std::array::from_fn(|band| {
        let mixed: f64 = radiance[band].iter().zip(weights).map(|(value, weight)| value * weight).sum();
        lamp.flux_per_dnb_flux[band] * mixed
    }))
}

fn main() -> Result<(), Box<dyn Error>> {
    let options: HashMap<String, String> = std::env::args()
        .skip(1)
        .filter_map(|arg| arg.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned())))
        .collect();
    let numbers = |key: &str, default: &str| -> Result<Vec<f64>, Box<dyn Error>> {
        options.get(key).map_or(default, String::as_str).split(',').map(|part| Ok(part.parse()?)).collect()
    };
    let resolution = match options.get("resolution").map(String::as_str) {
        Some("reference") => Resolution::reference(),
        Some("coarse") => Resolution::coarse(),
        _ => Resolution::table(),
    };
    let air = Atmosphere::new(Turbidity::new(numbers("turbidity", "2.5")?[0])?);
    let cloud_albedo = numbers("cloud_albedo", &CloudBase::DEFAULT_ALBEDO.to_string())?[0];
    let ground_albedo = numbers("ground_albedo", &DEFAULT_GROUND_ALBEDO.to_string())?[0];
    let ground_m = numbers("ground_m", "0")?[0];
    let bases_m = numbers("base_m", "500,1000,2000,4000")?;
    let clear = Zenith::new(air, ground_albedo, ground_m, &resolution)?;
    let overcast: Vec<Zenith> = bases_m
        .iter()
        .map(|&base_m| {
            let under = air.under(Some(CloudBase::new(ground_m + base_m, cloud_albedo)?));
            Zenith::new(under, ground_albedo, ground_m, &resolution)
        })
        .collect::<Result<_, _>>()?;
    let flux_w_m2 = PI * TOWN_NW_CM2_SR * W_M2_SR_PER_NW_CM2_SR;
    println!("bases above the ground, m: {bases_m:?}");
    for radius_km in numbers("radius_km", "5,15")? {
        let radius_m = 1e3 * radius_km;
        println!("town of {radius_km} km radius");
        let places = [("centre".to_owned(), 0.0), ("edge".to_owned(), radius_m)].into_iter().chain(
            OUTSIDE_M.map(|away_m| (format!("{:.0} km from the edge", 1e-3 * away_m), radius_m + away_m)),
        );
        for (name, center_m) in places {
            let open = clear.of_disc(radius_m, center_m);
            let factors: Vec<String> = overcast
                .iter()
                .map(|zenith| format!("{:8.3}", zenith.of_disc(radius_m, center_m) / open))
                .collect();
            println!(
                "  {name:20} clear {:6.2} mag  overcast/clear {}",
                brightness_mag_arcsec2(flux_w_m2 * open).unwrap_or(f64::NAN),
                factors.join(" ")
            );
        }
    }
    Ok(())
}
