//! Trajectories for training policies: the actions along a walk, the agent's pose before each, what its cameras see there, and the
//! instructions about it.
//!
//! A folder has `trajectories.jsonl`, one line per walk, and a folder for each camera, `cameras/125cm_30deg`, with its intrinsics
//! (`camera.json`), a line per walk (`pictures.jsonl`) and the pictures: in folders (`rgb/ID/0000.jpg`, `depth/ID/0000.png`), or
//! in shards as WebDataset reads them (`shards/000000.tar`, one sample per walk: `000012.json`, `000012.rgb.0000.jpg` and so
//! on). Picture n is what the camera sees before action n.

mod camera;
mod pictures;
mod read;
mod shard;

pub use camera::{CameraIntrinsics, CameraWalk, PixelGoal, camera_walk_line, read_camera_walks};
pub use pictures::{DEPTH_PER_M, PictureDigest, PictureKind, PictureLocation, PictureSet, read_pictures};
pub use read::read_trajectories;
pub use shard::ShardWriter;

use crate::{
    FormatError,
    habitat::{habitat_from_heading, habitat_from_wayword, heading_from_habitat},
    output,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;
use wayword_core::{AgentAction, DVec3, Heading, SceneId};

/// The value of `format`.
const TRAJECTORY_FORMAT: &str = "wayword-trajectory/2";
/// Positions and headings are rounded to that part of a metre and of a radian: a millionth.
const PARTS_PER_UNIT: f64 = 1e6;
/// The four numbers of a rotation are rounded to that part of 1, so that the heading keeps its digits.
const ROTATION_PARTS: f64 = 1e9;

/// A walk in single actions.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionTrajectory {
    /// Its name: that of its path.
    pub id: String,
    /// Name of the platform.
    pub platform: String,
    /// The scene.
    pub scene: SceneId,
    /// The split.
    pub split: String,
    /// The agent's actions. The last action, and no other, is [`AgentAction::Stop`].
    pub actions: Vec<AgentAction>,
    /// Where the agent is before each action, on the navmesh, world frame, metres.
    pub positions: Vec<DVec3>,
    /// Which way it looks before each action.
    pub headings: Vec<Heading>,
    /// How far each position is above the drawn floor, metres; `None` if no floor is drawn under it.
    pub above_floor_m: Vec<Option<f64>>,
    /// For each frame of the path, the number of the action before which the agent comes there.
    pub frame_steps: Vec<usize>,
    /// How far from the end of the path it stops, metres.
    pub off_m: f64,
    /// SHA-256 of the path that the agent follows.
    pub path_sha256: String,
    /// The instructions about it.
    pub instructions: Vec<TrajectoryInstruction>,
}

/// An instruction about a walk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrajectoryInstruction {
    /// Its episode in the VLN-CE file next to the trajectories.
    pub episode_id: String,
    /// Its style.
    pub style: String,
    /// Its words.
    pub text: String,
    /// Its parts, in order. The first begins before action 0, and each begins before a later action than the one before.
    pub sub_instructions: Vec<SubInstruction>,
    /// How many parts of the text have no length of their own on the walk, and were joined with a neighbour.
    pub joined_parts: usize,
}

/// A part of an instruction, and the part of the walk that it is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SubInstruction {
    /// Its words.
    pub text: String,
    /// Their byte range in the instruction.
    pub span: [usize; 2],
    /// The first and the last frame of the path that it is about.
    pub frames: [usize; 2],
    /// The actions before which the agent comes to these frames.
    pub steps: [usize; 2],
}

impl ActionTrajectory {
    /// The place on the drawn floor under the agent before an action; where no floor is drawn, its place on the navmesh. `None` if the
    /// walk has no such action.
    #[must_use]
    pub fn floor_position(&self, step: usize) -> Option<DVec3> {
        let above_m = self.above_floor_m.get(step).copied().flatten().unwrap_or_default();
        Some(*self.positions.get(step)? - DVec3::Z * above_m)
    }
}

/// A position and a heading as a file holds them, with few digits. Pictures are taken from there, so that readers of the
/// file can take the same.
#[must_use]
pub fn round_pose(position: DVec3, heading: Heading) -> (DVec3, Heading) {
    (round_position(position), rounded_heading(heading))
}

fn round_position(position: DVec3) -> DVec3 {
    (position * PARTS_PER_UNIT).round() / PARTS_PER_UNIT
}

fn rounded_heading(heading: Heading) -> Heading {
    Heading::new((heading.rad() * PARTS_PER_UNIT).round() / PARTS_PER_UNIT).unwrap_or(heading)
}

fn rotation_from_heading(heading: Heading) -> [f64; 4] {
    // No -0, which a reader would write as 0.
    habitat_from_heading(heading).map(|part| (part * ROTATION_PARTS).round() / ROTATION_PARTS + 0.0)
}

/// The heading of a rotation that a file has, with the digits that its writer had.
fn heading_from_rotation(rotation: [f64; 4]) -> Option<Heading> {
    heading_from_habitat(rotation).map(rounded_heading)
}

/// A length as a file holds it, with few digits.
#[must_use]
pub fn round_length_m(length_m: f64) -> f64 {
    (length_m * PARTS_PER_UNIT).round() / PARTS_PER_UNIT
}

/// The line of a trajectory.
#[must_use]
pub fn trajectory_line(trajectory: &ActionTrajectory) -> Value {
    let ActionTrajectory { id, platform, scene, split, actions, .. } = trajectory;
    let positions: Vec<_> = trajectory
        .positions
        .iter()
        .map(|position| habitat_from_wayword(round_position(*position)).to_array().map(|part| part + 0.0))
        .collect();
    let rotations: Vec<_> = trajectory.headings.iter().map(|heading| rotation_from_heading(*heading)).collect();
    json!({
        "format": TRAJECTORY_FORMAT,
        "trajectory_id": id,
        "platform": platform,
        "scene": scene,
        "split": split,
        "instructions": trajectory.instructions,
        "actions": actions,
        "positions": positions,
        "rotations": rotations,
        "above_floor_m": trajectory.above_floor_m,
        "frame_steps": trajectory.frame_steps,
        "off_m": round_length_m(trajectory.off_m),
        "path_sha256": trajectory.path_sha256,
    })
}

/// Writes a file of trajectories.
///
/// # Errors
/// When it cannot be written.
pub fn write_trajectories(file: &Path, trajectories: &[ActionTrajectory]) -> Result<(), FormatError> {
    output::write_file(file, |out| output::write_lines(out, trajectories.iter().map(trajectory_line)))
}

#[cfg(test)]
mod tests;
