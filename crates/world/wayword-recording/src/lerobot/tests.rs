//! Tests on datasets that LeRobot itself wrote, unchanged or damaged.

use super::*;
use flate2::read::GzDecoder;
use proptest::prelude::*;
use std::{fs, io::Read, path::PathBuf};
use wayword_core::{DVec3, Image};

/// Made by LeRobot's own library: `fixtures/make_lerobot.py`.
const DATASETS: [&str; 4] = ["v21_images", "v21_videos", "v30_images", "v30_videos"];
const CAMERA: &str = "observation.images.front";

/// A copy of a dataset, unpacked.
fn dataset(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("curve");
    unpack(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/lerobot").join(name), &root);
    (folder, root)
}

fn unpack(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name().into_string().unwrap())).unwrap();
        if path.is_dir() {
            unpack(&path, &to.join(name));
        } else if let Some(name) = name.strip_suffix(".gz") {
            let mut bytes = Vec::new();
            GzDecoder::new(fs::File::open(&path).unwrap()).read_to_end(&mut bytes).unwrap();
            fs::write(to.join(name), bytes).unwrap();
        } else {
            fs::copy(&path, to.join(name)).unwrap();
        }
    }
}

fn open(root: &Path) -> Result<LeRobotDataset, String> {
    LeRobotDataset::open(root, RecordingDescription::default()).map_err(|error| error.to_string())
}

fn recording(root: &Path, episode: usize) -> Result<Recording, String> {
    let dataset = open(root)?;
    dataset.open(&dataset.scenes()[episode]).map_err(|error| error.to_string())
}

fn pictures(recording: &Recording, wanted: &[usize]) -> Result<Vec<(usize, Image)>, String> {
    let mut pictures = Vec::new();
    let read = recording.reel.hand_out_pictures(wanted, &mut |number, image| {
        pictures.push((number, image));
        Ok(())
    });
    read.map(|()| pictures).map_err(|error| error.to_string())
}

/// The grey level in the middle of a picture's upper left quarter.
fn level(image: &Image) -> i32 {
    let at = (16 * image.width_px() as usize + 20) * 3;
    i32::from(image.rgb_bytes()[at])
}

/// Changes a text in a dataset's `meta/info.json`.
fn edit(root: &Path, from: &str, to: &str) {
    let file = DatasetInfo::info_file(root);
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(&file, text.replace(from, to)).unwrap();
}

#[test]
fn episodes_of_the_genuine_library_are_scenes() {
    for name in DATASETS {
        let (_folder, root) = dataset(name);
        let scenes = open(&root).unwrap().scenes();
        assert_eq!(scenes.iter().map(SceneId::as_str).collect::<Vec<_>>(), ["curve_000000", "curve_000001"], "{name}");
        for (episode, length) in [7, 6].into_iter().enumerate() {
            let recording = recording(&root, episode).unwrap();
            let times_s = recording.reel.times_s();
            assert_eq!(times_s.len(), length, "{name}");
            assert!(
                times_s.iter().enumerate().all(|(at, time_s)| (time_s - at as f64 / 5.0).abs() < 1e-6),
                "{times_s:?}"
            );
            assert_eq!(recording.reel.picture_name(2), "000002");
        }
    }
}

#[test]
fn an_episode_is_read_from_its_own_files_and_those_of_meta() {
    for name in DATASETS {
        let (_folder, root) = dataset(name);
        for junk in ["meta/.DS_Store", "run/dialogs.jsonl", "notes.txt", "recording.toml"] {
            let file = root.join(junk);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, "").unwrap();
        }
        let dataset = open(&root).unwrap();
        let files = dataset.files(&dataset.scenes()[0]).unwrap();
        let episode = &dataset.episodes[0].1;
        let clips = episode.clip.iter().map(|clip| &clip.file);
        assert!(
            clips.chain([&episode.data, &DatasetInfo::info_file(&root)]).all(|file| files.contains(file)),
            "{files:?}"
        );
        assert!(files.iter().all(|file| file.is_file()), "{files:?}");
        let told: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        for other in ["DS_Store", "dialogs", "notes", "episode_000001"] {
            assert!(!told.iter().any(|file| file.contains(other)), "{other}: {told:?}");
        }
        assert!(files.contains(&root.join("recording.toml")), "{files:?}");
    }
}

#[test]
fn each_picture_is_that_of_its_episode_and_row() {
    for name in DATASETS {
        let (_folder, root) = dataset(name);
        for (episode, wanted) in
            [(0, vec![0, 1, 2, 3, 4, 5, 6]), (1, vec![0, 1, 2, 3, 4, 5]), (0, vec![3, 6]), (1, vec![5])]
        {
            let recording = recording(&root, episode).unwrap();
            let pictures = pictures(&recording, &wanted).unwrap();
            assert_eq!(pictures.iter().map(|(number, _)| *number).collect::<Vec<_>>(), wanted, "{name}");
            for (number, image) in pictures {
                assert_eq!((image.width_px(), image.height_px()), (80, 64));
                let expected = 120 * episode as i32 + 16 * number as i32;
                // AV1 changes levels a little; the next frame's is 16 away.
                let most = if name.ends_with("videos") { 5 } else { 0 };
                assert!(
                    (level(&image) - expected).abs() <= most,
                    "{name} {episode} {number}: {} {expected}",
                    level(&image)
                );
            }
        }
    }
}

#[test]
fn poses_are_those_of_the_state() {
    for name in DATASETS {
        let (_folder, root) = dataset(name);
        let recording = recording(&root, 1).unwrap();
        let fix = recording.track.unwrap().fix_at(0.6).unwrap();
        assert!(fix.position.distance(DVec3::new(1.5, 1.75, 0.0)) < 1e-5, "{name}: {fix:?}");
        // theta = 90 + 30 degrees counter-clockwise from +x, which is east.
        assert!((fix.heading.unwrap().deg() - 330.0).abs() < 1e-4, "{name}: {fix:?}");
    }
}

#[test]
fn of_several_cameras_one_has_to_be_named() {
    let (_folder, root) = dataset("v30_images");
    edit(
        &root,
        "\"features\": {",
        &format!("\"features\": {{ \"{CAMERA}2\": {{\"dtype\": \"video\", \"shape\": [4, 4, 3]}},"),
    );
    let error = open(&root).err().unwrap();
    assert!(error.contains(&format!("several cameras: {CAMERA}, {CAMERA}2")) && error.contains("camera = "), "{error}");
    let named = |name: &str| {
        let described = RecordingDescription { camera: Some(name.to_owned()), ..RecordingDescription::default() };
        LeRobotDataset::open(&root, described).map(|dataset| dataset.episodes.len()).map_err(|error| error.to_string())
    };
    assert_eq!(named(CAMERA), Ok(2));
    assert!(named("wrist").unwrap_err().contains("no camera \"wrist\"; its cameras: "));
    assert!(named("observation.images.front2").unwrap_err().contains("videos/observation.images.front2"));
}

#[test]
fn paths_of_the_dataset_are_obeyed_but_do_not_leave_it() {
    let (_folder, root) = dataset("v21_images");
    fs::rename(root.join("data/chunk-000"), root.join("rows")).unwrap();
    edit(&root, "data/chunk-{episode_chunk:03d}/", "rows/");
    assert!(recording(&root, 1).is_ok());
    edit(&root, "rows/", "../rows/");
    assert!(open(&root).err().unwrap().contains("does not lie in the dataset"));
}

#[test]
fn a_dataset_that_contradicts_itself_is_refused() {
    let (_folder, root) = dataset("v21_videos");
    let list = root.join("meta/episodes.jsonl");
    let text = fs::read_to_string(&list).unwrap();
    fs::write(&list, text.replace("\"length\": 7", "\"length\": 8")).unwrap();
    assert!(recording(&root, 0).err().unwrap().contains("the number of rows of episode 0 is 7, not 8"));
    fs::write(&list, text.replace("\"episode_index\": 1", "\"episode_index\": 0")).unwrap();
    assert!(open(&root).err().unwrap().contains("episode 0 is listed twice"));
    fs::write(&list, text.replace("\"length\": 6", "\"length\": -6")).unwrap();
    assert!(open(&root).err().unwrap().contains("line 2"));
    fs::write(&list, "").unwrap();
    assert!(open(&root).err().unwrap().contains("lists no episodes"));
}

#[test]
fn a_video_without_a_rows_picture_is_named() {
    let (_folder, root) = dataset("v21_videos");
    let videos = root.join("videos/chunk-000").join(CAMERA);
    // The other episode has one picture less.
    fs::copy(videos.join("episode_000001.mp4"), videos.join("episode_000000.mp4")).unwrap();
    let error = recording(&root, 0).err().unwrap();
    assert!(error.contains("row 6 of the episode needs a picture at 1.200 s"), "{error}");
    fs::remove_file(videos.join("episode_000000.mp4")).unwrap();
    assert!(recording(&root, 0).err().unwrap().contains("episode_000000.mp4"));
}

#[test]
fn a_dataset_without_places_has_no_track() {
    let (_folder, root) = dataset("v30_images");
    edit(&root, "\"theta\"", "\"shoulder\"");
    assert!(recording(&root, 0).unwrap().track.is_none());
    let described =
        RecordingDescription { poses: Some("observation.state".to_owned()), ..RecordingDescription::default() };
    let dataset = LeRobotDataset::open(&root, described).unwrap();
    let fix = dataset.open(&dataset.scenes()[0]).unwrap().track.unwrap().fix_at(0.2).unwrap();
    assert!((fix.position.x - 0.5).abs() < 1e-6 && fix.heading.is_none(), "{fix:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn no_broken_dataset_panics(
        which in 0..DATASETS.len(),
        file in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (_folder, root) = dataset(DATASETS[which]);
        let mut all = Vec::new();
        files_below(&root, &mut all);
        let file = &all[file.index(all.len())];
        let mut bytes = fs::read(file).unwrap();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        fs::write(file, bytes).unwrap();
        for episode in 0..open(&root).map_or(0, |dataset| dataset.episodes.len()) {
            if let Ok(recording) = recording(&root, episode) {
                let wanted: Vec<usize> = (0..recording.reel.times_s().len().min(1)).collect();
                let _: Result<_, _> = pictures(&recording, &wanted);
            }
        }
    }
}

fn files_below(folder: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, into);
        } else {
            into.push(path);
        }
    }
}

#[test]
fn what_info_json_says_otherwise_is_told() {
    for name in DATASETS {
        let (_folder, root) = dataset(name);
        assert!(recording(&root, 0).unwrap().reel.remarks().is_empty(), "{name}");
        edit(&root, "\"total_episodes\": 2", "\"total_episodes\": 50");
        edit(&root, "\"total_frames\": 13", "\"total_frames\": 700");
        let told = recording(&root, 0).unwrap().reel.remarks().join("\n");
        assert!(
            told.contains("says 50 episodes, but 2 are listed, and 700 rows, but the listed episodes have 13"),
            "{name}: {told}"
        );
    }
}

#[test]
fn a_video_in_another_codec_is_written_again_in_its_place() {
    let (_folder, root) = dataset("v21_videos");
    let video = root.join("videos/chunk-000").join(CAMERA).join("episode_000000.mp4");
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/video/hevc.mp4"), video).unwrap();
    let error = recording(&root, 0).err().unwrap();
    for told in ["HEVC (H.265)", "find videos -name \"*.mp4\"", "mv \"$f.new.mp4\" \"$f\""] {
        assert!(error.contains(told), "{error}");
    }
    assert!(!error.contains("OUT.mp4"), "{error}");
}

#[test]
fn a_state_that_could_be_poses_is_named() {
    let (_folder, root) = dataset("v30_videos");
    edit(&root, "\"theta\"", "\"shoulder\"");
    let told = recording(&root, 0).unwrap().reel.remarks().join("\n");
    assert!(told.contains("poses = \"observation.state\"") && told.contains("recording.toml"), "{told}");
    // Where the user named poses, or the program took some, there is nothing to tell.
    let (_folder, root) = dataset("v30_images");
    assert_eq!(recording(&root, 0).unwrap().reel.remarks(), [""; 0]);
}
