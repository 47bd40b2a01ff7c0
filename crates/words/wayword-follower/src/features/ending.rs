//! Features of the end of a walk: everything that the text names compared with the whole walk.

use super::{
    FeatureNumber, limit_class,
    tables::{
        GROUPS, LAST_ROOM, LAST_THING, NAMED_ROOM, NAMED_THING, TURNS_TOLD, UNNAMED_END, UNNAMED_PASSED, UNTOLD_HOPS,
        UNTOLD_LENGTH, WALK_HOPS, relation_group,
    },
};
use crate::{
    guide::GuideTrial,
    nearness::{CLASSES, FAR_CLASS},
    tree::WalkTree,
};

/// Turns of at least this angle are usually described by people, radians.
const TOLD_TURN_RAD: f64 = 0.8;

/// Adds to `found` the features of a walk that ends at the node `end`.
pub(crate) fn ending_features(trial: &GuideTrial<'_>, tree: &WalkTree, end: usize, found: &mut Vec<FeatureNumber>) {
    if trial.guide.is_empty() {
        // The text has no step, so only the usual length of people's walks counts.
        let length_m: f64 = tree.nodes_back(end).map(|node| tree.nodes[node].length_m).sum();
        found.push(UNTOLD_HOPS.feature_at([(tree.nodes[end].hops.min(WALK_HOPS - 1), WALK_HOPS)]));
        found.push(UNTOLD_LENGTH.feature_at([(limit_class(length_m, &[2.0, 4.0, 6.0, 8.0, 10.0, 13.0, 16.0]), 8)]));
        return;
    }
    let viewpoint = |node: usize| tree.nodes[node].viewpoint;
    let is_goal = (usize::from(trial.guide.is_goal), 2);
    let places = || trial.located.iter().flatten();
    for (is_room, table) in [(true, LAST_ROOM), (false, LAST_THING)] {
        if let Some(place) = places().rfind(|place| place.is_room == is_room) {
            let near = (place.near.class[viewpoint(end)], CLASSES);
            found.push(table.feature_at([is_goal, (relation_group(place.mention.relation), GROUPS), near]));
        }
    }
    for place in places() {
        let nearest = tree.nodes_back(end).map(|node| place.near.class[viewpoint(node)]).min().unwrap_or(FAR_CLASS);
        found.push(match place.is_room {
            true => NAMED_ROOM.feature_at([is_goal, (nearest, CLASSES)]),
            false => NAMED_THING.feature_at([is_goal, (place.near.commonness, 3), (nearest, CLASSES)]),
        });
    }
    room_features(trial, is_goal, tree, end, found);
    let turns = tree.nodes_back(end).filter(|node| tree.nodes[*node].hops > 1);
    let walk_turns = turns.filter(|node| tree.nodes[*node].turn_rad.abs() > TOLD_TURN_RAD).count();
    // Class 6 is a text that only names a place to go to.
    let text_turns = if trial.guide.is_goal { 6 } else { trial.guide.count_turns().min(5) };
    found.push(TURNS_TOLD.feature_at([(text_turns, 7), (walk_turns.min(6), 7)]));
}

/// The rooms that the walk passes without a mention in the text, and the room where it ends.
fn room_features(
    trial: &GuideTrial<'_>,
    is_goal: (usize, usize),
    tree: &WalkTree,
    end: usize,
    found: &mut Vec<FeatureNumber>,
) {
    let room = |node: usize| trial.building.viewpoints[tree.nodes[node].viewpoint].room.as_deref();
    let is_named = |node: usize| trial.is_room_named[tree.nodes[node].viewpoint];
    let mut unnamed: Vec<&str> = Vec::new();
    for node in tree.nodes_back(end).filter(|node| *node != 0 && is_named(*node) == Some(false)) {
        let room = room(node).unwrap_or_default();
        if !unnamed.contains(&room) {
            unnamed.push(room);
        }
    }
    found.push(UNNAMED_PASSED.feature_at([is_goal, (unnamed.len().min(4), 5)]));
    if let Some(is_named) = is_named(end) {
        let commonness = trial.building.commonness_of_room(tree.nodes[end].viewpoint);
        found.push(UNNAMED_END.feature_at([is_goal, (usize::from(is_named), 2), (commonness, 3)]));
    }
}
