//! Divides a walk among the steps of a text so that the fewest of their claims are false.

use super::{
    claims::{ClaimedFact, PlaceRole, StepClaim},
    facts::WalkFacts,
    judge::judge_claim,
    outcome::ClaimOutcome,
    untold::{untold_bends, untold_flights},
};
use wayword_core::walk_cuts::{WalkCuts, all_stretches, stretch_index};

/// The cost of a turn that the stretch does not make.
const FALSE_TURN_COST: f64 = 1.5;
/// The cost of a climb that the stretch does not make.
const FALSE_CLIMB_COST: f64 = 2.0;
/// The cost of any other false claim.
const FALSE_CLAIM_COST: f64 = 1.0;
/// The cost of a claim that is doubtful there.
const DOUBTFUL_CLAIM_COST: f64 = 0.4;
/// The cost of a claim that cannot be decided there, so that a stretch where it holds is preferred.
const UNDECIDED_COST: f64 = 0.05;
/// The cost of a motion by a place on no way at all, so that a stretch with a way is preferred.
const NO_WAY_COST: f64 = 0.1;
/// The cost of a turn that is left out, of one that a walker need not be told of, and of a flight of stairs.
const UNTOLD_COSTS: [f64; 3] = [1.0, 0.3, 1.5];

/// How much less likely a division is for each unit of its cost, as a natural log. It was chosen by hand, not fitted.
const COST_STRENGTH: f64 = 4.0;

/// All divisions of the walk among steps with these claims. The best cut is the division with the least cost; among equal ones, each step
/// ends as early as it can.
pub(super) fn divide_walk(facts: &WalkFacts<'_>, claims: &[Vec<StepClaim<'_>>]) -> WalkCuts {
    let frames = facts.last_frame() + 1;
    let score_step = |claims: &Vec<StepClaim<'_>>| {
        let mut scores = vec![f64::NEG_INFINITY; frames * frames];
        for stretch in all_stretches(frames) {
            scores[stretch_index(frames, stretch)] = -COST_STRENGTH * stretch_cost(facts, claims, stretch);
        }
        scores
    };
    WalkCuts::new(claims.iter().map(score_step).collect(), frames)
}

/// The cost of giving a stretch to a step.
fn stretch_cost(facts: &WalkFacts<'_>, all: &[StepClaim<'_>], stretch: [usize; 2]) -> f64 {
    let [untold, forced, flight] = UNTOLD_COSTS;
    let bends = untold_bends(facts, all, stretch);
    let turns: f64 = bends.iter().map(|bend| if facts.is_decision(bend) { untold } else { forced }).sum();
    let flights = untold_flights(facts, all, stretch).len() as f64 * flight;
    let claims: f64 = all.iter().map(|claim| claim_cost(facts, claim, stretch)).sum();
    let is_motion = |claim: &StepClaim<'_>| {
        matches!(
            claim.what,
            ClaimedFact::Place {
                role: PlaceRole::Along
                    | PlaceRole::Through
                    | PlaceRole::Approached { .. }
                    | PlaceRole::Passed
                    | PlaceRole::TurnedPast,
                ..
            }
        )
    };
    let stands = stretch[0] == stretch[1] && all.iter().any(is_motion);
    turns + flights + claims + if stands { NO_WAY_COST } else { 0.0 }
}

fn claim_cost(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, stretch: [usize; 2]) -> f64 {
    match (judge_claim(facts, claim, stretch), claim.what) {
        (ClaimOutcome::Holds(_) | ClaimOutcome::Unjudged, _) => 0.0,
        (ClaimOutcome::Unknown(_), _) => UNDECIDED_COST,
        (ClaimOutcome::IsDoubtful, _) => DOUBTFUL_CLAIM_COST,
        (ClaimOutcome::Fails(_), ClaimedFact::Turn { .. }) => FALSE_TURN_COST,
        (ClaimOutcome::Fails(_), ClaimedFact::Climb(_)) => FALSE_CLIMB_COST,
        (ClaimOutcome::Fails(_), _) if facts.evidence.source.leaves_out() => DOUBTFUL_CLAIM_COST,
        (ClaimOutcome::Fails(_), _) => FALSE_CLAIM_COST,
    }
}
