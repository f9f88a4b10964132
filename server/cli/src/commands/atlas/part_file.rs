//! What an unfinished map has found so far: a file that only grows, each part with a checksum. A part that a kill cut short is
//! thrown away at the next opening.

use crate::failure::Failure;
use std::{
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{Read, Seek, SeekFrom, Write},
    path::Path,
    sync::{Mutex, PoisonError},
};

/// First bytes of a file: what it is, then the hash of what it is of.
const MAGIC: &[u8; 16] = b"skyglow atlas  1";
const HASH_BYTES: usize = 32;
/// Of a part before its numbers: its own number and how many numbers there are.
const HEAD_BYTES: usize = 16;

/// The file, open.
pub(super) struct PartFile {
    stored: HashMap<u64, Vec<f32>>,
    /// The file, and what went wrong with it.
    file: Mutex<(File, Option<String>)>,
}

impl PartFile {
    /// Opens what is there of the same map, or begins anew.
    ///
    /// * `key`: what decides the map.
    ///
    /// # Errors
    /// [`Failure::Work`] for a file that cannot be written.
    pub(super) fn open(path: &Path, key: &str) -> Result<Self, Failure> {
        let failure = |error| Failure::file(path, error);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failure)?;
        if file.try_lock().is_err() {
            return Err(Failure::Work(format!("{}: another run writes it", path.display())));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failure)?;
        let mut head = MAGIC.to_vec();
        head.extend(blake3::hash(key.as_bytes()).as_bytes());
        let (mut stored, mut length) = (HashMap::new(), head.len());
        if bytes.starts_with(&head) {
            while let Some((patch, sums, end)) = part_at(&bytes, length) {
                stored.insert(patch, sums);
                length = end;
            }
            tracing::info!(parts = stored.len(), "going on with {}", path.display());
        } else if !bytes.is_empty() && !bytes.starts_with(MAGIC) {
            return Err(Failure::Work(format!(
                "{}: is there already and not of this program",
                path.display()
            )));
        } else {
            file.seek(SeekFrom::Start(0)).and_then(|_| file.write_all(&head)).map_err(failure)?;
        }
        file.set_len(length as u64).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failure)?;
        Ok(Self { stored, file: Mutex::new((file, None)) })
    }

    /// The sums of a patch found before.
    pub(super) fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.stored.get(&patch).filter(|sums| sums.len() == count).cloned()
    }

    /// Adds a patch; false where that is impossible.
    pub(super) fn store(&self, patch: u64, sums: &[f32]) -> bool {
        let bytes = part(patch, sums);
        let mut guard = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let (file, error) = &mut *guard;
        if error.is_none()
            && let Err(problem) = file.write_all(&bytes)
        {
            *error = Some(problem.to_string());
        }
        error.is_none()
    }

    /// What went wrong.
    pub(super) fn error(&self) -> Option<String> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner).1.clone()
    }

    /// Removes a file that is done with, if it is there.
    pub(super) fn remove(path: &Path) {
        if let Err(error) = std::fs::remove_file(path)
            && error.kind() != std::io::ErrorKind::NotFound
        {
            tracing::warn!("{}: {error}", path.display());
        }
    }
}

fn part(patch: u64, sums: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD_BYTES + 4 * sums.len() + HASH_BYTES);
    bytes.extend(patch.to_le_bytes());
    bytes.extend((sums.len() as u64).to_le_bytes());
    bytes.extend(sums.iter().flat_map(|sum| sum.to_le_bytes()));
    let hash = blake3::hash(&bytes);
    bytes.extend(hash.as_bytes());
    bytes
}

/// The part that begins at a byte, and where it ends; None where there is no whole one.
fn part_at(bytes: &[u8], start: usize) -> Option<(u64, Vec<f32>, usize)> {
    let number = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
    let (patch, count) = (number(start)?, usize::try_from(number(start + 8)?).ok()?);
    let first = start + HEAD_BYTES;
    let end = first.checked_add(count.checked_mul(4)?)?;
    let hash = bytes.get(end..end.checked_add(HASH_BYTES)?)?;
    if blake3::hash(&bytes[start..end]).as_bytes() != hash {
        return None;
    }
    let sums =
        bytes[first..end].chunks_exact(4).filter_map(|four| Some(f32::from_le_bytes(four.try_into().ok()?)));
    Some((patch, sums.collect(), end + HASH_BYTES))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What was found is there again but for a cut part and another map begins anew.
    #[test]
    fn a_part_file_goes_on_where_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.tif.part");
        let file = PartFile::open(&path, "a").unwrap();
        assert!(file.load(1, 2).is_none());
        assert!(file.store(1, &[1.0, f32::NAN]) && file.store(7, &[3.5]));
        drop(file);
        let whole = std::fs::read(&path).unwrap();
        for cut in [0, 1, 40] {
            std::fs::write(&path, &whole[..whole.len() - cut]).unwrap();
            let file = PartFile::open(&path, "a").unwrap();
            let first = file.load(1, 2).unwrap();
            assert!(first[0] == 1.0 && first[1].is_nan());
            assert_eq!(file.load(7, 1).is_some(), cut == 0);
            assert!(file.load(7, 2).is_none() && file.error().is_none());
            // What is added after a cut is read again.
            assert!(file.store(9, &[2.0]));
            drop(file);
            assert_eq!(PartFile::open(&path, "a").unwrap().load(9, 1), Some(vec![2.0]));
        }
        let mut damaged = whole.clone();
        damaged[60] ^= 1;
        std::fs::write(&path, &damaged).unwrap();
        assert!(PartFile::open(&path, "a").unwrap().load(1, 2).is_none());
        std::fs::write(&path, &whole).unwrap();
        assert!(PartFile::open(&path, "b").unwrap().load(1, 2).is_none());
        assert!(PartFile::open(&path, "a").unwrap().load(1, 2).is_none());
        let running = PartFile::open(&path, "a").unwrap();
        assert!(PartFile::open(&path, "a").is_err());
        drop(running);
        std::fs::write(&path, b"somebody's own").unwrap();
        assert!(PartFile::open(&path, "a").is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"somebody's own");
        PartFile::remove(&path);
        PartFile::remove(&path);
        assert!(!path.exists());
    }
}
