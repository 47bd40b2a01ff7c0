//! Computes the walkable floor of a home from the boxes of its rooms, doors and objects.
//!
//! VirtualHome reports no navigation mesh. A cell is free if it lies inside a room, away from the walls, or in the passage
//! of a door, and no object's box is within the agent's radius.

use super::{error::HomeError, graph::EnvironmentGraph};
use crate::{live::FloorRectangle, raster::FloorRaster};
use wayword_core::DVec3;

/// Side of the floor's cells, metres.
const CELL_M: f64 = 0.1;
/// Half the width of the agent, metres.
const RADIUS_M: f64 = 0.2;
/// How far inside its box a room ends, metres: walls are on the box's edge even where the graph does not list them.
const WALL_M: f64 = 0.15;
/// How far a door's passage reaches into the rooms on both sides, metres.
const REACH_M: f64 = 0.5;
/// A position within this distance of the middle of a wall counts as in its doorway, metres.
const THRESHOLD_M: f64 = 0.25;
/// Heights above the floor between which objects are in the way, metres: the agent steps over lower ones and walks
/// under higher ones.
const IN_WAY_M: [f64; 2] = [0.1, 1.7];
/// Longest side of a home, metres. This limit and the next keep the work for a hostile graph to seconds.
const MAX_SIDE_M: f64 = 80.0;
/// Most nodes of a graph; one with more is refused.
const MAX_NODES: usize = 5000;

fn rectangle_contains((low, high): &FloorRectangle, at: [f64; 2]) -> bool {
    (0..2).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]))
}

fn grow_box((low, high): (DVec3, DVec3), by: [f64; 2]) -> FloorRectangle {
    ([low.x - by[0], low.y - by[1]], [high.x + by[0], high.y + by[1]])
}

/// The floor's height and its free cells: the rooms and the passages between them, without the area of obstacles.
pub(super) fn compute_floor(graph: &EnvironmentGraph) -> Result<(f64, FloorRaster), HomeError> {
    if graph.nodes.len() > MAX_NODES {
        let found = graph.nodes.len();
        return Err(HomeError::Floor(format!("has {found} nodes: expected at most {MAX_NODES}")));
    }
    let boxed = || graph.nodes.iter().filter_map(|node| Some((node, node.bounding_box?.bounds_m()?)));
    let rooms: Vec<_> = boxed().filter(|(node, _)| node.is_room()).map(|(_, bounds)| bounds).collect();
    let Some(floor_m) = rooms.iter().map(|(low, _)| low.z).min_by(f64::total_cmp) else {
        return Err(HomeError::Floor("has no room with a box".to_owned()));
    };
    let (low, high) = rooms
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), room| (low.min(room.0), high.max(room.1)));
    let size = high - low;
    if size.x > MAX_SIDE_M || size.y > MAX_SIDE_M {
        let reason = format!("is {:.0} m by {:.0} m large: expected at most {MAX_SIDE_M} m", size.x, size.y);
        return Err(HomeError::Floor(reason));
    }
    let inside: Vec<FloorRectangle> = rooms.iter().map(|room| grow_box(*room, [-(WALL_M + RADIUS_M); 2])).collect();
    let passages: Vec<FloorRectangle> =
        boxed().filter(|(node, _)| node.is_passage()).map(|(_, door)| passage_area(door)).collect();
    let in_way = |low: &DVec3, high: &DVec3| low.z < floor_m + IN_WAY_M[1] && high.z > floor_m + IN_WAY_M[0];
    let things = boxed().filter(|(node, _)| node.is_thing() && !node.is_passage());
    let blocked: Vec<FloorRectangle> =
        things.filter(|(_, (low, high))| in_way(low, high)).map(|(_, thing)| grow_box(thing, [RADIUS_M; 2])).collect();
    let is_free = |at: [f64; 2]| {
        let any = |areas: &[FloorRectangle]| areas.iter().any(|area| rectangle_contains(area, at));
        (any(&inside) || any(&passages)) && !any(&blocked)
    };
    let raster = FloorRaster::over_rectangle([low.x, low.y], [high.x, high.y], CELL_M, is_free);
    let mut raster = raster.ok_or_else(|| HomeError::Floor("has rooms without an area".to_owned()))?;
    raster.keep_largest_part();
    Ok((floor_m, raster))
}

/// The floor in a doorway and in front of it, on both sides of the wall. A door is wide along the wall and thin across.
fn passage_area(door: (DVec3, DVec3)) -> FloorRectangle {
    let size = door.1 - door.0;
    let along = |length: f64| -(RADIUS_M.min(length / 2.0 - CELL_M));
    if size.x >= size.y { grow_box(door, [along(size.x), REACH_M]) } else { grow_box(door, [REACH_M, along(size.y)]) }
}

/// The floor in each doorway. A door that is less thick than a wall counts as if it were as thick.
pub(super) fn threshold_areas(graph: &EnvironmentGraph) -> Vec<FloorRectangle> {
    let doors = graph.nodes.iter().filter(|node| node.is_passage()).filter_map(|node| node.bounding_box?.bounds_m());
    let threshold = |door: (DVec3, DVec3)| {
        let size = door.1 - door.0;
        let across = |thick: f64| (THRESHOLD_M - thick / 2.0).max(0.0);
        if size.x >= size.y { grow_box(door, [0.0, across(size.y)]) } else { grow_box(door, [across(size.x), 0.0]) }
    };
    doors.map(threshold).collect()
}

#[cfg(test)]
mod tests {
    use super::super::graph::{BoundingBox, EnvironmentNode};
    use super::*;
    use proptest::prelude::*;

    fn node(class_name: &str, category: &str, center: [f64; 3], size: [f64; 3]) -> EnvironmentNode {
        let bounding_box = Some(BoundingBox { center, size });
        EnvironmentNode { id: 0, class_name: class_name.into(), category: category.into(), bounding_box }
    }

    /// Two rooms of 4 m by 4 m with a wall between at x = 0, and a door in it; Unity's axes.
    fn two_rooms(more: Vec<EnvironmentNode>) -> EnvironmentGraph {
        let size = [4.0, 2.5, 4.0];
        let mut nodes =
            vec![node("kitchen", "Rooms", [-2.0, 1.25, 0.0], size), node("bedroom", "Rooms", [2.0, 1.25, 0.0], size)];
        nodes.extend(more);
        EnvironmentGraph { nodes }
    }

    fn door() -> EnvironmentNode {
        node("doorjamb", "Doors", [0.0, 1.0, 0.0], [0.2, 2.0, 1.0])
    }

    #[test]
    fn raster_connects_rooms_only_through_a_door() {
        let (from, to) = ([-2.0, 1.0], [2.0, 1.0]);
        let (floor_m, raster) = compute_floor(&two_rooms(vec![door()])).unwrap();
        let way = raster.shortest_way(from, to).unwrap();
        assert_eq!(floor_m, 0.0);
        let crossing = way.windows(2).find(|leg| leg[0][0] < 0.0 && leg[1][0] >= 0.0).unwrap();
        assert!(crossing.iter().all(|corner| corner[1].abs() < 0.9), "{way:?} misses the door");
        let (_, closed) = super::compute_floor(&two_rooms(Vec::new())).unwrap();
        assert_eq!(closed.shortest_way(from, to), None);
    }

    #[test]
    fn raster_blocks_only_objects_at_walking_height() {
        let clear =
            |thing: EnvironmentNode| compute_floor(&two_rooms(vec![door(), thing])).unwrap().1.is_free([2.0, 0.0]);
        let small = [0.5, 0.05, 0.5];
        assert!(!clear(node("coffeetable", "Furniture", [2.0, 0.25, 0.0], [0.5, 0.5, 0.5])));
        assert!(clear(node("rug", "Decor", [2.0, 0.02, 0.0], small)));
        assert!(clear(node("ceilinglamp", "Lamps", [2.0, 2.3, 0.0], small)));
    }

    #[test]
    fn raster_refuses_graphs_without_rooms_and_huge_ones() {
        let refused = |graph: &EnvironmentGraph| compute_floor(graph).unwrap_err().to_string();
        assert!(refused(&EnvironmentGraph::default()).contains("no room"));
        let wide = node("hall", "Rooms", [0.0, 1.0, 0.0], [500.0, 2.0, 4.0]);
        assert!(refused(&two_rooms(vec![wide])).contains("500 m"));
        assert!(refused(&two_rooms(vec![door(); 5001])).contains("at most 5000"));
    }

    proptest! {
        #[test]
        fn no_boxes_break_it(
            boxes in prop::collection::vec(
                (0..3_usize, prop::array::uniform3(-1e9..1e9f64), prop::array::uniform3(-9.0..9.0f64), any::<bool>()), 0..12,
            ),
        ) {
            let kinds = [("kitchen", "Rooms"), ("doorjamb", "Doors"), ("sofa", "Furniture")];
            let one = |(kind, center, size, near): (usize, [f64; 3], [f64; 3], bool)| {
                let center = if near { center.map(|number| number % 10.0) } else { center };
                node(kinds[kind].0, kinds[kind].1, center, size)
            };
            let graph = EnvironmentGraph { nodes: boxes.into_iter().map(one).collect() };
            if let Ok((floor_m, raster)) = compute_floor(&graph) {
                prop_assert!(floor_m.is_finite());
                prop_assert!(raster.viewpoint_places().iter().all(|place| raster.is_free(*place)));
            }
        }
    }
}
