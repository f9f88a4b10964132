//! The resident packs as one interpolable set.

use crate::error::EngineError;
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};
use skyglow_tables::{
    OffsetAxis,
    resident::{FREQUENCY_COUNT, ResidentTables},
};
use std::sync::Arc;

/// Packs in ascending turbidity, all on the same axes.
#[derive(Clone, Debug)]
pub struct TableSet {
    tables: Vec<Arc<ResidentTables>>,
}

impl TableSet {
    /// Sorts the packs and checks that one set of interpolation weights serves them all.
    ///
    /// # Errors
    /// [`EngineError::NoTables`] for none; [`EngineError::IncompatibleTables`] where axes differ, a turbidity
    /// comes twice, or an array has the wrong length or a value that is not finite.
    pub fn new(mut tables: Vec<Arc<ResidentTables>>) -> Result<Self, EngineError> {
        tables.sort_by(|a, b| a.turbidity.total_cmp(&b.turbidity));
        let first = tables.first().ok_or(EngineError::NoTables)?.clone();
        for (position, pack) in tables.iter().enumerate() {
            let refuse =
                |reason: String| EngineError::IncompatibleTables { turbidity: pack.turbidity, reason };
            check_lengths(pack).map_err(refuse)?;
            for (axis, ours, theirs) in [
                ("observer altitudes", &pack.observer_altitude_m, &first.observer_altitude_m),
                ("ring distances", &pack.ring_distance_m, &first.ring_distance_m),
            ] {
                if ours != theirs {
                    return Err(refuse(format!("its {axis} differ from those of the first pack")));
                }
            }
            if pack.offset_axis != first.offset_axis {
                return Err(refuse("its offset axes differ from those of the first pack".into()));
            }
            if position > 0 && tables[position - 1].turbidity == pack.turbidity {
                return Err(refuse("this turbidity comes twice".into()));
            }
        }
        Ok(Self { tables })
    }

    /// The packs, ascending in turbidity.
    pub fn tables(&self) -> &[Arc<ResidentTables>] {
        &self.tables
    }

    /// Turbidities, ascending.
    pub fn turbidities(&self) -> Vec<f64> {
        self.tables.iter().map(|pack| pack.turbidity).collect()
    }

    /// Observer altitudes of every pack, metres, ascending.
    pub fn observer_altitude_m(&self) -> &[f64] {
        &self.tables[0].observer_altitude_m
    }

    /// Axis of the offset (source altitude − observer altitude) on every ring of every pack.
    pub fn offset_axis(&self) -> &[OffsetAxis] {
        &self.tables[0].offset_axis
    }

    /// Nodes of the offset axis.
    pub fn offset_count(&self) -> usize {
        self.tables[0].offset_count
    }

    /// Number of rings of every pack.
    pub fn ring_count(&self) -> usize {
        self.tables[0].ring_distance_m.len()
    }

    /// Most basis functions that any pack has.
    pub fn basis_count(&self) -> usize {
        self.tables.iter().map(|pack| pack.basis_count).max().unwrap_or(0)
    }
}

fn check_lengths(pack: &ResidentTables) -> Result<(), String> {
    let ascending = |axis: &[f64]| !axis.is_empty() && axis.windows(2).all(|pair| pair[0] < pair[1]);
    if !ascending(&pack.observer_altitude_m) || !ascending(&pack.ring_distance_m) {
        return Err("an axis is empty or not ascending".into());
    }
    if pack.offset_count < 2
        || pack.offset_axis.len() != pack.ring_distance_m.len()
        || pack.offset_axis.iter().any(|axis| axis.count != pack.offset_count)
    {
        return Err(format!(
            "{} rings do not have {} offsets each",
            pack.offset_axis.len(),
            pack.offset_count
        ));
    }
    if pack.basis_count == 0 || pack.basis_count % 4 != 0 {
        return Err(format!("{} basis functions are not a multiple of 4", pack.basis_count));
    }
    let nodes = pack.observer_altitude_m.len()
        * LOBE_COUNT
        * BAND_COUNT
        * pack.ring_distance_m.len()
        * pack.offset_count;
    for (name, got, wanted) in [
        ("log_scale", pack.log_scale.len(), nodes),
        ("shape", pack.shape.len(), nodes * pack.basis_count),
        ("basis_spectrum", pack.basis_spectrum.len(), pack.basis_count * ELEVATION_COUNT * FREQUENCY_COUNT),
    ] {
        if got != wanted {
            return Err(format!("{name} has {got} values instead of {wanted}"));
        }
    }
    if pack.log_scale.iter().chain(&pack.basis_spectrum).any(|value| !value.is_finite())
        || pack.shape.iter().any(|value| !value.is_finite())
    {
        return Err("a value is not finite".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    #[test]
    fn packs_are_sorted_by_turbidity() {
        let set = TableSet::new(synthetic::table_set(&[3.0, 1.5, 2.0], 8)).unwrap();
        assert_eq!(set.turbidities(), [1.5, 2.0, 3.0]);
    }

    #[test]
    fn packs_that_do_not_fit_together_are_refused_with_the_reason() {
        assert!(matches!(TableSet::new(Vec::new()), Err(EngineError::NoTables)));
        let refusal = |change: fn(&mut ResidentTables)| {
            let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
            change(Arc::make_mut(&mut tables[1]));
            TableSet::new(tables).unwrap_err().to_string()
        };
        assert!(refusal(|pack| pack.turbidity = 2.0).contains("twice"));
        assert!(refusal(|pack| pack.offset_axis[1].scale_m += 1.0).contains("offset axes differ"));
        assert!(refusal(|pack| drop(pack.log_scale.pop())).contains("log_scale has"));
        assert!(refusal(|pack| pack.basis_spectrum[3] = f32::NAN).contains("not finite"));
        assert!(refusal(|pack| pack.basis_count = 7).contains("multiple of 4"));
    }
}
