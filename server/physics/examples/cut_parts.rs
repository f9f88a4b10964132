//! What a skyline leaves of the later orders of scattering, as a part of what they are under the open sky: fields of one
//! resolution against another. `cut_parts TURBIDITY`

#![expect(clippy::expect_used, reason = "a measuring tool for developers stops at the first error")]

use skyglow_physics::{
    Atmosphere, BAND_COUNT, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow},
    panorama::{azimuth_rad, elevation_rad},
};
use std::time::Instant;

const DISTANCES_KM: [f64; 6] = [1.0, 5.0, 15.0, 40.0, 80.0, 150.0];
const ROWS: [usize; 5] = [1, 6, 20, 40, 63];
const COLUMNS: [usize; 4] = [2, 20, 64, 128];

/// `[distance][row][column][lobe and band]`
fn views(setting: SourceSetting, resolution: &Resolution, observer_m: f64) -> Vec<f64> {
    let start = Instant::now();
    let field = SourceField::solve(setting, resolution);
    let solved = start.elapsed().as_secs_f64();
    let mut values = Vec::new();
    for row in ROWS {
        let rays = ViewRow::new(&field, observer_m, elevation_rad(row)).expect("a view");
        for distance_km in DISTANCES_KM {
            for column in COLUMNS {
                let radiance = rays.radiance_per_watt(1e3 * distance_km, azimuth_rad(column));
                values.extend((0..BAND_COUNT).flat_map(|band| [radiance[band][0], radiance[band][1]]));
            }
        }
    }
    println!("  solved in {solved:.1} s");
    values
}

fn main() {
    let turbidity: f64 =
        std::env::args().nth(1).and_then(|t| t.parse().ok()).expect("usage: cut_parts TURBIDITY");
    let atmosphere = Atmosphere::new(Turbidity::new(turbidity).expect("a turbidity"));
    let middle = Resolution {
        ring_step: 0.3,
        first_degree: 16,
        first_polar: 14,
        first_around: 8,
        first_along: 4,
        later_degree: 8,
        polar_per_hemisphere: 8,
        azimuths: 12,
        max_orders: 8,
        ..Resolution::table()
    };
    let observer_m = 200.0;
    let open = SourceSetting::new(atmosphere, 0.0, 0.0, DEFAULT_GROUND_ALBEDO).expect("a setting");
    let resolutions = [("table", Resolution::table()), ("middle", middle), ("coarse", Resolution::coarse())];
    let open_views: Vec<Vec<f64>> =
        resolutions.iter().map(|(_, resolution)| views(open, resolution, observer_m)).collect();
    for blocking_deg in [1.0f64, 4.0, 16.0] {
        let cut = open.behind(blocking_deg.to_radians()).expect("a skyline");
        let parts: Vec<Vec<f64>> = resolutions
            .iter()
            .zip(&open_views)
            .map(|((_, resolution), open)| {
                let cut = views(cut, resolution, observer_m);
                cut.iter().zip(open).map(|(cut, open)| (cut / open).min(1.0)).collect()
            })
            .collect();
        for (index, (name, _)) in resolutions.iter().enumerate().skip(1) {
            let errors: Vec<f64> = parts[index]
                .iter()
                .zip(&parts[0])
                .map(|(part, table)| (part - table) / table.max(1e-3))
                .collect();
            let mean = errors.iter().map(|e| e.abs()).sum::<f64>() / errors.len() as f64;
            let signed = errors.iter().sum::<f64>() / errors.len() as f64;
            let worst = errors.iter().fold(0.0f64, |most, e| most.max(e.abs()));
            let left = parts[0].iter().sum::<f64>() / errors.len() as f64;
            println!(
                "{blocking_deg} deg, {name}: part {left:.3}, mean error {mean:.4} ({signed:+.4}), largest {worst:.3}"
            );
        }
    }
}
