//! LeRobot v3.0 with its columns of language.
//!
//! Source: huggingface/lerobot, `src/lerobot/datasets/language.py` (rows and their rules), `dataset_metadata.py`, `utils.py` and
//! `io_utils.py` (files and fields). Starts of a style strictly grow, and with 4 frames a second no two rows of one style are closer
//! together than a reader can tell apart.

#![allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it writes what this program made, and reads nothing from a file"
)]

use super::columns::{ColumnFile, ColumnValues, LanguageRow, NamedColumn, write_column_file};
use crate::{FormatError, output};
use serde_json::{Map, Value, json};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::AgentAction;

/// Frames of a second: a step of 0.25 m is then one of 1 m/s.
pub const LEROBOT_FPS: u32 = 4;
/// The camera's name, as LeRobot's recipes ask for it.
pub const LEROBOT_CAMERA: &str = "observation.images.front";
/// The foot of `tasks.parquet`, without which LeRobot reads numbers for texts: pandas' description of the columns.
const TASKS_PANDAS: &str = r#"{"index_columns": ["task"], "column_indexes": [{"name": null, "field_name": null, "pandas_type": "unicode", "numpy_type": "object", "metadata": {"encoding": "UTF-8"}}], "columns": [{"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": null}, {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": null}], "pandas_version": "2.2.3"}"#;

/// An episode: a walk by one text.
#[derive(Debug, Clone, PartialEq)]
pub struct LeRobotEpisode {
    /// The text.
    pub task: String,
    /// Other texts of the walk.
    pub other_texts: Vec<String>,
    /// The parts of the text, each with the frame in which it begins; the starts strictly grow from 0.
    pub parts: Vec<(String, usize)>,
    /// The action in each frame.
    pub actions: Vec<AgentAction>,
    /// Place (x, y, z, metres, z up) and yaw (radians, counter-clockwise from +x) in each frame.
    pub states: Vec<[f32; 4]>,
    /// In some frames a pixel (column, row) that shows a later place of the walk.
    pub goals: BTreeMap<usize, [u32; 2]>,
    /// The walk's name, the text's episode, and its style, which stand beside LeRobot's own columns.
    pub names: [String; 3],
    /// In which video it lies: its number.
    pub video: usize,
    /// Its first frame in that video.
    pub video_from: usize,
}

/// The colours of the videos: of each channel, from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourStatistics {
    /// How many pictures were counted.
    pub pictures: usize,
    /// How many pixels of each channel have each value of 8 bits.
    pub counts: [[u64; 256]; 3],
}

/// The file of a video, below the dataset.
#[must_use]
pub fn lerobot_video(number: usize) -> PathBuf {
    format!("videos/{LEROBOT_CAMERA}/chunk-{:03}/file-{:03}.mp4", number / 1000, number % 1000).into()
}

/// Writes everything but the videos.
///
/// # Errors
/// When a file cannot be written.
pub fn write_lerobot_dataset(
    folder: &Path,
    episodes: &[LeRobotEpisode],
    [width, height]: [u32; 2],
    colours: &ColourStatistics,
) -> Result<(), FormatError> {
    let mut task_numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut tasks: Vec<String> = Vec::new();
    for episode in episodes {
        task_numbers.entry(&episode.task).or_insert_with(|| {
            tasks.push(episode.task.clone());
            tasks.len() - 1
        });
    }
    for name in ["meta/episodes/chunk-000", "data/chunk-000"] {
        let place = folder.join(name);
        std::fs::create_dir_all(&place).map_err(|source| FormatError::from_io(&place, "make the folder", source))?;
    }
    write_rows(&folder.join("data/chunk-000/file-000.parquet"), episodes, &task_numbers)?;
    let numbers = (0..tasks.len()).map(as_i64).collect();
    let columns = [named("task_index", ColumnValues::Int64(numbers)), named("task", ColumnValues::Text(tasks.clone()))];
    write_column_file(&folder.join("meta/tasks.parquet"), &columns, &[("pandas", TASKS_PANDAS)])?;
    write_column_file(&folder.join("meta/episodes/chunk-000/file-000.parquet"), &episode_columns(episodes), &[])?;
    let frames = episodes.iter().map(|episode| episode.actions.len()).sum();
    let info = info_json(episodes.len(), frames, tasks.len(), [width, height]);
    for (name, value) in [("meta/info.json", info), ("meta/stats.json", stats_json(episodes, &task_numbers, colours))] {
        output::write_file(&folder.join(name), |out| Ok(serde_json::to_writer_pretty(out, &value)?))?;
    }
    Ok(())
}

fn named(name: &str, values: ColumnValues) -> NamedColumn {
    (name.to_owned(), values)
}

fn as_i64(number: usize) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

fn info_json(episodes: usize, frames: usize, tasks: usize, [width, height]: [u32; 2]) -> Value {
    let scalar = |kind: &str| json!({"dtype": kind, "shape": [1], "names": null});
    json!({
        "codebase_version": "v3.0",
        "robot_type": "wayword",
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": LEROBOT_FPS,
        "splits": {"train": format!("0:{episodes}")},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
        "features": {
            LEROBOT_CAMERA: {
                "dtype": "video",
                "shape": [height, width, 3],
                "names": ["height", "width", "channels"],
                "info": {
                    "video.height": height,
                    "video.width": width,
                    "video.codec": "h264",
                    "video.pix_fmt": "yuv420p",
                    "video.fps": LEROBOT_FPS,
                    "video.channels": 3,
                    "has_audio": false,
                    "is_depth_map": false,
                },
            },
            "observation.state": {"dtype": "float32", "shape": [4], "names": ["x", "y", "z", "yaw"]},
            "action": {"dtype": "int64", "shape": [1], "names": ["action"]},
            "timestamp": scalar("float32"),
            "frame_index": scalar("int64"),
            "episode_index": scalar("int64"),
            "index": scalar("int64"),
            "task_index": scalar("int64"),
            "language_persistent": scalar("language"),
            "language_events": scalar("language"),
        },
    })
}

/// The rows of all frames, one group for each episode.
fn write_rows(
    file: &Path,
    episodes: &[LeRobotEpisode],
    task_numbers: &BTreeMap<&str, usize>,
) -> Result<(), FormatError> {
    let Some(first) = episodes.first() else { return Ok(()) };
    let mut rows = ColumnFile::begin(file, &row_columns(first, [0; 3]), &[])?;
    let mut first_row = 0;
    for (number, episode) in episodes.iter().enumerate() {
        let task = task_numbers.get(episode.task.as_str()).copied().unwrap_or_default();
        rows.write_group(&row_columns(episode, [number, first_row, task]))?;
        first_row += episode.actions.len();
    }
    rows.finish()
}

fn row_columns(episode: &LeRobotEpisode, [number, first_row, task]: [usize; 3]) -> Vec<NamedColumn> {
    let count = episode.actions.len();
    let persistent = episode.persistent_rows();
    vec![
        named(
            "observation.state",
            ColumnValues::Float32List(episode.states.iter().map(|state| state.to_vec()).collect()),
        ),
        named(
            "action",
            ColumnValues::Int64(episode.actions.iter().map(|action| i64::from(u8::from(*action))).collect()),
        ),
        named("timestamp", ColumnValues::Float32((0..count).map(time_s).collect())),
        named("frame_index", ColumnValues::Int64((0..count).map(as_i64).collect())),
        named("episode_index", ColumnValues::Int64(vec![as_i64(number); count])),
        named("index", ColumnValues::Int64((first_row..first_row + count).map(as_i64).collect())),
        named("task_index", ColumnValues::Int64(vec![as_i64(task); count])),
        named("language_persistent", ColumnValues::LanguagePersistent(vec![persistent; count])),
        named(
            "language_events",
            ColumnValues::LanguageEvents((0..count).map(|frame| episode.event_rows(frame)).collect()),
        ),
    ]
}

fn time_s(frame: usize) -> f32 {
    frame as f32 / LEROBOT_FPS as f32
}

impl LeRobotEpisode {
    /// What holds from a time on: the part that is walked, the parts that are still to be walked, and other words for the whole.
    /// Sorted as LeRobot's writer does, by time, style and role.
    fn persistent_rows(&self) -> Vec<LanguageRow> {
        let row = |role, style, content: String, frame| LanguageRow {
            role,
            content,
            style,
            time_s: time_s(frame),
            camera: None,
        };
        let mut rows = Vec::new();
        for (at, (part, frame)) in self.parts.iter().enumerate() {
            let to_do =
                self.parts[at..].iter().enumerate().map(|(number, (part, _))| format!("{}. {part}", number + 1));
            rows.push(row("assistant", "plan", to_do.collect::<Vec<_>>().join("\n"), *frame));
            rows.push(row("assistant", "subtask", part.clone(), *frame));
            if at == 0 {
                let mut texts = vec![&self.task];
                for text in &self.other_texts {
                    if !texts.contains(&text) {
                        texts.push(text);
                    }
                }
                rows.extend(texts.into_iter().map(|text| row("user", "task_aug", text.clone(), *frame)));
            }
        }
        rows
    }

    /// A question about the picture of a frame with its answer, where a goal is seen.
    fn event_rows(&self, frame: usize) -> Vec<LanguageRow> {
        let Some(pixel) = self.goals.get(&frame) else { return Vec::new() };
        let answer = json!({"label": "next place of the way", "point": pixel, "point_format": "xy"}).to_string();
        let row = |role, content: String| LanguageRow {
            role,
            content,
            style: "vqa",
            time_s: time_s(frame),
            camera: Some(LEROBOT_CAMERA.to_owned()),
        };
        let question = format!("The task is: {} Where in the picture does the way go on?", self.task);
        vec![row("assistant", answer), row("user", question)]
    }
}

fn episode_columns(episodes: &[LeRobotEpisode]) -> Vec<NamedColumn> {
    let mut first_row = 0;
    let starts: Vec<usize> = episodes
        .iter()
        .map(|episode| {
            first_row += episode.actions.len();
            first_row - episode.actions.len()
        })
        .collect();
    let each = |value: &dyn Fn(usize, &LeRobotEpisode) -> usize| {
        let values = episodes.iter().enumerate().map(|(number, episode)| as_i64(value(number, episode)));
        ColumnValues::Int64(values.collect())
    };
    let seconds = |frame: &dyn Fn(&LeRobotEpisode) -> usize| {
        ColumnValues::Float64(episodes.iter().map(|episode| frame(episode) as f64 / f64::from(LEROBOT_FPS)).collect())
    };
    let texts = |at: usize| ColumnValues::Text(episodes.iter().map(|episode| episode.names[at].clone()).collect());
    let length = |episode: &LeRobotEpisode| episode.actions.len();
    let video = |field: &str| format!("videos/{LEROBOT_CAMERA}/{field}");
    vec![
        named("episode_index", each(&|number, _| number)),
        named("tasks", ColumnValues::TextList(episodes.iter().map(|episode| vec![episode.task.clone()]).collect())),
        named("length", each(&|_, episode| length(episode))),
        named("data/chunk_index", each(&|_, _| 0)),
        named("data/file_index", each(&|_, _| 0)),
        named("dataset_from_index", each(&|number, _| starts[number])),
        named("dataset_to_index", each(&|number, episode| starts[number] + length(episode))),
        (video("chunk_index"), each(&|_, episode| episode.video / 1000)),
        (video("file_index"), each(&|_, episode| episode.video % 1000)),
        (video("from_timestamp"), seconds(&|episode| episode.video_from)),
        (video("to_timestamp"), seconds(&|episode| episode.video_from + length(episode))),
        named("meta/episodes/chunk_index", each(&|_, _| 0)),
        named("meta/episodes/file_index", each(&|_, _| 0)),
        named("trajectory_id", texts(0)),
        named("episode_id", texts(1)),
        named("style", texts(2)),
    ]
}

/// The statistics that training normalises with.
fn stats_json(episodes: &[LeRobotEpisode], task_numbers: &BTreeMap<&str, usize>, colours: &ColourStatistics) -> Value {
    let mut stats = Map::new();
    let frames = || {
        episodes
            .iter()
            .enumerate()
            .flat_map(|(number, episode)| (0..episode.actions.len()).map(move |frame| (number, episode, frame)))
    };
    let scalar = |value: &dyn Fn(usize, &LeRobotEpisode, usize) -> f64| {
        statistics(&[frames().map(|(number, episode, frame)| value(number, episode, frame)).collect()])
    };
    let states: Vec<Vec<f64>> = (0..4)
        .map(|axis| frames().map(|(_, episode, frame)| f64::from(episode.states[frame][axis])).collect())
        .collect();
    stats.insert(LEROBOT_CAMERA.to_owned(), colour_statistics(colours));
    stats.insert("observation.state".to_owned(), statistics(&states));
    stats.insert("action".to_owned(), scalar(&|_, episode, frame| f64::from(u8::from(episode.actions[frame]))));
    stats.insert("timestamp".to_owned(), scalar(&|_, _, frame| f64::from(time_s(frame))));
    stats.insert("frame_index".to_owned(), scalar(&|_, _, frame| frame as f64));
    stats.insert("episode_index".to_owned(), scalar(&|number, _, _| number as f64));
    let total = frames().count();
    stats.insert("index".to_owned(), statistics(&[(0..total).map(|row| row as f64).collect()]));
    stats.insert(
        "task_index".to_owned(),
        scalar(&|_, episode, _| task_numbers.get(episode.task.as_str()).copied().unwrap_or_default() as f64),
    );
    Value::Object(stats)
}

/// The quantiles that LeRobot keeps.
const QUANTILES: [(&str, f64); 5] = [("q01", 0.01), ("q10", 0.1), ("q50", 0.5), ("q90", 0.9), ("q99", 0.99)];

/// The statistics of each axis of a feature.
fn statistics(axes: &[Vec<f64>]) -> Value {
    let sorted: Vec<Vec<f64>> = axes
        .iter()
        .map(|values| {
            let mut values = values.clone();
            values.sort_by(f64::total_cmp);
            values
        })
        .collect();
    let each = |value: &dyn Fn(&[f64]) -> f64| -> Vec<f64> { sorted.iter().map(|values| value(values)).collect() };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let spread = |values: &[f64]| {
        let middle = mean(values);
        (values.iter().map(|value| (value - middle).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
    };
    let quantile = |values: &[f64], share: f64| {
        let at = ((values.len().saturating_sub(1)) as f64 * share).round() as usize;
        values.get(at).copied().unwrap_or_default()
    };
    let mut found = json!({
        "min": each(&|values| quantile(values, 0.0)),
        "max": each(&|values| quantile(values, 1.0)),
        "mean": each(&mean),
        "std": each(&spread),
        "count": [sorted.first().map_or(0, Vec::len)],
    });
    for (name, share) in QUANTILES {
        found[name] = json!(each(&|values| quantile(values, share)));
    }
    found
}

/// The statistics of the pictures' channels, each as `[[[red]], [[green]], [[blue]]]`.
fn colour_statistics(colours: &ColourStatistics) -> Value {
    let each = |value: &dyn Fn(&[u64; 256]) -> f64| -> Vec<[[f64; 1]; 1]> {
        colours.counts.iter().map(|counts| [[value(counts) / 255.0]]).collect()
    };
    let total = |counts: &[u64; 256]| counts.iter().sum::<u64>().max(1) as f64;
    let weighted = |counts: &[u64; 256], of: &dyn Fn(f64) -> f64| {
        counts.iter().enumerate().map(|(value, count)| of(value as f64) * *count as f64).sum::<f64>() / total(counts)
    };
    let mean = |counts: &[u64; 256]| weighted(counts, &|value| value);
    let spread = |counts: &[u64; 256]| {
        let middle = mean(counts);
        weighted(counts, &|value| (value - middle).powi(2)).sqrt()
    };
    let quantile = |counts: &[u64; 256], share: f64| {
        let mut left = share * total(counts);
        let at = counts.iter().position(|count| {
            left -= *count as f64;
            *count > 0 && left <= 0.0
        });
        at.or_else(|| counts.iter().rposition(|count| *count > 0)).unwrap_or_default() as f64
    };
    let mut found = json!({
        "min": each(&|counts| quantile(counts, 0.0)),
        "max": each(&|counts| quantile(counts, 1.0)),
        "mean": each(&mean),
        "std": each(&spread),
        "count": [colours.pictures],
    });
    for (name, share) in QUANTILES {
        found[name] = json!(each(&|counts| quantile(counts, share)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episode() -> LeRobotEpisode {
        LeRobotEpisode {
            task: "Turn left and stop.".to_owned(),
            other_texts: vec!["Left, stop.".to_owned(), "Turn left and stop.".to_owned()],
            parts: vec![("Turn left".to_owned(), 0), ("stop".to_owned(), 1)],
            actions: [2, 0].map(|number| AgentAction::try_from(number).unwrap()).to_vec(),
            states: vec![[0.0; 4], [1.0; 4]],
            goals: BTreeMap::from([(0, [3, 4])]),
            names: ["a", "a-0", "r2r"].map(str::to_owned),
            video: 0,
            video_from: 0,
        }
    }

    #[test]
    fn each_frame_has_one_part_and_the_plan_shrinks() {
        let rows = episode().persistent_rows();
        let told: Vec<_> = rows.iter().map(|row| (row.time_s, row.style, row.content.as_str())).collect();
        assert_eq!(
            told,
            [
                (0.0, "plan", "1. Turn left\n2. stop"),
                (0.0, "subtask", "Turn left"),
                (0.0, "task_aug", "Turn left and stop."),
                (0.0, "task_aug", "Left, stop."),
                (0.25, "plan", "1. stop"),
                (0.25, "subtask", "stop"),
            ]
        );
        assert_eq!((episode().event_rows(0).len(), episode().event_rows(1).len()), (2, 0));
    }

    #[test]
    fn statistics_have_the_shape_that_training_reads() {
        let mut counts = [[0; 256]; 3];
        (counts[0][255], counts[1][0], counts[2][51]) = (4, 4, 4);
        let colours = colour_statistics(&ColourStatistics { pictures: 1, counts });
        assert_eq!((&colours["mean"], &colours["count"]), (&json!([[[1.0]], [[0.0]], [[0.2]]]), &json!([1])));
        let stats = statistics(&[vec![1.0, 3.0]]);
        assert_eq!((&stats["std"], &stats["q99"], &stats["min"]), (&json!([1.0]), &json!([3.0]), &json!([1.0])));
    }
}
