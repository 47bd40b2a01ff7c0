//! Commands to the build, and their JSON as TDW's `command_api.md` documents it. Four-letter words such as `vers` are ids of
//! the build's output data (`output/mod.rs`).

use serde::Serialize;

/// A point or a direction in Unity's coordinates (see [`crate::unity`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs, reason = "each is the coordinate of that name")]
pub struct TdwVector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// A rotation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(missing_docs, reason = "each is the component of that name")]
pub struct TdwQuaternion {
    pub w: f64,
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// A point of the one-metre grid that walls of procedural rooms follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[allow(missing_docs, reason = "each is the coordinate of that name")]
pub struct GridPoint {
    pub x: u32,
    pub y: u32,
}

/// How often the build sends something.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SendFrequency {
    /// With the answer to this list of commands.
    Once,
    /// With every answer from now on.
    Always,
    /// No more.
    Never,
}

/// A command. Fields are named as in the command's JSON; fields that are missing here have the build's defaults.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "$type", rename_all = "snake_case")]
#[allow(missing_docs, reason = "fields are those of command_api.md")]
pub enum BuildCommand {
    /// Makes the build quit when it logs an error.
    SetErrorHandling,
    /// Asks for `vers`.
    SendVersion,
    /// Loads a scene that is part of the build.
    LoadScene { scene_name: String },
    /// Downloads and loads a scene.
    AddScene { name: String, url: String },
    /// Walls around a procedural room, in order.
    CreateExteriorWalls { walls: Vec<GridPoint> },
    /// Walls inside a procedural room.
    CreateInteriorWalls { walls: Vec<GridPoint> },
    /// The ceiling of a procedural room.
    CreateProcGenCeiling,
    /// Downloads and places an object; `rotation` in Euler angles, degrees.
    AddObject {
        name: String,
        url: String,
        scale_factor: f64,
        position: TdwVector3,
        rotation: TdwVector3,
        category: String,
        id: i32,
        affordance_points: Vec<TdwVector3>,
    },
    /// Resizes an object.
    ScaleObject { scale_factor: TdwVector3, id: i32 },
    /// Whether an object is moved by forces.
    SetKinematicState { id: i32, is_kinematic: bool, use_gravity: bool },
    /// Bakes the navmesh of a procedural scene.
    BakeNavMesh { voxel_size: f64, carve_type: &'static str, ignore: Vec<i32> },
    /// A body with a camera.
    CreateAvatar {
        #[serde(rename = "type")]
        kind: &'static str,
        id: String,
    },
    /// Moves an avatar to a position.
    TeleportAvatarTo { position: TdwVector3, avatar_id: String },
    /// Sets an avatar's rotation.
    RotateAvatarTo { rotation: TdwQuaternion, avatar_id: String },
    /// Size of pictures, pixels.
    SetScreenSize { width: u32, height: u32 },
    /// Vertical field of view, degrees.
    SetFieldOfView { field_of_view: f64, avatar_id: String },
    /// Whether the `_img` pass comes as PNG; else JPEG.
    SetImgPassEncoding { value: bool },
    /// Which passes come.
    SetPassMasks { pass_masks: Vec<&'static str>, avatar_id: String },
    /// Asks for `imag`; of all avatars where `ids` is empty.
    SendImages { ids: Vec<String>, frequency: SendFrequency },
    /// Asks for `segm`.
    SendSegmentationColors { ids: Vec<i32>, frequency: SendFrequency },
    /// Asks for `cate`.
    SendCategories { frequency: SendFrequency },
    /// Asks for `avki`.
    SendAvatars { ids: Vec<String>, frequency: SendFrequency },
    /// Asks for `sreg`.
    SendSceneRegions { frequency: SendFrequency },
    /// Asks for `tran`.
    SendTransforms { ids: Vec<i32>, frequency: SendFrequency },
    /// Asks for `boun`.
    SendBounds { ids: Vec<i32>, frequency: SendFrequency },
    /// Asks for `cama`.
    SendCameraMatrices { ids: Vec<String>, frequency: SendFrequency },
    /// Asks for `imse`.
    SendImageSensors { ids: Vec<String>, frequency: SendFrequency },
    /// Asks for `occu`.
    SendOccupancyMap { cell_size: f64, raycast_y: f64 },
    /// Asks for `isnm`.
    SendIsOnNavMesh { position: TdwVector3, max_distance: f64, id: i32 },
    /// Asks for exactly one `path` with that id.
    SendNavMeshPath { origin: TdwVector3, destination: TdwVector3, id: i32 },
    /// Ends the build; it answers `quit`.
    Terminate,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// The JSON of TDW's `command_api.md`, as its Python client sends it.
    #[test]
    fn commands_have_the_documented_json() {
        let at = TdwVector3 { x: 1.0, y: 0.5, z: -2.0 };
        let avatar_id = || "a".to_owned();
        let documented: Vec<(BuildCommand, Value)> = vec![
            (BuildCommand::SetErrorHandling, json!({ "$type": "set_error_handling" })),
            (BuildCommand::SendVersion, json!({ "$type": "send_version" })),
            (
                BuildCommand::LoadScene { scene_name: "ProcGenScene".into() },
                json!({ "$type": "load_scene", "scene_name": "ProcGenScene" }),
            ),
            (
                BuildCommand::CreateExteriorWalls { walls: vec![GridPoint { x: 0, y: 3 }] },
                json!({ "$type": "create_exterior_walls", "walls": [{ "x": 0, "y": 3 }] }),
            ),
            (BuildCommand::CreateProcGenCeiling, json!({ "$type": "create_proc_gen_ceiling" })),
            (
                BuildCommand::CreateAvatar { kind: "A_Img_Caps_Kinematic", id: avatar_id() },
                json!({ "$type": "create_avatar", "type": "A_Img_Caps_Kinematic", "id": "a" }),
            ),
            (
                BuildCommand::TeleportAvatarTo { position: at, avatar_id: avatar_id() },
                json!({ "$type": "teleport_avatar_to", "position": { "x": 1.0, "y": 0.5, "z": -2.0 }, "avatar_id": "a" }),
            ),
            (
                BuildCommand::RotateAvatarTo {
                    rotation: TdwQuaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 },
                    avatar_id: avatar_id(),
                },
                json!({ "$type": "rotate_avatar_to", "rotation": { "w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0 }, "avatar_id": "a" }),
            ),
            (
                BuildCommand::SetPassMasks { pass_masks: vec!["_img", "_id"], avatar_id: avatar_id() },
                json!({ "$type": "set_pass_masks", "pass_masks": ["_img", "_id"], "avatar_id": "a" }),
            ),
            (
                BuildCommand::SendImages { ids: vec![], frequency: SendFrequency::Once },
                json!({ "$type": "send_images", "ids": [], "frequency": "once" }),
            ),
            (
                BuildCommand::SendOccupancyMap { cell_size: 0.5, raycast_y: 2.5 },
                json!({ "$type": "send_occupancy_map", "cell_size": 0.5, "raycast_y": 2.5 }),
            ),
            (
                BuildCommand::SendNavMeshPath { origin: at, destination: at, id: 7 },
                json!({
                    "$type": "send_nav_mesh_path",
                    "origin": { "x": 1.0, "y": 0.5, "z": -2.0 },
                    "destination": { "x": 1.0, "y": 0.5, "z": -2.0 },
                    "id": 7,
                }),
            ),
            (BuildCommand::Terminate, json!({ "$type": "terminate" })),
        ];
        for (command, expected) in documented {
            assert_eq!(serde_json::to_value(&command).unwrap(), expected);
        }
    }
}
