use super::super::model::House;
use super::*;
use crate::{generate_house, graph::EYE_M};
use wayword_core::{DVec3, FailureKind, Heading, Pose};

fn small() -> HousePlatform {
    HousePlatform::new(HouseOptions { width_px: 160, height_px: 120, ..HouseOptions::default() })
}

#[test]
fn scenes_have_only_the_name_of_their_seed() {
    let platform = small();
    let scenes = platform.list_scenes().unwrap();
    assert_eq!(scenes.len(), 20);
    assert!(scenes.is_sorted() && scenes.iter().any(|scene| scene.as_str() == "house2-7"));
    for bad in ["house2-", "house2-07", "house2-x", "house2--1", "attic-7", "house2-99999999999999999999"] {
        let error = platform.graph_for_scene(&SceneId::new(bad).unwrap()).unwrap_err().to_string();
        assert!(error.contains("house2-7") && error.contains("--platform matterport"), "{error}");
    }
    let error = platform.graph_for_scene(&SceneId::new("house-3").unwrap()).unwrap_err().to_string();
    assert!(error.contains("an earlier version") && error.contains("house2-3"), "{error}");
}

#[test]
fn paths_keep_to_their_length_end_at_their_target_and_repeat() {
    let platform = small();
    for scene in ["house2-1", "house2-2"] {
        let scene = SceneId::new(scene).unwrap();
        let request = PathRequest { hops: 1..=9, length_m: 4.0..=16.0 };
        for seed in 0..2 {
            let path = platform.sample_path(&scene, &request, seed).unwrap();
            assert!(request.allows_length_of(&path));
            assert!(path.moves().iter().all(|step| step.distance_m < 1.1), "frames lie too far apart");
            let target = path.target.clone().unwrap();
            let last = path.frames.last().unwrap();
            let home = platform.ready_house(&scene).unwrap();
            assert!(home.labels_around(last.pose).unwrap().iter().any(|label| label.object == target.object));
            assert_eq!(platform.catalogue().object_name(&scene, last, &target.object).unwrap(), Some(target.name));
            assert_eq!(platform.sample_path(&scene, &request, seed).unwrap(), path);
        }
    }
}

#[test]
fn paths_end_on_the_floor_of_a_storey() {
    let platform = small();
    let storey_m = f64::from(crate::model::STOREY_CM) / 100.0;
    for scene in ["house2-4", "house2-10"] {
        let scene = SceneId::new(scene).unwrap();
        let request = PathRequest { hops: 1..=9, length_m: 4.0..=16.0 };
        for seed in 0..40 {
            let path = platform.sample_path(&scene, &request, seed).unwrap();
            let height_m = path.frames.last().unwrap().pose.position.z - crate::graph::EYE_M;
            let storeys = height_m / storey_m;
            assert!((storeys - storeys.round()).abs() < 0.05, "seed {seed} of {scene} ends at {height_m} m");
        }
    }
}

#[test]
fn a_view_has_picture_labels_and_room() {
    let platform = small();
    let scene = HousePlatform::scene_of(1).unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let mut rooms = std::collections::BTreeSet::new();
    let mut labels = 0;
    for id in graph.viewpoints().step_by(5) {
        let frame = graph.path_frames(std::slice::from_ref(id), None).unwrap().remove(0);
        let view = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap();
        let truth = view.ground_truth().unwrap();
        assert_eq!(view.image.as_ref().unwrap().rgb_bytes().len(), 160 * 120 * 3);
        rooms.insert(truth.room.clone().unwrap());
        labels += truth.labels.len();
        for label in &truth.labels {
            let [x, y, w, h] = label.box_px.unwrap();
            assert!(x >= 0.0 && y >= 0.0 && x + w <= 160.0 && y + h <= 120.0);
        }
    }
    assert!(rooms.len() >= 3 && labels > 5, "{rooms:?} {labels}");
}

#[test]
fn a_picture_that_cannot_be_drawn_is_not_called_a_missing_scene() {
    let platform = HousePlatform::new(HouseOptions { width_px: 0, ..HouseOptions::default() });
    let scene = HousePlatform::scene_of(1).unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let first = graph.viewpoints().next().unwrap().clone();
    let frame = graph.path_frames(&[first], None).unwrap().remove(0);
    let error = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap_err();
    assert!(error.to_string().starts_with("scene house2-1 cannot be drawn: "), "{error}");
    assert_eq!(error.failure_kind(), FailureKind::Broken);
}

#[test]
fn an_eye_in_a_doorway_is_in_the_room_ahead() {
    let platform = small();
    let scene = HousePlatform::scene_of(1).unwrap();
    let home = platform.ready_house(&scene).unwrap();
    let house = &home.scene.house;
    let opening = house.openings.iter().find(|opening| opening.is_passable() && !opening.span.along_x).unwrap();
    let (x, y) = opening.span.middle();
    let eye = DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0, EYE_M);
    let seen =
        [0.25, 0.75].map(|turns| home.room_seen(eye, Heading::new(turns * std::f64::consts::TAU).unwrap()).unwrap());
    let mut expected = [opening.room, opening.beyond.unwrap()]
        .map(|room| (house.rooms[room].outline.x0, house.rooms[room].kind.word()));
    expected.sort();
    assert_eq!(seen, [expected[1].1, expected[0].1]);
}

#[test]
fn places_outside_the_house_are_refused() {
    let platform = small();
    let scene = HousePlatform::scene_of(1).unwrap();
    for place in [DVec3::new(-50.0, 0.0, 1.5), DVec3::new(1.0, 1.0, 900.0), DVec3::NAN] {
        let frame = Frame { pose: Pose::looking_level(place, Heading::NORTH), viewpoint: None, level: None };
        let error = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH)).unwrap_err().to_string();
        assert!(error.contains("house2-1"), "{error}");
    }
}

/// FNV-1a, which is enough to see a difference.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// A change in how houses are generated changes these numbers. Note it in the changelog, because recorded paths name
/// places in these houses.
#[test]
fn a_house_and_its_picture_are_the_same_on_every_machine() {
    let house = generate_house(7);
    let json = serde_json::to_vec(&house).unwrap();
    assert_eq!(serde_json::from_slice::<House>(&json).unwrap(), house);
    let scene = HousePlatform::scene_of(7).unwrap();
    let platform = small();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let first = graph.viewpoints().next().unwrap().clone();
    let frame = graph.path_frames(&[first], None).unwrap().remove(0);
    let view = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::new(1.0).unwrap())).unwrap();
    let picture = hash(view.image.unwrap().rgb_bytes());
    assert_eq!((hash(&json), picture), (3_773_218_121_785_688_983, 14_575_826_249_945_224_923));
}
