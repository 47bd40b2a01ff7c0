//! The exporter of OpenTelemetry, with a warning when it fails for the first time.

use super::variables::ENDPOINT;
use crate::output::Output;
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
pub(super) struct Teller {
    output: Output,
    is_told: AtomicBool,
    /// Why the last request failed.
    noted: Mutex<String>,
}

impl Teller {
    pub(super) fn new(output: Output) -> Self {
        Self { output, is_told: AtomicBool::new(false), noted: Mutex::default() }
    }

    /// Keeps the reason of a failure until [`Self::tell`].
    pub(super) fn note(&self, reason: String) {
        *self.noted.lock().unwrap_or_else(PoisonError::into_inner) = reason;
    }

    /// Prints the warning, with the reason that was noted last, or else with this one.
    pub(super) fn tell(&self, reason: &str) {
        let noted = mem::take(&mut *self.noted.lock().unwrap_or_else(PoisonError::into_inner));
        if self.is_told.swap(true, Ordering::Relaxed) {
            return;
        }
        let reason = if noted.is_empty() { reason } else { &noted };
        self.output.say(format_args!(
            "warning: spans cannot be sent to the collector of {ENDPOINT} ({reason}); the run goes on, and they may be lost"
        ));
    }
}

/// An exporter that warns about its first failure.
#[derive(Debug)]
pub(super) struct Exporter {
    inner: opentelemetry_otlp::SpanExporter,
    teller: Arc<Teller>,
}

impl Exporter {
    pub(super) fn new(inner: opentelemetry_otlp::SpanExporter, teller: Arc<Teller>) -> Self {
        Self { inner, teller }
    }
}

impl SpanExporter for Exporter {
    async fn export(&self, batch: Vec<SpanData>) -> OTelSdkResult {
        let sent = self.inner.export(batch).await;
        match &sent {
            // Another try may have succeeded after a failure that was noted.
            Ok(()) => self.teller.note(String::new()),
            Err(error) => self.teller.tell(&error.to_string()),
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
