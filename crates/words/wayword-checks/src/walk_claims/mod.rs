//! Holds each claim of a text against its own stretch of the walk, in a closed world where the poses of the path are known, and labels or
//! witnesses say what it shows.
//!
//! The steps of the text divide the walk into consecutive stretches, one for each step. Of all divisions, the one is taken with the
//! least cost: a sum of weights of its false claims and of the turns and flights that it leaves out. What is false or left out in that
//! division is a mistake of the text: any other division costs at least as much.
//!
//! Frames have to lie close together. Between viewpoints of a graph, which are 2 m apart, it is not known what happens first.
//!
//! - `claims`: what each step claims of its stretch.
//! - `facts`: what is known of the walk: distances, turns, rooms and doors along it.
//! - `judge`: whether a claim holds on a stretch; `places` and `relations` decide those about places, and `by_sight` where witnesses leave
//!   things out. `outcome`: what is found.
//! - `untold`: turns and flights that a step leaves out.
//! - `gaps`: stretches that the text passes over in silence.
//! - `division`: the search for the best division.

mod by_sight;
mod claims;
mod division;
mod doors;
mod facts;
mod gaps;
mod judge;
mod outcome;
mod places;
mod relations;
#[cfg(test)]
mod tests;
mod untold;

use crate::{
    Evidence, WalkMemory,
    memory::{MAX_DENSE_HOP_M, StairFlight, WalkBend, mean_hop_m},
    new_finding, pass_finding,
};
use claims::{ClaimedFact, StepClaim, claims_by_step, effective_stops};
use division::divide_walk;
use facts::WalkFacts;
use gaps::{JudgedStep, find_gaps};
use judge::{judge_claim, turn_word};
use outcome::ClaimOutcome;
use std::ops::Range;
use untold::{names_stairs, untold_bends};
use wayword_core::{CheckFinding, CheckKind, InstructionPart, Verdict, walk_cuts::WalkCuts};
use wayword_language::reading::{
    TextReading,
    steps::{InstructionStep, read_steps},
};

/// Largest product of the number of steps and the square of the number of frames: the search compares so many stretches.
const MAX_STRETCHES: usize = 1_000_000;

/// The findings about a text on its walk.
pub(super) struct WalkFindings {
    pub(super) findings: Vec<CheckFinding>,
    /// The frame of each event of the reading, where it has one.
    pub(super) frames: Vec<Option<usize>>,
    /// The parts of the text with their stretches.
    pub(super) parts: Vec<InstructionPart>,
}

impl WalkFindings {
    /// Makes false claims about places unverified.
    pub(super) fn doubt_places(&mut self) {
        let is_about_place = |check| matches!(check, CheckKind::Landmarks | CheckKind::Order);
        let wrong = self.findings.iter_mut().filter(|finding| finding.verdict == Verdict::Fail);
        wrong.filter(|finding| is_about_place(finding.check)).for_each(|finding| finding.verdict = Verdict::Unverified);
    }
}

/// A walk, divided among the steps of a text.
struct DividedWalk<'a> {
    facts: WalkFacts<'a>,
    /// The claims of each step.
    claims: Vec<Vec<StepClaim<'a>>>,
    /// Whether each step stops, or is the condition of a stop.
    stops: Vec<bool>,
    /// All divisions.
    cuts: WalkCuts,
    /// The stretch of each step, in the best division.
    stretches: Vec<[usize; 2]>,
}

impl<'a> DividedWalk<'a> {
    /// `None` for a walk that has no moves, is too long, or has its frames too far apart.
    fn new(
        reading: &'a TextReading,
        steps: &'a [InstructionStep],
        (evidence, memory): (&'a Evidence, &'a WalkMemory),
        object: Option<usize>,
    ) -> Option<Self> {
        let work = steps.len() * evidence.frames.len() * evidence.frames.len();
        let facts = WalkFacts::new(evidence, memory);
        let is_coarse = memory.is_on_graph() || mean_hop_m(evidence).is_some_and(|hop_m| hop_m > MAX_DENSE_HOP_M);
        if evidence.moves.is_empty() || steps.is_empty() || work > MAX_STRETCHES || is_coarse {
            return None;
        }
        let stops = effective_stops(steps);
        let claims = claims_by_step(&facts, reading, (steps, &stops), object);
        let cuts = divide_walk(&facts, &claims);
        let stretches = cuts.best_cut();
        Some(Self { facts, claims, stops, cuts, stretches })
    }

    /// The parts of the text: its steps, each with the conditions that follow it ("until you reach the sofa").
    fn parts(&self, steps: &[InstructionStep]) -> Vec<InstructionPart> {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (number, step) in steps.iter().enumerate() {
            match ranges.last_mut().filter(|_| step.is_condition) {
                Some(range) => range.end = number + 1,
                None => ranges.push(number..number + 1),
            }
        }
        let part = |range: Range<usize>| {
            let [first, last] = [range.start, range.end - 1];
            let frames = [self.stretches[first][0], self.stretches[last][1]];
            let span = [steps[first].span[0], steps[last].span[1]];
            InstructionPart { span, frames, confidence: Some(self.cuts.joint_share(range, frames)) }
        };
        ranges.into_iter().map(part).collect()
    }
}

/// The parts of a text with their stretches of the walk; `None` where the walk cannot be divided, as for [`check_walk_claims`].
pub(super) fn align_steps_with_walk(
    reading: &TextReading,
    known: (&Evidence, &WalkMemory),
) -> Option<Vec<InstructionPart>> {
    let steps = read_steps(reading);
    // What is to be done with the object of a task says nothing of the way.
    let object = reading.task.as_ref().and_then(|task| task.object);
    Some(DividedWalk::new(reading, &steps, known, object)?.parts(&steps))
}

/// Checks the claims of a text, each at its stretch of the walk. `steps` are those of the reading; `object` is the event of the
/// object of a task, which another check judges; `tells_way` says whether the text has to name each turn. `None` for a walk that has
/// no moves, is too long, or has its frames too far apart.
pub(super) fn check_walk_claims(
    reading: &TextReading,
    steps: &[InstructionStep],
    known: (&Evidence, &WalkMemory),
    object: Option<usize>,
    tells_way: bool,
) -> Option<WalkFindings> {
    let divided = DividedWalk::new(reading, steps, known, object)?;
    let facts = &divided.facts;
    let frames = vec![None; reading.events.len()];
    let mut found = WalkFindings { findings: Vec::new(), frames, parts: divided.parts(steps) };
    let judge = |at: usize| {
        let (claims, stretch) = (&divided.claims[at], divided.stretches[at]);
        let outcomes = claims.iter().map(|claim| judge_claim(facts, claim, stretch)).collect();
        JudgedStep { step: &steps[at], claims, outcomes, stretch, stops: divided.stops[at] }
    };
    let judged: Vec<JudgedStep<'_, '_>> = (0..steps.len()).map(judge).collect();
    for JudgedStep { step, claims, outcomes, stretch, .. } in &judged {
        for (claim, outcome) in claims.iter().zip(outcomes) {
            if let (ClaimOutcome::Holds(frame), Some(event)) = (outcome, claim.event) {
                found.frames[event] = Some(*frame);
            }
            found.findings.extend(claim_finding(facts, claim, outcome));
        }
        if tells_way {
            found.findings.extend(untold_turns(facts, claims, step, *stretch));
        }
    }
    if tells_way {
        found.findings.extend(untold_climbs(facts, &judged));
    }
    // What a text leaves unsaid between two doors is known where all doors are.
    if tells_way && !facts.evidence.source.leaves_out() {
        found.findings.extend(find_gaps(facts, reading, &judged));
    }
    for check in [CheckKind::Order, CheckKind::Turns] {
        if found.findings.iter().all(|finding| finding.check != check) {
            found.findings.push(pass_finding(check));
        }
    }
    Some(found)
}

/// The finding about a claim that does not hold, or cannot be decided.
fn claim_finding(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, outcome: &ClaimOutcome) -> Option<CheckFinding> {
    let finding = |check, verdict, reason| Some(new_finding(check, verdict, reason, Some(claim.span)));
    match outcome {
        ClaimOutcome::Holds(_) | ClaimOutcome::Unjudged | ClaimOutcome::IsDoubtful => None,
        ClaimOutcome::Unknown(reason) => finding(CheckKind::Landmarks, Verdict::Unverified, reason.clone()),
        ClaimOutcome::Fails(reason) => {
            let whole = [0, facts.last_frame()];
            let holds_on = |stretch| matches!(judge_claim(facts, claim, stretch), ClaimOutcome::Holds(_));
            let holds_elsewhere = || holds_on(whole) || (0..=facts.last_frame()).any(|frame| holds_on([frame; 2]));
            let check = match claim.what {
                ClaimedFact::Turn { .. } | ClaimedFact::Length { .. } => CheckKind::Turns,
                ClaimedFact::Climb(_) | ClaimedFact::StairEnd { .. } => CheckKind::Floors,
                ClaimedFact::Place { .. } if holds_elsewhere() => CheckKind::Order,
                _ => CheckKind::Landmarks,
            };
            finding(check, Verdict::Fail, reason.clone())
        }
    }
}

/// Findings about steps that climb a flight of which no step says anything: "take the stairs, then turn right on the landing" tells both
/// halves of it.
fn untold_climbs(facts: &WalkFacts<'_>, judged: &[JudgedStep<'_, '_>]) -> Vec<CheckFinding> {
    let tells = |flight: &StairFlight, step: &JudgedStep<'_, '_>| {
        names_stairs(step.claims) && step.stretch[0] <= flight.to && flight.from <= step.stretch[1]
    };
    let is_left_out = |step: &&JudgedStep<'_, '_>| {
        !names_stairs(step.claims)
            && facts.flights_on(step.stretch).any(|flight| !judged.iter().any(|other| tells(flight, other)))
    };
    let reason = "the path climbs a flight of stairs in this stretch, and the text does not say so";
    let finding =
        |step: &JudgedStep<'_, '_>| new_finding(CheckKind::Floors, Verdict::Fail, reason, Some(step.step.span));
    judged.iter().filter(is_left_out).map(finding).collect()
}

/// Findings about turns of a step's stretch that the step leaves out.
fn untold_turns(
    facts: &WalkFacts<'_>,
    claims: &[StepClaim<'_>],
    step: &InstructionStep,
    stretch: [usize; 2],
) -> Vec<CheckFinding> {
    let bends = untold_bends(facts, claims, stretch).into_iter().filter(|bend| facts.is_decision(bend));
    let finding = |bend: &WalkBend| {
        let reason = format!("the path turns {} in this stretch, and the text does not say so", turn_word(bend.side()));
        new_finding(CheckKind::Turns, Verdict::Fail, reason, Some(step.span))
    };
    bends.map(finding).collect()
}
