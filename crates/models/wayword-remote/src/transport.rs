//! Sends HTTP requests. The size of responses and the time for them are limited, and redirects are not followed.

use crate::base_url::BaseUrl;
use std::{fs, time::Duration};
use ureq::{
    Agent, Proxy,
    config::Config,
    http::{HeaderMap, Response},
    tls::{PemItem, RootCerts, TlsConfig, parse_pem},
};

/// Largest body that is read, bytes; a larger one is an error. A reply of text has about a thousandth of this.
pub(crate) const MAX_BODY_BYTES: u64 = 8 << 20;

/// Longest wait for a connection, after which the request fails.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest time for a secure connection that is only tried out.
const TRIAL_TIMEOUT: Duration = Duration::from_secs(5);

/// The environment variable with the file of certificates to trust in place of the public ones.
pub(crate) const CERTIFICATES_VARIABLE: &str = "SSL_CERT_FILE";

/// Largest file of certificates that is read, bytes. The public ones take 0.3 MB.
const MAX_CERTIFICATE_BYTES: u64 = 16 << 20;

/// The authorities that are trusted: those of the file in `SSL_CERT_FILE`, or else the public ones.
///
/// # Errors
/// When the file cannot be read, or has no certificate.
pub(crate) fn trusted_roots() -> Result<RootCerts, &'static str> {
    let Some(file) = std::env::var_os(CERTIFICATES_VARIABLE).filter(|file| !file.is_empty()) else {
        return Ok(RootCerts::WebPki);
    };
    let size = fs::metadata(&file).map_err(|_| "names a file that is not there")?.len();
    if size > MAX_CERTIFICATE_BYTES {
        return Err("names a file that is too long for one of certificates");
    }
    let pem = fs::read(&file).map_err(|_| "names a file that cannot be read")?;
    roots_from_pem(&pem)
}

/// The certificates of a PEM file.
fn roots_from_pem(pem: &[u8]) -> Result<RootCerts, &'static str> {
    let roots: Vec<_> = parse_pem(pem)
        .filter_map(|item| match item {
            Ok(PemItem::Certificate(certificate)) => Some(certificate),
            _ => None,
        })
        .collect();
    if roots.is_empty() {
        Err("names a file without a certificate in PEM form")
    } else {
        Ok(RootCerts::new_with_certs(&roots))
    }
}

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
    pub(crate) fn new(base_url: &BaseUrl, connections: usize, timeout: Duration, roots: RootCerts) -> Self {
        let config = Config::builder()
            .http_status_as_error(false)
            // A redirect would send the key to another server.
            .max_redirects(0)
            .timeout_connect(Some(CONNECT_TIMEOUT))
            .timeout_global(Some(timeout))
            .max_idle_connections(connections)
            .max_idle_connections_per_host(connections)
            .user_agent(concat!("wayword/", env!("CARGO_PKG_VERSION")))
            // Compressed answers are not read.
            .accept_encoding("identity")
            .tls_config(TlsConfig::builder().root_certs(roots).build())
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

    /// Asks for a page, to see whether there is a connection.
    ///
    /// # Errors
    /// When no status came back in a short time.
    pub(crate) fn try_page(&self, url: &str) -> Result<HttpResponse, ureq::Error> {
        let request = self.0.get(url).config().timeout_global(Some(TRIAL_TIMEOUT)).build();
        request.call().map(read_response)
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
