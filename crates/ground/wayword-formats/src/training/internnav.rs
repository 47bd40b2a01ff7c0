//! InternNav's two layouts, both of LeRobot v2.1: VLN-CE walks with pixel goals (`internnav`), and InternData's VLN-N1 (`internnav-n1`).
//!
//! Source: InternRobotics/InternNav, `internnav/dataset/internvla_n1_lerobot_dataset.py` and `navdp_lerobot_dataset.py`. In both a
//! folder is a scene, and an episode has a Parquet file with a row for each picture.

#![allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it writes what this program made, and reads nothing from a file"
)]

use super::{
    columns::{ColumnValues, NamedColumn, write_column_file},
    episode_lines::{EPISODES_PER_CHUNK, INSTRUCTION_SEPARATOR},
};
use crate::{FormatError, output};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use wayword_core::{AgentAction, DMat4, DVec3};

/// The first action of an episode, which the loader skips.
const DUMMY_ACTION: i32 = -1;
/// Pictures each second, which nobody reads.
const FPS: f32 = 30.0;
/// The file of a scene's episodes, below its folder.
const EPISODES_FILE: &str = "meta/episodes.jsonl";

/// A walk of `internnav`.
#[derive(Debug, Clone, PartialEq)]
pub struct InternNavEpisode {
    /// Its number in its scene, from 0.
    pub index: usize,
    /// Its texts.
    pub texts: Vec<String>,
    /// Its actions; the last is a stop. There are as many pictures.
    pub actions: Vec<AgentAction>,
    /// What is known of each camera.
    pub cameras: Vec<InternNavCamera>,
}

/// A camera's poses and goals along a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct InternNavCamera {
    /// Its name: `125cm_30deg`.
    pub name: String,
    /// Before each action, the pose that takes the camera's points (x right, y down, z ahead, metres) into a world with z up.
    pub world_from_camera: Vec<DMat4>,
    /// For each picture a later place of the walk that it shows: column, row, and how many pictures later the agent is there.
    pub goals: Vec<Option<([u32; 2], usize)>>,
}

/// The pictures of an episode: colours of a camera, or depths.
#[must_use]
pub fn internnav_picture(index: usize, kind: &str, camera: &str, number: usize, ending: &str) -> PathBuf {
    let chunk = chunk_folder(index);
    format!("videos/{chunk}/observation.images.{kind}.{camera}/episode_{index:06}_{number}.{ending}").into()
}

fn chunk_folder(index: usize) -> String {
    format!("chunk-{:03}", index / EPISODES_PER_CHUNK)
}

fn data_file(folder: &Path, index: usize) -> PathBuf {
    folder.join(format!("data/{}/episode_{index:06}.parquet", chunk_folder(index)))
}

/// Writes the episodes of a scene's folder, without their pictures.
///
/// # Errors
/// When a file cannot be written.
pub fn write_internnav_scene(folder: &Path, episodes: &[InternNavEpisode]) -> Result<(), FormatError> {
    let joined = |episode: &InternNavEpisode| episode.texts.join(INSTRUCTION_SEPARATOR);
    let line = |episode: &InternNavEpisode| json!({"episode_index": episode.index, "tasks": [joined(episode)], "length": episode.actions.len()});
    write_json_lines(&folder.join(EPISODES_FILE), episodes.iter().map(line))?;
    let task = |episode: &InternNavEpisode| json!({"task_index": episode.index, "task": joined(episode)});
    write_json_lines(&folder.join("meta/tasks.jsonl"), episodes.iter().map(task))?;
    let mut first_row = 0;
    for episode in episodes {
        let file = data_file(folder, episode.index);
        make_folder_of(&file)?;
        write_column_file(&file, &episode_columns(episode, first_row), &[])?;
        first_row += episode.actions.len();
    }
    let cameras = episodes.first().map_or(&[][..], |episode| episode.cameras.as_slice());
    let mut features = json!({"action": {"dtype": "int32", "shape": [1], "names": null}});
    for camera in cameras {
        for (feature, kind, shape) in [
            ("pose", "float32", json!([4, 4])),
            ("goal", "int32", json!([2])),
            ("relative_goal_frame_id", "int32", json!([1])),
        ] {
            features[format!("{feature}.{}", camera.name)] = json!({"dtype": kind, "shape": shape, "names": null});
        }
    }
    write_info(folder, &features, [episodes.len(), first_row, episodes.len()], EPISODES_PER_CHUNK)
}

fn episode_columns(episode: &InternNavEpisode, first_row: usize) -> Vec<NamedColumn> {
    let count = episode.actions.len();
    let moves = episode.actions.iter().filter(|action| **action != AgentAction::Stop);
    let actions = std::iter::once(DUMMY_ACTION).chain(moves.map(|action| i32::from(u8::from(*action))));
    let named = |name: &str, values| (name.to_owned(), values);
    let mut columns = vec![named("action", ColumnValues::Int32(actions.collect()))];
    for camera in &episode.cameras {
        let goal = |goal: &Option<([u32; 2], usize)>| match goal {
            Some((pixel, _)) => pixel.map(u32::cast_signed).to_vec(),
            None => vec![-1, -1],
        };
        let ahead = |goal: &Option<([u32; 2], usize)>| goal.map_or(-1, |(_, ahead)| i32::try_from(ahead).unwrap_or(-1));
        let poses = camera.world_from_camera.iter().map(|pose| matrix_rows(*pose)).collect();
        columns.extend([
            named(&format!("pose.{}", camera.name), ColumnValues::Float32Matrix(poses)),
            named(&format!("goal.{}", camera.name), ColumnValues::Int32List(camera.goals.iter().map(goal).collect())),
            named(
                &format!("relative_goal_frame_id.{}", camera.name),
                ColumnValues::Int32(camera.goals.iter().map(ahead).collect()),
            ),
        ]);
    }
    let index = |value: usize| i64::try_from(value).unwrap_or(i64::MAX);
    columns.extend([
        named("timestamp", ColumnValues::Float32((0..count).map(|row| row as f32 / FPS).collect())),
        named("frame_index", ColumnValues::Int64((0..count).map(index).collect())),
        named("episode_index", ColumnValues::Int64(vec![index(episode.index); count])),
        named("index", ColumnValues::Int64((first_row..first_row + count).map(index).collect())),
        named("task_index", ColumnValues::Int64(vec![index(episode.index); count])),
    ]);
    columns
}

fn matrix_rows(pose: DMat4) -> Vec<Vec<f32>> {
    pose.transpose().to_cols_array_2d().iter().map(|row| row.iter().map(|part| *part as f32).collect()).collect()
}

fn write_info(
    folder: &Path,
    features: &Value,
    [episodes, frames, tasks]: [usize; 3],
    chunk: usize,
) -> Result<(), FormatError> {
    let info = json!({
        "codebase_version": "v2.1",
        "robot_type": "unknown",
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": tasks,
        "total_videos": 0,
        "total_chunks": episodes.div_ceil(chunk),
        "chunks_size": chunk,
        "fps": FPS as u32,
        "splits": {"train": format!("0:{episodes}")},
        "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "features": features,
    });
    let file = folder.join("meta/info.json");
    make_folder_of(&file)?;
    output::write_file(&file, |out| Ok(serde_json::to_writer_pretty(out, &info)?))
}

fn write_json_lines<T: Serialize>(file: &Path, lines: impl IntoIterator<Item = T>) -> Result<(), FormatError> {
    make_folder_of(file)?;
    output::write_file(file, |out| output::write_lines(out, lines))
}

fn make_folder_of(file: &Path) -> Result<(), FormatError> {
    let folder = file.parent().unwrap_or(file);
    std::fs::create_dir_all(folder).map_err(|source| FormatError::from_io(folder, "make the folder", source))
}

/// A walk of `internnav-n1` by one text.
#[derive(Debug, Clone, PartialEq)]
pub struct VlnN1Episode {
    /// Its number in its scene, from 0.
    pub index: usize,
    /// Its text.
    pub text: String,
    /// The parts of the text, each with its first and last picture.
    pub parts: Vec<(String, [usize; 2])>,
    /// Before each action, the pose that takes the camera's points (x right, y down, z ahead, metres) into a world with z up.
    pub world_from_camera: Vec<DMat4>,
    /// Focal length and principal point, pixels.
    pub focal_px: f64,
    /// The principal point.
    pub centre_px: [f64; 2],
    /// The camera's height over the agent's place, metres, and its pitch, radians (negative looks down).
    pub height_m: f64,
    /// The camera's pitch, radians; negative looks down.
    pub pitch_rad: f64,
}

/// A depth picture of VLN-N1 counts tenths of millimetres.
pub const VLN_N1_DEPTH_PER_M: f64 = 10_000.0;

/// The pictures of an episode: `rgb` or `depth`.
#[must_use]
pub fn vln_n1_picture(index: usize, kind: &str, number: usize, digits: usize, ending: &str) -> PathBuf {
    format!("videos/chunk-000/observation.images.{kind}/episode_{index:06}_{number:0digits$}.{ending}").into()
}

/// Writes the episodes of a scene's folder, without their pictures. `obstacles` are places in the way, in the world of the poses.
///
/// # Errors
/// When a file cannot be written.
pub fn write_vln_n1_scene(folder: &Path, episodes: &[VlnN1Episode], obstacles: &[DVec3]) -> Result<(), FormatError> {
    let (mut lines, mut stats, mut tasks) = (Vec::new(), Vec::new(), Vec::new());
    let mut first_row = 0;
    for episode in episodes {
        let count = episode.world_from_camera.len();
        // A task is JSON in a text. First each part, then the whole.
        let part = |(text, indexes): &(String, [usize; 2])| json!({"sub_instruction": text, "sub_indexes": indexes, "revised_sub_instruction": as_sentence(text)});
        let whole = json!({"sum_instruction": episode.text, "sum_indexes": [0, count.saturating_sub(1)]});
        let own: Vec<String> = episode.parts.iter().map(part).chain([whole]).map(|task| task.to_string()).collect();
        stats.push(json!({
            "episode_index": episode.index,
            "task_index": {"min": tasks.len(), "max": tasks.len() + own.len() - 1, "count": own.len()},
            "image_index": {"min": first_row, "max": first_row + count - 1, "count": count},
        }));
        lines.push(json!({"episode_index": episode.index, "tasks": own, "length": count}));
        tasks.extend(own);
        let file = folder.join(format!("data/chunk-000/episode_{:06}.parquet", episode.index));
        make_folder_of(&file)?;
        write_column_file(&file, &vln_n1_columns(episode, first_row), &[])?;
        first_row += count;
    }
    write_json_lines(&folder.join(EPISODES_FILE), lines)?;
    write_json_lines(&folder.join("meta/episodes_stats.jsonl"), stats)?;
    let task_line = |(index, task): (usize, &String)| json!({"task_index": index, "task": task});
    write_json_lines(&folder.join("meta/tasks.jsonl"), tasks.iter().enumerate().map(task_line))?;
    write_obstacles(&folder.join("meta/pointcloud.ply"), obstacles)?;
    let matrix = |side: usize| json!({"dtype": "float32", "shape": [side, side]});
    let features = json!({
        "observation.camera_intrinsic": matrix(3),
        "observation.camera_extrinsic": matrix(4),
        "action": matrix(4),
    });
    // Whatever their number, all episodes lie in one folder of files.
    write_info(folder, &features, [episodes.len(), first_row, tasks.len()], episodes.len().max(EPISODES_PER_CHUNK))
}

/// A part of a text as a sentence of its own.
fn as_sentence(text: &str) -> String {
    let mut letters = text.chars();
    let capital: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    if capital.ends_with(['.', '!', '?']) { capital } else { capital + "." }
}

fn vln_n1_columns(episode: &VlnN1Episode, first_row: usize) -> Vec<NamedColumn> {
    let count = episode.world_from_camera.len();
    let [cx, cy] = episode.centre_px.map(|part| part as f32);
    let focal = episode.focal_px as f32;
    let intrinsic = vec![vec![focal, 0.0, cx], vec![0.0, focal, cy], vec![0.0, 0.0, 1.0]];
    // The body's axes are x right, y ahead, z up, and the camera's (of OpenGL) x right, y up, z back.
    let (sin, cos) = libm::sincos(episode.pitch_rad);
    let body_from_camera = DMat4::from_cols(
        DVec3::X.extend(0.0),
        DVec3::new(0.0, -sin, cos).extend(0.0),
        DVec3::new(0.0, -cos, -sin).extend(0.0),
        DVec3::new(0.0, 0.0, episode.height_m).extend(1.0),
    );
    let gl_from_optical = DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0));
    let poses = episode.world_from_camera.iter().map(|pose| matrix_rows(*pose * gl_from_optical));
    let index = |value: usize| i64::try_from(value).unwrap_or(i64::MAX);
    let named = |name: &str, values| (name.to_owned(), values);
    vec![
        named("index", ColumnValues::Int64((first_row..first_row + count).map(index).collect())),
        named("observation.camera_intrinsic", ColumnValues::Float32Matrix(vec![intrinsic; count])),
        named("observation.camera_extrinsic", ColumnValues::Float32Matrix(vec![matrix_rows(body_from_camera); count])),
        named("action", ColumnValues::Float32Matrix(poses.collect())),
    ]
}

/// Writes the places in the way as points of the colour that the loader looks for.
fn write_obstacles(file: &Path, obstacles: &[DVec3]) -> Result<(), FormatError> {
    make_folder_of(file)?;
    output::write_file(file, |out| {
        let head = "ply\nformat binary_little_endian 1.0\nelement vertex";
        let fields = ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"];
        let fields: String = fields.iter().map(|field| format!("property {field}\n")).collect();
        out.write_all(format!("{head} {}\n{fields}end_header\n", obstacles.len()).as_bytes())?;
        for place in obstacles {
            place.to_array().iter().try_for_each(|part| out.write_all(&(*part as f32).to_le_bytes()))?;
            out.write_all(&[0, 0, 128])?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::training::episode_lines::{
        InternNavLine, read_internnav_episodes, read_internnav_lines, write_internnav_texts,
    };

    fn episode() -> InternNavEpisode {
        let camera = InternNavCamera {
            name: "125cm_30deg".to_owned(),
            world_from_camera: vec![DMat4::IDENTITY; 3],
            goals: vec![Some(([12, 200], 2)), None, None],
        };
        InternNavEpisode {
            index: 0,
            texts: vec!["Turn left.".to_owned(), "Go.".to_owned()],
            actions: [2, 1, 0].map(|number| AgentAction::try_from(number).unwrap()).to_vec(),
            cameras: vec![camera],
        }
    }

    #[test]
    fn texts_come_back_and_new_ones_take_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("house2-1");
        write_internnav_scene(&scene, &[episode()]).unwrap();
        let file = scene.join(EPISODES_FILE);
        let lines = read_internnav_lines(&file).unwrap();
        let expected = InternNavLine {
            index: 0,
            texts: episode().texts,
            other_tasks: Vec::new(),
            length: 3,
            extra: serde_json::Map::new(),
        };
        assert_eq!(lines, [expected]);
        let episodes = read_internnav_episodes(&file).unwrap();
        assert_eq!((episodes[0].scene.as_str(), episodes[0].instructions.len()), ("house2-1_000000", 2));
        let again = scene.join("meta/again.jsonl");
        let put = write_internnav_texts(&file, &again, &|_| episode().texts).unwrap();
        assert_eq!((put.walks, put.texts, put.left_out), (1, 2, 0));
        assert_eq!(std::fs::read(&again).unwrap(), std::fs::read(&file).unwrap());
        assert_eq!(
            internnav_picture(1000, "rgb", "125cm_0deg", 7, "jpg").display().to_string(),
            "videos/chunk-001/observation.images.rgb.125cm_0deg/episode_001000_7.jpg"
        );
    }

    #[test]
    fn a_level_camera_looks_ahead_of_the_body() {
        let episode = VlnN1Episode {
            index: 0,
            text: "Go.".to_owned(),
            parts: vec![("turn left".to_owned(), [0, 0])],
            world_from_camera: vec![DMat4::IDENTITY],
            focal_px: 112.0,
            centre_px: [112.0, 112.0],
            height_m: 1.25,
            pitch_rad: 0.0,
        };
        let columns = vln_n1_columns(&episode, 0);
        let ColumnValues::Float32Matrix(extrinsic) = &columns[2].1 else { panic!("{columns:?}") };
        let expected = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 1.25], [0.0, 0.0, 0.0, 1.0]];
        assert_eq!(extrinsic[0], expected.map(|row| row.to_vec()).to_vec());
        let folder = tempfile::tempdir().unwrap();
        write_vln_n1_scene(folder.path(), &[episode], &[DVec3::X]).unwrap();
        let tasks = std::fs::read_to_string(folder.path().join("meta/tasks.jsonl")).unwrap();
        let first: Value = serde_json::from_str(tasks.lines().next().unwrap()).unwrap();
        let told: Value = serde_json::from_str(first["task"].as_str().unwrap()).unwrap();
        assert_eq!(told["revised_sub_instruction"], "Turn left.");
    }
}
