//! Lets one of all programs that have the ledger open make a call, while the others wait for its answer. [`crate::flight`] does this
//! for threads of one program.

use crate::{
    Key, LedgerError,
    store::{Claimed, Store},
};
use std::{
    thread,
    time::{Duration, Instant},
};

/// Shortest and longest pause between two checks whether another program is done. Each pause is twice as long as the one before.
const FIRST_PAUSE: Duration = Duration::from_millis(10);
const LAST_PAUSE: Duration = Duration::from_millis(250);

/// How long to wait for a program that has claimed a call and neither sends another request for it nor releases it, because it is
/// suspended or hangs. The timeouts of all requests are shorter.
pub(crate) const PATIENCE: Duration = Duration::from_secs(3600);

/// The right to make a call. Other programs wait until it is dropped or the call is answered.
pub(crate) struct Claim<'a> {
    store: &'a dyn Store,
    key: &'a Key,
    is_held: bool,
}

/// The result of [`Claim::take`].
pub(crate) enum Taken<'a> {
    /// This program has the claim.
    Ours(Claim<'a>),
    /// Another program has made the call meanwhile.
    Answered,
    /// The run was stopped during the wait.
    Stopped,
}

impl<'a> Claim<'a> {
    /// Takes the right to make a call. If another program has it, waits until that program is done, has ended, or has sent no request for
    /// as long as `patience`.
    ///
    /// # Errors
    /// When the ledger cannot be used.
    pub(crate) fn take(
        store: &'a dyn Store,
        key: &'a Key,
        patience: Duration,
        stopped: impl Fn() -> bool,
    ) -> Result<Taken<'a>, LedgerError> {
        let mut from: Option<String> = None;
        loop {
            match store.claim(key, from.as_deref())? {
                Claimed::Ours => return Ok(Taken::Ours(Self { store, key, is_held: true })),
                Claimed::Answered => return Ok(Taken::Answered),
                Claimed::Others => {}
            }
            from = match wait(store, key, patience, &stopped)? {
                Waited::Released => None,
                Waited::Abandoned(by) => Some(by),
                Waited::Stopped => return Ok(Taken::Stopped),
            };
        }
    }

    /// Marks the call as answered: the ledger released the claim when it stored the answer.
    pub(crate) fn fulfilled(&mut self) {
        self.is_held = false;
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        if self.is_held {
            self.store.release(self.key);
        }
    }
}

/// How a wait for another program has ended.
enum Waited {
    /// The program has released the claim, with an answer or without.
    Released,
    /// The program of this name has ended, or has sent no request for too long.
    Abandoned(String),
    Stopped,
}

fn wait(store: &dyn Store, key: &Key, patience: Duration, stopped: impl Fn() -> bool) -> Result<Waited, LedgerError> {
    let (mut seen, mut since, mut pause) = (None, Instant::now(), FIRST_PAUSE);
    loop {
        if stopped() {
            return Ok(Waited::Stopped);
        }
        let Some(holder) = store.holder(key)? else { return Ok(Waited::Released) };
        let sends = seen.as_ref() != Some(&holder);
        if sends {
            since = Instant::now();
        }
        if holder.is_gone || since.elapsed() >= patience {
            return Ok(Waited::Abandoned(holder.name));
        }
        seen = Some(holder);
        thread::sleep(pause);
        pause = LAST_PAUSE.min(pause * 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Call, store::Sqlite};

    fn key() -> Key {
        Call { model: "t/m".into(), base_url: String::new(), request: "?".into(), replicate: 0 }.key()
    }

    #[test]
    fn take_claim_gives_up_waiting_for_a_program_that_hangs() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = [(), ()].map(|()| Sqlite::open(&folder.path().join("l.db")).unwrap());
        let key = key();
        let taken = |store, patience| Claim::take(store, &key, patience, || false).unwrap();
        let held = taken(&first, PATIENCE);
        assert!(matches!(held, Taken::Ours(_)));
        let before = first.holder(&key).unwrap().unwrap();
        let taken_over = taken(&second, Duration::from_millis(30));
        assert!(matches!(taken_over, Taken::Ours(_)));
        drop(held);
        first.flush().unwrap();
        assert_ne!(second.holder(&key).unwrap().unwrap().name, before.name, "it is not the first's");
        drop(taken_over);
        second.flush().unwrap();
        assert_eq!(second.holder(&key).unwrap(), None);
    }
}
