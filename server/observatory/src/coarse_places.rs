//! Something known at some places of a lattice, evenly far apart: what lies between takes it from the four around.

use crate::error::ObservatoryError;
use rayon::prelude::*;
use skyglow_scene::PlaceLattice;

/// Something at every n-th place of a lattice along either axis, and at its last ones.
#[derive(Debug)]
pub(crate) struct CoarsePlaces<T> {
    lattice: PlaceLattice,
    /// Places from one to the next.
    stride: u32,
    columns: u32,
    rows: u32,
    /// Row by row; None where there is nothing to know.
    known: Vec<Option<T>>,
}

impl<T: Send + Sync> CoarsePlaces<T> {
    /// At about so many places at most; `make` is given their columns and rows, on several threads.
    ///
    /// # Errors
    /// The first of `make`.
    pub(crate) fn new(
        lattice: PlaceLattice,
        most: usize,
        make: impl Fn(u32, u32) -> Result<Option<T>, ObservatoryError> + Sync,
    ) -> Result<Self, ObservatoryError> {
        let stride = (lattice.len() as f64 / most as f64).sqrt().ceil().max(1.0) as u32;
        let count = |places: u32| (places - 1).div_ceil(stride) + 1;
        let (columns, rows) = (count(lattice.columns), count(lattice.rows));
        let at = |number: u32, places: u32| (number * stride).min(places - 1);
        let known: Result<Vec<Option<T>>, ObservatoryError> = (0..columns * rows)
            .into_par_iter()
            .map(|number| make(at(number % columns, lattice.columns), at(number / columns, lattice.rows)))
            .collect();
        Ok(Self { lattice, stride, columns, rows, known: known? })
    }

    /// What is known around a place by its column and row, with weights that add up to 1; none where nothing is.
    pub(crate) fn around(&self, [column, row]: [u32; 2]) -> Vec<(&T, f64)> {
        let (left, right) = self.position(column, self.lattice.columns, self.columns);
        let (above, down) = self.position(row, self.lattice.rows, self.rows);
        let corners = [
            (left, above, (1.0 - right) * (1.0 - down)),
            (left + 1, above, right * (1.0 - down)),
            (left, above + 1, (1.0 - right) * down),
            (left + 1, above + 1, right * down),
        ];
        let known =
            corners.into_iter().filter(|(_, _, weight)| *weight > 0.0).filter_map(|(x, y, weight)| {
                Some((self.known[(y * self.columns + x) as usize].as_ref()?, weight))
            });
        let mut known: Vec<(&T, f64)> = known.collect();
        let sum: f64 = known.iter().map(|(_, weight)| weight).sum();
        known.iter_mut().for_each(|(_, weight)| *weight /= sum);
        known
    }

    /// The known place before one along an axis, and the weight of the next: the last is that of the lattice's last place.
    fn position(&self, at: u32, places: u32, count: u32) -> (u32, f64) {
        let before = (at / self.stride).min(count.saturating_sub(2));
        let first = before * self.stride;
        let step = self.stride.min(places - 1 - first).max(1);
        (before, f64::from(at - first) / f64::from(step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is linear over a lattice comes out as it is, up to its last places, also of lattices of one row.
    #[test]
    fn between_known_places_it_is_linear() {
        for (width, height, most) in [(53, 31, 40), (7, 1, 3), (1, 1, 5), (64, 64, 100_000)] {
            let lattice = PlaceLattice::within(width, height, usize::MAX);
            let value = |column: u32, row: u32| 2.0 * f64::from(column) - 3.0 * f64::from(row);
            let coarse =
                CoarsePlaces::new(lattice, most, |column, row| Ok(Some(value(column, row)))).unwrap();
            assert!(coarse.known.len() <= 3 * most + 4, "{} {most}", coarse.known.len());
            for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
                let around = coarse.around([column, row]);
                let found: f64 = around.iter().map(|(value, weight)| **value * weight).sum();
                assert!((found - value(column, row)).abs() < 1e-9, "{column} {row}: {found}");
            }
        }
        let lattice = PlaceLattice::within(9, 9, usize::MAX);
        let west = CoarsePlaces::new(lattice, 9, |column, _| Ok((column < 5).then_some(7.0))).unwrap();
        let around = west.around([4, 4]);
        assert!(
            !around.is_empty() && (around.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12
        );
        assert!(west.around([8, 8]).is_empty());
    }
}
