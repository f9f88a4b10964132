//! The reference solution, later orders: what orders two and more add to the direct sum.
//!
//! The same sum over every source (paper Eq. 3), with each source's light from a table solved for this
//! observer altitude: dense over the altitude of the source, over distance and over azimuth (a test halves the
//! steps). Nothing of a pack is in it but the solver.
//!
//! For sources behind skylines, fields are solved behind skylines of some angles e. Of what an open source would show,
//! L₀, a skyline leaves L = L₀·s(e)·q(e), where s is the share of the light that the source still emits and q varies
//! little: ln q is interpolated between the angles and between altitudes of sources, which crowd around the observer's.
//! At 90° s is 0.

mod by_lobe;
mod density;
mod nodes;
mod open_altitudes;
mod tables;

use super::{MIN_BELOW_BASE_M, Resolution, SourceField, SourceSetting};
use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    blocked_source::BlockedSource,
    cloud::CloudBase,
    emission::{EmissionMix, emitted_shares},
    error::PhysicsError,
    panorama::Direction,
    single_source::RadiancePerWatt,
    source_pixel::PointSource,
};
pub use by_lobe::FieldCache;
use density::DARKNESS_PER_M2_SR;
pub use density::SumDensity;
use nodes::{ANGLES_DEG, Nodes};
use rayon::prelude::*;
use tables::{LogTable, SampleAxes};

/// The sum over all orders beyond the first for one observer.
#[derive(Clone, Debug)]
pub struct MultipleSum {
    /// The air.
    pub atmosphere: Atmosphere,
    /// Lambertian albedo of the ground, 0..=1.
    pub ground_albedo: f64,
    /// Altitude of the observer, metres.
    pub observer_altitude_m: f64,
    /// Directions of the sources' light.
    pub emission: EmissionMix,
    /// How finely fields are solved.
    pub resolution: Resolution,
    /// How dense their tables are.
    pub density: SumDensity,
}

/// What is tabulated of the fields of a sum.
struct Tables {
    nodes: Nodes,
    /// ln of what the observer sees of open sources [m⁻² sr⁻¹ per watt], a field an altitude.
    open: LogTable<BAND_COUNT>,
    /// ln q of what skylines leave of it.
    cut: LogTable<BAND_COUNT>,
}

/// The tables of some sources and directions.
struct Solved {
    /// Elevations of the directions, ascending, radians.
    rows: Vec<f64>,
    tables: Tables,
    /// ln of the light that each source still emits.
    log_sent: Vec<f64>,
}

impl Solved {
    fn row(&self, direction: &Direction) -> usize {
        self.rows.partition_point(|&elevation| elevation < direction.elevation_rad)
    }

    /// Radiance that a source shows, W m⁻² sr⁻¹ for a lamp with as much light in every band as the satellite saw.
    fn radiance(
        &self,
        index: usize,
        blocked: &BlockedSource,
        row: usize,
        direction: &Direction,
    ) -> [f64; BAND_COUNT] {
        let (source, log_sent) = (&blocked.source, self.log_sent[index]);
        let log = self.tables.log_radiance(row, index, source, log_sent, direction.azimuth_rad);
        log.map(|log| source.flux_dnb_w * log.exp())
    }
}

impl MultipleSum {
    /// Radiance [W m⁻² sr⁻¹] of orders two and more at each direction, every source under an open sky: the part that
    /// [`crate::direct_sum::direct_sum`] leaves out. `flux_per_dnb_flux` is the lamp's s_b.
    ///
    /// Solves one field for every altitude of sources: seconds each. Without sources nothing is solved.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] for an altitude or albedo outside the solver's ranges, or an elevation below 0.
    pub fn radiance(
        &self,
        sources: &[PointSource],
        flux_per_dnb_flux: [f64; BAND_COUNT],
        directions: &[Direction],
    ) -> Result<Vec<[f64; BAND_COUNT]>, PhysicsError> {
        let open: Vec<BlockedSource> = sources.iter().copied().map(BlockedSource::open).collect();
        self.cut_radiance(&open, flux_per_dnb_flux, directions, &|| ())
    }

    /// As [`Self::radiance`] with each source behind its own skyline: the part that
    /// [`crate::direct_sum::cut_direct_sum`] leaves out. With all angles 0 it equals that sum, at its cost; else
    /// fields behind skylines are solved besides, [`Self::field_count`] in all. `advance` is called once a field.
    ///
    /// # Errors
    /// As [`Self::radiance`].
    pub fn cut_radiance(
        &self,
        sources: &[BlockedSource],
        flux_per_dnb_flux: [f64; BAND_COUNT],
        directions: &[Direction],
        advance: &(dyn Fn() + Sync),
    ) -> Result<Vec<[f64; BAND_COUNT]>, PhysicsError> {
        let sources = self.lit(sources);
        if sources.is_empty() {
            return Ok(vec![[0.0; BAND_COUNT]; directions.len()]);
        }
        let solved = self.solved(&sources, directions, advance)?;
        Ok(directions
            .par_iter()
            .map(|direction| {
                let row = solved.row(direction);
                let mut sum = [0.0; BAND_COUNT];
                for (index, source) in sources.iter().enumerate() {
                    let radiance = solved.radiance(index, source, row, direction);
                    for band in 0..BAND_COUNT {
                        sum[band] += flux_per_dnb_flux[band] * radiance[band];
                    }
                }
                sum
            })
            .collect())
    }

    /// As [`Self::radiance`], of each source alone: `[source][direction]`. The fields are solved once for all of them. Under clouds
    /// sources above their base are left out, and the others move up in the list.
    ///
    /// # Errors
    /// As [`Self::radiance`].
    pub fn radiance_of_each(
        &self,
        sources: &[PointSource],
        flux_per_dnb_flux: [f64; BAND_COUNT],
        directions: &[Direction],
    ) -> Result<Vec<Vec<[f64; BAND_COUNT]>>, PhysicsError> {
        let open: Vec<BlockedSource> = sources.iter().copied().map(BlockedSource::open).collect();
        let sources = self.lit(&open);
        if sources.is_empty() {
            return Ok(Vec::new());
        }
        let solved = self.solved(&sources, directions, &|| ())?;
        let of_one = |(index, source): (usize, &BlockedSource)| -> Vec<[f64; BAND_COUNT]> {
            let seen = directions.iter().map(|direction| {
                let row = solved.row(direction);
                let radiance = solved.radiance(index, source, row, direction);
                std::array::from_fn(|band| flux_per_dnb_flux[band] * radiance[band])
            });
            seen.collect()
        };
        Ok(sources.par_iter().enumerate().map(of_one).collect())
    }

    /// Solves what sources need to be seen in some directions.
    fn solved(
        &self,
        sources: &[BlockedSource],
        directions: &[Direction],
        advance: &(dyn Fn() + Sync),
    ) -> Result<Solved, PhysicsError> {
        let mut rows: Vec<f64> = directions.iter().map(|direction| direction.elevation_rad).collect();
        rows.sort_by(f64::total_cmp);
        rows.dedup();
        let nodes = Nodes::new(sources, self.observer_altitude_m, &self.density);
        let tables = self.solve(nodes, &rows, advance)?;
        let log_sent = sources.iter().map(|blocked| self.log_sent(blocked.blocking_rad)).collect();
        Ok(Solved { rows, tables, log_sent })
    }

    /// How many fields a sum over some sources solves.
    pub fn field_count(&self, sources: &[BlockedSource]) -> usize {
        let sources = self.lit(sources);
        if sources.is_empty() {
            return 0;
        }
        Nodes::new(&sources, self.observer_altitude_m, &self.density).field_count()
    }

    /// The sources whose light the observer sees: none at the base of a cloud and above, and none from there. Those
    /// nearer below it than fields are solved for count as at the highest altitude that they are.
    fn lit(&self, sources: &[BlockedSource]) -> Vec<BlockedSource> {
        let base_m = self.atmosphere.cloud().map_or(f64::INFINITY, CloudBase::altitude_m);
        if self.observer_altitude_m >= base_m {
            return Vec::new();
        }
        let is_below = |blocked: &&BlockedSource| blocked.source.altitude_m < base_m;
        let clamped = |blocked: &BlockedSource| {
            let altitude_m = blocked.source.altitude_m.min(base_m - MIN_BELOW_BASE_M);
            BlockedSource { source: PointSource { altitude_m, ..blocked.source }, ..*blocked }
        };
        sources.iter().filter(is_below).map(clamped).collect()
    }

    fn solve(&self, nodes: Nodes, rows: &[f64], advance: &(dyn Fn() + Sync)) -> Result<Tables, PhysicsError> {
        let axes = SampleAxes::new(&self.density);
        let mut open = LogTable::new(axes.clone(), rows.len(), nodes.altitude_m.len());
        for (field, &altitude_m) in nodes.altitude_m.iter().enumerate() {
            self.tabulate(self.setting(altitude_m)?, rows, &mut open, field)?;
            advance();
        }
        let mut cut = LogTable::new(axes.clone(), rows.len(), nodes.cut_count());
        let mut uncut = LogTable::new(axes, rows.len(), 1);
        let mut field = 0;
        for fields in &nodes.cut {
            let setting = self.setting(fields.altitude_m)?;
            self.tabulate(setting, rows, &mut uncut, 0)?;
            advance();
            for &angle in &fields.angles {
                let blocking_rad = ANGLES_DEG[angle].to_radians();
                self.tabulate(setting.behind(blocking_rad)?, rows, &mut cut, field)?;
                cut.subtract(field, &uncut, self.log_sent(blocking_rad));
                field += 1;
                advance();
            }
        }
        Ok(Tables { nodes, open, cut })
    }

    fn setting(&self, source_altitude_m: f64) -> Result<SourceSetting, PhysicsError> {
        SourceSetting::for_observer(
            self.atmosphere,
            source_altitude_m,
            self.observer_altitude_m,
            self.ground_albedo,
        )
    }

    /// Solves a field and enters ln of what the observer sees of it [m⁻² sr⁻¹ per watt].
    fn tabulate(
        &self,
        setting: SourceSetting,
        rows: &[f64],
        table: &mut LogTable<BAND_COUNT>,
        field: usize,
    ) -> Result<(), PhysicsError> {
        let solved = SourceField::solve(setting, &self.resolution);
        table.enter(field, &solved, self.observer_altitude_m, rows, |radiance| self.log_of(radiance))
    }

    /// ln of the mix of lobes.
    fn log_of(&self, radiance: RadiancePerWatt) -> [f32; BAND_COUNT] {
        radiance.map(|lobes| {
            let mixed: f64 =
                lobes.iter().zip(self.emission.weights()).map(|(value, weight)| value * weight).sum();
            mixed.max(DARKNESS_PER_M2_SR).ln() as f32
        })
    }

    /// ln of the share of its light that a source behind a skyline emits; −∞ at π/2.
    fn log_sent(&self, blocking_rad: f64) -> f64 {
        let shares = emitted_shares(blocking_rad);
        shares.iter().zip(self.emission.weights()).map(|(share, weight)| share * weight).sum::<f64>().ln()
    }
}

impl Tables {
    /// ln of what is seen of a source, by its index, of 1 W, m⁻² sr⁻¹.
    fn log_radiance(
        &self,
        row: usize,
        index: usize,
        source: &PointSource,
        log_sent: f64,
        azimuth_rad: f64,
    ) -> [f64; BAND_COUNT] {
        let mut log = self.open.log_at(row, &self.nodes.open_weights[index], source, azimuth_rad);
        let cut_weights = &self.nodes.cut_weights[index];
        if !cut_weights.is_empty() {
            let left = self.cut.log_at(row, cut_weights, source, azimuth_rad);
            // A skyline takes light and adds none.
            log.iter_mut().zip(left).for_each(|(log, left)| *log += (left + log_sent).min(0.0));
        }
        log
    }
}

#[cfg(test)]
mod tests;
