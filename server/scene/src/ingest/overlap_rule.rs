//! Which measurement counts where several rasters have one.

use crate::error::SceneError;
use serde::{Deserialize, Serialize};

/// Which measurement of a pixel counts where several rasters have one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OverlapRule {
    /// That of the first raster.
    #[default]
    First,
    /// The mean of all.
    Mean,
    /// The largest.
    Max,
    /// That of the raster with the latest date in its name.
    Newest,
}

impl OverlapRule {
    /// Their names.
    pub const NAMES: &'static str = "first, mean, max or newest";

    /// From the command line's spelling.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        match text {
            "first" => Ok(Self::First),
            "mean" => Ok(Self::Mean),
            "max" => Ok(Self::Max),
            "newest" => Ok(Self::Newest),
            _ => Err(SceneError::InvalidOption {
                option: "--overlap",
                reason: format!("\"{text}\" is none of {}", Self::NAMES),
            }),
        }
    }
}
