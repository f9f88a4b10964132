//! The classes of land cover that products have, and what they reflect.

use crate::error::SceneError;
use serde::{Deserialize, Serialize};

/// Whose classes a raster of land cover has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LandClasses {
    /// ESA WorldCover, 10 m.
    WorldCover,
    /// ESA CCI and Copernicus C3S, 300 m.
    Cci,
    /// CORINE, by the codes of its rasters (1 to 44) or of its classes (111 to 523).
    Corine,
    /// The International Geosphere-Biosphere Programme's, as in NASA's MCD12Q1.
    Igbp,
}

impl LandClasses {
    const ALL: [(Self, &'static str, &'static str); 4] = [
        (Self::WorldCover, "worldcover", "ESA WorldCover"),
        (Self::Cci, "cci", "ESA CCI"),
        (Self::Corine, "corine", "CORINE"),
        (Self::Igbp, "igbp", "IGBP"),
    ];
    /// Their names.
    pub const NAMES: &'static str = "worldcover, cci, corine or igbp";

    /// From the command line's spelling.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        let found = Self::ALL.iter().find(|(_, name, _)| *name == text);
        found.map(|(classes, ..)| *classes).ok_or_else(|| SceneError::InvalidOption {
            option: "--land-cover-classes",
            reason: format!("\"{text}\" is none of {}", Self::NAMES),
        })
    }

    /// Their name for people.
    pub(super) fn title(self) -> &'static str {
        Self::ALL.iter().find(|(classes, ..)| *classes == self).map_or("", |(_, _, title)| title)
    }

    /// Whether a class says that nothing is known.
    pub(super) fn is_void(self, code: i64) -> bool {
        match self {
            Self::WorldCover | Self::Cci => code == 0,
            Self::Corine => matches!(code, 0 | 48 | 128 | 255 | 990 | 995 | 999),
            Self::Igbp => matches!(code, 0 | 255),
        }
    }

    /// The cover of a class; None for one that these have not.
    pub(super) fn cover(self, code: i64) -> Option<Cover> {
        use Cover::*;
        Some(match (self, code) {
            (Self::WorldCover, 10)
            | (Self::Cci, 90 | 100 | 160 | 170)
            | (Self::Corine, 25 | 313)
            | (Self::Igbp, 5) => MixedForest,
            (Self::WorldCover, 95) | (Self::Igbp, 2) => EvergreenForest,
            (Self::Cci, 50) => EvergreenForest,
            (Self::Cci, 60..=62 | 80..=82) | (Self::Corine, 23 | 311) | (Self::Igbp, 3 | 4) => {
                DeciduousForest
            }
            (Self::Cci, 70..=72) | (Self::Corine, 24 | 312) | (Self::Igbp, 1) => EvergreenForest,
            (Self::WorldCover, 20)
            | (Self::Cci, 120..=122)
            | (Self::Corine, 27..=29 | 322..=324)
            | (Self::Igbp, 6..=8) => Shrub,
            (Self::WorldCover, 30) | (Self::Cci, 110 | 130) | (Self::Igbp, 9 | 10) => Grass,
            (Self::Corine, 10 | 11 | 18 | 26 | 141 | 142 | 231 | 321) => Grass,
            (Self::WorldCover, 40) | (Self::Cci, 10..=12 | 20 | 30 | 40) | (Self::Igbp, 12 | 14) => Crops,
            (Self::Corine, 12..=17 | 19..=22 | 211..=213 | 221..=223 | 241..=244) => Crops,
            (Self::WorldCover, 50) | (Self::Cci, 190) | (Self::Igbp, 13) => Built,
            (Self::Corine, 1..=9 | 111 | 112 | 121..=124 | 131..=133) => Built,
            (Self::Cci, 150..=153) | (Self::Corine, 32 | 333) => SparsePlants,
            (Self::WorldCover, 60)
            | (Self::Cci, 200..=202)
            | (Self::Corine, 30 | 31 | 33 | 331 | 332 | 334)
            | (Self::Igbp, 16) => Bare,
            (Self::WorldCover, 70) | (Self::Cci, 220) | (Self::Corine, 34 | 335) | (Self::Igbp, 15) => Ice,
            (Self::WorldCover, 80)
            | (Self::Cci, 210)
            | (Self::Corine, 40..=44 | 511 | 512 | 521..=523)
            | (Self::Igbp, 17) => Water,
            (Self::WorldCover, 90)
            | (Self::Cci, 180)
            | (Self::Corine, 35..=39 | 411 | 412 | 421..=423)
            | (Self::Igbp, 11) => Wetland,
            (Self::WorldCover, 100) | (Self::Cci, 140) => Tundra,
            _ => return None,
        })
    }
}

/// What covers the ground, as the Biosphere-Atmosphere Transfer Scheme has it (BATS 1e, Dickinson et al. 1993).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    EvergreenForest,
    DeciduousForest,
    MixedForest,
    Shrub,
    Grass,
    Crops,
    SparsePlants,
    Wetland,
    Tundra,
    Bare,
    Built,
    Ice,
    Water,
}

impl Cover {
    /// Albedo of visible light, 0.4 to 0.7 µm, after table 2 of BATS, rounded where several of its classes are one here; what is built is
    /// put between roads and roofs.
    pub(super) const fn albedo(self) -> f64 {
        match self {
            Self::EvergreenForest => 0.05,
            Self::MixedForest | Self::Wetland => 0.06,
            Self::Water => 0.07,
            Self::DeciduousForest | Self::Shrub => 0.08,
            Self::Tundra => 0.09,
            Self::Grass | Self::Crops => 0.10,
            Self::Built => 0.13,
            Self::SparsePlants => 0.17,
            Self::Bare => 0.20,
            Self::Ice => 0.80,
        }
    }

    pub(super) const fn is_forest(self) -> bool {
        matches!(self, Self::EvergreenForest | Self::DeciduousForest | Self::MixedForest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every class of every product has a cover, none of another has.
    #[test]
    fn every_class_has_a_cover() {
        let known = |classes: LandClasses| {
            (0..1_000).filter(|code| classes.cover(*code).is_some()).collect::<Vec<i64>>()
        };
        assert_eq!(known(LandClasses::WorldCover), [10, 20, 30, 40, 50, 60, 70, 80, 90, 95, 100]);
        assert_eq!(known(LandClasses::Igbp), (1..=17).collect::<Vec<_>>());
        let corine = known(LandClasses::Corine);
        assert_eq!((&corine[..44], corine.len()), (&(1..=44).collect::<Vec<_>>()[..], 88));
        assert_eq!(known(LandClasses::Cci).len(), 37);
        // The raster's codes are the classes in their order.
        for (grid, class) in corine[..44].iter().zip(&corine[44..]) {
            assert_eq!(LandClasses::Corine.cover(*grid), LandClasses::Corine.cover(*class), "{grid} {class}");
        }
        assert!(LandClasses::parse("corine").is_ok() && LandClasses::parse("modis").is_err());
    }
}
