//! The CPU executor against the f64 evaluation of the same tables.

mod common;

use common::{engine, largest_error, request};
use skyglow_engine::{DeviceChoice, ExecutorKind, prepare::Prepared, reference::render_f64, synthetic};

#[test]
fn the_cpu_executor_agrees_with_f64_at_and_between_turbidities() {
    let engine = engine(DeviceChoice::Cpu, &[1.5, 2.0, 3.0, 4.0], 16);
    let set = skyglow_engine::TableSet::new(engine.tables().to_vec()).unwrap();
    for turbidity in [2.0, 2.3] {
        for basis in [None, Some(5)] {
            let mut request = request(synthetic::polar_grid(7, 3000), turbidity);
            request.basis = basis;
            let exact = render_f64(&Prepared::new(&request, &set).unwrap(), &set);
            let rendered = engine.render_blocking(request).unwrap();
            assert_eq!(rendered.executor, ExecutorKind::Cpu);
            let error = largest_error(rendered.panorama.samples(), &exact);
            println!("T = {turbidity}, basis {basis:?}: largest relative error {error:.1e}");
            assert!(error < 1e-5, "{error}");
        }
    }
}

#[test]
fn fewer_functions_give_another_sky() {
    let engine = engine(DeviceChoice::Cpu, &[2.0], 16);
    let mut request = request(synthetic::polar_grid(7, 300), 2.0);
    let whole = engine.render_blocking(request.clone()).unwrap().panorama;
    request.basis = Some(3);
    let part = engine.render_blocking(request).unwrap();
    let whole: Vec<f64> = whole.samples().iter().map(|value| f64::from(*value)).collect();
    assert!(largest_error(part.panorama.samples(), &whole) > 1e-2);
    assert_eq!(part.basis_count, 3);
}
