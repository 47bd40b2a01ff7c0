//! Plans the last clause: where the walk stops.

use super::{Clause, DOORWAY_M, KEPT, Offer, Planner, Role, usable_room};
use crate::{style::way::Kind, writer::phrases::draw};
use wayword_core::Climb;
use wayword_language::lexicon::{agree, room_name};

/// Factor for naming the last room a second time.
const NAMED_AGAIN: f64 = 0.1;

impl Planner<'_> {
    /// The end: at a thing within reach, in the room, in the doorway, or at the stairs.
    pub(super) fn stop(&mut self) {
        let end = self.memory.frames().saturating_sub(1);
        let room = self.memory.room(end).and_then(usable_room);
        let is_told = room.is_some() && self.here == room;
        let flight = self.memory.flights.last().filter(|flight| flight.to == end).map(|flight| flight.climb);
        let last_hop_m = self.brief.walk.moves.last().map_or(f64::INFINITY, |step| step.distance_m);
        // A doorway that no caption shows could not be checked.
        let shows_doorway = self.memory.seen_from(end).any(|seen| agree(&seen.name, "doorway"));
        let door = self.memory.openings.last().filter(|opening| opening.behind == end && shows_doorway);
        // If the walker is in another room according to the text, the stop names the last room.
        let misleads = !is_told && self.names_another(room.as_deref());
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        match flight {
            Some(Climb::Up) => kinds.push((self.count(Kind::StopAtTop) * 8.0, Kind::StopAtTop)),
            Some(Climb::Down) => kinds.push((self.count(Kind::StopAtBottom) * 8.0, Kind::StopAtBottom)),
            _ => {}
        }
        kinds.push((self.count(Kind::StopAt) * 2.0, Kind::StopAt));
        if room.is_some() {
            kinds.push((self.count(Kind::StopAtIn) * 3.0, Kind::StopAtIn));
        }
        if door.is_some() && last_hop_m <= DOORWAY_M {
            kinds.push((self.count(Kind::StopInDoorway) * 1.5, Kind::StopInDoorway));
            if room.is_some() {
                kinds.push((self.count(Kind::StopInDoorwayOf) * 2.0, Kind::StopInDoorwayOf));
            }
        }
        // Hallways are long, so most texts give more than "stop in the hallway".
        let in_room = if room.as_deref().and_then(room_name) == Some("hallway") { 0.4 } else { 1.0 };
        if room.is_some() && !is_told {
            kinds.push((self.count(Kind::StopIn) * 1.5 * in_room + 1.0, Kind::StopIn));
        } else {
            let has_place = self
                .clauses
                .last()
                .is_some_and(|before| !before.is_bare() && before.kind != Kind::Straight && !before.is_offer());
            kinds.push((self.count(Kind::Stop) * if has_place { 0.5 } else { 0.02 }, Kind::Stop));
            if room.is_some() {
                // A text that has just sent the walker into it does not name it again.
                kinds.push((self.count(Kind::StopIn) * in_room * NAMED_AGAIN, Kind::StopIn));
            }
        }
        if misleads && room.is_some() {
            kinds.retain(|(_, kind)| matches!(kind, Kind::StopIn | Kind::StopAtIn | Kind::StopInDoorwayOf));
        }
        let kind = draw(&kinds, &mut self.rng).unwrap_or(Kind::Stop);
        let needs_thing = |kind: Kind| matches!(kind, Kind::StopAt | Kind::StopAtIn);
        kinds.retain(|(_, kind)| !needs_thing(*kind));
        let without = draw(&kinds, &mut self.rng).unwrap_or(Kind::Stop);
        let mut clause = Clause::new(if needs_thing(kind) { without } else { kind }, end, KEPT);
        clause.offer = needs_thing(kind).then(|| Offer::new(Role::Stop(kind), end));
        clause.room = room;
        self.push(clause);
    }

    /// Whether the room that the text names last is not this one.
    fn names_another(&self, room: Option<&str>) -> bool {
        let named = self.clauses.iter().rfind(|clause| clause.room.is_some() && clause.kind.names_room());
        named.is_some_and(|clause| clause.room.as_deref() != room)
    }
}
