//! Adapter, device and queue, and the errors that they report.

use crate::{
    error::{DeviceFault, RenderError},
    request::ExecutorKind,
};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};

/// A device that has not answered after this long is taken for lost.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(60);

/// An open device. Everything on it is made, used and dropped by one thread.
pub(crate) struct Context {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) kind: ExecutorKind,
    pub(crate) adapter: String,
    pub(crate) driver: String,
    /// Timestamps may be written, and how many nanoseconds one tick is.
    pub(crate) nanoseconds_per_tick: Option<f64>,
    faults: Faults,
}

/// The first error since the last check; callbacks fill it.
#[derive(Clone, Default)]
struct Faults(Arc<Mutex<Option<DeviceFault>>>);

impl Faults {
    fn note(&self, fault: DeviceFault) {
        // A loss brings other errors with it: the first one says most.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(fault);
    }

    fn take(&self) -> Option<DeviceFault> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// What kind of executor an adapter makes: software Vulkan is lavapipe.
fn kind_of(info: &wgpu::AdapterInfo) -> ExecutorKind {
    if info.device_type == wgpu::DeviceType::Cpu { ExecutorKind::Lavapipe } else { ExecutorKind::Gpu }
}

impl Context {
    /// Opens the best adapter of the wanted kind.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`] where there is none; [`RenderError::Device`] where it refuses.
    pub(crate) fn open(wanted: ExecutorKind) -> Result<Self, RenderError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        let instance = wgpu::Instance::new(descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        let found: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
        let rank = |adapter: &wgpu::Adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        let is_wanted = |adapter: &wgpu::Adapter| kind_of(&adapter.get_info()) == wanted;
        let adapter =
            adapters.into_iter().filter(is_wanted).min_by_key(rank).ok_or(RenderError::NoAdapter {
                wanted: wanted.name(),
                found: if found.is_empty() { "none".into() } else { found.join(", ") },
            })?;
        Self::open_adapter(&adapter)
    }

    fn open_adapter(adapter: &wgpu::Adapter) -> Result<Self, RenderError> {
        let info = adapter.get_info();
        // Lavapipe's timestamps do not say when a pass began or ended.
        let timestamps = match kind_of(&info) {
            ExecutorKind::Gpu => adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ExecutorKind::Lavapipe | ExecutorKind::Cpu => wgpu::Features::empty(),
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("skyglow"),
            required_features: timestamps,
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(|error| DeviceFault::Other(error.to_string()))?;
        let faults = Faults::default();
        let noted = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error| noted.note(fault_of(&error))));
        let noted = faults.clone();
        device.set_device_lost_callback(move |reason, message| {
            noted.note(DeviceFault::Lost(format!("{reason:?}: {message}")));
        });
        let nanoseconds_per_tick = (!timestamps.is_empty()).then(|| f64::from(queue.get_timestamp_period()));
        Ok(Self {
            device,
            queue,
            kind: kind_of(&info),
            adapter: info.name,
            driver: format!("{} {}", info.driver, info.driver_info),
            nanoseconds_per_tick,
            faults,
        })
    }

    /// The first complaint since the last call, as an error.
    ///
    /// # Errors
    /// That complaint.
    pub(crate) fn check(&self) -> Result<(), DeviceFault> {
        self.faults.take().map_or(Ok(()), Err)
    }

    /// Waits until all that was submitted is done.
    ///
    /// # Errors
    /// The first complaint, or that no answer came.
    pub(crate) fn wait(&self) -> Result<(), DeviceFault> {
        let waited =
            self.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(ANSWER_TIMEOUT) });
        self.check()?;
        waited.map(drop).map_err(|error| DeviceFault::Lost(error.to_string()))
    }

    /// Refuses a size beyond one of the adapter's limits.
    ///
    /// # Errors
    /// [`RenderError::BeyondLimit`].
    pub(crate) fn check_limit(
        &self,
        what: &'static str,
        needed: u64,
        allowed: u64,
    ) -> Result<(), RenderError> {
        if needed > allowed { Err(RenderError::BeyondLimit { what, needed, allowed }) } else { Ok(()) }
    }
}

fn fault_of(error: &wgpu::Error) -> DeviceFault {
    match error {
        wgpu::Error::OutOfMemory { source } => DeviceFault::OutOfMemory(source.to_string()),
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            DeviceFault::Other(description.clone())
        }
    }
}
