//! The stand-in's answers to commands: frames in the same layout as those of the genuine build.

use super::{
    flat::{Field, buffer},
    pictures,
    state::{Avatar, BuildState, Pictures, vector},
    world::unity_f32,
};
use crate::unity::wayword_forward_from_unity_rotation;
use serde_json::Value;
use wayword_core::DVec3;
use wayword_house::Object;

const UNITY: &str = "2020.3.24f1";
/// Smallest cell of an occupancy map, metres.
const FINEST_CELL_M: f64 = 0.1;

/// The frames that answer a command; none where it asks for no data, or for data that the stand-in does not have.
pub(super) fn to(state: &BuildState, kind: &str, command: &Value) -> Vec<Vec<u8>> {
    let id = command["id"].as_i64().unwrap_or(0) as i32;
    let avatars = || state.avatars.iter();
    match kind {
        "send_version" => vec![version(state.version)],
        "send_segmentation_colors" => vec![segmentation(state)],
        "send_categories" => vec![categories(state)],
        "send_scene_regions" => vec![regions(state)],
        "send_bounds" => vec![bounds(state)],
        "send_transforms" => vec![transforms(state)],
        "send_occupancy_map" => vec![occupancy(state, command["cell_size"].as_f64().unwrap_or(0.5))],
        "send_avatars" => avatars().map(avatar).collect(),
        "send_camera_matrices" => avatars().map(|avatar| camera_matrices(state, avatar)).collect(),
        "send_image_sensors" => avatars().map(sensors).collect(),
        "send_is_on_nav_mesh" => vec![on_nav_mesh(state, command, id)],
        "send_nav_mesh_path" => vec![path(state, command, id)],
        "terminate" => vec![buffer(b"quit", vec![Field::U8(1)])],
        _ => Vec::new(),
    }
}

/// The pictures that are due with this answer.
pub(super) fn pictures(state: &mut BuildState) -> Vec<Vec<u8>> {
    let ids = match &state.pictures {
        Pictures::None => return Vec::new(),
        Pictures::Once(ids) | Pictures::Always(ids) => ids.clone(),
    };
    if matches!(state.pictures, Pictures::Once(_)) {
        state.pictures = Pictures::None;
    }
    let wanted = state.avatars.iter().filter(|avatar| ids.is_empty() || ids.contains(&avatar.id));
    wanted.filter_map(|avatar| images(state, avatar)).collect()
}

fn images(state: &BuildState, avatar: &Avatar) -> Option<Vec<u8>> {
    let (width, height) = state.size;
    let (scene, camera) = (&state.world.scene, avatar.camera(state.size));
    let has_colours = avatar.pass_masks.iter().any(|pass| pass == "_img");
    let picture = if has_colours { scene.picture(&camera) } else { scene.ids(&camera) }.ok()?;
    let is_object = |id| state.world.is_object(id);
    let passes = pictures::passes(&picture, &avatar.pass_masks, state.png, is_object).into_iter().map(
        |pictures::Pass(mask, bytes, extension)| vec![Field::I32(mask), Field::Bytes(bytes), Field::U8(extension)],
    );
    let fields = vec![
        Field::Text(avatar.id.clone()),
        Field::Text("SensorContainer".to_owned()),
        Field::I32(width as i32),
        Field::I32(height as i32),
        Field::Tables(passes.collect()),
    ];
    Some(buffer(b"imag", fields))
}

/// A FlatBuffer up to 1.12, plain bytes from 1.13 on.
fn version(version: &str) -> Vec<u8> {
    if version.starts_with("1.12") {
        let fields = vec![Field::Text(UNITY.to_owned()), Field::Text(version.to_owned()), Field::U8(1)];
        return buffer(b"vers", fields);
    }
    [b"\0\0\0\0vers\x01", &[version.len() as u8][..], version.as_bytes(), UNITY.as_bytes()].concat()
}

fn ids(state: &BuildState) -> Vec<i32> {
    state.world.objects().map(|(id, _)| id as i32).collect()
}

fn texts(state: &BuildState, text: impl Fn(&Object) -> String) -> Field {
    Field::Texts(state.world.objects().map(|(_, object)| text(object)).collect())
}

fn segmentation(state: &BuildState) -> Vec<u8> {
    let colours = state.world.objects().flat_map(|(id, _)| pictures::id_colour(id).map(i32::from));
    let name = |object: &Object| {
        let colour = object.colour.map(|colour| format!("{colour}_")).unwrap_or_default();
        format!("{colour}{}", object.name).replace(' ', "_")
    };
    let fields = vec![
        Field::I32s(ids(state)),
        texts(state, name),
        texts(state, |object| object.name.clone()),
        Field::I32s(colours.collect()),
    ];
    buffer(b"segm", fields)
}

fn categories(state: &BuildState) -> Vec<u8> {
    let mut names: Vec<&str> = state.world.objects().map(|(_, object)| object.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let category = |(index, name): (usize, &str)| {
        let colour = pictures::id_colour(index as u32 + 1).map(|channel| f32::from_bits(u32::from(channel)));
        vec![Field::Struct(colour.to_vec()), Field::Text(name.to_owned())]
    };
    buffer(b"cate", vec![Field::Tables(names.into_iter().enumerate().map(category).collect())])
}

fn regions(state: &BuildState) -> Vec<u8> {
    let raw = state.world.rooms().flat_map(|(id, centre, size)| {
        let numbers = centre.into_iter().chain(size).flat_map(f32::to_le_bytes);
        id.to_le_bytes().into_iter().chain(numbers).collect::<Vec<u8>>()
    });
    buffer(b"sreg", vec![Field::Structs(28, raw.collect())])
}

/// Middles of a box's sides in the build's order, front to the north, and the box's own middle.
fn points(object: &Object) -> [[f32; 3]; 7] {
    let centre = object.centre_m();
    let half = (object.bounds_m.1 - object.bounds_m.0) / 2.0;
    let sides = [DVec3::Y, -DVec3::Y, DVec3::X, -DVec3::X, DVec3::Z, -DVec3::Z, DVec3::ZERO];
    sides.map(|side| unity_f32(centre + side * half))
}

fn bounds(state: &BuildState) -> Vec<u8> {
    let numbers = state.world.objects().flat_map(|(_, object)| points(object)).flatten();
    buffer(b"boun", vec![Field::I32s(ids(state)), Field::F32s(numbers.collect())])
}

fn transforms(state: &BuildState) -> Vec<u8> {
    let each = |numbers: &dyn Fn(&Object) -> Vec<f32>| {
        Field::F32s(state.world.objects().flat_map(|(_, object)| numbers(object)).collect())
    };
    let fields = vec![
        Field::I32s(ids(state)),
        each(&|object| points(object)[5].to_vec()),
        each(&|_| vec![0.0, 0.0, 0.0, 1.0]),
        each(&|_| vec![0.0, 0.0, 1.0]),
    ];
    buffer(b"tran", fields)
}

fn occupancy(state: &BuildState, cell_m: f64) -> Vec<u8> {
    let cell_m = if cell_m.is_finite() { cell_m.max(FINEST_CELL_M) } else { 0.5 };
    let (low, high) = state.world.extent();
    let count = |from: f64, to: f64| ((to - from) / cell_m).ceil() as usize;
    let (rows, columns) = (count(low.x, high.x), count(low.y, high.y));
    let (mut cells, mut positions) = (Vec::new(), Vec::new());
    for row in 0..rows {
        for column in 0..columns {
            let (x, z) = (low.x + (row as f64 + 0.5) * cell_m, low.y + (column as f64 + 0.5) * cell_m);
            cells.push(match state.world.standing(x, z) {
                (_, true) => 0,
                (true, false) => 1,
                (false, false) => -1_i8 as u8,
            });
            positions.extend([x as f32, z as f32]);
        }
    }
    let shape = Field::I32s(vec![columns as i32, rows as i32]);
    buffer(b"occu", vec![Field::Bytes(cells), Field::F32s(positions), shape])
}

fn looking(avatar: &Avatar) -> [Field; 2] {
    let forward = unity_f32(wayword_forward_from_unity_rotation(avatar.rotation));
    [Field::Struct(avatar.rotation.map(|number| number as f32).to_vec()), Field::Struct(forward.to_vec())]
}

fn avatar(avatar: &Avatar) -> Vec<u8> {
    let position = avatar.position.map(|number| number as f32);
    let [rotation, forward] = looking(avatar);
    buffer(b"avki", vec![Field::Text(avatar.id.clone()), Field::Struct(position.to_vec()), rotation, forward])
}

fn sensors(avatar: &Avatar) -> Vec<u8> {
    let [rotation, forward] = looking(avatar);
    let fov = Field::F32(avatar.field_of_view_deg as f32);
    let sensor = vec![Field::Text("SensorContainer".to_owned()), Field::U8(1), rotation, forward, fov];
    buffer(b"imse", vec![Field::Text(avatar.id.clone()), Field::Tables(vec![sensor])])
}

/// Unity's own matrices: camera space is right-handed, looking along -z.
fn camera_matrices(state: &BuildState, avatar: &Avatar) -> Vec<u8> {
    let camera = avatar.camera(state.size);
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
        Field::Text(avatar.id.clone()),
        Field::Text("SensorContainer".to_owned()),
        Field::F32s(projection.to_vec()),
        Field::F32s(matrix),
    ];
    buffer(b"cama", fields)
}

fn on_nav_mesh(state: &BuildState, command: &Value, id: i32) -> Vec<u8> {
    let asked = vector(&command["position"]);
    let found = state.world.on_nav_mesh(asked, command["max_distance"].as_f64().unwrap_or(1.0));
    let position = found.map_or([0.0; 3], unity_f32);
    buffer(b"isnm", vec![Field::F32s(position.to_vec()), Field::U8(u8::from(found.is_some())), Field::I32(id)])
}

fn path(state: &BuildState, command: &Value, id: i32) -> Vec<u8> {
    let way = state.world.way(vector(&command["origin"]), vector(&command["destination"]));
    let complete = way.is_some();
    let raw = way.into_iter().flatten().flat_map(unity_f32).flat_map(f32::to_le_bytes);
    buffer(b"path", vec![Field::Bytes(raw.collect()), Field::U8(if complete { 1 } else { 4 }), Field::I32(id)])
}
