//! How far persons agree about items: Krippendorff's alpha.

use super::{Answer, Interval, is_level};
use rand::Rng;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::rng;

/// Most resamples that are drawn; more would change no digit that is shown.
const MOST_RESAMPLES: usize = 100_000;

/// What answers mean, and so how far two of them are apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Names: two answers are the same or not.
    Nominal,
    /// Levels in an order: apart by how many answers lie between them.
    Ordinal,
    /// Numbers: apart by the square of their difference.
    Interval,
}

/// Krippendorff's alpha with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// 1 where all agree, 0 where they agree as chance has it.
    pub alpha: f64,
    /// Its interval, where more than one item has two answers.
    pub interval: Option<Interval>,
    /// What the answers mean.
    pub scale: Scale,
    /// Answers to items that have at least two.
    pub answers: usize,
    /// Persons who gave these answers.
    pub persons: usize,
    /// Items that have at least two answers.
    pub items: usize,
}

/// Krippendorff's alpha of answers (Krippendorff, Content Analysis, 2004, chapter 11), with an interval from a bootstrap that
/// draws items; any answer may be missing.
///
/// `None` where no item has two answers, where all answers are the same, where a value is not finite, and where the level is
/// not between 0 and 1.
#[must_use]
pub fn agreement<P: Ord, I: Ord>(
    answers: &[Answer<P, I>],
    scale: Scale,
    level: f64,
    resamples: usize,
    seed: u64,
) -> Option<Agreement> {
    let ratings = Ratings::new(answers).filter(|_| is_level(level))?;
    let alpha = ratings.alpha(scale)?;
    let mut rng = rng(seed, &["agreement"]);
    let items = ratings.items.len();
    let mut draw = || (0..items).map(|_| rng.random_range(0..items)).collect::<Vec<usize>>();
    let draws = (0..resamples.clamp(1, MOST_RESAMPLES)).map(|_| draw());
    let interval = if items > 1 { ratings.interval(scale, level, draws) } else { None };
    let Ratings { answers, persons, .. } = ratings;
    Some(Agreement { alpha, interval, scale, answers, persons, items })
}

/// Answers to the items that have at least two.
#[derive(Debug, Clone)]
pub struct Ratings {
    /// The values that occur, in order.
    levels: Vec<f64>,
    /// How often each item has each value, by the number of the value.
    items: Vec<Vec<(usize, f64)>>,
    answers: usize,
    persons: usize,
}

impl Ratings {
    /// Puts answers together by item, in the order of the items. `None` where a value is not finite.
    #[must_use]
    pub fn new<P: Ord, I: Ord>(answers: &[Answer<P, I>]) -> Option<Self> {
        let mut items: BTreeMap<&I, Vec<&Answer<P, I>>> = BTreeMap::new();
        for answer in answers {
            items.entry(&answer.item).or_default().push(answer);
        }
        items.retain(|_, of| of.len() > 1);
        let pairable = || items.values().flatten();
        let mut levels: Vec<f64> = pairable().map(|answer| answer.value).collect();
        levels.sort_unstable_by(f64::total_cmp);
        levels.dedup_by(|a, b| a == b);
        let persons: BTreeSet<&P> = pairable().map(|answer| &answer.person).collect();
        answers.iter().all(|answer| answer.value.is_finite()).then(|| Self {
            answers: pairable().count(),
            persons: persons.len(),
            items: items.values().map(|of| counts(of.iter().map(|answer| answer.value), &levels)).collect(),
            levels,
        })
    }

    /// How many items have at least two answers.
    #[must_use]
    pub fn items(&self) -> usize {
        self.items.len()
    }

    /// Alpha of all items. `None` where no item has two answers, or all answers are the same.
    #[must_use]
    pub fn alpha(&self, scale: Scale) -> Option<f64> {
        self.alpha_of(scale, 0..self.items.len())
    }

    /// The percentile interval of alpha over draws of items, each a list of their numbers. Draws whose answers are all the
    /// same have no alpha and are left out.
    #[must_use]
    pub fn interval(&self, scale: Scale, level: f64, draws: impl IntoIterator<Item = Vec<usize>>) -> Option<Interval> {
        let mut alphas: Vec<f64> =
            draws.into_iter().filter_map(|draw| self.alpha_of(scale, draw.into_iter())).collect();
        alphas.sort_unstable_by(f64::total_cmp);
        let tail = (1.0 - level.clamp(0.0, 1.0)) / 2.0;
        let end = |share| (!alphas.is_empty()).then(|| crate::bootstrap::quantile(&alphas, share));
        Some(Interval { low: end(tail)?, high: end(1.0 - tail)? })
    }

    fn alpha_of(&self, scale: Scale, items: impl Iterator<Item = usize>) -> Option<f64> {
        let drawn: Vec<&Vec<(usize, f64)>> = items.filter_map(|item| self.items.get(item)).collect();
        let mut totals = vec![0.0; self.levels.len()];
        drawn.iter().copied().flatten().for_each(|(level, count)| totals[*level] += count);
        let places = self.places(scale, &totals);
        let apart = |a: usize, b: usize| match scale {
            Scale::Nominal => f64::from(u8::from(a != b)),
            Scale::Ordinal | Scale::Interval => (places[a] - places[b]) * (places[a] - places[b]),
        };
        let observed: f64 = drawn.iter().map(|of| disagreement(of, apart) / (size(of) - 1.0)).sum();
        let all: Vec<(usize, f64)> = totals.iter().copied().enumerate().filter(|(_, total)| *total > 0.0).collect();
        let expected = disagreement(&all, apart) / (size(&all) - 1.0);
        (expected > 0.0).then(|| 1.0 - observed / expected)
    }

    /// Where each value lies, so that two are apart by the square of the difference. In an order, that is the number of
    /// answers below the value and half of those that have it.
    fn places(&self, scale: Scale, totals: &[f64]) -> Vec<f64> {
        if scale != Scale::Ordinal {
            return self.levels.clone();
        }
        let below = totals.iter().scan(0.0, |below, total| {
            *below += total;
            Some(*below - total / 2.0)
        });
        below.collect()
    }
}

/// Sum of the distances of all ordered pairs.
fn disagreement(counts: &[(usize, f64)], apart: impl Fn(usize, usize) -> f64) -> f64 {
    let mut sum = 0.0;
    for (at, (level, count)) in counts.iter().enumerate() {
        for (other, others) in &counts[..at] {
            sum += count * others * apart(*level, *other);
        }
    }
    2.0 * sum
}

fn size(counts: &[(usize, f64)]) -> f64 {
    counts.iter().map(|(_, count)| count).sum()
}

fn counts(values: impl Iterator<Item = f64>, levels: &[f64]) -> Vec<(usize, f64)> {
    let mut counts: BTreeMap<usize, f64> = BTreeMap::new();
    for value in values {
        *counts.entry(levels.partition_point(|level| *level < value)).or_default() += 1.0;
    }
    counts.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Krippendorff's own example, "Computing Krippendorff's Alpha-Reliability" (2011), section C: four observers, twelve units.
    fn example() -> Vec<Answer<u32, u32>> {
        let table = [
            [1, 2, 3, 3, 2, 1, 4, 1, 2, 0, 0, 0],
            [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, 0, 3],
            [0, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, 0],
            [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, 0],
        ];
        let cells = table
            .iter()
            .zip(0..)
            .flat_map(|(row, person)| row.iter().zip(0..).map(move |(value, item)| (person, item, *value)));
        cells
            .filter(|(_, _, value)| *value > 0)
            .map(|(person, item, value)| Answer { person, item, value: f64::from(value) })
            .collect()
    }

    #[test]
    fn the_published_example_has_its_alphas() {
        for (scale, expected) in [(Scale::Nominal, "0.743"), (Scale::Ordinal, "0.815"), (Scale::Interval, "0.849")] {
            let found = agreement(&example(), scale, 0.95, 500, 1).unwrap();
            assert_eq!(format!("{:.3}", found.alpha), expected);
            assert_eq!((found.answers, found.persons, found.items), (40, 4, 11));
            let Interval { low, high } = found.interval.unwrap();
            assert!(low < found.alpha && found.alpha <= high && high <= 1.0, "{found:?}");
        }
    }

    #[test]
    fn those_who_agree_have_alpha_1() {
        let all: Vec<Answer<u8, u8>> =
            (0..20).map(|n| Answer { person: n % 2, item: n / 2, value: f64::from(n / 2 % 3) }).collect();
        for scale in [Scale::Nominal, Scale::Ordinal, Scale::Interval] {
            assert_eq!(Ratings::new(&all).unwrap().alpha(scale), Some(1.0));
        }
    }

    #[test]
    fn what_cannot_be_compared_has_no_alpha() {
        let of = |value: fn(u8) -> f64, per_item: u8| -> Vec<Answer<u8, u8>> {
            (0..20).map(|n| Answer { person: n, item: n / per_item, value: value(n) }).collect()
        };
        assert_eq!(agreement(&of(f64::from, 1), Scale::Interval, 0.95, 10, 0), None);
        assert_eq!(agreement(&of(|_| 4.0, 2), Scale::Interval, 0.95, 10, 0), None);
        assert_eq!(agreement(&of(|_| f64::NAN, 2), Scale::Interval, 0.95, 10, 0), None);
        let one_item = agreement(&of(f64::from, 20), Scale::Interval, 0.95, 10, 0).unwrap();
        assert_eq!((one_item.items, one_item.interval), (1, None));
    }

    #[test]
    fn a_seed_gives_one_interval() {
        let with = |seed| agreement(&example(), Scale::Ordinal, 0.9, 300, seed).unwrap();
        assert_eq!(with(1), with(1));
        assert_ne!(with(1), with(2));
    }
}
