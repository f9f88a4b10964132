//! The binary files of a scene: named arrays behind one header. Numbers are little endian.
//!
//! `SKYGLOW\x01`, u32 number of sections, then for each: name (16 bytes, zero padded), u64 bytes when
//! unpacked, u64 bytes stored; then the sections one after the other, packed with zstd where that is
//! shorter. Integrity is checked by the checksums in `metadata.json`.
//!
//! Sections whose names begin with `outside` are stored as they are and stay in the file when it is opened: packed tiles, each with a
//! checksum of its own. Such a file has a section `check`, the BLAKE3 hash of the others as they are stored.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::os::unix::fs::FileExt;

const MAGIC: &[u8; 8] = b"SKYGLOW\x01";
const NAME_LENGTH: usize = 16;
const ENTRY_LENGTH: usize = NAME_LENGTH + 16;
/// Fast, and deterministic for one version of zstd.
const ZSTD_LEVEL: i32 = 3;
/// No section unpacks to more than this.
const MAX_SECTION_BYTES: u64 = 1 << 36;

/// Begins the names of sections that stay in the file.
const OUTSIDE: &str = "outside";
/// The hash of the other sections, where there are such.
const CHECK: &str = "check";
/// The most sections of a file.
const MAX_SECTIONS: usize = 1 << 18;

/// What is wrong with the bytes of a file.
pub(crate) type Flaw = String;

/// Packs sections into the bytes of a file.
pub(crate) fn pack(sections: &[(String, Cow<'_, [u8]>)]) -> Result<Vec<u8>, std::io::Error> {
    let has_outside = sections.iter().any(|(name, _)| name.starts_with(OUTSIDE));
    if sections.len() >= MAX_SECTIONS {
        let reason = format!(
            "{} parts are more than a file holds: join the terrain's files first (gdalbuildvrt, gdal_translate)",
            sections.len()
        );
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, reason));
    }
    let mut header = Vec::from(MAGIC);
    header.extend((sections.len() as u32 + u32::from(has_outside)).to_le_bytes());
    let mut entry = |name: &str, raw_bytes: usize, stored_bytes: usize| {
        let mut padded = [0u8; NAME_LENGTH];
        padded[..name.len()].copy_from_slice(name.as_bytes());
        header.extend(padded);
        header.extend((raw_bytes as u64).to_le_bytes());
        header.extend((stored_bytes as u64).to_le_bytes());
    };
    let mut body = Vec::new();
    let mut hasher = blake3::Hasher::new();
    for (name, raw) in sections {
        if name.starts_with(OUTSIDE) {
            entry(name, raw.len(), raw.len());
            body.extend_from_slice(raw);
            continue;
        }
        let packed = zstd::bulk::compress(raw, ZSTD_LEVEL)?;
        let stored = if packed.len() < raw.len() { &packed[..] } else { raw };
        entry(name, raw.len(), stored.len());
        hasher.update(stored);
        body.extend_from_slice(stored);
    }
    if has_outside {
        let hash = hasher.finalize();
        entry(CHECK, hash.as_bytes().len(), hash.as_bytes().len());
        body.extend_from_slice(hash.as_bytes());
    }
    header.extend(body);
    Ok(header)
}

/// A section that stays in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outside {
    /// First byte.
    pub(crate) start: u64,
    pub(crate) bytes: u64,
}

/// A file of sections, read but for those that stay in it.
#[derive(Debug, Default)]
pub(crate) struct Inside {
    /// Name, bytes unpacked, and where it is in `bytes`.
    parts: Vec<(String, u64, std::ops::Range<usize>)>,
    bytes: Vec<u8>,
    outside: BTreeMap<String, Outside>,
}

impl Inside {
    /// None for a file that has no section to leave in it.
    pub(crate) fn read(file: &File) -> std::io::Result<Result<Option<Self>, Flaw>> {
        let mut start = [0u8; 12];
        let length = file.metadata()?.len();
        let count = match length {
            0..12 => 0,
            _ => {
                file.read_exact_at(&mut start, 0)?;
                u32::from_le_bytes([start[8], start[9], start[10], start[11]]) as usize
            }
        };
        let head = 12 + count as u64 * ENTRY_LENGTH as u64;
        if start[..8] != *MAGIC || count > MAX_SECTIONS || head > length {
            return Ok(Err("is not of this program's format".to_owned()));
        }
        let mut entries = vec![0u8; count * ENTRY_LENGTH];
        file.read_exact_at(&mut entries, 12)?;
        if !entries.chunks_exact(ENTRY_LENGTH).any(|entry| entry.starts_with(OUTSIDE.as_bytes())) {
            return Ok(Ok(None));
        }
        let (mut inside, mut at) = (Self::default(), head);
        let mut hasher = blake3::Hasher::new();
        let mut check = Vec::new();
        for entry in entries.chunks_exact(ENTRY_LENGTH) {
            let name = String::from_utf8_lossy(&entry[..NAME_LENGTH]).trim_end_matches('\0').to_owned();
            let number = |from: usize| number::<8>(entry, from).map_or(u64::MAX, u64::from_le_bytes);
            let (raw, stored) = (number(NAME_LENGTH), number(NAME_LENGTH + 8));
            if stored > length - at || raw > MAX_SECTION_BYTES {
                return Ok(Err(format!("ends within its part \"{name}\"")));
            }
            if name.starts_with(OUTSIDE) {
                inside.outside.insert(name, Outside { start: at, bytes: stored });
            } else {
                let first = inside.bytes.len();
                inside.bytes.resize(first + stored as usize, 0);
                file.read_exact_at(&mut inside.bytes[first..], at)?;
                if name == CHECK {
                    check = inside.bytes[first..].to_vec();
                } else {
                    hasher.update(&inside.bytes[first..]);
                }
                inside.parts.push((name, raw, first..first + stored as usize));
            }
            at += stored;
        }
        if *hasher.finalize().as_bytes() != check[..] {
            return Ok(Err("was altered (its checksum is wrong)".to_owned()));
        }
        Ok(Ok(Some(inside)))
    }

    /// The sections.
    pub(crate) fn sections(&self) -> Sections<'_> {
        let part = |(name, raw, range): &(String, u64, std::ops::Range<usize>)| {
            (name.clone(), (*raw as usize, &self.bytes[range.clone()]))
        };
        Sections { entries: self.parts.iter().map(part).collect(), outside: self.outside.clone() }
    }
}

/// The sections of a file, still packed.
#[derive(Debug)]
pub(crate) struct Sections<'a> {
    entries: BTreeMap<String, (usize, &'a [u8])>,
    outside: BTreeMap<String, Outside>,
}

fn number<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], Flaw> {
    let end = "ends within its header";
    bytes.get(at..at + N).and_then(|part| part.try_into().ok()).ok_or_else(|| end.to_owned())
}

impl<'a> Sections<'a> {
    /// Reads the header.
    pub(crate) fn parse(bytes: &'a [u8]) -> Result<Self, Flaw> {
        if number::<8>(bytes, 0)? != *MAGIC {
            return Err("is not of this program's format".to_owned());
        }
        let count = u32::from_le_bytes(number(bytes, 8)?) as usize;
        let mut start = count
            .checked_mul(ENTRY_LENGTH)
            .and_then(|n| n.checked_add(12))
            .filter(|n| *n <= bytes.len())
            .ok_or("ends within its header")?;
        let mut entries = BTreeMap::new();
        for index in 0..count {
            let at = 12 + index * ENTRY_LENGTH;
            let name =
                String::from_utf8_lossy(&number::<NAME_LENGTH>(bytes, at)?).trim_end_matches('\0').to_owned();
            let raw = u64::from_le_bytes(number(bytes, at + NAME_LENGTH)?);
            let stored = u64::from_le_bytes(number(bytes, at + NAME_LENGTH + 8)?) as usize;
            let part = start.checked_add(stored).and_then(|end| bytes.get(start..end));
            let part = part
                .filter(|_| raw <= MAX_SECTION_BYTES)
                .ok_or_else(|| format!("ends within its part \"{name}\""))?;
            entries.insert(name, (raw as usize, part));
            start += stored;
        }
        Ok(Self { entries, outside: BTreeMap::new() })
    }

    /// Bytes of all sections, unpacked.
    pub(crate) fn unpacked_bytes(&self) -> u64 {
        self.entries.values().map(|(raw, _)| *raw as u64).sum()
    }

    /// Whether there is a section of that name here.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.entries.contains_key(name)
    }

    /// Where a section is that stays in the file.
    pub(crate) fn outside(&self, name: &str) -> Option<Outside> {
        self.outside.get(name).copied()
    }

    /// The bytes of a section.
    pub(crate) fn bytes(&self, name: &str) -> Result<Cow<'a, [u8]>, Flaw> {
        let &(raw, stored) = self.entries.get(name).ok_or_else(|| format!("has no part \"{name}\""))?;
        if raw == stored.len() {
            return Ok(Cow::Borrowed(stored));
        }
        match zstd::bulk::decompress(stored, raw) {
            Ok(bytes) if bytes.len() == raw => Ok(Cow::Owned(bytes)),
            _ => Err(format!("does not unpack in its part \"{name}\"")),
        }
    }

    /// A section as numbers.
    pub(crate) fn numbers<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        name: &str,
    ) -> Result<Vec<T>, Flaw> {
        let bytes = self.bytes(name)?;
        if bytes.len() % size_of::<T>() != 0 {
            return Err(format!("holds a broken number in its part \"{name}\""));
        }
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

/// Ascending codes as differences in 7-bit groups, low first; the high bit says that more follow.
pub(crate) fn pack_ascending(codes: &[u64]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(codes.len() * 2);
    let mut previous = 0u64;
    for &code in codes {
        let mut difference = code - previous;
        previous = code;
        while difference >= 0x80 {
            bytes.push((difference & 0x7f) as u8 | 0x80);
            difference >>= 7;
        }
        bytes.push(difference as u8);
    }
    bytes
}

/// Undoes [`pack_ascending`].
pub(crate) fn unpack_ascending(bytes: &[u8]) -> Result<Vec<u64>, Flaw> {
    let mut codes = Vec::with_capacity(bytes.len());
    let (mut code, mut difference, mut shift) = (0u64, 0u64, 0u32);
    for &byte in bytes {
        if shift > 63 {
            return Err("holds a broken code".to_owned());
        }
        difference |= u64::from(byte & 0x7f) << shift;
        shift += 7;
        if byte < 0x80 {
            code = code.checked_add(difference).ok_or("holds a broken code")?;
            codes.push(code);
            (difference, shift) = (0, 0);
        }
    }
    if shift != 0 {
        return Err("ends within a code".to_owned());
    }
    Ok(codes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn packed_codes_come_back(mut codes in proptest::collection::vec(0u64..1 << 40, 0..200)) {
            codes.sort_unstable();
            prop_assert_eq!(unpack_ascending(&pack_ascending(&codes)).unwrap(), codes);
        }

        /// Truncated or altered files are refused or read, without a panic.
        #[test]
        fn damaged_sections_never_panic(
            data in proptest::collection::vec(any::<u8>(), 0..300), cut in 0usize..400, flip in 0usize..400,
        ) {
            let file = pack(&[("a".into(), Cow::Borrowed(&data[..])), ("b".into(), Cow::Borrowed(&[0u8; 200]))]).unwrap();
            let whole = Sections::parse(&file).unwrap();
            prop_assert_eq!(&*whole.bytes("a").unwrap(), &data[..]);
            prop_assert_eq!(whole.numbers::<u32>("b").unwrap(), vec![0u32; 50]);
            let short = &file[..cut.min(file.len() - 1)];
            prop_assert!(Sections::parse(short).is_err());
            let mut changed = file.clone();
            let at = flip % changed.len();
            changed[at] ^= 0x55;
            if let Ok(sections) = Sections::parse(&changed) {
                let _either = (sections.bytes("a"), sections.bytes("b"));
            }
        }
    }
}
