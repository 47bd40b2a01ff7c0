//! Makes several independent results at the same time.

use std::{
    panic::resume_unwind,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
};
use wayword_ledger::CallContext;

/// Calls `make` for each item on at most `threads` threads, and returns the results in the order of the items. After a result
/// for which `ends` is true no further item is begun, so the results of the last items may be missing.
pub fn make_in_parallel<I: Sync, R: Send>(
    items: &[I],
    threads: usize,
    make: impl Fn(&I) -> R + Sync,
    ends: impl Fn(&R) -> bool + Sync,
) -> Vec<R> {
    let (next, ended) = (AtomicUsize::new(0), AtomicBool::new(false));
    let made: Mutex<Vec<(usize, R)>> = Mutex::default();
    let work = || {
        while !ended.load(Ordering::Relaxed) {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(at) else { break };
            let result = make(item);
            ended.fetch_or(ends(&result), Ordering::Relaxed);
            made.lock().unwrap_or_else(PoisonError::into_inner).push((at, result));
        }
    };
    // The calls that the other threads make belong to the span of this thread.
    let call_context = CallContext::from_current_thread();
    thread::scope(|scope| {
        let others: Vec<_> =
            (1..threads.min(items.len())).map(|_| scope.spawn(|| call_context.run_within(work))).collect();
        work();
        for other in others {
            if let Err(panic) = other.join() {
                resume_unwind(panic);
            }
        }
    });
    let mut made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
    made.sort_by_key(|(at, _)| *at);
    // Items are begun in their order, so those that were not begun are at the end.
    made.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn results_come_in_order_and_waits_overlap() {
        let items: Vec<u64> = (0..12).collect();
        let begun = Instant::now();
        let make = |item: &u64| {
            thread::sleep(Duration::from_millis(40 + item * 7919 % 20));
            item * 2
        };
        let made = make_in_parallel(&items, 8, make, |_| false);
        assert_eq!(made, items.iter().map(|item| item * 2).collect::<Vec<_>>());
        assert!(begun.elapsed() < Duration::from_millis(12 * 40), "{:?}", begun.elapsed());
        assert_eq!(make_in_parallel(&items, 1, |item| *item, |_| false), items);
        assert_eq!(make_in_parallel(&[], 8, |item: &u64| *item, |_| false), Vec::<u64>::new());
    }

    #[test]
    fn make_in_parallel_begins_no_item_after_the_end() {
        let items: Vec<usize> = (0..1000).collect();
        let made = make_in_parallel(&items, 4, |item| *item, |item| *item == 10);
        assert!((11..=20).contains(&made.len()), "{}", made.len());
        assert_eq!(made, items[..made.len()]);
    }
}
