//! The rooms, bends and flights of a walk.

use crate::Evidence;
use wayword_core::{Climb, Move, Side, motion};
use wayword_language::lexicon::room_name;

/// Frames in a row that lie in one room.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stay {
    /// The room, as the evidence names it.
    pub room: String,
    /// Its first frame.
    pub entered: usize,
    /// Its last frame.
    pub left: usize,
}

/// A turn, of one move or of several small ones to the same side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Its first move; it begins at the frame of that number.
    pub first: usize,
    /// Its last move.
    pub last: usize,
    /// How far it turns, radians, positive right.
    pub turn_rad: f64,
}

/// A flight of stairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flight {
    /// Up or down.
    pub climb: Climb,
    /// The frame at which it begins.
    pub from: usize,
    /// The frame at which it ends.
    pub to: usize,
    /// The storey at its end, where that is another one.
    pub to_level: Option<u32>,
}

impl Bend {
    /// The side to which it turns; `Behind` for a turn around.
    #[must_use]
    pub fn side(&self) -> Side {
        match self.turn_rad.to_degrees() {
            deg if deg.abs() >= motion::AROUND_DEG => Side::Behind,
            deg if deg < 0.0 => Side::Left,
            _ => Side::Right,
        }
    }

    /// Whether it is less than a turn that is named without "slightly".
    #[must_use]
    pub fn is_slight(&self) -> bool {
        self.turn_rad.to_degrees().abs() < motion::FULL_DEG
    }
}

/// The rooms in order. A gap of frames without a room, between two of one name, belongs to that stay.
pub(super) fn stays(evidence: &Evidence) -> Vec<Stay> {
    let mut stays: Vec<Stay> = Vec::new();
    for (frame, seen) in evidence.frames.iter().enumerate() {
        let Some(room) = seen.rooms.first() else { continue };
        let name = |room: &str| room_name(room).map_or_else(|| room.to_owned(), str::to_owned);
        match stays.last_mut() {
            Some(stay) if name(&stay.room) == name(room) => stay.left = frame,
            _ => stays.push(Stay { room: room.clone(), entered: frame, left: frame }),
        }
    }
    stays
}

/// Moves between which a walker turns back and forth by less than this in all have no turn, degrees.
const WINDING_DEG: f64 = motion::SLIGHT_DEG;
/// As long as the way between them is shorter than this, metres.
const WINDING_M: f64 = 2.5;
/// Several turns in a row are one bend up to this, degrees; beyond that they are turns of their own.
const ONE_BEND_DEG: f64 = 135.0;

/// The turns of a walk that are worth a word. `entered` are the frames at which another room begins.
pub(super) fn bends(moves: &[Move], entered: &[usize]) -> Vec<Bend> {
    let mut bends: Vec<Bend> = Vec::new();
    let mut at = 0;
    while at < moves.len() {
        let last = last_of_bend(moves, at);
        let turn_rad: f64 = moves[at..=last].iter().map(|step| step.turn_rad).sum();
        let deg = turn_rad.to_degrees().abs();
        if deg >= motion::SLIGHT_DEG {
            bends.push(Bend { first: at, last, turn_rad });
        }
        at = last + 1;
    }
    unwound(bends, moves, entered)
}

/// The last move of the bend that begins with a move: its own number, unless the moves after it turn on to the same
/// side. It is what the checks take for one turn, too.
fn last_of_bend(moves: &[Move], first: usize) -> usize {
    let deg = |at: usize| moves[at].turn_rad.to_degrees();
    let sign = deg(first).signum();
    // The opening turn is a turn of its own: the walker does not walk before it.
    let most = if first == 0 { 1 } else { motion::BEND_MOVES };
    let same = |at: &usize| deg(*at) * sign >= motion::BEND_STEP_DEG;
    let last = (first..moves.len()).take(most).take_while(same).last().unwrap_or(first);
    let total = |last: usize| (first..=last).map(deg).sum::<f64>().abs();
    let fits = |last: &usize| *last == first || (motion::BEND_DEG..=ONE_BEND_DEG).contains(&total(*last));
    // A turn that is one by itself and is followed by another such is not joined with it.
    let is_full = |at: usize| deg(at).abs() >= motion::FULL_DEG;
    let joins = |last: &usize| (first..=*last).filter(|at| is_full(*at)).count() <= 1;
    (first..=last).rev().find(|last| fits(last) && joins(last)).unwrap_or(first)
}

/// The bends without those that the next one takes back at once in the same room: a way that winds.
fn unwound(bends: Vec<Bend>, moves: &[Move], entered: &[usize]) -> Vec<Bend> {
    let mut kept: Vec<Bend> = Vec::new();
    for bend in bends {
        let takes_back = kept.last().is_some_and(|before| {
            let between_m: f64 = moves[before.first..bend.first].iter().map(|step| step.distance_m).sum();
            let net_deg = (before.turn_rad + bend.turn_rad).to_degrees().abs();
            let both_slight = before.is_slight() && bend.is_slight();
            let stays = !entered.iter().any(|frame| (before.first + 1..=bend.first).contains(frame));
            before.first > 0 && stays && both_slight && net_deg < WINDING_DEG && between_m < WINDING_M
        });
        if takes_back {
            kept.pop();
        } else {
            kept.push(bend);
        }
    }
    kept
}

/// Two flights with no longer way between them are one that turns at a landing, metres.
const LANDING_M: f64 = 2.5;

/// The flights of stairs, in order. Those that a landing joins are one.
pub(super) fn flights(evidence: &Evidence) -> Vec<Flight> {
    let (mut flights, mut at) = (Vec::<Flight>::new(), 0);
    while at < evidence.moves.len() {
        let Some((last, climb)) = motion::flight(&evidence.moves, at) else {
            at += 1;
            continue;
        };
        let level = |frame: usize| evidence.frames.get(frame).and_then(|frame| frame.level);
        let to_level = level(last + 1).filter(|level_after| level(at) != Some(*level_after));
        let flight = Flight { climb, from: at, to: last + 1, to_level };
        at = last + 1;
        match flights.last_mut().filter(|before| is_landing(before, &flight, &evidence.moves)) {
            Some(before) => (before.to, before.to_level) = (flight.to, flight.to_level.or(before.to_level)),
            None => flights.push(flight),
        }
    }
    flights
}

/// Whether only a landing lies between two flights.
fn is_landing(before: &Flight, next: &Flight, moves: &[Move]) -> bool {
    let between_m: f64 = moves[before.to..next.from].iter().map(|step| step.distance_m).sum();
    before.climb == next.climb && between_m <= LANDING_M
}
