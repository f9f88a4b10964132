//! A compact panorama: the header of its file, and what follows.

use super::{Assumptions, Light, PanoramaGrid};
use serde::Serialize;
use skyglow_display::{LogPlane, PointTable, SkyBodies, encode::STEPS_PER_E, encode_sky};
use skyglow_observatory::RenderedSky;
use skyglow_physics::{Direction, SeenSky};
use utoipa::ToSchema;

/// The header of a compact panorama; samples and points follow it (docs/guide.md).
#[derive(Debug, Serialize, ToSchema)]
pub struct CompactHeader {
    /// What the sky depends on.
    #[serde(flatten)]
    assumptions: Assumptions,
    /// Where the samples are.
    grid: PanoramaGrid,
    /// Steps of the logarithm in a factor of e.
    steps_per_e: f64,
    /// Planes in their order, four or five of each light; the second of each is photopic.
    planes: Vec<CompactPlane>,
    /// Elevation below which the terrain hides the sky, by column, degrees.
    horizon_deg: Vec<f64>,
    /// Stars and planets that are seen; none without a time.
    points: CompactPoints,
    /// Moon and Sun above the horizon.
    discs: Vec<CompactDisc>,
}

/// What one response sees.
#[derive(Debug, Serialize, ToSchema)]
pub struct CompactPlane {
    /// Its name.
    response: String,
    /// Unit of its values.
    unit: &'static str,
    /// Artificial light, or all light at the time.
    light: Light,
    /// The value of code 1; code c is `lowest · exp((c − 1) / steps_per_e)`, and 0 is darkness.
    lowest: f64,
    /// What the response sees of the dark reference, which adds to a clear sky's artificial light where no time was asked for.
    natural: f64,
}

/// Points of light.
#[derive(Debug, Serialize, ToSchema)]
pub struct CompactPoints {
    /// How many.
    count: usize,
    /// The values of code 1 of X, photopic, Z and scotopic illuminance, lx.
    lowest_lx: [f64; 4],
}

/// Moon or Sun.
#[derive(Debug, Serialize, ToSchema)]
pub struct CompactDisc {
    /// Of its middle, degrees clockwise from north.
    azimuth_deg: f64,
    /// Of its middle, degrees.
    elevation_deg: f64,
    /// Apparent radius, degrees.
    radius_deg: f64,
    /// X, photopic, Z and scotopic luminance of the lit part.
    lit_cd_m2: [f64; 4],
    /// The same of the dark part: earthshine.
    dark_cd_m2: [f64; 4],
    /// Lit part of the disc, 0 to 1.
    lit_share: f64,
    /// Direction of the bright limb, degrees from up towards growing azimuth.
    bright_limb_deg: f64,
}

/// Thousandths of a degree: a sample is a thousand times as wide.
fn short(degrees: f64) -> f64 {
    (degrees * 1e3).round() / 1e3
}

/// Artificial light as X, Y, Z, the dark-adapted eye and the response that was asked for see it, and at a time or under broken clouds all light, with those
/// of `bodies` that are seen.
///
/// # Errors
/// A header that is no JSON, by a defect.
pub fn compact_panorama(
    assumptions: Assumptions,
    sky: &RenderedSky,
    bodies: &SkyBodies,
) -> Result<Vec<u8>, serde_json::Error> {
    let total = (sky.night.is_some() || sky.gaps.is_some()).then(|| sky.seen_in_total());
    let mut planes = Vec::new();
    let mut group = |seen: &SeenSky, light: Light| {
        let coded = LogPlane::of_sky(seen, &sky.horizon);
        planes.extend(seen.responses().iter().zip(&coded).map(|(response, plane)| CompactPlane {
            response: response.name().to_owned(),
            unit: response.unit(),
            light,
            lowest: plane.lowest,
            natural: sky.context.dark.value(response),
        }));
        coded
    };
    let mut groups = vec![group(&sky.seen, Light::Artificial)];
    groups.extend(total.as_ref().map(|total| group(total, Light::Total)));
    let points = total.map(|total| bodies.seen_points(&total, &sky.horizon)).unwrap_or_default();
    let points = PointTable::new(points);
    let degrees =
        |Direction { azimuth_rad, elevation_rad }| (azimuth_rad.to_degrees(), elevation_rad.to_degrees());
    let header = CompactHeader {
        assumptions,
        grid: PanoramaGrid::default(),
        steps_per_e: STEPS_PER_E,
        planes,
        horizon_deg: sky.horizon.elevations_rad().iter().map(|e| short(e.to_degrees())).collect(),
        points: CompactPoints {
            count: points.len(),
            lowest_lx: points.planes.each_ref().map(|plane| plane.lowest),
        },
        discs: bodies
            .discs
            .iter()
            .map(|disc| {
                let (azimuth_deg, elevation_deg) = degrees(disc.direction);
                CompactDisc {
                    azimuth_deg,
                    elevation_deg,
                    radius_deg: disc.radius_rad.to_degrees(),
                    lit_cd_m2: disc.lit_cd_m2,
                    dark_cd_m2: disc.dark_cd_m2,
                    lit_share: disc.lit_share,
                    bright_limb_deg: disc.bright_limb_rad.to_degrees(),
                }
            })
            .collect(),
    };
    Ok(encode_sky(&serde_json::to_vec(&header)?, &groups, &points))
}
