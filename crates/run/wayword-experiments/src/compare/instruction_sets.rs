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

/// An instruction.
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
    kept: &ComparisonSettings,
    platform: &dyn Platform,
    demands: &PlatformDemands<'_>,
) -> Result<(Vec<ComparisonItem>, Vec<usize>, usize), CommandError> {
    let mut episodes = episodes::read_episodes(&kept.episodes, platform)?;
    episodes.truncate(kept.limit.unwrap_or(usize::MAX));
    let ids: BTreeSet<String> = episodes.iter().map(|episode| episode.id.clone()).collect();
    let mut all: Vec<(&str, BTreeMap<String, Vec<String>>)> = Vec::new();
    for (name, source) in &kept.instructions {
        // The texts of the episodes are read like any set, because styles must not be mixed there either.
        let source = if source.is_empty() { kept.episodes.to_string_lossy().into_owned() } else { source.clone() };
        let mut texts = texts_of(&source)?;
        texts.retain(|item, texts| ids.contains(item) && !texts.is_empty());
        all.push((name, texts));
    }
    let of_episodes = episodes.len();
    episodes.retain(|episode| all.iter().all(|(_, texts)| texts.contains_key(&episode.id)));
    if episodes.is_empty() {
        let problem = "the sets of instructions and the episodes have no item in common";
        return Err(CommandError::usage(
            problem,
            "items are matched by id: give runs that were made with the same --episodes",
        ));
    }
    let sizes = all.iter().map(|(_, texts)| texts.len()).collect();
    let mut items: Vec<ComparisonItem> = episodes.into_iter().map(|episode| item_with_texts(episode, &all)).collect();
    add_swaps(&mut items, kept, demands)?;
    Ok((items, sizes, of_episodes))
}

/// Describes each set by its texts for the items that were walked: their number and their mean length.
pub(super) fn describe_sets(
    kept: &ComparisonSettings,
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
        let source = if source.is_empty() { kept.episodes.to_string_lossy().into_owned() } else { source.clone() };
        InstructionSet {
            name: name.clone(),
            source: last_part(&source),
            texts: texts().count(),
            left_out: size - items.len(),
            words: words as f64 / texts().count().max(1) as f64,
        }
    };
    kept.instructions.iter().zip(sizes).map(describe).collect()
}

fn texts_of(source: &str) -> Result<BTreeMap<String, Vec<String>>, CommandError> {
    Ok(text_sets::read_text_set(source, None, TextPairing::Item)?
        .into_iter()
        .map(|(item, texts)| (item, texts.texts))
        .collect())
}

/// Joins an episode with its texts of some sets.
pub(super) fn item_with_texts(episode: Episode, sets: &[(&str, BTreeMap<String, Vec<String>>)]) -> ComparisonItem {
    let of_set = |(set, texts): &(&str, BTreeMap<String, Vec<String>>)| {
        let of_item = |(index, text): (usize, &String)| ComparisonText {
            set: (*set).to_owned(),
            index,
            text: text.clone(),
            purpose: TextPurpose::Set,
        };
        texts.get(&episode.id).into_iter().flatten().enumerate().map(of_item).collect::<Vec<_>>()
    };
    let texts = sets.iter().flat_map(of_set).collect();
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
    kept: &ComparisonSettings,
    demands: &PlatformDemands<'_>,
) -> Result<(), CommandError> {
    let Some((first, _)) = kept.instructions.first() else { return Ok(()) };
    let of_first: Vec<Vec<String>> = items
        .iter()
        .map(|item| item.texts.iter().filter(|text| text.set == *first).map(|text| text.text.clone()).collect())
        .collect();
    // Without a swap test, another path's text is only for the agent that knows the map.
    let is_floor = kept.knows_map() && !kept.swaps.contains(&InstructionSwap::OtherPath);
    let swaps: Vec<InstructionSwap> =
        kept.swaps.iter().copied().chain(is_floor.then_some(InstructionSwap::OtherPath)).collect();
    let elsewhere =
        if swaps.contains(&InstructionSwap::OtherPath) { other_items(items, kept, demands)? } else { Vec::new() };
    for (at, item) in items.iter_mut().enumerate() {
        for swap in &swaps {
            let purpose =
                if is_floor && *swap == InstructionSwap::OtherPath { TextPurpose::Floor } else { TextPurpose::Swap };
            for (index, text) in of_first[at].iter().enumerate() {
                let wrong = match swap {
                    InstructionSwap::OtherPath => elsewhere.get(at).copied().flatten().and_then(|other| {
                        let texts = &of_first[other];
                        texts.get(index % texts.len().max(1)).cloned()
                    }),
                    swap => swap_text(*swap, text, kept.seed, &format!("{}_{index}", item.episode.id)),
                };
                let added = |text| ComparisonText { set: swapped_set(first, *swap), index, text, purpose };
                item.texts.extend(wrong.map(added));
            }
        }
        if kept.knows_map() {
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
    kept: &ComparisonSettings,
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
    Ok((0..items.len()).map(|at| other_path(&candidates, at, kept.seed, &is_far)).collect())
}
