//! What counts of a pixel that several rasters have measured.

use super::granule_name::last_day;
use super::options::IngestOptions;
use super::overlap_rule::OverlapRule;
use super::radiance_source::{PixelKind, Strip};
use crate::error::SceneError;
use std::path::Path;

/// The rasters of which the newest comes first, by the dates in their names; equally new ones stay as they are.
///
/// # Errors
/// [`SceneError::InvalidOption`] naming one without a date.
pub(super) fn newest_first<T>(
    options: &IngestOptions,
    dates: &[Option<String>],
    rasters: Vec<T>,
) -> Result<Vec<T>, SceneError> {
    if options.overlap != OverlapRule::Newest || rasters.len() < 2 {
        return Ok(rasters);
    }
    let mut dated = Vec::with_capacity(rasters.len());
    for ((raster, date), path) in rasters.into_iter().zip(dates).zip(&options.radiance) {
        let refused = || SceneError::InvalidOption { option: "--overlap", reason: undated(path) };
        dated.push((last_day(date.as_ref().ok_or_else(refused)?), raster));
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
    /// Measurements of each pixel of the grid so far.
    counts: Vec<u32>,
}

impl Merge {
    /// For so many pixels.
    pub(super) fn new(rule: OverlapRule, pixels: usize) -> Self {
        Self { rule, counts: vec![0; pixels] }
    }

    /// Takes `part.radiance[there..there + length]` and its kinds to `whole[here..]`.
    pub(super) fn take(&mut self, whole: &mut Strip, here: usize, part: &Strip, there: usize, length: usize) {
        for offset in 0..length {
            let (to, from) = (here + offset, there + offset);
            let (kind, radiance) = (part.kinds[from], part.radiance[from]);
            let is_measured = kind == PixelKind::Measured;
            self.counts[to] += u32::from(is_measured);
            let count = self.counts[to];
            whole.shared += u64::from(is_measured && count == 2);
            // What is no measurement in one raster may be one in another.
            if whole.kinds[to] < kind {
                (whole.kinds[to], whole.radiance[to]) = (kind, radiance);
            } else if is_measured && self.rule == OverlapRule::Max {
                whole.radiance[to] = whole.radiance[to].max(radiance);
            } else if is_measured && self.rule == OverlapRule::Mean {
                whole.radiance[to] += (radiance - whole.radiance[to]) / f64::from(count);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A span counts by its end, a year and a month by their last day.
    #[test]
    fn the_newest_comes_first() {
        let names = ["2023-04/2024-03", "2023", "2024-03-30", "2022-12"];
        let options = IngestOptions {
            radiance: names.map(Into::into).into(),
            overlap: OverlapRule::Newest,
            ..IngestOptions::default()
        };
        let dates = names.map(|name| Some(name.to_owned()));
        let order = newest_first(&options, &dates, names.into()).unwrap();
        assert_eq!(order, ["2023-04/2024-03", "2024-03-30", "2023", "2022-12"]);
        let undated = [Some("2023".to_owned()), None, None, None];
        assert!(newest_first(&options, &undated, names.into()).is_err());
        assert!(newest_first(&options, &[None], vec!["alone"]).is_ok());
    }
}
