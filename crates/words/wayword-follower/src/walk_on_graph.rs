//! Puts a walk that leaves the viewpoints of its building onto the building's graph: its corners and places every few metres become
//! viewpoints, joined to those around them.

use crate::{
    alignment::walk_places,
    building::{KnownBuilding, PathPlace},
    building_parts::{BuildingThing, BuildingViewpoint},
};
use wayword_core::DVec3;
use wayword_language::lexicon::normalise_name;

/// A place of the walk that lies so near to a viewpoint is that viewpoint, metres.
const SAME_PLACE_M: f64 = 0.6;
/// A place of the walk is joined to viewpoints up to this far away, if one can walk straight to them, metres.
const JOINED_M: f64 = 2.8;
/// Two things of one name that lie so near to each other are one, metres.
const SAME_THING_M: f64 = 0.4;

/// A building with a walk on its graph.
#[derive(Debug)]
pub struct WalkOnGraph {
    /// The building, with viewpoints for the places of the walk.
    pub building: KnownBuilding,
    /// The viewpoints of the walk, in order.
    pub walk: Vec<usize>,
}

impl WalkOnGraph {
    /// Puts a path onto the graph of a building. `can_walk` tells whether one can walk straight from one place to another, both given by
    /// the eye's position in metres. Two places of the path that follow one another are always joined.
    #[must_use]
    pub fn new(building: &KnownBuilding, path: &[PathPlace], can_walk: &dyn Fn(DVec3, DVec3) -> bool) -> Self {
        let along = KnownBuilding::along_path(path.to_vec());
        let places = walk_places(&along, &(0..path.len()).collect::<Vec<_>>());
        let mut on_graph = Self { building: building.copy_places(), walk: Vec::new() };
        let mut chosen = places.into_iter().peekable();
        for (at, place) in path.iter().enumerate() {
            if chosen.next_if_eq(&at).is_none() {
                // What is seen between two places is seen from the one before.
                on_graph.walk.last().copied().into_iter().for_each(|viewpoint| on_graph.add_things(place, viewpoint));
                continue;
            }
            let viewpoint = on_graph.viewpoint_at(place, building.len(), can_walk);
            if let Some(before) = on_graph.walk.last().copied().filter(|before| *before != viewpoint) {
                on_graph.join(before, viewpoint);
            }
            if on_graph.walk.last() != Some(&viewpoint) {
                on_graph.walk.push(viewpoint);
            }
            on_graph.add_things(place, viewpoint);
        }
        on_graph.building.forget_nearness();
        on_graph
    }

    /// The viewpoint of a place: a near one of the graph, whose first `known` viewpoints are the building's own, or a new one.
    fn viewpoint_at(&mut self, place: &PathPlace, known: usize, can_walk: &dyn Fn(DVec3, DVec3) -> bool) -> usize {
        let far_m = |at: usize| self.building.viewpoints[at].position.distance(place.position);
        let is_same =
            |at: &usize| far_m(*at) <= SAME_PLACE_M && can_walk(place.position, self.building.viewpoints[*at].position);
        let near = (0..self.building.len()).filter(is_same);
        if let Some(same) = near.min_by(|a, b| far_m(*a).total_cmp(&far_m(*b))) {
            return same;
        }
        let is_joined =
            |at: &usize| far_m(*at) <= JOINED_M && can_walk(place.position, self.building.viewpoints[*at].position);
        let joined: Vec<usize> = (0..known).filter(is_joined).collect();
        let new = self.building.len();
        self.building.viewpoints.push(BuildingViewpoint {
            position: place.position,
            neighbours: Vec::new(),
            room: place.room.clone(),
            level: place.level,
            is_known: true,
            climbs: [false; 2],
        });
        joined.into_iter().for_each(|at| self.join(at, new));
        new
    }

    fn join(&mut self, a: usize, b: usize) {
        for (from, to) in [(a, b), (b, a)] {
            let neighbours = &mut self.building.viewpoints[from].neighbours;
            if !neighbours.contains(&to) {
                neighbours.push(to);
            }
        }
    }

    /// Adds what is seen from a place of the path.
    fn add_things(&mut self, place: &PathPlace, viewpoint: usize) {
        for thing in &place.things {
            let (name, position) = (normalise_name(&thing.name), thing.position_from(place.position));
            let mut things = self.building.things.iter_mut();
            let is_same =
                |known: &&mut BuildingThing| known.name == name && known.position.distance(position) <= SAME_THING_M;
            match things.find(is_same) {
                Some(known) if known.seen_from.contains(&viewpoint) => {}
                Some(known) => known.seen_from.push(viewpoint),
                None => self.building.things.push(BuildingThing { name, position, seen_from: vec![viewpoint] }),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_buildings::make_corridor;

    /// A place beside a viewpoint, metres to the east and the north of it.
    fn place_beside(building: &KnownBuilding, at: usize, off_m: [f64; 2]) -> PathPlace {
        let position = building.viewpoints[at].position + DVec3::new(off_m[0], off_m[1], 0.0);
        PathPlace { position, room: None, level: None, things: Vec::new() }
    }

    #[test]
    fn a_walk_along_viewpoints_keeps_their_numbers() {
        let corridor = make_corridor(&["hallway"; 5]);
        let path: Vec<PathPlace> = (0..5).map(|at| place_beside(&corridor, at, [0.0; 2])).collect();
        let on_graph = WalkOnGraph::new(&corridor, &path, &|_, _| true);
        assert_eq!((on_graph.walk, on_graph.building.len()), (vec![0, 1, 2, 3, 4], 5));
    }

    #[test]
    fn a_walk_beside_the_viewpoints_gets_its_own_and_is_joined_to_them() {
        let corridor = make_corridor(&["hallway"; 3]);
        let beside = |at: usize| place_beside(&corridor, at, [1.0; 2]);
        let path = [beside(0), beside(1), beside(2)];
        let joined = WalkOnGraph::new(&corridor, &path, &|_, _| true);
        assert_eq!(joined.walk, [3, 4, 5]);
        assert!(joined.building.viewpoints[3].neighbours.contains(&0));
        let alone = WalkOnGraph::new(&corridor, &path, &|_, _| false);
        assert_eq!(alone.building.viewpoints[3].neighbours, [4]);
        assert_eq!(alone.building.viewpoints[0].neighbours, corridor.viewpoints[0].neighbours);
    }
}
