//! Texts with words replaced by numbers, so that the scores compare numbers instead of strings.

use std::collections::HashMap;

/// The number of the empty word. In Python, `"".split(" ")` gives one empty word, so ROUGE-L sees it in a text without tokens.
const EMPTY_WORD_NUMBER: u32 = 0;

/// The scores count n-grams (runs of n words) of 1 to this many words.
pub(super) const GRAM_ORDER_COUNT: usize = 4;

/// Bits of a word's number. Four numbers and two bits for the length of the n-gram fit into 128 bits.
const WORD_NUMBER_BITS: u32 = 30;

/// Gives each distinct word a number, from 1.
#[derive(Debug, Clone, Default)]
pub struct CaptionVocabulary {
    numbers: HashMap<String, u32>,
}

/// A text as the numbers of its tokens, with its n-grams counted.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberedText {
    /// The words that BLEU, CIDEr-D and the figures of diversity count.
    words: Vec<u32>,
    /// The words that ROUGE-L counts, which are split at blanks only; `None` where they are the same.
    pieces: Option<Vec<u32>>,
    /// The n-grams of `words`, sorted by their keys.
    grams: Vec<CountedGram>,
}

/// An n-gram and how often it occurs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CountedGram {
    /// The length less one in the highest bits, then the words: the n-grams of one length lie together when sorted.
    pub(super) key: u128,
    /// How often the n-gram occurs in the text.
    pub(super) count: u32,
}

impl CountedGram {
    /// The length less one.
    pub(super) fn order(self) -> usize {
        gram_order(self.key)
    }
}

/// The length of an n-gram, less one.
pub(super) fn gram_order(key: u128) -> usize {
    (key >> (WORD_NUMBER_BITS * GRAM_ORDER_COUNT as u32)) as usize
}

impl CaptionVocabulary {
    /// The words by their numbers.
    #[must_use]
    pub fn words_by_number(&self) -> Vec<&str> {
        let mut words: Vec<(u32, &str)> = self.numbers.iter().map(|(word, number)| (*number, word.as_str())).collect();
        words.push((EMPTY_WORD_NUMBER, ""));
        words.sort_unstable();
        words.into_iter().map(|(_, word)| word).collect()
    }

    /// Numbers the tokens of a text. Words that are new get the next numbers.
    ///
    /// The reference keeps tokens as one line and splits it again: ROUGE-L at blanks, the others at white space of
    /// any kind. A token with a no-break space (`1 1/2`) is therefore one piece and two words.
    pub fn number_text<S: AsRef<str>>(&mut self, tokens: &[S]) -> NumberedText {
        let mut words = Vec::with_capacity(tokens.len());
        let mut pieces = Vec::with_capacity(tokens.len());
        for token in tokens {
            pieces.push(self.word_number(token.as_ref()));
            words.extend(token.as_ref().split_whitespace().map(|word| self.word_number(word)));
        }
        if pieces.is_empty() {
            pieces.push(EMPTY_WORD_NUMBER);
        }
        let grams = count_grams(&words);
        NumberedText { pieces: (pieces != words).then_some(pieces), words, grams }
    }

    fn word_number(&mut self, word: &str) -> u32 {
        if let Some(number) = self.numbers.get(word) {
            return *number;
        }
        let number = self.numbers.len() as u32 + 1;
        self.numbers.insert(word.to_owned(), number);
        number
    }
}

impl NumberedText {
    /// How many words it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether it has no words.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Its tokens with blanks between. `words` is what [`CaptionVocabulary::words_by_number`] gives.
    #[must_use]
    pub fn to_line(&self, words: &[&str]) -> String {
        let word = |number: &u32| words.get(*number as usize).copied().unwrap_or_default();
        self.pieces().iter().map(word).collect::<Vec<_>>().join(" ")
    }

    pub(super) fn words(&self) -> &[u32] {
        &self.words
    }

    pub(super) fn pieces(&self) -> &[u32] {
        self.pieces.as_ref().unwrap_or(&self.words)
    }

    /// Its n-grams, sorted by their keys.
    pub(super) fn grams(&self) -> &[CountedGram] {
        &self.grams
    }
}

/// The n-grams of all lengths with their counts, sorted by their keys.
fn count_grams(words: &[u32]) -> Vec<CountedGram> {
    let keys_of_order = |order: usize| {
        let key = move |window: &[u32]| {
            window.iter().fold(order as u128, |key, word| key << WORD_NUMBER_BITS | u128::from(*word))
        };
        let shift = WORD_NUMBER_BITS * (GRAM_ORDER_COUNT - 1 - order) as u32;
        words.windows(order + 1).map(move |window| key(window) << shift)
    };
    let mut keys: Vec<u128> = (0..GRAM_ORDER_COUNT).flat_map(keys_of_order).collect();
    keys.sort_unstable();
    keys.chunk_by(|a, b| a == b).map(|same| CountedGram { key: same[0], count: same.len() as u32 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_grams_are_counted_by_their_length() {
        let text = CaptionVocabulary::default().number_text(&["a", "b", "a", "b"]);
        let counts: Vec<(usize, u32)> = text.grams().iter().map(|gram| (gram.order(), gram.count)).collect();
        assert_eq!(counts, [(0, 2), (0, 2), (1, 2), (1, 1), (2, 1), (2, 1), (3, 1)]);
    }

    #[test]
    fn a_no_break_space_separates_words_but_not_pieces() {
        let text = CaptionVocabulary::default().number_text(&["the", "1\u{a0}1/2"]);
        assert_eq!((text.words().len(), text.pieces().len()), (3, 2));
    }

    #[test]
    fn a_text_is_the_line_of_its_tokens() {
        let mut vocabulary = CaptionVocabulary::default();
        let texts = [vocabulary.number_text(&["turn", "left"]), vocabulary.number_text(&["left", "1\u{a0}1/2"])];
        assert_eq!(texts.map(|text| text.to_line(&vocabulary.words_by_number())), ["turn left", "left 1\u{a0}1/2"]);
    }

    #[test]
    fn a_text_without_tokens_is_one_piece() {
        let empty = CaptionVocabulary::default().number_text::<&str>(&[]);
        assert!(empty.is_empty() && empty.grams().is_empty());
        assert_eq!(empty.pieces(), [EMPTY_WORD_NUMBER]);
    }
}
