//! Tests of the names that make a pose.

use super::*;
use std::collections::BTreeMap;

fn info(features: &[(&str, &[&str])]) -> DatasetInfo {
    let features: BTreeMap<_, _> = features
        .iter()
        .map(|(key, names)| (*key, serde_json::json!({"dtype": "float32", "shape": [names.len()], "names": names})))
        .collect();
    let info = serde_json::json!({"codebase_version": "v3.0", "fps": 5, "data_path": "x", "features": features});
    serde_json::from_value(info).unwrap()
}

fn find(features: &[(&str, &[&str])], poses: Option<&str>) -> Result<Option<PoseFeature>, String> {
    let described = RecordingDescription { poses: poses.map(str::to_owned), ..RecordingDescription::default() };
    PoseFeature::find_feature(Path::new("d"), &info(features), &described).map_err(|error| error.to_string())
}

#[test]
fn find_takes_unnamed_features_only_if_they_are_certain() {
    let found = |key, names| find(&[(key, names)], None).unwrap().map(|place| place.feature);
    assert_eq!(found("observation.state", &["x", "y", "theta"]).as_deref(), Some("observation.state"));
    assert_eq!(found("odometry", &["base.x", "base.y", "base.z", "base.yaw"]).as_deref(), Some("odometry"));
    // A command, speeds, an arm's hand, positions without a direction, other joints: in doubt there is no pose.
    assert_eq!(found("action", &["x", "y", "theta"]), None);
    assert_eq!(found("observation.state", &["x.vel", "y.vel", "theta.vel"]), None);
    assert_eq!(found("observation.state.end_effector", &["x", "y", "yaw"]), None);
    assert_eq!(found("observation.ee_pose", &["x", "y", "z", "yaw"]), None);
    assert_eq!(found("observation.state", &["x", "y", "z", "roll", "pitch", "yaw"]), None);
    assert_eq!(found("observation.state", &["x", "y"]), None);
    assert_eq!(found("observation.state", &["x", "y", "theta", "gripper"]), None);
    assert_eq!(find(&[("a", &["x", "y", "yaw"]), ("b", &["x", "y", "yaw"])], None), Ok(None));
}

#[test]
fn speeds_beside_a_pose_do_not_hide_it() {
    for names in [
        &["x", "y", "theta", "x.vel", "y.vel", "theta.vel"][..],
        &["base_x", "base_y", "base_z", "base_yaw", "vx", "omega"],
    ] {
        assert!(find(&[("observation.state", names)], None).unwrap().is_some(), "{names:?}");
    }
    assert_eq!(find(&[("observation.state", &["x", "y", "theta", "vx", "gripper"])], None), Ok(None));
}

#[test]
fn an_orientation_that_is_none_is_known() {
    let feature = |names: &[&str]| find(&[("observation.state", names)], Some("observation.state")).unwrap().unwrap();
    let quaternion = feature(&["x", "y", "z", "qx", "qy", "qz", "qw"]);
    assert!(!quaternion.lacks_facing(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    assert!(quaternion.lacks_facing(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    assert!(quaternion.lacks_facing(&[0.0, 1.0, 0.0, 0.0, 0.0, f64::NAN, 1.0]));
    let yaw = feature(&["x", "y", "theta"]);
    assert!(yaw.lacks_facing(&[0.0, 1.0, f64::NAN]) && !yaw.lacks_facing(&[0.0, 1.0, 2.0]));
    assert!(!feature(&["x", "y"]).lacks_facing(&[0.0, 1.0]));
}

#[test]
fn describe_unclear_names_two_elements_that_may_be_one() {
    let told = |key, names| PoseFeature::describe_unclear(&info(&[(key, names)]));
    for names in [&["x", "x", "theta"][..], &["left.x", "left.y", "right.x", "right.y"], &["x", "y", "pos_y", "yaw"]] {
        let words = told("observation.state", names).unwrap();
        assert!(words.contains("may be the one: rename the wrong one"), "{words}");
    }
    assert_eq!(told("observation.state", &["x", "y", "theta"]), None);
    assert_eq!(told("action", &["x", "x", "theta"]), None);
}

#[test]
fn a_feature_that_could_be_the_poses_is_named() {
    let told = |key, names| PoseFeature::describe_candidates(&info(&[(key, names)]));
    let state = told("observation.state", &["x", "y", "z", "qx", "qy", "qz", "qw"]).unwrap();
    assert!(
        state.contains("has x, y, z and a quaternion") && state.contains("poses = \"observation.state\""),
        "{state}"
    );
    assert!(told("observation.state", &["x", "y", "theta", "gripper"]).unwrap().contains("x, y and a yaw"));
    assert!(told("odometry", &["x", "y", "z", "quat.x", "quat.y", "quat.z", "quat.w", "vx"]).is_some());
    // A command, an arm's hand, joints.
    assert_eq!(told("action", &["x", "y", "theta"]), None);
    assert_eq!(told("observation.ee_pose", &["x", "y", "z", "qx", "qy", "qz", "qw"]), None);
    assert_eq!(told("observation.state", &["shoulder", "elbow"]), None);
}

#[test]
fn a_yaw_without_a_unit_is_read_by_the_path() {
    let feature = |names| find(&[("state", names)], None).unwrap().unwrap();
    let rows: Vec<f64> = (0..30).flat_map(|at| [f64::from(at) * 0.2, 0.01, 355.0 + f64::from(at % 11)]).collect();
    let (read, remark) = feature(&["x", "y", "theta"]).with_yaw_unit(&rows).unwrap();
    assert!(remark.unwrap().contains("read in degrees"));
    let heading = |read: &PoseFeature| {
        let fix = read.fix_from_numbers(0.0, &[0.0, 0.0, 360.0], &RecordingDescription::default());
        fix.unwrap().heading.unwrap().deg().round()
    };
    assert_eq!(heading(&read), 90.0);
    // A unit in the name is believed.
    let (named, remark) = feature(&["x", "y", "theta_rad"]).with_yaw_unit(&rows).unwrap();
    assert_eq!((heading(&named), remark), ((90.0 - 360_f64.to_degrees()).rem_euclid(360.0).round(), None));
    let standing: Vec<f64> = (0..30).flat_map(|at| [0.0, 0.0, f64::from(at) * 10.0]).collect();
    assert!(feature(&["x", "y", "theta"]).with_yaw_unit(&standing).unwrap_err().contains("goes up to 290.0"));
}

#[test]
fn find_takes_or_refuses_the_named_feature() {
    let state = |names| find(&[("state", names)], Some("state"));
    let place = state(&["gripper", "x", "y", "z", "qx", "qy", "qz", "qw"]).unwrap().unwrap();
    assert_eq!(place.elements(), [1, 2, 3, 4, 5, 6, 7]);
    let turned = state(&["quat.x", "quat.y", "quat.z", "quat.w", "pos.x", "pos.y"]).unwrap().unwrap();
    assert_eq!(turned.elements(), [4, 5, 0, 1, 2, 3]);
    assert_eq!(state(&["x", "y"]).unwrap().unwrap().facing, FeatureFacing::Unknown);
    assert!(state(&["left_x", "right_x", "y"]).unwrap_err().contains("left_x"));
    assert!(state(&["x", "y", "yaw", "qx"]).unwrap_err().contains("twice, or only in part"));
    assert!(state(&["a", "b"]).unwrap_err().contains("no elements x and y; its elements: a, b"));
    assert!(find(&[("state", &["x"])], Some("pose")).unwrap_err().contains("such lists: state"));
}

#[test]
fn yaw_is_counter_clockwise_from_x_which_is_east() {
    let deg = |names: &[&str], yaw: f64| {
        let place = find(&[("state", names)], Some("state")).unwrap().unwrap();
        let fix = place.fix_from_numbers(0.0, &[3.0, 4.0, yaw], &RecordingDescription::default()).unwrap();
        assert_eq!(fix.position, DVec3::new(3.0, 4.0, 0.0));
        fix.heading.unwrap().deg().round()
    };
    assert_eq!(deg(&["x", "y", "theta"], 0.0), 90.0);
    assert_eq!(deg(&["x", "y", "yaw"], std::f64::consts::FRAC_PI_2) % 360.0, 0.0);
    assert_eq!(deg(&["x", "y", "yaw_deg"], -90.0), 180.0);
}

#[test]
fn a_yaw_needs_a_world_with_z_up() {
    let described = RecordingDescription {
        poses: Some("state".to_owned()),
        world: Some(WorldUpAxis::YUp),
        ..RecordingDescription::default()
    };
    let info = info(&[("state", &["x", "y", "yaw"])]);
    assert!(PoseFeature::find_feature(Path::new("d"), &info, &described).unwrap_err().to_string().contains("z-up"));
}
