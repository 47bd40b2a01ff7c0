//! The tracing span of a call, for monitoring a run. For privacy it contains no words of the call or its answer.

use crate::{CallAnswer, CallContext, ModelCall};
use tracing::{Span, field::Empty, info_span};

/// The tracing target of the program's spans, which distinguishes them from those of other crates.
pub const SPAN_TARGET: &str = "wayword";

/// The span of a call, from the first look into the ledger to the answer.
#[derive(Debug)]
pub(crate) struct CallSpan(Span);

impl CallSpan {
    /// Begins the span. The fields that are not known yet are empty; the functions below fill them.
    pub(crate) fn begin_call(call: &ModelCall) -> Self {
        let span = info_span!(
            target: SPAN_TARGET,
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
        if let Some(purpose) = CallContext::current_purpose() {
            span.record("purpose", purpose);
        }
        Self(span)
    }

    /// The ledger already has the answer. Its cost is not recorded again, so that sums over spans equal the real spending.
    pub(crate) fn record_ledger_hit(&self) {
        self.0.record("from_ledger", true);
    }

    /// How many requests were sent.
    pub(crate) fn record_attempts(&self, requests: u32) {
        self.0.record("attempts", requests);
    }

    /// A request was answered.
    pub(crate) fn record_answer(&self, answer: &CallAnswer) {
        self.0.record("from_ledger", false);
        self.0.record("tokens_in", answer.tokens_in);
        self.0.record("tokens_out", answer.tokens_out);
        if let Some(usd) = answer.usd {
            self.0.record("usd", usd);
        }
    }

    /// There is no answer, for a reason of this kind.
    pub(crate) fn record_error(&self, kind: &'static str) {
        self.0.record("error", kind);
        self.0.record("otel.status_code", "ERROR");
    }
}
