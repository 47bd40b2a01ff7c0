//! The topic of a labelled span (turns, floors, rooms, other), recognised by a few words.

/// The topic of a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SpanTopic {
    /// A turn or a side.
    Turn,
    /// Stairs or a storey.
    Floor,
    /// A room.
    Room,
    /// A landmark, a verb, or anything else.
    Other,
}

/// A span with one of these words is about a turn.
const TURN_WORDS: [&str; 5] = ["left", "right", "straight", "around", "turn"];
/// A span with one of these words, and without a hall, is about stairs or storeys.
const FLOOR_WORDS: [&str; 4] = ["up", "down", "stairs", "steps"];
/// A span with one of these words is about a room.
const ROOM_WORDS: [&str; 22] = [
    "room", "bedroom", "bathroom", "kitchen", "hall", "hallway", "corridor", "office", "closet", "lounge", "foyer",
    "entryway", "balcony", "patio", "deck", "porch", "outside", "garage", "library", "laundry", "gym", "spa",
];

impl SpanTopic {
    pub(super) const ALL: [Self; 4] = [Self::Turn, Self::Floor, Self::Room, Self::Other];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Turn => "turns and sides",
            Self::Floor => "stairs and floors",
            Self::Room => "rooms",
            Self::Other => "landmarks and verbs",
        }
    }

    /// The first kind in [`Self::ALL`] of which the span has a word. "Down the hall" is a room.
    pub(super) fn for_span(span: &str) -> Self {
        let span = span.to_lowercase();
        let has = |list: &[&str]| span.split(|c: char| !c.is_alphanumeric()).any(|word| list.contains(&word));
        if has(&TURN_WORDS) {
            Self::Turn
        } else if has(&FLOOR_WORDS) && !span.contains("hall") {
            Self::Floor
        } else if has(&ROOM_WORDS) {
            Self::Room
        } else {
            Self::Other
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_of_the_kind_of_its_words() {
        for (span, kind) in [
            ("turn left", SpanTopic::Turn),
            ("on the right", SpanTopic::Turn),
            ("walk up", SpanTopic::Floor),
            ("the stairs", SpanTopic::Floor),
            ("down the hallway", SpanTopic::Room),
            ("Kitchen", SpanTopic::Room),
            ("walk past", SpanTopic::Other),
            ("upright lamp", SpanTopic::Other),
        ] {
            assert_eq!(SpanTopic::for_span(span), kind, "{span}");
        }
    }
}
