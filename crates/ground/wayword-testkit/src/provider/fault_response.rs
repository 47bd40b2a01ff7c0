//! Turns a drawn fault into the HTTP response, or the broken connection, that a failing service would give.

use super::{
    FaultSchedule, ProviderDialect, ServiceFault,
    breakable_connection::{BreakSwitch, ConnectionBreak},
    dialect::{ReplyEnding, ScriptReply, ServiceErrorKind},
};
use axum::{
    http::{HeaderMap, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde_json::Value;

/// The page that a gateway sends in place of JSON.
const GATEWAY_ERROR_PAGE: &str =
    "<!DOCTYPE html><html><head><title>502 Bad Gateway</title></head><body>Bad Gateway</body></html>";

/// A request with its right answer, ready to be spoilt by a fault.
pub(super) struct FaultResponder<'a> {
    pub(super) dialect: ProviderDialect,
    pub(super) faults: &'a FaultSchedule,
    /// Orders the connection to break.
    pub(super) line: &'a BreakSwitch,
    pub(super) headers: &'a HeaderMap,
    /// The answer without the fault.
    pub(super) good_reply: ScriptReply,
}

impl FaultResponder<'_> {
    /// The response that a service with this fault would give.
    pub(super) fn respond_with_fault(self, fault: ServiceFault) -> Response {
        match fault {
            ServiceFault::TooMany(form) => self.dialect.too_many(form, self.faults.wait),
            ServiceFault::Server => self
                .dialect
                .error_response(ServiceErrorKind::Server, "The server had an error while processing your request."),
            ServiceFault::Gateway => html_response(StatusCode::BAD_GATEWAY),
            ServiceFault::Unavailable => {
                self.dialect.error_response(ServiceErrorKind::Unavailable, "The model is not ready.")
            }
            ServiceFault::Overloaded => self.dialect.error_response(ServiceErrorKind::Overloaded, "Overloaded"),
            ServiceFault::Reset => self.respond_and_break(ConnectionBreak::Reset),
            ServiceFault::Closed => self.respond_and_break(ConnectionBreak::Close),
            ServiceFault::Trickle => self.respond_and_break(ConnectionBreak::Trickle(self.faults.trickle)),
            ServiceFault::Endless => self.respond_and_break(ConnectionBreak::Endless),
            ServiceFault::Truncated => {
                let whole = self.dialect.reply_body(&self.good_reply).to_string();
                let half: String = whole.chars().take(whole.chars().count() / 2).collect();
                ([(header::CONTENT_TYPE, "application/json")], half).into_response()
            }
            ServiceFault::NoChoices => json_response(&self.dialect.no_choices()),
            ServiceFault::ErrorInOk => {
                json_response(&self.dialect.error_body(ServiceErrorKind::Server, "The upstream failed.", None))
            }
            ServiceFault::WrongType => html_response(StatusCode::OK),
            ServiceFault::EchoesKey => {
                let message = format!("Upstream refused the key {}.", request_key(self.dialect, self.headers));
                self.dialect.error_response(ServiceErrorKind::Server, &message)
            }
            ServiceFault::CutOff => {
                let words: Vec<&str> = self.good_reply.text.split_inclusive(' ').collect();
                let text = words[..words.len() / 2].concat();
                json_response(&self.dialect.reply_body(&ScriptReply {
                    text,
                    end: ReplyEnding::Length,
                    ..self.good_reply
                }))
            }
            ServiceFault::Filtered => {
                json_response(&self.dialect.reply_body(&ScriptReply { end: ReplyEnding::Filtered, ..self.good_reply }))
            }
            ServiceFault::Refused => {
                json_response(&self.dialect.reply_body(&ScriptReply { end: ReplyEnding::Refused, ..self.good_reply }))
            }
        }
    }

    /// A good answer on a connection that breaks.
    fn respond_and_break(&self, how: ConnectionBreak) -> Response {
        self.line.order_break(how);
        json_response(&self.dialect.reply_body(&self.good_reply))
    }
}

/// A response of JSON with status 200.
pub(super) fn json_response(body: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], body.to_string()).into_response()
}

/// A page of HTML where a client expects JSON.
fn html_response(status: StatusCode) -> Response {
    (status, [(header::CONTENT_TYPE, "text/html; charset=utf-8")], GATEWAY_ERROR_PAGE).into_response()
}

/// The API key that came with a request; empty if none did.
pub(super) fn request_key(dialect: ProviderDialect, headers: &HeaderMap) -> String {
    let (name, prefix) = dialect.key_header();
    let value = headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default();
    value.strip_prefix(prefix).unwrap_or_default().to_owned()
}
