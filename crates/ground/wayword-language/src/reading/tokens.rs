//! The tokens of a text as the readers look at them: one by one, or as runs of words that are skipped.
//!
//! No reader walks over the same words from every token that it looks at: a long text would take the square of its length.
//! What stands before or behind a run of words is worked out once for all tokens. `growth` counts the looks.

use crate::text::Token;

/// The tokens of a text.
#[derive(Clone, Copy)]
pub(super) struct Tokens<'a>(&'a [Token]);

impl<'a> Tokens<'a> {
    pub(super) fn of(tokens: &'a [Token]) -> Self {
        Self(tokens)
    }

    pub(super) fn len(self) -> usize {
        self.0.len()
    }

    /// The token at a place, none behind the end.
    pub(super) fn get(self, at: usize) -> Option<&'a Token> {
        #[cfg(test)]
        super::growth::look();
        self.0.get(at)
    }

    /// The word or mark at a place, nothing behind the end.
    pub(super) fn word(self, at: usize) -> &'a str {
        self.get(at).map_or("", |token| token.word.as_str())
    }

    /// The word or mark right before a place, nothing before the first.
    pub(super) fn before(self, at: usize) -> &'a str {
        at.checked_sub(1).map_or("", |before| self.word(before))
    }

    /// Whether a word, and no mark, stands at a place.
    pub(super) fn is_word(self, at: usize) -> bool {
        self.get(at).is_some_and(Token::is_word)
    }

    /// The bytes from one token to another.
    pub(super) fn span(self, first: usize, last: usize) -> [usize; 2] {
        [self.0[first].span[0], self.0[last].span[1]]
    }

    /// The first token that begins at a byte or behind it.
    pub(super) fn first_from(self, byte: usize) -> usize {
        self.0.partition_point(|token| token.span[0] < byte)
    }

    /// For each token, where the run of words begins that stand right before it and may be skipped: the token itself where
    /// there are none.
    pub(super) fn runs_before(self, may: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut from = 0;
        let start = |at: usize| {
            if at > 0 && !may(self.word(at - 1)) {
                from = at;
            }
            from
        };
        (0..self.len()).map(start).collect()
    }

    /// For each token, the first one from there on that may not be skipped.
    pub(super) fn ends_of_runs(self, may: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut ends = vec![self.len(); self.len()];
        for at in (0..self.len()).rev() {
            ends[at] = if may(self.word(at)) { ends.get(at + 1).copied().unwrap_or(self.len()) } else { at };
        }
        ends
    }
}
