//! Lets people see what a run does: spans of the worker, its chunks, items and calls, as lines of a file and, with the
//! feature `telemetry`, at a collector of OpenTelemetry.
//!
//! Spans are made by `tracing`. A subscriber is there only while somebody watches, for the threads of one command, so a
//! program that this one runs in keeps its own. Other threads get it with their parent, by an
//! [`wayword_ledger::Occasion`].

mod chunk;
mod lines;

use crate::{
    error::{Error, Exit},
    output::Output,
};
pub(crate) use chunk::chunk;
use lines::Lines;
use std::path::Path;
use tracing::{Dispatch, Span, dispatcher, field::Empty, info_span, level_filters::LevelFilter};
use tracing_subscriber::{Registry, filter::Targets, layer::SubscriberExt};
use wayword_ledger::TARGET;

/// Watches one command.
pub(crate) struct Watch {
    worker: String,
    /// `None` if nobody watches.
    to: Option<Dispatch>,
}

impl Watch {
    /// Writes spans into a file of this worker in the folder, if one is given.
    ///
    /// # Errors
    /// When the file cannot be made, unless the disk is full.
    pub(crate) fn start(spans: Option<&Path>, output: &Output) -> Result<Self, Error> {
        let worker = wayword_queue::worker_name();
        let lines = spans.map(|folder| Lines::begin(folder, &worker, output)).transpose()?.flatten();
        let to = lines.map(|lines| {
            let ours = Targets::new().with_target(TARGET, LevelFilter::INFO);
            Dispatch::new(Registry::default().with(ours).with(lines))
        });
        Ok(Self { worker, to })
    }

    /// The name of this worker, which is that of its file.
    pub(crate) fn worker(&self) -> &str {
        &self.worker
    }

    /// Does a worker's work within its span.
    pub(crate) fn during(&self, work: impl FnOnce() -> Result<Exit, Error>) -> Result<Exit, Error> {
        match &self.to {
            Some(to) => dispatcher::with_default(to, || within(&self.worker, work)),
            None => work(),
        }
    }
}

fn within(worker: &str, work: impl FnOnce() -> Result<Exit, Error>) -> Result<Exit, Error> {
    let span = info_span!(
        target: TARGET,
        "worker",
        worker,
        version = env!("CARGO_PKG_VERSION"),
        run = Empty,
        exit_code = Empty,
        otel.status_code = Empty,
    );
    let ended = span.in_scope(work);
    let exit = ended.as_ref().map_or_else(Error::exit_code, |exit| *exit);
    span.record("exit_code", exit as u8);
    if !matches!(exit, Exit::Done | Exit::WithLoss) {
        span.record("otel.status_code", "ERROR");
    }
    ended
}

/// Notes in the worker's span, within which this has to be called, which run it works on.
pub(crate) fn is_of_run(id: &str) {
    Span::current().record("run", id);
}
