use super::*;
use proptest::prelude::*;
use skyglow_physics::{
    BAND_COUNT, Direction, Horizon, Lamp, LinearMeasure, Panorama, Response, SkyCurve, Turbidity,
    panorama::solid_angle_sr,
    spectrum::{Light, SpectralRule, Spectrum},
};
use skyglow_render::{
    prepare::Prepared, reference::render_f64, request::RenderRequest, synthetic, table_set::TableSet,
};
use skyglow_scene::PolarGrid;
use std::sync::{Arc, LazyLock};

static SOLVER: LazyLock<InfluenceSolver> = LazyLock::new(|| InfluenceSolver::new(SET.clone()));
static SET: LazyLock<Arc<TableSet>> = LazyLock::new(|| {
    Arc::new(TableSet::new(synthetic::table_set_with_skylines(&[1.5, 2.5, 3.5, 4.75], 24)).unwrap())
});

fn request(polar: PolarGrid, turbidity: f64) -> RenderRequest {
    let request = synthetic::request(polar, Turbidity::new(turbidity).unwrap());
    RenderRequest { observer_altitude_m: 640.0, ..request }
}

/// What the dark-adapted eye makes of the default lamp.
static RULE: LazyLock<Arc<SpectralRule>> =
    LazyLock::new(|| Lamp::default().light().rule(&Response::Scotopic));

fn linear(measure: &LinearMeasure) -> MeasureOfCells<'_> {
    MeasureOfCells::Linear(SeenMeasure { measure, rule: &RULE, within: None })
}

/// What the rule makes of the sky, `[row][column]`.
fn exact_sky(request: &RenderRequest) -> Vec<f32> {
    exact_sky_by(request, &RULE)
}

fn exact_sky_by(request: &RenderRequest, rule: &SpectralRule) -> Vec<f32> {
    let prepared = Prepared::new(request, &SET).unwrap();
    let sky = render_f64(&prepared, &SET);
    let kernel = Panorama::from_samples(sky.into_iter().map(|value| value as f32).collect()).unwrap();
    cells::values_of(&kernel, rule)
}

fn measures() -> Vec<(&'static str, LinearMeasure)> {
    let hills = (0..256).map(|column| (f64::from(column) * 0.2).sin().max(0.0) * 0.3).collect();
    let horizon = Horizon::new(hills).unwrap();
    let at = |azimuth_deg: f64, elevation_deg: f64| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    let north = SkyCurve::new(vec![at(340.0, 5.0), at(20.0, 5.0), at(30.0, 60.0), at(330.0, 40.0)]).unwrap();
    let to_zenith = SkyCurve::new(vec![at(90.0, 90.0), at(60.0, 10.0), at(130.0, 10.0)]).unwrap();
    let eight = SkyCurve::new(vec![at(0.0, 20.0), at(40.0, 40.0), at(40.0, 20.0), at(0.0, 40.0)]).unwrap();
    vec![
        ("zenith", LinearMeasure::zenith(&horizon)),
        ("mean", LinearMeasure::mean(&horizon)),
        ("horizontal", LinearMeasure::horizontal(&horizon)),
        ("region that wraps north", LinearMeasure::region(&north, &horizon)),
        ("region that touches the zenith", LinearMeasure::region(&to_zenith, &horizon)),
        ("region that crosses itself", LinearMeasure::region(&eight, &horizon)),
    ]
}

fn total(request: &RenderRequest, cells: &[CellInfluence]) -> f64 {
    let cells = cells.iter().zip(&request.polar.cells);
    cells.map(|(influence, cell)| influence.per_dnb_w * f64::from(cell.flux_dnb_w)).sum()
}

/// Linear measures of cells add up to those of the sky at and between packs.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn cells_add_up_to_the_sky_at_and_between_packs() {
    for turbidity in [2.5, 1.9, 4.0] {
        for polar in [synthetic::polar_grid(3, 2_000), synthetic::polar_grid_with_skylines(4, 2_000)] {
            let request = request(polar, turbidity);
            let sky = exact_sky(&request);
            for (name, measure) in measures() {
                let cells = SOLVER.cells(&request, linear(&measure)).unwrap();
                let (sum, value) = (total(&request, &cells), measure.of(&sky));
                assert!((sum / value - 1.0).abs() < 1e-4, "{name}, turbidity {turbidity}: {sum:e} {value:e}");
            }
        }
    }
}

/// A cell switched off takes its own influence away.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn a_cell_switched_off_takes_its_influence_away() {
    let request = request(synthetic::polar_grid_with_skylines(8, 400), 2.5);
    let with_all = exact_sky(&request);
    for (name, measure) in measures() {
        let cells = SOLVER.cells(&request, linear(&measure)).unwrap();
        // The brightest, and one in the middle.
        let light = |at: usize| cells[at].per_dnb_w * f64::from(request.polar.cells[at].flux_dnb_w);
        let brightest = (0..cells.len()).max_by(|&a, &b| light(a).total_cmp(&light(b))).unwrap();
        for off in [brightest, cells.len() / 2] {
            let mut polar = request.polar.as_ref().clone();
            polar.cells[off].flux_dnb_w = 0.0;
            let without = exact_sky(&RenderRequest { polar: Arc::new(polar), ..request.clone() });
            let taken = measure.of(&with_all) - measure.of(&without);
            let error = (light(off) - taken).abs();
            assert!(
                error < 1e-3 * taken.abs() + 1e-6 * measure.of(&with_all),
                "{name}: {:e} {taken:e}",
                light(off)
            );
        }
    }
}

/// The slope over altitude is what raising the cell changes.
#[test]
fn the_altitude_slope_is_what_raising_changes() {
    for turbidity in [2.5, 3.0] {
        let at = |altitude_m: f32| {
            let request = request(synthetic::polar_grid_of(&[(17, 120, 1e6, altitude_m)]), turbidity);
            let measure = LinearMeasure::zenith(&Horizon::flat());
            SOLVER.cells(&request, linear(&measure)).unwrap()[0]
        };
        let (low, middle, high) = (at(1_290.0), at(1_300.0), at(1_310.0));
        let wanted = (high.per_dnb_w / low.per_dnb_w).ln() / 20.0;
        let slope = f64::from(middle.log_slope_per_m);
        assert!((slope - wanted).abs() < 0.05 * wanted.abs() + 1e-6, "{slope:e} {wanted:e}");
    }
}

/// The norm of a cell is that of its own sky wherever it stands. Light of one line at a node, of which a response is linear: nodes of
/// made-up packs are not those of one sky.
#[test]
fn the_norm_of_a_cell_is_that_of_its_own_sky() {
    let line_nm = skyglow_physics::spectrum::nodes_nm()[1];
    let line = Spectrum::from_fn(|nm| f64::from(u8::from(nm == line_nm)));
    let rule = Light::new(line).rule(&Response::Photopic);
    let norm_of = |polar: PolarGrid| {
        let request = request(polar, 2.5);
        let cells = SOLVER.cells(&request, MeasureOfCells::Norm(&rule)).unwrap();
        let prepared = Prepared::new(&request, &SET).unwrap();
        // Not clamped at 0, as a norm is of the image itself: few of these are below.
        let sky = exact_sky_by(&request, &rule);
        let square: f64 = (0..64)
            .flat_map(|row| (0..256).map(move |column| (row, column)))
            .map(|(row, column)| solid_angle_sr(row) * f64::from(sky[row * 256 + column]).powi(2))
            .sum();
        assert_eq!(prepared.cells.len(), 1);
        (cells[0].per_dnb_w * f64::from(request.polar.cells[0].flux_dnb_w), square.sqrt())
    };
    let (here, wanted) = norm_of(synthetic::polar_grid_of(&[(17, 120, 1e6, 800.0)]));
    assert!((here / wanted - 1.0).abs() < 0.02, "{here:e} {wanted:e}");
    let (turned, _) = norm_of(synthetic::polar_grid_of(&[(200, 120, 1e6, 800.0)]));
    assert!((turned / here - 1.0).abs() < 1e-5);
    let (farther, _) = norm_of(synthetic::polar_grid_of(&[(17, 150, 1e6, 800.0)]));
    assert!((farther / here - 1.0).abs() > 0.1);
}

/// Dark scenes and lamps without light have no influence.
#[test]
fn what_gives_no_light_has_no_influence() {
    let dark = request(synthetic::dark_grid(), 2.5);
    assert!(SOLVER.cells(&dark, MeasureOfCells::Norm(&RULE)).unwrap().is_empty());
    let mut off = request(synthetic::polar_grid(3, 10), 2.5);
    off.flux_per_dnb_flux = [0.0; BAND_COUNT];
    let measure = LinearMeasure::mean(&Horizon::flat());
    let cells = SOLVER.cells(&off, linear(&measure)).unwrap();
    assert!(cells.len() == off.polar.cells.len() && cells.iter().all(|cell| cell.per_dnb_w == 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Influence is in proportion to flux and turns with the light.
    #[test]
    fn influence_scales_and_turns_with_the_light(
        column in 0usize..256, ring in 0u32..192, turns in 1usize..256, more in 1.5f32..20.0,
    ) {
        let measure = LinearMeasure::mean(&Horizon::flat());
        let value = |column: usize, flux: f32| {
            let request = request(synthetic::polar_grid_of(&[(column % 256, ring, flux, 500.0)]), 2.5);
            let cells = SOLVER.cells(&request, linear(&measure)).unwrap();
            cells[0].per_dnb_w
        };
        let here = value(column, 1e5);
        prop_assert!((value(column, 1e5 * more) / here - 1.0).abs() < 1e-5);
        prop_assert!((value(column + turns, 1e5) / here - 1.0).abs() < 1e-3);
    }
}
