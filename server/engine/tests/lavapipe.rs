//! The Vulkan executor on Mesa's lavapipe.

mod common;

use common::{engine, largest_error, request};
use skyglow_engine::{
    DeviceChoice, ExecutorKind, TableSet, prepare::Prepared, reference::render_f64, synthetic,
};

#[test]
fn lavapipe_agrees_with_f64_at_and_between_turbidities() {
    let engine = engine(DeviceChoice::Lavapipe, &[1.5, 2.0, 3.0, 4.0], 16);
    let set = TableSet::new(engine.tables().to_vec()).unwrap();
    for turbidity in [2.0, 2.3] {
        for basis in [None, Some(5)] {
            let mut request = request(synthetic::polar_grid(7, 3000), turbidity);
            request.basis = basis;
            let exact = render_f64(&Prepared::new(&request, &set).unwrap(), &set);
            let rendered = engine.render_blocking(request).unwrap();
            assert_eq!(rendered.executor, ExecutorKind::Lavapipe);
            let error = largest_error(rendered.panorama.samples(), &exact);
            println!("T = {turbidity}, basis {basis:?}: largest relative error {error:.1e}");
            assert!(error < 1e-5, "{error}");
        }
    }
}
