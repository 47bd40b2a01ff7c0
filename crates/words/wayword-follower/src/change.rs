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
    let base_score = known.score(guide);
    let mut changes: Vec<StepChange> = single_changes(guide)
        .into_iter()
        .map(|(kind, step, changed)| {
            let gain = known.score(&changed) - base_score;
            let described = &guide.steps[step].step;
            let is_turn = matches!(kind, StepChangeKind::Turn | StepChangeKind::NoTurn);
            let span = described.turn_span.filter(|_| is_turn).unwrap_or(described.span);
            StepChange { kind, step, span, gain: if gain.is_nan() { 0.0 } else { gain } }
        })
        .collect();
    changes.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.step.cmp(&b.step)));
    changes
}

/// The texts that differ from a text by one turn to the other side.
#[must_use]
pub fn flip_turns(guide: &Guide) -> Vec<Guide> {
    single_changes(guide)
        .into_iter()
        .filter(|(kind, ..)| *kind == StepChangeKind::Turn)
        .map(|(_, _, changed)| changed)
        .collect()
}

/// All texts that differ from a text by a single change of one step, with the kind of change and the step's number.
fn single_changes(guide: &Guide) -> Vec<(StepChangeKind, usize, Guide)> {
    let mut variants = Vec::new();
    for (step, guide_step) in guide.steps.iter().enumerate() {
        let mut add = |kind, change: &dyn Fn(&mut Guide)| {
            let mut changed = guide.clone();
            change(&mut changed);
            variants.push((kind, step, changed));
        };
        if let Some(side @ (Side::Left | Side::Right)) = guide_step.step.turn {
            add(StepChangeKind::Turn, &|guide| guide.steps[step].step.turn = Some(other_side(side)));
        }
        if guide_step.step.turn.is_some() {
            add(StepChangeKind::NoTurn, &|guide| guide.steps[step].leave_out_turn());
        }
        if guide_step.step.turn.is_none()
            && (guide_step.step.side.is_some() || guide_step.mentions.iter().any(|mention| mention.side.is_some()))
        {
            add(StepChangeKind::Side, &|guide| guide.steps[step].change_sides(other_side));
        }
        if let Some(climb @ (ClimbDirection::Up | ClimbDirection::Down)) = guide_step.step.climb {
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

/// Right for left, and left for right; other sides stay.
fn other_side(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        side => side,
    }
}

#[cfg(test)]
mod tests;
