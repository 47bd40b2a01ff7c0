//! Tests with files that they write themselves.

use super::*;
use proptest::prelude::*;
use serde_json::json;

/// A binary glTF file of a document and its bytes.
pub(crate) fn glb(document: &serde_json::Value, binary: &[u8]) -> Vec<u8> {
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

/// One textured triangle at (0 0 0), (1 0 0), (0 1 0), on a node that is moved 10 m along x.
pub(crate) fn triangle() -> (serde_json::Value, Vec<u8>) {
    let mut bytes: Vec<u8> =
        [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0.0_f32, 0.0, 1.0, 0.0, 0.0, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend([0_u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &[9, 8, 7], 1, 1, image::ExtendedColorType::Rgb8).unwrap();
    let image_at = bytes.len();
    bytes.extend(&png);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "translation": [10, 0, 0], "children": [1] }, { "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }],
        "images": [{ "bufferView": 3, "mimeType": "image/png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 6 },
            { "buffer": 0, "byteOffset": image_at, "byteLength": png.len() },
        ],
        "buffers": [{ "byteLength": bytes.len() }],
    });
    (document, bytes)
}

fn read(bytes: &[u8]) -> Result<SceneModel, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.glb");
    std::fs::write(&file, bytes).unwrap();
    SceneModel::from_stage(&HabitatStage::from_file(&file).unwrap()).map_err(|error| error.to_string())
}

#[test]
fn triangles_lie_where_their_node_is_and_stand_up() {
    let (document, bytes) = triangle();
    let model = read(&glb(&document, &bytes)).unwrap();
    // Without a configuration the file has z up, which is Wayword's own frame.
    assert_eq!(
        model.meshes[0].positions,
        [Vec3::new(10.0, 0.0, 0.0), Vec3::new(11.0, 0.0, 0.0), Vec3::new(10.0, 1.0, 0.0)]
    );
    assert_eq!(model.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(model.materials[0].base_colour, [0.5, 1.0, 1.0, 1.0]);
    assert_eq!(model.textures[0].texels, [[9, 8, 7, 255]]);
    assert_eq!(model.triangles().count(), 1);
}

#[test]
fn textures_of_hm3d_are_found_where_their_extension_says() {
    let (mut document, mut bytes) = triangle();
    let basis = super::pictures::tests::etc1s();
    document["bufferViews"][3] = json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": basis.len() });
    bytes.extend(basis);
    document["buffers"][0]["byteLength"] = bytes.len().into();
    document["images"][0]["mimeType"] = "image/x-basis".into();
    document["textures"][0] = json!({ "extensions": { "GOOGLE_texture_basis": { "source": 0 } } });
    document["extensionsRequired"] = json!(["GOOGLE_texture_basis", "KHR_materials_unlit"]);
    let model = read(&glb(&document, &bytes)).unwrap();
    assert_eq!((model.textures[0].width, model.textures[0].height), (16, 16));
    assert_eq!(model.filters, [TextureFilter::Bilinear], "the file has no smaller copies");
}

#[test]
fn textures_are_looked_up_as_their_sampler_asks() {
    let filter = |sampler: serde_json::Value| {
        let (mut document, bytes) = triangle();
        document["samplers"] = json!([sampler]);
        document["textures"][0]["sampler"] = 0.into();
        read(&glb(&document, &bytes)).unwrap().filters[0]
    };
    for mipmapped in [9984, 9985, 9986, 9987] {
        assert_eq!(filter(json!({ "magFilter": 9729, "minFilter": mipmapped })), TextureFilter::Trilinear);
    }
    assert_eq!(filter(json!({})), TextureFilter::Trilinear, "Habitat's default");
    assert_eq!(filter(json!({ "magFilter": 9729, "minFilter": 9729 })), TextureFilter::Bilinear);
    assert_eq!(filter(json!({ "minFilter": 9728 })), TextureFilter::Bilinear, "near by it blends");
    assert_eq!(filter(json!({ "magFilter": 9728, "minFilter": 9728 })), TextureFilter::Nearest);
    let (document, bytes) = triangle();
    assert_eq!(read(&glb(&document, &bytes)).unwrap().filters, [TextureFilter::Trilinear], "no sampler");
}

#[test]
fn errors_name_the_item() {
    let refusal = |change: fn(&mut serde_json::Value)| {
        let (mut document, bytes) = triangle();
        change(&mut document);
        let error = read(&glb(&document, &bytes)).unwrap_err();
        error.split_once("x.glb: ").unwrap().1.split_once(';').unwrap().0.to_owned()
    };
    assert_eq!(
        refusal(|d| d["accessors"][0]["count"] = 4.into()),
        "mesh 0, primitive 0: accessor 0 lies outside its view"
    );
    assert_eq!(
        refusal(|d| d["accessors"][2]["bufferView"] = 9.into()),
        "mesh 0, primitive 0: accessor 2 view 9 does not exist"
    );
    assert_eq!(refusal(|d| d["textures"][0]["source"] = 5.into()), "material 0: image 5: does not exist");
    assert_eq!(
        refusal(|d| d["bufferViews"][0]["byteLength"] = u64::MAX.into()),
        "mesh 0, primitive 0: accessor 0 view 0 lies outside its buffer"
    );
    assert_eq!(
        refusal(|d| d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])),
        "needs the extension KHR_draco_mesh_compression, which cannot be read"
    );
    assert_eq!(
        refusal(|d| d["buffers"] = json!([{ "byteLength": 1, "uri": "../secret" }])),
        "buffer 0: \"../secret\" is not a file beside the scene"
    );
}

#[test]
fn numbers_that_lead_nowhere_are_refused_with_their_place() {
    let refusal = |change: fn(&mut serde_json::Value)| {
        let (mut document, bytes) = triangle();
        change(&mut document);
        let error = read(&glb(&document, &bytes)).unwrap_err();
        error.split_once("x.glb: ").unwrap().1.split_once(';').unwrap().0.to_owned()
    };
    assert_eq!(refusal(|d| d["scene"] = 5.into()), "scene 5 does not exist: the file has 1, counted from 0");
    assert_eq!(
        refusal(|d| d["scenes"][0]["nodes"] = json!([0, 9])),
        "scene 0: node 9 does not exist: the file has 2, counted from 0"
    );
    assert_eq!(
        refusal(|d| d["nodes"][0]["children"] = json!([1, 9999])),
        "node 0: node 9999 does not exist: the file has 2, counted from 0"
    );
    assert_eq!(
        refusal(|d| d["nodes"][1]["mesh"] = 999.into()),
        "node 1: mesh 999 does not exist: the file has 1, counted from 0"
    );
    assert_eq!(
        refusal(|d| d["meshes"][0]["primitives"][0]["material"] = 999.into()),
        "mesh 0, primitive 0: material 999 does not exist"
    );
    assert_eq!(
        refusal(|d| d["accessors"][1]["count"] = 2.into()),
        "mesh 0, primitive 0: TEXCOORD has 2 entries, but POSITION has 3: each vertex needs one"
    );
    assert_eq!(
        refusal(|d| {
            d["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0, "COLOR_0": 3 });
            d["accessors"]
                .as_array_mut()
                .unwrap()
                .push(json!({ "bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3" }));
        }),
        "mesh 0, primitive 0: COLOR_0 has 2 entries, but POSITION has 3: each vertex needs one"
    );
    assert_eq!(
        refusal(|d| d["accessors"][2]["count"] = 2.into()),
        "mesh 0, primitive 0: its triangles have 2 corners, which is no multiple of 3"
    );
    assert_eq!(
        refusal(|d| d["accessors"][0]["count"] = 2.into()),
        "mesh 0, primitive 0: TEXCOORD has 3 entries, but POSITION has 2: each vertex needs one"
    );
    assert_eq!(
        refusal(|d| {
            d["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 });
            d["accessors"][0]["count"] = 2.into();
        }),
        "mesh 0, primitive 0: its indices name vertex 2, but there are 2, counted from 0"
    );
}

#[test]
fn a_vertex_that_no_scene_has_is_refused_however_it_came_there() {
    let far = |change: &dyn Fn(&mut serde_json::Value, &mut Vec<u8>)| {
        let (mut document, mut bytes) = triangle();
        change(&mut document, &mut bytes);
        read(&glb(&document, &bytes)).map(|_| ())
    };
    for x in [1.1e6_f32, 2e19, 3.4e38, f32::INFINITY, f32::NAN] {
        let error = far(&|_, bytes| bytes[12..16].copy_from_slice(&x.to_le_bytes())).unwrap_err();
        assert!(error.contains("mesh 0, primitive 0: vertex 1 lies at ") && error.contains("1e6 m"), "{error}");
        assert!(error.contains("scale of its node") && error.contains("units_to_meters"), "{error}");
    }
    assert!(far(&|document, _| document["nodes"][0]["scale"] = json!([1e30, 1, 1])).is_err());
    assert!(far(&|document, _| document["nodes"][0]["translation"] = json!([0, 0, 1e12])).is_err());
    assert!(far(&|document, _| document["nodes"][1]["rotation"] = json!([0, 0, 0, 0])).is_err());
    assert_eq!(far(&|_, bytes| bytes[12..16].copy_from_slice(&9e5_f32.to_le_bytes())), Ok(()));
}

/// The corners of a model's only triangle.
fn corners(model: &SceneModel) -> [Vec3; 3] {
    model.triangles().next().unwrap()
}

#[test]
fn a_mirrored_node_keeps_the_side_from_which_a_triangle_is_seen() {
    let (mut document, bytes) = triangle();
    let plain = read(&glb(&document, &bytes)).unwrap();
    let normal = |model: &SceneModel| {
        let [a, b, c] = corners(model);
        (b - a).cross(c - a)
    };
    assert_eq!(normal(&plain), Vec3::Z);
    // As Blender leaves it, as a matrix, flat in one direction, and in a mirrored parent.
    let mirrors = [
        json!({ "mesh": 0, "scale": [-1, 1, 1] }),
        json!({ "mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }),
        json!({ "mesh": 0, "scale": [-2, -2, -2], "rotation": [0, 1, 0, 0] }),
    ];
    for mirror in mirrors {
        document["nodes"][1] = mirror.clone();
        document["nodes"][0] = json!({ "children": [1] });
        let once = read(&glb(&document, &bytes)).unwrap();
        assert!(normal(&once).z.abs() > 0.9, "{mirror}: {once:?}");
        let stored = {
            let [a, b, c] = corners(&once);
            [a, c, b]
        };
        let way = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).z;
        let place = nodes::placed_meshes(&serde_json::from_value(document.clone()).unwrap()).unwrap()[0].1;
        let expected = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| place.transform_point3(corner.as_dvec3()).as_vec3());
        assert_eq!((stored, way(corners(&once)) * way(expected) < 0.0), (expected, true), "{mirror}");
        document["nodes"][0]["scale"] = json!([1, -1, 1]);
        let twice = read(&glb(&document, &bytes)).unwrap();
        assert_eq!(twice.meshes[0].triangles, [[0, 1, 2]], "two mirrors are none");
    }
}

#[test]
fn colours_are_found_wherever_a_material_keeps_them() {
    let read_material = |material: serde_json::Value| {
        let (mut document, bytes) = triangle();
        document["materials"][0] = material;
        let model = read(&glb(&document, &bytes)).unwrap();
        (model.materials[0].base_colour, model.materials[0].texture)
    };
    let diffuse =
        |fields: serde_json::Value| json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": fields } });
    let texture = json!({ "index": 0 });
    let grey = [0.5, 0.5, 0.5, 1.0];
    assert_eq!(read_material(diffuse(json!({ "diffuseTexture": texture }))), ([1.0; 4], Some(0)));
    assert_eq!(read_material(diffuse(json!({ "diffuseFactor": grey }))), (grey, None));
    let mut both = diffuse(json!({ "diffuseFactor": grey }));
    both["pbrMetallicRoughness"] = json!({ "baseColorTexture": texture });
    assert_eq!(read_material(both), ([1.0; 4], Some(0)), "a base colour that is there is the one to draw");
    let black = json!({ "baseColorFactor": [0, 0, 0, 1] });
    let glow = [0.25, 0.5, 1.0];
    let lamp = json!({ "pbrMetallicRoughness": black, "emissiveFactor": glow });
    assert_eq!(read_material(lamp), ([0.25, 0.5, 1.0, 1.0], None));
    let baked = json!({ "emissiveTexture": texture, "emissiveFactor": [1, 1, 1] });
    assert_eq!(read_material(baked), ([1.0; 4], Some(0)));
    let dark = json!({ "pbrMetallicRoughness": black, "emissiveTexture": texture });
    assert_eq!(read_material(dark), ([0.0, 0.0, 0.0, 1.0], None), "a factor of 0 is no light");
    let painted_lamp = json!({ "pbrMetallicRoughness": { "baseColorTexture": texture }, "emissiveFactor": glow });
    assert_eq!(read_material(painted_lamp), ([1.0; 4], Some(0)));
}

#[test]
fn the_transform_of_a_texture_may_choose_its_coordinates() {
    let (mut document, bytes) = triangle();
    let transform = json!({ "scale": [2, 1], "offset": [0.5, 0], "texCoord": 1 });
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({ "KHR_texture_transform": transform });
    document["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0, "TEXCOORD_1": 1 });
    let model = read(&glb(&document, &bytes)).unwrap();
    let uvs: Vec<[f32; 2]> = model.meshes[0].uvs.iter().map(|uv| uv.to_array()).collect();
    assert_eq!(uvs, [[0.5, 0.0], [2.5, 0.0], [0.5, 1.0]]);
}

#[test]
fn an_extension_is_refused_only_if_it_is_needed_and_with_what_helps() {
    let read_with = |name: &str| {
        let (mut document, bytes) = triangle();
        document["extensionsRequired"] = json!([name]);
        read(&glb(&document, &bytes)).map(|_| ())
    };
    for name in ["KHR_materials_variants", "KHR_materials_unlit", "KHR_lights_punctual", "KHR_xmp_json_ld"] {
        assert_eq!(read_with(name), Ok(()));
    }
    for (name, hint) in [
        ("KHR_texture_basisu", "pictures as PNG or JPEG"),
        ("EXT_texture_webp", "pictures as PNG or JPEG"),
        ("EXT_texture_avif", "pictures as PNG or JPEG"),
        ("MSFT_texture_dds", "pictures as PNG or JPEG"),
        ("KHR_draco_mesh_compression", "without geometry compression"),
        ("EXT_meshopt_compression", "without geometry compression"),
        ("EXT_mesh_gpu_instancing", "as a node of its own"),
        ("ACME_new", "without this extension"),
    ] {
        let error = read_with(name).unwrap_err();
        assert!(error.contains(name) && error.contains(hint), "{error}");
    }
    // Not required, but there is no other picture.
    let (mut document, bytes) = triangle();
    document["textures"][0] = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
    let error = read(&glb(&document, &bytes)).unwrap_err();
    assert!(error.contains("texture 0: is only in the format of EXT_texture_webp") && error.contains("PNG"), "{error}");
    document["textures"][0]["source"] = 0.into();
    assert!(read(&glb(&document, &bytes)).is_ok());
}

#[test]
fn nodes_in_a_circle_come_to_an_end() {
    let (mut document, bytes) = triangle();
    document["nodes"][1]["children"] = json!([0, 1]);
    assert_eq!(read(&glb(&document, &bytes)).unwrap().meshes.len(), 1);
}

#[test]
fn repeated_meshes_and_pictures_are_refused_before_memory_fills() {
    let (mut document, mut bytes) = triangle();
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    let grey = vec![7; 1 << 20];
    image::ImageEncoder::write_image(encoder, &grey, 1024, 1024, image::ExtendedColorType::L8).unwrap();
    document["bufferViews"][3] = json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": png.len() });
    bytes.extend(&png);
    document["buffers"][0]["byteLength"] = bytes.len().into();
    document["textures"] = vec![json!({ "source": 0 }); 9].into();
    let surface = |index: usize| json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": index } } });
    document["materials"] = (0..9).map(surface).collect::<Vec<_>>().into();
    let painted = read(&glb(&document, &bytes)).unwrap_err();
    assert!(painted.contains("texels together"), "{painted}");

    let (mut document, mut bytes) = triangle();
    document["accessors"][2] = json!({ "bufferView": 4, "componentType": 5121, "count": 60_000, "type": "SCALAR" });
    let view = json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": 60_000 });
    document["bufferViews"].as_array_mut().unwrap().push(view);
    bytes.extend([0; 60_000]);
    document["nodes"] = vec![json!({ "mesh": 0 }); 400].into();
    document["scenes"][0]["nodes"] = (0..400).collect::<Vec<_>>().into();
    let placed = read(&glb(&document, &bytes)).unwrap_err();
    assert!(placed.contains("corners"), "{placed}");
}

#[test]
fn a_file_beside_is_read_once_however_it_is_spelt() {
    let (mut document, bytes) = triangle();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("x.bin"), &bytes).unwrap();
    let spellings = ["x.bin", "./x.bin", "././x.bin", "x.bin/."];
    document["buffers"] = spellings.map(|uri| json!({ "byteLength": bytes.len(), "uri": uri })).to_vec().into();
    let file = folder.path().join("x.gltf");
    std::fs::write(&file, document.to_string()).unwrap();
    let asset = asset::GltfAsset::read(&file).unwrap();
    assert_eq!(asset.total_bytes(), document.to_string().len() as u64 + bytes.len() as u64);
    assert_eq!(SceneModel::from_stage(&HabitatStage::from_file(&file).unwrap()).unwrap().triangles().count(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn gltf_reader_survives_any_bytes(at in 0usize..2200, with: [u8; 2]) {
        let (document, bytes) = triangle();
        let mut file = glb(&document, &bytes);
        let at = at % file.len();
        for (byte, new) in file.iter_mut().skip(at).zip(with) {
            *byte = new;
        }
        if let Ok(model) = read(&file) {
            let _ = wayword_render::RenderScene::new(model.meshes, model.materials, model.textures);
        }
    }
}
