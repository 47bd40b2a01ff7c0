//! The tokens of a text as the readers use them: one by one, or as runs of words that are skipped.
//!
//! No reader goes over the same words again from every token, because a long text would then take the square of its
//! length. The tokens before or after a run of words are found once for all tokens. `growth_tests` counts how often
//! tokens are looked at.

use crate::text::TextToken;

/// The tokens of a text, with what depends on the text alone and not on the names that its reader knew.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct ReadTokens {
    /// The words and marks of the text.
    pub(super) all: Vec<TextToken>,
    /// For each token, the number of its clause.
    pub(super) clauses: Vec<usize>,
    /// For each token, whether the text denies it.
    pub(super) denied: Vec<bool>,
}

/// The tokens of a text.
#[derive(Clone, Copy)]
pub(super) struct TokenSlice<'a>(&'a [TextToken]);

impl<'a> TokenSlice<'a> {
    pub(super) fn from_tokens(tokens: &'a [TextToken]) -> Self {
        Self(tokens)
    }

    pub(super) fn len(self) -> usize {
        self.0.len()
    }

    /// The token at an index; `None` after the end.
    pub(super) fn get(self, at: usize) -> Option<&'a TextToken> {
        #[cfg(test)]
        super::growth_tests::count_look();
        self.0.get(at)
    }

    /// The word or mark at an index; empty after the end.
    pub(super) fn word_at(self, at: usize) -> &'a str {
        self.get(at).map_or("", |token| token.word.as_str())
    }

    /// The word or mark right before an index; empty before the first.
    pub(super) fn word_before(self, at: usize) -> &'a str {
        at.checked_sub(1).map_or("", |before| self.word_at(before))
    }

    /// Whether the token at an index is a word, and not a mark.
    pub(super) fn is_word(self, at: usize) -> bool {
        self.get(at).is_some_and(TextToken::is_word)
    }

    /// The byte range from one token to another.
    pub(super) fn span_of(self, first: usize, last: usize) -> [usize; 2] {
        [self.0[first].span[0], self.0[last].span[1]]
    }

    /// The first token that begins at a byte or after it.
    pub(super) fn first_from(self, byte: usize) -> usize {
        self.0.partition_point(|token| token.span[0] < byte)
    }

    /// For each token, where the unbroken run of skippable words right before it begins; its own index where there is
    /// none.
    pub(super) fn runs_before(self, can_skip: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut from = 0;
        let start = |at: usize| {
            if at > 0 && !can_skip(self.word_at(at - 1)) {
                from = at;
            }
            from
        };
        (0..self.len()).map(start).collect()
    }

    /// For each token, the first one from there on that may not be skipped.
    pub(super) fn ends_of_runs(self, can_skip: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut ends = vec![self.len(); self.len()];
        for at in (0..self.len()).rev() {
            ends[at] = if can_skip(self.word_at(at)) { ends.get(at + 1).copied().unwrap_or(self.len()) } else { at };
        }
        ends
    }
}
