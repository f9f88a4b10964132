//! The independent bands: how many there are, and what each is. All else follows from this file and the packs.

/// Number of bands; the length of every per-band array, always in the order of [`Band::ALL`].
pub const BAND_COUNT: usize = 4;

/// Wavelength at which scattering is evaluated, nm, and luminous efficacy K_b of a watt, lm/W: the mean of 683·V(λ) over 635–700,
/// 550–635, 475–550 and 400–475 nm.
const BANDS: [(f64, f64); BAND_COUNT] = [(680.0, 43.0), (590.0, 470.0), (510.0, 382.0), (440.0, 21.0)];

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
    pub const SHORTEST: Band = Band::nearest(0.0);

    /// The band with the longest wavelength.
    pub const LONGEST: Band = Band::nearest(1e6);

    /// The band nearest to what the eye sees best by day, 555 nm.
    pub const MIDDLE: Band = Band::nearest(555.0);

    /// The band whose wavelength is nearest to one, nm.
    const fn nearest(wavelength_nm: f64) -> Band {
        let mut nearest = 0;
        let mut index = 1;
        while index < BAND_COUNT {
            if (BANDS[index].0 - wavelength_nm).abs() < (BANDS[nearest].0 - wavelength_nm).abs() {
                nearest = index;
            }
            index += 1;
        }
        Band(nearest)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_found_by_their_wavelengths() {
        for band in Band::ALL {
            assert_eq!(Band::ALL[band.index()], band);
            assert!(Band::SHORTEST.wavelength_nm() <= band.wavelength_nm());
            assert!(band.wavelength_nm() <= Band::LONGEST.wavelength_nm());
            let from_peak_nm = |band: Band| (band.wavelength_nm() - 555.0).abs();
            assert!(from_peak_nm(Band::MIDDLE) <= from_peak_nm(band));
        }
        assert!(Band::SHORTEST != Band::MIDDLE && Band::MIDDLE != Band::LONGEST);
    }
}
