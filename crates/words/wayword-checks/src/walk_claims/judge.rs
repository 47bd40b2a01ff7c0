//! Decides whether a claim holds on a stretch of the walk: turns, climbs, lengths and ends here, places in `places` and `relations`.

use super::{
    by_sight::judge_by_sight,
    claims::{ClaimedFact, StepClaim, TurnSize},
    facts::WalkFacts,
    outcome::ClaimOutcome::{self, Fails, Holds, IsDoubtful, Unjudged, Unknown},
    places::PlaceJudge,
    relations::{judge_beside, judge_between},
};
use crate::sides::side_word;
use wayword_core::{ClimbDirection, Side, motion};
use wayword_language::reading::PlaceMention;

/// A stretch climbs if it rises or falls by this height, metres.
const CLIMB_M: f64 = 0.3;
/// A length is wrong where it is more than this many times too long or too short, and off by more than [`LENGTH_SLACK_M`].
const LENGTH_FACTOR: f64 = 1.6;
/// Two hops of a walk, metres.
const LENGTH_SLACK_M: f64 = 2.0;

/// Decides a claim on a stretch, given by its first and its last frame. Witnesses that leave things out can make few claims about places
/// false; poses alone decide the others.
pub(super) fn judge_claim(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, stretch: [usize; 2]) -> ClaimOutcome {
    if !is_by_witnesses(facts, claim) || claim.what.is_motion() {
        return decide_claim(facts, claim, stretch);
    }
    if matches!(claim.what, ClaimedFact::EndOf(_)) && facts.knows_rooms() {
        return decide_claim(facts, claim, stretch);
    }
    let decided = decide_claim(facts, claim, stretch);
    // What labels list decides before what witnesses saw.
    if !facts.evidence.source.leaves_out() && matches!(decided, Holds(_)) {
        return decided;
    }
    judge_by_sight(facts, claim, stretch).unwrap_or(match decided {
        Fails(_) => IsDoubtful,
        Unknown(_) => Unjudged,
        outcome => outcome,
    })
}

/// Whether only witnesses, who leave things out, can tell of a claim's things.
fn is_by_witnesses(facts: &WalkFacts<'_>, claim: &StepClaim<'_>) -> bool {
    facts.evidence.source.leaves_out() || claim.things.iter().flatten().any(|thing| thing.is_unlisted)
}

fn decide_claim(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, stretch: [usize; 2]) -> ClaimOutcome {
    match claim.what {
        ClaimedFact::Turn { side, size } => judge_turn(facts, (side, size), stretch),
        ClaimedFact::Climb(climb) => judge_climb(facts, climb, stretch),
        ClaimedFact::Place { place, role } => PlaceJudge { facts, claim, place, role, stretch }.judge_place(),
        ClaimedFact::Between(pair) => judge_between(facts, claim, pair, stretch[1]),
        ClaimedFact::Beside(pair) => judge_beside(facts, claim, pair, stretch),
        ClaimedFact::StairEnd { is_top } => judge_stair_end(facts, is_top, stretch),
        ClaimedFact::EndOf(place) => judge_end(facts, claim, place, stretch[1]),
        ClaimedFact::Length { low_m, high_m } => judge_length(facts, [low_m, high_m], stretch),
    }
}

fn judge_turn(facts: &WalkFacts<'_>, (side, size): (Side, TurnSize), stretch: [usize; 2]) -> ClaimOutcome {
    if let Some(bend) = facts.told_bend(side, stretch) {
        let (deg, way) = (bend.turn_rad.to_degrees().abs(), turn_word(side));
        return match size {
            TurnSize::Slight if deg > motion::MAX_SLIGHT_DEG => {
                Fails(format!("the path does not turn only slightly {way} here"))
            }
            TurnSize::Plain if deg < motion::TOLD_DEG => Fails(format!("the path turns only slightly {way} here")),
            TurnSize::Sharp if deg < motion::MAX_SLIGHT_DEG => {
                Fails(format!("the path does not turn sharply {way} here"))
            }
            _ => Holds(bend.first),
        };
    }
    let sign = match side {
        Side::Left => -1.0,
        Side::Right => 1.0,
        Side::Ahead | Side::Behind => 0.0,
    };
    // A long curve of small turns.
    if facts.bends_on(stretch).next().is_none()
        && size == TurnSize::Slight
        && facts.net_turn_deg(stretch[0]..=stretch[1]) * sign >= motion::SLIGHT_DEG
    {
        return Holds(stretch[0]);
    }
    Fails(format!("no move of the path turns {} here", turn_word(side)))
}

/// The word for a turn to a side.
pub(super) fn turn_word(side: Side) -> &'static str {
    match side {
        Side::Left | Side::Right => side_word(side),
        Side::Ahead | Side::Behind => "around",
    }
}

fn judge_climb(facts: &WalkFacts<'_>, climb: ClimbDirection, stretch: [usize; 2]) -> ClaimOutcome {
    let (way, sign) = if climb == ClimbDirection::Up { ("up", 1.0) } else { ("down", -1.0) };
    let moves = facts.evidence.moves.get(stretch[0]..stretch[1]).unwrap_or_default();
    let rise_m: f64 = moves.iter().map(|step| step.rise_m).sum();
    let has_flight = facts.memory.flights.iter().any(|flight| flight.climb == climb);
    // A few steps are no flight.
    let has_step = moves.iter().any(|step| step.rise_m * sign >= 0.1);
    if rise_m * sign >= CLIMB_M || (!has_flight && has_step) {
        return Holds(stretch[0]);
    }
    Fails(format!("the path does not go {way} any stairs here"))
}

/// Whether the upper or the lower end of stairs is on a stretch. A landing is no end: there the walk is on no other storey yet.
fn judge_stair_end(facts: &WalkFacts<'_>, is_top: bool, stretch: [usize; 2]) -> ClaimOutcome {
    let around = facts.around(stretch);
    let knows_levels = facts.evidence.frames.iter().any(|frame| frame.level.is_some());
    let ends = facts.memory.flights.iter().filter_map(|flight| {
        let arrives = (flight.climb == ClimbDirection::Up) == is_top;
        let reaches = flight.to_level.is_some() || !knows_levels;
        match arrives {
            true => (reaches && !flight.ends_on_stairs(&facts.evidence.moves)).then_some(flight.to),
            false => Some(flight.from),
        }
    });
    let end = if is_top { "top" } else { "bottom" };
    match ends.into_iter().find(|frame| around.contains(frame)) {
        Some(frame) => Holds(frame),
        None => Fails(format!("the {end} of the stairs is not here")),
    }
}

/// Whether a room ends where a stretch ends. Where the walk turns off there, the room may go on.
fn judge_end(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, place: &PlaceMention, to: usize) -> ClaimOutcome {
    let name = &place.name;
    if claim.stays.is_empty() {
        return Unjudged;
    }
    if !claim.stays.iter().any(|stay| stay.left <= to + 1 && to <= stay.left + 1) {
        return Fails(format!("the path goes on in {name:?} here"));
    }
    let around = facts.around([to; 2]);
    match facts.memory.bends.iter().any(|bend| around.contains(&bend.first) || around.contains(&bend.last)) {
        true => Unknown(format!("the program cannot check whether {name:?} ends here")),
        false => Holds(to),
    }
}

fn judge_length(facts: &WalkFacts<'_>, [low_m, high_m]: [f64; 2], stretch: [usize; 2]) -> ClaimOutcome {
    let real_m = facts.length_m(stretch);
    let too_long = low_m > real_m * LENGTH_FACTOR && low_m - real_m > LENGTH_SLACK_M;
    let too_short = high_m * LENGTH_FACTOR < real_m && real_m - high_m > LENGTH_SLACK_M;
    if too_long || too_short { Fails("the path does not go so far here".to_owned()) } else { Holds(stretch[0]) }
}
