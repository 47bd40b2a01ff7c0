//! Features of a step over a stretch of a walk: its length, turns, stairs, doors and marking words.

use super::{
    FeatureNumber, angle_class, angle_twelfth, limit_class,
    tables::{
        ANGLES, BORDER, CONDITION, CROSSING_ENDS, CROSSINGS, FIRST_TURN, HOPS, HOPS_CLASSES, HOPS_OF_MENTIONS,
        HOPS_OF_STEPS, LATER_TURNS, LENGTH, LEVEL, LEVEL_RISE, LEVELS, MARK_CROSSINGS, MARK_HOPS, MARK_TURN, MARKS,
        NEXT_STEP, ONWARD, OPENING_TURN, RISE, SAME_ROOM, SIDE_OF_TURN, SKIPPED, SQUARER, STAIRS_AT, STOPS, STRAIGHTER,
        TURN_AFTER_OPENING, TURN_BEFORE, WHOLE_TURN, WIDEST_TURN,
    },
};
use crate::{
    building::wrap_angle,
    building_parts::BuildingViewpoint,
    guide::{GuideStep, GuideStepKind, GuideTrial},
    tree::WalkTree,
};
use wayword_core::{ClimbDirection, Side};
use wayword_language::reading::steps::{StepRelation, StepStairs};

/// Most hops of a step. A walk on which a step would have to lead farther does not fit at all.
pub(crate) const MAX_STEP_HOPS: usize = 8;
/// Turns of at least this angle are more than a bend of a corridor, radians.
const CLEAR_TURN_RAD: f64 = 0.7;

/// The nodes of a walk that a step takes: from where it begins to where it ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WalkStretch<'a> {
    pub(crate) tree: &'a WalkTree,
    /// The first `hops + 1` entries are the nodes of the stretch, in the order of the walk.
    nodes: [usize; MAX_STEP_HOPS + 1],
    pub(crate) hops: usize,
}

impl<'a> WalkStretch<'a> {
    /// The stretch of `hops` hops, [`MAX_STEP_HOPS`] at most, that ends at a node.
    pub(crate) fn to_node(tree: &'a WalkTree, end: usize, hops: usize) -> Self {
        let mut nodes = [end; MAX_STEP_HOPS + 1];
        for at in (0..hops).rev() {
            nodes[at] = tree.nodes[nodes[at + 1]].before;
            if at + 1 == hops {
                nodes[at] = tree.nodes[end].before;
            }
        }
        Self { tree, nodes, hops }
    }

    /// The nodes of the tree, the first being where the step before has ended.
    pub(crate) fn nodes(&self) -> &[usize] {
        &self.nodes[..=self.hops]
    }

    pub(crate) fn first_node(&self) -> usize {
        self.nodes[0]
    }

    pub(crate) fn last_node(&self) -> usize {
        self.nodes[self.hops]
    }

    /// The turns before its hops, radians.
    fn hop_turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes()[1..].iter().map(|at| self.tree.nodes[*at].turn_rad)
    }

    /// Whether it begins where the walk does. Its first turn is then the walk's opening turn, which people often leave
    /// out.
    fn opens_walk(&self) -> bool {
        self.first_node() == 0 && self.hops > 0
    }

    /// All its turns together but the opening turn, radians.
    fn bend_rad(&self) -> f64 {
        wrap_angle(self.hop_turns().skip(usize::from(self.opens_walk())).sum())
    }
}

/// Adds to `found` those features of a step of the text over a stretch that do not depend on places that the step names.
pub(super) fn motion_features(
    trial: &GuideTrial<'_>,
    step: usize,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    let guide_step = &trial.guide.steps[step];
    let is_last = step + 1 == trial.guide.len();
    length_features(guide_step, is_last, stretch, found);
    context_features(trial, step, stretch, found);
    turn_features(guide_step, stretch, found);
    let viewpoint = |node: usize| &trial.building.viewpoints[stretch.tree.nodes[node].viewpoint];
    let (first, last) = (viewpoint(stretch.first_node()), viewpoint(stretch.last_node()));
    rise_features(guide_step, last.position.z - first.position.z, found);
    stairs_features(guide_step, [first, last], found);
    level_features(trial, guide_step, [viewpoint(0), last], found);
    let crossings =
        stretch.nodes().windows(2).filter(|pair| viewpoint(pair[0]).room != viewpoint(pair[1]).room).count();
    if stretch.hops > 0 {
        let crosses = |at: usize| {
            let pair = [stretch.nodes()[at], stretch.nodes()[at + 1]].map(viewpoint);
            (usize::from(pair[0].room != pair[1].room), 2)
        };
        let ends = [crosses(0), crosses(stretch.hops - 1)];
        let is_long = (usize::from(stretch.hops > 1), 2);
        found.push(CROSSING_ENDS.feature_at([
            (guide_step.step.door as usize, 4),
            (usize::from(is_last), 2),
            is_long,
            ends[0],
            ends[1],
        ]));
    }
    crossing_features(trial, guide_step, is_last, [first, last], crossings, found);
    onward_features(guide_step, stretch, found);
    let bend = limit_class(stretch.bend_rad().abs().to_degrees(), &[20.0, 50.0, 100.0]);
    for mark in &guide_step.step.marks {
        found.push(MARK_HOPS.feature_at([(*mark, MARKS), (stretch.hops.min(4), 5)]));
        found.push(MARK_CROSSINGS.feature_at([(*mark, MARKS), (crossings.min(2), 3)]));
        if stretch.hops > 0 {
            found.push(MARK_TURN.feature_at([(*mark, MARKS), (bend, 4)]));
        }
    }
}

/// How many hops and metres the stretch has.
fn length_features(guide_step: &GuideStep, is_last: bool, stretch: &WalkStretch<'_>, found: &mut Vec<FeatureNumber>) {
    let kind = (guide_step.kind as usize, GuideStepKind::COUNT);
    let hops = (stretch.hops.min(HOPS_CLASSES - 1), HOPS_CLASSES);
    let is_last = (usize::from(is_last), 2);
    found.push(HOPS.feature_at([kind, is_last, hops]));
    if guide_step.step.stops {
        found.push(STOPS.feature_at([is_last, (usize::from(guide_step.step.turn.is_some()), 2), hops]));
    }
    if guide_step.step.is_condition {
        found.push(CONDITION.feature_at([is_last, hops]));
    }
    let length_m: f64 = stretch.nodes()[1..].iter().map(|at| stretch.tree.nodes[*at].length_m).sum();
    found.push(LENGTH.feature_at([kind, (limit_class(length_m, &[0.1, 1.5, 3.0, 5.0, 7.0, 10.0, 14.0]), 8)]));
}

/// The context of the step: the other steps of its text, and the ways that it does not take.
fn context_features(trial: &GuideTrial<'_>, step: usize, stretch: &WalkStretch<'_>, found: &mut Vec<FeatureNumber>) {
    let steps = &trial.guide.steps;
    let kind = (steps[step].kind as usize, GuideStepKind::COUNT);
    let next = steps.get(step + 1);
    let is_last = (usize::from(next.is_none()), 2);
    let step_count = (limit_class(steps.len() as f64, &[3.0, 5.0]), 3);
    found.push(HOPS_OF_STEPS.feature_at([
        step_count,
        kind,
        is_last,
        (stretch.hops.min(HOPS_CLASSES - 1), HOPS_CLASSES),
    ]));
    if let Some(next) = next {
        found.push(NEXT_STEP.feature_at([kind, (next.kind as usize, GuideStepKind::COUNT), (stretch.hops.min(4), 5)]));
    }
    let mentions = (trial.guide.steps[step].mentions.len().min(3), 4);
    found.push(HOPS_OF_MENTIONS.feature_at([kind, is_last, mentions, (stretch.hops.min(4), 5)]));
    // "Turn left and walk on": the hop that turns may be the next step's.
    let before = step.checked_sub(1).map(|before| &steps[before]).filter(|before| describes_turn(before));
    if let (Some(before), Some(turn_rad)) = (before, stretch.hop_turns().next()) {
        let sign = if before.step.turn == Some(Side::Left) { -1.0 } else { 1.0 };
        let opens = (usize::from(stretch.opens_walk()), 2);
        found.push(TURN_BEFORE.feature_at([
            ((before.kind as usize).min(2), 3),
            opens,
            (angle_class(turn_rad * sign), ANGLES),
        ]));
    }
    let ways = |node: &usize| stretch.tree.nodes[*node].ways;
    if stretch.hops > 0 && !stretch.opens_walk() {
        found.push(SQUARER.feature_at([kind, (ways(&stretch.nodes()[1]).squarer.min(2), 3)]));
    }
    let skip = if describes_turn(&steps[step]) || stretch.opens_walk() { 2 } else { 1 };
    if stretch.hops >= skip {
        let straighter = stretch.nodes()[skip..].iter().filter(|node| ways(node).straighter > 0).count();
        found.push(STRAIGHTER.feature_at([kind, (straighter.min(2), 3)]));
    }
    // "Walk on and turn left": the ways to the left that are passed before were not meant.
    let side = match next.and_then(|next| next.step.turn) {
        Some(Side::Left) => Some(0),
        Some(Side::Right) => Some(1),
        _ => None,
    };
    if let Some(side) = side {
        let passed = stretch.nodes().iter().take(stretch.hops).skip(1).filter(|node| ways(node).aside[side]).count();
        let is_here = usize::from(ways(&stretch.last_node()).aside[side]);
        let here = if stretch.hops == 0 { 2 } else { is_here };
        found.push(SKIPPED.feature_at([kind, (passed.min(2), 3), (here, 3)]));
    }
}

/// Whether a step describes a turn.
fn describes_turn(guide_step: &GuideStep) -> bool {
    guide_step.step.turn.is_some()
}

/// The storey where the stretch ends, if the text gives one.
fn level_features(
    trial: &GuideTrial<'_>,
    guide_step: &GuideStep,
    [start, last]: [&BuildingViewpoint; 2],
    found: &mut Vec<FeatureNumber>,
) {
    let which = match (guide_step.step.floor, guide_step.step.storey) {
        (Some(floor), _) => floor.number.map_or(3, |number| (number as usize).clamp(1, 4) - 1),
        (None, Some(ClimbDirection::Up)) => 4,
        (None, Some(ClimbDirection::Down)) => 5,
        _ => return,
    };
    let which = (which, LEVELS);
    if let Some(level) = last.level {
        let most = trial.building.levels.clamp(1, 3) as usize - 1;
        found.push(LEVEL.feature_at([which, (level.clamp(1, 4) as usize - 1, 4), (most, 3)]));
    }
    let rise = limit_class(last.position.z - start.position.z, &[-4.0, -1.8, -0.6, 0.6, 1.8, 4.0]);
    found.push(LEVEL_RISE.feature_at([which, (rise, 7)]));
}

/// How far the walk turns on the stretch, by the side that the text gives.
fn turn_features(guide_step: &GuideStep, stretch: &WalkStretch<'_>, found: &mut Vec<FeatureNumber>) {
    if stretch.hops > 0 {
        let kind = (guide_step.kind as usize, GuideStepKind::COUNT);
        // Mirrored so that a turn to the side in the text is positive; without a side, only the size counts.
        let told_rad = |rad: f64| match guide_step.step.turn {
            Some(Side::Left) => -rad,
            Some(Side::Right) => rad,
            _ => rad.abs(),
        };
        let mut at = |table: &super::tables::FeatureTable, rad: f64| {
            found.push(table.feature_at([kind, (angle_class(told_rad(wrap_angle(rad))), ANGLES)]));
        };
        let opens = stretch.opens_walk();
        if opens {
            at(&OPENING_TURN, stretch.hop_turns().sum());
            at(&TURN_AFTER_OPENING, stretch.bend_rad());
        } else {
            at(&FIRST_TURN, stretch.hop_turns().next().unwrap_or_default());
            at(&WHOLE_TURN, stretch.bend_rad());
        }
        if stretch.hops > 1 {
            let widest = stretch.hop_turns().skip(usize::from(opens)).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            at(&WIDEST_TURN, widest.unwrap_or_default());
            let later = stretch.hop_turns().skip(1).filter(|rad| rad.abs() > CLEAR_TURN_RAD).count();
            found.push(LATER_TURNS.feature_at([kind, (later.min(2), 3)]));
        }
    }
    // "The door on your left": the way there bends to that side.
    if let Some((relation, side)) = guide_step.step.side.filter(|_| stretch.hops > 0) {
        let group = match relation {
            StepRelation::Into | StepRelation::Through => 0,
            StepRelation::To | StepRelation::Along => 1,
            StepRelation::Past | StepRelation::With => 2,
            _ => 3,
        };
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        found.push(SIDE_OF_TURN.feature_at([(group, 4), (angle_twelfth(stretch.bend_rad() * sign), 12)]));
    }
}

/// How far the stretch leads up, or down if the text describes a climb down.
fn rise_features(guide_step: &GuideStep, rise_m: f64, found: &mut Vec<FeatureNumber>) {
    // The first value is 0 for a step that describes a climb, and 1 for any other.
    let (climb_class, rise_m) = match guide_step.step.climb {
        Some(ClimbDirection::Up) => (0, rise_m),
        Some(ClimbDirection::Down) => (0, -rise_m),
        _ => (1, rise_m.abs()),
    };
    let class = limit_class(rise_m, &[-3.0, -2.0, -1.0, -0.5, -0.15, 0.15, 0.5, 1.0, 2.0, 3.0]);
    found.push(RISE.feature_at([(climb_class, 2), (class, 11)]));
}

/// Whether ways up or down begin where the stretch begins and ends, for a step that names stairs.
fn stairs_features(guide_step: &GuideStep, ends: [&BuildingViewpoint; 2], found: &mut Vec<FeatureNumber>) {
    let part = match guide_step.step.stairs {
        StepStairs::None => return,
        StepStairs::Named => 0,
        StepStairs::Top => 1,
        StepStairs::Bottom => 2,
    };
    for (at, viewpoint) in ends.iter().enumerate() {
        let ways = usize::from(viewpoint.climbs[0]) * 2 + usize::from(viewpoint.climbs[1]);
        let climbs = (usize::from(guide_step.step.climb.is_some()), 2);
        found.push(STAIRS_AT.feature_at([(part, 3), climbs, (at, 2), (ways, 4)]));
    }
}

/// How often the stretch changes rooms, and whether other rooms are next to its end.
fn crossing_features(
    trial: &GuideTrial<'_>,
    guide_step: &GuideStep,
    is_last: bool,
    [first, last]: [&BuildingViewpoint; 2],
    crossings: usize,
    found: &mut Vec<FeatureNumber>,
) {
    let door = (guide_step.step.door as usize, 4);
    found.push(CROSSINGS.feature_at([door, (crossings.min(3), 4)]));
    found.push(
        SAME_ROOM
            .feature_at([(guide_step.kind as usize, GuideStepKind::COUNT), (usize::from(first.room == last.room), 2)]),
    );
    let room = |at: &usize| &trial.building.viewpoints[*at].room;
    let border = last.neighbours.iter().filter(|at| *room(at) != last.room).count();
    found.push(BORDER.feature_at([door, (usize::from(is_last), 2), (border.min(2), 3)]));
}

/// Whether the walk could go straight on from the end.
fn onward_features(guide_step: &GuideStep, stretch: &WalkStretch<'_>, found: &mut Vec<FeatureNumber>) {
    let goes_on = usize::from(stretch.tree.nodes[stretch.last_node()].ways.onward);
    let kind = (guide_step.kind as usize, GuideStepKind::COUNT);
    found.push(ONWARD.feature_at([kind, (usize::from(guide_step.step.at_end), 2), (goes_on, 2)]));
}
