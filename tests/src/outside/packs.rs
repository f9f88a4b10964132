//! Packs of tables, and celestial tables.

use skyglow_tables::{CelestialTable, pack::Pack};

/// A celestial table without its hash, which is put behind it here.
pub fn celestial(content: &[u8]) {
    let whole = [content, blake3::hash(content).as_bytes()].concat();
    match CelestialTable::from_bytes(&whole) {
        Err(reason) => assert!(!reason.is_empty() && reason.len() < 10_000, "{reason}"),
        Ok(table) => {
            for (zenith_angle_rad, altitude_m) in [(0.0, 0.0), (1.5, 1e3), (3.0, 1e5), (-1.0, -1e3)] {
                let through = table.transmittance(zenith_angle_rad, altitude_m);
                assert!(through.iter().all(|share| (0.0..=1.0).contains(share)), "{through:?}");
                assert!(table.node_zenith(0, altitude_m).iter().all(|value| !value.is_nan()));
            }
            let sky = table.beam_sky(1.2, 0.3, 500.0);
            assert!(sky.samples().iter().all(|value| *value >= 0.0), "a negative sample, or none");
        }
    }
}

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
