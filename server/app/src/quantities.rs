//! The numbers of a sky under their names, for formats that describe each of them.

use skyglow_observatory::MapMeasure;
use skyglow_physics::{SkyQuantities, photometry::brightness_mag_arcsec2};

/// A number of a sky.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// Its name, which is that of the answer of a sky.
    pub name: &'static str,
    /// What it is, in a few words.
    pub label: &'static str,
    /// What it means.
    pub description: &'static str,
    /// Its unit.
    pub unit: Unit,
    value: fn(&SkyQuantities) -> Option<f64>,
}

/// A unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Its name.
    pub label: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Whether that is a symbol of the Unified Code for Units of Measure (UCUM), which has no magnitudes.
    pub is_ucum: bool,
}

impl Unit {
    const fn ucum(label: &'static str, symbol: &'static str) -> Self {
        Self { label, symbol, is_ucum: true }
    }
}

const LUMINANCE: Unit = Unit::ucum("candela per square metre", "cd/m2");
const ILLUMINANCE: Unit = Unit::ucum("lux", "lx");
const DEGREE: Unit = Unit::ucum("degree", "deg");
const RATIO: Unit = Unit::ucum("ratio", "1");
const KELVIN: Unit = Unit::ucum("kelvin", "K");
const SURFACE_BRIGHTNESS: Unit =
    Unit { label: "magnitude per square arcsecond", symbol: "mag/arcsec2", is_ucum: false };
const MAGNITUDE: Unit = Unit { label: "magnitude", symbol: "mag", is_ucum: false };

macro_rules! quantities {
    ($($name:ident, $label:literal, $unit:expr, $description:literal, $value:expr;)*) => {
        /// The numbers of a sky that are one number each.
        pub const SKY_QUANTITIES: &[Quantity] = &[$(Quantity {
            name: stringify!($name), label: $label, description: $description, unit: $unit, value: $value,
        }),*];
    };
}

quantities! {
    zenith_luminance_cd_m2, "Artificial luminance at the zenith", LUMINANCE,
        "Mean within 5 degrees of the zenith, artificial light alone", |sky| Some(sky.zenith_luminance_cd_m2);
    zenith_brightness_mag_arcsec2, "Artificial brightness at the zenith", SURFACE_BRIGHTNESS,
        "Mean within 5 degrees of the zenith, artificial light alone, in magnitudes: larger is darker", |sky| sky.zenith_brightness_mag_arcsec2;
    zenith_total_luminance_cd_m2, "Luminance at the zenith", LUMINANCE,
        "With the natural sky: that of datetime, or without it the dark reference", |sky| Some(sky.zenith_total_luminance_cd_m2);
    zenith_total_brightness_mag_arcsec2, "Brightness at the zenith", SURFACE_BRIGHTNESS,
        "With the natural sky, in magnitudes: larger is darker", |sky| sky.zenith_total_brightness_mag_arcsec2;
    ratio_to_natural, "Artificial over natural luminance at the zenith", RATIO,
        "Artificial luminance at the zenith over the natural one", |sky| Some(sky.ratio_to_natural);
    sqm_luminance_cd_m2, "Luminance for a Sky Quality Meter", LUMINANCE,
        "The luminance of the magnitude that a Sky Quality Meter at the zenith would read of artificial light alone",
        |sky| Some(sky.sqm_luminance_cd_m2);
    sqm_total_brightness_mag_arcsec2, "Reading of a Sky Quality Meter", SURFACE_BRIGHTNESS,
        "What a Sky Quality Meter at the zenith reads with the natural sky", |sky| sky.sqm_total_brightness_mag_arcsec2;
    mean_luminance_cd_m2, "Mean artificial luminance of the sky", LUMINANCE,
        "Mean over the visible sky, artificial light alone", |sky| Some(sky.mean_luminance_cd_m2);
    horizontal_illuminance_lx, "Horizontal illuminance by artificial light", ILLUMINANCE,
        "On level ground, by the visible sky, artificial light alone", |sky| Some(sky.horizontal_illuminance_lx);
    horizontal_total_illuminance_lx, "Horizontal illuminance", ILLUMINANCE,
        "With the natural sky, and what comes straight from Sun, Moon, planets and stars", |sky| Some(sky.horizontal_total_illuminance_lx);
    brightest_luminance_cd_m2, "Largest artificial luminance", LUMINANCE,
        "The largest luminance of the visible sky, artificial light alone", |sky| Some(sky.brightest_luminance_cd_m2);
    brightest_azimuth_deg, "Azimuth of the largest luminance", DEGREE,
        "Clockwise from north", |sky| Some(sky.brightest_azimuth_deg);
    brightest_elevation_deg, "Elevation of the largest luminance", DEGREE,
        "Above the horizontal plane", |sky| Some(sky.brightest_elevation_deg);
    bortle_class, "Bortle class", RATIO,
        "1 (darkest) to 9, by how much brighter artificial light makes the zenith than the dark reference, whatever the time", |sky| sky.bortle_class.map(f64::from);
    naked_eye_limit_mag, "Naked-eye limiting magnitude", MAGNITUDE,
        "The faintest star at the zenith that an eye sees (Crumey 2014, F = 2)", |sky| sky.naked_eye_limit_mag;
    zenith_scotopic_luminance_cd_m2, "Artificial scotopic luminance at the zenith", LUMINANCE,
        "What the dark-adapted eye sees within 5 degrees of the zenith, artificial light alone",
        |sky| Some(sky.zenith_scotopic_luminance_cd_m2);
    zenith_colour_temperature_k, "Colour temperature at the zenith", KELVIN,
        "Correlated colour temperature of the artificial light at the zenith", |sky| sky.zenith_colour_temperature_k;
}

impl Quantity {
    /// Its value; None where the sky has none.
    pub fn of(&self, sky: &SkyQuantities) -> Option<f64> {
        (self.value)(sky).filter(|value| value.is_finite())
    }

    /// The number of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SKY_QUANTITIES.iter().find(|quantity| quantity.name == name)
    }
}

/// A number that a map of brightness has at every place.
#[derive(Clone, Copy, Debug)]
pub struct MapQuantity {
    /// Its name, which is that of a number of a sky.
    pub name: &'static str,
    /// The map that has it.
    pub measure: MapMeasure,
    of_map: fn(f64) -> Option<f64>,
}

/// All of them.
pub const MAP_QUANTITIES: &[MapQuantity] = &[
    MapQuantity { name: "zenith_luminance_cd_m2", measure: MapMeasure::Zenith, of_map: Some },
    MapQuantity {
        name: "zenith_brightness_mag_arcsec2",
        measure: MapMeasure::Zenith,
        of_map: brightness_mag_arcsec2,
    },
    MapQuantity { name: "mean_luminance_cd_m2", measure: MapMeasure::Mean, of_map: Some },
    MapQuantity { name: "horizontal_illuminance_lx", measure: MapMeasure::Horizontal, of_map: Some },
];

impl MapQuantity {
    /// Its value from that of the map.
    pub fn of(&self, of_map: f64) -> Option<f64> {
        (self.of_map)(of_map).filter(|value| value.is_finite())
    }

    /// What it is.
    pub fn quantity(&self) -> Option<&'static Quantity> {
        Quantity::named(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Names are those of the answer of a sky, and each is there once.
    #[test]
    fn quantities_have_the_names_of_answers() {
        let names: HashSet<&str> = SKY_QUANTITIES.iter().map(|quantity| quantity.name).collect();
        assert_eq!(names.len(), SKY_QUANTITIES.len());
        for quantity in MAP_QUANTITIES {
            assert!(quantity.quantity().is_some(), "{}", quantity.name);
        }
        assert!(Quantity::named("zenith").is_none());
        // Dimmer is a larger magnitude; no light has none.
        let magnitude = MAP_QUANTITIES[1];
        assert!(magnitude.of(1e-4) > magnitude.of(1e-3));
        assert_eq!((magnitude.of(0.0), MAP_QUANTITIES[0].of(0.0)), (None, Some(0.0)));
    }
}
