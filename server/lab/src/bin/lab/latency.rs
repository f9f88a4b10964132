//! Times of the interface over loopback.

use crate::arguments::Outcome;
use skyglow_app::{ObservatorySource, SkySource};
use skyglow_http::{HttpConfig, router, serve};
use skyglow_lab::setup::engine_of;
use skyglow_observatory::Observatory;
use skyglow_render::{DeviceChoice, synthetic};
use skyglow_scene::{SceneStore, create_demo};
use std::{error::Error, sync::Arc, time::Instant};

fn observatory(data: &std::path::Path) -> Result<Observatory, Box<dyn Error + Send + Sync>> {
    create_demo(&SceneStore::new(data), &mut |_| {})?;
    let tables = synthetic::table_set(&[1.5, 2.5, 4.0, 6.0], 64);
    Ok(Observatory::new(engine_of(tables, DeviceChoice::Cpu)?, Vec::new(), data, 2))
}

/// Times the interface over loopback: demo scene, CPU executor, made-up tables (so the skies mean nothing).
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Goes on serving.
    #[arg(long)]
    stay: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    tokio::runtime::Runtime::new()?.block_on(measure(arguments)).map_err(|error| error as Box<dyn Error>)
}

async fn measure(arguments: &Arguments) -> Result<(), Box<dyn Error + Send + Sync>> {
    let folder = tempfile::tempdir()?;
    let data = folder.path().to_owned();
    let observatory = tokio::task::spawn_blocking(move || observatory(&data)).await??;
    let source = Arc::new(ObservatorySource::new(Arc::new(observatory)));
    while !source.is_ready() {
        tokio::time::sleep(std::time::Duration::from_millis(10)).await;
    }
    let scene = source.scenes()?.remove(0);
    let config = HttpConfig { requests_per_second: 0.0, ..HttpConfig::default() };
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await?;
    let base = format!("http://{}", listener.local_addr()?);
    let app = router(source, config.clone());
    let server = tokio::spawn(async move { serve(listener, app, &config, std::future::pending()).await });
    let client = reqwest::Client::builder().no_proxy().build()?;
    let [west, south, east, north] = scene.bounds;
    println!("{base}, scene {}", scene.id);
    println!("{:<44} {:>9} {:>9} {:>9}", "", "median ms", "worst ms", "bytes");
    for (what, path, encoding) in [
        ("sky", "sky?", ""),
        ("sky, cached", "sky?same", ""),
        ("site", "site?", ""),
        ("panorama.png", "panorama.png?", ""),
        ("panorama.png, sky cached", "panorama.png?same", ""),
        ("panorama.webp, sky cached", "panorama.webp?same", ""),
        ("panorama.exr, sky cached", "panorama.exr?same", ""),
        ("panorama.tif, sky cached", "panorama.tif?same", ""),
        ("panorama.json, sky cached", "panorama.json?same", ""),
        ("panorama.json, sky cached, gzip", "panorama.json?same", "gzip"),
        ("panorama.json, sky cached, br", "panorama.json?same", "br"),
        ("panorama.json, sky cached, zstd", "panorama.json?same", "zstd"),
        ("panorama.png fisheye, sky cached", "panorama.png?projection=fisheye&same", ""),
        ("tile", "tiles/radiance/8/154/128.png", ""),
    ] {
        let mut times_ms = Vec::new();
        let mut bytes = 0;
        for step in 0..40 {
            // Low-discrepancy places over the middle of the scene, so that nothing is cached from before.
            let (u, v) = match path.contains("same") {
                true => (0.5, 0.5),
                false => ((f64::from(step) * 0.618).fract(), (f64::from(step) * 0.414).fract()),
            };
            let (lon, lat) =
                (west + (0.2 + 0.6 * u) * (east - west), south + (0.2 + 0.6 * v) * (north - south));
            let query = path.replace("same", "");
            let url = match query.contains('?') {
                true => format!(
                    "{base}/api/v1/scenes/{}/{query}&lat={lon_lat}",
                    scene.id,
                    lon_lat = format_args!("{lat}&lon={lon}")
                )
                .replace("?&", "?"),
                false => format!("{base}/api/v1/scenes/{}/{query}", scene.id),
            };
            let start = Instant::now();
            let answer =
                client.get(url.replace("&&", "&")).header("accept-encoding", encoding).send().await?;
            let answer = answer.error_for_status()?;
            bytes = answer.bytes().await?.len();
            times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times_ms.sort_by(f64::total_cmp);
        println!("{what:<44} {:>9.2} {:>9.2} {bytes:>9}", times_ms[20], times_ms[39]);
    }
    if arguments.stay {
        server.await??;
    }
    Ok(())
}
