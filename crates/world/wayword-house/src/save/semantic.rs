//! Writes the semantics of a house as AI Habitat reads them: a mesh in which each object has its own colour, a list of the
//! objects by colour (HM3D's semantics, `*.semantic.glb` and `*.semantic.txt`), and the stage configuration that names
//! these files.

use super::{
    super::{drawing, model::House, objects},
    SaveError,
    buffer::GlbBuffer,
    gltf::glb_container,
};
use serde_json::{Value, json};
use std::fmt::Write;

/// The bytes of a `.semantic.glb`: every vertex has the colour of its object, as linear light. Habitat converts the vertex colours
/// of a `.glb` to sRGB before it looks them up in the list (`GenericSemanticMeshData::buildSemanticMeshData`).
///
/// # Errors
/// When the file would be larger than a GLB may be.
pub fn semantic_glb(house: &House) -> Result<Vec<u8>, SaveError> {
    let mut buffer = GlbBuffer::default();
    let drawn = drawing::draw_house(house).meshes;
    let primitives = drawn.iter().filter(|mesh| !mesh.triangles.is_empty()).map(|mesh| {
        let paint = colour_for_id(mesh.id).map(linear_from_srgb);
        let painted = buffer.add_floats(mesh.positions.iter().flat_map(|_| paint), 3);
        json!({
            "attributes": { "POSITION": buffer.add_positions(&mesh.positions), "COLOR_0": painted },
            "indices": buffer.add_indices(&mesh.triangles),
            "material": 0,
        })
    });
    let primitives: Vec<Value> = primitives.collect();
    buffer.bytes.resize(buffer.bytes.len().next_multiple_of(4), 0);
    let document = json!({
        "asset": { "version": "2.0", "generator": "wayword" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": [{ "extensions": { "KHR_materials_unlit": {} } }],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    glb_container(&document, &buffer.bytes)
}

/// The text of a `.semantic.txt`: number, colour, name and room of each object.
#[must_use]
pub fn semantic_txt(house: &House) -> String {
    let mut text = String::from("HM3D Semantic Annotations\n");
    for (id, object) in objects::objects_by_id(house) {
        let [red, green, blue] = colour_for_id(id);
        let _ = writeln!(text, "{id},{red:02X}{green:02X}{blue:02X},\"{}\",{}", object.name, object.room);
    }
    text
}

/// A `.stage_config.json` for files of this name. It declares that y is up, as in glTF, because Habitat assumes another
/// axis.
pub(super) fn stage_config(name: &str, has_navmesh: bool) -> Value {
    let mut config = json!({
        "render_asset": format!("{name}.glb"),
        "semantic_asset": format!("{name}.semantic.glb"),
        "semantic_descriptor_filename": format!("{name}.semantic.txt"),
        "has_semantic_textures": false,
        "up": [0.0, 1.0, 0.0],
        "front": [0.0, 0.0, -1.0],
        "units_to_meters": 1.0,
    });
    if has_navmesh {
        config["nav_asset"] = json!(format!("{name}.navmesh"));
    }
    config
}

/// The linear light of a channel in sRGB, from 0 to 1 (IEC 61966-2-1).
fn linear_from_srgb(channel: u8) -> f32 {
    let encoded = f32::from(channel) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::powf((encoded + 0.055) / 1.055, 2.4) }
}

/// The colour of an object's number. Multiplying by an odd factor gives each of the 2^24 numbers its own colour.
fn colour_for_id(id: u32) -> [u8; 3] {
    let [_, red, green, blue] = id.wrapping_mul(0x9E_3779).to_be_bytes();
    [red, green, blue]
}
