//! Lets one call of a kind go ahead alone until a service has answered one of that kind. A fault that every call would meet, as of a
//! wrong address or of a model without pictures, is then met once, and not by all calls that are in flight together.

use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, PoisonError},
    time::Duration,
};

/// After faults of this weight without any answer, every call of a kind is expected to fail: two calls that were each asked for twice,
/// or four that were refused.
const MAX_FAULT_WEIGHT: u32 = 4;
/// How often a waiting thread checks whether the run was stopped.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// What calls have in common that succeed or fail together.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CallKind {
    /// The name of the model.
    pub(crate) model: String,
    /// Whether the model is shown pictures.
    pub(crate) has_pictures: bool,
}

/// What is known of the calls of each kind.
#[derive(Debug, Default)]
pub(crate) struct FirstCalls {
    kinds: Mutex<BTreeMap<CallKind, KindState>>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct KindState {
    /// Calls of this kind go ahead together.
    is_open: bool,
    /// A service answered a call of this kind.
    is_answered: bool,
    /// A call goes ahead alone.
    is_tried: bool,
    /// The faults before any answer.
    fault_weight: u32,
}

/// A call that may go ahead. The next one may where it ends.
pub(crate) struct FirstCallTurn<'a> {
    calls: &'a FirstCalls,
    kind: &'a CallKind,
    is_alone: bool,
}

impl FirstCalls {
    /// Waits until a call may go ahead; `None` where the run was stopped meanwhile.
    pub(crate) fn wait_for_turn<'a>(
        &'a self,
        kind: &'a CallKind,
        is_stopped: impl Fn() -> bool,
    ) -> Option<FirstCallTurn<'a>> {
        let mut kinds = self.kinds.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let state = kinds.entry(kind.clone()).or_default();
            if state.is_open {
                return Some(FirstCallTurn { calls: self, kind, is_alone: false });
            }
            if !state.is_tried {
                state.is_tried = true;
                return Some(FirstCallTurn { calls: self, kind, is_alone: true });
            }
            if is_stopped() {
                return None;
            }
            let waited = self.changed.wait_timeout(kinds, STOP_CHECK_INTERVAL);
            kinds = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn change(&self, kind: &CallKind, change: impl FnOnce(&mut KindState)) {
        let mut kinds = self.kinds.lock().unwrap_or_else(PoisonError::into_inner);
        change(kinds.entry(kind.clone()).or_default());
        self.changed.notify_all();
    }
}

impl FirstCallTurn<'_> {
    /// Notes an answer: from now on, calls of this kind go ahead together.
    pub(crate) fn note_answer(&self) {
        self.calls.change(self.kind, |state| (state.is_open, state.is_answered) = (true, true));
    }

    /// Notes that no service was reached, which tells nothing of the other calls of this kind.
    pub(crate) fn note_loss(&self) {
        self.calls.change(self.kind, |state| state.is_open = true);
    }

    /// Notes a fault. Whether so many came without any answer that all calls of this kind are expected to fail.
    pub(crate) fn note_fault(&self, weight: u32) -> bool {
        let mut fails = false;
        self.calls.change(self.kind, |state| {
            state.fault_weight = state.fault_weight.saturating_add(weight);
            fails = !state.is_answered && state.fault_weight >= MAX_FAULT_WEIGHT;
        });
        fails
    }
}

impl Drop for FirstCallTurn<'_> {
    fn drop(&mut self) {
        if self.is_alone {
            self.calls.change(self.kind, |state| state.is_tried = false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        sync::atomic::{AtomicBool, AtomicUsize, Ordering},
        thread,
    };

    fn kind(has_pictures: bool) -> CallKind {
        CallKind { model: "server/m".to_owned(), has_pictures }
    }

    #[test]
    fn calls_go_ahead_one_by_one_until_one_is_answered() {
        let (calls, kind) = (FirstCalls::default(), kind(true));
        let (in_flight, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    let turn = calls.wait_for_turn(&kind, || false).unwrap();
                    most.fetch_max(in_flight.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                    thread::sleep(Duration::from_millis(2));
                    in_flight.fetch_sub(1, Ordering::SeqCst);
                    turn.note_fault(0);
                });
            }
        });
        assert_eq!(most.load(Ordering::SeqCst), 1);
        calls.wait_for_turn(&kind, || false).unwrap().note_answer();
        let together = [(); 3].map(|()| calls.wait_for_turn(&kind, || true).unwrap());
        assert!(together.iter().all(|turn| !turn.is_alone));
    }

    #[test]
    fn a_stopped_run_and_other_kinds_do_not_wait() {
        let calls = FirstCalls::default();
        let (seeing, writing) = (kind(true), kind(false));
        let _alone = calls.wait_for_turn(&seeing, || false).unwrap();
        assert!(calls.wait_for_turn(&writing, || false).is_some());
        let stopped = AtomicBool::new(true);
        assert!(calls.wait_for_turn(&seeing, || stopped.load(Ordering::SeqCst)).is_none());
    }

    #[test]
    fn faults_count_only_until_an_answer_came() {
        let (calls, kind) = (FirstCalls::default(), kind(false));
        let turn = calls.wait_for_turn(&kind, || false).unwrap();
        assert_eq!([1, 1, 1, 1].map(|weight| turn.note_fault(weight)), [false, false, false, true]);
        turn.note_answer();
        assert!(!turn.note_fault(4));
    }
}
