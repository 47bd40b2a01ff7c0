//! Clauses that the reader did not understand, and languages that it does not read.

use wayword_core::Finding;
use wayword_language::reading::Reading;

/// What of a text was not understood: such a text is unverified, and never right. The reader does not say so yet.
pub(super) fn coverage(_reading: &Reading) -> Vec<Finding> {
    Vec::new()
}
