//! Distances between all nodes of a viewpoint graph.

use std::{
    cmp::Ordering,
    collections::{BTreeMap, BinaryHeap},
};
use wayword_core::{ViewpointGraph, ViewpointId};

/// Shortest distances over a viewpoint graph, all pairs, metres.
#[derive(Debug, Clone)]
pub struct Distances {
    index: BTreeMap<ViewpointId, usize>,
    /// Row by row; infinite where there is no way.
    metres: Vec<f64>,
    /// Neighbours of node `i`: `to[first[i]..first[i + 1]]`, in the order of their numbers.
    first: Vec<usize>,
    to: Vec<(usize, f64)>,
}

impl Distances {
    /// Computes them: Dijkstra from every node.
    #[must_use]
    pub fn new(graph: &ViewpointGraph) -> Self {
        let index: BTreeMap<ViewpointId, usize> =
            graph.viewpoints().enumerate().map(|(at, id)| (id.clone(), at)).collect();
        let mut neighbours: Vec<Vec<(usize, f64)>> = vec![Vec::new(); index.len()];
        for (a, b, length_m) in graph.edges() {
            let (a, b) = (index[a], index[b]);
            neighbours[a].push((b, length_m));
            neighbours[b].push((a, length_m));
        }
        let (mut first, mut to) = (vec![0], Vec::new());
        for mut of_node in neighbours {
            of_node.sort_by_key(|(node, _)| *node);
            to.extend(of_node);
            first.push(to.len());
        }
        let mut distances = Self { index, metres: Vec::new(), first, to };
        let nodes = distances.index.len();
        let mut metres = vec![f64::INFINITY; nodes * nodes];
        let mut heap = BinaryHeap::new();
        for (from, row) in metres.chunks_mut(nodes.max(1)).enumerate() {
            distances.from(from, row, &mut heap);
        }
        distances.metres = metres;
        distances
    }

    fn from(&self, from: usize, row: &mut [f64], heap: &mut BinaryHeap<Reached>) {
        row[from] = 0.0;
        heap.push(Reached { metres: 0.0, node: from });
        while let Some(Reached { metres, node }) = heap.pop() {
            if metres > row[node] {
                continue;
            }
            for &(next, length_m) in &self.to[self.first[node]..self.first[node + 1]] {
                let metres = metres + length_m;
                if metres < row[next] {
                    row[next] = metres;
                    heap.push(Reached { metres, node: next });
                }
            }
        }
    }

    /// The distance between two nodes; `None` where one is unknown, or there is no way.
    #[must_use]
    pub fn metres(&self, a: &ViewpointId, b: &ViewpointId) -> Option<f64> {
        let (a, b) = (*self.index.get(a)?, *self.index.get(b)?);
        Some(self.metres[a * self.index.len() + b]).filter(|metres| metres.is_finite())
    }

    /// Whether there is such a node.
    #[must_use]
    pub fn has(&self, id: &ViewpointId) -> bool {
        self.index.contains_key(id)
    }

    /// Whether two nodes are joined.
    #[must_use]
    pub fn has_edge(&self, a: &ViewpointId, b: &ViewpointId) -> bool {
        let (Some(&a), Some(&b)) = (self.index.get(a), self.index.get(b)) else { return false };
        self.to[self.first[a]..self.first[a + 1]].binary_search_by_key(&b, |(node, _)| *node).is_ok()
    }
}

/// A node that was reached: the nearest comes first.
struct Reached {
    metres: f64,
    node: usize,
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.metres.total_cmp(&self.metres).then_with(|| other.node.cmp(&self.node))
    }
}
