//! Simulated people and items: who answers what, and how persons and items differ.

use rand::{Rng, seq::SliceRandom};
use serde::Serialize;

/// Items of a simulated study.
pub(super) const ITEMS: usize = 60;

/// How many people give how many answers each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) struct Design {
    pub(super) persons: usize,
    pub(super) each: usize,
}

/// How much persons differ, and items as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Effects {
    None,
    Middle,
    Large,
}

impl Effects {
    pub(super) const ALL: [Self; 3] = [Self::None, Self::Middle, Self::Large];

    /// Their standard deviation on the logit scale, of persons and of items each.
    pub(super) fn sd(self) -> f64 {
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
pub(super) struct Slot {
    pub(super) person: usize,
    pub(super) item: usize,
    /// Which condition of a comparison it is about.
    pub(super) is_second: bool,
}

/// Who answers what. As a study assigns them: each person gets the items with the fewest answers, at random among those, never one
/// twice; half of a person's and about half of an item's answers are about the second condition.
pub(super) fn assigned(design: Design, rng: &mut impl Rng) -> Vec<Slot> {
    let mut filled = [0_usize; ITEMS];
    let mut seconds = [0_usize; ITEMS];
    let mut slots = Vec::with_capacity(design.persons * design.each);
    for person in 0..design.persons {
        let mut items: Vec<usize> = (0..ITEMS).collect();
        items.shuffle(rng);
        items.sort_by_key(|item| filled[*item]);
        items.truncate(design.each);
        // The items whose answers are least about the second condition get it; persons with an odd number take turns.
        items.sort_by_key(|item| 2 * seconds[*item] as i64 - filled[*item] as i64);
        let half = (design.each + person % 2) / 2;
        for (at, item) in items.into_iter().enumerate() {
            let is_second = at < half;
            filled[item] += 1;
            seconds[item] += usize::from(is_second);
            slots.push(Slot { person, item, is_second });
        }
    }
    slots
}

/// Normal numbers with a standard deviation, by Box and Muller.
pub(super) fn normals(count: usize, sd: f64, rng: &mut impl Rng) -> Vec<f64> {
    (0..count).map(|_| sd * normal(rng)).collect()
}

pub(super) fn normal(rng: &mut impl Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - rng.random::<f64>())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * rng.random::<f64>())
}

pub(super) fn expit(logit: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-logit))
}

/// The mean of a function of a normal variable, by the trapezoid rule.
pub(super) fn over(mean: f64, sd: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in -72..=72 {
        let at = f64::from(step) / 8.0;
        let weight = libm::exp(-at * at / 2.0);
        sum += weight * of(mean + sd * at);
        weights += weight;
    }
    sum / weights
}

/// The logit whose mean share over persons and items is `share`.
pub(super) fn centre(share: f64, sd: f64) -> f64 {
    let (mut low, mut high) = (-30.0, 30.0);
    for _ in 0..80 {
        let middle = f64::midpoint(low, high);
        if over(middle, sd, expit) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}
