//! The list of episodes of a LeRobot dataset of version 2, `meta/episodes.jsonl`, with InternNav's way to put several texts into one.

use crate::{DatasetItem, Episode, FormatError, input, output};
use serde_json::json;
use std::path::{Path, PathBuf};
use wayword_core::SceneId;

/// What stands between the texts of a walk.
pub const INSTRUCTION_SEPARATOR: &str = "<INSTRUCTION_SEP>";

/// A line of a scene's `meta/episodes.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InternNavLine {
    /// The episode's number.
    pub index: usize,
    /// Its texts.
    pub texts: Vec<String>,
    /// How many pictures it has.
    pub length: usize,
}

/// Reads a scene's `meta/episodes.jsonl`.
///
/// # Errors
/// When the file cannot be read, or a line breaks a rule of the layout; the error names line and field.
pub fn read_internnav_lines(file: &Path) -> Result<Vec<InternNavLine>, FormatError> {
    let mut lines = Vec::new();
    input::each_line(file, |mut item| {
        lines.push(take_line(&mut item)?);
        Ok(())
    })?;
    Ok(lines)
}

fn take_line(item: &mut DatasetItem<'_>) -> Result<InternNavLine, FormatError> {
    let index = item.take_field("episode_index")?;
    item.set_id(&item.checked_name("episode_index", &index)?);
    let index: usize = item.parse_value("episode_index", index)?;
    let tasks = item.take_field("tasks")?;
    let texts = match item.checked_instructions("tasks", &tasks)?.first() {
        Some(joined) => joined.split(INSTRUCTION_SEPARATOR).map(str::to_owned).collect(),
        None => return Err(item.wrong_field("tasks", "it is empty", "the loader takes its first text")),
    };
    let length = item.take_field("length")?;
    let length: usize = item.parse_value("length", length)?;
    Ok(InternNavLine { index, texts, length })
}

/// Writes the lines of `file` again with other texts, by the name of the episode's recording. Episodes without a text are left out.
///
/// # Errors
/// When `file` cannot be read, or `out` cannot be written.
pub fn write_internnav_texts(file: &Path, out: &Path, texts: impl Fn(&str) -> Vec<String>) -> Result<(), FormatError> {
    let folder = dataset_folder(file)?;
    let lines = read_internnav_lines(file)?.into_iter().filter_map(|line| {
        let texts = texts(&internnav_scene_name(&folder, line.index));
        (!texts.is_empty()).then(|| {
            json!({"episode_index": line.index, "tasks": [texts.join(INSTRUCTION_SEPARATOR)], "length": line.length})
        })
    });
    output::write_file(out, |writer| output::write_lines(writer, lines))
}

/// The name under which an episode of a scene's folder is a recording.
#[must_use]
pub fn internnav_scene_name(folder: &Path, index: usize) -> String {
    format!("{}_{index:06}", folder.file_name().unwrap_or_default().to_string_lossy())
}

/// Reads a scene's `meta/episodes.jsonl` as episodes of recordings.
///
/// # Errors
/// As [`read_internnav_lines`]; when the folder's name is no name of a scene.
pub fn read_internnav_episodes(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let folder = dataset_folder(file)?;
    let episode = |line: InternNavLine| {
        let name = internnav_scene_name(&folder, line.index);
        let scene = SceneId::new(name.as_str()).map_err(|error| {
            FormatError::for_document(file, format!("folder {name:?}: {error}"), "give the folder another name")
        })?;
        Ok(Episode::for_recording(scene, line.texts))
    };
    read_internnav_lines(file)?.into_iter().map(episode).collect()
}

/// The folder of a dataset, in which `meta/episodes.jsonl` lies.
fn dataset_folder(file: &Path) -> Result<PathBuf, FormatError> {
    let file = std::path::absolute(file).map_err(|source| FormatError::from_io(file, "find", source))?;
    Ok(file.parent().and_then(Path::parent).unwrap_or(&file).to_owned())
}
