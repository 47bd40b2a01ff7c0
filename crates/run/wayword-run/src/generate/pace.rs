//! Measures how fast a run makes calls to models, and estimates the time that is left. Early on, the expected number of calls
//! per item counts; later, the number that finished items really took.

use crate::calls::CallSpending;
use indicatif::HumanDuration;
use std::{
    collections::VecDeque,
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

/// The pace is measured over the last minute, because the first answers may come from the ledger, which is fast.
const PACE_WINDOW: Duration = Duration::from_secs(60);
/// After this many finished items, their real number of calls counts as much as the expected number; after more, it
/// counts more.
const HALF_TRUST_ITEMS: f64 = 3.0;
/// Time between two looks at the calls.
const LOOK_INTERVAL: Duration = Duration::from_secs(1);

/// The progress of a run's calls.
pub(super) struct CallPace {
    /// Items to make.
    items: usize,
    /// Items that are made at the same time.
    workers: usize,
    /// Expected calls per item, from the plan.
    expected: f64,
    /// Items that are finished.
    done: AtomicUsize,
    /// The looks within `PACE_WINDOW`: when, and how many calls were made until then.
    seen: Mutex<VecDeque<(Instant, u64)>>,
    /// Whether the watch is over.
    ended: Mutex<bool>,
    /// Wakes the watch when it is over.
    ends: Condvar,
}

impl CallPace {
    pub(super) fn new(items: usize, workers: usize, expected: f64) -> Self {
        let (done, seen, ended, ends) = Default::default();
        Self { items, workers, expected, done, seen, ended, ends }
    }

    /// Takes note that an item is finished.
    pub(super) fn item_is_done(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Ends [`Self::watch_calls`].
    pub(super) fn end_watch(&self) {
        *lock_mutex(&self.ended) = true;
        self.ends.notify_all();
    }

    /// Looks at the calls every second until [`Self::end_watch`], and reports their progress to `show`.
    pub(super) fn watch_calls(&self, spent: impl Fn() -> CallSpending, show: impl Fn(&str)) {
        let mut ended = lock_mutex(&self.ended);
        while !*ended {
            ended = self.ends.wait_timeout(ended, LOOK_INTERVAL).unwrap_or_else(PoisonError::into_inner).0;
            let (now, spent) = (Instant::now(), spent());
            show(&self.describe_progress(now, spent.answered + spent.from_ledger));
        }
    }

    /// The progress as text: "31 of about 120 calls, 2 minutes left".
    fn describe_progress(&self, now: Instant, made: u64) -> String {
        let all = self.expected_calls(made as f64).round().max(made as f64);
        let left = match self.per_second(now, made) {
            Some(pace) if all > made as f64 => {
                let left = Duration::from_secs_f64(((all - made as f64) / pace).clamp(1.0, 1e8));
                format!(", {:#} left", HumanDuration(left))
            }
            _ => String::new(),
        };
        format!("{made} of about {all} calls{left}")
    }

    /// The expected number of calls of the whole run, given `made` so far.
    fn expected_calls(&self, made: f64) -> f64 {
        let (items, done) = (self.items as f64, self.done.load(Ordering::Relaxed) as f64);
        // Items in work are half done on average.
        let begun = done + (items - done).min(self.workers as f64) / 2.0;
        let trust = done / (done + HALF_TRUST_ITEMS);
        let per_item = trust * made / begun.max(1.0) + (1.0 - trust) * self.expected;
        if done >= items { made } else { (per_item * items).max(made) }
    }

    /// Calls per second within the last minute; `None` if there was no call.
    fn per_second(&self, now: Instant, made: u64) -> Option<f64> {
        let mut seen = lock_mutex(&self.seen);
        seen.push_back((now, made));
        while seen.len() > 2 && seen.front().is_some_and(|(at, _)| now.duration_since(*at) > PACE_WINDOW) {
            seen.pop_front();
        }
        let (at, before) = *seen.front()?;
        let pace = made.saturating_sub(before) as f64 / now.duration_since(at).as_secs_f64();
        (pace.is_finite() && pace > 0.0).then_some(pace)
    }
}

fn lock_mutex<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_that_is_left_follows_from_the_calls() {
        let pace = CallPace::new(1, 8, 13.0);
        let start = Instant::now();
        assert_eq!(pace.describe_progress(start, 0), "0 of about 13 calls");
        assert_eq!(pace.describe_progress(start + Duration::from_secs(10), 8), "8 of about 13 calls, 6s left");
        // More calls than expected: the number left is unknown.
        assert_eq!(pace.describe_progress(start + Duration::from_secs(20), 20), "20 of about 20 calls");
    }

    #[test]
    fn expected_calls_weigh_the_plan_against_finished_items() {
        let pace = CallPace::new(100, 1, 10.0);
        (0..30).for_each(|_| pace.item_is_done());
        let all = pace.expected_calls(610.0);
        assert!((1800.0..2000.0).contains(&all), "{all}");
        (30..100).for_each(|_| pace.item_is_done());
        assert!((pace.expected_calls(2000.0) - 2000.0).abs() < 1e-9);
    }

    #[test]
    fn watch_calls_ends_when_the_run_ends() {
        let pace = CallPace::new(1, 1, 1.0);
        std::thread::scope(|scope| {
            scope.spawn(|| pace.watch_calls(CallSpending::default, |_| {}));
            pace.end_watch();
        });
    }
}
