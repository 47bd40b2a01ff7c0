//! What there is to tell about a walk, step by step.

use super::landmarks::{Landmark, Landmarks};
use crate::{lexicon::room_name, walk::Walk};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Climb, Side, Turn, motion};

/// Something to tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    /// A turn on the spot, perhaps at a landmark or into a room.
    Turn { turn: Turn, at: Option<Landmark>, into: Option<String> },
    /// A flight of stairs.
    Climb { climb: Climb, to_level: Option<u32> },
    /// Into another room, or through it.
    Room { from: Option<String>, to: String, through: bool },
    /// Past a landmark.
    Pass(Landmark),
    /// On, with nothing to name.
    On,
    /// The end.
    Stop { by: Option<Landmark>, room: Option<String>, climbed: Option<Climb> },
}

/// A step with how much it matters: 3 must be told, 1 is told where there is room.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Weighed {
    pub(super) step: Step,
    pub(super) weight: u8,
}

/// Something longer than this between two turns is worth a word, metres.
const LONG_M: f64 = 3.5;
/// Rises of less than this are the floor's, metres.
const FLAT_M: f64 = 0.05;

/// The steps of a walk, the stop last.
pub(super) fn steps(walk: &Walk, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> Vec<Weighed> {
    let mut steps: Vec<Weighed> = Vec::new();
    let mut climbed = None;
    let mut at = 0;
    while at < walk.moves.len() {
        let flight = flight(walk, at);
        let last = flight.map_or(at, |(last, _)| last);
        let next_room = changed_room(walk, at, last + 1);
        let turn = walk.moves[at].turn();
        let mut told_room = false;
        if turn != Turn::Straight {
            let anchor = rng.random_bool(0.5).then(|| landmarks.choose(at, rng)).flatten().filter(|_| at > 0);
            let into = next_room.clone().filter(|_| flight.is_none() && turn != Turn::Around && rng.random_bool(0.5));
            told_room = into.is_some();
            steps.push(Weighed { step: Step::Turn { turn, at: anchor.filter(|_| into.is_none()), into }, weight: 3 });
        }
        if let Some((last, climb)) = flight {
            let to_level = walk.path.frames[last + 1].level.filter(|level| walk.path.frames[at].level != Some(*level));
            steps.push(Weighed { step: Step::Climb { climb, to_level }, weight: 3 });
            let within = walk.moves[at + 1..=last].iter().map(motion::Move::turn).filter(|turn| turn.side().is_some());
            steps.extend(within.map(|turn| Weighed { step: Step::Turn { turn, at: None, into: None }, weight: 3 }));
        }
        climbed = flight.map(|(_, climb)| climb);
        if let Some(to) = next_room.filter(|_| !told_room) {
            let from = walk.room(at).and_then(usable_room).filter(|_| rng.random_bool(0.4));
            let is_last = last + 1 == walk.moves.len() || changed_room(walk, last + 1, walk.moves.len()).is_none();
            let through = changed_room(walk, last + 1, last + 2).is_some();
            steps.push(Weighed { step: Step::Room { from, to, through }, weight: if is_last { 3 } else { 2 } });
        } else if !told_room && flight.is_none() && last + 1 < walk.moves.len() {
            let step = match landmarks.choose(last + 1, rng) {
                Some(landmark) => Some(Weighed { step: Step::Pass(landmark), weight: 1 }),
                None => (walk.moves[at].distance_m >= LONG_M).then_some(Weighed { step: Step::On, weight: 1 }),
            };
            steps.extend(
                step.filter(|step| {
                    step.step != Step::On || !matches!(steps.last(), Some(Weighed { step: Step::On, .. }))
                }),
            );
        }
        at = last + 1;
    }
    if steps.is_empty() {
        steps.push(Weighed { step: Step::On, weight: 3 });
    }
    let end = walk.path.frames.len() - 1;
    let room = walk.room(end).and_then(usable_room);
    steps.push(Weighed { step: Step::Stop { by: landmarks.choose(end, rng), room, climbed }, weight: 3 });
    steps
}

/// The flight of stairs that begins with a move: its last move, and which way it goes.
fn flight(walk: &Walk, first: usize) -> Option<(usize, Climb)> {
    let rise_m = walk.moves[first].rise_m;
    let same_way = |at: &usize| walk.moves[*at].rise_m * rise_m.signum() > FLAT_M;
    let last = (first..walk.moves.len()).take_while(same_way).last()?;
    let total_m: f64 = walk.moves[first..=last].iter().map(|step| step.rise_m).sum();
    match Climb::from_rise(total_m) {
        Climb::Level => None,
        climb => Some((last, climb)),
    }
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
