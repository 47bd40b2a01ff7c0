//! Traces the making of an item as a span.

use super::keep::ItemFate;
use crate::{error::CommandError, item::RunItem, pipeline::MadeItem};
use std::time::Instant;
use tracing::{Span, field::Empty, info_span};
use wayword_ledger::SPAN_TARGET;
use wayword_synthesis::repair::WritingOutcome;

/// The span of an item: from its beginning until the run folder holds it.
pub(super) struct ItemSpan {
    span: Span,
    /// Texts that passed.
    written: usize,
    /// The part that failed, if it is known before the item is kept.
    failed: &'static str,
    /// Whether the outcome of the item was recorded.
    is_recorded: bool,
}

impl ItemSpan {
    /// Begins as a part of the span that this thread is in.
    pub(super) fn begin(item: &RunItem) -> Self {
        let span = info_span!(
            target: SPAN_TARGET,
            "item",
            item = item.id(),
            outcome = Empty,
            written = Empty,
            rejected = Empty,
            reason = Empty,
            making_s = Empty,
            otel.status_code = Empty,
        );
        Self { span, written: 0, failed: "other", is_recorded: false }
    }

    /// Makes the item within the span. Finished items wait for their turn to be kept, so the time of the making is recorded in a
    /// field of its own.
    pub(super) fn make_within(
        &mut self,
        make: impl FnOnce() -> Result<MadeItem, CommandError>,
    ) -> Result<MadeItem, CommandError> {
        if self.span.is_disabled() {
            return make();
        }
        let since = Instant::now();
        let made = self.span.in_scope(make);
        self.span.record("making_s", since.elapsed().as_secs_f64());
        match &made {
            Ok(made) => self.record_counts(&made.outcomes),
            Err(error) => self.failed = error.failed_part(),
        }
        made
    }

    fn record_counts(&mut self, texts: &[WritingOutcome]) {
        self.written = texts.iter().filter(|text| matches!(text, WritingOutcome::Accepted(_))).count();
        self.span.record("written", self.written as u64);
        self.span.record("rejected", (texts.len() - self.written) as u64);
    }

    /// Ends the span with the outcome of the item. Its reason is from a fixed list of words; the message of a service is only in
    /// `errors.jsonl`.
    pub(super) fn end_with(mut self, fate: &ItemFate) {
        let (outcome, failure) = match fate {
            ItemFate::Made if self.written > 0 => ("written", None),
            ItemFate::Made => ("rejected", None),
            ItemFate::Failed(failure, _) => ("failed", Some(*failure)),
            ItemFate::Stopped(_) => ("stopped", None),
        };
        self.record_outcome(outcome);
        if let Some(failure) = failure {
            self.span.record("reason", format!("{} {}", self.failed, failure.name()));
            self.span.record("otel.status_code", "ERROR");
        }
    }

    fn record_outcome(&mut self, outcome: &str) {
        self.is_recorded = true;
        self.span.record("outcome", outcome);
    }
}

impl Drop for ItemSpan {
    fn drop(&mut self) {
        if !self.is_recorded {
            self.record_outcome("dropped");
        }
    }
}
