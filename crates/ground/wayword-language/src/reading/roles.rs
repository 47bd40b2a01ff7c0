//! The roles that the reader gives to the words of a text, and which clauses it understood.

/// A word of a text with the role that the reader gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadWord {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Its role.
    pub role: WordRole,
    /// Whether shares of understood words count it. Articles, pronouns, auxiliary verbs, conjunctions and prepositions
    /// are not counted.
    pub is_counted: bool,
}

impl ReadWord {
    /// Whether the program can act on the word, or knows that it makes no claim.
    #[must_use]
    pub fn is_understood(&self) -> bool {
        self.role != WordRole::Unknown
    }
}

/// The role of a word in its text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WordRole {
    /// A turn: "left" of "turn left".
    Turn,
    /// Up or down.
    Climb,
    /// A storey, or its number.
    Storey,
    /// A part of the name of an object or a room.
    Place,
    /// A noun for something that every path has: "room", "way", "end".
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
    /// A word about the walker's gaze.
    Facing,
    /// How places lie, or how the walk gets to one.
    Relation,
    /// A word that joins statements, or gives the time of one.
    Connective,
    /// A denial.
    Denial,
    /// An action on an object.
    Task,
    /// How an action is done or how something looks; no path could contradict it.
    Manner,
    /// A word without a meaning of its own.
    Filler,
    /// The reader does not know the word, or not in this place.
    Unknown,
}

/// A clause of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextClause {
    /// From its first word to its last, bytes. Both are 0 where the clause has no word.
    pub span: [usize; 2],
    /// Whether the reader knows its verb and its main noun. A clause without a word is understood.
    pub understood: bool,
}
