//! Chooses the paths of a study, with one text for each condition.

use crate::{
    demands::{Demands, SAME_GOAL_M},
    episodes,
    similarity::args::By,
    study_args::{Control, StudyNew},
    texts,
};
use rand::{Rng as _, seq::SliceRandom as _};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::Arc,
};
use wayword_core::{Heading, Path, Platform, SceneId, ViewpointId, rng};
use wayword_formats::{Format, detect, jsonl};
use wayword_metrics::Distances;
use wayword_navigation::swap::{Candidate, other_path};
use wayword_run::{count::count, error::Error, output::Output};
use wayword_study::{Condition, Kind, Mode, Told};
use wayword_world::path_of;

/// The names of the two control conditions.
const PEOPLE: &str = "people";
const OTHER_PATH: &str = "other-path";

/// A path with one text for each condition, in the order of the conditions.
#[derive(Debug)]
pub(super) struct Walk {
    pub(super) name: String,
    pub(super) path: Path,
    pub(super) viewpoints: Vec<ViewpointId>,
    pub(super) start_heading: Heading,
    pub(super) told: Vec<Told>,
}

/// A path that may become part of the study. It has no texts of the conditions yet.
struct Bare {
    id: String,
    name: String,
    path: Path,
    viewpoints: Vec<ViewpointId>,
    people: Vec<String>,
}

/// The conditions of a study: one for each `--run` and each control.
///
/// # Errors
/// When two have the same name, a control needs `--episodes`, or a pair lacks a second condition.
pub(super) fn conditions(args: &StudyNew) -> Result<Vec<Condition>, Error> {
    let condition = |name: &str, kind, source: String| Condition {
        name: name.to_owned(),
        kind,
        source,
        shows_doubts: args.doubts.iter().any(|shown| shown == name),
    };
    let run = |set: &crate::study_args::NamedSet| condition(&set.name, Kind::Run, set.source.clone());
    let mut all: Vec<Condition> = args.run.iter().map(run).collect();
    if args.include.contains(&Control::People) {
        let Some(file) = &args.episodes else {
            let problem = "--include people: it is not known which texts people wrote";
            return Err(Error::usage(problem, "give the dataset's file with --episodes"));
        };
        all.push(condition(PEOPLE, Kind::People, file.display().to_string()));
    }
    if args.include.contains(&Control::OtherPath) {
        let of = if args.include.contains(&Control::People) { PEOPLE } else { &args.run[0].name };
        all.push(condition(OTHER_PATH, Kind::OtherPath, of.to_owned()));
    }
    check_doubts(args, &all)?;
    let names: BTreeSet<&str> = all.iter().map(|condition| condition.name.as_str()).collect();
    if names.len() < all.len() {
        return Err(Error::usage(
            "two conditions have one name",
            "give each --run its own name, and none that of a control",
        ));
    }
    if args.mode == crate::study_args::StudyMode::Pair && all.len() < 2 {
        return Err(Error::usage(
            "--mode pair: there is one condition, so nothing to choose between",
            "give a second --run, or --include",
        ));
    }
    Ok(all)
}

/// Refuses marks for a set that does not exist, and marks in a study in which people do not walk.
fn check_doubts(args: &StudyNew, all: &[Condition]) -> Result<(), Error> {
    if let Some(name) = args.doubts.iter().find(|name| all.iter().all(|condition| condition.name != **name)) {
        let names: Vec<&str> = all.iter().map(|condition| condition.name.as_str()).collect();
        return Err(Error::usage(
            format!("--doubts {name}: there is no such set"),
            format!("there are: {}", names.join(", ")),
        ));
    }
    if !args.doubts.is_empty() && args.mode != crate::study_args::StudyMode::Follow {
        let problem = "--doubts: words are marked only for people who walk by a text";
        return Err(Error::usage(problem, "use --mode follow, or leave out --doubts"));
    }
    Ok(())
}

/// Chooses the paths that have a text of every condition, each path once, in an order drawn by the seed.
///
/// # Errors
/// When files cannot be read, or no path has texts of all conditions.
pub(super) fn walks(
    args: &StudyNew,
    mode: Mode,
    conditions: &[Condition],
    platform: &dyn Platform,
    output: &Output,
) -> Result<Vec<Walk>, Error> {
    let demands = Demands::new(platform);
    let mut bare = bare(args, mode, platform)?;
    if mode == Mode::Follow {
        let before = bare.len();
        bare = walkable(bare, platform, &demands)?;
        if bare.len() < before {
            let left = count(before - bare.len(), "path");
            output.say(format_args!(
                "left out: {left} whose viewpoints do not lead from the start to a goal 3 m away or more"
            ));
        }
    }
    let sets = sets(conditions)?;
    let mut drawn = rng(args.seed, &["study", "texts"]);
    // If an item has several texts of a condition, one is drawn.
    let mut texts: Vec<BTreeMap<&str, String>> = Vec::new();
    for item in &bare {
        let mut of_item = BTreeMap::new();
        // Two conditions of one source have the same text, because they are to differ only in their marks.
        let mut of_source: BTreeMap<&str, String> = BTreeMap::new();
        for condition in conditions {
            let found = match condition.kind {
                Kind::Run => sets.get(condition.name.as_str()).and_then(|set| set.get(&item.id)),
                Kind::People => Some(&item.people),
                Kind::OtherPath => None,
            };
            if let Some(found) = found.filter(|found| !found.is_empty()) {
                let draw = || found[drawn.random_range(0..found.len())].clone();
                let text = of_source.entry(condition.source.as_str()).or_insert_with(draw).clone();
                of_item.insert(condition.name.as_str(), text);
            }
        }
        texts.push(of_item);
    }
    // Only a path that has a text can lend it to another path.
    let source =
        conditions.iter().find(|condition| condition.kind == Kind::OtherPath).map(|condition| &condition.source);
    let has_source = |at: usize| source.is_some_and(|source| texts[at].contains_key(source.as_str()));
    let elsewhere = match source {
        Some(_) => elsewhere(&bare, &demands, args.seed, &has_source)?,
        None => vec![None; bare.len()],
    };
    let told = |at: usize| -> Option<Vec<Told>> {
        let text = |condition: &Condition| {
            let text = match condition.kind {
                Kind::OtherPath => texts.get(elsewhere.get(at).copied().flatten()?)?.get(condition.source.as_str()),
                _ => texts[at].get(condition.name.as_str()),
            };
            Some(Told { condition: condition.name.clone(), text: text?.clone(), marks: Vec::new() })
        };
        conditions.iter().map(text).collect()
    };
    let mut order: Vec<usize> = (0..bare.len()).collect();
    order.shuffle(&mut rng(args.seed, &["study", "paths"]));
    let told: BTreeMap<usize, Vec<Told>> = order.iter().filter_map(|at| Some((*at, told(*at)?))).collect();
    let mut seen = BTreeSet::new();
    order.retain(|at| told.contains_key(at) && seen.insert(bare[*at].name.clone()));
    if order.is_empty() {
        let problem = format!("none of {} has a text of every condition", count(bare.len(), "path"));
        let hint =
            "items are matched by id: give runs of the same paths; other-path needs a second path in the same scene";
        return Err(Error::usage(problem, hint));
    }
    let mut told = told;
    let mut bare: Vec<Option<Bare>> = bare.into_iter().map(Some).collect();
    let walk = |at: usize| {
        let Bare { name, path, viewpoints, .. } = bare[at].take()?;
        let start_heading = path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
        Some(Walk { name, path, viewpoints, start_heading, told: told.remove(&at)? })
    };
    Ok(order.into_iter().filter_map(walk).collect())
}

/// Keeps the paths that can be walked over the viewpoint graph and end far enough from their start. With a nearer goal, a
/// participant who stops at once would have arrived.
fn walkable(bare: Vec<Bare>, platform: &dyn Platform, demands: &Demands<'_>) -> Result<Vec<Bare>, Error> {
    let mut all = Vec::new();
    for item in bare {
        let scene = &item.path.scene;
        let distances = demands.distances(scene)?;
        let ends = item.viewpoints.first().zip(item.viewpoints.last());
        let apart_m = ends.and_then(|(start, goal)| distances.metres(start, goal));
        let graph = platform.graph(scene)?;
        let is_known = item.viewpoints.iter().all(|viewpoint| graph.position(viewpoint).is_some());
        if is_known && apart_m.is_some_and(|apart_m| apart_m >= SAME_GOAL_M) {
            all.push(item);
        }
    }
    Ok(all)
}

/// Reads the texts of each run, by item.
fn sets(conditions: &[Condition]) -> Result<BTreeMap<&str, BTreeMap<String, Vec<String>>>, Error> {
    let runs = conditions.iter().filter(|condition| condition.kind == Kind::Run);
    let read = |condition: &'_ Condition| -> Result<_, Error> {
        let set = texts::set(&condition.source, None, By::Item)?;
        Ok(set.into_iter().map(|(item, texts)| (item, texts.texts)).collect())
    };
    runs.map(|condition| Ok((condition.name.as_str(), read(condition)?))).collect()
}

/// Reads the paths of the episodes, or, without `--episodes`, of the first run.
fn bare(args: &StudyNew, mode: Mode, platform: &dyn Platform) -> Result<Vec<Bare>, Error> {
    let file: PathBuf = args.episodes.clone().unwrap_or_else(|| texts::file_of(&args.run[0].source));
    let is_walked = mode == Mode::Follow;
    if detect(&file)? != Format::Wayword {
        let read = if is_walked { episodes::read(&file, platform)? } else { wayword_formats::read(&file)? };
        let bare = |episode: wayword_formats::Episode| {
            let object = episode.target_object.as_ref();
            let path =
                path_of(platform, &*episode.id, &episode.scene, &episode.viewpoints, episode.start_heading, object)?;
            let name = episodes::cluster(&episode);
            Ok(Bare { id: episode.id, name, path, viewpoints: episode.viewpoints, people: episode.instructions })
        };
        return read.into_iter().map(bare).collect();
    }
    let viewpoints: BTreeMap<String, Vec<ViewpointId>> = if is_walked {
        episodes::read(&file, platform)?.into_iter().map(|episode| (episode.id, episode.viewpoints)).collect()
    } else {
        BTreeMap::new()
    };
    let mut all: Vec<Bare> = Vec::new();
    let mut index: BTreeMap<String, usize> = BTreeMap::new();
    for record in jsonl::read(&file)? {
        let at = *index.entry(record.path.id.clone()).or_insert_with(|| {
            let id = record.path.id.clone();
            let name = episodes::path_name(&record.path.scene, &record.path_id());
            let viewpoints = viewpoints.get(&id).cloned().unwrap_or_default();
            all.push(Bare { id, name, path: record.path.clone(), viewpoints, people: Vec::new() });
            all.len() - 1
        });
        all[at].people.push(record.instruction.text);
    }
    Ok(all)
}

/// For each path, the index of another one in the same scene with another goal, among those for which `may_stand` is true.
fn elsewhere(
    bare: &[Bare],
    demands: &Demands<'_>,
    seed: u64,
    may_stand: &dyn Fn(usize) -> bool,
) -> Result<Vec<Option<usize>>, Error> {
    let mut distances: BTreeMap<SceneId, Arc<Distances>> = BTreeMap::new();
    let mut candidates = Vec::new();
    for item in bare {
        let scene = item.path.scene.clone();
        let goal =
            item.viewpoints.last().or_else(|| item.path.frames.last().and_then(|frame| frame.viewpoint.as_ref()));
        if goal.is_some() {
            distances.insert(scene.clone(), demands.distances(&scene)?);
        }
        // A path without viewpoints ends at a place of its own.
        let goal = goal.cloned().or_else(|| ViewpointId::new(format!("end-of-{}", item.id)).ok());
        let Some(goal) = goal else {
            return Err(Error::usage(format!("item {}: it has no usable id", item.id), "give it another"));
        };
        candidates.push(Candidate { id: item.id.clone(), scene, goal, cluster: item.name.clone() });
    }
    let is_far = |a: &Candidate, b: &Candidate| {
        let apart_m = distances.get(&a.scene).and_then(|distances| distances.metres(&a.goal, &b.goal));
        apart_m.is_none_or(|apart_m| apart_m >= SAME_GOAL_M)
    };
    let standing: Vec<usize> = (0..bare.len()).filter(|at| may_stand(*at)).collect();
    let other = |at: usize| {
        // The path itself comes first, and the others after it.
        let among: Vec<usize> =
            std::iter::once(at).chain(standing.iter().copied().filter(|other| *other != at)).collect();
        let candidates: Vec<Candidate> = among.iter().map(|index| candidates[*index].clone()).collect();
        other_path(&candidates, 0, seed, &is_far).map(|found| among[found])
    };
    Ok((0..bare.len()).map(other).collect())
}
