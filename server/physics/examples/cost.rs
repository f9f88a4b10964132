//! Times the single-source integral: microseconds a direction, by tolerance and number of turbidities.
use skyglow_physics::{single_source::*, *};
use std::time::Instant;
fn main() {
    let t = |t| Atmosphere::new(Turbidity::new(t).unwrap());
    let mut sink = 0.0;
    for tol in [1e-3, 1e-4, 1e-5, 1e-6] {
        for temp in [1.5, 6.0] {
            let start = Instant::now();
            let mut n = 0;
            for d in 0..20 {
                let g = SourceGeometry { distance_m: 250.0 * 1200f64.powf(f64::from(d) / 19.0), source_altitude_m: 300.0, observer_altitude_m: 800.0 };
                for a in 0..16 { for e in 0..16 {
                    let v: [f64; 9] = radiance_per_watt(&[t(temp)], &g, f64::from(a) * 0.2, (f64::from(e) + 0.5) * 0.098, tol, 0.0);
                    sink += v[3]; n += 1;
                }}
            }
            let one = start.elapsed().as_secs_f64() / f64::from(n) * 1e6;
            println!("tolerance {tol:e} T {temp}: {one:.2} us");
        }
        let seven = [1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0].map(t);
        let start = Instant::now();
        let mut n = 0;
        for d in 0..20 {
            let g = SourceGeometry { distance_m: 250.0 * 1200f64.powf(f64::from(d) / 19.0), source_altitude_m: 300.0, observer_altitude_m: 800.0 };
            for a in 0..16 { for e in 0..16 {
                let v: [f64; 63] = radiance_per_watt(&seven, &g, f64::from(a) * 0.2, (f64::from(e) + 0.5) * 0.098, tol, 0.0);
                sink += v[3]; n += 1;
            }}
        }
        println!("tolerance {tol:e} seven turbidities: {:.2} us", start.elapsed().as_secs_f64() / f64::from(n) * 1e6);
    }
    println!("{sink:e}");
}
