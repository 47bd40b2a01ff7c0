//! Tests of scenes with a viewpoint graph from a file: a yard that is written here, without stage configuration or
//! navmesh.

use super::{tests::folder, *};
use serde_json::{Value, json};
use wayword_core::{DVec3, Heading, Pose, ViewGaze};

/// Graph of a ring around the red box of the yard, in Matterport's format.
fn ring_graph() -> Value {
    let places = [[1.5, 1.5], [4.0, 1.5], [6.5, 1.5], [6.5, 4.0], [6.5, 6.5], [4.0, 6.5], [1.5, 6.5], [1.5, 4.0]];
    let joined = |a: usize, b: usize| (a + 1) % places.len() == b || (b + 1) % places.len() == a;
    let item = |(at, [x, y]): (usize, &[f64; 2])| {
        let open: Vec<bool> = (0..places.len()).map(|other| joined(at, other)).collect();
        json!({
            "image_id": format!("v{at}"), "included": true, "height": 1.5, "unobstructed": open, "visible": open,
            "pose": [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, 1.5, 0, 0, 0, 1],
        })
    };
    places.iter().enumerate().map(item).collect()
}

fn open_platform(graph: &Value, has_labels: bool) -> (HabitatPlatform, tempfile::TempDir) {
    let folder = folder(has_labels);
    let graphs = folder.path().join("graphs");
    std::fs::create_dir(&graphs).unwrap();
    std::fs::write(graphs.join("yard_connectivity.json"), graph.to_string()).unwrap();
    let options = HabitatOptions { connectivity: Some(graphs), width_px: 80, height_px: 60, ..Default::default() };
    (HabitatPlatform::open(folder.path(), options, Arc::new(|_: &str| {})).unwrap(), folder)
}

fn yard_id() -> SceneId {
    SceneId::new("yard").unwrap()
}

#[test]
fn paths_go_along_the_graph_from_eye_to_eye() {
    let (platform, _folder) = open_platform(&ring_graph(), true);
    let request = PathRequest { hops: 3..=4, length_m: 5.0..=12.0 };
    for seed in 0..10 {
        let path = platform.sample_path(&yard_id(), &request, seed).unwrap();
        assert!((3..=4).contains(&path.moves().len()));
        assert!(path.frames.iter().all(|frame| frame.viewpoint.is_some() && frame.pose.position.z == 1.5));
        assert_eq!(path.target.unwrap().name, "toy box");
        let view = platform.look_from(&yard_id(), &path.frames[1], ViewGaze::quarter_view(Heading::NORTH)).unwrap();
        assert!(view.image.is_some());
        assert_eq!(platform.ground().ground_route(&yard_id(), &path.frames[0], &path.frames[1]).unwrap(), None);
    }
    assert!(platform.ground().ground_islands(&yard_id()).unwrap().is_empty());
    let seen = platform.catalogue().visible_from(&yard_id(), &ObjectId::new("2").unwrap()).unwrap().unwrap();
    assert_eq!(seen.len(), 8);
    assert!(
        platform
            .files()
            .source_files(&yard_id())
            .unwrap()
            .iter()
            .any(|file| file.ends_with("graphs/yard_connectivity.json"))
    );
    assert!(platform.navmesh(&yard_id()).is_ok(), "who asks for a navmesh gets one");
}

#[test]
fn views_are_taken_at_viewpoints_and_on_the_way_between_two() {
    let (platform, _folder) = open_platform(&ring_graph(), false);
    let look = |x: f64, y: f64, z: f64| {
        let frame =
            Frame { pose: Pose::looking_level(DVec3::new(x, y, z), Heading::NORTH), viewpoint: None, level: None };
        platform.look_without_picture(&yard_id(), &frame, ViewGaze::quarter_view(Heading::NORTH)).is_ok()
    };
    assert!(look(1.5, 1.5, 1.5) && look(2.7, 1.7, 0.4) && look(6.5, 5.1, 1.5));
    assert!(!look(4.0, 4.0, 1.5) && !look(2.7, 2.7, 1.5) && !look(1.5, 1.5, 4.5));
}

#[test]
fn a_scene_is_examined_with_what_it_offers_and_lacks() {
    for has_labels in [true, false] {
        let (platform, _folder) = open_platform(&ring_graph(), has_labels);
        assert_eq!(platform.files().candidate_scenes().unwrap(), [yard_id()]);
        let found = platform.files().examine_scene(&yard_id()).unwrap().unwrap();
        assert_eq!(found.unusable, None);
        assert_eq!(found.graph.unwrap(), wayword_core::GraphSize { viewpoints: 8, edges: 8 });
        let fit = found.fit.unwrap();
        assert_eq!((fit.over_floor, fit.edges, fit.through_walls), (8, 8, 0));
        assert_eq!(
            (found.has_labels, found.lacks.len(), found.storeys),
            (has_labels, 1 - usize::from(has_labels), Some(1))
        );
    }
}

#[test]
fn a_graph_that_does_not_fit_is_refused_whether_or_not_it_was_examined() {
    let mut graph = ring_graph();
    for item in graph.as_array_mut().unwrap() {
        let pose = &mut item["pose"];
        (pose[7], pose[11]) = (pose[11].clone(), json!(-pose[7].as_f64().unwrap()));
    }
    let (platform, _folder) = open_platform(&graph, false);
    let told = platform.graph_for_scene(&yard_id()).unwrap_err().to_string();
    assert!(told.contains("yard_connectivity.json: the viewpoints of this graph have y up, as in Habitat"), "{told}");
    let found = platform.files().examine_scene(&yard_id()).unwrap().unwrap();
    let why = found.unusable.unwrap();
    assert!(why.what.contains("have y up") && why.hint.contains("pose[7] becomes -pose[11]"), "{why:?}");
    assert!(platform.graph_for_scene(&yard_id()).is_err());
}

#[test]
fn broken_files_are_found_before_they_are_drawn() {
    let (platform, folder) = open_platform(&ring_graph(), true);
    let stage = folder.path().join("yard.glb");
    let whole = std::fs::read(&stage).unwrap();
    std::fs::write(&stage, &whole[..whole.len() / 2]).unwrap();
    let why = platform.files().examine_scene(&yard_id()).unwrap().unwrap().unusable.unwrap();
    assert!(why.what.contains("yard.glb"), "{why:?}");
    let (platform, folder) = open_platform(&json!([{ "image_id": "a" }]), true);
    let why = platform.files().examine_scene(&yard_id()).unwrap().unwrap().unusable.unwrap();
    assert!(why.what.contains("viewpoint 0: a: field `included` is missing") && why.hint.contains("get the graph"));
    std::fs::remove_file(folder.path().join("yard.semantic.txt")).unwrap();
    let (platform, folder) = open_platform(&ring_graph(), true);
    std::fs::write(folder.path().join("yard.semantic.txt"), "no annotations").unwrap();
    let why = platform.files().examine_scene(&yard_id()).unwrap().unwrap().unusable.unwrap();
    assert!(why.what.contains("yard.semantic.txt"), "{why:?}");
}
