//! Stars, planets, Moon and Sun as they stand before the sky: where refraction lifts them, and what the air lets through.

use super::NightSky;
use skyglow_celestial::{Component, PointLight, ephemeris::refraction_deg};
use skyglow_physics::{BAND_COUNT, Direction, ELEVATION_COUNT, SKY_RESPONSES};
use std::f64::consts::{FRAC_PI_2, PI};

/// A star or planet as it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPoint {
    /// Where, refraction included; above the horizontal plane.
    pub direction: Direction,
    /// Illuminance across its beam through the air, lx, by [`SKY_RESPONSES`].
    pub illuminance_lx: [f64; SKY_RESPONSES.len()],
}

/// Moon or Sun as it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenDisc {
    /// Its middle and light.
    pub point: SeenPoint,
    /// Angle across, rad.
    pub diameter_rad: f64,
    /// Lit part of the disc, 0..=1.
    pub lit_share: f64,
    /// Direction of the bright limb, radians from up towards growing azimuth.
    pub bright_limb_rad: f64,
    /// Luminance of the dark part over that of the lit one.
    pub dark_ratio: f64,
}

impl SeenDisc {
    /// Mean luminance of the lit part, cd m⁻², by [`SKY_RESPONSES`].
    pub fn lit_cd_m2(&self) -> [f64; SKY_RESPONSES.len()] {
        let radius_rad = 0.5 * self.diameter_rad;
        let lit_sr = PI * radius_rad * radius_rad * self.lit_share.max(1e-4);
        self.point.illuminance_lx.map(|lx| lx / lit_sr)
    }
}

impl NightSky {
    /// Stars and planets above the horizontal plane; none while their light does not count.
    pub fn points(&self) -> Vec<SeenPoint> {
        let counts = |component: &Component| self.components().iter().any(|sky| sky.component == *component);
        let [planets, stars] = [Component::Planets, Component::Stars].map(|component| {
            let counts = component == Component::Planets || counts(&component);
            if counts { self.seen_points(component) } else { Vec::new() }
        });
        [planets, stars].concat()
    }

    /// Moon and Sun where they stand above the horizontal plane.
    pub fn discs(&self) -> Vec<SeenDisc> {
        let (sun, moon) = (self.heavens().sun(), self.heavens().moon());
        let point = |component: Component| self.seen_points(component).first().copied();
        // Light of the Earth covers the whole disc, that of the Sun the lit part alone.
        let earthshine = 10f64.powf(-0.4 * (moon.earthshine_magnitude_v - moon.magnitude_v));
        let of_moon = point(Component::Moon).map(|point| SeenDisc {
            point,
            diameter_rad: moon.diameter_rad,
            lit_share: moon.illuminated_fraction,
            // Counterclockwise for who looks at it; azimuth grows clockwise.
            bright_limb_rad: -moon.bright_limb_from_zenith_rad,
            dark_ratio: (earthshine * moon.illuminated_fraction).min(1.0),
        });
        let of_sun = point(Component::Sun).map(|point| SeenDisc {
            point,
            diameter_rad: sun.diameter_rad,
            lit_share: 1.0,
            bright_limb_rad: 0.0,
            dark_ratio: 1.0,
        });
        of_moon.into_iter().chain(of_sun).collect()
    }

    /// Points of a component above the horizontal plane.
    fn seen_points(&self, component: Component) -> Vec<SeenPoint> {
        let rules = SKY_RESPONSES.each_ref().map(|response| component.light().rule(response));
        let seen = |point: &PointLight| {
            let (direction, through) = self.through(point)?;
            let illuminance_lx = rules.each_ref().map(|rule| rule.value(through));
            Some(SeenPoint { direction, illuminance_lx })
        };
        self.heavens().points(component).iter().filter_map(seen).collect()
    }

    /// Where a point is seen, and its irradiance there at the nodes; None below the horizontal plane.
    fn through(&self, point: &PointLight) -> Option<(Direction, [f64; BAND_COUNT])> {
        let true_deg = point.direction.elevation_rad.to_degrees();
        let elevation_rad =
            (true_deg + refraction_deg(true_deg, self.heavens().site().altitude_m())).to_radians();
        if elevation_rad < 0.0 {
            return None;
        }
        let row = (elevation_rad / FRAC_PI_2 * ELEVATION_COUNT as f64 - 0.5)
            .clamp(0.0, ELEVATION_COUNT as f64 - 1.0);
        let (low, part) = (row as usize, row.fract());
        let high = (low + 1).min(ELEVATION_COUNT - 1);
        let through = std::array::from_fn(|band| {
            let at = |row: usize| self.transmittance[row][band];
            point.irradiance[band] * (at(low) + part * (at(high) - at(low)))
        });
        Some((Direction { elevation_rad, ..point.direction }, through))
    }
}

#[cfg(test)]
mod tests {
    use crate::night_sky::{skipping::Skipping, tests::sky};
    use skyglow_celestial::Component;
    use skyglow_physics::Horizon;

    /// By night there are stars above the horizon, brighter high up than their catalogue says of the air; by day there are none, and the
    /// Sun is a disc of half a degree.
    #[test]
    fn stars_are_there_by_night_and_the_sun_by_day() {
        let [night, day] = ["2026-08-12T23:00:00Z", "2026-06-21T11:50:00Z"]
            .map(|utc| sky(utc, &Horizon::flat(), Skipping::OfWhatDoesNotCount));
        let points = night.points();
        assert!((2_000..6_000).contains(&points.len()), "{}", points.len());
        let outside = night.heavens().points(Component::Stars);
        let brightest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let seen = brightest(&mut points.iter().map(|point| point.illuminance_lx[1]));
        let above = outside.iter().filter(|point| point.direction.elevation_rad > 0.0);
        let catalogue = brightest(&mut above.map(|point| 2.54e-6 * 10f64.powf(-0.4 * point.magnitude_v)));
        assert!(seen > 0.3 * catalogue && seen < 3.0 * catalogue, "{seen} {catalogue}");
        // Planets alone are left by day.
        assert!(day.points().len() <= 7);
        let sun = day.discs().pop().unwrap();
        assert!((sun.diameter_rad.to_degrees() - 0.525).abs() < 0.01 && sun.lit_cd_m2()[1] > 1e8, "{sun:?}");
    }
}
