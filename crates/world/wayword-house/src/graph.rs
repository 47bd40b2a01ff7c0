//! Makes the viewpoint graph of a house from its standing places and its walkable ground.
//!
//! Places of hallways move to the middle of the hallway, and of two places under a metre apart one goes, where the other serves as
//! well. Then every two that are near and between which one walks straight, or nearly so, are joined. So the distance over the graph
//! is about that over the ground.

use super::{
    ground::{GroundCell, HouseGround},
    model::{HALF_WALL_CM, House, HouseRoom, RoomKind},
    open_line::OpenFloor,
    standing_places::{HouseRoadMap, standing_places},
};
use std::collections::BinaryHeap;
use wayword_core::{DVec3, ViewpointGraph, ViewpointId, graph::GraphError};

/// Height of the eye above the ground, metres.
pub const EYE_M: f64 = 1.5;
/// Of two viewpoints nearer to each other than this, one goes, metres.
const MERGED_M: f64 = 1.0;
/// Without a viewpoint, the ways between its neighbours may be so many times as long as with it.
const MAX_MERGE_DETOUR_FACTOR: f64 = 1.1;
/// Longest edge, metres.
const MAX_EDGE_M: f64 = 3.5;
/// A walk with one bend is nearly straight if it is at most so many times as long as the straight line.
const MAX_BEND_FACTOR: f64 = 1.15;
/// The same for a walk around furniture, over which one sees: both ends are in one room, or the way leads over a place that goes.
const MAX_ROUND_FACTOR: f64 = 1.25;
/// Where the bend may lie: shares of the straight line, and metres beside it.
const BEND_SHARES: [f64; 3] = [0.5, 0.25, 0.75];
const BENDS_BESIDE_M: [f64; 5] = [0.1, 0.2, 0.35, 0.5, 0.7];
/// An edge is left out where the way over a third viewpoint is at most so many times as long: it would lead past that one.
const MAX_PASSING_FACTOR: f64 = 1.015;

/// The graph has a viewpoint in every room, in or beside every opening and on the stairs, and others between them. Two viewpoints up to
/// 3.5 m apart are joined where one can walk straight from one to the other, with a slight bend, or around furniture of one room, and no wall or open door stands
/// between them; an edge that would lead past a third
/// viewpoint is left out. Every viewpoint can be reached from every other.
///
/// # Errors
/// Never for a generated house. In an edited house, names and positions are checked.
pub fn viewpoint_graph(house: &House, ground: &HouseGround) -> Result<ViewpointGraph, GraphError> {
    graph_over_places(house, ground, &standing_places(house, ground))
}

/// As [`viewpoint_graph`], from the standing places of the house.
pub(super) fn graph_over_places(
    house: &House,
    ground: &HouseGround,
    places: &[(GroundCell, DVec3)],
) -> Result<ViewpointGraph, GraphError> {
    let mut nodes: Vec<(GroundCell, DVec3)> = Vec::with_capacity(places.len());
    for (cell, place) in places {
        let moved = middle_of_hallway(house, ground, *cell, *place).unwrap_or((*cell, *place));
        if nodes.iter().all(|(cell, _)| *cell != moved.0) {
            nodes.push(moved);
        }
    }
    let mut joins = WalkableJoins::new(house, ground, nodes);
    let kept = joins.merge_close(house);
    let mut edges = joins.edges_among(&kept);
    let mut map = HouseRoadMap { ground, nodes: kept.iter().map(|at| joins.nodes[*at]).collect() };
    map.connect_parts(&mut edges);
    into_graph(ground, &map.nodes, &edges)
}

/// The lengths of the shortest ways from a place to all over those that are kept, metres (Dijkstra 1959).
fn lengths_over(joined: &[Vec<(usize, f64)>], start: usize, is_kept: &[bool]) -> Vec<f64> {
    let mut lengths = vec![f64::INFINITY; joined.len()];
    lengths[start] = 0.0;
    // Whole micrometres, because floating-point numbers have no order.
    let micrometres = |length_m: f64| std::cmp::Reverse((length_m * 1e6) as u64);
    let mut open = BinaryHeap::from([(micrometres(0.0), start)]);
    while let Some((length, at)) = open.pop() {
        if length > micrometres(lengths[at]) {
            continue;
        }
        for (next, length_m) in joined[at].iter().filter(|(next, _)| is_kept[*next]) {
            let through_m = lengths[at] + length_m;
            if through_m < lengths[*next] {
                lengths[*next] = through_m;
                open.push((micrometres(through_m), *next));
            }
        }
    }
    lengths
}

/// The place in the middle between the long walls of a hallway, for a place of it, if one can walk there.
fn middle_of_hallway(
    house: &House,
    ground: &HouseGround,
    cell: GroundCell,
    place: DVec3,
) -> Option<(GroundCell, DVec3)> {
    let hallway = house.rooms.iter().find(|room| room.kind == RoomKind::Hallway && is_in_room(room, cell, place))?;
    let area = hallway.inner_area();
    let (x_cm, y_cm) = area.centre();
    let middle = if area.width() >= area.depth() {
        place.with_y(f64::from(y_cm) / 100.0)
    } else {
        place.with_x(f64::from(x_cm) / 100.0)
    };
    let moved = ground.cell_at(middle).filter(|moved| moved.layer == cell.layer && ground.is_straight(cell, *moved))?;
    Some((moved, ground.middle_of_cell(moved)))
}

/// Whether a place is on the floor of a room.
fn is_in_room(room: &HouseRoom, cell: GroundCell, place: DVec3) -> bool {
    cell.layer == room.floor as usize && room.inner_area().holds_m(place.x, place.y)
}

/// Places, and the walks by which each two of them can be joined.
struct WalkableJoins {
    nodes: Vec<(GroundCell, DVec3)>,
    /// For each place, those to which an edge may lead, with its length in metres.
    joined: Vec<Vec<(usize, f64)>>,
    floors: Vec<OpenFloor>,
}

impl WalkableJoins {
    fn new(house: &House, ground: &HouseGround, nodes: Vec<(GroundCell, DVec3)>) -> Self {
        // A place in an opening is in the rooms on both sides of it.
        let is_at_room = |room: &HouseRoom, cell: GroundCell, place: DVec3| {
            cell.layer == room.floor as usize && room.outline.inset(-HALF_WALL_CM).holds_m(place.x, place.y)
        };
        let rooms_of = |(cell, place): &(GroundCell, DVec3)| -> Vec<usize> {
            (0..house.rooms.len()).filter(|room| is_at_room(&house.rooms[*room], *cell, *place)).collect()
        };
        let rooms: Vec<Vec<usize>> = nodes.iter().map(rooms_of).collect();
        let storeys = house.rooms.iter().map(|room| room.floor as usize + 1).max().unwrap_or_default();
        let floors: Vec<OpenFloor> = (0..storeys).map(|storey| OpenFloor::for_storey(house, storey)).collect();
        let mut joins = Self { joined: vec![Vec::new(); nodes.len()], nodes, floors };
        for a in 0..joins.nodes.len() {
            for b in a + 1..joins.nodes.len() {
                let (from, to) = (joins.nodes[a], joins.nodes[b]);
                let is_one_room = rooms[a].iter().any(|room| rooms[b].contains(room));
                if from.1.distance(to.1) <= MAX_EDGE_M
                    && (is_nearly_straight(ground, from, to) || is_one_room && is_round_furniture(ground, from.1, to.1))
                    && joins.is_clear(a, b)
                {
                    joins.join(a, b);
                }
            }
        }
        joins
    }

    fn join(&mut self, a: usize, b: usize) {
        let length_m = self.length_m(a, b);
        self.joined[a].push((b, length_m));
        self.joined[b].push((a, length_m));
    }

    /// Whether no wall and no open door stands between two places of one storey. Between others this is not asked.
    fn is_clear(&self, a: usize, b: usize) -> bool {
        let ((cell, from), (other, to)) = (self.nodes[a], self.nodes[b]);
        let floor = self.floors.get(cell.layer).filter(|_| cell.layer == other.layer);
        floor.is_none_or(|floor| floor.is_clear(from, to))
    }

    fn length_m(&self, a: usize, b: usize) -> f64 {
        self.nodes[a].1.distance(self.nodes[b].1)
    }

    /// The places that remain when, of two under a metre apart, one goes; the nearest pairs first.
    fn merge_close(&mut self, house: &House) -> Vec<usize> {
        let close = (0..self.nodes.len()).flat_map(|a| {
            let near = self.joined[a].iter().filter(move |(b, length_m)| a < *b && *length_m < MERGED_M);
            near.map(move |(b, length_m)| (*length_m, a, *b))
        });
        let mut close: Vec<(f64, usize, usize)> = close.collect();
        close.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut is_kept = vec![true; self.nodes.len()];
        for (_, a, b) in close {
            if is_kept[a] && is_kept[b] {
                // The later place is the less important one.
                for (gone, stays) in [(b, a), (a, b)] {
                    let before = self.joined.clone();
                    self.take_over_joins(gone, stays, &is_kept);
                    if self.can_go(gone, &is_kept, house) {
                        is_kept[gone] = false;
                        break;
                    }
                    self.joined = before;
                }
            }
        }
        (0..self.nodes.len()).filter(|at| is_kept[*at]).collect()
    }

    /// Joins a place with the neighbours of another that goes, where the way over that one is nearly straight.
    fn take_over_joins(&mut self, gone: usize, stays: usize, is_kept: &[bool]) {
        for (to, last_m) in self.joined[gone].clone() {
            let is_joined = self.joined[stays].iter().any(|(other, _)| *other == to);
            let straight_m = self.length_m(stays, to);
            let over_m = self.length_m(stays, gone) + last_m;
            if to != stays
                && is_kept[to]
                && !is_joined
                && straight_m <= MAX_EDGE_M
                && over_m <= MAX_ROUND_FACTOR * straight_m
                && self.is_clear(stays, to)
            {
                self.join(stays, to);
            }
        }
    }

    /// Whether the ways between the neighbours of a place stay about as long without it, and its room keeps another place.
    fn can_go(&self, gone: usize, is_kept: &[bool], house: &House) -> bool {
        let (cell, place) = self.nodes[gone];
        if let Some(room) = house.rooms.iter().find(|room| is_in_room(room, cell, place)) {
            let here =
                |at: &usize| *at != gone && is_kept[*at] && is_in_room(room, self.nodes[*at].0, self.nodes[*at].1);
            if !(0..self.nodes.len()).any(|at| here(&at)) {
                return false;
            }
        }
        let mut without = is_kept.to_vec();
        without[gone] = false;
        let neighbours: Vec<(usize, f64)> = self.joined[gone].iter().copied().filter(|(at, _)| is_kept[*at]).collect();
        neighbours.iter().all(|(from, first_m)| {
            let lengths = lengths_over(&self.joined, *from, &without);
            neighbours.iter().all(|(to, last_m)| lengths[*to] <= MAX_MERGE_DETOUR_FACTOR * (first_m + last_m))
        })
    }

    /// The edges among some places, as indices into `kept`, the shortest first. An edge that leads past a third place is left out.
    fn edges_among(&self, kept: &[usize]) -> Vec<(usize, usize)> {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (a, at) in kept.iter().enumerate() {
            for (other, length_m) in &self.joined[*at] {
                pairs.extend(kept.binary_search(other).ok().filter(|b| a < *b).map(|b| (*length_m, a, b)));
            }
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut neighbours: Vec<Vec<(usize, f64)>> = vec![Vec::new(); kept.len()];
        let mut edges = Vec::new();
        for (length_m, a, b) in pairs {
            let leads_past = neighbours[a].iter().any(|(third, first_m)| {
                let mut last_m = neighbours[b].iter().filter(|(other, _)| other == third).map(|(_, last_m)| last_m);
                last_m.any(|last_m| first_m + last_m <= MAX_PASSING_FACTOR * length_m)
            });
            if !leads_past {
                neighbours[a].push((b, length_m));
                neighbours[b].push((a, length_m));
                edges.push((a, b));
            }
        }
        edges
    }
}

/// Whether one can walk straight from one place to another, or with one slight bend.
fn is_nearly_straight(
    ground: &HouseGround,
    (from, place): (GroundCell, DVec3),
    (to, other): (GroundCell, DVec3),
) -> bool {
    if ground.is_straight(from, to) {
        return true;
    }
    let way = other - place;
    let beside = DVec3::new(-way.y, way.x, 0.0).normalize_or_zero();
    let length_m = way.length();
    let bends = BEND_SHARES.into_iter().flat_map(|share| {
        BENDS_BESIDE_M
            .into_iter()
            .flat_map(move |off_m| [off_m, -off_m].map(|off_m| place + way * share + beside * off_m))
    });
    let is_short = |bend: &DVec3| place.distance(*bend) + bend.distance(other) <= MAX_BEND_FACTOR * length_m;
    bends
        .filter(is_short)
        .filter_map(|bend| ground.cell_at(bend))
        .any(|bend| ground.is_straight(from, bend) && ground.is_straight(bend, to))
}

/// Whether a walker gets from one place to another of a room on a way that is not much longer than the straight line.
fn is_round_furniture(ground: &HouseGround, from: DVec3, to: DVec3) -> bool {
    ground.shortest_route(from, to).is_ok_and(|way| way.length_m <= MAX_ROUND_FACTOR * from.distance(to))
}

fn into_graph(
    ground: &HouseGround,
    nodes: &[(GroundCell, DVec3)],
    edges: &[(usize, usize)],
) -> Result<ViewpointGraph, GraphError> {
    let mut graph = ViewpointGraph::default();
    let mut names = Vec::new();
    for (number, (cell, place)) in nodes.iter().enumerate() {
        let Ok(name) = ViewpointId::new(format!("v{number:03}")) else {
            continue;
        };
        graph.add_viewpoint(name.clone(), *place + DVec3::Z * EYE_M, Some(ground.storey_of_cell(*cell)))?;
        names.push(name);
    }
    for (a, b) in edges {
        graph.join_viewpoints(&names[*a], &names[*b])?;
    }
    Ok(graph)
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
    #[test]
    fn distances_over_the_graph_are_about_those_over_the_ground() {
        let (mut near, mut arrived, mut close, mut joined, mut edges, mut short) = (0, 0, 0, 0, 0, 0);
        for seed in 0..12 {
            let house = generate_house(seed);
            let ground = HouseGround::for_house(&house);
            let graph = viewpoint_graph(&house, &ground).unwrap();
            let feet = |id| graph.position_of(id).unwrap() - DVec3::Z * EYE_M;
            edges += graph.edges().count();
            short += graph.edges().filter(|(_, _, length_m)| *length_m < 0.5).count();
            for a in graph.viewpoints() {
                let over_graph = graph.distances_from(a).unwrap();
                for b in graph.viewpoints().filter(|b| *b > a && feet(b).distance(feet(a)) < 3.0) {
                    let ground_m = ground.shortest_route(feet(a), feet(b)).unwrap().length_m;
                    near += usize::from(ground_m < 3.0);
                    arrived += usize::from(ground_m < 3.0 && over_graph[b] < 3.0);
                    close += usize::from(ground_m < 1.2);
                    joined += usize::from(ground_m < 1.2 && graph.neighbours_of(a).contains(&b));
                }
            }
        }
        // A way of "0 m" stays where a wall or a door stands between a place's neighbours and the place that it would go into.
        assert!(100 * short <= edges, "{short} of {edges}");
        assert!(near > 500 && 100 * arrived >= 93 * near, "{arrived} of {near}");
        assert!(close > 50 && 100 * joined >= 98 * close, "{joined} of {close}");
    }

    #[test]
    fn no_way_between_near_places_leads_a_long_way_round() {
        // In house 704 a dining table stands behind the door of its room.
        for seed in [704, 701, 702, 703, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9] {
            let house = generate_house(seed);
            let ground = HouseGround::for_house(&house);
            let graph = viewpoint_graph(&house, &ground).unwrap();
            let feet = |id: &ViewpointId| graph.position_of(id).unwrap() - DVec3::Z * EYE_M;
            for a in graph.viewpoints() {
                let over_graph = graph.distances_from(a).unwrap();
                let is_near =
                    |b: &&ViewpointId| *b > a && (feet(b).z - feet(a).z).abs() < 0.5 && feet(b).distance(feet(a)) < 4.0;
                for b in graph.viewpoints().filter(is_near) {
                    let ground_m = ground.shortest_route(feet(a), feet(b)).unwrap().length_m;
                    let bound_m = 2.0 * ground_m + 3.0;
                    assert!(
                        ground_m > 5.0 || over_graph[b] <= bound_m,
                        "house {seed}: {a} to {b}: {} m",
                        over_graph[b]
                    );
                }
            }
        }
    }

    #[test]
    fn viewpoints_of_a_hallway_stand_in_its_middle() {
        let (mut all, mut middle) = (0, 0);
        for seed in 0..12 {
            let house = generate_house(seed);
            let graph = viewpoint_graph(&house, &HouseGround::for_house(&house)).unwrap();
            for room in house.rooms.iter().filter(|room| room.kind == RoomKind::Hallway) {
                let area = room.inner_area();
                let eyes = graph.viewpoints().filter_map(|id| graph.position_of(id));
                let floor_m = f64::from(room.base_cm()) / 100.0;
                for eye in eyes.filter(|eye| area.holds_m(eye.x, eye.y) && (eye.z - EYE_M - floor_m).abs() < 0.1) {
                    let (x_cm, y_cm) = area.centre();
                    let across_m = if area.width() >= area.depth() {
                        eye.y - f64::from(y_cm) / 100.0
                    } else {
                        eye.x - f64::from(x_cm) / 100.0
                    };
                    all += 1;
                    middle += usize::from(across_m.abs() < 0.06);
                }
            }
        }
        assert!(all > 20 && 10 * middle >= 9 * all, "{middle} of {all}");
    }
}
