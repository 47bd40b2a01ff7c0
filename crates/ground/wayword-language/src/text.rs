//! Splits texts into words, marks and sentences, with byte ranges.

use crate::reading::vocabulary as v;

/// A word or a punctuation mark of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextToken {
    /// Lower case.
    pub word: String,
    /// Byte range in the text.
    pub span: [usize; 2],
}

impl TextToken {
    /// Whether it is a word and not a mark.
    #[must_use]
    pub fn is_word(&self) -> bool {
        self.word.chars().next().is_some_and(char::is_alphanumeric)
    }

    /// Whether it ends a sentence.
    #[must_use]
    pub fn ends_sentence(&self) -> bool {
        matches!(self.word.as_str(), "." | "!" | "?")
    }
}

/// Abbreviations with a full stop that does not end a sentence.
const ABBREVIATIONS: [&str; 9] = ["approx", "appr", "ca", "vs", "mr", "mrs", "ms", "dr", "prof"];
/// Abbreviations that may also end a sentence. If they do, the next word has a capital, or the text ends.
const LAST_ABBREVIATIONS: [&str; 10] = ["etc", "ft", "yd", "yds", "cm", "deg", "incl", "excl", "max", "min"];

/// The words and marks of a text. An apostrophe within a word belongs to the word, and the point within a number to the
/// number. A full stop that does not end a sentence ("approx.", "e.g.", "J. Smith") is left out.
#[must_use]
pub fn split_tokens(text: &str) -> Vec<TextToken> {
    let mut tokens = Vec::new();
    let mut start = None;
    let mut chars = text.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        let next = chars.peek().map(|(_, next)| *next);
        // Whether the letter belongs to the word or number before it.
        let joins = match c {
            '\'' | '’' => next.is_some_and(char::is_alphanumeric),
            '.' => next.is_some_and(|next| next.is_ascii_digit()) && ends_in_digit(&text[..at]),
            _ => false,
        };
        if c.is_alphanumeric() || (start.is_some() && joins) {
            start.get_or_insert(at);
            continue;
        }
        let word = start.take().map(|from| [from, at]);
        if let Some(span) = word {
            tokens.push(TextToken { word: text[span[0]..at].to_lowercase(), span });
        }
        let is_stop = c != '.' || word.is_none_or(|word| is_full_stop(text, word));
        if !c.is_whitespace() && c != '-' && is_stop {
            tokens.push(TextToken { word: c.to_string(), span: [at, at + c.len_utf8()] });
        }
    }
    if let Some(from) = start {
        tokens.push(TextToken { word: text[from..].to_lowercase(), span: [from, text.len()] });
    }
    tokens
}

/// Whether the last letter of a text is a digit.
fn ends_in_digit(text: &str) -> bool {
    text.ends_with(|c: char| c.is_ascii_digit())
}

/// Whether the full stop right after a word ends a sentence, and not only an abbreviation.
fn is_full_stop(text: &str, [from, to]: [usize; 2]) -> bool {
    let word = &text[from..to];
    let behind = &text[to + 1..];
    let next = behind.trim_start();
    let goes_on = next.starts_with(char::is_lowercase) || next.starts_with(|c: char| c.is_ascii_digit() || c == ',');
    let is_in = |list: &[&str]| list.iter().any(|short| short.eq_ignore_ascii_case(word));
    let is_letter = word.chars().count() == 1 && word.starts_with(char::is_alphabetic);
    // "E.g.", "a.m.": letters with a full stop after each.
    let mut letters = behind.chars();
    let one_follows = letters.next().is_some_and(char::is_alphabetic) && letters.next() == Some('.');
    let in_a_row = one_follows || (text[..from].ends_with('.') && goes_on);
    let is_short = is_in(&ABBREVIATIONS) && !next.is_empty() || is_in(&LAST_ABBREVIATIONS) && goes_on;
    !(is_short || is_letter && (in_a_row || is_initial(word, next)))
}

/// Whether a letter is an initial: a name follows, and not the next sentence ("room B. Turn left").
fn is_initial(letter: &str, next: &str) -> bool {
    let name: String = next.chars().take_while(|c| c.is_alphanumeric()).collect();
    let begins_sentence = [&v::WALKING, &v::TURNING, &v::ADVERBS, &v::DETERMINERS, &v::BREAKERS, &v::FUNCTION]
        .iter()
        .any(|list| list.contains(&name.to_lowercase().as_str()));
    let is_capital = |text: &str| text.starts_with(char::is_uppercase);
    is_capital(letter) && is_capital(&name) && !begins_sentence
}

/// The words of a text, lower case, without marks.
#[must_use]
pub fn split_words(text: &str) -> Vec<String> {
    split_tokens(text).into_iter().filter(TextToken::is_word).map(|token| token.word).collect()
}

/// A text with its first letter as a capital.
#[must_use]
pub fn capitalise_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The byte ranges of the pieces between the blanks of a text.
pub fn split_blanks(text: &str) -> impl Iterator<Item = [usize; 2]> + '_ {
    let places = text.split_inclusive(char::is_whitespace).scan(0, |offset, piece| {
        let from = *offset;
        *offset += piece.len();
        Some([from, from + piece.trim_end().len()])
    });
    places.filter(|place| place[0] < place[1])
}

/// Number of words in a text, as people count them: parts between spaces, without lone marks.
#[must_use]
pub fn word_count(text: &str) -> usize {
    text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// Number of sentences: words up to a full stop, exclamation or question mark, or the end.
#[must_use]
pub fn sentence_count(text: &str) -> usize {
    count_sentences(&split_tokens(text))
}

/// As [`sentence_count`], of a text that was split before.
pub(crate) fn count_sentences(tokens: &[TextToken]) -> usize {
    tokens.split(TextToken::ends_sentence).filter(|sentence| sentence.iter().any(TextToken::is_word)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn pieces_are_the_ranges_between_blanks() {
        for text in ["", " ", "  turn left,\n\t門 🪑 ."] {
            let told: Vec<&str> = split_blanks(text).map(|[from, to]| &text[from..to]).collect();
            assert_eq!(told, text.split_whitespace().collect::<Vec<_>>());
        }
    }

    #[test]
    fn words_sentences_and_marks_are_counted() {
        let text = "Walk to the robot's den. Then turn left, and wait!";
        assert_eq!(word_count(text), 10);
        assert_eq!(sentence_count(text), 2);
        assert_eq!(split_words(text)[3], "robot's");
        assert_eq!(sentence_count("no stop at the end"), 1);
        assert_eq!(sentence_count(""), 0);
    }

    #[test]
    fn a_point_that_ends_no_sentence_is_no_full_stop() {
        for text in [
            "Walk 3.5 meters and stop.",
            "Walk approx. 3 meters and stop.",
            "Stop at a seat, e.g. the sofa.",
            "Stop at a seat (i.e., the sofa).",
            "Walk 10 ft. ahead",
            "Stop at the desk of J. Smith.",
            "Stop at the desk of J. R. Smith.",
            "Pass Dr. Smith's room, the lamp, etc. and stop",
        ] {
            assert_eq!(sentence_count(text), 1, "{text}");
        }
        for text in [
            "Go to level 2. Turn left.",
            "Go to room B. Turn left.",
            "Walk 10 ft. Turn left.",
            "Pass the lamp, the bed, etc. Turn left.",
            "walk to the sofa. turn left",
            "Walk to the sofa.Turn left.",
            "Go to level 2.Turn left.",
        ] {
            assert_eq!(sentence_count(text), 2, "{text}");
        }
        assert_eq!(split_words("Walk 3.5 meters"), ["walk", "3.5", "meters"]);
    }

    proptest! {
        #[test]
        fn spans_point_at_their_words(text in "\\PC{0,60}") {
            for token in split_tokens(&text) {
                prop_assert_eq!(text[token.span[0]..token.span[1]].to_lowercase(), token.word);
            }
        }
    }
}
