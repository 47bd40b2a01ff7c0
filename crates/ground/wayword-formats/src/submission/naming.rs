//! The names that agents give instructions. Loaders make them in several ways; all names of a file are made in one.

use super::{SubmissionReading, instr_id};
use crate::Episode;
use std::collections::{BTreeMap, BTreeSet};

/// How a file names its instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionNaming {
    /// The item and the place of the instruction in it, as [`instr_id`] has it.
    ItemAndPlace,
    /// The item alone, where each item is one instruction: RxR's `instruction_id`, and files that a loader has split.
    Item,
    /// The path and the item, where each item is one instruction: VLN-HAMT's names for RxR.
    PathAndItem,
    /// The path, its object, and the place of the instruction in the item: VLN-DUET's names for REVERIE, whatever the
    /// `id` of the item.
    PathObjectAndPlace,
}

impl InstructionNaming {
    /// All ways but the first.
    const OTHERS: [Self; 3] = [Self::Item, Self::PathAndItem, Self::PathObjectAndPlace];

    /// How the names are made, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::ItemAndPlace => "the item and the place of the instruction in it",
            Self::Item => "the item alone",
            Self::PathAndItem => "the path and the item",
            Self::PathObjectAndPlace => "the path, the object and the place of the instruction",
        }
    }

    /// The name of an instruction, made in this way; `None` where the item has not what it takes.
    fn name_instruction(self, episode: &Episode, place: usize) -> Option<String> {
        let is_single = episode.instructions.len() == 1;
        match self {
            Self::ItemAndPlace => Some(instr_id(episode, place)),
            Self::Item => is_single.then(|| episode.id.clone()),
            Self::PathAndItem => is_single.then(|| format!("{}_{}", episode.path_id, episode.id)),
            Self::PathObjectAndPlace => {
                episode.target_object.as_ref().map(|object| format!("{}_{object}_{place}", episode.path_id))
            }
        }
    }

    /// The names of all instructions, made in this way, with those of [`instr_id`]; `None` where two would be the same.
    fn names_of(self, episodes: &[Episode]) -> Option<BTreeMap<String, String>> {
        let mut names = BTreeMap::new();
        for episode in episodes {
            for place in 0..episode.instructions.len() {
                let Some(name) = self.name_instruction(episode, place) else { continue };
                if names.insert(name, instr_id(episode, place)).is_some() {
                    return None;
                }
            }
        }
        Some(names)
    }
}

/// Gives the trajectories of a file the names that [`instr_id`] makes for the episodes, where the file makes them in
/// another way. The way has to explain every name of the file, and only one way may; else the names stay as they are.
/// Returns how the file makes them.
#[must_use]
pub fn name_as_episodes(reading: &mut SubmissionReading, episodes: &[Episode]) -> InstructionNaming {
    let given: Vec<&String> =
        reading.submitted.iter().map(|submitted| &submitted.instr_id).chain(&reading.flawed).collect();
    let known: BTreeSet<String> = episodes
        .iter()
        .flat_map(|episode| (0..episode.instructions.len()).map(|place| instr_id(episode, place)))
        .collect();
    if given.iter().all(|name| known.contains(*name)) {
        return InstructionNaming::ItemAndPlace;
    }
    let ways = InstructionNaming::OTHERS.into_iter().filter_map(|way| Some((way, way.names_of(episodes)?)));
    let fitting: Vec<_> = ways.filter(|(_, names)| given.iter().all(|name| names.contains_key(*name))).collect();
    let [(way, names)] = fitting.as_slice() else { return InstructionNaming::ItemAndPlace };
    let named = reading.submitted.iter_mut().map(|submitted| &mut submitted.instr_id).chain(&mut reading.flawed);
    for name in named {
        if let Some(as_episodes) = names.get(name) {
            name.clone_from(as_episodes);
        }
    }
    *way
}
