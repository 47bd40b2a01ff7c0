use super::*;
use crate::worlds::{AlteredPlatform, QuarterTurn, WorldAlteration, WorldMirror, testing::*};
use wayword_core::Side;

const GUESSER: EyeQuality = EyeQuality { guesses_sides: true, ..EyeQuality::PERFECT };

/// The labels along a path, all around each frame: by frame and object, the name and the side.
fn told(platform: &impl Platform, path: &Path) -> BTreeMap<(usize, ObjectId), (String, Side)> {
    let mut told = BTreeMap::new();
    for (number, frame) in path.frames.iter().enumerate() {
        for gaze in ViewGaze::around_heading(frame.pose.heading) {
            let view = platform.look_from(&path.scene, frame, gaze).unwrap();
            for label in labels(&view) {
                let side = frame.pose.heading.side_of(label.heading);
                told.insert((number, label.object.clone()), (label.name.clone(), side));
            }
        }
    }
    told
}

fn eye(eye: EyeQuality) -> ScriptedEye<House, House> {
    ScriptedEye::new(House, House, eye, 5)
}

/// Share of the things on the left or right that are on the mirrored side, or on the same one, in a changed world.
fn share_on_expected_side(of: EyeQuality, alter: impl WorldAlteration + Copy, expected: impl Fn(Side) -> Side) -> f64 {
    let (mut fits, mut all) = (0, 0);
    for seed in [3, 7] {
        let (_, path) = walk_of(seed);
        let before = told(&eye(of), &path);
        let changed = ScriptedEye::new(AlteredPlatform::new(House, alter), AlteredPlatform::new(House, alter), of, 5);
        let after = told(&changed, &alter.path_after(path));
        for (key, (_, side)) in before.iter().filter(|(_, (_, side))| matches!(side, Side::Left | Side::Right)) {
            all += 1;
            fits += usize::from(after.get(key).is_some_and(|(_, now)| *now == expected(*side)));
        }
    }
    assert!(all > 20, "{all}");
    f64::from(fits as u32) / f64::from(all as u32)
}

fn mirrored(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        other => other,
    }
}

#[test]
fn a_mirror_exposes_an_eye_that_guesses_sides() {
    assert!(share_on_expected_side(EyeQuality::PERFECT, WorldMirror, mirrored) > 0.98);
    assert!(share_on_expected_side(GUESSER, WorldMirror, mirrored) < 0.6);
}

#[test]
fn a_turn_does_not_change_the_sides_of_any_eye() {
    assert!(share_on_expected_side(EyeQuality::PERFECT, QuarterTurn, |side| side) > 0.98);
    assert!(share_on_expected_side(GUESSER, QuarterTurn, |side| side) > 0.98);
}

#[test]
fn a_guesser_lists_the_same_things_with_headings_and_places_that_agree() {
    let (scene, path) = walk();
    let things = |told: BTreeMap<(usize, ObjectId), (String, Side)>| told.into_keys().collect::<Vec<_>>();
    assert_eq!(things(told(&eye(GUESSER), &path)), things(told(&House, &path)));
    let mut moved = 0;
    for frame in &path.frames {
        for gaze in ViewGaze::around_heading(frame.pose.heading) {
            let view = eye(GUESSER).look_from(&scene, frame, gaze).unwrap();
            let truth = House.look_from(&scene, frame, gaze).unwrap();
            moved += labels(&view).iter().filter(|label| !labels(&truth).contains(label)).count();
            for label in labels(&view) {
                assert!(gaze.heading.turn_to(label.heading).abs() <= gaze.horizontal_fov_rad / 2.0 + 1e-9);
                let offset = label.position.unwrap() - frame.pose.position;
                assert!((offset.length() - label.distance_m.unwrap()).abs() < 1e-6);
                let level_m = offset.truncate().length();
                assert!((offset.with_z(0.0) - label.heading.unit_vector() * level_m).length() < 1e-6);
            }
        }
    }
    assert!(moved > 0);
}

#[test]
fn an_eye_with_lower_recall_reports_a_subset() {
    let of = EyeQuality { recall: 0.95, falls: 1.0, ..EyeQuality::PERFECT };
    let (_, path) = walk();
    let all = told(&House, &path);
    let seen: Vec<_> = (0..=4).map(|step| told(&eye(of).at_strength(f64::from(step) / 4.0), &path)).collect();
    for pair in seen.windows(2) {
        assert!(pair[1].iter().all(|(key, what)| pair[0].get(key) == Some(what)));
        assert!(pair[1].len() < pair[0].len());
    }
    assert!(seen[4].is_empty());
    let share = seen[2].len() as f64 / all.len() as f64;
    assert!((0.25..0.7).contains(&share), "{share}");
    assert_eq!(told(&eye(EyeQuality::PERFECT), &path), all);
}

#[test]
fn mistakes_are_other_names_for_as_many_things() {
    let (_, path) = walk();
    let all = told(&House, &path);
    let half = told(&eye(EyeQuality { rises: 1.0, ..EyeQuality::PERFECT }).at_strength(0.5), &path);
    let wrong = all.iter().filter(|(key, what)| half[*key].0 != what.0).count();
    let share = wrong as f64 / all.len() as f64;
    assert!(half.len() == all.len() && (0.3..0.7).contains(&share), "{share}");
    let every = told(&eye(EyeQuality { mistakes: 1.0, ..EyeQuality::PERFECT }), &path);
    assert!(all.iter().all(|(key, what)| every[key].0 != what.0));
}

#[test]
fn the_seed_alone_decides_the_draws() {
    let of = EyeQuality { recall: 0.5, ..EyeQuality::PERFECT };
    let (_, path) = walk();
    let by = |seed| told(&ScriptedEye::new(House, House, of, seed), &path);
    assert_eq!(by(1), by(1));
    assert_ne!(by(1), by(2));
}

#[test]
fn the_eye_stays_blind_where_no_camera_looked() {
    let (scene, path) = walk();
    let gaze = ViewGaze::quarter_view(path.frames[0].pose.heading);
    let blank = View::new(path.frames[0].pose, gaze.horizontal_fov_rad, None, None);
    let look = |scene: &SceneId, gaze| House.look_from(scene, &path.frames[0], gaze);
    assert!(eye(EyeQuality::PERFECT).eye_view(&scene, &path.frames[0], blank, look).unwrap().is_blank());
    let without = eye(EyeQuality::PERFECT).look_without_picture(&scene, &path.frames[0], gaze).unwrap();
    assert!(without.image.is_none());
    assert_eq!(labels(&without), labels(&House.look_from(&scene, &path.frames[0], gaze).unwrap()));
}

#[test]
fn a_scene_may_have_another_name_at_the_oracle() {
    let (scene, path) = walk();
    let (other, _) = walk_of(11);
    let eye = eye(EyeQuality::PERFECT).with_scene(scene.clone(), other.clone());
    let gaze = ViewGaze::quarter_view(path.frames[0].pose.heading);
    let seen = eye.eye_view(
        &scene,
        &path.frames[0],
        House.look_from(&scene, &path.frames[0], gaze).unwrap(),
        |asked, gaze| {
            assert_eq!(*asked, other);
            House.look_from(&scene, &path.frames[0], gaze)
        },
    );
    assert!(seen.is_ok());
}
