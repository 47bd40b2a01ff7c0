//! Texts with words replaced by numbers, so that the scores compare numbers instead of strings.

use std::collections::HashMap;

/// The number of the empty word. In Python, `"".split(" ")` gives one empty word, so ROUGE-L sees it in a text without tokens.
const NOTHING: u32 = 0;

/// Longest n-grams that the scores count.
pub(super) const ORDERS: usize = 4;

/// Bits of a word's number. Four numbers and two bits for the length of the n-gram fit into 128 bits.
const BITS: u32 = 30;

/// Numbers of words.
#[derive(Debug, Clone, Default)]
pub struct Vocabulary {
    numbers: HashMap<String, u32>,
}

/// A text as the numbers of its tokens, with its n-grams counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// The words that BLEU, CIDEr-D and the figures of diversity count.
    words: Vec<u32>,
    /// The words that ROUGE-L counts; `None` where they are the same.
    pieces: Option<Vec<u32>>,
    grams: Vec<Gram>,
}

/// An n-gram and how often it occurs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gram {
    /// The length less one in the highest bits, then the words: the n-grams of one length lie together when sorted.
    pub(super) key: u128,
    pub(super) count: u32,
}

impl Gram {
    /// The length less one.
    pub(super) fn order(self) -> usize {
        order(self.key)
    }
}

/// The length of an n-gram, less one.
pub(super) fn order(key: u128) -> usize {
    (key >> (BITS * ORDERS as u32)) as usize
}

impl Vocabulary {
    /// The words by their numbers.
    #[must_use]
    pub fn words(&self) -> Vec<&str> {
        let mut words: Vec<(u32, &str)> = self.numbers.iter().map(|(word, number)| (*number, word.as_str())).collect();
        words.push((NOTHING, ""));
        words.sort_unstable();
        words.into_iter().map(|(_, word)| word).collect()
    }

    /// A text of tokens.
    ///
    /// The reference keeps tokens as one line and splits it again: ROUGE-L at blanks, the others at white space of
    /// any kind. A token with a no-break space (`1 1/2`) is therefore one piece and two words.
    pub fn text<S: AsRef<str>>(&mut self, tokens: &[S]) -> Text {
        let mut words = Vec::with_capacity(tokens.len());
        let mut pieces = Vec::with_capacity(tokens.len());
        for token in tokens {
            pieces.push(self.number(token.as_ref()));
            words.extend(token.as_ref().split_whitespace().map(|word| self.number(word)));
        }
        if pieces.is_empty() {
            pieces.push(NOTHING);
        }
        let grams = grams(&words);
        Text { pieces: (pieces != words).then_some(pieces), words, grams }
    }

    fn number(&mut self, word: &str) -> u32 {
        if let Some(number) = self.numbers.get(word) {
            return *number;
        }
        let number = self.numbers.len() as u32 + 1;
        self.numbers.insert(word.to_owned(), number);
        number
    }
}

impl Text {
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

    /// Its tokens with blanks between. `words` is what [`Vocabulary::words`] gives.
    #[must_use]
    pub fn line(&self, words: &[&str]) -> String {
        let of = |number: &u32| words.get(*number as usize).copied().unwrap_or_default();
        self.pieces().iter().map(of).collect::<Vec<_>>().join(" ")
    }

    pub(super) fn words(&self) -> &[u32] {
        &self.words
    }

    pub(super) fn pieces(&self) -> &[u32] {
        self.pieces.as_ref().unwrap_or(&self.words)
    }

    /// Its n-grams, sorted by their keys.
    pub(super) fn grams(&self) -> &[Gram] {
        &self.grams
    }
}

fn grams(words: &[u32]) -> Vec<Gram> {
    let of_order = |order: usize| {
        let key = move |window: &[u32]| window.iter().fold(order as u128, |key, word| key << BITS | u128::from(*word));
        let place = BITS * (ORDERS - 1 - order) as u32;
        words.windows(order + 1).map(move |window| key(window) << place)
    };
    let mut keys: Vec<u128> = (0..ORDERS).flat_map(of_order).collect();
    keys.sort_unstable();
    keys.chunk_by(|a, b| a == b).map(|same| Gram { key: same[0], count: same.len() as u32 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_grams_are_counted_by_their_length() {
        let text = Vocabulary::default().text(&["a", "b", "a", "b"]);
        let counts: Vec<(usize, u32)> = text.grams().iter().map(|gram| (gram.order(), gram.count)).collect();
        assert_eq!(counts, [(0, 2), (0, 2), (1, 2), (1, 1), (2, 1), (2, 1), (3, 1)]);
    }

    #[test]
    fn a_no_break_space_separates_words_but_not_pieces() {
        let text = Vocabulary::default().text(&["the", "1\u{a0}1/2"]);
        assert_eq!((text.words().len(), text.pieces().len()), (3, 2));
    }

    #[test]
    fn a_text_is_the_line_of_its_tokens() {
        let mut vocabulary = Vocabulary::default();
        let texts = [vocabulary.text(&["turn", "left"]), vocabulary.text(&["left", "1\u{a0}1/2"])];
        assert_eq!(texts.map(|text| text.line(&vocabulary.words())), ["turn left", "left 1\u{a0}1/2"]);
    }

    #[test]
    fn a_text_without_tokens_is_one_piece() {
        let empty = Vocabulary::default().text::<&str>(&[]);
        assert!(empty.is_empty() && empty.grams().is_empty());
        assert_eq!(empty.pieces(), [NOTHING]);
    }
}
