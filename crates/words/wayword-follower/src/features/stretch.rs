//! Features of a step over a stretch of a walk: its length, turns, stairs, doors and marking words.

use super::{
    Feature, angle, class, places,
    tables::{
        ANGLES, BORDER, CONDITION, CROSSING_ENDS, CROSSINGS, FIRST_TURN, HOPS, HOPS_CLASSES, HOPS_OF_MENTIONS,
        HOPS_OF_STEPS, LATER_TURNS, LENGTH, LEVEL, LEVEL_RISE, LEVELS, MARK_CROSSINGS, MARK_HOPS, MARK_TURN, MARKS,
        NEXT_STEP, ONWARD, OPENING_TURN, RISE, SAME_ROOM, SIDE_OF_TURN, SKIPPED, SQUARER, STAIRS_AT, STOPS, STRAIGHTER,
        TURN_AFTER_OPENING, TURN_BEFORE, WHOLE_TURN, WIDEST_TURN,
    },
    twelfth,
};
use crate::{
    building::{Viewpoint, wrapped},
    guide::{Kind, Told, Trial},
    tree::Tree,
};
use wayword_core::{Climb, Side};
use wayword_language::reading::steps::{Relation, Stairs};

/// Most hops of a step.
pub(crate) const MOST_HOPS: usize = 8;
/// Turns of at least this angle are more than a bend of a corridor, radians.
const CLEAR_TURN_RAD: f64 = 0.7;

/// The nodes of a walk that a step takes: from where it begins to where it ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch<'a> {
    pub(crate) tree: &'a Tree,
    nodes: [usize; MOST_HOPS + 1],
    pub(crate) hops: usize,
}

impl<'a> Stretch<'a> {
    /// The stretch of `hops` hops, [`MOST_HOPS`] at most, that ends at a node.
    pub(crate) fn to(tree: &'a Tree, end: usize, hops: usize) -> Self {
        let mut nodes = [end; MOST_HOPS + 1];
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

    pub(crate) fn first(&self) -> usize {
        self.nodes[0]
    }

    pub(crate) fn last(&self) -> usize {
        self.nodes[self.hops]
    }

    /// The turns before its hops, radians.
    fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.nodes()[1..].iter().map(|at| self.tree.nodes[*at].turn_rad)
    }

    /// Whether it begins where the walk does. Its first turn is then the walk's opening turn, which people often leave
    /// out.
    fn opens(&self) -> bool {
        self.first() == 0 && self.hops > 0
    }

    /// All its turns together but the opening turn, radians.
    fn bend_rad(&self) -> f64 {
        wrapped(self.turns().skip(usize::from(self.opens())).sum())
    }
}

/// Finds the features of a step of the text over a stretch.
pub(crate) fn stretch(trial: &Trial<'_>, step: usize, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let told = &trial.guide.steps[step];
    let is_last = step + 1 == trial.guide.len();
    length(told, is_last, stretch, found);
    around(trial, step, stretch, found);
    turns(told, stretch, found);
    let viewpoint = |node: usize| &trial.building.viewpoints[stretch.tree.nodes[node].viewpoint];
    let (first, last) = (viewpoint(stretch.first()), viewpoint(stretch.last()));
    rise(told, last.position.z - first.position.z, found);
    stairs(told, [first, last], found);
    level(trial, told, [viewpoint(0), last], found);
    let crossings =
        stretch.nodes().windows(2).filter(|pair| viewpoint(pair[0]).room != viewpoint(pair[1]).room).count();
    if stretch.hops > 0 {
        let crosses = |at: usize| {
            let pair = [stretch.nodes()[at], stretch.nodes()[at + 1]].map(viewpoint);
            (usize::from(pair[0].room != pair[1].room), 2)
        };
        let ends = [crosses(0), crosses(stretch.hops - 1)];
        let is_long = (usize::from(stretch.hops > 1), 2);
        found.push(CROSSING_ENDS.at([
            (told.step.door as usize, 4),
            (usize::from(is_last), 2),
            is_long,
            ends[0],
            ends[1],
        ]));
    }
    rooms(trial, told, is_last, [first, last], crossings, found);
    onward(told, stretch, found);
    let bend = class(stretch.bend_rad().abs().to_degrees(), &[20.0, 50.0, 100.0]);
    for mark in &told.step.marks {
        found.push(MARK_HOPS.at([(*mark, MARKS), (stretch.hops.min(4), 5)]));
        found.push(MARK_CROSSINGS.at([(*mark, MARKS), (crossings.min(2), 3)]));
        if stretch.hops > 0 {
            found.push(MARK_TURN.at([(*mark, MARKS), (bend, 4)]));
        }
    }
    places::places(trial, step, stretch, found);
}

fn length(told: &Told, is_last: bool, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let kind = (told.kind as usize, Kind::COUNT);
    let hops = (stretch.hops.min(HOPS_CLASSES - 1), HOPS_CLASSES);
    let is_last = (usize::from(is_last), 2);
    found.push(HOPS.at([kind, is_last, hops]));
    if told.step.stops {
        found.push(STOPS.at([is_last, (usize::from(told.step.turn.is_some()), 2), hops]));
    }
    if told.step.is_condition {
        found.push(CONDITION.at([is_last, hops]));
    }
    let length_m: f64 = stretch.nodes()[1..].iter().map(|at| stretch.tree.nodes[*at].length_m).sum();
    found.push(LENGTH.at([kind, (class(length_m, &[0.1, 1.5, 3.0, 5.0, 7.0, 10.0, 14.0]), 8)]));
}

/// The context of the step: the other steps of its text, and the ways that it does not take.
fn around(trial: &Trial<'_>, step: usize, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let steps = &trial.guide.steps;
    let kind = (steps[step].kind as usize, Kind::COUNT);
    let next = steps.get(step + 1);
    let is_last = (usize::from(next.is_none()), 2);
    let of_steps = (class(steps.len() as f64, &[3.0, 5.0]), 3);
    found.push(HOPS_OF_STEPS.at([of_steps, kind, is_last, (stretch.hops.min(HOPS_CLASSES - 1), HOPS_CLASSES)]));
    if let Some(next) = next {
        found.push(NEXT_STEP.at([kind, (next.kind as usize, Kind::COUNT), (stretch.hops.min(4), 5)]));
    }
    let mentions = (trial.guide.steps[step].mentions.len().min(3), 4);
    found.push(HOPS_OF_MENTIONS.at([kind, is_last, mentions, (stretch.hops.min(4), 5)]));
    // "Turn left and walk on": the hop that turns may be the next step's.
    let before = step.checked_sub(1).map(|before| &steps[before]).filter(|before| told_turn(before));
    if let (Some(before), Some(turn_rad)) = (before, stretch.turns().next()) {
        let sign = if before.step.turn == Some(Side::Left) { -1.0 } else { 1.0 };
        let opens = (usize::from(stretch.opens()), 2);
        found.push(TURN_BEFORE.at([((before.kind as usize).min(2), 3), opens, (angle(turn_rad * sign), ANGLES)]));
    }
    let ways = |node: &usize| stretch.tree.nodes[*node].ways;
    if stretch.hops > 0 && !stretch.opens() {
        found.push(SQUARER.at([kind, (ways(&stretch.nodes()[1]).squarer.min(2), 3)]));
    }
    let skip = if told_turn(&steps[step]) || stretch.opens() { 2 } else { 1 };
    if stretch.hops >= skip {
        let straighter = stretch.nodes()[skip..].iter().filter(|node| ways(node).straighter > 0).count();
        found.push(STRAIGHTER.at([kind, (straighter.min(2), 3)]));
    }
    // "Walk on and turn left": the ways to the left that are passed before were not meant.
    let side = match next.and_then(|next| next.step.turn) {
        Some(Side::Left) => Some(0),
        Some(Side::Right) => Some(1),
        _ => None,
    };
    if let Some(side) = side {
        let passed = stretch.nodes().iter().take(stretch.hops).skip(1).filter(|node| ways(node).aside[side]).count();
        let is_here = usize::from(ways(&stretch.last()).aside[side]);
        let here = if stretch.hops == 0 { 2 } else { is_here };
        found.push(SKIPPED.at([kind, (passed.min(2), 3), (here, 3)]));
    }
}

fn told_turn(told: &Told) -> bool {
    told.step.turn.is_some()
}

/// The storey where it ends, if the text gives one.
fn level(trial: &Trial<'_>, told: &Told, [start, last]: [&Viewpoint; 2], found: &mut Vec<Feature>) {
    let which = match (told.step.floor, told.step.storey) {
        (Some(floor), _) => floor.number.map_or(3, |number| (number as usize).clamp(1, 4) - 1),
        (None, Some(Climb::Up)) => 4,
        (None, Some(Climb::Down)) => 5,
        _ => return,
    };
    let which = (which, LEVELS);
    if let Some(level) = last.level {
        let most = trial.building.levels.clamp(1, 3) as usize - 1;
        found.push(LEVEL.at([which, (level.clamp(1, 4) as usize - 1, 4), (most, 3)]));
    }
    let rise = class(last.position.z - start.position.z, &[-4.0, -1.8, -0.6, 0.6, 1.8, 4.0]);
    found.push(LEVEL_RISE.at([which, (rise, 7)]));
}

fn turns(told: &Told, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    if stretch.hops > 0 {
        let kind = (told.kind as usize, Kind::COUNT);
        // Mirrored so that a turn to the side in the text is positive; without a side, only the size counts.
        let told_rad = |rad: f64| match told.step.turn {
            Some(Side::Left) => -rad,
            Some(Side::Right) => rad,
            _ => rad.abs(),
        };
        let mut at = |table: &super::tables::Table, rad: f64| {
            found.push(table.at([kind, (angle(told_rad(wrapped(rad))), ANGLES)]));
        };
        let opens = stretch.opens();
        if opens {
            at(&OPENING_TURN, stretch.turns().sum());
            at(&TURN_AFTER_OPENING, stretch.bend_rad());
        } else {
            at(&FIRST_TURN, stretch.turns().next().unwrap_or_default());
            at(&WHOLE_TURN, stretch.bend_rad());
        }
        if stretch.hops > 1 {
            let widest = stretch.turns().skip(usize::from(opens)).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            at(&WIDEST_TURN, widest.unwrap_or_default());
            let later = stretch.turns().skip(1).filter(|rad| rad.abs() > CLEAR_TURN_RAD).count();
            found.push(LATER_TURNS.at([kind, (later.min(2), 3)]));
        }
    }
    // "The door on your left": the way there bends to that side.
    if let Some((relation, side)) = told.step.side.filter(|_| stretch.hops > 0) {
        let group = match relation {
            Relation::Into | Relation::Through => 0,
            Relation::To | Relation::Along => 1,
            Relation::Past | Relation::With => 2,
            _ => 3,
        };
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        found.push(SIDE_OF_TURN.at([(group, 4), (twelfth(stretch.bend_rad() * sign), 12)]));
    }
}

fn rise(told: &Told, rise_m: f64, found: &mut Vec<Feature>) {
    let (is_told, rise_m) = match told.step.climb {
        Some(Climb::Up) => (0, rise_m),
        Some(Climb::Down) => (0, -rise_m),
        _ => (1, rise_m.abs()),
    };
    let class = class(rise_m, &[-3.0, -2.0, -1.0, -0.5, -0.15, 0.15, 0.5, 1.0, 2.0, 3.0]);
    found.push(RISE.at([(is_told, 2), (class, 11)]));
}

fn stairs(told: &Told, ends: [&Viewpoint; 2], found: &mut Vec<Feature>) {
    let part = match told.step.stairs {
        Stairs::None => return,
        Stairs::Named => 0,
        Stairs::Top => 1,
        Stairs::Bottom => 2,
    };
    for (at, viewpoint) in ends.iter().enumerate() {
        let ways = usize::from(viewpoint.climbs[0]) * 2 + usize::from(viewpoint.climbs[1]);
        let climbs = (usize::from(told.step.climb.is_some()), 2);
        found.push(STAIRS_AT.at([(part, 3), climbs, (at, 2), (ways, 4)]));
    }
}

fn rooms(
    trial: &Trial<'_>,
    told: &Told,
    is_last: bool,
    [first, last]: [&Viewpoint; 2],
    crossings: usize,
    found: &mut Vec<Feature>,
) {
    let door = (told.step.door as usize, 4);
    found.push(CROSSINGS.at([door, (crossings.min(3), 4)]));
    found.push(SAME_ROOM.at([(told.kind as usize, Kind::COUNT), (usize::from(first.room == last.room), 2)]));
    let room = |at: &usize| &trial.building.viewpoints[*at].room;
    let border = last.neighbours.iter().filter(|at| *room(at) != last.room).count();
    found.push(BORDER.at([door, (usize::from(is_last), 2), (border.min(2), 3)]));
}

/// Whether the walk could go straight on from the end.
fn onward(told: &Told, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let goes_on = usize::from(stretch.tree.nodes[stretch.last()].ways.onward);
    let kind = (told.kind as usize, Kind::COUNT);
    found.push(ONWARD.at([kind, (usize::from(told.step.at_end), 2), (goes_on, 2)]));
}
