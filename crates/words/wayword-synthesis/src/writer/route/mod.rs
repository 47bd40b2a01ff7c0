//! Plans the clauses of a text about a way: turns, doors, rooms, stairs, and the stop.
//!
//! The plan depends on the way alone. It offers places for things, and `carry_out` fills them with the things that are
//! there. So a thing that comes or goes changes only the words of its own place.

mod carry_out;
pub(super) mod fill;
mod offer;
mod onward;
mod rooms;
mod stop;
mod turns;

pub(super) use carry_out::carry_out;
pub(super) use offer::{Offer, Role, with_stand_ins};

use super::{Brief, dice::Dice, landmarks::Landmark};
use crate::{style::way::Kind, walk::Walk};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use wayword_checks::memory::{Bend, Flight, Memory};
use wayword_core::{Climb, Motion, Side, motion};
use wayword_language::lexicon::room_name;

/// A planned clause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Clause {
    /// Its kind.
    pub(super) kind: Kind,
    /// Its frame.
    pub(super) at: usize,
    /// The side of its turn, or of its door or room.
    pub(super) side: Option<Side>,
    /// Its thing.
    pub(super) thing: Option<Landmark>,
    /// Its room.
    pub(super) room: Option<String>,
    /// The room that it leaves.
    pub(super) from: Option<String>,
    /// How much it matters. A clause of weight [`KEPT`] is never left out.
    pub(super) weight: u8,
    /// The place for a thing that it offers.
    pub(super) offer: Option<Offer>,
    /// Whether a clause for a thing may come right before it, so that it cannot limit an earlier "go straight".
    pub(super) follows_offer: bool,
    /// How many clauses of its kind come before it in the plan, things left out.
    number: usize,
}

/// Weight of clauses that are never left out.
pub(super) const KEPT: u8 = 4;
/// Weight of turns, climbs and the last room.
const MAIN: u8 = 3;
/// Weight of landmarks and of rooms on the way.
const SIDE: u8 = 2;
/// Weight of "go straight" and the like.
const FILLER: u8 = 1;

/// Least salience of a landmark on the way.
const WALKED_PAST: u8 = 2;
/// Least salience of one that is stopped at.
const STOPPED_AT: u8 = 1;
/// A hop longer than this is worth a clause, metres.
pub(super) const LONG_M: f64 = 3.0;
/// On a way without turns and doors, one clause is possible for each stretch of this length, metres.
const STRETCH_M: f64 = 2.0;
/// The walk can stop in a doorway if the hop through it is at most this long, metres.
const DOORWAY_M: f64 = 2.2;

impl Clause {
    fn new(kind: Kind, at: usize, weight: u8) -> Self {
        let (side, thing, room, from) = (None, None, None, None);
        Self { kind, at, side, thing, room, from, weight, offer: None, follows_offer: false, number: 0 }
    }

    /// A clause that exists only for a thing.
    fn for_a_thing(hop: usize, offer: Offer) -> Self {
        Self { offer: Some(offer), ..Self::new(Kind::Pass, hop, SIDE) }
    }

    /// Whether it exists only for a thing.
    pub(super) fn is_offer(&self) -> bool {
        self.offer.as_ref().is_some_and(|offer| offer.role == Role::Onward)
    }

    /// A "go straight" clause to put before it.
    pub(super) fn straight_on(&self) -> Self {
        Self::new(Kind::Straight, self.at, self.weight)
    }

    /// Lets it fall back to "go straight" if it gets no thing.
    pub(super) fn or_straight_on(&mut self) {
        if let Some(offer) = &mut self.offer {
            offer.or_straight = true;
        }
    }

    fn offering(mut self, offer: Offer) -> Self {
        self.offer = Some(offer);
        self
    }

    fn to(mut self, side: Side) -> Self {
        self.side = Some(side);
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

    /// The random generator of the clause for one purpose. A clause for a thing is identified by the thing, any other
    /// by its number among those of its kind. Frames play no role, so the same way with other frames gives the same
    /// draws.
    pub(super) fn drawn(&self, purpose: &str, dice: Dice) -> ChaCha8Rng {
        let kind = format!("{:?}", self.kind);
        match &self.thing {
            Some(thing) if matches!(self.kind, Kind::Pass | Kind::PassOnSide | Kind::To) => {
                dice.by(&[purpose, &kind, &thing.name])
            }
            _ => dice.by(&[purpose, &kind, &self.number.to_string()]),
        }
    }

    /// Whether it is a turn without a place.
    pub(super) fn is_bare(&self) -> bool {
        self.kind.is_bare_turn()
    }
}

/// The clauses of a path, the stop last.
pub(super) fn clauses(brief: &Brief<'_>, dice: Dice) -> Vec<Clause> {
    let memory = brief.memory;
    let here = memory.room(0).and_then(usable_room);
    let rng = dice.by(&["start"]);
    let mut planner = Planner { brief, memory, dice, rng, clauses: Vec::new(), here, along: false };
    if !stands_still(brief.walk) {
        planner.way();
    }
    if planner.clauses.is_empty() {
        planner.clauses.push(Clause::new(Kind::Straight, 0, MAIN));
    }
    planner.rng = dice.by(&["stop"]);
    planner.stop();
    planner.clauses
}

/// Numbers the clauses of each kind.
pub(super) fn numbered(mut plan: Vec<Clause>) -> Vec<Clause> {
    let mut told: BTreeMap<Kind, usize> = BTreeMap::new();
    for clause in plan.iter_mut().filter(|clause| !clause.is_offer()) {
        let number = told.entry(clause.kind).or_default();
        clause.number = *number;
        *number += 1;
    }
    plan
}

struct Planner<'a> {
    brief: &'a Brief<'a>,
    memory: &'a Memory,
    dice: Dice,
    /// The random generator of the current step.
    rng: ChaCha8Rng,
    clauses: Vec<Clause>,
    /// The room that the walker is in according to the text so far, if it is known.
    here: Option<String>,
    /// Whether the text has already sent the walker along the current hallway.
    along: bool,
}

impl Planner<'_> {
    fn way(&mut self) {
        let last = self.memory.frames().saturating_sub(1);
        let mut at = self.leave_at_once().unwrap_or(0);
        while at < last {
            self.rng = self.dice.by(&["step", &self.step(at)]);
            let bend = self.bend_at(at);
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

    /// The name of a step's draws: the number of turns and doors before it, and its distance from the last of them.
    fn step(&self, at: usize) -> String {
        let bends = self.memory.bends.iter().filter(|bend| bend.first < at).count();
        let openings = self.memory.openings.iter().filter(|opening| opening.before < at).count();
        format!("{bends} {openings} {}", self.stretch(at))
    }

    /// The number of the stretch, from 0, in which a frame lies since the last turn or door. If the motion is unknown,
    /// each hop is a stretch.
    fn stretch(&self, at: usize) -> usize {
        let bends = self.memory.bends.iter().map(|bend| bend.first).filter(|first| *first <= at);
        let doors = self.memory.openings.iter().map(|opening| opening.behind).filter(|behind| *behind <= at);
        let from = bends.chain(doors).max().unwrap_or(0);
        match self.brief.walk.path.motion.is_known() {
            true => (self.brief.walk.walked_m(from, at) / STRETCH_M) as usize,
            false => at - from,
        }
    }

    /// The turn to describe at a frame. A turn that begins on stairs and ends after them is described after them.
    fn bend_at(&self, at: usize) -> Option<Bend> {
        let flight = self.memory.flights.iter().find(|flight| flight.to == at);
        let begins_here = |bend: &&Bend| {
            let on_stairs = |flight: &&Flight| (flight.from + 1..flight.to).contains(&bend.first) && bend.last >= at;
            bend.first == at || flight.as_ref().is_some_and(on_stairs)
        };
        let bend = self.memory.bends.iter().find(begins_here)?;
        Some(Bend { first: at, ..*bend })
    }

    fn count(&self, kind: Kind) -> f64 {
        self.brief.profile.way.count(kind)
    }

    fn push(&mut self, clause: Clause) {
        self.clauses.push(clause);
    }

    /// Records the room that the walker is in according to the text.
    fn enter(&mut self, room: Option<&str>) {
        self.here = room.map(str::to_owned);
        self.along = false;
    }

    fn climb(&mut self, flight: Flight) {
        let kind = if flight.climb == Climb::Up { Kind::Up } else { Kind::Down };
        self.push(Clause::new(kind, flight.from, MAIN));
        self.enter(None);
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

/// The name of a room, if a walker can walk into it; stairs are climbed instead.
pub(super) fn usable_room(name: &str) -> Option<String> {
    (room_name(name) != Some("stairs")).then(|| name.to_owned())
}

/// Whether a shape fits a motion: if the motion is unknown, it must not contain "straight" or the like.
pub(super) fn suits(shape: &str, motion: Motion) -> bool {
    motion.is_known() || !["straight", "forward", "ahead"].iter().any(|word| shape.contains(word))
}

/// The word for a side.
pub(super) fn side_word(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}
