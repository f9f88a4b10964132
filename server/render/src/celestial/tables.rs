//! Celestial tables of all turbidities: skies of beams between them, with what was made of the tables kept for the altitudes that were
//! asked for last.

use super::{
    kept::Kept,
    node_skies::{BeamGrid, NodeSkies},
};
use crate::{
    cpu::blend::blend,
    error::RenderError,
    twin::{Twiddles, twiddles},
};
use skyglow_physics::{BAND_COUNT, Panorama, Turbidity, interpolation::Stencil};
use skyglow_tables::{CelestialTable, celestial_tables_in};
use std::{array::from_fn, path::Path, sync::Arc};

/// Altitudes of the observer that skies at the zenith angles of tables are made for, m; in between they are blended, so that the next
/// place nearby finds them made.
pub const ALTITUDES_M: [f64; 19] = [
    0.0, 250.0, 500.0, 750.0, 1_000.0, 1_250.0, 1_500.0, 1_750.0, 2_000.0, 2_250.0, 2_500.0, 2_750.0,
    3_000.0, 3_250.0, 3_500.0, 3_750.0, 4_000.0, 4_250.0, 4_500.0,
];
/// Bytes of them and of tables between turbidities that are kept at most.
pub const MAX_KEPT_BYTES: usize = 96 << 20;
/// Bytes of tables between turbidities among them: those of four turbidities.
const MAX_BETWEEN_BYTES: usize = 6 << 20;
/// Turbidities nearer than this to a table's are that table's own.
const SAME_TURBIDITY: f64 = 1e-9;

/// Tables in ascending turbidity, all on the same sample points.
pub struct CelestialTables {
    tables: Vec<Arc<CelestialTable>>,
    turbidities: Vec<f64>,
    twiddles: Twiddles,
    /// Tables between turbidities, by the bits of theirs.
    between: Kept<u64, CelestialTable>,
    /// By the bits of turbidity and the place among [`ALTITUDES_M`].
    skies: Kept<(u64, usize), NodeSkies>,
}

/// Skies of beams from every zenith angle of the tables around an observer's altitude.
pub struct SkiesAt<'a> {
    twiddles: &'a Twiddles,
    /// On the places of `skies`.
    altitude: Stencil,
    skies: Vec<Arc<NodeSkies>>,
}

impl SkiesAt<'_> {
    /// Scattered light of all beams of a grid on [`CelestialTables::zenith_angles_rad`], in the grid's unit per sr; dark where it is on
    /// others. In the logarithm between [`ALTITUDES_M`].
    pub fn sky(&self, grid: &BeamGrid) -> Panorama {
        let of = |place: usize| self.skies[place].sky(grid, self.twiddles).unwrap_or_else(Panorama::dark);
        let mut skies: Vec<Panorama> = self.altitude.nodes().map(of).collect();
        if skies.len() == 1 {
            return skies.swap_remove(0);
        }
        let sources: Vec<&[f32]> = skies.iter().map(Panorama::samples).collect();
        Panorama::from_samples(blend(&sources, &self.altitude, true)).unwrap_or_else(Panorama::dark)
    }
}

impl std::fmt::Debug for CelestialTables {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("CelestialTables").field("turbidities", &self.turbidities).finish()
    }
}

impl CelestialTables {
    /// Opens all in a folder; None where there are none.
    ///
    /// # Errors
    /// [`RenderError::Tables`] naming the file that is refused, [`RenderError::CelestialTables`].
    pub fn open(folder: &Path) -> Result<Option<Self>, RenderError> {
        let paths = celestial_tables_in(folder)?;
        let tables: Vec<CelestialTable> =
            paths.iter().map(|path| CelestialTable::open(path)).collect::<Result<_, _>>()?;
        if tables.is_empty() { Ok(None) } else { Self::new(tables).map(Some) }
    }

    /// From tables in any order, at least one.
    ///
    /// # Errors
    /// [`RenderError::CelestialTables`] where there is none, sample points differ, or a turbidity comes twice.
    pub fn new(mut tables: Vec<CelestialTable>) -> Result<Self, RenderError> {
        tables.sort_by(|a, b| a.turbidity().total_cmp(&b.turbidity()));
        let turbidities: Vec<f64> = tables.iter().map(CelestialTable::turbidity).collect();
        let refused = |reason: &str| RenderError::CelestialTables { reason: reason.to_owned() };
        let first = tables.first().ok_or_else(|| refused("there is none"))?;
        if tables.iter().any(|table| table.manifest().axes != first.manifest().axes) {
            return Err(refused("their sample points differ"));
        }
        if !turbidities.is_sorted_by(|a, b| a < b) {
            return Err(refused("a turbidity comes twice"));
        }
        Ok(Self {
            tables: tables.into_iter().map(Arc::new).collect(),
            turbidities,
            twiddles: twiddles(),
            between: Kept::new(MAX_BETWEEN_BYTES, CelestialTable::byte_count),
            skies: Kept::new(MAX_KEPT_BYTES - MAX_BETWEEN_BYTES, NodeSkies::byte_count),
        })
    }

    /// Smallest and largest turbidity.
    pub fn turbidity_range(&self) -> (f64, f64) {
        (self.turbidities[0], self.turbidities[self.turbidities.len() - 1])
    }

    /// Lowest and highest observer, m; beyond them the nearest counts.
    pub fn altitude_range_m(&self) -> (f64, f64) {
        self.tables[0].altitude_range_m()
    }

    /// BLAKE3 of each, hexadecimal, one after another.
    pub fn checksums(&self) -> String {
        self.tables.iter().map(|table| table.checksum()).collect::<Vec<_>>().join(" ")
    }

    /// Zenith angles of beams that grids are on, rad, ascending.
    pub fn zenith_angles_rad(&self) -> &[f64] {
        self.tables[0].zenith_angle_rad()
    }

    /// Tables around a turbidity, which counts as the nearest one where it lies beyond all.
    fn around(&self, turbidity: Turbidity) -> Stencil {
        Stencil::lagrange_or_node(&self.turbidities, turbidity.value(), SAME_TURBIDITY)
    }

    /// The table of a turbidity, which counts as the nearest one where it lies beyond all.
    fn table(&self, turbidity: Turbidity) -> Arc<CelestialTable> {
        let stencil = self.around(turbidity);
        match stencil.weights() {
            [_] => Arc::clone(&self.tables[stencil.nodes().start]),
            _ => self.between.get(turbidity.value().to_bits(), || {
                CelestialTable::between(&self.tables[stencil.nodes()], stencil.weights(), turbidity)
            }),
        }
    }

    /// Scattered light of a beam of unit irradiance, sr⁻¹, from a true zenith angle and azimuth, rad; between turbidities what tables
    /// hold is interpolated.
    pub fn beam_sky(
        &self,
        turbidity: Turbidity,
        (zenith_angle_rad, azimuth_rad): (f64, f64),
        observer_altitude_m: f64,
    ) -> Panorama {
        self.table(turbidity).beam_sky(zenith_angle_rad, azimuth_rad, observer_altitude_m)
    }

    /// Skies of beams around an altitude, at a turbidity as [`Self::beam_sky`] has it; they are made where they are not kept.
    pub fn skies_at(&self, turbidity: Turbidity, observer_altitude_m: f64) -> SkiesAt<'_> {
        let (lowest_m, highest_m) = self.altitude_range_m();
        let altitude_m = observer_altitude_m.clamp(lowest_m, highest_m);
        let above = ALTITUDES_M.partition_point(|m| *m <= altitude_m).clamp(1, ALTITUDES_M.len() - 1);
        let around = above - 1..above + 1;
        let altitude = Stencil::lagrange_or_node(&ALTITUDES_M[around.clone()], altitude_m, 1e-6);
        let table = self.table(turbidity);
        let skies = around.enumerate().filter(|(place, _)| altitude.nodes().contains(place));
        let skies = skies.map(|(_, node)| {
            self.skies.get((table.turbidity().to_bits(), node), || {
                let sky = |zenith: usize| table.node_sky(zenith, ALTITUDES_M[node]);
                NodeSkies::of(table.zenith_angle_rad().len(), sky, &self.twiddles)
            })
        });
        let skies: Vec<Arc<NodeSkies>> = skies.collect();
        let altitude = if skies.len() == 1 { Stencil::single(0) } else { altitude };
        SkiesAt { twiddles: &self.twiddles, altitude, skies }
    }

    /// What [`SkiesAt::sky`] has of one grid.
    pub fn grid_sky(&self, turbidity: Turbidity, grid: &BeamGrid, observer_altitude_m: f64) -> Panorama {
        self.skies_at(turbidity, observer_altitude_m).sky(grid)
    }

    /// What lights of several kinds scatter to the zenith that are the same at all azimuths: each of `rings` is the irradiance of one
    /// kind at each of [`Self::zenith_angles_rad`], of all azimuths together, in any unit.
    pub fn zenith_of_rings<const KINDS: usize>(
        &self,
        turbidity: Turbidity,
        rings: &[Vec<[f64; BAND_COUNT]>; KINDS],
        observer_altitude_m: f64,
    ) -> [[f64; BAND_COUNT]; KINDS] {
        let stencil = self.around(turbidity);
        let mut sums = [[0.0; BAND_COUNT]; KINDS];
        for node in 0..self.zenith_angles_rad().len() {
            let of_table =
                |table: usize| self.tables[table].node_zenith(node, observer_altitude_m).map(f64::ln);
            let logs: Vec<[f64; BAND_COUNT]> = stencil.nodes().map(of_table).collect();
            let first = stencil.nodes().start;
            let sky: [f64; BAND_COUNT] = from_fn(|band| stencil.sum(|table| logs[table - first][band]).exp());
            for (sum, ring) in sums.iter_mut().zip(rings).filter_map(|(sum, of)| Some((sum, of.get(node)?))) {
                sum.iter_mut().zip(ring).zip(sky).for_each(|((sum, ring), sky)| *sum += ring * sky);
            }
        }
        sums
    }

    /// Share of a beam that reaches the observer directly, by band; 0 below the horizon.
    pub fn transmittance(
        &self,
        turbidity: Turbidity,
        zenith_angle_rad: f64,
        observer_altitude_m: f64,
    ) -> [f64; BAND_COUNT] {
        let stencil = self.around(turbidity);
        let shares: Vec<[f64; BAND_COUNT]> = stencil
            .nodes()
            .map(|table| self.tables[table].transmittance(zenith_angle_rad, observer_altitude_m))
            .collect();
        from_fn(|band| {
            // Optical depth is linear in turbidity; where the edge of the shadow lies between tables, the nearest decides.
            let depth = |at: usize| -shares[at - stencil.nodes().start][band].max(1e-30).ln();
            let is_dark = shares.iter().any(|share| share[band] <= 0.0);
            if is_dark { 0.0 } else { (-stencil.sum(depth)).exp() }
        })
    }

    /// Bytes of what is kept.
    pub fn kept_bytes(&self) -> usize {
        self.between.bytes() + self.skies.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::AZIMUTH_COUNT;

    fn tables(turbidities: &[f64]) -> CelestialTables {
        let table = |turbidity: &f64| CelestialTable::synthetic(Turbidity::new(*turbidity).unwrap());
        CelestialTables::new(turbidities.iter().map(table).collect()).unwrap()
    }

    /// A beam of one zenith angle and azimuth as a grid.
    fn single_beam(tables: &CelestialTables, node: usize, column: usize) -> BeamGrid {
        let nodes = tables.zenith_angles_rad().len();
        let mut irradiance = vec![0.0; BAND_COUNT * nodes * AZIMUTH_COUNT];
        for band in 0..BAND_COUNT {
            irradiance[(band * nodes + node) * AZIMUTH_COUNT + column] = 2.0;
        }
        BeamGrid::new(nodes, irradiance).unwrap()
    }

    fn largest_difference(a: &Panorama, b: &Panorama, factor: f32) -> f32 {
        let relative = |(a, b): (&f32, &f32)| (a / (factor * b) - 1.0).abs();
        a.samples().iter().zip(b.samples()).map(relative).fold(0.0, f32::max)
    }

    /// A grid with one beam is that beam, between turbidities too.
    #[test]
    fn a_grid_of_one_beam_is_that_beam() {
        let tables = tables(&[2.0, 3.0, 4.0]);
        let (node, column) = (12, 40);
        let direction = (tables.zenith_angles_rad()[node], skyglow_physics::panorama::azimuth_rad(column));
        for turbidity in [2.0, 2.6] {
            let turbidity = Turbidity::new(turbidity).unwrap();
            let grid = tables.grid_sky(turbidity, &single_beam(&tables, node, column), 700.0);
            let beam = tables.beam_sky(turbidity, direction, 700.0);
            assert!(
                largest_difference(&grid, &beam, 2.0) < 2e-3,
                "{}",
                largest_difference(&grid, &beam, 2.0)
            );
        }
        let other = tables.beam_sky(Turbidity::new(2.0).unwrap(), (direction.0, 0.0), 700.0);
        let grid = tables.grid_sky(Turbidity::new(2.0).unwrap(), &single_beam(&tables, node, column), 700.0);
        assert!(largest_difference(&grid, &other, 2.0) > 0.1);
    }

    /// What is kept changes no bit and stays within its bytes.
    #[test]
    fn kept_skies_are_bounded_and_change_no_bit() {
        let tables = tables(&[2.5]);
        let turbidity = Turbidity::new(2.5).unwrap();
        let grid = single_beam(&tables, 5, 9);
        let first = tables.grid_sky(turbidity, &grid, 0.0);
        let one = tables.kept_bytes();
        assert_eq!(tables.grid_sky(turbidity, &grid, 0.0), first);
        assert_eq!(tables.kept_bytes(), one);
        for altitude_m in ALTITUDES_M {
            tables.grid_sky(turbidity, &grid, altitude_m);
        }
        let most = MAX_KEPT_BYTES - MAX_BETWEEN_BYTES;
        assert!(tables.kept_bytes() <= most && tables.kept_bytes() + one > most);
        assert_eq!(tables.grid_sky(turbidity, &grid, 0.0), first);
    }

    /// Between the altitudes that are kept skies are those made for the altitude itself, within 1 % in every direction (0.86 % at most), in thin air and in haze, whose
    /// scale height is the shortest.
    #[test]
    fn skies_between_altitudes_are_their_own() {
        let packs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
        let tables = CelestialTables::open(&packs).unwrap().unwrap();
        let nodes = tables.zenith_angles_rad().len();
        // The whole sky above, and one beam from below the horizon.
        let even = (0..BAND_COUNT * nodes * AZIMUTH_COUNT)
            .map(|at| if at / AZIMUTH_COUNT % nodes < nodes / 2 { 1.0 } else { 0.0 });
        let even = BeamGrid::new(nodes, even.collect()).unwrap();
        let dusk = single_beam(&tables, nodes - 12, 30);
        let mut worst = 0f32;
        for (table, turbidity) in tables.turbidities.iter().enumerate().filter(|(at, _)| [0, 5].contains(at))
        {
            for altitude_m in [125.0, 1_380.0, 3_870.0] {
                let sky = |node: usize| tables.tables[table].node_sky(node, altitude_m);
                let exact = NodeSkies::of(nodes, sky, &tables.twiddles);
                for grid in [&even, &dusk] {
                    let exact = exact.sky(grid, &tables.twiddles).unwrap();
                    let found = tables.grid_sky(Turbidity::new(*turbidity).unwrap(), grid, altitude_m);
                    worst = worst.max(largest_difference(&found, &exact, 1.0));
                }
            }
        }
        assert!(worst < 1e-2 && worst > 1e-6, "{worst}");
    }

    /// What rings scatter to the zenith is what their grid scatters there, between turbidities too.
    #[test]
    fn rings_scatter_as_their_grid_does() {
        let tables = tables(&[2.0, 3.0, 4.0]);
        let nodes = tables.zenith_angles_rad().len();
        let ring = |node: usize| 1.0 + 0.1 * node as f64;
        let rings: Vec<[f64; BAND_COUNT]> = (0..nodes).map(|node| [ring(node); BAND_COUNT]).collect();
        let cells = (0..BAND_COUNT * nodes * AZIMUTH_COUNT)
            .map(|at| (ring(at / AZIMUTH_COUNT % nodes) / AZIMUTH_COUNT as f64) as f32);
        let grid = BeamGrid::new(nodes, cells.collect()).unwrap();
        for turbidity in [2.0, 2.6] {
            let turbidity = Turbidity::new(turbidity).unwrap();
            let dark = vec![[0.0; BAND_COUNT]; nodes];
            let [zenith, of_nothing] = tables.zenith_of_rings(turbidity, &[rings.clone(), dark], 700.0);
            assert!(of_nothing.iter().all(|value| *value < 1e-300));
            let sky = tables.grid_sky(turbidity, &grid, 700.0);
            for (band, value) in zenith.into_iter().enumerate() {
                // The highest row is 0.7° from the zenith.
                let row =
                    f64::from(sky.samples()[Panorama::index(band, skyglow_physics::ELEVATION_COUNT - 1, 0)]);
                assert!((value / row - 1.0).abs() < 0.02, "{band}: {value} {row}");
            }
        }
    }

    /// Less comes through thicker air and nothing from below the horizon.
    #[test]
    fn transmittance_lies_between_tables() {
        let tables = tables(&[2.0, 4.0]);
        let at = |turbidity: f64, zenith: f64| {
            tables.transmittance(Turbidity::new(turbidity).unwrap(), zenith, 0.0)[0]
        };
        let (thin, middle, thick) = (at(2.0, 1.0), at(3.0, 1.0), at(4.0, 1.0));
        assert!(thin >= middle && middle >= thick && thick > 0.0, "{thin} {middle} {thick}");
        assert_eq!((at(2.0, 1.8), at(3.0, 1.8)), (0.0, 0.0));
    }

    /// Tables that do not fit together are refused with the reason.
    #[test]
    fn tables_that_do_not_fit_are_refused() {
        let table = |turbidity: f64| CelestialTable::synthetic(Turbidity::new(turbidity).unwrap());
        for (tables, said) in [(Vec::new(), "none"), (vec![table(2.0), table(2.0)], "twice")] {
            assert!(CelestialTables::new(tables).unwrap_err().to_string().contains(said));
        }
        let folder = tempfile::tempdir().unwrap();
        assert!(CelestialTables::open(folder.path()).unwrap().is_none());
    }

    /// Without one of its neighbours, a sky between turbidities is that of the table that was left out, within 1 % where light comes
    /// from everywhere; with it, the gap is half as wide.
    #[test]
    fn skies_between_turbidities_are_their_own() {
        let packs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
        let all = CelestialTables::open(&packs).unwrap().unwrap();
        let turbidity = Turbidity::new(2.5).unwrap();
        let others = all.tables.iter().filter(|table| table.turbidity() != 2.5);
        let without =
            CelestialTables::new(others.map(|table| CelestialTable::clone(table)).collect()).unwrap();
        let nodes = all.zenith_angles_rad().len();
        let even = (0..BAND_COUNT * nodes * AZIMUTH_COUNT)
            .map(|at| if at / AZIMUTH_COUNT % nodes < nodes / 2 { 1.0 } else { 0.0 });
        let even = BeamGrid::new(nodes, even.collect()).unwrap();
        let own = all.grid_sky(turbidity, &even, 500.0);
        let found = largest_difference(&without.grid_sky(turbidity, &even, 500.0), &own, 1.0);
        assert!(found < 1e-2 && found > 1e-6, "{found}");
        let other = all.grid_sky(Turbidity::new(2.0).unwrap(), &even, 500.0);
        assert!(largest_difference(&other, &own, 1.0) > 0.05);
    }
}
