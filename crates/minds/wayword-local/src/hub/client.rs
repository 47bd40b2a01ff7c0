//! Requests to the hub, and along its redirects.

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

/// Longest silence of a server. There is no bound on the whole: a model takes as long as it takes.
const SILENCE: Duration = Duration::from_secs(60);

/// What is encoded in one segment of a path: everything but what every address may hold.
const IN_A_SEGMENT: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// The hub's connections.
#[derive(Debug)]
pub(super) struct Client {
    agent: Agent,
    endpoint: Address,
    token: Option<Token>,
    first_wait: Duration,
}

/// What the hub says of a file.
#[derive(Debug)]
pub(super) enum Answer {
    There(Facts),
    /// The model has no such file, at this commit where it is told.
    Absent(Option<Commit>),
}

/// What is known of a file before it is fetched.
#[derive(Debug)]
pub(super) struct Facts {
    pub(super) commit: Commit,
    pub(super) hash: BlobHash,
    /// Bytes.
    pub(super) size: Option<u64>,
}

/// What was heard on the way to a file.
#[derive(Default)]
struct Heard {
    commit: Option<Commit>,
    /// Etag and size of the bytes that a redirect leads to.
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
            // A redirect must not carry the token to somebody else, and says what no other answer does.
            .max_redirects(0)
            .timeout_connect(Some(CONNECT))
            .timeout_recv_response(Some(SILENCE))
            .timeout_per_read(Some(SILENCE))
            .user_agent(concat!("wayword/", env!("CARGO_PKG_VERSION")))
            // The bytes as they are, or their hash would be another.
            .accept_encoding("identity")
            // A proxy cannot reach this machine's own servers.
            .proxy(if endpoint.is_loopback() { None } else { Proxy::try_from_env() })
            .build();
        // Nobody on the way may read it.
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

    /// Asks what a file is at a revision.
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
        let hash = BlobHash::from_etag(&etag).ok_or_else(|| incomplete("the answer names no hash of the file"))?;
        let commit = heard.commit.ok_or_else(|| incomplete("the answer names no commit"))?;
        Ok(Answer::There(Facts { commit, hash, size }))
    }

    /// Asks for the bytes at an address from a place on. A server that cannot do that gives all of them, so where they begin
    /// comes back too.
    ///
    /// # Errors
    /// When it is refused or nothing comes.
    pub(super) fn open(&self, model: &OnHub, address: &str, from: u64) -> Result<(u64, impl Read + use<>), Trouble> {
        let mut from = from;
        loop {
            let response = self.follow(Method::Get { from }, address, |_| false)?;
            match response.status().as_u16() {
                200 => from = 0,
                206 if begins_at(response.headers()) == Some(from) => {}
                // Not the part that was asked for, or there is none: from the beginning.
                206 | 416 if from > 0 => {
                    from = 0;
                    continue;
                }
                _ => return Err(self.refused(&response, address, model)),
            }
            return Ok((from, response.into_body().into_reader()));
        }
    }

    /// Sends a request and follows where it leads, until `enough` is heard.
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
            let location = text(response.headers(), "location").ok_or_else(|| lasting("a redirect leads nowhere"))?;
            at = at
                .redirected(location)
                .map_err(|problem| lasting(&format!("a redirect cannot be followed: {problem}")))?;
        }
        Err(lasting("it is redirected again and again"))
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
    /// Whether everything has been heard. The storage behind the last redirect knows neither hub nor commit, and its address may
    /// be signed for nothing but getting the file.
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

/// Where the bytes of a partial answer begin.
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
    /// Says what is wrong without the address: it may hold a password or a signature.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let uri: Uri = text.parse().map_err(|_| "it is no web address")?;
        let authority = uri.authority().ok_or("it has no host")?;
        if !matches!(uri.scheme_str(), Some("http" | "https")) {
            return Err("it begins with neither http:// nor https://");
        }
        if authority.as_str().contains('@') || authority.host().is_empty() {
            return Err("it holds a user or a password, or no host");
        }
        Ok(Self { text: text.to_owned(), uri })
    }

    /// The hub's address, to which a file's path is added.
    pub(super) fn endpoint(text: &str) -> Result<Self, &'static str> {
        let address = Self::parse(text.trim().trim_end_matches('/'))?;
        if address.uri.query().is_some() || text.contains('#') {
            return Err("it holds more than a host and a path");
        }
        Ok(address)
    }

    /// The address of a file below the hub's.
    pub(super) fn resolve(&self, model: &OnHub, revision: &str, file: &str) -> String {
        const IN_A_PATH: &AsciiSet = &IN_A_SEGMENT.remove(b'/');
        // A revision is one segment, a file may be several.
        let (revision, file) = (utf8_percent_encode(revision, IN_A_SEGMENT), utf8_percent_encode(file, IN_A_PATH));
        format!("{}/{}/{}/resolve/{revision}/{file}", self.text, model.org, model.name)
    }

    /// Where a redirect leads.
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

    /// Scheme, host and port: who is spoken to.
    pub(super) fn origin(&self) -> (&str, String, u16) {
        let scheme = self.uri.scheme_str().unwrap_or_default();
        let port = self.uri.port_u16().unwrap_or(if self.is_plain() { 80 } else { 443 });
        (scheme, self.host().to_ascii_lowercase(), port)
    }

    /// Whether others on the way can read what is sent.
    fn is_plain(&self) -> bool {
        self.uri.scheme_str() != Some("https")
    }

    /// Whether it is this machine.
    fn is_loopback(&self) -> bool {
        let bare = self.host().trim_start_matches('[').trim_end_matches(']');
        bare.eq_ignore_ascii_case("localhost") || bare.parse().is_ok_and(|address: IpAddr| address.is_loopback())
    }
}
