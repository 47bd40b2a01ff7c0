//! The words of a pack, and how a text is divided into them.

use super::chunks::{Chunk, ChunkSense, GlossWord};
use crate::data;
use std::collections::HashMap;

/// The words of a pack, each with what it may be.
#[derive(Debug)]
pub(super) struct PackWords {
    senses: HashMap<String, Vec<WordSense>>,
    longest_bytes: usize,
    /// Whether blanks part words, so that none ends within letters.
    is_spaced: bool,
}

/// One thing that a word may be.
#[derive(Debug, Clone, Copy)]
struct WordSense {
    class: &'static str,
    english: &'static str,
}

/// A word of a text that a pack knows, or that it does not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PackToken {
    /// Byte range in the text.
    pub(super) span: [usize; 2],
    /// The English words of its first sense; `None` for an unknown word.
    pub(super) english: Option<&'static str>,
}

/// The class of words without a meaning of their own.
const FILLER: &str = "filler";
/// The class of numbers.
const NUMBER: &str = "number";
/// The class of what no list has.
const UNKNOWN: &str = "unknown";
/// The English for an unknown word. The reader of English does not know it either.
const UNKNOWN_ENGLISH: &str = "unreadable";
/// Marks that every language has, with the English ones that they become, and their class.
const MARKS: [(&str, &str); 6] = [(",", ","), (";", ","), (":", ","), (".", "."), ("!", "."), ("?", ".")];
const MARK: &str = "mark";
/// Devanagari letters with a dot below, and the single letters that mean the same.
const DOTTED_LETTERS: [(&str, &str); 7] = [
    ("\u{915}\u{93C}", "\u{958}"),
    ("\u{916}\u{93C}", "\u{959}"),
    ("\u{917}\u{93C}", "\u{95A}"),
    ("\u{91C}\u{93C}", "\u{95B}"),
    ("\u{921}\u{93C}", "\u{95C}"),
    ("\u{922}\u{93C}", "\u{95D}"),
    ("\u{92B}\u{93C}", "\u{95E}"),
];

impl PackWords {
    /// Reads `words.txt`: a class, English words, and words of the language, with bars between. Blanks separate the words, or
    /// commas where words contain blanks.
    pub(super) fn parse(table: &'static str, is_spaced: bool) -> Self {
        let mark = |(mark, english): (&str, _)| (mark.to_owned(), vec![WordSense { class: MARK, english }]);
        let mut senses: HashMap<String, Vec<WordSense>> = MARKS.into_iter().map(mark).collect();
        for line in data::content_lines(table) {
            let [class, english, words] = data::row_columns(line);
            let english = if english == "-" { "" } else { english };
            let names = words.split(|c: char| if is_spaced { c == ',' } else { c.is_whitespace() });
            for name in names.map(str::trim).filter(|name| !name.is_empty()) {
                for spelling in spellings(name) {
                    senses.entry(spelling).or_default().push(WordSense { class, english });
                }
            }
        }
        let longest_bytes = senses.keys().map(String::len).max().unwrap_or(0);
        Self { senses, longest_bytes, is_spaced }
    }

    /// The words and marks of a text, each the longest that fits there, as chunks and as tokens. Words that say nothing are no chunks, and
    /// marks no tokens.
    pub(super) fn split_chunks(&self, text: &str) -> (Vec<Chunk>, Vec<PackToken>) {
        // Only ASCII, so that each byte keeps its place.
        let low = &text.to_ascii_lowercase();
        let (mut chunks, mut tokens) = (Vec::new(), Vec::new());
        let mut at = 0;
        while let Some(letter) = low[at..].chars().next() {
            let number_end = number_end(low, at);
            let found = self.longest_word(low, at).filter(|(end, _)| *end >= number_end);
            let end = found.map_or_else(|| self.unknown_end(low, at, letter).max(number_end), |(end, _)| end);
            let gloss = |english: &str| {
                let words = english.split_whitespace();
                words.map(|word| GlossWord { word: word.to_owned(), source: Some([at, end]) }).collect()
            };
            let senses: Vec<ChunkSense> = match found {
                Some((_, senses)) if senses.iter().all(|sense| sense.class == FILLER) => Vec::new(),
                Some((_, senses)) => {
                    senses.iter().map(|sense| ChunkSense { class: sense.class, words: gloss(sense.english) }).collect()
                }
                None if number_end > at => vec![ChunkSense { class: NUMBER, words: gloss(&low[at..end]) }],
                None if is_letter(letter) => vec![ChunkSense { class: UNKNOWN, words: gloss(UNKNOWN_ENGLISH) }],
                None => Vec::new(),
            };
            if !senses.is_empty() {
                chunks.push(Chunk { senses });
            }
            if is_letter(letter) {
                let english = match found {
                    Some((_, senses)) => senses.first().map(|sense| sense.english),
                    None => (number_end > at).then_some(NUMBER),
                };
                tokens.push(PackToken { span: [at, end], english });
            }
            at = end;
        }
        (chunks, tokens)
    }

    /// The end and the senses of the longest word that begins at a byte.
    fn longest_word(&self, text: &str, at: usize) -> Option<(usize, &[WordSense])> {
        let last = (at + self.longest_bytes).min(text.len());
        (at + 1..=last).rev().filter(|end| text.is_char_boundary(*end)).find_map(|end| {
            let senses = self.senses.get(&text[at..end])?;
            let is_within = self.is_spaced && text[at..end].ends_with(is_letter) && text[end..].starts_with(is_letter);
            (!is_within).then_some((end, senses.as_slice()))
        })
    }

    /// The end of an unknown word: a whole one where blanks part them, or one letter. Latin words are always whole.
    fn unknown_end(&self, text: &str, at: usize, letter: char) -> usize {
        let end = at + letter.len_utf8();
        let belongs = |c: char| is_letter(c) && (self.is_spaced || c.is_ascii());
        let more = if belongs(letter) { text[end..].find(|c| !belongs(c)).unwrap_or(text.len() - end) } else { 0 };
        end + more
    }
}

/// The end of the number in digits that begins at a byte; `at` where none does.
fn number_end(text: &str, at: usize) -> usize {
    let is_inner = |(index, c): &(usize, char)| {
        let is_point = || *c == '.' && *index > 0 && text[at + index + 1..].starts_with(|c: char| c.is_ascii_digit());
        c.is_ascii_digit() || is_point()
    };
    at + text[at..].char_indices().take_while(is_inner).count()
}

/// A word as people write it: with dots below as NFC has them, as single letters, and without them.
fn spellings(word: &str) -> Vec<String> {
    let mut all = vec![word.to_owned()];
    if DOTTED_LETTERS.iter().any(|(dotted, _)| word.contains(dotted)) {
        all.push(DOTTED_LETTERS.iter().fold(word.to_owned(), |word, (dotted, single)| word.replace(dotted, single)));
        all.push(word.replace('\u{93C}', ""));
    }
    all
}

/// Whether a character belongs to a word: letters, digits, and the vowel signs of Devanagari.
fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || ('\u{900}'..='\u{963}').contains(&c)
}
