//! Whose light it is: influences added up by named places and by areas (`docs/model.md#shares`). Lights are halved into balls, each
//! with the candidates that may have some of it (branch and bound as in nearest-neighbour search, Fukunaga & Narendra 1975).

mod areas;
mod balls;
mod towns;

use crate::{
    error::ObservatoryError,
    influence_map::InfluenceMap,
    influence_part::Part,
    watch::{Watch, note},
};
use balls::{Lights, Owners};
use rayon::prelude::*;
use skyglow_scene::Boundary;
use towns::Town;

pub use towns::{TOWN_REACH, town_radius_m};

/// What the lights of some owners do.
#[derive(Clone, Debug, PartialEq)]
pub struct Shares {
    /// Of each owner, in their order. Areas that overlap have their common lights each.
    pub of_each: Vec<Part>,
    /// Of lights that belong to nobody.
    pub of_nobody: Part,
    /// Lights that belong to several.
    pub shared_pixels: u64,
}

impl InfluenceMap {
    /// By the scene's named places: what the lights of each do, in their order. A light belongs to the place that is nearest in
    /// units of the place's own radius ([`town_radius_m`]), if within [`TOWN_REACH`] of them.
    ///
    /// # Errors
    /// [`skyglow_render::RenderError::Ended`] where `watch` ended it.
    pub fn by_town(&self, watch: &Watch<'_>) -> Result<Shares, ObservatoryError> {
        let towns: Vec<Town> = self.open_scene().places().iter().map(Town::new).collect();
        self.added_up(&towns::Towns(towns), self.open_scene().places().len(), watch)
    }

    /// By areas: what the lights do whose pixel's centre is inside.
    ///
    /// # Errors
    /// As [`Self::by_town`].
    pub fn by_area(&self, areas: &[&Boundary], watch: &Watch<'_>) -> Result<Shares, ObservatoryError> {
        self.added_up(&areas::Areas::new(areas), areas.len(), watch)
    }

    fn added_up(
        &self,
        owners: &impl Owners,
        count: usize,
        watch: &Watch<'_>,
    ) -> Result<Shares, ObservatoryError> {
        note(watch, 0.0)?;
        let directions =
            (0..self.pixels().len()).into_par_iter().map(|at| self.place(at).unit_vector()).collect();
        let lights = Lights { map: self, directions };
        let all: Vec<u32> = (0..count as u32).collect();
        let sums = lights.sums(0..self.pixels().len(), &all, owners, watch);
        note(watch, 1.0)?;
        let mut of_each = vec![Part::default(); count];
        for (owner, part) in sums.of_owners {
            of_each[owner as usize] = part;
        }
        Ok(Shares { of_each, of_nobody: sums.of_nobody, shared_pixels: sums.shared_pixels })
    }
}
