//! The stand-in's state: the scene, avatars and settings that the commands so far have made.

use super::world::{StandInWorld, StandInWorlds};
use crate::unity::{wayword_forward_from_unity_rotation, wayword_from_unity};
use serde_json::Value;
use std::sync::Arc;
use wayword_render::PinholeCamera;

/// An avatar with its camera.
#[derive(Debug, Clone)]
pub(super) struct StandInAvatar {
    pub(super) id: String,
    pub(super) position: [f64; 3],
    /// x, y, z, w.
    pub(super) rotation: [f64; 4],
    pub(super) field_of_view_deg: f64,
    pub(super) pass_masks: Vec<String>,
}

/// Which avatars' pictures are asked for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum PictureDemand {
    None,
    Once(Vec<String>),
    Always(Vec<String>),
}

/// The state of the imitated build.
#[derive(Debug)]
pub(super) struct BuildState {
    pub(super) worlds: StandInWorlds,
    /// The house as it is drawn now.
    pub(super) world: Arc<StandInWorld>,
    pub(super) version: &'static str,
    pub(super) avatars: Vec<StandInAvatar>,
    /// Width and height of pictures, pixels.
    pub(super) size: (u32, u32),
    /// Whether the `_img` pass is PNG; otherwise JPEG.
    pub(super) png: bool,
    pub(super) pictures: PictureDemand,
    pub(super) has_quit: bool,
    asked_version: bool,
}

impl BuildState {
    pub(super) fn new(worlds: StandInWorlds, version: &'static str) -> Self {
        Self {
            world: worlds.loaded_world(),
            worlds,
            version,
            avatars: Vec::new(),
            size: (256, 256),
            png: true,
            pictures: PictureDemand::None,
            has_quit: false,
            asked_version: false,
        }
    }

    /// Whether it has reported its version.
    pub(super) fn is_known(&self) -> bool {
        self.asked_version
    }

    /// Carries out a command.
    pub(super) fn obey_command(&mut self, kind: &str, command: &Value) {
        match kind {
            "load_scene" | "add_scene" => {
                self.avatars.clear();
                self.worlds.enter_scene(command["name"].as_str().unwrap_or_default());
                self.world = self.worlds.loaded_world();
            }
            "add_object" => self.world = self.worlds.furnished_world(),
            "create_avatar" => self.avatars.push(StandInAvatar {
                id: command["id"].as_str().unwrap_or("a").to_owned(),
                position: [0.0; 3],
                rotation: [0.0, 0.0, 0.0, 1.0],
                // The default of the genuine build.
                field_of_view_deg: 54.43223,
                pass_masks: vec!["_img".to_owned()],
            }),
            "set_screen_size" => self.size = (picture_side(command, "width"), picture_side(command, "height")),
            "set_img_pass_encoding" => self.png = command["value"].as_bool().unwrap_or(true),
            "send_images" => {
                let ids = texts_from_json(&command["ids"]);
                self.pictures = match command["frequency"].as_str() {
                    Some("always") => PictureDemand::Always(ids),
                    Some("never") => PictureDemand::None,
                    _ => PictureDemand::Once(ids),
                };
            }
            "send_version" => self.asked_version = true,
            "terminate" => self.has_quit = true,
            _ => self.move_avatar(kind, command),
        }
    }

    fn move_avatar(&mut self, kind: &str, command: &Value) {
        let id = command["avatar_id"].as_str().unwrap_or("a");
        let Some(avatar) = self.avatars.iter_mut().find(|avatar| avatar.id == id) else {
            return;
        };
        match kind {
            "teleport_avatar_to" => avatar.position = point_from_json(&command["position"]),
            "rotate_avatar_to" => {
                let [x, y, z] = point_from_json(&command["rotation"]);
                avatar.rotation = [x, y, z, command["rotation"]["w"].as_f64().unwrap_or(1.0)];
            }
            "look_at_position" => avatar.look_at(point_from_json(&command["position"])),
            "set_field_of_view" => {
                avatar.field_of_view_deg = command["field_of_view"].as_f64().unwrap_or(54.43223).clamp(1.0, 170.0);
            }
            "set_pass_masks" => avatar.pass_masks = texts_from_json(&command["pass_masks"]),
            _ => {}
        }
    }
}

impl StandInAvatar {
    fn look_at(&mut self, target: [f64; 3]) {
        let [x, y, z] = [0, 1, 2].map(|axis| target[axis] - self.position[axis]);
        let (yaw, pitch) = (libm::atan2(x, z), -libm::atan2(y, libm::sqrt(x * x + z * z)));
        let ((sin_y, cos_y), (sin_p, cos_p)) = (libm::sincos(yaw / 2.0), libm::sincos(pitch / 2.0));
        self.rotation = [cos_y * sin_p, sin_y * cos_p, -sin_y * sin_p, cos_y * cos_p];
    }

    pub(super) fn render_camera(&self, (width, height): (u32, u32)) -> PinholeCamera {
        let forward = wayword_forward_from_unity_rotation(self.rotation);
        let fov_rad = self.field_of_view_deg.to_radians();
        PinholeCamera::looking_along(wayword_from_unity(self.position), forward, fov_rad, width, height)
    }
}

fn picture_side(command: &Value, name: &str) -> u32 {
    command[name].as_u64().unwrap_or(256).clamp(1, 4096) as u32
}

/// A point; a missing coordinate is 0, as in the build.
pub(super) fn point_from_json(value: &Value) -> [f64; 3] {
    ["x", "y", "z"].map(|axis| value[axis].as_f64().unwrap_or(0.0))
}

fn texts_from_json(value: &Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(|text| text.as_str().map(str::to_owned)).collect()
}
