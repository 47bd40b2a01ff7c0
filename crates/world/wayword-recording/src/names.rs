//! Names of recordings, and of the files in their folders.

use std::{
    cmp::Ordering,
    path::{Path, PathBuf},
};
use wayword_core::{PlatformError, SceneId};
use wayword_world::files;

const FOLDER_HINT: &str = "give a folder that can be read";
/// Most recordings that an error names; three dots replace the others.
const MAX_NAMED_SCENES: usize = 12;
/// Most entries of a folder; more are an error.
const MAX_ENTRIES: usize = 1_000_000;

/// Subfolders in which datasets and phones' apps keep their pictures.
pub(crate) const PICTURE_FOLDERS: [&str; 10] =
    ["rgb", "images", "color", "frames", "data", "image_2", "image_0", "rgbd", "results", "lowres_wide"];

/// Whether a file is a picture that can be read, by its ending.
pub(crate) fn is_picture_name(name: &str) -> bool {
    has_ending(name, &["png", "jpg", "jpeg"])
}

/// Whether a file is a video that can be read, by its ending.
pub(crate) fn is_video_name(name: &str) -> bool {
    has_ending(name, &["mp4", "m4v", "mov"])
}

/// Whether a name ends in one of these ways.
pub(crate) fn has_ending(name: &str, endings: &[&str]) -> bool {
    let ending = Path::new(name).extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    // macOS leaves "._x.jpg" next to "x.jpg" on foreign disks.
    !name.starts_with('.') && endings.iter().any(|known| ending.eq_ignore_ascii_case(known))
}

/// The scene name of a recording, from the name of its file or folder.
pub(crate) fn scene_id_for_path(path: &Path) -> Result<SceneId, PlatformError> {
    let name = if path.is_dir() { path.file_name() } else { path.file_stem() };
    let name = match name {
        Some(name) => name.to_string_lossy().into_owned(),
        // "." and "/" have no name of their own.
        None => "recording".to_owned(),
    };
    SceneId::new(name)
        .map_err(|error| files::file_error(path, error.to_string(), "give the file or folder another name"))
}

/// The names in a folder, sorted as people count: `2.png` before `10.png`.
pub(crate) fn sorted_entries(folder: &Path) -> Result<Vec<String>, PlatformError> {
    let wrong = |error: std::io::Error| files::file_error(folder, error.to_string(), FOLDER_HINT);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        if names.len() == MAX_ENTRIES {
            return Err(files::file_error(
                folder,
                format!("holds more than {MAX_ENTRIES} files"),
                "split it into several folders",
            ));
        }
        // A name that is not UTF-8 cannot be a file that is read here.
        names.extend(entry.map_err(wrong)?.file_name().into_string().ok());
    }
    names.sort_by(|a, b| compare_names(a, b));
    Ok(names)
}

/// Those of these files that exist and are plain files, sorted, each once.
pub(crate) fn plain_files(files: impl IntoIterator<Item = PathBuf>) -> Vec<PathBuf> {
    let mut plain: Vec<PathBuf> = files.into_iter().filter(|file| file.is_file()).collect();
    plain.sort();
    plain.dedup();
    plain
}

/// The error for a recording that is not among `known_scenes`.
pub(crate) fn unknown_scene(scene: &SceneId, known_scenes: &[SceneId]) -> PlatformError {
    let names: Vec<&str> = known_scenes.iter().map(SceneId::as_str).take(MAX_NAMED_SCENES).collect();
    let more = if known_scenes.len() > MAX_NAMED_SCENES { ", ..." } else { "" };
    let hint = format!("--data holds {}{more}", names.join(", "));
    PlatformError::UnknownScene { scene: scene.to_string(), hint }
}

/// Compares names, with numbers in them compared as numbers.
fn compare_names(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.as_bytes(), b.as_bytes());
    while let (Some((x, left_rest)), Some((y, right_rest))) = (left.split_first(), right.split_first()) {
        let order = if x.is_ascii_digit() && y.is_ascii_digit() {
            let (x, y) = (leading_number(&mut left), leading_number(&mut right));
            // Without leading zeros, the longer number is the greater one.
            x.len().cmp(&y.len()).then_with(|| x.cmp(y))
        } else {
            (left, right) = (left_rest, right_rest);
            x.cmp(y)
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

/// Removes the digits at the beginning of `text` and returns them without leading zeros.
fn leading_number<'a>(text: &mut &'a [u8]) -> &'a [u8] {
    let end = text.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    *text = rest;
    let zeros = number.iter().position(|digit| *digit != b'0').unwrap_or(number.len());
    number.get(zeros..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn compare_names_is_a_total_order(mut names in prop::collection::vec("[a0-9]{0,5}", 3)) {
            names.sort_by(|a, b| compare_names(a, b));
            prop_assert_ne!(compare_names(&names[0], &names[2]), Ordering::Greater);
            prop_assert_eq!(compare_names(&names[0], &names[1]), compare_names(&names[1], &names[0]).reverse());
        }
    }
}
