//! The reference solution in f64: the same tables by plain sums, without transforms. Both executors are measured against it; the blend and
//! the mixing of lobes are the twins' own, in f64.

use crate::{
    node_table::{NodeTable, WINDOW},
    prepare::{MixNode, Prepared},
    table_set::TableSet,
    twin::{blend_radiance, lobe_shares, log_scale_between, mixed_curvature},
};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, Panorama};
use skyglow_tables::resident::{FREQUENCY_COUNT, ResidentTables};

/// Radiance `[band][row][column]`, W m⁻² sr⁻¹, of a prepared request; seconds, not milliseconds.
pub fn render_f64(request: &Prepared, set: &TableSet) -> Vec<f64> {
    let stencil = &request.turbidity_stencil;
    let mut rendered: Vec<Vec<f64>> =
        stencil.nodes().map(|pack| render_pack(request, &set.tables()[pack])).collect();
    if rendered.len() == 1 {
        return rendered.swap_remove(0);
    }
    let [weight, linear] = [stencil.weights(), stencil.linear_weights()]
        .map(|weights| std::array::from_fn(|pack| weights.get(pack).copied().unwrap_or(0.0)));
    (0..Panorama::LEN)
        .map(|sample| {
            // A pack that is not there has no weight; any other's sample stands in for it.
            let radiance = std::array::from_fn(|pack| rendered[pack.min(rendered.len() - 1)][sample]);
            blend_radiance(radiance, weight, linear)
        })
        .collect()
}

fn render_pack(request: &Prepared, tables: &ResidentTables) -> Vec<f64> {
    let basis_count = request.basis_count.min(tables.basis_count);
    let columns = columns(request, tables, basis_count);
    let basis = basis_images(tables, basis_count);
    let mut radiance_w_m2_sr = vec![0.0; Panorama::LEN];
    for band in 0..BAND_COUNT {
        for (slot, lit) in request.columns.iter().enumerate() {
            for row in 0..ELEVATION_COUNT {
                let target = &mut radiance_w_m2_sr[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
                for k in 0..basis_count {
                    let value = columns[(slot * BAND_COUNT + band) * basis_count + k];
                    let image = &basis[(k * ELEVATION_COUNT + row) * AZIMUTH_COUNT..][..AZIMUTH_COUNT];
                    // Azimuth difference 0 lies at the lit column; the image repeats after 256.
                    let (first, second) = target.split_at_mut(lit.azimuth as usize);
                    for (sum, sample) in second.iter_mut().chain(first).zip(image) {
                        *sum += value * sample;
                    }
                }
            }
        }
    }
    radiance_w_m2_sr.iter().map(|value| value.max(0.0)).collect()
}

/// H, `[column slot][band][function]`.
fn columns(request: &Prepared, tables: &ResidentTables, basis_count: usize) -> Vec<f64> {
    let nodes: Vec<ExactNode> = (0..BAND_COUNT)
        .flat_map(|band| request.nodes.iter().map(move |node| (band, node)))
        .map(|(band, node)| mixed_node(request, tables, band, node, basis_count))
        .collect();
    let mut columns = vec![0.0; request.columns.len() * BAND_COUNT * basis_count];
    for (slot, lit) in request.columns.iter().enumerate() {
        for band in 0..BAND_COUNT {
            let sums = &mut columns[(slot * BAND_COUNT + band) * basis_count..][..basis_count];
            for cell in &request.cells[lit.first_cell as usize..lit.end_cell as usize] {
                let at = |node: u32| &nodes[band * request.nodes.len() + node as usize];
                let (lower, upper) = (at(cell.lower_node), at(cell.upper_node()));
                let weight = f64::from(cell.upper_weight);
                let flux_w = f64::from(cell.flux_dnb_w) * f64::from(request.flux_per_dnb_flux[band]);
                let scale = flux_w * lower.log_scale_between(upper, weight).exp();
                for ((sum, low), high) in sums.iter_mut().zip(&lower.shape).zip(&upper.shape) {
                    *sum += scale * (low + weight * (high - low));
                }
            }
        }
    }
    columns
}

/// A node's altitudes and lobes mixed: its light is `exp(log_scale) · Σ_k shape_k · B_k`.
#[derive(Clone, Debug)]
pub struct ExactNode {
    /// ln of the scale, m⁻² sr⁻¹ per watt.
    pub log_scale: f64,
    /// How that curves over the offset: [`skyglow_tables::curvature`].
    pub curvature: f64,
    /// Shape coefficients.
    pub shape: Vec<f64>,
}

impl ExactNode {
    /// ln of the scale between this node and the one above, at `upper_weight` 0..1.
    pub fn log_scale_between(&self, upper: &Self, upper_weight: f64) -> f64 {
        log_scale_between([self.log_scale, upper.log_scale], [self.curvature, upper.curvature], upper_weight)
    }
}

/// One node in one band, with `basis_count` functions.
pub fn mixed_node(
    request: &Prepared,
    tables: &ResidentTables,
    band: usize,
    node: &MixNode,
    basis_count: usize,
) -> ExactNode {
    let table = NodeTable::of(tables, request, node);
    let mut log_scale = [0.0; LOBE_COUNT];
    let mut windows = [[0.0; LOBE_COUNT]; WINDOW];
    for lobe in (0..LOBE_COUNT).filter(|&lobe| request.emission[lobe] > 0.0) {
        for (place, window) in windows.iter_mut().enumerate() {
            let at = |altitude| f64::from(table.window(altitude, lobe, band)[place]);
            window[lobe] = table.altitudes.sum(at);
        }
        log_scale[lobe] = windows[table.place_in_window][lobe];
    }
    let [first, second, third, log_scale] = lobe_shares(request.emission.map(f64::from), log_scale);
    let shares = [first, second, third];
    let shape = (0..basis_count)
        .map(|k| {
            (0..LOBE_COUNT)
                .filter(|&lobe| shares[lobe] > 0.0)
                .map(|lobe| {
                    let shape = |altitude| {
                        let image = table.shape_index(altitude, lobe, band);
                        let row = &table.shape[image * table.basis_count..][..table.basis_count];
                        row.get(k).map_or(0.0, |value| value.to_f64())
                    };
                    shares[lobe] * table.altitudes.sum(shape)
                })
                .sum()
        })
        .collect();
    ExactNode { log_scale, curvature: mixed_curvature(shares, windows), shape }
}

/// The basis itself, `[function][row][column]`, from its spectrum; column 0 looks at the source.
pub fn basis_images(tables: &ResidentTables, basis_count: usize) -> Vec<f64> {
    let cosine: Vec<f64> = (0..AZIMUTH_COUNT)
        .map(|step| (std::f64::consts::TAU * step as f64 / AZIMUTH_COUNT as f64).cos())
        .collect();
    let mut images = Vec::with_capacity(basis_count * ELEVATION_COUNT * AZIMUTH_COUNT);
    for k in 0..basis_count {
        for row in 0..ELEVATION_COUNT {
            let spectrum = &tables.basis_spectrum[tables.spectrum_index(k, row, 0)..][..FREQUENCY_COUNT];
            for column in 0..AZIMUTH_COUNT {
                let sum: f64 = spectrum
                    .iter()
                    .enumerate()
                    .map(|(f, value)| {
                        let twice = if f == 0 || f == FREQUENCY_COUNT - 1 { 1.0 } else { 2.0 };
                        twice * f64::from(*value) * cosine[f * column % AZIMUTH_COUNT]
                    })
                    .sum();
                images.push(sum / AZIMUTH_COUNT as f64);
            }
        }
    }
    images
}
