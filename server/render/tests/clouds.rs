//! Packs under clouds beside those of a clear sky.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use skyglow_physics::{BAND_COUNT, EmissionMix, Turbidity};
use skyglow_render::{PackKind, RenderError, RenderRequest, TableSet, prepare::Prepared, synthetic};
use skyglow_tables::{Clouds, Scattering};
use std::sync::Arc;

const BASE_M: u32 = 1_000;

/// Clear packs for turbidity 2 and 3, one under clouds for 2.5 whose observers end below them.
fn set() -> TableSet {
    let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
    let mut closed = synthetic::under_clouds(synthetic::table_set(&[2.5], 8), BASE_M);
    for altitude_m in &mut Arc::make_mut(&mut closed[0]).observer_altitude_m {
        *altitude_m *= 900.0 / 6_000.0;
    }
    tables.extend(closed);
    TableSet::new(tables).unwrap()
}

/// Lights at the altitudes given, on rings of their own, seen from 300 m.
fn asked(altitudes_m: &[f32], cloud_base_m: Option<u32>) -> RenderRequest {
    let lights: Vec<_> =
        (20..).zip(altitudes_m).map(|(ring, &altitude_m)| (7, ring, 5.0, altitude_m)).collect();
    RenderRequest {
        polar: Arc::new(synthetic::polar_grid_of(&lights)),
        observer_altitude_m: 300.0,
        turbidity: Turbidity::new(2.5).unwrap(),
        scattering: Scattering::Single,
        cloud_base_m,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: [1.0; BAND_COUNT],
        basis: None,
    }
}

/// A sky is rendered from the packs of its own clouds.
#[test]
fn a_sky_takes_the_packs_of_its_own_clouds() {
    let set = set();
    let taken = |cloud_base_m| {
        let prepared = Prepared::new(&asked(&[10.0], cloud_base_m), &set).unwrap();
        prepared.turbidity_stencil.nodes().map(|index| set.tables()[index].turbidity).collect::<Vec<_>>()
    };
    assert_eq!(taken(None), [2.0, 3.0]);
    assert_eq!(taken(Some(BASE_M)), [2.5]);
    let refused = Prepared::new(&asked(&[10.0], Some(1_500)), &set).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "no packs with single scattering under clouds at 1500 m are resident; resident is single scattering, single \
         scattering under clouds at 1000 m"
    );
    assert_eq!(set.kinds()[0].kind, PackKind { cloud_base_m: None, scattering: Scattering::Single });
}

#[test]
fn each_kind_is_read_at_its_own_altitudes() {
    let set = set();
    // The made-up packs have nodes at 0, 500, 1 200, 2 500, 4 000 and 6 000 m, or at as many parts of 900 m.
    let node = |cloud_base_m, observer_altitude_m| {
        let asked = RenderRequest { observer_altitude_m, ..asked(&[10.0], cloud_base_m) };
        let stencil = Prepared::new(&asked, &set).unwrap().altitude_stencil;
        assert_eq!(stencil.nodes().len(), 1, "{stencil:?}");
        stencil.nodes().start
    };
    assert_eq!((node(None, 500.0), node(None, 6_000.0)), (1, 5));
    assert_eq!((node(Some(BASE_M), 75.0), node(Some(BASE_M), 900.0)), (1, 5));
    assert_eq!(set.highest_observer_m(), 6_000.0);
}

/// No light comes through clouds and none is worked on.
#[test]
fn no_light_comes_through_clouds() {
    let set = set();
    let work = |cloud_base_m| {
        let altitudes_m = [10.0, 990.0, 1_000.0, 2_500.0];
        Prepared::new(&asked(&altitudes_m, cloud_base_m), &set).unwrap().work()
    };
    assert_eq!(work(None).lit_cells, 4);
    assert_eq!(work(Some(BASE_M)).lit_cells, 2);
    assert!(work(Some(BASE_M)).mixed_nodes < work(None).mixed_nodes);
    assert!(Prepared::new(&asked(&[1_200.0], Some(BASE_M)), &set).unwrap().is_dark());
}

/// An observer in the clouds or above them is refused.
#[test]
fn observers_at_or_above_clouds_are_refused() {
    let set = set();
    let at = |observer_altitude_m, cloud_base_m| {
        Prepared::new(&RenderRequest { observer_altitude_m, ..asked(&[10.0], cloud_base_m) }, &set)
    };
    let highest_m = Clouds::new(BASE_M, 0.5).unwrap().ceiling_m();
    assert!(at(highest_m, Some(BASE_M)).is_ok());
    assert!(at(highest_m + 1.0, None).is_ok());
    match at(highest_m + 1.0, Some(BASE_M)) {
        Err(RenderError::AboveClouds { base_m, maximum_m, .. }) => {
            assert_eq!((base_m, maximum_m), (BASE_M, highest_m));
        }
        other => panic!("{other:?}"),
    }
}
