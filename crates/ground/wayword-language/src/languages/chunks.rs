//! Words and phrases of a text on their way to English.

/// An English word, with the place in the text that it means. A word that English alone needs has none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct GlossWord {
    pub(super) word: String,
    pub(super) source: Option<[usize; 2]>,
}

/// What a chunk may be: its class, and its English words.
#[derive(Debug, Clone)]
pub(super) struct ChunkSense {
    pub(super) class: &'static str,
    pub(super) words: Vec<GlossWord>,
}

/// A word or a phrase of the text. The first of its senses counts where no rule takes another.
#[derive(Debug, Clone)]
pub(super) struct Chunk {
    pub(super) senses: Vec<ChunkSense>,
}

impl Chunk {
    /// Its sense of one of these classes; the classes are tried in their order.
    pub(super) fn sense(&self, classes: &[&str]) -> Option<&ChunkSense> {
        classes.iter().find_map(|class| self.senses.iter().find(|sense| sense.class == *class))
    }
}
