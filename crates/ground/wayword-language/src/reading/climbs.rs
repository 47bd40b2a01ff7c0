//! Finds stairs and storeys in a text, and separates commands to climb ("go up the stairs") from places up there ("the
//! bedroom upstairs").

#[cfg(test)]
mod tests;

use super::{
    EventContent, PlaceLink, StoreyMention, TextEvent, links::link_before, tokens::TokenSlice, vocabulary as v,
};
use crate::lexicon::{is_room, is_thing, normal_word};
use wayword_core::ClimbDirection;

/// The climbs and storeys that a text names.
pub(super) fn climbs_and_floors(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let before_climb = tokens.runs_before(|word| v::BEFORE_CLIMB.contains(&word));
    let text = ClimbText { tokens, clauses, before_climb };
    let mut events: Vec<TextEvent> = Vec::new();
    // They are few, because a climb counts only once in a clause.
    let mut climbs_in_clause: Vec<EventContent> = Vec::new();
    for at in 0..tokens.len() {
        if at > 0 && clauses[at] != clauses[at - 1] {
            climbs_in_clause.clear();
        }
        if let Some(what) = text.climb_at(at).filter(|what| !climbs_in_clause.contains(what)) {
            climbs_in_clause.push(what.clone());
            events.push(TextEvent { what, span: tokens.span_of(at, at), clause: clauses[at], denied: false });
        }
        if let Some((floor, last)) = text.storey_at(at) {
            let span = tokens.span_of(at, last);
            events.push(TextEvent { what: EventContent::Floor(floor), span, clause: clauses[at], denied: false });
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
enum ClimbExtent {
    /// At least one flight of stairs.
    Flight,
    /// A few steps, fewer than a flight.
    Steps,
}

impl ClimbExtent {
    fn to_event(self, climb: ClimbDirection, is_command: bool) -> EventContent {
        match self {
            Self::Flight => climb_or_storey(climb, is_command),
            Self::Steps => EventContent::Steps(climb),
        }
    }
}

/// A command to climb, or else a place that lies up or down the stairs.
fn climb_or_storey(climb: ClimbDirection, is_command: bool) -> EventContent {
    if is_command { EventContent::Climb(climb) } else { EventContent::Storey(climb) }
}

/// A text, for questions about single tokens.
struct ClimbText<'a> {
    tokens: TokenSlice<'a>,
    clauses: &'a [usize],
    /// For each token, where the run of adverbs before it begins.
    before_climb: Vec<usize>,
}

impl<'a> ClimbText<'a> {
    fn word_at(&self, at: usize) -> &'a str {
        self.tokens.word_at(at)
    }

    fn word_before(&self, at: usize) -> &'a str {
        self.tokens.word_before(at)
    }

    /// The climb that a token means, or the place up or down the stairs.
    fn climb_at(&self, at: usize) -> Option<EventContent> {
        if self.describes_stairs(at) {
            return None;
        }
        if let Some(climb) = self.climb_without_stairs(at) {
            return Some(EventContent::Climb(climb));
        }
        let next = self.word_at(at + 1);
        match self.word_at(at) {
            "upper" | "lower" | "floor" | "level" | "storey" | "story" => self.other_storey(at),
            "upstairs" => Some(climb_or_storey(ClimbDirection::Up, self.commands_upstairs(at))),
            "downstairs" => Some(climb_or_storey(ClimbDirection::Down, self.commands_upstairs(at))),
            "climb" | "climbing" | "ascend" | "ascending" if next != "down" => {
                Some(self.leads_on(at)?.to_event(ClimbDirection::Up, true))
            }
            "descend" | "descending" => Some(self.leads_on(at)?.to_event(ClimbDirection::Down, true)),
            "up" => {
                Some(self.leads_on(at).or(self.behind_stairs(at))?.to_event(ClimbDirection::Up, self.is_command(at)))
            }
            "down" => {
                Some(self.leads_on(at).or(self.behind_stairs(at))?.to_event(ClimbDirection::Down, self.is_command(at)))
            }
            _ => None,
        }
    }

    /// Another storey as a goal: "take the stairs to the upper floor", "go to the floor above", but not "start on the
    /// upper floor", and not "the stairs to the upper floor".
    fn other_storey(&self, at: usize) -> Option<EventContent> {
        let next = self.word_at(at + 1);
        let is_joint = |word: &str| v::BREAKERS.contains(&word) && !v::DETERMINERS.contains(&word);
        let ends = |at: usize| !self.tokens.is_word(at) || self.word_at(at) == "and" || is_joint(self.word_at(at));
        let (climb, end) = match (self.word_at(at), next) {
            ("upper", _) if is_floor(next) => (ClimbDirection::Up, at + 2),
            ("lower", _) if is_floor(next) => (ClimbDirection::Down, at + 2),
            ("upper" | "lower", _) => return None,
            (_, "above") => (ClimbDirection::Up, at + 2),
            (_, "below") => (ClimbDirection::Down, at + 2),
            _ => return None,
        };
        let to = at.checked_sub(1 + usize::from(v::DETERMINERS.contains(&self.word_before(at))))?;
        let before = self.word_before(to);
        let verb =
            || (to.saturating_sub(4)..to).rev().map(|at| self.word_at(at)).find(|word| v::CLIMBING.contains(word));
        let goes = self.word_at(to) == "to" && (v::CLIMBING.contains(&before) || verb().is_some());
        (goes && ends(end)).then_some(EventContent::Storey(climb))
    }

    /// "Go up.", "head down and turn left", "ascend": a climb that names no stairs.
    fn climb_without_stairs(&self, at: usize) -> Option<ClimbDirection> {
        let (climb, is_verb) = match self.word_at(at) {
            "up" | "upward" | "upwards" => (ClimbDirection::Up, false),
            "down" | "downward" | "downwards" => (ClimbDirection::Down, false),
            "ascend" | "ascending" => (ClimbDirection::Up, true),
            "descend" | "descending" => (ClimbDirection::Down, true),
            "climb" | "climbing" if !self.tokens.is_word(at + 1) => (ClimbDirection::Up, true),
            _ => return None,
        };
        let end = at + 1 + usize::from(matches!(self.word_at(at + 1), "again" | "here" | "there" | "now"));
        let ends =
            !self.tokens.is_word(end) || matches!(self.word_at(end), "and" | "then" | "until" | "till" | "again");
        let verb = self.before_climb(at).map_or("", |before| self.word_at(before));
        let goes =
            is_verb || matches!(verb, "go" | "going" | "head" | "heading" | "walk" | "walking" | "climb" | "step");
        // "Ascend the ramp", "descend to the kitchen"; for "up" and "down", the words behind them decide whether those
        // are climbs.
        let climbs = if is_verb { self.word_at(at + 1) != "down" } else { ends };
        (goes && climbs && self.leads_on(at).is_none()).then_some(climb)
    }

    /// Whether a word of climbing only describes stairs: "the stairs leading up to the bedroom", "the stairs going up",
    /// "the stairs that go up", "the stairs ascending to the attic": the agent need not climb them.
    fn describes_stairs(&self, at: usize) -> bool {
        let Some(before) = self.before_climb(at) else { return false };
        let of_stairs =
            |before: usize| is_stairs(self.word_before(before)) || matches!(self.word_before(before), "that" | "which");
        match self.word_at(before) {
            "leading" | "leads" | "lead" => true,
            "going" | "goes" | "go" | "headed" => of_stairs(before),
            "stairs" | "staircase" | "steps" => matches!(self.word_at(at), "ascending" | "descending"),
            _ => false,
        }
    }

    /// The token before a word of climbing, with adverbs skipped.
    fn before_climb(&self, at: usize) -> Option<usize> {
        self.before_climb[at].checked_sub(1)
    }

    /// How far a climb goes by the words behind "up" or a verb of climbing: "up the old stairs", "up one floor", "up to
    /// the second floor", but not "up to the stairs". `None` where they name no stairs or storey.
    fn leads_on(&self, at: usize) -> Option<ClimbExtent> {
        let to = usize::from(self.word_at(at + 1) == "to");
        let in_phrase = |at: &usize| {
            let (word, name) = (self.word_at(*at), normal_word(self.word_at(*at)));
            let joins = word != "of"
                || matches!(self.word_before(*at), "flight" | "flights" | "set" | "sets" | "rest" | "couple");
            let is_end = is_stairs(word) || (is_floor(word) && !self.is_underfoot(*at));
            let is_noun = (is_thing(&name) || is_room(&name)) && !v::ADJECTIVES.contains(&word);
            let breaks = v::BREAKERS.contains(&word) && !v::DETERMINERS.contains(&word) && word != "of";
            self.tokens.is_word(*at)
                && joins
                && (is_end || !(is_noun || breaks || matches!(word, "passed" | "passing")))
        };
        let phrase: Vec<&str> = (at + 1 + to..at + 7).take_while(in_phrase).map(|at| self.word_at(at)).collect();
        let end = phrase.iter().position(|word| is_floor(word) || (to == 0 && is_stairs(word)))?;
        if is_floor(phrase[end]) && self.is_underfoot(at + 1 + to + end) {
            return None;
        }
        // A storey's height is many steps, and so is a flight.
        let few = phrase[..end].iter().any(|word| v::FEW.contains(word)) && matches!(phrase[end], "steps" | "stairs");
        Some(if few { ClimbExtent::Steps } else { ClimbExtent::Flight })
    }

    /// Whether a "floor" is no storey: "down the tiled floor", "down the wood floor hallway", the ground that one walks
    /// on.
    fn is_underfoot(&self, floor: usize) -> bool {
        let next = normal_word(self.word_at(floor + 1));
        v::FLOORINGS.contains(&self.word_before(floor)) || is_room(&next) || matches!(next.as_str(), "path" | "walkway")
    }

    /// How far a climb goes by the stairs before "up": "take the stairs up", "take the elevator down", but not "take a
    /// few steps down the hallway".
    fn behind_stairs(&self, at: usize) -> Option<ClimbExtent> {
        if v::DETERMINERS.contains(&self.word_at(at + 1)) && self.word_before(at) == "steps" {
            return None;
        }
        let mut words = (at.saturating_sub(4)..at).rev().map(|at| self.word_at(at));
        let taken = words.next().is_some_and(|word| is_stairs(word) || v::CARRIERS.contains(&word))
            && words.any(|word| matches!(word, "take" | "taking" | "follow" | "use" | "ride" | "riding"));
        taken.then_some(ClimbExtent::Flight)
    }

    /// Whether the words are a command to climb, and not a place upstairs or downstairs.
    fn is_command(&self, at: usize) -> bool {
        let Some(before) = self.before_climb(at) else { return true };
        let name = normal_word(self.word_at(before));
        let is_place = is_thing(&name) || is_room(&name);
        let is_carrier = is_stairs(self.word_at(before)) || v::CARRIERS.contains(&self.word_at(before));
        // "To the bathroom up the stairs", but "past the sofa up the stairs".
        !is_place || is_carrier || link_before(self.tokens, self.clauses, before) == PlaceLink::Along
    }

    /// Whether "upstairs" or "downstairs" is a command to climb. Without a verb of going before it, it names a place.
    fn commands_upstairs(&self, at: usize) -> bool {
        let name = normal_word(self.word_at(at + 1));
        if is_thing(&name) || is_room(&name) {
            return false;
        }
        let before = self.before_climb(at).map_or("", |before| self.word_at(before));
        let joined = matches!(self.word_before(at), "and" | "then")
            && !matches!(self.word_at(at + 1), "in" | "at" | "on" | "is");
        v::CLIMBING.contains(&before) || joined
    }

    /// A storey that is named from this token on, and its last token: "level 2", "second floor", "top floor".
    fn storey_at(&self, at: usize) -> Option<(StoreyMention, usize)> {
        let is_numbered = |at: usize| v::floor_number(self.word_at(at));
        let (number, last) = if is_floor(self.word_at(at)) {
            let has_number_before = at > 0 && (is_numbered(at - 1).is_some() || self.word_at(at - 1) == "top");
            (Some(is_numbered(at + 1).filter(|_| !has_number_before)?), at + 1)
        } else if self.word_at(at) == "top" && is_floor(self.word_at(at + 1)) {
            (None, at + 1)
        } else {
            // "Up one floor" and "two floors up" give a number of floors, and not the number of a floor.
            let is_one = matches!(self.word_at(at + 1), "floor" | "level" | "story" | "storey");
            (Some(is_numbered(at).filter(|_| is_one && self.word_at(at) != "one")?), at + 1)
        };
        let in_clause = (0..at).rev().take_while(|before| self.clauses[*before] == self.clauses[at]);
        let words: Vec<&str> = in_clause.map(|before| self.word_at(before)).take(7).collect();
        let joint = words.iter().find(|word| v::BREAKERS.contains(word) && !v::DETERMINERS.contains(word));
        let leaves = joint == Some(&"from") || words.iter().any(|word| v::LEAVING.contains(word));
        let going = |pair: &[&str]| matches!(pair[0], "going" | "goes") && (is_stairs(pair[1]) || pair[1] == "that");
        let aside =
            words.iter().any(|word| matches!(*word, "leading" | "leads" | "lead")) || words.windows(2).any(going);
        Some((StoreyMention { number, leaves, aside }, last))
    }
}
