//! Counts how many stretches of a path fit a statement of a text, for the check of repetitions.

use super::claims::PlaceClaim;
use crate::{CheckSubject, evidence::NEAR_M};
use wayword_core::{ClimbDirection, Side};
use wayword_language::lexicon::{ThingClass, find_thing, room_name, same_room};

/// A move that turns by this much may be called a turn, degrees.
const TURN_DEG: f64 = 20.0;
/// A hallway that turns by this much may be called two, degrees.
const CORNER_DEG: f64 = 30.0;
/// A move that rises by this much may be called stairs, metres.
const RISE_M: f64 = 0.2;

/// Counts the stretches of a path that fit statements of a text.
pub(super) struct PathStretches<'a> {
    subject: CheckSubject<'a>,
}

impl<'a> PathStretches<'a> {
    pub(super) fn from_subject(subject: CheckSubject<'a>) -> Self {
        Self { subject }
    }

    /// The number of turns to a side.
    pub(super) fn count_turns(&self, side: Side) -> usize {
        let turns = |deg: f64| match side {
            Side::Left => deg <= -TURN_DEG,
            Side::Right => deg >= TURN_DEG,
            Side::Ahead | Side::Behind => deg.abs() >= 90.0,
        };
        self.subject.evidence.moves.iter().filter(|step| turns(step.turn_rad.to_degrees())).count()
    }

    /// The number of moves up, or down.
    pub(super) fn count_climbs(&self, climb: ClimbDirection) -> usize {
        let way = if climb == ClimbDirection::Down { -1.0 } else { 1.0 };
        self.subject.evidence.moves.iter().filter(|step| step.rise_m * way >= RISE_M).count()
    }

    /// The number of places that a claim may mean: separate stays in a room of that name, or as many things near the
    /// path; 0 where that is not known.
    pub(super) fn count_places(&self, claim: &PlaceClaim) -> usize {
        match claim.class {
            ThingClass::Stairs => {
                return (self.count_climbs(ClimbDirection::Up) + self.count_climbs(ClimbDirection::Down)).max(1);
            }
            ThingClass::Door => return self.count_thresholds(),
            _ if find_thing(&claim.name).is_some_and(|thing| matches!(thing.name, "doorway" | "arch")) => {
                return self.count_thresholds();
            }
            _ => {}
        }
        if room_name(&claim.name) == Some("entryway") {
            return self.count_thresholds().max(self.count_stays(&claim.name));
        }
        if claim.is_room {
            return self.count_stays(&claim.name);
        }
        let spots = self.subject.reach.surroundings.map(|around| around.thing_spots(&claim.name, NEAR_M).len());
        spots.unwrap_or(0)
    }

    /// Separate stays in a room of that name. Where there are none, stays in rooms that people confuse with it count.
    fn count_stays(&self, name: &str) -> usize {
        let frames = &self.subject.evidence.frames;
        // How often the path comes into such a room from elsewhere.
        let runs = |is_in: &dyn Fn(&str) -> bool| {
            let mut before = false;
            frames
                .iter()
                .filter(|frame| {
                    let now = frame.rooms.iter().any(|room| is_in(room));
                    !std::mem::replace(&mut before, now) && now
                })
                .count()
        };
        let stays = match runs(&|room: &str| room_name(room) == room_name(name)) {
            0 => runs(&|room: &str| same_room(room, name)),
            stays => stays,
        };
        if room_name(name) == Some("hallway") { stays + self.count_corners(name) } else { stays }
    }

    /// Corners in a room: people call each straight part of a hallway a hallway.
    fn count_corners(&self, name: &str) -> usize {
        let evidence = self.subject.evidence;
        let turns = evidence.moves.iter().zip(&evidence.frames).skip(1);
        let is_in = |rooms: &[String]| rooms.is_empty() || rooms.iter().any(|room| same_room(room, name));
        turns.filter(|(step, frame)| step.turn_rad.to_degrees().abs() >= CORNER_DEG && is_in(&frame.rooms)).count()
    }

    /// Steps from one room into another, and one more: not every doorway lies between rooms.
    fn count_thresholds(&self) -> usize {
        let frames = &self.subject.evidence.frames;
        1 + frames.windows(2).filter(|pair| pair[0].rooms != pair[1].rooms).count()
    }
}
