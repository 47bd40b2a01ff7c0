//! Figures of a score of pairs: how well it separates wrong pairs from right ones, and whether its chances are true.

use super::made_wrong::PairFault;
use serde::Serialize;
use std::collections::BTreeMap;
use wayword_follower::pair::{PairMotion, chances_with_mean};

/// A pair with its chance to be wrong.
pub(super) struct ScoredPair {
    pub(super) fault: PairFault,
    /// The chance that it is wrong where half of all pairs are.
    pub(super) chance: f64,
}

/// The figures.
#[derive(Debug, Clone, Serialize)]
pub(super) struct PairFigures {
    pub(super) pairs: usize,
    /// For each fault, the share of right pairs with a lower chance, ties half.
    pub(super) auc: BTreeMap<&'static str, f64>,
    /// For each base rate in percent, the expected calibration error in five bins of equal width, and in five of equal size.
    pub(super) calibration_error: BTreeMap<u32, [f64; 2]>,
    /// The same of chances that were moved until their mean is the base rate.
    pub(super) moved_calibration_error: BTreeMap<u32, [f64; 2]>,
}

impl PairFigures {
    pub(super) fn new(scored: &[ScoredPair]) -> Self {
        let chances = |fault: PairFault| -> Vec<f64> {
            scored.iter().filter(|pair| pair.fault == fault).map(|pair| pair.chance).collect()
        };
        let right = chances(PairFault::None);
        let faults = PairFault::ALL.into_iter().filter(|fault| *fault != PairFault::None);
        let auc = faults.map(|fault| (fault.name(), area_under_curve(&chances(fault), &right))).collect();
        let errors = |is_moved: bool| {
            let error = |rate: u32| (rate, calibration_errors(scored, f64::from(rate) / 100.0, is_moved));
            [20, 50].map(error).into_iter().collect()
        };
        Self { pairs: scored.len(), auc, calibration_error: errors(false), moved_calibration_error: errors(true) }
    }
}

/// The share of pairs of one of each group in which that of the first has the higher value, ties half.
fn area_under_curve(high: &[f64], low: &[f64]) -> f64 {
    let mut sorted = low.to_vec();
    sorted.sort_by(f64::total_cmp);
    let wins = high.iter().map(|value| {
        let below = sorted.partition_point(|other| other < value);
        let ties = sorted.partition_point(|other| other <= value) - below;
        below as f64 + ties as f64 / 2.0
    });
    wins.sum::<f64>() / (high.len() * low.len()).max(1) as f64
}

/// The expected calibration errors where this share of all pairs is wrong: wrong and right pairs are weighted so that they have it.
fn calibration_errors(scored: &[ScoredPair], base_rate: f64, is_moved: bool) -> [f64; 2] {
    let wrong = scored.iter().filter(|pair| pair.fault != PairFault::None).count().max(1) as f64;
    let right = (scored.len() as f64 - wrong).max(1.0);
    let mut points: Vec<(f64, bool, f64)> = scored
        .iter()
        .map(|pair| {
            let is_wrong = pair.fault != PairFault::None;
            let weight = if is_wrong { base_rate / wrong } else { (1.0 - base_rate) / right };
            let odds = pair.chance / (1.0 - pair.chance) * base_rate / (1.0 - base_rate);
            (odds / (1.0 + odds), is_wrong, weight)
        })
        .collect();
    if is_moved {
        let known: Vec<(f64, f64)> = points.iter().map(|(chance, _, weight)| (*chance, *weight)).collect();
        points.iter_mut().zip(chances_with_mean(&known, base_rate)).for_each(|(point, chance)| point.0 = chance);
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut reached = 0.0;
    let by_size = points.iter().map(|(_, _, weight)| {
        reached += weight;
        bin_of(reached - weight / 2.0)
    });
    let by_size: Vec<usize> = by_size.collect();
    let by_width: Vec<usize> = points.iter().map(|(chance, _, _)| bin_of(*chance)).collect();
    [by_width, by_size].map(|bins| binned_error(&points, &bins))
}

const BINS: usize = 5;

fn bin_of(share: f64) -> usize {
    ((share * BINS as f64) as usize).min(BINS - 1)
}

fn binned_error(points: &[(f64, bool, f64)], bins: &[usize]) -> f64 {
    (0..BINS)
        .map(|bin| {
            let own = points.iter().zip(bins).filter(|(_, at)| **at == bin).map(|(point, _)| point);
            let off: f64 =
                own.map(|(chance, is_wrong, weight)| (chance - f64::from(u8::from(*is_wrong))) * weight).sum();
            off.abs()
        })
        .sum()
}

/// The figures as a table.
pub(super) fn figure_table(figures: &BTreeMap<PairMotion, PairFigures>) -> String {
    let mut lines = Vec::new();
    for (motion, figures) in figures {
        let word = match motion {
            PairMotion::Poses => "poses",
            PairMotion::Pictures => "pictures",
            PairMotion::Unknown => "no motion",
        };
        let auc = figures.auc.iter().map(|(fault, auc)| format!("{fault} {auc:.3}"));
        lines.push(format!(
            "{word}: {} pairs; area under the curve: {}",
            figures.pairs,
            auc.collect::<Vec<_>>().join(", ")
        ));
        for (rate, [by_width, by_size]) in &figures.calibration_error {
            let [moved_width, moved_size] = figures.moved_calibration_error.get(rate).copied().unwrap_or_default();
            lines.push(format!(
                "  {rate} % wrong: calibration error {by_width:.3} in bins of equal width, {by_size:.3} of equal size; moved to that mean \
                 {moved_width:.3}, {moved_size:.3}"
            ));
        }
    }
    lines.join("\n")
}
