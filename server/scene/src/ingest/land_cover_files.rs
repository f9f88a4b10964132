//! Reading rasters of land cover: classes become albedo, water and forest, means over samples of 25 m or more.

use super::gdal_open::{gdal_reason, open_file};
use super::georeference;
use super::land_classes::{Cover, LandClasses};
use super::options::IngestOptions;
use crate::error::SceneError;
use crate::grid::Grid;
use crate::land_cover::{LandCover, PARTS};
use crate::metadata::Recognition;
use crate::terrain::{TerrainRaster, TerrainRasterBuilder};
use gdal::raster::{GdalDataType, RasterBand};
use skyglow_physics::GeoPoint;
use std::path::{Path, PathBuf};

/// Finer samples than this, metres, are put together.
const FINEST_M: f64 = 25.0;
/// Classes beyond are none.
const MAX_CODE: usize = 1_023;
/// Fewer of its samples known, in a sample of ours, leave that void.
const LEAST_KNOWN: f64 = 0.5;
/// Places along each side of the lights' grid that are looked at for cover.
const PROBES: u32 = 24;

/// Reads the files, which must know some of the ground of the lights' grid.
pub(super) fn read(
    options: &IngestOptions,
    lights: &Grid,
    recognised: &mut Vec<Recognition>,
) -> Result<LandCover, SceneError> {
    let mut files = Vec::new();
    for path in &options.land_cover {
        let (rasters, said) = read_file(path, options)?;
        files.push(rasters);
        if !recognised.contains(&said) {
            recognised.push(said);
        }
    }
    let cover = LandCover::new(files);
    let is_known = probes(lights).any(|place| cover.at(place, 0.0).is_some());
    if let Some(path) = options.land_cover.first().filter(|_| !is_known) {
        let reason = "the files of land cover know nothing of the ground that the radiances are of: they lie elsewhere, or are void";
        return Err(SceneError::Refused { path: PathBuf::from(path), reason: reason.to_owned() });
    }
    Ok(cover)
}

/// Places spread over a grid, where it lies on Earth.
pub(super) fn probes(grid: &Grid) -> impl Iterator<Item = GeoPoint> {
    let points = (0..PROBES * PROBES).map(|number| {
        let [x, y] =
            [number % PROBES, number / PROBES].map(|step| (f64::from(step) + 0.5) / f64::from(PROBES));
        grid.point(x * f64::from(grid.width), y * f64::from(grid.height))
    });
    points.filter(|point| point.is_finite()).map(GeoPoint::from_vector)
}

fn read_file(path: &Path, options: &IngestOptions) -> Result<([TerrainRaster; 3], Recognition), SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let dataset = open_file(path, &["GTiff", "COG"])?;
    if dataset.raster_count() != 1 {
        return Err(refuse(format!("land cover has one band, this raster has {}", dataset.raster_count())));
    }
    options.check_size(dataset.raster_size()).map_err(refuse)?;
    let band = dataset.rasterband(1).map_err(|error| refuse(gdal_reason(error)))?;
    let wide = [GdalDataType::Float32, GdalDataType::Float64, GdalDataType::UInt32, GdalDataType::Int32];
    if wide.contains(&band.band_type()) {
        return Err(refuse(format!("its numbers are {}, not classes of 8 or 16 bits", band.band_type())));
    }
    let crs = dataset.spatial_ref().map_err(|_| {
        refuse(
            "the land cover has no coordinate reference system, so its place on Earth is unknown".to_owned(),
        )
    })?;
    let geotransform = dataset
        .geo_transform()
        .map_err(|_| refuse("the land cover is not georeferenced: it has no geotransform".to_owned()))?;
    let (width, height) = dataset.raster_size();
    let sample_m = georeference::grid(&geotransform, &crs, (width, height)).map_err(refuse)?.pixel_size_m();
    let factor = ((FINEST_M / sample_m).ceil() as usize).clamp(1, width.min(height));
    let size = (width / factor, height / factor);
    let [x0, dx, sx, y0, sy, dy] = geotransform;
    let by = factor as f64;
    let coarse = [x0, by * dx, by * sx, y0, by * sy, by * dy];
    let grid = georeference::grid(&coarse, &crs, size).map_err(refuse)?;
    let classes = options.land_cover_classes.unwrap_or(LandClasses::WorldCover);
    let table = Table::new(classes, &band);
    let mut builders = [(); 3].map(|()| TerrainRasterBuilder::new(grid.clone()));
    let mut codes = vec![0u16; width * factor];
    let mut unknown = None;
    for row in 0..size.1 {
        band.read_into_slice(
            (0, (row * factor) as isize),
            (width, factor),
            (width, factor),
            &mut codes,
            None,
        )
        .map_err(|error| {
            let reason =
                format!("it is truncated or broken near row {} ({})", row * factor, gdal_reason(error));
            SceneError::Unreadable { path: path.to_owned(), reason }
        })?;
        let means =
            (0..size.0).map(|column| table.mean(&codes, width, column * factor, factor, &mut unknown));
        let means: Vec<[f32; 3]> = means.collect();
        for (field, builder) in builders.iter_mut().enumerate() {
            let line: Vec<f32> = means.iter().map(|mean| mean[field]).collect();
            builder.push_row(&line).map_err(SceneError::io(path))?;
        }
        if let Some(code) = unknown {
            return Err(refuse(format!(
                "it holds the class {code}, which {} has not; --land-cover-classes says whose classes they are: {}",
                classes.title(),
                LandClasses::NAMES
            )));
        }
    }
    let [albedo, water, forest] = builders.map(|builder| builder.finish().map_err(SceneError::io(path)));
    let said = format!("classes of {}, means over {:.0} m", classes.title(), by * sample_m);
    let is_named = path.file_name().is_some_and(|name| name.to_string_lossy().contains("WorldCover"));
    let said = match options.land_cover_classes {
        Some(_) => Recognition::certain("land cover", said),
        None if is_named => Recognition::likely("land cover", said),
        None => Recognition::assumed("land cover", said),
    };
    Ok(([albedo?, water?, forest?], said))
}

/// What each code of a file says.
struct Table(Vec<Entry>);

#[derive(Clone, Copy)]
enum Entry {
    Void,
    Unknown,
    Known(Cover),
}

impl Table {
    fn new(classes: LandClasses, band: &RasterBand<'_>) -> Self {
        let no_data = band.no_data_value();
        let entry = |code: usize| match classes.cover(code as i64) {
            _ if no_data == Some(code as f64) || classes.is_void(code as i64) => Entry::Void,
            Some(cover) => Entry::Known(cover),
            None => Entry::Unknown,
        };
        Self((0..=MAX_CODE).map(entry).collect())
    }

    /// Albedo, water and forest of a square of codes, in parts; NaN where too little of it is known.
    fn mean(
        &self,
        codes: &[u16],
        width: usize,
        first: usize,
        side: usize,
        unknown: &mut Option<u16>,
    ) -> [f32; 3] {
        let (mut sum, mut known) = ([0.0; 3], 0.0);
        for line in codes.chunks_exact(width) {
            for &code in &line[first..first + side] {
                match self.0.get(usize::from(code)).copied().unwrap_or(Entry::Unknown) {
                    Entry::Void => {}
                    Entry::Unknown => *unknown = Some(code),
                    Entry::Known(cover) => {
                        known += 1.0;
                        sum[0] += cover.albedo();
                        sum[1] += f64::from(u8::from(cover == Cover::Water));
                        sum[2] += f64::from(u8::from(cover.is_forest()));
                    }
                }
            }
        }
        let is_known = known >= LEAST_KNOWN * (side * side) as f64;
        if is_known { sum.map(|sum| (PARTS * sum / known) as f32) } else { [f32::NAN; 3] }
    }
}
