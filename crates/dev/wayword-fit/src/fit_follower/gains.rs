//! Prints how much the best single change to a person's text would improve its fit to the walk. The thresholds of `check` are chosen
//! by this table, so that only a small share of true texts fails.

use super::texts::{FollowerScene, WalkedText};
use rayon::prelude::*;
use wayword_follower::{
    FeatureWeights,
    change::{StepChangeKind, rank_changes},
    swap::best_swap,
};

/// The columns of the table: shares of true texts that may fail by a threshold.
const FAILING_SHARES: [f64; 6] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.03];

/// The table: for each kind of change, the gain (a difference of log-likelihoods) that [`FAILING_SHARES`] of the texts exceed.
pub(super) fn gain_table(scenes: &[FollowerScene], texts: &[&WalkedText], weights: &FeatureWeights) -> String {
    let gains_of_text = |text: &&WalkedText| -> [f64; 4] {
        let building = &scenes[text.scene].building;
        let changes = rank_changes(&text.guide, building, &text.walk, text.heading_rad, weights);
        let best_gain =
            |kind: StepChangeKind| changes.iter().find(|change| change.kind == kind).map(|change| change.gain);
        let swap = best_swap(&text.guide, building, &text.walk, text.heading_rad, weights).map(|swap| swap.gain);
        [best_gain(StepChangeKind::Turn), best_gain(StepChangeKind::NoTurn), best_gain(StepChangeKind::Climb), swap]
            .map(|gain| gain.unwrap_or(f64::NEG_INFINITY))
    };
    let gains: Vec<[f64; 4]> = texts.par_iter().map(gains_of_text).collect();
    let shares = FAILING_SHARES.map(|share| format!("{:>8.1} %", 100.0 * share)).concat();
    let mut lines = vec![format!("{:<16}{shares}", "gain of")];
    for (kind, name) in ["turn", "turn left out", "climb", "places swapped"].into_iter().enumerate() {
        let mut kind_gains: Vec<f64> = gains.iter().map(|gains| gains[kind]).collect();
        kind_gains.sort_by(|a, b| b.total_cmp(a));
        let exceeded_by =
            |share: f64| kind_gains.get((share * kind_gains.len() as f64) as usize).copied().unwrap_or_default();
        let cells = FAILING_SHARES.map(|share| format!("{:>10.2}", exceeded_by(share))).concat();
        lines.push(format!("{name:<16}{cells}"));
    }
    lines.join("\n")
}
