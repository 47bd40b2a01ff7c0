//! Splits scenes into those for training and those for evaluation. A split by scene, and not by path, keeps a model
//! from being evaluated in rooms that it was trained in.

use crate::{
    OfficialSplit,
    jsonl::{DatasetSplit, InstructionRecord},
};
use rand::RngCore;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::SceneId;

/// Puts every scene into one of the two splits, and every record into the split of its scene.
///
/// The share `val_share` (0 to 1, rounded) of each platform's scenes is for `val`. Each split has at least one scene
/// where the platform has two and the share is neither 0 nor 1. The choice depends on the seed and the names of the
/// scenes, not on the order of the records, and a scene that is added later moves few others.
///
/// Scenes that are officially held out for validation or test ([`OfficialSplit`]) come first, and are for `val` whatever the
/// share, so that none of them is trained on.
pub fn split_by_scene(records: &mut [InstructionRecord], val_share: f64, seed: u64) {
    let val = val_scenes(records, val_share, seed);
    for record in records {
        let in_val = val.get(&record.platform).is_some_and(|scenes| scenes.contains(&record.path.scene));
        record.split = Some(if in_val { DatasetSplit::Val } else { DatasetSplit::Train });
    }
}

/// The scenes for `val`, by platform.
fn val_scenes(records: &[InstructionRecord], val_share: f64, seed: u64) -> BTreeMap<String, BTreeSet<SceneId>> {
    // For each platform its scenes in the order in which `val` takes them: those that are held out, then by their lot.
    let mut ordered: BTreeMap<String, BTreeSet<(bool, u64, SceneId)>> = BTreeMap::new();
    for record in records {
        let (platform, scene) = (&record.platform, &record.path.scene);
        // A generator draws the number, because the derived seeds themselves are too similar where the names are.
        let lot = wayword_core::seeded_rng(seed, &["split", platform, scene.as_str()]).next_u64();
        ordered.entry(platform.clone()).or_default().insert((!is_held_out(scene), lot, scene.clone()));
    }
    let take_first = |(platform, scenes): (String, BTreeSet<(bool, u64, SceneId)>)| {
        let held_out = scenes.iter().filter(|(is_free, ..)| !is_free).count();
        let count = val_count(scenes.len(), val_share).max(held_out);
        (platform, scenes.into_iter().take(count).map(|(.., scene)| scene).collect())
    };
    ordered.into_iter().map(take_first).collect()
}

fn is_held_out(scene: &SceneId) -> bool {
    OfficialSplit::for_scene(scene).is_some_and(OfficialSplit::is_held_out)
}

/// How many of a platform's scenes are for `val`.
fn val_count(scenes: usize, share: f64) -> usize {
    let wanted = scenes as f64 * share.clamp(0.0, 1.0);
    let rounded = (1..=scenes).take_while(|count| *count as f64 - 0.5 <= wanted).count();
    let needs_both = share > 0.0 && share < 1.0 && scenes > 1;
    if needs_both { rounded.clamp(1, scenes - 1) } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_split_gets_a_scene_where_there_are_two() {
        assert_eq!([val_count(2, 0.01), val_count(2, 0.99), val_count(10, 0.2)], [1, 1, 2]);
        assert_eq!([val_count(5, 0.0), val_count(5, 1.0), val_count(1, 0.1), val_count(0, 0.5)], [0, 5, 0, 0]);
        assert_eq!(val_count(5, f64::NAN), 0);
    }
}
