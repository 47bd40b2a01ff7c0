//! The figures whose intervals are tried, each with its truth over all persons and items.

use super::people::{Design, Effects, ITEMS, Slot, assigned, centre, expit, normal, normals, over};
use rand::Rng;
use wayword_metrics::{
    Answer, Comparison, Interval, Preference, Scale, agreement, bradley_terry, mean, mean_difference, share,
    share_difference,
};

const LEVEL: f64 = 0.95;
/// The share of a person's or item's variance that both conditions have in common.
const IN_COMMON: f64 = 0.5;
/// How much lower the second condition's logits are.
const LOWER: f64 = 0.8;

/// A figure of a simulated study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Figure {
    /// A share, of the mean that is given.
    Share(f64),
    /// The difference between two shares, the first of the mean that is given.
    Difference(f64),
    /// A mean of values like SPL: 0 without success, else up to 1.
    Mean(f64),
    /// The difference between two such means.
    MeanDifference(f64),
    /// Agreement on five levels.
    Alpha,
    /// The strengths of three systems.
    Strengths,
}

type Given = Vec<Answer<usize, usize>>;

impl Figure {
    /// The truth that the intervals of studies should cover; of three systems, three.
    pub(super) fn truth(self, effects: Effects) -> Vec<f64> {
        let sd = effects.sd() * std::f64::consts::SQRT_2;
        let spl = |logit: f64| over(logit, sd, |at| expit(at) * over(efficiency(at - logit), NOISE, expit));
        match self {
            Self::Share(base) => vec![base],
            Self::Difference(base) => vec![base - over(centre(base, sd) - LOWER, sd, expit)],
            Self::Mean(base) => vec![spl(centre(base, sd))],
            Self::MeanDifference(base) => vec![spl(centre(base, sd)) - spl(centre(base, sd) - LOWER)],
            Self::Alpha => vec![alpha(effects.sd())],
            Self::Strengths => strengths(sd),
        }
    }

    /// The intervals that one simulated study gives; fewer than the truths where it gives none.
    pub(super) fn intervals(self, design: Design, effects: Effects, rng: &mut impl Rng) -> Vec<Interval> {
        let slots = assigned(design, rng);
        let sd = effects.sd();
        match self {
            Self::Share(base) => share(&walks(&slots, base, sd, false, rng)[0], LEVEL).and_then(|of| of.interval).into_iter().collect(),
            Self::Mean(base) => mean(&walks(&slots, base, sd, true, rng)[0], LEVEL).and_then(|of| of.interval).into_iter().collect(),
            Self::Difference(base) => {
                let [first, second] = conditions(&slots, base, sd, false, rng);
                share_difference(&first, &second, LEVEL).and_then(|of| of.interval).into_iter().collect()
            }
            Self::MeanDifference(base) => {
                let [first, second] = conditions(&slots, base, sd, true, rng);
                mean_difference(&first, &second, LEVEL).and_then(|of| of.interval).into_iter().collect()
            }
            Self::Alpha => {
                let given = rated(&slots, sd, rng);
                agreement(&given, Scale::Ordinal, LEVEL).and_then(|of| of.interval).into_iter().collect()
            }
            Self::Strengths => chosen(&slots, sd, rng),
        }
    }
}

/// Noise of the efficiency of a walk on the logit scale, and the efficiency of one whose person and item have this effect.
const NOISE: f64 = 0.8;
fn efficiency(effect: f64) -> f64 {
    1.5 + effect / 2.0
}

/// Answers of one condition in which all slots are.
fn walks(slots: &[Slot], base: f64, sd: f64, is_spl: bool, rng: &mut impl Rng) -> [Given; 1] {
    let one: Vec<Slot> = slots.iter().map(|slot| Slot { is_second: false, ..*slot }).collect();
    let [first, _] = conditions(&one, base, sd, is_spl, rng);
    [first]
}

/// Answers of two conditions.
fn conditions(slots: &[Slot], base: f64, sd: f64, is_spl: bool, rng: &mut impl Rng) -> [Given; 2] {
    let centre = centre(base, sd * std::f64::consts::SQRT_2);
    let (common, own) = (sd * IN_COMMON.sqrt(), sd * (1.0 - IN_COMMON).sqrt());
    let mut of = |count: usize| -> Vec<[f64; 2]> {
        (0..count).map(|_| {
            let both = common * normal(rng);
            [both + own * normal(rng), both + own * normal(rng)]
        }).collect()
    };
    let persons = of(slots.len());
    let items = of(ITEMS);
    let mut given = [Vec::new(), Vec::new()];
    for Slot { person, item, is_second } in slots.iter().copied() {
        let condition = usize::from(is_second);
        let effect = persons[person][condition] + items[item][condition];
        let logit = centre - LOWER * f64::from(u8::from(is_second)) + effect;
        let is_success = rng.random::<f64>() < expit(logit);
        let value = if is_spl { expit(efficiency(effect) + NOISE * normal(rng)) } else { 1.0 };
        given[condition].push(Answer { person, item, value: if is_success { value } else { 0.0 } });
    }
    given
}

/// Where the five levels part.
const CUTS: [f64; 4] = [-2.0, -0.7, 0.7, 2.0];

fn rated(slots: &[Slot], sd: f64, rng: &mut impl Rng) -> Given {
    let (persons, items) = (normals(slots.len(), sd, rng), normals(ITEMS, sd, rng));
    let mut one = |slot: &Slot| {
        let chance: f64 = rng.random();
        let noise = libm::log(chance / (1.0 - chance));
        let felt = persons[slot.person] + items[slot.item] + noise;
        let level = CUTS.iter().filter(|cut| felt > **cut).count();
        Answer { person: slot.person, item: slot.item, value: level as f64 }
    };
    slots.iter().map(&mut one).collect()
}

/// Alpha of endlessly many persons and items: two persons on one item, against two on any two.
fn alpha(sd: f64) -> f64 {
    let above = |cut: usize, item: f64| match cut {
        0 => 1.0,
        5 => 0.0,
        cut => over(item - CUTS[cut - 1], sd, expit),
    };
    let level = |level: usize, item: f64| above(level, item) - above(level + 1, item);
    let overall: Vec<f64> = (0..5).map(|one| over(0.0, sd, |item| level(one, item))).collect();
    let place = |one: usize| overall[..one].iter().sum::<f64>() + overall[one] / 2.0;
    let apart = |pair: &dyn Fn(usize, usize) -> f64| -> f64 {
        let pairs = (0..5).flat_map(|a| (0..5).map(move |b| (a, b)));
        pairs.map(|(a, b)| pair(a, b) * (place(a) - place(b)).powi(2)).sum()
    };
    let observed = apart(&|a, b| over(0.0, sd, |item| level(a, item) * level(b, item)));
    1.0 - observed / apart(&|a, b| overall[a] * overall[b])
}

/// Three systems' utilities, the advantage of the side, and Davidson's parameter, as logarithms.
const UTILITIES: [f64; 3] = [0.6, 0.0, -0.6];
const SIDE: f64 = 0.2;
const TIE: f64 = -0.5;

/// Chances of the first, the second and a tie, by how much better the first is.
fn outcomes(better: f64) -> [f64; 3] {
    let odds = [better + SIDE, 0.0, TIE + (better + SIDE) / 2.0].map(libm::exp);
    let all: f64 = odds.iter().sum();
    odds.map(|one| one / all)
}

fn chosen(slots: &[Slot], sd: f64, rng: &mut impl Rng) -> Vec<Interval> {
    let part = sd / std::f64::consts::SQRT_2;
    let (persons, items) = (normals(3 * slots.len(), part, rng), normals(3 * ITEMS, part, rng));
    let mut one = |slot: &Slot| {
        let first = rng.random_range(0..3_usize);
        let second = (first + rng.random_range(1..3)) % 3;
        let utility = |system: usize| UTILITIES[system] + persons[3 * slot.person + system] + items[3 * slot.item + system];
        let [won, lost, _] = outcomes(utility(first) - utility(second));
        let chance: f64 = rng.random();
        let preference = if chance < won {
            Preference::First
        } else if chance < won + lost {
            Preference::Second
        } else {
            Preference::Tie
        };
        Comparison { person: slot.person, item: slot.item, first, second, preference }
    };
    let choices: Vec<_> = slots.iter().map(&mut one).collect();
    let Ok(mut found) = bradley_terry(&choices, LEVEL) else { return Vec::new() };
    found.strengths.sort_by_key(|strength| strength.system);
    if found.strengths.len() < 3 {
        return Vec::new();
    }
    found.strengths.iter().map(|strength| strength.term.interval).collect()
}

/// The strengths that endlessly many persons and items give, which are nearer to each other than any one person's: those of as
/// many choices as are expected.
fn strengths(sd: f64) -> Vec<f64> {
    let mut choices = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        let better = UTILITIES[first] - UTILITIES[second];
        let outcomes = [0, 1, 2].map(|at| over(better, sd, |better| outcomes(better)[at]));
        for (chance, preference) in outcomes.into_iter().zip([Preference::First, Preference::Second, Preference::Tie]) {
            for _ in 0..(chance * 20_000.0).round() as usize {
                choices.push(Comparison { person: choices.len(), item: 0, first, second, preference });
            }
        }
    }
    let Ok(mut found) = bradley_terry(&choices, LEVEL) else { return Vec::new() };
    found.strengths.sort_by_key(|strength| strength.system);
    found.strengths.iter().map(|strength| strength.term.value).collect()
}
