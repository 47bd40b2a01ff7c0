use super::*;
use proptest::prelude::*;
use std::collections::BTreeSet;
use wayword_core::{DVec3, ObjectDistinction, ObjectId, PathMotion, PathTarget, SceneId, Side, ViewpointId};

/// A path with a viewpoint at each corner, that begins with a look north.
fn path(corners: &[[f64; 3]]) -> Path {
    let stop = |(number, at): (usize, &[f64; 3])| PathStop {
        position: DVec3::from_array(*at),
        viewpoint: ViewpointId::new(format!("v{number}")).ok(),
        level: Some(1 + number as u32 / 2),
    };
    let target = PathTarget {
        object: ObjectId::new("7").unwrap(),
        name: "lamp".to_owned(),
        told_by: vec![
            ObjectDistinction::OnSide { side: Side::Left },
            ObjectDistinction::Colour { colour: "red".to_owned() },
        ],
        has_namesake: true,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 1,
    };
    Path {
        id: "p".to_owned(),
        scene: SceneId::new("s").unwrap(),
        frames: Path::frames_along(corners.iter().enumerate().map(stop).collect(), Some(Heading::NORTH)),
        motion: PathMotion::Known,
        target: Some(target),
    }
}

fn bent() -> Path {
    path(&[[0.0, 0.0, 1.5], [4.0, 0.0, 1.5], [4.0, 3.0, 1.5], [4.0, 3.0, 2.5]])
}

#[test]
fn reversed_twice_it_is_the_same_path() {
    let once = reverse_path(&bent());
    assert_eq!(once.base_frame_of, [3, 2, 1, 0]);
    assert_eq!(once.path.target, None);
    assert!((once.path.frames[0].pose.heading.deg() - 180.0).abs() < 1e-9);
    let twice = reverse_path(&once.path).path;
    assert_eq!(twice, Path { target: None, ..face_first_hop(&bent()).path });
}

#[test]
fn frames_are_at_equal_distances_and_keep_what_falls_on_them() {
    let halves = space_frames(&bent(), 0.5);
    assert_eq!(halves.path.frames.len(), 17);
    let named: Vec<usize> = (0..17).filter(|frame| halves.path.frames[*frame].viewpoint.is_some()).collect();
    assert_eq!(named, [0, 8, 14, 16]);
    assert_eq!(halves.path.length_m(), bent().length_m());
    assert_eq!(halves.path.target, bent().target);
    assert_eq!(halves.path.frames[1].pose.position, DVec3::new(0.5, 0.0, 1.5));
    assert_eq!(halves.base_frame_of[..6], [0, 0, 0, 0, 0, 1]);
    assert_eq!(halves.path.frames[15].level, Some(2));
}

#[test]
fn an_arrival_from_another_direction_drops_the_side_of_the_target() {
    let cut = space_frames(&bent(), 100.0).path;
    assert_eq!(cut.frames.len(), 2);
    assert_eq!(cut.target.unwrap().told_by, [ObjectDistinction::Colour { colour: "red".to_owned() }]);
}

#[test]
fn thinning_keeps_frames_that_there_are() {
    assert_eq!(thin_frames(&bent(), 3.5).base_frame_of, [0, 1, 3]);
    assert_eq!(thin_frames(&bent(), 0.1), unchanged_path(&bent()));
}

#[test]
fn turn_start_heading_turns_the_first_frame_and_along_removes_the_turn() {
    assert!((turn_start_heading(&bent(), -90.0).path.frames[0].pose.heading.deg() - 270.0).abs() < 1e-9);
    assert!((face_first_hop(&bent()).path.frames[0].pose.heading.deg() - 90.0).abs() < 1e-9);
}

#[test]
fn unknown_motion_lets_only_order_and_number_of_frames_change() {
    let unknown = Path { motion: PathMotion::Unknown, ..bent() };
    for changed in [space_frames(&unknown, 0.5), turn_start_heading(&unknown, 9.0), face_first_hop(&unknown)] {
        assert_eq!(changed, unchanged_path(&unknown));
    }
    assert_eq!(reverse_path(&unknown).path.frames[0], unknown.frames[3]);
    assert_eq!(drop_frames(&unknown, 100.0, 1).path.frames, [unknown.frames[0].clone(), unknown.frames[3].clone()]);
}

proptest! {
    #[test]
    fn dropped_frames_stay_dropped_at_a_higher_dose(seed: u64, low in 0.0..100.0f64, high in 0.0..100.0f64) {
        let (low, high) = (low.min(high), low.max(high));
        let long: Vec<[f64; 3]> = (0..30).map(|step| [f64::from(step), 0.0, 1.5]).collect();
        let [few, many] = [low, high].map(|percent| drop_frames(&path(&long), percent, seed).base_frame_of);
        let few: BTreeSet<usize> = few.into_iter().collect();
        prop_assert!(many.iter().all(|frame| few.contains(frame)));
        prop_assert!(many.contains(&0) && many.contains(&29));
        prop_assert_eq!(drop_frames(&path(&long), 0.0, seed), unchanged_path(&path(&long)));
    }

    #[test]
    fn resampling_never_makes_a_path_longer_and_hardly_shorter(
        corners in proptest::collection::vec([-9.0..9.0f64, -9.0..9.0, 0.0..3.0], 2..8), spacing_m in 0.1..4.0f64,
    ) {
        let before = path(&corners);
        let after = space_frames(&before, spacing_m);
        let [old_m, new_m] = [&before, &after.path].map(|path| path.length_m().unwrap());
        // Each corner is cut by less than one step.
        prop_assert!(new_m <= old_m + 1e-9 && new_m >= old_m - spacing_m * corners.len() as f64);
        prop_assert!(after.path.moves().iter().all(|step| step.distance_m <= spacing_m + 1e-9));
        prop_assert_eq!(after.path.frames.len(), after.base_frame_of.len());
        prop_assert!(after.base_frame_of.is_sorted());
        let ends = |path: &Path| [path.frames[0].clone().place_key(), path.frames[path.frames.len() - 1].clone().place_key()];
        prop_assert_eq!(ends(&after.path), ends(&before));
    }
}
