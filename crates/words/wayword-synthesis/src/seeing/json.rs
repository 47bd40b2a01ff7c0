//! Finds the JSON in an answer, even with text around it, and repairs frequent mistakes of models: wrong quotes,
//! trailing commas, `True`, a missing end.

use serde_json::{Deserializer, Value};

/// Longest answer that is read, bytes; a longer one is an error. A full answer has about 2,000.
pub(super) const MAX_ANSWER_BYTES: usize = 32 * 1024;

/// The JSON of an answer.
#[derive(Debug, PartialEq)]
pub(super) struct AnswerJson {
    pub(super) value: Value,
    /// Whether the answer breaks off within the JSON. The value then has only the complete part.
    pub(super) is_cut: bool,
}

/// The first object in an answer. Of an array, this is its first element.
///
/// # Errors
/// When there is none, or the answer is too long; the message is meant for the model.
pub(super) fn find_json(answer: &str) -> Result<AnswerJson, String> {
    if answer.len() > MAX_ANSWER_BYTES {
        return Err(format!("it has {} bytes, more than {MAX_ANSWER_BYTES}", answer.len()));
    }
    let start = answer.find('{').ok_or("there is no JSON in it")?;
    let text = &answer[start..];
    if let Some(Ok(value)) = Deserializer::from_str(text).into_iter::<Value>().next() {
        return Ok(AnswerJson { value, is_cut: false });
    }
    let (mended, is_cut) = mend_json(text);
    match Deserializer::from_str(&mended).into_iter::<Value>().next() {
        Some(Ok(value)) => Ok(AnswerJson { value, is_cut }),
        Some(Err(error)) => Err(format!("it is no valid JSON ({error})")),
        None => Err("there is no JSON in it".to_owned()),
    }
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

/// Repairs JSON: removes commas before closing brackets, replaces the words and quotes of other languages, and closes
/// it where it breaks off. The flag is true if it breaks off.
fn mend_json(text: &str) -> (String, bool) {
    let mut mending = JsonMender::default();
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let taken = match next {
            '"' | '\'' | '“' => match read_string(rest, next) {
                Some((content, taken)) => {
                    mending.out.push_str(&Value::String(content).to_string());
                    taken
                }
                None => break,
            },
            '{' | '[' if mending.open.len() == MAX_BRACKET_DEPTH => break,
            '{' | '[' => {
                mending.open.push(if next == '{' { '}' } else { ']' });
                mending.out.push(next);
                1
            }
            '}' | ']' => {
                mending.close_bracket(next);
                if mending.open.is_empty() {
                    return (mending.out, false);
                }
                1
            }
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ if next.is_ascii_alphabetic() => {
                let taken = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                mending.out.push_str(&json_word(&rest[..taken]));
                taken
            }
            _ => {
                mending.out.push(next);
                next.len_utf8()
            }
        };
        rest = &rest[taken..];
    }
    mending.finish_cut()
}

impl JsonMender {
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
            next if next == end => return Some((content, at + next.len_utf8())),
            next => content.push(next),
        }
    }
    None
}

/// The JSON for a word without quotes: a constant, or else a string.
fn json_word(word: &str) -> String {
    match word.to_ascii_lowercase().as_str() {
        "true" => "true".to_owned(),
        "false" => "false".to_owned(),
        "none" | "null" | "nan" | "undefined" => "null".to_owned(),
        // The exponent of a number.
        "e" => "e".to_owned(),
        _ => Value::String(word.to_owned()).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn find_json_repairs_mistakes_and_skips_text_around_it() {
        let wanted = json!({ "room": "hall", "things": [{ "name": "sofa", "sure": true }] });
        for answer in [
            r#"{"room": "hall", "things": [{"name": "sofa", "sure": true}]}"#,
            "Sure! Here it is:\n```json\n{\"room\": \"hall\", \"things\": [{\"name\": \"sofa\", \"sure\": true}]}\n```\nAnything else?",
            r#"{"room": "hall", "things": [{"name": "sofa", "sure": true,},],}"#,
            r#"{'room': 'hall', 'things': [{'name': 'sofa', 'sure': True}]}"#,
            "{“room”: “hall”, “things”: [{“name”: “sofa”, “sure”: true}]}",
            r#"{room: "hall", things: [{name: sofa, sure: true}]}"#,
            "{\"room\": \"hall\", // where one stands\n \"things\": [{\"name\": \"sofa\", \"sure\": true}]}",
        ] {
            assert_eq!(find_json(answer), Ok(AnswerJson { value: wanted.clone(), is_cut: false }), "{answer}");
        }
    }

    #[test]
    fn find_json_returns_the_complete_part_of_a_cut_answer() {
        let cut = r#"{"room": "hall", "things": [{"name": "sofa"}, {"name": "lamp"}, {"name": "tab"#;
        let value = json!({ "room": "hall", "things": [{ "name": "sofa" }, { "name": "lamp" }] });
        assert_eq!(find_json(cut), Ok(AnswerJson { value, is_cut: true }));
        assert!(find_json(r#"{"room": "ha"#).is_err());
    }

    #[test]
    fn no_answer_takes_long_or_panics() {
        for answer in ["", "I'm sorry, I can't help with that.", "{", "}{", "{'", "{\"a\": \\", "[[[[", "{“", "{\u{0}"]
        {
            assert!(find_json(answer).is_err(), "{answer}");
        }
        assert!(find_json(&"{\"a\":".repeat(5_000)).is_err());
        assert!(
            find_json(&format!("{{\"room\": \"{}\"}}", "x".repeat(2_000_000))).unwrap_err().contains("2000012 bytes")
        );
    }
}
