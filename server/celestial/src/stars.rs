//! The stars to V = 6.5 of the Yale Bright Star Catalogue (Hoffleit, Warren 1991), black bodies of Ballesteros' temperature (2012).

use crate::{
    components::Component,
    ephemeris::Positions,
    lights::at_nodes,
    magnitudes::{black_body, with_magnitude_v},
};
use glam::DVec3;
use skyglow_physics::spectrum::{NODE_COUNT, Spectrum};
use std::sync::LazyLock;

/// Stars of the catalogue.
pub const STAR_COUNT: usize = 8_404;
/// The faintest V in the catalogue: fainter stars are in the starlight.
pub const FAINTEST_V: f64 = 6.5;

/// A star outside the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Its direction at J2000: x to the equinox, z to the celestial north pole.
    pub direction_j2000: DVec3,
    /// V.
    pub magnitude_v: f64,
    /// B − V; 0.48 where none is known.
    pub b_minus_v: f64,
    /// Irradiance at the nodes in the unit of [`Component::Stars`].
    pub irradiance: [f64; NODE_COUNT],
}

/// All stars, the order of the catalogue kept.
pub fn stars() -> &'static [Star] {
    static STARS: LazyLock<Vec<Star>> =
        LazyLock::new(|| read(include_bytes!("../data/bright_stars_v6.5.bin")));
    &STARS
}

/// Reads rows of right ascension and declination, rad, V and B − V, in single precision.
fn read(bytes: &[u8]) -> Vec<Star> {
    let (rows, _) = bytes.as_chunks::<16>();
    let colours: Vec<[f64; NODE_COUNT]> = (0..COLOUR_STEPS).map(|step| colour(b_minus_v_of(step))).collect();
    rows.iter()
        .map(|row| {
            let (numbers, _) = row.as_chunks::<4>();
            let [right_ascension, declination, magnitude_v, b_minus_v] =
                std::array::from_fn(|at| f64::from(f32::from_le_bytes(numbers[at])));
            let place = ((b_minus_v - FIRST_COLOUR) / COLOUR_STEP).clamp(0.0, COLOUR_STEPS as f64 - 1.001);
            let (below, part) = (place as usize, place.fract());
            let scale = 10f64.powf(-0.4 * magnitude_v);
            Star {
                direction_j2000: DVec3::from_array(sofars::vm::s2c(right_ascension, declination)),
                magnitude_v,
                b_minus_v,
                irradiance: std::array::from_fn(|node| {
                    let (low, high) = (colours[below][node], colours[below + 1][node]);
                    scale * (low + part * (high - low))
                }),
            }
        })
        .collect()
}

/// Colours are found every so many magnitudes of B − V, from −0.4 to 4.
const COLOUR_STEP: f64 = 0.05;
const FIRST_COLOUR: f64 = -0.4;
const COLOUR_STEPS: usize = 89;

fn b_minus_v_of(step: usize) -> f64 {
    FIRST_COLOUR + COLOUR_STEP * step as f64
}

/// Temperature of a star by B − V, K: 4600·(1/(0.92 (B−V) + 1.7) + 1/(0.92 (B−V) + 0.62)).
pub fn temperature_k(b_minus_v: f64) -> f64 {
    4_600.0 * (1.0 / (0.92 * b_minus_v + 1.7) + 1.0 / (0.92 * b_minus_v + 0.62))
}

/// Spectrum of a star outside the air, W m⁻² nm⁻¹.
pub fn spectrum(magnitude_v: f64, b_minus_v: f64) -> Spectrum {
    let temperature_k = temperature_k(b_minus_v);
    with_magnitude_v(&Spectrum::from_fn(|nm| black_body(nm, temperature_k)), magnitude_v)
}

/// At the nodes, a star of V = 0 over the light that all are counted in.
fn colour(b_minus_v: f64) -> [f64; NODE_COUNT] {
    let own = at_nodes(&spectrum(0.0, b_minus_v));
    let unit = Component::Stars.spectrum_at_nodes();
    std::array::from_fn(|node| own[node] / unit[node])
}

/// Directions of all stars as they appear, east, north and up of the observer, below the horizon too.
pub fn directions(positions: &Positions) -> impl Iterator<Item = (&'static Star, DVec3)> + use<> {
    let positions = *positions;
    stars().iter().map(move |star| {
        (star, positions.stand.enu_from_cirs * positions.epoch.apparent(star.direction_j2000))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{site::Site, time::Instant};
    use skyglow_physics::Response;

    #[test]
    fn the_catalogue_is_whole() {
        assert_eq!(stars().len(), STAR_COUNT);
        let sum: f64 = stars().iter().map(|star| 10f64.powf(-0.4 * star.magnitude_v)).sum();
        assert!((sum - 94.6).abs() < 0.05, "{sum}");
        assert!(stars().iter().all(|star| star.magnitude_v <= FAINTEST_V
            && (star.direction_j2000.length() - 1.0).abs() < 1e-12
            && star.irradiance.iter().all(|value| *value > 0.0)));
        let sirius = stars().iter().min_by(|a, b| a.magnitude_v.total_cmp(&b.magnitude_v)).unwrap();
        assert!((sirius.magnitude_v + 1.46).abs() < 1e-6);
    }

    /// Ballesteros gives the Sun 5 780 K; a star of V = 0 gives 2.54e-6 lx, which a Sun's spectrum exceeds by some per cent.
    #[test]
    fn stars_have_colours_and_illuminances() {
        assert!((temperature_k(0.65) - 5_780.0).abs() < 40.0, "{}", temperature_k(0.65));
        for (b_minus_v, from, to) in [(-0.2, 0.99, 1.06), (0.65, 1.0, 1.06), (1.6, 0.99, 1.1)] {
            let ratio = Response::Photopic.value_of(&spectrum(0.0, b_minus_v)) / 2.54e-6;
            assert!((from..to).contains(&ratio), "{b_minus_v}: {ratio}");
        }
        // Red stars have more at long wavelengths than blue ones of the same V.
        let [blue, red] = [-0.2, 1.6].map(colour);
        let nodes = skyglow_physics::spectrum::nodes_nm();
        for node in (0..NODE_COUNT).filter(|node| (nodes[*node] - 550.0).abs() > 20.0) {
            assert_eq!(red[node] > blue[node], nodes[node] > 550.0);
        }
    }

    /// Polaris stands over the north by the latitude; the sky holds half of all stars.
    #[test]
    fn stars_stand_where_they_should() {
        let site = Site::new(50.0, 10.0, 0.0).unwrap();
        let positions = Positions::new(site, Instant::parse("2026-11-28T22:00:00Z").unwrap());
        let polaris = directions(&positions)
            .filter(|(star, _)| star.magnitude_v < 2.1)
            .max_by(|a, b| a.0.direction_j2000.z.total_cmp(&b.0.direction_j2000.z))
            .unwrap();
        let altitude_deg = polaris.1.z.asin().to_degrees();
        assert!((altitude_deg - 50.0).abs() < 0.8, "{altitude_deg}");
        let up = directions(&positions).filter(|(_, direction)| direction.z > 0.0).count();
        assert!((3_500..5_000).contains(&up), "{up}");
    }
}
