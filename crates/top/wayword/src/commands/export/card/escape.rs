//! Values of files within Markdown and YAML. They are not trusted: a model's or a scene's name must not become a link, a heading or
//! a key.

use minijinja::{Error, Output, State, Value, value::ValueKind};

/// Marks that mean something in Markdown or HTML.
const MARKS: &str = "\\`*_{}[]<>()#.!|&~:$^@";

/// A text that reads as it is in Markdown, within one line.
fn in_markdown(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || c == '\u{2028}' || c == '\u{2029}' {
            escaped.push(' ');
            continue;
        }
        if MARKS.contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Writes a value into the card: texts are escaped unless a filter has made them safe.
pub(super) fn write(out: &mut Output<'_>, _state: &State<'_, '_>, value: &Value) -> Result<(), Error> {
    match value.as_str().filter(|_| value.kind() == ValueKind::String && !value.is_safe()) {
        Some(text) => out.write_str(&in_markdown(text)).map_err(Error::from),
        None => out.write_str(&value.to_string()).map_err(Error::from),
    }
}

/// A text as YAML, in quotes: JSON's texts are YAML's too.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
pub(super) fn yaml(text: String) -> Value {
    let seen: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    Value::from_safe_string(serde_json::Value::from(seen).to_string())
}

/// A text that this program has checked or made: the name of a split, or of a file.
pub(super) fn plain(text: String) -> Value {
    Value::from_safe_string(text)
}

/// Texts one behind the other.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
pub(super) fn join(texts: Vec<String>, between: &str) -> Value {
    Value::from_safe_string(texts.iter().map(|text| in_markdown(text)).collect::<Vec<_>>().join(between))
}
