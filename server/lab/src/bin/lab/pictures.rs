//! Pictures of every kind, and how long each takes.

use crate::arguments::Outcome;
use skyglow_display::{
    Colormap, Notes, PictureOptions, Projection, Sky, Style, encode_exr, encode_png, encode_tiff,
    encode_webp, picture, raster,
};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Direction, ELEVATION_COUNT, Horizon, Lamp, LampPreset, Panorama, panorama,
};
use std::{path::PathBuf, time::Instant};

/// A large sodium town in the east, a small LED town in the north-north-west, a dark south.
fn invented_sky() -> Panorama {
    let towns: [(f64, f64, f64, Lamp); 2] =
        [(90.0, 1e-4, 25.0, LampPreset::Hps.lamp()), (340.0, 8e-6, 12.0, LampPreset::Led4000k.lamp())];
    let mut sky = Panorama::dark();
    for row in 0..ELEVATION_COUNT {
        for column in 0..AZIMUTH_COUNT {
            let at = Direction {
                azimuth_rad: panorama::azimuth_rad(column),
                elevation_rad: panorama::elevation_rad(row),
            };
            for band in 0..BAND_COUNT {
                let mut radiance = 1.5e-8;
                for (azimuth_deg, strength, width_deg, lamp) in towns {
                    let town = Direction { azimuth_rad: f64::to_radians(azimuth_deg), elevation_rad: 0.0 };
                    let angle_deg = at.enu().dot(town.enu()).clamp(-1.0, 1.0).acos().to_degrees();
                    radiance += strength * lamp.flux_per_dnb_flux[band] * (-angle_deg / width_deg).exp();
                }
                sky.samples_mut()[Panorama::index(band, row, column)] = radiance as f32;
            }
        }
    }
    sky
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
    let sky = invented_sky();
    let camera = Projection::Perspective { azimuth_deg: 60.0, elevation_deg: 20.0, fov_deg: 90.0 };
    for projection in [Projection::Equirectangular, Projection::Fisheye, camera] {
        for (style_name, style) in
            [("false", Style::default()), ("realistic", Style::Realistic { exposure_ev: 0.0 })]
        {
            let options = PictureOptions { style, ..PictureOptions::new(projection) };
            let name = format!("{}-{style_name}", projection.name());
            let image = timed(&format!("{name} picture"), || picture(&sky, &Horizon::flat(), &options))?;
            let bytes = timed(&format!("{name} PNG"), || encode_png(&image, &Notes::default()))?;
            std::fs::write(folder.join(format!("{name}.png")), bytes)?;
            let bytes = timed(&format!("{name} WebP"), || encode_webp(&image, &Notes::default()))?;
            std::fs::write(folder.join(format!("{name}.webp")), bytes)?;
        }
        let name = projection.name();
        let size = projection.default_raster_size_px();
        // Pixels are found as they are encoded.
        let flat = Horizon::flat();
        let floats = raster(&sky, &flat, projection, size, Sky::Artificial)?;
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
            sky: Sky::Total,
            width_px: 640,
            height_px: 160,
            ..PictureOptions::new(Projection::Equirectangular)
        };
        std::fs::write(
            folder.join(format!("map-{}.png", colormap.name())),
            encode_png(&picture(&sky, &Horizon::flat(), &options)?, &Notes::default())?,
        )?;
    }
    Ok(())
}
