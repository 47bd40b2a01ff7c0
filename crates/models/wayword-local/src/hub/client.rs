//! Sends requests to the hub, and follows its redirects.
//!
//! For a large file the hub answers with a redirect to a storage server. Commit, hash and size are in the headers of
//! the hub's redirects, and not in the storage server's answer, so they are collected along the way.

use super::{
    HubConfig,
    cache::{BlobHash, Commit},
    config::Token,
    name::OnHub,
    trouble::{Patience, SEE_WHO_ANSWERS, TRY_LATER, Trouble, is_absence, text},
};
use crate::LocalError;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use std::{io::Read, net::IpAddr, time::Duration};
use ureq::{
    Agent, Body, Proxy,
    config::Config,
    http::{HeaderMap, Response, Uri},
};

const MOST_REDIRECTS: usize = 10;

/// Longest wait for a connection.
const CONNECT: Duration = Duration::from_secs(10);

/// Longest silence of a server. There is no limit on a whole download, because a model may be large.
const SILENCE: Duration = Duration::from_secs(60);

/// The characters that are percent-encoded in one segment of a path: all except those that any address may contain.
const IN_A_SEGMENT: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// The hub's connections.
#[derive(Debug)]
pub(super) struct Client {
    agent: Agent,
    endpoint: Address,
    token: Option<Token>,
    first_wait: Duration,
}

/// The hub's answer about a file.
#[derive(Debug)]
pub(super) enum Answer {
    There(Facts),
    /// The model lacks the file at this commit, if the hub names a commit.
    Absent(Option<Commit>),
}

/// The facts about a file before it is fetched.
#[derive(Debug)]
pub(super) struct Facts {
    pub(super) commit: Commit,
    pub(super) hash: BlobHash,
    /// Bytes.
    pub(super) size: Option<u64>,
}

/// The facts that the answers along a chain of redirects have given so far.
#[derive(Default)]
struct Heard {
    commit: Option<Commit>,
    /// The etag and the size of the file that a redirect leads to.
    linked: Option<(String, Option<u64>)>,
}

#[derive(Clone, Copy)]
enum Method {
    Head,
    Get { from: u64 },
}

impl Client {
    pub(super) fn new(config: &HubConfig) -> Result<Self, LocalError> {
        let endpoint = Address::endpoint(&config.endpoint)
            .map_err(|problem| LocalError::download("HF_ENDPOINT", problem, "write it like https://huggingface.co"))?;
        let settings = Config::builder()
            .http_status_as_error(false)
            // Redirects are followed here, because the token must not go to another server, and a redirect's headers
            // are needed.
            .max_redirects(0)
            .timeout_connect(Some(CONNECT))
            .timeout_recv_response(Some(SILENCE))
            .timeout_per_read(Some(SILENCE))
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

    pub(super) fn patience(&self) -> Patience {
        Patience::new(self.first_wait)
    }

    /// The address of a file at a revision.
    pub(super) fn address(&self, model: &OnHub, revision: &str, file: &str) -> String {
        self.endpoint.resolve(model, revision, file)
    }

    /// Asks the hub about a file at a revision.
    ///
    /// # Errors
    /// When the hub refuses or cannot be reached.
    pub(super) fn ask(&self, model: &OnHub, revision: &str, file: &str) -> Result<Answer, LocalError> {
        let address = self.address(model, revision, file);
        let mut patience = self.patience();
        loop {
            match self.ask_once(model, &address) {
                Ok(answer) => return Ok(answer),
                Err(trouble) => patience.again(trouble, &address)?,
            }
        }
    }

    fn ask_once(&self, model: &OnHub, address: &str) -> Result<Answer, Trouble> {
        let mut heard = Heard::default();
        let response = self.follow(Method::Head, address, |headers| heard.hear(headers))?;
        let (status, headers) = (response.status().as_u16(), response.headers());
        if is_absence(status, headers) {
            return Ok(Answer::Absent(heard.commit));
        }
        if status >= 400 {
            return Err(self.refused(&response, address, model));
        }
        let incomplete = |problem: &str| Trouble::Lasting(LocalError::download(address, problem, SEE_WHO_ANSWERS));
        let (etag, size) = heard.linked.unwrap_or_else(|| {
            (text(headers, "etag").unwrap_or_default().to_owned(), number(headers, "content-length"))
        });
        let hash = BlobHash::from_etag(&etag).ok_or_else(|| incomplete("the answer has no hash of the file"))?;
        let commit = heard.commit.ok_or_else(|| incomplete("the answer has no commit"))?;
        Ok(Answer::There(Facts { commit, hash, size }))
    }

    /// Requests the bytes at an address, from byte `from` on. Also returns the position of the first byte that comes,
    /// because a server that cannot send a part sends all bytes.
    ///
    /// # Errors
    /// When the request is refused or not answered.
    pub(super) fn open(&self, model: &OnHub, address: &str, from: u64) -> Result<(u64, impl Read + use<>), Trouble> {
        let mut from = from;
        loop {
            let response = self.follow(Method::Get { from }, address, |_| false)?;
            match response.status().as_u16() {
                200 => from = 0,
                206 if begins_at(response.headers()) == Some(from) => {}
                // The server sends another part than requested, or none: request all bytes.
                206 | 416 if from > 0 => {
                    from = 0;
                    continue;
                }
                _ => return Err(self.refused(&response, address, model)),
            }
            return Ok((from, response.into_body().into_reader()));
        }
    }

    /// Sends a request and follows its redirects, until `enough` returns true or an answer is not a redirect.
    fn follow(
        &self,
        method: Method,
        address: &str,
        mut enough: impl FnMut(&HeaderMap) -> bool,
    ) -> Result<Response<Body>, Trouble> {
        let lasting = |problem: &str| Trouble::Lasting(LocalError::download(address, problem, TRY_LATER));
        let mut at = Address::parse(address).map_err(lasting)?;
        for _ in 0..MOST_REDIRECTS {
            let response = self.send(method, &at).map_err(|error| Trouble::unanswered(&error, address, at.host()))?;
            if enough(response.headers()) || !response.status().is_redirection() {
                return Ok(response);
            }
            let location = text(response.headers(), "location").ok_or_else(|| lasting("a redirect has no address"))?;
            at = at
                .redirected(location)
                .map_err(|problem| lasting(&format!("a redirect cannot be followed: {problem}")))?;
        }
        Err(lasting("there are too many redirects"))
    }

    fn send(&self, method: Method, at: &Address) -> Result<Response<Body>, ureq::Error> {
        let mut request = match method {
            Method::Head => self.agent.head(&at.text),
            Method::Get { .. } => self.agent.get(&at.text),
        };
        if let Method::Get { from: from @ 1.. } = method {
            request = request.header("range", format!("bytes={from}-"));
        }
        if let Some(token) = self.token.as_ref().filter(|_| at.origin() == self.endpoint.origin()) {
            request = request.header("authorization", token.header());
        }
        request.call()
    }

    fn refused(&self, response: &Response<Body>, address: &str, model: &OnHub) -> Trouble {
        Trouble::refused(response.status().as_u16(), response.headers(), address, model, self.token.is_some())
    }
}

impl Heard {
    /// Reads the headers of an answer, and returns whether all facts are known. Then the last redirect is not followed:
    /// the storage server does not know the commit, and its address may be signed for GET requests only.
    fn hear(&mut self, headers: &HeaderMap) -> bool {
        if self.commit.is_none() {
            self.commit = text(headers, "x-repo-commit").and_then(Commit::parse);
        }
        if self.linked.is_none() {
            let etag = text(headers, "x-linked-etag");
            self.linked = etag.map(|etag| (etag.to_owned(), number(headers, "x-linked-size")));
        }
        self.commit.is_some() && self.linked.is_some()
    }
}

fn number(headers: &HeaderMap, name: &str) -> Option<u64> {
    text(headers, name)?.trim().parse().ok()
}

/// The position of a partial answer's first byte.
fn begins_at(headers: &HeaderMap) -> Option<u64> {
    text(headers, "content-range")?.strip_prefix("bytes ")?.split('-').next()?.parse().ok()
}

/// A web address: `http` or `https`, a host, a path.
#[derive(Debug, Clone)]
pub(super) struct Address {
    pub(super) text: String,
    uri: Uri,
}

impl Address {
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
    pub(super) fn endpoint(text: &str) -> Result<Self, &'static str> {
        let address = Self::parse(text.trim().trim_end_matches('/'))?;
        if address.uri.query().is_some() || text.contains('#') {
            return Err("it contains more than a host and a path");
        }
        Ok(address)
    }

    /// The address of a file below the hub's.
    pub(super) fn resolve(&self, model: &OnHub, revision: &str, file: &str) -> String {
        const IN_A_PATH: &AsciiSet = &IN_A_SEGMENT.remove(b'/');
        // A revision is one segment of the path, a file may be several.
        let (revision, file) = (utf8_percent_encode(revision, IN_A_SEGMENT), utf8_percent_encode(file, IN_A_PATH));
        format!("{}/{}/{}/resolve/{revision}/{file}", self.text, model.org, model.name)
    }

    /// The address that a redirect leads to. A redirect from https to http is refused.
    pub(super) fn redirected(&self, location: &str) -> Result<Self, &'static str> {
        let (scheme, host, port) = self.origin();
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
    pub(super) fn origin(&self) -> (&str, String, u16) {
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
