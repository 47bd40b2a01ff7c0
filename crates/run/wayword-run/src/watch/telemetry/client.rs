//! The HTTP client for a collector of OpenTelemetry: the same library that calls models, behind OpenTelemetry's trait.

use super::{exporter::FailureReporter, variables};
use async_trait::async_trait;
use opentelemetry_http::{Bytes, HttpClient, HttpError, Request, Response};
use std::{fs, sync::Arc};
use ureq::{
    Agent, Error,
    tls::{PemItem, RootCerts, TlsConfig, parse_pem},
};

/// Largest answer of a collector that is read, bytes; a larger one is an error. An answer is empty or a few words.
const MAX_ANSWER_BYTES: u64 = 1 << 16;

/// A blocking client; the exporter uses it on a thread of its own.
#[derive(Debug)]
pub(super) struct CollectorClient {
    agent: Agent,
    reporter: Arc<FailureReporter>,
}

impl CollectorClient {
    /// A client with the time limit and the certificates that the environment names.
    ///
    /// # Errors
    /// When the certificates of the environment cannot be read.
    pub(super) fn new(reporter: Arc<FailureReporter>) -> Result<Self, String> {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            // A redirect would send the headers, which may have a key, to another server.
            .max_redirects(0)
            .timeout_global(Some(variables::request_timeout()))
            .user_agent(concat!("wayword/", env!("CARGO_PKG_VERSION")))
            .tls_config(TlsConfig::builder().root_certs(trusted_roots()?).build());
        Ok(Self { agent: config.build().new_agent(), reporter })
    }
}

/// The certificate authorities to trust: those of the environment's file, or else the public ones.
fn trusted_roots() -> Result<RootCerts, String> {
    let Some(file) = variables::otlp_variable_text("CERTIFICATE") else { return Ok(RootCerts::WebPki) };
    let unread = |why: &str| format!("{file}, which OTEL_EXPORTER_OTLP_CERTIFICATE names, {why}");
    let pem = fs::read(&file).map_err(|error| unread(&format!("cannot be read: {error}")))?;
    let roots: Vec<_> = parse_pem(&pem)
        .filter_map(|item| match item {
            Ok(PemItem::Certificate(certificate)) => Some(certificate),
            _ => None,
        })
        .collect();
    if roots.is_empty() { Err(unread("holds no certificate")) } else { Ok(RootCerts::new_with_certs(&roots)) }
}

#[async_trait]
impl HttpClient for CollectorClient {
    async fn send_bytes(&self, request: Request<Bytes>) -> Result<Response<Bytes>, HttpError> {
        let (head, body) = request.into_parts();
        let sent = self.agent.run(Request::from_parts(head, &body[..]));
        let (head, mut body) = sent.map_err(|error| self.note_error(error))?.into_parts();
        let body = body.with_config().limit(MAX_ANSWER_BYTES).read_to_vec().map_err(|error| self.note_error(error))?;
        Ok(Response::from_parts(head, body.into()))
    }
}

impl CollectorClient {
    /// Keeps the reason of a failure, which the exporter does not pass on.
    fn note_error(&self, error: Error) -> HttpError {
        self.reporter.note_reason(error_words(&error));
        error.into()
    }
}

/// Why a request failed, in words of our own: the library's errors may quote the address, which may contain a password.
fn error_words(error: &Error) -> String {
    match error {
        Error::Io(error) => error.to_string(),
        Error::Timeout(_) => "it gave no answer in time".to_owned(),
        Error::HostNotFound => "its host is not known".to_owned(),
        Error::ConnectionFailed => "there is no connection to it".to_owned(),
        _ => "the request failed".to_owned(),
    }
}
