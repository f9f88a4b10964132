//! Opening files with GDAL: plain files of the allowed formats alone.

use super::{hdf5, unpack};
use crate::error::SceneError;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags, Metadata};
use std::path::Path;
use std::sync::Once;

/// Keeps GDAL from writing to stderr: its messages come back as errors.
fn silence_gdal() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| gdal::config::set_error_handler(|_, _, _| {}));
}

/// What GDAL said, without its wrapping, on one line.
pub(super) fn gdal_reason(error: gdal::errors::GdalError) -> String {
    use gdal::errors::GdalError::{CplError, NullPointer};
    let text = match error {
        CplError { msg, .. } | NullPointer { msg, .. } if !msg.is_empty() => msg,
        other => other.to_string(),
    };
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Opens `path` with one of `drivers`. Only plain files: no network or archive file systems, no connection
/// strings, no formats that refer to other files.
pub(super) fn open_file(path: &Path, drivers: &[&str]) -> Result<Dataset, SceneError> {
    let metadata = std::fs::metadata(path).map_err(SceneError::io(path))?;
    let unreadable = |reason: String| SceneError::Unreadable { path: path.to_owned(), reason };
    if !metadata.is_file() {
        return Err(unreadable("it is not a file".to_owned()));
    }
    if path.starts_with("/vsi") || path.to_string_lossy().starts_with("/vsi") {
        return Err(unreadable("virtual file systems are not allowed".to_owned()));
    }
    hdf5::check(path)?;
    let dataset = open_name(&path.to_string_lossy(), drivers).map_err(|reason| {
        let is_other = reason.contains("not recognized as");
        unreadable(match unpack::advice(path) {
            Some(advice) => advice,
            None if is_other => format!("it is none of {}", drivers.join(", ")),
            None => reason,
        })
    })?;
    // GDAL would take its overviews from there.
    if let Some(other) = dataset.metadata_item("OVERVIEW_FILE", "OVERVIEWS") {
        let reason = format!(
            "it refers to another file ({other}), which is not allowed; make a plain GeoTIFF of it: gdal_translate"
        );
        return Err(SceneError::Refused { path: path.to_owned(), reason });
    }
    Ok(dataset)
}

/// Opens a name that is known to be a plain file or a subdataset of one.
pub(super) fn open_name(name: &str, drivers: &[&str]) -> Result<Dataset, String> {
    silence_gdal();
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_READONLY
            | GdalOpenFlags::GDAL_OF_RASTER
            | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
        allowed_drivers: Some(drivers),
        ..DatasetOptions::default()
    };
    Dataset::open_ex(name, options).map_err(gdal_reason)
}
