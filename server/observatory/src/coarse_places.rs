//! Something known at some places of a lattice, evenly far apart: what lies between takes it from the four around. It is found
//! around a window alone, where it is what it is for all of the lattice.

use crate::error::ObservatoryError;
use rayon::prelude::*;
use skyglow_scene::{PlaceLattice, PlaceWindow, Scene};
use std::ops::Range;

/// Places of a lattice at most that is known as a whole by as few places as whoever asks says.
pub(crate) const MAX_WHOLE_PLACES: usize = 40_000_000;
/// From one known place to the next in larger ones, metres at most.
const APART_M: f64 = 50_000.0;

/// Places of a lattice from one known place to the next, where about `most` are enough for lattices of up to [`MAX_WHOLE_PLACES`].
pub(crate) fn stride(scene: &Scene, lattice: PlaceLattice, most: usize) -> u32 {
    let evenly = (lattice.len() as f64 / most as f64).sqrt().ceil().max(1.0);
    let apart = APART_M / (scene.metadata().pixel_size_m.max(1.0) * f64::from(lattice.step));
    match lattice.len() > MAX_WHOLE_PLACES {
        true => evenly.min(apart).max(1.0) as u32,
        false => evenly as u32,
    }
}

/// Something at every n-th place of a lattice along either axis, and at its last ones.
#[derive(Debug)]
pub(crate) struct CoarsePlaces<T> {
    lattice: PlaceLattice,
    /// Places from one to the next.
    stride: u32,
    /// Columns and rows of those that are known, among all.
    columns: Range<u32>,
    rows: Range<u32>,
    /// Row by row; None where there is nothing to know.
    known: Vec<Option<T>>,
}

impl<T: Send + Sync> CoarsePlaces<T> {
    /// Around all places of a window; `make` is given columns and rows of the lattice, on several threads.
    ///
    /// * `stride`: places from one to the next.
    ///
    /// # Errors
    /// The first of `make`.
    pub(crate) fn new(
        lattice: PlaceLattice,
        window: &PlaceWindow,
        stride: u32,
        make: impl Fn(u32, u32) -> Result<Option<T>, ObservatoryError> + Sync,
    ) -> Result<Self, ObservatoryError> {
        let around = |range: &Range<u32>, places: u32| {
            let (first, _) = before(range.start, places, stride);
            let (last, _) = before(range.end - 1, places, stride);
            first..(last + 2).min(count(places, stride))
        };
        let (columns, rows) = (around(&window.columns, lattice.columns), around(&window.rows, lattice.rows));
        let at = |number: u32, places: u32| (number * stride).min(places - 1);
        let across = columns.len() as u32;
        let known: Result<Vec<Option<T>>, ObservatoryError> = (0..across * rows.len() as u32)
            .into_par_iter()
            .map(|number| {
                let (column, row) = (columns.start + number % across, rows.start + number / across);
                make(at(column, lattice.columns), at(row, lattice.rows))
            })
            .collect();
        Ok(Self { lattice, stride, columns, rows, known: known? })
    }

    /// What is known around a place of the window by its column and row, with weights that add up to 1; none where nothing is.
    pub(crate) fn around(&self, [column, row]: [u32; 2]) -> Vec<(&T, f64)> {
        let (left, right) = before(column, self.lattice.columns, self.stride);
        let (above, down) = before(row, self.lattice.rows, self.stride);
        let corners = [
            (left, above, (1.0 - right) * (1.0 - down)),
            (left + 1, above, right * (1.0 - down)),
            (left, above + 1, (1.0 - right) * down),
            (left + 1, above + 1, right * down),
        ];
        let known =
            corners.into_iter().filter(|(_, _, weight)| *weight > 0.0).filter_map(|(x, y, weight)| {
                let (column, row) = (x - self.columns.start, y - self.rows.start);
                let number = row as usize * self.columns.len() + column as usize;
                Some((self.known[number].as_ref()?, weight))
            });
        let mut known: Vec<(&T, f64)> = known.collect();
        let sum: f64 = known.iter().map(|(_, weight)| weight).sum();
        known.iter_mut().for_each(|(_, weight)| *weight /= sum);
        known
    }
}

/// How many places are known along an axis of so many.
fn count(places: u32, stride: u32) -> u32 {
    (places - 1).div_ceil(stride) + 1
}

/// The known place before one along an axis, and the weight of the next: the last is that of the lattice's last place.
fn before(at: u32, places: u32, stride: u32) -> (u32, f64) {
    let before = (at / stride).min(count(places, stride).saturating_sub(2));
    let first = before * stride;
    let step = stride.min(places - 1 - first).max(1);
    (before, f64::from(at - first) / f64::from(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is linear over a lattice comes out as it is, up to its last places, also of lattices of one row.
    #[test]
    fn between_known_places_it_is_linear() {
        for (width, height, stride) in [(53, 31, 7), (7, 1, 2), (1, 1, 1), (64, 64, 1)] {
            let lattice = PlaceLattice::within(width, height, usize::MAX);
            let value = |column: u32, row: u32| 2.0 * f64::from(column) - 3.0 * f64::from(row);
            let part = |columns: Range<u32>, rows: Range<u32>| {
                let window = PlaceWindow { columns, rows };
                CoarsePlaces::new(lattice, &window, stride, |column, row| Ok(Some(value(column, row))))
                    .unwrap()
            };
            let coarse = part(0..width, 0..height);
            for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
                let around = coarse.around([column, row]);
                let found: f64 = around.iter().map(|(value, weight)| **value * weight).sum();
                assert!((found - value(column, row)).abs() < 1e-9, "{column} {row}: {found}");
                // One place has what all have.
                let alone = part(column..column + 1, row..row + 1);
                assert_eq!(alone.around([column, row]), around);
                assert!(alone.known.len() <= 4);
            }
        }
        let lattice = PlaceLattice::within(9, 9, usize::MAX);
        let west =
            CoarsePlaces::new(lattice, &lattice.whole(), 3, |column, _| Ok((column < 5).then_some(7.0)))
                .unwrap();
        let around = west.around([4, 4]);
        assert!(
            !around.is_empty() && (around.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12
        );
        assert!(west.around([8, 8]).is_empty());
    }
}
