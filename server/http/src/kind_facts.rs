//! What is resident, by the orders of scattering that the packs hold.

use crate::source::SourceFacts;
use skyglow_tables::Scattering;

/// The packs of one scattering, as far as a request must know them.
#[derive(Clone, Debug, PartialEq)]
pub struct KindFacts {
    /// Orders of scattering.
    pub scattering: Scattering,
    /// Smallest and largest turbidity resident.
    pub turbidity_range: (f64, f64),
    /// Most basis functions resident.
    pub basis_count: usize,
    /// Lambertian albedo of the ground that light is scattered back from; None where scattering is single.
    pub ground_albedo: Option<f64>,
    /// Why sources behind skylines count as under an open sky; None where they do not.
    pub why_open: Option<&'static str>,
}

impl SourceFacts {
    /// The packs that serve a request which names no scattering; None where nothing is resident.
    pub fn best_kind(&self) -> Option<&KindFacts> {
        self.kinds.last()
    }

    /// The packs of a scattering, where there are any.
    pub fn kind(&self, scattering: Scattering) -> Option<&KindFacts> {
        self.kinds.iter().find(|kind| kind.scattering == scattering)
    }

    /// Why sources behind skylines count as under an open sky with a scattering; None where they do not.
    pub fn why_open(&self, scattering: Scattering) -> Option<&'static str> {
        self.kind(scattering).and_then(|kind| kind.why_open)
    }

    /// What is allowed with a scattering, named only where another one would allow something else.
    pub fn allowed_with(&self, kind: &KindFacts, allowed: String) -> String {
        match self.kinds.len() {
            0 | 1 => allowed,
            _ => format!("{allowed} with {} scattering", kind.scattering.name()),
        }
    }

    /// The names of every scattering resident.
    pub fn scatterings(&self) -> String {
        self.kinds.iter().map(|kind| kind.scattering.name()).collect::<Vec<_>>().join(", ")
    }
}
