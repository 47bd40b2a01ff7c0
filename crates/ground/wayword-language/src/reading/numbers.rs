//! Numbers before a place: which one of several it is, and how many there are.

use super::{Ordinal, tokens::Tokens, vocabulary as v};
use wayword_core::Side;

/// How far before a noun phrase its number may be, words.
const REACH: usize = 5;

/// The number words of a text right before nouns.
pub(super) struct Numbers<'a> {
    tokens: Tokens<'a>,
    /// For each token, where the run of adjectives and numbers before it begins.
    runs: Vec<usize>,
    /// For each token, whether it belongs to a turn or a storey.
    others: Vec<bool>,
}

impl<'a> Numbers<'a> {
    /// `spans` are the byte ranges of turns and storeys. Sides and numbers within them belong to those, and not to
    /// places.
    pub(super) fn of(tokens: Tokens<'a>, spans: &[[usize; 2]]) -> Self {
        let mut others = vec![false; tokens.len()];
        for span in spans {
            others[tokens.first_from(span[0])..tokens.first_from(span[1])].fill(true);
        }
        let may = |word: &str| v::ADJECTIVES.contains(&word) || cardinal(word).is_some() || ordinal(word).is_some();
        Self { tokens, runs: tokens.runs_before(may), others }
    }

    /// The adjectives and numbers before a token, the nearest first.
    fn words_before(&self, from: usize) -> impl Iterator<Item = usize> {
        (self.runs[from]..from).rev().take(REACH).filter(|at| !self.others[*at])
    }

    /// "The second door", "the last two chairs": which one the noun phrase that begins at a token means.
    pub(super) fn ordinal(&self, from: usize) -> Option<Ordinal> {
        self.words_before(from).find_map(|at| ordinal(self.tokens.word(at)))
    }

    /// "Two chairs", "a pair of doors", "both of the doors": how many.
    pub(super) fn count(&self, from: usize) -> Option<u32> {
        let counted = |from: usize| self.words_before(from).find_map(|at| cardinal(self.tokens.word(at)));
        counted(from).or_else(|| {
            let of = self.runs[from].checked_sub(1)?;
            let of = if v::DETERMINERS.contains(&self.tokens.word(of)) { of.checked_sub(1)? } else { of };
            let head = of.checked_sub(1).filter(|_| self.tokens.word(of) == "of")?;
            match self.tokens.word(head) {
                "pair" | "couple" => Some(2),
                "trio" => Some(3),
                "set" => None,
                "sets" | "pairs" | "flights" | "rows" => counted(head),
                word => cardinal(word),
            }
        })
    }
}

/// The number that a word counts, from 2 on: "one door" only means a door.
#[must_use]
pub fn cardinal(word: &str) -> Option<u32> {
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
    const OTHERS: [&str; 17] = [
        "a", "one", "an", "eleven", "fifteen", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "ninety",
        "eighty", "hundred", "thousand", "half", "several",
    ];
    cardinal(word).is_some() || OTHERS.contains(&word) || word.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Which one of several a word means.
#[must_use]
pub fn ordinal(word: &str) -> Option<Ordinal> {
    match word {
        "last" | "final" => Some(Ordinal::Last),
        "next" => Some(Ordinal::Next),
        "left" | "leftmost" => Some(Ordinal::Side(Side::Left)),
        "right" | "rightmost" => Some(Ordinal::Side(Side::Right)),
        "ground" | "bottom" => None,
        _ if cardinal(word).is_some() || matches!(word, "1" | "one") => None,
        _ => v::floor_number(word).filter(|number| *number < 100).map(Ordinal::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::places::first;

    #[test]
    fn which_one_of_several_is_kept() {
        for (text, which) in [
            ("take the second door on the left", Some(Ordinal::Number(2))),
            ("enter the 3rd bedroom", Some(Ordinal::Number(3))),
            ("go through the first white bedroom door", Some(Ordinal::Number(1))),
            ("stop at the last two chairs", Some(Ordinal::Last)),
            ("enter the next room on your left, the kitchen", None),
            ("go through the next doorway", Some(Ordinal::Next)),
            ("turn left and take the door", None),
            ("take the left door", Some(Ordinal::Side(Side::Left))),
            ("stop at the rightmost chair", Some(Ordinal::Side(Side::Right))),
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
