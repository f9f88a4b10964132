//! A source behind the skyline that blocks its low light towards one observer.

use crate::source_pixel::PointSource;

/// A point source, and how high what stands between it and the observer is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockedSource {
    /// The source as the observer sees it.
    pub source: PointSource,
    /// Elevation of the skyline in the vertical plane from source to observer, as seen from the source, radians, 0..=π/2:
    /// what leaves the source at and below it, in any azimuth, does not count in any order. 0 is the open sky.
    pub blocking_rad: f64,
}

impl BlockedSource {
    /// A source with nothing between it and the observer.
    pub fn open(source: PointSource) -> Self {
        Self { source, blocking_rad: 0.0 }
    }
}
