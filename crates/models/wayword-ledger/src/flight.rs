//! Keeps two threads from making the same call at the same time.

use crate::Key;
use std::{
    collections::BTreeMap,
    sync::{Arc, Condvar, Mutex, PoisonError},
};

/// The calls that are being made.
#[derive(Debug, Default)]
pub(crate) struct Flights {
    open: Mutex<BTreeMap<Key, Arc<Landed>>>,
}

#[derive(Debug, Default)]
struct Landed {
    done: Mutex<bool>,
    signal: Condvar,
}

/// The right to make a call. Other threads wait until it is dropped.
pub(crate) struct Flight<'a> {
    flights: &'a Flights,
    key: Key,
}

impl Flights {
    /// The right to make a call, or `None` after waiting for another thread that made it.
    pub(crate) fn take_off(&self, key: &Key) -> Option<Flight<'_>> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(other) = open.get(key).map(Arc::clone) else {
            open.insert(key.clone(), Arc::default());
            return Some(Flight { flights: self, key: key.clone() });
        };
        drop(open);
        let done = other.done.lock().unwrap_or_else(PoisonError::into_inner);
        drop(other.signal.wait_while(done, |done| !*done).unwrap_or_else(PoisonError::into_inner));
        None
    }

    /// Does something while no call is made and none can begin; `None` if one is being made.
    pub(crate) fn while_none<T>(&self, act: impl FnOnce() -> T) -> Option<T> {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.is_empty().then(act)
    }
}

impl Drop for Flight<'_> {
    fn drop(&mut self) {
        let landed = self.flights.open.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.key);
        if let Some(landed) = landed {
            *landed.done.lock().unwrap_or_else(PoisonError::into_inner) = true;
            landed.signal.notify_all();
        }
    }
}
