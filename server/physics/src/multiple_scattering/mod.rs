//! Multiple scattering by successive orders (van de Hulst 1948): all orders beyond the first, over a Lambertian ground
//! (`docs/model.md#multiple-scattering`).
//!
//! The light of one source is symmetric about the source's vertical. So the radiance of each order is stored on
//! a two-dimensional grid (distance from the vertical by altitude) as moments over direction, which a phase
//! function multiplies by its own. First-order light arrives from a point and is integrated exactly at every
//! place ([`first_order`], [`reflected`]); each later order is followed along straight rays from every place
//! ([`transport`]). An observer's sky is one more integral along the view ray ([`view`]).
//! The base of a cloud, if there is one, closes the grid: what it reflects counts as one scattering, like the ground's.
//!
//! [`monte_carlo`] is the reference solution of the solver: it shares only columns and phase functions with it.

mod budget;
mod direct;
mod energy;
mod field;
mod first_order;
mod gathering;
mod grid;
mod harmonics;
mod lanes;
mod log_field;
pub mod monte_carlo;
mod optics;
mod path;
mod radiance;
mod reflected;
mod setting;
mod smoothing;
mod source_function;
mod sum;
mod surfaces;
mod transport;
mod view;

pub use energy::OrderPower;
pub use field::SourceField;
use lanes::{LANES, Lanes};
pub use setting::{DEFAULT_GROUND_ALBEDO, MIN_BELOW_BASE_M, Resolution, SourceSetting};
pub use sum::{FieldCache, MultipleSum, SumDensity};
pub use view::ViewRow;

#[cfg(test)]
mod tests;

#[cfg(test)]
mod overcast_tests;

#[cfg(test)]
mod solver_checks;
