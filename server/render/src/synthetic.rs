//! Synthetic tables and grids: smooth, positive, fast to make. For tests and benches, never for a sky that anyone
//! is shown.

use crate::request::{ExecutorKind, RenderRequest};
use half::f16;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, EmissionMix, GeoPoint, LOBE_COUNT, Turbidity,
    blocking::{BLOCKING_ANGLES_DEG, BLOCKING_COUNT},
};
use skyglow_scene::{PolarCell, PolarGrid, RING_COUNT, ring_distance_m};
use skyglow_tables::{
    Clouds, OffsetAxis, Scattering,
    resident::{FREQUENCY_COUNT, ResidentBlocked, ResidentTables},
};
use std::sync::Arc;

/// The device with Vulkan that tests run on: lavapipe, unless `SKYGLOW_TEST_DEVICE` is `gpu`.
pub fn tested_device() -> ExecutorKind {
    match std::env::var("SKYGLOW_TEST_DEVICE").as_deref() {
        Ok("gpu") => ExecutorKind::Gpu,
        _ => ExecutorKind::Lavapipe,
    }
}

/// Nodes of the made-up packs' offset axis.
const OFFSET_COUNT: usize = 15;

/// A small generator of repeatable numbers (splitmix64).
#[derive(Clone, Debug)]
pub struct Noise(u64);

impl Noise {
    /// Numbers that depend on `seed` alone.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// One made-up pack of first-order light per turbidity, on common axes.
pub fn table_set(turbidities: &[f64], basis_count: usize) -> Vec<Arc<ResidentTables>> {
    table_set_of(Scattering::Single, turbidities, basis_count)
}

/// One made-up pack per turbidity, on common axes.
pub fn table_set_of(
    scattering: Scattering,
    turbidities: &[f64],
    basis_count: usize,
) -> Vec<Arc<ResidentTables>> {
    let pack = |&turbidity| match scattering {
        Scattering::Single => tables(turbidity, basis_count),
        Scattering::Multiple => with_all_orders(tables(turbidity, basis_count)),
    };
    turbidities.iter().map(|turbidity| Arc::new(pack(turbidity))).collect()
}

/// Packs as if they had been made under a closed layer of cloud.
pub fn under_clouds(tables: Vec<Arc<ResidentTables>>, base_m: u32) -> Vec<Arc<ResidentTables>> {
    let cover = |pack: Arc<ResidentTables>| {
        let mut pack = Arc::unwrap_or_clone(pack);
        pack.clouds = Clouds::new(base_m, 0.5).ok();
        pack.checksum.insert_str(0, "clouds-");
        Arc::new(pack)
    };
    tables.into_iter().map(cover).collect()
}

/// Makes a made-up pack brighter, the more the farther the source, as multiple scattering does.
fn with_all_orders(mut tables: ResidentTables) -> ResidentTables {
    tables.scattering = Scattering::Multiple;
    tables.checksum.insert_str(0, "multiple-");
    let (rings, offsets) = (tables.ring_distance_m.len(), tables.offset_count);
    for (node, log_scale) in tables.log_scale.iter_mut().enumerate() {
        let distance_m = tables.ring_distance_m[node / offsets % rings];
        *log_scale += (1.0 + distance_m / 20_000.0).ln() as f32;
    }
    tables
}

/// Lobe and band of every image, in the order of tables.
fn images() -> impl Iterator<Item = (usize, usize)> {
    (0..LOBE_COUNT * BAND_COUNT).map(|image| (image / BAND_COUNT, image % BAND_COUNT))
}

/// A made-up pack: brightness falls with distance and altitude, the first function is a glow towards the source,
/// the others are ripples on it that shrink with their order.
pub fn tables(turbidity: f64, basis_count: usize) -> ResidentTables {
    let observer_altitude_m = vec![0.0, 500.0, 1200.0, 2500.0, 4000.0, 6000.0];
    let ring_distances_m: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let mut log_scale = Vec::new();
    for observer_m in &observer_altitude_m {
        for lobe in 0..LOBE_COUNT {
            for band in 0..BAND_COUNT {
                for distance_m in &ring_distances_m {
                    let axis = OffsetAxis::at_distance(*distance_m, OFFSET_COUNT);
                    for offset_m in (0..OFFSET_COUNT).map(|node| axis.offset_m(node as f64)) {
                        let reach_m = 30_000.0 * (1.0 + 0.3 * lobe as f64) / turbidity.sqrt();
                        log_scale.push(
                            (-18.0
                                - 1.3 * distance_m.ln()
                                - distance_m / reach_m * (1.0 + 0.2 * band as f64)
                                - (observer_m - offset_m) / 7000.0) as f32,
                        );
                    }
                }
            }
        }
    }
    let mut shape = Vec::new();
    for distance_m in &ring_distances_m {
        let axis = OffsetAxis::at_distance(*distance_m, OFFSET_COUNT);
        for offset_m in (0..OFFSET_COUNT).map(|node| axis.offset_m(node as f64)) {
            for observer_m in &observer_altitude_m {
                for (lobe, band) in images() {
                    for k in 0..basis_count {
                        let wave = (0.7 * k as f64 + distance_m.ln() * (0.5 + 0.11 * k as f64)
                            - offset_m / 4000.0
                            + observer_m / 9000.0
                            + lobe as f64
                            + 0.3 * band as f64)
                            .sin();
                        let value = if k == 0 { 1.0 + 0.2 * wave } else { 0.25 * wave / (1 + k) as f64 };
                        shape.push(f16::from_f64(value));
                    }
                }
            }
        }
    }
    ResidentTables {
        turbidity,
        scattering: Scattering::Single,
        clouds: None,
        checksum: format!("{:016x}", turbidity.to_bits() ^ basis_count as u64),
        is_synthetic: true,
        observer_altitude_m,
        offset_count: OFFSET_COUNT,
        offset_axis: ring_distances_m
            .iter()
            .map(|distance_m| OffsetAxis::at_distance(*distance_m, OFFSET_COUNT))
            .collect(),
        ring_distance_m: ring_distances_m,
        basis_count,
        log_scale,
        shape,
        basis_spectrum: basis_spectrum(turbidity, basis_count),
        blocked: None,
    }
}

/// One made-up pack of first-order light per turbidity, each with tables of sources behind skylines.
pub fn table_set_with_skylines(turbidities: &[f64], basis_count: usize) -> Vec<Arc<ResidentTables>> {
    let pack = |&turbidity: &f64| {
        let open = tables(turbidity, basis_count);
        Arc::new(ResidentTables { blocked: Some(blocked_tables(&open)), ..open })
    };
    turbidities.iter().map(pack).collect()
}

/// Nodes of the offset axis of made-up tables of sources behind skylines.
const BLOCKED_OFFSET_COUNT: usize = 6;

/// Made-up tables of sources behind skylines, with fewer functions: darker the higher the skyline and the farther.
fn blocked_tables(open: &ResidentTables) -> ResidentBlocked {
    let basis_count = (open.basis_count / 2).next_multiple_of(4);
    let axis = |angle_index: usize, distance_m: &f64| {
        let mut axis = OffsetAxis::at_distance(*distance_m, BLOCKED_OFFSET_COUNT);
        axis.kink_m -= 40.0 * (angle_index + 1) as f64;
        axis
    };
    let angles = 0..ResidentBlocked::ANGLE_COUNT;
    let mut blocked = ResidentBlocked {
        observer_altitude_m: vec![0.0, 1500.0, 6000.0],
        offset_count: BLOCKED_OFFSET_COUNT,
        offset_axis: angles
            .map(|angle| open.ring_distance_m.iter().map(|distance_m| axis(angle, distance_m)).collect())
            .collect(),
        basis_count,
        log_scale: Vec::new(),
        shape: Vec::new(),
    };
    for observer_m in blocked.observer_altitude_m.clone() {
        for (angle_index, axes) in blocked.offset_axis.iter().enumerate() {
            let angle_rad = BLOCKING_ANGLES_DEG[angle_index + 1].to_radians();
            for _ in images() {
                for (axis, distance_m) in axes.iter().zip(&open.ring_distance_m) {
                    for offset_m in (0..axis.count).map(|node| axis.offset_m(node as f64)) {
                        let hidden =
                            0.5 * angle_index as f64 + (distance_m * angle_rad.tan() / 9000.0).min(6.0);
                        blocked.log_scale.push(
                            (-18.0 - 1.3 * distance_m.ln() - hidden - (observer_m - offset_m) / 7000.0)
                                as f32,
                        );
                    }
                }
            }
        }
    }
    for (angle_index, axes) in blocked.offset_axis.iter().enumerate() {
        let angle_rad = BLOCKING_ANGLES_DEG[angle_index + 1].to_radians();
        for (axis, distance_m) in axes.iter().zip(&open.ring_distance_m) {
            for offset_m in (0..axis.count).map(|node| axis.offset_m(node as f64)) {
                for observer_m in &blocked.observer_altitude_m {
                    for (lobe, band) in images() {
                        for k in 0..basis_count {
                            let wave = (0.9 * k as f64 + distance_m.ln() + angle_rad - offset_m / 4000.0
                                + observer_m / 9000.0
                                + lobe as f64
                                + 0.3 * band as f64)
                                .cos();
                            let value = if k == 0 { 0.9 + 0.2 * wave } else { 0.2 * wave / (1 + k) as f64 };
                            blocked.shape.push(f16::from_f64(value));
                        }
                    }
                }
            }
        }
    }
    blocked
}

fn basis_spectrum(turbidity: f64, basis_count: usize) -> Vec<f32> {
    let mut spectrum = Vec::with_capacity(basis_count * ELEVATION_COUNT * FREQUENCY_COUNT);
    for k in 0..basis_count {
        for row in 0..ELEVATION_COUNT {
            let height = (row as f64 + 0.5) / ELEVATION_COUNT as f64;
            for f in 0..FREQUENCY_COUNT {
                // Poisson kernel: Σ ρ^f cos fθ is positive and even.
                let (narrowness, ripple) = if k == 0 {
                    (0.8 - 0.5 * height, 1.0)
                } else {
                    (0.7 - 0.3 * height, (k as f64 * (1.3 * height + 0.2) + 0.1 * f as f64 + turbidity).cos())
                };
                let brightness = 20.0 * (-2.5 * height).exp();
                spectrum.push((brightness * ripple * f64::powi(narrowness, f as i32)) as f32);
            }
        }
    }
    spectrum
}

/// The made-up lamps' flux in each band per DNB flux: 0.4, 0.6, 0.2 and so on again.
pub fn flux_per_dnb_flux() -> [f64; BAND_COUNT] {
    std::array::from_fn(|band| [0.4, 0.6, 0.2][band % 3])
}

/// A request for the sky of a grid: first order, clear, the eye between the tables' altitudes.
pub fn request(polar: PolarGrid, turbidity: Turbidity) -> RenderRequest {
    RenderRequest {
        polar: Arc::new(polar),
        observer_altitude_m: 1661.0,
        turbidity,
        scattering: Scattering::Single,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: flux_per_dnb_flux(),
        basis: None,
    }
}

/// A grid without light.
pub fn dark_grid() -> PolarGrid {
    PolarGrid {
        observer: GeoPoint::from_rad_unchecked(0.0, 0.0),
        azimuth_start: vec![0; AZIMUTH_COUNT + 1],
        cells: Vec::new(),
        near: Vec::new(),
        flux_dnb_w: 0.0,
        coverage: 1.0,
    }
}

/// A grid of the given (column, ring, flux in DNB watts, altitude in metres) cells.
pub fn polar_grid_of(cells: &[(usize, u32, f32, f32)]) -> PolarGrid {
    let mut sorted = cells.to_vec();
    sorted.sort_by_key(|cell| (cell.0, cell.1));
    let mut grid = dark_grid();
    for azimuth in 0..AZIMUTH_COUNT {
        for &(_, ring, flux_dnb_w, altitude_m) in sorted.iter().filter(|cell| cell.0 == azimuth) {
            grid.cells.push(PolarCell { ring, flux_dnb_w, altitude_m, blocking: 0 });
            grid.flux_dnb_w += f64::from(flux_dnb_w);
        }
        grid.azimuth_start[azimuth + 1] = grid.cells.len() as u32;
    }
    grid
}

/// A made-up region with part of its light behind skylines of all heights.
pub fn polar_grid_with_skylines(seed: u64, lit_cells: usize) -> PolarGrid {
    let mut grid = polar_grid(seed, lit_cells);
    let mut noise = Noise::new(seed ^ 0x5EED);
    for cell in &mut grid.cells {
        cell.blocking = (noise.unit() * 1.6 * BLOCKING_COUNT as f64) as u32;
        if cell.blocking >= BLOCKING_COUNT as u32 {
            cell.blocking = 0;
        }
    }
    grid
}

/// A made-up region: about `lit_cells` lit cells in towns of very different brightness, on hills.
pub fn polar_grid(seed: u64, lit_cells: usize) -> PolarGrid {
    let mut noise = Noise::new(seed);
    let share = lit_cells as f64 / (AZIMUTH_COUNT * RING_COUNT) as f64;
    let mut cells = Vec::new();
    for azimuth in 0..AZIMUTH_COUNT {
        for ring in 0..RING_COUNT {
            if noise.unit() < share {
                let flux_w = 10f64.powf(1.0 + 5.0 * noise.unit());
                let hill_m = 900.0 + 700.0 * (azimuth as f64 * 0.1 + ring as f64 * 0.05).sin();
                cells.push((azimuth, ring as u32, flux_w as f32, (hill_m + 50.0 * noise.unit()) as f32));
            }
        }
    }
    let mut grid = dark_grid();
    let mut next = 0;
    for azimuth in 0..AZIMUTH_COUNT {
        while next < cells.len() && cells[next].0 == azimuth {
            let (_, ring, flux_dnb_w, altitude_m) = cells[next];
            grid.cells.push(PolarCell { ring, flux_dnb_w, altitude_m, blocking: 0 });
            grid.flux_dnb_w += f64::from(flux_dnb_w);
            next += 1;
        }
        grid.azimuth_start[azimuth + 1] = grid.cells.len() as u32;
    }
    grid
}
