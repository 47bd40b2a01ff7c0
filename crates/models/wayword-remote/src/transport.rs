//! Sends HTTP requests. The size of responses and the time for them are limited, and redirects are not followed.

use crate::base_url::BaseUrl;
use std::time::Duration;
use ureq::{
    Agent, Proxy,
    config::Config,
    http::{HeaderMap, Response},
};

/// Largest body that is read, bytes; a larger one is an error. A reply of text has about a thousandth of this.
pub(crate) const MAX_BODY_BYTES: u64 = 8 << 20;

/// Longest wait for a connection, after which the request fails.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// One provider's connections.
#[derive(Debug)]
pub(crate) struct HttpTransport(Agent);

/// A response, perhaps cut off in its body.
#[derive(Debug)]
pub(crate) struct HttpResponse {
    pub(crate) status: u16,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Result<Vec<u8>, ureq::Error>,
}

impl HttpTransport {
    /// Keeps up to `connections` connections open. `timeout` is for each request, from looking up the host to the last
    /// byte.
    pub(crate) fn new(base_url: &BaseUrl, connections: usize, timeout: Duration) -> Self {
        let config = Config::builder()
            .http_status_as_error(false)
            // A redirect would send the key to another server.
            .max_redirects(0)
            .timeout_connect(Some(CONNECT_TIMEOUT))
            .timeout_global(Some(timeout))
            .max_idle_connections(connections)
            .max_idle_connections_per_host(connections)
            .user_agent(concat!("wayword/", env!("CARGO_PKG_VERSION")))
            // A proxy cannot reach this machine's own servers.
            .proxy(if base_url.loopback { None } else { Proxy::try_from_env() })
            .build();
        Self(Agent::new_with_config(config))
    }

    /// Sends JSON.
    ///
    /// # Errors
    /// When no status came back.
    pub(crate) fn post(&self, url: &str, headers: &[(&str, String)], body: &[u8]) -> Result<HttpResponse, ureq::Error> {
        let request = self.0.post(url).header("content-type", "application/json");
        headers
            .iter()
            .fold(request, |request, (name, value)| request.header(*name, value))
            .send(body)
            .map(read_response)
    }

    /// Asks for JSON.
    ///
    /// # Errors
    /// When no status came back.
    pub(crate) fn get(&self, url: &str, headers: &[(&str, String)]) -> Result<HttpResponse, ureq::Error> {
        headers
            .iter()
            .fold(self.0.get(url), |request, (name, value)| request.header(*name, value))
            .call()
            .map(read_response)
    }
}

/// Reads status, headers and body. An error in the body leaves status and headers readable.
fn read_response(response: Response<ureq::Body>) -> HttpResponse {
    let (head, mut body) = response.into_parts();
    let body = body.with_config().limit(MAX_BODY_BYTES).read_to_vec();
    HttpResponse { status: head.status.as_u16(), headers: head.headers, body }
}
