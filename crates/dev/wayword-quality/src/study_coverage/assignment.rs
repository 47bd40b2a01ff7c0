//! Assigns the items of a simulated study to persons, and sets how much persons and items differ.

use rand::{Rng, seq::SliceRandom};
use serde::Serialize;
use std::fmt;

/// The number of items of a simulated study.
pub(super) const STUDY_ITEM_COUNT: usize = 60;

/// How many people give how many answers each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) struct SimulatedDesign {
    /// The number of persons.
    pub(super) persons: usize,
    /// The number of answers of each person.
    pub(super) each: usize,
}

impl fmt::Display for SimulatedDesign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {}", self.persons, self.each)
    }
}

/// How much persons differ from each other, and items as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum EffectSize {
    /// All persons are alike, and all items.
    None,
    /// By 0.75 logits, as a standard deviation.
    Middle,
    /// By 1.5 logits, as a standard deviation.
    Large,
}

impl EffectSize {
    pub(super) const ALL: [Self; 3] = [Self::None, Self::Middle, Self::Large];

    /// The standard deviation of persons, and also of items, on the logit scale.
    pub(super) fn sd_logits(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Middle => 0.75,
            Self::Large => 1.5,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Middle => "middle",
            Self::Large => "large",
        }
    }
}

/// An answer that a person is to give.
#[derive(Debug, Clone, Copy)]
pub(super) struct AnswerSlot {
    pub(super) person: usize,
    pub(super) item: usize,
    /// Whether it is about the second condition of a comparison, and not the first.
    pub(super) is_second: bool,
}

/// Assigns items as a real study does: each person gets the items with the fewest answers, at random among equals, and none twice. Half of
/// a person's answers and about half of an item's answers are about the second condition.
pub(super) fn assign_slots(design: SimulatedDesign, rng: &mut impl Rng) -> Vec<AnswerSlot> {
    let mut filled = [0_usize; STUDY_ITEM_COUNT];
    let mut seconds = [0_usize; STUDY_ITEM_COUNT];
    let mut slots = Vec::with_capacity(design.persons * design.each);
    for person in 0..design.persons {
        let mut items: Vec<usize> = (0..STUDY_ITEM_COUNT).collect();
        items.shuffle(rng);
        items.sort_by_key(|item| filled[*item]);
        items.truncate(design.each);
        // The items with the fewest answers about the second condition get one. Persons with an odd number of answers take turns: one
        // answers once more about the first condition, the next once more about the second.
        items.sort_by_key(|item| 2 * seconds[*item] as i64 - filled[*item] as i64);
        let half = (design.each + person % 2) / 2;
        for (at, item) in items.into_iter().enumerate() {
            let is_second = at < half;
            filled[item] += 1;
            seconds[item] += usize::from(is_second);
            slots.push(AnswerSlot { person, item, is_second });
        }
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn assigned_gives_no_person_an_item_twice_and_fills_items_evenly() {
        for (persons, each) in [(30, 1), (30, 10), (60, 5)] {
            let slots = assign_slots(SimulatedDesign { persons, each }, &mut wayword_core::seeded_rng(1, &["test"]));
            let places: BTreeSet<(usize, usize)> = slots.iter().map(|slot| (slot.person, slot.item)).collect();
            assert_eq!((slots.len(), places.len()), (persons * each, persons * each));
            let answers = |item: usize| slots.iter().filter(|slot| slot.item == item).count();
            let (fewest, most) = ((0..STUDY_ITEM_COUNT).map(answers).min(), (0..STUDY_ITEM_COUNT).map(answers).max());
            assert!(most <= fewest.map(|fewest| fewest + 1), "{fewest:?} {most:?}");
            let seconds = slots.iter().filter(|slot| slot.is_second).count();
            assert_eq!(seconds, slots.len() / 2);
        }
    }
}
