//! How much a writing prompt tells: all of it, or less for a model that reads little.

/// How much a prompt tells. Less is told to a model that reads little.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PromptDetail {
    Full,
    /// Fewer examples, and only what is passed, ahead or at the end.
    Short,
    /// An example or two, and the first things of each line.
    Least,
}

impl PromptDetail {
    /// All of them, the longest first.
    pub(super) const ALL: [Self; 3] = [Self::Full, Self::Short, Self::Least];

    /// Most reference texts. A style may have thousands, and more examples do not make a text more alike.
    pub(super) fn max_references(self) -> usize {
        match self {
            Self::Full => 10,
            Self::Short => 4,
            Self::Least => 2,
        }
    }

    /// Most things of a line; the later ones are left out.
    pub(super) fn max_line_things(self) -> usize {
        match self {
            Self::Full => 5,
            Self::Short => 4,
            Self::Least => 2,
        }
    }
}
