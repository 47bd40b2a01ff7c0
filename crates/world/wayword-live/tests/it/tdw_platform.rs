//! Tests the ThreeDWorld platform with the stand-in build: graph, paths, views, labels, and recovery from a lost build.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    collections::BTreeSet,
    fs,
    net::SocketAddr,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::Duration,
};
use wayword_core::{Heading, ObjectId, PathRequest, Platform, SceneId, ViewGaze};
use wayword_house::{HouseGround, HouseOptions, HousePlatform, HouseScene, ObjectRole, generate_house};
use wayword_live::{
    LivePictureOptions, StandInHouses,
    tdw::{
        ControllerOptions, TdwOptions, TdwPlatform,
        stand_in::{StandInFurnishing, StandInOptions, TdwStandIn},
    },
};

fn start(options: StandInOptions) -> (TdwPlatform, TdwStandIn) {
    start_with(options, None)
}

fn start_with(options: StandInOptions, package: Option<PathBuf>) -> (TdwPlatform, TdwStandIn) {
    let controller = ControllerOptions {
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        connect_timeout: Duration::from_secs(20),
        step_timeout: Duration::from_secs(60),
    };
    let pictures = LivePictureOptions { width_px: 160, height_px: 120, ..LivePictureOptions::default() };
    let platform = TdwPlatform::new(TdwOptions { controller, pictures, package }).unwrap();
    let address = platform.waits_at().trim_start_matches("tcp://").parse().unwrap();
    let build = TdwStandIn::start(address, options);
    (platform, build)
}

fn scene() -> SceneId {
    SceneId::new("floorplan_1a").unwrap()
}

#[test]
fn the_graph_lies_on_walkable_ground_and_is_one() {
    let (platform, _build) = start(StandInOptions::default());
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let house = (1..).map(generate_house).find(|house| house.storeys == 1).unwrap();
    let ground = HouseGround::for_house(&house);
    assert!(graph.len() > 20 && graph.count_components() == 1, "{} viewpoints", graph.len());
    let rooms: BTreeSet<_> = graph
        .viewpoints()
        .map(|id| {
            let eye = graph.position_of(id).unwrap();
            assert!((eye.z - 1.5).abs() < 1e-6);
            assert!(ground.is_walkable(eye.with_z(0.0)), "{eye}");
            house.room_at(eye.x, eye.y, 0.0).unwrap().outline.x0
        })
        .collect();
    assert!(rooms.len() >= 3);
}

#[test]
fn paths_keep_to_their_length_and_end_at_their_target_and_repeat() {
    let (platform, _build) = start(StandInOptions::default());
    let request = PathRequest { length_m: 4.0..=16.0, ..PathRequest::default() };
    for seed in 0..2 {
        let path = platform.sample_path(&scene(), &request, seed).unwrap();
        assert!(request.allows_length_of(&path));
        assert!(path.moves().iter().all(|step| step.distance_m < 1.01));
        let (target, last) = (path.target.clone().unwrap(), path.frames.last().unwrap());
        assert_eq!(platform.catalogue().object_name(&scene(), last, &target.object).unwrap(), Some(target.name));
        assert_eq!(platform.sample_path(&scene(), &request, seed).unwrap(), path);
    }
}

/// Through the whole chain, a view has the pixels that our renderer draws, and labels of the objects that they show.
#[test]
fn look_returns_the_houses_pixels_and_labels_of_visible_objects() {
    let (platform, _build) = start(StandInOptions::default());
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let drawn = HouseScene::new((1..).map(generate_house).find(|house| house.storeys == 1).unwrap()).unwrap();
    let mut labels = 0;
    for id in graph.viewpoints().step_by(9) {
        let frame = graph.path_frames(std::slice::from_ref(id), None).unwrap().remove(0);
        let gaze = ViewGaze::quarter_view(Heading::new(1.0).unwrap());
        let view = platform.look_from(&scene(), &frame, gaze).unwrap();
        let camera = wayword_render::PinholeCamera {
            position: frame.pose.position,
            heading_rad: 1.0,
            elevation_rad: 0.0,
            vertical_fov_rad: 2.0 * libm::atan(0.75),
            width: 160,
            height: 120,
        };
        let picture = drawn.render_picture(&camera).unwrap();
        let pixels = view.image.as_ref().unwrap().rgb_bytes();
        let off = picture.rgb.iter().zip(pixels).filter(|(a, b)| a.abs_diff(**b) > 8).count();
        assert!(off < pixels.len() / 200, "{off} of {} values differ", pixels.len());
        let truth = view.ground_truth().unwrap();
        let without = platform.look_without_picture(&scene(), &frame, gaze).unwrap();
        assert!(without.image.is_none() && without.ground_truth() == Some(truth), "labels need no picture");
        assert!(truth.lists_objects);
        for label in &truth.labels {
            let object = &drawn.objects[&label.object.as_str().parse::<u32>().unwrap()];
            assert!(object.role != ObjectRole::Shell && object.name == label.name);
            assert!(label.position.unwrap().distance(object.centre_m()) < 1e-4);
            assert!(picture.ids.contains(&label.object.as_str().parse().unwrap()));
        }
        labels += truth.labels.len();
    }
    assert!(labels > 5, "{labels}");
}

/// The built-in platform knows the same house directly. The pixels and boxes that come over the socket must yield the
/// same labels.
#[test]
fn labels_are_those_of_the_built_in_platform() {
    let (platform, _build) = start(StandInOptions::default());
    let seed = (1..).find(|seed| generate_house(*seed).storeys == 1).unwrap();
    let within = HousePlatform::new(HouseOptions { width_px: 160, height_px: 120, ..HouseOptions::default() });
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let mut labels = 0;
    for id in graph.viewpoints().step_by(5) {
        let frame = graph.path_frames(std::slice::from_ref(id), None).unwrap().remove(0);
        let told = |platform: &dyn Platform, scene: &SceneId| -> BTreeSet<(ObjectId, String)> {
            let view = platform.look_from(scene, &frame, ViewGaze::quarter_view(Heading::new(4.0).unwrap())).unwrap();
            view.ground_truth().unwrap().labels.iter().map(|label| (label.object.clone(), label.name.clone())).collect()
        };
        let ours = told(&platform, &scene());
        assert_eq!(ours, told(&within, &HousePlatform::scene_of(seed).unwrap()));
        labels += ours.len();
    }
    assert!(labels > 10, "{labels}");
}

/// Each house is the floor plan of its place, with labels of its furniture alone.
#[test]
fn several_houses_are_floor_plans_of_their_own() {
    let houses = StandInHouses::with_one_storey(5, 3);
    let shown = TdwStandIn::shown_scenes(&houses).unwrap();
    let (platform, _build) =
        start(StandInOptions { houses, furnished: StandInFurnishing::Always, ..Default::default() });
    for shown in shown.iter().chain(shown.iter().rev()) {
        let scene = SceneId::new(shown.scene.clone()).unwrap();
        let graph = platform.graph_for_scene(&scene).unwrap();
        let frame = graph.path_frames(&[graph.viewpoints().next().unwrap().clone()], None).unwrap().remove(0);
        let house = HouseScene::new(generate_house(shown.seed)).unwrap();
        for (id, object) in &house.objects {
            let told =
                platform.catalogue().object_name(&scene, &frame, &ObjectId::new(id.to_string()).unwrap()).unwrap();
            let expected = (object.role == ObjectRole::Furniture).then_some(object.name.as_str());
            assert_eq!(told.as_deref(), expected, "{shown}");
        }
    }
}

#[test]
fn sample_path_is_the_same_when_the_build_is_lost_once() {
    let request = PathRequest { length_m: 4.0..=16.0, ..PathRequest::default() };
    let (steady, _build) = start(StandInOptions::default());
    let (shaky, _other) = start(StandInOptions { breaks_after: Some(5), ..StandInOptions::default() });
    let expected = steady.sample_path(&scene(), &request, 3).unwrap();
    assert_eq!(shaky.sample_path(&scene(), &request, 3).unwrap(), expected);
}

#[test]
fn graph_refuses_an_unknown_scene_without_a_build() {
    let controller = ControllerOptions {
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        connect_timeout: Duration::from_millis(50),
        ..ControllerOptions::default()
    };
    let platform = TdwPlatform::new(TdwOptions { controller, ..TdwOptions::default() }).unwrap();
    let unknown = platform.graph_for_scene(&SceneId::new("floorplan_9z").unwrap()).unwrap_err().to_string();
    assert!(unknown.contains("room_8x10"), "{unknown}");
    let alone = platform.graph_for_scene(&scene()).unwrap_err().to_string();
    assert!(alone.contains("tcp://127.0.0.1") && alone.contains("TDW.x86_64"), "{alone}");
    assert!(platform.list_scenes().unwrap().contains(&scene()));
}

#[test]
fn graph_of_a_furnished_plan_without_the_package_names_the_flag() {
    let (platform, _build) = start(StandInOptions::default());
    let error = platform.graph_for_scene(&SceneId::new("floorplan_1a_0").unwrap()).unwrap_err().to_string();
    assert!(error.contains(": the furniture of floorplan_1a_0 is not available; give --data the folder of"), "{error}");
}

/// The part of the Python package `tdw` that a floor plan with one sofa needs.
fn package(folder: &Path) {
    let write = |name: &str, text: String| {
        fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
        fs::write(folder.join(name), text).unwrap();
    };
    let (place, one) = (r#"{"x":1,"y":0,"z":1}"#, r#"{"x":1,"y":1,"z":1}"#);
    let sofa = format!(
        r#"{{"name":"sofa_a","library":"models.json","position":{place},"rotation":{place},"scale_factor":{one}}}"#
    );
    write("add_ons/floorplan_layouts.json", format!(r#"{{"1":{{"0":[{sofa}]}}}}"#));
    let urls = r#"{"Linux":"u","Darwin":"u","Windows":"u"}"#;
    let record = format!(r#"{{"urls":{urls},"scale_factor":1.0,"wcategory":"sofa"}}"#);
    write("metadata_libraries/models.json", format!(r#"{{"records":{{"sofa_a":{record}}}}}"#));
}

/// The ground truth of a view to the north from every seventh viewpoint of a scene.
fn truths(platform: &TdwPlatform, scene: &str) -> Vec<Option<wayword_core::GroundTruth>> {
    let scene = SceneId::new(scene).unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let eyes: Vec<_> = graph.viewpoints().step_by(7).cloned().collect();
    let frames = eyes.iter().map(|eye| graph.path_frames(std::slice::from_ref(eye), None).unwrap().remove(0));
    let look = |frame| {
        platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap().ground_truth().cloned()
    };
    frames.map(look).collect()
}

#[test]
fn unfurnished_plan_has_no_labels_and_a_hint_about_furniture() {
    let folder = tempfile::tempdir().unwrap();
    package(folder.path());
    let honest = StandInOptions { furnished: StandInFurnishing::OnceAdded, ..StandInOptions::default() };
    let (platform, _build) = start_with(honest, Some(folder.path().to_owned()));
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hearing = heard.clone();
    let platform = platform.heard_by(Arc::new(move |line: &str| hearing.lock().unwrap().push(line.to_owned())));
    assert!(truths(&platform, "floorplan_1a").iter().all(Option::is_none), "what shows there is not known");
    let port = platform.waits_at().rsplit(':').next().unwrap().to_owned();
    let lines = heard.lock().unwrap().join("\n");
    for told in [
        &format!("waiting up to 20 s for a ThreeDWorld build to connect to 127.0.0.1:{port}"),
        &format!("TDW.x86_64 -port {port}"),
        "build 1.13.0.0 has connected",
        "loads floorplan_1a;",
        "floorplan_1a has no furniture",
        "as in floorplan_1a_0,",
        "--data",
    ] {
        assert!(lines.contains(told), "{told}: {lines}");
    }
    heard.lock().unwrap().clear();
    let furnished = truths(&platform, "floorplan_1a_0");
    assert!(furnished.iter().flatten().any(|truth| truth.lists_objects && !truth.labels.is_empty()));
    assert!(!heard.lock().unwrap().join("\n").contains("has no furniture"));
}
