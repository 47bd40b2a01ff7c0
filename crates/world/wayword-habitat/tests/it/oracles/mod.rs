//! Finds the oracle data: results of the genuine Habitat.

#![allow(dead_code, reason = "each test binary uses a part")]
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test that is skipped says so")]

use std::path::{Path, PathBuf};
use wayword_core::DVec3;
use wayword_habitat::axes::wayword_from_habitat;

/// The folder of the oracles; `None`, with a line on standard error, if there is none.
pub(crate) fn folder() -> Option<PathBuf> {
    let data = std::env::var_os("WAYWORD_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data"), PathBuf::from);
    let oracles = data.join("oracles");
    if oracles.is_dir() {
        return Some(oracles);
    }
    eprintln!("SKIPPED: no oracles at {} (set WAYWORD_DATA)", oracles.display());
    None
}

/// All navmeshes among them.
pub(crate) fn navmeshes() -> Vec<PathBuf> {
    let names = [
        "habitat_navmesh/rooms.navmesh",
        "habitat_frames/traj_flat_a/scene.navmesh",
        "habitat_frames/traj_simple_room/scene.navmesh",
    ];
    folder().map(|folder| names.map(|name| folder.join(name)).to_vec()).unwrap_or_default()
}

/// A file of JSON.
pub(crate) fn json(file: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// A position given in Habitat's frame, converted to Wayword's.
pub(crate) fn place(point: &serde_json::Value) -> DVec3 {
    let number = |at: usize| point[at].as_f64().unwrap();
    wayword_from_habitat(DVec3::new(number(0), number(1), number(2)))
}

/// The boxes of the scene of `rooms.navmesh`, from the oracles' README: low and high corner in Habitat's frame.
pub(crate) const ROOMS: [[[f32; 3]; 2]; 3] =
    [[[-5.0, -0.1, -4.0], [5.0, 0.0, 4.0]], [[-0.1, 0.0, -4.0], [0.1, 2.5, 2.8]], [[2.0, 0.0, -1.0], [3.0, 1.0, 1.0]]];

/// The corners of a box in Habitat's frame, and its triangles; their faces point outwards.
pub(crate) fn solid([low, high]: [[f32; 3]; 2]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let corner = |n: usize| std::array::from_fn(|axis| [low, high][n >> axis & 1][axis]);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// Writes the scene of `rooms.navmesh` as glTF beside its stage configuration.
pub(crate) fn write_rooms(stage: &Path) {
    let solids = ROOMS.map(solid);
    let corners: Vec<[f32; 3]> = solids
        .iter()
        .flat_map(|(corners, triangles)| triangles.iter().flatten().map(|at| corners[*at as usize]))
        .collect();
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() }],
        "buffers": [{ "byteLength": bytes.len(), "uri": "rooms.bin" }],
    });
    std::fs::write(stage.with_file_name("rooms.bin"), bytes).unwrap();
    std::fs::write(stage.with_file_name("rooms.gltf"), document.to_string()).unwrap();
    let config = serde_json::json!({ "render_asset": "rooms.gltf", "up": [0, 1, 0], "front": [0, 0, -1] });
    std::fs::write(stage, config.to_string()).unwrap();
}
