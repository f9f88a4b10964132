//! The Sun's spectrum outside the air: the extraterrestrial column of ASTM G173-03 (Gueymard 2004), means over 5 nm.

use skyglow_physics::spectrum::{SAMPLE_COUNT, Spectrum};

/// Irradiance at 1 au, W m⁻² nm⁻¹, 380 to 900 nm every 5 nm; each is the mean over 2.5 nm to either side.
const IRRADIANCE_W_M2_NM: [f64; SAMPLE_COUNT] = [
    1.1942, 0.932, 1.1738, 0.9389, 1.6177, 1.7075, 1.7104, 1.7611, 1.7254, 1.7071, 1.4567, 1.7428, 1.7681,
    1.91, 2.0503, 2.0111, 2.0377, 2.01, 1.997, 2.0267, 2.0612, 1.8841, 1.9178, 1.9745, 1.9003, 1.9343,
    1.9351, 1.8104, 1.8118, 1.8473, 1.9266, 1.8691, 1.8366, 1.8771, 1.8647, 1.8583, 1.8177, 1.8326, 1.8307,
    1.8523, 1.8284, 1.8362, 1.7537, 1.7913, 1.7549, 1.7628, 1.7314, 1.6791, 1.7034, 1.665, 1.6615, 1.6444,
    1.6308, 1.6122, 1.577, 1.4857, 1.5501, 1.5554, 1.5329, 1.5088, 1.4944, 1.463, 1.4712, 1.4457, 1.418,
    1.4154, 1.3944, 1.3676, 1.343, 1.3493, 1.319, 1.3202, 1.2778, 1.2901, 1.2744, 1.2692, 1.2545, 1.2342,
    1.2154, 1.2081, 1.1972, 1.187, 1.1694, 1.1398, 1.1389, 1.1229, 1.1111, 1.1112, 1.0745, 1.0733, 1.0606,
    1.048, 1.0452, 1.0244, 0.9827, 0.9546, 1.0035, 0.9533, 0.9672, 0.9558, 0.9442, 0.9379, 0.939, 0.9261,
    0.9069,
];

/// Irradiance of the Sun at 1 au outside the air, W m⁻² nm⁻¹.
pub fn solar_irradiance() -> Spectrum {
    Spectrum(IRRADIANCE_W_M2_NM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::magnitudes::magnitude_v;
    use skyglow_physics::Response;

    /// V −26.74, and 128 to 134 klx: the illuminance that solar spectra give, which differ by some per cent.
    #[test]
    fn the_sun_is_as_bright_as_it_is() {
        let sun = solar_irradiance();
        let magnitude = magnitude_v(&sun);
        assert!((magnitude + 26.74).abs() < 0.03, "{magnitude}");
        let illuminance_lx = Response::Photopic.value_of(&sun);
        assert!((128e3..134e3).contains(&illuminance_lx), "{illuminance_lx}");
        // 400 to 700 nm hold 39 % of 1361 W m⁻².
        let visible_w_m2 = Response::Band { from_nm: 400, to_nm: 700 }.value_of(&sun);
        assert!((visible_w_m2 / 1361.0 - 0.39).abs() < 0.01, "{visible_w_m2}");
    }
}
