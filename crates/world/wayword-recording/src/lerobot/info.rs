//! Reads `meta/info.json`, the description of a dataset.

use serde::Deserialize;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest `info.json` that is read, bytes; a larger one is an error.
const MAX_FILE_BYTES: u64 = 16 << 20;
const INFO_HINT: &str = "give a dataset of LeRobot, versions 2.0, 2.1 or 3.0, as its library writes it";
/// Most numbers per row of a feature that can hold poses; longer features are not looked at.
const MAX_WIDTH: u64 = 4096;

/// How a dataset's files are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DatasetLayout {
    /// Version 2: a file for each episode.
    Episodes,
    /// Version 3: many episodes in a file.
    Files,
}

/// The content of `meta/info.json`.
#[derive(Debug, Deserialize)]
pub(super) struct DatasetInfo {
    /// The version of the format: `v2.1`.
    codebase_version: String,
    /// Rows per second.
    fps: f64,
    /// Episodes per folder, in version 2.
    #[serde(default = "usual_chunk")]
    pub(super) chunks_size: u64,
    /// Templates of the paths of tables and videos (`template`).
    pub(super) data_path: String,
    #[serde(default)]
    pub(super) video_path: Option<String>,
    pub(super) features: BTreeMap<String, DatasetFeature>,
    /// Its totals of episodes and rows.
    #[serde(default)]
    total_episodes: Option<u64>,
    #[serde(default)]
    total_frames: Option<u64>,
}

/// A feature, as LeRobot calls a column of the rows or a camera.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct DatasetFeature {
    /// The type of its numbers, such as `float32`, or `video` or `image`.
    pub(super) dtype: String,
    #[serde(default)]
    shape: Vec<u64>,
    /// The names of its elements, in one of several forms ([`DatasetFeature::element_names`]).
    #[serde(default)]
    names: Value,
    /// Properties of a camera's pictures.
    #[serde(default, alias = "video_info")]
    info: Value,
}

/// Episodes per folder if `info.json` does not give the number: LeRobot's default.
fn usual_chunk() -> u64 {
    1000
}

impl DatasetInfo {
    /// The path of the file in a dataset.
    pub(super) fn info_file(root: &Path) -> PathBuf {
        root.join("meta").join("info.json")
    }

    /// Reads `meta/info.json`.
    ///
    /// # Errors
    /// When it does not exist, is not as the library writes it, or has a version that cannot be read.
    pub(super) fn read(root: &Path) -> Result<Self, PlatformError> {
        let file = Self::info_file(root);
        let wrong = |reason: String| files::file_error(&file, reason, INFO_HINT);
        let text = files::text_if_there(&file, MAX_FILE_BYTES, INFO_HINT)?
            .ok_or_else(|| wrong("there is no such file".into()))?;
        let info: Self = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        if info.chunks_size == 0 {
            return Err(wrong("chunks_size is 0".into()));
        }
        if !(1e-3..=1e4).contains(&info.fps) {
            return Err(wrong(format!("fps is {}, which is out of range (0.001 to 10000)", info.fps)));
        }
        info.layout()
            .ok_or_else(|| wrong(format!("is of version {:?}, which cannot be read", info.codebase_version)))?;
        Ok(info)
    }

    /// The layout of the dataset's files; `None` for an unknown version.
    pub(super) fn layout(&self) -> Option<DatasetLayout> {
        match self.codebase_version.strip_prefix('v')?.split('.').next()? {
            "2" => Some(DatasetLayout::Episodes),
            "3" => Some(DatasetLayout::Files),
            _ => None,
        }
    }

    /// How what `info.json` says differs from the list of episodes, for the user; `None` where it does not.
    pub(super) fn describe_other_totals(&self, episodes: u64, rows: u64) -> Option<String> {
        let differs = |said: Option<u64>, found: u64| said.filter(|said| *said != found);
        let parts = [
            differs(self.total_episodes, episodes).map(|said| format!("{said} episodes, but {episodes} are listed")),
            differs(self.total_frames, rows).map(|said| format!("{said} rows, but the listed episodes have {rows}")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| {
            format!(
                "meta/info.json says {}; a part of the dataset may be missing, so download it again",
                parts.join(", and ")
            )
        })
    }

    /// Time from one picture to the next, seconds.
    pub(super) fn step_s(&self) -> f64 {
        1.0 / self.fps
    }
}

impl DatasetFeature {
    /// Whether it holds pictures of a camera, and not depths.
    pub(super) fn is_camera(&self) -> bool {
        let depths =
            ["video.is_depth_map", "is_depth_map"].iter().any(|key| self.info.get(key) == Some(&Value::Bool(true)));
        matches!(self.dtype.as_str(), "video" | "image") && !depths
    }

    /// The width and height of a camera's pictures by `shape`, pixels; `None` if it does not have three numbers with names.
    fn picture_size(&self) -> Option<(u64, u64)> {
        let mut names = Vec::new();
        collect_texts(&self.names, &mut names);
        let side = |name: &str| {
            let at = names.iter().position(|other| *other == name)?;
            self.shape.get(at).copied()
        };
        if self.shape.len() == 3 { side("width").zip(side("height")) } else { None }
    }

    /// How the size of a camera's pictures by `shape` differs from that of its video, for the user; `None` where it does not.
    pub(super) fn describe_other_size(&self, key: &str, (width_px, height_px): (u32, u32)) -> Option<String> {
        let (width, height) = self.picture_size()?;
        let is_same = [(width, height), (height, width)].contains(&(width_px.into(), height_px.into()));
        (!is_same).then(|| {
            format!(
                "meta/info.json says that the pictures of {key} are {width} x {height}, but those of the video are {width_px} x {height_px}; \
                 the video's count"
            )
        })
    }

    /// The number of elements in a row; `None` if it is not a list of floating-point numbers.
    pub(super) fn width(&self) -> Option<usize> {
        match (self.dtype.as_str(), self.shape.as_slice()) {
            ("float32" | "float64", [width @ 1..=MAX_WIDTH]) => usize::try_from(*width).ok(),
            _ => None,
        }
    }

    /// The names of its elements, in lists or in groups (`{"motors": ["x", "y"]}`); `None` if an element has no name.
    pub(super) fn element_names(&self) -> Option<Vec<&str>> {
        let mut names = Vec::new();
        collect_texts(&self.names, &mut names);
        (self.width() == Some(names.len())).then_some(names)
    }
}

/// Collects all texts in a value, in order.
fn collect_texts<'a>(value: &'a Value, into: &mut Vec<&'a str>) {
    match value {
        Value::String(name) => into.push(name),
        Value::Array(values) => values.iter().for_each(|value| collect_texts(value, into)),
        Value::Object(groups) => groups.iter().for_each(|(key, value)| {
            // Some datasets number their names: {"x": 0, "y": 1}.
            if value.as_u64() == Some(into.len() as u64) { into.push(key) } else { collect_texts(value, into) }
        }),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(json: &str) -> DatasetFeature {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn names_are_found_in_lists_and_groups() {
        let list = feature(r#"{"dtype": "float32", "shape": [2], "names": ["x", "y"]}"#);
        assert_eq!(list.element_names(), Some(vec!["x", "y"]));
        let grouped = feature(r#"{"dtype": "float32", "shape": [3], "names": {"b": ["x", "y"], "a": ["yaw"]}}"#);
        assert_eq!(grouped.element_names(), Some(vec!["x", "y", "yaw"]));
        let numbered = feature(r#"{"dtype": "float32", "shape": [2], "names": {"x": 0, "y": 1}}"#);
        assert_eq!(numbered.element_names(), Some(vec!["x", "y"]));
        for unnamed in [r#"null"#, r#"["state"]"#] {
            let json = format!(r#"{{"dtype": "float32", "shape": [2], "names": {unnamed}}}"#);
            assert_eq!(feature(&json).element_names(), None);
        }
    }

    #[test]
    fn depths_are_no_camera() {
        assert!(
            feature(r#"{"dtype": "video", "shape": [4, 4, 3], "info": {"video.is_depth_map": false}}"#).is_camera()
        );
        assert!(!feature(r#"{"dtype": "video", "video_info": {"video.is_depth_map": true}}"#).is_camera());
        assert!(!feature(r#"{"dtype": "float32", "shape": [1]}"#).is_camera());
    }

    #[test]
    fn other_versions_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let read = |version: &str| {
            std::fs::create_dir_all(folder.path().join("meta")).unwrap();
            let text = format!(r#"{{"codebase_version": "{version}", "fps": 5, "data_path": "x", "features": {{}}}}"#);
            std::fs::write(DatasetInfo::info_file(folder.path()), text).unwrap();
            DatasetInfo::read(folder.path()).map(|info| info.layout().unwrap()).map_err(|error| error.to_string())
        };
        assert_eq!((read("v2.1"), read("v3.0")), (Ok(DatasetLayout::Episodes), Ok(DatasetLayout::Files)));
        assert!(read("v1.6").unwrap_err().contains("\"v1.6\""));
    }
}
