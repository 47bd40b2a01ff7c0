//! The topic of a labelled span (turns, floors, rooms, other), recognised by a few words.

/// The topic of a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Turn,
    Floor,
    Room,
    Other,
}

const TURNS: [&str; 5] = ["left", "right", "straight", "around", "turn"];
const FLOORS: [&str; 4] = ["up", "down", "stairs", "steps"];
const ROOMS: [&str; 22] = [
    "room", "bedroom", "bathroom", "kitchen", "hall", "hallway", "corridor", "office", "closet", "lounge", "foyer",
    "entryway", "balcony", "patio", "deck", "porch", "outside", "garage", "library", "laundry", "gym", "spa",
];

impl Kind {
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
    pub(super) fn of(span: &str) -> Self {
        let span = span.to_lowercase();
        let has = |list: &[&str]| span.split(|c: char| !c.is_alphanumeric()).any(|word| list.contains(&word));
        if has(&TURNS) {
            Self::Turn
        } else if has(&FLOORS) && !span.contains("hall") {
            Self::Floor
        } else if has(&ROOMS) {
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
            ("turn left", Kind::Turn),
            ("on the right", Kind::Turn),
            ("walk up", Kind::Floor),
            ("the stairs", Kind::Floor),
            ("down the hallway", Kind::Room),
            ("Kitchen", Kind::Room),
            ("walk past", Kind::Other),
            ("upright lamp", Kind::Other),
        ] {
            assert_eq!(Kind::of(span), kind, "{span}");
        }
    }
}
