//! The face of the Moon: relative albedo from the Lunar Reconnaissance Orbiter (NASA SVS 4720).

/// Columns and rows of the map.
pub const SIZE: (usize, usize) = (512, 256);

/// Relative albedo, linear, equirectangular: row 0 at the Moon's north, longitude 0 in the middle; the mean of the full disc is 128.
pub fn albedo_map() -> &'static [u8] {
    include_bytes!("../data/moon_albedo_512x256.r8")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seas are dark and highlands bright: Mare Imbrium lies in the north, Tycho's rays in the south.
    #[test]
    fn the_map_is_the_moon() {
        assert_eq!(albedo_map().len(), SIZE.0 * SIZE.1);
        let at = |longitude_deg: f64, latitude_deg: f64| {
            let column = ((longitude_deg + 180.0) / 360.0 * SIZE.0 as f64) as usize;
            let row = ((90.0 - latitude_deg) / 180.0 * SIZE.1 as f64) as usize;
            f64::from(albedo_map()[row * SIZE.0 + column])
        };
        assert!(at(-18.0, 33.0) < 0.75 * at(-11.0, -43.0), "{} {}", at(-18.0, 33.0), at(-11.0, -43.0));
        assert!(at(59.0, 17.0) < 0.8 * at(20.0, -30.0));
    }
}
