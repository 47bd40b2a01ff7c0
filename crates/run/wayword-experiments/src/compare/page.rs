//! Writes the HTML page of a comparison: its tables and plots, and a replay of some of its walks.

use super::{file, instruction_sets, score::WalkJudge, settings::ComparisonSettings};
use crate::{demands::PlatformDemands, episodes};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::Arc,
};
use wayword_core::{Platform, SceneId, ViewpointGraph, ViewpointId};
use wayword_metrics::{TrajectoryMetric, TrajectoryScore};
use wayword_navigation::{comparison::AgentComparison, walk::AgentWalkRecord};
use wayword_report::pages::{
    comparison::{self, WrittenComparison},
    replay::{WalkReplay, WalkSample},
};
use wayword_run::{error::CommandError, run_folder, text_file};

/// Writes the page of a finished comparison from its folder. It needs the platform and the episodes, but not the sets of instructions.
///
/// # Errors
/// When the folder, the platform or the episodes cannot be read, or the page cannot be written.
pub fn write_page_from_folder(
    folder: &Path,
    out: &Path,
    max_replays: usize,
) -> Result<WrittenComparison, CommandError> {
    let config: ComparisonSettings = run_folder::read_config(folder)?;
    let path = folder.join(file::COMPARISON);
    if !path.is_file() {
        let problem = format!("{} holds a comparison that was not finished", folder.display());
        return Err(CommandError::usage(problem, "give the same `wayword compare` command again"));
    }
    if config.inputs.get("episodes") != Some(&run_folder::hash_of_file(&config.episodes)?) {
        let problem = format!("{}: the file has changed since the comparison", config.episodes.display());
        return Err(CommandError::usage(problem, "put the old file back, or compare again in another folder"));
    }
    let result: AgentComparison = serde_json::from_str(&text_file::read_text_file(&path, "read the comparison")?)
        .map_err(|error| {
            CommandError::usage(
                format!("{}: {error}", path.display()),
                "run `wayword compare` with the same --out again",
            )
        })?;
    let platform = config.open_platform()?;
    let mut episodes = episodes::read_episodes(&config.episodes, platform.as_ref())?;
    episodes.truncate(config.limit.unwrap_or(usize::MAX));
    let items: Vec<_> = episodes.into_iter().map(|episode| instruction_sets::item_with_texts(episode, &[])).collect();
    // The judge is made without the comparison's rule, which may not apply to items that no set has. They were not walked, so the
    // rule can be set afterwards.
    let mut judge = WalkJudge::new(&config, &items, &PlatformDemands::new(platform.as_ref()), None)?;
    judge.rule = result.about.rule;
    write_page(folder, out, &result, &judge, platform.as_ref(), max_replays)
}

/// Writes the page of a comparison with at most `max_replays` replays.
///
/// # Errors
/// When the walks cannot be read, or the page cannot be written.
pub(super) fn write_page(
    folder: &Path,
    out: &Path,
    result: &AgentComparison,
    judge: &WalkJudge<'_>,
    platform: &dyn Platform,
    max_replays: usize,
) -> Result<WrittenComparison, CommandError> {
    let (chosen, left_out) = choose_walks(folder, judge, max_replays)?;
    let mut graphs: BTreeMap<SceneId, Arc<ViewpointGraph>> = BTreeMap::new();
    for shown in &chosen {
        let scene = &shown.walk.scene;
        if !graphs.contains_key(scene) {
            graphs.insert(scene.clone(), platform.graph_for_scene(scene)?);
        }
    }
    let replays: Vec<WalkReplay<'_>> = chosen
        .iter()
        .filter_map(|shown| {
            let graph = graphs.get(&shown.walk.scene)?;
            let ReplayedWalk { walk, score, reference } = shown;
            Some(WalkReplay { walk, graph, reference, score, rule: judge.rule })
        })
        .collect();
    comparison::write_comparison(out, result, &replays, left_out)
}

/// A walk that the page replays.
struct ReplayedWalk {
    walk: AgentWalkRecord,
    score: TrajectoryScore,
    reference: Vec<ViewpointId>,
}

/// Chooses the walks to replay. It reads all walks twice, so that only the chosen ones are in memory.
fn choose_walks(
    folder: &Path,
    judge: &WalkJudge<'_>,
    max_replays: usize,
) -> Result<(Vec<ReplayedWalk>, usize), CommandError> {
    let mut sample = WalkSample::with_limit(max_replays);
    let mut at = 0_usize;
    judge.for_each_walk(folder, |walk, score, _| {
        let is_success = score.get(TrajectoryMetric::SuccessRate, judge.rule).is_some_and(|rate| rate > 0.0);
        sample.offer_walk(&walk, is_success, at);
        at += 1;
        Ok(())
    })?;
    let (chosen, left_out) = sample.into_chosen();
    let chosen: BTreeSet<usize> = chosen.into_iter().collect();
    let mut shown = Vec::with_capacity(chosen.len());
    let mut at = 0_usize;
    judge.for_each_walk(folder, |walk, score, demand| {
        if chosen.contains(&at) {
            shown.push(ReplayedWalk { walk, score, reference: demand.reference.clone() });
        }
        at += 1;
        Ok(())
    })?;
    Ok((shown, left_out))
}
