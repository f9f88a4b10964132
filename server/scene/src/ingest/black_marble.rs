//! NASA Black Marble granules (HDF5): which subdataset, its scale, and the tile's place on Earth.

use super::gdal_open::{gdal_reason, open_name};
use super::layers;
use super::no_data::NoData;
use super::options::IngestOptions;
use super::radiance_source::{BandFacts, Conversion, Layer, LayerTest, RadianceSource, unit_of};
use crate::error::SceneError;
use crate::metadata::Recognition;
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, Metadata};
use std::path::Path;

/// Subdatasets taken when none is named, in this order: daily gap-filled, monthly and yearly composites.
const RADIANCE_NAMES: [&str; 2] = ["Gap_Filled_DNB_BRDF-Corrected_NTL", "NearNadir_Composite_Snow_Free"];
/// Scale and fill value of those in the products' documents, for granules without the attributes.
const DEFAULT_SCALE: f64 = 0.1;
const DEFAULT_FILL: f64 = 65_535.0;
/// A tile spans this many degrees.
const TILE_DEG: f64 = 10.0;

/// Opens the radiance subdataset of a granule.
pub(super) fn open(
    container: Dataset,
    path: &Path,
    options: &IngestOptions,
) -> Result<RadianceSource, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let listed = subdatasets(&container);
    let name = choose(&listed, options.band.as_deref()).map_err(refuse)?;
    let (dataset, short_name) = match name {
        Some(full) => {
            let short = short_name(&full).to_owned();
            let opened = open_name(&full, &["HDF5Image"]).map_err(|reason| SceneError::Unreadable {
                path: path.to_owned(),
                reason: format!("its dataset {short} does not open: {reason}"),
            })?;
            (opened, short)
        }
        // A file with one raster opens as that raster; its attributes tell its name.
        None => {
            let attributes = attributes(&container).map_err(refuse)?;
            let owner = attribute_owner(&attributes);
            let Some(band_name) = owner.or_else(|| options.band.clone()) else {
                return Err(refuse(format!(
                    "its only dataset is neither {} nor {}; if it is radiance, give --band 1",
                    RADIANCE_NAMES[0], RADIANCE_NAMES[1]
                )));
            };
            (container, band_name)
        }
    };
    let facts = facts(&dataset, short_name, options).map_err(refuse)?;
    let (width, height) = dataset.raster_size();
    let place = tile(&dataset, path)
        .map(|(h, v)| {
            let step = (TILE_DEG / width as f64, TILE_DEG / height as f64);
            [TILE_DEG * h - 180.0, step.0, 0.0, 90.0 - TILE_DEG * v, 0.0, -step.1]
        })
        .map(|transform| SpatialRef::from_epsg(4326).map(|crs| (transform, crs)))
        .or_else(|| {
            let transform = dataset.geo_transform().ok()?;
            dataset.spatial_ref().ok().map(|crs| Ok((transform, crs)))
        });
    let Some(place) = place else {
        return Err(refuse(
            "its place on Earth is unknown: neither the file's name nor its attributes have a tile hXXvYY"
                .to_owned(),
        ));
    };
    let (geotransform, crs) = place.map_err(|e| refuse(gdal_reason(e)))?;
    let short_name = facts.name.clone();
    let mut source = RadianceSource::new(dataset, path, options, facts, geotransform, crs)?;
    add_layers(&mut source, &listed, &short_name, options)?;
    Ok(source)
}

/// The granule's own layers of quality and of the number of observations, where the options ask for them.
fn add_layers(
    source: &mut RadianceSource,
    listed: &[String],
    band: &str,
    options: &IngestOptions,
) -> Result<(), SceneError> {
    let find = |names: &[String]| {
        names.iter().find_map(|name| listed.iter().find(|full| short_name(full) == name.as_str()))
    };
    let quality = find(&[format!("{band}_Quality"), "Mandatory_Quality_Flag".to_owned()]);
    let observations = find(&[format!("{band}_Num"), "Num_Observations".to_owned()]);
    layers::require(options, source, quality.is_some(), observations.is_some())?;
    let open = |full: &String| {
        open_name(full, &["HDF5Image"]).map_err(|reason| SceneError::Unreadable {
            path: source.path.clone(),
            reason: format!("its dataset {} does not open: {reason}", short_name(full)),
        })
    };
    let mut own = Vec::new();
    if let (Some(full), Some(good), true) = (quality, &options.quality, options.quality_files.is_empty()) {
        own.push((full, LayerTest::OneOf(good.clone())));
    }
    if let (Some(full), Some(least), true) =
        (observations, options.min_observations, options.observation_files.is_empty())
    {
        own.push((full, LayerTest::AtLeast(f64::from(least))));
    }
    let own: Vec<(String, Layer)> = own
        .into_iter()
        .map(|(full, test)| Ok((short_name(full).to_owned(), Layer { dataset: open(full)?, test })))
        .collect::<Result<_, SceneError>>()?;
    for (name, layer) in own {
        source.recognised.push(Recognition::certain("layer", name));
        source.layers.push(layer);
    }
    if let (Some(full), None) = (quality, &options.quality) {
        source.recognised.push(Recognition::certain(
            "quality layer",
            format!("{} is there and not used: --quality 0 takes good pixels alone", short_name(full)),
        ));
    }
    Ok(())
}

/// The attributes of a dataset's only band, as `key=value`.
fn attributes(dataset: &Dataset) -> Result<Vec<String>, String> {
    let band = dataset.rasterband(1).map_err(gdal_reason)?;
    Ok(band.metadata_domain("").unwrap_or_default())
}

/// Scale, offset, no data and unit of a dataset: its attributes', else the product's.
fn facts(dataset: &Dataset, short_name: String, options: &IngestOptions) -> Result<BandFacts, String> {
    let band = dataset.rasterband(1).map_err(gdal_reason)?;
    let attributes = attributes(dataset)?;
    // Attributes of other datasets of the granule are not of this band.
    let own: Vec<String> = attributes.iter().filter(|item| is_of(item, &short_name)).cloned().collect();
    let attribute = |suffix: &str| number(&own, &short_name, suffix);
    let is_counts = RADIANCE_NAMES.contains(&short_name.as_str()) && !band.band_type().is_floating();
    let scale = attribute("_scale_factor").or(band.scale().filter(|s| *s != 1.0));
    let offset = attribute("_add_offset").or(attribute("_offset")).or(band.offset());
    let mut no_data = NoData::of(&band, &own, &options.no_data);
    if is_counts {
        no_data.or_declare(DEFAULT_FILL);
    }
    let conversion = Conversion {
        scale: scale.unwrap_or(if is_counts { DEFAULT_SCALE } else { 1.0 }),
        offset: offset.unwrap_or(0.0),
    };
    if !band.band_type().is_floating() && conversion.scale == 1.0 && options.scale.is_none() {
        return Err("its dataset holds whole numbers without a scale; give --scale, or --scale 1 if they are nW cm-2 sr-1".to_owned());
    }
    let unit = unit_of(&band, &own);
    Ok(BandFacts { number: 1, name: short_name, conversion, no_data, unit })
}

/// Whether an attribute `<groups>_<dataset>_<name>=…` is of this dataset, or of none in particular.
fn is_of(item: &str, dataset: &str) -> bool {
    let key = item.split('=').next().unwrap_or_default();
    !key.contains("Data_Fields_") || key.contains(&format!("{dataset}_"))
}

/// The names that GDAL opens the subdatasets by.
fn subdatasets(container: &Dataset) -> Vec<String> {
    let items = container.metadata_domain("SUBDATASETS").unwrap_or_default();
    let names = items.iter().filter_map(|item| item.split_once('='));
    names.filter(|(key, _)| key.ends_with("_NAME")).map(|(_, name)| name.to_owned()).collect()
}

fn short_name(full: &str) -> &str {
    full.rsplit(['/', ':']).next().unwrap_or(full)
}

fn choose(listed: &[String], wanted: Option<&str>) -> Result<Option<String>, String> {
    let find = |name: &str| listed.iter().find(|full| short_name(full) == name).cloned();
    if listed.is_empty() {
        return match wanted {
            None | Some("1") => Ok(None),
            Some(name) if RADIANCE_NAMES.contains(&name) => Ok(None),
            Some(name) => Err(format!("there is no dataset \"{name}\" in it")),
        };
    }
    let all = || listed.iter().map(|full| short_name(full)).collect::<Vec<_>>().join(", ");
    match wanted {
        Some(name) => find(name)
            .map(Some)
            .ok_or_else(|| format!("there is no dataset \"{name}\" in it; it has {}", all())),
        None => RADIANCE_NAMES.iter().find_map(|name| find(name)).map(Some).ok_or_else(|| {
            format!(
                "it holds neither {} nor {}; choose with --band: {}",
                RADIANCE_NAMES[0],
                RADIANCE_NAMES[1],
                all()
            )
        }),
    }
}

/// The dataset that attributes such as `…_Data_Fields_NAME_scale_factor` speak of, among the known names.
fn attribute_owner(attributes: &[String]) -> Option<String> {
    let known = |name: &&&str| attributes.iter().any(|item| item.contains(**name));
    RADIANCE_NAMES.iter().find(known).map(|name| (*name).to_owned())
}

/// The number of attribute `<groups>_<dataset><suffix>`; GDAL joins the path with underscores.
fn number(attributes: &[String], dataset: &str, suffix: &str) -> Option<f64> {
    let ending = format!("{dataset}{suffix}");
    attributes
        .iter()
        .filter_map(|item| item.split_once('='))
        .find_map(|(key, value)| key.ends_with(&ending).then(|| value.trim().parse().ok()).flatten())
}

/// Column and row of the tile: from the file's name, else from the granule's attributes.
fn tile(dataset: &Dataset, path: &Path) -> Option<(f64, f64)> {
    let file_name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let item = |key: &str| {
        dataset.metadata_item(key, "").or_else(|| {
            // Groups come before the key, joined by underscores.
            let items = dataset.metadata_domain("").unwrap_or_default();
            let ending = format!("_{key}");
            items
                .iter()
                .filter_map(|item| item.split_once('='))
                .find(|(name, _)| name.ends_with(&ending))
                .map(|(_, value)| value.to_owned())
        })
    };
    let from_numbers = || {
        let parse = |key: &str| item(key)?.trim().parse::<u32>().ok();
        Some((parse("HorizontalTileNumber")?, parse("VerticalTileNumber")?))
    };
    let (h, v) = file_name
        .and_then(|name| tile_in(&name))
        .or_else(from_numbers)
        .or_else(|| tile_in(&item("LocalGranuleID")?))?;
    (h < 36 && v < 18).then_some((f64::from(h), f64::from(v)))
}

/// `hXXvYY` anywhere in a text.
fn tile_in(text: &str) -> Option<(u32, u32)> {
    text.as_bytes().windows(6).find_map(|w| {
        let digit = |byte: u8| byte.is_ascii_digit().then(|| u32::from(byte - b'0'));
        if w[0] != b'h' || w[3] != b'v' {
            return None;
        }
        Some((digit(w[1])? * 10 + digit(w[2])?, digit(w[4])? * 10 + digit(w[5])?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_is_found_in_a_granule_name() {
        assert_eq!(tile_in("VNP46A2.A2023001.h21v09.001.2023010.h5"), Some((21, 9)));
        assert_eq!(tile_in("h2v09 hello"), None);
    }

    #[test]
    fn the_radiance_subdataset_is_chosen_by_name() {
        let listed: Vec<String> = ["Mandatory_Quality_Flag", "NearNadir_Composite_Snow_Free"]
            .map(|n| format!("HDF5:\"/x/a.h5\"://HDFEOS/GRIDS/G/Data_Fields/{n}"))
            .into();
        assert!(choose(&listed, None).unwrap().unwrap().ends_with("/NearNadir_Composite_Snow_Free"));
        assert!(choose(&listed, Some("Mandatory_Quality_Flag")).unwrap().unwrap().ends_with("Flag"));
        let message = choose(&listed[..1], None).unwrap_err();
        assert!(message.contains("--band: Mandatory_Quality_Flag"), "{message}");
    }
}
