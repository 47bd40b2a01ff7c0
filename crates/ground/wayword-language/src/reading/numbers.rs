//! Finds the numbers before a place: which one of several it is ("the second door"), and how many there are ("two
//! chairs").

use super::{PlaceOrdinal, tokens::TokenSlice, vocabulary as v};
use wayword_core::Side;

/// How far before a noun phrase its number may be, words.
const NUMBER_REACH_WORDS: usize = 5;

/// The number words of a text right before nouns.
pub(super) struct PlaceNumbers<'a> {
    tokens: TokenSlice<'a>,
    /// For each token, where the run of adjectives and numbers before it begins.
    runs: Vec<usize>,
    /// For each token, whether it belongs to a turn or a storey.
    in_other_event: Vec<bool>,
}

impl<'a> PlaceNumbers<'a> {
    /// `spans` are the byte ranges of turns and storeys. Sides and numbers within them belong to those, and not to
    /// places.
    pub(super) fn from_tokens(tokens: TokenSlice<'a>, spans: &[[usize; 2]]) -> Self {
        let mut others = vec![false; tokens.len()];
        for span in spans {
            others[tokens.first_from(span[0])..tokens.first_from(span[1])].fill(true);
        }
        let is_number_or_adjective = |word: &str| {
            v::ADJECTIVES.contains(&word) || cardinal_number(word).is_some() || ordinal_word(word).is_some()
        };
        Self { tokens, runs: tokens.runs_before(is_number_or_adjective), in_other_event: others }
    }

    /// The adjectives and numbers before a token, the nearest first.
    fn words_before(&self, from: usize) -> impl Iterator<Item = usize> {
        (self.runs[from]..from).rev().take(NUMBER_REACH_WORDS).filter(|at| !self.in_other_event[*at])
    }

    /// "The second door", "the last two chairs": which one the noun phrase that begins at a token means.
    pub(super) fn ordinal_before(&self, from: usize) -> Option<PlaceOrdinal> {
        self.words_before(from).find_map(|at| ordinal_word(self.tokens.word_at(at)))
    }

    /// "Two chairs", "a pair of doors", "both of the doors": how many.
    pub(super) fn count_before(&self, from: usize) -> Option<u32> {
        let counted = |from: usize| self.words_before(from).find_map(|at| cardinal_number(self.tokens.word_at(at)));
        counted(from).or_else(|| {
            // In "a pair of the doors" the word before "of" counts.
            let before = self.runs[from].checked_sub(1)?;
            let is_article = v::DETERMINERS.contains(&self.tokens.word_at(before));
            let before = if is_article { before.checked_sub(1)? } else { before };
            let counting = before.checked_sub(1).filter(|_| self.tokens.word_at(before) == "of")?;
            match self.tokens.word_at(counting) {
                "pair" | "couple" => Some(2),
                "trio" => Some(3),
                "set" => None,
                "sets" | "pairs" | "flights" | "rows" => counted(counting),
                word => cardinal_number(word),
            }
        })
    }
}

/// The number that a word counts, from 2 on: "one door" only means a door.
#[must_use]
pub fn cardinal_number(word: &str) -> Option<u32> {
    match word {
        "both" | "two" => Some(2),
        "three" => Some(3),
        "four" => Some(4),
        "five" => Some(5),
        "six" => Some(6),
        "seven" => Some(7),
        "eight" => Some(8),
        "nine" => Some(9),
        "ten" => Some(10),
        "twelve" => Some(12),
        _ => word.parse().ok().filter(|number| (2..100).contains(number)),
    }
}

/// Whether a word is a number of any size: "500", "2.5", "twenty", "a".
pub(super) fn is_number(word: &str) -> bool {
    const OTHER_NUMBER_WORDS: [&str; 17] = [
        "a", "one", "an", "eleven", "fifteen", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "ninety",
        "eighty", "hundred", "thousand", "half", "several",
    ];
    cardinal_number(word).is_some()
        || OTHER_NUMBER_WORDS.contains(&word)
        || word.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Which one of several a word means.
#[must_use]
pub fn ordinal_word(word: &str) -> Option<PlaceOrdinal> {
    match word {
        "last" | "final" => Some(PlaceOrdinal::Last),
        "next" => Some(PlaceOrdinal::Next),
        "left" | "leftmost" => Some(PlaceOrdinal::Side(Side::Left)),
        "right" | "rightmost" => Some(PlaceOrdinal::Side(Side::Right)),
        "ground" | "bottom" => None,
        _ if cardinal_number(word).is_some() || matches!(word, "1" | "one") => None,
        _ => v::floor_number(word).filter(|number| *number < 100).map(PlaceOrdinal::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::places::first;

    #[test]
    fn which_one_of_several_is_kept() {
        for (text, which) in [
            ("take the second door on the left", Some(PlaceOrdinal::Number(2))),
            ("enter the 3rd bedroom", Some(PlaceOrdinal::Number(3))),
            ("go through the first white bedroom door", Some(PlaceOrdinal::Number(1))),
            ("stop at the last two chairs", Some(PlaceOrdinal::Last)),
            ("enter the next room on your left, the kitchen", None),
            ("go through the next doorway", Some(PlaceOrdinal::Next)),
            ("turn left and take the door", None),
            ("take the left door", Some(PlaceOrdinal::Side(Side::Left))),
            ("stop at the rightmost chair", Some(PlaceOrdinal::Side(Side::Right))),
            ("turn left hallway", None),
            ("pass the door on the left", None),
            ("stop at the two chairs", None),
            ("stop on the second floor by the chair", None),
        ] {
            assert_eq!(first(text).ordinal, which, "{text}");
        }
    }

    #[test]
    fn how_many_there_are_is_kept() {
        for (text, count, several) in [
            ("stop between the two chairs", Some(2), true),
            ("pass both white chairs", Some(2), true),
            ("walk past a pair of lamps", Some(2), true),
            ("pass 3 of the lamps", Some(3), true),
            ("pass the first two lamps", Some(2), true),
            ("pass couches", None, true),
            ("pass several lamps", None, true),
            ("pass one lamp", None, false),
            ("go to the level 2 bathroom", None, false),
            ("pass the second lamp", None, false),
            ("climb the stairs", None, false),
        ] {
            let place = first(text);
            assert_eq!((place.count, place.several), (count, several), "{text}");
        }
    }
}
