//! Opens the executor that is asked for.

use crate::{
    cpu::CpuExecutor,
    error::RenderError,
    executor::Executor,
    gpu::{GpuExecutor, context::Context},
    prepare::Prepared,
    request::{DeviceChoice, ExecutorKind, RenderRequest},
    synthetic,
    table_set::TableSet,
};
use skyglow_physics::{BAND_COUNT, EmissionMix, Turbidity, simd::instruction_set};
use std::sync::Arc;

/// What was opened.
#[derive(Clone, Debug)]
pub(crate) struct Opened {
    pub(crate) kind: ExecutorKind,
    pub(crate) adapter: String,
    pub(crate) driver: String,
    pub(crate) resident_bytes: u64,
}

/// An executor of the wanted kind with the packs resident.
///
/// # Errors
/// No such adapter, packs that do not fit, or a device that fails.
pub(crate) fn open(
    choice: DeviceChoice,
    budget_bytes: u64,
    set: &TableSet,
) -> Result<(Box<dyn Executor>, Opened), RenderError> {
    let wanted = match choice {
        DeviceChoice::Cpu => return Ok(open_cpu(set)),
        // Plain Rust takes a third of lavapipe's time or less on the same cores.
        DeviceChoice::Auto | DeviceChoice::Gpu => ExecutorKind::Gpu,
        DeviceChoice::Lavapipe => ExecutorKind::Lavapipe,
    };
    match open_adapter(wanted, budget_bytes, set) {
        Err(error) if choice == DeviceChoice::Auto => {
            match error {
                RenderError::NoAdapter { .. } => {
                    tracing::info!(%error, "panoramas are rendered in plain Rust")
                }
                _ => tracing::warn!(%error, "the GPU cannot be used; panoramas are rendered in plain Rust"),
            }
            Ok(open_cpu(set))
        }
        opened => opened,
    }
}

fn open_adapter(
    wanted: ExecutorKind,
    budget_bytes: u64,
    set: &TableSet,
) -> Result<(Box<dyn Executor>, Opened), RenderError> {
    let context = Context::open(wanted)?;
    let (adapter, driver) = (context.adapter.clone(), context.driver.clone());
    let executor = GpuExecutor::new(context, set.clone(), budget_bytes)?;
    let (kind, resident_bytes) = (executor.kind(), executor.resident_bytes());
    Ok((Box::new(executor), Opened { kind, adapter, driver, resident_bytes }))
}

fn open_cpu(set: &TableSet) -> (Box<dyn Executor>, Opened) {
    let executor = CpuExecutor::new(set.clone());
    let opened = Opened {
        kind: ExecutorKind::Cpu,
        adapter: format!("processor, {}", instruction_set()),
        driver: format!("{} threads", rayon::current_num_threads()),
        resident_bytes: executor.resident_bytes(),
    };
    (Box::new(executor), opened)
}

/// Requests that between them run every pipeline.
pub(crate) fn warm_up_requests(set: &TableSet) -> Vec<Prepared> {
    // One kind is enough, since all run the same pipelines: that with the most packs, or there may be no two to blend.
    let Some(packs) = set.kinds().iter().max_by_key(|packs| packs.turbidities.len()) else {
        return Vec::new();
    };
    let mut wanted = vec![packs.turbidities[0]];
    if let [first, second, ..] = packs.turbidities[..] {
        wanted.push(0.5 * (first + second));
    }
    let polar = Arc::new(synthetic::polar_grid_of(&[(0, 0, 1.0, 10.0)]));
    wanted
        .into_iter()
        .filter_map(|turbidity| {
            let request = RenderRequest {
                polar: Arc::clone(&polar),
                observer_altitude_m: 10.0,
                turbidity: Turbidity::new(turbidity).ok()?,
                scattering: packs.kind.scattering,
                cloud_base_m: packs.kind.cloud_base_m,
                emission: EmissionMix::garstang(),
                flux_per_dnb_flux: [1.0; BAND_COUNT],
                basis: None,
            };
            Prepared::new(&request, set).ok()
        })
        .collect()
}
