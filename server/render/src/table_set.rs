//! The resident packs as one set, checked to be interpolable.

use crate::{
    error::RenderError,
    pack_kind::{PackKind, ResidentKind},
    ring_axis::RingAxis,
};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, blocking::BLOCKING_COUNT};
use skyglow_tables::{
    OffsetAxis,
    resident::{FREQUENCY_COUNT, ResidentBlocked, ResidentTables},
};
use std::sync::Arc;

/// Packs by kind, then in ascending turbidity, all on the same axes but for the observer altitudes of each kind.
#[derive(Clone, Debug)]
pub struct TableSet {
    tables: Vec<Arc<ResidentTables>>,
    kinds: Vec<ResidentKind>,
    rings: Vec<RingAxis>,
    blocked: Option<BlockedAxes>,
}

/// The common axes of the tables of sources behind skylines.
#[derive(Clone, Debug)]
pub struct BlockedAxes {
    offset_count: usize,
    /// `[angle − 1][ring]`.
    axes: Vec<Vec<RingAxis>>,
}

impl BlockedAxes {
    fn of(blocked: &ResidentBlocked) -> Self {
        let angle = |rings: &Vec<OffsetAxis>| rings.iter().map(RingAxis::of).collect();
        Self { offset_count: blocked.offset_count, axes: blocked.offset_axis.iter().map(angle).collect() }
    }

    /// Nodes of the offset axis of every angle and ring.
    pub fn offset_count(&self) -> usize {
        self.offset_count
    }

    /// The axis at a blocking angle, 1..=7, on a ring.
    pub fn axis(&self, blocking: usize, ring: usize) -> &RingAxis {
        &self.axes[blocking - 1][ring]
    }
}

impl TableSet {
    /// Sorts the packs and checks that one set of interpolation weights serves all of a kind.
    ///
    /// # Errors
    /// [`RenderError::NoTables`] for none; [`RenderError::IncompatibleTables`] where axes differ, a turbidity
    /// comes twice in one kind, or an array has the wrong length or a value that is not finite.
    pub fn new(mut tables: Vec<Arc<ResidentTables>>) -> Result<Self, RenderError> {
        tables
            .sort_by(|a, b| PackKind::of(a).cmp(&PackKind::of(b)).then(a.turbidity.total_cmp(&b.turbidity)));
        let first = tables.first().ok_or(RenderError::NoTables)?.clone();
        let first_blocked = tables.iter().find_map(|pack| pack.blocked.clone());
        for (position, pack) in tables.iter().enumerate() {
            let kind = PackKind::of(pack);
            let refuse =
                |reason: String| RenderError::IncompatibleTables { turbidity: pack.turbidity, kind, reason };
            check_lengths(pack).map_err(refuse)?;
            if pack.ring_distance_m != first.ring_distance_m {
                return Err(refuse("its ring distances differ from those of the first pack".into()));
            }
            if pack.offset_axis != first.offset_axis {
                return Err(refuse("its offset axes differ from those of the first pack".into()));
            }
            if let (Some(ours), Some(theirs)) = (&pack.blocked, &first_blocked)
                && ours.offset_axis != theirs.offset_axis
            {
                return Err(refuse("its axes behind skylines differ from those of the first pack".into()));
            }
            let before = position.checked_sub(1).map(|before| &tables[before]);
            if let Some(before) = before.filter(|before| PackKind::of(before) == kind) {
                if before.turbidity == pack.turbidity {
                    return Err(refuse("this turbidity comes twice".into()));
                }
                if altitudes_differ(before, pack) {
                    return Err(refuse("its observer altitudes differ from those of its kind".into()));
                }
            }
        }
        Ok(Self {
            rings: first.offset_axis.iter().map(RingAxis::of).collect(),
            blocked: first_blocked.as_ref().map(BlockedAxes::of),
            kinds: ResidentKind::all_of(&tables),
            tables,
        })
    }

    /// Whether it has packs that are no skies of the model.
    pub(crate) fn is_synthetic(&self) -> bool {
        self.tables.iter().any(|tables| tables.is_synthetic)
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
    /// [`RenderError::KindNotResident`] naming the kinds that are.
    pub fn kind(&self, kind: PackKind) -> Result<&ResidentKind, RenderError> {
        self.kinds.iter().find(|resident| resident.kind == kind).ok_or_else(|| RenderError::KindNotResident {
            kind,
            resident: self.kinds.iter().map(|resident| resident.kind).collect(),
        })
    }

    /// Observer altitudes of the packs of a kind, metres, ascending.
    pub fn observer_altitude_m(&self, kind: &ResidentKind) -> &[f64] {
        &self.tables[kind.first].observer_altitude_m
    }

    /// The same of their tables of sources behind skylines; None where not all of them have such.
    pub fn blocked_observer_altitude_m(&self, kind: &ResidentKind) -> Option<&[f64]> {
        let blocked = self.tables[kind.first].blocked.as_ref().filter(|_| kind.hides_lights)?;
        Some(&blocked.observer_altitude_m)
    }

    /// Highest observer that packs of any kind know, metres.
    pub fn highest_observer_m(&self) -> f64 {
        let highest_m = self.tables.iter().filter_map(|pack| pack.observer_altitude_m.last().copied());
        highest_m.fold(0.0, f64::max)
    }

    /// Axis of the offset (source altitude − observer altitude) on every ring of every pack.
    pub fn offset_axis(&self) -> &[OffsetAxis] {
        &self.tables[0].offset_axis
    }

    /// [`OffsetAxis::position`] in f32 for the offset of a cell on a ring: fast, and right to about 2e-6 nodes.
    pub fn position(&self, ring: usize, offset_m: f32) -> f32 {
        self.rings[ring].position(offset_m)
    }

    /// The axis that [`Self::position`] is on.
    pub fn axis(&self, ring: usize) -> &RingAxis {
        &self.rings[ring]
    }

    /// The axes of sources behind skylines, where any pack has them.
    pub fn blocked(&self) -> Option<&BlockedAxes> {
        self.blocked.as_ref()
    }

    /// Nodes of the open sky and of all blocking angles: no request mixes more.
    pub fn node_count(&self) -> usize {
        let blocked =
            self.blocked.as_ref().map_or(0, |axes| ResidentBlocked::ANGLE_COUNT * axes.offset_count);
        self.ring_count() * (self.offset_count() + blocked)
    }

    /// Lit cells of one grid with light at every blocking angle everywhere: no request has more.
    pub fn cell_count(&self) -> usize {
        BLOCKING_COUNT * AZIMUTH_COUNT * self.ring_count()
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

/// Whether one set of altitude weights would not serve both packs.
fn altitudes_differ(a: &ResidentTables, b: &ResidentTables) -> bool {
    let blocked_differ = match (&a.blocked, &b.blocked) {
        (Some(a), Some(b)) => a.observer_altitude_m != b.observer_altitude_m,
        _ => false,
    };
    blocked_differ || a.observer_altitude_m != b.observer_altitude_m
}

fn check_lengths(pack: &ResidentTables) -> Result<(), String> {
    let ascending = |axis: &[f64]| !axis.is_empty() && axis.windows(2).all(|pair| pair[0] < pair[1]);
    if !ascending(&pack.observer_altitude_m) || !ascending(&pack.ring_distance_m) {
        return Err("an axis is empty or not ascending".into());
    }
    if pack.offset_axis.len() != pack.ring_distance_m.len()
        || !pack.offset_axis.iter().all(|axis| is_alike(axis, &pack.offset_axis[0], pack.offset_count))
    {
        return Err(format!(
            "{} rings do not have {} offsets each, three or more with one kink,",
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
    pack.blocked.as_ref().map_or(Ok(()), |blocked| check_blocked(pack, blocked))
}

/// Whether an axis has `count` nodes, enough for a curvature, and its kink where another has it.
fn is_alike(axis: &OffsetAxis, other: &OffsetAxis, count: usize) -> bool {
    axis.count == count && count >= 3 && axis.kink_node == other.kink_node
}

fn check_blocked(pack: &ResidentTables, blocked: &ResidentBlocked) -> Result<(), String> {
    let rings = pack.ring_distance_m.len();
    let first = blocked.offset_axis.first().and_then(|axes| axes.first());
    let fits = |axes: &Vec<OffsetAxis>| {
        let alike = |axis| first.is_some_and(|first| is_alike(axis, first, blocked.offset_count));
        axes.len() == rings && axes.iter().all(alike)
    };
    if blocked.observer_altitude_m.is_empty()
        || blocked.observer_altitude_m.windows(2).any(|pair| pair[0] >= pair[1])
        || blocked.offset_axis.len() != ResidentBlocked::ANGLE_COUNT
        || !blocked.offset_axis.iter().all(fits)
    {
        return Err("the axes of its sources behind skylines do not fit its rings".into());
    }
    if blocked.basis_count == 0
        || !blocked.basis_count.is_multiple_of(4)
        || blocked.basis_count > pack.basis_count
    {
        return Err(format!("its sources behind skylines have {} basis functions", blocked.basis_count));
    }
    let nodes = blocked.observer_altitude_m.len()
        * ResidentBlocked::ANGLE_COUNT
        * LOBE_COUNT
        * BAND_COUNT
        * rings
        * blocked.offset_count;
    if blocked.log_scale.len() != nodes || blocked.shape.len() != nodes * blocked.basis_count {
        return Err("its tables of sources behind skylines have another length than their axes".into());
    }
    if blocked.log_scale.iter().any(|value| !value.is_finite())
        || blocked.shape.iter().any(|value| !value.is_finite())
    {
        return Err("a value behind skylines is not finite".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use skyglow_tables::Scattering;

    /// Packs are sorted by kind and turbidity and one turbidity may be in both kinds.
    #[test]
    fn packs_are_sorted_by_kind_and_turbidity() {
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

    /// Positions on the offset axis are those of the pack.
    #[test]
    fn offset_positions_are_those_of_the_pack() {
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

    /// Packs that do not fit together are refused with the reason.
    #[test]
    fn packs_that_do_not_fit_are_refused() {
        assert!(matches!(TableSet::new(Vec::new()), Err(RenderError::NoTables)));
        let refusal = |change: fn(&mut ResidentTables)| {
            let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
            change(Arc::make_mut(&mut tables[1]));
            TableSet::new(tables).unwrap_err().to_string()
        };
        assert!(
            refusal(|pack| pack.turbidity = 2.0)
                .contains("with single scattering does not fit: this turbidity comes twice")
        );
        assert!(
            refusal(|pack| pack.observer_altitude_m[1] += 1.0)
                .contains("observer altitudes differ from those of its kind")
        );
        assert!(refusal(|pack| pack.offset_axis[1].kink_m += 1.0).contains("offset axes differ"));
        assert!(refusal(|pack| pack.log_scale.truncate(5)).contains("log_scale has"));
        assert!(refusal(|pack| pack.basis_spectrum[3] = f32::NAN).contains("not finite"));
        assert!(refusal(|pack| pack.basis_count = 7).contains("multiple of 4"));
        let blocked = |change: fn(&mut ResidentBlocked)| {
            let mut tables = synthetic::table_set_with_skylines(&[2.0, 3.0], 8);
            change(Arc::make_mut(&mut tables[1]).blocked.as_mut().unwrap());
            TableSet::new(tables).unwrap_err().to_string()
        };
        assert!(blocked(|tables| tables.offset_axis[2][1].kink_m += 1.0).contains("behind skylines differ"));
        assert!(blocked(|tables| tables.log_scale.truncate(5)).contains("another length"));
        assert!(blocked(|tables| tables.log_scale[7] = f32::INFINITY).contains("not finite"));
        assert!(blocked(|tables| tables.basis_count = 12).contains("12 basis functions"));
        assert!(blocked(|tables| tables.observer_altitude_m[1] += 1.0).contains("altitudes differ"));
        assert!(blocked(|tables| drop(tables.offset_axis.pop())).contains("do not fit its rings"));
    }

    #[test]
    fn a_kind_hides_lights_where_all_its_packs_can() {
        let mut tables = synthetic::table_set_with_skylines(&[2.0, 3.0], 8);
        assert!(TableSet::new(tables.clone()).unwrap().kinds()[0].hides_lights);
        Arc::make_mut(&mut tables[1]).blocked = None;
        assert!(!TableSet::new(tables).unwrap().kinds()[0].hides_lights);
    }
}
