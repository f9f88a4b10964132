//! Colour maps: perceptually uniform, monotonic in lightness, readable without colour vision.

use serde::{Deserialize, Serialize};

/// A named colour map, dark to bright. Rainbow-like maps are left out on purpose: their lightness goes up and
/// down, and readers with a colour deficiency cannot order them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Colormap {
    /// Black, purple, orange, pale yellow: the default.
    #[default]
    Inferno,
    /// Black, purple, pink, white.
    Magma,
    /// Blue, purple, orange, yellow.
    Plasma,
    /// Purple, green, yellow.
    Viridis,
    /// Blue, grey, yellow: made for colour-deficient readers.
    Cividis,
    /// Black to white.
    Grey,
}

/// Entries of a colour map's table.
pub const TABLE_LEN: usize = 256;

impl Colormap {
    /// All maps.
    pub const ALL: [Colormap; 6] = [
        Colormap::Inferno,
        Colormap::Magma,
        Colormap::Plasma,
        Colormap::Viridis,
        Colormap::Cividis,
        Colormap::Grey,
    ];

    /// The name used in requests.
    pub const fn name(self) -> &'static str {
        match self {
            Colormap::Inferno => "inferno",
            Colormap::Magma => "magma",
            Colormap::Plasma => "plasma",
            Colormap::Viridis => "viridis",
            Colormap::Cividis => "cividis",
            Colormap::Grey => "grey",
        }
    }

    /// The map of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|map| map.name() == name)
    }

    /// sRGB colour at `t` in 0..=1 (clamped; NaN counts as 0), dark at 0.
    pub fn rgb(self, t: f64) -> [u8; 3] {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        let gradient = match self {
            Colormap::Inferno => colorous::INFERNO,
            Colormap::Magma => colorous::MAGMA,
            Colormap::Plasma => colorous::PLASMA,
            Colormap::Viridis => colorous::VIRIDIS,
            Colormap::Cividis => colorous::CIVIDIS,
            Colormap::Grey => return [(t * 255.0).round() as u8; 3],
        };
        let colour = gradient.eval_continuous(t);
        [colour.r, colour.g, colour.b]
    }

    /// [`TABLE_LEN`] colours at t = i/(TABLE_LEN − 1).
    pub fn table(self) -> [[u8; 3]; TABLE_LEN] {
        std::array::from_fn(|i| self.rgb(i as f64 / (TABLE_LEN - 1) as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of an sRGB colour.
    fn lightness(rgb: [u8; 3]) -> f64 {
        let linear = rgb.map(|c| (f64::from(c) / 255.0).powf(2.2));
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    /// Every map gets brighter all the way so that grey prints and all eyes can order it.
    #[test]
    fn every_map_rises_in_lightness() {
        for map in Colormap::ALL {
            let table = map.table();
            for step in 0..TABLE_LEN - 16 {
                assert!(lightness(table[step + 16]) > lightness(table[step]), "{map:?} at {step}");
            }
        }
    }

    #[test]
    fn every_map_is_found_by_its_name_and_clamps() {
        for map in Colormap::ALL {
            assert_eq!(Colormap::from_name(map.name()), Some(map));
            assert_eq!(map.rgb(-3.0), map.rgb(0.0));
            assert_eq!(map.rgb(7.0), map.rgb(1.0));
            assert_eq!(map.rgb(f64::NAN), map.rgb(0.0));
        }
        assert_eq!(Colormap::from_name("jet"), None);
    }
}
