//! The transpose of the polar grid: which cells the light of each pixel went to.

use crate::light_tree::{LightSink, NO_BLOCKS_WITHIN_M};
use crate::polar_grid::{
    AZIMUTH_COLUMN_COUNT, NearLight, PlacedLight, PolarAccumulator, PolarAxes, PolarCell, PolarGrid,
    RING_COUNT, blocking_shares, log_distance,
};
use glam::DVec3;
use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use skyglow_physics::blocking::BLOCKING_COUNT;
use skyglow_physics::geometry::LocalFrame;
use std::{ops::Range, sync::Arc};

/// A part of a pixel's light in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellShare {
    /// Index in [`PolarGrid::cells`].
    pub cell: u32,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f32,
}

/// A lit pixel as an observer has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPixel {
    /// Its number, as [`Scene::column_and_row`](crate::Scene::column_and_row) takes it.
    pub number: u32,
    /// Altitude, metres.
    pub altitude_m: f32,
    /// Upward flux, DNB watts, calibration included.
    pub flux_dnb_w: f32,
    /// Distance of its centre along the ground, metres.
    pub distance_m: f32,
    /// Azimuth of its centre, clockwise from north, 0..2π.
    pub azimuth_rad: f32,
}

/// The light around an observer by cells and by pixels. Every pixel is taken by itself, far ones too.
#[derive(Clone, Debug)]
pub struct LightShares {
    /// The light by azimuth and distance.
    pub polar: Arc<PolarGrid>,
    /// Ascending by number.
    pixels: Arc<[LitPixel]>,
    /// Where each pixel's shares begin, and where the last one's end.
    starts: Vec<u32>,
    shares: Vec<CellShare>,
}

impl LightShares {
    /// Number of lit pixels within 300 km.
    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Whether there is no light.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// The lit pixels within 300 km, ascending by number.
    pub fn pixels(&self) -> &[LitPixel] {
        &self.pixels
    }

    /// The same as a shared list.
    pub fn shared_pixels(&self) -> Arc<[LitPixel]> {
        Arc::clone(&self.pixels)
    }

    /// Where the light of pixel `position` of [`Self::pixels`] went; a cell may come more than once.
    pub fn shares(&self, position: usize) -> &[CellShare] {
        &self.shares[self.starts[position] as usize..self.starts[position + 1] as usize]
    }

    /// The light of pixel `position` of [`Self::pixels`] alone, at the pixel's own altitude.
    pub fn alone(&self, position: usize) -> PolarGrid {
        let pixel = self.pixels[position];
        // Cells are numbered by column, then by ring and angle; pieces of a pixel may share one.
        let mut shares = self.shares(position).to_vec();
        shares.sort_unstable_by_key(|share| share.cell);
        shares.dedup_by(|next, kept| {
            let is_same = next.cell == kept.cell;
            kept.flux_dnb_w += if is_same { next.flux_dnb_w } else { 0.0 };
            is_same
        });
        let first_of = |start: &u32| shares.partition_point(|share| share.cell < *start) as u32;
        let cells = shares.iter().map(|share| PolarCell {
            flux_dnb_w: share.flux_dnb_w,
            altitude_m: pixel.altitude_m,
            ..self.polar.cells[share.cell as usize]
        });
        PolarGrid {
            observer: self.polar.observer,
            azimuth_start: self.polar.azimuth_start.iter().map(first_of).collect(),
            cells: cells.collect(),
            near: self.near_of(pixel.number).to_vec(),
            flux_dnb_w: f64::from(pixel.flux_dnb_w),
            coverage: self.polar.coverage,
        }
    }

    /// The near points of the pixel of a number.
    fn near_of(&self, number: u32) -> &[NearLight] {
        let near = &self.polar.near;
        let first = near.partition_point(|light| light.number < number);
        let count = near[first..].partition_point(|light| light.number == number);
        &near[first..first + count]
    }

    /// Bytes held.
    pub fn byte_count(&self) -> usize {
        let of_pixels = self.pixels.len() * (size_of::<LitPixel>() + size_of::<u32>());
        let of_cells = self.polar.byte_count();
        of_pixels + self.shares.len() * size_of::<CellShare>() + of_cells
    }
}

/// A pixel being gathered.
struct Visited {
    number: u32,
    altitude_m: f32,
    flux_dnb_w: f64,
    /// Where its shares begin.
    first_share: u32,
}

/// Light shares being gathered, in the order in which pixels are visited.
pub(crate) struct ShareCollector {
    accumulator: PolarAccumulator,
    axes: PolarAxes,
    /// Pixels nearer than this have their points stored.
    near_log_distance: f64,
    visited: Vec<Visited>,
    /// Shares with the numbers of their places on the grid in place of their cells'.
    shares: Vec<CellShare>,
}

/// Number of a place on the grid.
fn slot(at: usize, blocking: usize) -> u32 {
    (at * BLOCKING_COUNT + blocking) as u32
}

impl LightSink for ShareCollector {
    fn take(&mut self, numbers: Range<u32>, light: PlacedLight) {
        self.accumulator.add(light);
        // Far pixels are not rendered alone: the sky's own grid is enough for them.
        if light.log_distance < self.near_log_distance {
            self.accumulator.push_near(numbers.clone(), light);
        }
        // No blocks are taken here.
        let number = numbers.start;
        match self.visited.last_mut() {
            Some(last) if last.number == number => last.flux_dnb_w += light.flux_dnb_w,
            _ => self.visited.push(Visited {
                number,
                altitude_m: light.altitude_m as f32,
                flux_dnb_w: light.flux_dnb_w,
                first_share: self.shares.len() as u32,
            }),
        }
        for (at, weight) in self.axes.shares(light.azimuth_rad, light.log_distance) {
            for (angle, part) in blocking_shares(light.blocking) {
                let flux_dnb_w = (light.flux_dnb_w * weight * part) as f32;
                if flux_dnb_w > 0.0 {
                    self.shares.push(CellShare { cell: slot(at, angle), flux_dnb_w });
                }
            }
        }
    }
}

impl ShareCollector {
    pub(crate) fn new() -> Self {
        let (visited, shares) = (Vec::new(), Vec::new());
        Self {
            accumulator: PolarAccumulator::new(),
            axes: PolarAxes::new(),
            near_log_distance: log_distance(NO_BLOCKS_WITHIN_M),
            visited,
            shares,
        }
    }

    /// Orders pixels by their number, sees where they are, and names the cells of their shares.
    ///
    /// * `center`: the centre of a lit pixel by its number, as a unit vector.
    pub(crate) fn finish(
        self,
        observer: GeoPoint,
        frame: &LocalFrame,
        coverage: f64,
        center: impl Fn(u32) -> DVec3 + Sync,
    ) -> LightShares {
        let mut polar = self.accumulator.finish(observer, coverage);
        // Stable: points of a pixel keep their order.
        polar.near.sort_by_key(|light| light.number);
        let mut cell_of = vec![u32::MAX; AZIMUTH_COLUMN_COUNT * RING_COUNT * BLOCKING_COUNT];
        for (column, range) in polar.azimuth_start.windows(2).enumerate() {
            for cell in range[0]..range[1] {
                let of = polar.cells[cell as usize];
                let at = column * RING_COUNT + of.ring as usize;
                cell_of[slot(at, of.blocking as usize) as usize] = cell;
            }
        }
        let ends = self.visited.iter().skip(1).map(|next| next.first_share).chain([self.shares.len() as u32]);
        let mut visited: Vec<(&Visited, u32)> = self.visited.iter().zip(ends).collect();
        visited.sort_unstable_by_key(|(visited, _)| visited.number);
        let mut starts = vec![0];
        let mut shares = Vec::with_capacity(self.shares.len());
        for (visited, end) in &visited {
            let placed = self.shares[visited.first_share as usize..*end as usize].iter();
            let named = placed.map(|share| CellShare { cell: cell_of[share.cell as usize], ..*share });
            // A flux that f32 holds may still be too little for the f32 of a cell behind a skyline.
            shares.extend(named.filter(|share| share.cell != u32::MAX));
            starts.push(shares.len() as u32);
        }
        let pixel = |(visited, _): &(&Visited, u32)| {
            let bearing = frame.bearing_to(center(visited.number));
            LitPixel {
                number: visited.number,
                altitude_m: visited.altitude_m,
                flux_dnb_w: visited.flux_dnb_w as f32,
                distance_m: bearing.distance_m as f32,
                azimuth_rad: bearing.azimuth_rad as f32,
            }
        };
        LightShares {
            pixels: visited.par_iter().map(pixel).collect(),
            polar: Arc::new(polar),
            starts,
            shares,
        }
    }
}
