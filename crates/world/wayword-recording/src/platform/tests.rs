//! Tests of the platform on folders of pictures that are written here.

use super::*;
use ::image::{Rgb, RgbImage};
use std::sync::Mutex;
use wayword_core::motion::TurnKind;

/// Nine pictures, each with its own pattern: 4 m north, then 4 m east, with a pose file if `poses`.
fn walk(poses: bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut csv = String::from("image,x,y,z,heading_deg\n");
    for at in 0..=8_u32 {
        let picture = RgbImage::from_fn(64, 48, |x, y| {
            Rgb([if (x + 5 * at) / 4 % 2 == 0 { 200 } else { 20 }, (y * 5) as u8, at as u8])
        });
        picture.save(folder.path().join(format!("{at}.png"))).unwrap();
        let (north, east) = (at.min(4), at.saturating_sub(4));
        csv += &format!("{at}.png,{east},{north},1.5,{}\n", if at > 4 { 90 } else { 0 });
    }
    if poses {
        std::fs::write(folder.path().join("poses.csv"), csv).unwrap();
    }
    folder
}

fn open(folder: &tempfile::TempDir) -> (RecordingPlatform, SceneId, Arc<Mutex<Vec<String>>>) {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hearing = Arc::clone(&heard);
    let hear: OutputListener = Arc::new(move |line: &str| hearing.lock().unwrap().push(line.to_owned()));
    let platform = RecordingPlatform::open(folder.path(), hear).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    (platform, scene, heard)
}

#[test]
fn a_walk_with_poses_has_moves_and_pictures_ahead() {
    let folder = walk(true);
    let (platform, scene, heard) = open(&folder);
    let path = platform.sample_path(&scene, &PathRequest::default(), 3).unwrap();
    assert_eq!((path.frames.len(), path.motion, path.target.is_none()), (9, PathMotion::Known, true));
    let turns: Vec<TurnKind> = path.moves().iter().map(wayword_core::PathMove::turn).collect();
    assert_eq!(turns.iter().filter(|turn| **turn == TurnKind::Right).count(), 1, "{turns:?}");
    assert_eq!(platform.graph_for_scene(&scene).unwrap().len(), 9);
    for (at, frame) in path.frames.iter().enumerate() {
        let view = platform.look_from(&scene, frame, ViewGaze::quarter_view(frame.pose.heading)).unwrap();
        assert_eq!(view.image.unwrap().rgb_bytes()[2], at as u8);

        let behind = platform.look_from(&scene, frame, ViewGaze::around_heading(frame.pose.heading)[2]).unwrap();
        assert!(behind.image.is_none());
    }
    assert!(heard.lock().unwrap()[0].contains("9 pictures, 9 frames"), "{heard:?}");
}

#[test]
fn a_walk_without_poses_knows_its_order_alone() {
    let folder = walk(false);
    let (platform, scene, heard) = open(&folder);
    let path = platform.sample_path(&scene, &PathRequest { hops: 2..=3, ..PathRequest::default() }, 3).unwrap();
    assert_eq!(path.motion, PathMotion::Unknown);
    assert!(path.moves().is_empty());
    assert!((3..=4).contains(&path.frames.len()));
    assert!(platform.graph_for_scene(&scene).unwrap().is_empty());
    let names: Vec<&str> = path.frames.iter().map(|frame| frame.viewpoint.as_ref().unwrap().as_str()).collect();
    assert!(names.iter().all(|name| name.ends_with(".png")), "{names:?}");
    let first = &path.frames[0];
    assert!(platform.look_from(&scene, first, ViewGaze::quarter_view(first.pose.heading)).unwrap().image.is_some());
    assert!(heard.lock().unwrap()[0].contains("no poses"));
}

#[test]
fn stretches_fit_the_request_and_depend_on_the_seed() {
    let folder = walk(true);
    let (platform, scene, _) = open(&folder);
    let request = PathRequest { length_m: 2.0..=4.0, ..PathRequest::default() };
    let mut starts = BTreeSet::new();
    for seed in 0..20 {
        let path = platform.sample_path(&scene, &request, seed).unwrap();
        assert_eq!(path, platform.sample_path(&scene, &request, seed).unwrap());
        let length_m: f64 = path.moves().iter().map(|step| step.distance_m).sum();
        assert!((2.0..=4.0).contains(&length_m), "{length_m}");
        starts.insert(path.frames[0].viewpoint.clone());
    }
    assert!(starts.len() > 3);
    let long = PathRequest { length_m: 50.0..=60.0, ..PathRequest::default() };
    assert!(matches!(platform.sample_path(&scene, &long, 0), Err(PlatformError::NoSuchPath { .. })));
}

#[test]
fn no_path_leads_over_a_gap_in_the_track() {
    let folder = walk(true);
    // Two metres north, then three pictures without a pose, then far away.
    let csv = "image,x,y,z,heading_deg\n0.png,0,0,0,0\n1.png,0,1,0,0\n2.png,0,2,0,0\n\
               6.png,20,4,0,90\n7.png,21,4,0,90\n8.png,22,4,0,90\n";
    std::fs::write(folder.path().join("poses.csv"), csv).unwrap();
    let (platform, scene, heard) = open(&folder);
    let request = |length_m| PathRequest { length_m, ..PathRequest::default() };
    for seed in 0..20 {
        let path = platform.sample_path(&scene, &request(1.5..=30.0), seed).unwrap();
        assert!((path.length_m().unwrap() - 2.0).abs() < 1e-9, "{path:?}");
    }
    assert!(platform.sample_path(&scene, &request(5.0..=30.0), 0).is_err());
    let id = |name: &str| ViewpointId::new(name).unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    assert!(graph.shortest_path(&id("6.png"), &id("8.png")).unwrap().is_some());
    assert!(graph.shortest_path(&id("2.png"), &id("6.png")).unwrap().is_none());
    assert!(heard.lock().unwrap()[0].contains("1 gap that no path crosses"), "{heard:?}");
}

/// Two good recordings and two that cannot be read.
fn with_unreadable() -> tempfile::TempDir {
    let shelf = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        let folder = shelf.path().join(name);
        std::fs::create_dir(&folder).unwrap();
        RgbImage::from_pixel(4, 3, Rgb([9; 3])).save(folder.join("1.png")).unwrap();
    }
    let phone = shelf.path().join("phone");
    std::fs::create_dir(&phone).unwrap();
    std::fs::write(phone.join("1.jpg"), b"\0\0\0\x1cftypheic\0\0\0\0mif1heic").unwrap();
    std::fs::create_dir(shelf.path().join("torn")).unwrap();
    std::fs::write(shelf.path().join("torn/1.png"), b"\x89PNG\r\n\x1a\n").unwrap();
    shelf
}

#[test]
fn check_reports_all_unreadable_recordings_of_the_scenes() {
    let shelf = with_unreadable();
    let (platform, ..) = open(&shelf);
    let scenes: Vec<SceneId> = ["a", "b", "phone", "torn", "elsewhere"].map(|name| SceneId::new(name).unwrap()).into();
    let told = platform.files().check_scenes(&scenes.iter().collect()).unwrap_err().to_string();
    assert!(told.contains("2 of 4 recordings cannot be read") && told.contains("--scan"), "{told}");
    assert!(told.contains("1.jpg: is an HEIC picture") && told.contains("heif-convert"), "{told}");
    assert!(told.contains("torn/1.png: is a picture that is cut off"), "{told}");
    platform.files().check_scenes(&scenes[..2].iter().collect()).unwrap();
    let alone = RecordingPlatform::open(&shelf.path().join("phone"), Arc::new(|_: &str| {})).unwrap();
    let told = alone.files().check_scenes(&scenes.iter().collect()).unwrap_err().to_string();
    assert!(told.contains("1.jpg: is an HEIC picture, neither PNG nor JPEG"), "{told}");
    assert!(alone.graph_for_scene(&scenes[2]).unwrap_err().to_string().contains("HEIC"));
}

#[test]
fn an_unopened_recording_reports_its_error_when_used() {
    let shelf = with_unreadable();
    std::fs::write(shelf.path().join("b/2.heic"), b"\0\0\0\x1cftypheic\0\0\0\0mif1heic").unwrap();
    let (platform, ..) = open(&shelf);
    let [a, b] = ["a", "b"].map(|name| SceneId::new(name).unwrap());
    platform.files().check_scenes(&BTreeSet::from([&a])).unwrap();
    let told = platform.files().check_scenes(&BTreeSet::from([&a, &b])).unwrap_err().to_string();
    // The others of the folder are told with it.
    assert!(told.contains("3 of 4 recordings cannot be read") && told.contains("torn/1.png"), "{told}");
    assert!(told.contains("holds pictures, but 2.heic is an HEIC picture"), "{told}");
    assert!(platform.graph_for_scene(&b).unwrap_err().to_string().contains("2.heic"));
}

/// The names of the files that a scene is read from.
fn files(platform: &RecordingPlatform, scene: &str) -> Vec<String> {
    let files = platform.files().source_files(&SceneId::new(scene).unwrap()).unwrap();
    files.iter().map(|file| file.file_name().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
fn files_of_a_folder_are_its_pictures_poses_and_description() {
    let shelf = with_unreadable();
    let a = shelf.path().join("a");
    std::fs::create_dir(a.join("run")).unwrap();
    for name in ["2.png", "poses.csv", "recording.toml", ".DS_Store", "._1.png", "notes.txt", "run/dialogs.jsonl"] {
        std::fs::write(a.join(name), "").unwrap();
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/nowhere", a.join("gone.png")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(a.join("pipe.png")).status().unwrap().success());
    }
    let (platform, ..) = open(&shelf);
    assert_eq!(files(&platform, "a"), ["1.png", "2.png", "poses.csv", "recording.toml"]);
    assert_eq!(files(&platform, "b"), ["1.png"]);
    assert!(matches!(
        platform.files().source_files(&SceneId::new("c").unwrap()),
        Err(PlatformError::UnknownScene { .. })
    ));
}

#[cfg(all(feature = "mcap", feature = "video"))]
#[test]
fn files_of_a_video_include_its_poses_and_description() {
    let shelf = tempfile::tempdir().unwrap();
    for name in ["walk.mp4", "walk.toml", "walk.csv", "hall.mp4", "recording.toml", "bag.mcap", "bag.csv", "notes.txt"]
    {
        std::fs::write(shelf.path().join(name), "").unwrap();
    }
    let (platform, ..) = open(&shelf);
    assert_eq!(files(&platform, "walk"), ["recording.toml", "walk.csv", "walk.mp4", "walk.toml"]);
    assert_eq!(files(&platform, "hall"), ["hall.mp4", "recording.toml"]);
    assert_eq!(files(&platform, "bag"), ["bag.mcap", "recording.toml"]);
}

#[test]
fn unknown_scenes_and_viewpoints_are_refused() {
    let folder = walk(true);
    let (platform, scene, _) = open(&folder);
    let mut frame = platform.sample_path(&scene, &PathRequest::default(), 0).unwrap().frames.remove(0);
    frame.viewpoint = Some(ViewpointId::new("nothing").unwrap());
    let gaze = ViewGaze::quarter_view(frame.pose.heading);
    assert!(matches!(platform.look_from(&scene, &frame, gaze), Err(PlatformError::UnknownViewpoint { .. })));
    frame.viewpoint = None;
    assert!(matches!(platform.look_from(&scene, &frame, gaze), Err(PlatformError::NotAViewpoint { .. })));
    let other = SceneId::new("other").unwrap();
    assert!(matches!(platform.graph_for_scene(&other), Err(PlatformError::UnknownScene { .. })));
    let nowhere = RecordingPlatform::open(FilePath::new("/nowhere"), Arc::new(|_: &str| {}));
    assert!(nowhere.err().unwrap().to_string().contains("there is no such file or folder"));
}

#[test]
fn large_pictures_are_made_as_large_as_other_worlds_have_them() {
    let large = Image::new(1280, 720, vec![90; 1280 * 720 * 3]).unwrap();
    let small = scale_down(&large);
    assert_eq!((small.width_px(), small.height_px()), (640, 360));
    assert!(small.rgb_bytes().iter().all(|level| *level == 90));
    // A phone that was held upright.
    let upright = scale_down(&Image::new(720, 1280, vec![90; 1280 * 720 * 3]).unwrap());
    assert_eq!((upright.width_px(), upright.height_px()), (360, 640));
    assert_eq!(scale_down(&upright), upright);
}

#[test]
fn a_doubt_about_poses_is_reported() {
    let folder = walk(true);
    // North and east in a world with y up.
    let line = |at: u32| format!("{at}.png,{},1.5,-{}\n", at.saturating_sub(4), at.min(4));
    let csv: String = (0..=8).map(line).collect();
    std::fs::write(folder.path().join("poses.csv"), format!("image,x,y,z\n{csv}")).unwrap();
    let (platform, scene, heard) = open(&folder);
    platform.graph_for_scene(&scene).unwrap();
    assert!(heard.lock().unwrap().iter().any(|line| line.contains("write world = \"y-up\"")), "{heard:?}");
    std::fs::write(folder.path().join("recording.toml"), "world = \"y-up\"").unwrap();
    let (platform, scene, heard) = open(&folder);
    platform.graph_for_scene(&scene).unwrap();
    // Positions alone do not show the hand of the world.
    let heard = heard.lock().unwrap();
    assert!(heard.len() == 2 && heard[1].contains("if it is Unity's, write world = \"unity\""), "{heard:?}");
}

#[test]
fn columns_that_are_not_read_are_named_once() {
    let folder = walk(true);
    let csv = std::fs::read_to_string(folder.path().join("poses.csv")).unwrap();
    let with_speed: String =
        csv.lines().map(|line| format!("{line},{}\n", if line.starts_with("image") { "speed" } else { "1" })).collect();
    std::fs::write(folder.path().join("poses.csv"), with_speed).unwrap();
    let (platform, scene, heard) = open(&folder);
    platform.graph_for_scene(&scene).unwrap();
    let heard = heard.lock().unwrap();
    assert!(heard.len() == 2 && heard[1].ends_with("poses.csv: the column speed is not read"), "{heard:?}");
}

#[test]
fn a_short_recording_is_taken_whole_unless_another_length_is_asked_for() {
    // Four metres of the walk are less than the usual least length, and three pictures are fewer than the usual hops.
    for (poses, pictures) in [(true, 5), (true, 2), (false, 3)] {
        let folder = walk(poses);
        for at in pictures..=8 {
            std::fs::remove_file(folder.path().join(format!("{at}.png"))).unwrap();
        }
        if poses {
            let csv = std::fs::read_to_string(folder.path().join("poses.csv")).unwrap();
            let kept: Vec<&str> = csv.lines().take(pictures + 1).collect();
            std::fs::write(folder.path().join("poses.csv"), kept.join("\n")).unwrap();
        }
        let (platform, scene, _) = open(&folder);
        let path = platform.sample_path(&scene, &PathRequest::default(), 7).unwrap();
        assert_eq!(path.frames.len(), pictures, "with poses: {poses}");
        let long = PathRequest { length_m: 50.0..=60.0, hops: 50..=60 };
        assert!(matches!(platform.sample_path(&scene, &long, 7), Err(PlatformError::NoSuchPath { .. })));
    }
}
