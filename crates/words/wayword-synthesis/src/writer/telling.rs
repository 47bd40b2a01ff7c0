//! The clauses of a way in the words of its style.

use super::{
    Brief,
    dice::Dice,
    draft::Draft,
    landmarks::Landmarks,
    naming::Lengths,
    route::{self, Clause, KEPT, fill, stands_still, usable_room},
    task,
};
use crate::style::way::Kind;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use wayword_checks::Matter;
use wayword_language::text::word_count;

/// A text may be longer or shorter than its style's by this, words.
const SLACK: f64 = 2.0;
/// A way is planned so often until a text copies nothing from the style's references and has its length.
const PLANS: usize = 8;
/// And words that are copied are replaced so often.
const WORDINGS: usize = 24;
/// A text is no more words off its length than this.
const OFF: usize = 6;
/// What a copy is worth less, in words off the length, and what a text that shares eight words with a reference.
const COPIED: usize = 300;
const SHARED: usize = 100;
/// And what a text that is too long.
const OVER: usize = 1000;
/// No text is cut shorter than this, words.
const LEAST_WORDS: usize = 8;
/// Clauses of less weight than this are left out of a text that is longer than its style's.
const OPTIONAL: u8 = 3;

/// A text that describes the way step by step. `task` is what to do at the end, in words, with the name of its object.
pub(super) fn the_way(brief: &Brief<'_>, task: Option<&(String, String)>, dice: Dice) -> String {
    let words = brief.length().max(LEAST_WORDS);
    let end = brief.memory.frames().saturating_sub(1);
    let rooms: Vec<String> = brief.memory.room(end).map(str::to_owned).into_iter().collect();
    let matter = Matter { target: task.map(|(_, name)| name.as_str()), rooms: &rooms };
    let copies = &brief.profile.copies;
    let mut best: Option<(usize, String)> = None;
    for number in 0..PLANS {
        let dice = dice.other(number);
        let plan = Plan::of(brief, task, words, dice);
        let mut draft = plan.worded(brief, task, dice);
        for wording in 0..WORDINGS {
            let (text, starts) = draft.text();
            let (copied, shared) = (copies.copied(&text, matter), copies.much(&text));
            let cost = if copied.is_some() { COPIED } else { 0 } + if shared.is_some() { SHARED } else { 0 };
            let is_over = word_count(&text) >= brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
            let worth = word_count(&text).abs_diff(words) + cost + if is_over { OVER } else { 0 };
            if best.as_ref().is_none_or(|(least, _)| worth < *least) {
                best = Some((worth, text));
            }
            let Some(span) = copied.or(shared) else { break };
            draft.reword(span, &starts, brief, dice.other(wording));
        }
        if best.as_ref().is_some_and(|(worth, _)| *worth <= OFF) {
            break;
        }
    }
    best.map(|(_, text)| text).unwrap_or_default()
}

/// What a text says, clause by clause.
struct Plan {
    clauses: Vec<Clause>,
    full_stop: bool,
}

impl Plan {
    /// One of about so many words.
    fn of(brief: &Brief<'_>, task: Option<&(String, String)>, words: usize, dice: Dice) -> Self {
        let mut landmarks = Landmarks::new(brief, dice);
        if let Some((_, name)) = task {
            landmarks.reserve(name);
        }
        let mut clauses = route::clauses(brief, &mut landmarks, dice);
        fill::name_a_thing(&mut clauses, brief, &mut landmarks, dice);
        let mut lengths = Lengths::of(&brief.profile.way);
        while lengths.sum(&clauses) > words as f64 + SLACK && drop_least(&mut clauses, OPTIONAL) {}
        let mut times = 0;
        while lengths.sum(&clauses) < words as f64 - SLACK && !stands_still(brief.walk) {
            if !fill::fill(&mut clauses, brief, &mut landmarks, dice.other(times)) {
                break;
            }
            times += 1;
        }
        Self { clauses, full_stop: dice.by(&["full stop"]).random_bool(brief.profile.full_stops.clamp(0.0, 1.0)) }
    }

    fn worded<'a>(&self, brief: &'a Brief<'_>, task: Option<&(String, String)>, dice: Dice) -> Draft<'a> {
        let mut clauses = self.clauses.clone();
        let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
        let task = task.map(|(task, _)| task.as_str());
        loop {
            let mut told = clauses.clone();
            mend(&mut told, brief);
            let draft = Draft::of(told, task, self.full_stop, brief, dice);
            if word_count(&draft.text().0) < limit || !drop_least(&mut clauses, KEPT) {
                return draft;
            }
        }
    }
}

/// Leaves out the clause that matters least, if one matters less than `below`.
fn drop_least(clauses: &mut Vec<Clause>, below: u8) -> bool {
    let candidates = clauses.iter().enumerate().filter(|(_, clause)| clause.weight < below);
    let Some((at, _)) = candidates.min_by_key(|(at, clause)| (clause.weight, *at)) else { return false };
    clauses.remove(at);
    true
}

/// Puts right what leaving out clauses may have broken: a room that is left was entered, and of two turns in a row the
/// second has a place.
fn mend(clauses: &mut Vec<Clause>, brief: &Brief<'_>) {
    let start = brief.memory.room(0).and_then(usable_room);
    let mut known: BTreeSet<String> = start.into_iter().collect();
    clauses.retain(|clause| {
        let leaves = matches!(clause.kind, Kind::Leave | Kind::LeaveByDoor | Kind::TurnOut);
        let is_known = !leaves || clause.from.as_ref().is_none_or(|from| known.contains(from));
        if !leaves && clause.kind.names_room() {
            known.extend(clause.room.clone());
        }
        is_known || clause.kind == Kind::TurnOut
    });
    for at in 0..clauses.len() {
        if let Kind::LeaveEnter | Kind::TurnOut = clauses[at].kind {
            let from = clauses[at].from.clone();
            let leaves = |clause: &Clause| matches!(clause.kind, Kind::Leave | Kind::LeaveByDoor);
            let names = |clause: &Clause| clause.kind.names_room() && !leaves(clause);
            let entered = clauses[..at].iter().any(|clause| names(clause) && clause.room == from);
            if !entered && from != brief.memory.room(0).map(str::to_owned) {
                let is_turn = clauses[at].kind == Kind::TurnOut;
                clauses[at].kind = if is_turn { Kind::Turn } else { Kind::Enter };
            }
        }
    }
    for at in 1..clauses.len() {
        if clauses[at].is_bare() && clauses[at - 1].is_bare() {
            give_place(&mut clauses[at], brief);
        }
    }
    while let Some(at) = (1..clauses.len()).find(|at| clauses[*at].is_bare() && clauses[*at - 1].is_bare()) {
        let mut onward = clauses[at].clone();
        onward.kind = Kind::Straight;
        clauses.insert(at, onward);
    }
}

/// A turn in the room in which it happens.
fn give_place(clause: &mut Clause, brief: &Brief<'_>) {
    let room = brief.memory.room(clause.at).and_then(usable_room);
    if clause.kind == Kind::Turn && room.is_some() {
        (clause.kind, clause.room) = (Kind::TurnIn, room);
    }
}

/// The task of a text that ends in one.
pub(super) fn ending(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<Option<(String, String)>, super::WriteError> {
    let ends = brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    if ends { task::task(brief, rng).map(Some) } else { Ok(None) }
}
