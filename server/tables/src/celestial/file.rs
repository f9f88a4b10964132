//! The file of a celestial table: as that of a pack, with sections of its own. Nothing in it is trusted.

use super::{
    CelestialTable,
    manifest::{CELESTIAL_FORMAT_VERSION, CELESTIAL_MODEL_VERSION, CelestialAxes, CelestialManifest},
};
use crate::{
    error::TablesError,
    manifest::Versions,
    pack::{
        celestial_file_name, file_bytes,
        reading::{Parts, check_beside, checked_body},
        write_atomically,
    },
};
use skyglow_physics::{BAND_COUNT, Band, Turbidity};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"SKYBEAM\x01";
/// Points of an axis at most.
const MAX_AXIS: usize = 1024;

/// Values less those `stride` before, in place and from the end.
fn differences(values: &mut [i16], stride: usize, length: usize) {
    for block in values.chunks_exact_mut(length) {
        for i in (stride..length).rev() {
            block[i] = block[i].wrapping_sub(block[i - stride]);
        }
    }
}

/// Undoes [`differences`].
fn sums(values: &mut [i16], stride: usize, length: usize) {
    for block in values.chunks_exact_mut(length) {
        for i in stride..length {
            block[i] = block[i].wrapping_add(block[i - stride]);
        }
    }
}

/// Strides of the axes along which differences are taken, and how long a block along each is.
fn strides(axes: &CelestialAxes) -> [(usize, usize); 3] {
    let row = axes.azimuth_count;
    let image = BAND_COUNT * axes.direction_count();
    [(1, row), (row, axes.direction_count()), (image, image * axes.zenith_angle_deg.len())]
}

/// Sign in the lowest bit, so that small numbers have few bits.
fn folded(value: i16) -> u16 {
    ((value << 1) ^ (value >> 15)) as u16
}

fn unfolded(value: u16) -> i16 {
    (value >> 1) as i16 ^ -((value & 1) as i16)
}

impl CelestialTable {
    /// Reads and checks a table: magic, format, checksum, manifest, lengths, finite values.
    ///
    /// # Errors
    /// [`TablesError::Refused`] naming the file and what is wrong with it.
    pub fn open(path: &Path) -> Result<Self, TablesError> {
        let bytes = std::fs::read(path).map_err(TablesError::io(path))?;
        let table = Self::from_bytes(&bytes)
            .map_err(|reason| TablesError::Refused { path: path.to_owned(), reason })?;
        check_beside(path, &table.manifest)?;
        Ok(table)
    }

    /// The same of a file's content.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut parts = Parts::new(checked_body(bytes, MAGIC)?);
        let (manifest, turbidity) = read_manifest(parts.take("the manifest")?)?;
        let axes = &manifest.axes;
        let altitudes = axes.observer_altitude_m.len();
        let folded = parts.section("scattered", &axes.sample_counts(), 2)?;
        let mut scattered: Vec<i16> =
            bytemuck::pod_collect_to_vec::<u8, u16>(&folded).into_iter().map(unfolded).collect();
        for (stride, length) in strides(axes).into_iter().rev() {
            sums(&mut scattered, stride, length);
        }
        let direct = parts.section("direct", &[altitudes, axes.direct_count, BAND_COUNT], 4)?;
        let direct = bytemuck::pod_collect_to_vec::<u8, f32>(&direct);
        let shadow_rad =
            bytemuck::pod_collect_to_vec::<u8, f32>(&parts.section("shadow", &[altitudes], 4)?);
        parts.end()?;
        if !direct.iter().chain(&shadow_rad).all(|value| value.is_finite()) {
            return Err("it holds values that are not finite".to_owned());
        }
        let table = Self::from_parts(manifest, turbidity, scattered, direct, shadow_rad, false);
        if table.manifest.checksum == table.data_checksum() {
            Ok(table)
        } else {
            Err("its data are not those of its manifest".to_owned())
        }
    }

    /// BLAKE3 of the data, hexadecimal.
    pub(super) fn data_checksum(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(bytemuck::cast_slice(&self.scattered));
        hasher.update(bytemuck::cast_slice(&self.direct));
        hasher.update(bytemuck::cast_slice(&self.shadow_rad));
        hasher.finalize().to_hex().to_string()
    }

    /// Writes the table and its manifest to a folder, each under a temporary name that is renamed when it is whole
    /// and on disk. Returns the table's path.
    ///
    /// # Errors
    /// [`TablesError`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, TablesError> {
        let path = folder.join(celestial_file_name(self.manifest.turbidity));
        let json = serde_json::to_vec_pretty(&self.manifest)
            .map_err(|error| TablesError::Manifest { path: path.clone(), reason: error.to_string() })?;
        let mut scattered = self.scattered.clone();
        for (stride, length) in strides(&self.manifest.axes) {
            differences(&mut scattered, stride, length);
        }
        let scattered: Vec<u16> = scattered.into_iter().map(folded).collect();
        let sections: [(&[u8], usize); 3] = [
            (bytemuck::cast_slice(&scattered), 2),
            (bytemuck::cast_slice(&self.direct), 4),
            (bytemuck::cast_slice(&self.shadow_rad), 4),
        ];
        let bytes = file_bytes(MAGIC, &json, &sections).map_err(TablesError::io(&path))?;
        write_atomically(&path, &bytes)?;
        write_atomically(&path.with_extension("json"), &[json.as_slice(), b"\n"].concat())?;
        Ok(path)
    }
}

fn read_manifest(json: &[u8]) -> Result<(CelestialManifest, Turbidity), String> {
    let unreadable = |error: serde_json::Error| format!("its manifest cannot be read: {error}");
    let versions: Versions = serde_json::from_slice(json).map_err(unreadable)?;
    let wanted =
        Versions { format_version: CELESTIAL_FORMAT_VERSION, model_version: CELESTIAL_MODEL_VERSION };
    if versions != wanted {
        return Err(format!(
            "it has format {} of model {}, this program reads format {CELESTIAL_FORMAT_VERSION} of model \
             {CELESTIAL_MODEL_VERSION}; make it again with `skyglow precompute --part celestial`",
            versions.format_version, versions.model_version
        ));
    }
    let manifest: CelestialManifest = serde_json::from_slice(json).map_err(unreadable)?;
    let bands_nm = Band::ALL.map(Band::wavelength_nm);
    if manifest.bands_nm != bands_nm {
        return Err(format!(
            "its bands are at {:?} nm, those of this program at {bands_nm:?}; make it again with `skyglow precompute \
             --part celestial`",
            manifest.bands_nm
        ));
    }
    let turbidity = Turbidity::new(manifest.turbidity).map_err(|error| error.to_string())?;
    let axes = &manifest.axes;
    let nodes = [&axes.zenith_angle_deg, &axes.observer_altitude_m, &axes.elevation_deg];
    let counts = nodes.iter().map(|nodes| nodes.len()).chain([axes.azimuth_count, axes.direct_count]);
    if !counts.into_iter().all(|count| (2..=MAX_AXIS).contains(&count)) {
        return Err("an axis of its manifest has fewer than two points, or more than it can have".to_owned());
    }
    if nodes
        .iter()
        .any(|nodes| !nodes.is_sorted_by(|a, b| a < b) || !nodes.iter().all(|node| node.is_finite()))
    {
        return Err("an axis of its manifest does not rise".to_owned());
    }
    if manifest.log_step != super::LOG_STEP {
        return Err("its numbers have steps that this program does not know".to_owned());
    }
    Ok((manifest, turbidity))
}
