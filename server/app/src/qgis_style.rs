//! How QGIS shows rasters: the styles of its plugin, with limits for one raster. QGIS takes `NAME.qml` beside `NAME.tif`.

use skyglow_observatory::MapMeasure;
use skyglow_physics::Response;
use std::fmt::Write;

/// Limits are cd m⁻², made for the zenith by the dark reference.
const BRIGHTNESS: &str = include_str!("../../../qgis/skyglow/styles/brightness.qml");
/// Limits are parts of a sky.
const INFLUENCE: &str = include_str!("../../../qgis/skyglow/styles/influence.qml");
/// Elements of a style and their attributes that hold values of the raster.
const SCALED: [(&str, &[&str]); 3] = [
    ("<item ", &["value"]),
    ("<colorrampshader ", &["minimumValue", "maximumValue"]),
    ("<rasterrenderer ", &["classificationMin", "classificationMax"]),
];

/// The style of a map of brightness: classes relative to what the response sees of the dark reference.
pub fn of_brightness(measure: MapMeasure, response: &Response) -> String {
    let made_for = MapMeasure::Zenith.natural_value(&Response::Photopic);
    scaled(BRIGHTNESS, measure.natural_value(response) / made_for)
}

/// The style of a raster of influences: classes by each pixel's part in the whole.
pub fn of_influence(total: f64) -> String {
    scaled(INFLUENCE, total)
}

/// A style whose values have a factor.
fn scaled(style: &str, factor: f64) -> String {
    let mut text = String::with_capacity(style.len());
    for line in style.lines() {
        let element = SCALED.iter().find(|(element, _)| line.trim_start().starts_with(element));
        let attributes = element.map_or(&[][..], |element| element.1);
        let mut line = line.to_owned();
        for attribute in attributes {
            let name = format!(" {attribute}=\"");
            let Some((before, rest)) = line.split_once(&name) else { continue };
            let Some((value, after)) = rest.split_once('"') else { continue };
            // The class above all others ends at `inf`.
            if let Some(value) = value.parse().ok().filter(|value: &f64| value.is_finite()) {
                line = format!("{before}{name}{:?}\"{after}", value * factor);
            }
        }
        // To a string it cannot fail.
        let _written = writeln!(text, "{line}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limits of the classes.
    fn limits(style: &str) -> Vec<f64> {
        let items = style.lines().filter_map(|line| line.trim_start().strip_prefix("<item "));
        items
            .map(|item| item.split("value=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap())
            .collect()
    }

    /// From a hundredth of the dark reference on, each class twice the one before, whatever the measure.
    #[test]
    fn brightness_goes_by_the_dark_reference() {
        for (measure, response) in [
            (MapMeasure::Zenith, Response::Photopic),
            (MapMeasure::Horizontal, Response::Photopic),
            (MapMeasure::Cylindrical, Response::Scotopic),
        ] {
            let natural = measure.natural_value(&response);
            let style = of_brightness(measure, &response);
            let limits = limits(&style);
            assert_eq!((limits.len(), limits[13]), (14, f64::INFINITY));
            for (class, limit) in limits[..13].iter().enumerate() {
                assert!((limit / (0.01 * natural * f64::from(1 << class)) - 1.0).abs() < 1e-6, "{class}");
            }
            let shader = style.lines().find(|line| line.contains("<colorrampshader ")).unwrap();
            let most = shader.split("maximumValue=\"").nth(1).unwrap().split('"').next().unwrap();
            assert!((most.parse::<f64>().unwrap() / limits[12] - 1.0).abs() < 1e-6, "{shader}");
            assert_eq!(style.lines().count(), BRIGHTNESS.lines().count());
        }
    }

    #[test]
    fn influences_go_by_their_sum() {
        let (parts, limits) = (limits(INFLUENCE), limits(&of_influence(2.0e-4)));
        assert!(parts.len() > 5 && parts.len() == limits.len());
        for (part, limit) in parts.iter().zip(&limits) {
            assert!(part.is_infinite() && limit.is_infinite() || (limit / part - 2.0e-4).abs() < 1e-12);
        }
        assert!((limits[limits.len() - 2] - 2.0e-6).abs() < 1e-12, "the last is one in a hundred");
    }
}
