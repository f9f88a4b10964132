//! Options and progress of an ingest.

use super::date::{FORMS, is_date};
use crate::error::SceneError;
use crate::scene_id::SceneId;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The unit of the raster's radiances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RadianceUnit {
    /// nW cm⁻² sr⁻¹, as the VIIRS products have it.
    NanowattPerSquareCentimetreSteradian,
    /// W m⁻² sr⁻¹.
    WattPerSquareMetreSteradian,
}

impl RadianceUnit {
    /// From the command line's spelling, `nw-cm2-sr` or `w-m2-sr`.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        match text {
            "nw-cm2-sr" => Ok(Self::NanowattPerSquareCentimetreSteradian),
            "w-m2-sr" => Ok(Self::WattPerSquareMetreSteradian),
            _ => Err(SceneError::InvalidOption {
                option: "--units",
                reason: format!("\"{text}\" is no unit; nw-cm2-sr and w-m2-sr are known"),
            }),
        }
    }

    /// nW cm⁻² sr⁻¹ in one of the unit.
    pub fn nw_cm2_sr(self) -> f64 {
        match self {
            Self::NanowattPerSquareCentimetreSteradian => 1.0,
            Self::WattPerSquareMetreSteradian => 1e5,
        }
    }
}

/// The options of `skyglow ingest`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct IngestOptions {
    /// The radiance raster: GeoTIFF, COG or HDF5.
    pub radiance: PathBuf,
    /// Terrain rasters: GeoTIFF or SRTM `.hgt`; the first that has a value counts.
    pub terrain: Vec<PathBuf>,
    /// The scene's id; by default the file's name made one.
    pub id: Option<SceneId>,
    /// Title for people; by default the id.
    pub title: Option<String>,
    /// When the radiances were taken: a year, month, day or instant in UTC, or a span of two with `/`.
    pub date: Option<String>,
    /// Whom to credit.
    pub attribution: Option<String>,
    /// GeoJSON or CSV of named places.
    pub places: Option<PathBuf>,
    /// Subdataset or band: its name, or the band's number from 1.
    pub band: Option<String>,
    /// Factor on the stored numbers, instead of the file's own scale (its offset is then not used).
    pub scale: Option<f64>,
    /// Unit after scaling; by default nW cm⁻² sr⁻¹.
    pub units: Option<RadianceUnit>,
    /// Factor on the radiances wherever flux is made of them; 1 by default.
    pub calibration: f64,
    /// Overwrite a scene of the same id.
    pub replace: bool,
    /// Pixels that a raster may have; None for trusted input.
    pub max_pixels: Option<u64>,
}

/// Longest side of an untrusted raster, pixels: five times around the Earth at 15″.
const MAX_SIDE: usize = 500_000;

impl IngestOptions {
    /// Refuses rasters of absurd size, before memory is taken for a row of one.
    pub(super) fn check_size(&self, (width, height): (usize, usize)) -> Result<(), String> {
        let Some(max) = self.max_pixels else { return Ok(()) };
        let is_small = width.max(height) <= MAX_SIDE && width as u64 * height as u64 <= max;
        let reason = || {
            format!("it has {width} x {height} pixels; allowed are {max} in all, and {MAX_SIDE} along a side")
        };
        if is_small { Ok(()) } else { Err(reason()) }
    }

    /// The defaults for a raster.
    pub fn new(radiance: impl Into<PathBuf>) -> Self {
        Self {
            radiance: radiance.into(),
            terrain: Vec::new(),
            id: None,
            title: None,
            date: None,
            attribution: None,
            places: None,
            band: None,
            scale: None,
            units: None,
            calibration: 1.0,
            replace: false,
            max_pixels: None,
        }
    }

    /// Checks the numbers and the date.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let positive = |option, value: f64| {
            if value.is_finite() && value > 0.0 {
                return Ok(());
            }
            let reason = format!("{value} is not allowed; it must be a number above 0");
            Err(SceneError::InvalidOption { option, reason })
        };
        positive("--calibration", self.calibration)?;
        positive("--scale", self.scale.unwrap_or(1.0))?;
        match &self.date {
            Some(date) if !is_date(date) => {
                let reason = format!("\"{date}\" is no date; {FORMS}");
                Err(SceneError::InvalidOption { option: "--date", reason })
            }
            _ => Ok(()),
        }
    }
}

/// What an ingest is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IngestStage {
    /// Making the demo's rasters.
    Generate,
    /// Reading the radiance raster, in rows.
    Radiance,
    /// Reading terrain, in rows of all files.
    Terrain,
    /// Finding the altitude of each lit pixel.
    Altitude,
    /// Looking around from each lit pixel for terrain that hides its light.
    Skyline,
    /// Writing the scene.
    Store,
}

/// How far a stage is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IngestProgress {
    /// The stage.
    pub stage: IngestStage,
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
}
