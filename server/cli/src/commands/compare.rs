//! `skyglow compare`: measured skies beside the model.

use crate::{
    failure::Failure,
    flags::{JsonFlags, ProgramFlags},
    measurements::{Calibration, Compared, Reading, fit, read_ida},
    print,
    query::{self, QueryFlags},
    table::aligned,
};
use clap::Args;
use serde_json::{Value, json};
use skyglow_app::{
    SkySource,
    parameters::SkiesParameters,
    request::{self, MAX_SKIES, SkiesRequest},
    sky_lines::each_sky_line,
};
use skyglow_scene::SceneId;
use std::{path::PathBuf, sync::Arc};

/// Compare measured skies with the model's: residuals, and the calibration of the scene that fits them best
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow compare --scene demo --measurements station.dat --measurements other.dat --turbidity 3\n\n\
        Residuals are readings less model: positive where the sky is darker than the model's. The model is what a Sky Quality Meter\n\
        would read at the zenith there and then. Of one place alone the error of the factor is too small."
)]
pub(crate) struct Compare {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// Readings in the standard format for skyglow measurements (IDA/NSBM 1.0), as SQM and TESS loggers write them; several times for several
    #[arg(long, env = "SKYGLOW_MEASUREMENTS", value_name = "FILE", required = true)]
    measurements: Vec<PathBuf>,
    #[command(flatten)]
    query: QueryFlags<SkiesParameters>,
    #[command(flatten)]
    program: ProgramFlags,
    #[command(flatten)]
    json: JsonFlags,
}

/// A reading beside the model, or why there is no model of it.
struct Row {
    reading: Reading,
    compared: Result<Compared, String>,
}

impl Compare {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let mut readings = Vec::new();
        for path in &self.measurements {
            let bytes = std::fs::read(path).map_err(|error| Failure::file(path, error))?;
            let read =
                read_ida(&String::from_utf8_lossy(&bytes)).map_err(|error| Failure::file(path, error))?;
            readings.extend(read);
        }
        if readings.is_empty() {
            return Err(Failure::Work("there is no reading above 0 in what was measured".to_owned()));
        }
        let asked = |part: &[Reading], facts: &_| -> Result<SkiesRequest, Failure> {
            let places: Vec<Value> = part.iter().map(place).collect();
            let body = json!({ "places": places }).to_string();
            let query = Some(self.query.query());
            request::skies(query, body.as_bytes(), self.scene.clone(), facts).map_err(|e| query::failure(&e))
        };
        asked(&readings[..1], &self.program.facts())?;
        let source = self.program.source()?;
        let mut lines = Vec::new();
        for part in readings.chunks(MAX_SKIES) {
            lines.extend(lines_of(&source, &self.scene, asked(part, source.facts())?)?);
        }
        let rows: Vec<Row> =
            readings.into_iter().zip(&lines).map(|(reading, line)| row(reading, line)).collect();
        let compared: Vec<Compared> =
            rows.iter().filter_map(|row| row.compared.as_ref().ok()).copied().collect();
        let of_scene = lines.iter().find_map(|line| line["calibration"].as_f64()).unwrap_or(1.0);
        let fitted = fit(&compared, of_scene).map_err(|error| error.to_string());
        if self.json.json {
            let readings: Vec<Value> = rows.iter().map(json_of).collect();
            let (calibration, why_not) = (fitted.as_ref().ok(), fitted.as_ref().err());
            return print::print_json(
                &json!({"readings": readings, "calibration": calibration, "no_calibration": why_not}),
            );
        }
        print::print_line(aligned(&table(&rows)).trim_end())?;
        print::print_line("")?;
        match fitted {
            Ok(calibration) => print::print_line(aligned(&fit_rows(&calibration)).trim_end()),
            Err(why_not) => print::print_line(&format!("no calibration: {why_not}")),
        }
    }
}

/// A reading's place and time as the body of many skies has them.
fn place(reading: &Reading) -> Value {
    json!({"lat": reading.latitude_deg, "lon": reading.longitude_deg, "time": reading.time})
}

/// The answers of many skies, in their order.
fn lines_of(
    source: &Arc<dyn SkySource>,
    scene: &SceneId,
    asked: SkiesRequest,
) -> Result<Vec<Value>, Failure> {
    let failure = |error| query::failure(&error);
    let view = source.view(scene, asked.scenario.as_ref()).map_err(failure)?;
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_time().build().map_err(Failure::work)?;
    let mut lines = Vec::with_capacity(asked.skies.len());
    let take = async |_: f64, line: Vec<u8>| {
        lines.push(serde_json::from_slice::<Value>(&line));
        true
    };
    runtime.block_on(each_sky_line(source, &view, scene, asked.skies, take)).map_err(failure)?;
    lines.into_iter().collect::<Result<_, _>>().map_err(Failure::work)
}

fn row(reading: Reading, line: &Value) -> Row {
    let number = |name: &str| line["sky"][name].as_f64();
    let model = number("sqm_total_brightness_mag_arcsec2").zip(number("sqm_luminance_cd_m2"));
    let compared = model.map(|(model_mag_arcsec2, model_artificial_cd_m2)| Compared {
        latitude_deg: reading.latitude_deg,
        longitude_deg: reading.longitude_deg,
        brightness_mag_arcsec2: reading.brightness_mag_arcsec2,
        model_mag_arcsec2,
        model_artificial_cd_m2,
    });
    let said = || line["error"]["detail"].as_str().unwrap_or("the model has no light there").to_owned();
    Row { reading, compared: compared.ok_or_else(said) }
}

/// Under the names that the tables of the Python package have.
fn json_of(row: &Row) -> Value {
    let reading = &row.reading;
    let mut all = json!({
        "time": reading.time,
        "latitude_deg": reading.latitude_deg,
        "longitude_deg": reading.longitude_deg,
        "instrument": reading.instrument,
        "brightness_mag_arcsec2": reading.brightness_mag_arcsec2,
    });
    match &row.compared {
        Ok(compared) => {
            all["model_mag_arcsec2"] = compared.model_mag_arcsec2.into();
            all["model_artificial_cd_m2"] = compared.model_artificial_cd_m2.into();
            all["model_natural_cd_m2"] = compared.model_natural_cd_m2().into();
            all["residual_mag_arcsec2"] = compared.residual_mag_arcsec2().into();
        }
        Err(problem) => all["problem"] = problem.as_str().into(),
    }
    all
}

/// Magnitudes an arcsec², as the head of the table says.
fn table(rows: &[Row]) -> Vec<Vec<String>> {
    let head = ["time", "latitude", "longitude", "instrument", "measured", "model", "residual, mag arcsec-2"];
    let cells = |Row { reading, compared }: &Row| {
        let [model, residual] = match compared {
            Ok(compared) => {
                let residual = format!("{:+.2}", compared.residual_mag_arcsec2());
                [format!("{:.2}", compared.model_mag_arcsec2), residual]
            }
            Err(problem) => ["none".to_owned(), problem.clone()],
        };
        let [latitude, longitude] =
            [reading.latitude_deg, reading.longitude_deg].map(|deg| format!("{deg:.5}"));
        let measured = format!("{:.2}", reading.brightness_mag_arcsec2);
        vec![reading.time.clone(), latitude, longitude, reading.instrument.clone(), measured, model, residual]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(rows.iter().map(cells)).collect()
}

fn fit_rows(fitted: &Calibration) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let [low, high] = fitted.interval;
    vec![
        row("factor on the scene's light", format!("{:.3}, {low:.3} to {high:.3} (68 %)", fitted.factor)),
        row("to ingest the scene with", format!("--calibration {:.4}", fitted.calibration)),
        row(
            "residuals (root mean square)",
            format!("{:.3} mag before, {:.3} after", fitted.rms_before_mag, fitted.rms_after_mag),
        ),
        row("of", format!("{} readings at {} places", fitted.readings, fitted.places)),
    ]
}
