//! HDF5 files, before they are read: that they are complete, by the superblock (HDF5 File Format Specification, versions 0 to 3), and
//! that all they hold lies in them. HDF5 can take the numbers of a dataset from any file of the machine (external storage), stand for
//! objects of other files (external links), and piece datasets together from other files (virtual datasets).

use crate::error::SceneError;
use hdf5_metno_sys::{
    h5::{H5_index_t, H5_iter_order_t, H5dont_atexit, herr_t},
    h5d::{H5D_layout_t, H5Dget_create_plist},
    h5e::{H5E_DEFAULT, H5Eset_auto2},
    h5f::{H5F_ACC_RDONLY, H5Fclose, H5Fis_hdf5, H5Fopen},
    h5i::{H5I_type_t, H5Iget_type, hid_t},
    h5l::{H5L_info1_t, H5L_type_t, H5Lvisit1},
    h5o::{H5Oclose, H5Oopen},
    h5p::{H5P_DEFAULT, H5Pclose, H5Pget_external_count, H5Pget_layout},
};
use std::{
    ffi::{CStr, CString, c_char, c_int, c_void},
    io::{Read, Seek},
    path::Path,
};

/// Refuses an HDF5 file that is not complete or refers to other files. Files of other formats pass.
///
/// # Errors
/// [`SceneError::Unreadable`], [`SceneError::Refused`].
pub(super) fn check(path: &Path) -> Result<(), SceneError> {
    check_length(path)?;
    let unreadable =
        |reason: &str| SceneError::Unreadable { path: path.to_owned(), reason: reason.to_owned() };
    let name = CString::new(path.as_os_str().as_encoded_bytes())
        .map_err(|_| unreadable("its name has a zero byte"))?;
    match foreign_part(&name) {
        Ok(None) => Ok(()),
        Ok(Some(what)) => Err(SceneError::Refused {
            path: path.to_owned(),
            reason: format!(
                "{what}, which is not allowed; copy all that it refers to into one file: h5repack, or gdal_translate to a GeoTIFF"
            ),
        }),
        Err(NotReadable) => Err(unreadable("its HDF5 structure is broken")),
    }
}

/// Refuses an HDF5 file whose end is missing. The library itself prints pages when it meets such a file, and GDAL says only
/// that it did not open.
fn check_length(path: &Path) -> Result<(), SceneError> {
    let mut head = [0u8; 48];
    let mut file = std::fs::File::open(path).map_err(SceneError::io(path))?;
    if file.read_exact(&mut head).is_err() || head[..8] != *b"\x89HDF\r\n\x1a\n" {
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
    let found = file.seek(std::io::SeekFrom::End(0)).map_err(SceneError::io(path))?;
    if address_size == 8 && found < expected {
        let reason = format!("it is truncated: {found} of {expected} bytes are there");
        return Err(SceneError::Unreadable { path: path.to_owned(), reason });
    }
    Ok(())
}

/// The library says that a file, or a part of it, is not as it should be.
struct NotReadable;

/// What of an HDF5 file lies in other files; None where all is its own, and for what is no HDF5.
fn foreign_part(name: &CStr) -> Result<Option<String>, NotReadable> {
    let mut found = None;
    #[expect(unsafe_code, reason = "no crate lists links of all kinds, and storage, by calls that are safe")]
    // SAFETY: the name ends with a zero byte and outlives the calls; the file is closed once, after the visit; `visit` has the
    // signature that is asked for, and gets a pointer to `found`, which outlives the visit and is not used meanwhile.
    unsafe {
        // No pages on standard error, nor at the end of the program about what a broken file left open.
        H5dont_atexit();
        H5Eset_auto2(H5E_DEFAULT, None, std::ptr::null_mut());
        match H5Fis_hdf5(name.as_ptr()) {
            0 => return Ok(None),
            1.. => {}
            _ => return Err(NotReadable),
        }
        let file = H5Fopen(name.as_ptr(), H5F_ACC_RDONLY, H5P_DEFAULT);
        if file < 0 {
            return Err(NotReadable);
        }
        let data = (&raw mut found).cast::<c_void>();
        let visited =
            H5Lvisit1(file, H5_index_t::H5_INDEX_NAME, H5_iter_order_t::H5_ITER_NATIVE, Some(visit), data);
        H5Fclose(file);
        if visited < 0 { Err(NotReadable) } else { Ok(found) }
    }
}

/// Looks at one link, and at the storage of the dataset behind it: negative ends the visit as a failure, 1 as done, 0 goes on.
#[expect(unsafe_code, reason = "HDF5 calls it")]
unsafe extern "C" fn visit(
    group: hid_t,
    name: *const c_char,
    info: *const H5L_info1_t,
    data: *mut c_void,
) -> herr_t {
    const HARD: c_int = H5L_type_t::H5L_TYPE_HARD as c_int;
    const SOFT: c_int = H5L_type_t::H5L_TYPE_SOFT as c_int;
    // SAFETY: HDF5 gives an open group, a name that ends with a zero byte, and a filled structure, for as long as this runs, and
    // `data` as `foreign_part` gave it. The kind is read as a number, for it can be one that the enumeration lacks. Whatever is
    // opened is closed once.
    unsafe {
        let shown = || {
            CStr::from_ptr(name)
                .to_string_lossy()
                .chars()
                .filter(|c| !c.is_control())
                .take(80)
                .collect::<String>()
        };
        let refuse = |what: String| {
            *data.cast::<Option<String>>() = Some(what);
            1
        };
        match (&raw const (*info).type_).cast::<c_int>().read() {
            HARD => {}
            // Stays within the file.
            SOFT => return 0,
            _ => return refuse(format!("{} is a link to another file (external link)", shown())),
        }
        let object = H5Oopen(group, name, H5P_DEFAULT);
        if object < 0 {
            return -1;
        }
        let mut end = 0;
        if H5Iget_type(object) == H5I_type_t::H5I_DATASET {
            let properties = H5Dget_create_plist(object);
            let (files, layout) = (H5Pget_external_count(properties), H5Pget_layout(properties));
            end = match layout {
                H5D_layout_t::H5D_LAYOUT_ERROR => -1,
                _ if files < 0 => -1,
                H5D_layout_t::H5D_VIRTUAL => {
                    refuse(format!("{} is pieced together from other files (virtual dataset)", shown()))
                }
                _ if files > 0 => {
                    refuse(format!("the numbers of {} lie in other files (external storage)", shown()))
                }
                _ => 0,
            };
            H5Pclose(properties);
        }
        H5Oclose(object);
        end
    }
}

#[cfg(test)]
#[path = "hdf5_tests.rs"]
mod tests;
