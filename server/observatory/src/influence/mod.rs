//! Which lights cause it (paper Eq. 10–14, `docs/model.md#influence`): the measure of every lit cell by one correlation with the basis,
//! and from cells to pixels.
//!
//! A linear measure is Σ_p w(p)·L(p) over directions p. With the coefficients c of a cell at azimuth θ_i,
//!
//! ```text
//! Σ_p w(p)·b(θ_p − θ_i, φ_p) = Σ_k c_k·G_k(θ_i),    G_k(θ) = Σ_p w(p)·B_k(θ_p − θ, φ_p)
//! ```
//!
//! G is a correlation along azimuth: a product of spectra ([`correlation`]). Responses, and the blend between turbidities, are taken of
//! logarithms; w is then their derivative, and as they are homogeneous of the first degree cells still add up to the sky's own value
//! ([`sensitivity`]).

mod blended_sky;
mod cells;
mod correlation;
mod measure_kernel;
mod norms;
mod pixels;
mod products;
mod ready;
mod scales;
mod sensitivity;

pub(crate) use cells::norm_of_values;
pub use cells::{CellInfluence, CellsInSky, InfluenceSolver, MeasureOfCells};
pub use measure_kernel::{KernelOf, KernelRange, place_kernel};
pub use pixels::influence_of_pixels;
pub use sensitivity::{SeenMeasure, Within};

#[cfg(test)]
mod tests;
