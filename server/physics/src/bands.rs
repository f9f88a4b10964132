//! The three independent colour bands.

use serde::{Deserialize, Serialize};

/// Number of bands; the length of every per-band array, always in the order R, G, B.
pub const BAND_COUNT: usize = 3;

/// One of the three independent channels. Scattering is evaluated at a single wavelength each; flux is
/// counted over 600–700, 500–600 and 400–500 nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Band {
    /// 600–700 nm, scattering at 680 nm.
    R,
    /// 500–600 nm, scattering at 550 nm.
    G,
    /// 400–500 nm, scattering at 440 nm.
    B,
}

impl Band {
    /// All bands in array order.
    pub const ALL: [Band; BAND_COUNT] = [Band::R, Band::G, Band::B];

    /// Wavelength at which scattering is evaluated, nanometres.
    pub const fn wavelength_nm(self) -> f64 {
        match self {
            Band::R => 680.0,
            Band::G => 550.0,
            Band::B => 440.0,
        }
    }

    /// Position in every per-band array.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Luminous efficacy K_b of a watt in this band, lumens per watt.
    pub const fn luminous_efficacy_lm_w(self) -> f64 {
        match self {
            Band::R => 150.0,
            Band::G => 567.0,
            Band::B => 45.0,
        }
    }
}
