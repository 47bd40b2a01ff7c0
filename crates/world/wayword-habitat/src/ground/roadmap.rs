//! Makes a viewpoint graph for an island: viewpoints well inside the ground, with an edge between two of them if the way
//! over the ground is short and nearly straight.
//!
//! The steps are those of a probabilistic road map: try random places, keep those far from walls and from one another, join near
//! ones, and connect the remaining parts.

use super::{NavMeshGround, polygon::nearest_on_edge};
use crate::axes::EYE_M;
use std::collections::BTreeSet;
use wayword_core::{DVec3, GroundRoute, ViewpointGraph, ViewpointId, graph::GraphError, seeded_rng};

/// Least distance between two viewpoints of the same storey, metres.
const APART_M: f64 = 1.8;
/// Longest edge, metres.
const REACH_M: f64 = 4.0;
/// Greatest length of the way along an edge, as a multiple of the straight line's length.
const MAX_DETOUR_FACTOR: f64 = 1.1;
/// An edge is left out where the way over a third viewpoint is at most so many times as long: it would lead past that one.
const MAX_PASSING_FACTOR: f64 = 1.03;
/// Random places that are tried, for each square metre of ground.
const TRIES_PER_M2: f64 = 12.0;
/// Most random places that are tried.
const MAX_TRIES: usize = 40_000;
/// Most viewpoints, without those at bends: all pairs of them are examined for edges. On 3,000 square metres or less,
/// where [`MAX_TRIES`] does not thin out the tries, fewer are found.
const MAX_VIEWPOINTS: usize = 2000;
/// Most failed searches for a way between two parts; after them, parts stay unconnected.
const MAX_FAILED_SEARCHES: usize = 4000;
/// Distances to the border that exceed this count as equal to it, metres.
const MAX_CLEARANCE_M: f64 = 1.0;

/// Makes a road map of an island (0 is the largest). The same ground gives the same graph. Every viewpoint can be
/// reached from every other; the ids are `v0000`, `v0001` and so on.
///
/// # Errors
/// Never if the coordinates of the ground are finite; the graph checks names and positions itself.
pub fn viewpoint_graph(ground: &NavMeshGround, island: usize) -> Result<ViewpointGraph, GraphError> {
    let mut map = ViewpointRoadMap { ground, island, nodes: Vec::new(), edges: Vec::new() };
    map.place_viewpoints();
    map.join_near();
    map.connect_parts();
    map.into_graph()
}

/// A graph in the making.
struct ViewpointRoadMap<'a> {
    ground: &'a NavMeshGround,
    island: usize,
    /// The places of the viewpoints on the ground.
    nodes: Vec<DVec3>,
    /// Pairs of indices into `nodes`.
    edges: Vec<(usize, usize)>,
}

impl ViewpointRoadMap<'_> {
    /// Places viewpoints in open places first, then nearer to walls, wherever no other viewpoint is near.
    fn place_viewpoints(&mut self) {
        let area_m2 = self.ground.islands.get(self.island).map_or(0.0, |island| island.area_m2);
        let tries = ((area_m2 * TRIES_PER_M2).ceil() as usize).clamp(1, MAX_TRIES);
        let mut rng = seeded_rng(0, &["habitat viewpoints"]);
        let border = self.border_edges();
        let mut places: Vec<(f64, DVec3)> = Vec::with_capacity(tries);
        for _ in 0..tries {
            let Some(foothold) = self.ground.random_place(self.island, &mut rng) else { return };
            places.push((border_clearance(&border, foothold.place), foothold.place));
        }
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, place) in places {
            if self.nodes.len() >= MAX_VIEWPOINTS {
                break;
            }
            if self.nodes.iter().all(|node| are_far_apart(*node, place)) {
                self.nodes.push(place);
            }
        }
        // Sorted by height and position, so that the number in an id gives a hint of the position.
        self.nodes.sort_by(|a, b| {
            let key = |place: &DVec3| [(place.z / 0.5).floor(), (place.y / 2.0).floor(), place.x];
            let (a, b) = (key(a), key(b));
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        });
    }

    /// The polygons' edges behind which there is no ground.
    fn border_edges(&self) -> Vec<(DVec3, DVec3)> {
        let members = self.ground.islands.get(self.island).map_or(&[][..], |island| &island.polygons);
        let edges = members.iter().flat_map(|polygon| self.ground.polygons[*polygon].edges());
        let closed = edges.filter(|(corner, _)| corner.neighbour.is_none() && corner.portals.is_empty());
        closed.map(|(corner, next)| (corner.place, next.place)).collect()
    }

    /// Joins viewpoints at most [`REACH_M`] apart between which the way is nearly straight, the nearest pairs first. An edge that leads past
    /// a third viewpoint is left out.
    fn join_near(&mut self) {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for a in 0..self.nodes.len() {
            for b in a + 1..self.nodes.len() {
                let straight_m = self.nodes[a].distance(self.nodes[b]);
                if straight_m > REACH_M {
                    continue;
                }
                if self.way_between(a, b).is_some_and(|way| way.length_m <= straight_m * MAX_DETOUR_FACTOR) {
                    pairs.push((straight_m, a, b));
                }
            }
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        for (straight_m, a, b) in pairs {
            let beside_b: BTreeSet<usize> = self.neighbours(b).collect();
            let over =
                |third: usize| self.nodes[a].distance(self.nodes[third]) + self.nodes[third].distance(self.nodes[b]);
            let leads_past = self
                .neighbours(a)
                .any(|third| beside_b.contains(&third) && over(third) <= MAX_PASSING_FACTOR * straight_m);
            if !leads_past {
                self.edges.push((a, b));
            }
        }
    }

    fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> {
        self.edges.iter().filter_map(move |(a, b)| match node {
            _ if *a == node => Some(*b),
            _ if *b == node => Some(*a),
            _ => None,
        })
    }

    fn way_between(&self, a: usize, b: usize) -> Option<GroundRoute> {
        self.ground.geodesic(self.nodes[a], self.nodes[b]).ok()
    }

    /// Joins parts that are still unconnected, the nearest pairs first. Every bend of the way between them becomes a
    /// viewpoint.
    fn connect_parts(&mut self) {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        let parts = self.find_parts();
        for a in 0..self.nodes.len() {
            for b in a + 1..self.nodes.len() {
                if parts[a] != parts[b] {
                    pairs.push((self.nodes[a].distance(self.nodes[b]), a, b));
                }
            }
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut parts = parts;
        let mut in_vain = 0;
        for (_, a, b) in pairs {
            if parts[a] == parts[b] {
                continue;
            }
            let Some(way) = self.way_between(a, b) else {
                in_vain += 1;
                if in_vain > MAX_FAILED_SEARCHES {
                    break;
                }
                continue;
            };
            let mut last = a;
            // All corners of the way but the first and the last.
            for bend in way.corners.iter().skip(1).rev().skip(1).rev() {
                self.nodes.push(*bend);
                parts.push(parts[a]);
                self.edges.push((last, self.nodes.len() - 1));
                last = self.nodes.len() - 1;
            }
            self.edges.push((last, b));
            let (from, to) = (parts[b], parts[a]);
            parts.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
        }
    }

    /// For each node, the smallest node of its connected part, as the name of that part.
    fn find_parts(&self) -> Vec<usize> {
        let mut parts: Vec<usize> = (0..self.nodes.len()).collect();
        for (a, b) in &self.edges {
            let (keep, drop) = (parts[*a].min(parts[*b]), parts[*a].max(parts[*b]));
            parts.iter_mut().filter(|part| **part == drop).for_each(|part| *part = keep);
        }
        parts
    }

    fn into_graph(self) -> Result<ViewpointGraph, GraphError> {
        let mut graph = ViewpointGraph::default();
        let mut ids: Vec<ViewpointId> = Vec::with_capacity(self.nodes.len());
        for (number, place) in self.nodes.iter().enumerate() {
            let Ok(id) = ViewpointId::new(format!("v{number:04}")) else { continue };
            graph.add_viewpoint(id.clone(), *place + DVec3::Z * EYE_M, Some(self.ground.level_at(*place)))?;
            ids.push(id);
        }
        for (a, b) in &self.edges {
            graph.join_viewpoints(&ids[*a], &ids[*b])?;
        }
        Ok(graph)
    }
}

/// Whether two places are far enough apart for both to be viewpoints. Places with more than 1.2 m of height between them are on
/// different storeys.
fn are_far_apart(a: DVec3, b: DVec3) -> bool {
    let difference = a - b;
    difference.truncate().length() >= APART_M || difference.z.abs() > 1.2
}

/// Distance of a place from the border on its storey, at most [`MAX_CLEARANCE_M`].
fn border_clearance(border: &[(DVec3, DVec3)], place: DVec3) -> f64 {
    let on_floor = |(a, b): &&(DVec3, DVec3)| a.z.min(b.z) < place.z + 1.0 && a.z.max(b.z) > place.z - 1.0;
    let off = |(a, b): &(DVec3, DVec3)| (nearest_on_edge(*a, *b, place) - place).truncate().length();
    border.iter().filter(on_floor).map(off).fold(MAX_CLEARANCE_M, f64::min)
}
