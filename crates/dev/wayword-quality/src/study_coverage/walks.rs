//! Simulates walks in two conditions: whether a person reaches the goal, and how good the way is.

use super::assigned::{ITEMS, Slot};
use super::logits::{centre, expit, normal, over};
use rand::Rng;
use std::f64::consts::SQRT_2;
use wayword_metrics::Answer;

/// The share of a person's or item's variance that both conditions have in common.
const IN_COMMON: f64 = 0.5;
/// How much lower the second condition's logits are.
const LOWER: f64 = 0.8;
/// The standard deviation of how good a way is, on the logit scale.
const NOISE: f64 = 0.8;

type Given = Vec<Answer<usize, usize>>;

/// The answers of each condition.
#[derive(Default)]
pub(super) struct Walks {
    /// 1 for a walk that reached the goal, else 0.
    pub(super) successes: [Given; 2],
    /// How good the way was, from 0 to 1; 0 for a walk that did not reach the goal.
    pub(super) values: [Given; 2],
}

/// The same slots, all of the first condition.
pub(super) fn of_one(slots: &[Slot]) -> Vec<Slot> {
    slots.iter().map(|slot| Slot { is_second: false, ..*slot }).collect()
}

/// Walks by persons and items who each differ with standard deviation `sd`.
pub(super) fn drawn(slots: &[Slot], base: f64, sd: f64, rng: &mut impl Rng) -> Walks {
    let centre = centre(base, sd * SQRT_2);
    let persons = slots.iter().map(|slot| slot.person + 1).max().unwrap_or(0);
    let (persons, items) = (effects(persons, sd, rng), effects(ITEMS, sd, rng));
    let mut walks = Walks::default();
    for Slot { person, item, is_second } in slots.iter().copied() {
        let condition = usize::from(is_second);
        let effect = persons[person][condition] + items[item][condition];
        let is_success = rng.random::<f64>() < expit(centre - LOWER * condition as f64 + effect);
        let way = expit(goodness(effect) + NOISE * normal(rng));
        let answer = |value: f64| Answer { person, item, value: if is_success { value } else { 0.0 } };
        walks.successes[condition].push(answer(1.0));
        walks.values[condition].push(answer(way));
    }
    walks
}

/// Draws the effects of persons, or of items, on each of the two conditions, on the logit scale.
fn effects(count: usize, sd: f64, rng: &mut impl Rng) -> Vec<[f64; 2]> {
    let (common, own) = (sd * IN_COMMON.sqrt(), sd * (1.0 - IN_COMMON).sqrt());
    let mut one = || {
        let both = common * normal(rng);
        [both + own * normal(rng), both + own * normal(rng)]
    };
    (0..count).map(|_| one()).collect()
}

/// How good the way of a person and an item with this effect is, on the logit scale.
fn goodness(effect: f64) -> f64 {
    1.5 + effect / 2.0
}

/// The true shares of success in the two conditions, over all persons and items.
pub(super) fn shares(base: f64, sd: f64) -> [f64; 2] {
    let sd = sd * SQRT_2;
    [0.0, LOWER].map(|lower| over(centre(base, sd) - lower, sd, expit))
}

/// The true means of how good the ways are in the two conditions, over all persons and items.
pub(super) fn means(base: f64, sd: f64) -> [f64; 2] {
    let sd = sd * SQRT_2;
    let logit = centre(base, sd);
    let mean = |effect: f64, lower: f64| expit(logit - lower + effect) * over(goodness(effect), NOISE, expit);
    [0.0, LOWER].map(|lower| over(0.0, sd, |effect| mean(effect, lower)))
}
