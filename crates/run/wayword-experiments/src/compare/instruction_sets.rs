//! Reads the sets of instructions, joins them by item, and adds deliberately wrong texts for the swap tests.

use super::settings::{ComparisonSettings, last_part};
use crate::{
    demands::{PlatformDemands, SAME_GOAL_M},
    episodes,
    similarity::args::TextPairing,
    text_sets,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::Platform;
use wayword_formats::Episode;
use wayword_language::text::word_count;
use wayword_metrics::SceneDistances;
use wayword_navigation::{
    agents::AgentStart,
    comparison::{InstructionSet, empty_set, swapped_set},
    swap::{InstructionSwap, SwapCandidate, other_path, swap_text},
};
use wayword_run::error::CommandError;

/// An item for which every set has a text.
#[derive(Debug)]
pub(super) struct ComparisonItem {
    pub(super) episode: Episode,
    pub(super) start: AgentStart,
    /// Its instructions in the order of the sets, then the swapped ones of the first set.
    pub(super) texts: Vec<ComparisonText>,
}

/// An instruction of a set, by which agents walk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ComparisonText {
    pub(super) set: String,
    /// Its index among the item's texts in that set.
    pub(super) index: usize,
    pub(super) text: String,
    /// The use of the text.
    pub(super) purpose: TextPurpose,
}

/// The use of a text, which decides which agents walk by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum TextPurpose {
    /// A text of a set, for every agent that reads.
    Set,
    /// A swapped text of the first set, for the swap tests.
    Swap,
    /// A text that does not describe the path. It shows what an agent reaches by knowing the map alone.
    Floor,
}

/// Reads the items that all sets have in common. Returns them, the number of items of each set, and the number of episodes.
///
/// # Errors
/// When a set cannot be read, or the sets have no item in common.
pub(super) fn load_items(
    config: &ComparisonSettings,
    platform: &dyn Platform,
    demands: &PlatformDemands<'_>,
) -> Result<(Vec<ComparisonItem>, Vec<usize>, usize), CommandError> {
    let mut episodes = episodes::read_episodes(&config.episodes, platform)?;
    episodes.truncate(config.limit.unwrap_or(usize::MAX));
    let ids: BTreeSet<String> = episodes.iter().map(|episode| episode.id.clone()).collect();
    let mut sets: Vec<(&str, BTreeMap<String, Vec<String>>)> = Vec::new();
    for (name, source) in &config.instructions {
        // The texts of the episodes are read like any set, because styles must not be mixed there either.
        let source = if source.is_empty() { config.episodes.to_string_lossy().into_owned() } else { source.clone() };
        let mut texts = read_set_texts(&source)?;
        texts.retain(|item, texts| ids.contains(item) && !texts.is_empty());
        sets.push((name, texts));
    }
    let episode_count = episodes.len();
    episodes.retain(|episode| sets.iter().all(|(_, texts)| texts.contains_key(&episode.id)));
    if episodes.is_empty() {
        let problem = "the sets of instructions and the episodes have no item in common";
        return Err(CommandError::usage(
            problem,
            "items are matched by id: give runs that were made with the same --episodes",
        ));
    }
    let sizes = sets.iter().map(|(_, texts)| texts.len()).collect();
    let mut items: Vec<ComparisonItem> = episodes.into_iter().map(|episode| item_with_texts(episode, &sets)).collect();
    add_swaps(&mut items, config, demands)?;
    Ok((items, sizes, episode_count))
}

/// Describes each set by its texts for the items that were walked: their number and their mean length.
pub(super) fn describe_sets(
    config: &ComparisonSettings,
    items: &[ComparisonItem],
    sizes: &[usize],
    is_walked: impl Fn(&str) -> bool,
) -> Vec<InstructionSet> {
    let describe = |((name, source), size): (&(String, String), &usize)| {
        let texts = || {
            let walked = items.iter().filter(|item| is_walked(&item.episode.id));
            walked.flat_map(|item| &item.texts).filter(|text| text.set == *name)
        };
        let words: usize = texts().map(|text| word_count(&text.text)).sum();
        let source = if source.is_empty() { config.episodes.to_string_lossy().into_owned() } else { source.clone() };
        InstructionSet {
            name: name.clone(),
            source: last_part(&source),
            texts: texts().count(),
            left_out: size - items.len(),
            words: words as f64 / texts().count().max(1) as f64,
        }
    };
    config.instructions.iter().zip(sizes).map(describe).collect()
}

fn read_set_texts(source: &str) -> Result<BTreeMap<String, Vec<String>>, CommandError> {
    Ok(text_sets::read_text_set(source, None, TextPairing::Item)?
        .into_iter()
        .map(|(item, texts)| (item, texts.texts))
        .collect())
}

/// Joins an episode with its texts of some sets.
pub(super) fn item_with_texts(episode: Episode, sets: &[(&str, BTreeMap<String, Vec<String>>)]) -> ComparisonItem {
    let texts_in_set = |(set, texts): &(&str, BTreeMap<String, Vec<String>>)| {
        let to_text = |(index, text): (usize, &String)| ComparisonText {
            set: (*set).to_owned(),
            index,
            text: text.clone(),
            purpose: TextPurpose::Set,
        };
        texts.get(&episode.id).into_iter().flatten().enumerate().map(to_text).collect::<Vec<_>>()
    };
    let texts = sets.iter().flat_map(texts_in_set).collect();
    let start = AgentStart {
        scene: episode.scene.clone(),
        viewpoint: episode.viewpoints[0].clone(),
        heading: episode.start_heading.unwrap_or(wayword_core::Heading::NORTH),
    };
    ComparisonItem { episode, start, texts }
}

/// Adds a swapped version of each text of the first set for every swap, unless the swap leaves the text as it is.
fn add_swaps(
    items: &mut [ComparisonItem],
    config: &ComparisonSettings,
    demands: &PlatformDemands<'_>,
) -> Result<(), CommandError> {
    let Some((first, _)) = config.instructions.first() else { return Ok(()) };
    let first_set_texts: Vec<Vec<String>> = items
        .iter()
        .map(|item| item.texts.iter().filter(|text| text.set == *first).map(|text| text.text.clone()).collect())
        .collect();
    // Without a swap test, another path's text is only for the agent that knows the map.
    let is_floor = config.knows_map() && !config.swaps.contains(&InstructionSwap::OtherPath);
    let swaps: Vec<InstructionSwap> =
        config.swaps.iter().copied().chain(is_floor.then_some(InstructionSwap::OtherPath)).collect();
    let other_indices =
        if swaps.contains(&InstructionSwap::OtherPath) { other_items(items, config, demands)? } else { Vec::new() };
    for (at, item) in items.iter_mut().enumerate() {
        for swap in &swaps {
            let purpose =
                if is_floor && *swap == InstructionSwap::OtherPath { TextPurpose::Floor } else { TextPurpose::Swap };
            for (index, text) in first_set_texts[at].iter().enumerate() {
                let swapped = match swap {
                    InstructionSwap::OtherPath => other_indices.get(at).copied().flatten().and_then(|other| {
                        let texts = &first_set_texts[other];
                        texts.get(index % texts.len().max(1)).cloned()
                    }),
                    swap => swap_text(*swap, text, config.seed, &format!("{}_{index}", item.episode.id)),
                };
                let to_text = |text| ComparisonText { set: swapped_set(first, *swap), index, text, purpose };
                item.texts.extend(swapped.map(to_text));
            }
        }
        if config.knows_map() {
            // The empty text shows what the agent reaches by its knowledge of the map alone.
            item.texts.push(ComparisonText {
                set: empty_set(first),
                index: 0,
                text: String::new(),
                purpose: TextPurpose::Floor,
            });
        }
    }
    Ok(())
}

/// For each item, the index of another item in the same scene with another path and goal; `None` if there is none.
fn other_items(
    items: &[ComparisonItem],
    config: &ComparisonSettings,
    demands: &PlatformDemands<'_>,
) -> Result<Vec<Option<usize>>, CommandError> {
    let mut distances: BTreeMap<&wayword_core::SceneId, std::sync::Arc<SceneDistances>> = BTreeMap::new();
    for item in items {
        distances.insert(&item.episode.scene, demands.scene_distances(&item.episode.scene)?);
    }
    let candidates: Vec<SwapCandidate> = items
        .iter()
        .map(|item| SwapCandidate {
            id: item.episode.id.clone(),
            scene: item.episode.scene.clone(),
            goal: item.episode.viewpoints[item.episode.viewpoints.len() - 1].clone(),
            cluster: episodes::episode_path_name(&item.episode),
        })
        .collect();
    let is_far = |a: &SwapCandidate, b: &SwapCandidate| {
        distances[&a.scene].metres_between(&a.goal, &b.goal).is_none_or(|apart_m| apart_m >= SAME_GOAL_M)
    };
    Ok((0..items.len()).map(|at| other_path(&candidates, at, config.seed, &is_far)).collect())
}
