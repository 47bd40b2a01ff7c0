//! Decides when a command gives up because its platform or service is gone.

use wayword_core::FailureKind;

/// A command ends after this many items in a row that were lost, because the other items would be lost too. The same
/// number counts for items that all lack the same thing.
pub(crate) const MAX_FAILURES_IN_A_ROW: usize = 5;

/// Number of lost items in a row.
#[derive(Debug, Default)]
pub struct LossCounter(usize);

impl LossCounter {
    /// Counts an item with this failure, or without one. Returns whether the command should end.
    pub fn ends_command(&mut self, failure: Option<FailureKind>) -> bool {
        self.0 = if failure == Some(FailureKind::Lost) { self.0 + 1 } else { 0 };
        self.0 >= MAX_FAILURES_IN_A_ROW
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_losses_in_a_row_count() {
        let mut losses = LossCounter::default();
        let mut take = |failure| losses.ends_command(failure);
        assert!((1..MAX_FAILURES_IN_A_ROW).all(|_| !take(Some(FailureKind::Lost))));
        assert!(!take(Some(FailureKind::Broken)) && !take(None));
        assert!((1..MAX_FAILURES_IN_A_ROW).all(|_| !take(Some(FailureKind::Lost))));
        assert!(take(Some(FailureKind::Lost)));
    }
}
