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
use std::sync::{LazyLock, OnceLock};

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
    /// Cosine and sine of it.
    towards_sun: [f64; 2],
    /// What the distance of Earth and Sun makes of zodiacal light.
    zodiacal_factor: f64,
    sun: Sun,
    moon: Moon,
    planets: [PlanetSeen; 7],
    /// Points of light of each component, found when they are asked for: stars are thousands.
    points: [OnceLock<Vec<PointLight>>; Component::ALL.len()],
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
        let sun_longitude_rad = sun_ecliptic.y.atan2(sun_ecliptic.x);
        Ok(Self {
            site,
            instant,
            solar_flux_sfu,
            positions,
            galactic_from_enu: positions.galactic_from_enu(),
            ecliptic_from_enu,
            sun_longitude_rad,
            towards_sun: [sun_longitude_rad.cos(), sun_longitude_rad.sin()],
            zodiacal_factor: zodiacal_light::distance_factor(positions.epoch.sun_distance_au()),
            sun,
            moon,
            planets: PlanetSeen::all(&positions),
            points: Default::default(),
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

    /// How Earth and observer are placed and turned.
    pub fn positions(&self) -> &Positions {
        &self.positions
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
    pub fn points(&self, component: Component) -> &[PointLight] {
        self.points[component.index()].get_or_init(|| self.find_points(component))
    }

    fn find_points(&self, component: Component) -> Vec<PointLight> {
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
                let ecliptic = self.ecliptic_from_enu * enu;
                let (longitude_rad, latitude_rad) = spherical(ecliptic);
                let from_sun_rad = longitude_rad - self.sun_longitude_rad;
                let s10 = zodiacal_light::table_s10(from_sun_rad.to_degrees(), latitude_rad.to_degrees())
                    * self.zodiacal_factor;
                let [cosine, sine] = self.towards_sun;
                zodiacal_colour(ecliptic.x * cosine + ecliptic.y * sine).map(|colour| s10 * colour)
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

/// Reddening at the nodes over that of the component's spectrum, for elongations to 30° and for those from 90° on.
static ZODIACAL_COLOURS: LazyLock<[[f64; NODE_COUNT]; 2]> = LazyLock::new(|| {
    [0.0, 180.0].map(|elongation_deg| {
        nodes_nm().map(|nm| {
            zodiacal_light::reddening(nm, elongation_deg)
                / zodiacal_light::reddening(nm, zodiacal_light::MEAN_ELONGATION_DEG)
        })
    })
});

/// The same for an elongation by its cosine; it is linear in between.
fn zodiacal_colour(cos_elongation: f64) -> [f64; NODE_COUNT] {
    let [near, far] = &*ZODIACAL_COLOURS;
    if cos_elongation <= 0.0 {
        return *far;
    }
    let part = zodiacal_light::far_part(cos_elongation.min(1.0).acos().to_degrees());
    std::array::from_fn(|node| near[node] + part * (far[node] - near[node]))
}

/// Longitude and latitude of a unit vector, rad.
fn spherical(vector: DVec3) -> (f64, f64) {
    (vector.y.atan2(vector.x), vector.z.clamp(-1.0, 1.0).asin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_physics::Response;

    fn heavens(latitude_deg: f64, longitude_deg: f64, unix_s: f64) -> Heavens {
        let site = Site::new(latitude_deg, longitude_deg, 0.0).unwrap();
        Heavens::new(site, Instant::from_unix_s(unix_s).unwrap(), 100.0).unwrap()
    }

    fn towards(enu: DVec3) -> Direction {
        direction_of(enu)
    }

    /// The galactic centre, the gegenschein and the zenith have the brightness that the tables have there.
    #[test]
    fn maps_lie_where_they_should() {
        let heavens = heavens(-24.6, -70.4, 1.782e9);
        let galactic = heavens.galactic_from_enu().transpose();
        let [plane, pole] = [DVec3::X, DVec3::Z]
            .map(|axis| heavens.radiance_outside(Component::Starlight, towards(galactic * axis))[0]);
        assert!((plane - 290.0).abs() < 1e-6 && (pole - 29.5).abs() < 1.0, "{plane} {pole}");
        let against_sun = -heavens.sun().position.enu_au.normalize();
        let gegenschein = heavens.radiance_outside(Component::ZodiacalLight, towards(against_sun));
        // 2026-06-21: 1.016 au from the Sun.
        let season = 1.016_f64.powf(-2.3);
        for (value, colour) in gegenschein.into_iter().zip(zodiacal_colour(-1.0)) {
            assert!((value / (180.0 * season * colour) - 1.0).abs() < 0.01, "{value}");
        }
        let airglow = heavens.radiance_outside(Component::Airglow, towards(DVec3::Z));
        assert!((airglow[0] - 133.0).abs() < 1e-9);
        assert_eq!(heavens.radiance_outside(Component::Stars, towards(DVec3::Z)), [0.0; NODE_COUNT]);
    }

    /// The darkest direction above 45°, outside the air: 21.9 with little solar activity, a quarter of a magnitude brighter with much.
    #[test]
    fn dark_skies_are_as_dark_as_they_are() {
        let site = Site::new(28.0, -18.0, 0.0).unwrap();
        let at = Instant::parse("2026-04-15T02:00:00Z").unwrap();
        let darkest = |solar_flux_sfu: f64| {
            let heavens = Heavens::new(site, at, solar_flux_sfu).unwrap();
            let luminance = |direction: Direction| -> f64 {
                let seen = |component: Component| {
                    let rule = component.light().rule(&Response::JohnsonV);
                    rule.value(heavens.radiance_outside(component, direction))
                };
                Component::EXTENDED.into_iter().map(seen).sum()
            };
            let directions = (0..1_620).map(|step| Direction {
                azimuth_rad: f64::from(step % 36 * 10).to_radians(),
                elevation_rad: f64::from(45 + step / 36).to_radians(),
            });
            let least = directions.map(luminance).fold(f64::INFINITY, f64::min);
            skyglow_physics::photometry::brightness_mag_arcsec2(least).unwrap()
        };
        let (quiet, active) = (darkest(70.0), darkest(220.0));
        assert!((21.8..22.1).contains(&quiet) && (21.5..21.75).contains(&active), "{quiet} {active}");
    }

    /// Points of light have the V that they say, and colours: Mars has less blue than the Moon's own unit.
    #[test]
    fn points_are_as_bright_as_they_say() {
        let heavens = heavens(40.0, 0.0, 1.782e9);
        for component in Component::BODIES {
            let rule = component.light().rule(&Response::JohnsonV);
            for point in heavens.points(component).iter().step_by(97) {
                let zero = crate::magnitudes::ZERO_MAGNITUDE_LX;
                let found = -2.5 * (rule.value(point.irradiance) / zero).log10();
                assert!((found - point.magnitude_v).abs() < 0.02, "{component:?}: {found} {point:?}");
            }
        }
        assert!(heavens.points(Component::Airglow).is_empty());
        assert!(Heavens::new(heavens.site(), heavens.instant(), 20.0).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Nothing jumps from one direction to the next, above the horizon and below.
        #[test]
        fn radiance_is_continuous(
            azimuth in 0.0..6.3_f64, elevation in -1.5..1.5_f64, day in 0.0..365.0_f64, latitude in -90.0..90.0_f64,
        ) {
            prop_assume!(elevation.abs() > 1e-3);
            let heavens = heavens(latitude, 10.0, 1.767e9 + day * 86_400.0);
            for component in Component::EXTENDED {
                let [one, two] = [0.0, 1e-5].map(|step| heavens.radiance_outside(
                    component, Direction { azimuth_rad: azimuth + step, elevation_rad: elevation + step }));
                for node in 0..NODE_COUNT {
                    let jump = (one[node] - two[node]).abs();
                    prop_assert!(one[node] >= 0.0 && jump <= 2e-3 * one[node], "{component:?} {jump}");
                }
            }
        }
    }
}
