//! Finds where a walk stops, and which places the walker faces there.

use super::{EventContent, TextEvent, tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};

/// The commands of a text to stop, and its words about facing something.
pub(super) fn stops_and_facing(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let text = StopText { tokens };
    let event = |what: EventContent, at: usize| TextEvent {
        what,
        span: tokens.span_of(at, at),
        clause: clauses[at],
        denied: false,
    };
    let event_at = |at: usize| {
        let stops = text.stops_at(at).then(|| event(EventContent::Stop, at));
        stops.or_else(|| text.faces_at(at).map(|away| event(EventContent::Face { away }, at)))
    };
    (0..tokens.len()).filter_map(event_at).collect()
}

struct StopText<'a> {
    tokens: TokenSlice<'a>,
}

impl<'a> StopText<'a> {
    fn word_at(&self, at: usize) -> &'a str {
        self.tokens.word_at(at)
    }

    fn word_before(&self, at: usize) -> &'a str {
        self.tokens.word_before(at)
    }

    /// Whether a token ends the walk.
    fn stops_at(&self, at: usize) -> bool {
        let next = self.word_at(at + 1);
        let here = || !self.tokens.is_word(at + 1) || v::AFTER_STOP.contains(&next);
        match self.word_at(at) {
            "waiting" | "stop" if matches!(next, "sign" | "room" | "area") => false,
            // "The wait", but "make a stop".
            word if v::STOPPING.contains(&word) => !matches!(self.word_before(at), "the" | "non" | "t" | "rest"),
            "end" | "finish" | "rest" | "stand" => self.is_commanded(at) && here(),
            "stay" | "remain" => self.is_commanded(at) && (here() || self.names_this_spot(at + 1)),
            "standing" => matches!(self.word_before(at), "be" | "are" | "re"),
            "done" | "finished" | "arrived" => {
                matches!(self.word_before(at), "are" | "you're" | "you’re" | "be" | "have" | "you've" | "you’ve")
                    && here()
                    && !self.tells_when(at)
            }
            "destination" => matches!(self.word_before(at), "your" | "the") && !self.tells_when(at),
            _ => false,
        }
    }

    /// Whether the words from a token on are "where you are", as in "stay where you are".
    fn names_this_spot(&self, at: usize) -> bool {
        matches!((self.word_at(at), self.word_at(at + 1), self.word_at(at + 2)), ("where", "you", "are"))
    }

    /// Whether a verb begins its clause, or follows words of command.
    fn is_commanded(&self, at: usize) -> bool {
        at == 0 || !self.tokens.is_word(at - 1) || v::ADVERBS.contains(&self.word_before(at))
    }

    /// Whether the words only give the time of something: after "when you are done with that" the walk goes on.
    fn tells_when(&self, at: usize) -> bool {
        let mut before = (at.saturating_sub(5)..at).rev().take_while(|at| self.tokens.is_word(*at));
        before.any(|at| matches!(self.word_at(at), "when" | "once" | "after" | "if" | "until"))
    }

    /// Whether the walker looks at the places that follow (`false`) or away from them (`true`).
    fn faces_at(&self, at: usize) -> Option<bool> {
        let next = self.word_at(at + 1);
        match self.word_at(at) {
            "back" | "backs" if next == "to" && matches!(self.word_before(at), "your" | "my" | "the") => Some(true),
            "facing" if next == "away" => Some(true),
            // "An about-face" is a turn.
            "face" if self.word_before(at) == "about" => None,
            "face" | "facing" | "faced" if !self.names_direction(at + 1) && self.is_walker(at) => Some(next == "away"),
            "look" | "looking" if matches!(next, "at" | "toward" | "towards" | "into") && self.is_walker(at) => {
                Some(false)
            }
            _ => None,
        }
    }

    /// Whether words behind "face" name a direction and no place: "face left", "facing the opposite direction".
    fn names_direction(&self, from: usize) -> bool {
        let at = from + usize::from(matches!(self.word_at(from), "the" | "to" | "your"));
        let at = at + usize::from(matches!(self.word_at(at), "the" | "your"));
        matches!(self.word_at(at), "left" | "right" | "opposite" | "other" | "direction" | "around" | "straight")
            && matches!(self.word_at(at + 1), "" | "direction" | "way" | "and" | "so" | "then" | "." | ",")
    }

    /// Whether it is the walker who faces something, and not a thing: "stop facing the lamp", but not "the chair facing
    /// the lamp", "on the face of the clock".
    fn is_walker(&self, at: usize) -> bool {
        let before = self.word_before(at);
        let name = normal_word(before);
        let is_noun = is_thing(&name) || is_room(&name) || v::ABSTRACT.contains(&name.as_str());
        let is_article = v::DETERMINERS.contains(&before) && self.word_at(at) == "face";
        // "Turn left facing the lamp": a side is no thing.
        !self.tokens.is_word(at.wrapping_sub(1))
            || matches!(before, "left" | "right" | "straight" | "around" | "there" | "here")
            || !(is_noun || is_article || matches!(before, "that" | "which" | "is" | "it"))
    }
}

#[cfg(test)]
mod tests {
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    fn told(text: &str) -> Vec<EventContent> {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter().map(|event| event.what);
        events.filter(|what| matches!(what, EventContent::Stop | EventContent::Face { .. })).collect()
    }

    #[test]
    fn stops_are_found_in_many_wordings() {
        for text in [
            "Stop at the sink.",
            "Walk to the sink and wait there.",
            "Turn left then stop by the sofa.",
            "Come to a halt near the sofa.",
            "Walk on and end at the sofa.",
            "Please stand in the doorway.",
            "You should be standing by the sofa.",
            "Wait.",
            "You have arrived.",
            "Stay where you are.",
            "The sofa is your destination.",
        ] {
            assert_eq!(told(text), [EventContent::Stop], "{text}");
        }
        for text in [
            "Walk to the end of the hall.",
            "Walk past the tv stand.",
            "Walk past the man standing by the sofa.",
            "Go to the waiting room.",
            "Stay to the left of the table.",
            "When you are done with that turn left.",
            "Clean the rest of the sink.",
        ] {
            assert_eq!(told(text), [], "{text}");
        }
    }

    #[test]
    fn a_stop_can_be_denied() {
        let reading = read_instruction("Do not stop at the sofa.", &BTreeSet::new());
        assert!(reading.events.iter().all(|event| event.denied));
    }

    #[test]
    fn faces_ignores_things_that_face_something() {
        for (text, away) in [
            ("Turn to face the window.", false),
            ("Face the window.", false),
            ("Begin facing the window.", false),
            ("Turn left, facing the window.", false),
            ("You are looking at the window.", false),
            ("Turn your back to the window.", true),
            ("Start with your back to the bed.", true),
            ("Begin facing away from the bed.", true),
        ] {
            assert_eq!(told(text), [EventContent::Face { away }], "{text}");
        }
        for text in [
            "Walk past the chair facing the window.",
            "Face left.",
            "Turn around and face the opposite direction.",
            "Walk past the sofa that is facing the window.",
            "Do an about-face.",
        ] {
            assert_eq!(told(text), [], "{text}");
        }
    }
}
