//! What of the open sky over a place a map of all places shows.

use crate::night_sky::dark_outside;
use serde::Serialize;
use skyglow_physics::{Horizon, LinearMeasure, Response};
use std::f64::consts::PI;

/// What of the open sky over a place a map shows: the ground there is level, and hides nothing of the sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum MapMeasure {
    /// The mean luminance within 5° of the zenith, cd m⁻².
    Zenith,
    /// The mean luminance of the sky, cd m⁻².
    Mean,
    /// The horizontal illuminance, lx.
    Horizontal,
}

impl MapMeasure {
    /// Its unit, in ASCII, where what sees the sky has the unit `of_response`.
    pub fn unit(self, of_response: &str) -> String {
        match self {
            Self::Zenith | Self::Mean => of_response.to_owned(),
            Self::Horizontal if of_response == "cd m-2" => "lx".to_owned(),
            Self::Horizontal => of_response.trim_end_matches(" sr-1").to_owned(),
        }
    }

    /// The weights of the directions.
    pub(crate) fn weights(self, horizon: &Horizon) -> LinearMeasure {
        match self {
            Self::Zenith => LinearMeasure::zenith(horizon),
            Self::Mean => LinearMeasure::mean(horizon),
            Self::Horizontal => LinearMeasure::horizontal(horizon),
        }
    }

    /// What a response sees of the dark reference outside the air, in the unit of the measure, which the colours of such maps go by,
    /// whatever the air.
    pub fn natural_value(self, response: &Response) -> f64 {
        let radiance = dark_outside().value(response);
        match self {
            Self::Zenith | Self::Mean => radiance,
            Self::Horizontal => PI * radiance,
        }
    }

    /// Ends of those colours, logarithmic between: from a hundredth of that, where light pollution begins to count, to forty times it.
    pub fn colour_range(self, response: &Response) -> (f64, f64) {
        let natural = self.natural_value(response);
        (0.01 * natural, 40.0 * natural)
    }
}
