//! Positions of Sun, Moon and planets as an observer has them: IAU SOFA's `epv00` (Bretagnon, Francou 1988), `moon98`
//! (Chapront-Touzé, Chapront 1988, in Meeus 1998), `plan94` (Simon et al. 1994), IAU 2006/2000A precession and nutation.

use crate::{site::Site, time::Instant};
use glam::{DMat3, DVec3};
use serde::Serialize;
use skyglow_physics::Direction;
use std::f64::consts::FRAC_PI_2;

/// Metres of an astronomical unit.
pub const AU_M: f64 = 1.495_978_707e11;
/// Days that light takes for an astronomical unit.
const LIGHT_DAY_AU: f64 = 499.004_783_836_156_4 / 86_400.0;

/// A planet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[expect(missing_docs, reason = "their names say all")]
pub enum Planet {
    Mercury,
    Venus,
    Mars,
    Jupiter,
    Saturn,
    Uranus,
    Neptune,
}

impl Planet {
    /// All, outwards.
    pub const ALL: [Planet; 7] = [
        Planet::Mercury,
        Planet::Venus,
        Planet::Mars,
        Planet::Jupiter,
        Planet::Saturn,
        Planet::Uranus,
        Planet::Neptune,
    ];

    /// Its number in `plan94`.
    fn number(self) -> i32 {
        match self {
            Planet::Mercury => 1,
            Planet::Venus => 2,
            Planet::Mars => 4,
            Planet::Jupiter => 5,
            Planet::Saturn => 6,
            Planet::Uranus => 7,
            Planet::Neptune => 8,
        }
    }
}

/// A body of the solar system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "their names say all")]
pub enum Body {
    Sun,
    Moon,
    Planet(Planet),
}

/// How the Earth stands, moves and is turned at an instant. Vectors are in the Celestial Intermediate Reference System of date.
#[derive(Clone, Copy, Debug)]
pub struct Epoch {
    instant: Instant,
    tt: (f64, f64),
    /// Turns GCRS, which is J2000 within 0.02″, into the system of date.
    cirs_from_gcrs: DMat3,
    /// Sun to Earth in GCRS, au.
    earth_au: DVec3,
    /// Barycentric velocity of the Earth in GCRS, parts of that of light.
    velocity_c: DVec3,
}

impl Epoch {
    /// Of an instant.
    pub fn new(instant: Instant) -> Self {
        let tt = instant.julian_tt();
        // None only outside the years of an instant.
        let (heliocentric, barycentric) = sofars::eph::epv00(tt.0, tt.1).unwrap_or_default();
        Self {
            instant,
            tt,
            cirs_from_gcrs: matrix(sofars::pnp::c2i06a(tt.0, tt.1)),
            earth_au: DVec3::from_array(heliocentric[0]),
            velocity_c: DVec3::from_array(barycentric[1]) * LIGHT_DAY_AU,
        }
    }

    /// Its instant.
    pub fn instant(&self) -> Instant {
        self.instant
    }

    /// Turns GCRS into the system of date.
    pub fn cirs_from_gcrs(&self) -> DMat3 {
        self.cirs_from_gcrs
    }

    /// Turns GCRS into the mean ecliptic and equinox of date.
    pub fn ecliptic_from_gcrs(&self) -> DMat3 {
        matrix(sofars::coords::ecm06(self.tt.0, self.tt.1))
    }

    /// Distance from Sun to Earth, au.
    pub fn sun_distance_au(&self) -> f64 {
        self.earth_au.length()
    }

    /// From the Earth's centre to a body as it appears there, au: with the time that light takes, and aberration.
    ///
    /// `plan94` is within 20″ of the best theories for the inner planets and within 86″ for the outer ones.
    pub fn geocentric_au(&self, body: Body) -> DVec3 {
        let natural = match body {
            Body::Sun => -self.earth_au,
            Body::Moon => {
                let moon = |days: f64| DVec3::from_array(sofars::eph::moon98(self.tt.0, self.tt.1 - days)[0]);
                let days = moon(0.0).length() * LIGHT_DAY_AU;
                // The Earth's centre moved on while the light was on its way.
                moon(days) - self.velocity_c * (days / LIGHT_DAY_AU)
            }
            Body::Planet(planet) => {
                let from_earth = |days: f64| {
                    sofars::eph::plan94(self.tt.0, self.tt.1 - days, planet.number())
                        .map_or(DVec3::ZERO, |(state, _)| DVec3::from_array(state[0]))
                        - self.earth_au
                };
                let days = from_earth(0.0).length() * LIGHT_DAY_AU;
                from_earth(days)
            }
        };
        self.apparent(natural.normalize()) * natural.length()
    }

    /// A direction of GCRS as it appears from the moving Earth, in the system of date.
    pub fn apparent(&self, natural: DVec3) -> DVec3 {
        let lorentz = (1.0 - self.velocity_c.length_squared()).sqrt();
        let sun_au = self.earth_au.length();
        let moved = sofars::astro::ab(&natural.to_array(), &self.velocity_c.to_array(), sun_au, lorentz);
        self.cirs_from_gcrs * DVec3::from_array(moved)
    }
}

/// How an observer is placed and turned at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// Turns the system of date into east, north, up.
    pub enu_from_cirs: DMat3,
    /// From the Earth's centre, in the system of date, au.
    position_au: DVec3,
}

impl Stand {
    /// Of a site at an instant, by the Earth rotation angle of IAU 2000.
    pub fn new(site: Site, instant: Instant) -> Self {
        let ut1 = instant.julian_ut1();
        let turn_rad = sofars::erst::era00(ut1.0, ut1.1);
        let (latitude, longitude) = (site.latitude_deg().to_radians(), site.longitude_deg().to_radians());
        // WGS84; it fails for no latitude.
        let place = sofars::coords::gd2gc(1, longitude, latitude, site.altitude_m()).unwrap_or_default();
        let (sin, cos) = (turn_rad + longitude).sin_cos();
        let (sin_latitude, cos_latitude) = latitude.sin_cos();
        let east = DVec3::new(-sin, cos, 0.0);
        let north = DVec3::new(-sin_latitude * cos, -sin_latitude * sin, cos_latitude);
        let up = DVec3::new(cos_latitude * cos, cos_latitude * sin, sin_latitude);
        Self {
            enu_from_cirs: DMat3::from_cols(east, north, up).transpose(),
            position_au: DMat3::from_rotation_z(turn_rad) * DVec3::from_array(place) / AU_M,
        }
    }

    /// Where the observer has a body that is there from the Earth's centre, au.
    pub fn topocentric(&self, geocentric_au: DVec3) -> Topocentric {
        Topocentric { enu_au: self.enu_from_cirs * (geocentric_au - self.position_au) }
    }
}

/// Where an observer has a body, refraction left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Topocentric {
    /// East, north and up of the observer, au.
    pub enu_au: DVec3,
}

impl Topocentric {
    /// The direction; its elevation is the true altitude, −π/2..=π/2.
    pub fn direction(&self) -> Direction {
        direction_of(self.enu_au)
    }

    /// Degrees above the horizontal plane, refraction left out.
    pub fn true_altitude_deg(&self) -> f64 {
        self.direction().elevation_rad.to_degrees()
    }

    /// Distance, au.
    pub fn distance_au(&self) -> f64 {
        self.enu_au.length()
    }
}

/// The direction of a vector of east, north and up.
pub fn direction_of(enu: DVec3) -> Direction {
    let azimuth_rad = enu.x.atan2(enu.y).rem_euclid(std::f64::consts::TAU);
    Direction { azimuth_rad, elevation_rad: enu.z.atan2(enu.x.hypot(enu.y)).clamp(-FRAC_PI_2, FRAC_PI_2) }
}

/// Bodies of an instant over a site.
#[derive(Clone, Copy, Debug)]
pub struct Positions {
    /// How the Earth is.
    pub epoch: Epoch,
    /// How the observer is.
    pub stand: Stand,
}

impl Positions {
    /// Of a site and an instant.
    pub fn new(site: Site, instant: Instant) -> Self {
        Self { epoch: Epoch::new(instant), stand: Stand::new(site, instant) }
    }

    /// Where the observer has a body.
    pub fn of(&self, body: Body) -> Topocentric {
        self.stand.topocentric(self.epoch.geocentric_au(body))
    }

    /// The horizon's direction, east, north and up, of a star of J2000; aberration is in, parallax and proper motion are not.
    pub fn of_star(&self, right_ascension_rad: f64, declination_rad: f64) -> DVec3 {
        let catalogue = DVec3::from_array(sofars::vm::s2c(right_ascension_rad, declination_rad));
        self.stand.enu_from_cirs * self.epoch.apparent(catalogue)
    }

    /// Turns east, north, up into galactic axes: x to the centre, z to the pole.
    pub fn galactic_from_enu(&self) -> DMat3 {
        galactic_from_icrs() * self.gcrs_from_enu()
    }

    /// Turns east, north, up into the mean ecliptic and equinox of date.
    pub fn ecliptic_from_enu(&self) -> DMat3 {
        self.epoch.ecliptic_from_gcrs() * self.gcrs_from_enu()
    }

    fn gcrs_from_enu(&self) -> DMat3 {
        (self.stand.enu_from_cirs * self.epoch.cirs_from_gcrs()).transpose()
    }
}

/// Rows of SOFA as columns of glam.
fn matrix(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// Turns ICRS into galactic axes (IAU 1958, as Hipparcos has them in ICRS).
pub(crate) fn galactic_from_icrs() -> DMat3 {
    let axis = |longitude_rad: f64, latitude_rad: f64| {
        let (right_ascension, declination) = sofars::coords::g2icrs(longitude_rad, latitude_rad);
        DVec3::from_array(sofars::vm::s2c(right_ascension, declination))
    };
    DMat3::from_cols(axis(0.0, 0.0), axis(FRAC_PI_2, 0.0), axis(0.0, FRAC_PI_2)).transpose()
}

#[cfg(test)]
#[path = "ephemeris_tests.rs"]
mod tests;
