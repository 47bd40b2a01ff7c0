//! Reads what language models answer, the same way for every role.
//!
//! Servers leave much around an answer: thinking, marks of a chat template, wrappings, comments, repeats. Each form is
//! read in one place:
//!
//! - [`without_thinking`]: what the model thought before it answered.
//! - [`without_template_marks`]: marks of chat templates, such as `<|im_end|>`.
//! - [`read_text`]: the one text that was asked for, without anything around it, or why there is none.
//! - [`find_object`]: the JSON object that was asked for, mended where models break it.
//! - [`find_tool_calls`]: the calls of tools, in the many shapes that servers leave them in.
//!
//! All of it comes from outside: nothing is evaluated, and longer replies than [`MAX_REPLY_BYTES`] are cut.

mod chatter;
mod json;
mod markdown;
mod marks;
mod text;
mod thinking;
mod tools;

pub use chatter::is_refusal;
pub use json::{ObjectReading, find_object};
pub use marks::without_template_marks;
pub use text::{read_sentences, read_text, read_text_in, without_repeats};
pub use thinking::without_thinking;
pub use tools::{ToolCallReading, find_tool_calls};

/// The longest part of a reply that is read, bytes. A full answer has about 2,000; thinking before it may be long.
pub const MAX_REPLY_BYTES: usize = 256 * 1024;

/// The part of a reply that is read.
fn bounded(reply: &str) -> &str {
    &reply[..reply.floor_char_boundary(MAX_REPLY_BYTES)]
}
