//! Verifies an export of trajectories by walking them again: do the actions lead to the end of the path, do the poses give the same
//! pictures, and does each pixel goal show the place that it stands for?

use super::{drawing::draw_walk, settings::StepExportSettings, store};
use crate::walking::{WalkingScenes, floor_positions};
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
use wayword_core::DVec3;
use wayword_formats::{
    habitat::wayword_from_habitat,
    jsonl,
    trajectories::{
        ActionTrajectory, CameraIntrinsics, CameraWalk, DEPTH_PER_M, PictureKind, read_camera_walks, read_pictures,
        read_trajectories,
    },
};
use wayword_habitat::walk::{AgentStance, replay_actions};
use wayword_run::{
    error::CommandError,
    run_folder::{file, read_config, read_run_settings},
};

/// A pose counts as the written one if it is closer to it than this, metres.
const SAME_POSE_M: f64 = 0.001;
/// A goal is near the place that it stands for if it is no farther than this, metres, or than its pixel is wide there.
const NEAR_GOAL_M: f64 = 0.1;

/// Counts of a replay.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrajectoryReplay {
    /// Walks that were replayed.
    pub walks: usize,
    /// Walks in which the ground blocked a step, or a pose differed from the written one.
    pub astray: usize,
    /// The largest distance between the last place of an agent and the last frame of its walk, metres.
    pub farthest_off_m: f64,
    /// Pictures and depth pictures that were drawn again.
    pub pictures: usize,
    /// Of these, those that differ from the written ones.
    pub others: usize,
    /// Pixel goals.
    pub goals: usize,
    /// Of these, those with a pixel that, at its depth in the depth picture, shows the place that they stand for: within 0.1 m, or within
    /// the width of the pixel there.
    pub goals_near: usize,
}

/// Replays the walks of an export in `folder`, and draws every n-th walk again. `run` is the run that was exported.
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
    let trajectories = read_trajectories(&folder.join(store::TRAJECTORIES_FILE))?;
    for trajectory in &trajectories {
        counts.walks += 1;
        match replay_end(trajectory, &scenes, &steps)?.zip(ends.get(&trajectory.id)) {
            Some((end, wanted)) => {
                counts.farthest_off_m = counts.farthest_off_m.max((end - *wanted).truncate().length());
            }
            None => counts.astray += 1,
        }
    }
    for camera in store::read_cameras(folder)? {
        let walks = read_camera_walks(&store::pictures_file(folder, &camera))?;
        let walks: BTreeMap<&str, &CameraWalk> = walks.iter().map(|walk| (walk.trajectory_id.as_str(), walk)).collect();
        for trajectory in trajectories.iter().step_by(every.max(1)) {
            if let Some(walk) = walks.get(trajectory.id.as_str()) {
                counts.compare_walk(folder, (&scenes, &steps), &camera, (trajectory, walk))?;
            }
        }
    }
    Ok(counts)
}

impl TrajectoryReplay {
    /// Draws what a camera sees along a walk again, and compares it with the written pictures; looks up the pixel goals in the written
    /// depths.
    fn compare_walk(
        &mut self,
        folder: &Path,
        (scenes, steps): (&WalkingScenes, &StepExportSettings),
        camera: &CameraIntrinsics,
        (trajectory, walk): (&ActionTrajectory, &CameraWalk),
    ) -> Result<(), CommandError> {
        let drawn = draw_walk(scenes, camera, steps.jpeg_quality, trajectory)?;
        let count = trajectory.actions.len();
        let depth = read_pictures(folder, &walk.depth, PictureKind::Depth, count)?;
        let rgb = read_pictures(folder, &walk.rgb, PictureKind::Rgb, count)?;
        for (again, written) in drawn.rgb.iter().chain(&drawn.depth).zip(rgb.iter().chain(&depth)) {
            self.pictures += 1;
            self.others += usize::from(again != written);
        }
        for (step, goal) in walk.pixel_goals.iter().enumerate() {
            let Some(goal) = goal else { continue };
            self.goals += 1;
            let wanted = trajectory.floor_position(goal.step);
            let shown = place_in_depth(camera, walk, step, goal.pixel, &depth[step]);
            self.goals_near += usize::from(shown.is_some_and(|(place, footprint_m)| {
                wanted.is_some_and(|wanted| place.distance(wanted) <= NEAR_GOAL_M.max(footprint_m))
            }));
        }
        Ok(())
    }
}

/// The place in the world that a pixel shows, by the written depth and pose, and how wide a pixel is there, metres.
fn place_in_depth(
    camera: &CameraIntrinsics,
    walk: &CameraWalk,
    step: usize,
    pixel: [u32; 2],
    depth_png: &[u8],
) -> Option<(DVec3, f64)> {
    let depth = image::load_from_memory(depth_png).ok()?.into_luma16();
    let depth_m = f64::from(depth.get_pixel_checked(pixel[0], pixel[1])?.0[0]) / DEPTH_PER_M;
    let world_from_camera = walk.world_from_camera.get(step)?;
    let place = world_from_camera.transform_point3(camera.ray_through(pixel) * depth_m);
    Some((wayword_from_habitat(place), depth_m / camera.focal_px))
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
