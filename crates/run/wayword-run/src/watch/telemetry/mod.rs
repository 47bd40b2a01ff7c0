//! Spans to a collector of OpenTelemetry, by OTLP over HTTP. The address comes from OpenTelemetry's own environment variables. A
//! failing collector never stops the worker.

mod client;
mod exporter;
mod variables;

use crate::output::CommandOutput;
use client::CollectorClient;
use exporter::{FailureReporter, ReportingExporter};
use opentelemetry::{KeyValue, trace::TracerProvider};
use opentelemetry_otlp::{Protocol, SpanExporter, WithExportConfig, WithHttpConfig};
use opentelemetry_sdk::{
    Resource,
    resource::{EnvResourceDetector, TelemetryResourceDetector},
    trace::{SdkTracer, SdkTracerProvider},
};
use std::{sync::Arc, time::Duration};
use tracing::Subscriber;
use tracing_opentelemetry::OpenTelemetryLayer;
use tracing_subscriber::registry::LookupSpan;

/// How long a worker that is done waits for its last spans to be sent. Then it ends without them.
const LAST_WAIT: Duration = Duration::from_secs(5);

/// The connection to a collector.
pub(super) struct SpanTelemetry {
    provider: SdkTracerProvider,
    reporter: Arc<FailureReporter>,
}

impl SpanTelemetry {
    /// Begins to send, if the environment names a collector. Makes no connection yet. If the collector cannot be used, a warning
    /// is printed and no spans are sent.
    pub(super) fn start(worker: &str, output: &CommandOutput) -> Option<Self> {
        if !variables::is_asked() {
            return None;
        }
        let reporter = Arc::new(FailureReporter::new(output.clone()));
        let exporter = match make_exporter(&reporter) {
            Ok(exporter) => exporter,
            Err(reason) => {
                reporter.report_once(&reason);
                return None;
            }
        };
        let provider =
            SdkTracerProvider::builder().with_resource(worker_resource(worker)).with_batch_exporter(exporter).build();
        Some(Self { provider, reporter })
    }

    /// The layer of `tracing` that takes the program's spans.
    pub(super) fn tracing_layer<S: Subscriber + for<'a> LookupSpan<'a>>(&self) -> OpenTelemetryLayer<S, SdkTracer> {
        let layer = tracing_opentelemetry::layer().with_tracer(self.provider.tracer("wayword"));
        // Source lines and threads have no meaning for a user of the program.
        layer
            .with_location(false)
            .with_threads(false)
            .with_tracked_inactivity(false)
            .with_level(false)
            .with_target(false)
    }

    /// Sends the last spans, and gives up after a few seconds.
    pub(super) fn send_rest(self) {
        if let Err(error) = self.provider.shutdown_with_timeout(LAST_WAIT) {
            self.reporter.report_once(&error.to_string());
        }
    }
}

fn make_exporter(reporter: &Arc<FailureReporter>) -> Result<ReportingExporter, String> {
    let client = CollectorClient::new(Arc::clone(reporter))?;
    // The address may hold a password, so the error that quotes it is not passed on.
    let exporter = SpanExporter::builder()
        .with_http()
        .with_protocol(Protocol::HttpBinary)
        .with_http_client(client)
        .build()
        .map_err(|_| format!("{} is no address, or another variable of its is wrong", variables::ENDPOINT_VARIABLE))?;
    Ok(ReportingExporter::new(exporter, Arc::clone(reporter)))
}

/// The resource attributes of this worker. Names that the user sets in the environment win.
fn worker_resource(worker: &str) -> Resource {
    let ours = [
        KeyValue::new("service.name", "wayword"),
        KeyValue::new("service.version", env!("CARGO_PKG_VERSION")),
        KeyValue::new("service.instance.id", worker.to_owned()),
    ];
    let resource = Resource::builder_empty()
        .with_attributes(ours)
        .with_detector(Box::new(TelemetryResourceDetector))
        .with_detector(Box::new(EnvResourceDetector::new()));
    match variables::variable_text("OTEL_SERVICE_NAME") {
        Some(name) => resource.with_service_name(name).build(),
        None => resource.build(),
    }
}
