//! Reads the list of a dataset's episodes: their lengths and their files.

use super::{
    camera::{DatasetCamera, PictureStorage},
    info::{DatasetInfo, DatasetLayout},
    parquet::ParquetTable,
    template::{self, TemplateValue},
};
use crate::names::sorted_entries;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest list of episodes of version 2 that is read, bytes; a larger one is an error.
const MAX_LIST_BYTES: u64 = 512 << 20;
const META_HINT: &str = "download the dataset again, with its folder meta, or write it again with LeRobot's library";

/// One episode.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DatasetEpisode {
    pub(super) number: u64,
    /// Number of its rows.
    pub(super) length: u64,
    /// The Parquet file with its rows.
    pub(super) data: PathBuf,
    /// The stretch of a video with its pictures; `None` if the pictures are in the rows.
    pub(super) clip: Option<VideoClip>,
}

/// A stretch of a video.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct VideoClip {
    pub(super) file: PathBuf,
    /// Time at which the episode begins in the video, seconds.
    pub(super) from_s: f64,
}

/// The episodes of a dataset, by number.
///
/// # Errors
/// When their list cannot be read, or a path leads out of the dataset.
pub(super) fn read_episodes(
    root: &Path,
    info: &DatasetInfo,
    camera: &DatasetCamera,
) -> Result<Vec<DatasetEpisode>, PlatformError> {
    let mut episodes = match info.layout() {
        Some(DatasetLayout::Files) => read_episode_tables(root, info, camera)?,
        _ => read_episode_lines(root, info, camera)?,
    };
    episodes.sort_by_key(|episode| episode.number);
    if let Some([twice, _]) = episodes.array_windows::<2>().find(|[one, next]| one.number == next.number) {
        let reason = format!("episode {} is listed twice", twice.number);
        return Err(files::file_error(&root.join("meta"), reason, META_HINT));
    }
    Ok(episodes)
}

/// A line of `meta/episodes.jsonl`.
#[derive(Deserialize)]
struct EpisodeLine {
    episode_index: u64,
    length: u64,
}

/// The episodes of a dataset of version 2, from `meta/episodes.jsonl`.
fn read_episode_lines(
    root: &Path,
    info: &DatasetInfo,
    camera: &DatasetCamera,
) -> Result<Vec<DatasetEpisode>, PlatformError> {
    let file = root.join("meta").join("episodes.jsonl");
    let wrong = |reason: String| files::file_error(&file, reason, META_HINT);
    let text =
        files::text_if_there(&file, MAX_LIST_BYTES, META_HINT)?.ok_or_else(|| wrong("there is no such file".into()))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let episodes = lines.map(|(at, line)| {
        let EpisodeLine { episode_index, length } =
            serde_json::from_str(line).map_err(|error| wrong(format!("line {}: {error}", at + 1)))?;
        let values = [
            ("episode_chunk", TemplateValue::Number(episode_index / info.chunks_size)),
            ("episode_index", TemplateValue::Number(episode_index)),
            ("video_key", TemplateValue::Text(&camera.key)),
        ];
        let data = path_in_dataset(root, &info.data_path, &values)?;
        let clip = match camera.storage {
            PictureStorage::Rows => None,
            PictureStorage::Video => {
                Some(VideoClip { file: path_in_dataset(root, video_path(root, info)?, &values)?, from_s: 0.0 })
            }
        };
        Ok(DatasetEpisode { number: episode_index, length, data, clip })
    });
    episodes.collect()
}

/// The episodes of a dataset of version 3, from `meta/episodes/chunk-000/file-000.parquet` and so on.
fn read_episode_tables(
    root: &Path,
    info: &DatasetInfo,
    camera: &DatasetCamera,
) -> Result<Vec<DatasetEpisode>, PlatformError> {
    let folder = root.join("meta").join("episodes");
    let mut episodes = Vec::new();
    for chunk in sorted_entries(&folder)? {
        let chunk = folder.join(chunk);
        if !chunk.is_dir() {
            continue;
        }
        for file in sorted_entries(&chunk)?.iter().filter(|name| name.ends_with(".parquet")) {
            episodes.extend(read_episode_table(root, &chunk.join(file), info, camera)?);
        }
    }
    Ok(episodes)
}

/// The episodes that one of these tables lists, a row for each.
fn read_episode_table(
    root: &Path,
    file: &Path,
    info: &DatasetInfo,
    camera: &DatasetCamera,
) -> Result<Vec<DatasetEpisode>, PlatformError> {
    let table = ParquetTable::open(file)?;
    let whole = |name: &str| whole_numbers(&table, name);
    let (numbers, lengths) = (whole("episode_index")?, whole("length")?);
    let (chunks, file_numbers) = (whole("data/chunk_index")?, whole("data/file_index")?);
    let video_column = |name: &str| format!("videos/{}/{name}", camera.key);
    let clips = match camera.storage {
        PictureStorage::Rows => None,
        PictureStorage::Video => {
            let mut from_s = Vec::new();
            table.read_numbers(&video_column("from_timestamp"), 0..table.row_count(), &mut |row, time_s| {
                from_s.push(time_s);
                if time_s.is_finite() { Ok(()) } else { Err(format!("row {row} holds {time_s}, which is not a time")) }
            })?;
            let (chunks, file_numbers) = (whole(&video_column("chunk_index"))?, whole(&video_column("file_index"))?);
            Some(chunks.into_iter().zip(file_numbers).zip(from_s).collect::<Vec<_>>())
        }
    };
    let path = |template: &str, chunk: u64, part: u64| {
        let values = [
            ("chunk_index", TemplateValue::Number(chunk)),
            ("file_index", TemplateValue::Number(part)),
            ("video_key", TemplateValue::Text(&camera.key)),
        ];
        path_in_dataset(root, template, &values)
    };
    // Each column has a number for every row.
    let rows = numbers.into_iter().zip(lengths).zip(chunks.into_iter().zip(file_numbers)).enumerate();
    let episodes = rows.map(|(at, ((number, length), (chunk, part)))| {
        let clip = match clips.as_ref().and_then(|clips| clips.get(at)) {
            None => None,
            Some(((chunk, part), from_s)) => {
                Some(VideoClip { file: path(video_path(root, info)?, *chunk, *part)?, from_s: *from_s })
            }
        };
        Ok(DatasetEpisode { number, length, data: path(&info.data_path, chunk, part)?, clip })
    });
    episodes.collect()
}

/// A column of whole numbers that are not negative: one for each row.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "each number is checked before")]
fn whole_numbers(table: &ParquetTable, name: &str) -> Result<Vec<u64>, PlatformError> {
    let mut numbers = Vec::new();
    table.read_numbers(name, 0..table.row_count(), &mut |row, number| {
        // Up to 1e12 every whole number is exact in an f64; no dataset counts higher.
        if !(0.0..=1e12).contains(&number) || number.fract() != 0.0 {
            return Err(format!("row {row} holds {number}, which is not a count"));
        }
        numbers.push(number as u64);
        Ok(())
    })?;
    Ok(numbers)
}

/// The template of the videos' paths.
fn video_path<'a>(root: &Path, info: &'a DatasetInfo) -> Result<&'a str, PlatformError> {
    let none = || {
        files::file_error(&DatasetInfo::info_file(root), "has a camera that is a video, but no video_path", META_HINT)
    };
    info.video_path.as_deref().ok_or_else(none)
}

/// The path that a template gives, below the dataset's folder.
fn path_in_dataset(
    root: &Path,
    template: &str,
    values: &[(&str, TemplateValue<'_>)],
) -> Result<PathBuf, PlatformError> {
    let below = template::fill_template(template, values);
    Ok(root.join(below.map_err(|reason| files::file_error(&DatasetInfo::info_file(root), reason, META_HINT))?))
}
