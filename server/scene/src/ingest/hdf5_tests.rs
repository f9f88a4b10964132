//! Files are made with the library itself, each with one thing that lies in another file.

use super::check;
use crate::ingest::{IngestOptions, ingest};
use crate::scene_id::SceneId;
use crate::store::SceneStore;
use hdf5_metno_sys::{
    h5::*,
    h5d::*,
    h5f::*,
    h5g::{H5Gclose, H5Gcreate2},
    h5i::hid_t,
    h5l::*,
    h5p::*,
    h5s::*,
    h5t::*,
};
use std::ffi::{CStr, CString};
use std::io::Write;
use std::path::{Path, PathBuf};

const NAME: &CStr = c"Gap_Filled_DNB_BRDF-Corrected_NTL";
const SIDE: u64 = 16;

/// What is wrong with a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Sound,
    ExternalStorage,
    /// The same behind a user block, where the signature is not at the beginning, in a group.
    Hidden,
    ExternalLink,
    Virtual,
}

fn text(path: &Path) -> CString {
    CString::new(path.as_os_str().as_encoded_bytes()).unwrap()
}

/// A granule of one dataset, in `folder`; its numbers, or a file of them, lie in `other`.
fn granule(folder: &Path, kind: Kind, other: &Path) -> PathBuf {
    let path = folder.join(format!("{kind:?}.h21v09.h5"));
    let other = text(other);
    #[expect(unsafe_code, reason = "the library's own calls")]
    // SAFETY: names end with a zero byte and outlive the calls, and so does the array of numbers.
    unsafe {
        H5open();
        let creation = H5Pcreate(*H5P_CLS_FILE_CREATE);
        if kind == Kind::Hidden {
            assert!(H5Pset_userblock(creation, 1024) >= 0);
        }
        let file = H5Fcreate(text(&path).as_ptr(), H5F_ACC_TRUNC, creation, H5P_DEFAULT);
        assert!(file > 0);
        let group: hid_t = match kind {
            Kind::Hidden => H5Gcreate2(file, c"deep".as_ptr(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            _ => file,
        };
        let sides: [hsize_t; 2] = [SIDE, SIDE];
        let space = H5Screate_simple(2, sides.as_ptr(), std::ptr::null());
        let properties = H5Pcreate(*H5P_CLS_DATASET_CREATE);
        let made = match kind {
            Kind::Sound => 0,
            Kind::ExternalStorage | Kind::Hidden => {
                H5Pset_external(properties, other.as_ptr(), 0, SIDE * SIDE)
            }
            Kind::Virtual => H5Pset_virtual(properties, space, other.as_ptr(), NAME.as_ptr(), space),
            Kind::ExternalLink => H5Lcreate_external(
                other.as_ptr(),
                NAME.as_ptr(),
                file,
                c"elsewhere".as_ptr(),
                H5P_DEFAULT,
                H5P_DEFAULT,
            ),
        };
        assert!(made >= 0 && group > 0);
        // A soft link stays within its file.
        assert!(H5Lcreate_soft(NAME.as_ptr(), file, c"here".as_ptr(), H5P_DEFAULT, H5P_DEFAULT) >= 0);
        let dataset =
            H5Dcreate2(group, NAME.as_ptr(), *H5T_NATIVE_UCHAR, space, H5P_DEFAULT, properties, H5P_DEFAULT);
        assert!(dataset > 0);
        if matches!(kind, Kind::Sound | Kind::ExternalLink) {
            let numbers: Vec<u8> = (0..(SIDE * SIDE) as usize).map(|i| 1 + (i % 97) as u8).collect();
            let numbers = numbers.as_ptr().cast();
            assert!(H5Dwrite(dataset, *H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
        }
        H5Dclose(dataset);
        H5Pclose(properties);
        H5Pclose(creation);
        H5Sclose(space);
        if group != file {
            H5Gclose(group);
        }
        assert!(H5Fclose(file) >= 0);
    }
    path
}

fn refusal(folder: &Path, path: &Path, max_pixels: Option<u64>) -> Option<String> {
    let mut options = IngestOptions::new(path);
    options.id = Some(SceneId::parse("town").unwrap());
    (options.max_pixels, options.scale, options.band, options.replace) =
        (max_pixels, Some(1.0), Some("1".into()), true);
    ingest(&SceneStore::new(folder), &options, &mut |_| {}).err().map(|error| error.to_string())
}

/// A file that takes anything from another is refused, from whoever it is, packed or not; one that holds all its own is read.
#[test]
fn hdf5_that_refers_to_files_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let secret = folder.path().join("secret");
    std::fs::write(&secret, vec![b'x'; (SIDE * SIDE) as usize]).unwrap();
    let sound = granule(folder.path(), Kind::Sound, &secret);
    for (kind, said) in [
        (Kind::ExternalStorage, "external storage"),
        (Kind::Hidden, "external storage"),
        (Kind::ExternalLink, "external link"),
        (Kind::Virtual, "virtual dataset"),
    ] {
        let other = if kind == Kind::Virtual || kind == Kind::ExternalLink { &sound } else { &secret };
        let path = granule(folder.path(), kind, other);
        let packed = folder.path().join(format!("{kind:?}.h21v09.h5.gz"));
        let mut gzip = flate2::write::GzEncoder::new(
            std::fs::File::create(&packed).unwrap(),
            flate2::Compression::fast(),
        );
        gzip.write_all(&std::fs::read(&path).unwrap()).unwrap();
        gzip.finish().unwrap();
        for path in [&path, &packed] {
            for max_pixels in [None, Some(1 << 20)] {
                let told = refusal(folder.path(), path, max_pixels).unwrap();
                assert!(told.contains(said) && told.contains("not allowed"), "{kind:?}: {told}");
            }
        }
        assert!(!folder.path().join("scenes/town").exists());
    }
    assert_eq!(refusal(folder.path(), &sound, Some(1 << 20)), None);
}

/// A link of a kind that nobody has made up yet is refused, and so is a structure that breaks.
#[test]
fn strange_and_broken_hdf5_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = granule(folder.path(), Kind::ExternalLink, folder.path());
    let bytes = std::fs::read(&path).unwrap();
    let name = bytes.windows(9).position(|word| word == b"elsewhere").unwrap();
    // The kind of the link, before the length of its name: 64 is that of external ones.
    assert_eq!(bytes[name - 2], 64);
    for kind in [65, 255, 7] {
        let mut strange = bytes.clone();
        strange[name - 2] = kind;
        std::fs::write(&path, &strange).unwrap();
        assert!(check(&path).is_err(), "{kind}");
    }
    let sound = granule(folder.path(), Kind::Sound, folder.path());
    let mut broken = std::fs::read(&sound).unwrap();
    broken[96..600].fill(0xa5);
    std::fs::write(&sound, broken).unwrap();
    assert!(check(&sound).unwrap_err().to_string().contains("broken"));
}
