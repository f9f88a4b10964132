//! The pack file: a readable manifest and four or six compressed sections, checked before use.
//!
//! Layout: magic, manifest length (u64 LE), manifest (JSON), then each section as length (u64 LE) and a zstd
//! frame of its bytes with equal byte positions side by side, and at the end the BLAKE3 of all before it. Shape
//! coefficients are whole steps, a size a node, packed as what they are off the line through the two distances before;
//! those of sources behind skylines as differences of their bits (`packing.rs`).
//! The manifest lies beside the pack as `.json` too; the two must agree.

use crate::{
    axes::OffsetAxis,
    blocked::BlockedTables,
    clouds::Clouds,
    error::TablesError,
    manifest::{Manifest, Scattering},
    packing::{distance_differences, round_mantissas, round_to_steps, shuffle, to_steps},
    resident::ResidentTables,
};
use half::{f16, slice::HalfFloatSliceExt};
use rayon::prelude::*;
use skyglow_physics::interpolation::Stencil;
use std::{
    fs::File,
    io::Write,
    path::{Path, PathBuf},
};

pub(crate) mod reading;

const MAGIC: &[u8; 8] = b"SKYGLOW\x01";
const HASH_LEN: usize = 32;
/// File name ending of packs.
pub const PACK_EXTENSION: &str = "skyglow";
/// End of the names of celestial tables, before that ending.
const CELESTIAL_NAME_END: &str = "-celestial";

/// One turbidity's tables at their own sample points.
#[derive(Clone, Debug)]
pub struct Pack {
    manifest: Manifest,
    /// ln scale, `[observer_altitude][lobe][band][distance][offset]`.
    pub(crate) log_scale: Vec<f32>,
    /// Shape coefficients, the same with `[basis]` last.
    pub(crate) shape: Vec<f16>,
    /// `[basis][elevation][frequency]`.
    pub(crate) basis_spectrum: Vec<f32>,
    /// Sources behind skylines.
    pub(crate) blocked: Option<BlockedTables>,
}

/// Packs in a folder, by file name; celestial tables are not among them.
///
/// # Errors
/// [`TablesError::Io`] when the folder cannot be read.
pub fn packs_in(folder: &Path) -> Result<Vec<PathBuf>, TablesError> {
    let mut files = files_in(folder)?;
    files.retain(|path| !is_celestial(path));
    Ok(files)
}

/// Celestial tables in a folder, by file name.
///
/// # Errors
/// [`TablesError::Io`] when the folder cannot be read.
pub fn celestial_tables_in(folder: &Path) -> Result<Vec<PathBuf>, TablesError> {
    let mut files = files_in(folder)?;
    files.retain(|path| is_celestial(path));
    Ok(files)
}

/// File name of a celestial table, without folder.
pub(crate) fn celestial_file_name(turbidity: f64) -> String {
    format!("turbidity-{turbidity:.2}{CELESTIAL_NAME_END}.{PACK_EXTENSION}")
}

fn is_celestial(path: &Path) -> bool {
    path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with(CELESTIAL_NAME_END))
}

fn files_in(folder: &Path) -> Result<Vec<PathBuf>, TablesError> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(TablesError::io(folder))? {
        let path = entry.map_err(TablesError::io(folder))?.path();
        if path.extension().is_some_and(|extension| extension == PACK_EXTENSION) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// File name of a pack, without folder.
pub fn pack_file_name(turbidity: f64, scattering: Scattering, clouds: Option<Clouds>) -> String {
    format!(
        "turbidity-{turbidity:.2}-{}{}.{PACK_EXTENSION}",
        scattering.name(),
        Clouds::file_name_part(clouds)
    )
}

impl Pack {
    /// From parts as they were computed, without sources behind skylines; coefficients and basis are rounded to what a file
    /// holds, and the manifest's checksum is set.
    pub(crate) fn from_computed(
        manifest: Manifest,
        log_scale: Vec<f32>,
        mut shape: Vec<f16>,
        mut basis_spectrum: Vec<f32>,
    ) -> Self {
        round_to_steps(&mut shape, manifest.basis_count);
        round_mantissas(&mut basis_spectrum);
        let mut pack = Self { manifest, log_scale, shape, basis_spectrum, blocked: None };
        pack.set_checksum();
        pack
    }

    /// Adds the tables of sources behind skylines.
    pub(crate) fn set_blocked(&mut self, blocked: BlockedTables) {
        self.blocked = Some(blocked);
        self.set_checksum();
    }

    fn set_checksum(&mut self) {
        self.manifest.checksum = self.checksum();
    }

    /// BLAKE3 of the data, hexadecimal.
    fn checksum(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(bytemuck::cast_slice(&self.log_scale));
        hasher.update(bytemuck::cast_slice(&self.shape));
        hasher.update(bytemuck::cast_slice(&self.basis_spectrum));
        if let Some(blocked) = &self.blocked {
            hasher.update(bytemuck::cast_slice(&blocked.log_part));
            hasher.update(bytemuck::cast_slice(&blocked.shape_less_open));
        }
        hasher.finalize().to_hex().to_string()
    }

    /// What the pack is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    pub(crate) fn manifest_mut(&mut self) -> &mut Manifest {
        &mut self.manifest
    }

    /// Writes the pack and its manifest to a folder, each under a temporary name that is renamed when it is
    /// whole and on disk. Returns the pack's path.
    ///
    /// # Errors
    /// [`TablesError`] naming the file.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, TablesError> {
        let path = folder.join(pack_file_name(
            self.manifest.turbidity,
            self.manifest.scattering,
            self.manifest.clouds,
        ));
        let json = serde_json::to_vec_pretty(&self.manifest)
            .map_err(|error| TablesError::Manifest { path: path.clone(), reason: error.to_string() })?;
        let bytes = self.encoded(&json, &path)?;
        write_atomically(&path, &bytes)?;
        write_atomically(&path.with_extension("json"), &[json.as_slice(), b"\n"].concat())?;
        Ok(path)
    }

    /// The file's bytes around a manifest; `path` is for errors. In the format that the manifest says.
    fn encoded(&self, json: &[u8], path: &Path) -> Result<Vec<u8>, TablesError> {
        let (exponents, shape) = to_steps(&self.shape, self.manifest.shape_layout());
        let mut sections: Vec<(&[u8], usize)> = vec![
            (bytemuck::cast_slice(&self.log_scale), 4),
            (bytemuck::cast_slice(&exponents), 1),
            (bytemuck::cast_slice(&shape), 2),
            (bytemuck::cast_slice(&self.basis_spectrum), 4),
        ];
        let differences = self.blocked.as_ref().map(|blocked| {
            let axes = &blocked.axes;
            let row = axes.offset_count * axes.basis_count;
            (&blocked.log_part, distance_differences(&blocked.shape_less_open, axes.distance_m.len(), row))
        });
        if let Some((log_part, shape_less_open)) = &differences {
            sections.push((bytemuck::cast_slice(log_part), 4));
            sections.push((bytemuck::cast_slice(shape_less_open), 2));
        }
        file_bytes(MAGIC, json, &sections).map_err(TablesError::io(path))
    }

    /// The pack on the rings of a polar grid: cubic interpolation in ln r at constant fractional offset node.
    pub fn resident(&self, ring_distance_m: &[f64]) -> ResidentTables {
        let axes = &self.manifest.axes;
        let (distances, offsets) = (axes.distance_m.len(), axes.offset_count);
        let count = self.manifest.basis_count;
        let log_distance: Vec<f64> = axes.distance_m.iter().map(|d| d.ln()).collect();
        let stencils: Vec<Stencil> =
            ring_distance_m.iter().map(|d| Stencil::lagrange(&log_distance, d.ln())).collect();
        let rings = ring_distance_m.len();
        let mut log_scale = vec![0.0f32; self.log_scale.len() / distances * rings];
        log_scale
            .par_chunks_exact_mut(rings * offsets)
            .zip(self.log_scale.par_chunks_exact(distances * offsets))
            .for_each(|(out, table)| {
                for (ring, stencil) in stencils.iter().enumerate() {
                    for offset in 0..offsets {
                        let sum = stencil.sum(|distance| f64::from(table[distance * offsets + offset]));
                        out[ring * offsets + offset] = sum as f32;
                    }
                }
            });
        let shape = self.shape_on_rings(&stencils);
        let mut tables = ResidentTables {
            turbidity: self.manifest.turbidity,
            scattering: self.manifest.scattering,
            clouds: self.manifest.clouds,
            checksum: self.manifest.checksum.clone(),
            is_synthetic: false,
            observer_altitude_m: axes.observer_altitude_m.clone(),
            offset_count: offsets,
            offset_axis: ring_distance_m.iter().map(|&d| OffsetAxis::at_distance(d, offsets)).collect(),
            ring_distance_m: ring_distance_m.to_vec(),
            basis_count: count,
            log_scale,
            shape,
            basis_spectrum: self.basis_spectrum.clone(),
            blocked: None,
        };
        tables.blocked = self.blocked.as_ref().map(|blocked| blocked.resident(&tables));
        tables
    }

    /// Shape coefficients on rings with these stencils of distances, `[ring][offset][observer_altitude][lobe][band][basis]`.
    fn shape_on_rings(&self, stencils: &[Stencil]) -> Vec<f16> {
        let axes = &self.manifest.axes;
        let (offsets, count) = (axes.offset_count, self.manifest.basis_count);
        let row = offsets * count;
        let table = axes.distance_m.len() * row;
        let images = self.shape.len() / table;
        let mut wide = vec![0.0f32; self.shape.len()];
        wide.par_chunks_mut(table)
            .zip(self.shape.par_chunks(table))
            .for_each(|(wide, table)| table.convert_to_f32_slice(wide));
        let mut shape = vec![f16::ZERO; images * row * stencils.len()];
        shape.par_chunks_exact_mut(images * row).zip(stencils).for_each(|(out, stencil)| {
            let mut sum = vec![0.0f32; row];
            for (image, table) in wide.chunks_exact(table).enumerate() {
                sum.fill(0.0);
                for (d, w) in stencil {
                    let w = w as f32;
                    for (sum, value) in sum.iter_mut().zip(&table[d * row..(d + 1) * row]) {
                        *sum += w * value;
                    }
                }
                for (offset, sum) in sum.chunks_exact(count).enumerate() {
                    out[(offset * images + image) * count..][..count].convert_from_f32_slice(sum);
                }
            }
        });
        shape
    }
}

/// A file of a magic, a manifest and compressed sections with the width of their values, as `reading` reads it.
pub(crate) fn file_bytes(
    magic: &[u8; 8],
    json: &[u8],
    sections: &[(&[u8], usize)],
) -> std::io::Result<Vec<u8>> {
    let mut bytes = magic.to_vec();
    bytes.extend_from_slice(&(json.len() as u64).to_le_bytes());
    bytes.extend_from_slice(json);
    for &(section, width) in sections {
        let packed = zstd::bulk::compress(&shuffle(section, width), 19)?;
        bytes.extend_from_slice(&(packed.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&packed);
    }
    bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
    Ok(bytes)
}

/// Writes under a temporary name, flushes to disk, renames.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), TablesError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".tmp");
    let temporary = path.with_file_name(name);
    let write = || -> std::io::Result<()> {
        let mut file = File::create(&temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(&temporary, path)
    };
    write().map_err(|error| {
        // Best effort: the error that matters is the first one.
        let _ = std::fs::remove_file(&temporary);
        TablesError::io(path)(error)
    })
}
