//! Turns the clauses of reference texts into shapes with slots, so that the writer can fill them with other names.

use super::kind::{Kind, Parts};
use std::collections::BTreeSet;
use wayword_core::Side;
use wayword_language::{
    reading::{Event, Reading, What, read},
    text::{self, Token},
};

/// Most words of a shape.
const MOST_WORDS: usize = 13;

/// A clause of a text, with its joint to the clause before and, if it has one, its shape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Told {
    pub(super) joint: Joint,
    /// Its kind, if it has one.
    pub(super) kind: Option<Kind>,
    pub(super) shape: Option<(Kind, String)>,
    /// Whether it is an order to stop.
    pub(super) stops: bool,
}

/// The words and marks between two clauses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // The names explain themselves.
pub enum Joint {
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

impl Joint {
    /// The words and marks of the joint.
    #[must_use]
    pub fn words(self) -> &'static str {
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
const LINKS: &[&str] = &["and", "then", "next", "now"];

/// The clauses of a text. A shape may consist only of `allowed` words.
pub(super) fn told(text: &str, reading: &Reading, allowed: &BTreeSet<&str>) -> Vec<Told> {
    let tokens = text::tokens(text);
    let (mut clauses, mut end, mut pending) = (Vec::new(), 0, Vec::<&str>::new());
    let mut is_first = true;
    for (number, clause) in reading.clauses.iter().enumerate() {
        let [from, to] = clause.span;
        let of = |token: &&Token| token.span[0] >= from && token.span[1] <= to && token.is_word();
        let words: Vec<&Token> = tokens.iter().filter(of).collect();
        let links = words.iter().take_while(|token| LINKS.contains(&token.word.as_str())).count();
        let between = if from >= end { text.get(end..from).unwrap_or_default() } else { "" };
        pending.push(between);
        pending.extend(words[..links].iter().map(|token| token.word.as_str()));
        end = end.max(to);
        if links == words.len() {
            continue;
        }
        let runs_on = words[links].word == "until" && pending.iter().all(|part| part.trim().is_empty());
        let joint = match () {
            () if is_first => Joint::Start,
            () if runs_on => Joint::Run,
            () => joint(&pending),
        };
        (is_first, pending) = (false, Vec::new());
        let events: Vec<&Event> = reading.events.iter().filter(|event| event.clause == number).collect();
        let stops = events.iter().any(|event| event.what == What::Stop);
        let (kind, shape) = match clause.understood {
            true => shape(&words[links..], &events, allowed),
            false => (None, None),
        };
        clauses.push(Told { joint, kind, shape, stops });
    }
    clauses
}

/// The joint that marks and words make.
fn joint(between: &[&str]) -> Joint {
    let has = |part: &str| between.iter().any(|other| other.contains(part));
    let is = |word: &str| between.contains(&word);
    match (has(".") || has("!") || has(";") || has("\n"), has(","), is("and"), is("then")) {
        (true, _, _, false) => Joint::Stop,
        (true, _, _, true) => Joint::StopThen,
        (false, true, false, false) => Joint::Comma,
        (false, true, true, _) => Joint::CommaAnd,
        (false, true, false, true) => Joint::CommaThen,
        (false, false, true, true) => Joint::AndThen,
        (false, false, false, true) => Joint::Then,
        // Two clauses without any word between them count as joined by "and".
        (false, false, _, false) => Joint::And,
    }
}

/// The kind of a clause, and its shape if it consists of allowed words.
fn shape(words: &[&Token], events: &[&Event], allowed: &BTreeSet<&str>) -> (Option<Kind>, Option<(Kind, String)>) {
    let all: BTreeSet<&str> = words.iter().map(|token| token.word.as_str()).collect();
    let Some(parts) = Parts::of(events) else { return (None, None) };
    let Some(kind) = parts.kind(&all) else { return (None, None) };
    let shape = slotted(words, &parts, kind, allowed).filter(|shape| is_whole(kind, shape));
    (Some(kind), shape.map(|shape| (kind, shape)))
}

/// The words of a clause with slots for its names and sides.
fn slotted(words: &[&Token], parts: &Parts<'_>, kind: Kind, allowed: &BTreeSet<&str>) -> Option<String> {
    if words.len() > MOST_WORDS {
        return None;
    }
    let mut shaped: Vec<&str> = Vec::new();
    for token in words {
        let within = |span: [usize; 2]| token.span[0] >= span[0] && token.span[1] <= span[1];
        let slot = match () {
            () if parts.things.iter().any(|(_, span)| within(*span)) => Some("{l}"),
            () if kind == Kind::LeaveEnter && within(parts.rooms[0].1) => Some("{a}"),
            () if parts.rooms.iter().any(|(_, span)| within(*span)) => Some("{r}"),
            () if matches!(token.word.as_str(), "left" | "right") => {
                let of_turn = parts.turn_span().is_some_and(within);
                Some(if of_turn { "{s}" } else { "{p}" })
            }
            () => None,
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

/// Whether a shape has the slots that its kind needs, each once, and no other.
fn is_whole(kind: Kind, shape: &str) -> bool {
    let count = |slot: &str| shape.matches(slot).count();
    let (s, l, r, a, p) = (count("{s}"), count("{l}"), count("{r}"), count("{a}"), count("{p}"));
    let fits = match kind {
        Kind::Turn
        | Kind::TurnSlightly
        | Kind::TurnThroughDoor
        | Kind::TurnAtDoor
        | Kind::TurnAtTop
        | Kind::TurnAtBottom => (s, l, r, a, p) == (1, 0, 0, 0, 0),
        Kind::TurnAt => (s, l, r, a, p) == (1, 1, 0, 0, 0),
        Kind::TurnIn | Kind::TurnInto | Kind::TurnOut | Kind::TurnAtEnd => (s, l, r, a, p) == (1, 0, 1, 0, 0),
        // "The room" can replace its name.
        Kind::Enter | Kind::Leave | Kind::Through | Kind::StopIn => (s, l, a, p) == (0, 0, 0, 0) && r <= 1,
        Kind::LeaveByDoor | Kind::EnterThroughDoor | Kind::StopInDoorwayOf | Kind::Along | Kind::AlongToEnd => {
            (s, l, r, a, p) == (0, 0, 1, 0, 0)
        }
        Kind::EnterWith => (s, l, a, p) == (0, 1, 0, 0) && r <= 1,
        Kind::LeaveEnter => (s, l, r, a, p) == (0, 0, 1, 1, 0),
        Kind::Pass | Kind::To | Kind::StopAt => (s, l, r, a, p) == (0, 1, 0, 0, 0),
        Kind::EnterOnSide => (s, l, r, a, p) == (0, 0, 1, 0, 1),
        Kind::DoorOnSide => (s, l, r, a, p) == (0, 0, 0, 0, 1),
        Kind::PassEnter | Kind::StopAtIn => (s, l, r, a, p) == (0, 1, 1, 0, 0),
        Kind::PassOnSide => (s, l, r, a, p) == (0, 1, 0, 0, 1),
        _ => (s, l, r, a, p) == (0, 0, 0, 0, 0),
    };
    let may_run = !is_until(shape) || matches!(kind, Kind::To | Kind::ToDoor);
    fits && may_run && is_english(shape)
}

/// Words that cannot end a clause.
const DANGLING: &[&str] = &["the", "a", "an", "of", "to", "your", "on", "in", "at"];
/// Words that cannot begin a clause of its own.
const FRAGMENTS: &[&str] =
    &["down", "past", "into", "through", "once", "when", "out", "{s}", "up", "across", "along", "the", "on", "off"];

/// Whether a shape limits the clause before it, as in "until you reach the sofa".
#[must_use]
pub fn is_until(shape: &str) -> bool {
    shape.starts_with("until ")
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
    let is_whole = !FRAGMENTS.contains(&words[0]) && !DANGLING.contains(&words[words.len() - 1]);
    is_whole && words.iter().enumerate().all(fits)
}

/// Whether a shape, filled with new names, is read as a clause of the same kind and shape, and understood completely.
pub(super) fn reads_the_same(kind: Kind, shape: &str, allowed: &BTreeSet<&str>) -> bool {
    let room = if matches!(kind, Kind::Along | Kind::AlongToEnd | Kind::TurnAtEnd) { "hallway" } else { "bedroom" };
    [("left", "sofa"), ("right", "desk")].iter().all(|(side, thing)| {
        let filled = shape
            .replace("{s}", side)
            .replace("{p}", side)
            .replace("{l}", thing)
            .replace("{r}", room)
            .replace("{a}", "kitchen");
        let reading = read(&filled, &BTreeSet::new());
        let clauses = told(&filled, &reading, allowed);
        let all_understood = reading.clauses.iter().all(|clause| clause.understood);
        let same_side = reading.events.iter().all(|event| match &event.what {
            What::Turn(Side::Left) => *side == "left",
            What::Turn(Side::Right) => *side == "right",
            _ => true,
        });
        let is_same =
            matches!(clauses.as_slice(), [one] if one.shape.as_ref().is_some_and(|(a, b)| *a == kind && b == shape));
        all_understood && same_side && is_same
    })
}
