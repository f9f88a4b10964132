//! The independent bands: how many there are, and what each is. All else follows from this file and the packs.

/// Number of bands; the length of every per-band array, always in the order of [`Band::ALL`].
pub const BAND_COUNT: usize = 3;

/// Wavelength at which scattering is evaluated, nm, and luminous efficacy K_b of a watt, lm/W. Flux is counted over 600–700,
/// 500–600 and 400–500 nm.
const BANDS: [(f64, f64); BAND_COUNT] = [(680.0, 150.0), (550.0, 567.0), (440.0, 45.0)];

/// One of the independent channels. Scattering is evaluated at a single wavelength each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Band(usize);

impl Band {
    /// All bands in array order.
    pub const ALL: [Band; BAND_COUNT] = {
        let mut all = [Band(0); BAND_COUNT];
        let mut index = 0;
        while index < BAND_COUNT {
            all[index] = Band(index);
            index += 1;
        }
        all
    };

    /// The band with the shortest wavelength, in which the air is thickest.
    pub const SHORTEST: Band = Band::shorter_than(f64::NEG_INFINITY);

    /// The band with the longest wavelength.
    pub const LONGEST: Band = {
        let mut longest = Band::SHORTEST;
        let mut index = 0;
        while index < BAND_COUNT {
            if BANDS[index].0 > longest.wavelength_nm() {
                longest = Band(index);
            }
            index += 1;
        }
        longest
    };

    /// A band in the middle of the spectrum, of which others differ least: the second by wavelength.
    pub const MIDDLE: Band = Band::shorter_than(Band::SHORTEST.wavelength_nm());

    /// The band with the shortest wavelength above a bound, nm.
    const fn shorter_than(bound_nm: f64) -> Band {
        let mut found: Option<usize> = None;
        let mut index = 0;
        while index < BAND_COUNT {
            let is_first = match found {
                Some(other) => BANDS[index].0 < BANDS[other].0,
                None => true,
            };
            if BANDS[index].0 > bound_nm && is_first {
                found = Some(index);
            }
            index += 1;
        }
        match found {
            Some(index) => Band(index),
            None => panic!("too few bands"),
        }
    }

    /// Wavelength at which scattering is evaluated, nanometres.
    pub const fn wavelength_nm(self) -> f64 {
        BANDS[self.0].0
    }

    /// Position in every per-band array.
    pub const fn index(self) -> usize {
        self.0
    }

    /// Luminous efficacy K_b of a watt in this band, lumens per watt.
    pub const fn luminous_efficacy_lm_w(self) -> f64 {
        BANDS[self.0].1
    }
}
