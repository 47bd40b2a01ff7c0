//! Finds the JSON in a reply, even with text around it, and repairs frequent mistakes of models: wrong quotes, missing
//! and trailing commas, comments, `True`, a missing end.

use crate::{MAX_REPLY_BYTES, thinking::without_thinking};
use serde_json::{Deserializer, Map, Value};

/// The JSON object of a reply.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectReading {
    /// Its fields.
    pub fields: Map<String, Value>,
    /// Whether the reply breaks off within it. It then has only the complete fields.
    pub is_cut: bool,
}

/// Most objects of a reply that are examined; the last ones count.
const MAX_OBJECTS: usize = 64;
/// How deep the wanted object may lie within others.
const MAX_WRAPPERS: usize = 4;

/// The last object of a reply that is the wanted one by its fields (`fits`). It may lie within another, as in
/// `{"answer": {...}}`, be written as a text there, or lack its outer braces.
///
/// # Errors
/// When there is none, or the reply is too long; the message is meant for the model.
pub fn find_object(reply: &str, fits: &dyn Fn(&Map<String, Value>) -> bool) -> Result<ObjectReading, String> {
    if reply.len() > MAX_REPLY_BYTES {
        return Err(format!("it has {} bytes, more than {MAX_REPLY_BYTES}", reply.len()));
    }
    let answer = without_thinking(reply);
    let objects = top_objects(&answer);
    let wanted = |object: &JsonReading| {
        Some(ObjectReading { fields: wanted_within(&object.value, fits, MAX_WRAPPERS)?, is_cut: object.is_cut })
    };
    if let Some(found) = objects.iter().rev().find_map(wanted) {
        return Ok(found);
    }
    // Fields without the braces around them, or with every quote escaped.
    let bare = || answer.find('"').and_then(|at| wanted(&mend_json(&format!("{{{}}}", &answer[at..]))?));
    let escaped = || top_objects(&answer.replace("\\\"", "\"")).iter().rev().find_map(wanted);
    if let Some(found) = bare().or_else(escaped) {
        return Ok(found);
    }
    match objects.last() {
        Some(_) => Err("its JSON is not in the form that was asked for".to_owned()),
        None if answer.contains('{') => Err("it is no valid JSON".to_owned()),
        None => Err("there is no JSON in it".to_owned()),
    }
}

/// The objects of a text that are in no other object, in their order.
fn top_objects(text: &str) -> Vec<JsonReading> {
    let (mut objects, mut at) = (Vec::new(), 0);
    while let Some(open) = text[at..].find('{').map(|open| at + open) {
        match mend_json(&text[open..]) {
            Some(object) => {
                at = open + object.length.max(1);
                objects.push(object);
            }
            None => at = open + 1,
        }
        if objects.len() == MAX_OBJECTS {
            objects.remove(0);
        }
    }
    objects
}

/// The wanted object in a value: the value itself, or one within it, or one that is written there as a text.
fn wanted_within(
    value: &Value,
    fits: &dyn Fn(&Map<String, Value>) -> bool,
    depth: usize,
) -> Option<Map<String, Value>> {
    match value {
        // An object with a schema in place of values has the right fields, but no answer.
        Value::Object(fields) if fits(fields) && !fields.values().all(is_schema) => Some(fields.clone()),
        _ if depth == 0 => None,
        Value::Object(fields) => fields.values().rev().find_map(|inner| wanted_within(inner, fits, depth - 1)),
        Value::Array(values) => values.iter().rev().find_map(|inner| wanted_within(inner, fits, depth - 1)),
        Value::String(text) if text.contains('{') => {
            let objects = top_objects(text);
            objects.iter().rev().find_map(|object| wanted_within(&object.value, fits, depth - 1))
        }
        _ => None,
    }
}

fn is_schema(value: &Value) -> bool {
    value.get("type").is_some_and(Value::is_string) && value.get("name").is_none()
}

/// The value that a text begins with, mended if necessary.
pub(crate) fn mended_value(text: &str) -> Option<Value> {
    mend_json(text).map(|json| json.value)
}

/// Names of fields that hold an answer, and of those that hold what was thought about it.
const TEXT_FIELDS: [&str; 10] =
    ["instruction", "text", "answer", "response", "output", "direction", "content", "result", "caption", "message"];
const ASIDE_FIELDS: [&str; 8] = ["thought", "think", "reason", "note", "explanation", "style", "title", "confidence"];

/// The one text in a value: a string, the strings of a list one after the other, or the field that holds the answer.
/// `None` where several could.
pub(crate) fn text_in_value(value: &Value) -> Option<String> {
    text_within(value, MAX_WRAPPERS)
}

fn text_within(value: &Value, depth: usize) -> Option<String> {
    let is_prose = |text: &String| text.trim().contains(' ');
    match value {
        Value::String(text) => Some(text.clone()),
        _ if depth == 0 => None,
        Value::Array(values) => {
            let texts: Option<Vec<String>> = values.iter().map(|value| text_within(value, depth - 1)).collect();
            texts.filter(|texts| !texts.is_empty()).map(|texts| texts.join("\n"))
        }
        Value::Object(fields) => {
            let named = |names: &[&str], key: &String| names.iter().any(|name| key.to_lowercase().contains(name));
            let told = |(_, value): (&String, &Value)| text_within(value, depth - 1).filter(is_prose);
            let answer = TEXT_FIELDS.iter().find_map(|name| {
                fields.iter().filter(|(key, _)| named(&[name], key) && !named(&ASIDE_FIELDS, key)).find_map(told)
            });
            let mut others = fields.iter().filter(|(key, _)| !named(&ASIDE_FIELDS, key)).filter_map(told);
            answer.or_else(|| others.next().filter(|_| others.next().is_none()))
        }
        _ => None,
    }
}

/// The JSON value that a text begins with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JsonReading {
    pub(crate) value: Value,
    /// Whether the text breaks off within it. The value then has only the complete part.
    pub(crate) is_cut: bool,
    /// How long it is in the text, bytes.
    pub(crate) length: usize,
}

/// Reads the value that a text begins with, and mends it if it is broken.
pub(crate) fn mend_json(text: &str) -> Option<JsonReading> {
    let mut values = Deserializer::from_str(text).into_iter::<Value>();
    if let Some(Ok(value)) = values.next() {
        return Some(JsonReading { value, is_cut: false, length: values.byte_offset() });
    }
    let (mended, is_cut, length) = mend_text(text);
    let value = Deserializer::from_str(&mended).into_iter::<Value>().next()?.ok()?;
    Some(JsonReading { value, is_cut, length })
}

/// The state of a repair: the output so far, and the brackets that are open.
#[derive(Default)]
struct JsonMender {
    /// The repaired JSON so far.
    out: String,
    /// For each bracket that is open, the one that closes it; the innermost is last.
    open: Vec<char>,
    /// The length of `out` up to the last complete object or array, and `open` at that place.
    last_complete: Option<(usize, Vec<char>)>,
}

/// Deepest nesting of brackets, levels; the rest of a deeper text is cut off. JSON of the schema has four levels.
const MAX_BRACKET_DEPTH: usize = 32;

/// Repairs JSON: adds commas between values and removes those before closing brackets, leaves out comments, replaces the
/// words and quotes of other languages, and closes it where it breaks off. The flag is true if it breaks off; the number
/// is the length of what was read, bytes.
fn mend_text(text: &str) -> (String, bool, usize) {
    let mut mending = JsonMender::default();
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let taken = match next {
            '"' | '\'' | '“' => match read_string(rest, next) {
                Some((content, taken)) => {
                    mending.push_value(&Value::String(content).to_string());
                    taken
                }
                None => break,
            },
            '{' | '[' if mending.open.len() == MAX_BRACKET_DEPTH => break,
            '{' | '[' => {
                mending.push_value(&next.to_string());
                mending.open.push(if next == '{' { '}' } else { ']' });
                1
            }
            '}' | ']' => {
                mending.close_bracket(next);
                if mending.open.is_empty() {
                    return (mending.out, false, text.len() - rest.len() + 1);
                }
                1
            }
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '#' => rest.find('\n').unwrap_or(rest.len()),
            _ if next.is_ascii_alphabetic() => {
                let taken = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                mending.push_word(&rest[..taken]);
                taken
            }
            _ => {
                mending.out.push(if next.is_whitespace() { ' ' } else { next });
                next.len_utf8()
            }
        };
        rest = &rest[taken..];
    }
    let (mended, is_cut) = mending.finish_cut();
    (mended, is_cut, text.len())
}

impl JsonMender {
    /// Adds the beginning of a value, with a comma before it where one is missing.
    fn push_value(&mut self, value: &str) {
        if self.out.trim_end().ends_with(['"', '}', ']']) {
            self.out.push(',');
        }
        self.out.push_str(value);
    }

    /// Adds a word without quotes: a constant, a part of a number, or a string.
    fn push_word(&mut self, word: &str) {
        let is_exponent = word.eq_ignore_ascii_case("e") && self.out.ends_with(|c: char| c.is_ascii_digit());
        if is_exponent { self.out.push_str(word) } else { self.push_value(&json_word(word)) }
    }

    /// Closes the innermost bracket, if this is the one that closes it; any other is dropped.
    fn close_bracket(&mut self, bracket: char) {
        self.drop_trailing_comma();
        if self.open.last() == Some(&bracket) {
            self.open.pop();
            self.out.push(bracket);
            self.last_complete = Some((self.out.len(), self.open.clone()));
        }
    }

    /// Removes commas from the end of the output.
    fn drop_trailing_comma(&mut self) {
        let kept = self.out.trim_end().trim_end_matches(',').len();
        self.out.truncate(kept);
    }

    /// Cuts the output to its last complete part and closes the open brackets.
    fn finish_cut(mut self) -> (String, bool) {
        let Some((length, open)) = self.last_complete.take() else { return (String::new(), true) };
        self.out.truncate(length);
        self.out.extend(open.iter().rev());
        (self.out, true)
    }
}

/// The string at the beginning of a text, without its quotes, and its length with them. `None` if it is not closed.
fn read_string(text: &str, quote: char) -> Option<(String, usize)> {
    let end = if quote == '“' { '”' } else { quote };
    let mut content = String::new();
    let mut characters = text.char_indices().skip(1);
    while let Some((at, next)) = characters.next() {
        match next {
            '\\' => match characters.next()?.1 {
                'n' | 't' | 'r' => content.push(' '),
                // Other escapes only lose their backslash.
                other => content.push(other),
            },
            next if next == end && ends_string(&text[at + next.len_utf8()..]) => {
                return Some((content, at + next.len_utf8()));
            }
            next => content.push(next),
        }
    }
    None
}

/// Whether a quote ends its string, by what stands behind it. Models leave quotes within a string as they are.
fn ends_string(rest: &str) -> bool {
    let next = rest.trim_start_matches([' ', '\t', '\u{a0}']).chars().next();
    next.is_none_or(|next| ",:}]\"'“/#\n\r".contains(next))
}

/// The JSON for a word without quotes: a constant, or else a string.
fn json_word(word: &str) -> String {
    match word.to_ascii_lowercase().as_str() {
        "true" => "true".to_owned(),
        "false" => "false".to_owned(),
        "none" | "null" | "nan" | "undefined" => "null".to_owned(),
        _ => Value::String(word.to_owned()).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn found(reply: &str) -> Result<(Value, bool), String> {
        let fits = |fields: &Map<String, Value>| fields.contains_key("room") || fields.contains_key("things");
        find_object(reply, &fits).map(|found| (Value::Object(found.fields), found.is_cut))
    }

    #[test]
    fn an_object_is_found_in_every_form_that_models_give_it() {
        let wanted = json!({ "room": "hall", "things": [{ "name": "sofa", "sure": true }] });
        for reply in [
            r#"{"room": "hall", "things": [{"name": "sofa", "sure": true}]}"#,
            "Sure! Here it is:\n```json\n{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}\n```\nAnything else?",
            r#"{"room": "hall", "things": [{"name": "sofa", "sure": true,},],}"#,
            r#"{'room': 'hall', 'things': [{'name': 'sofa', 'sure': True}]}"#,
            "{“room”: “hall”, “things”: [{“name”: “sofa”, “sure”: true}]}",
            r#"{room: "hall", things: [{name: sofa, sure: true}]}"#,
            "{\"room\": \"hall\", // where one stands\n \"things\": [{\"name\": \"sofa\", \"sure\": true}]}",
            "{\"room\": \"hall\", /* where one stands */ \"things\": [{\"name\": \"sofa\", # grey\n \"sure\": true}]}",
            "{\"room\": \"hall\" \"things\": [{\"name\": \"sofa\" \"sure\": true}]}",
            r#"{"room": "kitchen"} Wait, that is wrong. {"room": "hall", "things": [{"name": "sofa", "sure": true}]}"#,
            r#"<think>Perhaps {"room": "kitchen"}.</think>{"room": "hall", "things": [{"name": "sofa", "sure": true}]}"#,
            r#"[THINK]{"room": "kitchen"}[/THINK]{"room": "hall", "things": [{"name": "sofa", "sure": true}]}</s>"#,
            r#"[{"room": "hall", "things": [{"name": "sofa", "sure": true}]}]"#,
            r#"{"view": {"room": "hall", "things": [{"name": "sofa", "sure": true}]}}"#,
            r#"{"name": "view", "arguments": {"room": "hall", "things": [{"name": "sofa", "sure": true}]}}"#,
            r#"{"answer": "{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}"}"#,
            r#"{"type": "object", "properties": {"room": {"type": "string"}}}{"room": "hall", "things": [{"name": "sofa", "sure": true}]}"#,
            r#"{"type": "object", "properties": {"room": "hall", "things": [{"name": "sofa", "sure": true}]}}"#,
            r#""room": "hall", "things": [{"name": "sofa", "sure": true}]"#,
            r#""{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}""#,
            r#"{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}"#,
            "{\"room\":\u{a0}\"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]\u{a0}}",
            "<|begin_of_box|>{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}<|end_of_box|>",
            "<answer>{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}",
            "{\"room\": \"hall\",\n\"things\": [\n{\"name\": \"sofa\", \"sure\": true}\n]\n}\n}",
        ] {
            assert_eq!(found(reply), Ok((wanted.clone(), false)), "{reply}");
        }
        assert_eq!(found(r#"{"type": "object", "properties": {"room": {"type": "string"}}}"#).ok(), None);
        let quoted = found(r#"{"room": "hall", "things": [{"name": "the "big" sofa", "far": NaN}]}"#);
        let value = json!({ "room": "hall", "things": [{ "name": "the \"big\" sofa", "far": null }] });
        assert_eq!(quoted, Ok((value, false)));
    }

    #[test]
    fn of_a_cut_object_the_complete_part_is_read() {
        let cut = r#"{"room": "hall", "things": [{"name": "sofa"}, {"name": "lamp"}, {"name": "tab"#;
        let value = json!({ "room": "hall", "things": [{ "name": "sofa" }, { "name": "lamp" }] });
        assert_eq!(found(cut), Ok((value, true)));
        assert!(found(r#"{"room": "ha"#).is_err());
    }

    #[test]
    fn no_reply_takes_long_or_panics() {
        for reply in ["", "I'm sorry, I can't help with that.", "{", "}{", "{'", "{\"a\": \\", "[[[[", "{“", "{\u{0}"]
        {
            assert!(found(reply).is_err(), "{reply}");
        }
        assert!(found(&"{\"a\":".repeat(60_000)).is_err());
        assert!(found(&format!("{{\"room\": \"{}\"}}", "x".repeat(2_000_000))).unwrap_err().contains("2000012 bytes"));
    }
}
