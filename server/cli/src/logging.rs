//! Logs, on standard error, and traces, to a collector where one is named.

use crate::failure::Failure;
use opentelemetry::{KeyValue, trace::TracerProvider};
use opentelemetry_otlp::{SpanExporter, WithExportConfig};
use opentelemetry_sdk::{Resource, trace::SdkTracerProvider};
use std::io::IsTerminal;
use tracing_subscriber::{EnvFilter, Layer, filter::Targets, layer::SubscriberExt, util::SubscriberInitExt};

/// Starts logging. `RUST_LOG` chooses what is logged, `default_level` where it is unset.
pub(crate) fn start(default_level: &str) {
    start_with(default_level, None);
}

/// The same with spans sent to a collector, by OTLP over HTTP (`http://HOST:4318`). What the variables OTEL_* say of sampling,
/// batches and the service's name holds.
///
/// # Errors
/// [`Failure::Work`] where the collector's address cannot be meant.
pub(crate) fn start_traced(default_level: &str, collector: &str) -> Result<Traces, Failure> {
    let endpoint = format!("{}/v1/traces", collector.trim_end_matches('/'));
    let exporter =
        SpanExporter::builder().with_http().with_endpoint(endpoint).build().map_err(Failure::work)?;
    let version = KeyValue::new("service.version", env!("CARGO_PKG_VERSION"));
    let mut resource = Resource::builder().with_attribute(version);
    let is_named = std::env::var_os("OTEL_SERVICE_NAME").is_some()
        || std::env::var("OTEL_RESOURCE_ATTRIBUTES").is_ok_and(|text| text.contains("service.name="));
    if !is_named {
        resource = resource.with_service_name("skyglow");
    }
    let provider =
        SdkTracerProvider::builder().with_resource(resource.build()).with_batch_exporter(exporter).build();
    start_with(default_level, Some(&provider));
    Ok(Traces(provider))
}

/// Spans on their way to a collector; what is left of them is sent when this is dropped.
pub(crate) struct Traces(SdkTracerProvider);

impl Drop for Traces {
    fn drop(&mut self) {
        if let Err(error) = self.0.shutdown() {
            tracing::warn!(%error, "the last spans did not reach the collector");
        }
    }
}

fn start_with(default_level: &str, traces: Option<&SdkTracerProvider>) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| {
        // Vulkan's loader and driver chatter is nobody's business below an error.
        EnvFilter::new(format!("{default_level},wgpu_core=error,wgpu_hal=error,naga=error"))
    });
    let log = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .with_filter(filter);
    // Our own spans alone: those of the exporter would make more of themselves.
    let own = Targets::new().with_target("skyglow", tracing::Level::INFO);
    let traces = traces.map(|provider| {
        tracing_opentelemetry::layer().with_tracer(provider.tracer("skyglow")).with_filter(own)
    });
    tracing_subscriber::registry().with(traces).with(log).init();
}
