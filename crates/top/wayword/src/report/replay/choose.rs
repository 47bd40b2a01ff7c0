//! Which walks are shown: some of each agent and set, successes and failures, as many of the one as of the other.

use std::collections::BTreeMap;
use wayword_navigation::walk::Walk;

/// Most agents and sets, successes and failures apart, of which walks are shown.
const MOST_GROUPS: usize = 1_000;

/// A sample of walks, taken while they pass by: what is kept of each says where it can be found again.
#[derive(Debug, Clone)]
pub struct Sample<T> {
    most: usize,
    groups: BTreeMap<Group, Vec<T>>,
    /// How many walks passed by.
    offered: usize,
}

/// Walks that are alike: by swapped texts, agent, set, success.
type Group = (bool, String, String, bool);

impl<T: Ord> Sample<T> {
    /// A sample of at most so many walks.
    #[must_use]
    pub fn of(most: usize) -> Self {
        Self { most, groups: BTreeMap::new(), offered: 0 }
    }

    /// A walk passes by.
    pub fn offer(&mut self, walk: &Walk, is_success: bool, place: T) {
        self.offered += 1;
        // The sets of walks by swapped texts are named SET~SWAP.
        let group = (walk.set.contains('~'), walk.agent.clone(), walk.set.clone(), is_success);
        if self.groups.len() >= MOST_GROUPS && !self.groups.contains_key(&group) {
            return;
        }
        let kept = self.groups.entry(group).or_default();
        if kept.len() < self.most {
            kept.push(place);
        }
    }

    /// The places of the chosen walks, in their order, and how many walks are left out.
    #[must_use]
    pub fn chosen(self) -> (Vec<T>, usize) {
        let mut groups: Vec<_> = self.groups.into_values().map(Vec::into_iter).collect();
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
    use wayword_navigation::walk::End;

    fn walk(agent: &str, set: &str) -> Walk {
        Walk {
            agent: agent.into(),
            set: set.into(),
            item: "1".into(),
            text_index: 0,
            text: String::new(),
            scene: SceneId::new("s").unwrap(),
            directions: None,
            steps: vec![],
            end: End::Stopped,
            object: None,
        }
    }

    #[test]
    fn what_is_rare_is_shown_too() {
        let mut sample = Sample::of(4);
        for at in 0..50 {
            sample.offer(&walk("a", "original"), at == 40, at);
            sample.offer(&walk("b", "original"), false, 100 + at);
        }
        assert_eq!(sample.chosen(), (vec![0, 1, 40, 100], 96));
    }

    #[test]
    fn swapped_texts_come_last_and_nothing_is_shown_where_nothing_is_wanted() {
        let mut sample = Sample::of(1);
        sample.offer(&walk("a", "original~directions"), true, 1);
        sample.offer(&walk("b", "original"), true, 2);
        assert_eq!(sample.clone().chosen(), (vec![2], 1));
        sample.most = 0;
        assert_eq!(sample.chosen(), (vec![], 2));
    }
}
