//! Finds the colours that a text gives to places.

use super::{tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};

/// The colours that a text gives places.
pub(super) struct PlaceColours<'a> {
    tokens: TokenSlice<'a>,
    /// For each token, the last colour in the run of adjectives that ends with it.
    last: Vec<Option<usize>>,
}

impl<'a> PlaceColours<'a> {
    pub(super) fn from_tokens(tokens: TokenSlice<'a>) -> Self {
        let mut last = None;
        let colour = |at: usize| {
            let word = tokens.word_at(at);
            if v::COLOURS.contains(&word) {
                last = Some(at);
            } else if !v::ADJECTIVES.contains(&word) {
                last = None;
            }
            last
        };
        Self { tokens, last: (0..tokens.len()).map(colour).collect() }
    }

    /// The colour of the place that begins at a token.
    pub(super) fn colour_before(&self, from: usize) -> Option<String> {
        Some(self.colour_at(self.last[from.checked_sub(1)?]?))
    }

    /// The colour that the words right behind a place give it: "is green", "that are dark red". `to` is the token behind the
    /// place.
    pub(super) fn colour_behind(&self, to: usize) -> Option<String> {
        let word = |at: usize| self.tokens.word_at(at);
        let at = to + usize::from(matches!(word(to), "that" | "which"));
        let behind_verb = matches!(word(at), "is" | "are" | "was" | "were").then_some(at + 1)?;
        let is_shade = |word: &str| matches!(word, "dark" | "light" | "all" | "mostly" | "very" | "painted" | "bright");
        let at = behind_verb + usize::from(is_shade(word(behind_verb)));
        // "Is a green chair" is about another thing.
        let name = normal_word(word(at + 1));
        let is_whole = !is_thing(&name) && !is_room(&name);
        (v::COLOURS.contains(&word(at)) && is_whole).then(|| self.colour_at(at))
    }

    /// The colour at a token, with its shade.
    fn colour_at(&self, at: usize) -> String {
        let colour = if self.tokens.word_at(at) == "gray" { "grey" } else { self.tokens.word_at(at) };
        let shade = Some(self.tokens.word_before(at)).filter(|word| matches!(*word, "dark" | "light"));
        shade.map_or(colour.to_owned(), |shade| format!("{shade} {colour}"))
    }
}
