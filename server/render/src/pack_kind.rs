//! The kinds of packs: turbidity is interpolated between packs of one kind.

use serde::Serialize;
use skyglow_tables::{Clouds, Manifest, ResidentTables, Scattering};
use std::{fmt, sync::Arc};

/// What packs have in common that turbidity is interpolated between. Under one sky the order is from the coarsest model
/// of the air to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct PackKind {
    /// Base of the closed layer of cloud above sea level, metres; None under a clear sky, which comes first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cloud_base_m: Option<u32>,
    /// Orders of scattering.
    pub scattering: Scattering,
}

impl PackKind {
    /// The kind of a pack.
    pub fn of(tables: &ResidentTables) -> Self {
        Self { cloud_base_m: tables.clouds.map(Clouds::base_m), scattering: tables.scattering }
    }

    /// The kind of the pack that a manifest describes.
    pub fn of_manifest(manifest: &Manifest) -> Self {
        Self { cloud_base_m: manifest.clouds.map(Clouds::base_m), scattering: manifest.scattering }
    }

    /// Altitude of the base above sea level, metres: no light comes through it. Infinite under a clear sky.
    pub fn cloud_altitude_m(self) -> f64 {
        self.cloud_base_m.map_or(f64::INFINITY, f64::from)
    }
}

impl fmt::Display for PackKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} scattering", self.scattering.name())?;
        self.cloud_base_m.map_or(Ok(()), |base_m| write!(out, " under clouds at {base_m} m"))
    }
}

/// The resident packs of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidentKind {
    /// The kind.
    #[serde(flatten)]
    pub kind: PackKind,
    /// Turbidities of its packs, ascending; never empty.
    pub turbidities: Vec<f64>,
    /// Most basis functions that any of them has.
    pub basis_count: usize,
    /// Whether they have tables of sources behind skylines: all of them, or it counts for none. Under clouds none counts: no basis
    /// follows the edge of a skyline's shadow on a cloud.
    pub hides_lights: bool,
    /// Index of the first of them in the table set; the others follow.
    #[serde(skip)]
    pub(crate) first: usize,
}

impl ResidentKind {
    /// The kinds of packs that are sorted by kind, then turbidity.
    pub(crate) fn all_of(tables: &[Arc<ResidentTables>]) -> Vec<Self> {
        let mut first = 0;
        tables
            .chunk_by(|a, b| PackKind::of(a) == PackKind::of(b))
            .map(|packs| {
                let kind = PackKind::of(&packs[0]);
                let kind = Self {
                    kind,
                    turbidities: packs.iter().map(|pack| pack.turbidity).collect(),
                    basis_count: packs.iter().map(|pack| pack.basis_count).max().unwrap_or(0),
                    hides_lights: kind.cloud_base_m.is_none()
                        && packs.iter().all(|pack| pack.blocked.is_some()),
                    first,
                };
                first += packs.len();
                kind
            })
            .collect()
    }
}
