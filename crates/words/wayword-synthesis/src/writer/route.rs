//! What there is to say about a path, step by step.

use super::landmarks::{Landmark, Landmarks};
use crate::walk::Walk;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Climb, Motion, Side, Turn, motion};
use wayword_language::lexicon::room_name;

/// Something to say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    /// A turn on the spot, perhaps at a landmark, into a room, or within or out of one.
    Turn { turn: Turn, at: Option<Landmark>, into: Option<String>, within: Option<Within> },
    /// A flight of stairs.
    Climb { climb: Climb, to_level: Option<u32> },
    /// Into another room, or through it.
    Room { from: Option<String>, to: String, through: bool },
    /// Past a landmark.
    Pass(Landmark),
    /// On through the room that one is in.
    Along { room: String },
    /// On, with nothing to name.
    On,
    /// No way at all: the path begins where it ends.
    Stay,
    /// The end.
    Stop { by: Option<Landmark>, room: Option<String>, climbed: Option<Climb> },
}

/// The room in which a turn happens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Within {
    pub(super) room: String,
    /// Whether the turn leads out of it.
    pub(super) out: bool,
}

/// A step with how much it matters: 3 must be said, 1 is said where there is room.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Weighed {
    pub(super) step: Step,
    pub(super) weight: u8,
}

/// Least salience of a landmark that is walked past or turned at.
const WALKED_PAST: u8 = 2;
/// Least salience of one that is stopped at.
const STOPPED_AT: u8 = 1;
/// A move longer than this is worth a phrase, metres.
const LONG_M: f64 = 3.5;

/// The steps of a path, the stop last.
pub(super) fn steps(walk: &Walk, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> Vec<Weighed> {
    let (mut steps, climbed) = match walk.path.motion {
        _ if stands_still(walk) => (Vec::new(), None),
        Motion::Known => by_moves(walk, landmarks, rng),
        Motion::Unknown => (by_sight(walk, landmarks, rng), None),
    };
    if steps.is_empty() {
        let step = if stands_still(walk) { Step::Stay } else { Step::On };
        steps.push(Weighed { step, weight: 3 });
    }
    let end = walk.path.frames.len() - 1;
    let room = walk.room(end).and_then(usable_room);
    let by = landmarks.choose(end, WALKED_PAST, rng).or_else(|| landmarks.choose(end, STOPPED_AT, rng));
    steps.push(Weighed { step: Step::Stop { by, room, climbed }, weight: 3 });
    steps
}

/// The steps of a path whose moves are known, and the climb with which it ends, if any.
fn by_moves(walk: &Walk, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> (Vec<Weighed>, Option<Climb>) {
    let mut steps: Vec<Weighed> = Vec::new();
    let (mut climbed, mut at) = (None, 0);
    while at < walk.moves.len() {
        let flight = motion::flight(&walk.moves, at);
        let last = flight.map_or(at, |(last, _)| last);
        let next_room = changed_room(walk, at, last + 1);
        let turn = walk.moves[at].turn();
        let mut told_room = false;
        if turn != Turn::Straight {
            let into = next_room.clone().filter(|_| flight.is_none() && turn != Turn::Around && rng.random_bool(0.5));
            told_room = into.is_some();
            let has_anchor = at > 0 && !told_room && turn != Turn::Around && rng.random_bool(0.6);
            let anchor = has_anchor.then(|| landmarks.choose(at, WALKED_PAST, rng)).flatten();
            let is_bare = anchor.is_none() && into.is_none() && turn != Turn::Around && rng.random_bool(0.5);
            let room = is_bare.then(|| walk.room(at).and_then(usable_room)).flatten();
            let within = room.map(|room| Within { room, out: changed_room(walk, at, at + 1).is_some() });
            // Two turns in a row need something between them.
            if matches!(steps.last(), Some(Weighed { step: Step::Turn { into: None, .. }, .. })) {
                steps.push(Weighed { step: Step::On, weight: 1 });
            }
            steps.push(Weighed { step: Step::Turn { turn, at: anchor, into, within }, weight: 3 });
        }
        if let Some((last, climb)) = flight {
            let to_level = walk.path.frames[last + 1].level.filter(|level| walk.path.frames[at].level != Some(*level));
            steps.push(Weighed { step: Step::Climb { climb, to_level }, weight: 3 });
            let within = walk.moves[at + 1..=last].iter().map(motion::Move::turn).filter(|turn| turn.side().is_some());
            steps.extend(
                within.map(|turn| Weighed { step: Step::Turn { turn, at: None, into: None, within: None }, weight: 3 }),
            );
        }
        climbed = flight.map(|(_, climb)| climb);
        if let Some(to) = next_room.filter(|_| !told_room) {
            let told_out = matches!(
                steps.last(),
                Some(Weighed { step: Step::Turn { within: Some(Within { out: true, .. }), .. }, .. })
            );
            let from = walk.room(at).and_then(usable_room).filter(|_| !told_out && rng.random_bool(0.4));
            let is_last = last + 1 == walk.moves.len() || changed_room(walk, last + 1, walk.moves.len()).is_none();
            let through = changed_room(walk, last + 1, last + 2).is_some();
            steps.push(Weighed { step: Step::Room { from, to, through }, weight: if is_last { 3 } else { 2 } });
        } else if flight.is_none() && last + 1 < walk.moves.len() {
            steps.extend(onwards(walk, at, &steps, landmarks, rng));
        }
        at = last + 1;
    }
    (steps, climbed)
}

/// The steps of a path without poses: rooms and landmarks in their order.
fn by_sight(walk: &Walk, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> Vec<Weighed> {
    let mut steps: Vec<Weighed> = Vec::new();
    let end = walk.path.frames.len() - 1;
    for at in 0..end {
        if let Some(to) = changed_room(walk, at, at + 1) {
            let from = walk.room(at).and_then(usable_room).filter(|_| rng.random_bool(0.4));
            let through = changed_room(walk, at + 1, at + 2).is_some();
            steps.push(Weighed { step: Step::Room { from, to, through }, weight: 2 });
        } else if at + 1 < end {
            steps.extend(onwards(walk, at, &steps, landmarks, rng));
        }
    }
    // However short the text has to be, there is something to say before the end.
    if let Some(last) = steps.last_mut() {
        last.weight = 3;
    }
    steps
}

/// What to say of a straight stretch: a landmark at its end, the room that it leads through, or at least that it goes
/// on.
fn onwards(
    walk: &Walk,
    at: usize,
    told: &[Weighed],
    landmarks: &mut Landmarks<'_>,
    rng: &mut ChaCha8Rng,
) -> Option<Weighed> {
    if let Some(landmark) = landmarks.choose(at + 1, WALKED_PAST, rng) {
        return Some(Weighed { step: Step::Pass(landmark), weight: 2 });
    }
    let room = walk.room(at + 1).and_then(usable_room);
    let is_told = |room: &str| {
        told.iter().any(|step| matches!(&step.step, Step::Along { room: other } | Step::Room { to: other, through: true, .. } if other == room))
    };
    match room.filter(|room| !is_told(room)) {
        Some(room) => Some(Weighed { step: Step::Along { room }, weight: 2 }),
        None if matches!(told.last(), Some(Weighed { step: Step::On | Step::Along { .. } | Step::Pass(_), .. })) => {
            None
        }
        None => {
            let is_long = walk.moves.get(at).is_some_and(|step| step.distance_m >= LONG_M);
            Some(Weighed { step: Step::On, weight: if is_long { 2 } else { 1 } })
        }
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

/// The room of frame `to`, where it is another than that of frame `from` and has a usable name.
fn changed_room(walk: &Walk, from: usize, to: usize) -> Option<String> {
    let (before, after) = (walk.room(from), walk.room(to)?);
    (before != Some(after)).then(|| usable_room(after)).flatten()
}

/// A room that one can walk into; stairs are climbed instead.
pub(super) fn usable_room(name: &str) -> Option<String> {
    (room_name(name) != Some("stairs")).then(|| name.to_owned())
}

/// The word for a side.
pub(super) fn side_word(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}
