//! Shares of cases with confidence intervals, and the tables that print them.

use serde::Serialize;
use std::fmt;
use wayword_metrics::clustered_interval;

/// How many resamples an interval is drawn from.
const RESAMPLE_COUNT: usize = 10_000;
/// The confidence level of the intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// A share of cases, with an interval from a bootstrap that draws whole clusters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct ClusteredShare {
    /// Cases that count.
    pub(crate) count: usize,
    /// All cases.
    pub(crate) of: usize,
    /// How many clusters the cases come from, such as texts or paths.
    clusters: usize,
    share: f64,
    low: f64,
    high: f64,
}

impl ClusteredShare {
    /// The share of cases, each given with its cluster; `None` where there are no cases.
    pub(crate) fn from_cases<C: Ord>(cases: impl IntoIterator<Item = (C, bool)>, seed: u64) -> Option<Self> {
        let cases: Vec<(C, f64)> = cases.into_iter().map(|(cluster, counts)| (cluster, f64::from(counts))).collect();
        let estimate = clustered_interval(&cases, RESAMPLE_COUNT, CONFIDENCE_LEVEL, seed)?;
        let count = cases.iter().filter(|(_, counts)| *counts > 0.0).count();
        let (share, low, high) = (estimate.mean, estimate.low, estimate.high);
        Some(Self { count, of: cases.len(), clusters: estimate.clusters, share, low, high })
    }
}

impl fmt::Display for ClusteredShare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [share, low, high] = [self.share, self.low, self.high].map(|share| 100.0 * share);
        write!(f, "{share:.1} % [{low:.1}, {high:.1}] ({}/{})", self.count, self.of)
    }
}

/// A share as a cell of a table.
pub(crate) fn share_cell(share: Option<&ClusteredShare>) -> String {
    share.map_or_else(|| "-".to_owned(), ClusteredShare::to_string)
}

/// The area under the curve of hits over false alarms, for cases that should score higher (true) and lower (false): how often one of
/// the first scores higher than one of the second. A tie counts half. 0.5 where one side is empty.
pub(crate) fn area_under_curve(mut scored: Vec<(bool, f64)>) -> f64 {
    scored.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut below, mut won) = (0.0, 0.0);
    for same in scored.chunk_by(|a, b| a.1 == b.1) {
        let positive = same.iter().filter(|(is_hit, _)| *is_hit).count() as f64;
        let negative = same.len() as f64 - positive;
        won += positive * (below + negative / 2.0);
        below += negative;
    }
    let positive = scored.len() as f64 - below;
    if positive * below > 0.0 { won / (positive * below) } else { 0.5 }
}

/// A table with columns as wide as their widest cell. The first row is its head.
pub(crate) fn aligned_table(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_counts_its_cases_and_a_single_cluster_cannot_vary() {
        let share = ClusteredShare::from_cases([(1, true), (1, false), (1, false), (1, true)], 0).unwrap();
        assert_eq!(share.to_string(), "50.0 % [50.0, 50.0] (2/4)");
        assert_eq!(share.clusters, 1);
        assert_eq!(ClusteredShare::from_cases::<u8>([], 0), None);
        assert_eq!(share_cell(None), "-");
    }

    #[test]
    fn clusters_that_differ_widen_the_interval() {
        let share = ClusteredShare::from_cases((0..20).map(|n| (n % 2, n % 2 == 0)), 0).unwrap();
        assert_eq!((share.count, share.of, share.low, share.high), (10, 20, 0.0, 1.0));
    }

    #[test]
    fn table_aligns_its_columns() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        assert_eq!(aligned_table(&[row(["a", "b", "c"]), row(["long", "x", ""])]), "a     b  c\nlong  x");
    }
}
