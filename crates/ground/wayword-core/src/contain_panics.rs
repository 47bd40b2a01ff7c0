//! Contains panics of third-party decoders: when one panics on a broken file, its caller gets a failure
//! and the program goes on.

use std::{
    cell::Cell,
    panic::{AssertUnwindSafe, catch_unwind},
};

thread_local! {
    /// How many calls of [`run_contained`], one within the other, this thread is in.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Runs third-party code on untrusted bytes; `None` where it panicked.
///
/// After a panic, do not use values that `work` could change. Values that it only read can still be used.
pub fn run_contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    DEPTH.set(DEPTH.get() + 1);
    let outcome = catch_unwind(AssertUnwindSafe(work));
    DEPTH.set(DEPTH.get() - 1);
    outcome.ok()
}

/// Runs a third-party decoder. Its panics on broken input become an error.
///
/// # Errors
/// In words, when the decoder refuses its input or panics.
pub fn run_decoder<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    run_contained(decode).unwrap_or_else(|| Err("is broken".to_owned()))
}

/// Whether this thread runs contained code. If so, the program's panic hook prints no message, because the caller
/// reports the failure itself.
#[must_use]
pub fn is_contained() -> bool {
    DEPTH.get() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contained_stops_a_panic_and_marks_the_thread() {
        let panics = || -> u32 { panic!("contained: {}", is_contained()) };
        assert_eq!(run_contained(|| run_contained(panics).map_or_else(is_contained, |_| false)), Some(true));
        assert!(!is_contained());
        assert_eq!(run_contained(|| 7), Some(7));
        assert_eq!(run_decoder(|| -> Result<u8, String> { panic!("broken") }), Err("is broken".to_owned()));
        assert_eq!(run_decoder(|| Ok(7)), Ok(7));
    }
}
