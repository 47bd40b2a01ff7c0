//! Writes the files of a comparison: the result, the tables, each walk's success, and submissions for the official evaluators.

use super::{file, score::WalkJudge};
use std::{collections::BTreeMap, fs, path::Path};
use wayword_formats::submission::{self, SubmittedTrajectory, TrajectoryPose};
use wayword_metrics::EpisodeDemand;
use wayword_navigation::{
    comparison::{AgentComparison, UNREAD_SET_NAME, WalkScores},
    walk::AgentWalkRecord,
};
use wayword_report::pages;
use wayword_robustness::sets::FollowResult;
use wayword_run::{error::CommandError, text_file, written_files::write_file};

/// Everything that the files need from the walks, collected in one pass.
#[derive(Default)]
pub(super) struct ComparisonOutputs {
    pub(super) results: WalkScores,
    /// The success of each walk by a text of a set.
    followed: Vec<FollowResult>,
    /// The trajectories by agent and set.
    submissions: BTreeMap<(String, String), Vec<SubmittedTrajectory>>,
}

impl ComparisonOutputs {
    /// Collects the scores, successes and trajectories from the walks of a folder.
    ///
    /// # Errors
    /// When one cannot be read or scored.
    pub(super) fn from_folder(folder: &Path, judge: &WalkJudge<'_>) -> Result<Self, CommandError> {
        let mut gathered = Self::default();
        judge.for_each_walk(folder, |walk, score, _: &EpisodeDemand| {
            let cluster = judge.path_of_item(&walk.item);
            // Walks without a text, or by the swapped texts of a set `SET~SWAP`, are no results of a set.
            if walk.set != UNREAD_SET_NAME && !walk.set.contains('~') {
                gathered.followed.extend(judge.follow_result(&walk, &score));
                gathered
                    .submissions
                    .entry((walk.agent.clone(), walk.set.clone()))
                    .or_default()
                    .push(to_submission(&walk));
            }
            gathered.results.add_walk(&walk, cluster, score);
            Ok(())
        })?;
        Ok(gathered)
    }
}

/// A walk in the form that the official evaluators read.
fn to_submission(walk: &AgentWalkRecord) -> SubmittedTrajectory {
    let to_pose = |step: &wayword_navigation::walk::AgentStep| TrajectoryPose {
        viewpoint: step.viewpoint.clone(),
        heading: step.heading_rad,
        elevation_rad: 0.0,
    };
    SubmittedTrajectory {
        instr_id: format!("{}_{}", walk.item, walk.text_index),
        trajectory: walk.steps.iter().map(to_pose).collect(),
        object: walk.object.clone(),
    }
}

/// Writes result, tables and submissions.
///
/// # Errors
/// When a file cannot be written.
pub(super) fn write_outputs(
    folder: &Path,
    comparison: &AgentComparison,
    gathered: &ComparisonOutputs,
) -> Result<(), CommandError> {
    let json = serde_json::to_string_pretty(comparison)
        .map_err(|error| CommandError::usage(format!("the result cannot be kept: {error}"), "report this as a bug"))?;
    write_file(&folder.join(file::COMPARISON), &json)?;
    write_file(&folder.join(file::MARKDOWN), pages::comparison::markdown_tables(comparison))?;
    write_file(&folder.join(file::LATEX), pages::comparison::latex_table(comparison))?;
    let mut lines = String::new();
    for result in &gathered.followed {
        let line = serde_json::to_string(result)
            .map_err(|error| CommandError::usage(format!("a walk cannot be kept: {error}"), "report this as a bug"))?;
        lines.push_str(&line);
        lines.push('\n');
    }
    write_file(&folder.join(file::FOLLOWED), &lines)?;
    let submissions = folder.join(file::SUBMISSIONS);
    fs::create_dir_all(&submissions).map_err(CommandError::io(&submissions, "make the folder"))?;
    for ((agent, set), submitted) in &gathered.submissions {
        submission::write_submission(&submissions.join(format!("{agent}.{set}.json")), submitted)?;
    }
    Ok(())
}
/// The set of texts that the walks of a submission follow, with its source, if a comparison wrote the submission and the texts are not
/// those of the episodes' file. A submission names no texts itself.
pub(crate) fn followed_set(submission: &Path, episodes: &Path) -> Option<String> {
    let folder = submission.parent().filter(|folder| folder.ends_with(file::SUBMISSIONS))?.parent()?;
    let text = text_file::read_text_file(&folder.join(file::COMPARISON), "read the comparison").ok()?;
    let comparison: AgentComparison = serde_json::from_str(&text).ok()?;
    let name = submission.file_name()?.to_str()?.trim_end_matches(".gz").strip_suffix(".json")?;
    let set = comparison.sets.into_iter().find(|set| name.ends_with(&format!(".{}", set.name)))?;
    let is_own = episodes.file_name().is_some_and(|name| name.to_string_lossy() == set.source);
    (!is_own).then(|| format!("{} ({})", set.name, set.source))
}
