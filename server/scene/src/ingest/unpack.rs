//! Files as they are downloaded: gzip and zip are unpacked into a folder of their own; what is no raster of the allowed kinds is
//! named, with what to do.

use crate::error::SceneError;
use std::{
    fs::File,
    io::{Read, Write},
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// Bytes that a packed file may unpack to where nobody sets a limit: a planet of 15″ in doubles.
const MAX_UNPACKED_BYTES: u64 = 32 << 30;
/// Bytes for each pixel that a raster of somebody who is not trusted may have: its numbers, and its directory.
const BYTES_PER_PIXEL: u64 = 16;
/// Entries of an archive at most.
const MAX_ENTRIES: usize = 4_096;
/// Endings of rasters and places in archives.
const RASTER_ENDINGS: [&str; 6] = ["tif", "tiff", "h5", "hdf5", "he5", "hgt"];

/// Files to read, some of which lie in a folder that goes away with this.
#[derive(Debug)]
pub(super) struct Unpacked {
    /// The files, in the order given; an archive gives all its rasters, by name.
    pub(super) paths: Vec<PathBuf>,
    _folder: Option<TempDir>,
}

/// Unpacks what is packed.
///
/// * `max_pixels`: of a raster, where whoever gives it is not trusted.
pub(super) fn unpack(paths: &[PathBuf], max_pixels: Option<u64>) -> Result<Unpacked, SceneError> {
    let limit = max_pixels.map_or(MAX_UNPACKED_BYTES, |n| n.saturating_mul(BYTES_PER_PIXEL).max(64 << 20));
    let (mut plain, mut folder) = (Vec::new(), None);
    for path in paths {
        let Some(packing) = Packing::of(path)? else {
            plain.push(path.clone());
            continue;
        };
        if folder.is_none() {
            folder = Some(TempDir::new().map_err(SceneError::io(std::env::temp_dir()))?);
        }
        let Some(into) = &folder else { continue };
        // A folder for each, so that no name meets another.
        let own = into.path().join(plain.len().to_string());
        std::fs::create_dir(&own).map_err(SceneError::io(&own))?;
        match packing {
            Packing::Gzip => plain.push(gunzip(path, &own, limit)?),
            Packing::Zip => plain.extend(unzip(path, &own, limit)?),
        }
    }
    Ok(Unpacked { paths: plain, _folder: folder })
}

/// How a file is packed, by its first bytes.
enum Packing {
    Gzip,
    Zip,
}

impl Packing {
    fn of(path: &Path) -> Result<Option<Self>, SceneError> {
        Ok(match head(path)? {
            [0x1f, 0x8b, ..] => Some(Self::Gzip),
            [b'P', b'K', 3 | 5, 4 | 6, ..] => Some(Self::Zip),
            _ => None,
        })
    }
}

/// The first bytes of a plain file; zeros where it is shorter or no plain file.
fn head(path: &Path) -> Result<[u8; 512], SceneError> {
    let mut head = [0u8; 512];
    if std::fs::metadata(path).map_err(SceneError::io(path))?.is_file() {
        let file = File::open(path).map_err(SceneError::io(path))?;
        let mut bytes = Vec::new();
        file.take(512).read_to_end(&mut bytes).map_err(SceneError::io(path))?;
        head[..bytes.len()].copy_from_slice(&bytes);
    }
    Ok(head)
}

fn refused(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::Refused { path: path.to_owned(), reason: reason.into() }
}

/// Copies at most so many bytes into a new file.
fn copy(from: &mut dyn Read, to: &Path, limit: u64, packed: &Path) -> Result<u64, SceneError> {
    let broken = |error: std::io::Error| refused(packed, format!("it cannot be unpacked ({error})"));
    let mut file = File::create(to).map_err(SceneError::io(to))?;
    let mut buffer = vec![0u8; 1 << 20];
    let mut written = 0u64;
    loop {
        let count = from.read(&mut buffer).map_err(broken)?;
        if count == 0 {
            return Ok(written);
        }
        written += count as u64;
        if written > limit {
            return Err(refused(
                packed,
                format!("it unpacks to more than {limit} bytes, which is not allowed"),
            ));
        }
        file.write_all(&buffer[..count]).map_err(SceneError::io(to))?;
    }
}

fn gunzip(path: &Path, folder: &Path, limit: u64) -> Result<PathBuf, SceneError> {
    let file = File::open(path).map_err(SceneError::io(path))?;
    let name = path.file_name().map_or_else(|| "raster".to_owned(), |n| n.to_string_lossy().into_owned());
    // A member within a tape archive is not looked for.
    let plain = name.strip_suffix(".gz").or(name.strip_suffix(".tgz")).unwrap_or(&name);
    let to = folder.join(plain);
    copy(&mut flate2::read::MultiGzDecoder::new(file), &to, limit, path)?;
    Ok(to)
}

fn unzip(path: &Path, folder: &Path, limit: u64) -> Result<Vec<PathBuf>, SceneError> {
    let broken = |error: zip::result::ZipError| refused(path, format!("it cannot be unpacked ({error})"));
    let file = File::open(path).map_err(SceneError::io(path))?;
    let mut archive = zip::ZipArchive::new(file).map_err(broken)?;
    if archive.len() > MAX_ENTRIES {
        return Err(refused(path, format!("it has {} entries; {MAX_ENTRIES} are allowed", archive.len())));
    }
    let (mut rasters, mut others, mut left) = (Vec::new(), Vec::new(), limit);
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).map_err(broken)?;
        // The name alone: where an entry would like to lie does not matter.
        let Some(name) =
            entry.enclosed_name().and_then(|p| Some(p.file_name()?.to_string_lossy().into_owned()))
        else {
            continue;
        };
        let ending = name.rsplit('.').next().unwrap_or_default().to_lowercase();
        if !entry.is_file() || name.starts_with('.') || !RASTER_ENDINGS.contains(&ending.as_str()) {
            others.push(name);
            continue;
        }
        let to = folder.join(&name);
        if to.exists() {
            return Err(refused(path, format!("it holds {name} twice; unpack it, and give the files")));
        }
        left -= copy(&mut entry, &to, left, path)?;
        rasters.push(to);
    }
    if rasters.is_empty() {
        others.truncate(5);
        return Err(refused(
            path,
            format!("it holds no GeoTIFF, HDF5 or .hgt file, but {}", others.join(", ")),
        ));
    }
    rasters.sort();
    Ok(rasters)
}

/// What a file is that the allowed formats do not read, and what to do with it; None for what is not known.
pub(super) fn advice(path: &Path) -> Option<String> {
    let head = head(path).ok()?;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let text = String::from_utf8_lossy(&head).trim_start_matches('\u{feff}').trim_start().to_lowercase();
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let convert = |what: &str, from: String| {
        Some(format!("it is {what}; make a GeoTIFF of it: gdal_translate {from} light.tif"))
    };
    if text.starts_with("<!doctype html") || text.starts_with("<html") || text.contains("<head>") {
        return Some(
            "it is a web page, not a raster: the download wanted a login first; log in (for NASA with an Earthdata token) and download it again"
                .to_owned(),
        );
    }
    if text.starts_with("<?xml") && text.contains("<error") || text.starts_with("<error") {
        return Some(
            "it is an error message of a download in XML, not a raster; download it again".to_owned(),
        );
    }
    if text.starts_with('{') {
        return Some(
            "it is JSON, not a raster; if it is an answer of a download, it says what went wrong".to_owned(),
        );
    }
    if head.starts_with(b"CDF\x01")
        || head.starts_with(b"CDF\x02")
        || head.starts_with(b"CDF\x05")
        || ending == "nc"
        || ending == "nc4"
    {
        return convert("NetCDF", format!("NETCDF:{name}:VARIABLE (gdalinfo lists the variables)"));
    }
    if text.starts_with("<vrtdataset") {
        return Some(
            "it is a virtual raster that does more than lay files side by side; make a GeoTIFF of it: gdal_translate mosaic.vrt light.tif"
                .to_owned(),
        );
    }
    if head.starts_with(b"EHFA_HEADER_TAG") {
        return convert("Erdas Imagine", name);
    }
    if text.starts_with("ncols") || text.starts_with("nrows") {
        return Some(format!(
            "it is an ASCII grid, which says nothing of its coordinate reference system; make a GeoTIFF of it: gdal_translate -a_srs EPSG:4326 {name} light.tif"
        ));
    }
    if head.starts_with(b"\x0e\x03\x13\x01") {
        return convert("HDF4", format!("HDF4_EOS:EOS_GRID:{name}:… (gdalinfo lists the datasets)"));
    }
    if head.starts_with(b"GRIB") {
        return convert("GRIB", name);
    }
    if head.starts_with(b"\x89PNG")
        || head.starts_with(b"\xff\xd8\xff")
        || head.starts_with(b"RIFF")
        || head.starts_with(b"GIF8")
    {
        return Some(
            "it is a picture, not a measurement; download the radiances (GeoTIFF or HDF5)".to_owned(),
        );
    }
    if head.starts_with(b"%PDF") {
        return Some("it is a PDF document, not a raster".to_owned());
    }
    if head.starts_with(b"SQLite format 3") {
        return convert("GeoPackage or another SQLite file", name);
    }
    if head[257..].starts_with(b"ustar") || ending == "tgz" {
        return Some(format!("it is a tape archive; unpack it first: tar xf {name}"));
    }
    if head.starts_with(b"7z\xbc\xaf\x27\x1c")
        || head.starts_with(b"Rar!")
        || head.starts_with(b"BZh")
        || head.starts_with(b"\xfd7zXZ")
    {
        return Some("it is packed; unpack it first (gzip and zip are read as they are)".to_owned());
    }
    match ending.as_str() {
        "hdr" | "bil" | "bip" | "bsq" | "flt" | "img" | "dem" | "adf" | "e00" | "grd" | "sdat" => {
            convert(&format!("a .{ending} file"), name)
        }
        _ => None,
    }
}
