//! Finds where a text says too little for a walker: a turn or a stop far behind the last thing that was named, a room that is crossed or a
//! long way without a word, a stop at one of several alike.

use super::{
    claims::{ClaimedFact, PlaceRole, StepClaim},
    facts::{WalkFacts, widest_to},
    outcome::ClaimOutcome,
};
use crate::{
    memory::{
        MAX_BARE_STOP_GAP_M, MAX_SIDE_DOOR_GAP_M, MAX_SILENT_WAY_M, MAX_TOLD_GAP_M, RememberedThing, WalkBend, is_door,
    },
    new_finding,
};
use std::collections::BTreeSet;
use wayword_core::{CheckFinding, CheckKind, Side, Verdict};
use wayword_language::reading::{PlaceMention, TextReading, steps::InstructionStep};

/// A step with its claims, what was found about them, and its stretch of the walk.
pub(super) struct JudgedStep<'s, 'a> {
    pub(super) step: &'s InstructionStep,
    pub(super) claims: &'s [StepClaim<'a>],
    pub(super) outcomes: Vec<ClaimOutcome>,
    pub(super) stretch: [usize; 2],
    /// Whether it stops, or is the condition of a stop.
    pub(super) stops: bool,
}

impl<'s, 'a> JudgedStep<'s, 'a> {
    /// The claims that hold, each with its frame.
    fn holding(&self) -> impl Iterator<Item = (&'s StepClaim<'a>, usize)> {
        self.claims.iter().zip(&self.outcomes).filter_map(|(claim, outcome)| match outcome {
            ClaimOutcome::Holds(frame) => Some((claim, *frame)),
            _ => None,
        })
    }

    /// Whether it says that the walk goes on: straight, along something, or so many metres.
    fn goes_on(&self) -> bool {
        let is_way = |claim: &StepClaim<'_>| {
            matches!(
                claim.what,
                ClaimedFact::Length { .. }
                    | ClaimedFact::EndOf(_)
                    | ClaimedFact::Climb(_)
                    | ClaimedFact::Place { role: PlaceRole::Along | PlaceRole::Approached { .. }, .. }
            )
        };
        self.step.is_straight || self.claims.iter().any(is_way)
    }
}

/// The findings about a whole text.
pub(super) fn find_gaps(
    facts: &WalkFacts<'_>,
    reading: &TextReading,
    steps: &[JudgedStep<'_, '_>],
) -> Vec<CheckFinding> {
    let mut found = Vec::new();
    // The frame up to which the text has words.
    let mut told = 0;
    let mut before: Option<&JudgedStep<'_, '_>> = None;
    for judged in steps {
        // "Walk straight" may have no stretch of its own.
        let is_led_there = before.is_some_and(JudgedStep::goes_on);
        if let Some(bend) = turn_after_gap(facts, judged, told).filter(|_| !is_led_there) {
            let side = bend.side();
            let reason = format!("there are other ways to the {} before this turn", super::turn_word(side));
            found.push(new_finding(CheckKind::Turns, Verdict::Fail, reason, Some(judged.step.span)));
        }
        found.extend(way_left_out(facts, judged, told).filter(|_| !is_led_there));
        told = told.max(last_told(facts, judged));
        if judged.goes_on() {
            told = told.max(judged.stretch[1]);
        }
        before = Some(judged);
    }
    found.extend(vague_stop(facts, steps));
    found.extend(unclear_stop(facts, reading, steps));
    found
}

/// The last frame of which a step has words.
fn last_told(facts: &WalkFacts<'_>, judged: &JudgedStep<'_, '_>) -> usize {
    let frame = |(claim, frame): (&StepClaim<'_>, usize)| match claim.what {
        ClaimedFact::Turn { side, .. } => facts.told_bend(side, judged.stretch).map_or(frame, |bend| bend.last + 1),
        ClaimedFact::Place { role: PlaceRole::Through, .. } => {
            let left =
                claim.stays.iter().filter(|stay| (stay.entered..=stay.left).contains(&frame)).map(|stay| stay.left);
            left.max().unwrap_or(frame).min(judged.stretch[1])
        }
        // "Go down the hallway" is about no point of it.
        ClaimedFact::Place { role: PlaceRole::Along | PlaceRole::Within { at_stop: false }, .. } => 0,
        _ => frame,
    };
    judged.holding().map(frame).max().unwrap_or(0)
}

/// The turn of a step that names nothing else, where the walk passes other doors on that side before it.
fn turn_after_gap<'a>(facts: &WalkFacts<'a>, judged: &JudgedStep<'_, 'a>, told: usize) -> Option<&'a WalkBend> {
    // A door alone does not tell which one is meant.
    let door = |claim: &StepClaim<'a>| match claim.what {
        ClaimedFact::Place { place, .. } if is_door(&place.name) => Some(place),
        _ => None,
    };
    let on_side = |claim: &StepClaim<'a>| door(claim).and_then(|door| door.side);
    let is_anchor = |claim: &StepClaim<'a>| !matches!(claim.what, ClaimedFact::Turn { .. }) && door(claim).is_none();
    if judged.claims.iter().any(is_anchor) || judged.goes_on() {
        return None;
    }
    let side = judged.step.turn.or_else(|| judged.claims.iter().find_map(on_side));
    let side = side.filter(|side| matches!(side, Side::Left | Side::Right))?;
    let bend = widest_to(side, facts.bends_on(judged.stretch))?;
    // "The door on the left" is the first one on the left.
    let limit_m =
        if judged.claims.iter().any(|claim| on_side(claim).is_some()) { MAX_SIDE_DOOR_GAP_M } else { MAX_TOLD_GAP_M };
    (told < bend.first
        && facts.length_m([told, bend.first]) > limit_m
        && facts.memory.passes_door(side, told, bend.first))
    .then_some(bend)
}

/// The finding about a room that the walk crosses, or a long way, before the next thing that the text names.
fn way_left_out(facts: &WalkFacts<'_>, judged: &JudgedStep<'_, '_>, mut told: usize) -> Option<CheckFinding> {
    if judged.goes_on() {
        return None;
    }
    // "Through the door into the kitchen" is one opening.
    let in_door = |(claim, frame): (&StepClaim<'_>, usize)| match claim.what {
        ClaimedFact::Place { place, role: PlaceRole::Through } if is_door(&place.name) => Some(frame),
        _ => None,
    };
    let in_room = |(claim, frame): (&StepClaim<'_>, usize)| match claim.what {
        ClaimedFact::Place { place, role: PlaceRole::Entered } if place.is_room => Some(frame),
        _ => None,
    };
    let [door, room] = [judged.holding().find_map(in_door), judged.holding().find_map(in_room)];
    if let Some((door, _)) = door.zip(room).filter(|(door, room)| *room > door + 1) {
        let between = facts.memory.room_at(door).unwrap_or("another room");
        let reason = format!("the door leads into {between:?} first");
        return Some(new_finding(CheckKind::Order, Verdict::Fail, reason, Some(judged.step.span)));
    }
    // In the order of the walk, and without claims that are about no point of it.
    let is_point = |claim: &StepClaim<'_>| {
        !matches!(
            claim.what,
            ClaimedFact::Beside(_)
                | ClaimedFact::Between(_)
                | ClaimedFact::Place { role: PlaceRole::Within { at_stop: false } | PlaceRole::InSight, .. }
        )
    };
    let points: BTreeSet<usize> =
        judged.holding().filter(|(claim, _)| is_point(claim)).map(|(_, frame)| frame).collect();
    for next in points {
        let crossed = facts.memory.stays.iter().find(|stay| {
            stay.entered > told
                && stay.left < next
                && facts.length_m([stay.entered - 1, stay.left + 1]) > MAX_TOLD_GAP_M
        });
        let gap_m = if next > told { facts.length_m([told, next]) } else { 0.0 };
        let reason = match crossed {
            Some(stay) => Some(format!("the text leaves out that the walk leads through {:?}", stay.room)),
            None => (gap_m > MAX_SILENT_WAY_M)
                .then(|| format!("the text has no words for {gap_m:.1} m of the walk before this")),
        };
        if let Some(reason) = reason {
            return Some(new_finding(CheckKind::Order, Verdict::Fail, reason, Some(judged.step.span)));
        }
        told = told.max(next);
    }
    None
}

/// The finding about a thing to stop at, of which the walk comes to another one first in the same room. A side, a number, a neighbour or
/// what it shows tells which one is meant.
fn unclear_stop(facts: &WalkFacts<'_>, reading: &TextReading, steps: &[JudgedStep<'_, '_>]) -> Option<CheckFinding> {
    let stop = steps.last().filter(|stop| stop.stops)?;
    let last = facts.last_frame();
    let is_relation = |claim: &StepClaim<'_>| matches!(claim.what, ClaimedFact::Beside(_) | ClaimedFact::Between(_));
    let is_alone = |place: &PlaceMention| {
        place.count.is_none() && !place.several && place.ordinal.is_none() && place.side.is_none()
    };
    let is_stop = |claim: &StepClaim<'_>| match claim.what {
        ClaimedFact::Place { place, role } => role == PlaceRole::Stopped && is_alone(place),
        _ => false,
    };
    if stop.claims.iter().any(is_relation) {
        return None;
    }
    let (claim, _) = stop.holding().find(|(claim, _)| is_stop(claim))?;
    let behind = reading.tokens().iter().find(|token| token.span[0] >= claim.span[1]);
    if behind.is_some_and(|token| matches!(token.word.as_str(), "of" | "with" | "showing")) {
        return None;
    }
    let near_m = |thing: &RememberedThing, frame: usize| facts.memory.distance_m(thing, frame).unwrap_or(f64::INFINITY);
    let things = &claim.things[0];
    let meant = things.iter().min_by(|a, b| near_m(a, last).total_cmp(&near_m(b, last)))?;
    let mut others = things.iter().filter(|thing| **thing != *meant);
    let other = others.find(|thing| facts.memory.is_met_before_end(thing, MAX_TOLD_GAP_M))?;
    let reason = format!("the walk comes to another {:?} before this one", other.name);
    Some(new_finding(CheckKind::Landmarks, Verdict::Fail, reason, Some(claim.span)))
}

/// The finding about a stop of which the text only names the room, where the walk goes on through it.
fn vague_stop(facts: &WalkFacts<'_>, steps: &[JudgedStep<'_, '_>]) -> Option<CheckFinding> {
    let (stop, before) = steps.split_last().filter(|(stop, _)| stop.stops)?;
    let names_only_a_room = |claim: &StepClaim<'_>| match claim.what {
        ClaimedFact::Place { place, .. } => place.is_room && claim.things[0].is_empty(),
        _ => false,
    };
    if !stop.claims.iter().all(names_only_a_room) {
        return None;
    }
    let limit_m = if stop.claims.is_empty() { MAX_BARE_STOP_GAP_M } else { MAX_TOLD_GAP_M };
    let told = before.iter().map(|judged| last_told(facts, judged)).max().unwrap_or(0);
    let gap_m = facts.length_m([told, facts.last_frame()]);
    (gap_m > limit_m).then(|| {
        let reason = format!("the walk goes on for {gap_m:.1} m, and the text does not say how far");
        new_finding(CheckKind::Landmarks, Verdict::Fail, reason, Some(stop.step.span))
    })
}
