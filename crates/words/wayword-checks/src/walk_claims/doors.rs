//! Decides whether the walk leads through the door that a text means: on its side, and of that number.

use super::{
    claims::PlaceRole,
    facts::NEAR_M,
    outcome::ClaimOutcome::{self, Fails, Holds, Unknown},
    places::PlaceJudge,
};
use crate::{
    goal::MAX_STOP_DISTANCE_M as STOP_M,
    memory::{IN_DOOR_M, RememberedThing, RoomOpening},
    sides::side_word,
};
use std::collections::BTreeSet;
use wayword_core::Side;
use wayword_language::reading::PlaceOrdinal;

/// The way into a doorway "on the right" turns by at least this angle, degrees.
const SIDEWAYS_DEG: f64 = 15.0;

impl PlaceJudge<'_, '_> {
    /// Whether the way through a change of rooms turns to the side that the text gives it.
    pub(super) fn way_on_side(&self, before: usize, behind: usize) -> ClaimOutcome {
        let Some(side @ (Side::Left | Side::Right)) = self.place.side else { return Holds(behind) };
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        // A turn behind the opening says nothing of its side.
        let has_bend = self.facts.told_bend(side, [before.saturating_sub(1), behind]).is_some();
        let net_deg = self.facts.net_turn_deg(before.saturating_sub(1)..=behind) * sign;
        match net_deg {
            _ if has_bend || net_deg >= SIDEWAYS_DEG => Holds(behind),
            _ if self.facts.memory.side_among_doors(before) == Some(side) => Holds(behind),
            deg if deg <= -SIDEWAYS_DEG => {
                Fails(format!("{:?} is not on the {} where the path enters it", self.name(), side_word(side)))
            }
            _ => Unknown(format!("the program cannot check on which side {:?} is", self.name())),
        }
    }

    /// Decides a door or doorway.
    pub(super) fn judge_door(&self) -> ClaimOutcome {
        let (facts, name, last) = (self.facts, self.name(), self.facts.last_frame());
        let around = facts.around(self.stretch);
        let far_m =
            |thing: &RememberedThing, frame: usize| facts.memory.distance_m(thing, frame).unwrap_or(f64::INFINITY);
        let doors = || self.claim.things[0].iter();
        let unknown = || Unknown(format!("the program cannot check which {name:?} is meant"));
        let leads_through = matches!(self.role, PlaceRole::Entered | PlaceRole::Through | PlaceRole::Left);
        let is_at_side = matches!(self.place.side, Some(Side::Left | Side::Right));
        let can_count = leads_through && is_at_side && facts.memory.knows_doors();
        match self.place.ordinal {
            Some(PlaceOrdinal::Last) => return unknown(),
            Some(PlaceOrdinal::Number(number)) if number > 1 && !can_count => return unknown(),
            _ => {}
        }
        let mut openings = facts.memory.openings.iter();
        match self.role {
            PlaceRole::Entered | PlaceRole::Through | PlaceRole::Left => {
                let has_door = |opening: &&RoomOpening| {
                    facts.memory.doors_at(opening).any(|there| doors().any(|door| **door == *there))
                };
                let is_here =
                    |opening: &&RoomOpening| self.changes_room_at(opening.behind) && self.turns_before(opening.behind);
                if let Some(opening) = openings.filter(has_door).find(is_here) {
                    return self.door_by_number(opening.before, opening.behind);
                }
                // Two rooms of one name have no change of rooms between them.
                let crossed = doors().filter_map(|door| facts.memory.nearest_hops(door));
                let mut crossed = crossed.filter(|(_, near_m)| *near_m <= IN_DOOR_M).flat_map(|(hops, _)| hops);
                match crossed.find(|hop| self.changes_room_at(hop + 1) && self.turns_before(hop + 1)) {
                    Some(hop) => self.door_by_number(hop, hop + 1),
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

    /// Whether the door between two frames is on the side that the text gives it, and the one that it counts there: from the place where
    /// the step begins, or where the walk comes into the room.
    fn door_by_number(&self, before: usize, behind: usize) -> ClaimOutcome {
        let found = self.way_on_side(before, behind);
        let (Holds(_), Some(side @ (Side::Left | Side::Right)), Some(PlaceOrdinal::Number(number))) =
            (&found, self.place.side, self.place.ordinal)
        else {
            return found;
        };
        let memory = self.facts.memory;
        let [from, _] = self.stretch;
        let starts = [Some(from), from.checked_sub(1), memory.stay_at(before).map(|stay| stay.entered)];
        let counts: BTreeSet<usize> =
            starts.into_iter().flatten().filter_map(|start| memory.door_number(side, start, before)).collect();
        if counts.is_empty() || counts.contains(&(number as usize)) {
            return found;
        }
        let counted = counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" or ");
        Fails(format!("of the doors on the {}, this is number {counted}", side_word(side)))
    }
}
