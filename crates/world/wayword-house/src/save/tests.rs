use super::super::{drawing, generate_house};
use super::*;
use glam::Vec3;
use gltf_reader::{Gltf, mesh::util::ReadColors};

/// All vertices of a file, with their light, in glTF's frame.
fn vertices(file: &Gltf) -> Vec<([f32; 3], [f32; 3])> {
    let blob = file.blob.as_deref().unwrap();
    let mut all = Vec::new();
    for mesh in file.meshes() {
        for primitive in mesh.primitives() {
            let reader = primitive.reader(|_| Some(blob));
            let ReadColors::RgbF32(colours) = reader.read_colors(0).unwrap() else { panic!("colours are floats") };
            all.extend(reader.read_positions().unwrap().zip(colours));
            let count = reader.read_positions().unwrap().len() as u32;
            assert!(reader.read_indices().unwrap().into_u32().all(|index| index < count));
            assert_eq!(reader.read_tex_coords(0).unwrap().into_f32().count(), count as usize);
        }
    }
    all
}

#[test]
fn a_saved_house_can_be_read_by_gltf_libraries() {
    let house = generate_house(4);
    let file = Gltf::from_slice(&encode_glb(&house).unwrap()).unwrap();
    let drawing = drawing::draw_house(&house);
    let drawn: usize = drawing.meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let read = vertices(&file);
    assert_eq!(read.len(), drawn);
    let high = read.iter().map(|(position, _)| position[1]).fold(0.0, f32::max);
    let ceiling = 2.7 + 3.0 * (house.storeys - 1) as f32;
    assert!((high - ceiling).abs() < 0.01, "y is up: {high}");
    assert!(read.iter().all(|(_, light)| light.iter().all(|factor| (0.0..=2.0).contains(factor))));
    let names: Vec<_> = file.nodes().filter_map(|node| node.name()).collect();
    for piece in &house.furniture {
        assert!(names.contains(&format!("{} {}", piece.name, piece.id).as_str()), "{} is missing", piece.name);
    }
    for image in file.images() {
        let gltf_reader::image::Source::View { view, mime_type } = image.source() else { panic!("images are inside") };
        assert_eq!(mime_type, "image/png");
        let bytes = &file.blob.as_ref().unwrap()[view.offset()..view.offset() + view.length()];
        assert_eq!(image::load_from_memory(bytes).unwrap().width(), 256);
    }
}

#[test]
fn factors_and_light_are_saved_as_they_are_multiplied() {
    let house = generate_house(4);
    let (file, drawing) = (Gltf::from_slice(&encode_glb(&house).unwrap()).unwrap(), drawing::draw_house(&house));
    let saved: Vec<_> = file.materials().map(|each| each.pbr_metallic_roughness().base_color_factor()).collect();
    assert_eq!(saved, drawing.materials.iter().map(|each| each.base_colour).collect::<Vec<_>>());
    let sum = |light: &mut dyn Iterator<Item = [f32; 3]>| light.flatten().map(f64::from).sum::<f64>();
    let saved = sum(&mut vertices(&file).into_iter().map(|(_, light)| light));
    let drawn = sum(&mut drawing.meshes.iter().flat_map(|mesh| mesh.colours.iter().copied()));
    assert!((saved / drawn - 1.0).abs() < 1e-9, "{saved} {drawn}");
}

#[test]
fn north_is_minus_z_and_up_is_y_in_gltf() {
    assert_eq!(gltf_from_wayword(Vec3::Y), Vec3::NEG_Z);
    assert_eq!(gltf_from_wayword(Vec3::Z), Vec3::Y);
    // A rotation, not a mirror image.
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(gltf_from_wayword);
    assert_eq!(x.cross(y), z);
}

#[test]
fn navigation_data_names_rooms_objects_and_ways() {
    let folder = tempfile::tempdir().unwrap();
    let house = generate_house(4);
    let HouseFiles { model: looks, navigation: ways, .. } = save_house(&house, folder.path(), None).unwrap();
    assert!(looks.ends_with("house2-4.glb") && looks.metadata().unwrap().len() > 100_000);
    let read: serde_json::Value = serde_json::from_slice(&std::fs::read(ways).unwrap()).unwrap();
    assert_eq!(read["rooms"].as_array().unwrap().len(), house.rooms.len());
    assert_eq!(serde_json::from_value::<House>(read["house"].clone()).unwrap(), house);
    let ground = HouseGround::for_house(&house);
    let (cell_m, origin) = (read["walkable"]["cell_m"].as_f64().unwrap(), &read["walkable"]["origin_m"]);
    for run in read["walkable"]["layers"][0]["runs"].as_array().unwrap() {
        let middle =
            |index: usize, cell: usize| origin[index].as_f64().unwrap() + cell_m * (run[cell].as_f64().unwrap() + 0.5);
        assert!(ground.is_walkable(wayword_core::DVec3::new(middle(0, 2), middle(1, 0), 0.0)));
    }
}

#[test]
fn semantic_glb_gives_every_object_its_own_colour() {
    let house = generate_house(4);
    let text = semantic_txt(&house);
    let mut colours = std::collections::BTreeSet::new();
    for line in text.lines().skip(1) {
        assert!(colours.insert(line.split(',').nth(1).unwrap().to_owned()), "{line}");
    }
    assert!(house.furniture.iter().all(|piece| text.contains(&format!("\"{}\"", piece.name))));
    let file = Gltf::from_slice(&semantic_glb(&house).unwrap()).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()) {
        let ReadColors::RgbF32(painted) = primitive.reader(|_| Some(blob)).read_colors(0).unwrap() else {
            panic!("colours are floats")
        };
        let hex = |[r, g, b]: [u8; 3]| format!("{r:02X}{g:02X}{b:02X}");
        // Habitat converts vertex colours from linear light to sRGB.
        let encode =
            |light: f32| if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
        seen.extend(painted.map(|colour| hex(colour.map(|light| (255.0 * encode(light)).round() as u8))));
    }
    assert!(seen.is_subset(&colours) && seen.len() > 20, "{} of {}", seen.len(), colours.len());
}

#[test]
fn save_house_names_a_missing_folder() {
    let error = save_house(&generate_house(4), std::path::Path::new("/nowhere/at all"), None).unwrap_err().to_string();
    assert!(error.contains("/nowhere/at all/house2-4.glb"), "{error}");
}
