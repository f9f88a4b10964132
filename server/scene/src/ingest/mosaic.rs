//! Radiance rasters on one grid, side by side or over each other.

use super::gdal_open::gdal_reason;
use super::overlap::Merge;
use super::overlap_rule::OverlapRule;
use super::radiance_source::{PixelKind, RadianceSource, Strip};
use crate::error::SceneError;
use gdal::spatial_ref::SpatialRef;
use std::ops::Range;

/// Pixels of two rasters are the same where they lie apart by less than this part of one.
const SAME_PIXEL: f64 = 0.01;
/// Sides of pixels are the same within this part: over a whole turn of 15″ that is a hundredth of a pixel.
const SAME_SIDE: f64 = 1e-7;

/// The rasters with their places in the grid of all.
pub(super) struct Mosaic {
    sources: Vec<Placed>,
    pub(super) geotransform: [f64; 6],
    pub(super) crs: SpatialRef,
    pub(super) size: (usize, usize),
}

struct Placed {
    source: RadianceSource,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Mosaic {
    /// Of at least one source.
    ///
    /// # Errors
    /// [`SceneError::Refused`] naming the first raster that does not lie on the grid of the one before.
    pub(super) fn new(sources: Vec<RadianceSource>) -> Result<Self, SceneError> {
        let Some(first) = sources.first() else {
            return Err(SceneError::InvalidOption {
                option: "FILES",
                reason: "no radiance raster is given".to_owned(),
            });
        };
        let (crs, origin) = (first.crs.clone(), first.geotransform);
        let first_path = first.path.clone();
        let mut offsets = Vec::with_capacity(sources.len());
        for (index, source) in sources.iter().enumerate() {
            if index == 0 {
                offsets.push((0, 0));
                continue;
            }
            let refuse = |reason: String| SceneError::Refused { path: source.path.clone(), reason };
            if source.crs != crs {
                return Err(refuse(format!(
                    "it has another coordinate reference system than {}; warp it first: gdalwarp -t_srs",
                    first_path.display()
                )));
            }
            offsets.push(offset(&origin, &source.geotransform).ok_or_else(|| {
                refuse(format!(
                    "its pixels do not lie on the grid of {}; bring both onto one grid first: gdalwarp -tap -tr",
                    first_path.display()
                ))
            })?);
        }
        if crs.is_geographic() && origin[2] == 0.0 && origin[4] == 0.0 {
            join_turns(&mut offsets, &sources, (360.0 / origin[1]).round() as i64);
        }
        let lowest = |part: fn(&(i64, i64)) -> i64| offsets.iter().map(part).min().unwrap_or(0);
        let (column0, row0) = (lowest(|o| o.0), lowest(|o| o.1));
        let placed: Vec<Placed> = sources
            .into_iter()
            .zip(offsets)
            .map(|(source, (column, row))| {
                let (width, height) = source.dataset.raster_size();
                let (column, row) = ((column - column0) as usize, (row - row0) as usize);
                Placed { source, columns: column..column + width, rows: row..row + height }
            })
            .collect();
        let end = |part: fn(&Placed) -> usize| placed.iter().map(part).max().unwrap_or(0);
        let size = (end(|p| p.columns.end), end(|p| p.rows.end));
        let g = origin;
        let (column0, row0) = (column0 as f64, row0 as f64);
        let geotransform = [
            g[0] + column0 * g[1] + row0 * g[2],
            g[1],
            g[2],
            g[3] + column0 * g[4] + row0 * g[5],
            g[4],
            g[5],
        ];
        Ok(Self { sources: placed, geotransform, crs, size })
    }

    /// The rasters, in the order given.
    pub(super) fn sources(&self) -> impl Iterator<Item = &RadianceSource> {
        self.sources.iter().map(|placed| &placed.source)
    }

    /// The first raster.
    pub(super) fn first(&self) -> &RadianceSource {
        &self.sources[0].source
    }

    /// Reads rows of the whole grid; `part` is scratch.
    ///
    /// * `reading`: what counts where several rasters have measured, and values that are no measurement, beside those that are known.
    ///
    /// # Errors
    /// As [`RadianceSource::read_rows`].
    pub(super) fn read_rows(
        &self,
        first_row: usize,
        rows: usize,
        (rule, codes): (OverlapRule, &[f64]),
        whole: &mut Strip,
        part: &mut Strip,
    ) -> Result<(), SceneError> {
        let width = self.size.0;
        if let [only] = self.sources.as_slice() {
            only.source.read_rows(first_row, rows, whole)?;
            whole.drop_codes(codes);
            return Ok(());
        }
        let mut merge = Merge::new(rule, width * rows);
        whole.radiance.clear();
        whole.radiance.resize(width * rows, 0.0);
        whole.kinds.clear();
        whole.kinds.resize(width * rows, PixelKind::Outside);
        for Placed { source, columns, rows: own } in &self.sources {
            let from = own.start.max(first_row);
            let to = own.end.min(first_row + rows);
            if from >= to {
                continue;
            }
            part.is_whole = whole.is_whole;
            source.read_rows(from - own.start, to - from, part)?;
            whole.is_whole = part.is_whole;
            part.drop_codes(codes);
            let length = columns.len();
            for row in from..to {
                let (there, here) = ((row - from) * length, (row - first_row) * width + columns.start);
                merge.take(whole, here, part, there, length);
            }
        }
        Ok(())
    }

    /// The CRS as WKT and its name.
    ///
    /// # Errors
    /// [`SceneError::Refused`] for one that GDAL cannot write.
    pub(super) fn crs_text(&self) -> Result<(String, String), SceneError> {
        let refuse =
            |error| SceneError::Refused { path: self.first().path.clone(), reason: gdal_reason(error) };
        Ok((self.crs.to_wkt().map_err(refuse)?, self.crs.name().unwrap_or_else(|| "unnamed".to_owned())))
    }
}

/// Columns and rows from the first pixel of one grid to that of another of the same pixels; None where they are not the same.
fn offset(origin: &[f64; 6], other: &[f64; 6]) -> Option<(i64, i64)> {
    let side = origin[1].abs().max(origin[2].abs());
    if [1, 2, 4, 5].iter().any(|&i| (origin[i] - other[i]).abs() > SAME_SIDE * side) {
        return None;
    }
    let determinant = origin[1] * origin[5] - origin[2] * origin[4];
    let (x, y) = (other[0] - origin[0], other[3] - origin[3]);
    let column = (x * origin[5] - y * origin[2]) / determinant;
    let row = (y * origin[1] - x * origin[4]) / determinant;
    let is_on_grid = [column, row].iter().all(|at| (at - at.round()).abs() < SAME_PIXEL);
    is_on_grid.then_some((column.round() as i64, row.round() as i64))
}

/// Moves rasters by a turn so that those on both sides of the antimeridian lie side by side: the widest gap is outside.
fn join_turns(offsets: &mut [(i64, i64)], sources: &[RadianceSource], turn: i64) {
    if turn < 2 {
        return;
    }
    let mut spans: Vec<(i64, i64)> = offsets
        .iter()
        .zip(sources)
        .map(|(offset, source)| {
            let first = offset.0.rem_euclid(turn);
            (first, first + source.dataset.raster_size().0 as i64)
        })
        .collect();
    if spans.iter().any(|(first, end)| end - first >= turn) {
        return;
    }
    spans.sort_unstable();
    let (mut reach, mut widest, mut start) = (spans[0].1, i64::MIN, spans[0].0);
    for &(first, end) in spans.iter().skip(1).chain(std::iter::once(&(spans[0].0 + turn, 0))) {
        if first - reach > widest {
            (widest, start) = (first - reach, first.rem_euclid(turn));
        }
        reach = reach.max(end);
    }
    // The first raster keeps its own longitudes.
    let own = offsets[0].0;
    let base = start + (own - start).div_euclid(turn) * turn;
    for offset in offsets {
        offset.0 = base + (offset.0 - base).rem_euclid(turn);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grids of the same pixels have whole offsets, others none.
    #[test]
    fn offsets_are_whole_on_one_grid() {
        let step = 1.0 / 240.0;
        let at = |x: f64, y: f64| [x, step, 0.0, y, 0.0, -step];
        assert_eq!(offset(&at(30.0, 10.0), &at(40.0, 0.0)), Some((2400, 2400)));
        assert_eq!(offset(&at(30.0, 10.0), &at(30.0 + 0.4 * step, 10.0)), None);
        assert_eq!(offset(&at(30.0, 10.0), &[30.0, 2.0 * step, 0.0, 10.0, 0.0, -step]), None);
    }
}
