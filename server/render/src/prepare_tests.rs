use super::*;
use crate::synthetic;
use skyglow_physics::{BAND_COUNT, EmissionMix, Turbidity};
use skyglow_tables::Scattering;
use std::sync::Arc;

fn set() -> TableSet {
    TableSet::new(synthetic::table_set(&[2.0, 3.0], 8)).unwrap()
}

fn request(polar: PolarGrid) -> RenderRequest {
    RenderRequest {
        polar: Arc::new(polar),
        observer_altitude_m: 100.0,
        turbidity: Turbidity::new(2.0).unwrap(),
        scattering: Scattering::Single,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: [1.0; BAND_COUNT],
        basis: None,
    }
}

/// No more functions are in use than the packs of a turbidity have.
#[test]
fn no_more_functions_than_the_packs_have() {
    let tables = [(2.0, 16), (3.0, 12), (4.0, 12), (5.0, 12), (6.0, 12)]
        .map(|(turbidity, count)| synthetic::table_set(&[turbidity], count).remove(0));
    let set = TableSet::new(tables.to_vec()).unwrap();
    let in_use = |turbidity: f64, basis: Option<usize>| {
        let turbidity = Turbidity::new(turbidity).unwrap();
        let request = RenderRequest { turbidity, basis, ..request(synthetic::dark_grid()) };
        Prepared::new(&request, &set).map(|prepared| prepared.basis_count)
    };
    for (turbidity, all) in [(2.0, 16), (2.5, 16), (3.0, 12), (5.0, 12), (5.5, 12)] {
        assert_eq!(in_use(turbidity, None).unwrap(), all, "{turbidity}");
        // As many as are resident may be asked for at every turbidity.
        assert_eq!(in_use(turbidity, Some(16)).unwrap(), all, "{turbidity}");
        assert_eq!(in_use(turbidity, Some(8)).unwrap(), 8, "{turbidity}");
        assert!(matches!(
            in_use(turbidity, Some(17)),
            Err(RenderError::BasisOutOfRange { basis: 17, maximum: 16 })
        ));
    }
}

#[test]
fn only_nodes_that_cells_need_are_listed() {
    let set = set();
    let axes = set.offset_axis();
    let between = 100.0 + axes[3].offset_m(4.75);
    let on_a_node = 100.0 + axes[9].offset_m(2.0);
    let polar = synthetic::polar_grid_of(&[(7, 3, 5.0, between as f32), (7, 9, 2.0, on_a_node as f32)]);
    let prepared = Prepared::new(&request(polar), &set).unwrap();
    let listed: Vec<_> = prepared.nodes.iter().map(|node| (node.ring, node.offset)).collect();
    assert_eq!(listed, [(3, 4), (3, 5), (9, 2)]);
    assert_eq!(prepared.columns, [LitColumn { azimuth: 7, first_cell: 0, end_cell: 2 }]);
    assert_eq!((prepared.cells[0].lower_node, prepared.cells[0].upper_node()), (0, 1));
    assert!((prepared.cells[0].upper_weight - 0.75).abs() < 1e-4);
    assert_eq!((prepared.cells[1].lower_node, prepared.cells[1].upper_node()), (2, 2));
}

/// The upper node of a cell is the next offset on its ring whatever else is lit.
#[test]
fn the_upper_node_is_the_next_on_its_ring() {
    let set = set();
    let cells: Vec<_> = (0..200u32)
        .map(|i| {
            let spread = |ratio: f64| (f64::from(i) * ratio).fract();
            let ring = (spread(0.618) * set.ring_count() as f64) as u32;
            (i as usize, ring, 1.0, (3_000.0 * spread(0.755)) as f32)
        })
        .collect();
    let prepared = Prepared::new(&request(synthetic::polar_grid_of(&cells)), &set).unwrap();
    let mut between = 0;
    for cell in &prepared.cells {
        let [lower, upper] = [cell.lower_node, cell.upper_node()].map(|node| prepared.nodes[node as usize]);
        assert_eq!((lower.ring, lower.blocking), (upper.ring, upper.blocking));
        assert_eq!(upper.offset, lower.offset + u32::from(cell.upper_weight > 0.0));
        between += usize::from(cell.upper_weight > 0.0);
    }
    assert!(between > 100, "{between}");
}

#[test]
fn dark_cells_and_dark_lamps_leave_no_work() {
    let polar = synthetic::polar_grid_of(&[(1, 1, 0.0, 0.0)]);
    assert_eq!(Prepared::new(&request(polar), &set()).unwrap().work(), WorkCount::default());
    let mut no_lamp = request(synthetic::polar_grid_of(&[(1, 1, 4.0, 0.0)]));
    no_lamp.flux_per_dnb_flux = [0.0; BAND_COUNT];
    assert!(Prepared::new(&no_lamp, &set()).unwrap().is_dark());
}

/// A resident turbidity takes one pack and others take neighbours.
#[test]
fn a_resident_turbidity_takes_one_pack() {
    let set = TableSet::new(synthetic::table_set(&[1.5, 2.0, 3.0, 4.0, 6.0], 8)).unwrap();
    let mut request = request(synthetic::polar_grid_of(&[(1, 1, 4.0, 0.0)]));
    request.turbidity = Turbidity::new(3.0 + 1e-10).unwrap();
    assert_eq!(Prepared::new(&request, &set).unwrap().turbidity_stencil.nodes(), 2..3);
    request.turbidity = Turbidity::new(3.1).unwrap();
    assert_eq!(Prepared::new(&request, &set).unwrap().turbidity_stencil.nodes(), 1..5);
}

#[test]
fn values_out_of_range_are_named_with_the_range() {
    let set = set();
    let mut bad = request(synthetic::polar_grid_of(&[]));
    bad.observer_altitude_m = 9000.0;
    let message = Prepared::new(&bad, &set).unwrap_err().to_string();
    assert_eq!(message, "altitude is 9000 m; allowed is 0 to 6000 m");
    bad.observer_altitude_m = -30.0;
    assert_eq!(Prepared::new(&bad, &set).unwrap().altitude_stencil, Stencil::single(0));
    bad.turbidity = Turbidity::new(5.0).unwrap();
    let message = Prepared::new(&bad, &set).unwrap_err().to_string();
    assert_eq!(message, "turbidity is 5; resident is 2 to 3");
    bad.turbidity = Turbidity::new(2.5).unwrap();
    bad.basis = Some(9);
    assert!(matches!(Prepared::new(&bad, &set), Err(RenderError::BasisOutOfRange { basis: 9, maximum: 8 })));
}

/// Lamps that no spectrum gives are refused and not rendered black.
#[test]
fn impossible_lamps_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, -1e-9, 1e300] {
        let mut request = request(synthetic::polar_grid_of(&[(1, 1, 4.0, 0.0)]));
        request.flux_per_dnb_flux[1] = bad;
        let error = Prepared::new(&request, &set()).unwrap_err();
        assert!(matches!(error, RenderError::BadLamp { .. }), "{bad}: {error}");
    }
    let mut bright = request(synthetic::polar_grid_of(&[(1, 1, 4.0, 0.0)]));
    (bright.flux_per_dnb_flux[0], bright.flux_per_dnb_flux[1]) = (0.0, 1e6);
    assert!(Prepared::new(&bright, &set()).is_ok());
}

#[test]
fn malformed_grids_are_refused() {
    let cases: [fn(&mut PolarGrid); 8] = [
        |grid| grid.cells[0].flux_dnb_w = -1.0,
        |grid| grid.cells[0].flux_dnb_w = 1e25,
        |grid| grid.cells[0].altitude_m = f32::INFINITY,
        |grid| grid.cells[0].ring = 192,
        |grid| grid.cells[0].blocking = 8,
        |grid| grid.cells[0].flux_dnb_w = f32::NAN,
        |grid| grid.azimuth_start[5] = 9,
        |grid| grid.azimuth_start.truncate(256),
    ];
    for change in cases {
        let mut grid = synthetic::polar_grid_of(&[(1, 1, 4.0, 0.0)]);
        change(&mut grid);
        assert!(matches!(Prepared::new(&request(grid), &set()), Err(RenderError::BadPolarGrid { .. })));
    }
}
