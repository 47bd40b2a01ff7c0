//! Chooses the places of a house at which its paths begin and end, and from which its viewpoint graph is made.
//!
//! They are placed in this order: in openings and on stairs, in the most open spot of every room, then wherever there is still space.
//! Parts that no straight walks join then get places along the shortest way between them. So a walk over all of them has straight
//! legs alone. The random paths of a seed depend on their order: whoever changes it changes all paths.

use super::{
    ground::{GroundCell, HouseGround},
    model::House,
};
use std::collections::BTreeMap;
use wayword_core::DVec3;

/// Least distance between two places, except in doorways and on stairs, metres.
const MIN_PLACE_DISTANCE_M: f64 = 1.8;
/// Least distance to walls and furniture, so that they do not fill the view: cells beyond the walker's radius.
const MIN_CLEARANCE_CELLS: u32 = 4;
/// Longest straight walk between two places, metres: long enough to join two rows of them.
const MAX_WALK_M: f64 = 3.0;

/// The standing places of a house, each with its cell of the ground and its position on the ground.
pub(super) fn standing_places(house: &House, ground: &HouseGround) -> Vec<(GroundCell, DVec3)> {
    let mut map = HouseRoadMap { ground, nodes: Vec::new() };
    map.add_fixed_places(house);
    let clearances = ground.all_clearances();
    map.enter_rooms(house, &clearances);
    map.fill_open_floor(&clearances);
    let mut walks = map.straight_walks();
    map.connect_parts(&mut walks);
    map.nodes
}

/// Places that are joined by walks while they are being made: a cell of the ground and its position for each place.
pub(super) struct HouseRoadMap<'a> {
    pub(super) ground: &'a HouseGround,
    pub(super) nodes: Vec<(GroundCell, DVec3)>,
}

impl HouseRoadMap<'_> {
    fn add_cell(&mut self, cell: GroundCell) {
        if self.nodes.iter().all(|(other, _)| *other != cell) {
            self.nodes.push((cell, self.ground.middle_of_cell(cell)));
        }
    }

    /// Adds places in openings and on the stairs.
    fn add_fixed_places(&mut self, house: &House) {
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

    /// Adds further cells, the most open ones first, each at least `MIN_PLACE_DISTANCE_M` from the others.
    fn fill_open_floor(&mut self, clearances: &[Vec<u32>]) {
        let is_open = |cell: &GroundCell| clearances[cell.layer][cell.index] >= MIN_CLEARANCE_CELLS;
        let mut cells: Vec<GroundCell> = self.ground.free_cells().filter(is_open).collect();
        cells.sort_by_key(|cell| (std::cmp::Reverse(clearances[cell.layer][cell.index]), *cell));
        for cell in cells {
            let place = self.ground.middle_of_cell(cell);
            let far = |(_, other): &(GroundCell, DVec3)| {
                (other.z - place.z).abs() > 1.0 || other.distance(place) >= MIN_PLACE_DISTANCE_M
            };
            if self.nodes.iter().all(far) {
                self.nodes.push((cell, place));
            }
        }
    }

    /// Pairs of near places between which one can walk straight.
    fn straight_walks(&self) -> Vec<(usize, usize)> {
        let mut edges = Vec::new();
        for (a, (from, place)) in self.nodes.iter().enumerate() {
            for (b, (to, other)) in self.nodes.iter().enumerate().skip(a + 1) {
                if place.distance(*other) <= MAX_WALK_M && self.ground.is_straight(*from, *to) {
                    edges.push((a, b));
                }
            }
        }
        edges
    }

    /// Joins parts that are not connected, with places at the corners of the shortest way between them.
    pub(super) fn connect_parts(&mut self, edges: &mut Vec<(usize, usize)>) {
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

    /// Adds places at the inner corners of a way, and edges along it from place `a` to `b`.
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

    /// The connected part to which each place belongs.
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
}
