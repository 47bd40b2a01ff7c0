//! A step over a stretch of a walk.

use super::{
    Feature, angle, class, places,
    tables::{
        ANGLES, BORDER, CONDITION, CROSSINGS, FIRST_TURN, HOPS, HOPS_CLASSES, LATER_TURNS, LENGTH, MARK_CROSSINGS,
        MARK_HOPS, MARK_TURN, MARKS, ONWARD, OPENING_TURN, RISE, SAME_ROOM, SIDE_OF_TURN, STAIRS_AT, STOPS,
        TURN_AFTER_OPENING, WHOLE_TURN, WIDEST_TURN,
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
pub(crate) const MOST_HOPS: usize = 6;
/// A turn that is no bend of a corridor, radians.
const CLEAR_TURN_RAD: f64 = 0.7;
/// How far a way onward may lie from straight ahead, radians.
const ONWARD_RAD: f64 = 0.6;

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

    /// Whether it begins where the walk does. Then its first turn is the walk's opening turn, which people often do not
    /// tell.
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
    turns(told, stretch, found);
    let viewpoint = |node: usize| &trial.building.viewpoints[stretch.tree.nodes[node].viewpoint];
    let (first, last) = (viewpoint(stretch.first()), viewpoint(stretch.last()));
    rise(told, last.position.z - first.position.z, found);
    stairs(told, [first, last], found);
    let crossings =
        stretch.nodes().windows(2).filter(|pair| viewpoint(pair[0]).room != viewpoint(pair[1]).room).count();
    rooms(trial, told, is_last, [first, last], crossings, found);
    onward(trial, told, stretch, last, found);
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

fn turns(told: &Told, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    if stretch.hops > 0 {
        let kind = (told.kind as usize, Kind::COUNT);
        // Turned so that a turn to the side that the text tells is positive; without a side, only the size counts.
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

/// Whether one could go straight on from the end.
fn onward(trial: &Trial<'_>, told: &Told, stretch: &Stretch<'_>, last: &Viewpoint, found: &mut Vec<Feature>) {
    let node = &stretch.tree.nodes[stretch.last()];
    let is_ahead = |to: &usize| {
        let (bearing_rad, length_m) = trial.building.hop(node.viewpoint, *to);
        length_m > 0.3 && bearing_rad.is_some_and(|rad| wrapped(rad - node.heading_rad).abs() < ONWARD_RAD)
    };
    let goes_on = usize::from(last.neighbours.iter().any(is_ahead));
    let kind = (told.kind as usize, Kind::COUNT);
    found.push(ONWARD.at([kind, (usize::from(told.step.at_end), 2), (goes_on, 2)]));
}
