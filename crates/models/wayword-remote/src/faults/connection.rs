//! Classifies the faults of connections: no server, no secure connection, or one that breaks.

use super::{FaultContext, RemoteFault, RetryFault, ServiceLoad};
use crate::transport::{CERTIFICATES_VARIABLE, MAX_BODY_BYTES};
use std::io::ErrorKind;
use ureq::Timeout;

/// The advice where a server ends each connection before it is secure.
const NO_HTTPS: &str = "; if the service speaks no HTTPS, let its base URL begin with http://";

/// The fault of a request without a complete response. `answered` is the status, if one came.
pub(crate) fn fault_from_transport(
    error: &ureq::Error,
    answered: Option<u16>,
    url: &str,
    context: FaultContext<'_>,
) -> RemoteFault {
    use ureq::Error as E;
    let refused = |error: &std::io::Error| error.kind() == ErrorKind::ConnectionRefused;
    let retry =
        |reason: String, load, maybe_paid| RemoteFault::Retry(RetryFault { reason, after: None, load, maybe_paid });
    // What every attempt meets again.
    let words = error.to_string();
    if let Some((problem, hint)) = certificate_problem(&words, context) {
        return RemoteFault::Stop { reason: format!("no secure connection to {url}: {problem}"), hint };
    }
    match error {
        E::Io(error) if refused(error) => retry(format!("nothing answers at {url}"), ServiceLoad::Unknown, false),
        E::Io(_) if words.contains("failed to lookup address") => {
            retry(format!("the host of {url} is not found"), ServiceLoad::Unknown, false)
        }
        E::HostNotFound => retry(format!("the host of {url} is not found"), ServiceLoad::Unknown, false),
        E::Timeout(Timeout::Connect | Timeout::Resolve) => {
            retry(format!("no connection to {url} within 10 seconds"), ServiceLoad::Slow, false)
        }
        E::Timeout(_) => {
            retry("no complete answer in time; give it more time with --timeout-s".to_owned(), ServiceLoad::Slow, true)
        }
        E::BodyExceedsLimit(_) => RemoteFault::Final {
            reason: format!("the answer is longer than {} MiB", MAX_BODY_BYTES >> 20),
            hint: None,
            is_refusal: false,
            maybe_paid: true,
        },
        E::Io(_) | E::Protocol(_) | E::ConnectionFailed | E::BodyStalled => {
            let where_ = if answered.is_some() { "in mid-answer" } else { "before an answer" };
            // A server of HTTPS ends a connection without encryption at once, and a server without HTTPS one with it.
            let is_first = answered.is_none() && !context.has_answered;
            let scheme = match is_first {
                true if url.starts_with("http://") => {
                    "; if the service speaks HTTPS, let its base URL begin with https://"
                }
                true if ends_in_handshake(error) => NO_HTTPS,
                _ => "",
            };
            let reason = format!("the connection broke {where_}: {}{scheme}", context.safe_text(&words));
            retry(reason, ServiceLoad::Unknown, true)
        }
        E::LargeResponseHeader(..) => {
            retry("the answer's headers are too large".to_owned(), ServiceLoad::Unknown, true)
        }
        E::ConnectProxyFailed(_) | E::InvalidProxyUrl => retry(
            format!(
                "the proxy makes no connection to {url}: {}; check HTTPS_PROXY and NO_PROXY",
                context.safe_text(&words)
            ),
            ServiceLoad::Unknown,
            false,
        ),
        E::Rustls(_) | E::Tls(_) | E::Pem(_) | E::TlsRequired => {
            retry(format!("no secure connection to {url}: {}", context.safe_text(&words)), ServiceLoad::Unknown, false)
        }
        // All other errors: the request could not be made. The error's text is left out, because it could contain the
        // request.
        _ => RemoteFault::Final {
            reason: "the request could not be made".to_owned(),
            hint: None,
            is_refusal: false,
            maybe_paid: false,
        },
    }
}

/// Whether a server ended the connection before it was secure. After that, the end has other words.
pub(crate) fn ends_in_handshake(error: &ureq::Error) -> bool {
    matches!(error, ureq::Error::Io(error) if error.kind() == ErrorKind::UnexpectedEof && error.to_string() == "unexpected end of file")
}

/// Why a certificate or the scheme of an address can't be right, and what to do; `None` for other errors. By the words of the TLS
/// library; the HTTP library does not give its types.
fn certificate_problem(words: &str, context: FaultContext<'_>) -> Option<(String, String)> {
    let says = |phrase: &str| words.contains(phrase);
    if says("InvalidContentType") {
        let hint = format!(
            "let base_url under [providers.{}], or --base-url, begin with http:// if the service is on your own network, or name its HTTPS port",
            context.provider
        );
        return Some(("the server does not speak HTTPS there".to_owned(), hint));
    }
    if says("ProtocolVersion") || says("peer is incompatible") {
        let hint = "the server has to offer TLS 1.2 or newer".to_owned();
        return Some(("the server speaks an old form of TLS".to_owned(), hint));
    }
    let (_, about) = words.split_once("invalid peer certificate: ")?;
    let own_authority = format!(
        "if you trust it, name a PEM file with the certificate of the authority that signed it in {CERTIFICATES_VARIABLE}"
    );
    let details = format!(" ({})", context.safe_text(about));
    let (problem, details, hint) = if about.contains("UnknownIssuer") || about.contains("BadSignature") {
        (
            "no authority that is trusted signed its certificate, as where it signed itself or a proxy reads along",
            String::new(),
            own_authority,
        )
    } else if about.contains("CaUsedAsEndEntity") || about.contains("UnsupportedCertVersion") {
        (
            "its certificate is that of an authority, and not that of a server",
            String::new(),
            "make a certificate of version 3 for the server (CA:FALSE, with its name under subjectAltName)".to_owned(),
        )
    } else if about.contains("not valid yet") || about.contains("NotValidYet") {
        ("its certificate is not valid yet", String::new(), "check this machine's clock".to_owned())
    } else if about.to_ascii_lowercase().contains("expired") {
        let hint = "the service has to renew it; if it is new, check this machine's clock".to_owned();
        ("its certificate has expired", String::new(), hint)
    } else if about.contains("not valid for name") || about.contains("NotValidForName") {
        let hint = "use the name that the certificate has in the base URL, and no number or other name of the machine";
        ("its certificate is for another name", details, hint.to_owned())
    } else {
        ("its certificate is not valid", details, own_authority)
    };
    Some((format!("{problem}{details}"), hint))
}
