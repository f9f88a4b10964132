//! The parameters of a view of a sky: projection, size and colours.

use super::sky::read_light;
use crate::{parameters as p, reader::Reader, validation::ValidationCode};
use serde::Serialize;
use skyglow_display::options::MAX_PICTURE_PX;
use skyglow_display::{
    Colormap, ColourRange, DynamicRange, GroundStyle, PictureOptions, Projection, Scale, Sky, Style,
};
use skyglow_physics::Response;

/// How a panorama is to be shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PictureRequest {
    /// Picture options; width and height are those given or the projection's own.
    pub options: PictureOptions,
    /// Width and height of a raster: those given or the raw grid's.
    pub raster_size_px: (u32, u32),
}

pub(super) fn read_view(reader: &mut Reader, response: &Response) -> PictureRequest {
    let projection = read_projection(reader);
    let style = read_style(reader, response);
    let ground = read_ground(reader, style);
    let dynamic_range = read_dynamic_range(reader, style);
    let sky = match (style, reader.text(&p::SKY)) {
        (Style::Eye { .. }, None) => Sky::Total,
        _ => read_light(reader),
    };
    let (width_px, height_px) = (reader.integer(&p::WIDTH), reader.integer(&p::HEIGHT_PX));
    let legend = reader.choice(&p::LEGEND) != Some("off");
    let sized = |own: (u32, u32)| (width_px.unwrap_or(own.0), height_px.unwrap_or(own.1));
    let picture_size_px = sized(projection.default_picture_size_px());
    check_pixels(reader, picture_size_px);
    PictureRequest {
        options: PictureOptions {
            projection,
            style,
            width_px: picture_size_px.0,
            height_px: picture_size_px.1,
            legend,
            sky,
            ground,
            dynamic_range,
            illustrative: false,
        },
        raster_size_px: sized(projection.default_raster_size_px()),
    }
}

fn read_ground(reader: &mut Reader, style: Style) -> GroundStyle {
    let ground = match reader.choice(&p::GROUND) {
        Some("lit") => GroundStyle::Lit,
        Some("snow") => GroundStyle::Snow,
        Some("water") => GroundStyle::Water,
        _ => GroundStyle::Dark,
    };
    if ground != GroundStyle::Dark && matches!(style, Style::FalseColour { .. }) {
        only_with(reader, &[&p::GROUND], "style=realistic or style=eye");
    }
    if ground != GroundStyle::Dark && reader.text(&p::TERRAIN) == Some("off") {
        only_with(reader, &[&p::GROUND], "terrain=on");
    }
    ground
}

fn read_dynamic_range(reader: &mut Reader, style: Style) -> DynamicRange {
    if reader.choice(&p::DYNAMIC_RANGE) != Some("hdr") {
        return DynamicRange::Standard;
    }
    if matches!(style, Style::FalseColour { .. }) {
        only_with(reader, &[&p::DYNAMIC_RANGE], "style=realistic or style=eye");
    }
    DynamicRange::High
}

/// Notes a picture of more pixels than one may ask for, though each side is in its range.
fn check_pixels(reader: &mut Reader, (width_px, height_px): (u32, u32)) {
    if u64::from(width_px) * u64::from(height_px) > u64::from(MAX_PICTURE_PX) {
        let parameter = if reader.text(&p::HEIGHT_PX).is_some() { &p::HEIGHT_PX } else { &p::WIDTH };
        let message = Some(format!("makes a picture of {width_px} x {height_px} pixels"));
        let allowed = Some(format!("at most {MAX_PICTURE_PX} pixels in all"));
        reader.fail(parameter, ValidationCode::NotAllowed, message, allowed);
    }
}

/// Notes parameters that say nothing under the choice made: silence would hide a slip.
fn only_with(reader: &mut Reader, parameters: &[&p::Parameter], choice: &str) {
    for parameter in parameters {
        if reader.text(parameter).is_some() {
            let message = Some(format!("means nothing without {choice}"));
            reader.fail(parameter, ValidationCode::Conflict, message, Some(format!("with {choice} alone")));
        }
    }
}

fn read_projection(reader: &mut Reader) -> Projection {
    let named = reader.choice(&p::PROJECTION);
    let azimuth_deg = reader.number(&p::AZIMUTH);
    let elevation_deg = reader.number(&p::ELEVATION);
    let fov_deg = reader.number(&p::FOV);
    if named == Some("perspective") {
        return Projection::Perspective {
            azimuth_deg: azimuth_deg.unwrap_or(0.0),
            elevation_deg: elevation_deg.unwrap_or(skyglow_display::options::DEFAULT_ELEVATION_DEG),
            fov_deg: fov_deg.unwrap_or(skyglow_display::options::DEFAULT_FOV_DEG),
        };
    }
    only_with(reader, &[&p::AZIMUTH, &p::ELEVATION, &p::FOV], "projection=perspective");
    if named == Some("fisheye") { Projection::Fisheye } else { Projection::Equirectangular }
}

fn read_style(reader: &mut Reader, response: &Response) -> Style {
    let style = reader.choice(&p::STYLE);
    let in_colour = matches!(style, Some("realistic" | "eye"));
    let colormap = reader.choice(&p::COLORMAP).and_then(Colormap::from_name).unwrap_or_default();
    let scale = match reader.choice(&p::SCALE) {
        Some("magnitude") => Scale::Magnitude,
        _ => Scale::Luminance,
    };
    let exposure_ev = reader.number(&p::EXPOSURE);
    let adaptation_cd_m2 = reader.number(&p::ADAPTATION);
    if scale == Scale::Magnitude && !response.has_magnitude() {
        let message = Some(format!("means nothing for what {} sees", response.name()));
        let allowed = Some("with photopic, sqm, johnson_b, johnson_v or johnson_r".to_owned());
        reader.fail(&p::SCALE, ValidationCode::Conflict, message, allowed);
    }
    if in_colour && *response != Response::Photopic {
        let message = Some("means nothing for a picture in the colours that an eye sees".to_owned());
        let allowed = Some("with style=false_colour alone".to_owned());
        reader.fail(&p::RESPONSE, ValidationCode::Conflict, message, allowed);
    }
    let default = ColourRange::for_response(scale, response);
    let min = reader.number_of_any_size(&p::MIN).unwrap_or(default.min);
    let max = reader.number_of_any_size(&p::MAX).unwrap_or(default.max);
    if in_colour {
        only_with(reader, &[&p::COLORMAP, &p::SCALE, &p::MIN, &p::MAX], "style=false_colour");
        let exposure_ev = exposure_ev.unwrap_or(0.0);
        let is_eye = style == Some("eye");
        if is_eye {
            return Style::Eye { exposure_ev, adaptation_cd_m2 };
        }
        only_with(reader, &[&p::ADAPTATION], "style=eye");
        return Style::Realistic { exposure_ev };
    }
    only_with(reader, &[&p::EXPOSURE], "style=realistic or style=eye");
    only_with(reader, &[&p::ADAPTATION], "style=eye");
    let range = ColourRange { scale, min, max };
    if let Err(error) = range.check() {
        // The end that the error names; where both are fine alone, the one that was given.
        let given_max = reader.text(&p::MAX).is_some();
        let parameter = match &error {
            skyglow_display::DisplayError::OutOfRange { option: "max", .. } => &p::MAX,
            skyglow_display::DisplayError::EmptyRange { .. } if given_max => &p::MAX,
            _ => &p::MIN,
        };
        reader.fail(parameter, ValidationCode::NotAllowed, Some(error.to_string()), None);
    }
    Style::FalseColour { colormap, range }
}
