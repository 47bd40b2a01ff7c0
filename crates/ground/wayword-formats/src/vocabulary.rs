//! Turns words into the numbers that VLN-CE's agents read.

use std::collections::BTreeMap;

/// The number of tokens of a text that VLN-CE's agents read. Shorter texts are filled up with `<pad>`, longer ones cut.
const TOKENS_PER_TEXT: usize = 200;
/// The token that fills up a short text.
const PAD: &str = "<pad>";
/// The token of a word that the vocabulary lacks.
const UNKNOWN: &str = "<unk>";

/// VLN-CE's `instruction_vocab`: a word's token is its place in the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TokenVocabulary {
    words: Vec<String>,
    index: BTreeMap<String, u64>,
    /// For each text of the file that was read, its tokens there.
    tokens_as_read: BTreeMap<String, Vec<u64>>,
}

impl TokenVocabulary {
    /// A vocabulary from its word list. Where a word is listed twice, the later place counts, as in Habitat's
    /// `VocabDict`. `<pad>` and `<unk>` are added at the end where the list lacks them.
    #[must_use]
    pub fn new(mut words: Vec<String>) -> Self {
        for special in [PAD, UNKNOWN] {
            if !words.iter().any(|word| word == special) {
                words.push(special.to_owned());
            }
        }
        let index = (0..).zip(&words).map(|(place, word)| (word.clone(), place)).collect();
        Self { words, index, tokens_as_read: BTreeMap::new() }
    }

    /// The vocabulary of some texts: `<pad>`, `<unk>`, then every word, sorted.
    #[must_use]
    pub fn from_texts<'t>(texts: impl IntoIterator<Item = &'t str>) -> Self {
        let words: std::collections::BTreeSet<_> = texts.into_iter().flat_map(split_words).collect();
        Self::new([PAD.to_owned(), UNKNOWN.to_owned()].into_iter().chain(words).collect())
    }

    /// Its words; each word's index is its token.
    #[must_use]
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// A text's 200 tokens, in lower case. A token is a word of letters and digits (with inner `'` and `-`), or a
    /// punctuation mark other than commas and question marks, which are left out. Everything after the 200th token is
    /// cut. A text keeps the tokens that were read with this vocabulary.
    #[must_use]
    pub fn tokens_of(&self, text: &str) -> Vec<u64> {
        if let Some(tokens) = self.tokens_as_read.get(text) {
            return tokens.clone();
        }
        let number = |word: &str| self.index.get(word).copied();
        let unknown = number(UNKNOWN).unwrap_or_default();
        let mut tokens: Vec<_> =
            split_words(text).take(TOKENS_PER_TEXT).map(|word| number(&word).unwrap_or(unknown)).collect();
        tokens.resize(TOKENS_PER_TEXT, number(PAD).unwrap_or_default());
        tokens
    }

    pub(crate) fn remember_tokens(&mut self, tokens_as_read: BTreeMap<String, Vec<u64>>) {
        self.tokens_as_read = tokens_as_read;
    }
}

/// The words of a text, in its order.
fn split_words(text: &str) -> impl Iterator<Item = String> {
    let mut words = Vec::new();
    let mut word = String::new();
    for letter in text.chars().flat_map(char::to_lowercase) {
        if letter.is_alphanumeric() || (!word.is_empty() && matches!(letter, '\'' | '-')) {
            word.push(letter);
            continue;
        }
        words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        if !letter.is_whitespace() && !matches!(letter, ',' | '?') {
            words.push(letter.to_string());
        }
    }
    words.extend((!word.is_empty()).then_some(word));
    words.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_numbered_by_their_place() {
        let vocabulary = TokenVocabulary::from_texts(["Turn left, then stop.", "Stop"]);
        assert_eq!(vocabulary.words(), ["<pad>", "<unk>", ".", "left", "stop", "then", "turn"]);
        let tokens = vocabulary.tokens_of("turn RIGHT, stop.");
        assert_eq!(tokens[..5], [6, 1, 4, 2, 0]);
        assert_eq!(tokens.len(), 200);
    }

    #[test]
    fn an_existing_vocabulary_keeps_its_numbers() {
        let words = ["<pad>", "<unk>", "walk", "stop"].map(str::to_owned).to_vec();
        assert_eq!(TokenVocabulary::new(words.clone()).words(), words);
        assert_eq!(TokenVocabulary::new(words).tokens_of("stop walk")[..3], [3, 2, 0]);
    }

    #[test]
    fn hyphens_and_apostrophes_stay_within_words() {
        assert_eq!(
            split_words("Don't enter the half-bath; -wait").collect::<Vec<_>>(),
            ["don't", "enter", "the", "half-bath", ";", "-", "wait"]
        );
    }
}
