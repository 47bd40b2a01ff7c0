//! Simulates choices between the texts of three systems, and the intervals of the strengths that a Bradley-Terry model gives them.

use super::assigned::{ITEMS, Slot};
use super::figure::LEVEL;
use super::logits::{normals, over};
use rand::Rng;
use std::f64::consts::SQRT_2;
use wayword_metrics::{BradleyTerry, Comparison, Interval, Preference, Term, bradley_terry};

/// The systems' utilities, the advantage of the side, and Davidson's parameter, as logarithms.
const UTILITIES: [f64; SYSTEMS] = [0.6, 0.0, -0.6];
const SYSTEMS: usize = 3;
const SIDE: f64 = 0.2;
const TIE: f64 = -0.5;

/// Choices of each ordered pair from which the true strengths are computed.
const EXPECTED: f64 = 5000.0;

/// The intervals of the strengths that simulated choices give; none where they give no strengths.
///
/// A person, and an item, gives each system a part of its utility, so that differences have standard deviation `sd`.
pub(super) fn intervals(slots: &[Slot], sd: f64, rng: &mut impl Rng) -> Vec<Interval> {
    let part = sd / SQRT_2;
    let (persons, items) = (normals(SYSTEMS * slots.len(), part, rng), normals(SYSTEMS * ITEMS, part, rng));
    let choose = |slot: &Slot| {
        let Slot { person, item, .. } = *slot;
        let first = rng.random_range(0..SYSTEMS);
        let second = (first + rng.random_range(1..SYSTEMS)) % SYSTEMS;
        let utility =
            |system: usize| UTILITIES[system] + persons[SYSTEMS * person + system] + items[SYSTEMS * item + system];
        let [won, lost, _] = chances(utility(first) - utility(second));
        let chance: f64 = rng.random();
        let preference = match () {
            () if chance < won => Preference::First,
            () if chance < won + lost => Preference::Second,
            () => Preference::Tie,
        };
        Comparison { person, item, first, second, preference }
    };
    let choices: Vec<_> = slots.iter().map(choose).collect();
    terms(&choices).iter().map(|term| term.interval).collect()
}

/// The true strengths over all persons and items: those of a data set in which each choice occurs as often as expected. They are nearer
/// to each other than any one person's utilities, because persons disagree.
pub(super) fn strengths(sd: f64) -> Vec<f64> {
    let mut choices = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        let better = UTILITIES[first] - UTILITIES[second];
        for (at, preference) in [Preference::First, Preference::Second, Preference::Tie].into_iter().enumerate() {
            let expected = EXPECTED * over(better, sd * SQRT_2, |better| chances(better)[at]);
            for _ in 0..expected.round() as usize {
                choices.push(Comparison { person: choices.len(), item: 0, first, second, preference });
            }
        }
    }
    terms(&choices).iter().map(|term| term.value).collect()
}

/// The chances that the first is chosen, the second, or neither, by how much better the first is.
fn chances(better: f64) -> [f64; 3] {
    let odds = [better + SIDE, 0.0, TIE + (better + SIDE) / 2.0].map(libm::exp);
    let all: f64 = odds.iter().sum();
    odds.map(|one| one / all)
}

/// The strengths in the order of the systems, where all of them have one.
fn terms(choices: &[Comparison<usize, usize, usize>]) -> Vec<Term> {
    let Ok(BradleyTerry { mut strengths, .. }) = bradley_terry(choices, LEVEL) else { return Vec::new() };
    strengths.sort_by_key(|strength| strength.system);
    if strengths.len() == SYSTEMS { strengths.iter().map(|strength| strength.term).collect() } else { Vec::new() }
}
