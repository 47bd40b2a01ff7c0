//! The end of a walk: what the whole text names against the whole walk.

use super::{
    Feature,
    tables::{GROUPS, LAST_ROOM, LAST_THING, NAMED_ROOM, NAMED_THING, TURNS_TOLD, UNNAMED_END, UNNAMED_PASSED, group},
};
use crate::{
    guide::Trial,
    near::{CLASSES, FAR},
    tree::Tree,
};

/// A turn that people would tell, radians.
const TOLD_TURN_RAD: f64 = 0.8;

/// Finds the features of a walk that ends at a node.
pub(crate) fn ending(trial: &Trial<'_>, tree: &Tree, end: usize, found: &mut Vec<Feature>) {
    let viewpoint = |node: usize| tree.nodes[node].viewpoint;
    let places = || trial.found.iter().flatten();
    for (is_room, table) in [(true, LAST_ROOM), (false, LAST_THING)] {
        if let Some(place) = places().rfind(|place| place.is_room == is_room) {
            let near = (place.near.class[viewpoint(end)], CLASSES);
            found.push(table.at([(group(place.mention.relation), GROUPS), near]));
        }
    }
    for place in places() {
        let nearest = tree.back(end).map(|node| place.near.class[viewpoint(node)]).min().unwrap_or(FAR);
        found.push(match place.is_room {
            true => NAMED_ROOM.at([(nearest, CLASSES)]),
            false => NAMED_THING.at([(place.near.commonness, 3), (nearest, CLASSES)]),
        });
    }
    rooms(trial, tree, end, found);
    let turns = tree.back(end).filter(|node| tree.nodes[*node].hops > 1);
    let real = turns.filter(|node| tree.nodes[*node].turn_rad.abs() > TOLD_TURN_RAD).count();
    found.push(TURNS_TOLD.at([(trial.guide.turns().min(5), 6), (real.min(6), 7)]));
}

/// The rooms that the walk passes and the text does not name, and the room where it ends.
fn rooms(trial: &Trial<'_>, tree: &Tree, end: usize, found: &mut Vec<Feature>) {
    let room = |node: usize| trial.building.viewpoints[tree.nodes[node].viewpoint].room.as_deref();
    let tells = |node: usize| trial.tells_room[tree.nodes[node].viewpoint];
    let mut unnamed: Vec<&str> = Vec::new();
    for node in tree.back(end).filter(|node| *node != 0 && tells(*node) == Some(false)) {
        let room = room(node).unwrap_or_default();
        if !unnamed.contains(&room) {
            unnamed.push(room);
        }
    }
    found.push(UNNAMED_PASSED.at([(unnamed.len().min(4), 5)]));
    if let Some(is_named) = tells(end) {
        let commonness = trial.building.commonness_of_room(tree.nodes[end].viewpoint);
        found.push(UNNAMED_END.at([(usize::from(is_named), 2), (commonness, 3)]));
    }
}
