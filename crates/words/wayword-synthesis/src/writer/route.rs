//! What there is to say about a path, clause by clause: each turn has its place, and rooms are entered before they are
//! left.

use super::{
    Brief,
    landmarks::{Landmark, Landmarks, Use},
    phrases::draw,
};
use crate::{style::way::Kind, walk::Walk};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_checks::memory::{Bend, Flight, Memory, Opening};
use wayword_core::{Climb, Motion, Side, motion};
use wayword_language::lexicon::room_name;

/// A clause to be said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Clause {
    /// What it says.
    pub(super) kind: Kind,
    /// The frame at which it is said.
    pub(super) at: usize,
    /// The side of its turn, or of its door or room.
    pub(super) side: Option<Side>,
    /// Its thing.
    pub(super) thing: Option<Landmark>,
    /// Its room.
    pub(super) room: Option<String>,
    /// The room that it leaves.
    pub(super) from: Option<String>,
    /// How much it matters: [`KEPT`] is never left out.
    pub(super) weight: u8,
}

/// Weight of what is never left out.
pub(super) const KEPT: u8 = 4;
/// Weight of turns, climbs and the last room.
const MAIN: u8 = 3;
/// Weight of landmarks and of rooms on the way.
const SIDE: u8 = 2;
/// Weight of what says that one goes on.
const FILLER: u8 = 1;

/// Least salience of a landmark on the way.
const WALKED_PAST: u8 = 2;
/// Least salience of one that is stopped at.
const STOPPED_AT: u8 = 1;
/// A hop longer than this is worth a clause, metres.
const LONG_M: f64 = 3.0;
/// One stops in a doorway where the hop through it is no longer than this, metres.
const DOORWAY_M: f64 = 2.2;

impl Clause {
    fn new(kind: Kind, at: usize, weight: u8) -> Self {
        Self { kind, at, side: None, thing: None, room: None, from: None, weight }
    }

    fn to(mut self, side: Side) -> Self {
        self.side = Some(side);
        self
    }

    fn by(mut self, thing: Landmark) -> Self {
        self.thing = Some(thing);
        self
    }

    fn room(mut self, room: &str) -> Self {
        self.room = Some(room.to_owned());
        self
    }

    fn from(mut self, room: &str) -> Self {
        self.from = Some(room.to_owned());
        self
    }

    /// Whether it is a turn without a place.
    pub(super) fn is_bare(&self) -> bool {
        matches!(self.kind, Kind::Turn | Kind::TurnSlightly | Kind::TurnAround)
    }
}

/// The clauses of a path, the stop last.
pub(super) fn clauses(brief: &Brief<'_>, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> Vec<Clause> {
    let memory = brief.memory;
    let here = memory.room(0).and_then(usable_room);
    let mut planner = Planner { brief, memory, landmarks, rng, clauses: Vec::new(), here, along: false };
    if !stands_still(brief.walk) {
        planner.way();
    }
    if planner.clauses.is_empty() {
        planner.clauses.push(Clause::new(Kind::Straight, 0, MAIN));
    }
    planner.stop();
    planner.clauses
}

struct Planner<'a, 'b, 'c> {
    brief: &'a Brief<'a>,
    memory: &'a Memory,
    landmarks: &'b mut Landmarks<'c>,
    rng: &'b mut ChaCha8Rng,
    clauses: Vec<Clause>,
    /// The room in which the text has the walker now, where it says so.
    here: Option<String>,
    /// Whether the text has told to go along the hallway in which one is.
    along: bool,
}

impl Planner<'_, '_, '_> {
    fn way(&mut self) {
        let last = self.memory.frames().saturating_sub(1);
        let mut at = 0;
        while at < last {
            let bend = self.memory.bends.iter().find(|bend| bend.first == at).copied();
            let opening = self.memory.openings.iter().find(|opening| opening.before == at);
            if let Some(flight) = self.memory.flights.iter().find(|flight| flight.from == at) {
                if let Some(bend) = bend {
                    self.turn(bend);
                }
                self.climb(*flight);
                at = flight.to;
                continue;
            }
            match (bend, opening) {
                (Some(bend), Some(opening)) => self.turn_and_change(bend, opening),
                (Some(bend), None) => {
                    self.turn(bend);
                    self.onwards(at);
                }
                (None, Some(opening)) => self.change(opening),
                (None, None) => self.onwards(at),
            }
            at += 1;
        }
    }

    fn count(&self, kind: Kind) -> f64 {
        self.brief.profile.way.count(kind)
    }

    fn push(&mut self, clause: Clause) {
        self.clauses.push(clause);
    }

    /// The text has the walker in a room now.
    fn enter(&mut self, room: Option<&str>) {
        self.here = room.map(str::to_owned);
        self.along = false;
    }

    fn climb(&mut self, flight: Flight) {
        let kind = if flight.climb == Climb::Up { Kind::Up } else { Kind::Down };
        self.push(Clause::new(kind, flight.from, MAIN));
        self.enter(None);
    }

    /// Into another room, with the turn before it, if any.
    fn change(&mut self, opening: &Opening) {
        let at = opening.before;
        let to = usable_room(&opening.to);
        let from = usable_room(&opening.from).filter(|from| self.here.as_ref() == Some(from));
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        let mut near = None;
        let next = self.memory.openings.iter().find(|next| next.before >= opening.behind);
        let is_last = next.is_none();
        if to.is_some() {
            let is_hall = room_name(&opening.to) == Some("hallway");
            let share = if is_last { 1.5 } else { 0.5 } * if is_hall { 0.4 } else { 1.0 };
            kinds.push((self.count(Kind::Enter) * share, Kind::Enter));
            if let Some(thing) = self.landmarks.peek(at, WALKED_PAST).filter(|_| at > 0) {
                kinds.push((self.count(Kind::PassEnter) * 5.0, Kind::PassEnter));
                near = Some(thing);
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
            kinds.push((self.count(Kind::ThroughDoor) * if is_last { 1.0 } else { 3.0 }, Kind::ThroughDoor));
            kinds.push((self.count(Kind::ToDoor) * 1.5, Kind::ToDoor));
            if from.is_some() {
                kinds.push((self.count(Kind::LeaveByDoor) * 2.0, Kind::LeaveByDoor));
            }
            if to.is_some() {
                kinds.push((self.count(Kind::EnterThroughDoor) * 1.5, Kind::EnterThroughDoor));
            }
        }
        let hall = usable_room(&opening.from).filter(|room| room_name(room) == Some("hallway"));
        if hall.is_some() && !self.along && self.is_end_of_hall(opening) {
            kinds.push((self.count(Kind::AlongToEnd) * 8.0, Kind::AlongToEnd));
        }
        let Some(kind) = draw(&kinds, self.rng) else {
            self.enter(None);
            return;
        };
        let weight = if is_last || at == 0 { MAIN } else { SIDE };
        let mut clause = Clause::new(kind, at, weight);
        match kind {
            Kind::Leave | Kind::LeaveByDoor => clause = clause.from(&opening.from).room(&opening.from),
            Kind::ThroughDoor | Kind::ToDoor => {}
            Kind::AlongToEnd => clause = clause.room(&opening.from),
            Kind::PassEnter => {
                clause.thing = near.map(|thing| self.landmarks.take(thing));
                clause = clause.from(&opening.from).room(&opening.to);
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
            let kind = draw(&kinds, self.rng).unwrap_or(Kind::ThroughDoor);
            if kind == Kind::Enter {
                self.push(Clause::new(kind, at, weight).from(&opening.from).room(&opening.to));
                return self.enter(to.as_deref());
            }
        }
        let told = !matches!(kind, Kind::Leave | Kind::LeaveByDoor | Kind::ThroughDoor | Kind::ToDoor);
        self.enter(to.as_deref().filter(|_| told));
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

    fn turn_and_change(&mut self, bend: Bend, opening: &Opening) {
        let (at, side) = (bend.first, bend.side());
        let to = usable_room(&opening.to);
        let can_leave = usable_room(&opening.from).is_some_and(|from| self.here == Some(from));
        if side == Side::Behind {
            self.push(Clause::new(Kind::TurnAround, at, MAIN));
            return self.change(opening);
        }
        // Who leaves the room of the start needs no turn; nor does a slight one.
        let is_implied = at == 0 && can_leave && self.rng.random_bool(0.7);
        if is_implied || (bend.is_slight() && self.rng.random_bool(0.6)) {
            return self.change(opening);
        }
        let mut kinds: Vec<(f64, Kind)> = Vec::new();
        if to.is_some() {
            kinds.push((self.count(Kind::TurnInto) * 1.5, Kind::TurnInto));
            kinds.push((self.count(Kind::EnterOnSide) * 1.5, Kind::EnterOnSide));
        }
        if opening.has_door {
            kinds.push((self.count(Kind::DoorOnSide) * 2.5, Kind::DoorOnSide));
            kinds.push((self.count(Kind::TurnThroughDoor) * 2.0, Kind::TurnThroughDoor));
        }
        if can_leave {
            kinds.push((self.count(Kind::TurnOut) * 2.0, Kind::TurnOut));
            kinds.push((self.count(Kind::Leave) * 0.15, Kind::Leave));
        }
        kinds.push((self.count(Kind::TurnAt) * 1.5, Kind::TurnAt));
        match draw(&kinds, self.rng) {
            Some(Kind::Leave) => {
                self.push(Clause::new(Kind::Turn, at, MAIN).to(side));
                self.push(Clause::new(Kind::Leave, at, MAIN).from(&opening.from).room(&opening.from));
                self.enter(None);
            }
            Some(Kind::TurnAt) => {
                match self.landmarks.find(at, WALKED_PAST, Use::Here, self.rng).filter(|_| at > 0) {
                    Some(thing) => self.push(Clause::new(Kind::TurnAt, at, MAIN).to(side).by(thing)),
                    None => self.push(Clause::new(Kind::Turn, at, MAIN).to(side)),
                }
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

    /// A turn within a room: at a landmark, at the stairs, in the room, or after what was just said.
    fn turn(&mut self, bend: Bend) {
        let (at, side) = (bend.first, bend.side());
        if at == 0 {
            return self.first_turn(bend);
        }
        if side == Side::Behind {
            return self.push(Clause::new(Kind::TurnAround, at, MAIN));
        }
        let thing = match self.rng.random_bool(0.75) {
            true => self.landmarks.find(at, WALKED_PAST, Use::Here, self.rng),
            false => None,
        };
        if let Some(thing) = thing {
            let kinds = [(3.0, Kind::TurnAt), (0.7, Kind::Pass), (1.5, Kind::To)];
            let kind = draw(&kinds, self.rng).unwrap_or(Kind::TurnAt);
            if kind == Kind::TurnAt {
                return self.push(Clause::new(kind, at, MAIN).to(side).by(thing));
            }
            self.push(Clause::new(kind, at, MAIN).by(thing));
            return self.push(Clause::new(Kind::Turn, at, MAIN).to(side));
        }
        if bend.is_slight() && self.rng.random_bool(0.6) {
            return;
        }
        let slight = bend.is_slight() && self.rng.random_bool(0.5);
        let bare = if slight { Kind::TurnSlightly } else { Kind::Turn };
        let flight = self.memory.flights.iter().find(|flight| flight.to == at).map(|flight| flight.climb);
        let follows = self.clauses.last().is_some_and(|before| !before.is_bare() && before.at + 1 >= at);
        let room = self.memory.room(at).and_then(usable_room);
        let is_hall = room.as_deref().and_then(room_name) == Some("hallway");
        let mut kinds = vec![(if follows { 4.0 } else { 0.3 }, bare)];
        match flight {
            Some(Climb::Up) => kinds.push((4.0, Kind::TurnAtTop)),
            Some(Climb::Down) => kinds.push((4.0, Kind::TurnAtBottom)),
            _ => {}
        }
        if is_hall && !self.along {
            kinds.push((3.0, Kind::Along));
        }
        if room.is_some() {
            kinds.push((1.0, Kind::TurnIn));
        }
        let kind = draw(&kinds, self.rng).unwrap_or(bare);
        let room = room.unwrap_or_default();
        match kind {
            Kind::Along => {
                self.along(at.saturating_sub(1), &room, MAIN);
                self.push(Clause::new(bare, at, MAIN).to(side));
            }
            Kind::TurnIn => {
                self.push(Clause::new(kind, at, MAIN).to(side).room(&room));
                self.enter(Some(&room));
            }
            kind => self.push(Clause::new(kind, at, MAIN).to(side)),
        }
    }

    /// The turn at the start. What lies ahead after it tells it, too.
    fn first_turn(&mut self, bend: Bend) {
        let side = bend.side();
        let leaves_soon =
            self.memory.openings.first().is_some_and(|opening| opening.before <= 1) && self.here.is_some();
        let kind = if side == Side::Behind { Kind::TurnAround } else { Kind::Turn };
        let is_told = match (side, leaves_soon) {
            (Side::Behind, true) => self.rng.random_bool(0.4),
            (Side::Behind, false) => true,
            (_, true) => self.rng.random_bool(0.25),
            (_, false) => !bend.is_slight() && self.rng.random_bool(0.6),
        };
        if is_told {
            self.push(Clause::new(kind, 0, MAIN).to(side));
            return;
        }
        let climbs = self.memory.flights.first().is_some_and(|flight| flight.from == 0);
        if leaves_soon || climbs {
            return;
        }
        if let Some(thing) = self.landmarks.find(1, WALKED_PAST, Use::Here, self.rng) {
            let kind = draw(&[(self.count(Kind::Pass), Kind::Pass), (self.count(Kind::To), Kind::To)], self.rng);
            self.push(Clause::new(kind.unwrap_or(Kind::Pass), 1, MAIN).by(thing));
        }
    }

    fn along(&mut self, at: usize, room: &str, weight: u8) {
        self.push(Clause::new(Kind::Along, at, weight).room(room));
        self.enter(Some(room));
        self.along = true;
    }

    /// A hop within a room: past a landmark, along the hallway, or at least straight on.
    fn onwards(&mut self, at: usize) {
        let is_last = at + 2 >= self.memory.frames();
        let was_onward = self.clauses.last().is_some_and(|before| {
            matches!(before.kind, Kind::Pass | Kind::PassOnSide | Kind::To | Kind::Straight) && before.at == at
        });
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        if (!was_onward && self.rng.random_bool(if is_last { 0.3 } else { 0.5 })) || !names_thing {
            let thing = self.landmarks.find(at + 1, WALKED_PAST, Use::Here, self.rng);
            let thing = thing.or_else(|| self.landmarks.find(at + 1, STOPPED_AT, Use::Here, self.rng));
            let thing =
                thing.or_else(|| self.landmarks.find(at, WALKED_PAST, Use::Here, self.rng).filter(|_| !names_thing));
            if let Some(thing) = thing {
                return self.pass(at, thing);
            }
        }
        let room = self.memory.room(at + 1).and_then(usable_room);
        let hall = room.filter(|room| room_name(room) == Some("hallway"));
        if let Some(hall) = hall.filter(|_| !self.along && self.rng.random_bool(0.7)) {
            return self.along(at, &hall, SIDE);
        }
        let is_long = self.brief.walk.moves.get(at).is_none_or(|step| step.distance_m >= LONG_M);
        if is_long && !was_onward && !self.along && self.rng.random_bool(0.5) {
            self.push(Clause::new(Kind::Straight, at, FILLER));
        }
    }

    fn pass(&mut self, at: usize, thing: Landmark) {
        let side = thing.passed.filter(|(frame, _)| (at..=at + 1).contains(frame)).map(|(_, side)| side);
        let mut kinds = vec![(self.count(Kind::Pass), Kind::Pass)];
        match side {
            Some(_) => kinds.push((self.count(Kind::PassOnSide) * 1.5, Kind::PassOnSide)),
            None => kinds.push((self.count(Kind::To) * 2.0, Kind::To)),
        }
        let kind = draw(&kinds, self.rng).unwrap_or(Kind::Pass);
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        let mut clause = Clause::new(kind, at, if names_thing { SIDE } else { MAIN }).by(thing);
        clause.side = side.filter(|_| kind == Kind::PassOnSide);
        self.push(clause);
    }

    /// The end: at a thing within reach, in the room, in the doorway, or at the stairs.
    fn stop(&mut self) {
        let end = self.memory.frames().saturating_sub(1);
        let room = self.memory.room(end).and_then(usable_room);
        let is_told = room.is_some() && self.here == room;
        let flight = self.memory.flights.last().filter(|flight| flight.to == end).map(|flight| flight.climb);
        let thing = self.landmarks.find(end, WALKED_PAST, Use::Stop, self.rng);
        let thing = thing.or_else(|| self.landmarks.find(end, STOPPED_AT, Use::Stop, self.rng));
        let last_hop_m = self.brief.walk.moves.last().map_or(f64::INFINITY, |step| step.distance_m);
        let door = self.memory.openings.last().filter(|opening| opening.behind == end && opening.has_door);
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
            kinds.push((self.count(Kind::StopInDoorway) * 1.0, Kind::StopInDoorway));
        }
        if room.is_some() && !is_told {
            kinds.push((self.count(Kind::StopIn) * 3.0 + 1.0, Kind::StopIn));
        } else {
            let has_place =
                self.clauses.last().is_some_and(|before| !before.is_bare() && before.kind != Kind::Straight);
            kinds.push((self.count(Kind::Stop) * if has_place { 0.5 } else { 0.02 }, Kind::Stop));
            if room.is_some() {
                kinds.push((self.count(Kind::StopIn), Kind::StopIn));
            }
        }
        let kind = draw(&kinds, self.rng).unwrap_or(Kind::Stop);
        let mut clause = Clause::new(kind, end, KEPT);
        clause.thing = thing.filter(|_| matches!(kind, Kind::StopAt | Kind::StopAtIn));
        clause.room = room;
        self.push(clause);
    }
}

/// Whether a path goes nowhere, as one with a single viewpoint does.
pub(super) fn stands_still(walk: &Walk) -> bool {
    !walk.path.motion.goes_anywhere(&walk.moves, walk.path.frames.len())
}

/// Which way the last flight of stairs of a path goes.
pub(super) fn last_climb(walk: &Walk) -> Option<Climb> {
    (0..walk.moves.len()).rev().find_map(|at| motion::flight(&walk.moves, at)).map(|(_, climb)| climb)
}

/// A room that one can walk into; stairs are climbed instead.
pub(super) fn usable_room(name: &str) -> Option<String> {
    (room_name(name) != Some("stairs")).then(|| name.to_owned())
}

/// Whether a shape may be said of a motion: where it is unknown, none says "straight".
pub(super) fn suits(shape: &str, motion: Motion) -> bool {
    motion.is_known() || !["straight", "forward", "ahead"].iter().any(|word| shape.contains(word))
}

/// The word for a side.
pub(super) fn side_word(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}
