//! Tests the VirtualHome platform with the stand-in executable: graph, paths, views, labels, rooms, and broken answers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    io::{BufReader, Write},
    net::TcpListener,
    thread,
    time::Duration,
};
use wayword_core::{DVec3, Frame, Heading, ObjectId, PathRequest, Platform, Pose, SceneId, ViewGaze};
use wayword_house::{HouseGround, HousePlatform, HouseScene, generate_house};
use wayword_live::{
    LivePictureOptions, StandInHouses,
    virtualhome::{VirtualHomeClient, VirtualHomeOptions, VirtualHomePlatform, stand_in::VirtualHomeStandIn},
};
use wayword_testkit::read_http_request;

fn start() -> (VirtualHomePlatform, VirtualHomeStandIn) {
    let simulator = VirtualHomeStandIn::start(([127, 0, 0, 1], 0).into()).unwrap();
    let pictures = LivePictureOptions { width_px: 160, height_px: 120, ..LivePictureOptions::default() };
    let timeout = Duration::from_secs(20);
    (VirtualHomePlatform::new(VirtualHomeOptions { url: simulator.url(), timeout, pictures }), simulator)
}

fn scene() -> SceneId {
    SceneId::new("home_0").unwrap()
}

/// The house that the stand-in shows as home 0.
fn house() -> HouseScene {
    HouseScene::new((1..).map(generate_house).find(|house| house.storeys == 1).unwrap()).unwrap()
}

#[test]
fn the_graph_leads_through_doors_from_room_to_room() {
    let (platform, _simulator) = start();
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let house = house().house;
    let ground = HouseGround::for_house(&house);
    let eyes: Vec<_> = graph.viewpoints().map(|id| graph.position_of(id).unwrap()).collect();
    assert!(eyes.len() > 20 && graph.count_components() == 1, "{} viewpoints", eyes.len());
    let rooms: std::collections::BTreeSet<_> = eyes
        .iter()
        .filter_map(|eye| house.room_at(eye.x, eye.y, 0.0))
        .map(|room| (room.outline.x0, room.outline.y0))
        .collect();
    assert!(rooms.len() * 3 >= house.rooms.len() * 2, "{} of {} rooms", rooms.len(), house.rooms.len());
    // The leaves of open doors are not in the graph, so a few places may lie behind one.
    let walkable = eyes.iter().filter(|eye| ground.is_walkable(eye.with_z(0.0))).count();
    assert!(walkable * 20 >= eyes.len() * 18, "{walkable} of {} can be stood on", eyes.len());
}

#[test]
fn paths_keep_to_their_length_and_end_at_their_target_and_repeat() {
    let (platform, _simulator) = start();
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

#[test]
fn look_returns_the_houses_pixels_with_names_and_room() {
    let (platform, _simulator) = start();
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let (drawn, mut labels) = (house(), 0);
    for id in graph.viewpoints().step_by(9) {
        let frame = graph.path_frames(std::slice::from_ref(id), None).unwrap().remove(0);
        let view = platform.look_from(&scene(), &frame, ViewGaze::quarter_view(Heading::new(2.0).unwrap())).unwrap();
        let camera = wayword_render::PinholeCamera {
            position: frame.pose.position,
            heading_rad: 2.0,
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
        let without =
            platform.look_without_picture(&scene(), &frame, ViewGaze::quarter_view(Heading::new(2.0).unwrap()));
        let without = without.unwrap();
        assert!(without.image.is_none() && without.ground_truth() == Some(truth), "labels need no picture");
        for label in &truth.labels {
            let number: u32 = label.object.as_str().parse().unwrap();
            let name = drawn.objects[&number].name.replace(' ', "");
            assert!(label.name.replace(' ', "") == name, "{} is {name}", label.name);
            assert!(picture.ids.contains(&number));
        }
        labels += truth.labels.len();
    }
    assert!(labels > 5, "{labels}");
}

/// In a doorway, the room is the one into which the eye looks, as in the built-in platform.
#[test]
fn rooms_are_those_of_the_built_in_platform_in_doorways_too() {
    let (platform, _simulator) = start();
    let (within, house) = (HousePlatform::default(), house().house);
    let scene_within = HousePlatform::scene_of(house.seed).unwrap();
    let doorways: Vec<_> = house.openings.iter().filter(|opening| opening.is_passable()).collect();
    let ends = doorways.iter().map(|opening| {
        let (x, y) = opening.span.thickened_by(1).centre();
        DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0, 1.5)
    });
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let eyes = graph.viewpoints().step_by(9).map(|id| graph.position_of(id).unwrap()).collect::<Vec<_>>();
    let mut told = 0;
    for (eye, turn) in ends.chain(eyes).flat_map(|eye| [0.3, 1.9, 3.4, 5.0].map(|turn| (eye, turn))) {
        let frame = Frame { pose: Pose::looking_level(eye, Heading::new(turn).unwrap()), viewpoint: None, level: None };
        let gaze = ViewGaze::quarter_view(frame.pose.heading);
        let room = |platform: &dyn Platform, scene: &SceneId| {
            let view = platform.look_without_picture(scene, &frame, gaze).unwrap();
            view.ground_truth().unwrap().room.clone()
        };
        let expected = room(&within, &scene_within);
        assert_eq!(room(&platform, &scene()), expected, "at {eye}, {turn} rad");
        told += usize::from(expected.is_some());
    }
    assert!(told > 4 * doorways.len(), "{told}");
}

/// Home `n` is house `n` of the list.
#[test]
fn several_houses_are_homes_of_their_own() {
    let houses = StandInHouses::with_one_storey(5, 3);
    let simulator = VirtualHomeStandIn::showing_houses(([127, 0, 0, 1], 0).into(), houses.clone()).unwrap();
    let options = VirtualHomeOptions { url: simulator.url(), timeout: Duration::from_secs(20), ..Default::default() };
    let platform = VirtualHomePlatform::new(options);
    let shown = VirtualHomeStandIn::shown_scenes(&houses).unwrap();
    // Forwards and backwards: on the way back every home was surveyed before.
    for shown in shown.iter().chain(shown.iter().rev()) {
        let scene = SceneId::new(shown.scene.clone()).unwrap();
        let house = generate_house(shown.seed);
        for piece in &house.furniture {
            let object = ObjectId::new(piece.id.to_string()).unwrap();
            let frame = Frame {
                pose: Pose::looking_level(DVec3::new(1.0, 1.0, 1.5), Heading::NORTH),
                viewpoint: None,
                level: None,
            };
            let name = platform.catalogue().object_name(&scene, &frame, &object).unwrap();
            assert_eq!(name.as_deref(), Some(&*piece.name), "{shown}");
        }
    }
    let beyond = platform.graph_for_scene(&SceneId::new("home_3").unwrap()).unwrap_err().to_string();
    assert!(beyond.contains("cannot do that"), "{beyond}");
}

#[test]
fn a_simulator_that_is_started_anew_gets_its_home_again() {
    let (platform, simulator) = start();
    let graph = platform.graph_for_scene(&scene()).unwrap();
    let first = graph.viewpoints().next().unwrap().clone();
    let frame = graph.path_frames(&[first], None).unwrap().remove(0);
    let look = || platform.look_from(&scene(), &frame, ViewGaze::quarter_view(Heading::NORTH));
    let before = look().unwrap();
    // Another client takes the camera away.
    VirtualHomeClient::new(simulator.url(), Duration::from_secs(5)).reset(3).unwrap();
    assert_eq!(look().unwrap().image.unwrap().rgb_bytes(), before.image.unwrap().rgb_bytes());
}

#[test]
fn scenes_are_homes_and_a_simulator_that_is_not_there_is_named() {
    let (platform, simulator) = start();
    assert_eq!(platform.list_scenes().unwrap().len(), 50);
    let unknown = platform.graph_for_scene(&SceneId::new("home_50").unwrap()).unwrap_err().to_string();
    assert!(unknown.contains("home_0 to home_49"), "{unknown}");
    drop(simulator);
    let gone = platform.graph_for_scene(&scene()).unwrap_err().to_string();
    assert!(
        gone.contains("http://127.0.0.1") && gone.contains("-http-port=PORT, where PORT is the port in --at"),
        "{gone}"
    );
}

/// The stand-in fails to clear where no home is loaded, as the genuine executable may. The genuine client goes on then.
#[test]
fn reset_goes_on_when_clear_fails() {
    let simulator = VirtualHomeStandIn::start(([127, 0, 0, 1], 0).into()).unwrap();
    let mut client = VirtualHomeClient::new(simulator.url(), Duration::from_secs(20));
    client.reset(0).unwrap();
    assert!(!client.environment_graph().unwrap().nodes.is_empty());
}

#[test]
fn progress_lines_name_the_simulator_and_how_to_start_it() {
    let (platform, simulator) = start();
    let heard = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    let hearing = heard.clone();
    let hear = move |line: &str| hearing.lock().unwrap().push(line.to_owned());
    let platform = platform.heard_by(std::sync::Arc::new(hear));
    platform.graph_for_scene(&scene()).unwrap();
    let lines = heard.lock().unwrap().join("\n");
    assert!(lines.contains(&format!("asking VirtualHome at {} for home_0", simulator.url())), "{lines}");
    assert!(lines.contains(&format!("-batchmode -http-port={}", simulator.port())), "{lines}");
}

/// The client's error for an answer, whatever the request was.
fn answered(status: &'static str, announced: usize, content: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let simulator = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        read_http_request(&mut BufReader::new(&stream)).unwrap();
        let _ = write!(stream, "HTTP/1.1 {status}\r\nContent-Length: {announced}\r\n\r\n{content}");
    });
    let error = VirtualHomeClient::new(url, Duration::from_secs(5)).environment_graph().unwrap_err();
    simulator.join().unwrap();
    error.to_string()
}

#[test]
fn unreadable_answers_name_position_and_expected_content() {
    let cases = [
        ("200 OK", "{]", "the answer is not JSON with `success`: "),
        ("200 OK", r#"{"success":true,"message":"nodes?"}"#, "the answer is not a graph of nodes with boxes: "),
        ("200 OK", r#"{"success":true,"message":"{\"nodes\":[{\"id\":true}]}"}"#, "line 1 column 20"),
        ("200 OK", r#"{"success":false,"message":"no home"}"#, "says that it failed: no home"),
        ("500 Oh", "sad", "status 500: sad"),
    ];
    for (status, content, expected) in cases {
        let error = answered(status, content.len(), content);
        assert!(error.contains(expected), "{error}");
    }
    let cut = answered("200 OK", usize::MAX / 2, "{");
    assert!(cut.contains("environment_graph"), "{cut}");
}
