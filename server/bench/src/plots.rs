//! The report as plots, in the manner of the paper's Fig. 6: run time against lit cells and against basis size, error
//! against basis size and against run time. Both axes are logarithmic.

use crate::{
    error::BenchError,
    report::{ErrorRow, Report, RunTimeRow},
};
use plotters::{
    backend::SVGBackend,
    chart::ChartBuilder,
    drawing::IntoDrawingArea,
    element::{Circle, PathElement, Text},
    prelude::IntoLogRange,
    series::LineSeries,
    style::{BLACK, Color, RGBColor, WHITE},
};
use std::{ops::Range, path::Path};

/// Width and height, pixels.
const SIZE: (u32, u32) = (900, 480);
/// Width of it that the legend takes.
const LEGEND_WIDTH: i32 = 220;
/// Height of a line of the legend.
const LEGEND_LINE: i32 = 20;
/// Colours that readers who see no red or no green tell apart (Okabe and Ito 2008).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(110, 110, 110),
    RGBColor(0, 0, 0),
];

/// One curve.
#[derive(Clone, Debug, PartialEq)]
struct Curve {
    name: String,
    /// Both above 0. Lines go from one to the next: from few lights to many, from small bases to large ones.
    points: Vec<(f64, f64)>,
}

/// A plot without its file.
struct Plot {
    file: &'static str,
    title: String,
    x: &'static str,
    y: &'static str,
    curves: Vec<Curve>,
}

impl Curve {
    /// Points that a logarithmic plot can show, in the order of the rows; None where there are none.
    fn of(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let points: Vec<(f64, f64)> =
            points.into_iter().filter(|point| point.0 > 0.0 && point.1 > 0.0).collect();
        (!points.is_empty()).then(|| Self { name: name.into(), points })
    }
}

/// Draws every plot that the report has rows for into a folder.
///
/// # Errors
/// [`BenchError::Plot`] naming the file.
pub(crate) fn draw(report: &Report, folder: &Path) -> Result<(), BenchError> {
    for plot in plots(report).into_iter().filter(|plot| !plot.curves.is_empty()) {
        let path = folder.join(plot.file);
        let mut text = String::new();
        plot.draw(&mut text).map_err(|reason| BenchError::Plot { path: path.clone(), reason })?;
        std::fs::write(&path, text).map_err(BenchError::file(&path))?;
    }
    Ok(())
}

fn plots(report: &Report) -> [Plot; 4] {
    let machine = format!("{}, {} threads", report.machine.processor, report.machine.threads);
    [
        Plot {
            file: "time-against-lights.svg",
            title: format!("Run time of a panorama, fastest rounds ({machine})"),
            x: "lit cells; from 10 000 on pixels of a raster",
            y: "milliseconds",
            curves: against_lights(report),
        },
        Plot {
            file: "time-against-basis.svg",
            title: format!("Run time by basis size, fastest rounds ({machine})"),
            x: "functions of the basis",
            y: "milliseconds",
            curves: against_basis(report),
        },
        Plot {
            file: "error-against-basis.svg",
            title: "Mean relative error by basis size".to_owned(),
            x: "functions of the basis",
            y: "percent",
            curves: errors(report, |row| Some(row.basis_count as f64)),
        },
        Plot {
            file: "error-against-time.svg",
            title: format!("Mean relative error by run time, fastest rounds ({machine})"),
            x: "milliseconds",
            y: "percent",
            curves: errors(report, |row| row.fastest_ms),
        },
    ]
}

fn against_lights(report: &Report) -> Vec<Curve> {
    let of_one_pack = report.run_times.iter().filter(|row| row.packs == 1);
    let largest = of_one_pack.map(|row| row.basis_count).max().unwrap_or(0);
    let mut curves = Vec::new();
    for executor in report.executors.iter().map(|executor| &executor.executor) {
        let rows = |skipping: bool| {
            let wanted = move |row: &&RunTimeRow| {
                row.skipping == skipping && row.packs == 1 && row.basis_count == largest
            };
            let rows = report.run_times.iter().filter(move |row| row.executor == *executor).filter(wanted);
            rows.map(|row| (row.lit_sources as f64, row.fastest_ms))
        };
        curves.extend(Curve::of(format!("{executor}, {largest} functions"), rows(true)));
        curves.extend(Curve::of(format!("{executor}, nothing skipped"), rows(false)));
    }
    let baseline = |name: &str, seconds: &dyn Fn(usize) -> f64| {
        let scenes = report.scenes.iter().enumerate();
        Curve::of(name, scenes.map(|(index, scene)| (scene.lit_sources as f64, 1e3 * seconds(index))))
    };
    let whole =
        |index: usize| report.scenes[index].image_mixing.seconds + report.scenes[index].accumulation.seconds;
    curves.extend(baseline("accumulation of images", &whole));
    curves
        .extend(baseline("images ready for this place", &|index| report.scenes[index].accumulation.seconds));
    curves.extend(baseline("direct sum (scaled)", &|index| report.scenes[index].direct_sum.seconds));
    curves
}

fn against_basis(report: &Report) -> Vec<Curve> {
    let mut curves = Vec::new();
    for executor in report.executors.iter().map(|executor| &executor.executor) {
        for scene in ["cells", "raster"] {
            let sources = report.scenes.iter().filter(|row| row.scene == scene).map(|row| row.lit_sources);
            let Some(most) = sources.max() else { continue };
            let wanted = |row: &&RunTimeRow| {
                row.executor == *executor
                    && (row.scene == scene && row.lit_sources == most)
                    && (row.skipping && row.packs == 1)
            };
            let rows = report.run_times.iter().filter(wanted);
            let name = format!("{executor}, {scene} {most}");
            curves.extend(Curve::of(name, rows.map(|row| (row.basis_count as f64, row.fastest_ms))));
        }
    }
    curves
}

/// One curve for each sky, by the first executor: all of them compute the same sky.
fn errors(report: &Report, x: impl Fn(&ErrorRow) -> Option<f64>) -> Vec<Curve> {
    let Some(executor) = report.executors.first() else { return Vec::new() };
    let rows = || report.errors.iter().filter(|row| row.executor == executor.executor);
    let mut skies: Vec<(&str, f64)> = rows().map(|row| (row.scene.as_str(), row.turbidity)).collect();
    skies.dedup();
    let curve = |(scene, turbidity): (&str, f64)| {
        let of_sky = rows().filter(|row| (row.scene.as_str(), row.turbidity) == (scene, turbidity));
        let points = of_sky.filter_map(|row| Some((x(row)?, 100.0 * row.mean)));
        Curve::of(format!("{scene}, T = {turbidity}"), points)
    };
    skies.into_iter().filter_map(curve).collect()
}

/// Whole decades around values.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let Range { start, end } = around(values);
    10f64.powf(start.log10().floor())..10f64.powf(end.log10().ceil())
}

/// A range around values, a fifth wider at both ends.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0f64), |(low, high), value| (low.min(value), high.max(value)));
    low / 1.2..high * 1.2
}

impl Plot {
    /// Draws into an SVG text; the error says what the drawing library says.
    fn draw(&self, text: &mut String) -> Result<(), String> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let (x, y) = (around(points().map(|point| point.0)), decades(points().map(|point| point.1)));
        let words = |error: &dyn std::fmt::Display| error.to_string();
        let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(|error| words(&error))?;
        let (graph, legend) = area.split_horizontally(SIZE.0 as i32 - LEGEND_WIDTH);
        let mut chart = ChartBuilder::on(&graph)
            .caption(&self.title, ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(64)
            .build_cartesian_2d(x.log_scale(), y.log_scale())
            .map_err(|error| words(&error))?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .axis_desc_style(("sans-serif", 14))
            .label_style(("sans-serif", 12))
            .x_label_formatter(&tick)
            .y_label_formatter(&tick)
            .light_line_style(BLACK.mix(0.06))
            .draw()
            .map_err(|error| words(&error))?;
        for (index, (curve, colour)) in self.curves.iter().zip(COLOURS.iter().cycle()).enumerate() {
            let line = LineSeries::new(curve.points.iter().copied(), colour.stroke_width(2));
            chart.draw_series(line).map_err(|error| words(&error))?;
            let marks = curve.points.iter().map(|&point| Circle::new(point, 3, colour.filled()));
            chart.draw_series(marks).map_err(|error| words(&error))?;
            let y = 50 + LEGEND_LINE * index as i32;
            let sample = PathElement::new([(0, y + 6), (18, y + 6)], colour.stroke_width(2));
            legend.draw(&sample).map_err(|error| words(&error))?;
            let name = Text::new(curve.name.as_str(), (24, y), ("sans-serif", 12));
            legend.draw(&name).map_err(|error| words(&error))?;
        }
        area.present().map_err(|error| words(&error))
    }
}

/// A value at an axis.
fn tick(value: &f64) -> String {
    if *value >= 1e4 { format!("{value:.0e}") } else { format!("{}", (value * 1e6).round() / 1e6) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve holds what a logarithmic plot can show in the order of its rows.
    #[test]
    fn curves_hold_positive_points_in_row_order() {
        let curve = Curve::of("a", [(4.0, 2.0), (0.0, 1.0), (1.0, 3.0), (2.0, 0.0)]).unwrap();
        assert_eq!(curve.points, [(4.0, 2.0), (1.0, 3.0)]);
        assert_eq!(Curve::of("dark", [(1.0, 0.0)]), None);
    }

    /// A plot is an SVG with its words and a mark for every point.
    #[test]
    fn plots_are_svgs_with_every_point() {
        let curve = |name: &str, points: &[(f64, f64)]| Curve::of(name, points.iter().copied()).unwrap();
        let draw = |curves: Vec<Curve>| {
            let plot = Plot { file: "a.svg", title: "the title".to_owned(), x: "lights", y: "ms", curves };
            let mut text = String::new();
            plot.draw(&mut text).unwrap();
            text
        };
        let text = draw(vec![curve("fast", &[(1.0, 2.0), (8.0, 3.0)]), curve("slow", &[(1.0, 9.0)])]);
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        for word in ["the title", "lights", "ms", "fast", "slow"] {
            assert!(text.contains(word), "{word}");
        }
        assert_eq!(text.matches("<circle").count(), 3);
        assert_eq!(draw(vec![curve("fast", &[(1.0, 2.0)])]).matches("<circle").count(), 1);
    }
}
