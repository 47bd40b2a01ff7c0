//! Turns a drawn fault into the HTTP response, or the broken connection, that a failing service would give.

use super::{
    Dialect, Fault, Faults,
    dialect::{End, Said, Wrong},
    wire::{Break, Line},
};
use axum::{
    http::{HeaderMap, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde_json::Value;

const PAGE: &str = "<!DOCTYPE html><html><head><title>502 Bad Gateway</title></head><body>Bad Gateway</body></html>";

/// A request with its right answer, ready to be spoilt by a fault.
pub(super) struct Misdeed<'a> {
    pub(super) dialect: Dialect,
    pub(super) faults: &'a Faults,
    pub(super) line: &'a Line,
    pub(super) headers: &'a HeaderMap,
    /// The answer without the fault.
    pub(super) said: Said,
}

impl Misdeed<'_> {
    pub(super) fn commit(self, fault: Fault) -> Response {
        match fault {
            Fault::TooMany(form) => self.dialect.too_many(form, self.faults.wait),
            Fault::Server => {
                self.dialect.refuse(Wrong::Server, "The server had an error while processing your request.")
            }
            Fault::Gateway => html(StatusCode::BAD_GATEWAY),
            Fault::Unavailable => self.dialect.refuse(Wrong::Unavailable, "The model is not ready."),
            Fault::Overloaded => self.dialect.refuse(Wrong::Overloaded, "Overloaded"),
            Fault::Reset => self.broken(Break::Reset),
            Fault::Closed => self.broken(Break::Close),
            Fault::Trickle => self.broken(Break::Trickle(self.faults.trickle)),
            Fault::Endless => self.broken(Break::Endless),
            Fault::Truncated => {
                let whole = self.dialect.answer(&self.said).to_string();
                let half: String = whole.chars().take(whole.chars().count() / 2).collect();
                ([(header::CONTENT_TYPE, "application/json")], half).into_response()
            }
            Fault::NoChoices => json(&self.dialect.no_choices()),
            Fault::ErrorInOk => json(&self.dialect.error(Wrong::Server, "The upstream failed.", None)),
            Fault::WrongType => html(StatusCode::OK),
            Fault::EchoesKey => {
                let message = format!("Upstream refused the key {}.", key_of(self.dialect, self.headers));
                self.dialect.refuse(Wrong::Server, &message)
            }
            Fault::CutOff => {
                let words: Vec<&str> = self.said.text.split_inclusive(' ').collect();
                let text = words[..words.len() / 2].concat();
                json(&self.dialect.answer(&Said { text, end: End::Length, ..self.said }))
            }
            Fault::Filtered => json(&self.dialect.answer(&Said { end: End::Filtered, ..self.said })),
            Fault::Refused => json(&self.dialect.answer(&Said { end: End::Refused, ..self.said })),
        }
    }

    /// A good answer on a connection that breaks.
    fn broken(&self, how: Break) -> Response {
        self.line.breaks(how);
        json(&self.dialect.answer(&self.said))
    }
}

pub(super) fn json(body: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}

fn html(status: StatusCode) -> Response {
    (status, [(header::CONTENT_TYPE, "text/html; charset=utf-8")], PAGE).into_response()
}

/// The key that came with a request.
pub(super) fn key_of(dialect: Dialect, headers: &HeaderMap) -> String {
    let (name, before) = dialect.key_header();
    let value = headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default();
    value.strip_prefix(before).unwrap_or_default().to_owned()
}
