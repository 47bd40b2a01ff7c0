//! Writes the navigation data of a house: rooms, objects, walkable cells, viewpoint graph.

use super::{
    super::{
        graph::EYE_M,
        ground::{HouseGround, RADIUS_CM},
        model::House,
        objects::{self, ObjectRole},
    },
    SaveError,
};
use serde_json::{Value, json};
use wayword_core::ViewpointGraph;

/// Navigation data as JSON, in the world frame (metres, z up, headings clockwise from +y).
///
/// `walkable.layers` has one entry for each storey and one for the stairs. Its `runs` are
/// `[row, first column, last column]` of cells on which one can stand; columns count along x and rows along y, from
/// `origin_m`. `house` is the model itself.
///
/// # Errors
/// When the model cannot be written as JSON.
pub fn navigation_json(house: &House, ground: &HouseGround, graph: &ViewpointGraph) -> Result<Value, SaveError> {
    let rooms = house.rooms.iter().map(|room| {
        let area = room.inner_area();
        let metres = [area.x0, area.y0, area.x1, area.y1].map(|edge| f64::from(edge) / 100.0);
        json!({ "name": room.kind.word(), "level": room.floor + 1, "floor_m": f64::from(room.base_cm()) / 100.0, "area_m": metres })
    });
    let things = objects::objects_by_id(house).into_iter().filter(|(_, object)| object.role != ObjectRole::Shell);
    let things = things.map(|(id, object)| {
        let (low, high) = object.bounds_m;
        json!({ "id": id, "name": object.name, "colour": object.colour, "room": object.room, "low_m": low.to_array(), "high_m": high.to_array() })
    });
    let viewpoints = graph.viewpoints().map(|id| {
        let eye = graph.position_of(id).unwrap_or_default();
        json!({ "id": id, "eye_m": eye.to_array(), "level": graph.level_of(id) })
    });
    let edges = graph.edges().map(|(a, b, length_m)| json!([a, b, length_m]));
    Ok(json!({
        "format": "wayword-house-navigation",
        "version": 1,
        "seed": house.seed,
        "eye_height_m": EYE_M,
        "walker_radius_m": f64::from(RADIUS_CM) / 100.0,
        "rooms": rooms.collect::<Vec<_>>(),
        "objects": things.collect::<Vec<_>>(),
        "viewpoints": viewpoints.collect::<Vec<_>>(),
        "edges": edges.collect::<Vec<_>>(),
        "walkable": ground.to_json(),
        "house": serde_json::to_value(house)?,
    }))
}
