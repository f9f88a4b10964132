//! Options of a precompute: what a pack contains.

use crate::{
    axes::TableAxes,
    blocked::BlockedAxes,
    clouds::Clouds,
    fit_constants::FitConstants,
    manifest::{PackParameters, Scattering},
    multiple::MultipleAxes,
};
use skyglow_physics::{Atmosphere, CloudBase, Turbidity, multiple_scattering::DEFAULT_GROUND_ALBEDO};

/// What to make.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecomputeOptions {
    /// Turbidity of the pack.
    pub turbidity: Turbidity,
    /// Orders of scattering.
    pub scattering: Scattering,
    /// Sample points of multiply scattered light and the ground's albedo; unused where scattering is single.
    pub multiple: MultipleAxes,
    /// The layer of cloud that closes the sky; None for a clear one.
    pub clouds: Option<Clouds>,
    /// Sample points.
    pub axes: TableAxes,
    /// Sample points of sources behind skylines; None for the open sky alone.
    pub blocked: Option<BlockedAxes>,
    /// M.
    pub basis_count: BasisCount,
    /// Geometries in the training set of the basis; each gives six images.
    pub training_geometries: usize,
    /// Alternating-least-squares iterations.
    pub fit_iterations: usize,
    /// Sources on which the error is measured.
    pub error_sources: usize,
}

/// M, a multiple of 4, by the air: where it is clean, the edge of the `oblique` lobe is sharp in the sky, and takes more functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BasisCount {
    /// At turbidities of 2 and less.
    pub clean: usize,
    /// Above.
    pub hazy: usize,
}

impl BasisCount {
    /// Those of the packs that come with the program: of 8, 16, 32, 64, 80, 96 and 112 the smallest with which skies of every class
    /// hold their limits, but for two by a hundredth part (`docs/notebook/2026-11-27.md`).
    pub const SHIPPED: Self = Self { clean: 112, hazy: 96 };
    /// Those of packs under clouds, which send all light back from above, smoothly (`docs/notebook/2026-11-29.md`).
    pub const UNDER_CLOUDS: Self = Self::same(64);
    /// Highest turbidity of clean air.
    const CLEAN: f64 = 2.0;

    /// The same in any air.
    pub const fn same(count: usize) -> Self {
        Self { clean: count, hazy: count }
    }

    /// M of a turbidity's pack.
    pub fn at(self, turbidity: Turbidity) -> usize {
        if turbidity.value() <= Self::CLEAN { self.clean } else { self.hazy }
    }
}

impl PrecomputeOptions {
    /// A pack like those that come with the program.
    pub fn full(turbidity: Turbidity) -> Self {
        Self {
            turbidity,
            scattering: Scattering::Single,
            multiple: MultipleAxes::full(DEFAULT_GROUND_ALBEDO),
            clouds: None,
            axes: TableAxes::full(),
            blocked: Some(BlockedAxes::full()),
            basis_count: BasisCount::SHIPPED,
            training_geometries: 330,
            fit_iterations: 7,
            error_sources: 160,
        }
    }

    /// A pack made in seconds, for tests of everything but accuracy.
    pub fn coarse(turbidity: Turbidity) -> Self {
        Self {
            turbidity,
            scattering: Scattering::Single,
            multiple: MultipleAxes::coarse(DEFAULT_GROUND_ALBEDO),
            clouds: None,
            axes: TableAxes::coarse(),
            blocked: Some(BlockedAxes::coarse()),
            basis_count: BasisCount::same(16),
            training_geometries: 12,
            fit_iterations: 1,
            error_sources: 4,
        }
    }

    /// The same under a layer of cloud, with the sample points that there are below it, and none of sources behind skylines.
    pub fn under(self, clouds: Clouds) -> Self {
        Self {
            axes: self.axes.below(clouds),
            multiple: self.multiple.below(clouds),
            blocked: None,
            // A part more.
            training_geometries: self.training_geometries.div_ceil(3) * 4,
            clouds: Some(clouds),
            ..self
        }
    }

    /// The layer of cloud as a boundary of the air.
    pub(crate) fn cloud_base(&self) -> Option<CloudBase> {
        self.clouds.map(Clouds::base)
    }

    /// The air of a turbidity.
    pub(crate) fn atmosphere(&self, turbidity: Turbidity) -> Atmosphere {
        Atmosphere::new(turbidity).under(self.cloud_base())
    }

    /// Sample points of multiply scattered light; None for the first order alone.
    pub(crate) fn multiple_axes(&self) -> Option<&MultipleAxes> {
        (self.scattering == Scattering::Multiple).then_some(&self.multiple)
    }

    /// Sample points of sources behind skylines as packs can have them: with no more functions than any basis, and
    /// with later orders where there are any.
    pub(crate) fn blocked_axes(&self) -> Option<BlockedAxes> {
        self.blocked.as_ref().map(|axes| BlockedAxes {
            basis_count: axes.basis_count.min(self.basis_count.clean).min(self.basis_count.hazy),
            later: axes.later.clone().filter(|_| self.scattering == Scattering::Multiple),
            ..axes.clone()
        })
    }

    pub(crate) fn parameters(&self, turbidity: Turbidity) -> PackParameters {
        PackParameters {
            turbidity: turbidity.value(),
            scattering: self.scattering,
            multiple: self.multiple_axes().cloned(),
            clouds: self.clouds,
            axes: self.axes.clone(),
            blocked: self.blocked_axes(),
            basis_count: self.basis_count.at(turbidity),
            training_geometries: self.training_geometries,
            fit_iterations: self.fit_iterations,
            fit: FitConstants::current(),
        }
    }
}
