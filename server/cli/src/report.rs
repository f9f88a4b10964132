//! A scene's ingest report as lines of a table.

use skyglow_scene::{Confidence, PixelCount, SceneMetadata};

/// Name and value of each line, indented; counts of nothing are left out.
pub(crate) fn rows(scene: &SceneMetadata) -> Vec<Vec<String>> {
    let report = &scene.report;
    let [west, south, east, north] = scene.bounds;
    let mut rows = Rows::default();
    if scene.illustrative {
        rows.add("note", "illustrative: made-up light, not a measurement");
    }
    rows.add("bounds", format!("{west:.4} {south:.4} {east:.4} {north:.4} degrees (west south east north)"));
    rows.add(
        "grid",
        format!(
            "{} x {} pixels of {:.0} m, {}",
            scene.grid.width, scene.grid.height, scene.pixel_size_m, scene.crs
        ),
    );
    if !report.files.is_empty() {
        rows.add("files", format!("{}: {}", report.files.len(), report.files.join(", ")));
    }
    rows.add("read", format!("{}, times {}", report.band, report.scale));
    for entry in &report.recognised {
        let sure = match entry.confidence {
            Confidence::Certain => "certain",
            Confidence::Likely => "likely",
            Confidence::Assumed => "assumed",
        };
        rows.add(&entry.what, format!("{} ({sure})", entry.value));
    }
    if report.offset_nw_cm2_sr != 0.0 {
        rows.add("offset", format!("{} nW cm-2 sr-1", report.offset_nw_cm2_sr));
    }
    rows.add(
        "range",
        format!(
            "{:.3} to {:.3} nW cm-2 sr-1, {:.3} in the mean over the lit",
            report.minimum_nw_cm2_sr, report.maximum_nw_cm2_sr, report.lit_mean_nw_cm2_sr
        ),
    );
    rows.add("flux", format!("{:.4e} W (DNB), calibration {}", report.flux_dnb_w, scene.calibration));
    rows.add("lit", pixels(&report.lit, false));
    rows.count("zero", &report.zero, false);
    rows.count("negative", &report.negative, true);
    rows.count("NaN", &report.nan, true);
    rows.count("infinite", &report.infinite, true);
    rows.count("no data", &report.no_data, false);
    rows.count("fill values", &report.fill, true);
    rows.count("quality too low", &report.rejected, false);
    rows.count("capped", &report.capped, true);
    rows.count("off the Earth", &report.outside_world, true);
    match &report.terrain {
        None => rows.add("terrain", "none: every lamp and observer at sea level"),
        Some(terrain) => {
            let range = format!("{:.0} to {:.0} m", terrain.minimum_m, terrain.maximum_m);
            rows.add(
                "terrain",
                format!("{range} in {} file(s), under {} lit pixels", terrain.files, terrain.covered),
            );
            rows.count("terrain near by", &terrain.nearest, true);
            rows.count("terrain missing", &terrain.missing, true);
        }
    }
    if scene.land_cover {
        rows.add("land cover", "pictures light the ground by it");
    }
    if scene.places_count > 0 {
        let source = scene.places_source.as_ref().map_or(String::new(), |source| format!(" ({source})"));
        rows.add("places", format!("{}{source}", scene.places_count));
    }
    for (name, value) in [("taken", &scene.date), ("attribution", &scene.attribution)] {
        if let Some(value) = value {
            rows.add(name, value);
        }
    }
    for warning in &report.warnings {
        rows.add("warning", warning);
    }
    rows.0
}

#[derive(Default)]
struct Rows(Vec<Vec<String>>);

impl Rows {
    fn add(&mut self, name: &str, value: impl Into<String>) {
        self.0.push(vec![format!("  {name}"), value.into()]);
    }

    fn count(&mut self, name: &str, count: &PixelCount, with_places: bool) {
        if count.count > 0 {
            self.add(name, pixels(count, with_places));
        }
    }
}

fn pixels(count: &PixelCount, with_places: bool) -> String {
    let mut text = format!("{} pixels", count.count);
    if with_places && !count.examples.is_empty() {
        let places: Vec<String> = count
            .examples
            .iter()
            .map(|place| format!("{:.4} {:.4}", place.latitude_deg, place.longitude_deg))
            .collect();
        text.push_str(&format!(", such as at {}", places.join(", ")));
    }
    text
}
