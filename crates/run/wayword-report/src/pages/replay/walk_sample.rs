//! Chooses the walks that are shown: in turn from each agent and set, a success and a failure, so that rare ones are shown too.

use std::collections::BTreeMap;
use wayword_navigation::walk::AgentWalkRecord;

/// Most groups (agent, set, success or failure) from which walks are shown.
const MAX_GROUPS: usize = 1_000;

/// A sample of walks, taken while they are read. It keeps the positions of walks, not the walks.
#[derive(Debug, Clone)]
pub struct WalkSample<T> {
    /// The largest number of walks that are chosen.
    most: usize,
    groups: BTreeMap<WalkGroupKey, WalkGroup<T>>,
    /// Number of walks that were offered.
    offered: usize,
}

/// Walks of a group, one of each item, because a walk of another item shows more than a second one of the same item.
#[derive(Debug, Clone)]
struct WalkGroup<T> {
    /// The item of the last walk that was taken. Walks are offered item by item.
    last_item: String,
    places: Vec<T>,
}

/// The key of walks that are alike: whether they are by swapped texts, agent, set, and whether they are successes.
type WalkGroupKey = (bool, String, String, bool);

impl<T: Ord> WalkSample<T> {
    /// A sample of at most `most` walks.
    #[must_use]
    pub fn with_limit(most: usize) -> Self {
        Self { most, groups: BTreeMap::new(), offered: 0 }
    }

    /// Offers a walk to the sample.
    pub fn offer_walk(&mut self, walk: &AgentWalkRecord, is_success: bool, place: T) {
        self.offered += 1;
        // The sets of walks by swapped texts are named SET~SWAP.
        let group = (walk.set.contains('~'), walk.agent.clone(), walk.set.clone(), is_success);
        if self.groups.len() >= MAX_GROUPS && !self.groups.contains_key(&group) {
            return;
        }
        let kept =
            self.groups.entry(group).or_insert_with(|| WalkGroup { last_item: String::new(), places: Vec::new() });
        if kept.places.len() < self.most && kept.last_item != walk.item {
            kept.places.push(place);
            kept.last_item.clone_from(&walk.item);
        }
    }

    /// The positions of the chosen walks in their order, and the number of walks that are left out.
    #[must_use]
    pub fn into_chosen(self) -> (Vec<T>, usize) {
        let mut groups: Vec<_> = self.groups.into_values().map(|kept| kept.places.into_iter()).collect();
        let mut chosen = Vec::new();
        loop {
            let before = chosen.len();
            let round = groups.iter_mut().filter_map(Iterator::next);
            chosen.extend(round.take(self.most - before));
            if chosen.len() == before {
                break;
            }
        }
        chosen.sort();
        let left_out = self.offered - chosen.len();
        (chosen, left_out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::SceneId;
    use wayword_navigation::walk::WalkEnd;

    fn walk(agent: &str, set: &str, item: usize) -> AgentWalkRecord {
        AgentWalkRecord {
            agent: agent.into(),
            set: set.into(),
            item: item.to_string(),
            text_index: 0,
            text: String::new(),
            scene: SceneId::new("s").unwrap(),
            directions: None,
            steps: vec![],
            end: WalkEnd::Stopped,
            object: None,
            effort: None,
        }
    }

    #[test]
    fn sample_includes_rare_outcomes() {
        let mut sample = WalkSample::with_limit(4);
        for at in 0..50 {
            sample.offer_walk(&walk("a", "original", at), at == 40, at);
            sample.offer_walk(&walk("b", "original", at), false, 100 + at);
        }
        assert_eq!(sample.into_chosen(), (vec![0, 1, 40, 100], 96));
    }

    #[test]
    fn an_item_is_shown_once_for_each_agent_and_outcome() {
        let mut sample = WalkSample::with_limit(9);
        for at in 0..6 {
            sample.offer_walk(&walk("a", "original", at / 3), at == 2, at);
        }
        assert_eq!(sample.into_chosen(), (vec![0, 2, 3], 3));
    }

    #[test]
    fn sample_puts_swapped_texts_last_and_can_be_empty() {
        let mut sample = WalkSample::with_limit(1);
        sample.offer_walk(&walk("a", "original~directions", 1), true, 1);
        sample.offer_walk(&walk("b", "original", 1), true, 2);
        assert_eq!(sample.clone().into_chosen(), (vec![2], 1));
        sample.most = 0;
        assert_eq!(sample.into_chosen(), (vec![], 2));
    }
}
