//! Every call of a model, made once and kept.
//!
//! One file for all runs. A call is known by everything that could change its answer; an answer is on disk before anybody hears
//! it; a request is on disk before it leaves. So a run that was killed pays twice at most for what was on the wire, and knows how
//! much that was. Several programs may use one file at once: each call is made by one of them, and the others wait for its answer.
//!
//! Architecture invariant: nothing here knows what a call means, and nothing of the database shows outside.

mod budget;
mod call;
mod checksum;
mod claim;
mod disk;
mod error;
mod flight;
mod ledger;
mod queries;
mod run;
mod stopper;
mod store;

pub use budget::{Limits, Refused};
pub use call::{Answer, Call, Key, Row};
pub use disk::network_at;
pub use error::LedgerError;
pub use ledger::Ledger;
pub use queries::{By, CostLine, Filter};
pub use run::{Attempts, OnceError, Run, Totals};
pub use stopper::Stopper;
