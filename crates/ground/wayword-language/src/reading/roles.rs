//! What the reader takes the words of a text for.

/// A word of a text, and what the reader takes it for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// What the reader takes it for.
    pub role: Role,
    /// Whether shares of understood words count it. Articles, pronouns, auxiliary verbs, conjunctions and prepositions
    /// are not counted.
    pub is_counted: bool,
}

impl Word {
    /// Whether the program can act on the word, or knows that it claims nothing.
    #[must_use]
    pub fn is_understood(&self) -> bool {
        self.role != Role::Unknown
    }
}

/// What a word is for its text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// A turn: "left" of "turn left".
    Turn,
    /// Up or down.
    Climb,
    /// A storey, or its number.
    Storey,
    /// A part of the name of an object or a room.
    Place,
    /// A noun that names nothing that a path could lack: "room", "way", "end".
    General,
    /// The side on which a place is, or which of several is meant.
    Side,
    /// A colour.
    Colour,
    /// How many things there are.
    Count,
    /// Which one of several things is meant.
    Ordinal,
    /// How far the walk goes.
    Distance,
    /// A verb by which the walker moves, or gets to see something.
    Motion,
    /// A direction of the compass.
    Compass,
    /// A stop.
    Stop,
    /// What the walker looks at.
    Facing,
    /// How places lie, or how the walk gets to one.
    Relation,
    /// What joins statements, or says when something happens.
    Connective,
    /// A denial.
    Denial,
    /// What is done with an object.
    Task,
    /// How something is done or looks; it claims nothing that a path could contradict.
    Manner,
    /// A word without a meaning of its own.
    Filler,
    /// The reader does not know the word, or not in this place.
    Unknown,
}

/// A clause of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clause {
    /// From its first word to its last, bytes. Both are 0 where the clause has no word.
    pub span: [usize; 2],
    /// Whether the reader knows its verb and its main noun. A clause without a word is understood.
    pub understood: bool,
}
