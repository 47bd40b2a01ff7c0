//! Removes the chatter around a text that a model was asked for ("Sure! Here is ..."), and recognises refusals.

use wayword_language::{
    PhraseList, WordList,
    chatter::{AGREEING, ANNOUNCED, ANNOUNCING, PARTING, REFUSING, zh},
    text::split_words,
};

/// Most words of a sentence that announces a text; a longer one belongs to the text.
const MAX_ANNOUNCING_WORDS: usize = 24;
/// Most characters of words that announce a text in a language without blanks.
const MAX_ANNOUNCING_CHARACTERS: usize = 30;
/// How much of a sentence is examined, bytes. Its beginning is enough to classify it.
const MAX_EXAMINED_BYTES: usize = 300;

/// The text without code fences, announcing sentences before it, and remarks after it.
pub(crate) fn without_chatter(text: &str) -> &str {
    let text = without_fence(text);
    let sentences = split_sentences(text);
    let before = sentences.iter().take_while(|sentence| announces_text(sentence)).count();
    // A reply of chatter alone stays as it is: the caller recognises that it is unusable.
    let Some(first) = sentences.get(before) else { return text };
    let behind = sentences.iter().skip(before + 1).find(|sentence| is_parting_remark(sentence));
    let start = offset_of_part(text, first);
    let end = behind.map_or(text.len(), |sentence| offset_of_part(text, sentence));
    text[start..end].trim().trim_end_matches("---").trim()
}

/// Whether a reply is a refusal.
#[must_use]
pub fn is_refusal(text: &str) -> bool {
    let text = text.trim_start_matches(['"', '“', '*']);
    begins_with_phrase(&sentence_words(text), &REFUSING) || starts_with_any(text, &zh::REFUSING)
}

/// A text in a language without blanks, without a sentence before it that only agrees, and without the words up to its first colon that only
/// announce it.
pub(crate) fn without_foreign_chatter(text: &str) -> &str {
    let agreed =
        zh::AGREEING.iter().find_map(|word| text.strip_prefix(*word)?.strip_prefix(['！', '!', '。', '，', ',']));
    let text = agreed.map_or(text, str::trim);
    let Some((before, rest)) = text.split_once([':', '：']) else { return text };
    let announces =
        zh::ANNOUNCED.iter().any(|word| before.trim().ends_with(word)) || starts_with_any(before, &zh::AGREEING);
    if announces && before.chars().count() <= MAX_ANNOUNCING_CHARACTERS { rest.trim() } else { text }
}

fn starts_with_any(text: &str, starts: &WordList) -> bool {
    starts.iter().any(|start| text.starts_with(*start))
}

/// The content of the first code fence, without the name of its language.
fn without_fence(text: &str) -> &str {
    const CODE_FENCE: &str = "```";
    let Some((_, inside)) = text.split_once(CODE_FENCE) else { return text };
    let inside = inside.split(CODE_FENCE).next().unwrap_or(inside);
    let body = match inside.split_once('\n') {
        Some((tag, body)) if !tag.trim().contains(' ') => body,
        _ => inside,
    };
    if body.trim().is_empty() { text } else { body }
}

/// The sentences of a text: each ends at its mark, at a colon, or at the end of its line.
fn split_sentences(text: &str) -> Vec<&str> {
    let mut sentences = Vec::new();
    for line in text.lines() {
        let mut start = 0;
        let marks = line.char_indices().filter(|(_, c)| matches!(c, '.' | '!' | '?' | ':'));
        for (at, mark) in marks {
            let rest = &line[at + mark.len_utf8()..];
            let close = rest.len() - rest.trim_start_matches(['"', '”', '\'', '*', ')']).len();
            if rest[close..].is_empty() || rest[close..].starts_with(char::is_whitespace) {
                let end = at + mark.len_utf8() + close;
                sentences.push(&line[start..end]);
                start = end;
            }
        }
        sentences.push(&line[start..]);
    }
    sentences.into_iter().map(str::trim).filter(|sentence| sentence.contains(char::is_alphanumeric)).collect()
}

/// Where a part of a text begins in it.
fn offset_of_part(text: &str, part: &str) -> usize {
    part.as_ptr() as usize - text.as_ptr() as usize
}

/// Whether a sentence only announces a text.
fn announces_text(sentence: &str) -> bool {
    let words = sentence_words(sentence);
    let words: &[String] = match count_agreeing_words(&words) {
        0 => &words,
        all if all == words.len() => return true,
        some => &words[some..],
    };
    let names_text = words.iter().any(|word| ANNOUNCED.contains(&word.as_str()));
    let leads = sentence.trim_end_matches('*').ends_with(':');
    names_text && words.len() <= MAX_ANNOUNCING_WORDS && (leads || begins_with_phrase(words, &ANNOUNCING))
}

/// Whether a sentence after a text does not belong to it: a remark, or a count of its words.
fn is_parting_remark(sentence: &str) -> bool {
    let words = sentence_words(sentence);
    let counts = sentence.starts_with('(') && words.iter().any(|word| word == "words" || word == "note");
    counts || begins_with_phrase(&words, &PARTING)
}

/// Number of words at the beginning that only express agreement ("Sure", "Of course").
fn count_agreeing_words(words: &[String]) -> usize {
    let longest = |from: usize| {
        let fits = AGREEING.iter().filter(|phrase| words[from..].iter().take(phrase.len()).eq(phrase.iter()));
        fits.map(Vec::len).max().unwrap_or(0)
    };
    let first = longest(0);
    first + if first < words.len() && first > 0 { longest(first) } else { 0 }
}

/// Whether words begin with one of the phrases.
fn begins_with_phrase(words: &[String], phrases: &PhraseList) -> bool {
    phrases.iter().any(|phrase| words.len() >= phrase.len() && words.iter().zip(phrase.iter()).all(|(a, b)| a == b))
}

/// The words at the beginning of a sentence, with straight apostrophes.
fn sentence_words(sentence: &str) -> Vec<String> {
    split_words(&sentence[..sentence.floor_char_boundary(MAX_EXAMINED_BYTES)].replace('’', "'"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn without_chatter_removes_announcements_and_remarks() {
        for (told, wanted) in [
            ("Sure! Here is the instruction: Go to the sink.", "Go to the sink."),
            (
                "Certainly! Here's a concise instruction in the style of the reference texts:\n\nGo to the sink.",
                "Go to the sink.",
            ),
            ("Go to the sink.\n\nLet me know if you need anything else!", "Go to the sink."),
            ("Go to the sink. I hope this helps.", "Go to the sink."),
            ("Of course.\nGo to the sink and stop.", "Go to the sink and stop."),
            ("```text\nGo to the sink.\n```", "Go to the sink."),
            ("Here you go:\n```\nGo to the sink.\n```\nThis instruction has five words.", "Go to the sink."),
            ("Go to the sink.\n\n(4 words)", "Go to the sink."),
            ("Go to the sink.\n---\nNote: I used the sink as the landmark.", "Go to the sink."),
            ("Here is the revised instruction.\nWalk past the bed.", "Walk past the bed."),
            ("Walk 2.5 metres. Stop: the sink is there.", "Walk 2.5 metres. Stop: the sink is there."),
            ("Follow the directions on the sign.", "Follow the directions on the sign."),
            ("This is the room with a bed. Stop here.", "This is the room with a bed. Stop here."),
            ("Sure!", "Sure!"),
            ("", ""),
        ] {
            assert_eq!(without_chatter(told), wanted, "{told}");
        }
    }

    #[test]
    fn refusals_are_recognised_and_instructions_are_not() {
        for refusal in
            ["I'm sorry, but I can't help with that.", "I’m sorry, I cannot.", "As an AI, I do not see.", "Sorry!"]
        {
            assert!(is_refusal(refusal), "{refusal}");
        }
        for text in ["Go past the sorry-looking plant.", "Into the hall. I can't stress it enough.", "Stop."] {
            assert!(!is_refusal(text), "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_reply_is_taken(reply in "(\\PC|[\n`:.! ]|Sure|Note){0,300}") {
            prop_assert!(reply.contains(without_chatter(&reply)));
            let _ = is_refusal(&reply);
        }
    }
}
