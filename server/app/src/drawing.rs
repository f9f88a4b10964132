//! A rendered sky as the bytes of a file: what the HTTP interface answers and the command line writes.

use crate::{
    accept::Format,
    answers::{Assumptions, PanoramaAnswer, compact_panorama},
    request::PictureRequest,
    sky_bodies::bodies_of,
};
use skyglow_display::{
    DisplayError, DynamicRange, GroundStyle, Notes, PictureOptions, Sky, encode_exr, encode_hdr_png,
    encode_png, encode_tiff, encode_webp, hdr_picture_with, notes, picture_with, raster,
};
use skyglow_observatory::{GroundRequest, ObservatoryError, RenderedSky, SceneView, SkyRequest, lit_ground};
use skyglow_physics::{Response, spectrum::RGB_BANDS};
use skyglow_scene::GroundSight;
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
    let sight =
        GroundSight { azimuths: view.options.azimuths(), lowest_tangent: view.options.lowest_tangent() };
    let [has_snow, has_water] =
        [GroundStyle::Snow, GroundStyle::Water].map(|style| view.options.ground == style);
    Some(GroundRequest { sight, albedo, has_snow, in_total, has_water })
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
    let notes = notes(&assumptions, &options)?;
    let ground = ground_request(view, format);
    let ground = ground.map(|wanted| lit_ground(scene, request, sky, &wanted)).transpose()?;
    let seen = total.as_ref().unwrap_or(&sky.seen);
    let bodies = || sky.night.as_ref().filter(|_| total.is_some()).map(bodies_of).unwrap_or_default();
    let image = || picture_with(&bodies(), ground.as_ref(), seen, &sky.response, &sky.horizon, &options);
    let hdr_image =
        || hdr_picture_with(&bodies(), ground.as_ref(), seen, &sky.response, &sky.horizon, &options);
    // Luminance is in R, G and B already, nearly: what else was asked for is a band of its own.
    let response = Some(&sky.response).filter(|response| **response != Response::Photopic);
    let bands = OnceCell::new();
    let floats = || {
        let wanted: Vec<Response> = RGB_BANDS.iter().chain(response).cloned().collect();
        let bands = bands.get_or_init(|| sky.seen_by(&wanted, total.is_some()));
        raster(bands, &sky.horizon, options.projection, view.raster_size_px, response)
    };
    Ok(match format {
        Format::Png if options.dynamic_range == DynamicRange::High => encode_hdr_png(&hdr_image()?, &notes)?,
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

/// The words of a file: place, light, air, and whether the light was measured.
fn notes(assumptions: &Assumptions, options: &PictureOptions) -> Result<Notes, serde_json::Error> {
    let Assumptions { scene, observer, .. } = assumptions;
    let light = match options.sky {
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
    if options.dynamic_range == DynamicRange::High {
        words.push_str(", rendered for screens that go above white: no photometry");
    }
    if let Some(time) = &assumptions.time {
        words.push_str(&format!(", time {time}"));
    }
    if assumptions.clouds != "none" {
        words.push_str(&format!(", clouds at {} m", assumptions.clouds));
        if let Some(cover) = assumptions.cloud_cover.filter(|cover| *cover < 1.0) {
            words.push_str(&format!(" over {:.0} % of the sky", 100.0 * cover));
        }
    }
    match options.ground {
        GroundStyle::Dark => {}
        GroundStyle::Lit => words.push_str(", the ground as it is lit"),
        GroundStyle::Snow => words.push_str(", the ground under snow"),
        GroundStyle::Water => words.push_str(", the ground as it is lit, water calm"),
    }
    Ok(Notes::new(&notes::description(words, scene.illustrative), &serde_json::to_string(assumptions)?))
}
