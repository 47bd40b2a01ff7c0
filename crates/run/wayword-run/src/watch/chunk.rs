//! Traces the making of a chunk as a span, with its outcome.

use tracing::{Span, field::Empty, info_span};
use wayword_ledger::TARGET;
use wayword_queue::{Claimed, Ended};

/// Makes a chunk within its span.
pub(crate) fn chunk<S, E>(claimed: Claimed, make: impl FnOnce() -> Result<Ended<S>, E>) -> Result<Ended<S>, E> {
    let (number, epoch) = (claimed.chunk as u64, claimed.epoch);
    let span = info_span!(target: TARGET, "chunk", chunk = number, epoch, outcome = Empty, otel.status_code = Empty);
    let ended = span.in_scope(make);
    match &ended {
        Ok(Ended::Done(_)) => tell(&span, "done", true),
        Ok(Ended::Stopped(_)) => tell(&span, "stopped", true),
        Ok(Ended::Failed(..)) => tell(&span, "failed", false),
        Err(_) => tell(&span, "broken", false),
    }
    ended
}

fn tell(span: &Span, outcome: &str, is_well: bool) {
    span.record("outcome", outcome);
    if !is_well {
        span.record("otel.status_code", "ERROR");
    }
}
