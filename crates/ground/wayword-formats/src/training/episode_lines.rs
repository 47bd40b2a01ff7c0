//! The list of episodes of a LeRobot dataset of version 2, `meta/episodes.jsonl`, with InternNav's way to put several texts into one.

use super::put_back::{TextsOfWalk, TextsPutBack};
use crate::{DatasetItem, Episode, FormatError, input, output};
use serde_json::{Map, Value};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use wayword_core::SceneId;

/// What stands between the texts of a walk.
pub const INSTRUCTION_SEPARATOR: &str = "<INSTRUCTION_SEP>";
/// Episodes in one folder of files.
pub const EPISODES_PER_CHUNK: usize = 1000;

/// A line of a scene's `meta/episodes.jsonl`.
#[derive(Debug, Clone, PartialEq)]
pub struct InternNavLine {
    /// The episode's number.
    pub index: usize,
    /// Its texts.
    pub texts: Vec<String>,
    /// Its other tasks, which InternNav does not read.
    pub other_tasks: Vec<String>,
    /// How many pictures it has.
    pub length: usize,
    /// Fields that the layout does not name.
    pub extra: Map<String, Value>,
}

/// Reads a scene's `meta/episodes.jsonl`.
///
/// # Errors
/// When the file cannot be read, or a line breaks a rule of the layout; the error names line and field.
pub fn read_internnav_lines(file: &Path) -> Result<Vec<InternNavLine>, FormatError> {
    let (mut lines, mut numbers) = (Vec::new(), BTreeSet::new());
    input::each_line(file, |mut item| {
        let line = take_line(&mut item)?;
        if !numbers.insert(line.index) {
            let problem = format!("{} was given to an earlier line", line.index);
            return Err(item.wrong_field("episode_index", problem, "give each episode its own number"));
        }
        lines.push(InternNavLine { extra: item.into_rest(), ..line });
        Ok(())
    })?;
    Ok(lines)
}

fn take_line(item: &mut DatasetItem<'_>) -> Result<InternNavLine, FormatError> {
    let index = item.take_field("episode_index")?;
    item.set_id(&item.checked_name("episode_index", &index)?);
    let index: usize = item.parse_value("episode_index", index)?;
    let tasks = item.take_field("tasks")?;
    let mut other_tasks = item.checked_instructions("tasks", &tasks)?;
    if other_tasks.is_empty() {
        return Err(item.wrong_field("tasks", "it is empty", "the loader takes its first text"));
    }
    let texts = other_tasks.remove(0).split(INSTRUCTION_SEPARATOR).map(str::to_owned).collect();
    let length = item.take_field("length")?;
    let length: usize = item.parse_value("length", length)?;
    Ok(InternNavLine { index, texts, other_tasks, length, extra: Map::new() })
}

/// Writes the lines of `file` again with other texts, by the name of the episode's recording. Episodes without a text are left out. Returns
/// what was put back.
///
/// # Errors
/// When `file` cannot be read, or `out` cannot be written.
pub fn write_internnav_texts(file: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError> {
    let folder = dataset_folder(file)?;
    let (mut lines, mut count) = (Vec::new(), TextsPutBack::default());
    for line in read_internnav_lines(file)? {
        let texts = texts(&internnav_scene_name(&folder, line.index));
        if !count.take_walk(texts.len()) {
            continue;
        }
        let tasks: Vec<String> = std::iter::once(texts.join(INSTRUCTION_SEPARATOR)).chain(line.other_tasks).collect();
        let mut fields = Map::new();
        fields.insert("episode_index".to_owned(), line.index.into());
        fields.insert("tasks".to_owned(), tasks.into());
        fields.insert("length".to_owned(), line.length.into());
        fields.extend(line.extra);
        lines.push(fields);
    }
    output::write_file(out, |writer| output::write_lines(writer, &lines))?;
    Ok(count)
}

/// The name under which an episode of a scene's folder is a recording.
#[must_use]
pub fn internnav_scene_name(folder: &Path, index: usize) -> String {
    // "." has a name too.
    let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
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
