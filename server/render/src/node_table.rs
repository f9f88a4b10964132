//! The table of a node: that of the open sky or that of its blocking angle.

use crate::prepare::{MixNode, Prepared};
use half::f16;
use skyglow_physics::interpolation::Stencil;
use skyglow_tables::resident::{ResidentBlocked, ResidentTables};

/// Nodes that give a curvature.
pub(crate) const WINDOW: usize = 3;

/// The table that a node is in, and its place there.
pub(crate) struct NodeTable<'a> {
    /// Interpolation over the table's observer altitudes.
    pub(crate) altitudes: &'a Stencil,
    /// Which of [`Self::window`] is the node itself.
    pub(crate) place_in_window: usize,
    /// ln of the scale, by [`Self::scale_index`].
    log_scale: &'a [f32],
    /// Shape coefficients, by [`Self::shape_index`].
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
        let axis = match blocked {
            None => &tables.offset_axis[ring],
            Some((behind, angle_index)) => &behind.offset_axis[angle_index][ring],
        };
        let place_in_window = offset + 1 - axis.curvature_node(offset);
        match blocked {
            None => Self {
                altitudes: &request.altitude_stencil,
                place_in_window,
                log_scale: &tables.log_scale,
                shape: &tables.shape,
                basis_count: tables.basis_count,
                tables,
                blocked,
                ring,
                offset,
            },
            Some((behind, _)) => Self {
                altitudes: &request.blocked_altitude_stencil,
                place_in_window,
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

    /// ln of the scale at the three nodes that give the curvature: [`skyglow_tables::curvature`].
    #[inline(always)]
    pub(crate) fn window(&self, observer_altitude: usize, lobe: usize, band: usize) -> [f32; WINDOW] {
        let first = self.scale_index(observer_altitude, lobe, band) - self.place_in_window;
        // A window lies within its ring's offsets.
        self.log_scale[first..].first_chunk().copied().unwrap_or_default()
    }

    fn scale_index(&self, observer_altitude: usize, lobe: usize, band: usize) -> usize {
        match self.blocked {
            None => self.tables.scale_index(observer_altitude, lobe, band, self.ring, self.offset),
            Some((behind, angle_index)) => {
                behind.scale_index(observer_altitude, angle_index, lobe, band, self.ring, self.offset)
            }
        }
    }

    /// Place of an image of the node in the table of shapes; times [`Self::basis_count`] the start in [`Self::shape`].
    pub(crate) fn shape_index(&self, observer_altitude: usize, lobe: usize, band: usize) -> usize {
        match self.blocked {
            None => self.tables.shape_index(observer_altitude, lobe, band, self.ring, self.offset),
            Some((behind, angle_index)) => {
                behind.shape_index(observer_altitude, angle_index, lobe, band, self.ring, self.offset)
            }
        }
    }
}
