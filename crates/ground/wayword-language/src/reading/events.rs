//! The result of reading an instruction: its events in the order of the text, its closing task, its words and clauses,
//! and the tokens that all of these were read from.

use super::{ReadWord, TextClause, tokens::ReadTokens};
use crate::{
    Language,
    text::{self, TextToken},
};
use std::sync::Arc;
use wayword_core::{ClimbDirection, Side};

/// An instruction after the rules of the language went over it.
#[derive(Debug, Clone, PartialEq)]
pub struct TextReading {
    /// Everything that can be compared with a path.
    pub events: Vec<TextEvent>,
    /// The closing task, where the text ends in one.
    pub task: Option<ClosingTask>,
    /// Every word of the text with its role.
    pub words: Vec<ReadWord>,
    /// The clauses of the text, by the number that events have.
    pub clauses: Vec<TextClause>,
    /// The language of the words that were read. Parts in another language than English are not read.
    pub language: Language,
    /// Its tokens, so that the text need not be split again. A reading without its denied events still has all of them,
    /// and shares them with the reading that it was made from.
    pub(super) tokens: Arc<ReadTokens>,
}

/// One statement or command of an instruction: a place, a turn, a climb, a distance.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEvent {
    /// Its kind and its details.
    pub what: EventContent,
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// The number of its clause, counted over the whole text.
    pub clause: usize,
    /// Whether the text denies it: "do not turn right".
    pub denied: bool,
}

/// The content of an event.
#[derive(Debug, Clone, PartialEq)]
pub enum EventContent {
    /// An object, a room, or a word that can mean either ("the stairs").
    Place(PlaceMention),
    /// A turn to a side, or around (`Behind`).
    Turn(Side),
    /// A command to go up or down a flight of stairs.
    Climb(ClimbDirection),
    /// A command to go up or down a few steps, fewer than a flight.
    Steps(ClimbDirection),
    /// A place that lies up or down the stairs ("the bedroom upstairs"), wherever the agent starts.
    Storey(ClimbDirection),
    /// A storey that the text names.
    Floor(StoreyMention),
    /// A command to walk on ("walk straight ahead").
    Onward,
    /// A command to stop or to wait, or a statement that the walk ends. The places of its clause tell where.
    Stop,
    /// The walker looks at the places of this clause ("stop facing the window"), or away from them ("with your back to
    /// the bed").
    Face {
        /// Whether the walker's back is to the places.
        away: bool,
    },
    /// A direction of the compass.
    Compass {
        /// Which one.
        towards: CompassDirection,
        /// Whether the walk goes or turns that way ("head north"), and not only a place lies there ("the east wall").
        goes: bool,
    },
    /// How far to walk, metres. A number of metres or feet is one value, and a number of steps is a range.
    Distance {
        /// At least so far.
        metres_low: f64,
        /// At most so far.
        metres_high: f64,
    },
}

/// The directions of the compass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // The names explain themselves.
pub enum CompassDirection {
    North,
    NorthEast,
    East,
    SouthEast,
    South,
    SouthWest,
    West,
    NorthWest,
}

impl CompassDirection {
    /// Degrees clockwise from north.
    #[must_use]
    pub fn degrees(self) -> f64 {
        45.0 * f64::from(self as u8)
    }
}

/// A storey that a text names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StoreyMention {
    /// Its number, the lowest being 1; `None` for the top storey.
    pub number: Option<u32>,
    /// Whether the path comes from there: "from the second floor", "start on level 1".
    pub leaves: bool,
    /// Whether the text only mentions a way there: "the stairs leading to the second floor".
    pub aside: bool,
}

/// An object or a room in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceMention {
    /// Its name in normal spelling.
    pub name: String,
    /// Whether the name can be an object's.
    pub is_thing: bool,
    /// Whether the name can be a room's.
    pub is_room: bool,
    /// How it is linked to its sentence.
    pub link: PlaceLink,
    /// The side of the agent that the text gives it ("on your left").
    pub side: Option<Side>,
    /// The colour that the text gives it.
    pub colour: Option<String>,
    /// Whether it follows a turn that happens at, by or after it ("turn left at the sofa").
    pub tells_turn: bool,
    /// How the walk goes on by it. `None` where the text only locates something at it, in it or next to it.
    pub going: Option<PlaceMotion>,
    /// Which one of several it is ("the second door").
    pub ordinal: Option<PlaceOrdinal>,
    /// How many there are, where the text gives a number ("two chairs", "a pair of doors").
    pub count: Option<u32>,
    /// Whether the text names several ("two chairs", "pass couches").
    pub several: bool,
}

/// How a walk goes on by a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceMotion {
    /// It leaves the place: "exit", "leave", "out of", "from".
    Leaving,
    /// It gets into the place: "enter", "into", "walk in".
    Entering,
    /// It goes through the place: "through", "across", "cross".
    Through,
    /// It goes along the place: "down the hallway", "follow the wall", "up the stairs".
    Along,
    /// It passes the place: "past", "pass", "walk by", "turn left after".
    Past,
    /// It goes around the place: "around the table".
    Around,
    /// It goes to the place, or only in its direction: "to", "towards", "approach".
    Towards,
    /// It goes on up to the moment of being there: "until you reach", "once you are in", "when you get to".
    Until,
}

/// Which one of several things alike is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceOrdinal {
    /// The first is 1.
    Number(u32),
    /// The last one.
    Last,
    /// The next one from here.
    Next,
    /// The one on that side of the others: "the left door".
    Side(Side),
}

/// How a place is linked to its sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceLink {
    /// No word links it: "leave the kitchen", "the kitchen is on your left".
    Plain,
    /// The agent gets there: "to", "into", "enter".
    Goal,
    /// Something is there, or the agent is: "in", "at", "from", "of".
    Within,
    /// Something is next to it, and the agent need not go there: "next to", "across from", "with".
    Beside,
    /// The agent goes past or through it: "past", "down".
    Along,
}

/// The closing task of an instruction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClosingTask {
    /// Its verb.
    pub verb: String,
    /// The event that is its object, where it names one.
    pub object: Option<usize>,
}

impl TextReading {
    /// The words and marks of the text, as [`split_tokens`](text::split_tokens) finds them.
    #[must_use]
    pub fn tokens(&self) -> &[TextToken] {
        &self.tokens.all
    }

    /// For each token, the number of its clause, counted over the whole text.
    #[must_use]
    pub fn token_clauses(&self) -> &[usize] {
        &self.tokens.clauses
    }

    /// For each token, whether the text denies it.
    pub(super) fn denied_tokens(&self) -> &[bool] {
        &self.tokens.denied
    }

    /// The words of the text, lower case, without marks.
    #[must_use]
    pub fn to_plain_words(&self) -> Vec<String> {
        self.tokens().iter().filter(|token| token.is_word()).map(|token| token.word.clone()).collect()
    }

    /// Number of sentences: words up to a full stop, exclamation or question mark, or the end.
    #[must_use]
    pub fn count_sentences(&self) -> usize {
        text::count_sentences(self.tokens())
    }

    /// The reading without the denied events: only the text's claims.
    #[must_use]
    pub fn into_claims(mut self) -> Self {
        if let Some(task) = &mut self.task {
            let claimed = |at: usize| self.events[..at].iter().filter(|event| !event.denied).count();
            task.object = task.object.filter(|at| !self.events[*at].denied).map(claimed);
        }
        self.events.retain(|event| !event.denied);
        self
    }
}
