//! The site that participants see. The async runtime lives here alone.

mod cookies;
mod desk;
mod forms;
mod gate;
mod listen;
mod pages;
mod routes;
mod tls;
mod ways;

pub use listen::{Listen, Security, Started, serve};
