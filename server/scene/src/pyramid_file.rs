//! The lights of a large scene as they are used, in a file that is mapped into memory: `pyramid.bin` beside the files of the scene.
//!
//! To unpack the lights of a planet and to sum them up in blocks takes seconds and gigabytes. Whoever opens a large scene first
//! does that once and stores what came of it; from then on opening reads a header, and of the lights those are read that somebody
//! asks for. Several processes on one machine share what is read.
//!
//! The file is not listed among those of the scene: like skylines that are made by tile it is made again where it is missing, of
//! another version, cut short or damaged. Who opens it checks its arrays, all but a server, which answers first and reads the file
//! through after its start ([`verify`]). Numbers are as the machine has them.
//!
//! A file on a network's drive is not mapped ([`stays_mapped`]): where another machine replaces it, who looks into it would be ended.
//!
//! Layout: a header of [`Header::bytes`] bytes, behind it the arrays, each at a multiple of [`ALIGNMENT`]: grid and mask as sections
//! (`sections.rs`), then codes, radiances and altitudes of the pixels, then codes and blocks of each level.

use crate::array::{Array, MappedFile};
use crate::grid::Grid;
use crate::grid_sections;
use crate::light_layer::Lights;
use crate::light_pyramid::{Block, LightPyramid};
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::sections::{self, Flaw, Sections};
use rayon::prelude::*;
use std::borrow::Cow;
use std::fs::{File, Permissions};
use std::io::{BufWriter, Read, Write};
use std::ops::Range;
use std::os::unix::fs::{FileExt, PermissionsExt};
use std::path::Path;
use std::time::{Duration, Instant};

/// Its name.
pub(crate) const PYRAMID_FILE: &str = "pyramid.bin";
/// Scenes with fewer lights are opened in tenths of a second, and stay in memory.
pub(crate) const MIN_LIGHTS: u64 = 1 << 20;

/// Begins the file; as a number it tells the order of bytes. The lowest byte counts layouts, and ways in which blocks are summed up.
const MAGIC: u64 = 0x0001_4452_5950_4753;
const FILE_MODE: u32 = 0o640;
/// Begins the names of files that are being written, and how long nobody writes one that is not left over.
const UNFINISHED: &str = ".pyramid-";
const STALE_AFTER: Duration = Duration::from_secs(600);
const ALIGNMENT: usize = 64;
const VERSION_BYTES: usize = 32;
/// Grid and mask, and codes, radiances and altitudes of pixels.
const FIRST_ARRAYS: usize = 4;
/// Read and hashed at a time.
const PART_BYTES: usize = 4 << 20;
/// Levels at most: rasters have 2^24 pixels along a side at most.
const MAX_LEVELS: usize = 24;

/// What a scene's file of lights has.
pub(crate) struct StoredPyramid {
    pub(crate) grid: Grid,
    pub(crate) mask: ValidMask,
    pub(crate) lights: Lights,
}

/// The lengths of the arrays, and their hashes.
struct Header {
    version: String,
    altitude_range_m: Option<[f32; 2]>,
    /// Bytes and BLAKE3 hash.
    arrays: Vec<(usize, blake3::Hash)>,
}

impl Header {
    /// Bytes of a header of so many arrays.
    fn bytes(arrays: usize) -> usize {
        8 + VERSION_BYTES + 8 + 8 + 40 * arrays + blake3::OUT_LEN
    }

    fn write(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_ne_bytes().to_vec();
        bytes.extend(self.version.as_bytes());
        let [lowest, highest] = self.altitude_range_m.unwrap_or([f32::NAN; 2]);
        bytes.extend([lowest.to_ne_bytes(), highest.to_ne_bytes()].concat());
        bytes.extend((self.arrays.len() as u64).to_ne_bytes());
        for (length, hash) in &self.arrays {
            bytes.extend((*length as u64).to_ne_bytes());
            bytes.extend(hash.as_bytes());
        }
        bytes.extend(blake3::hash(&bytes).as_bytes());
        bytes
    }

    /// Undoes [`Self::write`]; None for anything else.
    fn read(file: &[u8]) -> Option<Self> {
        let number = |at: usize| Some(u64::from_ne_bytes(file.get(at..at + 8)?.try_into().ok()?));
        let count = number(16 + VERSION_BYTES)? as usize;
        if number(0)? != MAGIC || !(FIRST_ARRAYS..=FIRST_ARRAYS + 2 * MAX_LEVELS).contains(&count) {
            return None;
        }
        let bytes = file.get(..Self::bytes(count))?;
        let (content, hash) = bytes.split_at(bytes.len() - blake3::OUT_LEN);
        if blake3::hash(content).as_bytes() != hash {
            return None;
        }
        let version = String::from_utf8(content[8..8 + VERSION_BYTES].to_vec()).ok()?;
        let altitude = |at: usize| Some(f32::from_ne_bytes(file.get(at..at + 4)?.try_into().ok()?));
        let range = [altitude(8 + VERSION_BYTES)?, altitude(12 + VERSION_BYTES)?];
        let array = |index: usize| {
            let at = 24 + VERSION_BYTES + 40 * index;
            let hash: [u8; blake3::OUT_LEN] = file.get(at + 8..at + 40)?.try_into().ok()?;
            Some((number(at)? as usize, blake3::Hash::from_bytes(hash)))
        };
        let arrays = (0..count).map(array).collect::<Option<Vec<_>>>()?;
        Some(Self { version, altitude_range_m: range.iter().all(|m| m.is_finite()).then_some(range), arrays })
    }

    /// Where the arrays are.
    fn places(&self) -> Vec<Range<usize>> {
        let mut at = Self::bytes(self.arrays.len());
        let place = |(length, _): &(usize, blake3::Hash)| {
            let start = at.next_multiple_of(ALIGNMENT);
            at = start.saturating_add(*length);
            start..at
        };
        self.arrays.iter().map(place).collect()
    }
}

/// Removes what writers that were killed left long ago.
fn clear_stale(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(UNFINISHED);
        let written = entry.metadata().and_then(|found| found.modified());
        if is_ours && written.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > STALE_AFTER)) {
            let _best_effort = std::fs::remove_file(entry.path());
        }
    }
}

/// Stores the lights of a scene in its folder.
pub(crate) fn write(
    folder: &Path,
    version: &str,
    (grid, mask): (&Grid, &ValidMask),
    lights: &Lights,
) -> std::io::Result<()> {
    let mut frame: Vec<(String, Cow<'_, [u8]>)> = grid_sections::to_sections(grid, "");
    frame.extend(mask.to_sections());
    let frame = sections::pack(&frame)?;
    let pixels = &lights.pixels;
    let mut arrays: Vec<&[u8]> = vec![
        &frame,
        bytemuck::cast_slice(&pixels.codes),
        bytemuck::cast_slice(&pixels.radiance_nw_cm2_sr),
        bytemuck::cast_slice(&pixels.altitude_m),
    ];
    for level in lights.pyramid.levels() {
        arrays.extend([bytemuck::cast_slice(&level.codes), bytemuck::cast_slice::<Block, u8>(&level.blocks)]);
    }
    let header = Header {
        version: version.to_owned(),
        altitude_range_m: lights.altitude_range_m,
        arrays: arrays.iter().map(|array| (array.len(), blake3::hash(array))).collect(),
    };
    let mode = Permissions::from_mode(FILE_MODE);
    clear_stale(folder);
    let file = tempfile::Builder::new().prefix(UNFINISHED).permissions(mode).tempfile_in(folder)?;
    let mut writer = BufWriter::new(file);
    let bytes = header.write();
    writer.write_all(&bytes)?;
    let mut at = bytes.len();
    for (array, place) in arrays.iter().zip(header.places()) {
        writer.write_all(&[0; ALIGNMENT][..place.start - at])?;
        writer.write_all(array)?;
        at = place.end;
    }
    let file = writer.into_inner().map_err(std::io::IntoInnerError::into_error)?;
    // What a power failure leaves is whole, or not there.
    file.as_file().sync_data()?;
    file.persist(folder.join(PYRAMID_FILE)).map(|_| ()).map_err(|error| error.error)
}

/// Kinds of file systems (Linux, `statfs(2)`) that lose a file which another machine replaces while it is open, or may: NFS, SMB,
/// CIFS, 9P, FUSE. Those of clusters (Lustre, Ceph, GPFS) keep it.
const REMOTE_KINDS: [u32; 5] = [0x6969, 0xfe53_4d42, 0xff53_4d42, 0x0102_1997, 0x6573_5546];

/// Whether what is mapped of a folder's files stays there when they are replaced: on this machine's own drives.
pub(crate) fn stays_mapped(folder: &Path) -> bool {
    rustix::fs::statfs(folder).is_ok_and(|found| is_local(found.f_type as u32))
}

fn is_local(kind: u32) -> bool {
    !REMOTE_KINDS.contains(&kind)
}

/// The lights of a scene from the file in its folder; None where there is none of this version, it is cut short, or damaged.
///
/// * `is_checked`: whether all of it is read and compared with its hashes; else the header and the grid alone.
pub(crate) fn open(folder: &Path, version: &str, is_checked: bool) -> Option<StoredPyramid> {
    let file = File::open(folder.join(PYRAMID_FILE)).ok()?;
    let mapped = MappedFile::new(&file).ok()?;
    let header = Header::read(mapped.bytes()).filter(|header| header.version == version)?;
    let places = header.places();
    if places.last()?.end != mapped.bytes().len() || is_checked && !is_whole(&file, None) {
        return None;
    }
    let [frame, codes, radiance, altitude, levels @ ..] = places.as_slice() else { return None };
    let (grid, mask) = read_frame(&mapped.bytes()[frame.clone()], &header.arrays[0].1).ok()?;
    let pixels = LitPixels {
        codes: mapped.array(codes.clone())?,
        radiance_nw_cm2_sr: mapped.array(radiance.clone())?,
        altitude_m: mapped.array(altitude.clone())?,
    };
    let level = |pair: &[Range<usize>]| {
        let [codes, blocks] = pair else { return None };
        Some((mapped.array::<u64>(codes.clone())?, mapped.array::<Block>(blocks.clone())?))
    };
    let levels = levels.chunks(2).map(level).collect::<Option<Vec<(Array<u64>, Array<Block>)>>>()?;
    let fits = pixels.codes.len() == pixels.radiance_nw_cm2_sr.len()
        && pixels.codes.len() == pixels.altitude_m.len()
        && levels.iter().all(|(codes, blocks)| codes.len() == blocks.len());
    let pyramid = LightPyramid::of_levels(levels, pixels.codes.len());
    let altitude_range_m = header.altitude_range_m;
    let lights = Lights { pixels, skylines: None, tiles: None, pyramid, altitude_range_m };
    fits.then_some(StoredPyramid { grid, mask, lights })
}

/// Whether there is a file of this version in a folder.
pub(crate) fn is_there(folder: &Path, version: &str) -> bool {
    let mut start = [0u8; 8 + VERSION_BYTES];
    let read = File::open(folder.join(PYRAMID_FILE)).and_then(|mut file| file.read_exact(&mut start));
    read.is_ok() && start[..8] == MAGIC.to_ne_bytes() && start[8..] == *version.as_bytes()
}

fn read_frame(bytes: &[u8], hash: &blake3::Hash) -> Result<(Grid, ValidMask), Flaw> {
    if blake3::hash(bytes) != *hash {
        return Err("was altered (its checksum is wrong)".to_owned());
    }
    let sections = Sections::parse(bytes)?;
    let grid = grid_sections::from_sections(&sections, "")?;
    let mask = ValidMask::from_sections(&sections, &grid)?;
    Ok((grid, mask))
}

/// Reads the file of a folder through, if there is one, and says whether it is whole. One that is damaged is removed, to be made again.
pub(crate) fn verify(folder: &Path) -> bool {
    let path = folder.join(PYRAMID_FILE);
    let Ok(file) = File::open(&path) else { return true };
    // Where it is not mapped nobody looks into it.
    let is_whole = !stays_mapped(folder) || is_whole(&file, Some(PAUSES));
    if !is_whole {
        let _best_effort = std::fs::remove_file(&path);
    }
    is_whole
}

/// Pauses after each part, in times that it took: those who ask for something meanwhile have three quarters of a core.
const PAUSES: u32 = 3;

/// Whether the arrays of a file have their hashes. Read, not mapped: what is read through this way is not held, and what a disk cannot
/// read is an error.
///
/// * `pauses`: one array after the other, with as many pauses; without it on all cores.
fn is_whole(file: &File, pauses: Option<u32>) -> bool {
    let mut start = Vec::new();
    let most = Header::bytes(FIRST_ARRAYS + 2 * MAX_LEVELS) as u64;
    let read = file.take(most).read_to_end(&mut start);
    let Some(header) = read.ok().and_then(|_| Header::read(&start)) else { return false };
    let places = header.places();
    let arrays = || places.iter().zip(&header.arrays);
    let has_hash = |(place, (_, hash)): (&Range<usize>, &(usize, blake3::Hash))| {
        hash_of(file, place, pauses).is_some_and(|found| found == *hash)
    };
    match pauses {
        Some(_) => arrays().all(has_hash),
        None => arrays().collect::<Vec<_>>().into_par_iter().all(has_hash),
    }
}

/// The hash of a part of a file; None where it cannot be read.
fn hash_of(file: &File, place: &Range<usize>, pauses: Option<u32>) -> Option<blake3::Hash> {
    let mut hasher = blake3::Hasher::new();
    let mut part = vec![0; PART_BYTES.min(place.len())];
    for first in place.clone().step_by(PART_BYTES) {
        let begun = Instant::now();
        let part = &mut part[..PART_BYTES.min(place.end - first)];
        file.read_exact_at(part, first as u64).ok()?;
        hasher.update(part);
        if let Some(pauses) = pauses {
            std::thread::sleep(pauses * begun.elapsed());
        }
    }
    Some(hasher.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ext4, XFS, btrfs, overlay and memory are here; NFS and FUSE may not be.
    #[test]
    fn drives_of_other_machines_are_not_mapped() {
        for kind in [0xef53, 0x5846_5342, 0x9123_683e, 0x794c_7630, 0x0102_1994] {
            assert!(is_local(kind), "{kind:x}");
        }
        assert!(!is_local(0x6969) && !is_local(0x6573_5546));
        assert!(!stays_mapped(Path::new("/no/such/folder")));
    }
}
