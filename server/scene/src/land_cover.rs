//! What covers the ground: its albedo, and how much of it is water and forest, kept as terrain is.

use crate::sections::{Flaw, Sections};
use crate::terrain::{Terrain, TerrainRaster};
use skyglow_physics::GeoPoint;
use std::borrow::Cow;
use std::fs::File;

/// Shares are kept in so many parts, since tiles of terrain keep tenths.
pub(crate) const PARTS: f64 = 1_000.0;

/// Albedo of snow on open ground, old (Warren 1982), and of a forest that stands in it (Betts and Ball 1997: conifers 0.13, bare aspen 0.21).
pub const SNOW_ALBEDO: f64 = 0.75;
const SNOWY_FOREST_ALBEDO: f64 = 0.15;

/// The ground at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Land {
    /// Share of visible light that it reflects, without snow.
    pub albedo: f64,
    /// Share of it that is open water.
    pub water: f64,
    /// Share of it that is forest.
    pub forest: f64,
}

impl Land {
    /// The albedo after snow: open ground is under it, forest stands in it, water is open.
    pub fn albedo_in_snow(&self) -> f64 {
        let open = (1.0 - self.water - self.forest).max(0.0);
        open * SNOW_ALBEDO.max(self.albedo)
            + self.forest * SNOWY_FOREST_ALBEDO
            + self.water * self.albedo.min(SNOWY_FOREST_ALBEDO)
    }
}

/// Three rasters a file, of albedo, water and forest; the first file that knows a place counts.
#[derive(Debug, Default)]
pub(crate) struct LandCover {
    fields: Terrain,
}

impl LandCover {
    pub(crate) fn new(files: Vec<[TerrainRaster; 3]>) -> Self {
        Self { fields: Terrain::new(files.into_iter().flatten().collect()) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.fields.is_empty()
    }

    /// Bytes of memory that it takes, about.
    pub(crate) fn byte_count(&self) -> u64 {
        self.fields.byte_count()
    }

    /// The ground within about `resolution_m` around a place; None where no file knows it.
    pub(crate) fn at(&self, place: GeoPoint, resolution_m: f64) -> Option<Land> {
        self.fields.rasters.chunks_exact(3).find_map(|file| {
            let [albedo, water, forest] = [0, 1, 2].map(|field: usize| {
                file[field].overview_m(place, resolution_m).map(|parts| (parts / PARTS).clamp(0.0, 1.0))
            });
            Some(Land { albedo: albedo?, water: water?, forest: forest? })
        })
    }

    /// The sections to store.
    pub(crate) fn to_sections(&self) -> Vec<(String, Cow<'_, [u8]>)> {
        self.fields.to_sections()
    }

    /// Undoes [`Self::to_sections`].
    ///
    /// * `file`: in which large sections stay.
    pub(crate) fn from_sections(sections: &Sections<'_>, file: Option<&File>) -> Result<Self, Flaw> {
        let fields = Terrain::from_sections(sections, file)?;
        match fields.rasters.len() % 3 {
            0 => Ok(Self { fields }),
            _ => Err("has not three rasters for each file".to_owned()),
        }
    }
}
