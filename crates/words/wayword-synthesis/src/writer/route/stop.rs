//! Plans the last clause: where the walk stops.

use super::{
    KEPT_WEIGHT, MAIN_WEIGHT, MAX_DOORWAY_HOP_M, OfferRole, ThingOffer, WayClause, WayPlanner, offer::OfferThings,
    usable_room,
};
use crate::{style::way::ClauseKind, writer::phrases::draw_option};
use wayword_checks::memory::{MAX_BARE_STOP_GAP_M, MAX_TOLD_GAP_M, StairFlight};
use wayword_core::ClimbDirection;
use wayword_language::lexicon::{names_agree, room_name};

/// Factor on the weight of "stop in the room" where the text has just named the room.
const NAMED_AGAIN_FACTOR: f64 = 0.1;
/// The same as [`MAX_BARE_STOP_GAP_M`] for a walk whose frames lie close together, where one sees how far it goes on, metres.
const MAX_CLOSE_STOP_GAP_M: f64 = 0.8;
/// After so many texts that failed, the text names what is passed last, because nothing else may fix the spot.
const TRIES_BEFORE_LAST_THING: usize = 2;

impl WayPlanner<'_> {
    /// The end: at a thing within reach, in the room, in the doorway, or at the stairs.
    pub(super) fn add_stop(&mut self) {
        let end = self.memory.frame_count().saturating_sub(1);
        let room = self.memory.room_at(end).and_then(usable_room);
        let is_told = room.is_some() && self.here == room;
        let ends_here = |flight: &&StairFlight| {
            flight.to == end && (self.memory.is_on_graph() || !flight.ends_on_stairs(&self.brief.walk.moves))
        };
        let flight = self.memory.flights.last().filter(ends_here).map(|flight| flight.climb);
        let last_hop_m = self.brief.walk.moves.last().map_or(f64::INFINITY, |step| step.distance_m);
        // A doorway that no caption shows could not be checked. On a graph a room with walls is entered through one, whatever is labelled.
        let shows_doorway = self.memory.is_on_graph() && self.memory.openings.last().is_some_and(|door| door.has_door)
            || self.memory.seen_from(end).any(|seen| names_agree(&seen.name, "doorway"));
        let door = self.memory.openings.last().filter(|opening| opening.behind == end && shows_doorway);
        // If the walker is in another room according to the text, the stop names the last room.
        let misleads = !is_told && self.names_another(room.as_deref());
        let mut kinds: Vec<(f64, ClauseKind)> = Vec::new();
        match flight {
            Some(ClimbDirection::Up) => {
                kinds.push((self.kind_count(ClauseKind::StopAtTop) * 8.0, ClauseKind::StopAtTop));
            }
            Some(ClimbDirection::Down) => {
                kinds.push((self.kind_count(ClauseKind::StopAtBottom) * 8.0, ClauseKind::StopAtBottom));
            }
            _ => {}
        }
        kinds.push((self.kind_count(ClauseKind::StopAt) * 2.0, ClauseKind::StopAt));
        if room.is_some() {
            kinds.push((self.kind_count(ClauseKind::StopAtIn) * 3.0, ClauseKind::StopAtIn));
        }
        if door.is_some() && last_hop_m <= MAX_DOORWAY_HOP_M {
            kinds.push((self.kind_count(ClauseKind::StopInDoorway) * 1.5, ClauseKind::StopInDoorway));
            if room.is_some() {
                kinds.push((self.kind_count(ClauseKind::StopInDoorwayOf) * 2.0, ClauseKind::StopInDoorwayOf));
            }
        }
        // Hallways are long, so most texts give more than "stop in the hallway".
        let in_room = if room.as_deref().and_then(room_name) == Some("hallway") { 0.4 } else { 1.0 };
        if room.is_some() && !is_told {
            kinds.push((self.kind_count(ClauseKind::StopIn) * 1.5 * in_room + 1.0, ClauseKind::StopIn));
            // "Go through the door on the left and stop": behind a door the room needs no name.
            let through_door = self.clauses.last().is_some_and(|before| {
                matches!(before.kind, ClauseKind::ThroughDoor | ClauseKind::DoorOnSide | ClauseKind::TurnThroughDoor)
            });
            if self.memory.is_on_graph() && through_door {
                kinds.push((self.kind_count(ClauseKind::Stop) * 0.5, ClauseKind::Stop));
            }
        } else {
            let has_place = self
                .clauses
                .last()
                .is_some_and(|before| !before.is_bare() && before.kind != ClauseKind::Straight && !before.is_offer());
            kinds.push((self.kind_count(ClauseKind::Stop) * if has_place { 0.5 } else { 0.02 }, ClauseKind::Stop));
            if room.is_some() {
                // A text that has just sent the walker into it does not name it again.
                kinds.push((self.kind_count(ClauseKind::StopIn) * in_room * NAMED_AGAIN_FACTOR, ClauseKind::StopIn));
            }
        }
        self.leave_out_vague_stops(&mut kinds, end);
        if misleads && room.is_some() {
            kinds.retain(|(_, kind)| {
                matches!(kind, ClauseKind::StopIn | ClauseKind::StopAtIn | ClauseKind::StopInDoorwayOf)
            });
        }
        if self.brief.complaints.len() >= TRIES_BEFORE_LAST_THING && end > 0 {
            let last = ThingOffer::new(OfferRole::Onward, end).with_things(OfferThings::Any);
            self.push(WayClause { weight: MAIN_WEIGHT, ..WayClause::for_a_thing(end - 1, last) });
        }
        let kind = draw_option(&kinds, &mut self.rng).unwrap_or(ClauseKind::Stop);
        let needs_thing = |kind: ClauseKind| matches!(kind, ClauseKind::StopAt | ClauseKind::StopAtIn);
        kinds.retain(|(_, kind)| !needs_thing(*kind));
        let is_in_room = room.as_deref().is_some_and(|room| room_name(room) != Some("hallway"));
        let plain = if is_in_room && self.memory.knows_doors() { ClauseKind::StopIn } else { ClauseKind::Stop };
        let without = draw_option(&kinds, &mut self.rng).unwrap_or(plain);
        let mut clause = WayClause::new(if needs_thing(kind) { without } else { kind }, end, KEPT_WEIGHT);
        clause.offer = needs_thing(kind).then(|| ThingOffer::new(OfferRole::Stop(kind), end));
        clause.room = room;
        self.push(clause);
    }

    /// Leaves out the stops that name too little, where the walk goes on for some way behind the last thing that the text tells.
    fn leave_out_vague_stops(&self, kinds: &mut Vec<(f64, ClauseKind)>, end: usize) {
        if !self.brief.walk.path.motion.is_known() {
            return;
        }
        let told = self.clauses.iter().rfind(|clause| !clause.is_offer()).map_or(0, |clause| {
            let bend = self.memory.bends.iter().find(|bend| bend.first == clause.at);
            bend.map_or(clause.at, |bend| bend.last) + 1
        });
        let gap_m = self.memory.walked_m(told.min(end), end);
        // A room alone fixes the spot only near the door by which one enters it.
        let entered = self.memory.stay_at(end).map_or(end, |stay| stay.entered);
        let in_room_m = self.memory.walked_m(entered.saturating_sub(1), end);
        let is_hall = self.memory.room_at(end).and_then(room_name) == Some("hallway");
        let fixes_spot = |kind: &ClauseKind| match kind {
            // Behind a door that tells nothing of its room the walker is anywhere.
            ClauseKind::Stop if self.here.is_none() && self.memory.knows_doors() => false,
            ClauseKind::Stop if self.memory.knows_doors() => gap_m <= MAX_CLOSE_STOP_GAP_M,
            ClauseKind::Stop => gap_m <= MAX_BARE_STOP_GAP_M,
            // A hallway is long.
            ClauseKind::StopIn if is_hall => in_room_m <= MAX_BARE_STOP_GAP_M,
            ClauseKind::StopIn => in_room_m <= MAX_TOLD_GAP_M,
            _ => true,
        };
        if kinds.iter().any(|(_, kind)| fixes_spot(kind)) {
            kinds.retain(|(_, kind)| fixes_spot(kind));
        }
    }

    /// Whether the room that the text names last is not this one.
    fn names_another(&self, room: Option<&str>) -> bool {
        let named = self.clauses.iter().rfind(|clause| clause.room.is_some() && clause.kind.names_room());
        named.is_some_and(|clause| clause.room.as_deref() != room)
    }
}
