//! Trajectories for training policies: the actions along a walk, the agent's pose before each, the picture it sees
//! there, and the instructions about it.
//!
//! A folder has `trajectories.jsonl`, one line per walk, and the pictures: in a folder for each walk
//! (`images/ID/0000.jpg`), or in shards as WebDataset reads them (`shards/000000.tar`, one sample per walk:
//! `000012.json`, `000012.0000.jpg` and so on). Picture n is what the agent sees before action n.

mod pictures;
mod read;
mod shard;

pub use pictures::{PictureDigest, picture_name, read_pictures};
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
const TRAJECTORY_FORMAT: &str = "wayword-trajectory/1";
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
    /// Where the agent is before each action, on the floor, world frame, metres.
    pub positions: Vec<DVec3>,
    /// Which way it looks before each action.
    pub headings: Vec<Heading>,
    /// For each frame of the path, the number of the action before which the agent comes there.
    pub frame_steps: Vec<usize>,
    /// How far from the end of the path it stops, metres.
    pub off_m: f64,
    /// Where its pictures are.
    pub pictures: PictureLocation,
    /// SHA-256 of its pictures, one after the other ([`PictureDigest`]).
    pub sha256: String,
    /// The instructions about it.
    pub instructions: Vec<TrajectoryInstruction>,
}

/// Where the pictures of a walk are, below the folder of `trajectories.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PictureLocation {
    /// A folder: `images/ID`.
    Folder(String),
    /// A sample of a shard.
    Sample {
        /// `shards/000000.tar`.
        shard: String,
        /// `000012`.
        key: String,
    },
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
    /// Its parts, in order.
    pub sub_instructions: Vec<SubInstruction>,
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
    habitat_from_heading(heading).map(|part| (part * ROTATION_PARTS).round() / ROTATION_PARTS)
}

/// The heading of a rotation that a file has, with the digits that its writer had.
fn heading_from_rotation(rotation: [f64; 4]) -> Option<Heading> {
    heading_from_habitat(rotation).map(rounded_heading)
}

/// The line of a trajectory.
#[must_use]
pub fn trajectory_line(trajectory: &ActionTrajectory) -> Value {
    let ActionTrajectory { id, platform, scene, split, actions, .. } = trajectory;
    let positions: Vec<_> = trajectory
        .positions
        .iter()
        .map(|position| habitat_from_wayword(round_position(*position)).to_array())
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
        "frame_steps": trajectory.frame_steps,
        "off_m": (trajectory.off_m * PARTS_PER_UNIT).round() / PARTS_PER_UNIT,
        "pictures": trajectory.pictures,
        "sha256": trajectory.sha256,
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
