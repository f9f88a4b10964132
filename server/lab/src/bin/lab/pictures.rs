//! Pictures of every kind, and how long each takes.

use crate::arguments::Outcome;
use skyglow_display::{
    Colormap, Notes, PictureOptions, Projection, Style, encode_exr, encode_png, encode_tiff, encode_webp,
    picture, raster,
};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Direction, ELEVATION_COUNT, Horizon, LampPreset, Panorama, Response,
    SKY_RESPONSES, SeenSky, SkyPart, panorama, spectrum::RGB_BANDS,
};
use std::{path::PathBuf, sync::Arc, time::Instant};

/// A large sodium town in the east, a small LED town in the north-north-west, a dark south.
fn invented_sky() -> Vec<SkyPart> {
    let towns = [(90.0, 1e-4, 25.0, LampPreset::Hps), (340.0, 8e-6, 12.0, LampPreset::Led4000k)];
    let of_town = |(azimuth_deg, strength, width_deg, lamp): (f64, f64, f64, LampPreset)| {
        let town = Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: 0.0 };
        let mut kernel = Panorama::dark();
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let at = Direction {
                    azimuth_rad: panorama::azimuth_rad(column),
                    elevation_rad: panorama::elevation_rad(row),
                };
                let angle_deg = at.enu().dot(town.enu()).clamp(-1.0, 1.0).acos().to_degrees();
                let radiance = (strength * (-angle_deg / width_deg).exp() + 1.5e-8) as f32;
                for band in 0..BAND_COUNT {
                    kernel.samples_mut()[Panorama::index(band, row, column)] = radiance;
                }
            }
        }
        SkyPart { light: Arc::clone(lamp.lamp().light()), kernel }
    };
    towns.map(of_town).to_vec()
}

/// Runs something a few times; prints the shortest time, ms.
fn timed<T, E>(what: &str, mut make: impl FnMut() -> Result<T, E>) -> Result<T, E> {
    let mut best_ms = f64::INFINITY;
    for _ in 0..4 {
        let start = Instant::now();
        make()?;
        best_ms = best_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    println!("{what:<44} {best_ms:8.2} ms");
    make()
}

/// Makes every kind of picture of an invented sky and says how long each step took.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder for them.
    folder: PathBuf,
}

pub(crate) fn run(Arguments { folder }: &Arguments) -> Outcome {
    std::fs::create_dir_all(folder)?;
    let parts = invented_sky();
    let (sky, bands) = (SeenSky::of(&parts, &SKY_RESPONSES), SeenSky::of(&parts, &RGB_BANDS));
    let seen_by = &Response::Photopic;
    let camera = Projection::Perspective { azimuth_deg: 60.0, elevation_deg: 20.0, fov_deg: 90.0 };
    for projection in [Projection::Equirectangular, Projection::Fisheye, camera] {
        for (style_name, style) in
            [("false", Style::default()), ("realistic", Style::Realistic { exposure_ev: 0.0 })]
        {
            let options = PictureOptions { style, ..PictureOptions::new(projection) };
            let name = format!("{}-{style_name}", projection.name());
            let image =
                timed(&format!("{name} picture"), || picture(&sky, seen_by, &Horizon::flat(), &options))?;
            let bytes = timed(&format!("{name} PNG"), || encode_png(&image, &Notes::default()))?;
            std::fs::write(folder.join(format!("{name}.png")), bytes)?;
            let bytes = timed(&format!("{name} WebP"), || encode_webp(&image, &Notes::default()))?;
            std::fs::write(folder.join(format!("{name}.webp")), bytes)?;
        }
        let name = projection.name();
        let size = projection.default_raster_size_px();
        // Pixels are found as they are encoded.
        let flat = Horizon::flat();
        let floats = raster(&bands, &flat, projection, size, None)?;
        std::fs::write(
            folder.join(format!("{name}.exr")),
            timed(&format!("{name} EXR"), || encode_exr(&floats, &Notes::default()))?,
        )?;
        std::fs::write(
            folder.join(format!("{name}.tif")),
            timed(&format!("{name} TIFF"), || encode_tiff(&floats, &Notes::default()))?,
        )?;
    }
    for colormap in Colormap::ALL {
        let style = Style::FalseColour { colormap, range: Default::default() };
        let options = PictureOptions {
            style,
            width_px: 640,
            height_px: 160,
            ..PictureOptions::new(Projection::Equirectangular)
        };
        std::fs::write(
            folder.join(format!("map-{}.png", colormap.name())),
            encode_png(&picture(&sky, seen_by, &Horizon::flat(), &options)?, &Notes::default())?,
        )?;
    }
    Ok(())
}
