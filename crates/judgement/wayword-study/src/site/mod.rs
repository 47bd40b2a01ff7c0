//! The web site that participants see. The async runtime is used in this folder alone.

mod cookies;
mod desk;
mod forms;
mod listen;
mod pages;
mod request_guard;
mod routes;
mod tls;
mod ways;

pub use listen::{ListenOptions, SiteAddress, SiteSecurity, preview_study, serve_study};
