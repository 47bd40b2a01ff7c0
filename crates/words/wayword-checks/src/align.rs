//! Maps the statements of a text, in its order, to the frames and moves of the path.
//!
//! A place is mapped to a frame that shows it, a turn to a move that makes it, or to a bend of up to three moves. The
//! frames of places never go back. Each turn needs a move of its own, after the last move of the turn before. A turn
//! and the places around it must be near each other. The search goes through the text step by step and keeps every
//! state that can still win, so it fails only if no mapping fits.

use crate::evidence::Evidence;
use wayword_core::{Side, motion};

/// A statement of the text.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum AlignmentStep {
    /// A place, and the frames that show it, ascending.
    Place(Vec<usize>),
    /// A turn.
    Turn(Side),
    /// A statement without a place in the order.
    Free,
}

/// How far a text has got on the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct AlignmentProgress {
    /// The frame of its last place.
    place: usize,
    /// The frame of its last turn.
    turn: usize,
    /// The first move after that turn.
    next_move: usize,
}

/// One way to map the text up to a step. All the ways to map it up to the same step are a layer of the search.
#[derive(Debug, Clone, Copy)]
struct AlignmentState {
    /// How far the text has got.
    progress: AlignmentProgress,
    /// The index, in the layer before, of the state that this one continues.
    before: usize,
    /// The frame of the step; `None` for a step that needs none.
    frame: Option<usize>,
}

/// The frame of each step, where all of them can be mapped to the path; else the first step at which no mapping of the
/// steps before it can go on.
pub(super) fn align_steps(steps: &[AlignmentStep], evidence: &Evidence) -> Result<Vec<Option<usize>>, usize> {
    let bends = PathBends::from_evidence(evidence);
    let start =
        AlignmentState { progress: AlignmentProgress { place: 0, turn: 0, next_move: 0 }, before: 0, frame: None };
    let mut layers: Vec<Vec<AlignmentState>> = vec![vec![start]];
    for (at, step) in steps.iter().enumerate() {
        let now = layers.last().map_or(&[][..], Vec::as_slice);
        let next = now.iter().enumerate().flat_map(|(before, reached)| {
            states_after(reached.progress, step, &bends).into_iter().map(move |(state, frame)| AlignmentState {
                progress: state,
                before,
                frame,
            })
        });
        let next = drop_dominated(next.collect());
        if next.is_empty() {
            return Err(at);
        }
        layers.push(next);
    }
    let mut frames = vec![None; steps.len()];
    let mut at = 0;
    for (frame, layer) in frames.iter_mut().zip(&layers[1..]).rev() {
        if let Some(reached) = layer.get(at) {
            (*frame, at) = (reached.frame, reached.before);
        }
    }
    Ok(frames)
}

/// The states that no other one dominates, least first. A state dominates another where neither its place nor its turn
/// nor its next move is later.
///
/// Dropping a dominated state is safe. A step only asks for frames and moves that are not before these three numbers,
/// so whatever can follow the dominated state can follow the other one too, and the states that come of it dominate
/// again. However long the text and the path are, a handful of states is kept; all of them would be as many as the
/// square of the path's length.
fn drop_dominated(mut reached: Vec<AlignmentState>) -> Vec<AlignmentState> {
    // A state that dominates another one comes before it.
    reached.sort_by_key(|reached| reached.progress);
    let mut kept: Vec<AlignmentState> = Vec::new();
    for candidate in reached {
        let dominates = |other: &AlignmentState| {
            let (a, b) = (other.progress, candidate.progress);
            a.place <= b.place && a.turn <= b.turn && a.next_move <= b.next_move
        };
        if !kept.iter().any(dominates) {
            kept.push(candidate);
        }
    }
    kept
}

/// The states after a step, without most of those that another of them dominates.
fn states_after(
    state: AlignmentProgress,
    step: &AlignmentStep,
    bends: &PathBends,
) -> Vec<(AlignmentProgress, Option<usize>)> {
    match step {
        AlignmentStep::Free => vec![(state, None)],
        AlignmentStep::Place(frames) => {
            let first = frames.partition_point(|frame| *frame < state.place.max(state.turn));
            frames
                .get(first)
                .map(|frame| (AlignmentProgress { place: *frame, ..state }, Some(*frame)))
                .into_iter()
                .collect()
        }
        AlignmentStep::Turn(side) => {
            // A place that the text names before a turn may be a hop ahead, because it can be seen from the frame of
            // the turn.
            let from = state.next_move.max(state.place.saturating_sub(1));
            let turned =
                |(first, last): (usize, usize)| AlignmentProgress { turn: first, next_move: last + 1, ..state };
            bends.soonest_turns(*side, from).into_iter().map(|bend| (turned(bend), Some(bend.0))).collect()
        }
    }
}

/// The moves, and bends of moves, that turn: first and last move of each, ascending.
struct PathBends {
    left: Vec<(usize, usize)>,
    right: Vec<(usize, usize)>,
    around: Vec<(usize, usize)>,
}

impl PathBends {
    fn from_evidence(evidence: &Evidence) -> Self {
        let deg: Vec<f64> = evidence.moves.iter().map(|step| step.turn_rad.to_degrees()).collect();
        let turns_to = |side: Side| {
            let spans = (0..deg.len()).flat_map(|first| {
                (first..(first + motion::MAX_BEND_MOVES).min(deg.len())).map(move |last| (first, last))
            });
            spans.filter(|(first, last)| is_turn(side, &deg[*first..=*last])).collect()
        };
        Self { left: turns_to(Side::Left), right: turns_to(Side::Right), around: turns_to(Side::Behind) }
    }

    /// The turns to a side, from a move on, that begin before every other one has ended. A later turn never lets the
    /// text go farther.
    fn soonest_turns(&self, side: Side, from: usize) -> Vec<(usize, usize)> {
        let all = match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
            Side::Ahead | Side::Behind => &self.around,
        };
        let rest = &all[all.partition_point(|(first, _)| *first < from)..];
        // The bends ascend by their first move and have few moves, so the one that ends soonest is among the first few.
        let soonest_end =
            rest.iter().map(|(_, last)| *last).take(motion::MAX_BEND_MOVES * motion::MAX_BEND_MOVES).min();
        rest.iter().copied().take_while(|(first, _)| soonest_end.is_some_and(|end| *first <= end)).collect()
    }
}

/// Whether moves that turn by these degrees (positive right) make a turn to a side.
fn is_turn(side: Side, bend: &[f64]) -> bool {
    let sign = if side == Side::Left { -1.0 } else { 1.0 };
    let total = bend.iter().sum::<f64>() * sign;
    match (side, bend.len()) {
        (Side::Ahead | Side::Behind, moves) => moves <= 2 && total.abs() >= motion::AROUND_AT_LEAST_DEG,
        // A move that turns nearly around to the other side ends in almost the same direction.
        (_, 1) => total >= motion::SLIGHT_DEG || total <= -motion::AROUND_DEG,
        _ => total >= motion::BEND_DEG && bend.iter().all(|deg| deg * sign >= motion::BEND_STEP_DEG),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::EvidenceSource;
    use proptest::prelude::*;
    use std::time::{Duration, Instant};
    use wayword_core::{PathMotion, PathMove};

    fn walk(turns_deg: &[f64]) -> Evidence {
        let step = |deg: &f64| PathMove { turn_rad: deg.to_radians(), distance_m: 2.0, rise_m: 0.0 };
        let moves = turns_deg.iter().map(step).collect();
        Evidence {
            frames: Vec::new(),
            moves,
            motion: PathMotion::Known,
            source: EvidenceSource::Nothing,
            has_witnesses: false,
            beyond: crate::EndSurroundings::default(),
        }
    }

    /// Tries every mapping of the steps, without any bound.
    fn fits(steps: &[AlignmentStep], state: AlignmentProgress, turns_deg: &[f64]) -> bool {
        let Some((step, rest)) = steps.split_first() else { return true };
        let moves = turns_deg.len();
        match step {
            AlignmentStep::Free => fits(rest, state, turns_deg),
            AlignmentStep::Place(frames) => frames
                .iter()
                .filter(|frame| **frame >= state.place && **frame >= state.turn)
                .any(|frame| fits(rest, AlignmentProgress { place: *frame, ..state }, turns_deg)),
            AlignmentStep::Turn(side) => (state.next_move..moves)
                .flat_map(|first| (first..moves.min(first + motion::MAX_BEND_MOVES)).map(move |last| (first, last)))
                .filter(|(first, last)| first + 1 >= state.place && is_turn(*side, &turns_deg[*first..=*last]))
                .any(|(first, last)| {
                    fits(rest, AlignmentProgress { turn: first, next_move: last + 1, ..state }, turns_deg)
                }),
        }
    }

    fn step() -> impl Strategy<Value = AlignmentStep> {
        prop_oneof![
            prop::collection::btree_set(0..6_usize, 1..4)
                .prop_map(|frames| AlignmentStep::Place(frames.into_iter().collect())),
            prop_oneof![Just(Side::Left), Just(Side::Right), Just(Side::Behind)].prop_map(AlignmentStep::Turn),
            Just(AlignmentStep::Free),
        ]
    }

    proptest! {
        #[test]
        fn dropped_states_could_not_have_gone_farther(
            steps in prop::collection::vec(step(), 0..6),
            turns in prop::collection::vec(prop_oneof![Just(0.0), Just(20.0), Just(-40.0), Just(70.0), Just(170.0)], 0..6),
        ) {
            let start = AlignmentProgress { place: 0, turn: 0, next_move: 0 };
            let laid = align_steps(&steps, &walk(&turns));
            prop_assert_eq!(laid.is_ok(), fits(&steps, start, &turns));
            let upto = laid.err().unwrap_or(steps.len());
            prop_assert!(fits(&steps[..upto], start, &turns));
        }
    }

    #[test]
    fn a_long_text_about_a_long_walk_back_and_forth_takes_no_time() {
        let began = Instant::now();
        let back_and_forth: Vec<f64> = (0..999).map(|at| if at % 2 == 0 { 180.0 } else { -90.0 }).collect();
        let steps =
            [AlignmentStep::Place((0..1000).collect()), AlignmentStep::Turn(Side::Left)].into_iter().cycle().take(1400);
        let steps: Vec<AlignmentStep> = steps.collect();
        assert!(align_steps(&steps, &walk(&back_and_forth)).is_ok_and(|frames| frames.iter().all(Option::is_some)));
        assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
    }

    fn places(frames: &[usize]) -> AlignmentStep {
        AlignmentStep::Place(frames.to_vec())
    }

    #[test]
    fn align_steps_gives_the_first_frame_that_fits_each_step() {
        let turn = AlignmentStep::Turn;
        let steps = [places(&[1, 4]), turn(Side::Right), AlignmentStep::Free, places(&[0, 3])];
        let path = walk(&[0.0, 0.0, 90.0, 0.0]);
        assert_eq!(align_steps(&steps, &path), Ok(vec![Some(1), Some(2), None, Some(3)]));
        assert_eq!(align_steps(&[places(&[2]), places(&[1])], &path), Err(1));
        assert_eq!(align_steps(&[places(&[1]), turn(Side::Left), places(&[2])], &path), Err(1));
        assert_eq!(align_steps(&[], &path), Ok(vec![]));
        // The later frame is taken where the earlier one leaves no way on.
        assert_eq!(
            align_steps(&[places(&[0]), turn(Side::Right), places(&[2, 3])], &path),
            Ok(vec![Some(0), Some(2), Some(2)])
        );
    }

    #[test]
    fn a_place_may_be_one_hop_ahead_of_the_turn_and_no_more() {
        let steps = |place: usize| [places(&[place]), AlignmentStep::Turn(Side::Right)];
        let path = walk(&[0.0, 90.0, 0.0, 0.0]);
        assert_eq!(align_steps(&steps(2), &path), Ok(vec![Some(2), Some(1)]));
        assert_eq!(align_steps(&steps(3), &path), Err(1));
        // A place behind a turn is not before the frame of the turn.
        let behind = |place: usize| [AlignmentStep::Turn(Side::Right), places(&[place])];
        assert_eq!(align_steps(&behind(1), &path), Ok(vec![Some(1), Some(1)]));
        assert_eq!(align_steps(&behind(0), &path), Err(1));
    }

    #[test]
    fn each_turn_takes_its_moves_away_from_the_next() {
        let twice = [AlignmentStep::Turn(Side::Right), AlignmentStep::Turn(Side::Right)];
        assert_eq!(align_steps(&twice, &walk(&[90.0, 90.0])), Ok(vec![Some(0), Some(1)]));
        assert_eq!(align_steps(&twice, &walk(&[90.0, 0.0])), Err(1));
        // A bend of two moves is one turn.
        assert_eq!(align_steps(&twice, &walk(&[29.0, 35.0])), Err(1));
    }

    #[test]
    fn is_turn_has_these_limits() {
        for (side, sign) in [(Side::Right, 1.0), (Side::Left, -1.0)] {
            let turns = |bend: &[f64]| is_turn(side, &bend.iter().map(|deg| deg * sign).collect::<Vec<_>>());
            assert!(turns(&[30.0]) && !turns(&[29.9]) && turns(&[180.0]));
            // Nearly around to the other side ends up the same way.
            assert!(turns(&[-150.0]) && !turns(&[-149.9]));
            assert!(turns(&[30.0, 30.0]) && !turns(&[30.0, 29.9]));
            assert!(turns(&[10.0, 40.0, 10.0]) && !turns(&[9.9, 40.0, 20.0]));
            assert!(!turns(&[-10.0, 80.0]) && !turns(&[-40.0, -40.0]));
        }
        for side in [Side::Ahead, Side::Behind] {
            assert!(is_turn(side, &[120.0]) && is_turn(side, &[-120.0]) && !is_turn(side, &[119.9]));
            assert!(
                is_turn(side, &[60.0, 60.0]) && !is_turn(side, &[40.0, 40.0, 40.0]) && !is_turn(side, &[60.0, -60.0])
            );
        }
    }
}
