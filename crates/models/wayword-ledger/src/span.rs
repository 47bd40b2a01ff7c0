//! The tracing span of a call, for monitoring a run. For privacy it contains no words of the call or its answer.

use crate::{Answer, Call, Occasion};
use tracing::{Span, field::Empty, info_span};

/// The tracing target of the program's spans, which distinguishes them from those of other crates.
pub const TARGET: &str = "wayword";

/// The span of a call, from the first look into the ledger to the answer.
#[derive(Debug)]
pub(crate) struct CallSpan(Span);

impl CallSpan {
    pub(crate) fn begin(call: &Call) -> Self {
        let span = info_span!(
            target: TARGET,
            "call",
            model = call.model,
            purpose = Empty,
            from_ledger = Empty,
            attempts = Empty,
            tokens_in = Empty,
            tokens_out = Empty,
            usd = Empty,
            error = Empty,
            otel.status_code = Empty,
        );
        if let Some(purpose) = Occasion::purpose() {
            span.record("purpose", purpose);
        }
        Self(span)
    }

    /// The ledger already has the answer. Its cost is not recorded again, so that sums over spans equal the real spending.
    pub(crate) fn found(&self) {
        self.0.record("from_ledger", true);
    }

    /// How many requests were sent.
    pub(crate) fn sent(&self, requests: u32) {
        self.0.record("attempts", requests);
    }

    /// A request was answered.
    pub(crate) fn answered(&self, answer: &Answer) {
        self.0.record("from_ledger", false);
        self.0.record("tokens_in", answer.tokens_in);
        self.0.record("tokens_out", answer.tokens_out);
        if let Some(usd) = answer.usd {
            self.0.record("usd", usd);
        }
    }

    /// There is no answer, for a reason of this kind.
    pub(crate) fn failed(&self, kind: &'static str) {
        self.0.record("error", kind);
        self.0.record("otel.status_code", "ERROR");
    }
}
