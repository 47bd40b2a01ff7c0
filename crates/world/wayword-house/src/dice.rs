//! Random choices from a seed, the same on every machine.

use rand_chacha::{ChaCha8Rng, rand_core::RngCore};

/// A random number generator that draws integers only, so that the result depends neither on the machine's word size nor
/// on its mathematics library.
#[derive(Debug)]
pub(crate) struct HouseDice(ChaCha8Rng);

impl HouseDice {
    /// The generator for one purpose within a house. Each purpose has its own, so that a change in one part of a house leaves
    /// the other parts as they were.
    pub(crate) fn new(seed: u64, purpose: &[&str]) -> Self {
        Self(wayword_core::seeded_rng(seed, purpose))
    }

    /// A number in `low..=high`; `low` where the range is empty.
    pub(crate) fn draw_between(&mut self, low: i32, high: i32) -> i32 {
        let count = (i64::from(high) - i64::from(low) + 1).max(1).unsigned_abs();
        let drawn = (u64::from(self.0.next_u32()) * count) >> 32;
        low + drawn as i32
    }

    /// `low` plus a random multiple of `step`, at most `high`.
    pub(crate) fn draw_stepped(&mut self, low: i32, high: i32, step: i32) -> i32 {
        low + step * self.draw_between(0, (high - low).max(0) / step)
    }

    /// True with a probability of `percent` in a hundred.
    pub(crate) fn chance(&mut self, percent: i32) -> bool {
        self.draw_between(1, 100) <= percent
    }

    /// One of a list's indices; 0 for an empty list.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        self.draw_between(0, count as i32 - 1).max(0) as usize
    }

    /// One of a non-empty array.
    pub(crate) fn pick<T: Copy, const N: usize>(&mut self, options: [T; N]) -> T {
        options[self.index(N)]
    }

    /// Puts a list into random order.
    pub(crate) fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.index(last + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_stay_in_range_and_reach_both_ends() {
        let mut dice = HouseDice::new(1, &["test"]);
        let drawn: Vec<_> = (0..200).map(|_| dice.draw_between(-1, 2)).collect();
        assert!(drawn.iter().all(|n| (-1..=2).contains(n)));
        assert!((-1..=2).all(|n| drawn.contains(&n)));
        assert_eq!(dice.draw_between(5, 3), 5);
        assert!((0..50).all(|_| dice.draw_stepped(10, 34, 5) % 5 == 0));
    }
}
