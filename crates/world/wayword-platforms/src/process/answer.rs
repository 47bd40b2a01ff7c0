//! Parses the lines that a child answers with.

use super::fault::ChildFault;
use serde::Deserialize;
use serde_json::Value;
use wayword_world::output_lines::to_safe_text;

/// Longest line of a child, bytes: an answer with a large picture in base64.
pub(crate) const MAX_LINE_BYTES: usize = 48 << 20;
/// Most commas and opening brackets in a line. Each can become a JSON value, which takes far more memory than its one
/// byte.
const MAX_VALUES: usize = 1_000_000;
/// Length of the part of a line that an error shows, characters.
const SHOWN_CHARS: usize = 80;

/// A child's answer to a request.
#[derive(Debug, PartialEq)]
pub(crate) struct ChildAnswer {
    pub(crate) id: u64,
    pub(crate) outcome: Result<Value, ChildRefusal>,
}

/// An error that the child sent.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct ChildRefusal {
    #[serde(default)]
    pub(crate) code: Option<String>,
    pub(crate) message: String,
}

/// An answer as it is written in JSON, before it is checked.
#[derive(Deserialize)]
struct AnswerMessage {
    id: u64,
    #[serde(default)]
    result: Option<Value>,
    #[serde(default)]
    error: Option<ChildRefusal>,
}

/// Parses an answer.
///
/// # Errors
/// If the line is not a JSON object with an id and either a result or an error.
pub(crate) fn parse_answer(line: &[u8]) -> Result<ChildAnswer, ChildFault> {
    let nonsense = |reason: String| ChildFault::Nonsense { reason, start: shown_start(line) };
    if line.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count() > MAX_VALUES {
        return Err(nonsense(format!("more than {MAX_VALUES} JSON values")));
    }
    let wire: AnswerMessage = serde_json::from_slice(line).map_err(|error| nonsense(error.to_string()))?;
    let outcome = match (wire.result, wire.error) {
        (Some(result), None) => Ok(result),
        (None, Some(refusal)) => Err(refusal),
        _ => return Err(nonsense("an answer must have either `result` or `error`".into())),
    };
    Ok(ChildAnswer { id: wire.id, outcome })
}

/// The beginning of a line, in a form that an error may show.
fn shown_start(line: &[u8]) -> String {
    let start = String::from_utf8_lossy(line.get(..4 * SHOWN_CHARS).unwrap_or(line));
    to_safe_text(&start, SHOWN_CHARS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;
    use std::io::Cursor;
    use wayword_world::output_lines::{OutputLine, read_line};

    #[test]
    fn an_answer_has_an_id_and_either_a_result_or_an_error() {
        let good = parse_answer(br#"{"id": 3, "result": {"scenes": []}, "more": 1}"#).unwrap();
        assert_eq!(good, ChildAnswer { id: 3, outcome: Ok(json!({"scenes": []})) });
        let refusal = parse_answer(br#"{"id": 3, "error": {"message": "no"}}"#).unwrap();
        assert_eq!(refusal.outcome.unwrap_err().message, "no");
        for bad in [
            &br#"{"id": 3}"#[..],
            br#"{"id": 3, "result": {}, "error": {"message": "no"}}"#,
            br#"{"id": -3, "result": {}}"#,
            br#"{"id": "3", "result": {}}"#,
            br#"{"result": {}}"#,
            br#"[3]"#,
            br#"{"id": 3, "result": {}} {"id": 4, "result": {}}"#,
            b"Loading textures...",
            b"",
            b"\xff\xfe",
        ] {
            assert!(matches!(parse_answer(bad), Err(ChildFault::Nonsense { .. })), "{bad:?} was accepted as an answer");
        }
    }

    #[test]
    fn a_line_of_too_many_values_is_not_even_parsed() {
        let mut line = br#"{"id":1,"result":["#.to_vec();
        line.extend(b"0,".repeat(MAX_VALUES));
        line.extend(b"0]}");
        let error = parse_answer(&line).unwrap_err().to_string();
        assert!(error.contains("JSON values"), "{error}");
    }

    #[test]
    fn errors_repeat_a_line_shortened_and_without_control_characters() {
        let error = parse_answer("\u{1b}[2J\u{7}".repeat(1000).as_bytes()).unwrap_err().to_string();
        assert!(error.len() < 300 && !error.contains(char::is_control), "{error}");
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_parser_panic(line in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse_answer(&line);
        }

        #[test]
        fn a_mutated_answer_is_read_as_an_answer_or_refused_with_a_short_reason(
            at in 0usize..60, byte in any::<u8>(), cut in 0usize..60,
        ) {
            let mut line = br#"{"id": 12, "result": {"viewpoints": [{"id": "a"}]}, "x": null}"#.to_vec();
            line[at] = byte;
            line.truncate(line.len() - cut);
            match parse_answer(&line) {
                Ok(answer) => prop_assert!(answer.outcome.is_ok(), "one byte cannot turn it into an error"),
                Err(fault) => prop_assert!(fault.to_string().chars().count() < 500 && !fault.leaves_child_usable()),
            }
        }

        #[test]
        fn an_answer_survives_writing_and_parsing(id in any::<u64>(), text in ".*") {
            let line = serde_json::to_vec(&json!({"id": id, "result": {"name": text}})).unwrap();
            let mut pipe = line.clone();
            pipe.push(b'\n');
            let OutputLine::Whole(read) = read_line(&mut Cursor::new(pipe), MAX_LINE_BYTES) else { panic!("half a line") };
            prop_assert_eq!(&read, &line);
            prop_assert_eq!(parse_answer(&read).unwrap(), ChildAnswer { id, outcome: Ok(json!({"name": text})) });
        }
    }
}
