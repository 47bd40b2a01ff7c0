//! Tests of all formats of pose files.

use super::*;
use crate::pose_reading::AngleUnit;
use proptest::prelude::*;
use wayword_core::DVec3;

/// Reads a pose file for pictures `0.png`, `1.png`, ... that were taken a second apart from `from_s` on.
fn read(name: &str, text: &str, from_s: f64, described: &RecordingDescription) -> Result<CameraTrack, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    let times_s: Vec<f64> = (0..4).map(|at| from_s + f64::from(at)).collect();
    read_track(&file, described, &times_s, &|at| format!("{at}.png")).map_err(|error| error.to_string())
}

fn at(track: &CameraTrack, time_s: f64) -> (DVec3, f64) {
    let fix = track.fix_at(time_s).unwrap();
    (fix.position, fix.heading.unwrap().deg().round() % 360.0)
}

#[test]
fn every_pose_format_gives_the_same_walk() {
    let usual = RecordingDescription::default();
    // Two metres east, looking east.
    let files = [
        (
            "poses.tum",
            "# time x y z qx qy qz qw\n10 0 0 1.5 -0.5 0.5 -0.5 0.5\n11 1 0 1.5 -0.5 0.5 -0.5 0.5\n12 2 0 1.5 -0.5 0.5 -0.5 0.5\n",
        ),
        ("poses.csv", "time_s,x,y,z,yaw_rad\n10,0,0,1.5,0\n11,1,0,1.5,0\n12,2,0,1.5,0\n"),
        (
            "poses.csv",
            "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n\
                       10000000000,0,0,1.5,0.5,-0.5,0.5,-0.5\n11000000000,1,0,1.5,0.5,-0.5,0.5,-0.5\n12000000000,2,0,1.5,0.5,-0.5,0.5,-0.5\n",
        ),
        ("poses.csv", "image;x;y;z;heading_deg\n0.png;0;0;1.5;90\n1.png;1;0;1.5;90\n2;2;0;1.5;90\n"),
        (
            "poses.json",
            r#"[{"image": "rgb/0.png", "position": [0, 0, 1.5], "heading_deg": 90},
                           {"time_s": 12, "position": [2, 0, 1.5], "orientation": [0, 0, 0, 1]}]"#,
        ),
        (
            "transforms.json",
            r#"{"camera_angle_x": 1.0, "frames": [
            {"file_path": "./images/0", "transform_matrix": [[0, 0, -1, 0], [-1, 0, 0, 0], [0, 1, 0, 1.5], [0, 0, 0, 1]]},
            {"file_path": "images/2.png", "transform_matrix": [[0, 0, -1, 2], [-1, 0, 0, 0], [0, 1, 0, 1.5], [0, 0, 0, 1]]}]}"#,
        ),
    ];
    for (name, text) in files {
        let track = read(name, text, 10.0, &usual).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(at(&track, 11.0), (DVec3::new(1.0, 0.0, 1.5), 90.0), "{name}: {text}");
    }
}

#[test]
fn kitti_counts_pictures_and_has_y_down() {
    let text = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 -1 0 0 1 3\n";
    let track = read("poses.txt", text, 0.0, &RecordingDescription::default()).unwrap();
    assert_eq!(at(&track, 1.0), (DVec3::new(0.0, 3.0, 1.0), 0.0));
}

#[test]
fn a_tracker_that_was_lost_leaves_no_pose() {
    let text = "10 0 0 1.5 -0.5 0.5 -0.5 0.5\n11 nan nan nan nan nan nan nan\n12 2 0 1.5 -0.5 0.5 -0.5 0.5\n";
    let track = read("poses.tum", text, 10.0, &RecordingDescription::default()).unwrap();
    assert_eq!(at(&track, 11.0).0, DVec3::new(1.0, 0.0, 1.5));
}

#[test]
fn clocks_that_never_meet_are_reported_with_both_time_spans() {
    let error =
        read("poses.csv", "time,x,y\n5,0,0\n6,1,1\n", 1_700_000_000.0, &RecordingDescription::default()).unwrap_err();
    assert!(error.contains("from 5 to 6 s") && error.contains("from 1700000000"), "{error}");
}

#[test]
fn pose_file_errors_name_the_line() {
    let usual = RecordingDescription::default();
    for (name, text, told) in [
        ("poses.csv", "time,x\n1,2\n", "line 1: the header needs"),
        ("poses.csv", "time,x,y\n1,2,here\n", "line 2: \"here\" is not a number"),
        ("poses.csv", "time,x,y\n1,2\n", "line 2: has too few cells (2)"),
        ("poses.csv", "image,x,y\n\"0, or so.png\",1,2\n", "line 2: a quoted cell contains ','"),
        ("poses.csv", "time,note,x,y\n1,\"left, then right\",1,2\n", "line 2: a quoted cell contains ','"),
        ("poses.tum", "1 2 3\n", "line 1: every line needs 8 numbers"),
        ("poses.tum", "1 0 0 0 0 0 0 1\n1 2 3\n", "line 2: every line needs 8 numbers"),
        ("poses.json", "[{\"position\": [0, 0, 0]}]", "pose 0: expected"),
        ("poses.json", "{", "line 1"),
        ("poses.json", "{}", "expected `transforms.json`"),
        ("poses.tum", "", "holds no poses"),
        ("poses.csv", "image,x,y\nother.png,1,2\n", "pictures that are not here: line 2 names \"other.png\""),
    ] {
        let error = read(name, text, 0.0, &usual).unwrap_err();
        assert!(error.contains(told), "{name} {text:?}: {error}");
    }
}

#[test]
fn euroc_looks_along_z() {
    // The first pose of V1_01_easy: the camera looks east and down, the sensor's x axis up.
    let text = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n\
                0,0.878612,2.142470,0.947262,0.060514,-0.828459,-0.058956,-0.553641\n";
    let track = read("poses.csv", text, 0.0, &RecordingDescription::default()).unwrap();
    assert_eq!(at(&track, 0.0).1, 80.0);
}

#[test]
fn a_yaw_needs_a_world_with_z_up() {
    let described = RecordingDescription { world: Some(WorldUpAxis::YUp), ..RecordingDescription::default() };
    let error = read("poses.csv", "time_s,x,y,z,yaw_rad\n0,0,0,0,0\n", 0.0, &described).unwrap_err();
    assert!(error.contains("z-up"), "{error}");
    assert!(read("poses.csv", "time_s,x,y,z,heading_deg\n0,0,0,0,0\n", 0.0, &described).is_ok());
}

#[test]
fn a_pose_file_is_found_by_its_name_and_never_outside() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("walk");
    std::fs::create_dir(&inside).unwrap();
    std::fs::write(folder.path().join("secret.csv"), "").unwrap();
    std::fs::write(folder.path().join("walk.csv"), "").unwrap();
    std::fs::write(folder.path().join("walk.mp4"), "").unwrap();
    let usual = RecordingDescription::default();
    assert_eq!(find_pose_file(&inside, &usual).unwrap(), None);
    assert_eq!(find_pose_file(&folder.path().join("walk.mp4"), &usual).unwrap(), Some(folder.path().join("walk.csv")));
    for named in ["../secret.csv", "none.csv", "/etc/hostname"] {
        let described = RecordingDescription { poses: Some(named.into()), ..RecordingDescription::default() };
        assert!(
            find_pose_file(&inside, &described)
                .unwrap_err()
                .to_string()
                .contains("is not a file in the recording's folder"),
            "{named}"
        );
    }
}

#[test]
fn lines_of_numbers_are_read_by_their_names_and_lengths() {
    let pose = "0 1.5 -0.5 0.5 -0.5 0.5";
    let first = "0.5 -0.5 0.5 -0.5";
    let matrix = |x: u32| format!("0 0 1 {x} -1 0 0 0 0 -1 0 1.5");
    let each = |line: &dyn Fn(u32) -> String| (0..3).map(|at| line(at) + "\n").collect::<String>();
    let z_up = RecordingDescription { world: Some(WorldUpAxis::ZUp), ..RecordingDescription::default() };
    for (name, text) in [
        // RTAB-Map, with the number of the pose.
        ("poses.txt", each(&|at| format!("1{at} {at} {pose} 17"))),
        ("poses.txt", "#timestamp x y z qx qy qz qw id\n".to_owned() + &each(&|at| format!("1{at} {at} {pose} {at}"))),
        // The names of the columns: in a comment, with units, without a comment.
        (
            "poses.txt",
            "# timestamp tx ty tz qw qx qy qz\n".to_owned() + &each(&|at| format!("1{at} {at} 0 1.5 {first}")),
        ),
        (
            "poses.tum",
            "# walk\n# time [s] x [m] y [m] z [m] qw [] qx [] qy [] qz []\n".to_owned()
                + &each(&|at| format!("1{at} {at} 0 1.5 {first}")),
        ),
        ("poses.txt", "time x y z qw qx qy qz\n".to_owned() + &each(&|at| format!("1{at} {at} 0 1.5 {first}"))),
        (
            "poses.txt",
            "# x, y, z, qw, qx, qy, qz, time\n".to_owned() + &each(&|at| format!("{at},0,1.5,0.5,-0.5,0.5,-0.5,1{at}")),
        ),
        // A CSV without a header.
        ("poses.csv", each(&|at| format!("1{at},{at},0,1.5,-0.5,0.5,-0.5,0.5"))),
        // Matrices, 3 x 4 and 4 x 4, and with the number of the picture or the time before them.
        ("poses.txt", each(&|at| matrix(at))),
        ("poses.txt", each(&|at| matrix(at) + " 0 0 0 1")),
        ("poses.txt", each(&|at| format!("{at} {}", matrix(at)))),
        ("poses.txt", each(&|at| format!("1{at}.0001 {} 0 0 0 1", matrix(at)))),
    ] {
        let track = read(name, &text, 10.0, &z_up).unwrap_or_else(|error| panic!("{text}: {error}"));
        let (place, deg) = at(&track, 11.0);
        assert!(place.distance(DVec3::new(1.0, 0.0, 1.5)) < 1e-3 && deg == 90.0, "{text}: {place} {deg}");
    }
    for (text, told) in [
        ("1 0 0 1.5 0 0 0 1 0.5\n", "this one has 9: one column too many"),
        ("1 0 0 1.5 0 0 0 1 2 3\n", "this one has 10"),
        (&("1 ".repeat(30) + "\n"), "this one has more than 17"),
    ] {
        let error = read("poses.txt", text, 0.0, &z_up).unwrap_err();
        assert!(error.contains(told), "{text}: {error}");
    }
    let error = read("images.bin", "\0\0", 0.0, &z_up).unwrap_err();
    assert!(error.contains("model_converter"), "{error}");
}

#[test]
fn a_yaw_in_degrees_is_asked_for_where_it_points_along_the_path() {
    let line = |at: u32| {
        let (x, y, yaw) = if at < 6 { (at, 0, 0) } else { (5, at - 5, 90) };
        format!("{},{x},{y},{yaw}\n", f64::from(at) * 0.3)
    };
    let text = "time,x,y,yaw\n".to_owned() + &(0..12).map(line).collect::<String>();
    let error = read("poses.csv", &text, 0.0, &RecordingDescription::default()).unwrap_err();
    assert!(error.contains("Write angle_unit = \"deg\" into a recording.toml"), "{error}");
    let told = |unit| RecordingDescription { angle_unit: Some(unit), ..RecordingDescription::default() };
    assert_eq!(at(&read("poses.csv", &text, 0.0, &told(AngleUnit::Degrees)).unwrap(), 3.0).1, 0.0);
    assert!(read("poses.csv", &text, 0.0, &told(AngleUnit::Radians)).is_ok());
    // A robot that drives backwards has such a yaw too, but not in degrees.
    let back = text.replace(",90\n", ",4.71\n").replace(",0\n", ",3.14\n");
    assert!(read("poses.csv", &back, 0.0, &RecordingDescription::default()).is_ok());
}

#[test]
fn settings_that_have_no_meaning_for_a_file_are_refused() {
    let order = RecordingDescription { quaternion: Some(QuaternionOrder::Wxyz), ..RecordingDescription::default() };
    let error = read("poses.csv", "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n", 0.0, &order).unwrap_err();
    assert!(error.contains("names the order of its quaternions itself"), "{error}");
    let inverse = Some(TransformDirection::WorldToCamera);
    let inverse = RecordingDescription { transform: inverse, ..RecordingDescription::default() };
    assert!(read("poses.csv", "time,x,y\n0,0,0\n", 0.0, &inverse).unwrap_err().contains("has no rotations"));
}

#[test]
fn a_column_that_counts_the_pictures_decides_if_it_does() {
    let usual = RecordingDescription::default();
    // The clock of a phone; the pictures are a second apart.
    let text = |step_s: f64, frames: [u32; 3]| {
        let line = |at: usize| format!("{},{},{at},0,0\n", 52311.25 + at as f64 * step_s, frames[at]);
        "timestamp,frame,x,y,z\n".to_owned() + &(0..3).map(line).collect::<String>()
    };
    let place =
        |text: &str| read("poses.csv", text, 0.0, &usual).map(|track| track.fix_at(2.0).map(|fix| fix.position.x));
    assert_eq!(place(&text(1.0, [0, 1, 2])), Ok(Some(2.0)));
    // The times of pictures without times are made up.
    assert_eq!(place(&text(0.1, [0, 1, 2])), Ok(Some(2.0)));
    let other = place(&text(1.0, [500, 501, 502])).unwrap_err();
    assert!(other.contains("subtract 52311.25 s"), "{other}");
}

#[test]
fn columns_that_are_not_read_are_named() {
    let unread = |name: &str, text: &str| {
        let track = read(name, text, 0.0, &RecordingDescription::default()).unwrap();
        track.unread().map(|told| told.split_once(": ").unwrap().1.to_owned())
    };
    let rows = |cells: &str| format!("0,0,0,0{cells}\n1,1,0,0{cells}\n2,2,0,0{cells}\n");
    let csv = |names: &str, cells: &str| format!("time_s,x,y,z{names}\n{}", rows(cells));
    assert_eq!(unread("a.csv", &csv(",heading_deg", ",90")), None);
    assert_eq!(
        unread("a.csv", &csv(",heading_deg,speed,gps", ",90,1,2")).unwrap(),
        "the columns speed, gps are not read"
    );
    // A direction that is not read is worse.
    let told = unread("a.csv", &csv(",roll,pitch,azimuth", ",0,0,90")).unwrap();
    assert!(told.starts_with("the columns roll, pitch, azimuth are not read; no column gives the direction"), "{told}");
    let many: String = (0..9).map(|at| format!(",c{at}")).collect();
    assert!(unread("a.csv", &csv(&many, &",0".repeat(9))).unwrap().contains("c5 and 3 more are not read"));
    let numbered = "0 0 0 0 0 0 0 1 1\n1 1 0 0 0 0 0 1 2\n2 2 0 0 0 0 0 1 3\n";
    assert_eq!(unread("a.tum", numbered).unwrap(), "column 9 is not read: it numbers the poses");
    assert_eq!(unread("a.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n"), None);
    let named = format!("# time x y z qx qy qz qw cov\n{}", numbered.replace(" 1 1\n", " 1 0.5\n"));
    assert_eq!(unread("a.txt", &named).unwrap(), "the column cov is not read");
}

proptest! {
    #[test]
    fn no_file_makes_it_panic(text in "(time|x|y|z|qw|image|[0-9.,;# \\-\n\"\\[\\]{}:e]){0,60}", ending in "(csv|json|tum)") {
        let _ = read(&format!("poses.{ending}"), &text, 0.0, &RecordingDescription::default());
    }
}

/// A level path around a corner in a world with y up: `image,x,y,z` and, if `is_held`, an OpenGL camera that looks
/// along it.
fn with_y_up(is_held: bool) -> String {
    let header = if is_held { "image,x,y,z,qx,qy,qz,qw" } else { "image,x,y,z" };
    // Ahead is -z, then +x: a quarter clockwise seen from above.
    let looking = |at: usize| if at <= 2 { ",0,0,0,1" } else { ",0,-0.70710678,0,0.70710678" };
    let line =
        |(at, [x, z]): (usize, [f64; 2])| format!("{at}.png,{x},1.5,{z}{}\n", if is_held { looking(at) } else { "" });
    let places = [[0.0, 0.0], [0.0, -2.0], [0.0, -4.0], [3.0, -4.0]];
    format!("{header}\n{}", places.into_iter().enumerate().map(line).collect::<String>())
}

#[test]
fn a_level_walk_that_would_climb_is_refused_until_the_user_sets_the_axes() {
    let usual = RecordingDescription::default();
    let error = read("poses.csv", &with_y_up(true), 0.0, &usual).unwrap_err();
    assert!(error.contains("poses.csv") && error.contains("path climbs straight up"), "{error}");
    assert!(error.contains("Write world = \"y-up\" and orientation = \"open-gl\" into a recording.toml"), "{error}");
    let meant = RecordingDescription {
        world: Some(WorldUpAxis::YUp),
        orientation: Some(crate::axes::PoseBody::OpenGl),
        ..usual
    };
    let track = read("poses.csv", &with_y_up(true), 0.0, &meant).unwrap();
    assert_eq!((at(&track, 2.0), track.doubt()), ((DVec3::new(0.0, 4.0, 1.5), 0.0), None));
}

#[test]
fn positions_alone_that_would_climb_raise_a_doubt() {
    let track = read("poses.csv", &with_y_up(false), 0.0, &RecordingDescription::default()).unwrap();
    assert!(track.doubt().unwrap().contains("write world = \"y-up\" into a recording.toml"), "{:?}", track.doubt());
}
