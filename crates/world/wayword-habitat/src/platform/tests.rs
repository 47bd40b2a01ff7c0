//! Tests of the platform on a scene that is written here: a floor of 8 x 8 m with a red box on it, without a navmesh.

use super::*;
use crate::scene::tests::glb;
use serde_json::json;
use wayword_core::{GroundCover, Heading};

/// A quad as two triangles.
pub(super) fn quad(out: &mut Vec<[f32; 3]>, corners: [[f32; 3]; 4]) {
    out.extend([0, 1, 2, 0, 2, 3].map(|corner: usize| corners[corner]));
}

fn boxed() -> Vec<Vec<[f32; 3]>> {
    let (mut floor, mut thing) = (Vec::new(), Vec::new());
    quad(&mut floor, [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]]);
    let corners = [[3.0, 3.0], [5.0, 3.0], [5.0, 5.0], [3.0, 5.0]];
    quad(&mut thing, corners.map(|[x, y]| [x, y, 1.8]));
    for side in 0..4 {
        let ([ax, ay], [bx, by]) = (corners[side], corners[(side + 1) % 4]);
        quad(&mut thing, [[ax, ay, 0.0], [bx, by, 0.0], [bx, by, 1.8], [ax, ay, 1.8]]);
    }
    vec![floor, thing]
}

/// The scene as a GLB with colours at the vertices.
fn file(colours: [[u8; 4]; 2]) -> Vec<u8> {
    painted(&boxed(), &colours)
}

/// A GLB of meshes, given as the corners of their triangles, each mesh in its colour.
fn painted(meshes: &[Vec<[f32; 3]>], colours: &[[u8; 4]]) -> Vec<u8> {
    painted_at(meshes, colours, &json!({ "mesh": 0 }))
}

/// The same with the fields of its only node.
pub(super) fn painted_at(meshes: &[Vec<[f32; 3]>], colours: &[[u8; 4]], node: &serde_json::Value) -> Vec<u8> {
    let (mut bytes, mut views, mut accessors, mut primitives) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (positions, colour) in meshes.iter().zip(colours) {
        let count = positions.len();
        let mut view = |data: Vec<u8>| {
            views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": data.len() }));
            bytes.extend(data);
            views.len() - 1
        };
        let place = view(positions.iter().flatten().flat_map(|number| number.to_le_bytes()).collect());
        let paint = view(colour.repeat(count));
        accessors.push(json!({ "bufferView": place, "componentType": 5126, "count": count, "type": "VEC3" }));
        accessors.push(
            json!({ "bufferView": paint, "componentType": 5121, "normalized": true, "count": count, "type": "VEC4" }),
        );
        let last = accessors.len() - 1;
        primitives.push(json!({ "attributes": { "POSITION": last - 1, "COLOR_0": last }, "material": 0 }));
    }
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [node],
        "meshes": [{ "primitives": primitives }],
        "materials": [{}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len() }],
    });
    glb(&document, &bytes)
}

pub(super) fn folder(has_labels: bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let paint = file([[90, 90, 90, 255], [200, 10, 10, 255]]);
    std::fs::write(folder.path().join("yard.glb"), &paint).unwrap();
    if has_labels {
        let objects = file([[0, 0, 255, 255], [255, 0, 0, 255]]);
        std::fs::write(folder.path().join("yard.semantic.glb"), objects).unwrap();
        let text = "HM3D Semantic Annotations\n1,0000FF,\"floor\",0\n2,FF0000,\"toy_box\",0\n";
        std::fs::write(folder.path().join("yard.semantic.txt"), text).unwrap();
    }
    folder
}

fn platform(has_labels: bool) -> (HabitatPlatform, SceneId) {
    let folder = folder(has_labels);
    let platform = HabitatPlatform::open(
        folder.path(),
        HabitatOptions { width_px: 160, height_px: 120, ..HabitatOptions::default() },
        Arc::new(|_: &str| {}),
    )
    .unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    // Reads the scene while the folder exists; the platform keeps it in memory.
    platform.graph_for_scene(&scene).unwrap();
    (platform, scene)
}

#[test]
fn paths_over_baked_ground_lead_around_the_box() {
    let (platform, scene) = platform(true);
    let request = PathRequest { length_m: 4.0..=9.0, ..PathRequest::default() };
    for seed in 0..20 {
        let path = platform.sample_path(&scene, &request, seed).unwrap();
        assert_eq!(path, platform.sample_path(&scene, &request, seed).unwrap());
        assert!(request.allows_length_of(&path));
        for frame in &path.frames {
            let eye = frame.pose.position;
            assert!(!((3.0..5.0).contains(&eye.x) && (3.0..5.0).contains(&eye.y)), "{eye} stands in the box");
            assert!(
                platform.look_from(&scene, frame, ViewGaze::quarter_view(frame.pose.heading)).unwrap().image.is_some()
            );
        }
        let target = path.target.unwrap();
        assert_eq!((target.object.as_str(), target.name.as_str()), ("2", "toy box"));
    }
}

#[test]
fn views_show_the_scene_and_label_it() {
    let (platform, scene) = platform(true);
    let pose = wayword_core::Pose::looking_level(wayword_core::DVec3::new(4.0, 0.8, 1.5), Heading::NORTH);
    let frame = Frame { pose, viewpoint: None, level: None };
    let view = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap();
    let image = view.image.unwrap();
    let middle = 3 * (60 * 160 + 80);
    assert_eq!(image.rgb_bytes()[middle..middle + 3], [200, 10, 10]);
    let depth = platform.ground().view_depth(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap().unwrap();
    let far_m = depth.level_m([0.4, 0.4, 0.6, 0.6], view.horizontal_fov_rad).unwrap();
    assert!((far_m - 2.2).abs() < 0.03, "the box begins at 3 m north, the eye stands at 0.8: {far_m}");
    let behind =
        platform.look_without_picture(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH.turned_by(3.0))).unwrap();
    assert!(behind.image.is_none());
    let object = ObjectId::new("2").unwrap();
    assert_eq!(platform.catalogue().object_name(&scene, &frame, &object).unwrap().as_deref(), Some("toy box"));
    assert!(!platform.catalogue().visible_from(&scene, &object).unwrap().unwrap().is_empty());
    let away = Frame {
        pose: wayword_core::Pose::looking_level(wayword_core::DVec3::new(90.0, 0.0, 1.5), Heading::NORTH),
        ..frame
    };
    assert!(matches!(
        platform.look_from(&scene, &away, ViewGaze::quarter_view(Heading::NORTH)),
        Err(PlatformError::UnknownViewpoint { .. })
    ));
    assert!(platform.ground().view_depth(&scene, &away, ViewGaze::quarter_view(Heading::NORTH)).is_err());
}

#[test]
fn a_scene_without_semantics_has_no_labels_and_targets() {
    let (platform, scene) = platform(false);
    assert_eq!(platform.catalogue().visible_from(&scene, &ObjectId::new("2").unwrap()).unwrap(), None);
    let path = platform.sample_path(&scene, &PathRequest::default(), 3).unwrap();
    assert_eq!(path.target, None);
    assert!(NavMesh::from_bytes(&platform.navmesh(&scene).unwrap().to_bytes()).is_ok());
    let elsewhere = platform.graph_for_scene(&SceneId::new("attic").unwrap()).unwrap_err().to_string();
    assert_eq!(elsewhere, "there is no scene attic: there are 1: yard ...");
}

#[test]
fn semantic_colours_that_are_not_in_the_list_give_a_warning_and_no_labels() {
    let folder = folder(true);
    // The colours of the list, stored without conversion to linear light, as the program wrote them once.
    let stored = file([[90, 90, 90, 255], [200, 10, 10, 255]]);
    let list = "HM3D Semantic Annotations\n1,5A5A5A,\"floor\",0\n2,C80A0A,\"toy_box\",0\n";
    std::fs::write(folder.path().join("yard.semantic.glb"), stored).unwrap();
    std::fs::write(folder.path().join("yard.semantic.txt"), list).unwrap();
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hearing = Arc::clone(&heard);
    let hear: OutputListener = Arc::new(move |line: &str| hearing.lock().unwrap().push(line.to_owned()));
    let platform = HabitatPlatform::open(folder.path(), HabitatOptions::default(), hear).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    let examined = platform.files().examine_scene(&scene).unwrap().unwrap();
    assert!(!examined.has_labels && examined.rooms == wayword_core::RoomNames::Unknown, "{examined:?}");
    let lack = examined.lacks.last().unwrap();
    assert!(lack.what.starts_with("0.0 % of the painted triangles in yard.semantic.glb"), "{lack:?}");
    assert!(platform.prepared_scene(&scene).unwrap().semantics.is_none());
    assert_eq!(platform.sample_path(&scene, &PathRequest::default(), 3).unwrap().target, None);
    let heard = heard.lock().unwrap();
    let [warning] = &heard[..] else { panic!("{heard:?}") };
    assert!(warning.starts_with("scene yard: 0.0 %") && warning.contains("wayword house --seed SEED"), "{warning}");
}

#[test]
fn a_list_that_lacks_many_colours_gives_labels_but_no_absences() {
    let folder = folder(true);
    std::fs::write(folder.path().join("yard.semantic.txt"), "HM3D Semantic Annotations\n2,FF0000,\"toy_box\",0\n")
        .unwrap();
    let platform = HabitatPlatform::open(folder.path(), HabitatOptions::default(), Arc::new(|_: &str| {})).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    let examined = platform.files().examine_scene(&scene).unwrap().unwrap();
    assert!(examined.has_labels && examined.lacks.last().unwrap().hint.contains("put the list beside the mesh"));
    let prepared = platform.prepared_scene(&scene).unwrap();
    assert!(prepared.semantics.as_ref().is_some_and(|semantics| !semantics.lists_objects));
}

#[test]
fn sample_path_error_reports_the_area_of_the_ground() {
    let (platform, scene) = platform(false);
    let request = PathRequest { length_m: 40.0..=50.0, ..PathRequest::default() };
    let message = platform.sample_path(&scene, &request, 1).unwrap_err().to_string();
    let area = message.split_once("40 to 50 metres on its ").unwrap().1.split_once(" m2 of ground").unwrap().0;
    // 8 x 8 m without the box, and less the agent's radius at every edge.
    assert!((50.0..60.0).contains(&area.parse::<f64>().unwrap()), "{message}");
    assert!(message.contains("units_to_meters, up and front"), "{message}");
}

/// A floor of 8 x 8 m, and a ceiling with a larger top over it: Recast finds the most ground on that top.
fn flat() -> [Vec<[f32; 3]>; 2] {
    let (mut floor, mut slab) = (Vec::new(), Vec::new());
    quad(&mut floor, [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]]);
    let [low, high] = [-1.0, 9.0];
    quad(&mut slab, [[low, low, 2.8], [high, low, 2.8], [high, high, 2.8], [low, high, 2.8]]);
    quad(&mut slab, [[low, high, 2.6], [high, high, 2.6], [high, low, 2.6], [low, low, 2.6]]);
    [floor, slab]
}

fn open_flat(options: HabitatOptions) -> (HabitatPlatform, SceneId, Arc<Mutex<Vec<String>>>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("flat.glb"), painted(&flat(), &[[90; 4], [200; 4]])).unwrap();
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hearing = Arc::clone(&heard);
    let hear: OutputListener = Arc::new(move |line: &str| hearing.lock().unwrap().push(line.to_owned()));
    let platform = HabitatPlatform::open(folder.path(), options, hear).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    (platform, scene, heard, folder)
}

#[test]
fn walks_keep_to_the_floor_under_the_ceiling_and_not_to_its_larger_top() {
    let (platform, scene, heard, _folder) = open_flat(HabitatOptions::default());
    let islands = platform.ground().ground_islands(&scene).unwrap();
    let told: Vec<(GroundCover, bool)> = islands.iter().map(|island| (island.cover, island.is_walked)).collect();
    assert_eq!(told, [(GroundCover::OnRoof, false), (GroundCover::Ceiling, true)]);
    for seed in 0..50 {
        let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
        assert!(path.frames.iter().all(|frame| frame.pose.position.z < 1.8), "{path:?}");
    }
    let graph = platform.graph_for_scene(&scene).unwrap();
    assert!(graph.viewpoints().all(|viewpoint| graph.position_of(viewpoint).unwrap().z < 1.8));
    let heard = heard.lock().unwrap();
    assert_eq!(heard.len(), 1, "{heard:?}");
    assert!(heard[0].contains("paths stay on island 1") && heard[0].contains("use --island"), "{heard:?}");
}

#[test]
fn an_island_that_is_named_is_walked_on_without_a_warning() {
    let (platform, scene, heard, _folder) = open_flat(HabitatOptions { island: Some(0), ..HabitatOptions::default() });
    let path = platform.sample_path(&scene, &PathRequest::default(), 1).unwrap();
    assert!(path.frames.iter().all(|frame| frame.pose.position.z > 4.0), "{path:?}");
    assert!(heard.lock().unwrap().is_empty());
    let (platform, scene, _heard, _folder) = open_flat(HabitatOptions { island: Some(2), ..HabitatOptions::default() });
    let error = platform.graph_for_scene(&scene).unwrap_err().to_string();
    assert!(error.contains("has no island 2: island 0: ") && error.contains("--island"), "{error}");
}

#[test]
fn a_navmesh_of_roofs_alone_is_refused_with_its_islands() {
    let folder = tempfile::tempdir().unwrap();
    let [_, slab] = flat();
    std::fs::write(folder.path().join("slab.glb"), painted(&[slab], &[[200; 4]])).unwrap();
    let stage = crate::scene::HabitatStage::from_file(&folder.path().join("slab.glb")).unwrap();
    let roofs = crate::bake::bake_navmesh(
        &crate::scene::SceneModel::from_stage(&stage).unwrap(),
        &crate::NavMeshSettings::default(),
    );
    let navmesh = folder.path().join("roofs.navmesh");
    std::fs::write(&navmesh, roofs.unwrap().to_bytes()).unwrap();
    let (platform, scene, _heard, _folder) =
        open_flat(HabitatOptions { navmesh: Some(navmesh), ..HabitatOptions::default() });
    let error = platform.graph_for_scene(&scene).unwrap_err().to_string();
    assert!(error.contains("flat.glb: no island of its navmesh is a place to walk on"), "{error}");
    assert!(
        error.contains("island 0: ") && error.contains("on top of a roof") && error.contains("--island"),
        "{error}"
    );
}

#[test]
fn a_way_leads_over_the_ground_with_a_corner_at_every_bend() {
    let (platform, scene) = platform(false);
    let standing = |x: f64, y: f64| {
        let pose = wayword_core::Pose::looking_level(wayword_core::DVec3::new(x, y, 1.5), Heading::NORTH);
        Frame { pose, viewpoint: None, level: None }
    };
    let way = platform.ground().ground_route(&scene, &standing(2.0, 4.0), &standing(6.0, 4.1)).unwrap().unwrap();
    assert!(way.corners.len() >= 3 && way.length_m > 4.5, "{way:?}");
    assert!(way.corners.iter().all(|corner| corner.z.abs() < 0.3), "{way:?}");
    assert_eq!(platform.ground().ground_route(&scene, &standing(2.0, 4.0), &standing(90.0, 4.0)).unwrap(), None);
}
