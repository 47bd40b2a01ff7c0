//! Lays what a text says, in its order, along the walk.
//!
//! A place is laid on a frame that shows it, a turn on a move (or a bend of up to three) that makes it. Places may not go
//! back, each turn needs a move of its own after the last one's, and a turn and the places around it must be near each
//! other. The search keeps every state that the text so far allows, so it fails only where no reading of the text fits.

use crate::evidence::Evidence;
use std::collections::BTreeMap;
use wayword_core::{Side, motion};

/// Longest bend that is told as one turn, moves.
const BEND_MOVES: usize = 3;
/// Least turn of each move of a bend, degrees.
const BEND_STEP_DEG: f64 = 10.0;
/// Least turn of a bend, degrees.
const BEND_DEG: f64 = 60.0;
/// Least turn that is told as turning around, degrees.
const ABOUT_DEG: f64 = 120.0;

/// Something to lay along the walk.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Step {
    /// A place, and the frames that show it.
    Place(Vec<usize>),
    /// A turn.
    Turn(Side),
    /// Something that holds no place in the order.
    Free,
}

/// How far a text has got: the frame of its last place, the frame of its last turn, and the first move that is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct State {
    place: usize,
    turn: usize,
    next_move: usize,
}

/// The frame of each step, where all of them can be laid along the walk; else the first step at which none of the ways to
/// lay those before it can go on.
pub(super) fn align(steps: &[Step], evidence: &Evidence) -> Result<Vec<Option<usize>>, usize> {
    // For each step the states after it, each with the state before it and its own frame.
    let mut layers: Vec<BTreeMap<State, (State, Option<usize>)>> = Vec::with_capacity(steps.len());
    let start = State { place: 0, turn: 0, next_move: 0 };
    let mut now = vec![start];
    for (at, step) in steps.iter().enumerate() {
        let mut layer = BTreeMap::new();
        for state in &now {
            for (next, frame) in after(*state, step, evidence) {
                layer.entry(next).or_insert((*state, frame));
            }
        }
        if layer.is_empty() {
            return Err(at);
        }
        now = layer.keys().copied().collect();
        layers.push(layer);
    }
    let mut frames = vec![None; steps.len()];
    let mut state = now.first().copied().unwrap_or(start);
    for (frame, layer) in frames.iter_mut().zip(&layers).rev() {
        if let Some((before, at)) = layer.get(&state) {
            (*frame, state) = (*at, *before);
        }
    }
    Ok(frames)
}

fn after(state: State, step: &Step, evidence: &Evidence) -> Vec<(State, Option<usize>)> {
    match step {
        Step::Free => vec![(state, None)],
        Step::Place(frames) => frames
            .iter()
            .filter(|frame| **frame >= state.place && **frame >= state.turn)
            .map(|frame| (State { place: *frame, ..state }, Some(*frame)))
            .collect(),
        // A place that is told before a turn may already be seen from the frame of the turn, a hop ahead of itself.
        Step::Turn(side) => turns(*side, state.next_move, evidence)
            .into_iter()
            .filter(|(first, _)| first + 1 >= state.place)
            .map(|(first, last)| (State { turn: first, next_move: last + 1, ..state }, Some(first)))
            .collect(),
    }
}

/// The moves, or bends of moves, from `from` on that make a turn to a side: first and last move of each.
fn turns(side: Side, from: usize, evidence: &Evidence) -> Vec<(usize, usize)> {
    let sign = if side == Side::Left { -1.0 } else { 1.0 };
    let deg: Vec<f64> = evidence.moves.iter().map(|step| step.turn_rad.to_degrees() * sign).collect();
    let is_turn = |first: usize, last: usize| {
        let bend = &deg[first..=last];
        let total: f64 = bend.iter().sum();
        let one_way = bend.len() == 1 || bend.iter().all(|deg| *deg >= BEND_STEP_DEG);
        match side {
            Side::Behind => bend.len() == 1 && total.abs() >= ABOUT_DEG || bend.len() == 2 && total.abs() >= ABOUT_DEG,
            _ if bend.len() == 1 => total >= motion::SLIGHT_DEG || total <= -motion::AROUND_DEG,
            _ => one_way && total >= BEND_DEG,
        }
    };
    let spans =
        (from..deg.len()).flat_map(|first| (first..(first + BEND_MOVES).min(deg.len())).map(move |last| (first, last)));
    spans.filter(|(first, last)| is_turn(*first, *last)).collect()
}
