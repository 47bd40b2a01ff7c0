//! Translates errors of the crate `object_store` into [`CloudError`].
//!
//! The crate distinguishes only a few kinds of error. A wrong key, a missing bucket and an overloaded server can all arrive
//! as a generic error with the server's answer in its text. So this file searches the text for known codes. It never passes
//! the text on, because a server's answer can repeat signatures and keys.

use super::CloudError;
use object_store::client::{HttpError, HttpErrorKind};
use std::{error::Error, io};

/// The hint for errors with no known cause.
const STORE_LOG_HINT: &str = "see what the store's own log says, and check the address";

/// Codes of answers to invalid credentials. They come with 400, 401 or 403.
const BAD_CREDENTIALS_CODES: [&str; 9] = [
    "InvalidAccessKeyId",
    "SignatureDoesNotMatch",
    "ExpiredToken",
    "InvalidToken",
    "TokenRefreshRequired",
    "AuthenticationFailed",
    "InvalidAuthenticationInfo",
    "NoAuthenticationInformation",
    "AuthorizationHeaderMalformed",
];

/// Codes of answers about a missing bucket.
const NO_BUCKET_CODES: [&str; 4] =
    ["NoSuchBucket", "ContainerNotFound", "ContainerBeingDeleted", "The specified bucket does not exist"];

/// Texts of object_store when it finds no credentials. They are compared and never shown.
const NO_CREDENTIALS_TEXTS: [&str; 7] = [
    "instance metadata",
    "169.254.169.254",
    "metadata.google.internal",
    "getting credentials",
    "Account must be specified",
    "MissingAccount",
    "application_default_credentials",
];

/// The error for callers, without the texts of servers. `at` is the address of the object, and `doing` the operation on it.
pub(super) fn from_store_error(at: &str, doing: &'static str, error: &object_store::Error) -> CloudError {
    use object_store::Error as E;
    // Every level has its own text; the variables of a level may be only in its debugging text.
    let text = format!("{error} {error:?}");
    let has = |codes: &[&str]| codes.iter().any(|code| text.contains(code));
    let at = at.to_owned();
    let answer = answer_code(&text);
    if has(&NO_BUCKET_CODES) {
        return CloudError::NoBucket { bucket: at };
    }
    if has(&BAD_CREDENTIALS_CODES) || has(&NO_CREDENTIALS_TEXTS) || matches!(error, E::Unauthenticated { .. }) {
        return CloudError::Credentials { at, answer };
    }
    if matches!(error, E::NotFound { .. }) {
        return CloudError::Refused { at, doing, answer: "it is not there".to_owned(), hint: STORE_LOG_HINT };
    }
    if matches!(error, E::PermissionDenied { .. }) || system_error_kind(error) == Some(io::ErrorKind::PermissionDenied)
    {
        return CloudError::Permission { at, doing, answer };
    }
    if text.contains("BadScheme") {
        let hint = "give an https:// endpoint, or allow it with the provider's variable, such as AWS_ALLOW_HTTP=true";
        return CloudError::Refused { at, doing, answer: "the endpoint has no TLS".to_owned(), hint };
    }
    if text.contains("invalid peer certificate") || text.contains("InvalidCertificate") {
        let hint = "check the endpoint; where an authority of your own signs, name the file of its certificate in SSL_CERT_FILE";
        return CloudError::Refused { at, doing, answer: "the store's certificate is not valid here".to_owned(), hint };
    }
    if let Some(problem) = network_problem(error).or_else(|| overload_problem(&text)) {
        return CloudError::Network { at, doing, problem: problem.to_owned() };
    }
    if text.contains("incorrectly configured region") || text.contains("PermanentRedirect") {
        let hint = "set AWS_REGION to the region of the bucket";
        return CloudError::Refused { at, doing, answer: "the bucket is in another region".to_owned(), hint };
    }
    CloudError::Refused { at, doing, answer, hint: STORE_LOG_HINT }
}

/// The error of a store that could not be opened. Opening sends no request, so a setting is wrong.
pub(super) fn from_settings_error(at: &str, error: &object_store::Error) -> CloudError {
    let text = format!("{error} {error:?}");
    if NO_CREDENTIALS_TEXTS.iter().any(|known| text.contains(known)) {
        return CloudError::Credentials { at: at.to_owned(), answer: "none are set".to_owned() };
    }
    let (problem, hint) = if text.contains("CA certificates") {
        let hint =
            "install the system's certificates (package ca-certificates), or name a file of them in SSL_CERT_FILE";
        ("this machine has no certificates of authorities", hint)
    } else {
        let hint = "check AWS_*, AZURE_* and GOOGLE_*: a flag is true or false, a key of Azure is base64, and the file of a service account must be there";
        ("a variable of the provider has a value that cannot be used", hint)
    };
    CloudError::Refused { at: at.to_owned(), doing: "open it", answer: problem.to_owned(), hint }
}

/// Whether the store reports that it has no conditional writes.
pub(super) fn is_not_implemented(error: &object_store::Error) -> bool {
    use object_store::Error as E;
    matches!(error, E::NotImplemented { .. } | E::NotSupported { .. }) || {
        let text = error.to_string();
        text.contains("<Code>NotImplemented</Code>") || status_code(&text) == Some("501")
    }
}

/// Whether another write of the same object was under way, and no writer has won yet.
pub(super) fn is_conflict(error: &object_store::Error) -> bool {
    let text = error.to_string();
    ["ConditionalRequestConflict", "OperationAborted"].iter().any(|code| text.contains(code))
}

/// Whether the bucket does not exist. For a bucket that is being removed, Azure sends the status of an existing object, so the
/// code is read instead.
pub(super) fn is_no_bucket(error: &object_store::Error) -> bool {
    let text = error.to_string();
    NO_BUCKET_CODES.iter().any(|code| text.contains(code))
}

/// An error, its cause, the cause's cause and so on.
fn error_chain<'a>(error: &'a (dyn Error + 'static)) -> impl Iterator<Item = &'a (dyn Error + 'static)> {
    // No error has 32 levels; an error that is its own cause must not hang the program.
    std::iter::successors(Some(error), |level: &&'a (dyn Error + 'static)| (*level).source()).take(32)
}

/// The kind of the operating system's error that caused an error, if one did.
fn system_error_kind(error: &object_store::Error) -> Option<io::ErrorKind> {
    error_chain(error).find_map(|level| Some(level.downcast_ref::<io::Error>()?.kind()))
}

/// The problem with the network that caused an error, if one did.
fn network_problem(error: &object_store::Error) -> Option<&'static str> {
    let kind = error_chain(error).find_map(|level| Some(level.downcast_ref::<HttpError>()?.kind()))?;
    Some(match kind {
        HttpErrorKind::Connect => "no connection",
        HttpErrorKind::Timeout => "no answer in time",
        HttpErrorKind::Interrupted | HttpErrorKind::Request => "the connection broke",
        HttpErrorKind::Decode => "the answer cannot be read",
        _ => "the request failed",
    })
}

/// The problem of a server that an answer's status reports, if it does.
fn overload_problem(text: &str) -> Option<&'static str> {
    match status_code(text)? {
        "429" | "503" => Some("the store is overloaded"),
        "500" | "502" | "504" => Some("the store has a failure"),
        _ => None,
    }
}

/// The three digits of an answer's HTTP status in the text of an error.
fn status_code(text: &str) -> Option<&str> {
    let digits = text.split_once("status code: ")?.1.get(..3)?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then_some(digits)
}

/// The status and the code of an answer. Both have a form that cannot contain a secret: three digits, and a word of letters.
fn answer_code(text: &str) -> String {
    let code = text
        .split_once("<Code>")
        .and_then(|(_, rest)| rest.split_once("</Code>"))
        .map(|(code, _)| code)
        .filter(|code| (1..=40).contains(&code.len()) && code.bytes().all(|byte| byte.is_ascii_alphabetic()));
    match (status_code(text), code) {
        (Some(status), Some(code)) => format!("answer {status} {code}"),
        (Some(status), None) => format!("answer {status}"),
        (None, Some(code)) => format!("answer {code}"),
        (None, None) => "no further answer".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{CloudError, from_store_error};
    use object_store::Error;

    fn generic(text: &str) -> Error {
        Error::Generic { store: "S3", source: text.to_owned().into() }
    }

    #[test]
    fn an_answer_is_known_by_its_code_and_never_repeated() {
        let body = "status code: 403 Forbidden: <Error><Code>SignatureDoesNotMatch</Code><AWSAccessKeyId>AKIASECRET</AWSAccessKeyId>";
        let error = from_store_error("s3://b/a", "write it", &generic(body));
        assert!(matches!(error, CloudError::Credentials { .. }));
        let text = format!("{error} {error:?}");
        assert!(!text.contains("AKIASECRET") && text.contains("answer 403 SignatureDoesNotMatch"), "{text}");
    }

    #[test]
    fn a_missing_bucket_is_distinguished_from_a_missing_object() {
        let source = || "status code: 404: <Code>NoSuchBucket</Code>".into();
        let error = from_store_error("s3://b/a", "read it", &Error::NotFound { path: "a".into(), source: source() });
        assert!(matches!(error, CloudError::NoBucket { .. }));
    }

    #[test]
    fn an_overloaded_store_may_work_later() {
        assert!(from_store_error("s3://b/a", "write it", &generic("status code: 503 Slow Down")).is_lost());
        assert!(!from_store_error("s3://b/a", "write it", &generic("status code: 400 Bad")).is_lost());
    }

    #[test]
    fn a_code_that_could_hide_a_key_is_left_out() {
        let error = from_store_error("s3://b/a", "write it", &generic("status code: 400: <Code>key=AKIA12345</Code>"));
        assert!(!error.to_string().contains("AKIA"), "{error}");
    }
}
