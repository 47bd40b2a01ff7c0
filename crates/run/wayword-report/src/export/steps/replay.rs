//! Verifies an export of trajectories by walking them again: do the actions lead to the end of the path, and do the poses give the
//! same pictures?

use super::{settings::StepExportSettings, store::take_picture};
use crate::walking::{WalkingScenes, floor_positions};
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
use wayword_core::DVec3;
use wayword_formats::{
    jsonl,
    trajectories::{ActionTrajectory, read_pictures, read_trajectories},
};
use wayword_habitat::walk::{AgentStance, replay_actions};
use wayword_run::{
    error::CommandError,
    run_folder::{file, read_config, read_run_settings},
};

/// A pose counts as the written one if it is closer to it than this, metres.
const SAME_POSE_M: f64 = 0.001;

/// Counts of a replay.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrajectoryReplay {
    /// Walks that were replayed.
    pub walks: usize,
    /// Walks in which the ground blocked a step, or a pose differed from the written one.
    pub astray: usize,
    /// The largest distance between the last place of an agent and the last frame of its walk, metres.
    pub farthest_off_m: f64,
    /// Pictures that were drawn again.
    pub pictures: usize,
    /// Pictures that differ from the written ones.
    pub others: usize,
}

/// Replays the walks of an export in `folder`, and draws every n-th of their pictures. `run` is the run that was exported.
///
/// # Errors
/// When a file breaks a rule of its format, or a scene cannot be drawn.
pub fn replay_export(folder: &Path, run: &Path, every: usize) -> Result<TrajectoryReplay, CommandError> {
    let steps: StepExportSettings = read_config(folder)?;
    let scenes = WalkingScenes::open_run(&read_run_settings(run)?, [steps.width_px, steps.height_px])?;
    let ends: BTreeMap<String, DVec3> = jsonl::read_records(&run.join(file::INSTRUCTIONS))?
        .into_iter()
        .filter_map(|record| floor_positions(&record.path).last().map(|end| (record.path.id, *end)))
        .collect();
    let mut counts = TrajectoryReplay::default();
    for trajectory in read_trajectories(&folder.join(super::store::TRAJECTORIES_FILE))? {
        counts.walks += 1;
        match replay_end(&trajectory, &scenes, &steps)?.zip(ends.get(&trajectory.id)) {
            Some((end, wanted)) => {
                counts.farthest_off_m = counts.farthest_off_m.max((end - *wanted).truncate().length());
            }
            None => counts.astray += 1,
        }
        for (number, written) in read_pictures(folder, &trajectory)?.into_iter().enumerate().step_by(every.max(1)) {
            counts.pictures += 1;
            counts.others += usize::from(take_picture(&scenes, &steps, &trajectory, number)? != written);
        }
    }
    Ok(counts)
}

/// The place to which the actions of a walk lead; `None` if a step is blocked, or a pose differs from the written one.
fn replay_end(
    trajectory: &ActionTrajectory,
    scenes: &WalkingScenes,
    steps: &StepExportSettings,
) -> Result<Option<DVec3>, CommandError> {
    let ground = scenes.ground(&trajectory.scene)?;
    let (Some(first), Some(heading)) = (trajectory.positions.first(), trajectory.headings.first()) else {
        return Ok(None);
    };
    let Some(foothold) = ground.nearest_foothold(*first) else { return Ok(None) };
    let start = AgentStance::new(foothold, *heading);
    let taken: Option<Vec<DVec3>> = replay_actions(&ground, start, &trajectory.actions, steps.gait()?)
        .map(|stance| stance.map(|stance| stance.foothold.place))
        .collect();
    let is_same = |taken: &Vec<DVec3>| {
        taken.len() == trajectory.actions.len() + 1
            && taken.iter().zip(&trajectory.positions).all(|(a, b)| a.distance(*b) < SAME_POSE_M)
    };
    Ok(taken.filter(is_same).and_then(|taken| taken.last().copied()))
}
