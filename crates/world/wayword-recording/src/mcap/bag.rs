//! Finds the files of a rosbag2 recording: a folder with `metadata.yaml`, which lists one or several MCAP files in their order.

use crate::names::sorted_entries;
use std::path::{Component, Path, PathBuf};
use wayword_core::PlatformError;
use wayword_world::files;

/// The name of a bag's description in its folder.
pub(super) const METADATA_FILE: &str = "metadata.yaml";
/// Largest description that is read, bytes; a larger one is an error.
const MAX_FILE_BYTES: u64 = 64 << 20;
/// Most files of a recording; more are an error.
const MAX_FILES: usize = 10_000;
const METADATA_HINT: &str =
    "`ros2 bag reindex FOLDER` writes metadata.yaml again; or give the path of a single .mcap file";
const MISSING_HINT: &str = "copy the file to the others; if it is lost, take its line out of metadata.yaml: then no path leads \
                            over its time";
const UNLISTED_HINT: &str = "if it belongs to them, `ros2 bag reindex FOLDER` lists it; else move it to another folder";

/// The MCAP files of a recording in their order; `None` if the folder has no `metadata.yaml` of rosbag2 that lists MCAP files,
/// or if this says nothing about the files in the folder.
///
/// # Errors
/// When `metadata.yaml` cannot be read, or some of the recording's files are not there or not listed.
pub(crate) fn find_bag_files(folder: &Path) -> Result<Option<Vec<PathBuf>>, PlatformError> {
    let file = folder.join(METADATA_FILE);
    let Some(text) = files::text_if_there(&file, MAX_FILE_BYTES, METADATA_HINT)? else { return Ok(None) };
    let names = listed_files(&text);
    if !text.contains("rosbag2_bagfile_information") || !names.iter().any(|name| is_mcap(name)) {
        return Ok(None);
    }
    let wrong = |reason: String, hint| files::file_error(&file, reason, hint);
    if names.len() > MAX_FILES {
        return Err(wrong(format!("lists {} files, but at most {MAX_FILES} are read", names.len()), METADATA_HINT));
    }
    let found: Vec<Option<PathBuf>> = names.iter().map(|name| find_listed(folder, name)).collect();
    let there: Vec<PathBuf> = found.iter().flatten().cloned().collect();
    let present = sorted_entries(folder)?.into_iter().filter(|name| !name.starts_with('.') && is_mcap(name));
    let unlisted = present.filter(|name| !is_packed(name)).find(|name| !there.contains(&folder.join(name)));
    let packed = names.iter().zip(&found).find(|(name, found)| found.is_none() && folder.join(name).is_file());
    if let Some((name, _)) = packed {
        let reason = format!("lists {name}, which is compressed as a whole");
        return Err(wrong(reason, "unpack its files: `zstd -d *.zstd` in this folder"));
    }
    // A file that got another name, or that lies among others, is a recording of its own.
    if there.is_empty() || (names.len() == 1 && unlisted.is_some()) {
        return Ok(None);
    }
    if let Some((name, _)) = names.iter().zip(&found).find(|(_, found)| found.is_none()) {
        let reason = format!("lists {name}, which is not there; it is one of {} files of this recording", names.len());
        return Err(wrong(reason, MISSING_HINT));
    }
    match unlisted {
        Some(name) => {
            Err(wrong(format!("does not list {name}, which lies beside the recording's files"), UNLISTED_HINT))
        }
        None => Ok(Some(there)),
    }
}

/// The path of a file that a bag lists, unpacked; `None` if it is not there.
fn find_listed(folder: &Path, name: &str) -> Option<PathBuf> {
    let is_within = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    let plain = if is_packed(name) { Path::new(name).with_extension("") } else { PathBuf::from(name) };
    // Old bags have the folder's own name before that of the file.
    let paths = [folder.join(&plain), folder.join(plain.file_name()?)];
    paths.into_iter().find(|path| is_within && path.is_file())
}

fn is_mcap(name: &str) -> bool {
    let plain = if is_packed(name) { Path::new(name).with_extension("") } else { PathBuf::from(name) };
    plain.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
}

/// Whether a file is compressed as a whole, as rosbag2 does with `--compression-mode file`.
fn is_packed(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "zstd" || ending == "zst")
}

/// The names under `relative_file_paths`: a YAML list of texts, one a line or in brackets.
fn listed_files(text: &str) -> Vec<String> {
    let plain = |name: &str| name.trim().trim_matches(['"', '\'']).to_owned();
    let mut lines = text.lines().skip_while(|line| !line.trim_start().starts_with("relative_file_paths:"));
    let first = lines.next().and_then(|line| line.split_once(':')).map_or("", |(_, rest)| rest.trim());
    if let Some(within) = first.strip_prefix('[') {
        let rest: String = lines.map_while(|line| (!within.contains(']')).then_some(line)).collect();
        let list = format!("{within}{rest}");
        let list = list.split(']').next().unwrap_or_default();
        return list.split(',').map(plain).filter(|name| !name.is_empty()).collect();
    }
    let item = |line: &str| line.trim().strip_prefix('-').map(plain);
    lines.filter(|line| !line.trim().is_empty()).map_while(item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bag(metadata: &str, present: &[&str]) -> Result<Option<Vec<String>>, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(METADATA_FILE), metadata).unwrap();
        for name in present {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let names = |files: Vec<PathBuf>| {
            files.iter().map(|file| file.file_name().unwrap().to_string_lossy().into_owned()).collect()
        };
        find_bag_files(folder.path()).map(|files| files.map(names)).map_err(|error| error.to_string())
    }

    fn metadata(list: &str) -> String {
        format!(
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 5\n  \
             relative_file_paths:{list}\n  compression_format: \"\"\n  files:\n    - path: other.mcap\n"
        )
    }

    #[test]
    fn files_are_listed_in_their_order_in_every_form_of_yaml() {
        let present = ["walk_0.mcap", "walk_1.mcap"];
        for list in [
            "\n    - walk_1.mcap\n    - walk_0.mcap",
            "\n  - \"walk_1.mcap\"\n\n  - 'walk_0.mcap'",
            " [walk_1.mcap, \"walk_0.mcap\"]",
            " [walk_1.mcap,\n    walk_0.mcap]",
            "\n    - walk/walk_1.mcap\n    - walk/walk_0.mcap",
        ] {
            assert_eq!(bag(&metadata(list), &present).unwrap().unwrap(), ["walk_1.mcap", "walk_0.mcap"], "{list}");
        }
    }

    #[test]
    fn other_folders_are_no_bag() {
        assert_eq!(bag("name: model\nrelative_file_paths:\n  - a.mcap\n", &["a.mcap"]), Ok(None));
        assert_eq!(bag(&metadata("\n    - a_0.db3"), &["a_0.db3"]), Ok(None));
        assert_eq!(bag(&metadata(" []"), &[]), Ok(None));
        assert_eq!(bag("", &[]), Ok(None));
    }

    #[test]
    fn missing_packed_and_outer_files_are_told() {
        let two = metadata("\n    - a_0.mcap\n    - a_1.mcap");
        let error = bag(&two, &["a_1.mcap"]).unwrap_err();
        assert!(error.contains("lists a_0.mcap, which is not there; it is one of 2 files"), "{error}");
        let error = bag(&two, &["a_0.mcap", "a_1.mcap", "b.mcap"]).unwrap_err();
        assert!(error.contains("does not list b.mcap") && error.contains("reindex"), "{error}");
        let error = bag(&metadata("\n    - a_0.mcap.zstd"), &["a_0.mcap.zstd"]).unwrap_err();
        assert!(error.contains("compressed as a whole") && error.contains("zstd -d"), "{error}");
        let unpacked = bag(&metadata("\n    - a_0.mcap.zstd"), &["a_0.mcap.zstd", "a_0.mcap"]);
        assert_eq!(unpacked.unwrap().unwrap(), ["a_0.mcap"]);
        let outer = bag(&metadata("\n    - ../a_0.mcap\n    - a_1.mcap"), &["a_0.mcap", "a_1.mcap"]);
        assert!(outer.unwrap_err().contains("../a_0.mcap, which is not there"));
    }

    #[test]
    fn files_that_the_list_does_not_know_stay_recordings_of_their_own() {
        assert_eq!(bag(&metadata("\n    - a_0.mcap"), &["renamed.mcap"]), Ok(None));
        assert_eq!(bag(&metadata("\n    - a_0.mcap"), &["a_0.mcap", "other.mcap"]), Ok(None));
        assert_eq!(bag(&metadata("\n    - a_0.mcap"), &["a_0.mcap"]).unwrap().unwrap(), ["a_0.mcap"]);
    }
}
