//! The scales of a cell between its two nodes, and how what comes of them changes with the cell's altitude.

use skyglow_physics::BAND_COUNT;
use skyglow_render::{
    cpu::layout::NodeScales,
    prepare::PreparedCell,
    twin::{log_scale_between, natural_exp},
};

/// Step in the weight of the upper node over which slopes are differences.
const SLOPE_STEP: f32 = 0.02;

/// The scales of a cell's nodes in one pack.
pub(super) struct CellScales<'a>([&'a NodeScales; 2]);

impl CellScales<'_> {
    /// scale·shape of products with a measure, `[lower, upper][band]`, in every band, and its slope over the weight of the upper node.
    pub(super) fn times(
        &self,
        flux_per_dnb_flux: [f32; BAND_COUNT],
        upper_weight: f32,
        products: &[[f32; BAND_COUNT]; 2],
    ) -> [Slope; BAND_COUNT] {
        let steps = steps_around(upper_weight);
        std::array::from_fn(|band| {
            let log_scale = |weight: f32| self.log_scale(band, weight);
            let scale = flux_per_dnb_flux[band] * natural_exp(log_scale(upper_weight));
            let [lower, upper] = products.map(|product| product[band]);
            let shape = (1.0 - upper_weight) * lower + upper_weight * upper;
            let slope = steps.map_or(0.0, |(low, high)| {
                let log_slope = (log_scale(high) - log_scale(low)) / (high - low);
                scale * (log_slope * shape + upper - lower)
            });
            Slope { value: f64::from(scale * shape), slope: f64::from(slope) }
        })
    }

    fn log_scale(&self, band: usize, upper_weight: f32) -> f32 {
        let log_scale = self.0.map(|scales| scales.log_scale[band]);
        let curvature = self.0.map(|scales| scales.curvature[band]);
        log_scale_between(log_scale, curvature, upper_weight)
    }

    /// Flux times scale of every band at a weight of the upper node, m⁻² sr⁻¹ per DNB watt.
    pub(super) fn scale(&self, flux_per_dnb_flux: [f32; BAND_COUNT], upper_weight: f32) -> [f32; BAND_COUNT] {
        std::array::from_fn(|band| flux_per_dnb_flux[band] * natural_exp(self.log_scale(band, upper_weight)))
    }
}

/// A value per DNB watt, and how it changes with the place on the offset axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slope {
    pub(super) value: f64,
    pub(super) slope: f64,
}

impl Slope {
    pub(super) fn add(&mut self, other: Self) {
        self.value += other.value;
        self.slope += other.slope;
    }

    /// d ln(value)/d(place); 0 where the value is not above 0.
    pub(super) fn log_slope(self) -> f64 {
        if self.value > 0.0 { self.slope / self.value } else { 0.0 }
    }
}

/// The weights that a slope is a difference between; None right on a node, which has no other beside it.
pub(super) fn steps_around(upper_weight: f32) -> Option<(f32, f32)> {
    let ends = ((upper_weight - SLOPE_STEP).max(0.0), (upper_weight + SLOPE_STEP).min(1.0));
    (upper_weight > 0.0).then_some(ends)
}

pub(super) fn scales_of<'a>(cell: &PreparedCell, scales: &'a [NodeScales]) -> CellScales<'a> {
    CellScales([cell.lower_node, cell.upper_node()].map(|node| &scales[node as usize]))
}
