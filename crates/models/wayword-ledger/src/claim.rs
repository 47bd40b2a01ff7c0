//! Lets one of all programs that have the ledger open make a call, while the others wait for its answer. [`crate::flight`] does this
//! for threads of one program.

use crate::{
    CallKey, LedgerError,
    store::{CallStore, ClaimState},
};
use std::{
    thread,
    time::{Duration, Instant},
};

/// Pause before the second check whether another program is done. Each further pause is twice as long as the one before.
const FIRST_PAUSE: Duration = Duration::from_millis(10);
/// Longest pause between two checks.
const MAX_PAUSE: Duration = Duration::from_millis(250);

/// How long to wait for a program that has claimed a call and neither sends another request for it nor releases it, because it is
/// suspended or hangs. The timeouts of all requests are shorter.
pub(crate) const ABANDONED_CLAIM_TIMEOUT: Duration = Duration::from_secs(3600);

/// The right to make a call. Other programs wait until it is dropped or the call is answered.
pub(crate) struct CallClaim<'a> {
    store: &'a dyn CallStore,
    key: &'a CallKey,
    /// Whether the claim still has to be released. The ledger releases it itself when it stores the answer.
    is_held: bool,
}

/// The result of [`CallClaim::take_claim`].
pub(crate) enum ClaimOutcome<'a> {
    /// This program has the claim.
    Ours(CallClaim<'a>),
    /// Another program has made the call meanwhile.
    Answered,
    /// The run was stopped during the wait.
    Stopped,
}

impl<'a> CallClaim<'a> {
    /// Takes the right to make a call. If another program has it, waits until that program is done, has ended, or has sent no request for
    /// as long as `patience`.
    ///
    /// # Errors
    /// When the ledger cannot be used.
    pub(crate) fn take_claim(
        store: &'a dyn CallStore,
        key: &'a CallKey,
        patience: Duration,
        stopped: impl Fn() -> bool,
    ) -> Result<ClaimOutcome<'a>, LedgerError> {
        // The name of a program that has the claim and is no longer waited for.
        let mut abandoned_by: Option<String> = None;
        loop {
            match store.claim_call(key, abandoned_by.as_deref())? {
                ClaimState::Ours => return Ok(ClaimOutcome::Ours(Self { store, key, is_held: true })),
                ClaimState::Answered => return Ok(ClaimOutcome::Answered),
                ClaimState::Others => {}
            }
            abandoned_by = match wait_for_holder(store, key, patience, &stopped)? {
                WaitOutcome::Released => None,
                WaitOutcome::Abandoned(name) => Some(name),
                WaitOutcome::Stopped => return Ok(ClaimOutcome::Stopped),
            };
        }
    }

    /// Marks the call as answered: the ledger released the claim when it stored the answer.
    pub(crate) fn mark_fulfilled(&mut self) {
        self.is_held = false;
    }
}

impl Drop for CallClaim<'_> {
    fn drop(&mut self) {
        if self.is_held {
            self.store.release_call(self.key);
        }
    }
}

/// How a wait for another program has ended.
enum WaitOutcome {
    /// The program has released the claim, with an answer or without.
    Released,
    /// The program of this name has ended, or has sent no request for too long.
    Abandoned(String),
    /// The run was stopped.
    Stopped,
}

/// Waits while the program that has the claim is running and sends a request at least every `patience`.
fn wait_for_holder(
    store: &dyn CallStore,
    key: &CallKey,
    patience: Duration,
    stopped: impl Fn() -> bool,
) -> Result<WaitOutcome, LedgerError> {
    let (mut last_holder, mut last_change, mut pause) = (None, Instant::now(), FIRST_PAUSE);
    loop {
        if stopped() {
            return Ok(WaitOutcome::Stopped);
        }
        let Some(holder) = store.claim_holder(key)? else { return Ok(WaitOutcome::Released) };
        // Another holder, or one more request of the same holder.
        let has_changed = last_holder.as_ref() != Some(&holder);
        if has_changed {
            last_change = Instant::now();
        }
        if holder.is_gone || last_change.elapsed() >= patience {
            return Ok(WaitOutcome::Abandoned(holder.name));
        }
        last_holder = Some(holder);
        thread::sleep(pause);
        pause = MAX_PAUSE.min(pause * 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ModelCall, store::SqliteStore};

    fn key() -> CallKey {
        ModelCall { model: "t/m".into(), base_url: String::new(), request: "?".into(), replicate: 0 }.key()
    }

    #[test]
    fn take_claim_gives_up_waiting_for_a_program_that_hangs() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = [(), ()].map(|()| SqliteStore::open(&folder.path().join("l.db")).unwrap());
        let key = key();
        let taken = |store, patience| CallClaim::take_claim(store, &key, patience, || false).unwrap();
        let held = taken(&first, ABANDONED_CLAIM_TIMEOUT);
        assert!(matches!(held, ClaimOutcome::Ours(_)));
        let before = first.claim_holder(&key).unwrap().unwrap();
        let taken_over = taken(&second, Duration::from_millis(30));
        assert!(matches!(taken_over, ClaimOutcome::Ours(_)));
        drop(held);
        first.flush().unwrap();
        assert_ne!(second.claim_holder(&key).unwrap().unwrap().name, before.name, "it is not the first's");
        drop(taken_over);
        second.flush().unwrap();
        assert_eq!(second.claim_holder(&key).unwrap(), None);
    }
}
