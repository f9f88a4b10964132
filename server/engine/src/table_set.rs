//! The resident packs as one interpolable set.

use crate::{
    error::EngineError,
    packs::{PackKind, ResidentKind},
    twin::natural_log,
};
use skyglow_physics::{BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};
use skyglow_tables::{
    OffsetAxis,
    resident::{FREQUENCY_COUNT, ResidentTables},
};
use std::sync::Arc;

/// Packs by kind, then in ascending turbidity, all on the same axes.
#[derive(Clone, Debug)]
pub struct TableSet {
    tables: Vec<Arc<ResidentTables>>,
    kinds: Vec<ResidentKind>,
    rings: Vec<RingAxis>,
}

/// The offset axis of a ring as f32 needs it: position = bend node + asinh((Δ − Δ₀)/L)/step, L and step of the
/// side of the bend.
#[derive(Clone, Copy, Debug)]
struct RingAxis {
    bend_m: f32,
    bend_node: f32,
    per_scale_below_m: f32,
    per_scale_above_m: f32,
    per_step_below: f32,
    per_step_above: f32,
}

impl TableSet {
    /// Sorts the packs and checks that one set of interpolation weights serves them all.
    ///
    /// # Errors
    /// [`EngineError::NoTables`] for none; [`EngineError::IncompatibleTables`] where axes differ, a turbidity
    /// comes twice in one kind, or an array has the wrong length or a value that is not finite.
    pub fn new(mut tables: Vec<Arc<ResidentTables>>) -> Result<Self, EngineError> {
        tables
            .sort_by(|a, b| PackKind::of(a).cmp(&PackKind::of(b)).then(a.turbidity.total_cmp(&b.turbidity)));
        let first = tables.first().ok_or(EngineError::NoTables)?.clone();
        for (position, pack) in tables.iter().enumerate() {
            let kind = PackKind::of(pack);
            let refuse =
                |reason: String| EngineError::IncompatibleTables { turbidity: pack.turbidity, kind, reason };
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
            if let Some(before) = position.checked_sub(1).map(|before| &tables[before])
                && PackKind::of(before) == kind
                && before.turbidity == pack.turbidity
            {
                return Err(refuse("this turbidity comes twice".into()));
            }
        }
        let rings = first.offset_axis.iter().map(|axis| RingAxis {
            bend_m: axis.bend_m as f32,
            bend_node: axis.bend_node as f32,
            per_scale_below_m: (1.0 / axis.scale_below_m) as f32,
            per_scale_above_m: (1.0 / axis.scale_above_m) as f32,
            per_step_below: (1.0 / axis.step_below) as f32,
            per_step_above: (1.0 / axis.step_above) as f32,
        });
        Ok(Self { rings: rings.collect(), kinds: ResidentKind::all_of(&tables), tables })
    }

    /// The packs, by kind, then ascending in turbidity.
    pub fn tables(&self) -> &[Arc<ResidentTables>] {
        &self.tables
    }

    /// The kinds that there are packs of, the best last; never empty.
    pub fn kinds(&self) -> &[ResidentKind] {
        &self.kinds
    }

    /// The packs of a kind.
    ///
    /// # Errors
    /// [`EngineError::KindNotResident`] naming the kinds that are.
    pub fn kind(&self, kind: PackKind) -> Result<&ResidentKind, EngineError> {
        self.kinds.iter().find(|resident| resident.kind == kind).ok_or_else(|| EngineError::KindNotResident {
            kind,
            resident: self.kinds.iter().map(|resident| resident.kind).collect(),
        })
    }

    /// Observer altitudes of every pack, metres, ascending.
    pub fn observer_altitude_m(&self) -> &[f64] {
        &self.tables[0].observer_altitude_m
    }

    /// Axis of the offset (source altitude − observer altitude) on every ring of every pack.
    pub fn offset_axis(&self) -> &[OffsetAxis] {
        &self.tables[0].offset_axis
    }

    /// [`OffsetAxis::position`] in f32 for the offset of a cell on a ring: fast, and right to about 2e-6 nodes.
    pub fn position(&self, ring: usize, offset_m: f32) -> f32 {
        let axis = self.rings[ring];
        let above_m = offset_m - axis.bend_m;
        let (per_scale_m, per_step) = if above_m < 0.0 {
            (axis.per_scale_below_m, -axis.per_step_below)
        } else {
            (axis.per_scale_above_m, axis.per_step_above)
        };
        let size = above_m.abs() * per_scale_m;
        let from_bend = per_step * natural_log(size + (size * size + 1.0).sqrt());
        (axis.bend_node + from_bend).clamp(0.0, (self.offset_count() - 1) as f32)
    }

    /// Nodes of the offset axis.
    pub fn offset_count(&self) -> usize {
        self.tables[0].offset_count
    }

    /// Number of rings of every pack.
    pub fn ring_count(&self) -> usize {
        self.tables[0].ring_distance_m.len()
    }

    /// Most basis functions that any pack has, of whatever kind: what buffers must hold.
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
    if pack.basis_count == 0 || !pack.basis_count.is_multiple_of(4) {
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
    use skyglow_tables::Scattering;

    #[test]
    fn packs_are_sorted_by_kind_and_turbidity_and_one_turbidity_may_be_in_both_kinds() {
        let mut tables = synthetic::table_set_of(Scattering::Multiple, &[3.0, 1.5, 2.0], 8);
        tables.extend(synthetic::table_set(&[4.0, 2.0], 12));
        let set = TableSet::new(tables).unwrap();
        let order: Vec<_> = set.tables().iter().map(|pack| (pack.scattering, pack.turbidity)).collect();
        let (one, all) = (Scattering::Single, Scattering::Multiple);
        assert_eq!(order, [(one, 2.0), (one, 4.0), (all, 1.5), (all, 2.0), (all, 3.0)]);
        let kinds: Vec<_> = set.kinds().iter().map(|k| (k.kind.scattering, k.first, k.basis_count)).collect();
        assert_eq!(kinds, [(one, 0, 12), (all, 2, 8)]);
        assert_eq!(set.kinds()[1].turbidities, [1.5, 2.0, 3.0]);
    }

    #[test]
    fn positions_on_the_offset_axis_are_those_of_the_pack() {
        let set = TableSet::new(synthetic::table_set(&[2.0], 8)).unwrap();
        let mut largest = 0f64;
        for (ring, axis) in set.offset_axis().iter().enumerate() {
            for offset_m in [-7000.0, -3333.0, -400.0, -20.0, 0.0, 0.3, 55.0, 900.0, 4321.0, 9000.0f32] {
                let exact = axis.position(f64::from(offset_m));
                largest = largest.max((f64::from(set.position(ring, offset_m)) - exact).abs());
            }
        }
        assert!(largest < 5e-6, "{largest}");
    }

    #[test]
    fn packs_that_do_not_fit_together_are_refused_with_the_reason() {
        assert!(matches!(TableSet::new(Vec::new()), Err(EngineError::NoTables)));
        let refusal = |change: fn(&mut ResidentTables)| {
            let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
            change(Arc::make_mut(&mut tables[1]));
            TableSet::new(tables).unwrap_err().to_string()
        };
        assert!(
            refusal(|pack| pack.turbidity = 2.0)
                .contains("with single scattering does not fit: this turbidity comes twice")
        );
        assert!(refusal(|pack| pack.offset_axis[1].bend_m += 1.0).contains("offset axes differ"));
        assert!(refusal(|pack| pack.log_scale.truncate(5)).contains("log_scale has"));
        assert!(refusal(|pack| pack.basis_spectrum[3] = f32::NAN).contains("not finite"));
        assert!(refusal(|pack| pack.basis_count = 7).contains("multiple of 4"));
    }
}
