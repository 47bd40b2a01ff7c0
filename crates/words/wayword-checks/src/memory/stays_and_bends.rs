//! Finds the rooms, bends and flights of stairs of a walk.

use crate::Evidence;
use std::{cmp::Ordering, collections::BTreeSet, ops::Range};
use wayword_core::{ClimbDirection, PathMove, Side, motion};
use wayword_language::lexicon::room_name;

/// Frames in a row that lie in one room.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoomStay {
    /// The room, as the evidence names it.
    pub room: String,
    /// Its first frame.
    pub entered: usize,
    /// Its last frame.
    pub left: usize,
}

/// A turn, of one move or of several small ones to the same side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkBend {
    /// Its first move; it begins at the frame of that number.
    pub first: usize,
    /// Its last move.
    pub last: usize,
    /// How far it turns, radians, positive right.
    pub turn_rad: f64,
}

/// A flight of stairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StairFlight {
    /// Up or down.
    pub climb: ClimbDirection,
    /// The frame at which it begins.
    pub from: usize,
    /// The frame at which it ends.
    pub to: usize,
    /// The storey at its end, where that is another one.
    pub to_level: Option<u32>,
}

/// A hop with at least this share of the slope of its flight lies on the stairs as a whole.
const STEEP_SHARE: f64 = 0.9;

impl StairFlight {
    /// Whether the walk ends with this flight, as steep as it is elsewhere: then it is not known whether the stairs end there too.
    #[must_use]
    pub fn ends_on_stairs(&self, moves: &[PathMove]) -> bool {
        let slope = |step: &PathMove| step.rise_m.abs() / step.distance_m.max(f64::MIN_POSITIVE);
        let steps = moves.get(self.from..self.to).unwrap_or_default();
        let steepest = steps.iter().map(slope).fold(0.0, f64::max);
        self.to == moves.len() && steps.last().is_some_and(|step| slope(step) >= STEEP_SHARE * steepest)
    }
}

impl WalkBend {
    /// The side to which it turns; `Behind` for a turn around.
    #[must_use]
    pub fn side(&self) -> Side {
        match self.turn_rad.to_degrees() {
            deg if deg.abs() >= motion::AROUND_DEG => Side::Behind,
            deg if deg < 0.0 => Side::Left,
            _ => Side::Right,
        }
    }

    /// Whether it is a slight turn.
    #[must_use]
    pub fn is_slight(&self) -> bool {
        self.turn_rad.to_degrees().abs() < motion::FULL_DEG
    }
}

/// The stays in order. Frames without a known room, between two frames in rooms of one name, belong to the same stay.
pub(super) fn find_stays(evidence: &Evidence) -> Vec<RoomStay> {
    let mut stays: Vec<RoomStay> = Vec::new();
    for (frame, seen) in evidence.frames.iter().enumerate() {
        let Some(room) = seen.rooms.first() else { continue };
        let name = |room: &str| room_name(room).map_or_else(|| room.to_owned(), str::to_owned);
        match stays.last_mut() {
            Some(stay) if name(&stay.room) == name(room) => stay.left = frame,
            _ => stays.push(RoomStay { room: room.clone(), entered: frame, left: frame }),
        }
    }
    stays
}

/// Moves the begin of a room behind a turn that is made just before its door. A frame in the opening counts to the room ahead, although
/// the hop from there leads through the door.
pub(super) fn turn_before_rooms(
    stays: &mut [RoomStay],
    bends: &[WalkBend],
    leads_through_door: impl Fn(usize) -> bool,
) {
    for at in 1..stays.len() {
        let entered = stays[at].entered;
        let turns_there = bends.iter().any(|bend| bend.first == entered);
        if stays[at - 1].left + 1 == entered && entered < stays[at].left && turns_there && leads_through_door(entered) {
            stays[at - 1].left = entered;
            stays[at].entered = entered + 1;
        }
    }
}

/// Two opposite turns are taken for a winding way, and not for turns, if three limits hold. Each is smaller than this,
/// degrees.
const WINDING_EACH_DEG: f64 = 40.0;
/// They add up to less than this, degrees.
const WINDING_DEG: f64 = motion::SLIGHT_DEG;
/// The way between them is shorter than this, metres.
const WINDING_M: f64 = 2.5;
/// Several turns in a row are one bend up to this, degrees; beyond that they are turns of their own.
const ONE_BEND_DEG: f64 = 135.0;

/// The turns of a walk that are worth a word. The way back has the same turns, in reverse.
pub(super) fn find_bends(moves: &[PathMove]) -> Vec<WalkBend> {
    let mut bends: Vec<WalkBend> = Vec::new();
    // The opening turn is a turn of its own: the walker does not walk before it.
    let mut at = 0;
    while at < moves.len() {
        let run = if at == 0 { 1 } else { run_of_turns(moves, at) };
        join_bends(moves, at..at + run, &mut bends);
        at += run;
    }
    drop_winding(bends, moves)
}

/// How far a move turns, degrees, positive right.
fn turn_deg(moves: &[PathMove], at: usize) -> f64 {
    moves[at].turn_rad.to_degrees()
}

/// How many moves in a row, from `first` on, turn to the same side; 1 if the first one hardly turns.
fn run_of_turns(moves: &[PathMove], first: usize) -> usize {
    let sign = turn_deg(moves, first).signum();
    let same = (first + 1..moves.len()).take_while(|at| turn_deg(moves, *at) * sign >= motion::BEND_STEP_DEG);
    let turns = turn_deg(moves, first).abs() >= motion::BEND_STEP_DEG;
    if turns { 1 + same.count() } else { 1 }
}

/// Adds the bends of a run of moves that turn to one side, in order. Parts of the run that can be one bend are joined:
/// the longest first (of equal ones, the part that turns farthest), then those in the rest of the run.
fn join_bends(moves: &[PathMove], run: Range<usize>, bends: &mut Vec<WalkBend>) {
    let total = |part: &Range<usize>| part.clone().map(|at| turn_deg(moves, at)).sum::<f64>().abs();
    let parts = run
        .clone()
        .flat_map(|first| (first + 2..=run.end.min(first + motion::MAX_BEND_MOVES)).map(move |end| first..end));
    let fits = |part: &Range<usize>| (motion::BEND_DEG..=ONE_BEND_DEG).contains(&total(part));
    // A full turn that is followed by another full turn is not joined with it.
    let is_full = |at: &usize| turn_deg(moves, *at).abs() >= motion::FULL_DEG;
    let joins = |part: &Range<usize>| part.clone().filter(is_full).count() <= 1;
    let far = |part: &Range<usize>| (part.len(), total(part));
    let best = parts
        .filter(|part| fits(part) && joins(part))
        .max_by(|a, b| far(a).partial_cmp(&far(b)).unwrap_or(Ordering::Equal));
    let Some(part) = best else {
        let worth_a_word = |at: &usize| turn_deg(moves, *at).abs() >= motion::SLIGHT_DEG;
        bends.extend(run.filter(worth_a_word).map(|at| WalkBend { first: at, last: at, turn_rad: moves[at].turn_rad }));
        return;
    };
    join_bends(moves, run.start..part.start, bends);
    let turn_rad = part.clone().map(|at| moves[at].turn_rad).sum();
    bends.push(WalkBend { first: part.start, last: part.end - 1, turn_rad });
    join_bends(moves, part.end..run.end, bends);
}

/// The bends without pairs that cancel each other at once, as on a winding way. The nearest two go first. Only the
/// turns count, because a walker in a door is in the room ahead, which is another one on the way back.
fn drop_winding(mut bends: Vec<WalkBend>, moves: &[PathMove]) -> Vec<WalkBend> {
    let between_m =
        |pair: &[WalkBend]| moves[pair[0].last..pair[1].first].iter().map(|step| step.distance_m).sum::<f64>();
    let takes_back = |pair: &[WalkBend]| {
        let small = pair.iter().all(|bend| bend.turn_rad.to_degrees().abs() < WINDING_EACH_DEG);
        let net_deg = (pair[0].turn_rad + pair[1].turn_rad).to_degrees().abs();
        pair[0].first > 0 && small && net_deg < WINDING_DEG && between_m(pair) < WINDING_M
    };
    loop {
        let winding = bends.windows(2).enumerate().filter(|(_, pair)| takes_back(pair));
        let Some((at, _)) = winding.min_by(|a, b| between_m(a.1).total_cmp(&between_m(b.1))) else { return bends };
        bends.drain(at..at + 2);
    }
}

/// The bends, where one that leads through a door is two if the part before the door or the part behind it is a turn by itself: "go through
/// the door and turn left" is not "the door on the left". A small rest needs no word. `doors` has the hops that lead through a door.
pub(super) fn split_at_doors(bends: &[WalkBend], moves: &[PathMove], doors: &BTreeSet<usize>) -> Vec<WalkBend> {
    let part = |first: usize, last: usize| WalkBend {
        first,
        last,
        turn_rad: moves[first..=last].iter().map(|step| step.turn_rad).sum(),
    };
    let split = |bend: &WalkBend| {
        let parts = doors
            .range(bend.first..bend.last)
            .map(|hop| [part(bend.first, *hop), part(hop + 1, bend.last)])
            .find(|parts| parts.iter().any(|part| part.turn_rad.to_degrees().abs() >= motion::TOLD_DEG));
        parts.map_or_else(
            || vec![*bend],
            |parts| parts.into_iter().filter(|part| part.turn_rad.to_degrees().abs() >= motion::SLIGHT_DEG).collect(),
        )
    };
    bends.iter().flat_map(split).collect()
}

/// Two flights with at most this much way between them are one flight that turns at a landing, metres.
const LANDING_M: f64 = 2.5;

/// The flights of stairs, in order. Those that a landing joins are one.
pub(super) fn find_flights(evidence: &Evidence) -> Vec<StairFlight> {
    let (mut flights, mut at) = (Vec::<StairFlight>::new(), 0);
    while at < evidence.moves.len() {
        let Some((last, climb)) = motion::flight_from(&evidence.moves, at) else {
            at += 1;
            continue;
        };
        let level = |frame: usize| evidence.frames.get(frame).and_then(|frame| frame.level);
        let to_level = level(last + 1).filter(|level_after| level(at) != Some(*level_after));
        let flight = StairFlight { climb, from: at, to: last + 1, to_level };
        at = last + 1;
        match flights.last_mut().filter(|before| is_landing(before, &flight, &evidence.moves)) {
            Some(before) => (before.to, before.to_level) = (flight.to, flight.to_level.or(before.to_level)),
            None => flights.push(flight),
        }
    }
    flights
}

/// Whether only a landing lies between two flights.
fn is_landing(before: &StairFlight, next: &StairFlight, moves: &[PathMove]) -> bool {
    let between_m: f64 = moves[before.to..next.from].iter().map(|step| step.distance_m).sum();
    before.climb == next.climb && between_m <= LANDING_M
}
