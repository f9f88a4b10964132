//! Aerial perspective: what the air between an eye and the ground takes of its light and adds to it (Koschmieder 1924;
//! `docs/model.md#lit-ground`).

use crate::{
    Turbidity,
    atmosphere::{AEROSOL_SCALE_HEIGHT_M, Atmosphere, MOLECULE_SCALE_HEIGHT_M},
    bands::BAND_COUNT,
    geometry::EARTH_RADIUS_M,
    lit_ground::SeenLight,
};

/// Wavelengths at which the air counts for X, Y, Z and scotopic luminance, nm.
const RESPONSE_NM: [f64; BAND_COUNT] = [595.0, 557.0, 449.0, 507.0];

/// Air between an eye and what it sees.
#[derive(Clone, Copy, Debug)]
pub struct AirBetween(Atmosphere);

impl AirBetween {
    /// Of a turbidity at sea level.
    pub fn new(turbidity: Turbidity) -> Self {
        Self(Atmosphere::at(turbidity, RESPONSE_NM))
    }

    /// Share of X, Y, Z and scotopic luminance, each at one wavelength, that comes through over a straight path of `distance_m` between
    /// two altitudes above sea level, metres.
    pub fn transmittance(&self, altitudes_m: [f64; 2], distance_m: f64) -> SeenLight {
        let [molecules_m, aerosol_m] = [MOLECULE_SCALE_HEIGHT_M, AEROSOL_SCALE_HEIGHT_M]
            .map(|scale_m| distance_m * mean_density(altitudes_m, distance_m, scale_m));
        let (of_molecules, of_aerosol) =
            (self.0.molecule_extinction_per_m(), self.0.aerosol_extinction_per_m());
        std::array::from_fn(|band| (-of_molecules[band] * molecules_m - of_aerosol[band] * aerosol_m).exp())
    }
}

/// Mean of exp(−z/H) over a straight path; its middle lies below a straight line of altitudes by the Earth's curvature, a mean of
/// d²/12R.
fn mean_density([from_m, to_m]: [f64; 2], distance_m: f64, scale_m: f64) -> f64 {
    let sag_m = distance_m * distance_m / (12.0 * EARTH_RADIUS_M);
    let [low, high] = [from_m.min(to_m), from_m.max(to_m)].map(|altitude_m| (altitude_m - sag_m) / scale_m);
    let rise = high - low;
    let mean = if rise < 1e-6 { 1.0 - 0.5 * rise } else { -(-rise).exp_m1() / rise };
    (-low).exp() * mean
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight up through all of the air it is the vertical optical depth, and along the ground Beer's law.
    #[test]
    fn it_agrees_with_known_paths() {
        let turbidity = Turbidity::new(2.5).unwrap();
        let (air, atmosphere) = (AirBetween::new(turbidity), Atmosphere::at(turbidity, RESPONSE_NM));
        let up = air.transmittance([0.0, 90_000.0], 90_000.0);
        for (through, depth) in up.into_iter().zip(atmosphere.vertical_optical_depth(0.0)) {
            // The sag, meant for level paths, makes it denser by a few per cent.
            assert!((-through.ln() / depth - 1.0).abs() < 0.1, "{through} {depth}");
        }
        let level = air.transmittance([0.0, 0.0], 1_000.0);
        let per_m =
            atmosphere.molecule_extinction_per_m().into_iter().zip(atmosphere.aerosol_extinction_per_m());
        for (level, (molecules, aerosol)) in level.into_iter().zip(per_m) {
            assert!((-level.ln() / (1_000.0 * (molecules + aerosol)) - 1.0).abs() < 1e-4);
        }
        // Blue light is lost first, and high air is clearer.
        let seen = air.transmittance([0.0, 0.0], 20_000.0);
        assert!(seen[2] < seen[3] && seen[3] < seen[1] && seen[1] < seen[0]);
        assert!(air.transmittance([3_000.0, 3_000.0], 20_000.0)[1] > seen[1]);
    }

    /// A level path of 100 km sinks 196 m in its middle; the mean density over the chord is met within 1 %.
    #[test]
    fn long_paths_sink_into_denser_air() {
        let (altitude_m, distance_m, scale_m) = (2_000.0, 100_000.0, 1_200.0);
        let steps = 10_000;
        let mean = (0..steps)
            .map(|step| {
                let along = (f64::from(step) + 0.5) / f64::from(steps);
                let z = altitude_m - distance_m * distance_m * along * (1.0 - along) / (2.0 * EARTH_RADIUS_M);
                (-z / scale_m).exp() / f64::from(steps)
            })
            .sum::<f64>();
        let found = mean_density([altitude_m, altitude_m], distance_m, scale_m);
        assert!((found / mean - 1.0).abs() < 0.01, "{found} {mean}");
        assert!(found > (-altitude_m / scale_m).exp() * 1.05);
    }
}
