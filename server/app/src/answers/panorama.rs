//! A panorama's raw grid.

use super::Assumptions;
use serde::Serialize;
use skyglow_display::Sky;
use skyglow_observatory::RenderedSky;
use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT, SkyQuantities, spectrum::RGB_BANDS};
use utoipa::ToSchema;

/// The grid of a panorama.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PanoramaGrid {
    /// Columns.
    pub azimuth_count: usize,
    /// Rows.
    pub elevation_count: usize,
    /// Azimuth of column 0, degrees clockwise from north.
    pub azimuth_first_deg: f64,
    /// Degrees from column to column.
    pub azimuth_step_deg: f64,
    /// Elevation of row 0, the lowest, degrees.
    pub elevation_first_deg: f64,
    /// Degrees from row to row.
    pub elevation_step_deg: f64,
}

impl Default for PanoramaGrid {
    fn default() -> Self {
        Self {
            azimuth_count: AZIMUTH_COUNT,
            elevation_count: ELEVATION_COUNT,
            azimuth_first_deg: 0.0,
            azimuth_step_deg: 360.0 / AZIMUTH_COUNT as f64,
            elevation_first_deg: 0.5 * 90.0 / ELEVATION_COUNT as f64,
            elevation_step_deg: 90.0 / ELEVATION_COUNT as f64,
        }
    }
}

/// A panorama's samples and numbers.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PanoramaAnswer {
    /// What it depends on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// Where the samples are.
    pub grid: PanoramaGrid,
    /// First and last wavelength of the bands R, G, B, nm.
    pub bands_nm: [[f64; 2]; 3],
    /// Unit of `radiance`.
    pub unit: String,
    /// Which light the samples hold: `artificial` or `total`.
    pub light: Light,
    /// `radiance[band][row][column]`; 0 below the horizon, whichever light.
    pub radiance: Vec<Vec<Vec<f32>>>,
    /// What the response sees, `values[row][column]`, in its unit; 0 below the horizon, whichever light.
    pub values: Vec<Vec<f32>>,
    /// Elevation below which the terrain hides the sky, by column, degrees, 0 to 90: 0 everywhere where
    /// `terrain_occlusion` is false.
    pub horizon_deg: Vec<f64>,
    /// The numbers.
    pub sky: SkyQuantities,
}

/// Which light.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Light {
    /// Artificial light alone.
    Artificial,
    /// With the natural sky, that of the time where one was asked for.
    Total,
}

impl PanoramaAnswer {
    /// The answer for a rendered sky.
    pub fn new(assumptions: Assumptions, sky: &RenderedSky, light: Sky) -> Self {
        let total = (light == Sky::Total).then(|| sky.seen_in_total());
        let bands = sky.seen_by(&RGB_BANDS, total.is_some());
        let seen = total.as_ref().unwrap_or(&sky.seen);
        // Nothing is seen where ground hides the sky.
        let rows = |plane: &[f32]| plane.chunks_exact(AZIMUTH_COUNT).map(<[f32]>::to_vec).collect();
        Self {
            assumptions,
            grid: PanoramaGrid::default(),
            bands_nm: [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]],
            unit: "W m-2 sr-1".to_owned(),
            light: match light {
                Sky::Artificial => Light::Artificial,
                Sky::Total | Sky::TotalOfInstant => Light::Total,
            },
            radiance: (0..RGB_BANDS.len()).map(|place| rows(bands.plane(place))).collect(),
            values: rows(seen.seen_by(&sky.response).unwrap_or_default()),
            horizon_deg: sky
                .horizon
                .elevations_rad()
                .iter()
                .map(|elevation| elevation.to_degrees())
                .collect(),
            sky: sky.quantities.clone(),
        }
    }
}
