//! Traces the making of a chunk as a span, with its outcome.

use tracing::{Span, field::Empty, info_span};
use wayword_ledger::SPAN_TARGET;
use wayword_queue::{ChunkClaim, ChunkOutcome};

/// Makes a chunk within its span.
pub(crate) fn within_chunk_span<S, E>(
    claimed: ChunkClaim,
    make: impl FnOnce() -> Result<ChunkOutcome<S>, E>,
) -> Result<ChunkOutcome<S>, E> {
    let (number, epoch) = (claimed.chunk as u64, claimed.epoch);
    let span =
        info_span!(target: SPAN_TARGET, "chunk", chunk = number, epoch, outcome = Empty, otel.status_code = Empty);
    let ended = span.in_scope(make);
    match &ended {
        Ok(ChunkOutcome::Done(_)) => record_outcome(&span, "done", true),
        Ok(ChunkOutcome::Stopped(_)) => record_outcome(&span, "stopped", true),
        Ok(ChunkOutcome::Failed(..)) => record_outcome(&span, "failed", false),
        Err(_) => record_outcome(&span, "broken", false),
    }
    ended
}

fn record_outcome(span: &Span, outcome: &str, is_well: bool) {
    span.record("outcome", outcome);
    if !is_well {
        span.record("otel.status_code", "ERROR");
    }
}
