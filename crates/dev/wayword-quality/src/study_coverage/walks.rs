//! Simulates walks in two conditions: whether a person reaches the goal, and how good the way is.

use super::assignment::{AnswerSlot, STUDY_ITEM_COUNT};
use super::logits::{centre_for_share, draw_normal, expit, mean_over_normal};
use rand::Rng;
use std::f64::consts::SQRT_2;
use wayword_metrics::StudyAnswer;

/// The share of a person's or item's variance that both conditions have in common.
const COMMON_VARIANCE_SHARE: f64 = 0.5;
/// How much lower the logits of success are in the second condition than in the first.
const SECOND_CONDITION_DROP_LOGITS: f64 = 0.8;
/// The standard deviation of how good a way is, on the logit scale.
const GOODNESS_SD_LOGITS: f64 = 0.8;

/// The answers about one condition, by person and item.
type ConditionAnswers = Vec<StudyAnswer<usize, usize>>;

/// The answers of each condition.
#[derive(Default)]
pub(super) struct SimulatedWalks {
    /// 1 for a walk that reached the goal, else 0.
    pub(super) successes: [ConditionAnswers; 2],
    /// How good the way was, from 0 to 1; 0 for a walk that did not reach the goal.
    pub(super) values: [ConditionAnswers; 2],
}

/// The same slots, all of the first condition.
pub(super) fn with_first_condition(slots: &[AnswerSlot]) -> Vec<AnswerSlot> {
    slots.iter().map(|slot| AnswerSlot { is_second: false, ..*slot }).collect()
}

/// Draws the walk of every slot. Persons differ with standard deviation `sd`, and so do items. `base`: the share of success
/// in the first condition.
pub(super) fn draw_walks(slots: &[AnswerSlot], base: f64, sd: f64, rng: &mut impl Rng) -> SimulatedWalks {
    let centre = centre_for_share(base, sd * SQRT_2);
    let persons = slots.iter().map(|slot| slot.person + 1).max().unwrap_or(0);
    let (persons, items) = (draw_effects(persons, sd, rng), draw_effects(STUDY_ITEM_COUNT, sd, rng));
    let mut walks = SimulatedWalks::default();
    for AnswerSlot { person, item, is_second } in slots.iter().copied() {
        let condition = usize::from(is_second);
        let effect = persons[person][condition] + items[item][condition];
        let is_success = rng.random::<f64>() < expit(centre - SECOND_CONDITION_DROP_LOGITS * condition as f64 + effect);
        let way = expit(way_goodness(effect) + GOODNESS_SD_LOGITS * draw_normal(rng));
        let answer = |value: f64| StudyAnswer { person, item, value: if is_success { value } else { 0.0 } };
        walks.successes[condition].push(answer(1.0));
        walks.values[condition].push(answer(way));
    }
    walks
}

/// Draws the effects of persons, or of items, on each of the two conditions, on the logit scale.
fn draw_effects(count: usize, sd: f64, rng: &mut impl Rng) -> Vec<[f64; 2]> {
    let (common, separate) = (sd * COMMON_VARIANCE_SHARE.sqrt(), sd * (1.0 - COMMON_VARIANCE_SHARE).sqrt());
    let mut draw_effect = || {
        let both = common * draw_normal(rng);
        [both + separate * draw_normal(rng), both + separate * draw_normal(rng)]
    };
    (0..count).map(|_| draw_effect()).collect()
}

/// How good the way of a person and an item with this effect is, on the logit scale.
fn way_goodness(effect: f64) -> f64 {
    1.5 + effect / 2.0
}

/// The true shares of success in the two conditions, over all persons and items.
pub(super) fn true_shares(base: f64, sd: f64) -> [f64; 2] {
    let sd = sd * SQRT_2;
    [0.0, SECOND_CONDITION_DROP_LOGITS].map(|lower| mean_over_normal(centre_for_share(base, sd) - lower, sd, expit))
}

/// The true means of how good the ways are in the two conditions, over all persons and items.
pub(super) fn true_means(base: f64, sd: f64) -> [f64; 2] {
    let sd = sd * SQRT_2;
    let logit = centre_for_share(base, sd);
    let mean = |effect: f64, lower: f64| {
        expit(logit - lower + effect) * mean_over_normal(way_goodness(effect), GOODNESS_SD_LOGITS, expit)
    };
    [0.0, SECOND_CONDITION_DROP_LOGITS].map(|lower| mean_over_normal(0.0, sd, |effect| mean(effect, lower)))
}
