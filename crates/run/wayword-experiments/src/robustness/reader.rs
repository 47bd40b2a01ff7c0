//! Lets the agent `reader` walk by a text, to see whether the text leads to the goal.

use crate::{
    demands::{PlatformDemands, SAME_GOAL_M},
    episodes::viewpoints_along_path,
};
use wayword_core::{Path, Platform};
use wayword_navigation::{
    AgentView, ThingSource,
    agents::{AgentStart, walk_by_reading},
    grounders::{GrounderScope, LexicalGrounder},
};
use wayword_run::error::CommandError;

/// The name of the agent, as `wayword compare` has it.
pub(super) const READER_AGENT_NAME: &str = "reader";

/// Walks by a text from the viewpoint nearest to the start of a path: 1 where the walk ends less than 3 m from the viewpoint
/// nearest to its end, 0 elsewhere. `None` where the platform has no viewpoints, or the path no poses.
///
/// # Errors
/// When a view cannot be had.
pub(super) fn reader_arrives(
    platform: &dyn Platform,
    demands: &PlatformDemands<'_>,
    path: &Path,
    text: &str,
) -> Result<Option<f64>, CommandError> {
    if !path.motion.is_known() || platform.graph_for_scene(&path.scene)?.is_empty() {
        return Ok(None);
    }
    let viewpoints = viewpoints_along_path(platform, path)?;
    let (Some(first), Some(goal), Some(frame)) = (viewpoints.first(), viewpoints.last(), path.frames.first()) else {
        return Ok(None);
    };
    let start = AgentStart { scene: path.scene.clone(), viewpoint: first.clone(), heading: frame.pose.heading };
    let lexical = LexicalGrounder::new(GrounderScope::Views);
    let view = AgentView::new(platform, &lexical, false, &path.scene)?;
    let walked = walk_by_reading(&view, &start, text, &ThingSource::Labels)?;
    let end = walked.steps.last().map_or(first, |step| &step.viewpoint);
    let off_m = demands.scene_distances(&path.scene)?.metres_between(end, goal);
    Ok(Some(f64::from(u8::from(off_m.is_some_and(|off_m| off_m < SAME_GOAL_M)))))
}
