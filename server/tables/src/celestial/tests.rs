use super::*;
use skyglow_physics::beam::{BeamField, BeamSetting};

fn table() -> CelestialTable {
    CelestialTable::synthetic(Turbidity::new(2.5).unwrap())
}

/// A sky turns with the source's azimuth and is even about it.
#[test]
fn skies_turn_with_their_source() {
    let table = table();
    let (zenith, altitude_m) = (1.2, 700.0);
    let north = table.beam_sky(zenith, 0.0, altitude_m);
    let east = table.beam_sky(zenith, FRAC_PI_2, altitude_m);
    for row in [0, 20, 63] {
        for column in [0, 3, 100, 200] {
            let turned = east.radiance_w_m2_sr(1, row, (column + 64) % AZIMUTH_COUNT);
            let mirrored = north.radiance_w_m2_sr(1, row, (AZIMUTH_COUNT - column) % AZIMUTH_COUNT);
            let here = north.radiance_w_m2_sr(1, row, column);
            assert!(here > 0.0 && (turned / here - 1.0).abs() < 1e-5, "{here} {turned}");
            assert!((mirrored / here - 1.0).abs() < 1e-5);
        }
    }
}

/// Nodes are the skies of beams at their zenith angles, and beyond the last it is dark.
#[test]
fn nodes_are_skies_at_their_zenith_angles() {
    let table = table();
    let nodes = table.zenith_angle_rad();
    assert!(nodes.is_sorted() && nodes[0] == 0.0 && (40..=50).contains(&nodes.len()), "{}", nodes.len());
    for node in [0, 20, nodes.len() - 1] {
        assert_eq!(table.node_sky(node, 900.0), table.beam_sky(nodes[node], 0.0, 900.0));
    }
    assert_eq!(table.beam_sky(2.0, 0.0, 0.0), Panorama::dark());
    assert_eq!(table.node_sky(10, 9_000.0), table.node_sky(10, 4_500.0));
}

/// The direct beam weakens towards the horizon and is nothing below it.
#[test]
fn the_direct_beam_ends_at_the_horizon() {
    let table = table();
    let through = |zenith: f64| table.transmittance(zenith, 300.0)[0];
    assert!(through(0.0) > through(1.0) && through(1.0) > through(1.5) && through(1.5) > 0.0);
    assert_eq!(through(1.7), 0.0);
}

/// Stored values come back as they were.
#[test]
fn files_hold_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = table();
    table.manifest.checksum = table.data_checksum();
    let path = table.write(folder.path()).unwrap();
    assert_eq!(path.file_name().unwrap(), "turbidity-2.50-celestial.skyglow");
    assert_eq!(crate::packs_in(folder.path()).unwrap(), Vec::<std::path::PathBuf>::new());
    assert_eq!(crate::celestial_tables_in(folder.path()).unwrap(), vec![path.clone()]);
    let read = CelestialTable::open(&path).unwrap();
    assert_eq!(
        (&read.scattered, &read.direct, &read.manifest),
        (&table.scattered, &table.direct, &table.manifest)
    );
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert!(CelestialTable::from_bytes(&bytes).unwrap_err().contains("checksum"));
    assert!(CelestialTable::from_bytes(&bytes[..7]).is_err());
}

/// A table of the usual size is within 2 % of the solver in 99 of 100 directions, and small.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn tables_are_near_the_solver_and_small() {
    let table = CelestialTable::make(Turbidity::new(2.5).unwrap(), &CelestialOptions::default()).unwrap();
    let error = &table.manifest().measured_error;
    assert!(error.samples > 4_000 && error.mean > 0.0, "{error:?}");
    assert!(error.mean < 0.004 && error.p99 < 0.02 && error.zenith_largest < 0.015, "{error:?}");
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::metadata(table.write(folder.path()).unwrap()).unwrap().len();
    assert!(bytes < 400_000, "{bytes}");
    let field = BeamField::solve(BeamSetting::new(BeamAir::new(Turbidity::new(2.5).unwrap())));
    for (zenith, altitude_m) in [(0.3, 0.0), (1.2, 300.0), (1.5, 300.0), (1.56, 2_000.0), (1.58, 2_000.0)] {
        let exact = field.transmittance(altitude_m, zenith);
        for (got, exact) in table.transmittance(zenith, altitude_m).into_iter().zip(exact) {
            assert!((got / exact - 1.0).abs() < 0.03, "{zenith} {altitude_m}: {got} {exact}");
        }
    }
}
