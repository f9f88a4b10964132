//! What shines in the night sky, outside the air: where Sun, Moon, planets and stars stand, how bright they are, and the
//! radiance of starlight, zodiacal light and airglow by direction (`docs/model.md#heavens`). No files, no GPU.

pub mod airglow;
pub mod answers;
pub mod bodies;
pub mod calendar;
pub mod components;
pub mod dark_reference;
pub mod eclipse;
pub mod ephemeris;
pub mod error;
pub mod heavens;
pub mod irradiance_grid;
pub mod lights;
pub mod limiting_magnitude;
pub mod magnitudes;
pub mod milky_way;
pub mod moon_face;
pub mod moon_orientation;
pub mod night;
pub mod path;
pub mod phase;
#[cfg(feature = "openapi")]
mod schema;
pub mod site;
pub mod solar_spectrum;
pub mod starlight;
pub mod stars;
pub mod time;
pub mod zodiacal_light;

pub use answers::BodiesAnswer;
pub use bodies::{Moon, PlanetSeen, Sun};
pub use calendar::Calendar;
pub use components::Component;
pub use ephemeris::{Body, Planet, Positions};
pub use error::CelestialError;
pub use heavens::{Heavens, PointLight};
pub use irradiance_grid::IrradianceGrid;
pub use night::Night;
pub use site::Site;
pub use time::{CalendarDate, Instant};
