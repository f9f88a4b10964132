//! Layers beside the radiances: masks, quality, numbers of observations.

use super::gdal_open::open_file;
use super::options::IngestOptions;
use super::radiance_source::{Layer, LayerTest, RadianceSource};
use crate::error::SceneError;
use std::path::Path;

/// Adds the layers that the options give as files of their own.
///
/// # Errors
/// Files that are no raster of one band on the radiances' grid.
pub(super) fn add_files(
    source: &mut RadianceSource,
    options: &IngestOptions,
    index: usize,
) -> Result<(), SceneError> {
    let lit = options.masks.get(index).map(|path| (path, LayerTest::Lit));
    let quality = options.quality.as_ref().zip(options.quality_files.get(index));
    let quality = quality.map(|(good, path)| (path, LayerTest::OneOf(good.clone())));
    let observations = options.min_observations.zip(options.observation_files.get(index));
    let observations = observations.map(|(least, path)| (path, LayerTest::AtLeast(f64::from(least))));
    for (path, test) in [lit, quality, observations].into_iter().flatten() {
        let layer = Layer { dataset: open_beside(path, source)?, test };
        source.layers.push(layer);
    }
    Ok(())
}

fn open_beside(path: &Path, source: &RadianceSource) -> Result<gdal::Dataset, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let dataset = open_file(path, &["GTiff", "COG"])?;
    let side = source.geotransform[1].abs().max(source.geotransform[2].abs());
    let is_same_grid = dataset
        .geo_transform()
        .is_ok_and(|own| own.iter().zip(&source.geotransform).all(|(a, b)| (a - b).abs() <= 0.01 * side));
    if dataset.raster_count() != 1 || dataset.raster_size() != source.dataset.raster_size() || !is_same_grid {
        return Err(refuse(format!(
            "it is not one band on the grid of {}; bring it there first: gdalwarp -tr -te",
            source.path.display()
        )));
    }
    Ok(dataset)
}

/// Refuses options that ask for layers which are not there.
///
/// # Errors
/// [`SceneError::Refused`] naming the option that gives the layer.
pub(super) fn require(
    options: &IngestOptions,
    source: &RadianceSource,
    has_quality: bool,
    has_observations: bool,
) -> Result<(), SceneError> {
    let refuse = |what: &str, option: &str| {
        let reason = format!("it has no layer of {what}; give one on its grid with {option}");
        Err(SceneError::Refused { path: source.path.clone(), reason })
    };
    if options.quality.is_some() && options.quality_files.is_empty() && !has_quality {
        return refuse("quality", "--quality-file");
    }
    if options.min_observations.is_some() && options.observation_files.is_empty() && !has_observations {
        return refuse("the number of observations", "--observations-file");
    }
    Ok(())
}
