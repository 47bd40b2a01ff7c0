//! The exporter of OpenTelemetry, with a warning when it fails for the first time.

use super::variables::ENDPOINT_VARIABLE;
use crate::output::CommandOutput;
use opentelemetry_sdk::{
    Resource,
    error::OTelSdkResult,
    trace::{SpanData, SpanExporter},
};
use std::{
    mem,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// Prints a warning about the first failure, and none about later ones.
#[derive(Debug)]
pub(super) struct FailureReporter {
    output: CommandOutput,
    /// Whether the warning was printed.
    has_warned: AtomicBool,
    /// Why the last request failed.
    last_reason: Mutex<String>,
}

impl FailureReporter {
    pub(super) fn new(output: CommandOutput) -> Self {
        Self { output, has_warned: AtomicBool::new(false), last_reason: Mutex::default() }
    }

    /// Keeps the reason of a failure until [`Self::report_once`].
    pub(super) fn note_reason(&self, reason: String) {
        *self.last_reason.lock().unwrap_or_else(PoisonError::into_inner) = reason;
    }

    /// Prints the warning, with the reason that was noted last, or else with this one.
    pub(super) fn report_once(&self, reason: &str) {
        let noted = mem::take(&mut *self.last_reason.lock().unwrap_or_else(PoisonError::into_inner));
        if self.has_warned.swap(true, Ordering::Relaxed) {
            return;
        }
        let reason = if noted.is_empty() { reason } else { &noted };
        self.output.say(format_args!(
            "warning: spans cannot be sent to the collector of {ENDPOINT_VARIABLE} ({reason}); the run goes on, and they may be lost"
        ));
    }
}

/// An exporter that warns about its first failure.
#[derive(Debug)]
pub(super) struct ReportingExporter {
    inner: opentelemetry_otlp::SpanExporter,
    reporter: Arc<FailureReporter>,
}

impl ReportingExporter {
    pub(super) fn new(inner: opentelemetry_otlp::SpanExporter, reporter: Arc<FailureReporter>) -> Self {
        Self { inner, reporter }
    }
}

impl SpanExporter for ReportingExporter {
    async fn export(&self, batch: Vec<SpanData>) -> OTelSdkResult {
        let sent = self.inner.export(batch).await;
        match &sent {
            // Another try may have succeeded after a failure that was noted.
            Ok(()) => self.reporter.note_reason(String::new()),
            Err(error) => self.reporter.report_once(&error.to_string()),
        }
        sent
    }

    fn shutdown_with_timeout(&self, timeout: Duration) -> OTelSdkResult {
        self.inner.shutdown_with_timeout(timeout)
    }

    fn force_flush(&self) -> OTelSdkResult {
        self.inner.force_flush()
    }

    fn set_resource(&mut self, resource: &Resource) {
        self.inner.set_resource(resource);
    }
}
