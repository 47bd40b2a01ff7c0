use super::*;
use crate::worlds::{AlteredPlatform, testing::*};
use wayword_core::{Platform, ViewGaze};

type Twice<A> = AlteredPlatform<AlteredPlatform<House, A>, A>;

fn twice<A: WorldAlteration + Copy>(alter: A) -> Twice<A> {
    AlteredPlatform::new(AlteredPlatform::new(House, alter), alter)
}

/// Asserts that a world shows the same views along a path as the unchanged one.
fn assert_same(world: &impl Platform) {
    let (scene, path) = walk();
    for frame in path.frames.iter().step_by(2) {
        for gaze in ViewGaze::around_heading(frame.pose.heading) {
            let [view, plain] =
                [world.look_from(&scene, frame, gaze), House.look_from(&scene, frame, gaze)].map(Result::unwrap);
            // Turning a heading rounds, which can shift an edge by a pixel.
            assert!(mean_difference(&view, &plain) < 0.1);
            assert!(view.pose.position.distance(plain.pose.position) < 1e-9);
            assert_eq!(labels(&view).len(), labels(&plain).len());
            for (a, b) in labels(&view).iter().zip(labels(&plain)) {
                assert_eq!((&a.object, &a.name, a.distance_m), (&b.object, &b.name, b.distance_m));
                assert!(a.heading.turn_to(b.heading).abs() < 1e-9);
                assert!(a.position.unwrap().distance(b.position.unwrap()) < 1e-9);
                assert!(a.box_px.unwrap().iter().zip(b.box_px.unwrap()).all(|(a, b)| (a - b).abs() <= 1.0));
            }
        }
    }
}

#[test]
fn mirrored_twice_or_turned_four_times_it_is_the_same_world() {
    assert_same(&twice(WorldMirror));
    assert_same(&AlteredPlatform::new(AlteredPlatform::new(twice(QuarterTurn), QuarterTurn), QuarterTurn));
}

#[test]
fn in_a_mirrored_view_everything_lies_on_the_other_side() {
    let (scene, path) = walk();
    let mirrored = WorldMirror.path_after(path.clone());
    let world = AlteredPlatform::new(House, WorldMirror);
    let mut seen = 0;
    for (before, after) in path.frames.iter().zip(&mirrored.frames) {
        let plain = House.look_from(&scene, before, ViewGaze::quarter_view(before.pose.heading)).unwrap();
        let view = world.look_from(&scene, after, ViewGaze::quarter_view(after.pose.heading)).unwrap();
        assert_eq!(labels(&view).len(), labels(&plain).len());
        for (a, b) in labels(&plain).iter().zip(labels(&view)) {
            seen += 1;
            let [off, other] = [before.pose.heading.turn_to(a.heading), after.pose.heading.turn_to(b.heading)];
            assert!((off + other).abs() < 1e-9 && a.object == b.object);
            let towards = Heading::towards(after.pose.position, b.position.unwrap()).unwrap();
            assert!(towards.turn_to(b.heading).abs() < 1e-9);
        }
        let [first, last] =
            [(&plain, 0), (&view, 159)].map(|(view, x)| view.image.as_ref().unwrap().rgb_bytes()[x * 3]);
        assert!(first.abs_diff(last) <= 1);
    }
    assert!(seen > 10);
}

#[test]
fn a_turned_world_shows_the_same_pictures_to_an_eye_that_turns_too() {
    let (scene, path) = walk();
    let turned = QuarterTurn.path_after(path.clone());
    let world = AlteredPlatform::new(House, QuarterTurn);
    for (before, after) in path.frames.iter().zip(&turned.frames) {
        let plain = House.look_from(&scene, before, ViewGaze::quarter_view(before.pose.heading)).unwrap();
        let view = world.look_from(&scene, after, ViewGaze::quarter_view(after.pose.heading)).unwrap();
        assert!(mean_difference(&view, &plain) < 0.1);
        assert!((before.pose.heading.turn_to(after.pose.heading).to_degrees() - 90.0).abs() < 1e-9);
    }
    assert_eq!(turned.moves().len(), path.moves().len());
    for (a, b) in turned.moves().iter().zip(path.moves()) {
        assert!((a.turn_rad - b.turn_rad).abs() < 1e-9 && (a.distance_m - b.distance_m).abs() < 1e-9);
    }
}

#[test]
fn an_altered_world_reports_nothing_that_only_the_original_has() {
    let (scene, path) = walk();
    let gaze = ViewGaze::quarter_view(path.frames[0].pose.heading);
    assert!(House.ground().look_down(&scene, 1).unwrap().is_some());
    assert!(House.ground().view_depth(&scene, &path.frames[0], gaze).unwrap().is_some());
    let world = AlteredPlatform::new(House, WorldMirror);
    assert!(world.inner().is_none());
    assert!(world.ground().look_down(&scene, 1).unwrap().is_none());
    let path = WorldMirror.path_after(path);
    assert!(world.ground().view_depth(&scene, &path.frames[0], gaze).unwrap().is_none());
    assert!(world.files().examine_scene(&scene).unwrap().is_none());
    assert_eq!(world.files().scene_file(&scene).unwrap(), None);
}

#[test]
fn the_ground_of_a_mirrored_world_is_mirrored() {
    let (scene, path) = walk();
    let (first, last) = (&path.frames[0], &path.frames[path.frames.len() - 1]);
    let before = House.ground().ground_route(&scene, first, last).unwrap().unwrap();
    let mirrored = WorldMirror.path_after(path.clone());
    let (first, last) = (&mirrored.frames[0], &mirrored.frames[mirrored.frames.len() - 1]);
    let world = AlteredPlatform::new(House, WorldMirror);
    let after = world.ground().ground_route(&scene, first, last).unwrap().unwrap();
    assert_eq!(after.length_m, before.length_m);
    let mirrored: Vec<DVec3> = before.corners.into_iter().map(|corner| WorldMirror.place_after(corner)).collect();
    assert_eq!(after.corners, mirrored);
}
