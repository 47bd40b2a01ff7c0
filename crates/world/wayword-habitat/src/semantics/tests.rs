//! Tests with semantic meshes that are written here: two panels north of the eye, the left one in front of a third.

mod genuine;

use super::*;
use crate::{
    file_error::FileError,
    scene::{HabitatStage, tests::glb},
};
use serde_json::json;
use std::path::Path;
use wayword_core::{Heading, ViewGaze};

const ANNOTATIONS: &str =
    "HM3D Semantic Annotations\n1,FF0000,\"sofa\",0\n2,00FF00,\"lamp\",0\n3,0000FF,\"wall\",0\n4,00FFFF,\"bed\",0\n";

/// A panel that faces south: `x` is its left and right end, `y` its position; z is from 0.5 to 2.5.
fn panel(x: [f32; 2], y: f32) -> [[f32; 3]; 6] {
    let corners = [[x[0], y, 0.5], [x[1], y, 0.5], [x[1], y, 2.5], [x[0], y, 2.5]];
    [0, 1, 2, 0, 2, 3].map(|corner: usize| corners[corner])
}

/// A sofa on the left, a lamp on the right, a wall behind both, and a bed hidden behind the sofa.
fn panels() -> Vec<([[f32; 3]; 6], [u8; 3])> {
    vec![
        (panel([-1.5, -0.2], 3.0), [255, 0, 0]),
        (panel([0.2, 1.5], 3.0), [0, 255, 0]),
        (panel([-3.0, 3.0], 6.0), [0, 0, 255]),
        (panel([-1.4, -0.4], 4.0), [0, 255, 255]),
    ]
}

/// The panels, painted at the vertices.
fn by_vertices() -> Vec<u8> {
    let (mut positions, mut colours) = (Vec::new(), Vec::new());
    for (corners, colour) in panels() {
        positions.extend(corners.iter().flatten().flat_map(|number| number.to_le_bytes()));
        colours.extend((0..6).flat_map(|_| [colour[0], colour[1], colour[2], 255]));
    }
    let (first, second) = (positions.len(), colours.len());
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "COLOR_0": 1 } }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "normalized": true, "count": 24, "type": "VEC4" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": first }, { "buffer": 0, "byteOffset": first, "byteLength": second }],
        "buffers": [{ "byteLength": first + second }],
    });
    glb(&document, &[positions, colours].concat())
}

/// The panels, painted with a texture of four texels, one for each panel.
fn by_texture() -> Vec<u8> {
    let (mut positions, mut uvs, mut texels) = (Vec::new(), Vec::new(), Vec::new());
    for (number, (corners, colour)) in panels().into_iter().enumerate() {
        positions.extend(corners.iter().flatten().flat_map(|number| number.to_le_bytes()));
        let u = (number as f32 + 0.5) / 4.0;
        uvs.extend((0..6).flat_map(|_| [u, 0.5]).flat_map(f32::to_le_bytes));
        texels.extend(colour);
    }
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &texels, 4, 1, image::ExtendedColorType::Rgb8).unwrap();
    let (first, second) = (positions.len(), uvs.len());
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }],
        "images": [{ "bufferView": 2 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC2" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": first },
            { "buffer": 0, "byteOffset": first, "byteLength": second },
            { "buffer": 0, "byteOffset": first + second, "byteLength": png.len() },
        ],
        "buffers": [{ "byteLength": first + second + png.len() }],
    });
    glb(&document, &[positions, uvs, png].concat())
}

/// The panels with numbered faces, as in Matterport3D.
fn by_numbers() -> Vec<u8> {
    let mut file = b"ply\nformat binary_little_endian 1.0\nelement vertex 24\nproperty float x\nproperty float y\nproperty float z\n\
        element face 8\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n"
        .to_vec();
    for (corners, _) in panels() {
        file.extend(corners.iter().flatten().flat_map(|number| number.to_le_bytes()));
    }
    for face in 0..8_i32 {
        file.push(3);
        file.extend([3 * face, 3 * face + 1, 3 * face + 2, face / 2].iter().flat_map(|number| number.to_le_bytes()));
    }
    file
}

const HOUSE: &str = "ASCII 1.0\n\
    R 0 0 0 0 l 0 0 0 -9 -9 0 9 9 3 3 0 0 0\n\
    R 1 0 0 0 b 0 0 0 -1 -1 0 1 1 3 3 0 0 0\n\
    O 0 0 0 0 0 0\nO 1 0 1 0 0 0\nO 2 0 2 0 0 0\nO 3 0 3 0 0 0\n\
    C 0 1 sofa\nC 1 2 lamp\nC 2 3 wall\nC 3 4 bed\n";

fn semantics(mesh: (&str, &[u8]), text: (&str, &str)) -> SceneSemantics {
    read_semantics(mesh, text).unwrap()
}

fn read_semantics(mesh: (&str, &[u8]), text: (&str, &str)) -> Result<SceneSemantics, FileError> {
    let folder = tempfile::tempdir().unwrap();
    let (mesh_file, text_file) = (folder.path().join(mesh.0), folder.path().join(text.0));
    std::fs::write(&mesh_file, mesh.1).unwrap();
    std::fs::write(&text_file, text.1).unwrap();
    let files = if text.0 == "x.house" {
        SemanticFiles { numbered: Some((mesh_file, text_file)), painted: None }
    } else {
        SemanticFiles { painted: Some((mesh_file, text_file)), numbered: None }
    };
    let stage = HabitatStage::from_file(Path::new("x.glb")).unwrap();
    load_semantics(&files, stage.habitat_from_asset).map(Option::unwrap)
}

#[test]
fn a_list_that_is_empty_or_cut_gives_no_labels_or_a_warning() {
    let read = |list: &str| semantics(("x.semantic.glb", &by_vertices()), ("x.semantic.txt", list));
    let whole = read(ANNOTATIONS);
    assert_eq!((whole.has_labels, whole.lists_objects, whole.lack), (true, true, None));
    let lines: Vec<&str> = ANNOTATIONS.split_inclusive('\n').collect();
    let empty = read(lines[0]);
    assert!(!empty.has_labels && empty.lack.unwrap().what.starts_with("0.0 % of the painted triangles"));
    let half = read(&lines[..3].concat());
    assert!(half.has_labels && !half.lists_objects, "objects may be there that the list does not have");
    assert!(half.lack.unwrap().what.starts_with("50.0 % of the painted triangles"));
    let other = HOUSE.replace("\nO ", "\nX ");
    let regions = semantics(("x_semantic.ply", &by_numbers()), ("x.house", &other));
    assert!(!regions.lists_objects && regions.lack.unwrap().what.starts_with("no face of "));
}

#[test]
fn a_semantic_mesh_that_is_broken_or_shows_nothing_gives_no_labels() {
    let document = |nodes: serde_json::Value| json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": nodes });
    let read = |mesh: &[u8]| read_semantics(("x.semantic.glb", mesh), ("x.semantic.txt", ANNOTATIONS));
    let nothing = read(&glb(&document(json!([{}])), b"")).unwrap();
    assert!(!nothing.has_labels && !nothing.lists_objects);
    assert!(nothing.lack.unwrap().what.starts_with("no triangle in x.semantic.glb is painted"));
    for (mesh, reason) in [
        (glb(&document(json!([{ "mesh": 999 }])), b""), "node 0: mesh 999 does not exist"),
        (by_vertices()[..600].to_vec(), "is cut off: it should have "),
        (Vec::new(), "is empty"),
        (b"<html>".to_vec(), "is a web page or XML"),
    ] {
        let error = read(&mesh).unwrap_err();
        assert!(error.reason.starts_with(reason), "{error}");
        assert_ne!(error.hint, crate::scene::EXPORT_HINT, "{error}");
    }
}

fn seen_labels(semantics: &SceneSemantics) -> Vec<(String, String)> {
    let camera = PinholeCamera {
        position: DVec3::new(0.0, 0.0, 1.5),
        heading_rad: 0.0,
        elevation_rad: 0.0,
        vertical_fov_rad: 2.0 * libm::atan(0.75),
        width: 160,
        height: 120,
    };
    let labels = semantics.visible_labels(&camera, ViewGaze::quarter_view(Heading::NORTH)).unwrap();
    labels.into_iter().map(|label| (label.object.to_string(), label.name)).collect()
}

fn two(first: (&str, &str), second: (&str, &str)) -> Vec<(String, String)> {
    [first, second].map(|(id, name)| (id.to_owned(), name.to_owned())).to_vec()
}

#[test]
fn labels_match_the_pixels_for_vertex_and_texture_paint() {
    for mesh in [by_vertices(), by_texture()] {
        let semantics = semantics(("x.semantic.glb", &mesh), ("x.semantic.txt", ANNOTATIONS));
        assert_eq!(seen_labels(&semantics), two(("1", "sofa"), ("2", "lamp")));
        assert_eq!(semantics.room_at(DVec3::ZERO, Heading::NORTH), None);
    }
}

#[test]
fn numbered_faces_have_the_names_of_their_house() {
    let semantics = semantics(("x_semantic.ply", &by_numbers()), ("x.house", HOUSE));
    assert_eq!(seen_labels(&semantics), two(("0", "sofa"), ("1", "lamp")));
    assert_eq!(semantics.room_at(DVec3::new(0.0, 0.0, 1.5), Heading::NORTH), Some("bedroom"));
    assert_eq!(semantics.room_at(DVec3::new(5.0, 0.0, 1.5), Heading::NORTH), Some("living room"));
    let lamp = semantics.find_thing(&ObjectId::new("1").unwrap()).unwrap();
    assert_eq!(lamp.bounds, Some((DVec3::new(0.2_f32.into(), 3.0, 0.5), DVec3::new(1.5, 3.0, 2.5))));
}

#[test]
fn real_house_files_are_read() {
    let data = std::env::var_os("WAYWORD_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data"),
        std::path::PathBuf::from,
    );
    for scan in ["GdvgFV5R1Z5", "gZ6f7yhEvPG"] {
        let file = data.join(format!("matterport/v1/scans/{scan}/house_segmentations/{scan}.house"));
        let Ok(text) = std::fs::read_to_string(&file) else {
            eprintln!("SKIPPED: no {} (set WAYWORD_DATA)", file.display());
            continue;
        };
        let house = super::house::parse_house(&text).unwrap();
        let objects = text.lines().filter(|line| line.starts_with("O ")).count();
        let regions = text.lines().filter(|line| line.starts_with("R ")).count();
        assert_eq!((house.things.len(), house.regions.len()), (objects, regions));
        let named = house.things.iter().filter(|thing| thing.name.is_some()).count();
        // One of the two files lists no objects.
        assert!(objects == 0 || (objects / 10..objects).contains(&named), "{named} of {objects} have names");
        assert!(house.regions.iter().all(|region| region.low.cmple(region.high).all()));
    }
}
