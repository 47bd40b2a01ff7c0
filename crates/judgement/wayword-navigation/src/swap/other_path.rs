//! Chooses the item with the instruction that replaces another item's, for the swap [`OtherPath`](super::InstructionSwap::OtherPath).

use rand::Rng;
use wayword_core::{SceneId, ViewpointId, seeded_rng};

/// An item with an instruction that could replace another item's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SwapCandidate {
    /// The item's id.
    pub id: String,
    /// Its building.
    pub scene: SceneId,
    /// Where its path ends.
    pub goal: ViewpointId,
    /// Its path: items on one path are one cluster.
    pub cluster: String,
}

/// Chooses the item that gives its instruction to item `at`: one of the same building, with another path and goal, for which
/// `is_far(item at, other)` is true. `None` if there is none.
#[must_use]
pub fn other_path(
    items: &[SwapCandidate],
    at: usize,
    seed: u64,
    is_far: &dyn Fn(&SwapCandidate, &SwapCandidate) -> bool,
) -> Option<usize> {
    let item = items.get(at)?;
    let is_other = |other: &SwapCandidate| {
        other.scene == item.scene && other.cluster != item.cluster && other.goal != item.goal && is_far(item, other)
    };
    let others: Vec<usize> = (0..items.len()).filter(|other| is_other(&items[*other])).collect();
    let chosen = seeded_rng(seed, &["swap", "other-path", &item.id]).random_range(0..others.len().max(1));
    others.get(chosen).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items() -> Vec<SwapCandidate> {
        let item = |(id, scene, goal, cluster): (&str, &str, &str, &str)| SwapCandidate {
            id: id.to_owned(),
            scene: SceneId::new(scene).unwrap(),
            goal: ViewpointId::new(goal).unwrap(),
            cluster: cluster.to_owned(),
        };
        [
            ("a", "s", "1", "p"),
            ("b", "s", "2", "p"),
            ("c", "s", "1", "q"),
            ("d", "t", "3", "r"),
            ("e", "s", "4", "x"),
            ("f", "s", "5", "y"),
        ]
        .map(item)
        .to_vec()
    }

    #[test]
    fn another_path_is_of_the_building_with_another_goal_and_far() {
        let items = items();
        let chosen: Vec<usize> = (0..50).map(|seed| other_path(&items, 0, seed, &|_, _| true).unwrap()).collect();
        assert!(chosen.iter().all(|at| [4, 5].contains(at)) && chosen.contains(&4) && chosen.contains(&5));
        assert_eq!(other_path(&items, 0, 1, &|item, other| item.id == "a" && other.id == "e"), Some(4));
        assert_eq!(other_path(&items, 0, 1, &|_, _| false), None);
        assert_eq!(other_path(&items, 3, 1, &|_, _| true), None);
        assert_eq!(other_path(&items, 9, 1, &|_, _| true), None);
    }

    #[test]
    fn other_path_depends_only_on_seed_and_item() {
        let items = items();
        let choose = |at: usize, seed: u64| other_path(&items, at, seed, &|_, _| true);
        assert_eq!(
            (0..9).map(|seed| choose(1, seed)).collect::<Vec<_>>(),
            (0..9).map(|seed| choose(1, seed)).collect::<Vec<_>>()
        );
    }
}
