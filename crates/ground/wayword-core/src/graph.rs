//! The viewpoint graph that every platform offers: places where an agent can be, and straight walks between them.

use crate::{Heading, Path, ViewpointId, path::PathStop};
use glam::DVec3;
use petgraph::{
    algo::{astar, connected_components, dijkstra},
    graph::{NodeIndex, UnGraph},
    visit::EdgeRef,
};
use std::collections::BTreeMap;

/// Nodes with a position, undirected edges with a length in metres.
#[derive(Debug, Clone, Default)]
pub struct ViewpointGraph {
    graph: UnGraph<ViewpointNode, f64>,
    index: BTreeMap<ViewpointId, NodeIndex>,
}

#[derive(Debug, Clone)]
struct ViewpointNode {
    id: ViewpointId,
    /// The eye, metres, world frame.
    position: DVec3,
    /// The storey, the lowest being 1.
    level: Option<u32>,
    /// Height of the floor, metres, world frame.
    floor_m: Option<f64>,
}

/// A shortest path over the graph.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewpointRoute {
    /// Nodes from start to goal, both included.
    pub viewpoints: Vec<ViewpointId>,
    /// Sum of its edges, metres.
    pub length_m: f64,
}

/// Why a graph cannot be built or walked as the caller asked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// Two nodes have one name.
    #[error("viewpoint {0} is listed twice")]
    Twice(ViewpointId),
    /// A position is not finite.
    #[error("viewpoint {0} has a position that is not finite")]
    NotFinite(ViewpointId),
    /// The graph has no viewpoint of this name.
    #[error("viewpoint {0} is not in the graph")]
    Unknown(ViewpointId),
    /// Two consecutive viewpoints have no edge.
    #[error(
        "there is no edge from viewpoint {0} to {1}; a path lists every viewpoint that it passes, so add those between them"
    )]
    NoEdge(ViewpointId, ViewpointId),
}

impl ViewpointGraph {
    /// Adds a node. `position` is the eye's (metres, world frame), `level` its storey, the lowest being 1.
    ///
    /// # Errors
    /// When the name is taken or the position not finite.
    pub fn add_viewpoint(&mut self, id: ViewpointId, position: DVec3, level: Option<u32>) -> Result<(), GraphError> {
        if !position.is_finite() {
            return Err(GraphError::NotFinite(id));
        }
        if self.index.contains_key(&id) {
            return Err(GraphError::Twice(id));
        }
        let node = self.graph.add_node(ViewpointNode { id: id.clone(), position, level, floor_m: None });
        self.index.insert(id, node);
        Ok(())
    }

    /// Sets the height of the floor under a node, metres, world frame. A height that is not finite clears it.
    ///
    /// # Errors
    /// When the node is not in the graph.
    pub fn set_floor(&mut self, id: &ViewpointId, floor_m: f64) -> Result<(), GraphError> {
        let node = self.find_node(id)?;
        self.graph[node].floor_m = Some(floor_m).filter(|floor_m| floor_m.is_finite());
        Ok(())
    }

    /// Joins two nodes; the edge's length is their straight distance. Joining them twice leaves one edge.
    ///
    /// # Errors
    /// When one of them is not in the graph.
    pub fn join_viewpoints(&mut self, a: &ViewpointId, b: &ViewpointId) -> Result<(), GraphError> {
        let (a, b) = (self.find_node(a)?, self.find_node(b)?);
        let length_m = self.graph[a].position.distance(self.graph[b].position);
        if a != b {
            self.graph.update_edge(a, b, length_m);
        }
        Ok(())
    }

    fn find_node(&self, id: &ViewpointId) -> Result<NodeIndex, GraphError> {
        self.index.get(id).copied().ok_or_else(|| GraphError::Unknown(id.clone()))
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.graph.node_count()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.graph.node_count() == 0
    }

    /// Number of connected parts. No edges lead from one part to another.
    #[must_use]
    pub fn count_components(&self) -> usize {
        connected_components(&self.graph)
    }

    /// All names, in the order in which they were added.
    pub fn viewpoints(&self) -> impl Iterator<Item = &ViewpointId> {
        self.graph.node_weights().map(|node| &node.id)
    }

    /// All edges, each once, with their length in metres.
    pub fn edges(&self) -> impl Iterator<Item = (&ViewpointId, &ViewpointId, f64)> {
        self.graph
            .edge_references()
            .map(|edge| (&self.graph[edge.source()].id, &self.graph[edge.target()].id, *edge.weight()))
    }

    /// The eye's position at a node, metres, world frame.
    #[must_use]
    pub fn position_of(&self, id: &ViewpointId) -> Option<DVec3> {
        self.index.get(id).map(|node| self.graph[*node].position)
    }

    /// The storey of a node, the lowest being 1.
    #[must_use]
    pub fn level_of(&self, id: &ViewpointId) -> Option<u32> {
        self.index.get(id).and_then(|node| self.graph[*node].level)
    }

    /// How high the floor under a node is, metres, world frame, where the platform knows it.
    #[must_use]
    pub fn floor_m(&self, id: &ViewpointId) -> Option<f64> {
        self.index.get(id).and_then(|node| self.graph[*node].floor_m)
    }

    /// The neighbours of a node, by name.
    #[must_use]
    pub fn neighbours_of(&self, id: &ViewpointId) -> Vec<&ViewpointId> {
        let Some(node) = self.index.get(id) else {
            return Vec::new();
        };
        let mut names: Vec<_> = self.graph.neighbors(*node).map(|other| &self.graph[other].id).collect();
        names.sort();
        names
    }

    /// The distances over the graph from one node to every node that can be reached, metres.
    ///
    /// # Errors
    /// When the node is not in the graph.
    pub fn distances_from(&self, start: &ViewpointId) -> Result<BTreeMap<&ViewpointId, f64>, GraphError> {
        let lengths = dijkstra(&self.graph, self.find_node(start)?, None, |edge| *edge.weight());
        Ok(lengths.into_iter().map(|(node, length_m)| (&self.graph[node].id, length_m)).collect())
    }

    /// The shortest route from one node to another, or `None` if they are not connected.
    ///
    /// # Errors
    /// When a node is not in the graph.
    pub fn shortest_path(&self, start: &ViewpointId, goal: &ViewpointId) -> Result<Option<ViewpointRoute>, GraphError> {
        let (start, goal) = (self.find_node(start)?, self.find_node(goal)?);
        let goal_position = self.graph[goal].position;
        let remaining_m = |node: NodeIndex| self.graph[node].position.distance(goal_position);
        let shortest = astar(&self.graph, start, |node| node == goal, |edge| *edge.weight(), remaining_m);
        Ok(shortest.map(|(length_m, nodes)| ViewpointRoute {
            viewpoints: nodes.into_iter().map(|node| self.graph[node].id.clone()).collect(),
            length_m,
        }))
    }

    /// The frames of a path over the given nodes. The first frame looks along `start`, or else along the first hop.
    ///
    /// # Errors
    /// When a node is unknown or two consecutive nodes have no edge (the same node twice is a stay).
    pub fn path_frames(
        &self,
        viewpoints: &[ViewpointId],
        start: Option<Heading>,
    ) -> Result<Vec<crate::Frame>, GraphError> {
        for pair in viewpoints.windows(2) {
            let (a, b) = (self.find_node(&pair[0])?, self.find_node(&pair[1])?);
            if a != b && self.graph.find_edge(a, b).is_none() {
                return Err(GraphError::NoEdge(pair[0].clone(), pair[1].clone()));
            }
        }
        let stops = viewpoints.iter().map(|id| {
            let node = &self.graph[self.find_node(id)?];
            Ok(PathStop { position: node.position, viewpoint: Some(id.clone()), level: node.level })
        });
        Ok(Path::frames_along(stops.collect::<Result<_, _>>()?, start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn id(n: usize) -> ViewpointId {
        ViewpointId::new(format!("v{n}")).unwrap()
    }

    fn graph(points: &[(f64, f64)], edges: &[(usize, usize)]) -> ViewpointGraph {
        let mut graph = ViewpointGraph::default();
        for (n, (x, y)) in points.iter().enumerate() {
            graph.add_viewpoint(id(n), DVec3::new(*x, *y, 0.0), Some(1)).unwrap();
        }
        for (a, b) in edges {
            graph.join_viewpoints(&id(*a), &id(*b)).unwrap();
        }
        graph
    }

    #[test]
    fn shortest_path_takes_the_shorter_way_round() {
        let square = graph(&[(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)], &[(0, 1), (1, 2), (2, 3), (3, 0)]);
        let route = square.shortest_path(&id(0), &id(2)).unwrap().unwrap();
        assert!((route.length_m - 4.0).abs() < 1e-12);
        assert_eq!(route.viewpoints.len(), 3);
    }

    #[test]
    fn parts_that_do_not_touch_have_no_path() {
        let parts = graph(&[(0.0, 0.0), (1.0, 0.0), (9.0, 9.0)], &[(0, 1)]);
        assert_eq!(parts.count_components(), 2);
        assert_eq!(parts.shortest_path(&id(0), &id(2)).unwrap(), None);
        assert!(parts.shortest_path(&id(0), &id(7)).is_err());
    }

    #[test]
    fn a_walk_keeps_to_edges() {
        let line = graph(&[(0.0, 0.0), (0.0, 2.0), (2.0, 2.0)], &[(0, 1), (1, 2)]);
        assert_eq!(line.path_frames(&[id(0), id(1), id(2)], None).unwrap().len(), 3);
        assert_eq!(line.path_frames(&[id(0), id(2)], None), Err(GraphError::NoEdge(id(0), id(2))));
    }

    #[test]
    fn names_are_taken_once_and_places_are_finite() {
        let mut graph = graph(&[(0.0, 0.0)], &[]);
        assert_eq!(graph.add_viewpoint(id(0), DVec3::ZERO, None), Err(GraphError::Twice(id(0))));
        assert_eq!(graph.add_viewpoint(id(1), DVec3::NAN, None), Err(GraphError::NotFinite(id(1))));
    }

    proptest! {
        #[test]
        fn shortest_paths_keep_the_triangle_inequality_and_their_own_length(
            points in prop::collection::vec((0.0..10.0f64, 0.0..10.0f64), 5..12),
            extra in prop::collection::vec((0usize..12, 0usize..12), 0..20),
        ) {
            let n = points.len();
            let ring: Vec<_> = (0..n).map(|i| (i, (i + 1) % n)).collect();
            let edges: Vec<_> = ring.into_iter().chain(extra.into_iter().map(|(a, b)| (a % n, b % n))).collect();
            let graph = graph(&points, &edges);
            let length = |a, b| graph.shortest_path(&id(a), &id(b)).unwrap().unwrap().length_m;
            for (a, b, c) in [(0, 1, 2), (0, n / 2, n - 1), (n - 1, 1, 3)] {
                prop_assert!(length(a, c) <= length(a, b) + length(b, c) + 1e-9);
                prop_assert!((length(a, b) - length(b, a)).abs() < 1e-9);
                let route = graph.shortest_path(&id(a), &id(b)).unwrap().unwrap();
                let position = |id| graph.position_of(id).unwrap();
                let hops: f64 = route.viewpoints.windows(2).map(|pair| position(&pair[0]).distance(position(&pair[1]))).sum();
                prop_assert!((hops - route.length_m).abs() < 1e-9);
            }
        }
    }
}
