//! Writes a house as binary glTF 2.0: one node for each object, unlit, with its baked light in `COLOR_0`.

use super::{
    super::{drawing, model::House, names::scene_name, objects},
    SaveError,
    buffer::GlbBuffer,
};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use wayword_render::{Mesh, MeshMaterial, Texture};

/// The bytes of a `.glb` file.
///
/// Nodes are named by object and number ("sofa 41"); `extras` holds the number, the same as in the id buffer. Materials
/// are unlit (`KHR_materials_unlit`) because the light is baked. Colour factors and light are those of this program, which
/// multiplies stored colours by them. So does Habitat; a program that follows glTF to the letter takes them for linear light, and
/// shows the house brighter.
///
/// # Errors
/// When a texture cannot be encoded, or the file would be larger than a GLB may be.
pub fn encode_glb(house: &House) -> Result<Vec<u8>, SaveError> {
    let drawing = drawing::draw_house(house);
    let mut buffer = GlbBuffer::default();
    let (nodes, meshes) = nodes_and_meshes(house, &drawing.meshes, &mut buffer);
    let used: Vec<usize> = used_textures(&drawing.materials);
    let images = used
        .iter()
        .map(|texture| {
            let png = encode_png(*texture, &drawing.textures[*texture])?;
            Ok(json!({ "mimeType": "image/png", "bufferView": buffer.add_view(&png, None) }))
        })
        .collect::<Result<Vec<_>, SaveError>>()?;
    let textures: Vec<_> = (0..images.len()).map(|image| json!({ "source": image, "sampler": 0 })).collect();
    let materials: Vec<_> = drawing.materials.iter().map(|each| material_json(each, &used)).collect();
    buffer.bytes.resize(buffer.bytes.len().next_multiple_of(4), 0);
    // The sampler is linear near by (9729), trilinear far away (9987), and repeats in both directions (10497).
    let document = json!({
        "asset": { "version": "2.0", "generator": "wayword" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "name": scene_name(house.seed), "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "textures": textures,
        "images": images,
        "samplers": [{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 }],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    glb_container(&document, &buffer.bytes)
}

/// One node and one mesh for each object, with a primitive for each of its materials.
fn nodes_and_meshes(house: &House, meshes: &[Mesh], buffer: &mut GlbBuffer) -> (Vec<Value>, Vec<Value>) {
    let names = objects::objects_by_id(house);
    let mut by_object: BTreeMap<u32, Vec<Value>> = BTreeMap::new();
    for mesh in meshes.iter().filter(|mesh| !mesh.triangles.is_empty()) {
        let position = buffer.add_positions(&mesh.positions);
        let uv = buffer.add_floats(mesh.uvs.iter().flat_map(|uv| uv.to_array()), 2);
        let light = buffer.add_floats(mesh.colours.iter().flatten().copied(), 3);
        by_object.entry(mesh.id).or_default().push(json!({
            "attributes": { "POSITION": position, "TEXCOORD_0": uv, "COLOR_0": light },
            "indices": buffer.add_indices(&mesh.triangles),
            "material": mesh.material,
        }));
    }
    let name = |id: &u32| names.get(id).map_or_else(|| id.to_string(), |object| format!("{} {id}", object.name));
    let nodes = by_object
        .keys()
        .enumerate()
        .map(|(mesh, id)| json!({ "name": name(id), "mesh": mesh, "extras": { "id": id } }));
    let nodes = nodes.collect();
    (nodes, by_object.into_values().map(|primitives| json!({ "primitives": primitives })).collect())
}

/// Textures that some material uses, sorted.
fn used_textures(materials: &[MeshMaterial]) -> Vec<usize> {
    let mut used: Vec<usize> = materials.iter().filter_map(|material| material.texture).collect();
    used.sort_unstable();
    used.dedup();
    used
}

fn material_json(material: &MeshMaterial, used: &[usize]) -> Value {
    let mut surface = json!({ "baseColorFactor": material.base_colour, "metallicFactor": 0.0 });
    if let Some(at) = material.texture.and_then(|texture| used.binary_search(&texture).ok()) {
        surface["baseColorTexture"] = json!({ "index": at });
    }
    json!({
        "pbrMetallicRoughness": surface,
        "doubleSided": material.double_sided,
        "extensions": { "KHR_materials_unlit": {} },
    })
}

fn encode_png(index: usize, texture: &Texture) -> Result<Vec<u8>, SaveError> {
    let mut bytes = Vec::new();
    let rgb: Vec<u8> = texture.texels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    image::ImageEncoder::write_image(encoder, &rgb, texture.width, texture.height, image::ExtendedColorType::Rgb8)
        .map_err(|source| SaveError::Texture { texture: index, source })?;
    Ok(bytes)
}

/// Header, JSON chunk padded with spaces, binary chunk (glTF 2.0, section 4).
pub(super) fn glb_container(document: &Value, binary: &[u8]) -> Result<Vec<u8>, SaveError> {
    let mut text = serde_json::to_vec(document)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let bytes = 12 + 8 + text.len() + 8 + binary.len();
    let size = |bytes: usize| u32::try_from(bytes).map_err(|_| SaveError::TooLarge { bytes });
    let mut glb = Vec::with_capacity(bytes);
    glb.extend_from_slice(b"glTF");
    glb.extend_from_slice(&2_u32.to_le_bytes());
    glb.extend_from_slice(&size(bytes)?.to_le_bytes());
    for (kind, chunk) in [(b"JSON", text.as_slice()), (b"BIN\0", binary)] {
        glb.extend_from_slice(&size(chunk.len())?.to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(chunk);
    }
    Ok(glb)
}
