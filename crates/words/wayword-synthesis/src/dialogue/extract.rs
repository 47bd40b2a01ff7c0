//! Takes the one question or the one answer that was asked for out of a model's reply.

use wayword_language::{answers::ASKING, text::split_words};

/// Longest question, characters. A longer text is no question.
const MAX_QUESTION_CHARS: usize = 300;
/// Longest answer, characters; a longer one ends with its last whole sentence.
const MAX_ANSWER_CHARS: usize = 1200;
/// Longest part of a reply that is examined, bytes; the rest is ignored.
const MAX_REPLY_BYTES: usize = 16_384;
/// Labels that models put before a question.
const QUESTION_LABELS: [&str; 4] = ["question:", "q:", "next question:", "new question:"];
/// Marks that begin another turn within an answer, wherever they are.
const TURN_MARKS: [&str; 5] = ["question:", "user:", "### ", "<|", "</s>"];
/// Marks that begin another turn only after a whole sentence, because "the short answer: no" is one answer.
const TURN_MARKS_AFTER_SENTENCE: [&str; 5] = ["q:", "a:", "answer:", "human:", "assistant:"];

/// The one question in a reply, without labels, quotes, chatter, further questions or an invented answer. `None` if
/// there is no question, or it is longer than the limit.
pub(super) fn extract_question(reply: &str) -> Option<String> {
    let reply = first_bytes(reply, MAX_REPLY_BYTES);
    let label_end = QUESTION_LABELS
        .iter()
        .filter_map(|label| label_positions(reply, label).last().map(|at| at + label.len()))
        .max();
    let rest = &reply[label_end.unwrap_or(0)..];
    let answer_start =
        ["answer:", "a:"].iter().filter_map(|label| label_positions(rest, label).find(|at| *at > 0)).min();
    let rest = rest[..answer_start.unwrap_or(rest.len())].trim();
    let asked = match rest.find(['?', '？']) {
        Some(mark) => last_sentence(&rest[..=mark + rest[mark..].chars().next().map_or(0, char::len_utf8) - 1]),
        None => rest.lines().find(|line| begins_as_question(line))?,
    };
    let bare = asked.trim().trim_matches(|c: char| matches!(c, '"' | '“' | '”' | '*' | '_' | '`') || c.is_whitespace());
    let bare = bare.trim_start_matches(['\'', '-', '‘', '(']).trim_start();
    let fits = bare.chars().count() <= MAX_QUESTION_CHARS && bare.contains(char::is_alphanumeric);
    fits.then(|| bare.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// The answer in a reply, without a repetition of the question before it and invented turns after it, cut to the length
/// limit.
pub(super) fn extract_answer(reply: &str, question: &str) -> String {
    let reply = without_lead(first_bytes(reply, MAX_REPLY_BYTES).trim(), question);
    let is_behind_sentence = |at: &usize| {
        let before = reply[..*at].trim_end_matches([' ', '*', '"']);
        before.is_empty() || before.ends_with(['.', '!', '?', '\n'])
    };
    let marked_turns = TURN_MARKS.iter().filter_map(|label| label_positions(reply, label).find(|at| *at > 0));
    let turns_after_sentence = TURN_MARKS_AFTER_SENTENCE
        .iter()
        .filter_map(|label| label_positions(reply, label).filter(is_behind_sentence).find(|at| *at > 0));
    let cut = marked_turns.chain(turns_after_sentence).min();
    bounded_answer(reply[..cut.unwrap_or(reply.len())].trim()).to_owned()
}

/// The beginning of a text, at most so many bytes and cut between characters.
fn first_bytes(text: &str, bytes: usize) -> &str {
    &text[..text.floor_char_boundary(bytes)]
}

/// The positions of a label, in upper or lower case, at the start of a line or after a space.
fn label_positions<'a>(text: &'a str, label: &'a str) -> impl Iterator<Item = usize> + 'a {
    text.char_indices().map(|(at, _)| at).filter(move |at| {
        let is_label = text.get(*at..at + label.len()).is_some_and(|here| here.eq_ignore_ascii_case(label));
        is_label
            && text[..*at]
                .chars()
                .next_back()
                .is_none_or(|before| before.is_whitespace() || matches!(before, '*' | '.' | '?' | '"'))
    })
}

/// The last sentence of a text that ends in a question mark.
fn last_sentence(text: &str) -> &str {
    let mut ends = text.char_indices().filter(|(at, c)| {
        let next_is_space = text[at + c.len_utf8()..].starts_with(|next: char| next.is_whitespace() || next == '"');
        *c == '\n' || (matches!(c, '.' | '!' | ':') && next_is_space)
    });
    ends.next_back().map_or(text, |(at, c)| &text[at + c.len_utf8()..])
}

/// Whether a line begins with a word that asks, as "Which room is this" without its mark.
fn begins_as_question(line: &str) -> bool {
    split_words(first_bytes(line, 200)).first().is_some_and(|first| ASKING.contains(&first.as_str()))
}

/// The reply without "Answer:" and the question itself before the answer.
fn without_lead<'a>(reply: &'a str, question: &str) -> &'a str {
    let strip = |text: &'a str, lead: &str| -> &'a str {
        let starts = text.get(..lead.len()).is_some_and(|start| start.eq_ignore_ascii_case(lead));
        let rest = if starts && !lead.is_empty() { text[lead.len()..].trim_start() } else { text };
        if rest.is_empty() { text } else { rest }
    };
    let mut rest = reply;
    for lead in ["Question:", question, "Answer:", "A:"] {
        rest = strip(rest, lead);
    }
    rest
}

/// The answer, if it is within the limit; otherwise its whole sentences within the limit.
fn bounded_answer(text: &str) -> &str {
    let Some((end, _)) = text.char_indices().nth(MAX_ANSWER_CHARS) else { return text };
    let whole = &text[..end];
    whole.rfind(['.', '!', '?']).map_or(whole, |at| &whole[..=at]).trim()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn one_question_is_taken_from_a_reply() {
        for (reply, wanted) in [
            ("What colour is the sofa?", "What colour is the sofa?"),
            ("Question: What colour is the sofa? Answer: It is red.", "What colour is the sofa?"),
            ("Sure! Here is a question: What is on the left?", "What is on the left?"),
            ("\"Is there a lamp?\"", "Is there a lamp?"),
            ("Q: Is there a bed? Q: Is there a lamp? ", "Is there a lamp?"),
            ("Is there a bed? Is there a lamp?", "Is there a bed?"),
            ("Great. Let me ask more. Are there\nany windows?", "any windows?"),
            ("**Question:** Is there a window?", "Is there a window?"),
            ("Which room is this\n", "Which room is this"),
            ("Describe the left side.", "Describe the left side."),
            ("QUESTION: what is that?\nANSWER: a bed", "what is that?"),
            ("- Is there a door?", "Is there a door?"),
        ] {
            assert_eq!(extract_question(reply).as_deref(), Some(wanted), "{reply}");
        }
    }

    #[test]
    fn chatter_silence_and_endless_questions_are_no_question() {
        let long = format!("Is there a {}?", "very ".repeat(80));
        for reply in ["", "   ", "?", "I have no more questions.", "Thank you!", "🤖", long.as_str()] {
            assert_eq!(extract_question(reply), None, "{reply}");
        }
    }

    #[test]
    fn answers_are_cut_where_they_invent_another_turn() {
        let asked = "What colour is the sofa?";
        for (reply, wanted) in [
            ("It is red.", "It is red."),
            ("It is red. Question: What is on it? Answer: A cat.", "It is red."),
            ("It is red.\nQ: Is there a lamp?", "It is red."),
            ("Red\nUser: and the lamp?", "Red"),
            ("Answer: It is red.", "It is red."),
            ("What colour is the sofa? It is red.", "It is red."),
            ("What colour is the sofa?", "What colour is the sofa?"),
            ("Question: What colour is the sofa? Answer: red", "red"),
            ("It is a TV: a large one", "It is a TV: a large one"),
            ("The short answer: red", "The short answer: red"),
            ("red question: what is on it answer: a cat", "red"),
            ("It is red. A: it is red", "It is red."),
            ("", ""),
        ] {
            assert_eq!(extract_answer(reply, asked), wanted, "{reply}");
        }
    }

    #[test]
    fn a_long_answer_ends_with_a_sentence() {
        let long = "There is a chair and a long table. ".repeat(100);
        let kept = extract_answer(&long, "?");
        assert!(kept.len() <= MAX_ANSWER_CHARS && kept.ends_with("table."), "{kept}");
    }

    proptest! {
        #[test]
        fn any_reply_is_bounded(reply in "(\\PC|[\n:?Qq. ]){0,400}", asked in "\\PC{0,40}") {
            prop_assert!(extract_answer(&reply.repeat(8), &asked).chars().count() <= MAX_ANSWER_CHARS);
            prop_assert!(extract_question(&reply).is_none_or(|question| question.chars().count() <= MAX_QUESTION_CHARS));
        }
    }
}
