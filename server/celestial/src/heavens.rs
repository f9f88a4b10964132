//! All that shines outside the air over a place at an instant, as kernels at the nodes by direction (`docs/model.md#heavens`).

use crate::{
    airglow,
    bodies::{Moon, PlanetSeen, Sun, planet_b_minus_v},
    components::Component,
    ephemeris::{Positions, direction_of},
    error::CelestialError,
    lights::{FULL_MOON_MAGNITUDE_V, SUN_B_MINUS_V, SUN_MAGNITUDE_V, at_nodes, reddened_sun},
    magnitudes::with_magnitude_v,
    site::Site,
    starlight, stars,
    time::Instant,
    zodiacal_light,
};
use glam::{DMat3, DVec3};
use skyglow_physics::{
    Direction,
    error::check_range,
    spectrum::{NODE_COUNT, nodes_nm},
};

/// Solar radio flux at 10.7 cm, solar flux units, where none is given.
pub const DEFAULT_SOLAR_FLUX_SFU: f64 = 100.0;

/// A point, or a small disc, of light outside the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it appears, refraction left out; elevations below the horizon are negative.
    pub direction: Direction,
    /// V outside the air.
    pub magnitude_v: f64,
    /// Irradiance across the beam at every node, in the unit of its component.
    pub irradiance: [f64; NODE_COUNT],
}

/// The heavens over a site at an instant.
#[derive(Clone, Debug)]
pub struct Heavens {
    site: Site,
    instant: Instant,
    solar_flux_sfu: f64,
    positions: Positions,
    galactic_from_enu: DMat3,
    ecliptic_from_enu: DMat3,
    /// Ecliptic longitude of the Sun, rad.
    sun_longitude_rad: f64,
    sun: Sun,
    moon: Moon,
    planets: [PlanetSeen; 7],
}

impl Heavens {
    /// With the solar radio flux at 10.7 cm, 50..=400 solar flux units, which airglow goes with.
    ///
    /// # Errors
    /// [`CelestialError::Physics`] naming `solar_flux`.
    pub fn new(site: Site, instant: Instant, solar_flux_sfu: f64) -> Result<Self, CelestialError> {
        check_range("solar_flux", solar_flux_sfu, 50.0, 400.0, "sfu")?;
        let positions = Positions::new(site, instant);
        let (sun, moon) = (Sun::of(&positions), Moon::of(&positions));
        let ecliptic_from_enu = positions.ecliptic_from_enu();
        let sun_ecliptic = ecliptic_from_enu * sun.position.enu_au;
        Ok(Self {
            site,
            instant,
            solar_flux_sfu,
            positions,
            galactic_from_enu: positions.galactic_from_enu(),
            ecliptic_from_enu,
            sun_longitude_rad: sun_ecliptic.y.atan2(sun_ecliptic.x),
            sun,
            moon,
            planets: PlanetSeen::all(&positions),
        })
    }

    /// Where the observer stands.
    pub fn site(&self) -> Site {
        self.site
    }

    /// When.
    pub fn instant(&self) -> Instant {
        self.instant
    }

    /// Solar radio flux at 10.7 cm, solar flux units.
    pub fn solar_flux_sfu(&self) -> f64 {
        self.solar_flux_sfu
    }

    /// The Sun.
    pub fn sun(&self) -> &Sun {
        &self.sun
    }

    /// The Moon.
    pub fn moon(&self) -> &Moon {
        &self.moon
    }

    /// The planets, outwards.
    pub fn planets(&self) -> &[PlanetSeen; 7] {
        &self.planets
    }

    /// Turns east, north, up into galactic axes.
    pub fn galactic_from_enu(&self) -> DMat3 {
        self.galactic_from_enu
    }

    /// Points of light of a component, below the horizon too; none of extended ones.
    pub fn points(&self, component: Component) -> Vec<PointLight> {
        let gray = |magnitude_v: f64, unit_v: f64| [10f64.powf(-0.4 * (magnitude_v - unit_v)); NODE_COUNT];
        match component {
            Component::Sun => vec![PointLight {
                direction: self.sun.position.direction(),
                magnitude_v: self.sun.magnitude_v,
                irradiance: gray(self.sun.magnitude_v, SUN_MAGNITUDE_V),
            }],
            Component::Moon => vec![PointLight {
                direction: self.moon.position.direction(),
                magnitude_v: self.moon.magnitude_v,
                irradiance: gray(self.moon.magnitude_v, FULL_MOON_MAGNITUDE_V),
            }],
            Component::Planets => self.planets.iter().map(planet_light).collect(),
            Component::Stars => stars::directions(&self.positions)
                .map(|(star, enu)| PointLight {
                    direction: direction_of(enu),
                    magnitude_v: star.magnitude_v,
                    irradiance: star.irradiance,
                })
                .collect(),
            Component::Starlight | Component::ZodiacalLight | Component::Airglow => Vec::new(),
        }
    }

    /// Radiance outside the air from a direction, at every node in the unit of the component; elevations −π/2..=π/2. Multiplied by
    /// [`Component::spectrum_at_nodes`] it is W m⁻² sr⁻¹ nm⁻¹. 0 for points of light, and for airglow from below the horizontal plane.
    pub fn radiance_outside(&self, component: Component, direction: Direction) -> [f64; NODE_COUNT] {
        self.radiance_outside_enu(component, direction.enu())
    }

    /// The same from a unit vector of east, north, up.
    pub fn radiance_outside_enu(&self, component: Component, enu: DVec3) -> [f64; NODE_COUNT] {
        match component {
            Component::Starlight => {
                let (longitude_rad, latitude_rad) = spherical(self.galactic_from_enu * enu);
                let s10 = starlight::table_s10(longitude_rad.to_degrees(), latitude_rad.to_degrees());
                [s10; NODE_COUNT]
            }
            Component::ZodiacalLight => {
                let (longitude_rad, latitude_rad) = spherical(self.ecliptic_from_enu * enu);
                let from_sun_rad = longitude_rad - self.sun_longitude_rad;
                let s10 = zodiacal_light::table_s10(from_sun_rad.to_degrees(), latitude_rad.to_degrees())
                    * zodiacal_light::distance_factor(self.positions.epoch.sun_distance_au());
                let cos_elongation = (latitude_rad.cos() * from_sun_rad.cos()).clamp(-1.0, 1.0);
                zodiacal_colour(cos_elongation.acos().to_degrees()).map(|colour| s10 * colour)
            }
            Component::Airglow => {
                let zenith_s10 = airglow::zenith_s10(self.solar_flux_sfu);
                [zenith_s10 * airglow::van_rhijn(enu.z, self.site.altitude_m()); NODE_COUNT]
            }
            Component::Sun | Component::Moon | Component::Planets | Component::Stars => [0.0; NODE_COUNT],
        }
    }
}

/// A planet as a point of light: the Sun's spectrum, reddened to the planet's B − V.
fn planet_light(seen: &PlanetSeen) -> PointLight {
    let excess_mag = planet_b_minus_v(seen.planet) - SUN_B_MINUS_V;
    let own = at_nodes(&with_magnitude_v(&reddened_sun(excess_mag, 550.0), seen.magnitude_v));
    let unit = Component::Planets.spectrum_at_nodes();
    PointLight {
        direction: seen.position.direction(),
        magnitude_v: seen.magnitude_v,
        irradiance: std::array::from_fn(|node| own[node] / unit[node]),
    }
}

/// Reddening at the nodes over that of the component's spectrum.
fn zodiacal_colour(elongation_deg: f64) -> [f64; NODE_COUNT] {
    nodes_nm().map(|nm| {
        zodiacal_light::reddening(nm, elongation_deg)
            / zodiacal_light::reddening(nm, zodiacal_light::MEAN_ELONGATION_DEG)
    })
}

/// Longitude and latitude of a unit vector, rad.
fn spherical(vector: DVec3) -> (f64, f64) {
    (vector.y.atan2(vector.x), vector.z.clamp(-1.0, 1.0).asin())
}
