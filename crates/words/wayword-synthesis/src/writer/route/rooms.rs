//! Plans the change from one room into another, with the turn before it.
//!
//! Several kinds of clauses can describe a change ("leave the kitchen", "go through the door"). One is drawn by how
//! often the style uses it, times a factor for the situation.

use super::{
    MAIN_WEIGHT, OfferRole, SIDE_WEIGHT, ThingOffer, WayClause, WayPlanner, carry_out::told_until, usable_room,
};
use crate::{style::way::ClauseKind, writer::phrases::draw_option};
use rand::Rng;
use wayword_checks::memory::{MAX_SIDE_DOOR_GAP_M, RoomOpening, WalkBend};
use wayword_core::{Side, motion};
use wayword_language::lexicon::room_name;

/// The start room counts as left soon if the path leaves it after at most this many hops.
const MAX_SOON_HOPS: usize = 2;
/// Share of texts that begin with leaving the start room, where the path leaves it soon.
const LEAVE_AT_ONCE_SHARE: f64 = 0.6;
/// A style that goes to a door in at least this share of its clauses about doors and rooms mostly adds nothing about the door.
const TO_DOOR_SHARE: f64 = 0.25;

impl WayPlanner<'_> {
    /// Begins the text with leaving the room of the start, as many texts do, without describing the first turn. Returns
    /// the frame where the plan goes on.
    pub(super) fn leave_at_once(&mut self) -> Option<usize> {
        let opening = self.memory.openings.first().filter(|opening| opening.before <= MAX_SOON_HOPS)?;
        // Stairs that begin on the way to the door have a clause of their own.
        if self.memory.flights.iter().any(|flight| flight.from < opening.behind) {
            return None;
        }
        let mut bends = self.memory.bends.iter().filter(|bend| bend.first > 0);
        if bends.any(|bend| bend.first <= opening.before && !self.is_left_out(*bend)) {
            return None;
        }
        let from = usable_room(&opening.from).filter(|from| self.here.as_ref() == Some(from))?;
        let is_hall = room_name(&from) == Some("hallway");
        if is_hall || !self.rng.random_bool(LEAVE_AT_ONCE_SHARE) {
            return None;
        }
        let to = usable_room(&opening.to);
        let mut kinds = vec![(self.kind_count(ClauseKind::Leave), ClauseKind::Leave)];
        if to.is_some() {
            kinds.push((self.kind_count(ClauseKind::LeaveEnter) * 2.0, ClauseKind::LeaveEnter));
        }
        if opening.has_door {
            kinds.push((self.kind_count(ClauseKind::LeaveByDoor) * 8.0, ClauseKind::LeaveByDoor));
            kinds.push((self.kind_count(ClauseKind::ThroughDoor), ClauseKind::ThroughDoor));
        }
        let kind = draw_option(&kinds, &mut self.rng)?;
        let mut clause = WayClause::new(kind, opening.before, MAIN_WEIGHT);
        match kind {
            ClauseKind::LeaveEnter => clause = clause.with_left_room(&from).with_room(&opening.to),
            ClauseKind::ThroughDoor => {}
            _ => clause = clause.with_left_room(&from).with_room(&from),
        }
        self.push(clause);
        self.enter_room(to.as_deref().filter(|_| kind == ClauseKind::LeaveEnter));
        Some(opening.behind)
    }

    /// Plans the change into another room.
    pub(super) fn change_room(&mut self, opening: &RoomOpening) {
        let at = opening.before;
        self.go_on_to(at);
        let to = usable_room(&opening.to);
        let from = usable_room(&opening.from).filter(|from| self.here.as_ref() == Some(from));
        let mut kinds: Vec<(f64, ClauseKind)> = Vec::new();
        let next = self.memory.openings.iter().find(|next| next.before >= opening.behind);
        let is_last = next.is_none();
        if to.is_some() {
            let is_hall = room_name(&opening.to) == Some("hallway");
            let share = if is_last { 1.5 } else { 0.5 } * if is_hall { 0.4 } else { 1.0 };
            kinds.push((self.kind_count(ClauseKind::Enter) * share, ClauseKind::Enter));
            if at > 0 {
                kinds.push((self.kind_count(ClauseKind::PassEnter) * 5.0, ClauseKind::PassEnter));
            }
            let is_crossed = next.is_some_and(|next| next.before <= opening.behind + 1);
            if is_crossed {
                kinds.push((self.kind_count(ClauseKind::Through) * 1.5, ClauseKind::Through));
            }
        }
        // A hallway is left by one of several doors, and stairs belong to the hall where they begin.
        let says_way = self.can_say_leave(opening);
        if from.is_some() && says_way {
            kinds.push((self.kind_count(ClauseKind::Leave) * if is_last { 0.3 } else { 1.0 }, ClauseKind::Leave));
            if to.is_some() {
                kinds.push((self.kind_count(ClauseKind::LeaveEnter) * 1.5, ClauseKind::LeaveEnter));
            }
        }
        if opening.has_door {
            kinds.push((
                self.kind_count(ClauseKind::ThroughDoor) * if is_last { 2.0 } else { 4.0 },
                ClauseKind::ThroughDoor,
            ));
            if to.is_some() {
                kinds.push((self.kind_count(ClauseKind::ToDoor) * 1.5, ClauseKind::ToDoor));
            }
            if from.is_some() {
                kinds.push((self.kind_count(ClauseKind::LeaveByDoor) * 2.0, ClauseKind::LeaveByDoor));
            }
            if to.is_some() {
                kinds.push((self.kind_count(ClauseKind::EnterThroughDoor) * 3.0, ClauseKind::EnterThroughDoor));
            }
        }
        let hall = usable_room(&opening.from).filter(|room| room_name(room) == Some("hallway"));
        if hall.is_some() && !self.along && self.is_end_of_hall(opening) {
            kinds.push((self.kind_count(ClauseKind::AlongToEnd) * 8.0, ClauseKind::AlongToEnd));
        }
        let Some(kind) = draw_option(&kinds, &mut self.rng) else {
            self.enter_room(None);
            return;
        };
        // A walker who turns on the way through the next room needs to know which room it is.
        let until = next.map_or(self.memory.frame_count(), |next| next.before + 1);
        let turns = self.memory.bends.iter().any(|bend| (at..until).contains(&bend.first));
        let is_main = is_last || at == 0 || turns || self.memory.knows_doors();
        let weight = if is_main { MAIN_WEIGHT } else { SIDE_WEIGHT };
        let mut clause = WayClause::new(kind, at, weight);
        match kind {
            ClauseKind::Leave | ClauseKind::LeaveByDoor => {
                clause = clause.with_left_room(&opening.from).with_room(&opening.from);
            }
            ClauseKind::ThroughDoor | ClauseKind::ToDoor => {}
            ClauseKind::AlongToEnd => clause = clause.with_room(&opening.from),
            ClauseKind::PassEnter => {
                clause = clause
                    .with_left_room(&opening.from)
                    .with_room(&opening.to)
                    .with_offer(ThingOffer::new(OfferRole::PassEnter, at));
                clause.kind = ClauseKind::Enter;
            }
            _ => clause = clause.with_left_room(&opening.from).with_room(&opening.to),
        }
        self.push(clause);
        if kind == ClauseKind::AlongToEnd {
            self.along = true;
            self.here = usable_room(&opening.from);
            return self.change_room(opening);
        }
        if kind == ClauseKind::ToDoor {
            if self.goes_no_further_than_doors() {
                return self.enter_room(None);
            }
            let kinds = [(1.0, ClauseKind::ThroughDoor), (if to.is_some() { 2.0 } else { 0.0 }, ClauseKind::Enter)];
            let kind = draw_option(&kinds, &mut self.rng).unwrap_or(ClauseKind::ThroughDoor);
            if kind == ClauseKind::Enter {
                self.push(WayClause::new(kind, at, weight).with_left_room(&opening.from).with_room(&opening.to));
                return self.enter_room(to.as_deref());
            }
        }
        let names_new_room =
            !matches!(kind, ClauseKind::Leave | ClauseKind::LeaveByDoor | ClauseKind::ThroughDoor | ClauseKind::ToDoor);
        self.enter_room(to.as_deref().filter(|_| names_new_room));
    }

    /// Whether a text that sends the walker to a door leaves it there, as the texts of a style do that mostly name doors so.
    fn goes_no_further_than_doors(&mut self) -> bool {
        let to = self.kind_count(ClauseKind::ToDoor);
        let on = self.kind_count(ClauseKind::ThroughDoor) + self.kind_count(ClauseKind::Enter);
        let share = to / (to + on).max(f64::EPSILON);
        share >= TO_DOOR_SHARE && self.rng.random_bool(share)
    }

    /// Whether the walk passes no other door on a side between what the text tells before and a frame.
    fn is_next_door(&self, side: Side, at: usize) -> bool {
        let told = self.planned_until(at);
        // A walker passes the door beside the last thing, too.
        let after = if self.memory.knows_doors() { told.saturating_sub(1) } else { told };
        let is_near = !self.memory.knows_doors() && self.memory.walked_m(told, at) <= MAX_SIDE_DOOR_GAP_M;
        is_near || !self.memory.passes_door(side, after, at)
    }

    /// Says that the walk goes on before a door that is not the next one.
    fn go_past_doors(&mut self, at: usize) {
        if self.clauses.last().is_some_and(|before| before.kind.goes_on()) {
            return;
        }
        let told = self.planned_until(at);
        let hall = self.memory.room_at(told).and_then(usable_room).filter(|room| room_name(room) == Some("hallway"));
        match hall.filter(|_| self.goes_along(told)) {
            Some(hall) => self.go_along(told, &hall, MAIN_WEIGHT),
            None => self.push(WayClause::new(ClauseKind::Straight, told, MAIN_WEIGHT)),
        }
    }

    /// Whether "leave the room" tells the way: not out of a hallway, unless it ends there, nor onto stairs.
    fn can_say_leave(&self, opening: &RoomOpening) -> bool {
        let is_hall = room_name(&opening.from) == Some("hallway");
        usable_room(&opening.to).is_some() && (!is_hall || self.is_end_of_hall(opening))
    }

    /// Plans the change into another room by one of several doors: that on this side.
    pub(super) fn choose_door(&mut self, side: Side, opening: &RoomOpening) {
        self.go_on_to(opening.before);
        if self.is_counted_door(side, opening) {
            return self.take_door(side, opening);
        }
        let to = usable_room(&opening.to);
        let mut kinds: Vec<(f64, ClauseKind)> = Vec::new();
        if opening.has_door {
            kinds.push((self.kind_count(ClauseKind::DoorOnSide) * 4.0, ClauseKind::DoorOnSide));
        }
        if to.is_some() {
            kinds.push((self.kind_count(ClauseKind::EnterOnSide) * 1.5, ClauseKind::EnterOnSide));
        }
        let Some(kind) = draw_option(&kinds, &mut self.rng) else { return self.change_room(opening) };
        self.push(WayClause::new(kind, opening.before, MAIN_WEIGHT).with_side(side).with_room(&opening.to));
        self.enter_room(to.as_deref().filter(|_| kind == ClauseKind::EnterOnSide));
    }

    /// Whether the walk passes other doors on a side before it takes this one, so that "the door on the left" gets a number.
    fn is_counted_door(&self, side: Side, opening: &RoomOpening) -> bool {
        let told = told_until(&self.clauses, self.memory).min(opening.before);
        opening.has_door && self.memory.door_number(side, told, opening.before).is_some_and(|number| number > 1)
    }

    /// Plans the change into another room by the door on a side.
    fn take_door(&mut self, side: Side, opening: &RoomOpening) {
        let clause = WayClause::new(ClauseKind::DoorOnSide, opening.before, MAIN_WEIGHT);
        self.push(clause.with_side(side).with_room(&opening.to));
        self.enter_room(None);
    }

    /// Whether a hallway ends where the walk leaves it: the walk went along the hallway, and straight on into the room
    /// behind it.
    fn is_end_of_hall(&self, opening: &RoomOpening) -> bool {
        let stay = self.memory.stay_at(opening.before);
        let is_walked = stay.is_some_and(|stay| stay.left > stay.entered);
        let is_straight = |at: usize| {
            self.brief.walk.moves.get(at).is_some_and(|step| step.turn_rad.to_degrees().abs() < motion::SLIGHT_DEG)
        };
        is_walked && opening.before > 0 && is_straight(opening.before)
    }

    /// Plans a turn at the frame where the walk changes rooms: in one clause ("turn left into the kitchen") or in two,
    /// or the change alone where the turn needs no mention.
    pub(super) fn turn_and_change(&mut self, bend: WalkBend, opening: &RoomOpening) {
        let (at, side) = (bend.first, bend.side());
        let to = usable_room(&opening.to);
        let can_leave = usable_room(&opening.from).is_some_and(|from| self.here == Some(from));
        self.go_on_to(at);
        if at == 0 && self.leaves_out_first_turn(side) {
            return self.change_room(opening);
        }
        if side == Side::Behind {
            self.push(WayClause::new(ClauseKind::TurnAround, at, MAIN_WEIGHT));
            return self.change_room(opening);
        }
        // Leaving the room of the start makes a turn clear by itself, and a slight turn needs no mention.
        let is_implied = at == 0 && can_leave && self.rng.random_bool(0.7);
        if is_implied || self.is_left_out(bend) {
            return self.change_room(opening);
        }
        if bend.turn_rad.to_degrees().abs() < motion::TOLD_DEG {
            if self.memory.faces_other_door(at) {
                return self.choose_door(side, opening);
            }
            self.push(WayClause::new(ClauseKind::TurnSlightly, at, MAIN_WEIGHT).with_side(side));
            return self.change_room(opening);
        }
        if self.is_counted_door(side, opening) {
            return self.take_door(side, opening);
        }
        let mut kinds: Vec<(f64, ClauseKind)> = Vec::new();
        if to.is_some() {
            kinds.push((self.kind_count(ClauseKind::TurnInto) * 1.5, ClauseKind::TurnInto));
            kinds.push((self.kind_count(ClauseKind::EnterOnSide) * 1.5, ClauseKind::EnterOnSide));
        }
        let is_next_door = self.is_next_door(side, at);
        if !is_next_door {
            self.go_past_doors(at);
        }
        if opening.has_door && is_next_door {
            kinds.push((self.kind_count(ClauseKind::DoorOnSide) * 4.0, ClauseKind::DoorOnSide));
            kinds.push((self.kind_count(ClauseKind::TurnThroughDoor) * 3.0, ClauseKind::TurnThroughDoor));
        }
        if can_leave && self.can_say_leave(opening) {
            kinds.push((self.kind_count(ClauseKind::TurnOut) * 2.0, ClauseKind::TurnOut));
            kinds.push((self.kind_count(ClauseKind::Leave) * 0.15, ClauseKind::Leave));
        }
        kinds.push((self.kind_count(ClauseKind::TurnAt) * 1.5, ClauseKind::TurnAt));
        match draw_option(&kinds, &mut self.rng) {
            Some(ClauseKind::Leave) => {
                self.push(WayClause::new(ClauseKind::Turn, at, MAIN_WEIGHT).with_side(side));
                self.push(
                    WayClause::new(ClauseKind::Leave, at, MAIN_WEIGHT)
                        .with_left_room(&opening.from)
                        .with_room(&opening.from),
                );
                self.enter_room(None);
            }
            Some(ClauseKind::TurnAt) => {
                let turn = WayClause::new(ClauseKind::Turn, at, MAIN_WEIGHT).with_side(side);
                self.push(if at > 0 { turn.with_offer(ThingOffer::new(OfferRole::Turn, at)) } else { turn });
                self.change_room(opening);
            }
            Some(ClauseKind::TurnOut) => {
                self.push(
                    WayClause::new(ClauseKind::TurnOut, at, MAIN_WEIGHT)
                        .with_side(side)
                        .with_room(&opening.from)
                        .with_left_room(&opening.from),
                );
                self.enter_room(None);
            }
            Some(kind) => {
                let names_room = !matches!(kind, ClauseKind::DoorOnSide | ClauseKind::TurnThroughDoor);
                self.push(WayClause::new(kind, at, MAIN_WEIGHT).with_side(side).with_room(&opening.to));
                self.enter_room(to.as_deref().filter(|_| names_room));
            }
            None => self.change_room(opening),
        }
    }
}
