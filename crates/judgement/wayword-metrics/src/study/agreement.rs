//! Krippendorff's alpha: how far persons agree about items, beyond chance. It is 1 minus the observed disagreement within items
//! over the disagreement that random pairs of answers would have.

use super::{ConfidenceInterval, StudyAnswer, is_level, quantile};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The scale of the answers, which defines the distance between two of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerScale {
    /// Names: two answers are the same or not.
    Nominal,
    /// Ordered levels: the distance depends on how many answers lie between them.
    Ordinal,
    /// Numbers: the distance is the square of their difference.
    Interval,
}

/// Krippendorff's alpha with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RaterAgreement {
    /// 1 if all agree, 0 if they agree only as often as chance would make them.
    pub alpha: f64,
    /// Its interval; `None` where leaving out a person or an item never changes alpha.
    pub interval: Option<ConfidenceInterval>,
    /// Its standard error, where it is above 0.
    pub se: Option<f64>,
    /// The scale of the answers.
    pub scale: AnswerScale,
    /// Answers to items that have at least two.
    pub answers: usize,
    /// Persons who gave these answers.
    pub persons: usize,
    /// Items that have at least two answers.
    pub items: usize,
}

/// Krippendorff's alpha of answers (Krippendorff, Content Analysis, 2004, chapter 11), with an interval; any answer may be
/// missing.
///
/// The variance is a jackknife's: that over items left out, and as much as that over persons left out exceeds that over
/// single answers left out. The interval is Student's for the logarithm of 1 - alpha, with one degree of freedom less than there
/// are persons or items, whichever are fewer. The usual bootstrap over items gives intervals that are too narrow, because it ignores
/// that other persons would answer differently.
///
/// `None` where no item has two answers, where all answers are the same, where a value is not finite, and where the level is
/// not between 0 and 1.
#[must_use]
pub fn krippendorff_alpha<P: Ord, I: Ord>(
    answers: &[StudyAnswer<P, I>],
    scale: AnswerScale,
    level: f64,
) -> Option<RaterAgreement> {
    let is_fine = is_level(level) && answers.iter().all(|answer| answer.value.is_finite());
    let ratings = is_fine.then(|| RatingTable::new(answers, scale));
    let ratings = ratings?;
    let alpha = ratings.alpha_without(&[])?;
    let [persons, items] = [&ratings.by_person, &ratings.by_item].map(Vec::len);
    let se = ratings.standard_error().filter(|se| *se > 0.0 && alpha < 1.0);
    let t = quantile::student_quantile(0.5 + level / 2.0, persons.min(items).saturating_sub(1));
    let half = se.zip(t).map(|(se, t)| t * se / (1.0 - alpha));
    let interval = half.map(|half| ConfidenceInterval {
        low: 1.0 - (1.0 - alpha) * half.exp(),
        high: 1.0 - (1.0 - alpha) * (-half).exp(),
    });
    Some(RaterAgreement { alpha, interval, se, scale, answers: ratings.answers.len(), persons, items })
}

/// An answer by the numbers of its item and its value.
type AnswerPosition = (usize, usize);

/// Answers to the items that have at least two.
struct RatingTable {
    scale: AnswerScale,
    /// The values that occur, in order.
    levels: Vec<f64>,
    /// How often each item has each value, by the number of the value.
    items: Vec<Vec<(usize, f64)>>,
    /// All answers, item by item.
    answers: Vec<AnswerPosition>,
    /// The answers of each person.
    by_person: Vec<Vec<AnswerPosition>>,
    /// The answers to each item.
    by_item: Vec<Vec<AnswerPosition>>,
}

impl RatingTable {
    fn new<P: Ord, I: Ord>(answers: &[StudyAnswer<P, I>], scale: AnswerScale) -> Self {
        let mut items: BTreeMap<&I, Vec<&StudyAnswer<P, I>>> = BTreeMap::new();
        for answer in answers {
            items.entry(&answer.item).or_default().push(answer);
        }
        items.retain(|_, item_answers| item_answers.len() > 1);
        let mut levels: Vec<f64> = items.values().flatten().map(|answer| answer.value).collect();
        levels.sort_unstable_by(f64::total_cmp);
        levels.dedup_by(|a, b| a == b);
        let mut by_person: BTreeMap<&P, Vec<AnswerPosition>> = BTreeMap::new();
        let mut by_item = vec![Vec::new(); items.len()];
        for (item, item_answers) in items.values().enumerate() {
            for answer in item_answers {
                let position = (item, levels.partition_point(|level| *level < answer.value));
                by_person.entry(&answer.person).or_default().push(position);
                by_item[item].push(position);
            }
        }
        Self {
            scale,
            levels,
            items: by_item.iter().map(|item_answers| count_levels(item_answers)).collect(),
            answers: by_item.iter().flatten().copied().collect(),
            by_person: by_person.into_values().collect(),
            by_item,
        }
    }

    /// The standard error by the jackknife; `None` if too few of the reduced sets of answers have an alpha.
    fn standard_error(&self) -> Option<f64> {
        let single: Vec<Vec<AnswerPosition>> = self.answers.iter().map(|position| vec![*position]).collect();
        let [item, person, answer] =
            [&self.by_item, &self.by_person, &single].map(|groups| self.jackknife_variance(groups));
        Some((item? + (person? - answer?).max(0.0)).sqrt())
    }

    /// The jackknife variance of alpha: each group of answers is left out in turn.
    fn jackknife_variance(&self, groups: &[Vec<AnswerPosition>]) -> Option<f64> {
        let alphas: Vec<f64> = groups.iter().filter_map(|group| self.alpha_without(group)).collect();
        let count = alphas.len() as f64;
        let mean = alphas.iter().sum::<f64>() / count;
        let square: f64 = alphas.iter().map(|alpha| (alpha - mean) * (alpha - mean)).sum();
        (alphas.len() > 1).then(|| square * (count - 1.0) / count)
    }

    /// Alpha without some answers. `None` where no item has two answers, or all answers are the same.
    fn alpha_without(&self, left_out: &[AnswerPosition]) -> Option<f64> {
        let mut items = self.items.clone();
        for (item, level) in left_out {
            items[*item].iter_mut().filter(|(at, _)| at == level).for_each(|(_, count)| *count -= 1.0);
        }
        items.retain(|counts| answer_total(counts) > 1.0);
        let mut totals = vec![0.0; self.levels.len()];
        items.iter().flatten().for_each(|(level, count)| totals[*level] += count);
        let positions = self.level_positions(&totals);
        let distance = |a: usize, b: usize| match self.scale {
            AnswerScale::Nominal => f64::from(u8::from(a != b)),
            AnswerScale::Ordinal | AnswerScale::Interval => {
                (positions[a] - positions[b]) * (positions[a] - positions[b])
            }
        };
        let observed: f64 =
            items.iter().map(|counts| total_disagreement(counts, distance) / (answer_total(counts) - 1.0)).sum();
        let all: Vec<(usize, f64)> = totals.iter().copied().enumerate().filter(|(_, total)| *total > 0.0).collect();
        let expected = total_disagreement(&all, distance) / (answer_total(&all) - 1.0);
        (expected > 0.0).then(|| 1.0 - observed / expected)
    }

    /// A coordinate for each level, such that the squared difference of two coordinates is their distance. On an ordinal scale
    /// this is the number of answers below the level plus half of those at it.
    fn level_positions(&self, totals: &[f64]) -> Vec<f64> {
        if self.scale != AnswerScale::Ordinal {
            return self.levels.clone();
        }
        let below = totals.iter().scan(0.0, |below, total| {
            *below += total;
            Some(*below - total / 2.0)
        });
        below.collect()
    }
}

/// Sum of the distances of all ordered pairs of answers. `counts` has the number of answers at each level.
fn total_disagreement(counts: &[(usize, f64)], distance: impl Fn(usize, usize) -> f64) -> f64 {
    let mut sum = 0.0;
    for (at, (level, count)) in counts.iter().enumerate() {
        for (other, others) in &counts[..at] {
            sum += count * others * distance(*level, *other);
        }
    }
    2.0 * sum
}

/// The number of answers at all levels together.
fn answer_total(counts: &[(usize, f64)]) -> f64 {
    counts.iter().map(|(_, count)| count).sum()
}

/// How often each level occurs among answers.
fn count_levels(answers: &[AnswerPosition]) -> Vec<(usize, f64)> {
    let mut counts: BTreeMap<usize, f64> = BTreeMap::new();
    answers.iter().for_each(|(_, level)| *counts.entry(*level).or_default() += 1.0);
    counts.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Krippendorff's own example, "Computing Krippendorff's Alpha-Reliability" (2011), section C: four observers, twelve units.
    fn example() -> Vec<StudyAnswer<u32, u32>> {
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
            .map(|(person, item, value)| StudyAnswer { person, item, value: f64::from(value) })
            .collect()
    }

    #[test]
    fn the_published_example_has_its_alphas() {
        for (scale, expected) in
            [(AnswerScale::Nominal, "0.743"), (AnswerScale::Ordinal, "0.815"), (AnswerScale::Interval, "0.849")]
        {
            let found = krippendorff_alpha(&example(), scale, 0.95).unwrap();
            assert_eq!(format!("{:.3}", found.alpha), expected);
            assert_eq!((found.answers, found.persons, found.items), (40, 4, 11));
            let ConfidenceInterval { low, high } = found.interval.unwrap();
            assert!(low < found.alpha && found.alpha <= high && high <= 1.0, "{found:?}");
        }
    }

    #[test]
    fn alpha_is_one_for_full_agreement() {
        let all: Vec<StudyAnswer<u8, u8>> =
            (0..20).map(|n| StudyAnswer { person: n % 2, item: n / 2, value: f64::from(n / 2 % 3) }).collect();
        for scale in [AnswerScale::Nominal, AnswerScale::Ordinal, AnswerScale::Interval] {
            let found = krippendorff_alpha(&all, scale, 0.95).unwrap();
            assert_eq!((found.alpha, found.interval), (1.0, None));
        }
    }

    #[test]
    fn alpha_is_none_without_answers_to_compare() {
        let of = |value: fn(u8) -> f64, per_item: u8| -> Vec<StudyAnswer<u8, u8>> {
            (0..20).map(|n| StudyAnswer { person: n, item: n / per_item, value: value(n) }).collect()
        };
        assert_eq!(krippendorff_alpha(&of(f64::from, 1), AnswerScale::Interval, 0.95), None);
        assert_eq!(krippendorff_alpha(&of(|_| 4.0, 2), AnswerScale::Interval, 0.95), None);
        assert_eq!(krippendorff_alpha(&of(|_| f64::NAN, 2), AnswerScale::Interval, 0.95), None);
        let one_item = krippendorff_alpha(&of(f64::from, 20), AnswerScale::Interval, 0.95).unwrap();
        assert_eq!((one_item.items, one_item.interval), (1, None));
    }

    #[test]
    fn more_items_narrow_the_interval() {
        let of = |items: u32| -> RaterAgreement {
            let value = |n: u32| f64::from((n.wrapping_mul(2_654_435_761) >> 16) % 3 + n / 3 % 3);
            let all: Vec<_> =
                (0..3 * items).map(|n| StudyAnswer { person: n % 30, item: n / 3, value: value(n) }).collect();
            krippendorff_alpha(&all, AnswerScale::Ordinal, 0.95).unwrap()
        };
        let width = |found: &RaterAgreement| found.interval.map(|interval| interval.high - interval.low).unwrap();
        let (few, many) = (of(20), of(200));
        assert!(width(&few) > 2.0 * width(&many), "{few:?} {many:?}");
    }
}
