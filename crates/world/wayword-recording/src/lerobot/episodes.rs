//! Reads the list of a dataset's episodes: their lengths and their files.

use super::{
    camera::{Camera, Kept},
    info::{Info, Layout},
    parquet::Table,
    template::{self, Value},
};
use crate::names::entries;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use wayword_core::PlatformError;
use wayword_world::files;

const MAX_LIST_BYTES: u64 = 512 << 20;
const HINT: &str = "download the dataset again, with its folder meta, or write it again with LeRobot's library";

/// One episode.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Episode {
    pub(super) number: u64,
    /// Number of its rows.
    pub(super) length: u64,
    /// The Parquet file with its rows.
    pub(super) data: PathBuf,
    /// The stretch of a video with its pictures; `None` if the pictures are in the rows.
    pub(super) clip: Option<Clip>,
}

/// A stretch of a video.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Clip {
    pub(super) file: PathBuf,
    /// Time at which the episode begins in the video, seconds.
    pub(super) from_s: f64,
}

/// The episodes of a dataset, by number.
///
/// # Errors
/// When their list cannot be read, or a path leads out of the dataset.
pub(super) fn read(root: &Path, info: &Info, camera: &Camera) -> Result<Vec<Episode>, PlatformError> {
    let mut episodes = match info.layout() {
        Some(Layout::Files) => in_files(root, info, camera)?,
        _ => one_by_one(root, info, camera)?,
    };
    episodes.sort_by_key(|episode| episode.number);
    if let Some(pair) = episodes.windows(2).find(|pair| pair[0].number == pair[1].number) {
        return Err(files::wrong(&root.join("meta"), format!("episode {} is listed twice", pair[0].number), HINT));
    }
    Ok(episodes)
}

#[derive(Deserialize)]
struct Line {
    episode_index: u64,
    length: u64,
}

/// Version 2: `meta/episodes.jsonl`.
fn one_by_one(root: &Path, info: &Info, camera: &Camera) -> Result<Vec<Episode>, PlatformError> {
    let file = root.join("meta").join("episodes.jsonl");
    let wrong = |reason: String| files::wrong(&file, reason, HINT);
    let text =
        files::text_if_there(&file, MAX_LIST_BYTES, HINT)?.ok_or_else(|| wrong("there is no such file".into()))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let episodes = lines.map(|(at, line)| {
        let Line { episode_index, length } =
            serde_json::from_str(line).map_err(|error| wrong(format!("line {}: {error}", at + 1)))?;
        let values = [
            ("episode_chunk", Value::Number(episode_index / info.chunks_size)),
            ("episode_index", Value::Number(episode_index)),
            ("video_key", Value::Text(&camera.key)),
        ];
        let data = place(root, &info.data_path, &values)?;
        let clip = match camera.kept {
            Kept::Rows => None,
            Kept::Video => Some(Clip { file: place(root, video_path(root, info)?, &values)?, from_s: 0.0 }),
        };
        Ok(Episode { number: episode_index, length, data, clip })
    });
    episodes.collect()
}

/// Version 3: `meta/episodes/chunk-000/file-000.parquet` and so on.
fn in_files(root: &Path, info: &Info, camera: &Camera) -> Result<Vec<Episode>, PlatformError> {
    let folder = root.join("meta").join("episodes");
    let mut episodes = Vec::new();
    for chunk in entries(&folder)? {
        let chunk = folder.join(chunk);
        if !chunk.is_dir() {
            continue;
        }
        for file in entries(&chunk)?.iter().filter(|name| name.ends_with(".parquet")) {
            episodes.extend(in_file(root, &chunk.join(file), info, camera)?);
        }
    }
    Ok(episodes)
}

fn in_file(root: &Path, file: &Path, info: &Info, camera: &Camera) -> Result<Vec<Episode>, PlatformError> {
    let table = Table::open(file)?;
    let whole = |name: &str| whole_numbers(&table, name);
    let (numbers, lengths) = (whole("episode_index")?, whole("length")?);
    let (chunks, parts) = (whole("data/chunk_index")?, whole("data/file_index")?);
    let of_video = |name: &str| format!("videos/{}/{name}", camera.key);
    let clips = match camera.kept {
        Kept::Rows => None,
        Kept::Video => {
            let mut from_s = Vec::new();
            table.numbers(&of_video("from_timestamp"), 0..table.rows(), &mut |row, time_s| {
                from_s.push(time_s);
                if time_s.is_finite() { Ok(()) } else { Err(format!("row {row} holds {time_s}, which is not a time")) }
            })?;
            Some((whole(&of_video("chunk_index"))?, whole(&of_video("file_index"))?, from_s))
        }
    };
    let path = |template: &str, chunk: u64, part: u64| {
        let values = [
            ("chunk_index", Value::Number(chunk)),
            ("file_index", Value::Number(part)),
            ("video_key", Value::Text(&camera.key)),
        ];
        place(root, template, &values)
    };
    let episodes = (0..numbers.len()).map(|at| {
        let clip = match &clips {
            None => None,
            Some((chunks, parts, from_s)) => {
                Some(Clip { file: path(video_path(root, info)?, chunks[at], parts[at])?, from_s: from_s[at] })
            }
        };
        let data = path(&info.data_path, chunks[at], parts[at])?;
        Ok(Episode { number: numbers[at], length: lengths[at], data, clip })
    });
    episodes.collect()
}

/// A column of whole numbers that are not negative: one for each row.
fn whole_numbers(table: &Table, name: &str) -> Result<Vec<u64>, PlatformError> {
    let mut numbers = Vec::new();
    table.numbers(name, 0..table.rows(), &mut |row, number| {
        if !(0.0..=1e12).contains(&number) || number.fract() != 0.0 {
            return Err(format!("row {row} holds {number}, which is not a count"));
        }
        numbers.push(number as u64);
        Ok(())
    })?;
    Ok(numbers)
}

fn video_path<'a>(root: &Path, info: &'a Info) -> Result<&'a str, PlatformError> {
    let none = || files::wrong(&Info::file(root), "has a camera that is a video, but no video_path", HINT);
    info.video_path.as_deref().ok_or_else(none)
}

fn place(root: &Path, template: &str, values: &[(&str, Value<'_>)]) -> Result<PathBuf, PlatformError> {
    let below = template::fill(template, values);
    Ok(root.join(below.map_err(|reason| files::wrong(&Info::file(root), reason, HINT))?))
}
