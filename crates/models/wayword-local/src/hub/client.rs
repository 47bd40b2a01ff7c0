//! Sends requests to the hub, and follows its redirects.
//!
//! For a large file the hub answers with a redirect to a storage server. Commit, hash and size are in the headers of
//! the hub's redirects, and not in the storage server's answer, so they are collected along the way.

use super::{
    HubConfig,
    cache::{BlobHash, CommitHash},
    config::HubToken,
    name::HubModelName,
    request_failure::{CHECK_WHO_ANSWERS_HINT, RequestFailure, RetryPatience, TRY_LATER, header_text, is_absence},
};
use crate::LocalError;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use std::{io::Read, net::IpAddr, time::Duration};
use ureq::{
    Agent, Body, Proxy,
    config::Config,
    http::{HeaderMap, Response, Uri},
};

/// The most redirects of one request. More are an error.
const MAX_REDIRECTS: usize = 10;

/// Longest wait for a connection, after which the request fails.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest silence of a server, after which the request fails. There is no limit on a whole download, because a model
/// may be large.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(60);

/// The characters that are percent-encoded in one segment of a path: all except those that any address may contain.
const SEGMENT_ESCAPES: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// The hub's connections.
#[derive(Debug)]
pub(super) struct HubClient {
    agent: Agent,
    endpoint: WebAddress,
    token: Option<HubToken>,
    first_wait: Duration,
}

/// The hub's answer about a file.
#[derive(Debug)]
pub(super) enum HubFileAnswer {
    /// The model has the file.
    There(HubFileFacts),
    /// The model lacks the file at this commit, if the hub names a commit.
    Absent(Option<CommitHash>),
}

/// The facts about a file before it is fetched.
#[derive(Debug)]
pub(super) struct HubFileFacts {
    pub(super) commit: CommitHash,
    /// The hash that the file must have.
    pub(super) hash: BlobHash,
    /// The length of the file, bytes.
    pub(super) size: Option<u64>,
}

/// The facts that the answers along a chain of redirects have given so far.
#[derive(Default)]
struct RedirectFacts {
    commit: Option<CommitHash>,
    /// The etag and the size of the file that a redirect leads to.
    linked: Option<(String, Option<u64>)>,
}

/// The method of a request.
#[derive(Clone, Copy)]
enum HubMethod {
    /// Only the headers.
    Head,
    /// The bytes from position `from` on.
    Get { from: u64 },
}

impl HubClient {
    pub(super) fn new(config: &HubConfig) -> Result<Self, LocalError> {
        let endpoint = WebAddress::parse_endpoint(&config.endpoint).map_err(|problem| {
            LocalError::download_failed("HF_ENDPOINT", problem, "write it like https://huggingface.co")
        })?;
        let settings = Config::builder()
            .http_status_as_error(false)
            // Redirects are followed here, because the token must not go to another server, and a redirect's headers
            // are needed.
            .max_redirects(0)
            .timeout_connect(Some(CONNECT_TIMEOUT))
            .timeout_recv_response(Some(SILENCE_TIMEOUT))
            .timeout_per_read(Some(SILENCE_TIMEOUT))
            .user_agent(concat!("wayword/", env!("CARGO_PKG_VERSION")))
            // No compression, because the hash is that of the uncompressed file.
            .accept_encoding("identity")
            // A proxy cannot reach a server on this machine.
            .proxy(if endpoint.is_loopback() { None } else { Proxy::try_from_env() })
            .build();
        // The token is not sent over plain http, except to this machine.
        let token = config.token.clone().filter(|_| !endpoint.is_plain() || endpoint.is_loopback());
        Ok(Self { agent: Agent::new_with_config(settings), endpoint, token, first_wait: config.first_wait })
    }

    pub(super) fn new_patience(&self) -> RetryPatience {
        RetryPatience::new(self.first_wait)
    }

    /// The address of a file at a revision.
    pub(super) fn file_address(&self, model: &HubModelName, revision: &str, file: &str) -> String {
        self.endpoint.file_address(model, revision, file)
    }

    /// Asks the hub about a file at a revision.
    ///
    /// # Errors
    /// When the hub refuses or cannot be reached.
    pub(super) fn ask_about_file(
        &self,
        model: &HubModelName,
        revision: &str,
        file: &str,
    ) -> Result<HubFileAnswer, LocalError> {
        let address = self.file_address(model, revision, file);
        let mut patience = self.new_patience();
        loop {
            match self.ask_once(model, &address) {
                Ok(answer) => return Ok(answer),
                Err(trouble) => patience.wait_or_give_up(trouble, &address)?,
            }
        }
    }

    /// One attempt of [`HubClient::ask_about_file`].
    fn ask_once(&self, model: &HubModelName, address: &str) -> Result<HubFileAnswer, RequestFailure> {
        let mut facts = RedirectFacts::default();
        let response = self.follow_redirects(HubMethod::Head, address, |headers| facts.read_headers(headers))?;
        let (status, headers) = (response.status().as_u16(), response.headers());
        if is_absence(status, headers) {
            return Ok(HubFileAnswer::Absent(facts.commit));
        }
        if status >= 400 {
            return Err(self.describe_refusal(&response, address, model));
        }
        let incomplete = |problem: &str| {
            RequestFailure::Lasting(LocalError::download_failed(address, problem, CHECK_WHO_ANSWERS_HINT))
        };
        let (etag, size) = facts.linked.unwrap_or_else(|| {
            (header_text(headers, "etag").unwrap_or_default().to_owned(), header_number(headers, "content-length"))
        });
        let hash = BlobHash::from_etag(&etag).ok_or_else(|| incomplete("the answer has no hash of the file"))?;
        let commit = facts.commit.ok_or_else(|| incomplete("the answer has no commit"))?;
        Ok(HubFileAnswer::There(HubFileFacts { commit, hash, size }))
    }

    /// Requests the bytes at an address, from byte `from` on. Also returns the position of the first byte that comes,
    /// because a server that cannot send a part sends all bytes.
    ///
    /// # Errors
    /// When the request is refused or not answered.
    pub(super) fn open_download(
        &self,
        model: &HubModelName,
        address: &str,
        from: u64,
    ) -> Result<(u64, impl Read + use<>), RequestFailure> {
        let mut from = from;
        loop {
            let response = self.follow_redirects(HubMethod::Get { from }, address, |_| false)?;
            match response.status().as_u16() {
                200 => from = 0,
                206 if first_byte_position(response.headers()) == Some(from) => {}
                // The server sends another part than requested, or none: request all bytes.
                206 | 416 if from > 0 => {
                    from = 0;
                    continue;
                }
                _ => return Err(self.describe_refusal(&response, address, model)),
            }
            return Ok((from, response.into_body().into_reader()));
        }
    }

    /// Sends a request and follows its redirects, until `enough` returns true or an answer is not a redirect.
    fn follow_redirects(
        &self,
        method: HubMethod,
        address: &str,
        mut enough: impl FnMut(&HeaderMap) -> bool,
    ) -> Result<Response<Body>, RequestFailure> {
        let lasting = |problem: &str| RequestFailure::Lasting(LocalError::download_failed(address, problem, TRY_LATER));
        let mut current = WebAddress::parse(address).map_err(lasting)?;
        for _ in 0..MAX_REDIRECTS {
            let response = self
                .send_request(method, &current)
                .map_err(|error| RequestFailure::from_transport_error(&error, address, current.host()))?;
            if enough(response.headers()) || !response.status().is_redirection() {
                return Ok(response);
            }
            let location =
                header_text(response.headers(), "location").ok_or_else(|| lasting("a redirect has no address"))?;
            current = current
                .follow_location(location)
                .map_err(|problem| lasting(&format!("a redirect cannot be followed: {problem}")))?;
        }
        Err(lasting("there are too many redirects"))
    }

    fn send_request(&self, method: HubMethod, at: &WebAddress) -> Result<Response<Body>, ureq::Error> {
        let mut request = match method {
            HubMethod::Head => self.agent.head(&at.text),
            HubMethod::Get { .. } => self.agent.get(&at.text),
        };
        if let HubMethod::Get { from: from @ 1.. } = method {
            request = request.header("range", format!("bytes={from}-"));
        }
        if let Some(token) = self.token.as_ref().filter(|_| at.server_origin() == self.endpoint.server_origin()) {
            request = request.header("authorization", token.header_value());
        }
        request.call()
    }

    fn describe_refusal(&self, response: &Response<Body>, address: &str, model: &HubModelName) -> RequestFailure {
        RequestFailure::from_status(
            response.status().as_u16(),
            response.headers(),
            address,
            model,
            self.token.is_some(),
        )
    }
}

impl RedirectFacts {
    /// Reads the headers of an answer, and returns whether all facts are known. Then the last redirect is not followed:
    /// the storage server does not know the commit, and its address may be signed for GET requests only.
    fn read_headers(&mut self, headers: &HeaderMap) -> bool {
        if self.commit.is_none() {
            self.commit = header_text(headers, "x-repo-commit").and_then(CommitHash::parse);
        }
        if self.linked.is_none() {
            let etag = header_text(headers, "x-linked-etag");
            self.linked = etag.map(|etag| (etag.to_owned(), header_number(headers, "x-linked-size")));
        }
        self.commit.is_some() && self.linked.is_some()
    }
}

fn header_number(headers: &HeaderMap, name: &str) -> Option<u64> {
    header_text(headers, name)?.trim().parse().ok()
}

/// The position of a partial answer's first byte.
fn first_byte_position(headers: &HeaderMap) -> Option<u64> {
    header_text(headers, "content-range")?.strip_prefix("bytes ")?.split('-').next()?.parse().ok()
}

/// A web address: `http` or `https`, a host, a path.
#[derive(Debug, Clone)]
pub(super) struct WebAddress {
    pub(super) text: String,
    uri: Uri,
}

impl WebAddress {
    /// Reads an address.
    ///
    /// # Errors
    /// The problem with the address. It does not repeat the address, which may contain a password or a signature.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let uri: Uri = text.parse().map_err(|_| "it is not a web address")?;
        let authority = uri.authority().ok_or("it has no host")?;
        if !matches!(uri.scheme_str(), Some("http" | "https")) {
            return Err("it begins with neither http:// nor https://");
        }
        if authority.as_str().contains('@') || authority.host().is_empty() {
            return Err("it contains a user or a password, or has no host");
        }
        Ok(Self { text: text.to_owned(), uri })
    }

    /// Reads the hub's address, to which the path of a file is added.
    pub(super) fn parse_endpoint(text: &str) -> Result<Self, &'static str> {
        let address = Self::parse(text.trim().trim_end_matches('/'))?;
        if address.uri.query().is_some() || text.contains('#') {
            return Err("it contains more than a host and a path");
        }
        Ok(address)
    }

    /// The address of a file below the hub's.
    pub(super) fn file_address(&self, model: &HubModelName, revision: &str, file: &str) -> String {
        const IN_A_PATH: &AsciiSet = &SEGMENT_ESCAPES.remove(b'/');
        // A revision is one segment of the path, a file may be several.
        let (revision, file) = (utf8_percent_encode(revision, SEGMENT_ESCAPES), utf8_percent_encode(file, IN_A_PATH));
        format!("{}/{}/{}/resolve/{revision}/{file}", self.text, model.org, model.name)
    }

    /// The address that a redirect leads to. A redirect from https to http is refused.
    pub(super) fn follow_location(&self, location: &str) -> Result<Self, &'static str> {
        let (scheme, host, port) = self.server_origin();
        let to = if location.starts_with("//") {
            Self::parse(&format!("{scheme}:{location}"))?
        } else if location.starts_with('/') {
            Self::parse(&format!("{scheme}://{host}:{port}{location}"))?
        } else {
            Self::parse(location)?
        };
        if to.is_plain() && !self.is_plain() { Err("it leads from https to http") } else { Ok(to) }
    }

    fn host(&self) -> &str {
        self.uri.host().unwrap_or_default()
    }

    /// Scheme, host and port, which together identify a server.
    pub(super) fn server_origin(&self) -> (&str, String, u16) {
        let scheme = self.uri.scheme_str().unwrap_or_default();
        let port = self.uri.port_u16().unwrap_or(if self.is_plain() { 80 } else { 443 });
        (scheme, self.host().to_ascii_lowercase(), port)
    }

    /// Whether requests go over plain http, so that others on the network can read them.
    fn is_plain(&self) -> bool {
        self.uri.scheme_str() != Some("https")
    }

    /// Whether the host is this machine.
    fn is_loopback(&self) -> bool {
        let bare = self.host().trim_start_matches('[').trim_end_matches(']');
        bare.eq_ignore_ascii_case("localhost") || bare.parse().is_ok_and(|address: IpAddr| address.is_loopback())
    }
}
