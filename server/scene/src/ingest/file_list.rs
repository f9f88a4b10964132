//! Which files are meant: plain ones, those of a folder, of a list, or of a virtual raster (VRT) that lays local files side by side.

use crate::error::SceneError;
use std::path::{Path, PathBuf};

/// Files of one scene at most.
const MAX_FILES: usize = 4_096;
/// Bytes of a list or a virtual raster at most.
const MAX_LIST_BYTES: u64 = 16 << 20;
/// Endings of the rasters that are taken from a folder.
const ENDINGS: [&str; 7] = ["tif", "tiff", "h5", "hdf5", "he5", "gz", "zip"];

/// The files that are meant, and values of no data that a virtual raster declares for them.
#[derive(Debug, Default, PartialEq)]
pub(super) struct FileList {
    pub(super) paths: Vec<PathBuf>,
    pub(super) no_data: Vec<f64>,
}

/// Puts folders, lists (`.txt`, a file a line) and virtual rasters in terms of their files. For whoever is trusted alone: they
/// name files of this machine.
///
/// # Errors
/// Folders and lists without a file, virtual rasters that do more than lay files side by side.
pub(super) fn expand(given: &[PathBuf]) -> Result<FileList, SceneError> {
    let mut list = FileList::default();
    for path in given {
        let metadata = std::fs::metadata(path).map_err(SceneError::io(path))?;
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if metadata.is_dir() {
            list.paths.extend(of_folder(path)?);
        } else if ending == "vrt" || ending == "txt" || ending == "lst" {
            if metadata.len() > MAX_LIST_BYTES {
                return Err(refused(
                    path,
                    format!("it has {} bytes; a list of files is shorter", metadata.len()),
                ));
            }
            let text = std::fs::read_to_string(path).map_err(SceneError::io(path))?;
            if ending == "vrt" { of_vrt(path, &text, &mut list)? } else { of_list(path, &text, &mut list)? }
        } else {
            list.paths.push(path.clone());
        }
    }
    if list.paths.len() > MAX_FILES {
        return Err(SceneError::InvalidOption {
            option: "FILES",
            reason: format!("{} files are given; {MAX_FILES} are allowed", list.paths.len()),
        });
    }
    Ok(list)
}

fn refused(path: &Path, reason: impl Into<String>) -> SceneError {
    SceneError::Refused { path: path.to_owned(), reason: reason.into() }
}

fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, SceneError> {
    let entries = std::fs::read_dir(folder).map_err(SceneError::io(folder))?;
    let is_raster = |path: &PathBuf| {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        path.is_file() && ENDINGS.contains(&ending.as_str())
    };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_raster).collect();
    paths.sort();
    if paths.is_empty() {
        return Err(refused(folder, "the folder holds no GeoTIFF and no HDF5 granule"));
    }
    Ok(paths)
}

fn of_list(path: &Path, text: &str, list: &mut FileList) -> Result<(), SceneError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let before = list.paths.len();
    let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    list.paths.extend(
        lines.filter(|line| !line.is_empty() && !line.starts_with('#')).map(|line| folder.join(line)),
    );
    if list.paths.len() == before {
        return Err(refused(path, "the list names no file; write one on each line"));
    }
    Ok(())
}

/// Of `gdalbuildvrt`: sources that lie side by side in their own resolution. Anything else is GDAL's to compute.
fn of_vrt(path: &Path, text: &str, list: &mut FileList) -> Result<(), SceneError> {
    let more = || {
        refused(
            path,
            format!(
                "it is a virtual raster that does more than lay files side by side; make a GeoTIFF of it: gdal_translate {} light.tif",
                path.display()
            ),
        )
    };
    let is_computed = [
        "<ScaleRatio",
        "<ScaleOffset",
        "<LUT",
        "PixelFunction",
        "VRTWarpedDataset",
        "VRTPansharpened",
        "<KernelFiltered",
        "<MaskBand",
    ];
    if is_computed.iter().any(|word| text.contains(word)) || text.matches("<VRTRasterBand").count() != 1 {
        return Err(more());
    }
    for rectangles in text.split("<SrcRect").skip(1) {
        let source = attributes(rectangles);
        let Some(target) = rectangles.split("<DstRect").nth(1).map(attributes) else { return Err(more()) };
        let [x, y, width, height] = source;
        if x != 0.0 || y != 0.0 || (width - target[2]).abs() > 0.01 || (height - target[3]).abs() > 0.01 {
            return Err(more());
        }
    }
    for value in ["<NoDataValue>", "<NODATA>"].iter().flat_map(|tag| text.split(tag).skip(1)) {
        let number = value.split('<').next().and_then(|word| word.trim().parse().ok());
        list.no_data.extend(number.filter(|n| !list.no_data.contains(n)));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let before = list.paths.len();
    for source in text.split("<SourceFilename").skip(1) {
        let Some((head, name)) = source.split_once('>') else { return Err(more()) };
        let name = name.split('<').next().unwrap_or_default();
        let name = name
            .replace("&quot;", "\"")
            .replace("&apos;", "'")
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&amp;", "&");
        let file =
            if head.contains("relativeToVRT=\"1\"") { folder.join(&name) } else { PathBuf::from(&name) };
        if !file.is_file() {
            return Err(refused(path, format!("its source {name} is no file of this machine")));
        }
        list.paths.push(file);
    }
    if list.paths.len() == before { Err(more()) } else { Ok(()) }
}

/// xOff, yOff, xSize and ySize of a rectangle; NaN where one is missing.
fn attributes(text: &str) -> [f64; 4] {
    let tag = text.split('>').next().unwrap_or_default();
    ["xOff", "yOff", "xSize", "ySize"].map(|name| {
        let value = tag.split(&format!("{name}=\"")).nth(1).and_then(|rest| rest.split('"').next());
        value.and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE_BY_SIDE: &str = r#"<VRTDataset rasterXSize="8" rasterYSize="4"><VRTRasterBand dataType="Float32" band="1">
        <NoDataValue>-999.9</NoDataValue>
        <SimpleSource><SourceFilename relativeToVRT="1">a.tif</SourceFilename><SourceBand>1</SourceBand>
        <SrcRect xOff="0" yOff="0" xSize="4" ySize="4" /><DstRect xOff="4" yOff="0" xSize="4" ySize="4" /></SimpleSource>
        </VRTRasterBand></VRTDataset>"#;

    /// A virtual raster stands for the files that it lays side by side, and no other is read.
    #[test]
    fn virtual_rasters_stand_for_their_files() {
        let folder = tempfile::tempdir().unwrap();
        let (vrt, tif) = (folder.path().join("all.vrt"), folder.path().join("a.tif"));
        std::fs::write(&tif, "x").unwrap();
        std::fs::write(&vrt, SIDE_BY_SIDE).unwrap();
        let list = expand(std::slice::from_ref(&vrt)).unwrap();
        assert_eq!(list, FileList { paths: vec![tif], no_data: vec![-999.9] });
        for (from, to) in [
            ("xSize=\"4\" ySize=\"4\" /><Dst", "xSize=\"2\" ySize=\"4\" /><Dst"),
            ("<SrcRect xOff=\"0\"", "<SrcRect xOff=\"1\""),
            ("<SourceBand>", "<ScaleRatio>2</ScaleRatio><SourceBand>"),
            ("a.tif", "/vsicurl/http://localhost/a.tif"),
        ] {
            std::fs::write(&vrt, SIDE_BY_SIDE.replace(from, to)).unwrap();
            assert!(expand(std::slice::from_ref(&vrt)).is_err(), "{to}");
        }
    }

    #[test]
    fn folders_and_lists_give_their_rasters() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.tif", "a.h5", "notes.md"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let list = expand(&[folder.path().to_owned()]).unwrap();
        assert_eq!(list.paths, [folder.path().join("a.h5"), folder.path().join("b.tif")]);
        let lines = folder.path().join("files.txt");
        std::fs::write(&lines, "# two\nb.tif\n\na.h5\n").unwrap();
        assert_eq!(
            expand(&[lines]).unwrap().paths,
            [folder.path().join("b.tif"), folder.path().join("a.h5")]
        );
    }
}
