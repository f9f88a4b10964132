//! Packs of tables.

use skyglow_tables::pack::Pack;

/// A pack without its hash, which is put behind it here: whoever alters a file can do so too.
pub fn pack(content: &[u8]) {
    let whole = [content, blake3::hash(content).as_bytes()].concat();
    match Pack::from_bytes(&whole) {
        Err(reason) => assert!(!reason.is_empty() && reason.len() < 10_000, "{reason}"),
        Ok(pack) => {
            let nearest_m = pack.manifest().axes.distance_m[0];
            let resident = pack.resident(&[nearest_m, 2.0 * nearest_m, 300_000.0]);
            assert_eq!(resident.ring_distance_m.len(), 3);
        }
    }
}
