//! A model provider for tests and measurements: an HTTP server on this machine that speaks the dialects of the real ones on
//! one port and answers from scripts. It can fail in every way that real services fail. The test sets the share of each fault,
//! and the requests that get it are drawn from a seed.

pub mod barcode;
mod behaviour;
mod dialect;
mod faults;
mod gallery;
mod log;
mod misdeed;
mod pictured;
mod rate;
mod retry_after;
pub mod scripts;
mod server;
mod wire;

use std::{io, net::SocketAddr, time::Duration};
use tokio::runtime::Runtime;

pub use behaviour::{Behaviour, Heard, Script};
pub use dialect::Dialect;
pub use faults::{Fault, Faults};
pub use gallery::{Gallery, Scenery, Thing};
pub use log::{Body, Log};
pub use pictured::Pictured;
pub use rate::Rate;
pub use retry_after::RetryAfter;

/// Threads that serve. They are named `provider`, so that a measurement can leave out their work.
const THREADS: usize = 2;
/// The longest time that dropping a provider takes.
const FAREWELL: Duration = Duration::from_secs(2);

/// A running provider. It stops when it is dropped, and every connection to it breaks.
pub struct Provider {
    address: SocketAddr,
    shared: std::sync::Arc<server::Shared>,
    runtime: Option<Runtime>,
}

impl Provider {
    /// Starts a provider on a port of 127.0.0.1 that the system chooses.
    ///
    /// # Errors
    /// When the system gives no port or thread.
    pub fn start(behaviour: Behaviour) -> io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("provider")
            .enable_all()
            .build()?;
        let listener = runtime.block_on(tokio::net::TcpListener::bind("127.0.0.1:0"))?;
        let address = listener.local_addr()?;
        let shared = std::sync::Arc::new(server::Shared::new(behaviour));
        runtime.spawn(server::serve(listener, shared.clone()));
        Ok(Self { address, shared, runtime: Some(runtime) })
    }

    /// The base URL for clients of a dialect; it ends with the API's version where the dialect has one.
    #[must_use]
    pub fn base_url(&self, dialect: Dialect) -> String {
        format!("http://{}{}", self.address, dialect.base_path())
    }

    /// How many requests have come so far. Requests for the list of models or for a model's capabilities do not count.
    #[must_use]
    pub fn requests(&self) -> u64 {
        self.shared.tally().received
    }

    /// The counts so far. They grow by some 50 bytes for each distinct request.
    #[must_use]
    pub fn log(&self) -> Log {
        self.shared.tally().clone()
    }
}

impl Drop for Provider {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(FAREWELL);
        }
    }
}
