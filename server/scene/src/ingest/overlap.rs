//! What counts of a pixel that several rasters have measured.

use super::options::IngestOptions;
use super::radiance_source::{PixelKind, Strip};
use crate::error::SceneError;
use serde::{Deserialize, Serialize};
use std::path::Path;

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

/// The rasters of which the newest comes first, by the dates in their names; equally new ones stay as they are.
///
/// # Errors
/// [`SceneError::InvalidOption`] naming one without a date.
pub(super) fn newest_first<T>(
    options: &IngestOptions,
    dates: &[Option<String>],
    rasters: Vec<T>,
) -> Result<Vec<T>, SceneError> {
    if options.overlap != OverlapRule::Newest {
        return Ok(rasters);
    }
    let mut dated = Vec::with_capacity(rasters.len());
    for ((raster, date), path) in rasters.into_iter().zip(dates).zip(&options.radiance) {
        let date = date
            .as_ref()
            .ok_or_else(|| SceneError::InvalidOption { option: "--overlap", reason: undated(path) })?;
        // Of a span its end.
        let end = date.rsplit('/').next().unwrap_or(date).to_owned();
        dated.push((end, raster));
    }
    dated.sort_by(|a, b| b.0.cmp(&a.0));
    Ok(dated.into_iter().map(|(_, raster)| raster).collect())
}

fn undated(path: &Path) -> String {
    format!(
        "newest needs the rasters' dates, and the name of {} has none that is known; give the newest file first and --overlap first",
        path.display()
    )
}

/// Takes the pixels of rows of one raster into those of the grid of all.
pub(super) struct Merge {
    rule: OverlapRule,
    /// Of each pixel of the grid, how many measurements are in its mean.
    counts: Vec<u32>,
}

impl Merge {
    /// For so many pixels.
    pub(super) fn new(rule: OverlapRule, pixels: usize) -> Self {
        let counts = if rule == OverlapRule::Mean { vec![0; pixels] } else { Vec::new() };
        Self { rule, counts }
    }

    /// Takes `part.radiance[there..there + length]` and its kinds to `whole[here..]`.
    pub(super) fn take(&mut self, whole: &mut Strip, here: usize, part: &Strip, there: usize, length: usize) {
        for offset in 0..length {
            let (to, from) = (here + offset, there + offset);
            let (kind, radiance) = (part.kinds[from], part.radiance[from]);
            let is_second = whole.kinds[to] == PixelKind::Measured && kind == PixelKind::Measured;
            whole.shared += u64::from(is_second);
            // What is no measurement in one raster may be one in another.
            if whole.kinds[to] < kind {
                (whole.kinds[to], whole.radiance[to]) = (kind, radiance);
            } else if is_second && self.rule == OverlapRule::Max {
                whole.radiance[to] = whole.radiance[to].max(radiance);
            }
            if kind == PixelKind::Measured && self.rule == OverlapRule::Mean {
                self.counts[to] += 1;
                whole.radiance[to] += (radiance - whole.radiance[to]) / f64::from(self.counts[to]);
            }
        }
    }
}
