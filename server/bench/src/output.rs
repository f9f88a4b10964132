//! The report as files: `bench.json` and the plots.

use crate::{error::BenchError, plots, report::Report};
use std::path::Path;

impl Report {
    /// Writes `bench.json` and the plots into a folder, which is made.
    ///
    /// # Errors
    /// [`BenchError::File`] and [`BenchError::Plot`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), BenchError> {
        std::fs::create_dir_all(folder).map_err(BenchError::file(folder))?;
        let path = folder.join("bench.json");
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| BenchError::File { path: path.clone(), source: error.into() })?;
        text.push('\n');
        std::fs::write(&path, text).map_err(BenchError::file(&path))?;
        plots::draw(self, folder)
    }
}
