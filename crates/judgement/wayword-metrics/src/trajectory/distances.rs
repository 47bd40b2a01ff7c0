//! All shortest distances between the viewpoints of a scene. A place is the number of a viewpoint in the order of names.

use super::numbered_viewpoints::NumberedViewpoints;
use std::{cmp::Ordering, collections::BinaryHeap};
use wayword_core::{ViewpointGraph, ViewpointId};

/// The distances over a viewpoint graph between all its viewpoints, computed once.
///
/// They take eight bytes for each pair: 1 MB for the largest of Matterport's buildings.
#[derive(Debug, Clone)]
pub struct SceneDistances {
    places: NumberedViewpoints,
    /// The edges of the graph.
    edge_lists: EdgeLists,
    /// From one place to all, place after place; infinite where there is no way.
    metres: Vec<f64>,
}

impl SceneDistances {
    /// All distances of a graph: a shortest-path tree (Dijkstra 1959) from each viewpoint.
    #[must_use]
    pub fn new(graph: &ViewpointGraph) -> Self {
        let places = NumberedViewpoints::new(graph.viewpoints());
        let roads = EdgeLists::new(graph, &places);
        let mut metres = vec![f64::INFINITY; places.len() * places.len()];
        let mut frontier = BinaryHeap::new();
        for (start, row) in metres.chunks_exact_mut(places.len().max(1)).enumerate() {
            roads.write_distances_from(start, row, &mut frontier);
        }
        Self { places, edge_lists: roads, metres }
    }

    /// The length of the shortest way from one viewpoint to another, metres; `None` where there is no way, or where the
    /// scene lacks one of them.
    #[must_use]
    pub fn metres_between(&self, a: &ViewpointId, b: &ViewpointId) -> Option<f64> {
        let metres = self.metres_between_places(self.place_number(a.as_str())?, self.place_number(b.as_str())?);
        metres.is_finite().then_some(metres)
    }

    /// Whether the scene has this viewpoint.
    #[must_use]
    pub fn has_viewpoint(&self, viewpoint: &ViewpointId) -> bool {
        self.place_number(viewpoint.as_str()).is_some()
    }

    /// Whether an edge joins two viewpoints. No edge joins a viewpoint to itself.
    #[must_use]
    pub fn has_edge(&self, a: &ViewpointId, b: &ViewpointId) -> bool {
        let ends = self.place_number(a.as_str()).zip(self.place_number(b.as_str()));
        ends.is_some_and(|(a, b)| self.are_joined(a, b))
    }

    /// The place of a viewpoint; `None` if the scene lacks it.
    pub(super) fn place_number(&self, viewpoint: &str) -> Option<usize> {
        self.places.find(viewpoint)
    }

    /// The name of the viewpoint at a place.
    pub(super) fn place_name(&self, place: usize) -> &ViewpointId {
        self.places.name(place)
    }

    /// From one place to another, metres; infinite where there is no way.
    pub(super) fn metres_between_places(&self, a: usize, b: usize) -> f64 {
        self.metres[a * self.places.len() + b]
    }

    /// Whether an edge joins two places.
    pub(super) fn are_joined(&self, a: usize, b: usize) -> bool {
        self.edge_lists.edges_from(a).iter().any(|(other, _)| *other == b)
    }
}

/// The edges of all places in one vector, grouped by place: those of place `n` are from `first[n]` to `first[n + 1]`.
#[derive(Debug, Clone)]
struct EdgeLists {
    first: Vec<usize>,
    /// The place at the other end of each edge, and the length in metres.
    to: Vec<(usize, f64)>,
}

impl EdgeLists {
    /// Collects the edges of a graph. Edges of infinite length are left out, because sums over them would be meaningless.
    fn new(graph: &ViewpointGraph, places: &NumberedViewpoints) -> Self {
        let mut ends: Vec<(usize, usize, f64)> = graph
            .edges()
            .filter(|(_, _, length_m)| length_m.is_finite())
            .filter_map(|(a, b, length_m)| Some((places.find(a.as_str())?, places.find(b.as_str())?, length_m)))
            .flat_map(|(a, b, length_m)| [(a, b, length_m), (b, a, length_m)])
            .collect();
        ends.sort_unstable_by_key(|(a, b, _)| (*a, *b));
        let first = (0..=places.len()).map(|place| ends.partition_point(|(a, _, _)| *a < place)).collect();
        Self { first, to: ends.into_iter().map(|(_, b, length_m)| (b, length_m)).collect() }
    }

    /// The edges of a place.
    fn edges_from(&self, place: usize) -> &[(usize, f64)] {
        &self.to[self.first[place]..self.first[place + 1]]
    }

    /// Writes the distances from `start` to all places, metres, into a row that is infinite everywhere. The frontier is empty before
    /// and after; the caller passes it so that its memory is reused.
    fn write_distances_from(&self, start: usize, row: &mut [f64], frontier: &mut BinaryHeap<FrontierPlace>) {
        row[start] = 0.0;
        frontier.push(FrontierPlace { metres: 0.0, place: start });
        while let Some(FrontierPlace { metres, place }) = frontier.pop() {
            if metres > row[place] {
                continue;
            }
            for (next, length_m) in self.edges_from(place) {
                let through = metres + length_m;
                if through < row[*next] {
                    row[*next] = through;
                    frontier.push(FrontierPlace { metres: through, place: *next });
                }
            }
        }
    }
}

/// An entry of Dijkstra's priority queue. The order is reversed, because `BinaryHeap` pops its greatest element and the nearest place
/// must come first.
#[derive(Debug, Clone, Copy)]
struct FrontierPlace {
    metres: f64,
    place: usize,
}

impl Ord for FrontierPlace {
    fn cmp(&self, other: &Self) -> Ordering {
        other.metres.total_cmp(&self.metres).then(other.place.cmp(&self.place))
    }
}

impl PartialOrd for FrontierPlace {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for FrontierPlace {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for FrontierPlace {}

#[cfg(test)]
mod tests {
    use super::super::testing::{any_graph, graph, id};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_way_round_is_as_long_as_its_edges() {
        let line = SceneDistances::new(&graph(&[[0.0, 0.0], [3.0, 4.0], [3.0, 0.0]], &[(0, 1), (1, 2)]));
        assert_eq!(line.metres_between(&id(0), &id(2)), Some(9.0));
        assert_eq!(line.metres_between(&id(2), &id(2)), Some(0.0));
        assert!(line.has_edge(&id(2), &id(1)) && !line.has_edge(&id(0), &id(2)) && !line.has_edge(&id(1), &id(1)));
    }

    #[test]
    fn metres_is_none_for_unreachable_and_unknown_viewpoints() {
        let parts = SceneDistances::new(&graph(&[[0.0, 0.0], [1.0, 0.0], [9.0, 9.0]], &[(0, 1)]));
        assert_eq!(parts.metres_between(&id(0), &id(2)), None);
        assert_eq!(parts.metres_between(&id(0), &id(7)), None);
        assert!(parts.has_viewpoint(&id(2)) && !parts.has_viewpoint(&id(7)) && !parts.has_edge(&id(0), &id(7)));
        assert_eq!(SceneDistances::new(&ViewpointGraph::default()).metres_between(&id(0), &id(0)), None);
    }

    #[test]
    fn edges_of_infinite_length_are_left_out() {
        let far = SceneDistances::new(&graph(&[[-1e300, 0.0], [1e300, 0.0]], &[(0, 1)]));
        assert!(!far.has_edge(&id(0), &id(1)));
    }

    proptest! {
        #[test]
        fn distances_are_those_of_the_shortest_paths(graph in any_graph()) {
            let distances = SceneDistances::new(&graph);
            for a in graph.viewpoints() {
                for b in graph.viewpoints() {
                    let route = graph.shortest_path(a, b).unwrap().map(|route| route.length_m);
                    let found = distances.metres_between(a, b);
                    prop_assert_eq!(found.is_some(), route.is_some());
                    prop_assert!((found.unwrap_or(0.0) - route.unwrap_or(0.0)).abs() < 1e-9);
                    prop_assert_eq!(distances.has_edge(a, b), graph.neighbours_of(a).contains(&b));
                }
            }
        }
    }
}
