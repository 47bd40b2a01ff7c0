//! The dialect of OpenAI's legacy completions: the request has one prompt, and the model continues it.

use super::{End, Said, openai, parts};
use crate::provider::Heard;
use serde_json::{Value, json};
use wayword_core::Role;

pub(super) fn heard(body: &Value) -> Result<Heard, &'static str> {
    let prompt = parts::text(body, "prompt")?;
    let mut heard =
        Heard { model: parts::text(body, "model")?, messages: vec![(Role::User, prompt)], ..Heard::default() };
    parts::sampling(&mut heard, body, &["max_tokens"]);
    Ok(heard)
}

pub(super) fn answer(said: &Said) -> Value {
    let text = match said.end {
        End::Stop | End::Length => said.text.as_str(),
        End::Filtered => "",
        End::Refused => super::SORRY,
    };
    let choice = json!({ "index": 0, "text": text, "logprobs": null, "finish_reason": openai::finish(said.end) });
    openai::envelope(said, "text_completion", &choice)
}
