//! Makes the viewpoint graph of a house from its walkable ground.
//!
//! Viewpoints are placed in this order: in openings and on stairs, in the most open spot of every room, then wherever
//! there is still space. Parts of the graph that are not joined then get viewpoints along the shortest way between them.

use super::{
    ground::{GroundCell, HouseGround},
    model::House,
};
use std::collections::BTreeMap;
use wayword_core::{DVec3, ViewpointGraph, ViewpointId, graph::GraphError};

/// Height of the eye above the ground, metres.
pub const EYE_M: f64 = 1.5;
/// Least distance between two viewpoints, except in doorways and on stairs, metres.
const MIN_VIEWPOINT_DISTANCE_M: f64 = 1.8;
/// Least distance to walls and furniture, so that they do not fill the view: cells beyond the walker's radius.
const MIN_CLEARANCE_CELLS: u32 = 4;
/// Longest edge, metres: long enough to join two rows of viewpoints.
const MAX_EDGE_M: f64 = 3.0;

/// The graph has a viewpoint in every opening, on the stairs and in every room, and others between them. Two viewpoints
/// are joined where one can walk straight from one to the other.
///
/// # Errors
/// Never for a generated house. In an edited house, names and positions are checked.
pub fn viewpoint_graph(house: &House, ground: &HouseGround) -> Result<ViewpointGraph, GraphError> {
    let mut map = HouseRoadMap { ground, nodes: Vec::new() };
    map.add_fixed_viewpoints(house);
    let clearances = ground.all_clearances();
    map.enter_rooms(house, &clearances);
    map.fill_open_floor(&clearances);
    let mut edges = map.straight_edges();
    map.connect_parts(&mut edges);
    map.into_graph(&edges)
}

/// The graph while it is being made: a cell of the ground and its place for each viewpoint.
struct HouseRoadMap<'a> {
    ground: &'a HouseGround,
    nodes: Vec<(GroundCell, DVec3)>,
}

impl HouseRoadMap<'_> {
    fn add_cell(&mut self, cell: GroundCell) {
        if self.nodes.iter().all(|(other, _)| *other != cell) {
            self.nodes.push((cell, self.ground.middle_of_cell(cell)));
        }
    }

    /// Adds viewpoints in openings and on the stairs.
    fn add_fixed_viewpoints(&mut self, house: &House) {
        for opening in house.openings.iter().filter(|opening| opening.is_passable()) {
            let (x, y) = opening.span.middle();
            self.add_nearest(DVec3::new(f64::from(x), f64::from(y), f64::from(opening.base_cm)) / 100.0);
        }
        let Some(stairs) = &house.stairs else {
            return;
        };
        let on_landing = (stairs.flight_cm + stairs.depth_cm()) / 2;
        for lower in [true, false] {
            let (from, to) = stairs.flight_across(lower);
            for deep in [stairs.flight_cm / 2, on_landing] {
                let (x, y) = stairs.rect_across((from + to) / 2, (from + to) / 2, [deep, deep]).centre();
                let (x_m, y_m) = (f64::from(x) / 100.0, f64::from(y) / 100.0);
                self.add_nearest(DVec3::new(x_m, y_m, stairs.height_at(x_m, y_m)));
            }
        }
    }

    /// Adds the free cell nearest to a place, within 60 cm.
    fn add_nearest(&mut self, place: DVec3) {
        if let Some(cell) = self.ground.cell_at(place) {
            return self.add_cell(cell);
        }
        let off_m = |cell: &GroundCell| self.ground.middle_of_cell(*cell).distance(place);
        let near = self.ground.free_cells().filter(|cell| off_m(cell) < 0.6);
        if let Some(cell) = near.min_by(|a, b| off_m(a).total_cmp(&off_m(b))) {
            self.add_cell(cell);
        }
    }

    /// Adds the most open cell of every room.
    fn enter_rooms(&mut self, house: &House, clearances: &[Vec<u32>]) {
        for room in &house.rooms {
            let floor = room.floor as usize;
            let inside = |cell: &GroundCell| {
                let place = self.ground.middle_of_cell(*cell);
                cell.layer == floor && room.inner_area().holds_m(place.x, place.y)
            };
            let open = |cell: &GroundCell| (clearances[cell.layer][cell.index], std::cmp::Reverse(*cell));
            if let Some(cell) = self.ground.free_cells().filter(inside).max_by_key(open) {
                self.add_cell(cell);
            }
        }
    }

    /// Adds further cells, the most open ones first, each at least `MIN_VIEWPOINT_DISTANCE_M` from the others.
    fn fill_open_floor(&mut self, clearances: &[Vec<u32>]) {
        let is_open = |cell: &GroundCell| clearances[cell.layer][cell.index] >= MIN_CLEARANCE_CELLS;
        let mut cells: Vec<GroundCell> = self.ground.free_cells().filter(is_open).collect();
        cells.sort_by_key(|cell| (std::cmp::Reverse(clearances[cell.layer][cell.index]), *cell));
        for cell in cells {
            let place = self.ground.middle_of_cell(cell);
            let far = |(_, other): &(GroundCell, DVec3)| {
                (other.z - place.z).abs() > 1.0 || other.distance(place) >= MIN_VIEWPOINT_DISTANCE_M
            };
            if self.nodes.iter().all(far) {
                self.nodes.push((cell, place));
            }
        }
    }

    /// Pairs of near viewpoints between which one can walk straight.
    fn straight_edges(&self) -> Vec<(usize, usize)> {
        let mut edges = Vec::new();
        for (a, (from, place)) in self.nodes.iter().enumerate() {
            for (b, (to, other)) in self.nodes.iter().enumerate().skip(a + 1) {
                if place.distance(*other) <= MAX_EDGE_M && self.ground.is_straight(*from, *to) {
                    edges.push((a, b));
                }
            }
        }
        edges
    }

    /// Joins parts of the graph that are not connected, with viewpoints at the corners of the shortest way between them.
    fn connect_parts(&mut self, edges: &mut Vec<(usize, usize)>) {
        // Most of the nearest pairs are compared again after each way.
        let mut ways: BTreeMap<(usize, usize), Option<Vec<DVec3>>> = BTreeMap::new();
        loop {
            let parts = self.label_parts(edges);
            let apart = |a: &usize, b: &usize| parts[*a] != parts[*b];
            let count = self.nodes.len();
            let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).filter(|(a, b)| apart(a, b));
            let length_m = |(a, b): &(usize, usize)| self.nodes[*a].1.distance(self.nodes[*b].1);
            let mut pairs: Vec<_> = pairs.collect();
            pairs.sort_by(|a, b| length_m(a).total_cmp(&length_m(b)).then(a.cmp(b)));
            let places = |(a, b): (usize, usize)| {
                let find_way = || Some(self.ground.shortest_route(self.nodes[a].1, self.nodes[b].1).ok()?.corners);
                Some((a, b, ways.entry((a, b)).or_insert_with(find_way).clone()?))
            };
            // A pair with furniture or a ceiling between may have no short way; the next nearest pair may. So the ways of
            // the twelve nearest pairs are compared.
            let Some((a, b, corners)) =
                pairs.into_iter().take(12).filter_map(places).min_by_key(|(_, _, way)| way.len())
            else {
                return;
            };
            self.add_way(a, b, &corners, edges);
        }
    }

    /// Adds viewpoints at the inner corners of a way, and edges along it from viewpoint `a` to `b`.
    fn add_way(&mut self, a: usize, b: usize, corners: &[DVec3], edges: &mut Vec<(usize, usize)>) {
        let mut before = a;
        for corner in corners.iter().skip(1).take(corners.len().saturating_sub(2)) {
            if let Some(cell) = self.ground.cell_at(*corner) {
                self.nodes.push((cell, *corner));
                edges.push((before, self.nodes.len() - 1));
                before = self.nodes.len() - 1;
            }
        }
        edges.push((before, b));
    }

    /// The connected part to which each viewpoint belongs.
    fn label_parts(&self, edges: &[(usize, usize)]) -> Vec<usize> {
        let mut part: Vec<usize> = (0..self.nodes.len()).collect();
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for (a, b) in edges {
                let low = part[*a].min(part[*b]);
                changed |= part[*a] != low || part[*b] != low;
                (part[*a], part[*b]) = (low, low);
            }
        }
        part
    }

    fn into_graph(self, edges: &[(usize, usize)]) -> Result<ViewpointGraph, GraphError> {
        let mut graph = ViewpointGraph::default();
        let mut names = Vec::new();
        for (number, (cell, place)) in self.nodes.iter().enumerate() {
            let Ok(name) = ViewpointId::new(format!("v{number:03}")) else {
                continue;
            };
            graph.add_viewpoint(name.clone(), *place + DVec3::Z * EYE_M, Some(self.ground.storey_of_cell(*cell)))?;
            names.push(name);
        }
        for (a, b) in edges {
            graph.join_viewpoints(&names[*a], &names[*b])?;
        }
        Ok(graph)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{generate_house, model::RoomKind};
    use super::*;

    #[test]
    fn graphs_are_whole_and_every_room_has_a_viewpoint() {
        for seed in 0..8 {
            let house = generate_house(seed);
            let graph = viewpoint_graph(&house, &HouseGround::for_house(&house)).unwrap();
            assert_eq!(graph.count_components(), 1, "house {seed}");
            let places: Vec<DVec3> = graph.viewpoints().map(|id| graph.position_of(id).unwrap()).collect();
            for room in house.rooms.iter().filter(|room| room.kind != RoomKind::Staircase) {
                let base_m = f64::from(room.base_cm()) / 100.0 + EYE_M;
                let inside = |place: &&DVec3| room.outline.holds_m(place.x, place.y) && (place.z - base_m).abs() < 0.2;
                assert!(places.iter().any(|place| inside(&place)), "house {seed}: {room:?}");
            }
            let levels: Vec<_> = graph.viewpoints().filter_map(|id| graph.level_of(id)).collect();
            assert_eq!(levels.iter().max(), Some(&house.storeys));
            assert!(graph.edges().all(|(_, _, length_m)| length_m < 6.0));
        }
    }
}
