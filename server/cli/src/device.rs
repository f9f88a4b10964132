//! What renders, as flags and the file name it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use skyglow_render::DeviceChoice;

/// What renders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Device {
    /// A hardware GPU if there is one, else the CPU, which is faster than lavapipe.
    #[default]
    Auto,
    /// A hardware GPU or an error.
    Gpu,
    /// Mesa's software Vulkan or an error.
    Lavapipe,
    /// Plain Rust, no Vulkan.
    Cpu,
}

impl From<Device> for DeviceChoice {
    fn from(device: Device) -> Self {
        match device {
            Device::Auto => DeviceChoice::Auto,
            Device::Gpu => DeviceChoice::Gpu,
            Device::Lavapipe => DeviceChoice::Lavapipe,
            Device::Cpu => DeviceChoice::Cpu,
        }
    }
}
