//! What is known of a walk, for claims about its stretches: distances, turns, flights, rooms and openings.

use crate::{
    Evidence, WalkMemory,
    memory::{RememberedThing, RoomStay, StairFlight, WalkBend, is_any_door, is_door},
    sides::{lies_on, wrap_angle},
};
use wayword_core::{Side, motion};
use wayword_language::{
    lexicon::{ThingClass, find_thing, names_agree, normalise_name, room_name, same_colour, same_room},
    reading::PlaceMention,
};

/// A walker "by the sofa" is at most this far from it, metres.
pub(super) const NEAR_M: f64 = 3.0;

/// A bend that straightens the way turns by less than this, degrees.
const STRAIGHTENING_DEG: f64 = 60.0;
/// It comes after less than this way behind the bend that it takes back, metres.
const STRAIGHTENING_M: f64 = 2.5;

/// The facts of a walk.
pub(super) struct WalkFacts<'a> {
    pub(super) evidence: &'a Evidence,
    pub(super) memory: &'a WalkMemory,
    /// How far along the walk each frame lies, metres.
    along_m: Vec<f64>,
}

impl<'a> WalkFacts<'a> {
    pub(super) fn new(evidence: &'a Evidence, memory: &'a WalkMemory) -> Self {
        let mut along_m = vec![0.0];
        along_m.extend(evidence.moves.iter().scan(0.0, |sum, step| {
            *sum += step.distance_m;
            Some(*sum)
        }));
        Self { evidence, memory, along_m }
    }

    /// The number of the last frame.
    pub(super) fn last_frame(&self) -> usize {
        self.evidence.frames.len().saturating_sub(1)
    }

    /// The length of a stretch, metres.
    pub(super) fn length_m(&self, [from, to]: [usize; 2]) -> f64 {
        let along = |frame: usize| self.along_m.get(frame).or(self.along_m.last()).copied().unwrap_or_default();
        along(to) - along(from)
    }

    /// The frames of a stretch, with one more at either end, because frames lie up to a metre apart.
    pub(super) fn around(&self, [from, to]: [usize; 2]) -> std::ops::RangeInclusive<usize> {
        from.saturating_sub(1)..=(to + 1).min(self.last_frame())
    }

    /// The bends that begin on a stretch.
    pub(super) fn bends_on(&self, [from, to]: [usize; 2]) -> impl Iterator<Item = &'a WalkBend> {
        self.memory.bends.iter().filter(move |bend| (from..to).contains(&bend.first))
    }

    /// The bend of a stretch that a step's turn means: the widest to its side.
    pub(super) fn told_bend(&self, side: Side, stretch: [usize; 2]) -> Option<&'a WalkBend> {
        widest_to(side, self.bends_on(stretch))
    }

    /// Whether a walker has to be told of a bend: it is wide enough, and does not only straighten the way after the bend before it, as
    /// behind a door that one goes through aslant.
    pub(super) fn is_decision(&self, bend: &WalkBend) -> bool {
        bend.turn_rad.to_degrees().abs() >= motion::TOLD_DEG && !self.straightens(bend)
    }

    /// Whether a bend takes back the bend just before it.
    fn straightens(&self, bend: &WalkBend) -> bool {
        let bends = &self.memory.bends;
        let at = bends.iter().position(|other| other == bend).filter(|at| *at > 0);
        let Some(before) = at.and_then(|at| bends.get(at - 1)) else { return false };
        let net_deg = (before.turn_rad + bend.turn_rad).to_degrees().abs();
        let is_small = bend.turn_rad.to_degrees().abs() < STRAIGHTENING_DEG;
        is_small && net_deg < motion::SLIGHT_DEG && self.length_m([before.last, bend.first]) < STRAIGHTENING_M
    }

    /// The flights of stairs whose middle lies on a stretch.
    pub(super) fn flights_on(&self, [from, to]: [usize; 2]) -> impl Iterator<Item = &'a StairFlight> {
        self.memory.flights.iter().filter(move |flight| (from..to).contains(&((flight.from + flight.to) / 2)))
    }

    /// The things of the walk that a place of the text may be.
    pub(super) fn things_meant(&self, place: &PlaceMention) -> Vec<&'a RememberedThing> {
        // "The floor lamp" is no table lamp where there are floor lamps.
        let is_exact = |thing: &&RememberedThing| normalise_name(&thing.name) == place.name;
        let has_exact = place.name.contains(' ') && self.memory.things.iter().any(|thing| is_exact(&thing));
        // A door stands in a doorway.
        let is_named = |thing: &RememberedThing| {
            names_agree(&thing.name, &place.name) || (is_door(&place.name) && is_any_door(&thing.name))
        };
        let is_alike = |thing: &&RememberedThing| is_named(thing) && (!has_exact || is_exact(thing));
        let alike = self.memory.things.iter().filter(is_alike);
        let has_colour = |thing: &&RememberedThing| match (&thing.colour, &place.colour) {
            (Some(known), Some(claimed)) => same_colour(known, claimed),
            _ => true,
        };
        let coloured: Vec<&RememberedThing> = alike.clone().filter(has_colour).collect();
        if coloured.is_empty() { alike.collect() } else { coloured }
    }

    /// The stays in rooms of a name: those of exactly that name, where there are any. A hallway may be called an entryway only where there
    /// is no entryway.
    pub(super) fn stays_in(&self, name: &str) -> Vec<&'a RoomStay> {
        let alike = || self.memory.stays.iter().filter(|stay| same_room(&stay.room, name));
        let exact: Vec<&RoomStay> = alike().filter(|stay| room_name(&stay.room) == room_name(name)).collect();
        if exact.is_empty() { alike().collect() } else { exact }
    }

    /// Whether a frame lies in a room of a name.
    pub(super) fn is_in_room(&self, frame: usize, name: &str) -> bool {
        self.evidence.frames.get(frame).is_some_and(|seen| seen.rooms.iter().any(|room| same_room(room, name)))
    }

    /// Whether the room of a frame is known.
    pub(super) fn knows_room(&self, frame: usize) -> bool {
        self.evidence.frames.get(frame).is_some_and(|seen| !seen.rooms.is_empty())
    }

    /// Whether the room of every frame is known.
    pub(super) fn knows_rooms(&self) -> bool {
        self.evidence.frames.iter().all(|frame| !frame.rooms.is_empty())
    }

    /// The direction of a thing from the heading with which the walk arrives at a frame, radians, positive right.
    pub(super) fn direction_rad(&self, thing: &RememberedThing, frame: usize) -> Option<f64> {
        let glimpsed = || thing.glimpse_from(frame).and_then(|glimpse| glimpse.turn_rad);
        self.memory.turn_towards(thing, frame).or_else(glimpsed)
    }

    /// Whether a thing lies ahead of a walker that arrives at a frame, or goes on from there.
    pub(super) fn is_ahead(&self, thing: &RememberedThing, frame: usize) -> bool {
        let leaving_rad = self.evidence.moves.get(frame).map_or(0.0, |step| step.turn_rad);
        self.direction_rad(thing, frame)
            .is_some_and(|rad| lies_on(Side::Ahead, rad) || lies_on(Side::Ahead, wrap_angle(rad - leaving_rad)))
    }

    /// Whether the things that can be seen from every frame are known.
    pub(super) fn lists_things(&self) -> bool {
        self.evidence.frames.iter().all(|frame| frame.knows_things)
    }

    /// How far the walk turns over a stretch in sum, degrees, positive right.
    pub(super) fn net_turn_deg(&self, frames: std::ops::RangeInclusive<usize>) -> f64 {
        let moves = self.evidence.moves.get(*frames.start()..(*frames.end()).min(self.evidence.moves.len()));
        moves.unwrap_or_default().iter().map(|step| step.turn_rad.to_degrees()).sum()
    }
}

/// The widest of some bends to a side.
pub(super) fn widest_to<'b>(side: Side, bends: impl Iterator<Item = &'b WalkBend>) -> Option<&'b WalkBend> {
    let fitting = bends.filter(|bend| turns_to(bend, side));
    fitting.max_by(|a, b| a.turn_rad.abs().total_cmp(&b.turn_rad.abs()).then(b.first.cmp(&a.first)))
}

/// Whether a bend is a turn to a side, as a text may call it.
fn turns_to(bend: &WalkBend, side: Side) -> bool {
    let deg = bend.turn_rad.to_degrees();
    match side {
        Side::Left => deg <= -motion::SLIGHT_DEG || deg >= motion::AROUND_DEG,
        Side::Right => deg >= motion::SLIGHT_DEG || deg <= -motion::AROUND_DEG,
        Side::Ahead | Side::Behind => deg.abs() >= motion::AROUND_AT_LEAST_DEG,
    }
}

/// Whether a name means stairs.
pub(super) fn is_stairs(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::Stairs)
}
