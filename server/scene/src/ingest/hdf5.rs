//! Whether an HDF5 file is complete, by its superblock (HDF5 File Format Specification, versions 0 to 3).

use crate::error::SceneError;
use std::path::Path;

/// Refuses an HDF5 file whose end is missing. The library itself prints pages when it meets such a file, and GDAL says only
/// that it did not open. Other files pass.
///
/// # Errors
/// [`SceneError::Unreadable`] naming both lengths.
pub(super) fn check_length(path: &Path) -> Result<(), SceneError> {
    let mut head = [0u8; 48];
    let mut file = std::fs::File::open(path).map_err(SceneError::io(path))?;
    if std::io::Read::read_exact(&mut file, &mut head).is_err() || head[..8] != *b"\x89HDF\r\n\x1a\n" {
        return Ok(());
    }
    // The address after the last byte, for 8-byte addresses: versions 0 and 1 keep it behind the group
    // parameters (4 bytes more in 1), 2 and 3 behind two addresses.
    let (address_size, at) = match head[8] {
        0 => (head[13], 40),
        2 | 3 => (head[9], 28),
        _ => return Ok(()),
    };
    let mut address = [0u8; 8];
    address.copy_from_slice(&head[at..at + 8]);
    let expected = u64::from_le_bytes(address);
    let found = file.metadata().map_err(SceneError::io(path))?.len();
    if address_size == 8 && found < expected {
        let reason = format!("it is truncated: {found} of {expected} bytes are there");
        return Err(SceneError::Unreadable { path: path.to_owned(), reason });
    }
    Ok(())
}
