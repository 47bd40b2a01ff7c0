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

pub(super) use carry_out::{carry_out, told_until};
pub(super) use offer::{OfferRole, ThingOffer, with_stand_ins};

use super::{WritingBrief, dice::TextDice, landmarks::ChosenLandmark};
use crate::{style::way::ClauseKind, walk::ObservedWalk};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use wayword_checks::memory::{StairFlight, WalkBend, WalkMemory};
use wayword_core::{ClimbDirection, Side, motion};
use wayword_language::lexicon::room_name;

/// A planned clause.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct WayClause {
    /// The content of the clause, such as a turn at a thing.
    pub(super) kind: ClauseKind,
    /// The frame at which the walker does it.
    pub(super) at: usize,
    /// The side of its turn, or of its door or room.
    pub(super) side: Option<Side>,
    /// The thing that its words name.
    pub(super) thing: Option<ChosenLandmark>,
    /// The room that its words name: the one that the walker enters, or where the clause takes place.
    pub(super) room: Option<String>,
    /// The room that it leaves.
    pub(super) from: Option<String>,
    /// How much it matters, from 1. A clause of weight [`KEPT_WEIGHT`] is never left out.
    pub(super) weight: u8,
    /// The place for a thing that it offers.
    pub(super) offer: Option<ThingOffer>,
    /// Whether a clause for a thing may come right before it, so that it cannot limit an earlier "go straight".
    pub(super) follows_offer: bool,
    /// How many clauses of its kind come before it in the plan, things left out.
    number: usize,
}

/// Weight of clauses that are never left out.
pub(super) const KEPT_WEIGHT: u8 = 4;
/// Weight of turns, climbs and the last room.
const MAIN_WEIGHT: u8 = 3;
/// Weight of landmarks and of rooms on the way.
const SIDE_WEIGHT: u8 = 2;
/// Weight of "go straight" and the like.
const FILLER_WEIGHT: u8 = 1;

/// Least salience of a landmark on the way.
const MIN_PASSED_SALIENCE: u8 = 2;
/// Least salience of a landmark that the walk stops at.
const MIN_STOP_SALIENCE: u8 = 1;
/// A hop longer than this is worth a clause, metres.
pub(super) const LONG_HOP_M: f64 = 3.0;
/// On a way without turns and doors, one clause is possible for each stretch of this length, metres.
const STRETCH_M: f64 = 2.0;
/// The walk can stop in a doorway if the hop through it is at most this long, metres.
const MAX_DOORWAY_HOP_M: f64 = 2.2;

impl WayClause {
    fn new(kind: ClauseKind, at: usize, weight: u8) -> Self {
        let (side, thing, room, from) = (None, None, None, None);
        Self { kind, at, side, thing, room, from, weight, offer: None, follows_offer: false, number: 0 }
    }

    /// A clause that exists only for a thing.
    fn for_a_thing(hop: usize, offer: ThingOffer) -> Self {
        Self { offer: Some(offer), ..Self::new(ClauseKind::Pass, hop, SIDE_WEIGHT) }
    }

    /// Whether it exists only for a thing.
    pub(super) fn is_offer(&self) -> bool {
        self.offer.as_ref().is_some_and(|offer| offer.role == OfferRole::Onward)
    }

    /// A "go straight" clause to put before it.
    pub(super) fn straight_on(&self) -> Self {
        Self::new(ClauseKind::Straight, self.at, self.weight)
    }

    /// The same clause of another kind.
    pub(super) fn of_kind(&self, kind: ClauseKind) -> Self {
        Self { kind, ..self.clone() }
    }

    /// Lets it fall back to "go straight" if it gets no thing.
    pub(super) fn or_straight_on(&mut self) {
        if let Some(offer) = &mut self.offer {
            offer.or_straight = true;
        }
    }

    fn with_offer(mut self, offer: ThingOffer) -> Self {
        self.offer = Some(offer);
        self
    }

    fn with_side(mut self, side: Side) -> Self {
        self.side = Some(side);
        self
    }

    fn with_room(mut self, room: &str) -> Self {
        self.room = Some(room.to_owned());
        self
    }

    fn with_left_room(mut self, room: &str) -> Self {
        self.from = Some(room.to_owned());
        self
    }

    /// The random generator of the clause for one purpose. A clause for a thing is identified by the thing, any other
    /// by its number among those of its kind. Frames play no role, so the same way with other frames gives the same
    /// draws.
    pub(super) fn clause_rng(&self, purpose: &str, dice: TextDice) -> ChaCha8Rng {
        let kind = format!("{:?}", self.kind);
        match &self.thing {
            Some(thing) if matches!(self.kind, ClauseKind::Pass | ClauseKind::PassOnSide | ClauseKind::To) => {
                dice.named_rng(&[purpose, &kind, &thing.name])
            }
            _ => dice.named_rng(&[purpose, &kind, &self.number.to_string()]),
        }
    }

    /// Whether it is a turn without a place.
    pub(super) fn is_bare(&self) -> bool {
        self.kind.is_bare_turn()
    }
}

/// The clauses of a path, the stop last.
pub(super) fn plan_clauses(brief: &WritingBrief<'_>, dice: TextDice) -> Vec<WayClause> {
    let memory = brief.memory;
    let here = memory.room_at(0).and_then(usable_room);
    let rng = dice.named_rng(&["start"]);
    let mut planner = WayPlanner { brief, memory, dice, rng, clauses: Vec::new(), here, along: false };
    if !stands_still(brief.walk) {
        planner.plan_way();
    }
    if planner.clauses.is_empty() {
        planner.clauses.push(WayClause::new(ClauseKind::Straight, 0, MAIN_WEIGHT));
    }
    planner.rng = dice.named_rng(&["stop"]);
    planner.add_stop();
    planner.clauses
}

/// Numbers the clauses of each kind.
pub(super) fn number_clauses(mut plan: Vec<WayClause>) -> Vec<WayClause> {
    let mut counts: BTreeMap<ClauseKind, usize> = BTreeMap::new();
    for clause in plan.iter_mut().filter(|clause| !clause.is_offer()) {
        let number = counts.entry(clause.kind).or_default();
        clause.number = *number;
        *number += 1;
    }
    plan
}

/// Plans the clauses of a way step by step, from its start.
struct WayPlanner<'a> {
    brief: &'a WritingBrief<'a>,
    memory: &'a WalkMemory,
    dice: TextDice,
    /// The random generator of the current step.
    rng: ChaCha8Rng,
    clauses: Vec<WayClause>,
    /// The room that the walker is in according to the text so far, if it is known.
    here: Option<String>,
    /// Whether the text has already sent the walker along the current hallway.
    along: bool,
}

impl WayPlanner<'_> {
    /// Plans all clauses before the stop, frame by frame.
    fn plan_way(&mut self) {
        let last = self.memory.frame_count().saturating_sub(1);
        let mut at = self.leave_at_once().unwrap_or(0);
        while at < last {
            self.rng = self.dice.named_rng(&["step", &self.step_name(at)]);
            let bend = self.bend_at(at);
            let opening = self.memory.openings.iter().find(|opening| opening.before == at);
            if let Some(flight) = self.memory.flights.iter().find(|flight| flight.from == at) {
                if let Some(bend) = bend {
                    self.add_turn(bend);
                }
                self.add_climb(*flight);
                at = flight.to;
                continue;
            }
            match (bend, opening) {
                (Some(bend), Some(opening)) => self.turn_and_change(bend, opening),
                (Some(bend), None) => {
                    self.add_turn(bend);
                    self.go_onwards(at);
                }
                (None, Some(opening)) => match self.memory.side_among_doors(opening.before) {
                    Some(side) => self.choose_door(side, opening),
                    None => self.change_room(opening),
                },
                (None, None) => self.go_onwards(at),
            }
            at += 1;
        }
    }

    /// The name of a step's draws: the number of turns and doors before it, and its distance from the last of them.
    fn step_name(&self, at: usize) -> String {
        let bends = self.memory.bends.iter().filter(|bend| bend.first < at).count();
        let openings = self.memory.openings.iter().filter(|opening| opening.before < at).count();
        format!("{bends} {openings} {}", self.stretch_number(at))
    }

    /// The number of the stretch, from 0, in which a frame lies since the last turn or door. If the motion is unknown,
    /// each hop is a stretch.
    fn stretch_number(&self, at: usize) -> usize {
        let bends = self.memory.bends.iter().map(|bend| bend.first).filter(|first| *first <= at);
        let doors = self.memory.openings.iter().map(|opening| opening.behind).filter(|behind| *behind <= at);
        let from = bends.chain(doors).max().unwrap_or(0);
        match self.brief.walk.path.motion.is_known() {
            true => (self.brief.walk.walked_m(from, at) / STRETCH_M) as usize,
            false => at - from,
        }
    }

    /// The turn to describe at a frame. A turn that begins on stairs and ends after them is described after them.
    fn bend_at(&self, at: usize) -> Option<WalkBend> {
        let flight = self.memory.flights.iter().find(|flight| flight.to == at);
        let begins_here = |bend: &&WalkBend| {
            let on_stairs =
                |flight: &&StairFlight| (flight.from + 1..flight.to).contains(&bend.first) && bend.last >= at;
            bend.first == at || flight.as_ref().is_some_and(on_stairs)
        };
        let bend = self.memory.bends.iter().find(begins_here)?;
        Some(WalkBend { first: at, ..*bend })
    }

    /// How often the texts of the style have a kind of clause: the weight of the kind in a draw.
    fn kind_count(&self, kind: ClauseKind) -> f64 {
        self.brief.profile.way.kind_count(kind)
    }

    /// The frame up to which the plan so far describes the walk, places for things included, at most `at`.
    fn planned_until(&self, at: usize) -> usize {
        self.clauses.last().map_or(0, |before| before.at + 1).min(at)
    }

    fn push(&mut self, clause: WayClause) {
        self.clauses.push(clause);
    }

    /// Records the room that the walker is in according to the text.
    fn enter_room(&mut self, room: Option<&str>) {
        self.here = room.map(str::to_owned);
        self.along = false;
    }

    /// Adds the clause for a flight of stairs. Behind it the text leaves the room open.
    fn add_climb(&mut self, flight: StairFlight) {
        let kind = if flight.climb == ClimbDirection::Up { ClauseKind::Up } else { ClauseKind::Down };
        self.push(WayClause::new(kind, flight.from, MAIN_WEIGHT));
        self.enter_room(None);
    }
}

/// Whether a path goes nowhere, as one with a single viewpoint does.
pub(super) fn stands_still(walk: &ObservedWalk) -> bool {
    !walk.path.motion.goes_anywhere(&walk.moves, walk.path.frames.len())
}

/// Which way the last flight of stairs of a path goes.
pub(super) fn last_climb(walk: &ObservedWalk) -> Option<ClimbDirection> {
    (0..walk.moves.len()).rev().find_map(|at| motion::flight_from(&walk.moves, at)).map(|(_, climb)| climb)
}

/// The name of a room, if a walker can walk into it; stairs are climbed instead.
pub(super) fn usable_room(name: &str) -> Option<String> {
    (room_name(name) != Some("stairs")).then(|| name.to_owned())
}

/// The word for a side.
pub(super) fn side_word(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}
