//! A rendered sky as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    accept::Format,
    answers::{Assumptions, PanoramaAnswer, compact_panorama},
    request::PictureRequest,
};
use skyglow_display::{
    Disc, DisplayError, Notes, PictureOptions, PointLight, Sky, SkyBodies, encode_exr, encode_png,
    encode_tiff, encode_webp, notes, picture_with, raster,
};
use skyglow_observatory::{
    GroundRequest, ObservatoryError, RenderedSky, SceneView, SkyRequest, lit_ground, night_sky::NightSky,
};
use skyglow_physics::{Response, spectrum::RGB_BANDS};
use std::cell::OnceCell;
use thiserror::Error;

/// A defect of the program: what is asked was checked before.
#[derive(Debug, Error)]
pub enum DrawingError {
    /// A picture or raster.
    #[error(transparent)]
    Display(#[from] DisplayError),
    /// Ground in light.
    #[error(transparent)]
    Ground(#[from] ObservatoryError),
    /// A document.
    #[error("writing JSON failed: {0}")]
    Json(#[from] serde_json::Error),
}

/// What of the ground a picture shows in light; None where it shows none.
fn ground_request(view: &PictureRequest, format: Format) -> Option<GroundRequest> {
    let albedo = view.options.ground.albedo().filter(|_| matches!(format, Format::Png | Format::WebP))?;
    let in_total = view.options.sky == Sky::Total;
    Some(GroundRequest { azimuths: view.options.azimuths(), albedo, in_total })
}

/// Draws and encodes what was rendered for a request in a scene; takes milliseconds to a second. Every format carries its assumptions, and says so where the
/// scene's light is made up; pictures do below the sky too, where they have a legend.
///
/// # Errors
/// [`DrawingError`], only by a defect.
pub fn draw(
    assumptions: Assumptions,
    (request, scene): (&SkyRequest, &SceneView),
    sky: &RenderedSky,
    view: &PictureRequest,
    format: Format,
) -> Result<Vec<u8>, DrawingError> {
    let total = (view.options.sky == Sky::Total).then(|| sky.seen_in_total());
    let light = if total.is_some() && sky.night.is_some() { Sky::TotalOfInstant } else { view.options.sky };
    let options = PictureOptions { illustrative: assumptions.scene.illustrative, sky: light, ..view.options };
    let notes = notes(&assumptions, options.sky)?;
    let ground = ground_request(view, format);
    let ground = ground.map(|wanted| lit_ground(scene, request, sky, &wanted)).transpose()?;
    let image = || {
        let seen = total.as_ref().unwrap_or(&sky.seen);
        let night = sky.night.as_ref().filter(|_| total.is_some());
        let bodies = night.map(bodies_of).unwrap_or_default();
        picture_with(&bodies, ground.as_ref(), seen, &sky.response, &sky.horizon, &options)
    };
    // Luminance is in R, G and B already, nearly: what else was asked for is a band of its own.
    let response = Some(&sky.response).filter(|response| **response != Response::Photopic);
    let bands = OnceCell::new();
    let floats = || {
        let wanted: Vec<Response> = RGB_BANDS.iter().chain(response).cloned().collect();
        let bands = bands.get_or_init(|| sky.seen_by(&wanted, total.is_some()));
        raster(bands, &sky.horizon, options.projection, view.raster_size_px, response)
    };
    Ok(match format {
        Format::Png => encode_png(&image()?, &notes)?,
        Format::WebP => encode_webp(&image()?, &notes)?,
        Format::Exr => encode_exr(&floats()?, &notes)?,
        Format::Tiff => encode_tiff(&floats()?, &notes)?,
        Format::Json => serde_json::to_vec(&PanoramaAnswer::new(assumptions, sky, view.options.sky))?,
        Format::Sky => {
            compact_panorama(assumptions, sky, &sky.night.as_ref().map(bodies_of).unwrap_or_default())?
        }
    })
}

/// Stars, planets, Moon and Sun for a picture.
fn bodies_of(night: &NightSky) -> SkyBodies {
    let points = night.points().into_iter().map(|point| PointLight {
        direction: point.direction,
        illuminance_lx: point.illuminance_lx,
        limit_mag: point.limit_mag,
    });
    let discs = night.discs().into_iter().map(|disc| {
        let lit_cd_m2 = disc.lit_cd_m2();
        Disc {
            direction: disc.point.direction,
            radius_rad: 0.5 * disc.diameter_rad,
            lit_cd_m2,
            dark_cd_m2: lit_cd_m2.map(|luminance| luminance * disc.dark_ratio),
            lit_share: disc.lit_share,
            bright_limb_rad: disc.bright_limb_rad,
        }
    });
    SkyBodies { points: points.collect(), discs: discs.collect() }
}

/// The words of a file: place, light, air, and whether the light was measured.
fn notes(assumptions: &Assumptions, light: Sky) -> Result<Notes, serde_json::Error> {
    let Assumptions { scene, observer, .. } = assumptions;
    let light = match light {
        Sky::Artificial => "artificial light alone",
        Sky::Total => "artificial light with the natural sky",
        Sky::TotalOfInstant => "artificial light with the natural sky of the time",
    };
    let mut words = format!(
        "Sky at {:.5}, {:.5} from {:.0} m: {light}; scene {}, turbidity {}, scattering {}, lamp {}, emission {}, coverage {:.2}",
        observer.latitude_deg,
        observer.longitude_deg,
        observer.altitude_m,
        scene.id,
        assumptions.turbidity,
        assumptions.scattering,
        assumptions.lamp.preset.as_deref().unwrap_or("custom"),
        assumptions.emission.preset.as_deref().unwrap_or("custom"),
        assumptions.coverage,
    );
    if let Some(time) = &assumptions.time {
        words.push_str(&format!(", time {time}"));
    }
    if assumptions.clouds != "none" {
        words.push_str(&format!(", clouds at {} m", assumptions.clouds));
        if let Some(cover) = assumptions.cloud_cover.filter(|cover| *cover < 1.0) {
            words.push_str(&format!(" over {:.0} % of the sky", 100.0 * cover));
        }
    }
    Ok(Notes::new(&notes::description(words, scene.illustrative), &serde_json::to_string(assumptions)?))
}
