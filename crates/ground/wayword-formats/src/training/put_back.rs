//! Texts that are put back into the list of walks that they are about.

/// The texts about the walk of a name; none where there are none.
pub type TextsOfWalk<'a> = &'a dyn Fn(&str) -> Vec<String>;

/// What was put back.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TextsPutBack {
    /// Walks with a text.
    pub walks: usize,
    /// Their texts.
    pub texts: usize,
    /// Walks that were left out, because they have no text or cannot be written again.
    pub left_out: usize,
}

impl TextsPutBack {
    /// Counts a walk with so many texts. Returns whether it is written.
    pub(super) fn take_walk(&mut self, texts: usize) -> bool {
        self.walks += usize::from(texts > 0);
        self.texts += texts;
        self.left_out += usize::from(texts == 0);
        texts > 0
    }
}
