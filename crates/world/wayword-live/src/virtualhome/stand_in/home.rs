//! Presents a generated house as VirtualHome does: as an environment graph, colours of instances, and pictures.

use crate::{
    tdw::stand_in::{StandInWorld, id_colour, png},
    unity::{unity_from_wayword, wayword_from_unity},
};
use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Map, Value, json};
use wayword_core::DVec3;
use wayword_house::ObjectRole;
use wayword_render::PinholeCamera;

/// The first id of a room: above the ids of objects.
const FIRST_ROOM_ID: usize = 100_000;

/// A generated house that is presented as a home.
#[derive(Debug)]
pub(super) struct GeneratedHome {
    world: StandInWorld,
}

/// A node with its box.
fn node_json(id: u64, class: &str, category: &str, (low, high): (DVec3, DVec3)) -> Value {
    let (centre, size) = (unity_from_wayword((low + high) / 2.0), unity_from_wayword(high - low));
    json!({
        "id": id,
        "class_name": class.replace(' ', ""),
        "category": category,
        "prefab_name": format!("PRE_{id}"),
        "obj_transform": { "position": centre, "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0] },
        "bounding_box": { "center": centre, "size": size },
        "properties": [],
        "states": [],
    })
}

impl GeneratedHome {
    /// The first house with one storey from a seed on.
    pub(super) fn from_seed(seed: u64) -> Self {
        Self { world: StandInWorld::with_one_storey(seed) }
    }

    /// Rooms and objects, and which object is in which room.
    pub(super) fn graph_json(&self) -> Value {
        let house = &self.world.house_scene().house;
        let room_id = |room: usize| (FIRST_ROOM_ID + room) as u64;
        let mut nodes: Vec<Value> = house
            .rooms
            .iter()
            .enumerate()
            .map(|(index, room)| {
                let (area, base_cm) = (room.outline, room.base_cm());
                let low = DVec3::new(area.x0.into(), area.y0.into(), base_cm.into()) / 100.0;
                let high = DVec3::new(area.x1.into(), area.y1.into(), (base_cm + room.height_cm).into()) / 100.0;
                node_json(room_id(index), room.kind.word(), "Rooms", (low, high))
            })
            .collect();
        let mut edges = Vec::new();
        for (id, object) in self.world.coloured_objects() {
            let opening = house.openings.iter().find(|opening| opening.id == id);
            let (class, category) = match (opening, object.role) {
                // VirtualHome has both: a jamb for an open passage, and a door for one with a leaf.
                (Some(opening), _) if opening.is_passable() => {
                    (if opening.word() == "door" { "door" } else { "doorjamb" }, "Doors")
                }
                (_, ObjectRole::Furniture) => (object.name.as_str(), "Furniture"),
                _ => (object.name.as_str(), "Windows"),
            };
            nodes.push(node_json(id.into(), class, category, object.bounds_m));
            edges.push(json!({ "from_id": id, "to_id": room_id(object.room), "relation_type": "INSIDE" }));
        }
        json!({ "nodes": nodes, "edges": edges })
    }

    /// The colour of each object, with channels between 0 and 1.
    pub(super) fn colours_json(&self) -> Value {
        let colour = |id: u32| json!(id_colour(id).map(|channel| f64::from(channel) / 255.0));
        Value::Object(self.world.coloured_objects().map(|(id, _)| (id.to_string(), colour(id))).collect::<Map<_, _>>())
    }

    /// A camera's picture, as a PNG in base64; `None` for modes that the stand-in does not have.
    pub(super) fn encode_picture(&self, camera: &Value, wanted: &Value) -> Option<String> {
        let number = |value: &Value| value.as_f64();
        let vector = |value: &Value| Some([number(&value["x"])?, number(&value["y"])?, number(&value["z"])?]);
        let side = |name: &str| wanted[name].as_u64().unwrap_or(256).clamp(1, 4096) as u32;
        let [pitch_deg, yaw_deg, _] = vector(&camera["rotation"])?;
        let camera = PinholeCamera {
            position: wayword_from_unity(vector(&camera["position"])?),
            heading_rad: yaw_deg.to_radians(),
            // Unity's positive rotation about its right axis looks down.
            elevation_rad: -pitch_deg.to_radians(),
            vertical_fov_rad: number(&camera["field_view"])?.clamp(1.0, 170.0).to_radians(),
            width: side("image_width"),
            height: side("image_height"),
        };
        let colour = |id: &u32| if self.world.is_object(*id) { id_colour(*id) } else { [0; 3] };
        let rgb = match wanted["mode"].as_str()? {
            "normal" => self.world.house_scene().render_picture(&camera).ok()?.rgb,
            "seg_inst" => {
                self.world.house_scene().render_object_ids(&camera).ok()?.ids.iter().flat_map(colour).collect()
            }
            _ => return None,
        };
        Some(BASE64_STANDARD.encode(png((camera.width, camera.height), &rgb)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::names::split_class_name;
    use wayword_house::generate_house;

    #[test]
    fn words_splits_the_joined_names_of_a_generated_house() {
        for house in (0..30).map(generate_house) {
            let things = house.furniture.iter().map(|piece| piece.name.to_string());
            let rooms = house.rooms.iter().map(|room| room.kind.word().to_owned());
            let openings = house.openings.iter().map(|opening| opening.word().to_owned());
            for name in things.chain(rooms).chain(openings) {
                assert_eq!(split_class_name(&name.replace(' ', "")), name);
            }
        }
    }
}
