//! Where one can walk in a home, told from the boxes of what is in it.

use super::{error::HomeError, graph::EnvironmentGraph};
use crate::raster::Raster;
use wayword_core::DVec3;

/// Side of the floor's cells, metres.
const CELL_M: f64 = 0.1;
/// Half the width of who walks, metres.
const RADIUS_M: f64 = 0.2;
/// A room ends so far inside its box: walls stand on its edge, whether or not they are in the graph.
const WALL_M: f64 = 0.15;
/// How far a door's passage reaches into the rooms on both sides, metres.
const REACH_M: f64 = 0.5;
/// What lies lower than this above the floor is stepped over, and what hangs higher is walked under, metres.
const IN_WAY_M: [f64; 2] = [0.1, 1.7];
/// Largest home, metres, and most things in it: keeps the time that a hostile graph can cost to seconds.
const MAX_SIDE_M: f64 = 80.0;
const MAX_NODES: usize = 5000;

/// A rectangle of floor: lower and upper corner.
type Area = ([f64; 2], [f64; 2]);

fn holds((low, high): &Area, at: [f64; 2]) -> bool {
    (0..2).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]))
}

fn grown((low, high): (DVec3, DVec3), by: [f64; 2]) -> Area {
    ([low.x - by[0], low.y - by[1]], [high.x + by[0], high.y + by[1]])
}

/// The floor's height and its free cells: rooms and the passages between them, less what stands in the way.
pub(super) fn raster(graph: &EnvironmentGraph) -> Result<(f64, Raster), HomeError> {
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
    let inside: Vec<Area> = rooms.iter().map(|room| grown(*room, [-(WALL_M + RADIUS_M); 2])).collect();
    let passages: Vec<Area> = boxed().filter(|(node, _)| node.is_passage()).map(|(_, door)| passage(door)).collect();
    let in_way = |low: &DVec3, high: &DVec3| low.z < floor_m + IN_WAY_M[1] && high.z > floor_m + IN_WAY_M[0];
    let things = boxed().filter(|(node, _)| node.is_thing() && !node.is_passage());
    let blocked: Vec<Area> =
        things.filter(|(_, (low, high))| in_way(low, high)).map(|(_, thing)| grown(thing, [RADIUS_M; 2])).collect();
    let is_free = |at: [f64; 2]| {
        let any = |areas: &[Area]| areas.iter().any(|area| holds(area, at));
        (any(&inside) || any(&passages)) && !any(&blocked)
    };
    let raster = Raster::over([low.x, low.y], [high.x, high.y], CELL_M, is_free);
    let mut raster = raster.ok_or_else(|| HomeError::Floor("has rooms without an area".to_owned()))?;
    raster.keep_largest_part();
    Ok((floor_m, raster))
}

/// The floor in a door and before it, on both sides of the wall: a door is wide along the wall and thin across.
fn passage(door: (DVec3, DVec3)) -> Area {
    let size = door.1 - door.0;
    let along = |length: f64| -(RADIUS_M.min(length / 2.0 - CELL_M));
    if size.x >= size.y { grown(door, [along(size.x), REACH_M]) } else { grown(door, [REACH_M, along(size.y)]) }
}
