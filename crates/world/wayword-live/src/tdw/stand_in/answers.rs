//! The stand-in's answers to commands: frames in the same layout as those of the genuine build.

use super::{
    flatbuffer_writer::{FlatBufferField, write_buffer},
    pictures,
    state::{BuildState, PictureDemand, StandInAvatar, point_from_json},
    world::unity_f32,
};
use crate::unity::wayword_forward_from_unity_rotation;
use serde_json::Value;
use wayword_core::DVec3;
use wayword_house::NumberedObject;

/// The version of Unity that the stand-in reports.
const UNITY_VERSION: &str = "2020.3.24f1";
/// Smallest cell of an occupancy map, metres.
const FINEST_CELL_M: f64 = 0.1;

/// The frames that answer a command; none where it asks for no data, or for data that the stand-in does not have.
pub(super) fn answer_command(state: &BuildState, kind: &str, command: &Value) -> Vec<Vec<u8>> {
    let id = command["id"].as_i64().unwrap_or(0) as i32;
    let avatars = || state.avatars.iter();
    match kind {
        "send_version" => vec![version_frame(state.version)],
        "send_segmentation_colors" => vec![segmentation_frame(state)],
        "send_categories" => vec![categories_frame(state)],
        "send_scene_regions" => vec![regions_frame(state)],
        "send_bounds" => vec![bounds_frame(state)],
        "send_transforms" => vec![transforms_frame(state)],
        "send_occupancy_map" => vec![occupancy_frame(state, command["cell_size"].as_f64().unwrap_or(0.5))],
        "send_avatars" => avatars().map(avatar_frame).collect(),
        "send_camera_matrices" => avatars().map(|avatar| camera_matrices_frame(state, avatar)).collect(),
        "send_image_sensors" => avatars().map(sensors_frame).collect(),
        "send_is_on_nav_mesh" => vec![on_nav_mesh_frame(state, command, id)],
        "send_nav_mesh_path" => vec![path_frame(state, command, id)],
        "terminate" => vec![write_buffer(b"quit", vec![FlatBufferField::U8(1)])],
        _ => Vec::new(),
    }
}

/// The pictures that are due with this answer.
pub(super) fn due_pictures(state: &mut BuildState) -> Vec<Vec<u8>> {
    let ids = match &state.pictures {
        PictureDemand::None => return Vec::new(),
        PictureDemand::Once(ids) | PictureDemand::Always(ids) => ids.clone(),
    };
    if matches!(state.pictures, PictureDemand::Once(_)) {
        state.pictures = PictureDemand::None;
    }
    let wanted = state.avatars.iter().filter(|avatar| ids.is_empty() || ids.contains(&avatar.id));
    wanted.filter_map(|avatar| images_frame(state, avatar)).collect()
}

/// The frame `imag` of an avatar; `None` if its camera cannot be drawn.
fn images_frame(state: &BuildState, avatar: &StandInAvatar) -> Option<Vec<u8>> {
    let (width, height) = state.size;
    let (scene, camera) = (&state.world.scene, avatar.render_camera(state.size));
    let has_colours = avatar.pass_masks.iter().any(|pass| pass == "_img");
    let picture = match has_colours {
        true => scene.render_picture(&camera).ok()?,
        false => scene.render_object_ids(&camera).ok()?,
    };
    let is_object = |id| state.world.is_object(id);
    let passes = pictures::encode_passes(&picture, &avatar.pass_masks, state.png, is_object).into_iter().map(
        |pictures::EncodedPass(mask, bytes, extension)| {
            vec![FlatBufferField::I32(mask), FlatBufferField::Bytes(bytes), FlatBufferField::U8(extension)]
        },
    );
    let fields = vec![
        FlatBufferField::Text(avatar.id.clone()),
        FlatBufferField::Text("SensorContainer".to_owned()),
        FlatBufferField::I32(width as i32),
        FlatBufferField::I32(height as i32),
        FlatBufferField::Tables(passes.collect()),
    ];
    Some(write_buffer(b"imag", fields))
}

/// A FlatBuffer up to 1.12, plain bytes from 1.13 on.
fn version_frame(version: &str) -> Vec<u8> {
    if version.starts_with("1.12") {
        let fields = vec![
            FlatBufferField::Text(UNITY_VERSION.to_owned()),
            FlatBufferField::Text(version.to_owned()),
            FlatBufferField::U8(1),
        ];
        return write_buffer(b"vers", fields);
    }
    [b"\0\0\0\0vers\x01", &[version.len() as u8][..], version.as_bytes(), UNITY_VERSION.as_bytes()].concat()
}

/// The ids of all objects that have a colour.
fn object_ids(state: &BuildState) -> Vec<i32> {
    state.world.coloured_objects().map(|(id, _)| id as i32).collect()
}

/// A field with one text for each object.
fn object_texts(state: &BuildState, text: impl Fn(&NumberedObject) -> String) -> FlatBufferField {
    FlatBufferField::Texts(state.world.coloured_objects().map(|(_, object)| text(object)).collect())
}

fn segmentation_frame(state: &BuildState) -> Vec<u8> {
    let colours = state.world.coloured_objects().flat_map(|(id, _)| pictures::id_colour(id).map(i32::from));
    let name = |object: &NumberedObject| {
        let colour = object.colour.map(|colour| format!("{colour}_")).unwrap_or_default();
        format!("{colour}{}", object.name).replace(' ', "_")
    };
    let fields = vec![
        FlatBufferField::I32s(object_ids(state)),
        object_texts(state, name),
        object_texts(state, |object| object.name.clone()),
        FlatBufferField::I32s(colours.collect()),
    ];
    write_buffer(b"segm", fields)
}

fn categories_frame(state: &BuildState) -> Vec<u8> {
    let mut names: Vec<&str> = state.world.coloured_objects().map(|(_, object)| object.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let category = |(index, name): (usize, &str)| {
        let colour = pictures::id_colour(index as u32 + 1).map(|channel| f32::from_bits(u32::from(channel)));
        vec![FlatBufferField::Struct(colour.to_vec()), FlatBufferField::Text(name.to_owned())]
    };
    write_buffer(b"cate", vec![FlatBufferField::Tables(names.into_iter().enumerate().map(category).collect())])
}

fn regions_frame(state: &BuildState) -> Vec<u8> {
    let raw = state.world.room_boxes().flat_map(|(id, centre, size)| {
        let numbers = centre.into_iter().chain(size).flat_map(f32::to_le_bytes);
        id.to_le_bytes().into_iter().chain(numbers).collect::<Vec<u8>>()
    });
    write_buffer(b"sreg", vec![FlatBufferField::Structs(28, raw.collect())])
}

/// Middles of a box's sides in the build's order, front to the north, and the box's own middle.
fn box_points(object: &NumberedObject) -> [[f32; 3]; 7] {
    let centre = object.centre_m();
    let half = (object.bounds_m.1 - object.bounds_m.0) / 2.0;
    let sides = [DVec3::Y, -DVec3::Y, DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z, DVec3::ZERO];
    sides.map(|side| unity_f32(centre + side * half))
}

fn bounds_frame(state: &BuildState) -> Vec<u8> {
    let numbers = state.world.coloured_objects().flat_map(|(_, object)| box_points(object)).flatten();
    write_buffer(b"boun", vec![FlatBufferField::I32s(object_ids(state)), FlatBufferField::F32s(numbers.collect())])
}

fn transforms_frame(state: &BuildState) -> Vec<u8> {
    let each = |numbers: &dyn Fn(&NumberedObject) -> Vec<f32>| {
        FlatBufferField::F32s(state.world.coloured_objects().flat_map(|(_, object)| numbers(object)).collect())
    };
    let fields = vec![
        FlatBufferField::I32s(object_ids(state)),
        each(&|object| box_points(object)[5].to_vec()),
        each(&|_| vec![0.0, 0.0, 0.0, 1.0]),
        each(&|_| vec![0.0, 0.0, 1.0]),
    ];
    write_buffer(b"tran", fields)
}

fn occupancy_frame(state: &BuildState, cell_m: f64) -> Vec<u8> {
    let cell_m = if cell_m.is_finite() { cell_m.max(FINEST_CELL_M) } else { 0.5 };
    let (low, high) = state.world.house_extent();
    let count = |from: f64, to: f64| ((to - from) / cell_m).ceil() as usize;
    let (rows, columns) = (count(low.x, high.x), count(low.y, high.y));
    let (mut cells, mut positions) = (Vec::new(), Vec::new());
    for row in 0..rows {
        for column in 0..columns {
            let (x, z) = (low.x + (row as f64 + 0.5) * cell_m, low.y + (column as f64 + 0.5) * cell_m);
            cells.push(match state.world.floor_state(x, z) {
                (_, true) => 0,
                (true, false) => 1,
                (false, false) => -1_i8 as u8,
            });
            positions.extend([x as f32, z as f32]);
        }
    }
    let shape = FlatBufferField::I32s(vec![columns as i32, rows as i32]);
    write_buffer(b"occu", vec![FlatBufferField::Bytes(cells), FlatBufferField::F32s(positions), shape])
}

fn gaze_fields(avatar: &StandInAvatar) -> [FlatBufferField; 2] {
    let forward = unity_f32(wayword_forward_from_unity_rotation(avatar.rotation));
    [
        FlatBufferField::Struct(avatar.rotation.map(|number| number as f32).to_vec()),
        FlatBufferField::Struct(forward.to_vec()),
    ]
}

fn avatar_frame(avatar: &StandInAvatar) -> Vec<u8> {
    let position = avatar.position.map(|number| number as f32);
    let [rotation, forward] = gaze_fields(avatar);
    write_buffer(
        b"avki",
        vec![FlatBufferField::Text(avatar.id.clone()), FlatBufferField::Struct(position.to_vec()), rotation, forward],
    )
}

fn sensors_frame(avatar: &StandInAvatar) -> Vec<u8> {
    let [rotation, forward] = gaze_fields(avatar);
    let fov = FlatBufferField::F32(avatar.field_of_view_deg as f32);
    let sensor =
        vec![FlatBufferField::Text("SensorContainer".to_owned()), FlatBufferField::U8(1), rotation, forward, fov];
    write_buffer(b"imse", vec![FlatBufferField::Text(avatar.id.clone()), FlatBufferField::Tables(vec![sensor])])
}

/// Unity's own matrices: camera space is right-handed, looking along -z.
fn camera_matrices_frame(state: &BuildState, avatar: &StandInAvatar) -> Vec<u8> {
    let camera = avatar.render_camera(state.size);
    let axes = camera.world_from_camera();
    let rows = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| {
        let [x, y, z] = unity_f32(axis);
        [x, y, z, -axis.dot(camera.position) as f32]
    });
    let matrix = [rows[0], rows[1], rows[2], [0.0, 0.0, 0.0, 1.0]].concat();
    let scale = 1.0 / libm::tan(camera.vertical_fov_rad / 2.0);
    let aspect = f64::from(state.size.0) / f64::from(state.size.1);
    let (near, far) = (0.1, 100.0);
    let depth = [-(far + near) / (far - near), -2.0 * far * near / (far - near)];
    let mut projection = [0.0_f32; 16];
    (projection[0], projection[5]) = ((scale / aspect) as f32, scale as f32);
    (projection[10], projection[11], projection[14]) = (depth[0], depth[1], -1.0);
    let fields = vec![
        FlatBufferField::Text(avatar.id.clone()),
        FlatBufferField::Text("SensorContainer".to_owned()),
        FlatBufferField::F32s(projection.to_vec()),
        FlatBufferField::F32s(matrix),
    ];
    write_buffer(b"cama", fields)
}

fn on_nav_mesh_frame(state: &BuildState, command: &Value, id: i32) -> Vec<u8> {
    let asked = point_from_json(&command["position"]);
    let found = state.world.nearest_walkable(asked, command["max_distance"].as_f64().unwrap_or(1.0));
    let position = found.map_or([0.0; 3], unity_f32);
    write_buffer(
        b"isnm",
        vec![
            FlatBufferField::F32s(position.to_vec()),
            FlatBufferField::U8(u8::from(found.is_some())),
            FlatBufferField::I32(id),
        ],
    )
}

fn path_frame(state: &BuildState, command: &Value, id: i32) -> Vec<u8> {
    let way = state.world.shortest_way(point_from_json(&command["origin"]), point_from_json(&command["destination"]));
    let complete = way.is_some();
    let raw = way.into_iter().flatten().flat_map(unity_f32).flat_map(f32::to_le_bytes);
    write_buffer(
        b"path",
        vec![
            FlatBufferField::Bytes(raw.collect()),
            FlatBufferField::U8(if complete { 1 } else { 4 }),
            FlatBufferField::I32(id),
        ],
    )
}
