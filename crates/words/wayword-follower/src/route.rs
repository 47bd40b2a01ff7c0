//! Compares an instruction with the walk that it was written for: finds wrong steps, and checks whether the text leads
//! elsewhere.

use crate::{
    building::KnownBuilding,
    change::{StepChange, StepChangeKind, rank_changes},
    fit::WalkFit,
    guide::{Guide, GuideTrial},
    posterior::walk_shares,
    swap::{PlaceSwap, best_swap},
    tree::{WalkPrior, WalkTree},
    weights::FeatureWeights,
};
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, Side, Verdict};

/// A known walk, from a dataset or of a robot.
#[derive(Debug, Clone, Copy)]
pub struct KnownWalk<'a> {
    /// Its building.
    pub building: &'a KnownBuilding,
    /// Its viewpoints.
    pub walk: &'a [usize],
    /// The walker's first direction, radians from +y clockwise.
    pub heading_rad: f64,
}

impl KnownWalk<'_> {
    /// The gains of all single changes of a text for this walk.
    fn walk_changes(&self, guide: &Guide, weights: &FeatureWeights) -> Vec<StepChange> {
        rank_changes(guide, self.building, self.walk, self.heading_rad, weights)
    }
}

/// Least gain from which a change of a step is taken for an error of the text, natural logs. `wayword-measure
/// fit-follower` prints the share of people's texts that gain more: 1.8 % by a turn to the other side, and .1 to .3 %
/// by each of the others. In other buildings, it is about a third more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainThresholds {
    /// Of a turn to the other side.
    pub turn: f64,
    /// Of a turn left out.
    pub no_turn: f64,
    /// Of a climb the other way.
    pub climb: f64,
    /// Of two swapped places.
    pub swap: f64,
    /// How much better another walk has to fit.
    pub route: f64,
}

impl Default for GainThresholds {
    fn default() -> Self {
        Self { turn: 2.4, no_turn: 4.1, climb: 0.2, swap: 3.0, route: 6.0 }
    }
}

/// The result of comparing an instruction with its walk alone.
#[derive(Debug, Clone, PartialEq)]
pub struct WalkJudgement {
    /// The wrong steps; empty if there is none, and if the text has too many steps.
    pub wrong: Vec<CheckFinding>,
    /// The gain of the best change of a turn, natural logs: the higher, the likelier the text has a wrong turn. `None`
    /// if it has no turn.
    pub turn_gain: Option<f64>,
}

/// The reason why a text is not compared with other walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnfollowedReason {
    /// Only the walk itself is known. Its turns are still checked.
    NoGraph,
    /// The work grows with the square of the steps.
    TooManySteps,
    /// The walk has more hops than all steps together can lead, because a step leads a few hops at most.
    TooFewSteps,
}

impl UnfollowedReason {
    /// The reason, in words.
    #[must_use]
    pub fn reason_words(self) -> &'static str {
        match self {
            Self::NoGraph => "no viewpoint graph is known on which it lies, so no other walk is",
            Self::TooManySteps => "the text has too many steps",
            Self::TooFewSteps => "the path has more hops than the steps of the text can lead",
        }
    }
}

/// Most steps of a text that is followed; a longer text is not judged. People's texts have 20 at most.
pub(crate) const MAX_FOLLOWED_STEPS: usize = 60;

/// The comparison of an instruction with all walks from the same start.
#[derive(Debug, Clone, PartialEq)]
pub struct RouteVerdict {
    /// The finding for the report of checks.
    pub finding: CheckFinding,
    /// The share of the known walk: how likely it is that the text means it.
    pub share: f64,
    /// The share of the likeliest other walk.
    pub other: f64,
    /// The end viewpoints of walks that fit about as well as the known one, its own first: one of each group of close
    /// viewpoints.
    pub ends: Vec<usize>,
}

/// Ends that are at least this far apart count as different, metres: success on R2R is to stop nearer than this.
const APART_M: f64 = 3.0;
/// Another walk fits about as well as the known one if its share is at least this fraction of the known walk's share. Of
/// people's texts in R2R's train split that the follower takes to the right place, 5 % have a second place that near to the
/// best (15 % at a half); of those that it takes to a wrong one, 21 % (50 %): `wayword-measure reader-figures`.
const AS_WELL_FRACTION: f64 = 0.8;

/// Judges an instruction by the walk that it was written for.
#[must_use]
pub fn judge_steps(
    guide: &Guide,
    known: KnownWalk<'_>,
    weights: &FeatureWeights,
    thresholds: GainThresholds,
) -> WalkJudgement {
    if guide.len() > MAX_FOLLOWED_STEPS {
        return WalkJudgement { wrong: Vec::new(), turn_gain: None };
    }
    let changes = known.walk_changes(guide, weights);
    let turn_gain = changes.iter().find(|change| change.kind == StepChangeKind::Turn).map(|change| change.gain);
    let mut wrong = wrong_steps(guide, &changes, thresholds);
    let swap = best_swap(guide, known.building, known.walk, known.heading_rad, weights);
    wrong.extend(swap.filter(|swap| swap.gain > thresholds.swap).map(wrong_order));
    WalkJudgement { wrong, turn_gain }
}

/// The steps that one change would make fit much better, each with one finding.
fn wrong_steps(guide: &Guide, changes: &[StepChange], thresholds: GainThresholds) -> Vec<CheckFinding> {
    let mut found: Vec<(usize, CheckFinding)> = Vec::new();
    for change in changes {
        let step = &guide.steps[change.step].step;
        let wrong = match (change.kind, step.turn, step.climb) {
            (StepChangeKind::Turn, Some(side), _) if change.gain > thresholds.turn => {
                let (told, real) = if side == Side::Left { ("left", "right") } else { ("right", "left") };
                Some((CheckKind::Turns, format!("the path turns {real} here, and not {told}")))
            }
            (StepChangeKind::NoTurn, Some(_), _) if change.gain > thresholds.no_turn => {
                Some((CheckKind::Turns, "the path does not turn like this here".to_owned()))
            }
            (StepChangeKind::Climb, _, Some(climb)) if change.gain > thresholds.climb => {
                let (told, real) = if climb == ClimbDirection::Up { ("up", "down") } else { ("down", "up") };
                Some((CheckKind::Floors, format!("the path goes {real} here, and not {told}")))
            }
            _ => None,
        };
        if let Some((check, reason)) = wrong.filter(|_| found.iter().all(|(step, _)| *step != change.step)) {
            found.push((change.step, CheckFinding { check, verdict: Verdict::Fail, reason, span: Some(change.span) }));
        }
    }
    found.sort_by_key(|(step, _)| *step);
    found.into_iter().map(|(_, finding)| finding).collect()
}

/// The finding for two places that the text names in the wrong order.
fn wrong_order(swap: PlaceSwap) -> CheckFinding {
    let PlaceSwap { names: [first, second], spans, .. } = swap;
    let reason = format!(
        "the path fits much better if {second:?} stands where the text says {first:?}, and the other way round"
    );
    CheckFinding { check: CheckKind::Order, verdict: Verdict::Fail, reason, span: Some(spans[0]) }
}

/// The walks from one start, and how likely an instruction means each.
struct WalkPosterior {
    tree: WalkTree,
    /// The known walk's number in the tree.
    own: usize,
    /// For each walk, the probability that the text means it.
    shares: Vec<f64>,
}

impl WalkPosterior {
    fn for_guide(
        guide: &Guide,
        known: KnownWalk<'_>,
        prior: Option<WalkPrior>,
        weights: &FeatureWeights,
    ) -> Result<Self, UnfollowedReason> {
        if guide.len() > MAX_FOLLOWED_STEPS {
            return Err(UnfollowedReason::TooManySteps);
        }
        let prior = prior.ok_or(UnfollowedReason::NoGraph)?;
        let start = known.walk.first().copied().unwrap_or_default();
        let mut tree = WalkTree::from_prior(known.building, start, known.heading_rad, prior);
        let own = tree.add_walk(known.building, known.walk);
        let fit = WalkFit::new(&GuideTrial::new(guide, known.building), &tree, weights);
        if !fit.score(own).is_finite() {
            return Err(UnfollowedReason::TooFewSteps);
        }
        let shares = walk_shares(&fit, &tree);
        Ok(Self { tree, own, shares })
    }

    /// Whether two walks end at different places.
    fn are_apart(&self, building: &KnownBuilding, a: usize, b: usize) -> bool {
        let position = |walk: usize| building.viewpoints[self.tree.end_viewpoint(walk)].position;
        position(a).distance(position(b)) >= APART_M
    }

    /// The walks that end elsewhere than the known one.
    fn walks_elsewhere(&self, building: &KnownBuilding) -> Vec<usize> {
        (1..self.tree.len()).filter(|walk| self.are_apart(building, *walk, self.own)).collect()
    }
}

/// The probability, from 0 to 1, that an instruction leads to the end of its walk or within 3 m of it.
///
/// # Errors
/// With the reason, if this cannot be decided.
pub fn goal_probability(
    guide: &Guide,
    known: KnownWalk<'_>,
    prior: Option<WalkPrior>,
    weights: &FeatureWeights,
) -> Result<f64, UnfollowedReason> {
    let posterior = WalkPosterior::for_guide(guide, known, prior, weights)?;
    let elsewhere: f64 = posterior.walks_elsewhere(known.building).into_iter().map(|walk| posterior.shares[walk]).sum();
    Ok((1.0 - elsewhere).clamp(0.0, 1.0))
}

/// Checks whether an instruction leads elsewhere than the walk that it was written for. `prior` selects the other walks
/// that are considered; `None` if the graph is unknown.
///
/// # Errors
/// With the reason, if this cannot be decided.
pub fn judge_route(
    guide: &Guide,
    known: KnownWalk<'_>,
    prior: Option<WalkPrior>,
    weights: &FeatureWeights,
    thresholds: GainThresholds,
) -> Result<RouteVerdict, UnfollowedReason> {
    let posterior = WalkPosterior::for_guide(guide, known, prior, weights)?;
    let WalkPosterior { tree, own, shares } = &posterior;
    let share = shares[*own];
    let mut walks = posterior.walks_elsewhere(known.building);
    walks.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
    let other = walks.first().map_or(0.0, |walk| shares[*walk]);
    let mut ends = vec![*own];
    for walk in walks {
        let is_new = ends.iter().all(|end| posterior.are_apart(known.building, *end, walk));
        if shares[walk] >= AS_WELL_FRACTION * share && is_new {
            ends.push(walk);
        }
    }
    let gain = (other / share.max(f64::MIN_POSITIVE)).ln();
    let leads_elsewhere = gain > thresholds.route;
    let finding = CheckFinding {
        check: CheckKind::Route,
        verdict: if leads_elsewhere { Verdict::Fail } else { Verdict::Pass },
        reason: if leads_elsewhere {
            "the text leads elsewhere: another walk fits it much better".into()
        } else {
            String::new()
        },
        span: if leads_elsewhere { fault_span(&known.walk_changes(guide, weights)) } else { None },
    };
    let ends = ends.into_iter().map(|walk| tree.end_viewpoint(walk)).collect();
    Ok(RouteVerdict { finding, share, other, ends })
}

/// The byte range of the change with the highest gain, if that is positive.
fn fault_span(changes: &[StepChange]) -> Option<[usize; 2]> {
    changes.first().filter(|change| change.gain > 0.0).map(|change| change.span)
}

#[cfg(test)]
mod tests;
