//! What each pixel of a stored scene does to a measure of the sky.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{request, store_town_on, town};
use skyglow_engine::{
    InfluenceSolver, MeasureOfCells, RenderRequest, TableSet, influence_of_pixels, synthetic,
};
use skyglow_physics::{GeoPoint, Horizon, LinearMeasure, source_pixel::point_sources};
use skyglow_scene::{PolarGrid, SceneStore};
use std::sync::Arc;

#[test]
fn pixels_add_up_to_the_sky_and_each_counts_as_if_it_were_alone() {
    let folder = tempfile::tempdir().unwrap();
    // A slope, so that pixels that share cells stand at different altitudes.
    store_town_on(folder.path(), 1.0, &|row, column| 200.0 + 30.0 * row as f32 + 55.0 * column as f32);
    let scene = SceneStore::new(folder.path()).open(&town()).unwrap();
    let solver =
        InfluenceSolver::new(Arc::new(TableSet::new(synthetic::table_set(&[1.5, 2.5, 3.5], 24)).unwrap()));
    let measures = [LinearMeasure::zenith(&Horizon::flat()), LinearMeasure::horizontal(&Horizon::flat())];
    // Beside the town, where its pixels are split, and 30 km off, where they share cells.
    for (latitude_deg, longitude_deg) in [(-1.43, 36.64), (-1.59, 36.41)] {
        let here = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap();
        let shares = scene.light_shares(here, false);
        assert_eq!(shares.len(), 9);
        let pixels = scene.source_pixels_within(here, 300_000.0);
        for turbidity in [2.5, 2.0] {
            let asked = request(shares.polar.clone(), turbidity);
            for measure in &measures {
                let of_grid = |polar: PolarGrid| -> (Vec<_>, f64) {
                    let asked = RenderRequest { polar: Arc::new(polar), ..asked.clone() };
                    let cells = solver.cells(&asked, MeasureOfCells::Linear(measure)).unwrap();
                    let fluxes = asked.polar.cells.iter().map(|cell| f64::from(cell.flux_dnb_w));
                    let sum = cells.iter().zip(fluxes).map(|(cell, flux)| cell.per_dnb_w * flux).sum();
                    (cells, sum)
                };
                let (cells, sky) = of_grid(shares.polar.clone());
                let influence = influence_of_pixels(&shares, &cells);
                let sum: f64 = influence.iter().map(|value| f64::from(*value)).sum();
                assert!((sum / sky - 1.0).abs() < 1e-5, "{sum:e} {sky:e}");
                // Between packs a light counts by what it adds to the others', which is not what it gives alone.
                for (position, pixel) in pixels.iter().enumerate().filter(|_| turbidity == 2.5) {
                    let sources = point_sources(here, std::slice::from_ref(pixel));
                    let (_, alone) =
                        of_grid(PolarGrid::of_sources(here, sources.into_iter().map(|source| (source, 0.0))));
                    let error = f64::from(influence[position]) / alone - 1.0;
                    assert!(error.abs() < 0.01, "{longitude_deg} {turbidity} {position}: {error}");
                }
                // The check can fail: pixels are not alike.
                let (least, most) =
                    influence.iter().fold((f32::MAX, 0f32), |(a, b), &v| (a.min(v), b.max(v)));
                assert!(most > 1.05 * least);
            }
        }
    }
}
