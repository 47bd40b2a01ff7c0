//! Reads a model's reply to the request to split an instruction.

use super::{MAX_PHRASES, MAX_READ_BYTES, SplitInstruction, first_bytes, shorten_phrase};

/// Names of the closing line.
const CLOSING_LINE_NAMES: [&str; 3] = ["task", "activity", "action"];
/// Words that models write in an empty line or list.
const EMPTY_LINE_WORDS: [&str; 5] = ["none", "(none)", "n/a", "nothing", "-"];

/// Reads a reply: numbered or bulleted lines, then "TASK: ...". Code fences, quotes, emphasis and chatter around are passed over.
///
/// # Errors
/// Describes the missing part in words.
pub(super) fn read_directions(reply: &str) -> Result<SplitInstruction, &'static str> {
    let mut phrases: Vec<String> = Vec::new();
    let mut awaits_task = false;
    for line in first_bytes(reply, MAX_READ_BYTES).lines() {
        let (listed, text) = strip_bullet(line);
        let (is_closing, text) = closing_text(text).map_or((false, text), |task| (true, task));
        let text = strip_marks(text);
        let is_empty =
            !text.contains(char::is_alphanumeric) || EMPTY_LINE_WORDS.contains(&text.to_lowercase().as_str());
        if is_closing || awaits_task {
            if !is_empty {
                return Ok(SplitInstruction { phrases, activity: shorten_phrase(text) });
            }
            awaits_task = true;
        } else if listed && !is_empty && phrases.len() < MAX_PHRASES {
            phrases.push(shorten_phrase(text));
        }
    }
    Err(if awaits_task { "its \"TASK:\" line is empty" } else { "it wrote no line that begins with \"TASK:\"" })
}

/// A line without its number or bullet, and whether it had one.
fn strip_bullet(line: &str) -> (bool, &str) {
    let line = line.trim();
    let numbered = || {
        let line = line.trim_start_matches(['(', '*', '_']);
        let rest = line.trim_start_matches(|c: char| c.is_ascii_digit());
        (rest.len() < line.len()).then(|| rest.strip_prefix(['.', ')', ':', '-'])).flatten()
    };
    // A star with a space after it is a bullet, two are emphasis.
    let bulleted = || ["- ", "* ", "• ", "– ", "+ "].iter().find_map(|bullet| line.strip_prefix(bullet));
    numbered().or_else(bulleted).map_or((false, line), |rest| (true, rest))
}

/// The text after the name of the closing line; `None` for other lines.
fn closing_text(text: &str) -> Option<&str> {
    let text = text.trim_start_matches(['*', '_', '"', '#', ' ']);
    let name = CLOSING_LINE_NAMES
        .iter()
        .find(|name| text.get(..name.len()).is_some_and(|start| start.eq_ignore_ascii_case(name)))?;
    let rest = text[name.len()..].trim_start_matches(['*', '_', '"', ' ']);
    rest.strip_prefix([':', '-', '–', '—', '='])
}

/// A phrase without quotes and emphasis around it.
fn strip_marks(text: &str) -> &str {
    text.trim_matches(|c: char| c.is_whitespace() || matches!(c, '"' | '“' | '”' | '\'' | '*' | '_' | '`'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(reply: &str) -> (Vec<String>, String) {
        let directions = read_directions(reply).unwrap();
        (directions.phrases, directions.activity)
    }

    #[test]
    fn replies_are_read_however_they_are_dressed() {
        let wanted = (vec!["past the sofa".to_owned(), "up the stairs".to_owned()], "wipe the sink".to_owned());
        for reply in [
            "1. past the sofa\n2. up the stairs\nTASK: wipe the sink",
            "Here you are:\n```\n1) \"past the sofa\"\n2) “up the stairs”\nTask - 'wipe the sink'\n```\nAnything else?",
            "- past the sofa\n- up the stairs\n\n**TASK:** wipe the sink",
            "* past the sofa\n* up the stairs\n* **Task**: wipe the sink",
            "**1.** past the sofa\n**2.** up the stairs\n3. TASK: wipe the sink",
            "PHRASES:\r\n(1) past the sofa\r\n(2) up the stairs\r\nTASK:\r\nwipe the sink\r\n",
            "• past the sofa\n• up the stairs\n• none\nActivity: wipe the sink",
        ] {
            assert_eq!(read(reply), wanted, "{reply}");
        }
        assert_eq!(read("TASK: wipe the sink").0, Vec::<String>::new());
        assert_eq!(read("1. the 2 sofas\n2. task lamp\nTASK: wait").0, ["the 2 sofas", "task lamp"]);
    }

    #[test]
    fn a_reply_without_a_task_is_refused_with_the_reason() {
        assert!(read_directions("I cannot help with that.").unwrap_err().contains("no line"));
        assert!(read_directions("1. the sofa\nTASK:\n\n").unwrap_err().contains("empty"));
    }

    #[test]
    fn a_long_reply_stays_small() {
        let task = format!("{}TASK: {}", "1. the sofa\n".repeat(100), "x".repeat(100_000));
        let (phrases, activity) = read(&task);
        assert!(phrases.len() == MAX_PHRASES && activity.len() <= super::super::MAX_PHRASE_BYTES);
    }

    proptest! {
        #[test]
        fn any_reply_gives_something_or_a_reason(reply in "((1\\.|-|TASK|:|```|\\*|ß|sofa|\"|none|\n) ?){0,30}|\\PC{0,60}") {
            if let Ok(read) = read_directions(&reply) {
                prop_assert!(!read.activity.is_empty() && read.phrases.iter().all(|phrase| !phrase.is_empty()));
            }
        }
    }
}
