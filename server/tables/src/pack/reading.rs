//! Reads a pack without trusting it: the sizes of its manifest are checked against limits, and the size of each section is
//! checked before memory is allocated for it.

use super::{HASH_LEN, MAGIC, Pack};
use crate::{
    blocked::{BlockedAxes, BlockedTables},
    error::TablesError,
    layout::IMAGE_COUNT,
    manifest::{FORMAT_VERSION, MODEL_VERSION, Manifest, Versions},
    packing::{from_distance_differences, from_steps, unshuffle},
    resident::FREQUENCY_COUNT,
};
use serde::de::DeserializeOwned;
use skyglow_physics::{Band, ELEVATION_COUNT};
use std::path::Path;

/// Points of an axis at most.
const MAX_AXIS: usize = 4096;
/// Bytes of a section at most.
const MAX_SECTION: usize = 1 << 30;
/// Times its packed length that a section can be at most: a few bytes do not make room for everything.
const MAX_RATIO: usize = 1 << 12;

impl Pack {
    /// Reads and checks a pack: magic, format, checksum, manifest, lengths, finite values.
    ///
    /// # Errors
    /// [`TablesError::Refused`] naming the file and what is wrong with it.
    pub fn open(path: &Path) -> Result<Self, TablesError> {
        let bytes = std::fs::read(path).map_err(TablesError::io(path))?;
        let pack = Self::from_bytes(&bytes)
            .map_err(|reason| TablesError::Refused { path: path.to_owned(), reason })?;
        check_beside(path, &pack.manifest)?;
        Ok(pack)
    }

    /// The same of a file's content.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let body = checked_body(bytes, MAGIC)?;
        let mut parts = Parts::new(body);
        let manifest = read_manifest(parts.take("the manifest")?)?;
        let (axes, count) = (&manifest.axes, manifest.basis_count);
        // No axis is long enough for this to overflow.
        let nodes = axes.observer_altitude_m.len() * IMAGE_COUNT * axes.geometries_per_observer();
        let log_scale = bytemuck::pod_collect_to_vec::<u8, f32>(&parts.section("log_scale", &[nodes], 4)?);
        let exponents = bytemuck::pod_collect_to_vec::<u8, i8>(&parts.section("shape_step", &[nodes], 1)?);
        let shape = bytemuck::pod_collect_to_vec::<u8, u16>(&parts.section("shape", &[nodes, count], 2)?);
        let shape = from_steps(&exponents, &shape, manifest.shape_layout());
        let spectrum = parts.section("basis_spectrum", &[count, ELEVATION_COUNT, FREQUENCY_COUNT], 4)?;
        let basis_spectrum = bytemuck::pod_collect_to_vec::<u8, f32>(&spectrum);
        let blocked = manifest.blocked.as_ref().map(|axes| read_blocked(&mut parts, axes)).transpose()?;
        parts.end()?;
        let pack = Self { manifest, log_scale, shape, basis_spectrum, blocked };
        if pack.manifest.checksum != pack.checksum() {
            return Err("its data are not those of its manifest".to_owned());
        }
        if pack.is_finite() { Ok(pack) } else { Err("it holds values that are not finite".to_owned()) }
    }

    /// What a pack that is refused was: what the manifest beside it says, or the one inside it. Nothing of it is checked.
    pub fn manifest_of_refused(path: &Path) -> Option<Manifest> {
        let beside = std::fs::read(path.with_extension("json")).ok();
        if let Some(manifest) = beside.and_then(|text| serde_json::from_slice(&text).ok()) {
            return Some(manifest);
        }
        let bytes = std::fs::read(path).ok()?;
        let mut parts = Parts::new(bytes.get(MAGIC.len()..)?);
        serde_json::from_slice(parts.take("the manifest").ok()?).ok()
    }

    fn is_finite(&self) -> bool {
        self.log_scale.iter().chain(&self.basis_spectrum).all(|v| v.is_finite())
            && self.shape.iter().all(|v| v.is_finite())
            && self.blocked.as_ref().is_none_or(|blocked| {
                blocked.log_part.iter().all(|v| v.is_finite())
                    && blocked.shape_less_open.iter().all(|v| v.is_finite())
            })
    }
}

/// What is between the magic of a file and the hash at its end, which must be that of all before it.
pub(crate) fn checked_body<'a>(bytes: &'a [u8], magic: &[u8; 8]) -> Result<&'a [u8], String> {
    if bytes.len() < magic.len() + 8 + HASH_LEN || !bytes.starts_with(magic) {
        return Err("not a skyglow pack, or cut off at its start".to_owned());
    }
    let (body, hash) = bytes.split_at(bytes.len() - HASH_LEN);
    if blake3::hash(body).as_bytes() != hash {
        return Err("its checksum does not fit its content: it is truncated or altered; make it again with \
                    `skyglow precompute`"
            .to_owned());
    }
    Ok(&body[magic.len()..])
}

/// What is left of a pack's content.
pub(crate) struct Parts<'a> {
    rest: &'a [u8],
}

impl<'a> Parts<'a> {
    pub(crate) fn new(body: &'a [u8]) -> Self {
        Self { rest: body }
    }

    /// Nothing may follow.
    pub(crate) fn end(&self) -> Result<(), String> {
        if self.rest.is_empty() { Ok(()) } else { Err("it goes on behind its last section".to_owned()) }
    }

    /// The bytes behind the next length.
    pub(crate) fn take(&mut self, what: &str) -> Result<&'a [u8], String> {
        let cut_off = || format!("{what} is cut off");
        let (length, tail) = self.rest.split_first_chunk::<8>().ok_or_else(cut_off)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| cut_off())?;
        let (section, tail) = tail.split_at_checked(length).ok_or_else(cut_off)?;
        self.rest = tail;
        Ok(section)
    }

    /// The next section unpacked: values of `width` bytes, as many as the product of the counts.
    pub(crate) fn section(&mut self, what: &str, counts: &[usize], width: usize) -> Result<Vec<u8>, String> {
        let expected = counts
            .iter()
            .try_fold(width, |bytes, count| bytes.checked_mul(*count))
            .filter(|bytes| *bytes <= MAX_SECTION)
            .ok_or_else(|| format!("{what} would be larger than a section can be"))?;
        let packed = self.take(what)?;
        if expected > MAX_RATIO * packed.len() {
            return Err(format!("{what} is {} bytes, too few for {expected}", packed.len()));
        }
        // The stated size is checked before memory is allocated.
        let said = zstd::zstd_safe::get_frame_content_size(packed).ok().flatten();
        if said != Some(expected as u64) {
            let said = said.map_or_else(|| "an unknown number of".to_owned(), |bytes| bytes.to_string());
            return Err(format!("{what} has {said} bytes instead of {expected}"));
        }
        let raw = zstd::bulk::decompress(packed, expected)
            .map_err(|error| format!("{what} cannot be unpacked: {error}"))?;
        if raw.len() != expected {
            return Err(format!("{what} has {} bytes instead of {expected}", raw.len()));
        }
        Ok(unshuffle(&raw, width))
    }
}

fn read_manifest(json: &[u8]) -> Result<Manifest, String> {
    let unreadable = |error: serde_json::Error| format!("its manifest cannot be read: {error}");
    let versions: Versions = serde_json::from_slice(json).map_err(unreadable)?;
    if !versions.are_read() {
        return Err(format!(
            "it has format {} of model {}, this program reads format {FORMAT_VERSION} of model {MODEL_VERSION}; \
             make it again with `skyglow precompute`",
            versions.format_version, versions.model_version
        ));
    }
    let manifest: Manifest = serde_json::from_slice(json).map_err(unreadable)?;
    let bands_nm = Band::ALL.map(Band::wavelength_nm);
    if manifest.bands_nm != bands_nm {
        return Err(format!(
            "its bands are at {:?} nm, those of this program at {bands_nm:?}; make it again with `skyglow precompute`",
            manifest.bands_nm
        ));
    }
    let axes = &manifest.axes;
    let blocked = manifest.blocked.as_ref();
    let counts = [axes.offset_count, manifest.basis_count]
        .into_iter()
        .chain(blocked.into_iter().flat_map(|axes| [axes.offset_count, axes.basis_count]));
    let points = [&axes.distance_m, &axes.observer_altitude_m]
        .into_iter()
        .chain(blocked.into_iter().flat_map(|axes| [&axes.distance_m, &axes.observer_altitude_m]));
    let is_counted = |count: usize| (1..=MAX_AXIS).contains(&count);
    if !counts.chain(points.clone().map(Vec::len)).all(is_counted)
        || axes.offset_count < 3
        || blocked.is_some_and(|axes| axes.basis_count > manifest.basis_count || axes.offset_count < 3)
    {
        return Err("an axis of its manifest is empty, or longer than it can be".to_owned());
    }
    let distances = [&axes.distance_m].into_iter().chain(blocked.map(|axes| &axes.distance_m));
    if points.into_iter().any(|axis| !axis.is_sorted_by(|a, b| a < b))
        || distances.into_iter().any(|axis| axis[0] <= 0.0)
    {
        return Err("an axis of its manifest does not rise, or has distances that are none".to_owned());
    }
    Ok(manifest)
}

fn read_blocked(parts: &mut Parts, axes: &BlockedAxes) -> Result<BlockedTables, String> {
    let nodes = axes.node_count();
    let log_part = parts.section("blocked_log_part", &[nodes], 4)?;
    let differences = parts.section("blocked_shape_less_open", &[nodes, axes.basis_count], 2)?;
    let bits = bytemuck::pod_collect_to_vec::<u8, u16>(&differences);
    Ok(BlockedTables {
        axes: axes.clone(),
        log_part: bytemuck::pod_collect_to_vec(&log_part),
        shape_less_open: from_distance_differences(
            bits,
            axes.distance_m.len(),
            axes.offset_count * axes.basis_count,
        ),
    })
}

/// The manifest beside a pack must be the pack's own.
pub(crate) fn check_beside<M: DeserializeOwned + PartialEq>(
    path: &Path,
    manifest: &M,
) -> Result<(), TablesError> {
    let beside = path.with_extension("json");
    let text = match std::fs::read(&beside) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(TablesError::io(&beside)(error)),
    };
    match serde_json::from_slice::<M>(&text) {
        Ok(other) if &other == manifest => Ok(()),
        Ok(_) => Err(TablesError::Refused {
            path: path.to_owned(),
            reason: format!("{} describes another pack", beside.display()),
        }),
        Err(error) => Err(TablesError::Manifest { path: beside, reason: error.to_string() }),
    }
}
