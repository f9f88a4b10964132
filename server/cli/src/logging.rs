//! Logs, on standard error.

use std::io::IsTerminal;
use tracing_subscriber::EnvFilter;

/// Starts logging. `RUST_LOG` chooses what is logged, `default_level` where it is unset.
pub(crate) fn start(default_level: &str) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| {
        // Vulkan's loader and driver chatter is nobody's business below an error.
        EnvFilter::new(format!("{default_level},wgpu_core=error,wgpu_hal=error,naga=error"))
    });
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .init();
}
