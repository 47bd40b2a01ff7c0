//! Small scenes.

use super::{basis, picture};
use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};

/// A binary glTF file of a document and its bytes.
pub fn container(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// One textured triangle with painted corners, on a node below a node.
fn triangle(picture: &[u8]) -> (Value, Vec<u8>) {
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    bytes.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    bytes.extend([0_u16, 1, 2, 0].iter().flat_map(|index| index.to_le_bytes()));
    bytes.extend([255, 0, 0, 255].repeat(3));
    let picture_at = bytes.len();
    bytes.extend(picture);
    let is_basis = picture.starts_with(b"sB");
    let texture = if is_basis {
        json!({ "extensions": { "GOOGLE_texture_basis": { "source": 0 } } })
    } else {
        json!({ "source": 0 })
    };
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "translation": [0, 1, 0], "children": [1] }, { "mesh": 0, "rotation": [0, 0, 0, 1], "scale": [1, 1, 1] }],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 3 }, "indices": 2, "material": 0, "mode": 4 },
        ] }],
        "materials": [{ "doubleSided": true, "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 1, 1, 1],
            "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2], "rotation": 0.5 } } },
        } }],
        "textures": [texture],
        "images": [{ "bufferView": 4 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR" },
            { "bufferView": 3, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 6 },
            { "buffer": 0, "byteOffset": 68, "byteLength": 12 },
            { "buffer": 0, "byteOffset": picture_at, "byteLength": picture.len() },
        ],
        "buffers": [{ "byteLength": bytes.len() }],
    });
    (document, bytes)
}

/// A triangle with these bytes as its picture.
pub fn with_picture(picture: &[u8]) -> Vec<u8> {
    let (document, bytes) = triangle(picture);
    container(&document, &bytes)
}

/// Documents of the kinds that are read: a picture in PNG, in Basis; no indices, strips, fans, no scene, no material.
fn documents() -> Vec<(Value, Vec<u8>)> {
    let mut documents = vec![triangle(&picture::png(2, 2)), triangle(&basis::etc1s())];
    let mut changed = |change: fn(&mut Value)| {
        let (mut document, bytes) = triangle(&picture::png(1, 1));
        change(&mut document);
        documents.push((document, bytes));
    };
    changed(|document| {
        drop(document["meshes"][0]["primitives"][0].as_object_mut().and_then(|all| all.remove("indices")))
    });
    changed(|document| document["meshes"][0]["primitives"][0]["mode"] = json!(5));
    changed(|document| document["meshes"][0]["primitives"][0]["mode"] = json!(6));
    changed(|document| drop(document.as_object_mut().and_then(|all| all.remove("scenes"))));
    changed(|document| {
        drop(document["meshes"][0]["primitives"][0].as_object_mut().and_then(|all| all.remove("material")))
    });
    changed(|document| {
        document["nodes"][1] = json!({ "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] })
    });
    documents
}

/// Binary files.
pub fn binaries() -> Vec<Vec<u8>> {
    documents().iter().map(|(document, bytes)| container(document, bytes)).collect()
}

/// Text files, with their bytes in them.
pub fn texts() -> Vec<Vec<u8>> {
    let text = |(mut document, bytes): (Value, Vec<u8>)| {
        document["buffers"][0]["uri"] =
            format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes)).into();
        document.to_string().into_bytes()
    };
    documents().into_iter().map(text).collect()
}
