//! Corrupts texts that people wrote, to measure how many of the errors `wayword check` finds.
//!
//! Invariant: this folder does not use the program's reader, its lexicon or its checks. The corrupted texts must be able to contain words
//! that the reader does not know, or the measurement would flatter it.

mod building;
mod corruptible_text;
mod kind;
mod lists;
mod names;
mod repeats_and_swaps;
mod replacements;
mod text;
mod turns;

use crate::{
    checked_texts::{text_item, write_items},
    key::{CorruptionKey, TextCorruption, apply_edits},
};
use building::{LabelledBuilding, nearest_m};
use clap::{Args, builder::PossibleValuesParser};
use corruptible_text::CorruptibleText;
use kind::PeopleCorruptionKind;
use rand::{
    Rng,
    seq::{IteratorRandom, SliceRandom},
};
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use text::split_words;
use wayword_core::{Platform, SceneId, seeded_rng};
use wayword_experiments::episodes::{episode_path_name, read_episodes};
use wayword_formats::Episode;
use wayword_run::{error::CommandError, output::CommandOutput, platforms};
use wayword_world::survey_scene;

pub(crate) use text::clauses_around;

/// The text of another path counts as wrong only if that path ends at least this far from the goal of the text's own path,
/// metres.
const OTHER_GOAL_M: f64 = 3.0;

/// The flags of `corrupt-people`.
#[derive(Debug, Args)]
pub struct CorruptPeopleArgs {
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// File with the texts: R2R or REVERIE.
    #[arg(long)]
    episodes: PathBuf,
    /// Use only this building. May be given several times.
    #[arg(long)]
    scan: Vec<String>,
    /// Kinds of corruption. May be given several times.
    #[arg(long, value_parser = PossibleValuesParser::new(["all"].into_iter().chain(PeopleCorruptionKind::ALL.map(PeopleCorruptionKind::name))), default_value = "all")]
    kind: Vec<String>,
    /// Most texts of each kind.
    #[arg(long, default_value_t = 300)]
    count: usize,
    /// Seed of the choice.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// File for the corrupted texts. The changes go into FILE.key.json in the same folder.
    #[arg(long)]
    out: PathBuf,
}

/// A text with one of its turns flipped; `None` where it commands no turn.
pub(crate) fn flip_one_turn(text: &str, rng: &mut impl Rng) -> Option<String> {
    let edits = turns::flipped_turns(text, &split_words(text));
    let edit = edits.into_iter().choose(rng)?;
    Some(apply_edits(text, vec![edit])?.0)
}

/// Makes people's texts wrong, and writes them with their key.
///
/// # Errors
/// When the data or the texts cannot be read, no text can be changed in the ways that are asked for, or a file cannot be written.
pub fn write_corruptions(flags: &CorruptPeopleArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let platform = platforms::open_named("matterport", Some(&flags.data), None, None)?;
    let mut episodes = read_episodes(&flags.episodes, platform.as_ref())?;
    episodes.retain(|episode| flags.scan.is_empty() || flags.scan.iter().any(|scan| scan == episode.scene.as_str()));
    let known: BTreeSet<SceneId> = platform.list_scenes()?.into_iter().collect();
    episodes.retain(|episode| known.contains(&episode.scene));
    let is_asked = |kind: &PeopleCorruptionKind| flags.kind.iter().any(|name| name == "all" || name == kind.name());
    let kinds: Vec<PeopleCorruptionKind> = PeopleCorruptionKind::ALL.into_iter().filter(is_asked).collect();
    let buildings = survey_buildings(&episodes, platform.as_ref(), output)?;
    let (items, corruptions) = corrupt_texts(&episodes, &buildings, &kinds, flags.count, flags.seed);
    if items.is_empty() {
        let problem = format!("{}: no text of these buildings can be changed in these ways", flags.episodes.display());
        return Err(CommandError::usage(problem, "give other kinds, another --scan or another file"));
    }
    write_items(&flags.out, &items)?;
    let lines = kind_count_lines(&kinds, &corruptions);
    CorruptionKey::new(flags.seed, corruptions).write(&CorruptionKey::path_for_texts(&flags.out))?;
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// The rooms and objects of every building that the episodes are in.
fn survey_buildings(
    episodes: &[Episode],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<BTreeMap<SceneId, LabelledBuilding>, CommandError> {
    let scenes: BTreeSet<&SceneId> = episodes.iter().map(|episode| &episode.scene).collect();
    let bar = output.progress_bar(scenes.len(), "buildings");
    let known = scenes.into_par_iter().map(|scene| {
        let building = LabelledBuilding::new(&survey_scene(platform, scene)?);
        bar.inc(1);
        Ok::<_, CommandError>((scene.clone(), building))
    });
    let known = known.collect();
    bar.finish_and_clear();
    known
}

/// The corrupted texts, each as an item of its own, and the changes in each.
///
/// For each kind, all texts are tried in a random order until `count` of them could be corrupted.
fn corrupt_texts(
    episodes: &[Episode],
    buildings: &BTreeMap<SceneId, LabelledBuilding>,
    kinds: &[PeopleCorruptionKind],
    count: usize,
    seed: u64,
) -> (Vec<Episode>, Vec<TextCorruption>) {
    let texts = episodes.iter().flat_map(|episode| (0..episode.instructions.len()).map(move |place| (episode, place)));
    let texts: Vec<(&Episode, usize)> = texts.collect();
    let (mut items, mut corruptions) = (Vec::new(), Vec::new());
    for kind in kinds.iter().copied() {
        let mut drawn = texts.clone();
        drawn.shuffle(&mut seeded_rng(seed, &["corrupt people", kind.name()]));
        let mut made = 0;
        for (episode, place) in drawn {
            if made == count {
                break;
            }
            let Some(building) = buildings.get(&episode.scene) else { continue };
            let others = if kind == PeopleCorruptionKind::OtherPath {
                texts_of_other_paths(episode, episodes, building)
            } else {
                Vec::new()
            };
            let text = episode.instructions[place].as_str();
            let path = building.viewpoint_positions(&episode.viewpoints);
            let original = CorruptibleText { text, words: split_words(text), path, building, others: &others };
            let purpose = ["corrupt people", kind.name(), &episode.id, &place.to_string()];
            let edits = kind.draw_edits(&original, &mut seeded_rng(seed, &purpose));
            let Some((text, changes)) = edits.and_then(|edits| apply_edits(text, edits)) else { continue };
            let item = text_item(items.len(), episode, &text);
            corruptions.push(TextCorruption {
                item: item.target_object.as_ref().map_or(item.id.clone(), |object| format!("{}_{object}", item.id)),
                of: episode.id.clone(),
                instruction: place,
                path: episode_path_name(episode),
                kind: kind.name().to_owned(),
                changes,
            });
            items.push(item);
            made += 1;
        }
    }
    (items, corruptions)
}

/// The texts of all paths in the building of `episode` with another goal.
fn texts_of_other_paths<'e>(episode: &Episode, episodes: &'e [Episode], building: &LabelledBuilding) -> Vec<&'e str> {
    let goal = |episode: &Episode| {
        building.viewpoint_positions(&episode.viewpoints[episode.viewpoints.len().saturating_sub(1)..])
    };
    let own_goal = goal(episode);
    let is_other = |other: &&Episode| {
        other.scene == episode.scene && nearest_m(&own_goal, &goal(other)).is_some_and(|off_m| off_m >= OTHER_GOAL_M)
    };
    let others = episodes.iter().filter(is_other);
    others.flat_map(|episode| episode.instructions.iter().map(String::as_str)).collect()
}

fn kind_count_lines(kinds: &[PeopleCorruptionKind], corruptions: &[TextCorruption]) -> Vec<String> {
    let count =
        |kind: &PeopleCorruptionKind| corruptions.iter().filter(|corruption| corruption.kind == kind.name()).count();
    kinds.iter().map(|kind| format!("{:<18} {:>5}", kind.name(), count(kind))).collect()
}

#[cfg(test)]
mod tests;
