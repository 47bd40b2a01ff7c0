//! Decides what witnesses that leave things out can decide of a claim about places: whether a thing at the stop is only far off, how
//! many of a kind they name, on which side a thing is passed, whether two things lie beside each other or on both sides.

use super::{
    claims::{ClaimedFact, PlaceRole, StepClaim},
    facts::{WalkFacts, is_stairs},
    outcome::ClaimOutcome::{self, Fails, Holds, Unknown},
};
use crate::{
    FrameEvidence, SeenThing,
    evidence::is_wide,
    memory::is_any_door,
    sides::{side_word, wrap_angle},
};
use std::ops::RangeInclusive;
use wayword_core::Side;
use wayword_language::{
    lexicon::{find_thing, names_agree},
    reading::PlaceMention,
};

/// From so many frames at the end of a walk, one sees the thing to stop at.
const FRAMES_AT_STOP: usize = 2;
/// From so many frames at the end of a stretch, one sees two things that lie there.
const FRAMES_OF_PAIR: usize = 3;
/// A thing that a step passes is at the side at most so many frames before and after its stretch, of which the witnesses are not sure.
const FRAMES_OF_PASSING: usize = 3;
/// A thing that one passes is seen in such directions to the side, degrees.
const SIDEWAYS_DEG: RangeInclusive<f64> = 50.0..=130.0;
/// Two things beside each other are seen in directions that differ by at most this angle; if both are near, by twice as much, degrees.
const BESIDE_DEG: f64 = 60.0;
/// A walker between two things sees them in directions that differ by at least this angle, where a witness only names thirds of a view,
/// degrees.
const BETWEEN_DEG: f64 = 45.0;

/// What the witnesses say against a claim, or for it; `None` where they cannot tell.
pub(super) fn judge_by_sight<'a>(
    facts: &WalkFacts<'a>,
    claim: &StepClaim<'a>,
    stretch: [usize; 2],
) -> Option<ClaimOutcome> {
    let at_end = stretch[1].saturating_sub(FRAMES_OF_PAIR - 1)..=stretch[1];
    match claim.what {
        ClaimedFact::Place { place, .. } if place.count.is_some_and(|count| count > 1) => {
            judge_count(facts, place, facts.around(stretch))
        }
        ClaimedFact::Place { place, role: PlaceRole::Stopped | PlaceRole::Within { at_stop: true } } => {
            let last = facts.last_frame();
            judge_stop(facts, place, last.saturating_sub(FRAMES_AT_STOP - 1)..=last)
        }
        ClaimedFact::Place { place, role: PlaceRole::Passed | PlaceRole::TurnedPast } => {
            let frames = stretch[0].saturating_sub(FRAMES_OF_PASSING)..=stretch[1] + FRAMES_OF_PASSING;
            judge_side(facts, place, frames)
        }
        ClaimedFact::Beside(pair) => judge_pair(facts, pair, at_end, PairRelation::Beside),
        ClaimedFact::Between(pair) => judge_pair(facts, pair, at_end, PairRelation::Between),
        _ => None,
    }
}

/// The things that a place may be, as a frame shows them.
fn seen_from<'f>(
    facts: &WalkFacts<'f>,
    place: &'f PlaceMention,
    frame: usize,
) -> impl Iterator<Item = &'f SeenThing> + use<'f> {
    let things = facts.evidence.frames.get(frame).into_iter().flat_map(|seen| &seen.things);
    things.filter(|thing| names_agree(&thing.name, &place.name))
}

/// Whether a place is too wide, or one of too many, to be near a spot or far from it.
fn has_no_spot(place: &PlaceMention) -> bool {
    place.is_room || is_wide(&place.name) || is_any_door(&place.name)
}

/// Whether the number of a kind of thing is more than any witness names.
fn judge_count<'f>(
    facts: &WalkFacts<'f>,
    place: &'f PlaceMention,
    frames: RangeInclusive<usize>,
) -> Option<ClaimOutcome> {
    // Nobody counts flights by looking.
    let count = place.count.filter(|_| !is_stairs(&place.name))? as usize;
    let named = |frame: usize| -> usize {
        seen_from(facts, place, frame).map(|thing| if thing.several { count } else { 1 }).sum()
    };
    let most = frames.map(named).max()?;
    (0 < most && most < count).then(|| Fails(format!("no frame shows {count} of {:?}", place.name)))
}

/// Whether the thing at a stop is only seen far off.
fn judge_stop<'f>(
    facts: &WalkFacts<'f>,
    place: &'f PlaceMention,
    frames: RangeInclusive<usize>,
) -> Option<ClaimOutcome> {
    if has_no_spot(place) {
        return None;
    }
    let mut seen = frames.clone().flat_map(|frame| seen_from(facts, place, frame)).peekable();
    seen.peek()?;
    if !seen.all(|thing| thing.is_far) {
        return None;
    }
    let may_show = |frame: &FrameEvidence| frame.may_show(&place.name);
    Some(match facts.evidence.frames.get(frames)?.iter().any(may_show) {
        true => Unknown(format!("the program cannot check whether {:?} is near the end", place.name)),
        false => Fails(format!("{:?} is seen only far from where the path ends", place.name)),
    })
}

/// Whether a thing is only seen on the other side than the one that the text gives it.
fn judge_side<'f>(
    facts: &WalkFacts<'f>,
    place: &'f PlaceMention,
    frames: RangeInclusive<usize>,
) -> Option<ClaimOutcome> {
    let side = place.side.filter(|side| matches!(side, Side::Left | Side::Right) && !place.is_room)?;
    let off_deg = frames.flat_map(|frame| seen_from(facts, place, frame)).filter_map(|thing| thing.turn_rad);
    let mut sideways = off_deg.map(|rad| wrap_angle(rad).to_degrees()).filter(|deg| SIDEWAYS_DEG.contains(&deg.abs()));
    let is_other = |deg: f64| (deg < 0.0) != (side == Side::Left);
    let is_wrong = is_other(sideways.next()?) && sideways.all(is_other);
    is_wrong.then(|| Fails(format!("{:?} is not on the {} where the path passes it", place.name, side_word(side))))
}

/// A relation of two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PairRelation {
    /// One lies beside the other.
    Beside,
    /// The walker is between them.
    Between,
}

/// Whether two things that a frame shows lie to each other as a text says.
fn judge_pair<'f>(
    facts: &WalkFacts<'f>,
    [one, other]: [&'f PlaceMention; 2],
    frames: RangeInclusive<usize>,
    relation: PairRelation,
) -> Option<ClaimOutcome> {
    if [one, other].into_iter().any(has_no_spot) {
        return None;
    }
    let fits = |a: &SeenThing, b: &SeenThing| {
        let apart_deg = a.turn_rad.zip(b.turn_rad).map(|(a, b)| wrap_angle(a - b).to_degrees().abs())?;
        let are_near = !a.is_far && !b.is_far;
        Some(match relation {
            PairRelation::Beside => {
                a.is_far == b.is_far && apart_deg <= if are_near { 2.0 * BESIDE_DEG } else { BESIDE_DEG }
            }
            PairRelation::Between => are_near && apart_deg >= BETWEEN_DEG,
        })
    };
    let mut shown = Vec::new();
    for frame in frames.clone() {
        for a in seen_from(facts, one, frame) {
            shown.extend(seen_from(facts, other, frame).filter_map(|b| Some((frame, fits(a, b)?))));
        }
    }
    match shown.iter().find(|(_, fits)| *fits) {
        Some((frame, _)) => Some(Holds(*frame)),
        None if shown.is_empty() => [one, other]
            .into_iter()
            .find(|place| is_absent(facts, place, frames.clone()))
            .map(|place| Fails(format!("{:?} is not seen here", place.name))),
        None => Some(Fails(match relation {
            PairRelation::Beside => format!("{:?} is not near {:?} here", one.name, other.name),
            PairRelation::Between => format!("the walk is not between {:?} and {:?} here", one.name, other.name),
        })),
    }
}

/// Whether witnesses of several frames name no such thing in any of them, not even as a guess.
fn is_absent<'f>(facts: &WalkFacts<'f>, place: &'f PlaceMention, mut frames: RangeInclusive<usize>) -> bool {
    find_thing(&place.name).is_some()
        && frames.all(|frame| {
            let is_unseen = |seen: &FrameEvidence| seen.knows_things && !seen.may_show(&place.name);
            facts.evidence.frames.get(frame).is_some_and(is_unseen) && seen_from(facts, place, frame).next().is_none()
        })
}
