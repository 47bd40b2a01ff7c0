//! Takes the one text that a model was asked for out of its reply.

use crate::{
    MAX_REPLY_BYTES,
    chatter::{without_chatter, without_foreign_chatter},
    json::{mended_value, text_in_value},
    markdown::{join_lines, without_inline_marks},
    marks::next_mark,
    thinking::without_thinking,
    without_template_marks,
};
use wayword_core::{FinishReason, ModelReply};
use wayword_language::{
    languages::ReadableText,
    text::{split_tokens, split_words},
};

/// How many wrappings around each other are taken off.
const MAX_WRAPPINGS: usize = 6;

/// Names of tags around an answer. Of several such tags the last one counts.
const ANSWER_TAGS: [&str; 12] = [
    "answer",
    "final",
    "final_answer",
    "response",
    "output",
    "result",
    "instruction",
    "instructions",
    "text",
    "caption",
    "solution",
    "directions",
];

/// Signs that no text for people has. A text that still has one after all wrappings are off is asked for again.
const FOREIGN_SIGNS: [char; 11] = ['<', '>', '|', '{', '}', '[', ']', '\\', '`', '*', '#'];

/// The one text in a reply, on one line: without thinking, marks, wrappings, chatter, `labels` ("instruction:"), quotes
/// and emphasis; a text that is said twice once, and of several texts to choose from the first.
///
/// # Errors
/// When something is left that belongs to no text, the text is not English, or the reply is too long. The words are for the model, which is
/// asked again.
pub fn read_text(reply: &str, labels: &[&str]) -> Result<String, String> {
    let text = plain_text(reply, labels)?;
    if text.chars().any(|c| c.is_alphabetic() && c > '\u{24F}') {
        return Err("it is not in English: write it in English alone".to_owned());
    }
    Ok(text)
}

/// Least letters of a Latin word that is taken for English in a text of another language; "TV" is written so everywhere.
const MIN_ENGLISH_LETTERS: usize = 3;

/// The one text in a reply, as [`read_text`] takes it out, for a text in another language than English, of this name.
///
/// # Errors
/// When something is left that belongs to no text, the text is not in that language or has English words, or the reply is too long.
pub fn read_text_in(language: &str, reply: &str, labels: &[&str]) -> Result<String, String> {
    let text = without_foreign_chatter(&plain_text(reply, labels)?).to_owned();
    if ReadableText::new(&text, None).glossed_language() != Some(language) {
        return Err(format!("it is not in {language}: write it in {language} alone"));
    }
    let mut words = text.split(|c: char| !c.is_ascii_alphabetic());
    if let Some(word) = words.find(|word| word.len() >= MIN_ENGLISH_LETTERS) {
        return Err(format!("it has the word {word:?}: write every name in {language}"));
    }
    Ok(text)
}

/// The one text in a reply, in whatever language.
fn plain_text(reply: &str, labels: &[&str]) -> Result<String, String> {
    if reply.len() > MAX_REPLY_BYTES {
        return Err(format!("it has {} bytes, more than {MAX_REPLY_BYTES}", reply.len()));
    }
    let mut text = without_template_marks(&without_thinking(reply));
    for _ in 0..MAX_WRAPPINGS {
        match unwrapped(&text) {
            Some(inner) => text = inner,
            None => break,
        }
    }
    let text = first_of_options(&text, labels);
    let text = text.replace("**", "").replace("__", "");
    let joined = join_lines(without_chatter(&text));
    let joined = without_inline_marks(&joined);
    let text = without_repeats(without_label_and_quotes(&joined, labels)).to_owned();
    if let Some(sign) = text.chars().find(|c| FOREIGN_SIGNS.contains(c)) {
        return Err(format!("it has the sign {sign:?}: write the text alone, without marks or formatting"));
    }
    Ok(text)
}

/// The words of a reply without thinking and marks. Of a reply that was cut off: up to the end of its last sentence, or
/// all of it where no sentence ended.
#[must_use]
pub fn read_sentences(reply: &ModelReply) -> String {
    let text = without_template_marks(&without_thinking(&reply.text));
    let text = text.trim();
    if reply.finish == FinishReason::Stop {
        return text.to_owned();
    }
    // The dot of "2.5 metres" ends no sentence.
    let ends = |(at, _): &(usize, &str)| text[at + 1..].chars().next().is_none_or(|next| !next.is_alphanumeric());
    text.rmatch_indices(['.', '!', '?']).find(ends).map_or(text, |(end, _)| &text[..=end]).to_owned()
}

/// The text within the outermost wrapping; `None` where there is none.
fn unwrapped(text: &str) -> Option<String> {
    let trimmed = text.trim();
    let inner = in_answer_tag(trimmed)
        .or_else(|| in_boxed(trimmed))
        .or_else(|| in_fence(trimmed))
        .or_else(|| in_json(trimmed))
        .or_else(|| in_quotes(trimmed))?;
    (inner.contains(char::is_alphanumeric) && inner.len() < text.len()).then_some(inner)
}

/// The content of the last tag that is named after an answer, or of a tag around the whole text.
fn in_answer_tag(text: &str) -> Option<String> {
    let (mut at, mut open, mut found) = (0, None, None);
    while let Some(mark) = next_mark(text, at) {
        at = mark.span.end;
        let is_answer = ANSWER_TAGS.contains(&mark.name.as_str());
        let wraps_all = mark.span.start == 0 && !mark.has_bars;
        match (&open, mark.closes) {
            (None, false) if is_answer || wraps_all => open = Some(mark),
            (Some(opened), true) if opened.name == mark.name => {
                let content = &text[opened.span.end..mark.span.start];
                let is_whole = is_answer || mark.span.end == text.len();
                found = (is_whole && content.contains(char::is_alphanumeric)).then(|| content.to_owned()).or(found);
                open = None;
            }
            // The opening tag may be a part of the prompt.
            (None, true) if is_answer && found.is_none() => found = Some(text[..mark.span.start].to_owned()),
            _ => {}
        }
    }
    // A tag that is never closed: all behind it.
    let rest =
        || open.filter(|mark| ANSWER_TAGS.contains(&mark.name.as_str())).map(|mark| text[mark.span.end..].to_owned());
    found.or_else(rest)
}

/// The content of `\boxed{...}`, and of `\text{...}` within it.
fn in_boxed(text: &str) -> Option<String> {
    let begin = ["\\boxed{", "\\text{", "\\fbox{"].into_iter().find_map(|mark| Some(text.rfind(mark)? + mark.len()))?;
    let end = text[begin..].rfind('}').map_or(text.len(), |end| begin + end);
    Some(text[begin..end].to_owned())
}

/// The content of the first code fence, without the name of its language.
fn in_fence(text: &str) -> Option<String> {
    const CODE_FENCE: &str = "```";
    let (_, inside) = text.split_once(CODE_FENCE)?;
    let inside = inside.split(CODE_FENCE).next().unwrap_or(inside);
    let body = match inside.split_once('\n') {
        Some((tag, body)) if !tag.trim().contains(' ') => body,
        _ => inside,
    };
    Some(body.to_owned()).filter(|body| !body.trim().is_empty())
}

/// The text in a reply that is JSON: an object with one text, a list of texts, or a text in quotes.
fn in_json(text: &str) -> Option<String> {
    let begin = text.find(['{', '['])?;
    // JSON behind a text is no wrapping of it.
    let is_led = text[..begin].trim().is_empty() || text[..begin].trim_end().ends_with(':');
    is_led.then(|| text_in_value(&mended_value(&text[begin..])?)).flatten()
}

/// The content of a text in quotes that is written as a string of a program, with escapes.
fn in_quotes(text: &str) -> Option<String> {
    let is_string = text.starts_with('"') && text.ends_with('"') && text.contains('\\');
    let value: serde_json::Value = is_string.then(|| serde_json::from_str(text).ok()).flatten()?;
    value.as_str().map(str::to_owned)
}

/// Words that number the texts to choose from.
const OPTION_WORDS: [&str; 6] = ["option", "version", "variant", "alternative", "candidate", "attempt"];
/// Longest line that is a heading of an option, bytes.
const MAX_OPTION_HEADING_BYTES: usize = 60;

/// The first of several texts to choose from, or the text between two rules (`---`).
fn first_of_options(text: &str, labels: &[&str]) -> String {
    let is_heading = |line: &str| option_heading(line, labels).is_some();
    if text.lines().filter(|line| is_heading(line)).count() >= 2 {
        let mut lines = text.lines().skip_while(|line| !is_heading(line));
        let first = lines.next().and_then(|line| option_heading(line, labels)).unwrap_or_default();
        let behind = lines.take_while(|line| !is_heading(line));
        return [first].into_iter().chain(behind).collect::<Vec<_>>().join("\n");
    }
    let is_rule = |line: &&str| line.trim().len() >= 3 && line.trim().chars().all(|c| "-–—*=_".contains(c));
    let lines: Vec<&str> = text.lines().collect();
    let parts = lines.split(|line| is_rule(line)).map(|part| part.join("\n"));
    let whole = |part: &String| split_words(without_chatter(part)).len() >= MIN_TEXT_WORDS;
    parts.into_iter().find(whole).unwrap_or_else(|| text.to_owned())
}

/// A part between two rules with fewer words is a heading.
const MIN_TEXT_WORDS: usize = 4;

/// What stands behind the heading of an option ("Option 1: ..."); `None` where a line has none.
fn option_heading<'a>(line: &'a str, labels: &[&str]) -> Option<&'a str> {
    let bare = line.trim_start_matches(|c: char| c.is_whitespace() || "*#-(_".contains(c));
    let names = OPTION_WORDS.iter().chain(labels);
    let name =
        names.into_iter().find(|name| bare.get(..name.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(name)))?;
    let rest = bare[name.len()..].trim_start();
    let number = rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(rest.len());
    let is_number =
        (1..=2).contains(&number) && rest[..number].chars().any(|c| c.is_ascii_digit() || c.is_ascii_uppercase());
    let behind = rest[number..].trim_start_matches(|c: char| "*)_ ".contains(c));
    let text = behind.strip_prefix([':', '.', '-', '–']).or_else(|| behind.is_empty().then_some(behind));
    // A heading may have words of its own before its colon: "Option 1 (short):".
    let described = || {
        Some(behind.split_once(':')?).filter(|(head, _)| head.len() <= MAX_OPTION_HEADING_BYTES).map(|(_, text)| text)
    };
    is_number.then(|| text.or_else(described)).flatten().map(|text| text.trim_start_matches(['*', ' ', '_']))
}

/// A text without the labels before it and the quotes around it.
fn without_label_and_quotes<'a>(text: &'a str, labels: &[&str]) -> &'a str {
    let mut rest = text.trim();
    for label in labels {
        let starts = rest.get(..label.len()).is_some_and(|start| start.eq_ignore_ascii_case(label));
        if let Some(after) =
            rest.get(label.len()..).filter(|_| starts).and_then(|after| after.strip_prefix([':', '：']))
        {
            rest = after.trim();
        }
    }
    for (open, close) in [('"', '"'), ('“', '”'), ('\'', '\''), ('«', '»'), ('„', '“')] {
        let inner = rest.strip_prefix(open).and_then(|inner| inner.strip_suffix(close));
        rest = inner.filter(|inner| !inner.contains(open)).map_or(rest, str::trim);
    }
    rest
}

/// Most times that a text is looked for in a row.
const MAX_REPEATS: usize = 6;

/// A text once that is said several times in a row, word for word.
#[must_use]
pub fn without_repeats(text: &str) -> &str {
    let words: Vec<_> = split_tokens(text).into_iter().filter(wayword_language::text::TextToken::is_word).collect();
    let length = (2..=MAX_REPEATS).rev().filter(|times| words.len() % times == 0).map(|times| words.len() / times);
    let is_period = |length: &usize| {
        *length >= MIN_TEXT_WORDS && words.iter().zip(&words[*length..]).all(|(first, again)| first.word == again.word)
    };
    let Some(length) = length.into_iter().find(is_period) else { return text };
    let (last, next) = (&words[length - 1], &words[length]);
    // What ends the text belongs to it: its full stop, but no sign that begins it again.
    let between = &text[last.span[1]..next.span[0]];
    let end = between.find(['.', '!', '?']).map_or(0, |at| at + 1);
    &text[..last.span[1] + end]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "Go past the table. Stop at the sink.";
    const LABELS: [&str; 2] = ["instruction", "caption"];

    #[test]
    fn one_text_is_read_from_every_wrapping() {
        for reply in [
            TEXT,
            "<answer>Go past the table. Stop at the sink.</answer>",
            "<think>A table.</think><answer>Go past the table. Stop at the sink.</answer>",
            "Draft: <answer>Go on.</answer> Better: <answer>Go past the table. Stop at the sink.</answer>",
            "<answer>Go past the table. Stop at the sink.",
            "Go past the table. Stop at the sink.</answer>",
            "<p>Go past the table. Stop at the sink.</p>",
            "{\"instruction\": \"Go past the table. Stop at the sink.\"}",
            "{\"thought\": \"It goes past a table and then on.\", \"text\": \"Go past the table. Stop at the sink.\"}",
            "Here is the instruction: {\"instruction\": \"Go past the table. Stop at the sink.\"}",
            "```json\n{\"instruction\": \"Go past the table. Stop at the sink.\"}\n```",
            "{\"result\": {\"instruction\": \"Go past the table. Stop at the sink.\"}}",
            "{\"steps\": [\"Go past the table.\", \"Stop at the sink.\"]}",
            "[\"Go past the table. Stop at the sink.\"]",
            "['Go past the table. Stop at the sink.']",
            "{'instruction': 'Go past the table. Stop at the sink.'}",
            "{\"instruction\": \"Go past the table. Stop at the sink.\"",
            "\"Go past the table.\\nStop at the sink.\"",
            "\"{\\\"instruction\\\": \\\"Go past the table. Stop at the sink.\\\"}\"",
            "\\boxed{Go past the table. Stop at the sink.}",
            "$\\boxed{\\text{Go past the table. Stop at the sink.}}$",
            "> *Go past the table. Stop at the sink.*",
            "> Go past the table.\n> Stop at the sink.",
            "_Go past the table. Stop at the sink._",
            "**Instruction:** \"Go past the\n table. Stop at the sink.\"",
            "# Instruction\n\nGo past the table. Stop at the sink.",
            "### Final Answer\nGo past the table. Stop at the sink.",
            "- Go past the table.\n- Stop at the sink.",
            "1. Go past the table.\n2. Stop at the sink.",
            "1) Go past the table\n2) Stop at the sink",
            "Step 1: Go past the table.\nStep 2: Stop at the sink.",
            "Option 1: Go past the table. Stop at the sink.\n\nOption 2: Go on.",
            "**Option 1 (short):** Go past the table. Stop at the sink.\n**Option 2 (long):** Go on and on.",
            "Instruction A:\nGo past the table. Stop at the sink.\nInstruction B:\nGo on.",
            "Go past the table. Stop at the sink.\n\n---\n\nGo past the table. Stop at the sink.",
            "Go past the table. Stop at the sink. Go past the table. Stop at the sink.",
            "Go past the table. Stop at the sink.\n\n[Word count: 8]",
            "Go past the table. Stop at the sink.\n\n(8 words)",
            "Sure! Here it is:\n\nGo past the table. Stop at the sink.\n\nLet me know if it fits.",
            "Go past the table.<br>Stop at the sink.",
            "Go past the table.\\nStop at the sink.",
            "Go past the `table`. Stop at the sink.",
            "Go past the [table](#table). Stop at the sink.",
            "Go past the table&#46; Stop at the sink.",
            "“Go past the table. Stop at the sink.”",
            "🚶 Go past the table. Stop at the sink. ✅",
            "ASSISTANT: Go past the table. Stop at the sink.</s>",
        ] {
            assert_eq!(read_text(reply, &LABELS).as_deref(), Ok(TEXT), "{reply}");
        }
        assert_eq!(read_text("instruction", &LABELS).as_deref(), Ok("instruction"));
        assert_eq!(read_text("\"Go\" and \"stop\"", &LABELS).as_deref(), Ok("\"Go\" and \"stop\""));
        assert_eq!(read_text("", &LABELS).as_deref(), Ok(""));
    }

    #[test]
    fn what_cannot_be_cleaned_is_asked_for_again() {
        for (reply, reason) in [
            ("Go to <place>. Stop.", "sign '<'"),
            ("| step | what |\n|---|---|\n| 1 | go on |", "sign '|'"),
            ("Go past the 沙发 and stop.", "not in English"),
            ("经过沙发，停在走廊里。", "not in English"),
            ("Go to [LANDMARK] and stop.", "sign '['"),
        ] {
            assert!(
                read_text(reply, &LABELS).is_err_and(|why| why.contains(reason)),
                "{reply}: {:?}",
                read_text(reply, &LABELS)
            );
        }
    }

    #[test]
    fn a_sentence_that_was_cut_off_is_left_out() {
        for (finish, told, wanted) in [
            (FinishReason::Length, "A bed. A lamp and a", "A bed."),
            (FinishReason::Length, "A lamp and a", "A lamp and a"),
            (FinishReason::Length, "A bed. A rug 2.5 metres", "A bed."),
            (FinishReason::Length, "He said \"go!\" and", "He said \"go!"),
            (FinishReason::Stop, "A bed. A lamp and a rug</s>", "A bed. A lamp and a rug"),
            (FinishReason::Stop, " A rug 2.5 metres wide ", "A rug 2.5 metres wide"),
        ] {
            assert_eq!(read_sentences(&ModelReply { text: told.to_owned(), finish, usage: None }), wanted);
        }
    }

    proptest! {
        #[test]
        fn any_reply_is_read(reply in "(\\PC|[\n`:.!{}\\[\\]\"<>/ ]|Option 1:|<answer>|\\\\boxed|---){0,200}") {
            if let Ok(text) = read_text(&reply, &LABELS) {
                prop_assert!(!text.contains(FOREIGN_SIGNS));
            }
        }

        #[test]
        fn a_text_that_is_said_twice_is_read_once(words in "[a-z]{2,6}( [a-z]{2,6}){4,9}") {
            let once = without_repeats(&words).to_owned();
            let twice = format!("{words}. {words}.");
            prop_assert_eq!(without_repeats(&twice), format!("{once}."));
        }
    }
}
