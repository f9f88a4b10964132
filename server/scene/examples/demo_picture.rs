//! Makes the demo and writes its light and its terrain as grey pictures: `demo_picture DIR`.

#![expect(clippy::expect_used, reason = "a tool for developers stops at the first error")]

use skyglow_physics::GeoPoint;
use skyglow_scene::{SceneId, SceneStore, create_demo};
use std::time::Instant;

fn main() {
    let dir = std::env::args().nth(1).expect("a folder");
    let store = SceneStore::new(&dir);
    let start = Instant::now();
    let metadata = create_demo(&store, &mut |_| {}).expect("a demo");
    println!(
        "made in {:.2} s, {} lit pixels, {:.3e} W",
        start.elapsed().as_secs_f64(),
        metadata.lit_pixels,
        metadata.report.flux_dnb_w
    );
    println!("{:?}", metadata.report.warnings);
    let scene = store.open(&SceneId::parse("demo").expect("an id")).expect("a scene");
    let (width, height) = (1320usize, 780usize);
    let picture = |name: &str, value: &dyn Fn(GeoPoint) -> f64| {
        let mut bytes = format!("P5 {width} {height} 255\n").into_bytes();
        for i in 0..width * height {
            let (row, column) = ((i / width) as f64, (i % width) as f64);
            let place = GeoPoint::from_deg(49.0 - (row + 0.5) / 120.0, 4.0 + (column + 0.5) / 120.0)
                .expect("a place");
            bytes.push(value(place).clamp(0.0, 255.0) as u8);
        }
        std::fs::write(format!("{dir}/{name}.pgm"), bytes).expect("a picture");
    };
    picture("light", &|place| {
        scene.radiance_nw_cm2_sr(place).map_or(0.0, |l| 60.0 * (1.0 + 5.0 * l).log10())
    });
    picture("terrain", &|place| scene.terrain_altitude_m(place).map_or(0.0, |h| 255.0 * (h / 4000.0).sqrt()));
}
