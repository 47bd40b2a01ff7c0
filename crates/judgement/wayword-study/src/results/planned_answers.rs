//! Plans who will answer which item, as the site hands items out: the least filled item first, then the condition that a person had least,
//! and no route twice for one person.

use crate::{StudyItem, StudyTask};
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::PlannedAnswer;

/// An item of a planned study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PlannedItem {
    /// The number of its route.
    route: usize,
    /// The numbers of the conditions of its texts: one, or two where texts are compared.
    conditions: Vec<usize>,
}

impl PlannedItem {
    /// Whether it has a text of a condition.
    pub(super) fn is_about(&self, condition: usize) -> bool {
        self.conditions.contains(&condition)
    }
}

/// The items of a study in which each of `routes` routes has a text of every condition.
pub(super) fn full_items(routes: usize, conditions: usize, mode: StudyTask) -> Vec<PlannedItem> {
    let texts: Vec<Vec<usize>> = match mode {
        StudyTask::Pair => (0..conditions).flat_map(|a| (a + 1..conditions).map(move |b| vec![a, b])).collect(),
        StudyTask::Follow | StudyTask::Rate => (0..conditions).map(|condition| vec![condition]).collect(),
    };
    let on_route = |route| texts.iter().map(move |conditions| PlannedItem { route, conditions: conditions.clone() });
    (0..routes).flat_map(on_route).collect()
}

/// The items of a study that was made. Practice is left out.
pub(super) fn items_of_study(items: &[StudyItem], conditions: &[&str]) -> Vec<PlannedItem> {
    let planned = |item: &StudyItem| PlannedItem {
        route: item.route as usize,
        conditions: item
            .texts
            .iter()
            .filter_map(|text| conditions.iter().position(|name| *name == text.condition))
            .collect(),
    };
    items.iter().filter(|item| !item.is_practice).map(planned).collect()
}

/// The routes of items.
pub(super) fn count_routes(items: &[PlannedItem]) -> usize {
    items.iter().map(|item| item.route).collect::<BTreeSet<_>>().len()
}

/// How many answers `persons` persons give with `per_person` items each, as far as items and routes allow.
pub(super) fn count_answers(items: &[PlannedItem], persons: usize, per_person: usize) -> usize {
    persons * per_person.min(count_routes(items))
}

/// The answers about the first two conditions, of `answers` answers that `persons` persons give in turns. Where texts are compared, these are the
/// comparisons of the two.
pub(super) fn plan_answers(items: &[PlannedItem], persons: usize, answers: usize, seed: u64) -> Vec<PlannedAnswer> {
    let mut filled = vec![0_usize; items.len()];
    let mut planned = Vec::new();
    for person in 0..persons {
        // Shares of persons differ by one answer at most.
        let own = answers * (person + 1) / persons - answers * person / persons;
        let (mut routes, mut uses) = (BTreeSet::new(), BTreeMap::<usize, usize>::new());
        for _ in 0..own {
            let key = |(number, item): &(usize, &PlannedItem)| {
                let condition_uses: usize = item.conditions.iter().map(|one| uses.get(one).copied().unwrap_or(0)).sum();
                (filled[*number], condition_uses, drawn_order(seed, person, *number))
            };
            let open = items.iter().enumerate().filter(|(_, item)| !routes.contains(&item.route));
            let Some((number, item)) = open.min_by_key(key) else { break };
            filled[number] += 1;
            routes.insert(item.route);
            item.conditions.iter().for_each(|one| *uses.entry(*one).or_default() += 1);
            let is_second = match item.conditions[..] {
                [0] | [0, 1] | [1, 0] => Some(false),
                [1] => Some(true),
                _ => None,
            };
            planned.extend(is_second.map(|is_second| PlannedAnswer { person, item: item.route, is_second }));
        }
    }
    planned
}

/// A number that orders equally good items, other for each person: the steps of splitmix64.
fn drawn_order(seed: u64, person: usize, item: usize) -> u64 {
    let mut mixed = seed ^ ((person as u64) << 32) ^ item as u64;
    for _ in 0..2 {
        mixed = mixed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_fill_evenly_and_nobody_gets_a_route_twice() {
        for mode in [StudyTask::Follow, StudyTask::Pair] {
            let items = full_items(12, 2, mode);
            let answers = count_answers(&items, 30, 6);
            let planned = plan_answers(&items, 30, answers, 3);
            assert_eq!(planned.len(), 180);
            let places: BTreeSet<(usize, usize)> = planned.iter().map(|answer| (answer.person, answer.item)).collect();
            assert_eq!(places.len(), 180);
            let mut filled = BTreeMap::<(usize, bool), usize>::new();
            planned.iter().for_each(|answer| *filled.entry((answer.item, answer.is_second)).or_default() += 1);
            let (least, most) = (filled.values().min().unwrap(), filled.values().max().unwrap());
            assert!(most - least <= 1, "{mode:?} {filled:?}");
        }
    }

    #[test]
    fn persons_answer_about_both_conditions_equally_often() {
        let planned = plan_answers(&full_items(60, 2, StudyTask::Rate), 60, 600, 1);
        for person in 0..60 {
            let own: Vec<_> = planned.iter().filter(|answer| answer.person == person).collect();
            let seconds = own.iter().filter(|answer| answer.is_second).count();
            assert!(own.len() == 10 && (4..=6).contains(&seconds), "{seconds} of {}", own.len());
        }
    }

    #[test]
    fn only_answers_about_the_first_two_conditions_are_kept() {
        let planned = plan_answers(&full_items(10, 3, StudyTask::Follow), 10, 60, 1);
        assert_eq!(planned.len(), 40);
        assert_eq!(plan_answers(&full_items(10, 3, StudyTask::Pair), 10, 60, 1).len(), 20);
        assert!(plan_answers(&[], 3, 0, 1).is_empty());
    }
}
