//! The variance of a figure if answers are correlated within each person and within each item.
//!
//! Cameron, Gelbach and Miller (2011): V = V_person + V_item - V_cell, each from the sums of errors within its groups, times
//! G / (G - 1) (n - 1) / (n - k) for G groups, n answers and k figures that were estimated together. This is what statsmodels'
//! `cov_cluster_2groups` computes. The sum can be too small, even negative, so V is never below the larger of `V_person` and
//! `V_item`.

use std::collections::BTreeMap;

/// If the variance from persons and items is below this share of that from single answers, it is a rounding error.
const BALANCED_VARIANCE_SHARE: f64 = 1e-20;

/// For each answer the numbers of its person, its item and its cell (the pair of both), and how many of each there are.
pub(in crate::study) struct AnswerGroups {
    persons: Vec<usize>,
    items: Vec<usize>,
    cells: Vec<usize>,
    counts: [usize; 3],
}

impl AnswerGroups {
    /// The groups of answers, given by the person and the item of each.
    pub(in crate::study) fn from_pairs<'a, P: Ord + 'a, I: Ord + 'a>(
        pairs: impl Iterator<Item = (&'a P, &'a I)>,
    ) -> Self {
        let (persons, items): (Vec<&P>, Vec<&I>) = pairs.unzip();
        let (persons, items) = (number_distinct(&persons), number_distinct(&items));
        let both: Vec<(usize, usize)> = persons.iter().copied().zip(items.iter().copied()).collect();
        let cells = number_distinct(&both);
        let counts = [&persons, &items, &cells].map(|numbers| numbers.iter().max().map_or(0, |highest| highest + 1));
        Self { persons, items, cells, counts }
    }

    /// The parts of the variance of a sum of errors, where `estimated` parameters were estimated from the same answers.
    pub(in crate::study) fn variance_parts(&self, errors: &[f64], estimated: usize) -> VarianceParts {
        let answers = errors.len();
        // (n - 1) / (n - k), the correction for few answers.
        let correction = (answers.saturating_sub(1)) as f64 / (answers.saturating_sub(estimated)).max(1) as f64;
        let part = |groups: &[usize], count: usize| {
            let mut sums = vec![0.0; count];
            groups.iter().zip(errors).for_each(|(group, error)| sums[*group] += error);
            let square: f64 = sums.iter().map(|sum| sum * sum).sum();
            if count > 1 { correction * square * count as f64 / (count - 1) as f64 } else { 0.0 }
        };
        let [persons, items, cells] = self.counts;
        VarianceParts {
            person: part(&self.persons, persons),
            item: part(&self.items, items),
            cell: part(&self.cells, cells),
            answers,
            persons,
            items,
        }
    }
}

/// Numbers the distinct values from 0, in their order; equal values get equal numbers.
fn number_distinct<T: Ord>(all: &[T]) -> Vec<usize> {
    let mut numbers: BTreeMap<&T, usize> = all.iter().map(|value| (value, 0)).collect();
    numbers.values_mut().zip(0..).for_each(|(number, at)| *number = at);
    all.iter().map(|value| numbers[value]).collect()
}

/// The three parts of a two-way clustered variance, and how many answers, persons and items they come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::study) struct VarianceParts {
    /// `V_person`, from the sums of errors within each person.
    pub(in crate::study) person: f64,
    /// `V_item`, from the sums of errors within each item.
    pub(in crate::study) item: f64,
    /// `V_cell`, from the sums of errors within each pair of a person and an item.
    pub(in crate::study) cell: f64,
    pub(in crate::study) answers: usize,
    pub(in crate::study) persons: usize,
    pub(in crate::study) items: usize,
}

impl VarianceParts {
    /// The variance. If the errors cancel within every person and every item, only the part of single answers is left.
    pub(in crate::study) fn variance(&self) -> f64 {
        let larger = self.person.max(self.item);
        if larger <= BALANCED_VARIANCE_SHARE * self.cell {
            self.cell
        } else {
            larger.max(self.person + self.item - self.cell)
        }
    }

    /// Whether the answers come from more than one person and are about more than one item. A single person or item is no sample: nothing
    /// shows how another one would differ.
    pub(in crate::study) fn is_sample(&self) -> bool {
        self.persons > 1 && self.items > 1
    }

    /// Whether no two answers share a person or an item.
    pub(in crate::study) fn is_independent(&self) -> bool {
        self.persons == self.answers && self.items == self.answers
    }

    /// The number of persons or of items, whichever is smaller.
    pub(in crate::study) fn fewest_groups(&self) -> usize {
        self.persons.min(self.items)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(places: &[(u8, u8)], errors: &[f64]) -> VarianceParts {
        AnswerGroups::from_pairs(places.iter().map(|(person, item)| (person, item))).variance_parts(errors, 1)
    }

    #[test]
    fn sums_are_taken_within_persons_items_and_both() {
        let found = parts(&[(7, 1), (7, 2), (9, 1), (9, 1)], &[1.0, 2.0, -1.0, -2.0]);
        assert_eq!((found.persons, found.items, found.answers), (2, 2, 4));
        assert_eq!(found.person, 2.0 * (9.0 + 9.0));
        assert_eq!(found.item, 2.0 * (4.0 + 4.0));
        assert_eq!(found.cell, 1.5 * (1.0 + 4.0 + 9.0));
        assert_eq!(found.variance(), found.person);
    }

    #[test]
    fn answers_that_balance_everywhere_have_the_variance_of_single_ones() {
        let found = parts(&[(1, 1), (1, 2), (2, 1), (2, 2)], &[1.0, -1.0, -1.0, 1.0]);
        assert_eq!((found.person, found.item, found.cell), (0.0, 0.0, 16.0 / 3.0));
        assert_eq!(found.variance(), found.cell);
    }

    #[test]
    fn independent_answers_have_the_usual_variance_of_a_mean() {
        let found = parts(&[(1, 1), (2, 2), (3, 3)], &[1.0 / 3.0, -1.0 / 3.0, 0.0]);
        assert!(found.is_independent());
        assert!((found.variance() - 1.0 / 3.0).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn a_single_person_or_item_is_no_sample() {
        for places in [&[(1, 5), (2, 5), (3, 5)][..], &[(1, 5), (1, 6), (1, 7)], &[(1, 1), (1, 1)], &[(1, 1)]] {
            assert!(!parts(places, &vec![0.5; places.len()]).is_sample(), "{places:?}");
        }
        let two = parts(&[(1, 5), (2, 5), (2, 6)], &[1.0, -1.0, 0.0]);
        assert!(two.is_sample() && !two.is_independent());
        assert_eq!(two.fewest_groups(), 2);
    }
}
