//! Chooses the paths of a study, with one text for each condition.

use super::{
    candidates::{
        CandidatePath, candidates_file, check_texts, keep_walkable, list_paths, no_text_error, read_candidates,
        read_run_texts,
    },
    corrupted::corrupt_text,
    lent_texts::{ScenePaths, TextChoice},
};
use crate::{
    demands::PlatformDemands,
    study_args::{StudyControl, StudyNew},
};
use rand::{Rng as _, seq::SliceRandom as _};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{Heading, Path, Platform, ViewpointId, seeded_rng};
use wayword_run::{count::count_phrase, error::CommandError, output::CommandOutput};
use wayword_study::{ConditionKind, StudyCondition, StudyTask, StudyText};

/// The names of the control conditions: texts that people wrote, texts of other paths, and corrupted texts.
const PEOPLE_CONDITION: &str = "original";
const OTHER_PATH_CONDITION: &str = "other-path";
const CORRUPTED_CONDITION: &str = "corrupted";

/// A path with one text for each condition, in the order of the conditions.
#[derive(Debug)]
pub(super) struct StudyWalk {
    pub(super) name: String,
    pub(super) path: Path,
    pub(super) viewpoints: Vec<ViewpointId>,
    pub(super) start_heading: Heading,
    pub(super) condition_texts: Vec<StudyText>,
}

/// The paths of a study.
#[derive(Debug)]
pub(super) struct ChosenWalks {
    /// Those of the study in their order, and last the one for practice.
    pub(super) walks: Vec<StudyWalk>,
    /// How many are in the study.
    pub(super) routes: usize,
    pub(super) has_practice: bool,
}

/// The conditions of a study: one for each `--run` and each control.
///
/// # Errors
/// When two have the same name, a control needs `--episodes`, or a pair lacks a second condition.
pub(super) fn study_conditions(args: &StudyNew) -> Result<Vec<StudyCondition>, CommandError> {
    let condition = |name: &str, kind, source: String| StudyCondition {
        name: name.to_owned(),
        kind,
        source,
        shows_doubts: args.doubts.iter().any(|shown| shown == name),
    };
    let run = |set: &crate::study_args::NamedSet| condition(&set.name, ConditionKind::Run, set.source.clone());
    let mut all: Vec<StudyCondition> = args.run.iter().map(run).collect();
    if args.include.contains(&StudyControl::People) {
        let Some(file) = &args.episodes else {
            let problem = "--include original: it is not known which texts people wrote";
            return Err(CommandError::usage(problem, "give the dataset's file with --episodes"));
        };
        all.push(condition(PEOPLE_CONDITION, ConditionKind::People, file.display().to_string()));
    }
    // Wrong texts are made from the best ones.
    let of = if args.include.contains(&StudyControl::People) { PEOPLE_CONDITION } else { &args.run[0].name };
    if args.include.contains(&StudyControl::OtherPath) {
        all.push(condition(OTHER_PATH_CONDITION, ConditionKind::OtherPath, of.to_owned()));
    }
    if args.include.contains(&StudyControl::Corrupted) {
        all.push(condition(CORRUPTED_CONDITION, ConditionKind::Corrupted, of.to_owned()));
    }
    check_doubts(args, &all)?;
    let names: BTreeSet<&str> = all.iter().map(|condition| condition.name.as_str()).collect();
    if names.len() < all.len() {
        return Err(CommandError::usage(
            "two conditions have one name",
            "give each --run its own name, and none that of a control",
        ));
    }
    if args.mode == crate::study_args::StudyMode::Pair && all.len() < 2 {
        return Err(CommandError::usage(
            "--mode pair: there is one condition, so nothing to choose between",
            "give a second --run, or --include",
        ));
    }
    Ok(all)
}

/// Refuses marks for a set that does not exist, and marks in a study in which people do not walk.
fn check_doubts(args: &StudyNew, all: &[StudyCondition]) -> Result<(), CommandError> {
    if let Some(name) = args.doubts.iter().find(|name| all.iter().all(|condition| condition.name != **name)) {
        let names: Vec<&str> = all.iter().map(|condition| condition.name.as_str()).collect();
        return Err(CommandError::usage(
            format!("--doubts {name}: there is no such set"),
            format!("there are: {}", names.join(", ")),
        ));
    }
    if !args.doubts.is_empty() && args.mode != crate::study_args::StudyMode::Follow {
        let problem = "--doubts: words are marked only for people who walk through the pictures";
        return Err(CommandError::usage(problem, "use --mode follow, or leave out --doubts"));
    }
    Ok(())
}

/// Chooses the paths that have a text of every condition, each path once, in an order drawn by the seed: at most
/// `--items` for the study, and one for practice. No text of the path for practice, and none that practice shows, comes again.
///
/// # Errors
/// When files cannot be read, or no path has texts of all conditions.
pub(super) fn choose_walks(
    args: &StudyNew,
    mode: StudyTask,
    conditions: &[StudyCondition],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<ChosenWalks, CommandError> {
    let demands = PlatformDemands::new(platform);
    let sets = read_run_texts(conditions)?;
    let listed = list_paths(&candidates_file(args))?;
    check_texts(&listed, conditions, &sets)?;
    let mut candidates = read_candidates(args, mode, platform)?;
    if mode == StudyTask::Follow {
        let before = candidates.len();
        candidates = keep_walkable(candidates, platform, &demands)?;
        if candidates.len() < before {
            let left = count_phrase(before - candidates.len(), "path");
            output.say(format_args!(
                "left out: {left} whose viewpoints do not lead from the start to a goal 3 m away or more"
            ));
        }
    }
    let mut rng = seeded_rng(args.seed, &["study", "texts"]);
    // If an item has several texts of a condition, one is drawn.
    let mut texts: Vec<BTreeMap<&str, String>> = Vec::new();
    for item in &candidates {
        let mut of_item = BTreeMap::new();
        // Two conditions of one source have the same text, because they are to differ only in their marks.
        let mut of_source: BTreeMap<&str, String> = BTreeMap::new();
        for condition in conditions {
            let found = match condition.kind {
                ConditionKind::Run => sets.get(condition.name.as_str()).and_then(|set| set.get(&item.id)),
                ConditionKind::People => Some(&item.people),
                ConditionKind::OtherPath | ConditionKind::Corrupted => None,
            };
            if let Some(found) = found.filter(|found| !found.is_empty()) {
                let draw = || found[rng.random_range(0..found.len())].clone();
                let text = of_source.entry(condition.source.as_str()).or_insert_with(draw).clone();
                of_item.insert(condition.name.as_str(), text);
            }
        }
        for condition in conditions.iter().filter(|condition| condition.kind == ConditionKind::Corrupted) {
            let source = of_item.get(condition.source.as_str());
            if let Some(corrupted) = source.and_then(|text| corrupt_text(text, args.seed, &item.id)) {
                of_item.insert(condition.name.as_str(), corrupted);
            }
        }
        texts.push(of_item);
    }
    let choice =
        TextChoice { conditions, texts: &texts, scenes: ScenePaths::of(&candidates, &demands)?, seed: args.seed };
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.shuffle(&mut seeded_rng(args.seed, &["study", "paths"]));
    let mut seen = BTreeSet::new();
    order.retain(|at| choice.has_own_texts(*at) && seen.insert(candidates[*at].name.clone()));
    let chosen = choice.choose(&order, args.items as usize, mode);
    if chosen.study.is_empty() {
        return Err(no_text_error(candidates.len(), conditions));
    }
    let mut candidates: Vec<Option<CandidatePath>> = candidates.into_iter().map(Some).collect();
    let mut walk = |(at, condition_texts): (usize, Vec<StudyText>)| {
        let CandidatePath { name, path, viewpoints, .. } = candidates[at].take()?;
        let start_heading = path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
        Some(StudyWalk { name, path, viewpoints, start_heading, condition_texts })
    };
    let study: Vec<StudyWalk> = chosen.study.into_iter().filter_map(&mut walk).collect();
    let practice = chosen.practice.and_then(walk);
    Ok(ChosenWalks {
        routes: study.len(),
        has_practice: practice.is_some(),
        walks: study.into_iter().chain(practice).collect(),
    })
}
