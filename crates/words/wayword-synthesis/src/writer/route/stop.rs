//! The end of the way.

use super::{Clause, DOORWAY_M, KEPT, Planner, STOPPED_AT, WALKED_PAST, usable_room};
use crate::{
    style::way::Kind,
    writer::{landmarks::Use, phrases::draw},
};
use wayword_core::Climb;
use wayword_language::lexicon::room_name;

/// How much seldomer the last room is named twice.
const NAMED_AGAIN: f64 = 0.1;

impl Planner<'_, '_> {
    /// The end: at a thing within reach, in the room, in the doorway, or at the stairs.
    pub(super) fn stop(&mut self) {
        let end = self.memory.frames().saturating_sub(1);
        let room = self.memory.room(end).and_then(usable_room);
        let is_told = room.is_some() && self.here == room;
        let flight = self.memory.flights.last().filter(|flight| flight.to == end).map(|flight| flight.climb);
        let thing = self.landmarks.find(end, WALKED_PAST, Use::Stop);
        let thing = thing.or_else(|| self.landmarks.find(end, STOPPED_AT, Use::Stop));
        let last_hop_m = self.brief.walk.moves.last().map_or(f64::INFINITY, |step| step.distance_m);
        let door = self.memory.openings.last().filter(|opening| opening.behind == end && opening.has_door);
        // Where the text has the walker in another room, it names the last one.
        let misleads = !is_told && self.names_another(room.as_deref());
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        match flight {
            Some(Climb::Up) => kinds.push((self.count(Kind::StopAtTop) * 8.0, Kind::StopAtTop)),
            Some(Climb::Down) => kinds.push((self.count(Kind::StopAtBottom) * 8.0, Kind::StopAtBottom)),
            _ => {}
        }
        if thing.is_some() {
            kinds.push((self.count(Kind::StopAt) * 2.0, Kind::StopAt));
            if room.is_some() {
                kinds.push((self.count(Kind::StopAtIn) * 3.0, Kind::StopAtIn));
            }
        }
        if door.is_some() && last_hop_m <= DOORWAY_M {
            kinds.push((self.count(Kind::StopInDoorway) * 1.5, Kind::StopInDoorway));
            if room.is_some() {
                kinds.push((self.count(Kind::StopInDoorwayOf) * 2.0, Kind::StopInDoorwayOf));
            }
        }
        // Hallways are long: most texts say more than that one stops in one.
        let in_room = if room.as_deref().and_then(room_name) == Some("hallway") { 0.4 } else { 1.0 };
        if room.is_some() && !is_told {
            kinds.push((self.count(Kind::StopIn) * 1.5 * in_room + 1.0, Kind::StopIn));
        } else {
            let has_place =
                self.clauses.last().is_some_and(|before| !before.is_bare() && before.kind != Kind::Straight);
            kinds.push((self.count(Kind::Stop) * if has_place { 0.5 } else { 0.02 }, Kind::Stop));
            if room.is_some() {
                // Who has just told to enter it does not name it again.
                kinds.push((self.count(Kind::StopIn) * in_room * NAMED_AGAIN, Kind::StopIn));
            }
        }
        if misleads && room.is_some() {
            kinds.retain(|(_, kind)| matches!(kind, Kind::StopIn | Kind::StopAtIn | Kind::StopInDoorwayOf));
        }
        let kind = draw(&kinds, &mut self.rng).unwrap_or(Kind::Stop);
        let mut clause = Clause::new(kind, end, KEPT);
        clause.thing = thing.filter(|_| matches!(kind, Kind::StopAt | Kind::StopAtIn));
        clause.room = room;
        self.push(clause);
    }

    /// Whether the room that the text names last is not this one.
    fn names_another(&self, room: Option<&str>) -> bool {
        let named = self.clauses.iter().rfind(|clause| clause.room.is_some() && clause.kind.names_room());
        named.is_some_and(|clause| clause.room.as_deref() != room)
    }
}
