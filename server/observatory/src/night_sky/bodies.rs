//! Stars, planets, Moon and Sun as they stand before the sky: where refraction lifts them, and what the air lets through.

use super::{NightSky, ThroughAir};
use skyglow_celestial::Component;
use skyglow_physics::{Direction, Response, SKY_RESPONSES};
use std::f64::consts::PI;

/// A star or planet as it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPoint {
    /// Where, refraction included; above the horizon.
    pub direction: Direction,
    /// Illuminance across its beam through the air, lx, by [`SKY_RESPONSES`].
    pub illuminance_lx: [f64; SKY_RESPONSES.len()],
    /// V that the naked eye's limit is compared with: outside the air, and what the air takes more than at the zenith.
    pub limit_mag: f64,
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
    /// Stars and planets above the horizon; no stars while their light does not count.
    pub fn points(&self) -> Vec<SeenPoint> {
        [Component::Planets, Component::Stars].map(|component| self.seen_points(component)).concat()
    }

    /// Moon and Sun where they stand above the horizon.
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

    /// Points of a component above the horizon: where, and what a response sees across the beam of each, in its unit times sr.
    pub(crate) fn beams_of(&self, component: Component, response: &Response) -> Vec<(Direction, f64)> {
        let rule = component.light().rule(response);
        let points = self.points[component.index()].iter();
        points.map(|point| (point.direction, rule.value(point.irradiance))).collect()
    }

    /// Points of a component above the horizon.
    fn seen_points(&self, component: Component) -> Vec<SeenPoint> {
        let rules = SKY_RESPONSES.each_ref().map(|response| component.light().rule(response));
        let seen = |point: &ThroughAir| SeenPoint {
            direction: point.direction,
            illuminance_lx: rules.each_ref().map(|rule| rule.value(point.irradiance)),
            limit_mag: point.magnitude_v + self.more_extinction_mag(point.direction.nearest_sample().0),
        };
        self.points[component.index()].iter().map(seen).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::night_sky::{skipping::Skipping, tests::sky};
    use skyglow_celestial::Component;
    use skyglow_physics::{AZIMUTH_COUNT, Horizon, photometry::naked_eye_limit_mag};

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
        // A picture shows as many as are counted; refraction lifts a few over the horizon.
        let total_cd_m2 = night.seen().plane(1);
        let shown = night.seen_points(Component::Stars).into_iter().filter(|star| {
            let (row, column) = star.direction.nearest_sample();
            star.limit_mag <= naked_eye_limit_mag(f64::from(total_cd_m2[row * AZIMUTH_COUNT + column]))
        });
        let counted = night.seen_stars(total_cd_m2, &Horizon::flat(), |_, sky| sky).count.visible as usize;
        assert!(shown.count().abs_diff(counted) < counted / 50, "{counted}");
        // Planets alone are left by day.
        assert!(day.points().len() <= 7);
        let sun = day.discs().pop().unwrap();
        assert!((sun.diameter_rad.to_degrees() - 0.525).abs() < 0.01 && sun.lit_cd_m2()[1] > 1e8, "{sun:?}");
    }
}
