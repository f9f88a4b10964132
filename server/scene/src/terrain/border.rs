//! The samples just outside of a raster, taken from the rasters that lie there: half a sample at an edge is bilinear with them, so that
//! files that meet have no seam. A raster around the whole Earth meets itself.

/// The ring of samples around a level of a raster, metres; NaN where nothing lies there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Border {
    width: usize,
    height: usize,
    /// The rows above and below, with corners, then the columns to the left and right.
    heights_m: Vec<f32>,
}

impl Border {
    /// Of stored samples; None where they are not as many as the level's size asks for.
    pub(super) fn of_samples((width, height): (usize, usize), heights_m: Vec<f32>) -> Option<Self> {
        (heights_m.len() == Self::len((width, height))).then_some(Self { width, height, heights_m })
    }

    /// How many samples lie around a level.
    pub(super) fn len((width, height): (usize, usize)) -> usize {
        2 * (width + 2) + 2 * height
    }

    /// The heights, to store.
    pub(super) fn samples(&self) -> &[f32] {
        &self.heights_m
    }

    /// Columns and rows of the samples, in their order: −1 and the level's width and height are outside.
    pub(super) fn positions((width, height): (usize, usize)) -> impl Iterator<Item = (i64, i64)> {
        let (width, height) = (width as i64, height as i64);
        let rows =
            [-1, height].into_iter().flat_map(move |row| (-1..=width).map(move |column| (column, row)));
        rows.chain([-1, width].into_iter().flat_map(move |column| (0..height).map(move |row| (column, row))))
    }

    /// A sample next to the level, metres; NaN where there is none.
    pub(super) fn height_m(&self, column: i64, row: i64) -> f32 {
        let (width, height) = (self.width as i64, self.height as i64);
        let is_near = (-1..=width).contains(&column) && (-1..=height).contains(&row);
        let line = width + 2;
        let at = match (column, row) {
            (_, -1) => column + 1,
            (_, row) if row == height => line + column + 1,
            (-1, _) => 2 * line + row,
            (column, _) if column == width => 2 * line + height + row,
            _ => return f32::NAN,
        };
        if is_near { self.heights_m[at as usize] } else { f32::NAN }
    }

    /// The samples that are no void, with their columns and rows.
    pub(super) fn known(&self) -> impl Iterator<Item = (i64, i64, f32)> {
        let all = Self::positions((self.width, self.height)).zip(&self.heights_m);
        all.filter(|(_, height_m)| height_m.is_finite())
            .map(|((column, row), &height_m)| (column, row, height_m))
    }
}
