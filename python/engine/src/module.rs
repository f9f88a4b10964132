//! The Python module: one class that answers addresses.

use crate::{
    answers::{Answers, Question},
    map_parts::MapQuestion,
    waiting::beside_python,
};
use pyo3::{
    create_exception,
    exceptions::{PyException, PyOSError, PyRuntimeError, PyValueError},
    prelude::*,
    types::PyBytes,
};
use skyglow_app::problem::LineError;
use skyglow_display::{Notes, tile::brightness_map_png};
use skyglow_render::DeviceChoice;
use skyglow_scene::{PlaceWindow, SceneStore, create_demo, demo_is_wanted};
use std::{
    path::PathBuf,
    process,
    sync::atomic::{AtomicBool, Ordering},
};

create_exception!(
    skyglow_engine,
    RefusedError,
    PyException,
    "Why there is no answer; its one argument is a problem document (RFC 9457) as JSON text."
);

/// An engine with its table packs, before the scenes of a folder.
#[pyclass(frozen, module = "skyglow_engine")]
struct Engine {
    answers: Option<Answers>,
    /// The process whose threads it has: those of a process that forked are not in the other one.
    process: u32,
}

impl Engine {
    fn answers(&self) -> PyResult<&Answers> {
        match &self.answers {
            Some(answers) if self.process == process::id() => Ok(answers),
            _ => Err(PyRuntimeError::new_err(
                "this engine belongs to the process that made it, and this one was forked from that: make an engine in each \
                 process, or start processes by multiprocessing's \"spawn\"",
            )),
        }
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        if self.process != process::id() {
            // Its threads are not here: to wait for them would take for ever.
            std::mem::forget(self.answers.take());
        }
    }
}

fn refused(problem: &LineError) -> PyErr {
    match serde_json::to_string(problem) {
        Ok(document) => RefusedError::new_err(document),
        Err(error) => PyRuntimeError::new_err(error.to_string()),
    }
}

#[pymethods]
impl Engine {
    #[new]
    fn open(py: Python<'_>, packs: PathBuf, data: PathBuf, device: &str) -> PyResult<Self> {
        let choice = DeviceChoice::from_name(device).ok_or_else(|| {
            PyValueError::new_err(format!("device={device:?}: allowed are auto, gpu, lavapipe, cpu"))
        })?;
        let opened = beside_python(py, |_| Answers::open(&packs, &data, choice))?;
        let answers = opened.map_err(|error| PyOSError::new_err(error.to_string()))?;
        Ok(Self { answers: Some(answers), process: process::id() })
    }

    /// What the HTTP interface answers a GET at an address, or with a body a POST: the same bytes.
    #[pyo3(signature = (address, query = "", body = None))]
    fn answer<'py>(
        &self,
        py: Python<'py>,
        address: &str,
        query: &str,
        body: Option<&[u8]>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let answers = self.answers()?;
        let question = Question { address, query, body };
        let watched = |goes_on: &AtomicBool| answers.answer(&question, &|_| goes_on.load(Ordering::Relaxed));
        match beside_python(py, watched)? {
            Ok(bytes) => Ok(PyBytes::new(py, &bytes)),
            Err(problem) => Err(refused(&problem)),
        }
    }

    /// What a map of brightness will be, as JSON, and which of its places lie within bounds; nothing of it is found.
    #[pyo3(signature = (scene, query, places, bounds = None))]
    fn map_frame(
        &self,
        py: Python<'_>,
        scene: &str,
        query: &str,
        places: u32,
        bounds: Option<[f64; 4]>,
    ) -> PyResult<String> {
        let answers = self.answers()?;
        let question = MapQuestion { scene, query, places };
        let framed = beside_python(py, |_| answers.map_frame(&question, bounds))?;
        framed.map_err(|problem| refused(&problem))
    }

    /// The numbers of a part of that map, from the first column and row to those before the last: float32 of this machine, row by row
    /// from the north, NaN where there is none.
    fn map_part<'py>(
        &self,
        py: Python<'py>,
        scene: &str,
        query: &str,
        places: u32,
        columns: (u32, u32),
        rows: (u32, u32),
    ) -> PyResult<Bound<'py, PyBytes>> {
        let answers = self.answers()?;
        let question = MapQuestion { scene, query, places };
        let window = PlaceWindow { columns: columns.0..columns.1, rows: rows.0..rows.1 };
        let watched = |goes_on: &AtomicBool| {
            let part = answers.map_part(&question, &window, &|_| goes_on.load(Ordering::Relaxed));
            part.map(|values| values.iter().flat_map(|value| value.to_ne_bytes()).collect::<Vec<u8>>())
        };
        match beside_python(py, watched)? {
            Ok(bytes) => Ok(PyBytes::new(py, &bytes)),
            Err(problem) => Err(refused(&problem)),
        }
    }

    /// What renders: `gpu`, `lavapipe` or `cpu`.
    #[getter]
    fn executor(&self) -> PyResult<&str> {
        Ok(self.answers()?.executor())
    }

    /// The device's name.
    #[getter]
    fn adapter(&self) -> PyResult<&str> {
        Ok(self.answers()?.adapter())
    }
}

/// Makes the demo scene in a folder where there is none, or an older one; whether it did.
#[pyfunction]
fn make_demo(py: Python<'_>, data: PathBuf) -> PyResult<bool> {
    let make = |_: &_| {
        let store = SceneStore::new(&data);
        let is_wanted = demo_is_wanted(&store);
        if is_wanted {
            create_demo(&store, &mut |_| {})?;
        }
        Ok::<_, skyglow_scene::SceneError>(is_wanted)
    };
    beside_python(py, make)?.map_err(|error| PyOSError::new_err(error.to_string()))
}

/// Numbers of a map of brightness, float32 of this machine row by row, in the colours of map tiles, as PNG: less than the lower end of
/// `colour_range` is transparent, and so is NaN.
#[pyfunction]
fn brightness_png<'py>(
    py: Python<'py>,
    values: &[u8],
    size_px: [u32; 2],
    colour_range: (f64, f64),
    description: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let (numbers, rest) = values.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(PyValueError::new_err("values: four bytes for each number"));
    }
    let values: Vec<f32> = numbers.iter().map(|&four| f32::from_ne_bytes(four)).collect();
    let drawn = beside_python(py, |_| {
        let has_data: Vec<bool> = values.iter().map(|value| !value.is_nan()).collect();
        brightness_map_png(&values, &has_data, size_px, colour_range, &Notes::new(description, ""))
    })?;
    drawn.map(|png| PyBytes::new(py, &png)).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The engine of Skyglow: skyglow.Engine is how to ask it.
#[pymodule]
mod skyglow_engine {
    #[pymodule_export]
    use super::{Engine, RefusedError, brightness_png, make_demo};
}
