//! Air that beams from outside go through: molecules by the US Standard Atmosphere 1976, haze by turbidity, ozone
//! (`docs/model.md#beams`).

use super::ozone;
use crate::{
    atmosphere::{
        AEROSOL_ALBEDO, AEROSOL_SCALE_HEIGHT_M, MOLECULE_EXTINCTION_550_PER_M, MOLECULE_SCALE_HEIGHT_M,
        MOLECULE_WAVELENGTH_POWER, Turbidity,
    },
    bands::{BAND_COUNT, Band},
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
};
use std::sync::LazyLock;

/// Vertical optical depth of molecules over sea level at 550 nm (Bucholtz 1995), as lamps have it.
const MOLECULE_DEPTH_550: f64 = MOLECULE_EXTINCTION_550_PER_M * MOLECULE_SCALE_HEIGHT_M;
/// Ozone over a place, Dobson units, in the mean over the Earth and the year.
pub const USUAL_OZONE_DOBSON: f64 = 300.0;
/// Power of the wavelength in the extinction of aerosol, as lamps have it.
const AEROSOL_POWER: f64 = 1.3;
/// Refractive index of the air at sea level and 15 °C less 1, at 550 nm (Ciddor 1996); others differ by 1 %.
const REFRACTIVITY: f64 = 2.778e-4;
/// Lowest and highest altitude of the profile's table, metres, and its step.
const LOWEST_M: f64 = -6_000.0;
const HIGHEST_M: f64 = 120_000.0;
const STEP_M: f64 = 50.0;

/// Layers of the US Standard Atmosphere 1976: geopotential altitude of the base [m], temperature there [K], lapse [K/m].
const LAYERS: [(f64, f64, f64); 8] = [
    (0.0, 288.15, -6.5e-3),
    (11_000.0, 216.65, 0.0),
    (20_000.0, 216.65, 1.0e-3),
    (32_000.0, 228.65, 2.8e-3),
    (47_000.0, 270.65, 0.0),
    (51_000.0, 270.65, -2.8e-3),
    (71_000.0, 214.65, -2.0e-3),
    (84_852.0, 186.946, 0.0),
];
/// g·M/R of the same, K/m.
const HYDROSTATIC_K_PER_M: f64 = 0.034_163_195;
/// Radius of the same, metres.
const STANDARD_RADIUS_M: f64 = 6_356_766.0;

/// How molecules are spread over altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoleculeProfile {
    /// US Standard Atmosphere 1976, with so much ozone, Dobson units.
    Standard {
        /// [`USUAL_OZONE_DOBSON`] in the mean.
        ozone_dobson: f64,
    },
    /// Exponential, with extinction at sea level and 550 nm: to compare with older numbers.
    Exponential {
        /// Ozone, Dobson units, spread as in the standard one.
        ozone_dobson: f64,
        /// Scale height, metres.
        scale_height_m: f64,
        /// Extinction at sea level and 550 nm, m⁻¹.
        extinction_550_per_m: f64,
        /// No molecules from here on, metres.
        top_m: f64,
    },
}

/// Scattering and extinction at one altitude, m⁻¹, per band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    pub(super) molecules_per_m: [f64; BAND_COUNT],
    /// Of aerosol, scattered and absorbed.
    pub(super) aerosol_per_m: [f64; BAND_COUNT],
    pub(super) extinction_per_m: [f64; BAND_COUNT],
}

impl Coefficients {
    /// Share of extinction that is scattering by molecules and by aerosol, per band.
    pub(super) fn scattering_shares(&self) -> [[f64; BAND_COUNT]; 2] {
        let share = |scattered: [f64; BAND_COUNT], albedo: f64| -> [f64; BAND_COUNT] {
            std::array::from_fn(|b| albedo * scattered[b] / self.extinction_per_m[b].max(f64::MIN_POSITIVE))
        };
        [share(self.molecules_per_m, 1.0), share(self.aerosol_per_m, AEROSOL_ALBEDO)]
    }
}

/// Air of one turbidity as a beam meets it.
#[derive(Clone, Debug)]
pub struct BeamAir {
    turbidity: Turbidity,
    profile: MoleculeProfile,
    is_refracting: bool,
    molecules_per_m: [f64; BAND_COUNT],
    aerosol_per_m: [f64; BAND_COUNT],
    ozone_per_m: [f64; BAND_COUNT],
}

/// Pressure over temperature of the US Standard Atmosphere relative to sea level: relative density.
fn standard_density(altitude_m: f64) -> f64 {
    let geopotential_m = STANDARD_RADIUS_M * altitude_m / (STANDARD_RADIUS_M + altitude_m);
    let mut pressure = 1.0;
    for (index, &(base_m, base_k, lapse)) in LAYERS.iter().enumerate() {
        let above_m = LAYERS.get(index + 1).map_or(f64::INFINITY, |layer| layer.0);
        let rise_m = geopotential_m.min(above_m) - base_m;
        let here_k = base_k + lapse * rise_m;
        pressure *= if lapse == 0.0 {
            (-HYDROSTATIC_K_PER_M * rise_m / base_k).exp()
        } else {
            (here_k / base_k).powf(-HYDROSTATIC_K_PER_M / lapse)
        };
        if geopotential_m <= above_m {
            return pressure * LAYERS[0].1 / here_k;
        }
    }
    0.0
}

/// ln of the relative density every [`STEP_M`].
static LOG_DENSITY: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let count = ((HIGHEST_M - LOWEST_M) / STEP_M) as usize + 1;
    (0..count).map(|k| standard_density(LOWEST_M + STEP_M * k as f64).ln()).collect()
});

/// ∫ of the relative density over altitude from sea level, metres.
static STANDARD_COLUMN_M: LazyLock<f64> = LazyLock::new(|| {
    let count = (HIGHEST_M / STEP_M) as usize;
    (0..count).map(|k| standard_density((k as f64 + 0.5) * STEP_M) * STEP_M).sum()
});

impl BeamAir {
    /// The air of a turbidity at the bands' wavelengths.
    pub fn new(turbidity: Turbidity) -> Self {
        Self::with_profile(
            turbidity,
            MoleculeProfile::Standard { ozone_dobson: USUAL_OZONE_DOBSON },
            true,
            Band::ALL.map(Band::wavelength_nm),
        )
    }

    /// The air of a turbidity with another profile, with or without refraction, at any wavelengths, nm.
    pub fn with_profile(
        turbidity: Turbidity,
        profile: MoleculeProfile,
        is_refracting: bool,
        wavelengths_nm: [f64; BAND_COUNT],
    ) -> Self {
        let (extinction_550_per_m, depth_550, ozone_dobson) = match profile {
            MoleculeProfile::Standard { ozone_dobson } => {
                (MOLECULE_DEPTH_550 / *STANDARD_COLUMN_M, MOLECULE_DEPTH_550, ozone_dobson)
            }
            MoleculeProfile::Exponential { ozone_dobson, scale_height_m, extinction_550_per_m, .. } => {
                (extinction_550_per_m, extinction_550_per_m * scale_height_m, ozone_dobson)
            }
        };
        let aerosol_550_per_m = (turbidity.value() - 1.0) * depth_550 / AEROSOL_SCALE_HEIGHT_M;
        Self {
            turbidity,
            profile,
            is_refracting,
            molecules_per_m: wavelengths_nm
                .map(|nm| extinction_550_per_m * (550.0 / nm).powf(MOLECULE_WAVELENGTH_POWER)),
            aerosol_per_m: wavelengths_nm.map(|nm| aerosol_550_per_m * (550.0 / nm).powf(AEROSOL_POWER)),
            ozone_per_m: wavelengths_nm.map(|nm| ozone_dobson * ozone::densest_extinction_per_m(nm)),
        }
    }

    /// The turbidity that this was made for.
    pub fn turbidity(&self) -> Turbidity {
        self.turbidity
    }

    /// Density of molecules relative to sea level.
    pub(super) fn molecule_density(&self, altitude_m: f64) -> f64 {
        match self.profile {
            MoleculeProfile::Exponential { top_m, .. } if altitude_m > top_m => 0.0,
            MoleculeProfile::Exponential { scale_height_m, .. } => (-altitude_m / scale_height_m).exp(),
            MoleculeProfile::Standard { .. } => {
                let (last, table) = (LOG_DENSITY.len() - 2, &*LOG_DENSITY);
                let place = ((altitude_m - LOWEST_M) / STEP_M).max(0.0);
                let lower = (place as usize).min(last);
                let slope = table[lower + 1] - table[lower];
                (table[lower] + (place - lower as f64) * slope).exp()
            }
        }
    }

    pub(super) fn at(&self, altitude_m: f64) -> Coefficients {
        let molecules = self.molecule_density(altitude_m);
        let aerosol = (-altitude_m / AEROSOL_SCALE_HEIGHT_M).exp();
        let ozone = ozone::relative_density(altitude_m);
        let molecules_per_m = self.molecules_per_m.map(|value| value * molecules);
        let aerosol_per_m = self.aerosol_per_m.map(|value| value * aerosol);
        Coefficients {
            molecules_per_m,
            aerosol_per_m,
            extinction_per_m: std::array::from_fn(|band| {
                molecules_per_m[band] + aerosol_per_m[band] + ozone * self.ozone_per_m[band]
            }),
        }
    }

    /// −d ln n/dr of the refractive index n at an altitude, m⁻¹, and n − 1.
    pub(super) fn refraction(&self, altitude_m: f64) -> (f64, f64) {
        if !self.is_refracting {
            return (0.0, 0.0);
        }
        let here = self.molecule_density(altitude_m);
        let half_m = 200.0;
        let slope = (self.molecule_density(altitude_m - half_m) - self.molecule_density(altitude_m + half_m))
            / (2.0 * half_m);
        (REFRACTIVITY * slope / (1.0 + REFRACTIVITY * here), REFRACTIVITY * here)
    }

    /// Phase function of the air over an altitude as a whole, by what each constituent scatters vertically.
    pub fn mixed_phase(&self, altitude_m: f64) -> MixedPhase {
        let aerosol_m =
            AEROSOL_ALBEDO * AEROSOL_SCALE_HEIGHT_M * (-altitude_m / AEROSOL_SCALE_HEIGHT_M).exp();
        let molecules_m = MOLECULE_SCALE_HEIGHT_M * self.molecule_density(altitude_m);
        MixedPhase {
            molecules: self.molecules_per_m.map(|per_m| per_m * molecules_m),
            aerosol: self.aerosol_per_m.map(|per_m| per_m * aerosol_m),
        }
    }

    /// Vertical optical depth over an altitude of at least 0, per band, by the midpoint rule.
    pub fn vertical_optical_depth(&self, altitude_m: f64) -> [f64; BAND_COUNT] {
        let count = ((HIGHEST_M - altitude_m) / STEP_M) as usize;
        let mut depth = [0.0; BAND_COUNT];
        for k in 0..count {
            let here = self.at(altitude_m + (k as f64 + 0.5) * STEP_M);
            for (depth, extinction) in depth.iter_mut().zip(here.extinction_per_m) {
                *depth += extinction * STEP_M;
            }
        }
        depth
    }
}

/// Phase function of air that scatters by molecules and by aerosol.
#[derive(Clone, Copy, Debug)]
pub struct MixedPhase {
    /// What molecules scatter of light that crosses the air vertically, per band.
    molecules: [f64; BAND_COUNT],
    aerosol: [f64; BAND_COUNT],
}

impl MixedPhase {
    /// Its value, sr⁻¹, per band.
    pub fn per_sr(&self, cos_scattering: f64) -> [f64; BAND_COUNT] {
        let (rayleigh, aerosol) =
            (rayleigh_per_sr(cos_scattering), henyey_greenstein_per_sr(cos_scattering, AEROSOL_ASYMMETRY));
        std::array::from_fn(|band| {
            let (m, a) = (self.molecules[band], self.aerosol[band]);
            (m * rayleigh + a * aerosol) / (m + a)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Densities of the standard's tables at 5, 20, 50 and 80 km over 1.225 kg/m³.
    #[test]
    fn the_standard_profile_is_that_of_its_tables() {
        for (altitude_m, density) in [
            (0.0, 1.225),
            (5_000.0, 0.736_43),
            (20_000.0, 8.891e-2),
            (50_000.0, 1.026_9e-3),
            (80_000.0, 1.846e-5),
        ] {
            let relative = standard_density(altitude_m) * 1.225;
            assert!((relative / density - 1.0).abs() < 2e-3, "{altitude_m}: {relative} {density}");
            let air = BeamAir::new(Turbidity::default());
            assert!((air.molecule_density(altitude_m) * 1.225 / relative - 1.0).abs() < 1e-3);
        }
    }

    /// Depths over sea level: molecules, haze by turbidity, and ozone.
    #[test]
    fn vertical_depths_are_as_stated() {
        let at = [550.0; BAND_COUNT];
        for turbidity in [1.0, 2.5] {
            let turbidity = Turbidity::new(turbidity).unwrap();
            let air = BeamAir::with_profile(
                turbidity,
                MoleculeProfile::Standard { ozone_dobson: USUAL_OZONE_DOBSON },
                true,
                at,
            );
            let wanted = 0.0973 * turbidity.value() + 0.085 * 0.3;
            let depth = air.vertical_optical_depth(0.0)[0];
            assert!((depth / wanted - 1.0).abs() < 2e-3, "{depth} {wanted}");
        }
    }
}
