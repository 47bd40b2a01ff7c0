//! A handle that stops a run from outside, as from a signal handler.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// Stops a run. It does not keep the ledger open, so a signal handler may hold it until the end of the process.
#[derive(Debug, Clone, Default)]
pub struct RunStopper(Arc<AtomicBool>);

impl RunStopper {
    /// Does the same as [`crate::LedgerRun::stop`].
    pub fn stop(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// Whether the run was stopped.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}
