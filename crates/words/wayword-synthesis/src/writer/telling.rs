//! Writes a text that describes the way step by step.
//!
//! Several plans are made for the drawn length. The best is put into words, and phrases that copy a reference are
//! replaced until none does or the attempts are used up.

use super::{
    Brief,
    dice::Dice,
    draft::Draft,
    landmarks::Landmarks,
    naming::Lengths,
    route::{self, Clause, KEPT, LONG_M, carry_out, fill, numbered, stands_still, usable_room, with_stand_ins},
    task,
};
use crate::style::way::Kind;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use wayword_checks::Matter;
use wayword_language::text::word_count;

/// Tolerance around the drawn length while a plan is filled or cut, words.
const SLACK: f64 = 2.0;
/// A plan that misses its length by at most this is as good as an exact one, words.
const OFF: f64 = 5.0;
/// Greatest length of a plan with a thing in every place, as a multiple of the drawn length.
const MOST: f64 = 1.1;
/// Most plans that are tried until one has the right length and copies no reference.
const PLANS: usize = 8;
/// Most replacements of copied phrases for each plan.
const WORDINGS: usize = 24;
/// Costs of a copied phrase, of a run of words shared with a reference, and of too many words.
const COPIED: usize = 3;
const SHARED: usize = 1;
const OVER: usize = 10;
/// Least number of words of a text.
const LEAST_WORDS: usize = 8;
/// Only clauses below this weight are dropped from a text that is too long.
const OPTIONAL: u8 = 3;

/// A text that describes the way step by step. `task` is what to do at the end, in words, with the name of its object.
pub(super) fn the_way(brief: &Brief<'_>, task: Option<&(String, String)>, dice: Dice) -> String {
    let words = brief.length().max(LEAST_WORDS);
    let end = brief.memory.frames().saturating_sub(1);
    let rooms: Vec<String> = brief.memory.room(end).map(str::to_owned).into_iter().collect();
    let matter = Matter { target: task.map(|(_, name)| name.as_str()), rooms: &rooms };
    let copies = &brief.profile.copies;
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let mut best: Option<(usize, String)> = None;
    for (plan, dice) in plans(brief, words as f64, dice) {
        let mut draft = plan.worded(brief, task, dice);
        for _ in 0..WORDINGS {
            let (text, starts) = draft.text();
            let (copied, shared) = (copies.copied(&text, matter), copies.much(&text));
            let is_over = word_count(&text) >= limit;
            let cost = [(copied.is_some(), COPIED), (shared.is_some(), SHARED), (is_over, OVER)];
            let cost = cost.iter().filter(|(is_so, _)| *is_so).map(|(_, cost)| cost).sum();
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, text));
            }
            let Some(span) = copied.or(shared) else { break };
            draft.reword(span, &starts, brief, dice);
        }
        if best.as_ref().is_some_and(|(cost, _)| *cost == 0) {
            break;
        }
    }
    best.map(|(_, text)| text).unwrap_or_default()
}

/// Several plans of a text with their sources of random draws, those nearest to its length first.
fn plans(brief: &Brief<'_>, words: f64, dice: Dice) -> Vec<(Plan, Dice)> {
    let numbered = (0..PLANS).map(|number| dice.other(number));
    let mut plans: Vec<(Plan, Dice)> = numbered.map(|dice| (Plan::of(brief, words, dice), dice)).collect();
    // The sort is stable: of plans that are near enough, the first is taken.
    plans.sort_by_key(|(plan, _)| (plan.off - OFF).max(0.0).round() as u64);
    plans
}

/// The plan of a text, clause by clause. It depends on the way alone; things are filled into its places later.
struct Plan {
    clauses: Vec<Clause>,
    full_stop: bool,
    /// Difference from the drawn length, words, as far as it is known before things are filled in.
    off: f64,
}

impl Plan {
    /// A plan of about this many words.
    fn of(brief: &Brief<'_>, words: f64, dice: Dice) -> Self {
        let mut clauses = route::clauses(brief, dice);
        if !stands_still(brief.walk) {
            fill::offer_places(&mut clauses, brief, dice);
        }
        let mut lengths = Lengths::of(&brief.profile.way);
        let mut is_long =
            |plan: &[Clause]| lengths.expected(plan) > words + SLACK || lengths.most(plan) > words * MOST + SLACK;
        while is_long(&clauses) && drop_least(&mut clauses, OPTIONAL) {}
        let mut is_short =
            |plan: &[Clause]| lengths.expected(plan) < words - SLACK && lengths.most(plan) < words * MOST;
        let mut times = 0;
        while is_short(&clauses) && !stands_still(brief.walk) {
            if !fill::fill(&mut clauses, brief, dice.other(times)) {
                break;
            }
            times += 1;
        }
        let over = lengths.most(&clauses) - words * MOST;
        let off = (lengths.expected(&clauses) - words).abs().max(over);
        Self { off, clauses, full_stop: dice.by(&["full stop"]).random_bool(brief.profile.full_stops.clamp(0.0, 1.0)) }
    }

    fn worded<'a>(&self, brief: &'a Brief<'_>, task: Option<&(String, String)>, dice: Dice) -> Draft<'a> {
        let mut landmarks = Landmarks::new(brief, dice);
        if let Some((_, name)) = task {
            landmarks.reserve(name);
        }
        let mut clauses = self.clauses.clone();
        let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
        let task = task.map(|(task, _)| task.as_str());
        loop {
            let mut plan = clauses.clone();
            mend(&mut plan, brief);
            let told = carry_out(&numbered(with_stand_ins(plan, brief.memory)), brief, &landmarks, dice);
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

/// Repairs a plan after clauses were dropped: a room that is left must have been entered, and of two consecutive turns
/// the second needs a place.
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
        let onward = clauses[at].straight_on();
        clauses.insert(at, onward);
    }
    bridge(clauses, brief);
}

/// Lets a place for a thing fall back to "go straight": between two consecutive turns, and on a long last stretch that
/// no other clause describes.
fn bridge(clauses: &mut [Clause], brief: &Brief<'_>) {
    let told: Vec<usize> = (0..clauses.len()).filter(|at| !clauses[*at].is_offer()).collect();
    let befores = std::iter::once(None).chain(told.iter().map(|at| Some(*at)));
    let pairs: Vec<(Option<usize>, usize)> = befores.zip(told.iter().copied()).collect();
    for (before, at) in pairs {
        let is_end = at + 1 == clauses.len();
        let needs = match before {
            None => is_end,
            Some(before) if is_end => brief.walk.walked_m(clauses[before].at, clauses[at].at) >= LONG_M,
            Some(before) => clauses[before].is_bare() && clauses[at].is_bare(),
        };
        let first = before.map_or(0, |before| before + 1);
        if let Some(between) = clauses[first..at].first_mut().filter(|_| needs) {
            between.or_straight_on();
        }
    }
}

/// Turns a plain turn into one that names its room.
fn give_place(clause: &mut Clause, brief: &Brief<'_>) {
    let room = brief.memory.room(clause.at).and_then(usable_room);
    if clause.kind == Kind::Turn && room.is_some() {
        (clause.kind, clause.room) = (Kind::TurnIn, room);
    }
}

/// Draws the task, if this text ends in one.
pub(super) fn ending(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<Option<(String, String)>, super::WriteError> {
    let ends = brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    if ends { task::task(brief, rng).map(Some) } else { Ok(None) }
}
