//! Keeps two threads of this program from making the same call at the same time: the first one makes it, and the others wait.

use crate::CallKey;
use std::{
    collections::BTreeMap,
    sync::{Arc, Condvar, Mutex, PoisonError},
};

/// The calls that threads are making at the moment.
#[derive(Debug, Default)]
pub(crate) struct CallFlights {
    /// By the key of each call: the signal for the threads that wait for it.
    open: Mutex<BTreeMap<CallKey, Arc<FlightSignal>>>,
}

/// Wakes the threads that wait for a call.
#[derive(Debug, Default)]
struct FlightSignal {
    /// Whether the call has ended, with an answer or without.
    done: Mutex<bool>,
    signal: Condvar,
}

/// The right to make a call. Other threads wait until it is dropped.
pub(crate) struct CallFlight<'a> {
    flights: &'a CallFlights,
    key: CallKey,
}

impl CallFlights {
    /// Takes the right to make a call. If another thread has it, waits for that thread and returns `None`.
    pub(crate) fn take_off(&self, key: &CallKey) -> Option<CallFlight<'_>> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(other) = open.get(key).map(Arc::clone) else {
            open.insert(key.clone(), Arc::default());
            return Some(CallFlight { flights: self, key: key.clone() });
        };
        drop(open);
        let done = other.done.lock().unwrap_or_else(PoisonError::into_inner);
        drop(other.signal.wait_while(done, |done| !*done).unwrap_or_else(PoisonError::into_inner));
        None
    }

    /// Runs `act` while no call is in flight, and keeps new ones from beginning meanwhile. Returns `None` if a call is in flight.
    pub(crate) fn run_while_idle<T>(&self, act: impl FnOnce() -> T) -> Option<T> {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.is_empty().then(act)
    }
}

impl Drop for CallFlight<'_> {
    fn drop(&mut self) {
        let landed = self.flights.open.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.key);
        if let Some(landed) = landed {
            *landed.done.lock().unwrap_or_else(PoisonError::into_inner) = true;
            landed.signal.notify_all();
        }
    }
}
