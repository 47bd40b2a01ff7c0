//! Changes without a dose: each is made as a whole or not at all, so there is no amount to choose.

/// A change that is made as a whole, without a dose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WholeChange {
    /// The world is mirrored: left becomes right.
    Mirror,
    /// The world is turned by 90 degrees.
    Turn,
    /// An object is taken away.
    Remove,
    /// An object is put in.
    Add,
    /// An object gets another colour.
    Material,
    /// The path is walked the other way.
    Reverse,
}

impl WholeChange {
    /// All changes without a dose.
    pub const ALL: [Self; 6] = [Self::Mirror, Self::Turn, Self::Remove, Self::Add, Self::Material, Self::Reverse];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mirror => "mirror",
            Self::Turn => "turn",
            Self::Remove => "remove",
            Self::Add => "add",
            Self::Material => "material",
            Self::Reverse => "reverse",
        }
    }

    /// Describes the effect in one sentence.
    #[must_use]
    pub fn describe_effect(self) -> &'static str {
        match self {
            Self::Mirror => "The world is mirrored, so that left becomes right.",
            Self::Turn => "The world is turned by 90 degrees, which nobody in it can see.",
            Self::Remove => "An object is taken out of the world.",
            Self::Add => "An object is put into the world.",
            Self::Material => "An object gets another colour.",
            Self::Reverse => "The path is walked from its end to its start.",
        }
    }
}
