//! Measures how much better an instruction would fit its walk after one small change, such as the other side for a
//! turn.
//!
//! A text with "left" where the walk turns right fits better with that one word changed. Only the known walk is
//! examined, so no graph is needed.

use crate::{building::KnownBuilding, guide::Guide, one_walk::OneWalk, weights::FeatureWeights};
use wayword_core::{ClimbDirection, Side};

/// A change of one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StepChangeKind {
    /// A turn to the other side.
    Turn,
    /// A turn left out.
    NoTurn,
    /// A place on the other side.
    Side,
    /// A climb the other way.
    Climb,
    /// A step left out.
    NoStep,
}

/// A change of one step, and its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepChange {
    /// The kind of change.
    pub kind: StepChangeKind,
    /// The step, by its number.
    pub step: usize,
    /// The byte range of the changed words: those of the turn, or of the whole step.
    pub span: [usize; 2],
    /// How much better the changed text fits the walk, in natural logs; negative where it fits worse.
    pub gain: f64,
}

/// The gains of all single changes for a walk, the highest first.
///
/// `walk` lists the viewpoints of the walk, and `heading_rad` is the direction of the walker at its start (radians from
/// +y, clockwise).
#[must_use]
pub fn rank_changes(
    guide: &Guide,
    building: &KnownBuilding,
    walk: &[usize],
    heading_rad: f64,
    weights: &FeatureWeights,
) -> Vec<StepChange> {
    let known = OneWalk::new(building, walk, heading_rad, weights);
    let as_told = known.score(guide);
    let mut changes: Vec<StepChange> = single_changes(guide)
        .into_iter()
        .map(|(kind, step, changed)| {
            let gain = known.score(&changed) - as_told;
            let told = &guide.steps[step].step;
            let turns = matches!(kind, StepChangeKind::Turn | StepChangeKind::NoTurn);
            let span = told.turn_span.filter(|_| turns).unwrap_or(told.span);
            StepChange { kind, step, span, gain: if gain.is_nan() { 0.0 } else { gain } }
        })
        .collect();
    changes.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.step.cmp(&b.step)));
    changes
}

/// The texts that differ from one by a turn to the other side.
#[must_use]
pub fn flip_turns(guide: &Guide) -> Vec<Guide> {
    single_changes(guide)
        .into_iter()
        .filter(|(kind, ..)| *kind == StepChangeKind::Turn)
        .map(|(_, _, changed)| changed)
        .collect()
}

/// The texts that differ from one by a single change.
fn single_changes(guide: &Guide) -> Vec<(StepChangeKind, usize, Guide)> {
    let mut variants = Vec::new();
    for (step, told) in guide.steps.iter().enumerate() {
        let mut add = |kind, change: &dyn Fn(&mut Guide)| {
            let mut changed = guide.clone();
            change(&mut changed);
            variants.push((kind, step, changed));
        };
        if let Some(side @ (Side::Left | Side::Right)) = told.step.turn {
            add(StepChangeKind::Turn, &|guide| guide.steps[step].step.turn = Some(other_side(side)));
        }
        if told.step.turn.is_some() {
            add(StepChangeKind::NoTurn, &|guide| guide.steps[step].leave_out_turn());
        }
        if told.step.turn.is_none() && (told.step.side.is_some() || told.mentions.iter().any(|at| at.side.is_some())) {
            add(StepChangeKind::Side, &|guide| guide.steps[step].change_sides(other_side));
        }
        if let Some(climb @ (ClimbDirection::Up | ClimbDirection::Down)) = told.step.climb {
            let opposite = if climb == ClimbDirection::Up { ClimbDirection::Down } else { ClimbDirection::Up };
            add(StepChangeKind::Climb, &|guide| guide.steps[step].step.climb = Some(opposite));
        }
        if guide.len() > 1 {
            add(StepChangeKind::NoStep, &|guide| {
                guide.steps.remove(step);
            });
        }
    }
    variants
}

fn other_side(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        side => side,
    }
}

#[cfg(test)]
mod tests;
