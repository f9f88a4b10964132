//! Both executors on one set of packs, and the skies that are asked of them.

use skyglow_physics::{AZIMUTH_COUNT, EmissionMix, GeoPoint, Turbidity};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, RenderError, RenderRequest, TableSet, prepare::Prepared,
    reference::render_f64, resident_tables, synthetic::tested_device,
};
use skyglow_scene::{PolarCell, PolarGrid};
use skyglow_tables::{ResidentTables, Scattering, packs_in};
use skyglow_tests::tree;
use std::{error::Error, sync::Arc};

/// A lit cell with its column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lamp {
    /// Azimuth column, 0..256.
    pub(crate) column: usize,
    /// Ring, 0..192.
    pub(crate) ring: u32,
    /// Upward flux, DNB watts.
    pub(crate) flux_dnb_w: f32,
    /// Altitude, metres.
    pub(crate) altitude_m: f32,
    /// Index of the blocking angle, 0..8.
    pub(crate) blocking: u32,
}

impl Lamp {
    /// A lamp under an open sky.
    pub(crate) fn open(column: usize, ring: u32, flux_dnb_w: f32, altitude_m: f32) -> Self {
        Self { column, ring, flux_dnb_w, altitude_m, blocking: 0 }
    }
}

/// The polar grid of some lamps.
pub(crate) fn grid_of(lamps: &[Lamp]) -> PolarGrid {
    let mut sorted = lamps.to_vec();
    sorted.sort_by_key(|lamp| (lamp.column, lamp.ring, lamp.blocking));
    let cell = |lamp: &Lamp| PolarCell {
        ring: lamp.ring,
        flux_dnb_w: lamp.flux_dnb_w,
        altitude_m: lamp.altitude_m,
        blocking: lamp.blocking,
    };
    PolarGrid {
        observer: GeoPoint::from_rad_unchecked(0.0, 0.0),
        azimuth_start: (0..=AZIMUTH_COUNT)
            .map(|column| sorted.partition_point(|lamp| lamp.column < column) as u32)
            .collect(),
        flux_dnb_w: sorted.iter().map(|lamp| f64::from(lamp.flux_dnb_w)).sum(),
        cells: sorted.iter().map(cell).collect(),
        near: Vec::new(),
        coverage: 1.0,
    }
}

/// The lamps of a grid.
pub(crate) fn lamps_of(grid: &PolarGrid) -> Vec<Lamp> {
    (0..AZIMUTH_COUNT)
        .flat_map(|column| {
            let cells = grid.azimuth_start[column] as usize..grid.azimuth_start[column + 1] as usize;
            grid.cells[cells].iter().map(move |cell| Lamp {
                column,
                ring: cell.ring,
                flux_dnb_w: cell.flux_dnb_w,
                altitude_m: cell.altitude_m,
                blocking: cell.blocking,
            })
        })
        .collect()
}

/// The packs that come with the program.
pub(crate) fn shipped_tables() -> Result<Vec<Arc<ResidentTables>>, Box<dyn Error>> {
    Ok(resident_tables(&packs_in(&tree::root().join("precomputed"))?)?.0)
}

/// What the checks work on.
pub(crate) struct Bench {
    /// Both executors on the packs that come with the program.
    pub(crate) shipped: Rig,
}

/// Plain Rust and Vulkan on the same packs: Mesa's in software, or a GPU's where `SKYGLOW_TEST_DEVICE` is `gpu`.
pub(crate) struct Rig {
    /// The packs as one set.
    pub(crate) set: TableSet,
    engines: Vec<(&'static str, Engine)>,
}

impl Rig {
    /// Both executors.
    pub(crate) fn of(tables: Vec<Arc<ResidentTables>>) -> Result<Self, RenderError> {
        Self::with(tables, &[DeviceChoice::Cpu, tested_device().choice()])
    }

    /// The executors asked for, the first of them the one that [`Self::sky`] takes.
    pub(crate) fn with(
        tables: Vec<Arc<ResidentTables>>,
        devices: &[DeviceChoice],
    ) -> Result<Self, RenderError> {
        let set = TableSet::new(tables.clone())?;
        let start = |device: &DeviceChoice| {
            let config = EngineConfig {
                device: *device,
                tables: tables.clone(),
                budget_bytes: 8 << 30,
                ..EngineConfig::default()
            };
            let engine = Engine::start(config)?;
            Ok((engine.info().executor.name(), engine))
        };
        Ok(Self { engines: devices.iter().map(start).collect::<Result<_, RenderError>>()?, set })
    }

    /// Names of the executors.
    pub(crate) fn executors(&self) -> impl Iterator<Item = &'static str> {
        self.engines.iter().map(|(name, _)| *name)
    }

    /// A request for the packs' own kind at their second turbidity (their first where there is one alone), 640 m up.
    pub(crate) fn request(&self, polar: PolarGrid) -> Result<RenderRequest, Box<dyn Error>> {
        let tables = self.set.tables();
        Ok(RenderRequest {
            polar: Arc::new(polar),
            observer_altitude_m: 640.0,
            turbidity: Turbidity::new(tables[1.min(tables.len() - 1)].turbidity)?,
            scattering: self.scattering(),
            cloud_base_m: None,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: skyglow_bench::options::REFERENCE_FLUX,
            basis: None,
        })
    }

    /// Orders of scattering of the packs.
    pub(crate) fn scattering(&self) -> Scattering {
        self.set.tables()[0].scattering
    }

    /// The sky by every executor, `[band][row][column]`, W m⁻² sr⁻¹.
    pub(crate) fn skies(
        &self,
        request: &RenderRequest,
    ) -> Result<Vec<(&'static str, Vec<f32>)>, RenderError> {
        let render = |(name, engine): &(&'static str, Engine)| {
            Ok((*name, engine.render_blocking(request.clone())?.panorama.samples().to_vec()))
        };
        self.engines.iter().map(render).collect()
    }

    /// The sky by the first executor.
    pub(crate) fn sky(&self, request: &RenderRequest) -> Result<Vec<f32>, RenderError> {
        Ok(self.engines[0].1.render_blocking(request.clone())?.panorama.samples().to_vec())
    }

    /// The sky in f64 by plain sums.
    pub(crate) fn exact(&self, request: &RenderRequest) -> Result<Vec<f64>, RenderError> {
        Ok(render_f64(&Prepared::new(request, &self.set)?, &self.set))
    }
}

/// f32 as f64.
pub(crate) fn widened(values: &[f32]) -> impl Iterator<Item = f64> {
    values.iter().map(|value| f64::from(*value))
}

/// The brightest sample of each row of each band, for every sample: what the transforms along azimuth round to.
pub(crate) fn row_maxima(sky: &[f64]) -> Vec<f64> {
    let brightest = |row: &[f64]| row.iter().copied().fold(0.0, f64::max);
    sky.chunks_exact(AZIMUTH_COUNT).flat_map(|row| [brightest(row); AZIMUTH_COUNT]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_render::synthetic;

    #[test]
    fn lamps_make_the_grid_that_they_are_read_from() {
        let mut grid = synthetic::polar_grid_with_skylines(4, 900);
        grid.flux_dnb_w = grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum();
        let mut lamps = lamps_of(&grid);
        lamps.reverse();
        assert_eq!(grid_of(&lamps), grid);
    }
}
