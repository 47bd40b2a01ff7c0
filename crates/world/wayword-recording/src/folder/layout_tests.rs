//! Tests of the layouts in which datasets and phones' apps keep pictures and poses. In each of them the camera goes north, a metre
//! from picture to picture, and looks there.

use super::*;
use image::{Rgb, RgbImage};
use wayword_core::DVec3;

/// A folder with files: pictures by their endings, else text.
fn folder(files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        if is_picture_name(name) {
            RgbImage::from_pixel(4, 3, Rgb([0, 0, 0])).save(file).unwrap();
        } else {
            std::fs::write(file, text).unwrap();
        }
    }
    folder
}

/// Files for the pictures 0, 1 and 2, then a last one.
fn files(each: impl Fn(usize) -> Vec<(String, String)>, last: (&str, String)) -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = (0..3).flat_map(each).collect();
    all.push((last.0.to_owned(), last.1));
    all
}

fn open(files: &[(String, String)], below: &str) -> Result<Recording, String> {
    let files: Vec<(&str, String)> = files.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
    let folder = folder(&files);
    let source = PictureFolder::open(&folder.path().join(below)).unwrap().unwrap();
    let scene = source.scenes()[0].clone();
    let opened = source.open(&scene).map_err(|error| error.to_string());
    if opened.as_ref().is_ok_and(|recording| recording.track.is_some()) {
        assert!(source.files(&scene).unwrap().len() > 3, "the poses are among the files");
    }
    opened
}

/// Where the camera is at each picture from the first on, and where it looks.
fn walked(recording: &Recording) -> Vec<Option<(DVec3, f64)>> {
    let track = recording.track.as_ref().expect("it has poses");
    let fixes = recording.reel.times_s().iter().map(|time_s| track.fix_at(*time_s));
    let fixes: Vec<_> = fixes.collect();
    let first = fixes[0].unwrap().position;
    let round = |place: DVec3| (place * 1000.0).round() / 1000.0 + DVec3::ZERO;
    fixes
        .iter()
        .map(|fix| fix.map(|fix| (round(fix.position - first), fix.heading.unwrap().deg().round() % 360.0)))
        .collect()
}

fn northward() -> Vec<Option<(DVec3, f64)>> {
    (0..3).map(|at| Some((DVec3::new(0.0, f64::from(at), 0.0), 0.0))).collect()
}

/// A 4 x 4 matrix of an optical frame that looks north in a world with z up.
fn matrix(at: usize, end: &str) -> String {
    format!("1 0 0 0{end}0 0 1 {at}{end}0 -1 0 1.5{end}0 0 0 1\n")
}

fn lines(line: impl Fn(usize) -> String) -> String {
    (0..3).map(line).collect()
}

#[test]
fn datasets_and_apps_are_read_with_their_own_conventions() {
    let none = || String::new();
    let pose_of_7_scenes = |at| format!("1 0 0 0\n0 1 0 0\n0 0 1 {at}\n0 0 0 1\n");
    let euroc_header =
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
    let euroc_ns = |at: usize| 1_403_636_579_000_000_000_u64 + at as u64 * 1_000_000_000;
    let sensor = "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, -1.0, 0.0, 0.1,\n         1.0, 0.0, 0.0, 0.0,\n         \
                  0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\nrate_hz: 20\n";
    let cases = [
        (
            "7-Scenes",
            "",
            files(
                |at| {
                    vec![
                        (format!("frame-00000{at}.color.png"), none()),
                        (format!("frame-00000{at}.depth.png"), none()),
                        (format!("frame-00000{at}.pose.txt"), pose_of_7_scenes(at)),
                    ]
                },
                ("notes.txt", none()),
            ),
        ),
        (
            "ScanNet",
            "",
            files(
                |at| vec![(format!("color/{at}.jpg"), none()), (format!("pose/{at}.txt"), matrix(at, "\n"))],
                ("depth/0.png", none()),
            ),
        ),
        (
            "Replica",
            "",
            files(
                |at| vec![(format!("results/frame00000{at}.jpg"), none())],
                ("traj.txt", lines(|at| matrix(at, " "))),
            ),
        ),
        (
            "KITTI",
            "sequences/05",
            files(
                |at| {
                    vec![
                        (format!("sequences/05/image_2/00000{at}.png"), none()),
                        ("sequences/05/times.txt".into(), "0.0\n0.1\n0.2\n".into()),
                    ]
                },
                ("poses/05.txt", lines(|at| format!("1 0 0 0 0 1 0 0 0 0 1 {at}\n"))),
            ),
        ),
        (
            "EuRoC",
            "mav0/cam0",
            files(
                |at| {
                    vec![
                        (format!("mav0/cam0/data/{}.png", euroc_ns(at)), none()),
                        ("mav0/cam0/sensor.yaml".into(), sensor.into()),
                    ]
                },
                (
                    "mav0/state_groundtruth_estimate0/data.csv",
                    euroc_header.to_owned() + &lines(|at| format!("{},0,{at},1.5,0.5,-0.5,-0.5,-0.5\n", euroc_ns(at))),
                ),
            ),
        ),
        (
            "ARKitScenes",
            "",
            files(
                |at| vec![(format!("lowres_wide/40753679_679{at}.500.png"), none())],
                ("lowres_wide.traj", lines(|at| format!("679{at}.5 1.5707963267948966 0 0 0 1.5 -{at}\n"))),
            ),
        ),
        (
            "Record3D",
            "",
            files(
                |at| vec![(format!("rgbd/{at}.jpg"), none())],
                (
                    "metadata",
                    "{\"fps\": 30, \"poses\": [[0,0,0,1,0,1.5,0], [0,0,0,1,0,1.5,-1], [0,0,0,1,0,1.5,-2]]}".into(),
                ),
            ),
        ),
        (
            "Stray Scanner, the video as pictures",
            "",
            files(
                |at| vec![(format!("rgb/{at}.jpg"), none())],
                (
                    "odometry.csv",
                    "timestamp, frame, x, y, z, qx, qy, qz, qw\n".to_owned()
                        + &lines(|at| format!("{}, 00000{at}, 0, 1.5, -{at}, 1, 0, 0, 0\n", 52311.25 + at as f64 / 60.0)),
                ),
            ),
        ),
        (
            "COLMAP, named by the user",
            "",
            files(
                |at| {
                    vec![
                        (format!("images/{at}.jpg"), none()),
                        ("recording.toml".into(), "poses = \"sparse/0/images.txt\"\nworld = \"z-up\"".into()),
                    ]
                },
                (
                    "sparse/0/images.txt",
                    "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
                        .to_owned()
                        + &lines(|at| format!("{at} 0.70710678 0.70710678 0 0 0 1.5 -{at} 1 {at}.jpg\n\n")),
                ),
            ),
        ),
    ];
    for (name, below, files) in cases {
        let recording = open(&files, below).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(walked(&recording), northward(), "{name}");
    }
}

#[test]
fn the_mounting_of_a_camera_counts_and_a_lost_scanner_has_no_pose() {
    // The pose of picture 1 is lost.
    let lost = "-inf -inf -inf -inf\n".repeat(4);
    let pose = |at| if at == 1 { lost.clone() } else { matrix(at, "\n") };
    let files = files(
        |at| vec![(format!("color/{at}.jpg"), String::new()), (format!("pose/{at}.txt"), pose(at))],
        ("recording.toml", "pictures_per_s = 0.1".into()),
    );
    let recording = open(&files, "").unwrap();
    let walked = walked(&recording);
    assert!(walked[0].is_some() && walked[1].is_none() && walked[2].is_some(), "{walked:?}");
}

#[test]
fn other_files_beside_pictures_are_no_poses() {
    // Boxes of objects, as detectors are trained with.
    let files = files(
        |at| vec![(format!("{at}.png"), String::new()), (format!("poses/{at}.txt"), "0 0.5 0.5 0.1 0.1\n".into())],
        ("notes.txt", String::new()),
    );
    assert!(open(&files, "").unwrap().track.is_none());
}

#[test]
fn clocks_that_differ_are_brought_together_by_a_setting() {
    let csv = lines(|at| format!("{},0,{at},1.5,90\n", 52311.25 + at as f64));
    let with = |toml: &str| {
        files(
            |at| vec![(format!("{at}.png"), String::new()), ("recording.toml".into(), toml.to_owned())],
            ("poses.csv", format!("timestamp,x,y,z,heading_deg\n{csv}")),
        )
    };
    let error = open(&with(""), "").err().unwrap();
    assert!(error.contains("subtract 52311.25 s") && error.contains("write pose_time_offset_s = -52311.25"), "{error}");
    let recording = open(&with("pose_time_offset_s = -52311.25"), "").unwrap();
    assert_eq!(walked(&recording)[2], Some((DVec3::new(0.0, 2.0, 0.0), 90.0)));
}
