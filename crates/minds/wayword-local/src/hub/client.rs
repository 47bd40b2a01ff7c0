//! Requests to the hub, and along its redirects.

use super::{
    HubConfig,
    address::Address,
    commit::Commit,
    config::Token,
    hash::BlobHash,
    name::OnHub,
    refusal::{Refused, is_absence},
    trouble::{Patience, Trouble},
};
use crate::LocalError;
use std::{io::Read, time::Duration};
use ureq::{
    Agent, Body, Proxy,
    config::Config,
    http::{HeaderMap, Response},
};

const MOST_REDIRECTS: usize = 10;

/// Longest wait for a connection.
const CONNECT: Duration = Duration::from_secs(10);

/// Longest silence of a server. There is no bound on the whole: a model takes as long as it takes.
const SILENCE: Duration = Duration::from_secs(60);

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

/// A file's bytes from a place on.
pub(super) struct Opened {
    pub(super) from: u64,
    pub(super) body: Box<dyn Read>,
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
        let endpoint = Address::endpoint(&config.endpoint).map_err(|problem| LocalError::Download {
            address: "HF_ENDPOINT".to_owned(),
            problem: problem.to_owned(),
            hint: "write it like https://huggingface.co".to_owned(),
        })?;
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
        let token = config.token.clone().filter(|_| endpoint.keeps_secrets());
        Ok(Self { agent: Agent::new_with_config(settings), endpoint, token, first_wait: config.first_wait })
    }

    pub(super) fn patience(&self) -> Patience {
        Patience::new(self.first_wait)
    }

    /// The address of a file at a revision.
    pub(super) fn address(&self, place: &OnHub, revision: &str, file: &str) -> String {
        self.endpoint.resolve(place, revision, file)
    }

    /// Asks what a file is at a revision.
    ///
    /// # Errors
    /// When the hub refuses or cannot be reached.
    pub(super) fn ask(&self, place: &OnHub, revision: &str, file: &str) -> Result<Answer, LocalError> {
        let address = self.address(place, revision, file);
        let mut patience = self.patience();
        loop {
            match self.ask_once(place, &address) {
                Ok(answer) => return Ok(answer),
                Err(trouble) => patience.again(trouble, &address)?,
            }
        }
    }

    fn ask_once(&self, place: &OnHub, address: &str) -> Result<Answer, Trouble> {
        let mut heard = Heard::default();
        let response = self.follow(Method::Head, address, |headers| heard.hear(headers))?;
        let status = response.status().as_u16();
        if is_absence(status, response.headers()) {
            return Ok(Answer::Absent(heard.commit));
        }
        if status >= 400 {
            return Err(self.refused(&response, address, place));
        }
        let incomplete = |problem: &str| {
            Trouble::Lasting(LocalError::Download {
                address: address.to_owned(),
                problem: problem.to_owned(),
                hint:
                    "see HF_ENDPOINT where you have set it, and whether something on the way answers instead of the hub"
                        .to_owned(),
            })
        };
        let (etag, size) = match heard.linked {
            Some(linked) => linked,
            None => (
                text(response.headers(), "etag").unwrap_or("").to_owned(),
                number(response.headers(), "content-length"),
            ),
        };
        let hash = BlobHash::from_etag(&etag).ok_or_else(|| incomplete("the answer names no hash of the file"))?;
        let commit = heard.commit.ok_or_else(|| incomplete("the answer names no commit"))?;
        Ok(Answer::There(Facts { commit, hash, size }))
    }

    /// Asks for a file's bytes from a place on; a server that cannot do that gives all of them.
    ///
    /// # Errors
    /// When it is refused or nothing comes.
    pub(super) fn open(&self, place: &OnHub, commit: &Commit, file: &str, from: u64) -> Result<Opened, Trouble> {
        let address = self.address(place, commit.as_str(), file);
        let response = self.follow(Method::Get { from }, &address, |_| false)?;
        let from = match response.status().as_u16() {
            200 => 0,
            206 if begins_at(response.headers()) == Some(from) => from,
            // Not the part that was asked for, or there is none: from the beginning.
            206 | 416 if from > 0 => return self.open(place, commit, file, 0),
            _ => return Err(self.refused(&response, &address, place)),
        };
        Ok(Opened { from, body: Box::new(response.into_body().into_reader()) })
    }

    /// Sends a request and follows where it leads, until `enough` is heard.
    fn follow(
        &self,
        method: Method,
        address: &str,
        mut enough: impl FnMut(&HeaderMap) -> bool,
    ) -> Result<Response<Body>, Trouble> {
        let lasting = |problem: &str| {
            Trouble::Lasting(LocalError::Download {
                address: address.to_owned(),
                problem: problem.to_owned(),
                hint: "try again later; see HF_ENDPOINT where you have set it".to_owned(),
            })
        };
        let mut at = Address::parse(address).map_err(lasting)?;
        for _ in 0..MOST_REDIRECTS {
            let response = self.send(method, &at).map_err(|error| Trouble::of(&error, address, at.host()))?;
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
            Method::Head => self.agent.head(at.as_str()),
            Method::Get { .. } => self.agent.get(at.as_str()),
        };
        if let Method::Get { from: from @ 1.. } = method {
            request = request.header("range", format!("bytes={from}-"));
        }
        if let Some(token) = self.token.as_ref().filter(|_| at.origin() == self.endpoint.origin()) {
            request = request.header("authorization", token.header());
        }
        request.call()
    }

    fn refused(&self, response: &Response<Body>, address: &str, place: &OnHub) -> Trouble {
        let (status, headers) = (response.status().as_u16(), response.headers());
        Refused { status, headers, address, place, had_token: self.token.is_some() }.trouble()
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

fn text<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    headers.get(name)?.to_str().ok()
}

fn number(headers: &HeaderMap, name: &str) -> Option<u64> {
    text(headers, name)?.trim().parse().ok()
}

/// Where the bytes of a partial answer begin.
fn begins_at(headers: &HeaderMap) -> Option<u64> {
    text(headers, "content-range")?.strip_prefix("bytes ")?.split('-').next()?.parse().ok()
}
