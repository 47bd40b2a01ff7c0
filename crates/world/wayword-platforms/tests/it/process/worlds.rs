//! Tests with a world program that behaves.

use super::{actor, look, options, pid, scene, started};
use std::{collections::BTreeSet, path::Path, sync::Arc};
use wayword_core::{Heading, ObjectId, PathRequest, Platform, ViewGaze, ViewpointId};
use wayword_platforms::ProcessPlatform;

fn request() -> PathRequest {
    PathRequest { hops: 2..=3, length_m: 3.0..=7.0 }
}

#[test]
fn a_world_is_listed_walked_and_seen() {
    let platform = started("behaves").unwrap();
    assert_eq!((platform.name(), platform.world().name.as_str()), ("process", "actor"));
    assert_eq!(platform.list_scenes().unwrap(), [scene("bad"), scene("good")], "scenes are sorted");
    let good = scene("good");
    let graph = platform.graph_for_scene(&good).unwrap();
    assert_eq!((graph.len(), graph.edges().count()), (4, 3));
    assert!(Arc::ptr_eq(&graph, &platform.graph_for_scene(&good).unwrap()), "a scene's graph is asked for once");
    let path = platform.sample_path(&good, &request(), 3).unwrap();
    assert_eq!(path, platform.sample_path(&good, &request(), 3).unwrap());
    assert!(request().allows_length_of(&path));
    let view = look(&platform, "good").unwrap();
    let image = view.image.as_ref().unwrap();
    assert_eq!((image.width_px(), image.height_px(), &image.rgb_bytes()[..3]), (32, 24, &[10, 200, 30][..]));
    let labels = &view.ground_truth().unwrap().labels;
    assert_eq!((labels.len(), labels[0].name.as_str()), (1, "lamp"));
    assert!((labels[0].heading.rad() - libm::atan2(actor::LAMP[0], actor::LAMP[1])).abs() < 1e-12);
}

#[test]
fn objects_are_named_and_found_by_labels_if_the_world_offers_neither() {
    let platform = started("behaves").unwrap();
    let (good, lamp) = (scene("good"), ObjectId::new("7").unwrap());
    let graph = platform.graph_for_scene(&good).unwrap();
    let frame = graph.path_frames(&[ViewpointId::new("a").unwrap()], None).unwrap().remove(0);
    assert_eq!(platform.catalogue().object_name(&good, &frame, &lamp).unwrap().as_deref(), Some("lamp"));
    assert_eq!(platform.catalogue().object_name(&good, &frame, &ObjectId::new("8").unwrap()).unwrap(), None);
    let everywhere: BTreeSet<ViewpointId> = graph.viewpoints().cloned().collect();
    assert_eq!(platform.catalogue().visible_from(&good, &lamp).unwrap(), Some(everywhere));
    let view = platform.look_without_picture(&good, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap();
    assert!(view.image.is_none() && view.ground_truth().is_some());
}

#[test]
fn pictures_may_be_files_of_the_folder_that_the_greeting_names() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("view.png"), actor::png(actor::WIDTH_PX, actor::HEIGHT_PX)).unwrap();
    let options = options("leaves pictures", folder.path());
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    assert!(look(&platform, "bad").unwrap().image.is_some());
}

#[test]
fn a_world_may_draw_its_own_paths_if_they_fit_the_request() {
    let (good, seed) = (scene("good"), 5);
    let drawn = |role: &str, request: &PathRequest| {
        started(role).unwrap().sample_path(&good, request, seed).map_err(|error| error.to_string())
    };
    let path = drawn("draws viewpoints", &request()).unwrap();
    let names: Vec<_> = path.frames.iter().map(|frame| frame.viewpoint.as_ref().unwrap().as_str()).collect();
    assert_eq!(names, ["a", "b", "c"]);
    assert_eq!(path, drawn("draws viewpoints", &request()).unwrap(), "the seed that is sent is the same");
    // The number of hops is not checked for a path over open ground.
    let path = drawn("draws places", &request()).unwrap();
    assert!((path.length_m().unwrap() - 5.0).abs() < 1e-12 && path.frames[1].level == Some(1));
    let long = PathRequest { length_m: 6.0..=7.0, ..request() };
    for (role, request, says) in [
        ("draws viewpoints", &long, "metres: 4.000; expected 2 to 3 hops and 6 to 7 metres"),
        ("draws places", &long, "metres: 5.000"),
        ("draws strangers", &request(), "nobody is not in the graph"),
        ("draws a ghost", &request(), "`target` \"ghost\" is not known"),
        ("draws a spin", &request(), "`heading_rad` is 1e308"),
        ("draws a tower", &request(), "`level` is 99999, expected 1"),
        ("draws stubs", &request(), "`stops` has length 1"),
        ("draws nothing", &request(), "has no path with 2 to 3 hops"),
    ] {
        let error = drawn(role, request).unwrap_err();
        assert!(error.contains(says), "{role}: {error}");
    }
}

#[test]
fn a_list_or_a_graph_that_repeats_itself_is_refused() {
    let twice = started("repeats").unwrap().list_scenes().unwrap_err().to_string();
    assert!(twice.contains("`scenes` lists good twice"), "{twice}");
    let to_itself = started("loops").unwrap().graph_for_scene(&scene("good")).unwrap_err().to_string();
    assert!(to_itself.contains("`edges[1]` leads from viewpoint b to itself"), "{to_itself}");
}

#[test]
fn threads_that_ask_at_once_are_answered_one_after_another() {
    let platform = started("behaves").unwrap();
    let pids: BTreeSet<u32> = std::thread::scope(|scope| {
        let looks = (0..8).map(|_| scope.spawn(|| (0..20).map(|_| pid(&look(&platform, "good").unwrap())).collect()));
        let looks: Vec<_> = looks.collect();
        looks.into_iter().flat_map(|look| -> Vec<u32> { look.join().unwrap() }).collect()
    });
    assert_eq!(pids.len(), 1, "one child answered them all");
}

#[test]
fn a_world_file_starts_its_command_and_its_words_are_passed_on() {
    let folder = tempfile::tempdir().unwrap();
    let options = options("prints", folder.path());
    let mut command = vec!["sh".to_owned()];
    command.extend(options.arguments);
    let file = folder.path().join("world.json");
    let world = serde_json::json!({"command": command, "width_px": 32, "height_px": 24});
    std::fs::write(&file, world.to_string()).unwrap();
    let heard = Arc::new(std::sync::Mutex::new(Vec::new()));
    let platform = {
        let heard = Arc::clone(&heard);
        ProcessPlatform::open(&file, Arc::new(move |line: &str| heard.lock().unwrap().push(line.to_owned()))).unwrap()
    };
    look(&platform, "bad").unwrap_err();
    let heard = heard.lock().unwrap().join("|");
    assert!(heard.contains("about to do something: [31mprints"), "{heard}");
    assert!(ProcessPlatform::open(Path::new("/nowhere/world.json"), Arc::new(|_: &str| ())).is_err());
}
