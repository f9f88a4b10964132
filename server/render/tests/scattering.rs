//! Packs of first-order light and of all orders resident together.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{largest_error, request, vulkan};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, RenderError, RenderRequest, TableSet, prepare::Prepared,
    reference::render_f64, synthetic,
};
use skyglow_tables::{ResidentTables, Scattering};
use std::sync::Arc;

const SINGLE: [f64; 5] = [1.5, 2.0, 3.0, 4.0, 6.0];
const MULTIPLE: [f64; 3] = [2.0, 2.8, 5.0];

fn single() -> Vec<Arc<ResidentTables>> {
    synthetic::table_set(&SINGLE, 16)
}

fn multiple() -> Vec<Arc<ResidentTables>> {
    synthetic::table_set_of(Scattering::Multiple, &MULTIPLE, 12)
}

fn both() -> Vec<Arc<ResidentTables>> {
    // Not in the set's own order.
    multiple().into_iter().chain(single()).collect()
}

fn engine(device: DeviceChoice, tables: Vec<Arc<ResidentTables>>) -> Engine {
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() }).unwrap()
}

fn asked(seed: u64, turbidity: f64, scattering: Scattering) -> RenderRequest {
    RenderRequest { scattering, ..request(synthetic::polar_grid(seed, 600), turbidity) }
}

/// Turbidity is interpolated between packs of the scattering asked for.
#[test]
fn turbidity_stays_within_one_scattering() {
    let set = TableSet::new(both()).unwrap();
    let taken = |turbidity: f64, scattering: Scattering| -> Vec<f64> {
        let prepared = Prepared::new(&asked(1, turbidity, scattering), &set).unwrap();
        let packs = prepared.turbidity_stencil.nodes().map(|index| &set.tables()[index]);
        packs
            .map(|pack| {
                assert_eq!(pack.scattering, scattering);
                pack.turbidity
            })
            .collect()
    };
    assert_eq!(taken(2.4, Scattering::Multiple), MULTIPLE);
    assert_eq!(taken(2.4, Scattering::Single), [1.5, 2.0, 3.0, 4.0]);
    // Resident in both kinds.
    for scattering in Scattering::ALL {
        assert_eq!(taken(2.0, scattering), [2.0]);
    }
}

/// Ranges of turbidity and basis are those of the scattering asked for.
#[test]
fn ranges_are_those_of_the_scattering() {
    let set = TableSet::new(both()).unwrap();
    for turbidity in [1.6, 5.5] {
        Prepared::new(&asked(1, turbidity, Scattering::Single), &set).unwrap();
        match Prepared::new(&asked(1, turbidity, Scattering::Multiple), &set) {
            Err(RenderError::TurbidityOutOfRange { minimum, maximum, .. }) => {
                assert_eq!((minimum, maximum), (2.0, 5.0));
            }
            other => panic!("{other:?}"),
        }
    }
    let with_basis = |scattering| {
        let request = RenderRequest { basis: Some(14), ..asked(1, 3.0, scattering) };
        Prepared::new(&request, &set)
    };
    with_basis(Scattering::Single).unwrap();
    assert!(matches!(
        with_basis(Scattering::Multiple),
        Err(RenderError::BasisOutOfRange { basis: 14, maximum: 12 })
    ));
}

/// Scattering that is not resident is refused with what is.
#[test]
fn scattering_not_resident_is_refused() {
    for (tables, absent, message) in [
        (
            single(),
            Scattering::Multiple,
            "no packs with multiple scattering are resident; resident is single scattering",
        ),
        (
            multiple(),
            Scattering::Single,
            "no packs with single scattering are resident; resident is multiple scattering",
        ),
    ] {
        let engine = engine(DeviceChoice::Cpu, tables);
        let refused = engine.render_blocking(asked(1, 2.0, absent)).unwrap_err();
        assert!(matches!(refused, RenderError::KindNotResident { .. }), "{refused}");
        assert_eq!(refused.to_string(), message);
    }
}

/// Requests of both kinds at once come out as from an engine with that kind alone.
#[test]
fn both_kinds_at_once_come_out_as_alone() {
    for device in [vulkan(), DeviceChoice::Cpu] {
        let requests: Vec<_> = (0..12)
            .map(|i| {
                // Turbidities that are a pack of both kinds, of one, and of none.
                let turbidity = [2.0, 2.8, 2.4][i as usize % 3];
                asked(i / 4, turbidity, Scattering::ALL[i as usize % 2])
            })
            .collect();
        let alone = [engine(device, single()), engine(device, multiple())];
        let expected: Vec<_> = requests
            .iter()
            .map(|request| {
                let engine = &alone[usize::from(request.scattering == Scattering::Multiple)];
                engine.render_blocking(request.clone()).unwrap()
            })
            .collect();
        drop(alone);
        let mixed = Arc::new(engine(device, both()));
        let answers = render_all(&mixed, &requests);
        for (i, (got, expected)) in answers.iter().zip(&expected).enumerate() {
            assert_eq!(got.panorama, expected.panorama, "{device:?}, request {i}");
            assert_eq!(got.work.packs, expected.work.packs);
            assert_eq!(got.basis_count, if i % 2 == 0 { 16 } else { 12 });
        }
        // The same light and air, another scattering: another sky.
        let skies = [4, 5].map(|i: usize| &answers[i].panorama);
        assert_ne!(requests[4].scattering, requests[5].scattering);
        assert_ne!(skies[0], skies[1]);
        let stats = mixed.stats();
        assert_eq!((stats.rendered, stats.failed, stats.refused), (12, 0, 0));
    }
}

fn render_all(engine: &Arc<Engine>, requests: &[RenderRequest]) -> Vec<skyglow_render::Rendered> {
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    runtime.block_on(async {
        let tasks: Vec<_> = requests
            .iter()
            .cloned()
            .map(|request| {
                let engine = Arc::clone(engine);
                tokio::spawn(async move { engine.render(request).await.unwrap() })
            })
            .collect();
        let mut answers = Vec::new();
        for task in tasks {
            answers.push(task.await.unwrap());
        }
        answers
    })
}

/// Vulkan and CPU agree with f64 where both kinds are resident.
#[test]
fn executors_agree_with_f64_for_both_kinds() {
    let set = TableSet::new(both()).unwrap();
    for device in [vulkan(), DeviceChoice::Cpu] {
        let engine = engine(device, both());
        for scattering in Scattering::ALL {
            for turbidity in [2.0, 2.4] {
                let request = asked(7, turbidity, scattering);
                let exact = render_f64(&Prepared::new(&request, &set).unwrap(), &set);
                let rendered = engine.render_blocking(request).unwrap();
                let error = largest_error(rendered.panorama.samples(), &exact);
                assert!(error < 1e-5, "{device:?}, {scattering:?}, T = {turbidity}: {error:.1e}");
            }
        }
    }
}

/// Every pack counts in the memory and its kind in what is told.
#[test]
fn every_pack_counts_in_the_memory() {
    let bytes = |tables| engine(DeviceChoice::Cpu, tables).info().resident_bytes;
    let mixed = engine(DeviceChoice::Cpu, both());
    assert_eq!(mixed.info().resident_bytes, bytes(single()) + bytes(multiple()));
    let kinds: Vec<_> = mixed
        .info()
        .kinds
        .iter()
        .map(|packs| (packs.kind.scattering, packs.turbidities.as_slice(), packs.basis_count))
        .collect();
    assert_eq!(
        kinds,
        [(Scattering::Single, SINGLE.as_slice(), 16), (Scattering::Multiple, MULTIPLE.as_slice(), 12)]
    );
}
