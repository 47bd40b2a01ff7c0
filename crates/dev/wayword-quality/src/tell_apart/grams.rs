//! Turns a text into features: which runs of one to three words it has, and its length.

use super::logistic::SparseRow;
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::captions::{character_tokens, stands_alone};

/// The longest run of words that is a feature.
const MAX_GRAM_WORDS: usize = 3;
/// A run of words is a feature only if at least this many texts have it.
const MIN_GRAM_TEXTS: usize = 2;
/// The unit of the length feature, words.
const LENGTH_UNIT_WORDS: f64 = 20.0;

/// A text in lower case, with letters and digits of ASCII alone, and one space between words. Each Chinese or Japanese character is a word.
pub(super) fn to_plain(text: &str) -> String {
    let tokens = character_tokens(&text.to_lowercase());
    let is_character = |token: &str| token.chars().all(|c| c.is_alphanumeric() && stands_alone(c));
    let kept = |c: char| if c.is_ascii_alphanumeric() { c } else { ' ' };
    let plain = |token: &String| match is_character(token) {
        true => token.clone(),
        false => token.chars().map(kept).collect(),
    };
    let words = tokens.iter().map(plain).collect::<Vec<String>>().join(" ");
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The runs of words of a plain text.
pub(super) fn word_grams(plain: &str) -> BTreeSet<String> {
    let words: Vec<&str> = plain.split(' ').filter(|word| !word.is_empty()).collect();
    (1..=MAX_GRAM_WORDS).flat_map(|length| words.windows(length).map(|run| run.join(" ")).collect::<Vec<_>>()).collect()
}

/// The features that some texts have: their runs of words, a length, and a constant.
pub(super) struct GramFeatures {
    /// The place of each run of words in a row of features.
    places: BTreeMap<String, usize>,
}

impl GramFeatures {
    /// The features of texts, each given by its runs of words.
    pub(super) fn from_texts<'a>(texts: impl Iterator<Item = &'a BTreeSet<String>>) -> Self {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        texts.flatten().for_each(|gram| *counts.entry(gram).or_default() += 1);
        let frequent = counts.into_iter().filter(|(_, count)| *count >= MIN_GRAM_TEXTS);
        Self { places: frequent.enumerate().map(|(at, (gram, _))| (gram.to_owned(), at)).collect() }
    }

    /// The number of features, with the length and the constant.
    pub(super) fn len(&self) -> usize {
        self.places.len() + 2
    }

    /// The runs of words, each with its place.
    pub(super) fn gram_places(&self) -> impl Iterator<Item = (&str, usize)> {
        self.places.iter().map(|(gram, at)| (gram.as_str(), *at))
    }

    /// The row of a text.
    pub(super) fn feature_row(&self, plain: &str, grams: &BTreeSet<String>) -> SparseRow {
        let words = plain.split_whitespace().count() as f64;
        let known = grams.iter().filter_map(|gram| Some((*self.places.get(gram)?, 1.0)));
        known.chain([(self.places.len(), words / LENGTH_UNIT_WORDS), (self.places.len() + 1, 1.0)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_marks_and_white_space_are_no_features() {
        assert_eq!(to_plain(" Walk\tto the\nTV-stand,  it's lit. "), "walk to the tv stand it s lit");
        assert_eq!(to_plain("走出TV房，左转。 È caffè 2"), "走 出 tv 房 左 转 caff 2");
    }

    #[test]
    fn runs_of_up_to_three_words_are_features_where_two_texts_have_them() {
        let texts = ["go to the door", "go to it"].map(word_grams);
        assert!(texts[0].contains("to the door") && !texts[0].contains("go to the door"));
        let features = GramFeatures::from_texts(texts.iter());
        let names: Vec<&str> = features.gram_places().map(|(gram, _)| gram).collect();
        assert_eq!(names, ["go", "go to", "to"]);
        assert_eq!(features.feature_row("to it", &word_grams("to it")), [(2, 1.0), (3, 0.1), (4, 1.0)]);
    }
}
