//! Lets people watch a run: spans of the worker, its chunks, items and calls, as lines of a file and, with the feature
//! `telemetry`, at a collector of OpenTelemetry.
//!
//! Spans are made by `tracing`. The subscriber is set only if spans are wanted, and only for the threads of one command, so that
//! a host program (Python) keeps its own. Threads that the command starts inherit it from their parent through
//! [`wayword_ledger::CallContext`].

mod chunk;
mod lines;
#[cfg(feature = "telemetry")]
mod telemetry;
#[cfg(not(feature = "telemetry"))]
#[path = "no_telemetry.rs"]
mod telemetry;

use crate::{
    error::{CommandError, Exit},
    output::CommandOutput,
    stores,
};
pub(crate) use chunk::within_chunk_span;
use lines::SpanLines;
use std::path::Path;
use telemetry::SpanTelemetry;
use tracing::{Dispatch, Span, dispatcher, field::Empty, info_span, level_filters::LevelFilter};
use tracing_subscriber::{Registry, filter::Targets, layer::SubscriberExt};
use wayword_ledger::SPAN_TARGET;

/// Watches one command.
pub(crate) struct CommandWatch {
    /// The name of this worker.
    worker: String,
    /// Where spans go; `None` if no spans are wanted.
    dispatch: Option<Dispatch>,
    /// The connection to a collector, if the environment names one.
    telemetry: Option<SpanTelemetry>,
}

impl CommandWatch {
    /// Writes spans into a file of this worker in the folder, if one is given, and sends them to the collector that the
    /// environment names.
    ///
    /// # Errors
    /// When the file cannot be made, unless the disk is full.
    pub(crate) fn start(spans: Option<&Path>, output: &CommandOutput) -> Result<Self, CommandError> {
        let worker = wayword_queue::worker_name();
        if let Some(folder) = spans {
            stores::refuse_address(folder, "spans are written into a folder", "name one of this machine")?;
        }
        let lines = spans.map(|folder| SpanLines::begin(folder, &worker, output)).transpose()?.flatten();
        let telemetry = SpanTelemetry::start(&worker, output);
        let is_asked = lines.is_some() || telemetry.is_some();
        let to = is_asked.then(|| {
            let own_spans = Targets::new().with_target(SPAN_TARGET, LevelFilter::INFO);
            let sent = telemetry.as_ref().map(SpanTelemetry::tracing_layer);
            Dispatch::new(Registry::default().with(own_spans).with(lines).with(sent))
        });
        Ok(Self { worker, dispatch: to, telemetry })
    }

    /// Runs `work` within the worker's span, and passes it the worker's name, which is also the name of its file.
    pub(crate) fn watch_work(
        self,
        work: impl FnOnce(&str) -> Result<Exit, CommandError>,
    ) -> Result<Exit, CommandError> {
        let Some(to) = self.dispatch else { return work(&self.worker) };
        let ended = dispatcher::with_default(&to, || within_worker_span(&self.worker, work));
        if let Some(telemetry) = self.telemetry {
            telemetry.send_rest();
        }
        ended
    }
}

fn within_worker_span(
    worker: &str,
    work: impl FnOnce(&str) -> Result<Exit, CommandError>,
) -> Result<Exit, CommandError> {
    let span = info_span!(
        target: SPAN_TARGET,
        "worker",
        worker,
        version = env!("CARGO_PKG_VERSION"),
        run = Empty,
        exit_code = Empty,
        otel.status_code = Empty,
    );
    let ended = span.in_scope(|| work(worker));
    let exit = ended.as_ref().map_or_else(CommandError::exit_code, |exit| *exit);
    span.record("exit_code", exit as u8);
    if !matches!(exit, Exit::Done | Exit::WithLoss) {
        span.record("otel.status_code", "ERROR");
    }
    ended
}

/// Records the run's id in the current span, which must be the worker's.
pub(crate) fn record_run_id(id: &str) {
    Span::current().record("run", id);
}
