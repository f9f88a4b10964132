//! The ground at a place, and from which sample it is known.

/// Elevation of the ground as the terrain has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// The terrain has a value there.
    Here {
        /// Metres above sea level; may be negative.
        elevation_m: f64,
    },
    /// The terrain has a gap there: its nearest valid sample within 5 km counts.
    Nearest {
        /// Metres above sea level; may be negative.
        elevation_m: f64,
        /// Metres from the place to that sample.
        distance_m: f64,
    },
    /// No terrain within 5 km: sea level counts.
    Unknown,
}

impl Ground {
    /// Elevation where one is known, metres; may be negative.
    pub fn elevation_m(self) -> Option<f64> {
        match self {
            Ground::Here { elevation_m } | Ground::Nearest { elevation_m, .. } => Some(elevation_m),
            Ground::Unknown => None,
        }
    }

    /// Altitude that the model takes, metres, at least 0; None where it is unknown (then 0 counts).
    pub fn known_altitude_m(self) -> Option<f64> {
        self.elevation_m().map(|elevation_m| elevation_m.max(0.0))
    }

    /// Altitude that the model takes, metres, at least 0.
    pub fn altitude_m(self) -> f64 {
        self.known_altitude_m().unwrap_or(0.0)
    }
}
