//! Decides whether a place has the role on a stretch that the text gives it: rooms, doors and things.

use super::{
    claims::{PlaceRole, StepClaim},
    facts::{NEAR_M, WalkFacts, is_stairs},
    outcome::ClaimOutcome::{self, Fails, Holds, Unjudged, Unknown},
};
use crate::{
    evidence::is_wide,
    goal::MAX_STOP_DISTANCE_M as STOP_M,
    memory::{AHEAD_FRAMES, BEHIND_STOP_M, RememberedThing, RoomStay, ThingPassing, WalkBend, is_way_through},
    sides::{lies_on, side_word, wrap_angle},
};
use wayword_core::Side;
use wayword_language::{
    lexicon::{ThingClass, find_thing, is_fabric},
    reading::{PlaceMention, PlaceOrdinal},
};

/// How far "stop by the stairs" holds: as [`STOP_M`], for things whose centre may be far although they are near: stairs, rugs, curtains.
const WIDE_STOP_M: f64 = 4.0;
/// A thing that the walker goes to may still be this far away at the end of the stretch, metres.
const APPROACHED_M: f64 = 3.5;
/// A walker who goes to a thing comes as near to it as the walk does, up to this, metres.
const REACHED_SLACK_M: f64 = 1.0;
/// A thing that the walk comes so near to was passed, metres.
const TOUCHED_M: f64 = 1.3;
/// A turn "at the lamp" is at most this far from it, metres; at a wide thing [`NEAR_M`].
const TURN_M: f64 = 2.2;
/// "Turn left past the sofa": the sofa is passed at most so long after the turn begins, metres.
const TURNED_PAST_M: f64 = 0.5;
/// A thing was passed before a stretch if it was passed so long before its first frame, metres.
const PASSED_BEFORE_M: f64 = 0.4;
/// From this angle on a thing is behind the walker, degrees.
const BEHIND_DEG: f64 = 110.0;
/// A thing that the walk passes is at most so far away there, metres.
const PASSED_M: f64 = 3.5;
/// A thing counts as in sight where a frame up to this many frames away shows it.
const SIGHT_FRAMES: usize = 3;

/// How far a bed or a bathtub reaches from its middle, metres.
const LARGE_REACH_M: f64 = 0.8;

/// Whether a thing is so long that a walker stands beside it long after its middle.
fn is_large(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| matches!(thing.class, ThingClass::Bed | ThingClass::Tub))
}

/// The judge of one place on one stretch.
pub(super) struct PlaceJudge<'f, 'a> {
    pub(super) facts: &'f WalkFacts<'a>,
    pub(super) claim: &'f StepClaim<'a>,
    pub(super) place: &'f PlaceMention,
    pub(super) role: PlaceRole,
    /// Its first and its last frame.
    pub(super) stretch: [usize; 2],
}

impl PlaceJudge<'_, '_> {
    pub(super) fn judge_place(&self) -> ClaimOutcome {
        let name = self.name();
        let as_room = self.place.is_room.then(|| self.judge_room());
        if let Some(holds @ Holds(_)) = as_room {
            return holds;
        }
        if is_stairs(name) && self.facts.flights_on(self.wider()).next().is_some() && self.role != PlaceRole::Passed {
            return Holds(self.stretch[0]);
        }
        if is_way_through(name) {
            return self.judge_door();
        }
        let things = &self.claim.things[0];
        match (things.is_empty(), as_room) {
            (false, _) => self.judge_count(things).unwrap_or_else(|| self.judge_things(things)),
            (true, Some(outcome)) if !self.place.is_thing => outcome,
            (true, None) if self.role == PlaceRole::Stopped && self.facts.lists_things() && !is_fabric(name) => {
                Fails(format!("{name:?} is not seen from the end of the path"))
            }
            (true, _) => Unjudged,
        }
    }

    pub(super) fn name(&self) -> &str {
        &self.place.name
    }

    /// The stretch with one more frame at either end.
    fn wider(&self) -> [usize; 2] {
        let around = self.facts.around(self.stretch);
        [*around.start(), *around.end()]
    }

    /// The mistake in a number of things, if the text names more than can be seen on the stretch.
    fn judge_count(&self, things: &[&RememberedThing]) -> Option<ClaimOutcome> {
        let count = self.place.count.filter(|count| *count > 1)? as usize;
        let around = self.facts.around(self.stretch);
        let is_there = |thing: &&&RememberedThing| around.clone().any(|frame| thing.glimpse_from(frame).is_some());
        let seen = things.iter().filter(is_there).count();
        (seen < count).then(|| Fails(format!("the path shows {seen} of {:?} here, and not {count}", self.name())))
    }

    /// Whether a change of rooms whose first frame behind it is `behind` belongs to the stretch. A turn just before it may belong to the
    /// step before, and a turn just behind it to the step that names the room or the one before; a turn at the end of the stretch comes
    /// before a change behind it.
    pub(super) fn changes_room_at(&self, behind: usize) -> bool {
        let [from, to] = self.stretch;
        let turns_at =
            |frame: usize| self.facts.memory.bends.iter().any(|bend| (bend.first..=bend.last).contains(&frame));
        match behind {
            _ if (from + 1..=to).contains(&behind) => true,
            _ if behind == from => behind > 0 && (behind - 1..=behind + 1).any(turns_at),
            _ if behind + 1 == from => behind > 0 && turns_at(behind),
            _ => behind == to + 1 && !turns_at(to),
        }
    }

    /// Whether the turn that the step makes before it comes to a change of rooms comes before it in the walk as well, or just behind the
    /// door.
    pub(super) fn turns_before(&self, behind: usize) -> bool {
        let turns = |side| self.facts.told_bend(side, [self.stretch[0], behind + 1]).is_some();
        self.claim.turn_before.is_none_or(turns)
    }

    /// Whether a room that is entered soon after the stretch lies straight ahead at its end.
    fn leads_straight_to(&self, entered: usize) -> bool {
        let to = self.stretch[1];
        let turns = || self.facts.memory.bends.iter().any(|bend| (to..entered).contains(&bend.first));
        (to + 1..=to + 2).contains(&entered) && !turns()
    }

    /// Decides a room.
    fn judge_room(&self) -> ClaimOutcome {
        let [from, to] = self.stretch;
        let (facts, name, last) = (self.facts, self.name(), self.facts.last_frame());
        let stays = || self.claim.stays.iter();
        let entered = || stays().map(|stay| stay.entered).filter(|entered| *entered > 0);
        let overlap =
            || stays().find(|stay| stay.entered <= to && stay.left >= from).map(|stay| stay.entered.max(from));
        let is_last_in = || facts.is_in_room(last, name).then_some(last);
        let found = match self.role {
            PlaceRole::Entered => {
                entered().find(|entered| self.changes_room_at(*entered) && self.turns_before(*entered))
            }
            // One can go to a room and enter it straight ahead afterwards, or be in it already.
            PlaceRole::Approached { .. } | PlaceRole::Reached => entered()
                .find(|entered| self.changes_room_at(*entered) || self.leads_straight_to(*entered))
                .or_else(|| is_last_in().filter(|_| to == last)),
            PlaceRole::Left => {
                stays().map(|stay| stay.left).find(|left| *left < last && self.changes_room_at(left + 1))
            }
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => is_last_in(),
            PlaceRole::TurnedAt | PlaceRole::TurnedPast | PlaceRole::Passed | PlaceRole::Near | PlaceRole::InSight => {
                facts.around(self.stretch).find(|frame| facts.is_in_room(*frame, name))
            }
            // From the stretch on, past things that the next steps name.
            PlaceRole::Along => {
                let goes_along = |stay: &&RoomStay| facts.memory.goes_along(stay, self.stretch[0]);
                overlap().filter(|_| stays().any(goes_along))
            }
            PlaceRole::Through | PlaceRole::Within { at_stop: false } => overlap(),
        };
        match found {
            Some(frame) => self.room_on_side(frame),
            None if stays().next().is_none() || !facts.knows_rooms() => Unjudged,
            None => Fails(match self.role {
                PlaceRole::Entered => format!("the path does not enter {name:?} here"),
                PlaceRole::Left => format!("the path does not leave {name:?} here"),
                PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => {
                    format!("the path does not end in {name:?}")
                }
                _ => format!("the path is not at {name:?} here"),
            }),
        }
    }

    /// A room that is entered on a side: the walk has to turn to it.
    fn room_on_side(&self, frame: usize) -> ClaimOutcome {
        if !matches!(self.role, PlaceRole::Entered | PlaceRole::Approached { .. } | PlaceRole::Through) {
            return Holds(frame);
        }
        self.way_on_side(frame.saturating_sub(1), frame)
    }

    /// Decides a thing, of which one of `things` may be meant.
    fn judge_things(&self, things: &[&RememberedThing]) -> ClaimOutcome {
        let there: Vec<(&RememberedThing, Vec<usize>)> = things
            .iter()
            .map(|thing| (*thing, self.frames_of(thing)))
            .filter(|(_, frames)| !frames.is_empty())
            .collect();
        let Some(first) = there.first().and_then(|(_, frames)| frames.first()) else {
            return self.missing_reason(things);
        };
        if let Some(PlaceOrdinal::Number(number)) =
            self.place.ordinal.filter(|ordinal| *ordinal != PlaceOrdinal::Number(1))
        {
            let is_it = |thing: &RememberedThing| {
                self.facts.memory.ordinal_among_alike(thing).is_some_and(|(place, _)| place == number as usize)
            };
            if !there.iter().any(|(thing, _)| is_it(thing)) {
                return Unknown(format!("the program cannot check which {:?} is meant", self.name()));
            }
        }
        let Some(side) = self.place.side else { return Holds(*first) };
        let sides: Vec<(usize, Option<bool>)> = there
            .iter()
            .flat_map(|(thing, frames)| frames.iter().map(|frame| (*frame, self.is_on_side(thing, *frame, side))))
            .collect();
        if let Some((frame, _)) = sides.iter().find(|(_, is_there)| *is_there == Some(true)) {
            return Holds(*frame);
        }
        if sides.iter().any(|(_, is_there)| is_there.is_none()) {
            return Unknown(format!("the program cannot check on which side of the walker {:?} is", self.name()));
        }
        Fails(format!("{:?} is not on the {} where the path passes it", self.name(), side_word(side)))
    }

    /// The frames of the stretch at which a thing has the role that the text gives it.
    fn frames_of(&self, thing: &RememberedThing) -> Vec<usize> {
        let [from, to] = self.stretch;
        let (facts, last) = (self.facts, self.facts.last_frame());
        let far_m = |frame: usize| facts.memory.distance_m(thing, frame);
        let is_seen = |frame: usize| thing.glimpse_from(frame).is_some();
        let is_seen_near = |frame: usize| (frame.saturating_sub(SIGHT_FRAMES)..=frame + SIGHT_FRAMES).any(is_seen);
        // Without a position, being seen is all that is known.
        let within = |frame: usize, limit_m: f64| match far_m(frame) {
            Some(far_m) => far_m <= limit_m && (is_seen_near(frame) || !facts.lists_things()),
            None => is_seen(frame),
        };
        if !self.was_ahead(thing) || self.is_in_other_room(thing) {
            return Vec::new();
        }
        let around = facts.around(self.stretch);
        // A side is that of the stretch itself.
        let frames = || if self.place.side.is_some() { from..=to } else { around.clone() };
        let stop_m = if is_wide(self.name()) { WIDE_STOP_M } else { STOP_M };
        match self.role {
            PlaceRole::Passed => {
                let is_here = |passed: &ThingPassing| {
                    (from..=to + 1).contains(&passed.frame)
                        && !self.is_passed_before(passed)
                        && !self.is_behind_at_first(thing)
                };
                match thing.passed.filter(|passed| within(passed.frame, PASSED_M)) {
                    Some(passed) if is_here(&passed) => vec![passed.frame],
                    Some(_) if !is_wide(self.name()) => Vec::new(),
                    _ => (from..=to).filter(|frame| within(*frame, TOUCHED_M)).collect(),
                }
            }
            PlaceRole::Approached { is_reached } => {
                let (start_m, end_m) = (far_m(from), far_m(to));
                let comes_nearer = start_m.zip(end_m).is_none_or(|(start_m, end_m)| end_m < start_m - 0.3);
                let is_ahead = facts.is_ahead(thing, to);
                let is_toward = comes_nearer && (within(to, APPROACHED_M) || is_ahead) && (from..=to).any(is_seen);
                // What lies at the side is passed.
                let leads_there = within(to, TOUCHED_M)
                    || (from.max(to.saturating_sub(1))..=to).any(|frame| facts.is_ahead(thing, frame));
                // One goes to a thing until the walk leads away from it.
                let nearest_m = (0..=last).filter_map(far_m).fold(f64::INFINITY, f64::min);
                let is_there = far_m(to).is_none_or(|end_m| end_m <= nearest_m + REACHED_SLACK_M);
                let comes_there = if is_reached { within(to, APPROACHED_M) && is_there } else { within(to, stop_m) };
                ((comes_there || (is_toward && !is_reached)) && leads_there).then_some(to).into_iter().collect()
            }
            PlaceRole::TurnedPast => {
                let is_before = |passed: &usize, bend: &WalkBend| {
                    facts.length_m([bend.first.min(*passed), *passed]) <= TURNED_PAST_M
                };
                let passed = thing.passed.filter(|passed| !self.is_passed_before(passed)).map(|passed| passed.frame);
                let passed = passed.filter(|frame| within(*frame, PASSED_M));
                let passed = passed.filter(|passed| facts.bends_on(self.stretch).any(|bend| is_before(passed, bend)));
                passed.filter(|frame| (from.saturating_sub(1)..=to + 1).contains(frame)).into_iter().collect()
            }
            PlaceRole::Reached => (to..=(to + 1).min(last)).filter(|frame| within(*frame, stop_m)).collect(),
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => {
                let limit_m = match self.is_behind_at_last(thing) {
                    true if is_large(self.name()) => BEHIND_STOP_M + LARGE_REACH_M,
                    true => BEHIND_STOP_M,
                    false => stop_m,
                };
                let is_there = within(last, limit_m) && (is_seen(last) || within(last, TOUCHED_M));
                is_there.then_some(last).into_iter().collect()
            }
            PlaceRole::TurnedAt => {
                let turn_m = if is_wide(self.name()) { NEAR_M } else { TURN_M };
                let mut bends = facts.bends_on(self.stretch).peekable();
                match bends.peek().is_none() {
                    true => frames().filter(|frame| within(*frame, turn_m)).collect(),
                    false => bends
                        .flat_map(|bend| bend.first..=bend.last + 1)
                        .filter(|frame| within(*frame, turn_m))
                        .collect(),
                }
            }
            PlaceRole::Entered | PlaceRole::Left | PlaceRole::Through => {
                frames().filter(|frame| within(*frame, stop_m)).collect()
            }
            PlaceRole::Along | PlaceRole::Near | PlaceRole::Within { at_stop: false } => {
                frames().filter(|frame| within(*frame, NEAR_M)).collect()
            }
            PlaceRole::InSight => frames().filter(|frame| is_seen(*frame)).collect(),
        }
    }

    /// Whether a thing is passed before the stretch begins.
    fn is_passed_before(&self, passed: &ThingPassing) -> bool {
        self.facts.length_m([0, self.stretch[0]]) - passed.along_m > PASSED_BEFORE_M
    }

    /// Whether a thing lies behind a walker who goes on from the first frame of the stretch.
    fn is_behind_at_first(&self, thing: &RememberedThing) -> bool {
        let from = self.stretch[0];
        let leaving_rad = self.facts.evidence.moves.get(from).map_or(0.0, |step| step.turn_rad);
        let towards = self.facts.direction_rad(thing, from).map(|rad| wrap_angle(rad - leaving_rad));
        towards.is_some_and(|rad| rad.abs() >= BEHIND_DEG.to_radians())
    }

    /// Whether a thing lies behind a walker at the last frame, or was passed long before.
    fn is_behind_at_last(&self, thing: &RememberedThing) -> bool {
        let direction_rad = self.facts.direction_rad(thing, self.facts.last_frame());
        direction_rad.is_some_and(|rad| rad.abs() >= BEHIND_DEG.to_radians()) || self.facts.memory.is_left_behind(thing)
    }

    /// Whether a thing stands in a room where the walk is not: on the stretch, at its end for a stop, or later for a thing ahead.
    fn is_in_other_room(&self, thing: &RememberedThing) -> bool {
        let [from, to] = self.stretch;
        let last = self.facts.last_frame();
        let frames = match self.role {
            PlaceRole::Approached { is_reached: false } | PlaceRole::Reached => to..=last,
            PlaceRole::Approached { is_reached: true } => from..=(to + 1).min(last),
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => last..=last,
            PlaceRole::InSight => return false,
            PlaceRole::Passed | PlaceRole::TurnedPast => from..=to,
            PlaceRole::TurnedAt => from..=self.facts.bends_on(self.stretch).next().map_or(to, |bend| bend.first),
            _ => from.saturating_sub(1)..=(to + 1).min(last),
        };
        thing.room.as_ref().is_some_and(|room| {
            let knows = frames.clone().all(|frame| self.facts.knows_room(frame));
            knows && !frames.clone().any(|frame| self.facts.is_in_room(frame, room))
        })
    }

    /// Whether the walker saw a thing ahead, on the stretch or not long before. Where directions are not known, being seen is enough.
    fn was_ahead(&self, thing: &RememberedThing) -> bool {
        let [from, to] = self.stretch;
        let frames = match self.role {
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => to.saturating_sub(AHEAD_FRAMES)..=to,
            _ => from.saturating_sub(AHEAD_FRAMES)..=to + 1,
        };
        thing.is_ahead_from(&frames)
    }

    /// Whether a thing is on a side of the walker at a frame; `None` where its direction is not known.
    fn is_on_side(&self, thing: &RememberedThing, frame: usize, side: Side) -> Option<bool> {
        if let Some(passed) = thing.passed.filter(|passed| thing.position.is_some() && passed.frame == frame)
            && matches!(self.role, PlaceRole::Passed | PlaceRole::TurnedPast)
        {
            return Some(passed.side == side);
        }
        let arriving_rad = self.facts.direction_rad(thing, frame)?;
        let leaving_rad = self.facts.evidence.moves.get(frame).map_or(0.0, |step| step.turn_rad);
        Some(lies_on(side, wrap_angle(arriving_rad)) || lies_on(side, wrap_angle(arriving_rad - leaving_rad)))
    }

    /// Why none of the things has the role.
    fn missing_reason(&self, things: &[&RememberedThing]) -> ClaimOutcome {
        let name = self.name();
        let last = self.facts.last_frame();
        Fails(match self.role {
            PlaceRole::Passed => format!("the path does not pass {name:?} here"),
            PlaceRole::TurnedPast => format!("the path turns before it passes {name:?}"),
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => {
                let far_m = things.iter().filter_map(|thing| self.facts.memory.distance_m(thing, last));
                match far_m.min_by(f64::total_cmp) {
                    Some(far_m) if far_m > STOP_M && !is_wide(name) => {
                        format!("the nearest {name:?} is {far_m:.1} m from where the path ends")
                    }
                    Some(_) if things.iter().any(|thing| self.is_behind_at_last(thing)) => {
                        format!("{name:?} is behind a walker where the path ends")
                    }
                    _ => format!("{name:?} is not seen from the end of the path"),
                }
            }
            PlaceRole::Approached { .. } | PlaceRole::Reached => format!("the path does not lead to {name:?} here"),
            PlaceRole::TurnedAt => format!("the path does not turn at {name:?}"),
            PlaceRole::Entered | PlaceRole::Through => format!("the path does not go through {name:?} here"),
            PlaceRole::Left => format!("the path does not leave {name:?} here"),
            PlaceRole::InSight => format!("{name:?} is not in sight here"),
            PlaceRole::Along | PlaceRole::Near | PlaceRole::Within { at_stop: false } => {
                format!("{name:?} is not near the path here")
            }
        })
    }
}
