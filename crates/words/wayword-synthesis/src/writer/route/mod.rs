//! What there is to say about a path, clause by clause: each turn has its place, and rooms are entered before they are
//! left. The plan of a text goes by the way alone. It has offers of places for things; which things are told there is seen
//! when the plan is carried out, so that a thing that comes or goes changes the words of its own place only.

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
    /// The thing that may be told with it, or for which it stands.
    pub(super) offer: Option<Offer>,
    /// Whether a clause for a thing may stand right before it, so that it cannot say how far that one goes.
    pub(super) follows_offer: bool,
    /// How many clauses of its kind come before it in the plan, things left out.
    number: usize,
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
pub(super) const LONG_M: f64 = 3.0;
/// Something may be told of every so many metres of a way without turns and doors.
const STRETCH_M: f64 = 2.0;
/// One stops in a doorway where the hop through it is no longer than this, metres.
const DOORWAY_M: f64 = 2.2;

impl Clause {
    fn new(kind: Kind, at: usize, weight: u8) -> Self {
        let (side, thing, room, from) = (None, None, None, None);
        Self { kind, at, side, thing, room, from, weight, offer: None, follows_offer: false, number: 0 }
    }

    /// A clause that is there for a thing alone.
    fn for_a_thing(hop: usize, offer: Offer) -> Self {
        Self { offer: Some(offer), ..Self::new(Kind::Pass, hop, SIDE) }
    }

    /// Whether it is there for a thing alone.
    pub(super) fn is_offer(&self) -> bool {
        self.offer.as_ref().is_some_and(|offer| offer.role == Role::Onward)
    }

    /// That one goes straight on before it.
    pub(super) fn straight_on(&self) -> Self {
        Self::new(Kind::Straight, self.at, self.weight)
    }

    /// Says that one goes straight on where it has no thing.
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

    /// What it draws for one purpose: a clause that is there for a thing by its thing, and another by its place among those of
    /// its kind. Frames have no part in it, so that other frames of the same way draw the same.
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

/// Gives the clauses of a plan their places among those of their kinds.
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
    /// What is drawn for the step that is told.
    rng: ChaCha8Rng,
    clauses: Vec<Clause>,
    /// The room in which the text has the walker now, where it says so.
    here: Option<String>,
    /// Whether the text has told to go along the hallway in which one is.
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

    /// What a step draws by: the turns and doors before it, and how far it is from the last of them.
    fn step(&self, at: usize) -> String {
        let bends = self.memory.bends.iter().filter(|bend| bend.first < at).count();
        let openings = self.memory.openings.iter().filter(|opening| opening.before < at).count();
        format!("{bends} {openings} {}", self.stretch(at))
    }

    /// In which stretch of a way without turns and doors a frame lies, from 0. Of an unknown motion each hop is one.
    fn stretch(&self, at: usize) -> usize {
        let bends = self.memory.bends.iter().map(|bend| bend.first).filter(|first| *first <= at);
        let doors = self.memory.openings.iter().map(|opening| opening.behind).filter(|behind| *behind <= at);
        let from = bends.chain(doors).max().unwrap_or(0);
        match self.brief.walk.path.motion.is_known() {
            true => (self.brief.walk.walked_m(from, at) / STRETCH_M) as usize,
            false => at - from,
        }
    }

    /// The turn that is told at a frame. One that begins on stairs and ends behind them is told behind them.
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
