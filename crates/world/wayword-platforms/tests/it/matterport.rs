//! Matterport3D as a platform, on a made-up building.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{FRAC_PI_2, TAU};
use tempfile::TempDir;
use wayword_core::{Frame, Heading, ObjectId, PathRequest, Platform, PlatformError, SceneId, ViewGaze, ViewpointId};
use wayword_platforms::MatterportPlatform;
use wayword_testkit::{SCAN, viewpoint_id, wall_colour, write_building, write_skyboxes};
use wayword_world::{labels_around, path_over_viewpoints};

fn building() -> (TempDir, MatterportPlatform) {
    let folder = tempfile::tempdir().unwrap();
    write_building(folder.path()).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    (folder, platform)
}

fn scene() -> SceneId {
    SceneId::new(SCAN).unwrap()
}

fn viewpoint(index: usize) -> ViewpointId {
    ViewpointId::new(viewpoint_id(index)).unwrap()
}

fn frame(platform: &MatterportPlatform, index: usize) -> Frame {
    platform.graph_for_scene(&scene()).unwrap().path_frames(&[viewpoint(index)], None).unwrap().remove(0)
}

fn heading(deg: f64) -> Heading {
    Heading::new(deg.to_radians()).unwrap()
}

#[test]
fn the_graph_has_the_included_viewpoints_and_their_levels() {
    let (_folder, platform) = building();
    assert_eq!(platform.list_scenes().unwrap(), [scene()]);
    let graph = platform.graph_for_scene(&scene()).unwrap();
    assert_eq!((graph.len(), graph.count_components()), (14, 1));
    let levels: Vec<_> = (0..14).map(|index| graph.level_of(&viewpoint(index)).unwrap()).collect();
    assert_eq!(levels, [1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2]);
}

#[test]
fn without_a_house_file_levels_come_from_the_floors() {
    let (folder, _) = building();
    let segmentations = folder.path().join(format!("matterport/v1/scans/{SCAN}/house_segmentations"));
    std::fs::remove_file(segmentations.join(format!("{SCAN}.house"))).unwrap();
    let graph = MatterportPlatform::open(folder.path()).unwrap().graph_for_scene(&scene()).unwrap();
    let levels: Vec<_> = (0..14).map(|index| graph.level_of(&viewpoint(index)).unwrap()).collect();
    assert_eq!(levels, [1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2]);
}

#[test]
fn a_look_gives_labels_and_the_room() {
    let (_folder, platform) = building();
    // Viewpoint 3 is in the living room, which has a television on its north wall.
    let view = platform.look_from(&scene(), &frame(&platform, 3), ViewGaze::quarter_view(Heading::NORTH)).unwrap();
    assert!(view.image.is_none());
    let truth = view.ground_truth().unwrap();
    assert_eq!(truth.room.as_deref(), Some("living room"));
    let tv = truth.labels.iter().find(|label| label.name == "tv").unwrap();
    assert!(tv.heading.turn_to(Heading::NORTH).abs() < 0.02);
    assert!((tv.distance_m.unwrap() - 1.456).abs() < 0.01);
    let behind = platform.look_from(&scene(), &frame(&platform, 3), ViewGaze::quarter_view(heading(180.0))).unwrap();
    assert!(behind.ground_truth().unwrap().labels.iter().all(|label| label.name != "tv"));
}

#[test]
fn directions_from_boxes_are_those_to_the_objects() {
    let (_folder, platform) = building();
    let mut labels = 0;
    for index in 0..14 {
        let frame = frame(&platform, index);
        for label in labels_around(&platform, &scene(), &frame).unwrap() {
            let centre = Heading::towards(frame.pose.position, label.position.unwrap()).unwrap();
            let off_deg = label.heading.turn_to(centre).to_degrees();
            assert!(off_deg.abs() < 12.0, "{} is off by {off_deg} degrees", label.name);
            labels += 1;
        }
    }
    assert!(labels >= 40, "{labels}");
}

#[test]
fn every_label_is_in_exactly_one_view_of_a_panorama() {
    let (_folder, platform) = building();
    let frame = frame(&platform, 10);
    let all = labels_around(&platform, &scene(), &frame).unwrap().len();
    for step in 0..40 {
        let around = ViewGaze::around_heading(heading(f64::from(step) * 9.0));
        let counts = around.map(|gaze| {
            let view = platform.look_from(&scene(), &frame, gaze).unwrap();
            view.ground_truth().unwrap().labels.len()
        });
        assert_eq!(counts.iter().sum::<usize>(), all, "{counts:?}");
    }
}

#[test]
fn without_boxes_labels_come_from_the_house_file() {
    let (folder, with_boxes) = building();
    std::fs::remove_dir_all(folder.path().join("reverie")).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    let names = |platform: &MatterportPlatform| {
        let labels = labels_around(platform, &scene(), &frame(platform, 13)).unwrap();
        labels.into_iter().map(|label| label.name).collect::<std::collections::BTreeSet<_>>()
    };
    assert!(names(&platform).is_superset(&names(&with_boxes)));
    assert!(names(&platform).contains("office chair"));
}

#[test]
fn a_look_without_data_has_no_ground_truth() {
    let (folder, _) = building();
    std::fs::remove_dir_all(folder.path().join("reverie")).unwrap();
    std::fs::remove_dir_all(folder.path().join("matterport/v1")).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    let view = platform.look_from(&scene(), &frame(&platform, 0), ViewGaze::quarter_view(Heading::NORTH)).unwrap();
    assert_eq!(view.ground_truth(), None);
    let path = platform.sample_path(&scene(), &PathRequest::default(), 3).unwrap();
    assert_eq!(path.target, None);
}

#[test]
fn an_episode_names_its_target_and_notes_namesakes() {
    let (_folder, platform) = building();
    let bedroom: Vec<_> = [0, 1, 6, 7, 8, 9, 10].map(viewpoint).into();
    let pillow = ObjectId::new("27").unwrap();
    let path = path_over_viewpoints(&platform, "a", &scene(), &bedroom, Some(heading(0.0)), Some(&pillow)).unwrap();
    let target = path.target.unwrap();
    assert_eq!((target.name.as_str(), target.has_namesake), ("pillow", true));
    assert_eq!(path.frames[0].pose.heading, heading(0.0));
    // The desk is neither seen nor listed at this viewpoint, but at others.
    let desk = ObjectId::new("38").unwrap();
    assert_eq!(platform.catalogue().object_name(&scene(), &path.frames[0], &desk).unwrap().as_deref(), Some("desk"));
    let nothing = ObjectId::new("999").unwrap();
    assert_eq!(platform.catalogue().object_name(&scene(), &path.frames[0], &nothing).unwrap(), None);
}

/// With the boxes, and without them with the `.house` file: an object is visible from the viewpoints where its label is
/// in a view.
#[test]
fn visible_from_lists_viewpoints_with_a_box_of_the_object() {
    let (folder, platform) = building();
    let agree = |platform: &MatterportPlatform| {
        let desk = ObjectId::new("38").unwrap();
        let from = platform.catalogue().visible_from(&scene(), &desk).unwrap().unwrap();
        let graph = platform.graph_for_scene(&scene()).unwrap();
        for (number, viewpoint) in graph.viewpoints().enumerate() {
            let labels = labels_around(platform, &scene(), &frame(platform, number)).unwrap();
            assert_eq!(from.contains(viewpoint), labels.iter().any(|label| label.object == desk), "{viewpoint}");
        }
        assert!(!from.is_empty() && from.len() < graph.len());
    };
    agree(&platform);
    let nothing = ObjectId::new("999").unwrap();
    assert!(platform.catalogue().visible_from(&scene(), &nothing).unwrap().unwrap().is_empty());
    std::fs::remove_dir_all(folder.path().join("reverie")).unwrap();
    agree(&MatterportPlatform::open(folder.path()).unwrap());
    std::fs::remove_dir_all(folder.path().join("matterport/v1")).unwrap();
    assert_eq!(
        MatterportPlatform::open(folder.path()).unwrap().catalogue().visible_from(&scene(), &nothing).unwrap(),
        None
    );
}

#[test]
fn errors_name_missing_scenes_and_viewpoints() {
    let (_folder, platform) = building();
    let elsewhere = SceneId::new("elsewhere").unwrap();
    assert!(matches!(platform.graph_for_scene(&elsewhere), Err(PlatformError::UnknownScene { .. })));
    let apart = path_over_viewpoints(&platform, "a", &scene(), &[viewpoint(0), viewpoint(13)], None, None).unwrap_err();
    assert!(apart.to_string().contains("no edge"), "{apart}");
    let mut between = frame(&platform, 0);
    between.viewpoint = None;
    let gaze = ViewGaze::quarter_view(Heading::NORTH);
    assert!(matches!(platform.look_from(&scene(), &between, gaze), Err(PlatformError::NotAViewpoint { .. })));
    between.viewpoint = Some(viewpoint(14));
    assert!(matches!(platform.look_from(&scene(), &between, gaze), Err(PlatformError::UnknownViewpoint { .. })));
}

#[test]
fn random_paths_keep_to_the_request_and_the_seed() {
    let (_folder, platform) = building();
    let request = PathRequest { hops: 4..=6, length_m: 8.0..=20.0 };
    let mut ids = std::collections::BTreeSet::new();
    for seed in 0..40 {
        let path = platform.sample_path(&scene(), &request, seed).unwrap();
        assert!(request.hops.contains(&path.moves().len()) && request.allows_length_of(&path));
        assert_eq!(path, platform.sample_path(&scene(), &request, seed).unwrap());
        let target = path.target.clone().unwrap();
        let around = labels_around(&platform, &scene(), path.frames.last().unwrap()).unwrap();
        assert!(around.iter().any(|label| label.object == target.object && label.name == target.name));
        ids.insert(path.id);
    }
    assert_eq!(ids.len(), 40);
}

#[test]
fn a_skybox_is_shown_the_right_way_round() {
    let (folder, _) = building();
    write_skyboxes(folder.path()).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    for (quarter, gaze) in ViewGaze::compass_views().into_iter().enumerate() {
        let view = platform.look_from(&scene(), &frame(&platform, 0), gaze).unwrap();
        let image = view.image.unwrap();
        assert_eq!((image.width_px(), image.height_px()), (640, 480));
        let middle = 3 * (240 * 640 + 320);
        let shown = &image.rgb_bytes()[middle..middle + 3];
        let close = shown.iter().zip(wall_colour(quarter)).all(|(a, b)| a.abs_diff(b) <= 6);
        assert!(close, "quarter {quarter}: {shown:?}");
    }
    // The gaze is wider than any flat picture, so the view has only labels.
    let all_round = ViewGaze { heading: Heading::NORTH, horizontal_fov_rad: TAU };
    assert!(platform.look_from(&scene(), &frame(&platform, 0), all_round).unwrap().image.is_none());
}

#[test]
fn a_folder_of_36_views_serves_where_there_is_no_skybox() {
    let (folder, _) = building();
    let views = folder.path().join("views").join(SCAN).join(viewpoint_id(0));
    std::fs::create_dir_all(&views).unwrap();
    for index in 0..36u8 {
        // Red encodes the column, green the row.
        let colour = image::Rgb([20 * (index % 12), 100 * (index / 12), 0]);
        image::RgbImage::from_pixel(64, 48, colour).save(views.join(format!("{index}.jpg"))).unwrap();
    }
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    let gaze = ViewGaze { heading: heading(90.0), horizontal_fov_rad: FRAC_PI_2 };
    let image = platform.look_from(&scene(), &frame(&platform, 0), gaze).unwrap().image.unwrap();
    let at = |x: usize, y: usize| &image.rgb_bytes()[3 * (640 * y + x)..][..2];
    let close = |shown: &[u8], expected: [u8; 2]| shown.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 6);
    assert!(close(at(320, 240), [60, 100]), "{:?}", at(320, 240));
    assert!(close(at(320, 2), [60, 200]), "the top comes from the upper row: {:?}", at(320, 2));
    assert!(close(at(2, 240), [40, 100]) || close(at(2, 240), [20, 100]), "{:?}", at(2, 240));
    std::fs::remove_file(views.join("17.jpg")).unwrap();
    let error =
        MatterportPlatform::open(folder.path()).unwrap().look_from(&scene(), &frame(&platform, 0), gaze).unwrap_err();
    assert!(error.to_string().contains("17.jpg"), "{error}");
}

#[test]
fn fixture_episodes_can_be_walked_to_a_visible_target() {
    let (folder, platform) = building();
    let bytes = std::fs::read(folder.path().join("reverie/REVERIE_val_seen.json")).unwrap();
    let items: Vec<serde_json::Value> = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(items.len(), 10);
    for item in &items {
        let viewpoints: Vec<ViewpointId> = serde_json::from_value(item["path"].clone()).unwrap();
        let object = ObjectId::new(item["objId"].to_string()).unwrap();
        let path = path_over_viewpoints(&platform, "a", &scene(), &viewpoints, None, Some(&object)).unwrap();
        assert!((4..=7).contains(&path.moves().len()));
        let around = labels_around(&platform, &scene(), path.frames.last().unwrap()).unwrap();
        let target = path.target.unwrap();
        assert!(around.iter().any(|label| label.object == object && label.name == target.name), "{}", target.name);
        for text in item["instructions"].as_array().unwrap() {
            let last_word = target.name.split(' ').next_back().unwrap();
            assert!(text.as_str().unwrap().contains(last_word), "{text} is about the {}", target.name);
        }
    }
}
