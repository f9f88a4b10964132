//! What the observer of a sum sees of single sources, tabulated over distance and azimuth for each field.

use super::{
    super::{SourceField, ViewRow},
    density::SumDensity,
};
use crate::{
    error::PhysicsError,
    interpolation::Stencil,
    single_source::RadiancePerWatt,
    source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M, PointSource},
};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Azimuth nodes are this power of an even share of the half turn.
const AZIMUTH_CROWDING: f64 = 1.7;

/// Places of fields in a table and the weights with which they count.
pub(super) type FieldWeights = Vec<(usize, f64)>;

/// Distances and azimuths of a table.
#[derive(Clone, Debug)]
pub(super) struct SampleAxes {
    pub(super) distance_m: Vec<f64>,
    log_distance: Vec<f64>,
    pub(super) azimuth_rad: Vec<f64>,
}

impl SampleAxes {
    pub(super) fn new(density: &SumDensity) -> Self {
        let ratio = MAX_SOURCE_DISTANCE_M / MIN_SOURCE_DISTANCE_M;
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let distance_m: Vec<f64> = (0..density.distances)
            .map(|k| MIN_SOURCE_DISTANCE_M * ratio.powf(share(k, density.distances)))
            .collect();
        let azimuth_rad =
            (0..density.azimuths).map(|k| PI * share(k, density.azimuths).powf(AZIMUTH_CROWDING)).collect();
        Self { log_distance: distance_m.iter().map(|d| d.ln()).collect(), distance_m, azimuth_rad }
    }

    /// Samples of one field in one row.
    pub(super) fn len(&self) -> usize {
        self.distance_m.len() * self.azimuth_rad.len()
    }
}

/// Logarithms of N values for every row of the sky and every field, `[row][field][distance][azimuth]`.
#[derive(Debug)]
pub(super) struct LogTable<const N: usize> {
    axes: SampleAxes,
    fields: usize,
    pub(super) log: Vec<[f32; N]>,
}

impl<const N: usize> LogTable<N> {
    /// All zero.
    pub(super) fn new(axes: SampleAxes, rows: usize, fields: usize) -> Self {
        Self { log: vec![[0.0; N]; rows * fields * axes.len()], axes, fields }
    }

    /// Where the samples of a field in a row are, `[distance][azimuth]`.
    pub(super) fn part(&self, row: usize, field: usize) -> std::ops::Range<usize> {
        let start = (row * self.fields + field) * self.axes.len();
        start..start + self.axes.len()
    }

    /// Enters what the observer sees of a field: `log_of` its outputs at every row, distance and azimuth.
    ///
    /// # Errors
    /// As those of [`ViewRow::new`].
    pub(super) fn enter(
        &mut self,
        field: usize,
        solved: &SourceField,
        observer_altitude_m: f64,
        rows_rad: &[f64],
        log_of: impl Fn(RadiancePerWatt) -> [f32; N] + Sync,
    ) -> Result<(), PhysicsError> {
        let (row_len, part, axes) = (self.row_len(), self.part(0, field), &self.axes);
        let parts = self.log.par_chunks_mut(row_len);
        parts.zip(rows_rad).try_for_each(|(row, &elevation_rad)| {
            let rays = ViewRow::new(solved, observer_altitude_m, elevation_rad)?;
            let mut values = row[part.clone()].iter_mut();
            for &distance_m in &axes.distance_m {
                for (&azimuth_rad, value) in axes.azimuth_rad.iter().zip(values.by_ref()) {
                    *value = log_of(rays.radiance_per_watt(distance_m, azimuth_rad));
                }
            }
            Ok(())
        })
    }

    /// Takes from a field the only one of another table, and an addend besides.
    pub(super) fn subtract(&mut self, field: usize, other: &Self, addend: f64) {
        let rows = other.log.chunks(other.row_len());
        for (row, of_row) in rows.enumerate() {
            let part = self.part(row, field);
            for (value, other) in self.log[part].iter_mut().zip(of_row) {
                value.iter_mut().zip(other).for_each(|(value, other)| *value -= other + addend as f32);
            }
        }
    }

    /// Samples of a row, of all fields.
    pub(super) fn row_len(&self) -> usize {
        self.fields * self.axes.len()
    }

    /// The logarithm for a source seen in a row at an azimuth [rad]; `fields` are places and weights of fields.
    pub(super) fn log_at(
        &self,
        row: usize,
        fields: &[(usize, f64)],
        source: &PointSource,
        azimuth_rad: f64,
    ) -> [f64; N] {
        // Azimuth from the source's, folded to 0..=π: the sky is even.
        let turn = (azimuth_rad - source.azimuth_rad).rem_euclid(2.0 * PI);
        let azimuths = Stencil::lagrange(&self.axes.azimuth_rad, turn.min(2.0 * PI - turn));
        let distances = Stencil::lagrange(&self.axes.log_distance, source.distance_m.ln());
        let mut sum = [0.0; N];
        for &(field, field_weight) in fields {
            for (distance, distance_weight) in distances {
                let start = self.part(row, field).start + distance * self.axes.azimuth_rad.len();
                for (azimuth, azimuth_weight) in azimuths {
                    let weight = field_weight * distance_weight * azimuth_weight;
                    for (sum, &log) in sum.iter_mut().zip(&self.log[start + azimuth]) {
                        *sum += weight * f64::from(log);
                    }
                }
            }
        }
        sum
    }
}
