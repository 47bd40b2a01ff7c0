//! The ledger: makes each call of a model once and keeps the answer.
//!
//! A call's key covers everything that could change its answer. The ledger writes a request to disk before it is sent,
//! and an answer before it is returned. So a run that was killed pays twice at most for the requests that were in
//! flight, and the ledger knows how much that was. Several programs may use one ledger at once: one of them makes a
//! call, and the others wait for its answer.
//!
//! A ledger is kept in one of three stores, and behaves the same in all of them:
//! - a file on a disk of this machine ([`Ledger::open`]), which all runs share;
//! - recordings of the chunks of one shard ([`Ledger::in_chunks`]), on any file system, for one program at a time;
//! - a database of PostgreSQL (`Ledger::open_postgres`, with the feature `postgres`), for any number of machines. There, the
//!   limits of a run and the rates of providers hold for all programs together.
//!
//! Architecture invariant: this crate does not interpret calls, and its interface does not expose the database.
//!
//! # Where things are
//! - `call`: the fields that are kept of a call, and its key.
//! - `budget`: how much a run may spend.
//! - `claim`, and `presence.rs` of each store: how programs share calls, and notice that another one has ended.
//! - `rate`, `store/postgres/rates.rs`: how many requests all workers together send.
//! - `disk`: which file systems are network file systems.
//! - `store/mod.rs`: what a store does. `store/sqlite/schema.rs` and `store/postgres/tables.rs` have the tables, `store/chunks/line.rs` the lines of
//!   a recording.
//! - `span`: what a trace has of a call.

mod budget;
mod call;
mod call_context;
mod checksum;
mod claim;
mod disk;
mod error;
mod flight;
mod ledger;
mod location;
mod queries;
mod rate;
mod recording;
mod run;
mod span;
mod spending;
mod stopper;
mod store;

pub use budget::{RequestRefusedError, RunLimits};
pub use call::{CallAnswer, CallKey, LedgerEntry, ModelCall};
pub use call_context::{AccountTotals, CallAccount, CallContext};
pub use disk::network_at;
pub use error::LedgerError;
pub use ledger::Ledger;
pub use location::LedgerLocation;
pub use rate::ProviderRates;
pub use run::{CallAttempts, LedgerRun, OnceError, RunTotals};
pub use span::SPAN_TARGET;
pub use spending::{CostGrouping, CostLine, LedgerFilter, RunSpending};
pub use stopper::RunStopper;
#[cfg(feature = "postgres")]
pub use store::LEDGER_TABLES;
