//! Collects the walks of a run's records, and divides each into single actions on the ground of its scene.

use super::{super::items, instruction_parts::split_instruction, settings::StepExportSettings};
use crate::walking::{WalkingScenes, floor_positions};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use wayword_core::{FailureKind, Heading, Path, hex_text};
use wayword_formats::{
    jsonl::InstructionRecord,
    trajectories::{ActionTrajectory, TrajectoryInstruction, round_length_m, round_pose},
};
use wayword_habitat::walk::follow_places;
use wayword_run::{error::CommandError, run_folder::FailedItem};

/// A walk, and the texts about it.
pub(super) struct ExportedWalk<'a> {
    pub(super) path: &'a Path,
    pub(super) split: &'a str,
    /// The records about the walk, each with the name of its episode.
    pub(super) texts: Vec<(String, &'a InstructionRecord)>,
}

impl ExportedWalk<'_> {
    /// SHA-256 of its path.
    pub(super) fn path_sha256(&self) -> String {
        // A path that was read can be written.
        hex_text(Sha256::digest(serde_json::to_vec(self.path).unwrap_or_default()))
    }

    /// Its texts, with the actions before which the agent comes to their parts.
    pub(super) fn instructions(&self, frame_steps: &[usize]) -> Vec<TrajectoryInstruction> {
        let instruction = |(episode_id, record): &(String, &InstructionRecord)| {
            let (sub_instructions, joined_parts) = split_instruction(&record.instruction, frame_steps);
            TrajectoryInstruction {
                episode_id: episode_id.clone(),
                style: record.instruction.style.clone(),
                text: record.instruction.text.clone(),
                sub_instructions,
                joined_parts,
            }
        };
        self.texts.iter().map(instruction).collect()
    }
}

/// The walks of records, scene by scene. A walk occurs once, with all of its texts and their split.
pub(super) fn walks_from_records<'a>(records: &'a [InstructionRecord], splits: &'a [String]) -> Vec<ExportedWalk<'a>> {
    let mut walks: Vec<ExportedWalk<'a>> = Vec::new();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for ((record, split), name) in records.iter().zip(splits).zip(items::episode_names(records)) {
        let path = &record.path;
        let at = *places.entry(path.id.as_str()).or_insert_with(|| {
            walks.push(ExportedWalk { path, split, texts: Vec::new() });
            walks.len() - 1
        });
        walks[at].texts.push((name, record));
    }
    // Sorted by scene, so that each scene is prepared only once.
    walks.sort_by(|a, b| a.path.scene.cmp(&b.path.scene));
    walks
}

/// Divides a walk into single actions that follow its path from frame to frame. If the actions cannot follow the path, the inner
/// result is a failed item.
pub(super) fn trajectory_from_walk(
    walk: &ExportedWalk<'_>,
    scenes: &WalkingScenes,
    steps: &StepExportSettings,
) -> Result<Result<ActionTrajectory, FailedItem>, CommandError> {
    let (path, gait) = (walk.path, steps.gait()?);
    let failed = |failure, reason: String| FailedItem { item: path.id.clone(), failure, reason };
    let ground = match scenes.ground(&path.scene) {
        Ok(ground) => ground,
        Err(error) if error.failure_kind() == FailureKind::Lost => return Err(error.into()),
        Err(error) => return Ok(Err(failed(error.failure_kind(), error.to_string()))),
    };
    let heading = path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
    let walked = match follow_places(&ground, &floor_positions(path), heading, gait, steps.tolerance_m) {
        Ok(walked) => walked,
        Err(astray) => return Ok(Err(failed(FailureKind::Broken, astray.to_string()))),
    };
    let stances = walked.stances.iter().map(|stance| round_pose(stance.foothold.place, stance.heading(gait)));
    let (positions, headings): (Vec<_>, Vec<_>) = stances.unzip();
    let above_floor_m = positions
        .iter()
        .map(|position| Ok(scenes.above_floor_m(&path.scene, *position)?.map(round_length_m)))
        .collect::<Result<_, CommandError>>()?;
    Ok(Ok(ActionTrajectory {
        id: path.id.clone(),
        platform: scenes.platform().name().to_owned(),
        scene: path.scene.clone(),
        split: walk.split.to_owned(),
        positions,
        headings,
        above_floor_m,
        off_m: walked.off_m,
        path_sha256: walk.path_sha256(),
        instructions: walk.instructions(&walked.reached),
        frame_steps: walked.reached,
        actions: walked.actions,
    }))
}
