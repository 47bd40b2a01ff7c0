//! Reads the paths and texts that a study may use, and checks them, as far as possible without their scenes.

use crate::{
    demands::{PlatformDemands, SAME_GOAL_M},
    episodes,
    similarity::args::TextPairing,
    study_args::StudyNew,
    text_sets,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
};
use wayword_core::{Path, Platform, SceneId, ViewpointId};
use wayword_formats::{DatasetFormat, detect_format, jsonl};
use wayword_metrics::SceneDistances;
use wayword_run::{count::count_phrase, episode_paths::path_for_episode, error::CommandError};
use wayword_study::{ConditionKind, StudyCondition, StudyTask};

/// The texts of each run by the name of its condition, and in it by item.
pub(super) type RunTexts<'a> = BTreeMap<&'a str, BTreeMap<String, Vec<String>>>;

/// A path that may become part of the study. It has no texts of the conditions yet.
pub(super) struct CandidatePath {
    pub(super) id: String,
    pub(super) name: String,
    pub(super) path: Path,
    pub(super) viewpoints: Vec<ViewpointId>,
    pub(super) people: Vec<String>,
}

/// A path as its file names it, without its scene.
pub(super) struct ListedPath {
    id: String,
    /// Its name, unique over all scenes.
    name: String,
    scene: SceneId,
}

/// The file with the paths of a study: that of `--episodes`, or else the first run's.
pub(super) fn candidates_file(args: &StudyNew) -> PathBuf {
    args.episodes.clone().unwrap_or_else(|| text_sets::text_set_file(&args.run[0].source))
}

/// Lists the paths of a file, each once.
///
/// # Errors
/// When the file cannot be read.
pub(super) fn list_paths(file: &FilePath) -> Result<Vec<ListedPath>, CommandError> {
    let mut listed: Vec<ListedPath> = if detect_format(file)? == DatasetFormat::Wayword {
        let of_record = |record: jsonl::InstructionRecord| ListedPath {
            name: episodes::path_name(&record.path.scene, &record.path_id()),
            id: record.path.id,
            scene: record.path.scene,
        };
        jsonl::read_records(file)?.into_iter().map(of_record).collect()
    } else {
        let of_episode = |episode: wayword_formats::Episode| ListedPath {
            name: episodes::episode_path_name(&episode),
            id: episode.id,
            scene: episode.scene,
        };
        wayword_formats::read_any_format(file)?.into_iter().map(of_episode).collect()
    };
    let mut ids = BTreeSet::new();
    listed.retain(|path| ids.insert(path.id.clone()));
    Ok(listed)
}

/// Refuses sets of which no path has a text of every run, and other paths where no scene has two. It needs no scene, so it comes before
/// anything that takes time.
///
/// # Errors
/// When the study would have no path.
pub(super) fn check_texts(
    listed: &[ListedPath],
    conditions: &[StudyCondition],
    sets: &RunTexts<'_>,
) -> Result<(), CommandError> {
    let has_texts = |path: &&ListedPath| sets.values().all(|set| set.contains_key(&path.id));
    let mut names_in: BTreeMap<&SceneId, BTreeSet<&str>> = BTreeMap::new();
    for path in listed.iter().filter(has_texts) {
        names_in.entry(&path.scene).or_default().insert(&path.name);
    }
    let least = if conditions.iter().any(|condition| condition.kind == ConditionKind::OtherPath) { 2 } else { 1 };
    if names_in.values().any(|names| names.len() >= least) {
        return Ok(());
    }
    Err(no_text_error(listed.len(), conditions))
}

/// The error of a study without a path.
pub(super) fn no_text_error(paths: usize, conditions: &[StudyCondition]) -> CommandError {
    let has = |kind: ConditionKind| conditions.iter().any(|condition| condition.kind == kind);
    let problem = format!("none of {} has a text of every condition", count_phrase(paths, "path"));
    let mut hints = vec!["items are matched by id: give runs of the same paths"];
    if has(ConditionKind::OtherPath) {
        hints.push(
            "other-path needs a second path in the same scene whose goal is 3 m away or more: make a run with several paths in each \
             scene (docs/STUDY.md), or take --include corrupted, which needs none",
        );
    }
    if has(ConditionKind::Corrupted) {
        hints.push("corrupted needs a text that names a side, a thing or a room");
    }
    CommandError::usage(problem, hints.join("; "))
}

/// Refuses a path with a step that is no edge of the graph: nobody could walk it.
fn check_steps(item: &CandidatePath, distances: &SceneDistances) -> Result<(), CommandError> {
    let steps = || item.viewpoints.windows(2).filter(|step| step[0] != step[1]);
    let Some((number, step)) = steps().enumerate().find(|(_, step)| !distances.has_edge(&step[0], &step[1])) else {
        return Ok(());
    };
    let problem = format!(
        "path {}: its step {} of {}, from viewpoint {} to {}, is no edge of the graph of scene {}",
        item.name,
        number + 1,
        steps().count(),
        step[0],
        step[1],
        item.path.scene
    );
    Err(CommandError::usage(
        problem,
        "leave the path out, or check that --data holds the graph that the paths were made over",
    ))
}

/// Keeps the paths that can be walked over the viewpoint graph and end far enough from their start. With a nearer goal, a
/// participant who stops at once would have arrived.
///
/// # Errors
/// When a scene cannot be read, or a step of a path is no edge of its graph.
pub(super) fn keep_walkable(
    candidates: Vec<CandidatePath>,
    platform: &dyn Platform,
    demands: &PlatformDemands<'_>,
) -> Result<Vec<CandidatePath>, CommandError> {
    let mut walkable = Vec::new();
    for item in candidates {
        let scene = &item.path.scene;
        let distances = demands.scene_distances(scene)?;
        let ends = item.viewpoints.first().zip(item.viewpoints.last());
        let apart_m = ends.and_then(|(start, goal)| distances.metres_between(start, goal));
        let graph = platform.graph_for_scene(scene)?;
        let is_known = item.viewpoints.iter().all(|viewpoint| graph.position_of(viewpoint).is_some());
        if is_known {
            check_steps(&item, &distances)?;
        }
        if is_known && apart_m.is_some_and(|apart_m| apart_m >= SAME_GOAL_M) {
            walkable.push(item);
        }
    }
    Ok(walkable)
}

/// Reads the texts of each run, by item.
///
/// # Errors
/// When a run cannot be read.
pub(super) fn read_run_texts(conditions: &[StudyCondition]) -> Result<RunTexts<'_>, CommandError> {
    let runs = conditions.iter().filter(|condition| condition.kind == ConditionKind::Run);
    let read = |condition: &'_ StudyCondition| -> Result<_, CommandError> {
        let set = text_sets::read_text_set(&condition.source, None, TextPairing::Item)?;
        Ok(set.into_iter().map(|(item, texts)| (item, texts.texts)).collect())
    };
    runs.map(|condition| Ok((condition.name.as_str(), read(condition)?))).collect()
}

/// Reads the paths of the episodes, or, without `--episodes`, of the first run.
///
/// # Errors
/// When the file or a scene cannot be read.
pub(super) fn read_candidates(
    args: &StudyNew,
    mode: StudyTask,
    platform: &dyn Platform,
) -> Result<Vec<CandidatePath>, CommandError> {
    let file = candidates_file(args);
    let is_walked = mode == StudyTask::Follow;
    if detect_format(&file)? != DatasetFormat::Wayword {
        let read = if is_walked {
            episodes::read_episodes(&file, platform)?
        } else {
            wayword_formats::read_any_format(&file)?
        };
        let to_candidate = |episode: wayword_formats::Episode| {
            let path = path_for_episode(platform, &episode)?;
            let name = episodes::episode_path_name(&episode);
            Ok(CandidatePath {
                id: episode.id,
                name,
                path,
                viewpoints: episode.viewpoints,
                people: episode.instructions,
            })
        };
        return read.into_iter().map(to_candidate).collect();
    }
    let viewpoints: BTreeMap<String, Vec<ViewpointId>> = if is_walked {
        episodes::read_episodes(&file, platform)?.into_iter().map(|episode| (episode.id, episode.viewpoints)).collect()
    } else {
        BTreeMap::new()
    };
    let mut candidates: Vec<CandidatePath> = Vec::new();
    let mut index: BTreeMap<String, usize> = BTreeMap::new();
    for record in jsonl::read_records(&file)? {
        let at = *index.entry(record.path.id.clone()).or_insert_with(|| {
            let id = record.path.id.clone();
            let name = episodes::path_name(&record.path.scene, &record.path_id());
            let viewpoints = viewpoints.get(&id).cloned().unwrap_or_default();
            candidates.push(CandidatePath { id, name, path: record.path.clone(), viewpoints, people: Vec::new() });
            candidates.len() - 1
        });
        candidates[at].people.push(record.instruction.text);
    }
    Ok(candidates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, PathMotion, ViewpointGraph};

    fn scene() -> SceneId {
        SceneId::new("s").unwrap()
    }

    fn viewpoint(name: &str) -> ViewpointId {
        ViewpointId::new(name).unwrap()
    }

    #[test]
    fn a_step_without_an_edge_is_named() {
        let mut graph = ViewpointGraph::default();
        for (at, name) in ["a", "b", "c"].into_iter().enumerate() {
            graph.add_viewpoint(viewpoint(name), DVec3::X * at as f64, None).unwrap();
        }
        graph.join_viewpoints(&viewpoint("a"), &viewpoint("b")).unwrap();
        let distances = SceneDistances::new(&graph);
        let path = |viewpoints: &[&str]| CandidatePath {
            id: "7".into(),
            name: "s/7".into(),
            path: Path { id: "7".into(), scene: scene(), frames: Vec::new(), motion: PathMotion::Known, target: None },
            viewpoints: viewpoints.iter().map(|name| viewpoint(name)).collect(),
            people: Vec::new(),
        };
        check_steps(&path(&["b", "a", "a", "b"]), &distances).unwrap();
        let refused = check_steps(&path(&["a", "a", "b", "c"]), &distances).unwrap_err().to_string();
        assert!(refused.contains("path s/7: its step 2 of 2, from viewpoint b to c, is no edge"), "{refused}");
    }

    #[test]
    fn a_control_of_other_paths_needs_two_paths_with_texts_in_a_scene() {
        let listed = |scenes: &[&str]| -> Vec<ListedPath> {
            let path = |(at, scene): (usize, &&str)| ListedPath {
                id: at.to_string(),
                name: format!("{scene}/{at}"),
                scene: SceneId::new(*scene).unwrap(),
            };
            scenes.iter().enumerate().map(path).collect()
        };
        let condition = |kind| StudyCondition { name: "x".into(), kind, source: "ours".into(), shows_doubts: false };
        let texts = |ids: &[&str]| -> RunTexts<'static> {
            BTreeMap::from([("ours", ids.iter().map(|id| ((*id).to_owned(), vec!["Go.".to_owned()])).collect())])
        };
        let (run, other) = ([condition(ConditionKind::Run)], [condition(ConditionKind::OtherPath)]);
        assert!(check_texts(&listed(&["a", "a"]), &other, &texts(&["0", "1"])).is_ok());
        assert!(check_texts(&listed(&["a", "b"]), &run, &texts(&["1"])).is_ok());
        for (scenes, ids) in [(["a", "b"], vec!["0", "1"]), (["a", "a"], vec!["0"])] {
            let refused = check_texts(&listed(&scenes), &other, &texts(&ids)).unwrap_err().to_string();
            assert!(refused.contains("--include corrupted"), "{refused}");
        }
        assert!(check_texts(&listed(&["a"]), &run, &texts(&["9"])).is_err(), "no path has a text");
    }
}
