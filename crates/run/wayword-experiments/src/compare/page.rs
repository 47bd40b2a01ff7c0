//! Writes the HTML page of a comparison: its tables and plots, and a replay of some of its walks.

use super::{file, kept::Kept, score::Judge, sets};
use crate::{demands::Demands, episodes};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::Arc,
};
use wayword_core::{Platform, SceneId, ViewpointGraph, ViewpointId};
use wayword_metrics::{Metric, Score};
use wayword_navigation::{comparison::Comparison, walk::Walk};
use wayword_report::pages::{
    comparison::{self, Written},
    replay::{Replay, Sample},
};
use wayword_run::{error::Error, run_folder as run, text_file};

/// Whether a folder holds a comparison, finished or not.
pub fn is_comparison(folder: &Path) -> bool {
    run::table_of(folder).is_ok_and(|kept| kept.contains_key("agents"))
}

/// Writes the page of a finished comparison from its folder. It needs the platform and the episodes, but not the sets of instructions.
///
/// # Errors
/// When the folder, the platform or the episodes cannot be read, or the page cannot be written.
pub fn write_of_folder(folder: &Path, out: &Path, most: usize) -> Result<Written, Error> {
    let kept: Kept = run::config_of(folder)?;
    let path = folder.join(file::COMPARISON);
    if !path.is_file() {
        let problem = format!("{} holds a comparison that was not finished", folder.display());
        return Err(Error::usage(problem, "give the same `wayword compare` command again"));
    }
    if kept.inputs.get("episodes") != Some(&run::hash_of_file(&kept.episodes)?) {
        let problem = format!("{}: the file has changed since the comparison", kept.episodes.display());
        return Err(Error::usage(problem, "put the old file back, or compare again in another folder"));
    }
    let found: Comparison = serde_json::from_str(&text_file::read(&path, "read the comparison")?).map_err(|error| {
        Error::usage(format!("{}: {error}", path.display()), "run `wayword compare` with the same --out again")
    })?;
    let platform = kept.platform()?;
    let mut episodes = episodes::read(&kept.episodes, platform.as_ref())?;
    episodes.truncate(kept.limit.unwrap_or(usize::MAX));
    let items: Vec<_> = episodes.into_iter().map(|episode| sets::item(episode, &[])).collect();
    // Without the rule, because it may not apply to items that no set has, and those are not walked.
    let mut judge = Judge::new(&kept, &items, &Demands::new(platform.as_ref()), None)?;
    judge.rule = found.about.rule;
    write(folder, out, &found, &judge, platform.as_ref(), most)
}

/// Writes the page of a comparison with at most `most` replays.
///
/// # Errors
/// When the walks cannot be read, or the page cannot be written.
pub(super) fn write(
    folder: &Path,
    out: &Path,
    found: &Comparison,
    judge: &Judge<'_>,
    platform: &dyn Platform,
    most: usize,
) -> Result<Written, Error> {
    let (chosen, left_out) = choose(folder, judge, most)?;
    let mut graphs: BTreeMap<SceneId, Arc<ViewpointGraph>> = BTreeMap::new();
    for shown in &chosen {
        let scene = &shown.walk.scene;
        if !graphs.contains_key(scene) {
            graphs.insert(scene.clone(), platform.graph(scene)?);
        }
    }
    let replays: Vec<Replay<'_>> = chosen
        .iter()
        .filter_map(|shown| {
            let graph = graphs.get(&shown.walk.scene)?;
            let Shown { walk, score, reference } = shown;
            Some(Replay { walk, graph, reference, score, rule: judge.rule })
        })
        .collect();
    comparison::write(out, found, &replays, left_out)
}

/// A walk that the page replays.
struct Shown {
    walk: Walk,
    score: Score,
    reference: Vec<ViewpointId>,
}

/// Chooses the walks to replay. It reads all walks twice, so that only the chosen ones are in memory.
fn choose(folder: &Path, judge: &Judge<'_>, most: usize) -> Result<(Vec<Shown>, usize), Error> {
    let mut sample = Sample::of(most);
    let mut at = 0_usize;
    judge.each(folder, |walk, score, _| {
        let is_success = score.get(Metric::SuccessRate, judge.rule).is_some_and(|rate| rate > 0.0);
        sample.offer(&walk, is_success, at);
        at += 1;
        Ok(())
    })?;
    let (chosen, left_out) = sample.chosen();
    let chosen: BTreeSet<usize> = chosen.into_iter().collect();
    let mut shown = Vec::with_capacity(chosen.len());
    let mut at = 0_usize;
    judge.each(folder, |walk, score, demand| {
        if chosen.contains(&at) {
            shown.push(Shown { walk, score, reference: demand.reference.clone() });
        }
        at += 1;
        Ok(())
    })?;
    Ok((shown, left_out))
}
