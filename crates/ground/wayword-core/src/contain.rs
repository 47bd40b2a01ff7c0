//! Other people's decoders: a panic of theirs on a broken file ends what they were doing, and nothing else.

use std::{
    cell::Cell,
    panic::{AssertUnwindSafe, catch_unwind},
};

thread_local! {
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Runs somebody else's code on bytes that nobody vouches for; `None` where it panicked.
///
/// What it was given is not to be used after that, unless it was only read.
pub fn contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    DEPTH.set(DEPTH.get() + 1);
    let done = catch_unwind(AssertUnwindSafe(work));
    DEPTH.set(DEPTH.get() - 1);
    done.ok()
}

/// Runs somebody else's decoder, whose panics on broken input become a refusal.
///
/// # Errors
/// In words, when it refuses what it was given, or panicked.
pub fn decoded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    contained(decode).unwrap_or_else(|| Err("is broken".to_owned()))
}

/// Whether this thread runs what is contained. A program's panic hook says nothing then: there is an answer without a panic's words.
#[must_use]
pub fn is_contained() -> bool {
    DEPTH.get() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_contained_and_known_to_be() {
        let panics = || -> u32 { panic!("contained: {}", is_contained()) };
        assert_eq!(contained(|| contained(panics).map_or_else(is_contained, |_| false)), Some(true));
        assert!(!is_contained());
        assert_eq!(contained(|| 7), Some(7));
        assert_eq!(decoded(|| -> Result<u8, String> { panic!("broken") }), Err("is broken".to_owned()));
        assert_eq!(decoded(|| Ok(7)), Ok(7));
    }
}
