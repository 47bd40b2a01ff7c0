//! The calls of a command to models: reached over HTTP, kept in the ledger, bounded by a budget.
//!
//! A build without the feature `remote` has the same functions, and says how to get one that can call.

#[cfg(not(feature = "remote"))]
mod absent;
#[cfg(all(feature = "remote", feature = "local"))]
mod local;
#[cfg(all(feature = "remote", not(feature = "local")))]
#[path = "no_local.rs"]
mod local;
#[cfg(feature = "remote")]
mod place;
#[cfg(feature = "remote")]
mod present;
mod price;
mod spent;

#[cfg(not(feature = "remote"))]
pub use absent::Calls;
#[cfg(feature = "remote")]
pub use place::ledger_path;
#[cfg(feature = "remote")]
pub use present::Calls;
pub use price::Price;
pub use spent::Spent;
