//! Three correlations between two figures of the same items: Pearson's, Spearman's and Kendall's tau-b.
//!
//! All take two lists and pair their values by position. They give `None` where a correlation is not defined: for lists of
//! different lengths, fewer than two items, a value that is not finite, or a list in which all values are equal.

use std::cmp::Ordering;

/// Pearson's correlation. If one list contains only 0 and 1, this is the point-biserial correlation.
#[must_use]
pub fn pearson_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let (a, b) = (centre_values(a)?, centre_values(b)?);
    if a.len() != b.len() {
        return None;
    }
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let scale = (dot(&a, &a) * dot(&b, &b)).sqrt();
    // If all values of a list are equal, its variance may be a rounding error instead of zero.
    let varies = |values: &[f64]| values.iter().any(|value| *value != values[0]);
    (varies(&a) && varies(&b) && scale > 0.0).then(|| (dot(&a, &b) / scale).clamp(-1.0, 1.0))
}

/// Spearman's rank correlation: Pearson's of the ranks, where equal values share the mean of their ranks.
#[must_use]
pub fn spearman_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    pearson_correlation(&mean_ranks(a)?, &mean_ranks(b)?)
}

/// Kendall's tau-b: of all pairs of items, how many more are in the same order on both sides than in opposite orders,
/// over the geometric mean of the numbers of pairs that each side orders (does not tie).
#[must_use]
pub fn kendall_tau_b(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.len() < 2 || a.iter().chain(b).any(|value| !value.is_finite()) {
        return None;
    }
    let mut pairs: Vec<(f64, f64)> =
        a.iter().zip(b).map(|(a, b)| (without_minus_zero(*a), without_minus_zero(*b))).collect();
    let by_b = |x: &(f64, f64), y: &(f64, f64)| x.1.total_cmp(&y.1);
    pairs.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then_with(|| by_b(x, y)));
    let tied_in_both = count_tied_pairs(&pairs, |x, y| x == y);
    let tied_in_a = count_tied_pairs(&pairs, |x, y| x.0 == y.0);
    // In the order of A, with ties of A in the order of B, every pair that B has the other way round is discordant.
    let mut b_values: Vec<f64> = pairs.iter().map(|(_, b)| *b).collect();
    let discordant = count_exchanges(&mut b_values);
    let tied_in_b = count_tied_pairs(&b_values, |x, y| x == y);
    let all = choose_two(pairs.len());
    let [ordered_in_a, ordered_in_b] = [tied_in_a, tied_in_b].map(|tied| (all - tied) as f64);
    let concordant = all + tied_in_both - tied_in_a - tied_in_b - discordant;
    let scale = ordered_in_a.sqrt() * ordered_in_b.sqrt();
    (scale > 0.0).then(|| ((concordant as f64 - discordant as f64) / scale).clamp(-1.0, 1.0))
}

/// Turns -0.0 into 0.0: `total_cmp` would sort them apart, but they are one value.
fn without_minus_zero(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value }
}

/// The values less their mean; `None` where a correlation is not defined.
fn centre_values(values: &[f64]) -> Option<Vec<f64>> {
    if values.len() < 2 || values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Some(values.iter().map(|value| value - mean).collect())
}

/// The rank of each value, from 1. Equal values share the mean of their ranks.
fn mean_ranks(values: &[f64]) -> Option<Vec<f64>> {
    if values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|x, y| without_minus_zero(values[*x]).total_cmp(&without_minus_zero(values[*y])));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for same in order.chunk_by(|x, y| values[*x] == values[*y]) {
        let rank = before as f64 + (same.len() as f64 + 1.0) / 2.0;
        same.iter().for_each(|at| ranks[*at] = rank);
        before += same.len();
    }
    Some(ranks)
}

/// The number of pairs among `count` things.
fn choose_two(count: usize) -> u64 {
    let count = count as u64;
    count * count.saturating_sub(1) / 2
}

/// Pairs within runs of equal values.
fn count_tied_pairs<T>(sorted: &[T], same: impl FnMut(&T, &T) -> bool) -> u64 {
    sorted.chunk_by(same).map(|run| choose_two(run.len())).sum()
}

/// Sorts by merging, and counts the pairs that were in the wrong order (Knight 1966).
fn count_exchanges(values: &mut [f64]) -> u64 {
    if values.len() < 2 {
        return 0;
    }
    let (left, right) = values.split_at_mut(values.len() / 2);
    let mut count = count_exchanges(left) + count_exchanges(right);
    let mut merged = Vec::with_capacity(left.len() + right.len());
    let (mut l, mut r) = (0, 0);
    while l < left.len() && r < right.len() {
        if left[l].total_cmp(&right[r]) == Ordering::Greater {
            count += (left.len() - l) as u64;
            merged.push(right[r]);
            r += 1;
        } else {
            merged.push(left[l]);
            l += 1;
        }
    }
    merged.extend_from_slice(&left[l..]);
    merged.extend_from_slice(&right[r..]);
    values.copy_from_slice(&merged);
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Correlation = fn(&[f64], &[f64]) -> Option<f64>;
    const ALL: [Correlation; 3] = [pearson_correlation, spearman_correlation, kendall_tau_b];

    /// `(a, b, pearson, spearman, tau-b)` by SciPy 1.17.1: `pearsonr`, `spearmanr`, `kendalltau`.
    fn known() -> Vec<(Vec<f64>, Vec<f64>, [f64; 3])> {
        vec![
            (
                vec![1.0, 2.0, 3.0, 4.0, 5.0],
                vec![3.0, 1.0, 4.0, 1.0, 5.0],
                [0.353_553_390_593_273_8, 0.410_391_340_834_061_65, 0.316_227_766_016_837_94],
            ),
            (
                vec![1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0],
                vec![0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0],
                [0.240_192_230_707_630_74, 0.222_549_549_284_631_14, 0.204_124_145_231_931_54],
            ),
            (
                vec![0.5, -1.25, 3.0, 0.75, 2.0, 2.0, 9.0, -4.0],
                vec![1.0, 2.0, 3.0, 2.0, 1.0, 0.0, 4.0, 4.0],
                [0.130_707_089_582_650_76, 0.030_490_072_219_358_427, 0.0],
            ),
            (
                vec![3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0, 5.0, 3.0, 5.0, 8.0],
                vec![2.0, 7.0, 1.0, 8.0, 2.0, 8.0, 1.0, 8.0, 2.0, 8.0, 4.0, 5.0],
                [0.099_799_007_597_215_51, 0.141_579_686_364_015_7, 0.171_096_477_707_288_75],
            ),
            (vec![10.0, 20.0], vec![2.0, 1.0], [-1.0, -0.999_999_999_999_999_9, -1.0]),
        ]
    }

    #[test]
    fn rank_correlations_depend_only_on_the_order() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0], [1.0, 10.0, 100.0, 1e6]);
        assert_eq!(spearman_correlation(&a, &b), Some(1.0));
        assert_eq!(kendall_tau_b(&a, &b), Some(1.0));
        assert!(pearson_correlation(&a, &b).unwrap() < 0.9);
    }

    #[test]
    fn values_are_those_of_scipy() {
        for (a, b, expected) in known() {
            for (found, expected) in ALL.map(|of| of(&a, &b).unwrap()).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{a:?} {b:?}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn correlations_are_none_for_constant_values() {
        for of in ALL {
            assert_eq!(of(&[], &[]), None);
            assert_eq!(of(&[1.0], &[2.0]), None);
            assert_eq!(of(&[1.0, 2.0], &[1.0]), None);
            assert_eq!(of(&[0.1, 0.1, 0.1], &[1.0, 2.0, 3.0]), None);
            assert_eq!(of(&[0.0, -0.0], &[1.0, 2.0]), None);
            assert_eq!(of(&[1.0, f64::NAN], &[1.0, 2.0]), None);
        }
    }

    /// By the definition, over all pairs.
    fn tau_by_pairs(a: &[f64], b: &[f64]) -> Option<f64> {
        let sign = |x: f64, y: f64| f64::from(u8::from(x > y)) - f64::from(u8::from(x < y));
        let (mut both, mut in_a, mut in_b) = (0.0, 0.0, 0.0);
        for i in 0..a.len() {
            for j in 0..i {
                let (of_a, of_b) = (sign(a[i], a[j]), sign(b[i], b[j]));
                both += of_a * of_b;
                in_a += of_a * of_a;
                in_b += of_b * of_b;
            }
        }
        let scale = f64::sqrt(in_a) * f64::sqrt(in_b);
        (scale > 0.0).then(|| both / scale)
    }

    proptest! {
        #[test]
        fn kendall_tau_b_follows_its_definition(values in prop::collection::vec((0..6u8, 0..6u8), 0..40)) {
            let (a, b): (Vec<f64>, Vec<f64>) = values.iter().map(|(a, b)| (f64::from(*a), f64::from(*b))).unzip();
            match (kendall_tau_b(&a, &b), tau_by_pairs(&a, &b)) {
                (Some(found), Some(expected)) => prop_assert!((found - expected).abs() < 1e-12),
                (found, expected) => prop_assert_eq!(found, expected),
            }
        }

        #[test]
        fn sides_can_change_places(values in prop::collection::vec((0..9u8, 0..9u8), 2..40)) {
            let (a, b): (Vec<f64>, Vec<f64>) = values.iter().map(|(a, b)| (f64::from(*a), f64::from(*b))).unzip();
            for of in ALL {
                match (of(&a, &b), of(&b, &a)) {
                    (Some(one), Some(other)) => prop_assert!((one - other).abs() < 1e-12 && one.abs() <= 1.0),
                    (one, other) => prop_assert_eq!(one, other),
                }
            }
        }
    }
}
