//! Turns the clauses of reference texts into shapes with slots, so that the writer can fill them with other names.

use super::kind::{ClauseKind, ClauseParts, is_door_word};
use std::collections::BTreeSet;
use wayword_core::Side;
use wayword_language::{
    reading::{EventContent, TextEvent, TextReading, read_instruction},
    text::TextToken,
};

/// Most words of a shape; a clause with more has no shape.
const MAX_SHAPE_WORDS: usize = 13;

/// A clause of a text, with its joint to the clause before and, if it has one, its shape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::style) struct ShapedClause {
    pub(in crate::style) joint: ClauseJoint,
    /// Its kind, if it has one.
    pub(in crate::style) kind: Option<ClauseKind>,
    /// Its kind and its words with slots, if they make a shape that the writer can use.
    pub(in crate::style) shape: Option<(ClauseKind, String)>,
    /// The byte ranges of its words, without those that join it to the clause before.
    pub(in crate::style) words: Vec<[usize; 2]>,
    /// The byte ranges of its names, with their slots; empty for a clause without a kind.
    pub(in crate::style) names: Vec<([usize; 2], &'static str)>,
    /// Whether it is an order to stop.
    pub(in crate::style) stops: bool,
}

/// The words and marks between two clauses. `Start` is before the first clause of a text; `Stop` is a full stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // The names explain themselves.
pub enum ClauseJoint {
    Start,
    Stop,
    StopThen,
    And,
    AndThen,
    Comma,
    CommaAnd,
    CommaThen,
    Then,
    /// "Walk straight until you reach the sofa".
    Run,
}

impl ClauseJoint {
    /// The words and marks of the joint.
    #[must_use]
    pub fn joining_words(self) -> &'static str {
        match self {
            Self::Start => "",
            Self::Stop => ". ",
            Self::StopThen => ". then ",
            Self::And => " and ",
            Self::AndThen => " and then ",
            Self::Comma => ", ",
            Self::CommaAnd => ", and ",
            Self::CommaThen => ", then ",
            Self::Then => " then ",
            Self::Run => " ",
        }
    }

    /// Whether a new sentence begins.
    #[must_use]
    pub fn begins_sentence(self) -> bool {
        matches!(self, Self::Start | Self::Stop | Self::StopThen)
    }
}

/// Words that join clauses and do not belong to a shape.
const JOINING_WORDS: &[&str] = &["and", "then", "next", "now"];

/// The clauses of a text. A shape may consist only of `allowed` words.
pub(in crate::style) fn shape_clauses(
    text: &str,
    reading: &TextReading,
    allowed: &BTreeSet<&str>,
) -> Vec<ShapedClause> {
    let (mut clauses, mut end, mut pending) = (Vec::new(), 0, Vec::<&str>::new());
    let mut is_first = true;
    for (number, clause) in reading.clauses.iter().enumerate() {
        let [from, to] = clause.span;
        let is_in_clause = |token: &&TextToken| token.span[0] >= from && token.span[1] <= to && token.is_word();
        let words: Vec<&TextToken> = reading.tokens().iter().filter(is_in_clause).collect();
        let links = words.iter().take_while(|token| JOINING_WORDS.contains(&token.word.as_str())).count();
        let between = if from >= end { text.get(end..from).unwrap_or_default() } else { "" };
        pending.push(between);
        pending.extend(words[..links].iter().map(|token| token.word.as_str()));
        end = end.max(to);
        if links == words.len() {
            continue;
        }
        let runs_on = words[links].word == "until" && pending.iter().all(|part| part.trim().is_empty());
        let joint = match () {
            () if is_first => ClauseJoint::Start,
            () if runs_on => ClauseJoint::Run,
            () => joint_between(&pending),
        };
        (is_first, pending) = (false, Vec::new());
        let events: Vec<&TextEvent> = reading.events.iter().filter(|event| event.clause == number).collect();
        let stops = events.iter().any(|event| event.what == EventContent::Stop);
        let words = &words[links..];
        let mut shaped = ShapedClause {
            joint,
            kind: None,
            shape: None,
            words: words.iter().map(|token| token.span).collect(),
            names: Vec::new(),
            stops,
        };
        if clause.understood {
            shaped.add_shape(words, &events, allowed);
        }
        clauses.push(shaped);
    }
    clauses
}

/// The joint that marks and words make.
fn joint_between(between: &[&str]) -> ClauseJoint {
    let has = |part: &str| between.iter().any(|other| other.contains(part));
    let is = |word: &str| between.contains(&word);
    match (has(".") || has("!") || has(";") || has("\n"), has(","), is("and"), is("then")) {
        (true, _, _, false) => ClauseJoint::Stop,
        (true, _, _, true) => ClauseJoint::StopThen,
        (false, true, false, false) => ClauseJoint::Comma,
        (false, true, true, _) => ClauseJoint::CommaAnd,
        (false, true, false, true) => ClauseJoint::CommaThen,
        (false, false, true, true) => ClauseJoint::AndThen,
        (false, false, false, true) => ClauseJoint::Then,
        // Two clauses without any word between them count as joined by "and".
        (false, false, _, false) => ClauseJoint::And,
    }
}

impl ShapedClause {
    /// Finds its kind with its names, and its shape if it consists of allowed words.
    fn add_shape(&mut self, words: &[&TextToken], events: &[&TextEvent], allowed: &BTreeSet<&str>) {
        let all: BTreeSet<&str> = words.iter().map(|token| token.word.as_str()).collect();
        let Some(parts) = ClauseParts::from_events(events) else { return };
        let Some(kind) = parts.clause_kind(&all) else { return };
        self.kind = Some(kind);
        self.names = parts.named_slots(kind);
        let shape = words_with_slots(words, &self.names, &parts, allowed).filter(|shape| is_whole(kind, shape));
        self.shape = shape.map(|shape| (kind, shape));
    }
}

/// The words of a clause with slots for its names and sides.
fn words_with_slots(
    words: &[&TextToken],
    names: &[([usize; 2], &'static str)],
    parts: &ClauseParts<'_>,
    allowed: &BTreeSet<&str>,
) -> Option<String> {
    if words.len() > MAX_SHAPE_WORDS {
        return None;
    }
    let mut shaped: Vec<&str> = Vec::new();
    for token in words {
        let within = |span: [usize; 2]| token.span[0] >= span[0] && token.span[1] <= span[1];
        let slot = match names.iter().find(|(span, _)| within(*span)) {
            Some((_, slot)) => Some(*slot),
            None if matches!(token.word.as_str(), "left" | "right") => {
                let of_turn = parts.turn_span().is_some_and(within);
                Some(if of_turn { "{s}" } else { "{p}" })
            }
            None => None,
        };
        let word = match slot {
            Some(slot) => slot,
            None => *allowed.get(token.word.as_str())?,
        };
        if slot.is_none() || shaped.last() != Some(&word) {
            shaped.push(word);
        }
    }
    Some(shaped.join(" "))
}

/// Whether a shape of English words has the slots of its kind and is a clause of its own ([`ClauseKind`] explains the slots).
fn is_whole(kind: ClauseKind, shape: &str) -> bool {
    let may_run = !is_until(shape) || matches!(kind, ClauseKind::To | ClauseKind::ToDoor);
    has_its_slots(kind, shape) && may_run && is_english(shape)
}

/// Whether a shape has the slots that its kind needs, each once, and no other.
pub(in crate::style) fn has_its_slots(kind: ClauseKind, shape: &str) -> bool {
    let count = |slot: &str| shape.matches(slot).count();
    let (s, l, r, a, p) = (count("{s}"), count("{l}"), count("{r}"), count("{a}"), count("{p}"));
    match kind {
        ClauseKind::Turn
        | ClauseKind::TurnSlightly
        | ClauseKind::TurnThroughDoor
        | ClauseKind::TurnAtDoor
        | ClauseKind::TurnAtTop
        | ClauseKind::TurnAtBottom => (s, l, r, a, p) == (1, 0, 0, 0, 0),
        ClauseKind::TurnAt => (s, l, r, a, p) == (1, 1, 0, 0, 0),
        ClauseKind::TurnIn | ClauseKind::TurnInto | ClauseKind::TurnOut | ClauseKind::TurnAtEnd => {
            (s, l, r, a, p) == (1, 0, 1, 0, 0)
        }
        // "The room" can replace its name.
        ClauseKind::Enter | ClauseKind::Leave | ClauseKind::Through | ClauseKind::StopIn => {
            (s, l, a, p) == (0, 0, 0, 0) && r <= 1
        }
        ClauseKind::LeaveByDoor
        | ClauseKind::EnterThroughDoor
        | ClauseKind::StopInDoorwayOf
        | ClauseKind::Along
        | ClauseKind::AlongToEnd => (s, l, r, a, p) == (0, 0, 1, 0, 0),
        ClauseKind::EnterWith => (s, l, a, p) == (0, 1, 0, 0) && r <= 1,
        ClauseKind::LeaveEnter => (s, l, r, a, p) == (0, 0, 1, 1, 0),
        ClauseKind::Pass | ClauseKind::To | ClauseKind::StopAt => (s, l, r, a, p) == (0, 1, 0, 0, 0),
        ClauseKind::EnterOnSide => (s, l, r, a, p) == (0, 0, 1, 0, 1),
        ClauseKind::DoorOnSide => (s, l, r, a, p) == (0, 0, 0, 0, 1),
        ClauseKind::PassEnter | ClauseKind::StopAtIn => (s, l, r, a, p) == (0, 1, 1, 0, 0),
        ClauseKind::PassOnSide => (s, l, r, a, p) == (0, 1, 0, 0, 1),
        _ => (s, l, r, a, p) == (0, 0, 0, 0, 0),
    }
}

/// Words that cannot end a clause.
const DANGLING_WORDS: &[&str] = &["the", "a", "an", "of", "to", "your", "on", "in", "at"];
/// Words that cannot begin a clause of its own.
const FRAGMENT_OPENERS: &[&str] =
    &["down", "past", "into", "through", "once", "when", "out", "{s}", "up", "across", "along", "the", "on", "off"];

/// Whether a shape limits the clause before it, as in "until you reach the sofa".
#[must_use]
pub fn is_until(shape: &str) -> bool {
    shape.starts_with("until ")
}

/// What a shape tells beside its kind, on which it depends where the shape fits.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ShapeTraits {
    /// It has "straight" or the like.
    pub goes_straight: bool,
    /// It tells that its thing is in front of the walker.
    pub says_front: bool,
    /// It names a room.
    pub names_room: bool,
    /// It has "the room" without a name.
    pub says_room: bool,
    /// It leads into the open air.
    pub goes_outside: bool,
    /// It means the part of the room by its door.
    pub is_at_door: bool,
    /// It has "at the kitchen".
    pub is_at_room: bool,
    /// It leads out of a room.
    pub leaves: bool,
    /// It limits the clause before it, as in "until you reach the sofa".
    pub is_until: bool,
    /// It has "past" or "after".
    pub says_past: bool,
    /// It has "all the way".
    pub goes_all_the_way: bool,
    /// Its words for doors, in English.
    pub doors: Vec<String>,
}

impl ShapeTraits {
    /// Whether a shape of any language names its thing before its room.
    #[must_use]
    pub fn names_thing_first(shape: &str) -> bool {
        matches!((shape.find("{l}"), shape.find("{r}")), (Some(thing), Some(room)) if thing < room)
    }

    /// The traits of an English shape.
    #[must_use]
    pub fn of_english(shape: &str) -> Self {
        let has = |any: &[&str]| any.iter().any(|part| shape.contains(part));
        Self {
            goes_straight: has(&["straight", "forward", "ahead"]),
            says_front: has(&["front"]),
            names_room: has(&["{r}"]),
            says_room: shape.split(' ').any(|word| word == "room"),
            goes_outside: has(&["onto the {r}", "out into the {r}"]),
            is_at_door: has(&["just inside", "once you", "doorway", "at the {r}"]),
            is_at_room: has(&["at the {r}"]),
            leaves: has(&["exit", "leave", "out "]),
            is_until: is_until(shape),
            says_past: has(&["past", "after"]),
            goes_all_the_way: has(&["all the way"]),
            // The first word is the verb: "exit".
            doors: shape.split(' ').skip(1).filter(|word| is_door_word(word)).map(str::to_owned).collect(),
        }
    }
}

/// Whether a shape is a correct clause of its own: it has an article before each name and adds no detail to its kind.
/// "Next" and "front" are only allowed in "next to" and "in front of", and a thing cannot be entered.
fn is_english(shape: &str) -> bool {
    let words: Vec<&str> = shape.split(' ').collect();
    let before = |at: usize| at.checked_sub(1).map_or("", |at| words[at]);
    let after = |at: usize| words.get(at + 1).copied().unwrap_or_default();
    let fits = |(at, word): (usize, &&str)| match *word {
        "{l}" => {
            let link = at.checked_sub(2).map_or("", |at| words[at]);
            let in_front = link == "of" && at >= 3 && words[at - 3] == "front";
            before(at) == "the" && (in_front || !matches!(link, "in" | "inside" | "into" | "on" | "of"))
        }
        "{r}" | "{a}" => before(at) == "the",
        "{p}" => matches!(before(at), "the" | "your"),
        "next" => after(at) == "to",
        "toward" | "towards" => !shape.contains("{r}"),
        "front" => after(at) == "of",
        "room" => !shape.contains("{r}"),
        "foot" | "bottom" | "top" => shape.contains("stair") || shape.contains("step"),
        _ => true,
    };
    let is_whole = !FRAGMENT_OPENERS.contains(&words[0]) && !DANGLING_WORDS.contains(&words[words.len() - 1]);
    is_whole && words.iter().enumerate().all(fits)
}

/// Whether a shape, filled with new names, is read as a clause of the same kind and shape, and understood completely.
pub(super) fn reads_the_same(kind: ClauseKind, shape: &str, allowed: &BTreeSet<&str>) -> bool {
    let room = if matches!(kind, ClauseKind::Along | ClauseKind::AlongToEnd | ClauseKind::TurnAtEnd) {
        "hallway"
    } else {
        "bedroom"
    };
    [("left", "sofa"), ("right", "desk")].iter().all(|(side, thing)| {
        let filled = shape
            .replace("{s}", side)
            .replace("{p}", side)
            .replace("{l}", thing)
            .replace("{r}", room)
            .replace("{a}", "kitchen");
        let reading = read_instruction(&filled, &BTreeSet::new());
        let clauses = shape_clauses(&filled, &reading, allowed);
        let all_understood = reading.clauses.iter().all(|clause| clause.understood);
        let same_side = reading.events.iter().all(|event| match &event.what {
            EventContent::Turn(Side::Left) => *side == "left",
            EventContent::Turn(Side::Right) => *side == "right",
            _ => true,
        });
        let is_same =
            matches!(clauses.as_slice(), [one] if one.shape.as_ref().is_some_and(|(a, b)| *a == kind && b == shape));
        all_understood && same_side && is_same
    })
}
