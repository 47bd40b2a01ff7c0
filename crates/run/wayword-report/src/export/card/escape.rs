//! Escapes values for the Markdown and YAML of a dataset card. The values come from files and are not trusted: the name of a model
//! or a scene must not become a link, a heading or a key.

use minijinja::{Error, Output, State, Value, value::ValueKind};

/// Characters with a meaning in Markdown or HTML; a backslash in front takes it away.
const ESCAPED_CHARACTERS: &str = "\\`*_{}[]<>()#.!|&~:$^@";

/// Escapes a text so that Markdown shows it unchanged, on one line.
fn in_markdown(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || c == '\u{2028}' || c == '\u{2029}' {
            escaped.push(' ');
            continue;
        }
        if ESCAPED_CHARACTERS.contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Writes a value into the card: texts are escaped unless a filter has made them safe.
pub(super) fn write_card_value(out: &mut Output<'_>, _state: &State<'_, '_>, value: &Value) -> Result<(), Error> {
    match value.as_str().filter(|_| value.kind() == ValueKind::String && !value.is_safe()) {
        Some(text) => out.write_str(&in_markdown(text)).map_err(Error::from),
        None => out.write_str(&value.to_string()).map_err(Error::from),
    }
}

/// Filter `yaml`: the text as a quoted YAML string. A JSON string is a valid YAML string.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
pub(super) fn yaml_filter(text: String) -> Value {
    let printable: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    Value::from_safe_string(serde_json::Value::from(printable).to_string())
}

/// Filter `plain`: passes a text through unescaped. Only for texts that this program has checked or made: names of splits and files.
pub(super) fn plain_filter(text: String) -> Value {
    Value::from_safe_string(text)
}

/// Filter `join`: escapes texts and joins them with a separator.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
pub(super) fn join_filter(texts: Vec<String>, between: &str) -> Value {
    Value::from_safe_string(texts.iter().map(|text| in_markdown(text)).collect::<Vec<_>>().join(between))
}
