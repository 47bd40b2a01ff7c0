//! Features of the rooms and objects that a step names, along its stretch.

use super::{
    FeatureNumber, WalkStretch, angle_twelfth, limit_class,
    tables::{
        AHEAD, GROUP_ROOM, GROUP_THING, GROUPS, NEAREST, RELATIONS, ROOM, ROOM_AT_END, ROOM_MOVE, SIDE_OF_PLACE, THING,
        THING_AT_END, TOWARDS, TURN_AT, relation_group,
    },
};
use crate::{
    building::{offset_bearing, wrap_angle},
    guide::{GuideTrial, LocatedMention},
    nearness::{CLASSES, FAR_CLASS},
};
use wayword_core::Side;

/// Distance of a place, from and to, at which a step can lead towards it, metres.
const TOWARDS_M: std::ops::Range<f64> = 1.0..14.0;

/// Adds to `found` the features of each place that the step names and the building has.
pub(super) fn place_features(
    trial: &GuideTrial<'_>,
    step: usize,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    let is_last = step + 1 == trial.guide.len();
    for place in &trial.located[step] {
        near_features(place, stretch, is_last, found);
        towards_features(trial, place, stretch, found);
        side_features(trial, place, stretch, found);
        ahead_features(trial, place, stretch, found);
        nearest_features(trial, place, stretch, is_last, found);
    }
}

/// The distance class of the place at the begin of the stretch, at its nearest point, and at its end.
fn near_features(place: &LocatedMention<'_>, stretch: &WalkStretch<'_>, is_last: bool, found: &mut Vec<FeatureNumber>) {
    let class = |node: usize| place.near.class[stretch.tree.nodes[node].viewpoint];
    let (first, last) = (class(stretch.first_node()), class(stretch.last_node()));
    let nearest = stretch.nodes().iter().map(|node| class(*node)).min().unwrap_or(FAR_CLASS);
    let relation = (place.mention.relation as usize, RELATIONS);
    let group = (relation_group(place.mention.relation), GROUPS);
    // Each dimension of a feature is a pair: the value, and the number of values.
    for (at, near) in [first, nearest, last].into_iter().enumerate() {
        let (at, near) = ((at, 3), (near, CLASSES));
        if place.is_room {
            found.push(ROOM.feature_at([relation, at, near]));
            found.push(GROUP_ROOM.feature_at([group, at, near]));
        } else {
            found.push(THING.feature_at([relation, (place.near.commonness, 3), at, near]));
            found.push(GROUP_THING.feature_at([group, at, near]));
        }
    }
    if is_last {
        let table = if place.is_room { ROOM_AT_END } else { THING_AT_END };
        found.push(table.feature_at([relation, (last, CLASSES)]));
    }
    if place.is_room {
        // Classes 0 and 1 are viewpoints in the room.
        let moves = usize::from(first <= 1) * 2 + usize::from(last <= 1);
        found.push(ROOM_MOVE.feature_at([relation, (moves, 4)]));
    }
    if place.mention.tells_turn {
        found.push(TURN_AT.feature_at([(usize::from(place.is_room), 2), (first, CLASSES)]));
    }
}

/// Whether the stretch leads in the direction of the place.
fn towards_features(
    trial: &GuideTrial<'_>,
    place: &LocatedMention<'_>,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    let viewpoint = |node: usize| stretch.tree.nodes[node].viewpoint;
    let position = |node: usize| trial.building.viewpoints[viewpoint(node)].position;
    let Some(there) = place.near.nearest[viewpoint(stretch.first_node())] else { return };
    let off = there - position(stretch.first_node());
    let gone = position(stretch.last_node()) - position(stretch.first_node());
    let is_apart = TOWARDS_M.contains(&libm::hypot(off.x, off.y)) && libm::hypot(gone.x, gone.y) > 0.3;
    if let (true, Some(off_rad), Some(gone_rad)) =
        (is_apart && stretch.hops > 0, offset_bearing(off), offset_bearing(gone))
    {
        let angle = limit_class(wrap_angle(off_rad - gone_rad).abs().to_degrees(), &[25.0, 60.0, 100.0]);
        let relation = (place.mention.relation as usize, RELATIONS);
        found.push(TOWARDS.feature_at([relation, (usize::from(place.is_room), 2), (angle, 4)]));
    }
}

/// On which side of the walker the place is where it is nearest, if the text gives a side.
fn side_features(
    trial: &GuideTrial<'_>,
    place: &LocatedMention<'_>,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    let sign = match place.mention.side {
        Some(Side::Left) => -1.0,
        Some(Side::Right) => 1.0,
        _ => return,
    };
    let class = |node: &usize| place.near.class[stretch.tree.nodes[*node].viewpoint];
    let Some(nearest) = stretch.nodes().iter().min_by_key(|node| class(node)).filter(|node| class(node) < FAR_CLASS)
    else {
        return;
    };
    let node = &stretch.tree.nodes[*nearest];
    let off = |there| offset_bearing(there - trial.building.viewpoints[node.viewpoint].position);
    if let Some(off_rad) = place.near.nearest[node.viewpoint].and_then(off) {
        found.push(SIDE_OF_PLACE.feature_at([(angle_twelfth(wrap_angle(off_rad - node.heading_rad) * sign), 12)]));
    }
}

/// Whether the place lies ahead of the walker where the stretch ends, or behind.
fn ahead_features(
    trial: &GuideTrial<'_>,
    place: &LocatedMention<'_>,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    let node = &stretch.tree.nodes[stretch.last_node()];
    let Some(there) = place.near.nearest[node.viewpoint] else { return };
    let off = there - trial.building.viewpoints[node.viewpoint].position;
    // Three classes of distance. A farther place gives no feature.
    let near = match place.near.class[node.viewpoint] {
        0 | 1 => 0,
        2 => 1,
        3 | 4 => 2,
        _ => return,
    };
    if let (true, Some(off_rad)) = (libm::hypot(off.x, off.y) > 0.3, offset_bearing(off)) {
        let angle = limit_class(wrap_angle(off_rad - node.heading_rad).abs().to_degrees(), &[45.0, 90.0, 135.0]);
        let relation = (place.mention.relation as usize, RELATIONS);
        found.push(AHEAD.feature_at([relation, (usize::from(place.is_room), 2), (near, 3), (angle, 4)]));
    }
}

/// Whether the stretch ends where the place is nearest: the walk could go nearer from there, or was nearer before.
fn nearest_features(
    trial: &GuideTrial<'_>,
    place: &LocatedMention<'_>,
    stretch: &WalkStretch<'_>,
    is_last: bool,
    found: &mut Vec<FeatureNumber>,
) {
    let class = |viewpoint: usize| place.near.class[viewpoint];
    let viewpoint = |node: &usize| stretch.tree.nodes[*node].viewpoint;
    let (end, here) = (viewpoint(&stretch.last_node()), class(viewpoint(&stretch.last_node())));
    let was_nearer = stretch.nodes().iter().any(|node| class(viewpoint(node)) < here);
    let comes_nearer = trial.building.viewpoints[end].neighbours.iter().any(|to| class(*to) < here);
    let group = (relation_group(place.mention.relation), GROUPS);
    let which = usize::from(was_nearer) * 2 + usize::from(comes_nearer);
    found.push(NEAREST.feature_at([group, (usize::from(place.is_room), 2), (usize::from(is_last), 2), (which, 4)]));
}
