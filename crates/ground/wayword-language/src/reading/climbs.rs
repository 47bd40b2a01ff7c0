//! Finds stairs and storeys in a text, and separates commands to climb ("go up the stairs") from places up there ("the
//! bedroom upstairs").

#[cfg(test)]
mod tests;

use super::{Event, Floor, Link, What, links::link, tokens::Tokens, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};
use wayword_core::Climb;

/// The climbs and storeys that a text names.
pub(super) fn climbs_and_floors(tokens: Tokens<'_>, clauses: &[usize]) -> Vec<Event> {
    let before_climb = tokens.runs_before(|word| v::BEFORE_CLIMB.contains(&word));
    let text = Text { tokens, clauses, before_climb };
    let mut events: Vec<Event> = Vec::new();
    // The climbs found in this clause. They are few, because each is counted once in a clause.
    let mut told: Vec<What> = Vec::new();
    for at in 0..tokens.len() {
        if at > 0 && clauses[at] != clauses[at - 1] {
            told.clear();
        }
        if let Some(what) = text.climb(at).filter(|what| !told.contains(what)) {
            told.push(what.clone());
            events.push(Event { what, span: tokens.span(at, at), clause: clauses[at], denied: false });
        }
        if let Some((floor, last)) = text.floor(at) {
            let span = tokens.span(at, last);
            events.push(Event { what: What::Floor(floor), span, clause: clauses[at], denied: false });
        }
    }
    events
}

fn is_stairs(word: &str) -> bool {
    matches!(
        word,
        "stairs" | "stair" | "staircase" | "staircases" | "steps" | "stairway" | "flight" | "flights" | "stairwell"
    )
}

fn is_floor(word: &str) -> bool {
    matches!(word, "floor" | "floors" | "level" | "levels" | "story" | "storey")
}

/// How far a climb goes: a flight of stairs, or a few steps.
#[derive(Clone, Copy)]
enum Way {
    Flight,
    Steps,
}

impl Way {
    fn told(self, climb: Climb, is_command: bool) -> What {
        match self {
            Self::Flight => told(climb, is_command),
            Self::Steps => What::Steps(climb),
        }
    }
}

fn told(climb: Climb, is_command: bool) -> What {
    if is_command { What::Climb(climb) } else { What::Storey(climb) }
}

struct Text<'a> {
    tokens: Tokens<'a>,
    clauses: &'a [usize],
    /// For each token, where the run of adverbs before it begins.
    before_climb: Vec<usize>,
}

impl<'a> Text<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.tokens.word(at)
    }

    fn before(&self, at: usize) -> &'a str {
        self.tokens.before(at)
    }

    /// The climb that a token means, or the place up or down the stairs.
    fn climb(&self, at: usize) -> Option<What> {
        if self.describes_stairs(at) {
            return None;
        }
        if let Some(climb) = self.alone(at) {
            return Some(What::Climb(climb));
        }
        let next = self.word(at + 1);
        match self.word(at) {
            "upper" | "lower" | "floor" | "level" | "storey" | "story" => self.other_storey(at),
            "upstairs" => Some(told(Climb::Up, self.commands_upstairs(at))),
            "downstairs" => Some(told(Climb::Down, self.commands_upstairs(at))),
            "climb" | "climbing" | "ascend" | "ascending" if next != "down" => {
                Some(self.leads_on(at)?.told(Climb::Up, true))
            }
            "descend" | "descending" => Some(self.leads_on(at)?.told(Climb::Down, true)),
            "up" => Some(self.leads_on(at).or(self.behind_stairs(at))?.told(Climb::Up, self.commands(at))),
            "down" => Some(self.leads_on(at).or(self.behind_stairs(at))?.told(Climb::Down, self.commands(at))),
            _ => None,
        }
    }

    /// "Take the stairs to the upper floor", "go to the floor above", but not "start on the upper floor", and not "the
    /// stairs to the upper floor".
    fn other_storey(&self, at: usize) -> Option<What> {
        let next = self.word(at + 1);
        let is_joint = |word: &str| v::BREAKERS.contains(&word) && !v::DETERMINERS.contains(&word);
        let ends = |at: usize| !self.tokens.is_word(at) || self.word(at) == "and" || is_joint(self.word(at));
        let (climb, end) = match (self.word(at), next) {
            ("upper", _) if is_floor(next) => (Climb::Up, at + 2),
            ("lower", _) if is_floor(next) => (Climb::Down, at + 2),
            ("upper" | "lower", _) => return None,
            (_, "above") => (Climb::Up, at + 2),
            (_, "below") => (Climb::Down, at + 2),
            _ => return None,
        };
        let to = at.checked_sub(1 + usize::from(v::DETERMINERS.contains(&self.before(at))))?;
        let before = self.before(to);
        let verb = || (to.saturating_sub(4)..to).rev().map(|at| self.word(at)).find(|word| v::CLIMBING.contains(word));
        let goes = self.word(to) == "to" && (v::CLIMBING.contains(&before) || verb().is_some());
        (goes && ends(end)).then_some(What::Storey(climb))
    }

    /// "Go up.", "head down and turn left", "ascend": a climb that names no stairs.
    fn alone(&self, at: usize) -> Option<Climb> {
        let (climb, is_verb) = match self.word(at) {
            "up" | "upward" | "upwards" => (Climb::Up, false),
            "down" | "downward" | "downwards" => (Climb::Down, false),
            "ascend" | "ascending" => (Climb::Up, true),
            "descend" | "descending" => (Climb::Down, true),
            "climb" | "climbing" if !self.tokens.is_word(at + 1) => (Climb::Up, true),
            _ => return None,
        };
        let end = at + 1 + usize::from(matches!(self.word(at + 1), "again" | "here" | "there" | "now"));
        let ends = !self.tokens.is_word(end) || matches!(self.word(end), "and" | "then" | "until" | "till" | "again");
        let verb = self.before_climb(at).map_or("", |before| self.word(before));
        let goes =
            is_verb || matches!(verb, "go" | "going" | "head" | "heading" | "walk" | "walking" | "climb" | "step");
        // "Ascend the ramp", "descend to the kitchen"; for "up" and "down", the words behind them decide whether those
        // are climbs.
        let climbs = if is_verb { self.word(at + 1) != "down" } else { ends };
        (goes && climbs && self.leads_on(at).is_none()).then_some(climb)
    }

    /// "The stairs leading up to the bedroom", "the stairs going up", "the stairs that go up", "the stairs ascending to
    /// the attic": the agent need not climb them.
    fn describes_stairs(&self, at: usize) -> bool {
        let Some(before) = self.before_climb(at) else { return false };
        let of_stairs =
            |before: usize| is_stairs(self.before(before)) || matches!(self.before(before), "that" | "which");
        match self.word(before) {
            "leading" | "leads" | "lead" => true,
            "going" | "goes" | "go" | "headed" => of_stairs(before),
            "stairs" | "staircase" | "steps" => matches!(self.word(at), "ascending" | "descending"),
            _ => false,
        }
    }

    /// The token before a word of climbing, with adverbs skipped.
    fn before_climb(&self, at: usize) -> Option<usize> {
        self.before_climb[at].checked_sub(1)
    }

    /// "Up the old stairs", "up one floor", "up to the second floor", but not "up to the stairs".
    fn leads_on(&self, at: usize) -> Option<Way> {
        let to = usize::from(self.word(at + 1) == "to");
        let in_phrase = |at: &usize| {
            let (word, name) = (self.word(*at), normal_word(self.word(*at)));
            let joins =
                word != "of" || matches!(self.before(*at), "flight" | "flights" | "set" | "sets" | "rest" | "couple");
            let is_end = is_stairs(word) || (is_floor(word) && !self.is_underfoot(*at));
            let is_noun = (is_thing(&name) || is_room(&name)) && !v::ADJECTIVES.contains(&word);
            let breaks = v::BREAKERS.contains(&word) && !v::DETERMINERS.contains(&word) && word != "of";
            self.tokens.is_word(*at)
                && joins
                && (is_end || !(is_noun || breaks || matches!(word, "passed" | "passing")))
        };
        let phrase: Vec<&str> = (at + 1 + to..at + 7).take_while(in_phrase).map(|at| self.word(at)).collect();
        let end = phrase.iter().position(|word| is_floor(word) || (to == 0 && is_stairs(word)))?;
        if is_floor(phrase[end]) && self.is_underfoot(at + 1 + to + end) {
            return None;
        }
        // A storey's height is many steps, and so is a flight.
        let few = phrase[..end].iter().any(|word| v::FEW.contains(word)) && matches!(phrase[end], "steps" | "stairs");
        Some(if few { Way::Steps } else { Way::Flight })
    }

    /// "Down the tiled floor", "down the wood floor hallway": the ground that one walks on, and no storey.
    fn is_underfoot(&self, floor: usize) -> bool {
        let next = normal_word(self.word(floor + 1));
        v::FLOORINGS.contains(&self.before(floor)) || is_room(&next) || matches!(next.as_str(), "path" | "walkway")
    }

    /// "Take the stairs up", "take the elevator down", but not "take a few steps down the hallway".
    fn behind_stairs(&self, at: usize) -> Option<Way> {
        if v::DETERMINERS.contains(&self.word(at + 1)) && self.before(at) == "steps" {
            return None;
        }
        let mut words = (at.saturating_sub(4)..at).rev().map(|at| self.word(at));
        let taken = words.next().is_some_and(|word| is_stairs(word) || v::CARRIERS.contains(&word))
            && words.any(|word| matches!(word, "take" | "taking" | "follow" | "use" | "ride" | "riding"));
        taken.then_some(Way::Flight)
    }

    /// Whether the words are a command to climb, and not a place upstairs or downstairs.
    fn commands(&self, at: usize) -> bool {
        let Some(before) = self.before_climb(at) else { return true };
        let name = normal_word(self.word(before));
        let is_place = is_thing(&name) || is_room(&name);
        let is_carrier = is_stairs(self.word(before)) || v::CARRIERS.contains(&self.word(before));
        // "To the bathroom up the stairs", but "past the sofa up the stairs".
        !is_place || is_carrier || link(self.tokens, self.clauses, before) == Link::Along
    }

    /// The same for "upstairs" and "downstairs". Without a verb of going before them, they name a place.
    fn commands_upstairs(&self, at: usize) -> bool {
        let name = normal_word(self.word(at + 1));
        if is_thing(&name) || is_room(&name) {
            return false;
        }
        let before = self.before_climb(at).map_or("", |before| self.word(before));
        let joined =
            matches!(self.before(at), "and" | "then") && !matches!(self.word(at + 1), "in" | "at" | "on" | "is");
        v::CLIMBING.contains(&before) || joined
    }

    /// A storey that is named from this token on, and its last token: "level 2", "second floor", "top floor".
    fn floor(&self, at: usize) -> Option<(Floor, usize)> {
        let is_numbered = |at: usize| v::floor_number(self.word(at));
        let (number, last) = if is_floor(self.word(at)) {
            let told_before = at > 0 && (is_numbered(at - 1).is_some() || self.word(at - 1) == "top");
            (Some(is_numbered(at + 1).filter(|_| !told_before)?), at + 1)
        } else if self.word(at) == "top" && is_floor(self.word(at + 1)) {
            (None, at + 1)
        } else {
            // "Up one floor" and "two floors up" give a number of floors, and not the number of a floor.
            let is_one = matches!(self.word(at + 1), "floor" | "level" | "story" | "storey");
            (Some(is_numbered(at).filter(|_| is_one && self.word(at) != "one")?), at + 1)
        };
        let in_clause = (0..at).rev().take_while(|before| self.clauses[*before] == self.clauses[at]);
        let words: Vec<&str> = in_clause.map(|before| self.word(before)).take(7).collect();
        let joint = words.iter().find(|word| v::BREAKERS.contains(word) && !v::DETERMINERS.contains(word));
        let leaves = joint == Some(&"from") || words.iter().any(|word| v::LEAVING.contains(word));
        let going = |pair: &[&str]| matches!(pair[0], "going" | "goes") && (is_stairs(pair[1]) || pair[1] == "that");
        let aside =
            words.iter().any(|word| matches!(*word, "leading" | "leads" | "lead")) || words.windows(2).any(going);
        Some((Floor { number, leaves, aside }, last))
    }
}
