//! Makes many items in parallel, and passes the results on in the order of the items.

use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, PoisonError, mpsc},
    thread,
};

/// How far the newest item may be ahead of the oldest unfinished one, in items per worker: enough that one slow item does not
/// delay the others, few enough that finished items do not fill the memory.
const MAX_ITEMS_AHEAD_PER_WORKER: usize = 4;

/// Number of items that are made in parallel if no model is called.
pub fn core_count() -> usize {
    thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Calls its function if it is dropped during a panic.
struct PanicAction<'a>(&'a dyn Fn());

impl Drop for PanicAction<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            (self.0)();
        }
    }
}

/// The state of the work.
struct OrderedProgress {
    /// Index of the item that is begun next.
    next: usize,
    /// Number of items that were passed to `keep`.
    kept: usize,
    /// Whether no further item is begun.
    stopped: bool,
}

/// Calls `make` for each item on `workers` threads, and `keep` with each result in the order of the items. When `keep` returns
/// `false` or fails, no further item is begun; those in progress are finished and dropped.
///
/// # Errors
/// The first error of `keep`.
pub fn in_order<I: Sync, R: Send, E>(
    items: &[I],
    workers: usize,
    make: impl Fn(&I) -> R + Sync,
    mut keep: impl FnMut(&I, R) -> Result<bool, E>,
) -> Result<(), E> {
    let workers = workers.clamp(1, items.len().max(1));
    let progress = Mutex::new(OrderedProgress { next: 0, kept: 0, stopped: false });
    let moved = Condvar::new();
    let take = || {
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if progress.stopped || progress.next >= items.len() {
                return None;
            }
            if progress.next < progress.kept + workers * MAX_ITEMS_AHEAD_PER_WORKER {
                progress.next += 1;
                return Some(progress.next - 1);
            }
            progress = moved.wait(progress).unwrap_or_else(PoisonError::into_inner);
        }
    };
    let update = |change: &dyn Fn(&mut OrderedProgress)| {
        change(&mut progress.lock().unwrap_or_else(PoisonError::into_inner));
        moved.notify_all();
    };
    let stop = || update(&|progress| progress.stopped = true);
    thread::scope(|scope| {
        // Workers must not wait for room after `keep` has panicked.
        let _last = PanicAction(&stop);
        let (sender, results) = mpsc::channel();
        for _ in 0..workers {
            let (sender, take, make, stop) = (sender.clone(), &take, &make, &stop);
            scope.spawn(move || {
                // Without this, a panic in one worker would leave the others waiting for its item for ever.
                let _last = PanicAction(stop);
                while let Some(at) = take() {
                    // The receiver is gone once `keep` has returned `false`.
                    let _ = sender.send((at, make(&items[at])));
                }
            });
        }
        drop(sender);
        // Results that came before those of earlier items.
        let mut waiting = BTreeMap::new();
        let mut kept = 0;
        for (at, result) in results {
            waiting.insert(at, result);
            while let Some(result) = waiting.remove(&kept) {
                let goes_on = keep(&items[kept], result);
                if !matches!(goes_on, Ok(true)) {
                    stop();
                    return goes_on.map(drop);
                }
                kept += 1;
                update(&|progress| progress.kept = kept);
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        sync::atomic::{AtomicUsize, Ordering},
        time::Duration,
    };

    #[test]
    fn in_order_keeps_the_order_of_the_items_however_long_each_takes() {
        let items: Vec<u64> = (0..200).collect();
        let mut kept = Vec::new();
        let make = |item: &u64| {
            thread::sleep(Duration::from_micros(item * 7919 % 997));
            item * 2
        };
        let keep = |item: &u64, twice| {
            kept.push((*item, twice));
            Ok::<bool, ()>(true)
        };
        in_order(&items, 16, make, keep).unwrap();
        assert_eq!(kept, items.iter().map(|item| (*item, item * 2)).collect::<Vec<_>>());
    }

    #[test]
    fn a_panic_ends_the_work_instead_of_hanging_it() {
        let items: Vec<usize> = (0..1000).collect();
        let make = |item: &usize| {
            assert_ne!(*item, 3, "this one panics on purpose");
            *item
        };
        let work = || in_order(&items, 2, make, |_, _| Ok::<bool, ()>(true));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).is_err());
    }

    #[test]
    fn a_panic_while_keeping_ends_the_work_too() {
        let items: Vec<usize> = (0..1000).collect();
        let keep = |item: &usize, _| {
            assert_ne!(*item, 3, "this one panics on purpose");
            Ok::<bool, ()>(true)
        };
        let work = || in_order(&items, 2, |item| *item, keep);
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).is_err());
    }

    #[test]
    fn in_order_begins_no_item_after_the_end_and_returns_errors() {
        let begun = AtomicUsize::new(0);
        let items: Vec<usize> = (0..1000).collect();
        let make = |item: &usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            *item
        };
        in_order(&items, 2, make, |_, item| Ok::<bool, ()>(item < 10)).unwrap();
        assert!(begun.load(Ordering::Relaxed) <= 11 + 2 * MAX_ITEMS_AHEAD_PER_WORKER);
        assert_eq!(in_order(&items, 2, |item| *item, |_, _| Err("full")), Err("full"));
        assert_eq!(in_order(&[], 2, |item: &usize| *item, |_, _| Err("never")), Ok(()));
    }
}
