//! Features of the rooms and objects that a step names, along its stretch.

use super::{
    Feature, Stretch, class,
    tables::{
        AHEAD, GROUP_ROOM, GROUP_THING, GROUPS, NEAREST, RELATIONS, ROOM, ROOM_AT_END, ROOM_MOVE, SIDE_OF_PLACE, THING,
        THING_AT_END, TOWARDS, TURN_AT, group,
    },
    twelfth,
};
use crate::{
    building::{bearing, wrapped},
    guide::{Found, Trial},
    near::{CLASSES, FAR},
};
use wayword_core::Side;

/// Distance of a place, from and to, at which a step can lead towards it, metres.
const TOWARDS_M: std::ops::Range<f64> = 1.0..14.0;

pub(super) fn places(trial: &Trial<'_>, step: usize, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let is_last = step + 1 == trial.guide.len();
    for place in &trial.found[step] {
        near(place, stretch, is_last, found);
        towards(trial, place, stretch, found);
        side(trial, place, stretch, found);
        ahead(trial, place, stretch, found);
        nearest(trial, place, stretch, is_last, found);
    }
}

/// The distance class of the place at the begin of the stretch, at its nearest point, and at its end.
fn near(place: &Found<'_>, stretch: &Stretch<'_>, is_last: bool, found: &mut Vec<Feature>) {
    let class = |node: usize| place.near.class[stretch.tree.nodes[node].viewpoint];
    let (first, last) = (class(stretch.first()), class(stretch.last()));
    let nearest = stretch.nodes().iter().map(|node| class(*node)).min().unwrap_or(FAR);
    let relation = (place.mention.relation as usize, RELATIONS);
    let group = (group(place.mention.relation), GROUPS);
    for (at, near) in [first, nearest, last].into_iter().enumerate() {
        let (at, near) = ((at, 3), (near, CLASSES));
        if place.is_room {
            found.push(ROOM.at([relation, at, near]));
            found.push(GROUP_ROOM.at([group, at, near]));
        } else {
            found.push(THING.at([relation, (place.near.commonness, 3), at, near]));
            found.push(GROUP_THING.at([group, at, near]));
        }
    }
    if is_last {
        let table = if place.is_room { ROOM_AT_END } else { THING_AT_END };
        found.push(table.at([relation, (last, CLASSES)]));
    }
    if place.is_room {
        let moves = usize::from(first <= 1) * 2 + usize::from(last <= 1);
        found.push(ROOM_MOVE.at([relation, (moves, 4)]));
    }
    if place.mention.tells_turn {
        found.push(TURN_AT.at([(usize::from(place.is_room), 2), (first, CLASSES)]));
    }
}

/// Whether the stretch leads in the direction of the place.
fn towards(trial: &Trial<'_>, place: &Found<'_>, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let viewpoint = |node: usize| stretch.tree.nodes[node].viewpoint;
    let position = |node: usize| trial.building.viewpoints[viewpoint(node)].position;
    let Some(there) = place.near.nearest[viewpoint(stretch.first())] else { return };
    let off = there - position(stretch.first());
    let gone = position(stretch.last()) - position(stretch.first());
    let is_apart = TOWARDS_M.contains(&libm::hypot(off.x, off.y)) && libm::hypot(gone.x, gone.y) > 0.3;
    if let (true, Some(off_rad), Some(gone_rad)) = (is_apart && stretch.hops > 0, bearing(off), bearing(gone)) {
        let angle = class(wrapped(off_rad - gone_rad).abs().to_degrees(), &[25.0, 60.0, 100.0]);
        let relation = (place.mention.relation as usize, RELATIONS);
        found.push(TOWARDS.at([relation, (usize::from(place.is_room), 2), (angle, 4)]));
    }
}

/// On which side of the walker the place is where it is nearest, if the text gives a side.
fn side(trial: &Trial<'_>, place: &Found<'_>, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let sign = match place.mention.side {
        Some(Side::Left) => -1.0,
        Some(Side::Right) => 1.0,
        _ => return,
    };
    let class = |node: &usize| place.near.class[stretch.tree.nodes[*node].viewpoint];
    let Some(nearest) = stretch.nodes().iter().min_by_key(|node| class(node)).filter(|node| class(node) < FAR) else {
        return;
    };
    let node = &stretch.tree.nodes[*nearest];
    let off = |there| bearing(there - trial.building.viewpoints[node.viewpoint].position);
    if let Some(off_rad) = place.near.nearest[node.viewpoint].and_then(off) {
        found.push(SIDE_OF_PLACE.at([(twelfth(wrapped(off_rad - node.heading_rad) * sign), 12)]));
    }
}

/// Whether the place lies ahead of the walker where the stretch ends, or behind.
fn ahead(trial: &Trial<'_>, place: &Found<'_>, stretch: &Stretch<'_>, found: &mut Vec<Feature>) {
    let node = &stretch.tree.nodes[stretch.last()];
    let Some(there) = place.near.nearest[node.viewpoint] else { return };
    let off = there - trial.building.viewpoints[node.viewpoint].position;
    let near = match place.near.class[node.viewpoint] {
        0 | 1 => 0,
        2 => 1,
        3 | 4 => 2,
        _ => return,
    };
    if let (true, Some(off_rad)) = (libm::hypot(off.x, off.y) > 0.3, bearing(off)) {
        let angle = class(wrapped(off_rad - node.heading_rad).abs().to_degrees(), &[45.0, 90.0, 135.0]);
        let relation = (place.mention.relation as usize, RELATIONS);
        found.push(AHEAD.at([relation, (usize::from(place.is_room), 2), (near, 3), (angle, 4)]));
    }
}

/// Whether the stretch ends where the place is nearest: the walk could go nearer from there, or was nearer before.
fn nearest(trial: &Trial<'_>, place: &Found<'_>, stretch: &Stretch<'_>, is_last: bool, found: &mut Vec<Feature>) {
    let class = |viewpoint: usize| place.near.class[viewpoint];
    let of_node = |node: &usize| stretch.tree.nodes[*node].viewpoint;
    let (end, here) = (of_node(&stretch.last()), class(of_node(&stretch.last())));
    let was_nearer = stretch.nodes().iter().any(|node| class(of_node(node)) < here);
    let comes_nearer = trial.building.viewpoints[end].neighbours.iter().any(|to| class(*to) < here);
    let group = (group(place.mention.relation), GROUPS);
    let which = usize::from(was_nearer) * 2 + usize::from(comes_nearer);
    found.push(NEAREST.at([group, (usize::from(place.is_room), 2), (usize::from(is_last), 2), (which, 4)]));
}
