//! Options and progress of an ingest.

use super::date::{FORMS, is_date};
use super::land_classes::LandClasses;
use super::overlap_rule::OverlapRule;
use super::units::{RadianceUnit, metres_in};
use crate::error::SceneError;
use crate::scene_id::SceneId;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What becomes of noise around zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoisePolicy {
    /// Negative values take as much from the faintest pixels around them: the light of every block stays the sum of its pixels.
    #[default]
    Balance,
    /// Negative values count as dark, and the positive half of the noise as light.
    Cut,
}

impl NoisePolicy {
    /// From the command line's spelling, `balance` or `cut`.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        match text {
            "balance" => Ok(Self::Balance),
            "cut" => Ok(Self::Cut),
            _ => Err(SceneError::InvalidOption {
                option: "--noise",
                reason: format!("\"{text}\" is neither balance nor cut"),
            }),
        }
    }
}

/// When it is found what terrain hides of each light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SkylineTime {
    /// At ingest, for all lights.
    Ingest,
    /// When a place first needs it, for the lights around that place; then it is kept.
    Need,
}

impl SkylineTime {
    /// With more lights they are found when they are needed, if nobody says otherwise.
    const MAX_LIGHTS_AT_INGEST: usize = 500_000;

    /// From the command line's spelling, `ingest` or `need`.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        match text {
            "ingest" => Ok(Self::Ingest),
            "need" => Ok(Self::Need),
            _ => Err(SceneError::InvalidOption {
                option: "--skylines",
                reason: format!("\"{text}\" is neither ingest nor need"),
            }),
        }
    }

    /// What is done where nobody says.
    pub(super) fn of_lights(lights: usize) -> Self {
        if lights > Self::MAX_LIGHTS_AT_INGEST { Self::Need } else { Self::Ingest }
    }
}

/// The options of `skyglow ingest`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct IngestOptions {
    /// The radiance rasters, GeoTIFF, COG or HDF5, plain or in gzip or zip: one, or several on one grid. Of whoever is trusted also folders, lists (`.txt`) and virtual rasters of local files.
    pub radiance: Vec<PathBuf>,
    /// Which measurement of a pixel counts where several rasters have one.
    #[serde(default)]
    pub overlap: OverlapRule,
    /// Terrain rasters: GeoTIFF or SRTM `.hgt`; the first that has a value counts.
    pub terrain: Vec<PathBuf>,
    /// Rasters of classes of land cover, GeoTIFF or COG; the first that knows a place counts.
    #[serde(default)]
    pub land_cover: Vec<PathBuf>,
    /// Whose classes they are; by default WorldCover's, where there are no others.
    #[serde(default)]
    pub land_cover_classes: Option<LandClasses>,
    /// The scene's id; by default the file's name made one.
    pub id: Option<SceneId>,
    /// Title for people; by default the id.
    pub title: Option<String>,
    /// When the radiances were taken: a year, month, day or instant in UTC, or a span of two with `/`.
    pub date: Option<String>,
    /// Whom to credit.
    pub attribution: Option<String>,
    /// GeoJSON or CSV of named places; without them those of the gazetteer inside the scene.
    pub places: Option<PathBuf>,
    /// Subdataset or band: its name, or the band's number from 1.
    pub band: Option<String>,
    /// Factor on the stored numbers, instead of the file's own scale (its offset is then not used).
    pub scale: Option<f64>,
    /// Unit after scaling; by default what the file says, and nW cm⁻² sr⁻¹ where it says nothing.
    pub units: Option<RadianceUnit>,
    /// Stored values that are no data, beside those that the file declares.
    pub no_data: Vec<f64>,
    /// Zero is dark ground though the file declares it no data.
    pub zero_is_dark: bool,
    /// Radiances below this are dark, nW cm⁻² sr⁻¹.
    pub floor_nw_cm2_sr: Option<f64>,
    /// Radiances above this count as this, nW cm⁻² sr⁻¹.
    pub cap_nw_cm2_sr: Option<f64>,
    /// Rasters on the radiances' grid that are 0 or no data where what is measured is no light: one for each radiance raster.
    pub masks: Vec<PathBuf>,
    /// Values of the quality layer that are taken; pixels of others are no data. None for all.
    pub quality: Option<Vec<i64>>,
    /// Quality layers as rasters on the radiances' grid; granules have their own.
    pub quality_files: Vec<PathBuf>,
    /// Pixels with fewer observations are no data.
    pub min_observations: Option<u32>,
    /// Numbers of observations as rasters on the radiances' grid; granules have their own.
    pub observation_files: Vec<PathBuf>,
    /// What becomes of noise around zero.
    pub noise: NoisePolicy,
    /// When skylines of lights are found; None: when they are needed where there are very many lights, else at ingest.
    #[serde(default)]
    pub skylines: Option<SkylineTime>,
    /// Unit of the terrain, such as `m` or `ft`; by default what each file says, and metres where it says nothing.
    pub terrain_units: Option<String>,
    /// Factor on the radiances wherever flux is made of them; 1 by default.
    pub calibration: f64,
    /// Overwrite a scene of the same id.
    pub replace: bool,
    /// Pixels that a raster may have; None for trusted input.
    pub max_pixels: Option<u64>,
    /// Bytes of memory that the reading may take; None for what the machine has.
    pub memory_bytes: Option<u64>,
    /// Bytes of memory that the scene may take once it is opened; None for any.
    pub max_scene_bytes: Option<u64>,
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
        Self { radiance: vec![radiance.into()], calibration: 1.0, ..Self::default() }
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
        for (option, value) in [("--floor", self.floor_nw_cm2_sr), ("--cap", self.cap_nw_cm2_sr)] {
            positive(option, value.unwrap_or(1.0))?;
        }
        let files = [
            ("--mask", &self.masks),
            ("--quality-file", &self.quality_files),
            ("--observations-file", &self.observation_files),
        ];
        for (option, given) in files {
            if !given.is_empty() && given.len() != self.radiance.len() {
                let reason = format!(
                    "{} files are given for {} radiance rasters; give one for each, in their order",
                    given.len(),
                    self.radiance.len()
                );
                return Err(SceneError::InvalidOption { option, reason });
            }
        }
        if let Some(unit) = self.terrain_units.as_deref().filter(|unit| metres_in(unit).is_none()) {
            let reason = format!("\"{unit}\" is no length; m, ft, us-ft, dm and cm are known");
            return Err(SceneError::InvalidOption { option: "--terrain-units", reason });
        }
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
