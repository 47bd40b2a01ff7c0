//! When a command gives up, because what it needs is gone.

use wayword_core::Failure;

/// So many items in a row whose world or service was lost end a command: the others would wait for the same.
pub(crate) const MOST_IN_A_ROW: usize = 5;

/// Items in a row that were lost.
#[derive(Debug, Default)]
pub(crate) struct Losses(usize);

impl Losses {
    /// Takes note of an item that failed so, or not at all. Returns whether that is enough.
    pub(crate) fn are_enough(&mut self, failure: Option<Failure>) -> bool {
        self.0 = if failure == Some(Failure::Lost) { self.0 + 1 } else { 0 };
        self.0 >= MOST_IN_A_ROW
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_losses_in_a_row_count() {
        let mut losses = Losses::default();
        let mut take = |failure| losses.are_enough(failure);
        assert!((1..MOST_IN_A_ROW).all(|_| !take(Some(Failure::Lost))));
        assert!(!take(Some(Failure::Broken)) && !take(None));
        assert!((1..MOST_IN_A_ROW).all(|_| !take(Some(Failure::Lost))));
        assert!(take(Some(Failure::Lost)));
    }
}
