//! OpenAI's legacy completions: one prompt, and the text that a model adds to it.

use super::{DialectReply, DialectRequest, MissingField, RemoteMessage, WireRequest, chat};
use serde_json::{Map, Value, json};
use wayword_core::MessageRole;

/// Turns a request into a body for this API.
///
/// # Errors
/// When there is a picture.
pub(super) fn to_wire(request: DialectRequest<'_>) -> Result<WireRequest, &'static str> {
    if request.lines.iter().any(|line| !line.pictures.is_empty()) {
        return Err("the completions endpoint takes no pictures: for --see, choose a model behind a chat endpoint");
    }
    let mut body = Map::new();
    body.insert("model".to_owned(), request.model.into());
    if let [only @ RemoteMessage { role: MessageRole::User, .. }] = request.lines {
        // Instruction models take a single request as it is.
        body.insert("prompt".to_owned(), only.text.clone().into());
    } else {
        body.insert("prompt".to_owned(), conversation_script(request.lines).into());
        // Otherwise a model writes the user's next lines too.
        body.insert("stop".to_owned(), json!(["\nUser:"]));
    }
    chat::insert_sampling(request, &mut body);
    Ok(WireRequest { path: "/completions".to_owned(), body: body.into() })
}

/// A conversation as a script that ends where the model is to answer.
fn conversation_script(lines: &[RemoteMessage]) -> String {
    let mut prompt = String::new();
    for line in lines {
        match line.role {
            MessageRole::System => prompt.push_str(&format!("{}\n\n", line.text)),
            MessageRole::User => prompt.push_str(&format!("User: {}\n", line.text)),
            MessageRole::Assistant => prompt.push_str(&format!("Assistant: {}\n", line.text)),
        }
    }
    prompt + "Assistant:"
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<DialectReply, MissingField> {
    let choice = body.get("choices").and_then(|choices| choices.get(0)).ok_or(MissingField("choices"))?;
    let text = choice.get("text").and_then(Value::as_str).ok_or(MissingField("text"))?;
    Ok(chat::with_usage(body, text.to_owned(), chat::reply_end(choice)?))
}
