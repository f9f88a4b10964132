//! A number at every place of a lattice, as a mean mipmap pyramid (Williams 1983) for maps at any scale.

use super::place_lattice::PlaceLattice;

/// A number at every place of a lattice, and its means over ever larger blocks of places.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceValues {
    lattice: PlaceLattice,
    /// Means over blocks of 2^level × 2^level places; NaN where none of them has a number.
    levels: Vec<Plane>,
}

/// Numbers row by row.
#[derive(Clone, Debug, PartialEq)]
struct Plane {
    columns: usize,
    rows: usize,
    values: Vec<f32>,
}

impl PlaceValues {
    /// From numbers row by row from the north, NaN where there is none; None where their number is not the lattice's.
    pub fn new(lattice: PlaceLattice, values: Vec<f32>) -> Option<Self> {
        if values.len() != lattice.len() {
            return None;
        }
        let mut plane = Plane { columns: lattice.columns as usize, rows: lattice.rows as usize, values };
        let mut levels = Vec::new();
        while plane.values.len() > 1 {
            let above = plane.halved();
            levels.push(plane);
            plane = above;
        }
        levels.push(plane);
        Some(Self { lattice, levels })
    }

    /// The places.
    pub fn lattice(&self) -> PlaceLattice {
        self.lattice
    }

    /// The numbers, row by row from the north; NaN where there is none.
    pub fn values(&self) -> &[f32] {
        &self.levels[0].values
    }

    /// Bytes held.
    pub fn byte_count(&self) -> usize {
        self.levels.iter().map(|plane| size_of_val(plane.values.as_slice())).sum()
    }

    /// At pixel coordinates of the raster: between places linear; None where the nearest has no number.
    ///
    /// * `pixels`: width of the area asked for, in pixels of the raster: the mean over that width is returned, at least over one.
    pub fn at(&self, x: f64, y: f64, pixels: f64) -> Option<f64> {
        let across = pixels / f64::from(self.lattice.step);
        let level = (across.max(1.0).log2().round() as usize).min(self.levels.len() - 1);
        let (column, row) = self.lattice.place_at(x, y);
        let scale = f64::exp2(level as f64);
        let of_level = |place: f64| (place + 0.5) / scale - 0.5;
        self.levels[level].at(of_level(column), of_level(row))
    }
}

impl Plane {
    fn halved(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mean = |index: usize| {
            let (column, row) = (2 * (index % columns), 2 * (index / columns));
            let (mut sum, mut count) = (0.0, 0.0);
            for row in row..(row + 2).min(self.rows) {
                for column in column..(column + 2).min(self.columns) {
                    let value = self.values[row * self.columns + column];
                    if !value.is_nan() {
                        sum += value;
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 { sum / count } else { f32::NAN }
        };
        Self { columns, rows, values: (0..columns * rows).map(mean).collect() }
    }

    fn at(&self, column: f64, row: f64) -> Option<f64> {
        let along = |place: f64, count: usize| {
            let place = place.clamp(0.0, (count - 1) as f64);
            let below = (place as usize).min(count.saturating_sub(2));
            (below, (below + 1).min(count - 1), place - below as f64)
        };
        let (west, east, across) = along(column, self.columns);
        let (north, south, down) = along(row, self.rows);
        let (mut sum, mut weights, mut nearest) = (0.0, 0.0, (0.0, f32::NAN));
        for (column, row, weight) in [
            (west, north, (1.0 - across) * (1.0 - down)),
            (east, north, across * (1.0 - down)),
            (west, south, (1.0 - across) * down),
            (east, south, across * down),
        ] {
            let value = self.values[row * self.columns + column];
            if weight > nearest.0 {
                nearest = (weight, value);
            }
            if !value.is_nan() {
                sum += weight * f64::from(value);
                weights += weight;
            }
        }
        (!nearest.1.is_nan()).then(|| sum / weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values are linear between places, and means when zoomed out.
    #[test]
    fn values_are_linear_and_means_when_zoomed_out() {
        let lattice = PlaceLattice::within(16, 8, 32);
        assert_eq!((lattice.step, lattice.columns, lattice.rows), (2, 8, 4));
        let plane = |x: f64, y: f64| 1.0 + 2.0 * x + 5.0 * y;
        let values: Vec<f32> = (0..32)
            .map(|at| plane(2.0 * f64::from(at % 8) + 1.0, 2.0 * f64::from(at / 8) + 1.0) as f32)
            .collect();
        let places = PlaceValues::new(lattice, values.clone()).unwrap();
        for (x, y) in [(1.0, 1.0), (3.7, 2.2), (14.9, 6.9)] {
            assert!((places.at(x, y, 1.0).unwrap() - plane(x, y)).abs() < 1e-5);
        }
        // Beyond the outermost places it is that of theirs.
        assert_eq!(places.at(0.0, 0.0, 1.0), places.at(1.0, 1.0, 1.0));
        let mean = values.iter().sum::<f32>() / 32.0;
        let from_afar = places.at(8.0, 4.0, 1e6).unwrap();
        assert!((from_afar - f64::from(mean)).abs() < 1e-4, "{from_afar} {mean}");
        assert!(PlaceValues::new(lattice, values[1..].to_vec()).is_none());
    }

    /// Where the nearest place has no value, there is none.
    #[test]
    fn a_missing_nearest_value_is_no_value() {
        let lattice = PlaceLattice::within(3, 1, 3);
        let places = PlaceValues::new(lattice, vec![4.0, f32::NAN, f32::NAN]).unwrap();
        assert_eq!(places.at(0.9, 0.5, 1.0), Some(4.0));
        assert_eq!(places.at(1.2, 0.5, 1.0), None);
        assert_eq!(places.at(1.2, 0.5, 4.0), Some(4.0));
        assert!(places.byte_count() >= 12);
    }
}
