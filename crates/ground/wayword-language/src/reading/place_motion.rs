//! Finds how a walk goes by a place: out of it, into it, through it, past it, to it.

use super::{PlaceMotion, role_words as r, tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{ThingClass, find_thing, is_room, normal_word};

/// How far before a place the word that decides may be, words.
const MOTION_REACH_WORDS: usize = 7;
/// How far before that the words for a moment may begin ("when you get to"), words.
const MOMENT_REACH_WORDS: usize = 4;

/// How the walk goes on by the place of that name that begins at a token; `None` where it does not go by it.
pub(super) fn motion_by_place(
    tokens: TokenSlice<'_>,
    clauses: &[usize],
    from: usize,
    place: &str,
) -> Option<PlaceMotion> {
    let clause = *clauses.get(from)?;
    let in_clause = |at: &usize| tokens.is_word(*at) && clauses[*at] == clause;
    let first = from - (0..from).rev().take(MOTION_REACH_WORDS + MOMENT_REACH_WORDS).take_while(in_clause).count();
    let text = MotionText { tokens, first };
    if text.is_task() {
        return None;
    }
    let (at, motion) = text.deciding_word((first.max(from.saturating_sub(MOTION_REACH_WORDS))..from).rev())?;
    // "Take the second door".
    let is_taken = motion == Some(PlaceMotion::Along) && text.is_doorway(place);
    let motion = if is_taken { Some(PlaceMotion::Through) } else { motion };
    // "Until you are at the sofa", "when you get to the sofa", but not "once you are past the sofa".
    let is_there = matches!(motion, None | Some(PlaceMotion::Towards));
    if is_there && text.tells_when(at) { Some(PlaceMotion::Until) } else { motion }
}

/// The words before a place, in its clause.
struct MotionText<'a> {
    tokens: TokenSlice<'a>,
    /// The first token that is looked at.
    first: usize,
}

impl<'a> MotionText<'a> {
    fn word_at(&self, at: usize) -> &'a str {
        self.tokens.word_at(at)
    }

    fn word_before(&self, at: usize) -> &'a str {
        self.tokens.word_before(at)
    }

    /// Whether the clause is a task: in "take the towel down from the shelf" the towel moves, and not the walker.
    fn is_task(&self) -> bool {
        let skips = |at: &usize| v::ADVERBS.contains(&self.word_at(*at)) || matches!(self.word_at(*at), "and" | "but");
        let verb = (self.first..self.tokens.len()).take(MOMENT_REACH_WORDS).find(|at| !skips(at)).unwrap_or(self.first);
        let (word, next) = (self.word_at(verb), self.word_at(verb + 1));
        let moves_it = matches!((word, next), ("take", "down" | "off" | "out" | "up" | "away") | ("bring", "me"));
        let walks = [&v::GOING, &v::TURNING, &v::WALKING].iter().any(|list| list.contains(&word));
        moves_it || (r::TASKS.contains(&word) && !walks && word != "use")
    }

    /// The first of these tokens, read backwards from the place, that decides, and the motion that it means; the motion is
    /// `None` where the word only locates something there.
    fn deciding_word(&self, mut window: impl Iterator<Item = usize>) -> Option<(usize, Option<PlaceMotion>)> {
        while let Some(at) = window.next() {
            if self.word_at(at) == "of" && v::PARTS.contains(&self.word_before(at)) {
                // "To the end of the hallway": the word before that end decides.
                window.next();
                continue;
            }
            if let Some(motion) = self.verb_motion(at) {
                return Some((at, Some(motion)));
            }
            if matches!(
                self.word_at(at),
                "reach" | "reaches" | "reached" | "reaching" | "see" | "find" | "spot" | "hit"
            ) {
                let reaches = self.word_at(at).starts_with("reach") && !self.tells_when(at);
                return Some((at, reaches.then_some(PlaceMotion::Towards)));
            }
            let breaks = v::BREAKERS.contains(&self.word_at(at)) && !v::DETERMINERS.contains(&self.word_at(at));
            let is_other =
                breaks || v::BESIDE.contains(&self.word_at(at)) || matches!(self.word_at(at), "thru" | "face");
            if is_other && !matches!(self.word_at(at), "and" | "or" | "it" | "you") {
                return Some((at, self.preposition_motion(at)));
            }
        }
        None
    }

    /// The motion that a verb expresses for its object: "exit the kitchen", "passing the sofa".
    fn verb_motion(&self, at: usize) -> Option<PlaceMotion> {
        // "The exit door", "a pass": a noun.
        if v::DETERMINERS.contains(&self.word_before(at)) {
            return None;
        }
        match self.word_at(at) {
            "exit" | "exits" | "exiting" | "leave" | "leaves" | "leaving" => Some(PlaceMotion::Leaving),
            "enter" | "enters" | "entering" | "visit" => Some(PlaceMotion::Entering),
            "pass" | "passes" | "passing" | "passed" => Some(PlaceMotion::Past),
            "cross" | "crosses" | "crossing" => Some(PlaceMotion::Through),
            "approach" | "approaching" => Some(PlaceMotion::Towards),
            "follow" | "follows" | "following" | "climb" | "climbing" | "ascend" | "ascending" | "descend"
            | "descending" | "take" | "taking" | "use" | "using" => Some(PlaceMotion::Along),
            "circle" | "circling" => Some(PlaceMotion::Around),
            _ => None,
        }
    }

    /// The motion that a preposition expresses.
    fn preposition_motion(&self, at: usize) -> Option<PlaceMotion> {
        let before = self.word_before(at);
        if matches!(before, "leads" | "leading" | "lead") {
            // "The door that leads into the kitchen": it names the goal of the door.
            return None;
        }
        let goes = || v::GOING.contains(&before) || v::CLIMBING.contains(&before);
        let behind_noun = || self.is_noun(before);
        match self.word_at(at) {
            "of" => (before == "out").then_some(PlaceMotion::Leaving),
            "out" => Some(PlaceMotion::Leaving),
            "from" => self.leaves_place(at).then_some(PlaceMotion::Leaving),
            "off" => (goes() || before == "step").then_some(PlaceMotion::Leaving),
            "to" if before == "in" => Some(PlaceMotion::Entering),
            "to" => (!v::BESIDE.contains(&before) && !self.is_doorway(before)).then_some(PlaceMotion::Towards),
            "toward" | "towards" => Some(PlaceMotion::Towards),
            "for" => matches!(before, "head" | "heading" | "aim" | "aiming" | "make").then_some(PlaceMotion::Towards),
            "into" | "onto" => Some(PlaceMotion::Entering),
            "in" | "inside" | "within" => (goes() || before == "back").then_some(PlaceMotion::Entering),
            "through" | "thru" => Some(PlaceMotion::Through),
            "across" => (!behind_noun()).then_some(PlaceMotion::Through),
            "between" => goes().then_some(PlaceMotion::Through),
            "down" | "along" | "up" => (!behind_noun() || self.is_way(before)).then_some(PlaceMotion::Along),
            "past" | "after" => Some(PlaceMotion::Past),
            "beyond" => goes().then_some(PlaceMotion::Past),
            "by" => {
                (goes() || matches!(before, "pass" | "passing") || self.goes_right_by(at)).then_some(PlaceMotion::Past)
            }
            "around" => (!behind_noun()).then_some(PlaceMotion::Around),
            "until" | "till" => Some(PlaceMotion::Until),
            _ => None,
        }
    }

    /// Whether "right" before "by" is no turn: "walk right by the sofa", but not "turn right by the sofa".
    fn goes_right_by(&self, by: usize) -> bool {
        self.word_before(by) == "right" && by > 1 && v::GOING.contains(&self.word_before(by - 1))
    }

    /// Whether a "from" is the walker's: "from the kitchen", "away from the sofa", but not "across from", "two feet
    /// from" or "far from".
    fn leaves_place(&self, at: usize) -> bool {
        let before = self.word_before(at);
        let across = (self.first..at).rev().take(3).any(|at| self.word_at(at) == "across");
        let away = before == "away" && v::GOING.contains(&self.word_before(at - 1));
        let aside = v::BESIDE.contains(&before) || v::UNITS.contains(&before) || matches!(before, "far" | "away");
        !across && (away || !aside)
    }

    /// Whether a word names a thing or a room.
    fn is_noun(&self, word: &str) -> bool {
        let name = normal_word(word);
        !v::ADJECTIVES.contains(&word) && (find_thing(&name).is_some_and(|thing| thing.name == name) || is_room(&name))
    }

    /// Whether a word names a way that can be followed: the stairs of "take the stairs up".
    fn is_way(&self, word: &str) -> bool {
        find_thing(&normal_word(word)).is_some_and(|thing| thing.class == ThingClass::Stairs)
    }

    /// Whether a word names a door or a way through a wall. In "the door to the kitchen" the kitchen is the door's goal, and
    /// not the walk's.
    fn is_doorway(&self, word: &str) -> bool {
        let name = normal_word(word);
        find_thing(&name)
            .is_some_and(|thing| thing.class == ThingClass::Door || matches!(thing.name, "doorway" | "arch"))
    }

    /// Whether words before a token say that this is a moment: "until you", "once", "as soon as you".
    fn tells_when(&self, at: usize) -> bool {
        // "Until you get to two chairs in front of a shelf": the moment is at the chairs, and not at the shelf.
        let mut before = (self.first..at).rev().map(|at| self.word_at(at)).take_while(|word| !self.is_noun(word));
        before.any(|word| matches!(word, "until" | "till" | "when" | "once" | "soon"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::{EventContent, PlaceMention, read_instruction};
    use std::collections::BTreeSet;

    /// How the walk goes on by the last place of a text.
    fn last(text: &str) -> Option<PlaceMotion> {
        let places = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let mut place =
            places.filter_map(|event| if let EventContent::Place(place) = event.what { Some(place) } else { None });
        let PlaceMention { going, .. } = place.next_back().unwrap_or_else(|| panic!("{text} names no place"));
        going
    }

    #[test]
    fn going_separates_the_ways_by_a_place() {
        for (going, texts) in [
            (PlaceMotion::Leaving, &["exit the kitchen", "leave the big kitchen", "walk out of the kitchen"][..]),
            (PlaceMotion::Leaving, &["coming from the kitchen", "walk away from the sofa", "step off the rug"]),
            (PlaceMotion::Entering, &["enter the kitchen", "turn left into the kitchen", "walk in the kitchen"]),
            (PlaceMotion::Entering, &["step inside the bathroom", "walk out of the bedroom and go into the hall"]),
            (
                PlaceMotion::Through,
                &["walk through the kitchen", "cross the room through the arch", "go across the kitchen"],
            ),
            (PlaceMotion::Through, &["walk between the sofas", "take the second door on the left", "use the doorway"]),
            (
                PlaceMotion::Along,
                &["walk down the hallway", "follow the hallway", "go up the stairs", "take the stairs"],
            ),
            (
                PlaceMotion::Past,
                &["walk past the sofa", "passing the old sofa", "walk by the sofa", "pass by the sofa"],
            ),
            (
                PlaceMotion::Past,
                &["turn left after the sofa", "once you are past the sofa", "walk past the bed and the sofa"],
            ),
            (PlaceMotion::Around, &["walk around the table"]),
            (
                PlaceMotion::Towards,
                &["walk to the sofa", "head towards the sofa", "approach the sofa", "head for the sofa"],
            ),
            (PlaceMotion::Towards, &["walk to the end of the hallway", "go out of the bedroom to the hallway"]),
            (
                PlaceMotion::Until,
                &["walk until you reach the sofa", "go on until the sofa", "when you get to the sofa"],
            ),
            (
                PlaceMotion::Until,
                &[
                    "when you get to the top of the stairs",
                    "once you are in the kitchen",
                    "until you are next to the sofa",
                ],
            ),
        ] {
            for text in texts {
                assert_eq!(last(text), Some(going), "{text}");
            }
        }
    }

    #[test]
    fn locating_words_are_no_way() {
        for text in [
            "stop in the kitchen",
            "wait by the sofa",
            "turn left at the sofa",
            "the door across the hall from the kitchen",
            "stop three feet from the sofa",
            "stop next to the kitchen",
            "wait near the doorway to the kitchen",
            "the stairs leading to the kitchen",
            "stop in front of the sofa",
            "wait to the left of the sofa",
            "the bedroom with the sofa",
            "face the sofa",
            "the exit door",
            "you will see the sofa",
            "pick up the lamp",
            "take down the picture",
            "remove the lamp from the table",
            "wipe down the counter",
            "until you get to the two chairs in front of a sofa",
            "turn right by the sofa",
            "go to the door that leads into the kitchen",
        ] {
            assert_eq!(last(text), None, "{text}");
        }
    }
}
