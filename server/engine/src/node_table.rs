//! Where the numbers of a node lie: in the tables of the open sky or in those of its blocking angle.

use crate::{
    prepare::{MixNode, Prepared},
    taps::Taps,
};
use half::f16;
use skyglow_tables::resident::{ResidentBlocked, ResidentTables};

/// The table that a node is in, and its place there.
pub(crate) struct NodeTable<'a> {
    /// Interpolation over the table's observer altitudes.
    pub(crate) taps: &'a Taps,
    /// ln of the scale, by [`Self::index`].
    pub(crate) log_scale: &'a [f32],
    /// Shape coefficients, [`Self::basis_count`] a node.
    pub(crate) shape: &'a [f16],
    /// Functions of the table; those of the pack beyond are 0.
    pub(crate) basis_count: usize,
    tables: &'a ResidentTables,
    blocked: Option<(&'a ResidentBlocked, usize)>,
    ring: usize,
    offset: usize,
}

impl<'a> NodeTable<'a> {
    /// The table of one of the request's nodes.
    pub(crate) fn of(tables: &'a ResidentTables, request: &'a Prepared, node: &MixNode) -> Self {
        let angle_index = (node.blocking as usize).checked_sub(1);
        let blocked = angle_index.and_then(|angle_index| Some((tables.blocked.as_ref()?, angle_index)));
        let (ring, offset) = (node.ring as usize, node.offset as usize);
        match blocked {
            None => Self {
                taps: &request.altitude_taps,
                log_scale: &tables.log_scale,
                shape: &tables.shape,
                basis_count: tables.basis_count,
                tables,
                blocked,
                ring,
                offset,
            },
            Some((behind, _)) => Self {
                taps: &request.blocked_altitude_taps,
                log_scale: &behind.log_scale,
                shape: &behind.shape,
                basis_count: behind.basis_count,
                tables,
                blocked,
                ring,
                offset,
            },
        }
    }

    /// Whether it is the table of sources behind skylines.
    pub(crate) fn is_behind_skyline(&self) -> bool {
        self.blocked.is_some()
    }

    /// Position in [`Self::log_scale`]; times [`Self::basis_count`] the start in [`Self::shape`].
    pub(crate) fn index(&self, observer_altitude: usize, lobe: usize, band: usize) -> usize {
        match self.blocked {
            None => self.tables.node_index(observer_altitude, lobe, band, self.ring, self.offset),
            Some((behind, angle_index)) => {
                behind.node_index(observer_altitude, angle_index, lobe, band, self.ring, self.offset)
            }
        }
    }
}
