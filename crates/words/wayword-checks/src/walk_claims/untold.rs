//! Finds the turns and flights of a stretch that the claims of its step leave out.

use super::{
    claims::{ClaimedFact, PlaceRole, StepClaim},
    facts::{WalkFacts, is_stairs, widest_to},
};
use crate::memory::{StairFlight, WalkBend};

/// The bends of a stretch that the claims of its step leave out.
pub(super) fn untold_bends<'a>(
    facts: &WalkFacts<'a>,
    claims: &[StepClaim<'_>],
    stretch: [usize; 2],
) -> Vec<&'a WalkBend> {
    let mut bends: Vec<&WalkBend> = facts.bends_on(stretch).collect();
    // A staircase turns as it is built.
    if names_stairs(claims) {
        bends.retain(|bend| !facts.memory.is_on_stairs(bend));
    }
    for claim in claims {
        let side = match claim.what {
            ClaimedFact::Turn { side, .. } => Some(side),
            // "The door on your right" sends the walker to the right.
            ClaimedFact::Place {
                place,
                role: PlaceRole::Entered | PlaceRole::Through | PlaceRole::Approached { .. },
            } => place.side,
            _ => None,
        };
        let told = side.and_then(|side| widest_to(side, bends.iter().copied()));
        bends.retain(|bend| told != Some(*bend));
    }
    bends
}

/// The flights of a stretch that its step says nothing of. A turn on a landing lies within a flight that other steps may tell.
pub(super) fn untold_flights<'a>(
    facts: &WalkFacts<'a>,
    claims: &[StepClaim<'_>],
    stretch: [usize; 2],
) -> Vec<&'a StairFlight> {
    if names_stairs(claims) || turns_on_stairs(facts, claims, stretch) {
        return Vec::new();
    }
    facts.flights_on(stretch).collect()
}

/// Whether a claim is a turn within a flight.
fn turns_on_stairs(facts: &WalkFacts<'_>, claims: &[StepClaim<'_>], stretch: [usize; 2]) -> bool {
    claims.iter().any(|claim| match claim.what {
        ClaimedFact::Turn { side, .. } => {
            facts.told_bend(side, stretch).is_some_and(|bend| facts.memory.is_on_stairs(bend))
        }
        _ => false,
    })
}

/// Whether one of the claims is about stairs.
pub(super) fn names_stairs(claims: &[StepClaim<'_>]) -> bool {
    claims.iter().any(|claim| match claim.what {
        ClaimedFact::Climb(_) => true,
        ClaimedFact::Place { place, .. } => is_stairs(&place.name),
        _ => false,
    })
}
