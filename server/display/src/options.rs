//! What a picture is asked to be, and the ranges that are checked in one place.

use crate::{
    colormap::Colormap,
    error::{DisplayError, check},
    eye::ADAPTATION_RANGE_CD_M2,
    false_colour::ColourRange,
    realistic::EXPOSURE_RANGE_EV,
};
use serde::{Deserialize, Serialize};
use skyglow_physics::multiple_scattering::DEFAULT_GROUND_ALBEDO;

/// Smallest width or height of the sky in a picture, pixels.
pub const MIN_SIDE_PX: u32 = 16;
/// Largest width or height of the sky in a picture, pixels.
pub const MAX_SIDE_PX: u32 = 4096;
/// Most pixels of the sky in a picture or raster: one is drawn in at most about a second, so that nobody who asks for
/// large ones keeps the others waiting.
pub const MAX_PICTURE_PX: u32 = 8 << 20;
/// Allowed field of view of [`Projection::Perspective`], degrees.
pub const FOV_RANGE_DEG: (f64, f64) = (1.0, 150.0);
/// Field of view when none is given, degrees.
pub const DEFAULT_FOV_DEG: f64 = 90.0;
/// Elevation of the picture's centre in a perspective when none is given, degrees.
pub const DEFAULT_ELEVATION_DEG: f64 = 20.0;

/// How directions become pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub enum Projection {
    /// Azimuth along the width, column `c` of `w` at `c·360/w` degrees (column 0 north); elevation along the
    /// height, zenith at the top, pixel centres at `90 − (y + ½)·90/h` degrees. 256 × 64 is the raw grid.
    #[default]
    Equirectangular,
    /// Zenithal equidistant: zenith in the centre, distance from it proportional to the zenith angle, the
    /// horizon touching the nearer edge; north up, east left as on sky charts.
    Fisheye,
    /// What a camera sees (rectilinear); east is right of north when looking north.
    Perspective {
        /// Azimuth of the picture's centre, degrees clockwise from north.
        azimuth_deg: f64,
        /// Elevation of the picture's centre, degrees, −90..=90.
        elevation_deg: f64,
        /// Horizontal field of view, degrees, [`FOV_RANGE_DEG`].
        fov_deg: f64,
    },
}

impl Projection {
    /// The name used in requests.
    pub const fn name(self) -> &'static str {
        match self {
            Projection::Equirectangular => "equirectangular",
            Projection::Fisheye => "fisheye",
            Projection::Perspective { .. } => "perspective",
        }
    }

    /// Width and height of a picture for eyes when none are given, pixels.
    pub const fn default_picture_size_px(self) -> (u32, u32) {
        match self {
            Projection::Equirectangular => (1024, 256),
            Projection::Fisheye => (768, 768),
            Projection::Perspective { .. } => (1024, 576),
        }
    }

    /// Width and height of a raster for programs when none are given, pixels; the raw grid where it fits.
    pub const fn default_raster_size_px(self) -> (u32, u32) {
        match self {
            Projection::Equirectangular => (256, 64),
            Projection::Fisheye => (256, 256),
            Projection::Perspective { .. } => (256, 144),
        }
    }

    /// Checks the angles.
    ///
    /// # Errors
    /// [`DisplayError::OutOfRange`] naming `azimuth`, `elevation` or `fov`.
    pub fn check(self) -> Result<(), DisplayError> {
        if let Projection::Perspective { azimuth_deg, elevation_deg, fov_deg } = self {
            check("azimuth", azimuth_deg, -360.0, 360.0, " degrees")?;
            check("elevation", elevation_deg, -90.0, 90.0, " degrees")?;
            check("fov", fov_deg, FOV_RANGE_DEG.0, FOV_RANGE_DEG.1, " degrees")?;
        }
        Ok(())
    }
}

/// Which light is shown: what a picture is made of has it already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sky {
    /// Artificial light alone.
    #[default]
    Artificial,
    /// With the natural sky: the dark reference.
    Total,
    /// With the natural sky of an instant.
    TotalOfInstant,
}

/// How radiance becomes colour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Style {
    /// What the response sees through a colour map.
    FalseColour {
        /// The colour map.
        colormap: Colormap,
        /// What the map's ends mean.
        range: ColourRange,
    },
    /// As the eye sees it.
    Eye {
        /// Stops above the adapted eye, [`EXPOSURE_RANGE_EV`].
        exposure_ev: f64,
        /// Luminance that it is adapted to, [`ADAPTATION_RANGE_CD_M2`]; None: the mean of the sky.
        adaptation_cd_m2: Option<f64>,
    },
    /// As a camera with a fixed exposure would show it.
    Realistic {
        /// Stops above the reference exposure, [`EXPOSURE_RANGE_EV`].
        exposure_ev: f64,
    },
}

impl Default for Style {
    fn default() -> Self {
        Style::FalseColour { colormap: Colormap::default(), range: ColourRange::default() }
    }
}

/// How bright a picture's lights may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum DynamicRange {
    /// No brighter than white, for every screen.
    #[default]
    Standard,
    /// Above white, for screens that can: [`crate::hdr_picture_with`].
    High,
}

/// What ground below the horizon looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum GroundStyle {
    /// A silhouette.
    #[default]
    Dark,
    /// As the sky, Moon and lamps light it.
    Lit,
    /// The same under snow.
    Snow,
    /// As it is lit, where water is calm, and mirrors.
    Water,
}

impl GroundStyle {
    /// Share of light that it reflects; None for a silhouette. That of bare and green land is the one that lamps' light has to the
    /// sky; that of snow is of an old cover (Warren 1982).
    pub const fn albedo(self) -> Option<f64> {
        match self {
            GroundStyle::Dark => None,
            GroundStyle::Lit | GroundStyle::Water => Some(DEFAULT_GROUND_ALBEDO),
            GroundStyle::Snow => Some(0.75),
        }
    }
}

/// Everything that decides a picture's pixels, given the panorama.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PictureOptions {
    /// How directions become pixels.
    pub projection: Projection,
    /// How radiance becomes colour.
    pub style: Style,
    /// Width of the sky, pixels.
    pub width_px: u32,
    /// Height of the sky, pixels; the legend comes below it.
    pub height_px: u32,
    /// Compass letters on the sky and a labelled strip below it.
    pub legend: bool,
    /// Which light is shown.
    pub sky: Sky,
    /// What the ground looks like.
    pub ground: GroundStyle,
    /// How bright lights may be; of the styles of eye and camera alone.
    pub dynamic_range: DynamicRange,
    /// Whether the light is made up: the legend then says so.
    pub illustrative: bool,
}

impl PictureOptions {
    /// A projection at its own size, false colour, with its legend.
    pub fn new(projection: Projection) -> Self {
        let (width_px, height_px) = projection.default_picture_size_px();
        Self {
            projection,
            style: Style::default(),
            width_px,
            height_px,
            legend: true,
            sky: Sky::default(),
            ground: GroundStyle::default(),
            dynamic_range: DynamicRange::default(),
            illustrative: false,
        }
    }

    /// Checks sizes, angles, range and exposure.
    ///
    /// # Errors
    /// The first [`DisplayError`] found, naming the option.
    pub fn check(&self) -> Result<(), DisplayError> {
        check_size(self.width_px, self.height_px)?;
        self.projection.check()?;
        match self.style {
            Style::FalseColour { .. } if self.ground != GroundStyle::Dark => {
                Err(DisplayError::LitInFalseColour)
            }
            Style::FalseColour { .. } if self.dynamic_range == DynamicRange::High => {
                Err(DisplayError::HighInFalseColour)
            }
            Style::FalseColour { range, .. } => range.check(),
            Style::Realistic { exposure_ev } => check_exposure(exposure_ev),
            Style::Eye { exposure_ev, adaptation_cd_m2 } => {
                let (darkest, brightest) = ADAPTATION_RANGE_CD_M2;
                check_exposure(exposure_ev)?;
                check("adaptation", adaptation_cd_m2.unwrap_or(darkest), darkest, brightest, " cd/m2")
            }
        }
    }
}

fn check_exposure(exposure_ev: f64) -> Result<(), DisplayError> {
    check("exposure", exposure_ev, EXPOSURE_RANGE_EV.0, EXPOSURE_RANGE_EV.1, " EV")
}

/// Checks a width and height in pixels.
pub(crate) fn check_size(width_px: u32, height_px: u32) -> Result<(), DisplayError> {
    let (low, high) = (f64::from(MIN_SIDE_PX), f64::from(MAX_SIDE_PX));
    check("width", f64::from(width_px), low, high, " px")?;
    let highest = f64::from(MAX_PICTURE_PX / width_px).min(high);
    check("height_px", f64::from(height_px), low, highest, " px")
}
