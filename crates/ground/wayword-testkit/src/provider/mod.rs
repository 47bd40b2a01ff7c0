//! A model provider for tests and measurements: an HTTP server on this machine that speaks the dialects of the real ones on
//! one port and answers from scripts. It can fail in every way that real services fail. The test sets the share of each fault,
//! and the requests that get it are drawn from a seed.

pub mod barcode;
mod barcode_platform;
mod behaviour;
mod breakable_connection;
mod dialect;
mod fault_response;
mod faults;
mod gallery;
mod request_log;
mod request_rate;
mod retry_after;
pub mod scripts;
mod server;

use std::{io, net::SocketAddr, time::Duration};
use tokio::runtime::Runtime;

pub use barcode_platform::BarcodePlatform;
pub use behaviour::{ModelScript, ProviderBehaviour, ScriptRequest};
pub use dialect::ProviderDialect;
pub use faults::{FaultSchedule, ServiceFault};
pub use gallery::{GalleryThing, PictureGallery, PictureScenery};
pub use request_log::{ProviderLog, RequestCounts};
pub use request_rate::ProviderRequestRate;
pub use retry_after::RetryAfter;

/// Threads that serve. They are named `provider`, so that a measurement can leave out their work.
const SERVER_THREAD_COUNT: usize = 2;
/// The longest time that dropping a provider takes. Requests that are still being answered then are cut off.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(2);

/// A running provider. It stops when it is dropped, and every connection to it breaks.
pub struct ScriptedProvider {
    address: SocketAddr,
    /// The state that it shares with its connections.
    shared: std::sync::Arc<server::ProviderState>,
    /// Runs the server; `None` only while the provider is being dropped.
    runtime: Option<Runtime>,
}

impl ScriptedProvider {
    /// Starts a provider on a port of 127.0.0.1 that the system chooses.
    ///
    /// # Errors
    /// When the system gives no port or thread.
    pub fn start(behaviour: ProviderBehaviour) -> io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(SERVER_THREAD_COUNT)
            .thread_name("provider")
            .enable_all()
            .build()?;
        let listener = runtime.block_on(tokio::net::TcpListener::bind("127.0.0.1:0"))?;
        let address = listener.local_addr()?;
        let shared = std::sync::Arc::new(server::ProviderState::new(behaviour));
        runtime.spawn(server::serve_connections(listener, shared.clone()));
        Ok(Self { address, shared, runtime: Some(runtime) })
    }

    /// The base URL for clients of a dialect; it ends with the API's version where the dialect has one.
    #[must_use]
    pub fn base_url(&self, dialect: ProviderDialect) -> String {
        format!("http://{}{}", self.address, dialect.base_path())
    }

    /// How many requests have come so far. Requests for the list of models or for a model's capabilities do not count.
    #[must_use]
    pub fn request_count(&self) -> u64 {
        self.shared.lock_log().received
    }

    /// The counts so far. They grow by some 50 bytes for each distinct request.
    #[must_use]
    pub fn log(&self) -> ProviderLog {
        self.shared.lock_log().clone()
    }
}

impl Drop for ScriptedProvider {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(SHUTDOWN_TIMEOUT);
        }
    }
}
