//! Plans the change from one room into another, with the turn before it.

use super::{Clause, MAIN, Offer, Planner, Role, SIDE, usable_room};
use crate::{style::way::Kind, writer::phrases::draw};
use rand::Rng;
use wayword_checks::memory::{Bend, Opening};
use wayword_core::{Side, motion};
use wayword_language::lexicon::{Class, room_name, thing};

/// The start room counts as left soon if the path leaves it within this many hops.
const LEFT_SOON: usize = 2;
/// Share of texts that then begin with leaving it.
const LEFT_AT_ONCE: f64 = 0.6;

/// Greatest distance from a door at which the walker counts as being in it, metres.
const IN_DOOR_M: f64 = 0.5;

impl Planner<'_> {
    /// Begins the text with leaving the room of the start, as many texts do, without describing the first turn. Returns
    /// the frame where the plan goes on.
    pub(super) fn leave_at_once(&mut self) -> Option<usize> {
        let opening = self.memory.openings.first().filter(|opening| opening.before <= LEFT_SOON)?;
        let mut bends = self.memory.bends.iter().filter(|bend| bend.first > 0);
        if bends.any(|bend| bend.first <= opening.before && !self.is_left_out(*bend)) {
            return None;
        }
        let from = usable_room(&opening.from).filter(|from| self.here.as_ref() == Some(from))?;
        let is_hall = room_name(&from) == Some("hallway");
        if is_hall || !self.rng.random_bool(LEFT_AT_ONCE) {
            return None;
        }
        let to = usable_room(&opening.to);
        let mut kinds = vec![(self.count(Kind::Leave), Kind::Leave)];
        if to.is_some() {
            kinds.push((self.count(Kind::LeaveEnter) * 2.0, Kind::LeaveEnter));
        }
        if opening.has_door {
            kinds.push((self.count(Kind::LeaveByDoor) * 8.0, Kind::LeaveByDoor));
            kinds.push((self.count(Kind::ThroughDoor), Kind::ThroughDoor));
        }
        let kind = draw(&kinds, &mut self.rng)?;
        let mut clause = Clause::new(kind, opening.before, MAIN);
        match kind {
            Kind::LeaveEnter => clause = clause.from(&from).room(&opening.to),
            Kind::ThroughDoor => {}
            _ => clause = clause.from(&from).room(&from),
        }
        self.push(clause);
        self.enter(to.as_deref().filter(|_| kind == Kind::LeaveEnter));
        Some(opening.behind)
    }

    /// Plans the change into another room.
    pub(super) fn change(&mut self, opening: &Opening) {
        let at = opening.before;
        self.go_on_to(at);
        let to = usable_room(&opening.to);
        let from = usable_room(&opening.from).filter(|from| self.here.as_ref() == Some(from));
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        let next = self.memory.openings.iter().find(|next| next.before >= opening.behind);
        let is_last = next.is_none();
        if to.is_some() {
            let is_hall = room_name(&opening.to) == Some("hallway");
            let share = if is_last { 1.5 } else { 0.5 } * if is_hall { 0.4 } else { 1.0 };
            kinds.push((self.count(Kind::Enter) * share, Kind::Enter));
            if at > 0 {
                kinds.push((self.count(Kind::PassEnter) * 5.0, Kind::PassEnter));
            }
            let is_crossed = next.is_some_and(|next| next.before <= opening.behind + 1);
            if is_crossed {
                kinds.push((self.count(Kind::Through) * 1.5, Kind::Through));
            }
        }
        if from.is_some() {
            kinds.push((self.count(Kind::Leave) * if is_last { 0.3 } else { 1.0 }, Kind::Leave));
            if to.is_some() {
                kinds.push((self.count(Kind::LeaveEnter) * 1.5, Kind::LeaveEnter));
            }
        }
        if opening.has_door {
            kinds.push((self.count(Kind::ThroughDoor) * if is_last { 2.0 } else { 4.0 }, Kind::ThroughDoor));
            kinds.push((self.count(Kind::ToDoor) * 1.5, Kind::ToDoor));
            if from.is_some() {
                kinds.push((self.count(Kind::LeaveByDoor) * 2.0, Kind::LeaveByDoor));
            }
            if to.is_some() {
                kinds.push((self.count(Kind::EnterThroughDoor) * 3.0, Kind::EnterThroughDoor));
            }
        }
        let hall = usable_room(&opening.from).filter(|room| room_name(room) == Some("hallway"));
        if hall.is_some() && !self.along && self.is_end_of_hall(opening) {
            kinds.push((self.count(Kind::AlongToEnd) * 8.0, Kind::AlongToEnd));
        }
        let Some(kind) = draw(&kinds, &mut self.rng) else {
            self.enter(None);
            return;
        };
        // A walker who turns on the way through the next room needs to know which room it is.
        let until = next.map_or(self.memory.frames(), |next| next.before + 1);
        let turns = self.memory.bends.iter().any(|bend| (at..until).contains(&bend.first));
        let weight = if is_last || at == 0 || turns { MAIN } else { SIDE };
        let mut clause = Clause::new(kind, at, weight);
        match kind {
            Kind::Leave | Kind::LeaveByDoor => clause = clause.from(&opening.from).room(&opening.from),
            Kind::ThroughDoor | Kind::ToDoor => {}
            Kind::AlongToEnd => clause = clause.room(&opening.from),
            Kind::PassEnter => {
                clause = clause.from(&opening.from).room(&opening.to).offering(Offer::new(Role::PassEnter, at));
                clause.kind = Kind::Enter;
            }
            _ => clause = clause.from(&opening.from).room(&opening.to),
        }
        self.push(clause);
        if kind == Kind::AlongToEnd {
            self.along = true;
            self.here = usable_room(&opening.from);
            return self.change(opening);
        }
        if kind == Kind::ToDoor {
            let kinds = [(1.0, Kind::ThroughDoor), (if to.is_some() { 2.0 } else { 0.0 }, Kind::Enter)];
            let kind = draw(&kinds, &mut self.rng).unwrap_or(Kind::ThroughDoor);
            if kind == Kind::Enter {
                self.push(Clause::new(kind, at, weight).from(&opening.from).room(&opening.to));
                return self.enter(to.as_deref());
            }
        }
        let told = !matches!(kind, Kind::Leave | Kind::LeaveByDoor | Kind::ThroughDoor | Kind::ToDoor);
        self.enter(to.as_deref().filter(|_| told));
    }

    /// Whether the walker is in a door or doorway at a frame, so that a turn there happens behind the door.
    fn stands_in_a_door(&self, at: usize) -> bool {
        let is_door = |name: &str| thing(name).is_some_and(|thing| thing.class == Class::Door);
        let doors = self.memory.things.iter().filter(|seen| seen.position.is_some() && is_door(&seen.name));
        doors.filter_map(|door| self.memory.distance_m(door, at)).any(|distance_m| distance_m <= IN_DOOR_M)
    }

    /// Whether a hallway ends where the walk leaves it: it went straight along it, and straight on into the room behind.
    fn is_end_of_hall(&self, opening: &Opening) -> bool {
        let stay = self.memory.stay(opening.before);
        let is_walked = stay.is_some_and(|stay| stay.left > stay.entered);
        let is_straight = |at: usize| {
            self.brief.walk.moves.get(at).is_some_and(|step| step.turn_rad.to_degrees().abs() < motion::SLIGHT_DEG)
        };
        is_walked && opening.before > 0 && is_straight(opening.before)
    }

    pub(super) fn turn_and_change(&mut self, bend: Bend, opening: &Opening) {
        let (at, side) = (bend.first, bend.side());
        let to = usable_room(&opening.to);
        let can_leave = usable_room(&opening.from).is_some_and(|from| self.here == Some(from));
        self.go_on_to(at);
        if side == Side::Behind {
            self.push(Clause::new(Kind::TurnAround, at, MAIN));
            return self.change(opening);
        }
        // Leaving the room of the start makes a turn clear by itself, and a slight turn needs no mention.
        let is_implied = at == 0 && can_leave && self.rng.random_bool(0.7);
        if is_implied || self.is_left_out(bend) {
            return self.change(opening);
        }
        if self.stands_in_a_door(at) {
            self.change(opening);
            return self.push(Clause::new(Kind::Turn, at, MAIN).to(side));
        }
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        if to.is_some() {
            kinds.push((self.count(Kind::TurnInto) * 1.5, Kind::TurnInto));
            kinds.push((self.count(Kind::EnterOnSide) * 1.5, Kind::EnterOnSide));
        }
        if opening.has_door {
            kinds.push((self.count(Kind::DoorOnSide) * 4.0, Kind::DoorOnSide));
            kinds.push((self.count(Kind::TurnThroughDoor) * 3.0, Kind::TurnThroughDoor));
        }
        if can_leave {
            kinds.push((self.count(Kind::TurnOut) * 2.0, Kind::TurnOut));
            kinds.push((self.count(Kind::Leave) * 0.15, Kind::Leave));
        }
        kinds.push((self.count(Kind::TurnAt) * 1.5, Kind::TurnAt));
        match draw(&kinds, &mut self.rng) {
            Some(Kind::Leave) => {
                self.push(Clause::new(Kind::Turn, at, MAIN).to(side));
                self.push(Clause::new(Kind::Leave, at, MAIN).from(&opening.from).room(&opening.from));
                self.enter(None);
            }
            Some(Kind::TurnAt) => {
                let turn = Clause::new(Kind::Turn, at, MAIN).to(side);
                self.push(if at > 0 { turn.offering(Offer::new(Role::Turn, at)) } else { turn });
                self.change(opening);
            }
            Some(Kind::TurnOut) => {
                self.push(Clause::new(Kind::TurnOut, at, MAIN).to(side).room(&opening.from).from(&opening.from));
                self.enter(None);
            }
            Some(kind) => {
                let told = !matches!(kind, Kind::DoorOnSide | Kind::TurnThroughDoor);
                self.push(Clause::new(kind, at, MAIN).to(side).room(&opening.to));
                self.enter(to.as_deref().filter(|_| told));
            }
            None => self.change(opening),
        }
    }
}
