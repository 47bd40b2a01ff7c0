//! Bootstrap intervals for means of values that come in clusters, as several instructions about one path do.

use rand::Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_core::seeded_rng;

/// Resamples at most. If more are asked for, this many are drawn, because more would not change the digits that reports show.
const MAX_RESAMPLES: usize = 100_000;

/// How intervals and random pairs are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResamplingOptions {
    /// How many times the clusters are drawn anew for an interval.
    pub resamples: usize,
    /// The share that the intervals cover, as 0.95.
    pub level: f64,
    /// Seed of the intervals and of the random pairs.
    pub seed: u64,
}

/// A mean with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanEstimate {
    /// The mean over all values.
    pub mean: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// How many values.
    pub values: usize,
    /// How many groups they come in.
    pub clusters: usize,
}

impl MeanEstimate {
    /// The ends of the interval; `None` where all values come in one group, because nothing shows how groups differ.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        (self.clusters > 1).then_some([self.low, self.high])
    }
}

/// The mean of values, with a percentile bootstrap interval (Efron 1979) that draws whole clusters with replacement.
///
/// Items on one path are not independent: REVERIE's 501 val_seen items are 126 paths. Drawing items one by one would make
/// the interval narrower than it is. `level` is the share that the interval covers, as 0.95; `resamples` beyond 100,000 are
/// not drawn. `None` where there are no values.
#[must_use]
pub fn clustered_interval<C: Ord>(
    values: &[(C, f64)],
    resamples: usize,
    level: f64,
    seed: u64,
) -> Option<MeanEstimate> {
    let mut rng = seeded_rng(seed, &["bootstrap"]);
    let draw = move |clusters: usize| (0..clusters).map(|_| rng.random_range(0..clusters)).collect();
    clustered_interval_from_draws(values, resamples.clamp(1, MAX_RESAMPLES), level, draw)
}

/// As [`clustered_interval`], but the caller draws the resamples: `draw` gets the number of clusters and returns the indices of
/// the drawn ones, which count clusters in their order. An index beyond the last cluster is ignored.
#[must_use]
pub fn clustered_interval_from_draws<C: Ord>(
    values: &[(C, f64)],
    resamples: usize,
    level: f64,
    mut draw: impl FnMut(usize) -> Vec<usize>,
) -> Option<MeanEstimate> {
    let mut clusters: BTreeMap<&C, ClusterSum> = BTreeMap::new();
    for (cluster, value) in values {
        clusters.entry(cluster).or_default().add(ClusterSum { total: *value, count: 1 });
    }
    let clusters: Vec<ClusterSum> = clusters.into_values().collect();
    let all = clusters.iter().copied().reduce(ClusterSum::plus)?;
    let mut mean = || {
        let drawn = draw(clusters.len()).into_iter().filter_map(|at| clusters.get(at).copied());
        drawn.reduce(ClusterSum::plus).unwrap_or(all).mean()
    };
    let mut means: Vec<f64> = (0..resamples.max(1)).map(|_| mean()).collect();
    means.sort_unstable_by(f64::total_cmp);
    let tail = (1.0 - level.clamp(0.0, 1.0)) / 2.0;
    Some(MeanEstimate {
        mean: all.mean(),
        low: interpolated_quantile(&means, tail),
        high: interpolated_quantile(&means, 1.0 - tail),
        values: values.len(),
        clusters: clusters.len(),
    })
}

/// The interval of each figure of a set, also for figures that are no means, as corpus BLEU.
///
/// `figures` gets the indices of the drawn clusters, some of them repeatedly, and computes all figures of that draw. A value that is
/// not finite is left out of its figure's interval; the interval is NaN if no draw gives a finite value.
#[must_use]
pub fn resampled_intervals<const N: usize>(
    clusters: usize,
    drawing: &ResamplingOptions,
    mut figures: impl FnMut(&[usize]) -> [f64; N],
) -> [(f64, f64); N] {
    let mut rng = seeded_rng(drawing.seed, &["bootstrap"]);
    let resamples = drawing.resamples.clamp(1, MAX_RESAMPLES);
    let mut drawn_values = [(); N].map(|()| Vec::with_capacity(resamples));
    let mut drawn = vec![0; clusters];
    for _ in 0..resamples {
        drawn.fill_with(|| rng.random_range(0..clusters));
        for (values, value) in drawn_values.iter_mut().zip(figures(&drawn)) {
            values.extend(Some(value).filter(|value| value.is_finite()));
        }
    }
    drawn_values.map(|values| {
        percentile_interval(values, drawing.level).map_or((f64::NAN, f64::NAN), |[low, high]| (low, high))
    })
}

/// The ends of the central interval that contains the share `level` of the values: equally many are cut off on both sides.
/// `None` if there are no values.
#[must_use]
pub fn percentile_interval(mut values: Vec<f64>, level: f64) -> Option<[f64; 2]> {
    if values.is_empty() {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    let tail = (1.0 - level.clamp(0.0, 1.0)) / 2.0;
    Some([tail, 1.0 - tail].map(|share| interpolated_quantile(&values, share)))
}

/// The sum and the number of the values in one or several clusters.
#[derive(Debug, Clone, Copy, Default)]
struct ClusterSum {
    total: f64,
    count: usize,
}

impl ClusterSum {
    fn add(&mut self, other: Self) {
        *self = self.plus(other);
    }

    fn plus(self, other: Self) -> Self {
        Self { total: self.total + other.total, count: self.count + other.count }
    }

    fn mean(self) -> f64 {
        self.total / self.count as f64
    }
}

/// The value below which the given share of sorted values lies, interpolated linearly between the two neighbours.
fn interpolated_quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * (sorted.len() - 1) as f64;
    let below = sorted[at.floor() as usize];
    below + (sorted[at.ceil() as usize] - below) * at.fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interval(values: &[(u8, f64)], level: f64) -> MeanEstimate {
        clustered_interval(values, 1000, level, 3).unwrap()
    }

    fn width(estimate: MeanEstimate) -> f64 {
        estimate.high - estimate.low
    }

    #[test]
    fn clustered_interval_from_draws_no_values_is_none() {
        assert_eq!(clustered_interval::<u8>(&[], 1000, 0.95, 0), None);
    }

    #[test]
    fn clustered_interval_from_draws_one_cluster_has_no_width() {
        let of_one = interval(&[(1, 0.0), (1, 1.0), (1, 0.5)], 0.95);
        assert_eq!((of_one.mean, of_one.low, of_one.high), (0.5, 0.5, 0.5));
        assert_eq!((of_one.values, of_one.clusters), (3, 1));
    }

    #[test]
    fn values_that_go_together_widen_the_interval() {
        let together: Vec<(u8, f64)> = (0..200).map(|n| (n / 10, f64::from(n / 10 % 2))).collect();
        let apart: Vec<(u8, f64)> = together.iter().zip(0..).map(|((_, value), n)| (n, *value)).collect();
        let (together, apart) = (interval(&together, 0.95), interval(&apart, 0.95));
        assert_eq!(together.mean, apart.mean);
        assert!(width(together) > 2.0 * width(apart), "{together:?} {apart:?}");
    }

    /// 100 coins: a mean of one half has a standard error of 0.05.
    #[test]
    fn clustered_interval_has_the_width_of_theory() {
        let coins: Vec<(u8, f64)> = (0..100).map(|n| (n, f64::from(n % 2))).collect();
        let found = clustered_interval(&coins, 20_000, 0.95, 1).unwrap();
        assert!((width(found) - 2.0 * 1.96 * 0.05).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn a_seed_gives_one_interval() {
        let values: Vec<(u8, f64)> = (0..50).map(|n| (n % 7, f64::from(n).sin())).collect();
        let with = |seed| clustered_interval(&values, 500, 0.9, seed).unwrap();
        assert_eq!(with(1), with(1));
        assert_ne!(with(1), with(2));
    }

    proptest! {
        #[test]
        fn the_interval_holds_the_mean_and_stays_among_the_values(
            values in prop::collection::vec((0..12u8, -1.0..1.0f64), 1..60),
            level in 0.9..1.0f64,
        ) {
            let found = interval(&values, level);
            let least = values.iter().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
            let most = values.iter().map(|(_, value)| *value).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(found.low - 1e-9 <= found.mean && found.mean <= found.high + 1e-9, "{:?}", found);
            prop_assert!(least - 1e-9 <= found.low && found.high <= most + 1e-9);
        }

        #[test]
        fn a_higher_level_is_never_narrower(
            values in prop::collection::vec((0..12u8, -1.0..1.0f64), 1..60),
            level in 0.5..1.0f64,
            less in 0.0..0.5f64,
        ) {
            let (wide, narrow) = (interval(&values, level), interval(&values, level - less));
            prop_assert!(wide.low <= narrow.low && narrow.high <= wide.high);
        }

        #[test]
        fn the_order_of_values_does_not_matter(values in prop::collection::vec((0..12u8, -1.0..1.0f64), 1..60)) {
            let mut turned = values.clone();
            turned.reverse();
            let (found, turned) = (interval(&values, 0.9), interval(&turned, 0.9));
            prop_assert!((found.low - turned.low).abs() < 1e-9 && (found.high - turned.high).abs() < 1e-9);
        }
    }
}
