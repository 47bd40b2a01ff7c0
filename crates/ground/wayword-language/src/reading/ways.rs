//! Finds how a walk goes by a place: out of it, into it, through it, past it, to it.

use super::{Going, role_words as r, tokens::Tokens, vocabulary as v};
use crate::lexicon::{Class, is_room, normal_word, thing};

/// How far before a place the word that decides may be, words.
const REACH: usize = 7;
/// How far before that the words for a moment may begin ("when you get to"), words.
const MORE: usize = 4;

/// How the walk goes on by the place of that name that begins at a token; `None` where it does not go by it.
pub(super) fn going(tokens: Tokens<'_>, clauses: &[usize], from: usize, place: &str) -> Option<Going> {
    let clause = *clauses.get(from)?;
    let in_clause = |at: &usize| tokens.is_word(*at) && clauses[*at] == clause;
    let first = from - (0..from).rev().take(REACH + MORE).take_while(in_clause).count();
    let text = Text { tokens, first };
    if text.is_task() {
        return None;
    }
    let (at, found) = text.decided((first.max(from.saturating_sub(REACH))..from).rev())?;
    // "Take the second door".
    let is_taken = found == Some(Going::Along) && text.is_doorway(place);
    let found = if is_taken { Some(Going::Through) } else { found };
    // "Until you are at the sofa", "when you get to the sofa", but not "once you are past the sofa".
    let is_there = matches!(found, None | Some(Going::Towards));
    if is_there && text.tells_when(at) { Some(Going::Until) } else { found }
}

struct Text<'a> {
    tokens: Tokens<'a>,
    /// The first token that is looked at.
    first: usize,
}

impl<'a> Text<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.tokens.word(at)
    }

    fn before(&self, at: usize) -> &'a str {
        self.tokens.before(at)
    }

    /// "Take the towel down from the shelf": the towel moves, and not the walker.
    fn is_task(&self) -> bool {
        let skips = |at: &usize| v::ADVERBS.contains(&self.word(*at)) || matches!(self.word(*at), "and" | "but");
        let verb = (self.first..self.tokens.len()).take(MORE).find(|at| !skips(at)).unwrap_or(self.first);
        let (word, next) = (self.word(verb), self.word(verb + 1));
        let moves_it = matches!((word, next), ("take", "down" | "off" | "out" | "up" | "away") | ("bring", "me"));
        let walks = [&v::GOING, &v::TURNING, &v::WALKING].iter().any(|list| list.contains(&word));
        moves_it || (r::TASKS.contains(&word) && !walks && word != "use")
    }

    /// The nearest of these tokens that decides, and its decision.
    fn decided(&self, mut window: impl Iterator<Item = usize>) -> Option<(usize, Option<Going>)> {
        while let Some(at) = window.next() {
            if self.word(at) == "of" && v::PARTS.contains(&self.before(at)) {
                // "To the end of the hallway": the word before that end decides.
                window.next();
                continue;
            }
            if let Some(found) = self.verb(at) {
                return Some((at, Some(found)));
            }
            if matches!(self.word(at), "reach" | "reaches" | "reached" | "reaching" | "see" | "find" | "spot" | "hit") {
                let reaches = self.word(at).starts_with("reach") && !self.tells_when(at);
                return Some((at, reaches.then_some(Going::Towards)));
            }
            let breaks = v::BREAKERS.contains(&self.word(at)) && !v::DETERMINERS.contains(&self.word(at));
            let is_other = breaks || v::BESIDE.contains(&self.word(at)) || matches!(self.word(at), "thru" | "face");
            if is_other && !matches!(self.word(at), "and" | "or" | "it" | "you") {
                return Some((at, self.preposition(at)));
            }
        }
        None
    }

    /// The motion that a verb expresses for its object: "exit the kitchen", "passing the sofa".
    fn verb(&self, at: usize) -> Option<Going> {
        // "The exit door", "a pass": a noun.
        if v::DETERMINERS.contains(&self.before(at)) {
            return None;
        }
        match self.word(at) {
            "exit" | "exits" | "exiting" | "leave" | "leaves" | "leaving" => Some(Going::Leaving),
            "enter" | "enters" | "entering" | "visit" => Some(Going::Entering),
            "pass" | "passes" | "passing" | "passed" => Some(Going::Past),
            "cross" | "crosses" | "crossing" => Some(Going::Through),
            "approach" | "approaching" => Some(Going::Towards),
            "follow" | "follows" | "following" | "climb" | "climbing" | "ascend" | "ascending" | "descend"
            | "descending" | "take" | "taking" | "use" | "using" => Some(Going::Along),
            "circle" | "circling" => Some(Going::Around),
            _ => None,
        }
    }

    /// The motion that a preposition expresses.
    fn preposition(&self, at: usize) -> Option<Going> {
        let before = self.before(at);
        if matches!(before, "leads" | "leading" | "lead") {
            // "The door that leads into the kitchen": it names the goal of the door.
            return None;
        }
        let goes = || v::GOING.contains(&before) || v::CLIMBING.contains(&before);
        let behind_noun = || self.is_noun(before);
        match self.word(at) {
            "of" => (before == "out").then_some(Going::Leaving),
            "out" => Some(Going::Leaving),
            "from" => self.leaves(at).then_some(Going::Leaving),
            "off" => (goes() || before == "step").then_some(Going::Leaving),
            "to" if before == "in" => Some(Going::Entering),
            "to" => (!v::BESIDE.contains(&before) && !self.is_doorway(before)).then_some(Going::Towards),
            "toward" | "towards" => Some(Going::Towards),
            "for" => matches!(before, "head" | "heading" | "aim" | "aiming" | "make").then_some(Going::Towards),
            "into" | "onto" => Some(Going::Entering),
            "in" | "inside" | "within" => (goes() || before == "back").then_some(Going::Entering),
            "through" | "thru" => Some(Going::Through),
            "across" => (!behind_noun()).then_some(Going::Through),
            "between" => goes().then_some(Going::Through),
            "down" | "along" | "up" => (!behind_noun() || self.is_way(before)).then_some(Going::Along),
            "past" | "after" => Some(Going::Past),
            "beyond" => goes().then_some(Going::Past),
            "by" => (goes() || matches!(before, "pass" | "passing") || self.goes_right_by(at)).then_some(Going::Past),
            "around" => (!behind_noun()).then_some(Going::Around),
            "until" | "till" => Some(Going::Until),
            _ => None,
        }
    }

    /// "Walk right by the sofa", but not "turn right by the sofa".
    fn goes_right_by(&self, by: usize) -> bool {
        self.before(by) == "right" && by > 1 && v::GOING.contains(&self.before(by - 1))
    }

    /// "From the kitchen", "away from the sofa", but not "across from", "two feet from" or "far from".
    fn leaves(&self, at: usize) -> bool {
        let before = self.before(at);
        let across = (self.first..at).rev().take(3).any(|at| self.word(at) == "across");
        let away = before == "away" && v::GOING.contains(&self.before(at - 1));
        let aside = v::BESIDE.contains(&before) || v::UNITS.contains(&before) || matches!(before, "far" | "away");
        !across && (away || !aside)
    }

    fn is_noun(&self, word: &str) -> bool {
        let name = normal_word(word);
        !v::ADJECTIVES.contains(&word) && (thing(&name).is_some_and(|thing| thing.name == name) || is_room(&name))
    }

    /// A way that can be followed: "take the stairs up".
    fn is_way(&self, word: &str) -> bool {
        thing(&normal_word(word)).is_some_and(|thing| thing.class == Class::Stairs)
    }

    /// "The door to the kitchen": it names the goal of the door.
    fn is_doorway(&self, word: &str) -> bool {
        let name = normal_word(word);
        thing(&name).is_some_and(|thing| thing.class == Class::Door || matches!(thing.name, "doorway" | "arch"))
    }

    /// Whether words before a token say that this is a moment: "until you", "once", "as soon as you".
    fn tells_when(&self, at: usize) -> bool {
        // "Until you get to two chairs in front of a shelf": the moment is at the chairs, and not at the shelf.
        let mut before = (self.first..at).rev().map(|at| self.word(at)).take_while(|word| !self.is_noun(word));
        before.any(|word| matches!(word, "until" | "till" | "when" | "once" | "soon"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::{Place, What, read};
    use std::collections::BTreeSet;

    /// How the walk goes on by the last place of a text.
    fn last(text: &str) -> Option<Going> {
        let places = read(text, &BTreeSet::new()).events.into_iter();
        let mut place = places.filter_map(|event| if let What::Place(place) = event.what { Some(place) } else { None });
        let Place { going, .. } = place.next_back().unwrap_or_else(|| panic!("{text} names no place"));
        going
    }

    #[test]
    fn going_separates_the_ways_by_a_place() {
        for (going, texts) in [
            (Going::Leaving, &["exit the kitchen", "leave the big kitchen", "walk out of the kitchen"][..]),
            (Going::Leaving, &["coming from the kitchen", "walk away from the sofa", "step off the rug"]),
            (Going::Entering, &["enter the kitchen", "turn left into the kitchen", "walk in the kitchen"]),
            (Going::Entering, &["step inside the bathroom", "walk out of the bedroom and go into the hall"]),
            (Going::Through, &["walk through the kitchen", "cross the room through the arch", "go across the kitchen"]),
            (Going::Through, &["walk between the sofas", "take the second door on the left", "use the doorway"]),
            (Going::Along, &["walk down the hallway", "follow the hallway", "go up the stairs", "take the stairs"]),
            (Going::Past, &["walk past the sofa", "passing the old sofa", "walk by the sofa", "pass by the sofa"]),
            (
                Going::Past,
                &["turn left after the sofa", "once you are past the sofa", "walk past the bed and the sofa"],
            ),
            (Going::Around, &["walk around the table"]),
            (Going::Towards, &["walk to the sofa", "head towards the sofa", "approach the sofa", "head for the sofa"]),
            (Going::Towards, &["walk to the end of the hallway", "go out of the bedroom to the hallway"]),
            (Going::Until, &["walk until you reach the sofa", "go on until the sofa", "when you get to the sofa"]),
            (
                Going::Until,
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
