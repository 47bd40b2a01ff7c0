//! Which doors a walk passes, faces and takes.

use super::{
    WalkMemory,
    openings::{IN_DOOR_M, OPENING_DOOR_M, RoomOpening, is_door, is_way_through},
    things::RememberedThing,
};
use std::{f64::consts::PI, ops::Range};
use wayword_core::{Heading, Side};

/// A door at the side of the walk lies at most so far from it, metres.
const SIDE_DOOR_M: f64 = 2.0;
/// A walker faces a door at most so far aside, degrees, and so far away, metres.
const FACED_DOOR_DEG: f64 = 40.0;
/// See [`FACED_DOOR_DEG`].
const FACED_DOOR_M: f64 = 6.0;
/// A walker who bends by at least this takes another door than the one ahead, degrees.
const MIN_DOOR_CHOICE_DEG: f64 = 20.0;
/// A walker bends towards a door at most so many frames before it.
const DOOR_CHOICE_FRAMES: usize = 2;

impl WalkMemory {
    /// Whether the walk passes a door close by on a side, strictly between two frames.
    #[must_use]
    pub fn passes_door(&self, side: Side, after: usize, before: usize) -> bool {
        self.doors_passed(side, after + 1..before).next().is_some()
    }

    /// The doors that the walk passes close by on a side, at these frames.
    fn doors_passed(&self, side: Side, frames: Range<usize>) -> impl Iterator<Item = &RememberedThing> {
        let is_near = |door: &RememberedThing, frame| self.distance_m(door, frame).is_some_and(|m| m <= SIDE_DOOR_M);
        let on_side = move |door: &&RememberedThing| {
            let passed = door.passed.filter(|by| by.side == side && frames.contains(&by.frame));
            passed.is_some_and(|by| is_near(door, by.frame))
        };
        self.things.iter().filter(|thing| is_door(&thing.name)).filter(on_side)
    }

    /// Which of the doors on a side the one is through which the walk leads behind the frame `before`, of those that a walker sees ahead
    /// from the frame `from` on; the first is 1. `None` where doors are not known.
    #[must_use]
    pub fn door_number(&self, side: Side, from: usize, before: usize) -> Option<usize> {
        // Before a turn the door that the walk takes lies at the side, too.
        let is_taken = |door: &RememberedThing| {
            self.nearest_hops(door).is_some_and(|(hops, near_m)| near_m <= IN_DOOR_M && hops.contains(&before))
        };
        let is_met = |door: &&RememberedThing| {
            door.passed.is_some_and(|passed| door.is_ahead_from(&(from..=passed.frame))) && !is_taken(door)
        };
        self.knows_doors.then(|| self.doors_passed(side, from..before).filter(is_met).count() + 1)
    }

    /// Whether a walker who arrives at a frame, or comes back to it, sees a door or doorway ahead through which the walk does not lead.
    #[must_use]
    pub fn faces_other_door(&self, frame: usize) -> bool {
        let there = self.headings.get(frame).copied();
        let back = self.headings.get(frame + 1).map(|heading| heading.turned_by(PI));
        let is_ahead = |door: &RememberedThing| {
            let off_deg = |heading: Heading| self.off_deg(frame, heading, door);
            there.into_iter().chain(back).filter_map(off_deg).any(|off_deg| off_deg.abs() <= FACED_DOOR_DEG)
        };
        self.other_doors_near(frame).any(is_ahead)
    }

    /// The doors and doorways near a frame from which they are seen, without those through which the walk leads. None where doors are not
    /// known.
    fn other_doors_near(&self, frame: usize) -> impl Iterator<Item = &RememberedThing> {
        let is_near = move |door: &RememberedThing| self.distance_m(door, frame).is_some_and(|m| m <= FACED_DOOR_M);
        let leads_through =
            |door: &RememberedThing| self.nearest_hops(door).is_some_and(|(_, near_m)| near_m <= IN_DOOR_M);
        let is_other =
            move |door: &&RememberedThing| is_way_through(&door.name) && is_near(door) && !leads_through(door);
        self.seen_from(frame).filter(is_other).filter(|_| self.knows_doors)
    }

    /// How far aside of a heading a thing lies from a frame, degrees, positive right.
    fn off_deg(&self, frame: usize, heading: Heading, thing: &RememberedThing) -> Option<f64> {
        let towards = Heading::towards(*self.eyes.get(frame)?, thing.position?)?;
        Some(heading.turn_to(towards).to_degrees())
    }

    /// The side to which a walker bends, without a turn, towards an opening whose last frame before it is `before`, where another door or
    /// doorway is ahead and none lies farther to that side: the opening is "on the left". On a straight way the door ahead is meant.
    #[must_use]
    pub fn side_among_doors(&self, before: usize) -> Option<Side> {
        let in_turn = |frame: &usize| self.bends.iter().any(|bend| (bend.first..=bend.last).contains(frame));
        let turn_deg = |frame: usize| {
            let (here, next) = (self.headings.get(frame)?, self.headings.get(frame + 1)?);
            let deg = here.turn_to(*next).to_degrees();
            let is_farther = |door: &RememberedThing| {
                self.off_deg(frame, *here, door).is_some_and(|off_deg| off_deg * deg.signum() > deg.abs())
            };
            Some(deg).filter(|deg| deg.abs() >= MIN_DOOR_CHOICE_DEG && !self.other_doors_near(frame).any(is_farther))
        };
        let near = (before.saturating_sub(DOOR_CHOICE_FRAMES).max(1)..=before).filter(|frame| !in_turn(frame));
        let deg = near.filter(|frame| self.faces_other_door(*frame)).find_map(turn_deg)?;
        Some(if deg < 0.0 { Side::Left } else { Side::Right })
    }

    /// The doors and doorways of a change of rooms whose positions are known.
    pub fn doors_at(&self, opening: &RoomOpening) -> impl Iterator<Item = &RememberedThing> {
        let frames = [opening.before, opening.behind];
        let is_near = move |door: &&RememberedThing| {
            let within = |frame: usize| self.distance_m(door, frame).is_some_and(|far_m| far_m <= OPENING_DOOR_M);
            door.position.is_some() && frames.into_iter().any(within)
        };
        self.things.iter().filter(|thing| is_way_through(&thing.name)).filter(is_near)
    }
}
