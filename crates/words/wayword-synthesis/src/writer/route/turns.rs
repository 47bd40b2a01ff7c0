//! Turns within a room, and the turn at the start.

use super::{Clause, LONG_M, MAIN, Planner, WALKED_PAST, usable_room};
use crate::{
    style::way::Kind,
    writer::{landmarks::Use, phrases::draw},
};
use rand::Rng;
use wayword_checks::memory::Bend;
use wayword_core::{Climb, Side};
use wayword_language::lexicon::room_name;

impl Planner<'_, '_> {
    /// A turn within a room: at a landmark, at the stairs, in the room, or after what was just said.
    pub(super) fn turn(&mut self, bend: Bend) {
        let (at, side) = (bend.first, bend.side());
        if at == 0 {
            return self.first_turn(bend);
        }
        if side == Side::Behind {
            return self.push(Clause::new(Kind::TurnAround, at, MAIN));
        }
        let flight = self.memory.flights.iter().find(|flight| flight.to == at).map(|flight| flight.climb);
        let thing = match self.rng.random_bool(if flight.is_some() { 0.25 } else { 0.75 }) {
            true => self.landmarks.find(at, WALKED_PAST, Use::Here),
            false => None,
        };
        if let Some(thing) = thing {
            let ahead = if thing.side == Some(Side::Ahead) { 1.8 } else { 0.0 };
            let kind = draw(&[(3.0, Kind::TurnAt), (ahead, Kind::To)], &mut self.rng).unwrap_or(Kind::TurnAt);
            if kind == Kind::TurnAt {
                return self.push(Clause::new(kind, at, MAIN).to(side).by(thing));
            }
            self.push(Clause::new(kind, at, MAIN).by(thing));
            return self.push(Clause::new(Kind::Turn, at, MAIN).to(side));
        }
        if self.rng.random_bool(left_out(bend)) {
            return;
        }
        self.go_on_to(at);
        let slight = bend.is_slight() && self.rng.random_bool(0.5);
        let bare = if slight { Kind::TurnSlightly } else { Kind::Turn };
        let follows = self.clauses.last().is_some_and(|before| !before.is_bare() && before.at + 1 >= at);
        let room = self.memory.room(at).and_then(usable_room);
        let is_hall = room.as_deref().and_then(room_name) == Some("hallway");
        let mut kinds = vec![(if follows { 4.0 } else { 0.3 }, bare)];
        match flight {
            Some(Climb::Up) => kinds.push((4.0, Kind::TurnAtTop)),
            Some(Climb::Down) => kinds.push((4.0, Kind::TurnAtBottom)),
            _ => {}
        }
        if is_hall && !self.along && self.walked_in(at) >= 2 {
            kinds.push((3.0, Kind::Along));
        }
        if room.is_some() {
            kinds.push((0.4, Kind::TurnIn));
        }
        let kind = draw(&kinds, &mut self.rng).unwrap_or(bare);
        let room = room.unwrap_or_default();
        match kind {
            Kind::Along => {
                self.along(at.saturating_sub(1), &room, MAIN);
                self.push(Clause::new(bare, at, MAIN).to(side));
            }
            Kind::TurnIn => {
                self.push(Clause::new(kind, at, MAIN).to(side).room(&room));
            }
            kind => self.push(Clause::new(kind, at, MAIN).to(side)),
        }
    }

    /// How many hops one has walked in the room of a frame before it.
    fn walked_in(&self, at: usize) -> usize {
        self.memory.stay(at).map_or(0, |stay| at - stay.entered)
    }

    /// Who has walked some way in a room since the last clause is told so, before a turn or a door.
    pub(super) fn go_on_to(&mut self, at: usize) {
        let Some(stay) = self.memory.stay(at) else { return };
        let told = self.clauses.last().map_or(0, |before| before.at + 1);
        let from = stay.entered.max(told);
        let room = usable_room(&stay.room);
        if self.along || self.brief.walk.walked_m(from, at) < LONG_M {
            return;
        }
        match room.filter(|room| room_name(room) == Some("hallway")) {
            Some(hall) => self.along(from, &hall, MAIN),
            None => self.push(Clause::new(Kind::Straight, from, MAIN)),
        }
    }

    /// The turn at the start. What lies ahead after it tells it, too.
    fn first_turn(&mut self, bend: Bend) {
        let side = bend.side();
        let leaves_soon =
            self.memory.openings.first().is_some_and(|opening| opening.before <= 1) && self.here.is_some();
        let kind = if side == Side::Behind { Kind::TurnAround } else { Kind::Turn };
        let is_told = match (side, leaves_soon) {
            (Side::Behind, true) => self.rng.random_bool(0.15),
            (Side::Behind, false) => self.rng.random_bool(0.5),
            (_, true) => self.rng.random_bool(0.15),
            (_, false) => !bend.is_slight() && self.rng.random_bool(0.4),
        };
        if is_told {
            self.push(Clause::new(kind, 0, MAIN).to(side));
            return;
        }
        let climbs = self.memory.flights.first().is_some_and(|flight| flight.from == 0);
        if leaves_soon || climbs {
            return;
        }
        if let Some(thing) = self.landmarks.find(1, WALKED_PAST, Use::Here) {
            self.pass(0, thing);
        }
    }
}

/// How often a turn is left out: nobody tells a small one that the way asks for by itself.
pub(super) fn left_out(bend: Bend) -> f64 {
    if bend.turn_rad.to_degrees().abs() < HARDLY_DEG { 0.6 } else { 0.0 }
}

/// Smaller turns may be left out, degrees.
const HARDLY_DEG: f64 = 40.0;
