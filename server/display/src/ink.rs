//! What becomes of a pixel's colour: bytes for every screen, or for those that go above white.

use crate::realistic::SrgbBytes;

/// A pixel of a picture.
pub(crate) trait Ink: Copy + PartialEq + Send + Sync {
    /// Of linear sRGB, 0..=1, where `lights` of what is seen, 0..=1, is light of stars, planets, Moon, Sun and lamps.
    fn of(linear: [f64; 3], lights: f64, bytes: &SrgbBytes) -> Self;

    /// Of sRGB bytes.
    fn of_bytes(rgb: [u8; 3]) -> Self;
}

impl Ink for [u8; 3] {
    #[inline]
    fn of(linear: [f64; 3], _: f64, bytes: &SrgbBytes) -> Self {
        linear.map(|channel| bytes.of(channel))
    }

    #[inline]
    fn of_bytes(rgb: [u8; 3]) -> Self {
        rgb
    }
}
