//! Writes a text that describes the way step by step.
//!
//! Several plans are made for the drawn length. The best is put into words, and phrases that copy a reference are
//! replaced until none does or the attempts are used up.

use super::{
    WritingBrief,
    dice::TextDice,
    draft::TextDraft,
    landmarks::LandmarkChooser,
    naming::ClauseLengths,
    route::{
        self, KEPT_WEIGHT, LONG_HOP_M, WayClause, carry_out, fill, number_clauses, stands_still, usable_room,
        with_stand_ins,
    },
    task::{TaskPhrase, draw_task},
};
use crate::style::way::ClauseKind;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use wayword_checks::TextTopic;
use wayword_language::text::{split_tokens, word_count};

/// Tolerance around the drawn length while a plan is filled or cut, words.
const LENGTH_SLACK_WORDS: f64 = 2.0;
/// A plan that misses its length by at most this is as good as an exact one, words.
const PLAN_LENGTH_TOLERANCE_WORDS: f64 = 5.0;
/// Greatest length of a plan with a thing in every place, as a multiple of the drawn length.
const MAX_LENGTH_RATIO: f64 = 1.1;
/// Most plans that are tried until one has the right length and copies no reference.
const MAX_PLANS: usize = 8;
/// Most replacements of copied phrases for each plan.
const MAX_REWORDINGS: usize = 24;
/// Cost of a copied phrase. Of several texts the cheapest is taken, and one without cost at once.
const COPIED_COST: usize = 3;
/// Cost of a run of words shared with a reference.
const SHARED_COST: usize = 1;
/// Cost of too many words.
const OVER_LIMIT_COST: usize = 10;
/// Least number of words that a text is planned for.
const MIN_PLANNED_WORDS: usize = 8;
/// Only clauses below this weight are dropped from a text that is too long.
const OPTIONAL_BELOW_WEIGHT: u8 = 3;
/// A turn so near to the start is made at once, metres.
const MAX_AT_ONCE_M: f64 = 1.0;
/// A door or room "on the right" so near to the start is the first one there, metres.
const MAX_FIRST_DOOR_M: f64 = 2.0;

/// A text that describes the way step by step, and its draft; `None` only where no plan is tried. `task` is what to do at the end.
pub(super) fn write_way_text<'a>(
    brief: &'a WritingBrief<'_>,
    task: Option<&TaskPhrase>,
    dice: TextDice,
) -> Option<(String, TextDraft<'a>)> {
    let words = brief.target_words().max(MIN_PLANNED_WORDS);
    let end = brief.memory.frame_count().saturating_sub(1);
    let rooms: Vec<String> = brief.memory.room_at(end).map(str::to_owned).into_iter().collect();
    let topic = TextTopic { target: task.map(|task| task.name.as_str()), rooms: &rooms };
    let copies = &brief.profile.copies;
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let mut best: Option<(usize, (String, TextDraft<'_>))> = None;
    for (plan, dice) in ranked_plans(brief, words as f64, dice) {
        let mut draft = plan.draft_for_plan(brief, task, dice);
        for _ in 0..MAX_REWORDINGS {
            let (text, starts) = draft.text_and_starts();
            let tokens = split_tokens(&text);
            let (copied, shared) = (copies.find_copy(&tokens, topic), copies.find_avoidable_copy(&tokens));
            let is_over = word_count(&text) >= limit;
            let cost = [(copied.is_some(), COPIED_COST), (shared.is_some(), SHARED_COST), (is_over, OVER_LIMIT_COST)];
            let cost = cost.iter().filter(|(is_so, _)| *is_so).map(|(_, cost)| cost).sum();
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, (text, draft.clone())));
            }
            let Some(span) = copied.or(shared) else { break };
            draft.reword_span(span, &starts, brief, dice);
        }
        if best.as_ref().is_some_and(|(cost, _)| *cost == 0) {
            break;
        }
    }
    best.map(|(_, best)| best)
}

/// Several plans of a text with their sources of random draws, those nearest to its length first.
fn ranked_plans(brief: &WritingBrief<'_>, words: f64, dice: TextDice) -> Vec<(WayTextPlan, TextDice)> {
    let numbered = (0..MAX_PLANS).map(|number| dice.other_draws(number));
    let mut plans: Vec<(WayTextPlan, TextDice)> =
        numbered.map(|dice| (WayTextPlan::for_length(brief, words, dice), dice)).collect();
    // The sort is stable: of plans that are near enough, the first is taken.
    plans.sort_by_key(|(plan, _)| (plan.length_error_words - PLAN_LENGTH_TOLERANCE_WORDS).max(0.0).round() as u64);
    plans
}

/// The plan of a text, clause by clause. It depends on the way alone; things are filled into its places later.
struct WayTextPlan {
    clauses: Vec<WayClause>,
    /// Whether a text of one sentence ends in a full stop.
    full_stop: bool,
    /// Difference from the drawn length, words, as far as it is known before things are filled in.
    length_error_words: f64,
}

impl WayTextPlan {
    /// A plan of about this many words.
    fn for_length(brief: &WritingBrief<'_>, words: f64, dice: TextDice) -> Self {
        let mut clauses = route::plan_clauses(brief, dice);
        if !stands_still(brief.walk) {
            fill::offer_places(&mut clauses, brief, dice);
        }
        let mut lengths = ClauseLengths::for_way(&brief.profile.way);
        let mut is_long = |plan: &[WayClause]| {
            lengths.expected_words(plan) > words + LENGTH_SLACK_WORDS
                || lengths.most_words(plan) > words * MAX_LENGTH_RATIO + LENGTH_SLACK_WORDS
        };
        while is_long(&clauses) && drop_least(&mut clauses, OPTIONAL_BELOW_WEIGHT) {}
        let mut is_short = |plan: &[WayClause]| {
            lengths.expected_words(plan) < words - LENGTH_SLACK_WORDS
                && lengths.most_words(plan) < words * MAX_LENGTH_RATIO
        };
        let mut times = 0;
        while is_short(&clauses) && !stands_still(brief.walk) {
            if !fill::fill_plan(&mut clauses, brief, dice.other_draws(times)) {
                break;
            }
            times += 1;
        }
        let over = lengths.most_words(&clauses) - words * MAX_LENGTH_RATIO;
        let off = (lengths.expected_words(&clauses) - words).abs().max(over);
        Self {
            length_error_words: off,
            clauses,
            full_stop: dice.named_rng(&["full stop"]).random_bool(brief.profile.full_stops.clamp(0.0, 1.0)),
        }
    }

    /// Fills things into the plan and puts it into words. Clauses are dropped until the text keeps the limit of words.
    fn draft_for_plan<'a>(
        &self,
        brief: &'a WritingBrief<'_>,
        task: Option<&TaskPhrase>,
        dice: TextDice,
    ) -> TextDraft<'a> {
        let mut landmarks = LandmarkChooser::new(brief, dice);
        if let Some(task) = task {
            landmarks.reserve_name(&task.name);
        }
        let mut clauses = self.clauses.clone();
        let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
        loop {
            let mut plan = clauses.clone();
            mend_clauses(&mut plan, brief);
            let filled = carry_out(&number_clauses(with_stand_ins(plan, brief.memory)), brief, &landmarks, dice);
            let draft = TextDraft::from_clauses(filled, task, self.full_stop, brief, dice);
            if word_count(&draft.text_and_starts().0) < limit || !drop_least(&mut clauses, KEPT_WEIGHT) {
                return draft;
            }
        }
    }
}

/// Leaves out the clause that matters least, if one matters less than `below`.
fn drop_least(clauses: &mut Vec<WayClause>, below: u8) -> bool {
    let candidates = clauses.iter().enumerate().filter(|(_, clause)| clause.weight < below);
    let Some((at, _)) = candidates.min_by_key(|(at, clause)| (clause.weight, *at)) else { return false };
    clauses.remove(at);
    true
}

/// Repairs a plan after clauses were dropped: a room that is left must have been entered, and of two consecutive turns
/// the second needs a place.
fn mend_clauses(clauses: &mut Vec<WayClause>, brief: &WritingBrief<'_>) {
    let start = brief.memory.room_at(0).and_then(usable_room);
    let mut known: BTreeSet<String> = start.into_iter().collect();
    clauses.retain(|clause| {
        let leaves = matches!(clause.kind, ClauseKind::Leave | ClauseKind::LeaveByDoor | ClauseKind::TurnOut);
        let is_known = !leaves || clause.from.as_ref().is_none_or(|from| known.contains(from));
        if !leaves && clause.kind.names_room() {
            known.extend(clause.room.clone());
        }
        is_known || clause.kind == ClauseKind::TurnOut
    });
    for at in 0..clauses.len() {
        if let ClauseKind::LeaveEnter | ClauseKind::TurnOut = clauses[at].kind {
            let from = clauses[at].from.clone();
            let leaves = |clause: &WayClause| matches!(clause.kind, ClauseKind::Leave | ClauseKind::LeaveByDoor);
            let names = |clause: &WayClause| clause.kind.names_room() && !leaves(clause);
            let entered = clauses[..at].iter().any(|clause| names(clause) && clause.room == from);
            if !entered && from != brief.memory.room_at(0).map(str::to_owned) {
                let is_turn = clauses[at].kind == ClauseKind::TurnOut;
                clauses[at].kind = if is_turn { ClauseKind::Turn } else { ClauseKind::Enter };
            }
        }
    }
    for at in 1..clauses.len() {
        if clauses[at].is_bare() && clauses[at - 1].is_bare() {
            give_place(&mut clauses[at], brief);
        }
    }
    // Whoever hears of a turn or a door first takes it at once.
    let walks_first = |first: &WayClause| {
        let takes_door = first.side.is_some() && first.thing.is_none() && brief.memory.knows_doors();
        let most_m = if takes_door && !first.is_bare() { MAX_FIRST_DOOR_M } else { MAX_AT_ONCE_M };
        (first.is_bare() || takes_door) && brief.walk.walked_m(0, first.at) > most_m
    };
    if clauses.first().is_some_and(walks_first) {
        clauses.insert(0, WayClause::straight_on(&clauses[0]));
    }
    while let Some(at) = (1..clauses.len()).find(|at| clauses[*at].is_bare() && clauses[*at - 1].is_bare()) {
        let onward = clauses[at].straight_on();
        clauses.insert(at, onward);
    }
    bridge_gaps(clauses, brief);
}

/// Lets a place for a thing fall back to "go straight": between two consecutive turns, and on a long last stretch that
/// no other clause describes.
fn bridge_gaps(clauses: &mut [WayClause], brief: &WritingBrief<'_>) {
    let fixed: Vec<usize> = (0..clauses.len()).filter(|at| !clauses[*at].is_offer()).collect();
    let clauses_before = std::iter::once(None).chain(fixed.iter().map(|at| Some(*at)));
    // Each clause that is no offer, with the one before it.
    let pairs: Vec<(Option<usize>, usize)> = clauses_before.zip(fixed.iter().copied()).collect();
    for (before, at) in pairs {
        let is_end = at + 1 == clauses.len();
        let needs = match before {
            None => is_end,
            Some(before) if is_end => brief.walk.walked_m(clauses[before].at, clauses[at].at) >= LONG_HOP_M,
            Some(before) => clauses[before].is_bare() && clauses[at].is_bare(),
        };
        let first = before.map_or(0, |before| before + 1);
        if let Some(between) = clauses[first..at].first_mut().filter(|_| needs) {
            between.or_straight_on();
        }
    }
}

/// Turns a plain turn into one that names its room.
fn give_place(clause: &mut WayClause, brief: &WritingBrief<'_>) {
    let room = brief.memory.room_at(clause.at).and_then(usable_room);
    if clause.kind == ClauseKind::Turn && room.is_some() {
        (clause.kind, clause.room) = (ClauseKind::TurnIn, room);
    }
}

/// Draws the task, if this text ends in one.
pub(super) fn draw_ending(
    brief: &WritingBrief<'_>,
    rng: &mut ChaCha8Rng,
) -> Result<Option<TaskPhrase>, super::WriteError> {
    let ends = brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    if ends { draw_task(brief, rng).map(Some) } else { Ok(None) }
}
