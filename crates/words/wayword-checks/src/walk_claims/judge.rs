//! Decides whether a claim holds on a stretch of the walk.

use super::{
    claims::{ClaimedFact, PlaceRole, StepClaim},
    facts::{WalkFacts, is_stairs},
};
use crate::{
    goal::{MAX_STOP_DISTANCE_M as STOP_M, is_wide},
    landmarks::is_door,
    memory::{RememberedThing, RoomOpening, ThingGlimpse},
    sides::{lies_on, side_word, wrap_angle},
};
use wayword_core::{ClimbDirection, DVec3, Side, motion};
use wayword_language::{
    lexicon::{ThingClass, find_thing, is_fabric},
    reading::{PlaceMention, PlaceOrdinal},
};

/// How far "stop by the stairs" holds: as [`STOP_M`], for things whose centre may be far although they are near: stairs, rugs, curtains.
const WIDE_STOP_M: f64 = 4.0;
/// A turn "at the sofa" is at most this far from it, and a walker "by the sofa" as well, metres.
const NEAR_M: f64 = 3.0;
/// A thing that the walker goes to may still be this far away at the end of the stretch, metres.
const APPROACHED_M: f64 = 3.5;
/// Two things beside each other have centres at most this far apart, metres.
const BESIDE_M: f64 = 2.5;
/// A thing that the walk comes so near to was passed, metres.
const TOUCHED_M: f64 = 1.3;
/// A walk goes through a door whose middle it comes so near to, metres: between two frames lies half a metre.
const THROUGH_M: f64 = 0.9;
/// A door between two frames lies at most so far from one of them, metres.
const DOOR_M: f64 = 1.4;
/// What lies behind a walker at the end has to be so near, metres: it was passed else.
const BEHIND_STOP_M: f64 = 1.5;
/// From this angle on a thing is behind the walker, degrees.
const BEHIND_DEG: f64 = 110.0;
/// A picture ahead shows what lies within this angle of the heading, degrees.
const AHEAD_DEG: f64 = 50.0;
/// A thing is known to the walker who saw it ahead at most this many frames before the stretch.
const AHEAD_FRAMES: usize = 4;
/// A thing that the walk passes is at most so far away there, metres.
const PASSED_M: f64 = 3.5;
/// A thing counts as in sight where a frame up to this many frames away shows it.
const SIGHT_FRAMES: usize = 3;
/// A stretch climbs if it rises or falls by this height, metres.
const CLIMB_M: f64 = 0.3;
/// A walker between two things sees them in directions that differ by at least this angle, degrees.
const BETWEEN_DEG: f64 = 75.0;
/// The way into a doorway "on the right" turns by at least this angle, degrees.
const SIDEWAYS_DEG: f64 = 15.0;
/// A length is wrong where it is more than this many times too long or too short, and off by more than [`LENGTH_SLACK_M`].
const LENGTH_FACTOR: f64 = 1.6;
/// Two hops of a walk, metres.
const LENGTH_SLACK_M: f64 = 2.0;

/// Whether a claim holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ClaimOutcome {
    /// It holds, at this frame.
    Holds(usize),
    /// It does not hold.
    Fails(String),
    /// It cannot be decided.
    Unknown(String),
    /// Another check decides it: whether there is such a thing along the walk at all.
    Unjudged,
}

use ClaimOutcome::{Fails, Holds, Unjudged, Unknown};

/// Decides a claim on a stretch, given by its first and its last frame.
pub(super) fn judge_claim(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, stretch: [usize; 2]) -> ClaimOutcome {
    match claim.what {
        ClaimedFact::Turn(side) => judge_turn(facts, side, stretch),
        ClaimedFact::Climb(climb) => judge_climb(facts, climb, stretch),
        ClaimedFact::Place { place, role } => PlaceJudge { facts, claim, place, role, stretch }.judge_place(),
        ClaimedFact::Between(pair) => judge_between(facts, claim, pair, stretch[1]),
        ClaimedFact::Beside(pair) => judge_beside(facts, claim, pair, stretch),
        ClaimedFact::StairEnd { is_top } => judge_stair_end(facts, is_top, stretch),
        ClaimedFact::EndOf(place) => judge_end(facts, claim, place, stretch[1]),
        ClaimedFact::Length { low_m, high_m } => judge_length(facts, [low_m, high_m], stretch),
    }
}

fn judge_turn(facts: &WalkFacts<'_>, side: Side, stretch: [usize; 2]) -> ClaimOutcome {
    if let Some(bend) = facts.told_bend(side, stretch) {
        return Holds(bend.first);
    }
    let sign = match side {
        Side::Left => -1.0,
        Side::Right => 1.0,
        Side::Ahead | Side::Behind => 0.0,
    };
    // A long curve of small turns.
    if facts.bends_on(stretch).next().is_none()
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
            true => reaches.then_some(flight.to),
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

/// Whether two places lie beside each other near a stretch.
fn judge_beside(
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
    let places =
        |things: &[&RememberedThing]| things.iter().map(|thing| thing.position).collect::<Option<Vec<DVec3>>>();
    let (Some(here), Some(there)) = (places(&here), places(there)) else {
        return Unknown(format!("the program cannot check whether {:?} is near {:?}", place.name, neighbour.name));
    };
    let is_wide = [place, neighbour].iter().any(|place| is_wide(&place.name));
    let limit_m = if is_wide { 2.0 * BESIDE_M } else { BESIDE_M };
    let is_pair = here.iter().any(|a| there.iter().any(|b| a != b && (*a - *b).truncate().length() <= limit_m));
    if is_pair { Holds(stretch[1]) } else { Fails(format!("{:?} is not near {:?} here", place.name, neighbour.name)) }
}

/// Decides a relation of two places of which one at least is not seen along the walk.
fn judge_absent_pair(facts: &WalkFacts<'_>, claim: &StepClaim<'_>, pair: [&PlaceMention; 2]) -> ClaimOutcome {
    let is_absent = |(place, things): &(&PlaceMention, &Vec<&RememberedThing>)| {
        place.is_thing && !place.is_room && !is_fabric(&place.name) && things.is_empty()
    };
    match pair.into_iter().zip(&claim.things).find(is_absent) {
        Some((place, _)) if facts.lists_things() => {
            Unknown(format!("the program cannot check where {:?} is: the path does not show it", place.name))
        }
        _ => Unjudged,
    }
}

/// Whether a frame lies between two places.
fn judge_between(
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

/// Whether a name means an opening between rooms, of whatever kind.
fn is_any_door(name: &str) -> bool {
    is_door(name) || find_thing(name).is_some_and(|thing| thing.class == ThingClass::Door)
}

/// The judge of one place on one stretch.
struct PlaceJudge<'f, 'a> {
    facts: &'f WalkFacts<'a>,
    claim: &'f StepClaim<'a>,
    place: &'f PlaceMention,
    role: PlaceRole,
    stretch: [usize; 2],
}

impl PlaceJudge<'_, '_> {
    fn judge_place(&self) -> ClaimOutcome {
        let name = self.name();
        let as_room = self.place.is_room.then(|| self.judge_room());
        if let Some(holds @ Holds(_)) = as_room {
            return holds;
        }
        if is_stairs(name) && self.facts.flights_on(self.wider()).next().is_some() && self.role != PlaceRole::Passed {
            return Holds(self.stretch[0]);
        }
        if is_any_door(name) {
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

    fn name(&self) -> &str {
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
    /// step before; a turn at the end of the stretch comes before a change behind it.
    fn changes_room_at(&self, behind: usize) -> bool {
        let [from, to] = self.stretch;
        let turns_at =
            |frame: usize| self.facts.memory.bends.iter().any(|bend| (bend.first..=bend.last).contains(&frame));
        match behind {
            _ if (from + 1..=to).contains(&behind) => true,
            _ if behind == from => behind > 0 && turns_at(behind - 1),
            _ => behind == to + 1 && !turns_at(to),
        }
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
            PlaceRole::Entered => entered().find(|entered| self.changes_room_at(*entered)),
            // One can go to a room and turn into it afterwards, or be in it already.
            PlaceRole::Approached | PlaceRole::Reached => entered()
                .find(|entered| self.changes_room_at(*entered) || (to + 1..=to + 2).contains(entered))
                .or_else(|| is_last_in().filter(|_| to == last)),
            PlaceRole::Left => {
                stays().map(|stay| stay.left).find(|left| *left < last && self.changes_room_at(left + 1))
            }
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => is_last_in(),
            PlaceRole::TurnedAt | PlaceRole::Passed | PlaceRole::Near | PlaceRole::InSight => {
                facts.around(self.stretch).find(|frame| facts.is_in_room(*frame, name))
            }
            PlaceRole::Through | PlaceRole::Along | PlaceRole::Within { at_stop: false } => overlap(),
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
        if !matches!(self.role, PlaceRole::Entered | PlaceRole::Approached | PlaceRole::Through) {
            return Holds(frame);
        }
        self.way_on_side(frame.saturating_sub(1), frame)
    }

    /// Whether the way through a change of rooms turns to the side that the text gives it.
    fn way_on_side(&self, before: usize, behind: usize) -> ClaimOutcome {
        let Some(side @ (Side::Left | Side::Right)) = self.place.side else { return Holds(behind) };
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        let around = self.facts.around([before, behind]);
        let has_bend = self.facts.told_bend(side, [*around.start(), *around.end()]).is_some();
        let net_deg = self.facts.net_turn_deg(around) * sign;
        match net_deg {
            _ if has_bend || net_deg >= SIDEWAYS_DEG => Holds(behind),
            deg if deg <= -SIDEWAYS_DEG => {
                Fails(format!("{:?} is not on the {} where the path enters it", self.name(), side_word(side)))
            }
            _ => Unknown(format!("the program cannot check on which side {:?} is", self.name())),
        }
    }

    /// Decides a door or doorway.
    fn judge_door(&self) -> ClaimOutcome {
        let (facts, name, last) = (self.facts, self.name(), self.facts.last_frame());
        let around = facts.around(self.stretch);
        let far_m =
            |thing: &RememberedThing, frame: usize| facts.memory.distance_m(thing, frame).unwrap_or(f64::INFINITY);
        let doors = || self.claim.things[0].iter();
        let unknown = || Unknown(format!("the program cannot check which {name:?} is meant"));
        if matches!(self.place.ordinal, Some(PlaceOrdinal::Last))
            || matches!(self.place.ordinal, Some(PlaceOrdinal::Number(number)) if number > 1)
        {
            return unknown();
        }
        let mut openings = facts.memory.openings.iter();
        match self.role {
            PlaceRole::Entered | PlaceRole::Through | PlaceRole::Left => {
                let has_door = |opening: &&RoomOpening| {
                    [opening.before, opening.behind]
                        .iter()
                        .any(|frame| doors().any(|door| far_m(door, *frame) <= DOOR_M))
                };
                if let Some(opening) = openings.filter(has_door).find(|opening| self.changes_room_at(opening.behind)) {
                    return self.way_on_side(opening.before, opening.behind);
                }
                // Two rooms of one name have no change of rooms between them.
                let [from, to] = self.stretch;
                let through = (from..=to).find(|frame| doors().any(|door| far_m(door, *frame) <= THROUGH_M));
                match through {
                    Some(frame) => self.way_on_side(frame, (frame + 1).min(last)),
                    None if facts.knows_rooms() => Fails(format!("the path does not go through a {name} here")),
                    None => unknown(),
                }
            }
            PlaceRole::Stopped | PlaceRole::Within { .. } => {
                let ends_in_door = openings.any(|opening| opening.behind + 1 >= last && opening.before <= last);
                match ends_in_door || doors().any(|door| far_m(door, last) <= STOP_M) {
                    true => Holds(last),
                    false => unknown(),
                }
            }
            _ => {
                let is_near = |frame: usize| doors().any(|door| far_m(door, frame) <= NEAR_M);
                let opening =
                    openings.find(|opening| around.contains(&opening.before) || around.contains(&opening.behind));
                let found =
                    opening.map(|opening| opening.before).or_else(|| around.clone().find(|frame| is_near(*frame)));
                found.map_or_else(unknown, Holds)
            }
        }
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
        if !self.was_ahead(thing) {
            return Vec::new();
        }
        let around = facts.around(self.stretch);
        // A side is that of the stretch itself.
        let frames = || if self.place.side.is_some() { from..=to } else { around.clone() };
        let stop_m = if is_wide(self.name()) { WIDE_STOP_M } else { STOP_M };
        match self.role {
            PlaceRole::Passed => {
                let passed = thing.passed.map(|passed| passed.frame).filter(|frame| (from..=to + 1).contains(frame));
                let passed = passed.filter(|frame| within(*frame, PASSED_M));
                passed.into_iter().chain((from..=to).filter(|frame| within(*frame, TOUCHED_M))).collect()
            }
            PlaceRole::Approached => {
                let (start_m, end_m) = (far_m(from), far_m(to));
                let comes_nearer = start_m.zip(end_m).is_none_or(|(start_m, end_m)| end_m < start_m - 0.3);
                let is_ahead = facts.is_ahead(thing, to);
                let is_toward = comes_nearer && (within(to, APPROACHED_M) || is_ahead) && (from..=to).any(is_seen);
                (within(to, stop_m) || is_toward).then_some(to).into_iter().collect()
            }
            PlaceRole::Reached => (to..=(to + 1).min(last)).filter(|frame| within(*frame, stop_m)).collect(),
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => {
                let is_behind =
                    facts.direction_rad(thing, last).is_some_and(|rad| rad.abs() >= BEHIND_DEG.to_radians());
                let limit_m = if is_behind { BEHIND_STOP_M } else { stop_m };
                let is_there = within(last, limit_m) && (is_seen(last) || within(last, TOUCHED_M));
                is_there.then_some(last).into_iter().collect()
            }
            PlaceRole::TurnedAt => {
                let mut bends = facts.bends_on(self.stretch).peekable();
                match bends.peek().is_none() {
                    true => frames().filter(|frame| within(*frame, NEAR_M)).collect(),
                    false => bends
                        .flat_map(|bend| bend.first..=bend.last + 1)
                        .filter(|frame| within(*frame, NEAR_M))
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

    /// Whether the walker saw a thing ahead, on the stretch or not long before. Where directions are not known, being seen is enough.
    fn was_ahead(&self, thing: &RememberedThing) -> bool {
        let [from, to] = self.stretch;
        let frames = from.saturating_sub(AHEAD_FRAMES)..=to + 1;
        let is_ahead = |glimpse: &ThingGlimpse| glimpse.turn_rad.is_none_or(|rad| rad.abs() <= AHEAD_DEG.to_radians());
        thing.glimpses.iter().any(|glimpse| frames.contains(&glimpse.frame) && is_ahead(glimpse))
    }

    /// Whether a thing is on a side of the walker at a frame; `None` where its direction is not known.
    fn is_on_side(&self, thing: &RememberedThing, frame: usize, side: Side) -> Option<bool> {
        if let (PlaceRole::Passed, Some(passed)) = (self.role, thing.passed.filter(|_| thing.position.is_some()))
            && passed.frame == frame
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
            PlaceRole::Stopped | PlaceRole::Within { at_stop: true } => {
                let far_m = things.iter().filter_map(|thing| self.facts.memory.distance_m(thing, last));
                match far_m.min_by(f64::total_cmp) {
                    Some(far_m) if far_m > STOP_M && !is_wide(name) => {
                        format!("the nearest {name:?} is {far_m:.1} m from where the path ends")
                    }
                    _ => format!("{name:?} is not seen from the end of the path"),
                }
            }
            PlaceRole::Approached | PlaceRole::Reached => format!("the path does not lead to {name:?} here"),
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
