//! Finds files that look like poses and that nobody named, so that a recording without poses is not told to have none.

use super::{
    columns::{PoseColumns, header_names},
    rows::parse_number,
};
use crate::names::{PICTURE_FOLDERS, has_ending, is_picture_name, is_video_name, sorted_entries};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

/// Endings of files that may hold poses.
const POSE_ENDINGS: [&str; 8] = ["tum", "txt", "csv", "tsv", "json", "jsonl", "traj", "log"];
/// Words in JSON about poses, as several programs write them.
const POSE_WORDS: [&str; 10] = [
    "transform_matrix",
    "\"position\"",
    "camera_to_world",
    "camtoworld",
    "cameraPoseARFrame",
    "\"translation\"",
    "\"xyz\"",
    "\"pose\"",
    "\"quaternion\"",
    "\"extrinsics\"",
];
/// Places of COLMAP's models.
const COLMAP_FOLDERS: [&str; 5] = ["sparse/0", "colmap/sparse/0", "sparse", "colmap", "dslr_calibration_undistorted"];
/// Bytes that are read from the beginning of a file.
const HEAD_BYTES: u64 = 4096;
/// Most files of a folder that are looked into, and most that are named.
const MAX_EXAMINED_FILES: usize = 200;
const MAX_NAMED_FILES: usize = 3;
/// How far the length of a rotation's row or of a quaternion may be from 1.
const UNIT_LENGTH_SLACK: f64 = 0.02;

/// A line for each file beside a recording that looks like poses; `files` are those that the recording is read from, and `data` is
/// the path that the user gave.
pub(crate) fn describe_unread(data: &Path, files: &[PathBuf]) -> Vec<String> {
    let Some(UnposedRecording { root, pictures, video }) = UnposedRecording::from_files(files) else {
        return Vec::new();
    };
    let toml = video.as_deref().map_or_else(|| "recording.toml".to_owned(), own_toml);
    let mut lines: Vec<String> = Vec::new();
    // The folder of the pictures may itself be what the user gave. Then a pose file above it cannot be named.
    let is_outside = pictures == data && root != pictures;
    let folders = [Some(&root), (pictures != root).then_some(&pictures)];
    for folder in folders.into_iter().flatten() {
        for name in pose_like_files(folder, video.as_deref()) {
            let file = folder.join(name);
            let name = file.strip_prefix(&root).unwrap_or(&file).display();
            lines.push(if is_outside && *folder == root {
                format!("{} looks like poses and is not read; give the folder above as --data", file.display())
            } else {
                format!(
                    "{name} looks like poses and is not read; if it holds those of the camera or of the robot, name it in {toml}: \
                     poses = \"{name}\" (for a robot's base, add orientation = \"robot\")"
                )
            });
        }
    }
    lines.extend(describe_colmap(&root, &toml));
    lines
}

/// The names of the first files in a folder that look like poses, without those that belong to another video than `video`.
fn pose_like_files(folder: &Path, video: Option<&Path>) -> Vec<String> {
    let names = sorted_entries(folder).unwrap_or_default();
    let stem = |name: &str| Path::new(name).file_stem().map(std::ffi::OsStr::to_owned);
    let is_of_other_video = |name: &String| {
        let is_own = video.is_none_or(|video| video.file_stem() == stem(name).as_deref());
        !is_own && names.iter().any(|other| is_video_name(other) && stem(other) == stem(name))
    };
    let candidates = names.iter().filter(|name| has_ending(name, &POSE_ENDINGS) && !is_of_other_video(name));
    let found = candidates.take(MAX_EXAMINED_FILES).filter(|name| looks_like_poses(&folder.join(name)));
    found.take(MAX_NAMED_FILES).cloned().collect()
}

/// The description of a file, by its name.
fn own_toml(recording: &Path) -> String {
    recording.with_extension("toml").file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// A line about COLMAP's model below a folder.
fn describe_colmap(folder: &Path, toml: &str) -> Option<String> {
    COLMAP_FOLDERS.iter().find_map(|below| {
        if folder.join(below).join("images.txt").is_file() {
            return Some(format!(
                "{below}/images.txt holds COLMAP's poses and is not read, because COLMAP chooses its own scale and axes; if \
                 you have aligned them (metres, z up), name them in {toml}: poses = \"{below}/images.txt\" and world = \
                 \"z-up\""
            ));
        }
        folder.join(below).join("images.bin").is_file().then(|| {
            format!(
                "{below}/images.bin holds COLMAP's poses and is not read; colmap model_converter --output_type TXT writes \
                 images.txt"
            )
        })
    })
}

/// Whether a file looks like poses by its first lines.
fn looks_like_poses(file: &Path) -> bool {
    let mut head = Vec::new();
    let opened = File::open(file).and_then(|opened| opened.take(HEAD_BYTES).read_to_end(&mut head));
    if !file.is_file() || opened.is_err() {
        return false;
    }
    let text = String::from_utf8_lossy(&head);
    if text.trim_start().starts_with(['{', '[']) {
        return POSE_WORDS.iter().any(|word| text.contains(word));
    }
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let is_header = |line: &&str| PoseColumns::from_names(&header_names(line)).is_some();
    let has_header = text.lines().take(8).any(|line| is_header(&line));
    let is_pose_line = |line: &str| {
        let words = line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> = words.take(18).map(|word| parse_number(word).ok()).collect();
        numbers.is_some_and(|numbers| holds_rotation(&numbers))
    };
    has_header || lines.any(is_pose_line)
}

/// Whether a line of numbers can be a pose: it ends with a quaternion or holds a rotation.
fn holds_rotation(numbers: &[f64]) -> bool {
    let is_unit = |numbers: &[f64]| {
        let length = libm::sqrt(numbers.iter().map(|number| number * number).sum());
        (length - 1.0).abs() <= UNIT_LENGTH_SLACK
    };
    let range = |from: usize, to: usize| numbers.get(from..to).is_some_and(is_unit);
    match numbers.len() {
        7 => range(3, 7),
        8 | 9 => range(4, 8),
        12 | 16 => range(0, 3) && range(4, 7) && range(8, 11),
        13 | 17 => range(1, 4) && range(5, 8) && range(9, 12),
        _ => false,
    }
}

/// Where the poses of a recording may be.
struct UnposedRecording {
    /// The folder of the recording.
    root: PathBuf,
    /// The folder of its pictures: `root` or a folder in it.
    pictures: PathBuf,
    /// The video, if it is one.
    video: Option<PathBuf>,
}

impl UnposedRecording {
    /// From the files of a recording; `None` for kinds of recordings that have no pose files.
    fn from_files(files: &[PathBuf]) -> Option<Self> {
        let ending = |file: &Path| file.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if files.iter().any(|file| matches!(ending(file).as_str(), "mcap" | "parquet")) {
            return None;
        }
        let name = |file: &Path| file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if let Some(video) = files.iter().find(|file| is_video_name(&name(file))) {
            let folder = video.parent()?.to_owned();
            return Some(Self { root: folder.clone(), pictures: folder, video: Some(video.clone()) });
        }
        let pictures = files.iter().find(|file| is_picture_name(&name(file)))?.parent()?.to_owned();
        let above = pictures.parent().filter(|_| PICTURE_FOLDERS.contains(&name(&pictures).as_str()));
        Some(Self { root: above.unwrap_or(&pictures).to_owned(), pictures, video: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_file_under_another_name_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("1.png", "");
        write("walk.tum", "1 0 0 1.5 0 0 0 1\n");
        write("named.log", "# timestamp x y z qw qx qy qz\n1 0 0 1.5 1 0 0 0\n");
        write("matrices.txt", "1 0 0 2 0 1 0 3 0 0 1 4\n");
        write("slam.json", "{\"poses\": [{\"t\": 1, \"xyz\": [0, 0, 1.5]}]}");
        write("slam.jsonl", "{\"time_s\": 1, \"position\": [0, 0, 1.5]}\n");
        // Neither of these is a pose.
        write("camera_matrix.csv", "300.0, 0.0, 160.0\n0.0, 300.0, 120.0\n0.0, 0.0, 1.0\n");
        write("imu.csv", "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z\n1,2,3,4,5,6,7\n");
        write("intrinsic.txt", "577 0 318 0\n0 578 242 0\n0 0 1 0\n0 0 0 1\n");
        write("boxes.txt", "0 0.5 0.5 0.1 0.1\n");
        write("notes.json", "{\"camera\": 1}");
        let files = [folder.path().join("1.png")];
        let named: Vec<String> = describe_unread(folder.path(), &files)
            .iter()
            .map(|line| line.split(' ').next().unwrap().to_owned())
            .collect();
        assert_eq!(named, ["matrices.txt", "named.log", "slam.json"]);
        for read in ["matrices.txt", "named.log"] {
            std::fs::remove_file(folder.path().join(read)).unwrap();
        }
        let named = describe_unread(folder.path(), &files).join(" ");
        assert!(["slam.json ", "slam.jsonl ", "walk.tum "].iter().all(|name| named.contains(name)), "{named}");
        write("matrices.txt", "1 0 0 2 0 1 0 3 0 0 1 4\n");
        let inside = [folder.path().join("rgb/1.png")];
        let told = describe_unread(&folder.path().join("rgb"), &inside);
        assert!(told[0].contains("give the folder above as --data"), "{told:?}");
        assert!(describe_unread(folder.path(), &inside)[0].contains("poses = \"matrices.txt\""));
        std::fs::create_dir_all(folder.path().join("sparse/0")).unwrap();
        write("sparse/0/images.bin", "");
        assert!(describe_unread(folder.path(), &files).last().unwrap().contains("model_converter"));
    }
}
