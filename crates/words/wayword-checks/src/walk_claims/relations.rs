//! Decides how two places lie to each other and to the walk: beside each other, or with the walker between them.

use super::{
    claims::StepClaim,
    facts::{NEAR_M, WalkFacts},
    outcome::ClaimOutcome::{self, Fails, Holds, Unjudged, Unknown},
};
use crate::{evidence::is_wide, memory::RememberedThing, sides::wrap_angle};
use wayword_language::{lexicon::is_fabric, reading::PlaceMention};

/// Two things beside each other have centres at most this far apart, metres.
const BESIDE_M: f64 = 2.5;
/// A walker between two things sees them in directions that differ by at least this angle, degrees.
const BETWEEN_DEG: f64 = 75.0;

/// Whether two places lie beside each other near a stretch.
pub(super) fn judge_beside(
    facts: &WalkFacts<'_>,
    claim: &StepClaim<'_>,
    [place, neighbour]: [&PlaceMention; 2],
    stretch: [usize; 2],
) -> ClaimOutcome {
    let [all, there] = &claim.things;
    if all.is_empty() || there.is_empty() {
        return judge_absent_pair(facts, claim, [place, neighbour]);
    }
    let is_near = |thing: &&&RememberedThing| {
        (stretch[0]..=stretch[1])
            .any(|frame| facts.memory.distance_m(thing, frame).is_none_or(|far_m| far_m <= 2.0 * NEAR_M))
    };
    let here: Vec<&RememberedThing> = all.iter().filter(is_near).copied().collect();
    if here.iter().chain(there).any(|thing| thing.position.is_none()) {
        return Unknown(format!("the program cannot check whether {:?} is near {:?}", place.name, neighbour.name));
    }
    let is_wide = [place, neighbour].iter().any(|place| is_wide(&place.name));
    let limit_m = if is_wide { 2.0 * BESIDE_M } else { BESIDE_M };
    let lies_beside = |a: &RememberedThing, b: &RememberedThing| {
        let far_m = a.position.zip(b.position).map(|(a, b)| (a - b).truncate().length());
        // A wall may stand between things that no frame shows both.
        let are_seen_together = a.glimpses.iter().any(|glimpse| b.glimpse_from(glimpse.frame).is_some());
        a.position != b.position && are_seen_together && far_m.is_some_and(|far_m| far_m <= limit_m)
    };
    let is_pair = here.iter().any(|a| there.iter().any(|b| lies_beside(a, b)));
    if is_pair { Holds(stretch[1]) } else { Fails(format!("{:?} is not near {:?} here", place.name, neighbour.name)) }
}

/// Decides a relation of two places of which one at least is not seen along the walk.
fn judge_absent_pair(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, pair: [&PlaceMention; 2]) -> ClaimOutcome {
    let is_absent = |(place, things): &(&PlaceMention, &Vec<&RememberedThing>)| {
        let is_room = place.is_room && !facts.stays_in(&place.name).is_empty();
        place.is_thing && !is_room && !is_fabric(&place.name) && things.is_empty()
    };
    match pair.into_iter().zip(&claim.things).find(is_absent) {
        Some((place, _)) if facts.lists_things() => {
            Unknown(format!("the program cannot check where {:?} is: the path does not show it", place.name))
        }
        _ => Unjudged,
    }
}

/// Whether a frame lies between two places.
pub(super) fn judge_between(
    facts: &WalkFacts<'_>,
    claim: &StepClaim<'_>,
    [one, other]: [&PlaceMention; 2],
    frame: usize,
) -> ClaimOutcome {
    let directions = |things: &[&RememberedThing]| -> Option<Vec<f64>> {
        let is_near =
            |thing: &&&RememberedThing| facts.memory.distance_m(thing, frame).is_none_or(|far_m| far_m <= NEAR_M);
        things.iter().filter(is_near).map(|thing| facts.direction_rad(thing, frame)).collect()
    };
    if claim.things.iter().any(Vec::is_empty) {
        return judge_absent_pair(facts, claim, [one, other]);
    }
    let (Some(here), Some(there)) = (directions(&claim.things[0]), directions(&claim.things[1])) else {
        return Unknown(format!("the program cannot check whether one is between {:?} and {:?}", one.name, other.name));
    };
    let is_apart = |a: f64, b: f64| wrap_angle(a - b).abs() >= BETWEEN_DEG.to_radians();
    if here.iter().any(|a| there.iter().any(|b| is_apart(*a, *b))) {
        return Holds(frame);
    }
    Fails(format!("the walk is not between {:?} and {:?} here", one.name, other.name))
}
