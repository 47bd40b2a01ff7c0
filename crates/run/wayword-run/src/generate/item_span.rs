//! Traces the making of an item as a span.

use super::keep::Fate;
use crate::{error::Error, item::Item, pipeline::Made};
use std::time::Instant;
use tracing::{Span, field::Empty, info_span};
use wayword_ledger::TARGET;
use wayword_synthesis::repair::Outcome;

/// The span of an item: from its beginning until the run folder holds it.
pub(super) struct ItemSpan {
    span: Span,
    /// Texts that passed.
    written: usize,
    /// The part that failed, if it is known before the item is kept.
    failed: &'static str,
    /// Whether the outcome of the item was recorded.
    is_told: bool,
}

impl ItemSpan {
    /// Begins as a part of the span that this thread is in.
    pub(super) fn begin(item: &Item) -> Self {
        let span = info_span!(
            target: TARGET,
            "item",
            item = item.id(),
            outcome = Empty,
            written = Empty,
            rejected = Empty,
            reason = Empty,
            making_s = Empty,
            otel.status_code = Empty,
        );
        Self { span, written: 0, failed: "other", is_told: false }
    }

    /// Makes the item within the span. Finished items wait for their turn to be kept, so the time of the making is recorded in a
    /// field of its own.
    pub(super) fn make(&mut self, make: impl FnOnce() -> Result<Made, Error>) -> Result<Made, Error> {
        if self.span.is_disabled() {
            return make();
        }
        let since = Instant::now();
        let made = self.span.in_scope(make);
        self.span.record("making_s", since.elapsed().as_secs_f64());
        match &made {
            Ok(made) => self.counts(&made.outcomes),
            Err(error) => self.failed = error.of(),
        }
        made
    }

    fn counts(&mut self, texts: &[Outcome]) {
        self.written = texts.iter().filter(|text| matches!(text, Outcome::Accepted(_))).count();
        self.span.record("written", self.written as u64);
        self.span.record("rejected", (texts.len() - self.written) as u64);
    }

    /// Ends the span with the outcome of the item. Its reason is from a fixed list of words; the message of a service is only in
    /// `errors.jsonl`.
    pub(super) fn end(mut self, fate: &Fate) {
        let (outcome, failure) = match fate {
            Fate::Made if self.written > 0 => ("written", None),
            Fate::Made => ("rejected", None),
            Fate::Failed(failure, _) => ("failed", Some(*failure)),
            Fate::Stopped(_) => ("stopped", None),
        };
        self.tell(outcome);
        if let Some(failure) = failure {
            self.span.record("reason", format!("{} {}", self.failed, failure.name()));
            self.span.record("otel.status_code", "ERROR");
        }
    }

    fn tell(&mut self, outcome: &str) {
        self.is_told = true;
        self.span.record("outcome", outcome);
    }
}

impl Drop for ItemSpan {
    fn drop(&mut self) {
        if !self.is_told {
            self.tell("dropped");
        }
    }
}
