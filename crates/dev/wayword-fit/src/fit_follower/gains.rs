//! Prints how much single changes of people's texts would improve the fit to their walks. The thresholds of `check` are chosen by this
//! table, so that only a small share of true texts fails.

use super::texts::{FollowerScene, WalkedText};
use rayon::prelude::*;
use wayword_follower::{
    FeatureWeights,
    change::{StepChangeKind, rank_changes},
    swap::best_swap,
};

/// The shares of true texts that may fail by a threshold.
const FAILING_SHARES: [f64; 6] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.03];

/// The table: for each kind of change, the gains that these shares of the texts exceed.
pub(super) fn gain_table(scenes: &[FollowerScene], texts: &[&WalkedText], weights: &FeatureWeights) -> String {
    let of_text = |text: &&WalkedText| -> [f64; 4] {
        let building = &scenes[text.scene].building;
        let changes = rank_changes(&text.guide, building, &text.walk, text.heading_rad, weights);
        let most = |kind: StepChangeKind| changes.iter().find(|change| change.kind == kind).map(|change| change.gain);
        let swap = best_swap(&text.guide, building, &text.walk, text.heading_rad, weights).map(|swap| swap.gain);
        [most(StepChangeKind::Turn), most(StepChangeKind::NoTurn), most(StepChangeKind::Climb), swap]
            .map(|gain| gain.unwrap_or(f64::NEG_INFINITY))
    };
    let gains: Vec<[f64; 4]> = texts.par_iter().map(of_text).collect();
    let shares = FAILING_SHARES.map(|share| format!("{:>8.1} %", 100.0 * share)).concat();
    let mut lines = vec![format!("{:<16}{shares}", "gain of")];
    for (kind, name) in ["turn", "turn left out", "climb", "places swapped"].into_iter().enumerate() {
        let mut of_kind: Vec<f64> = gains.iter().map(|gains| gains[kind]).collect();
        of_kind.sort_by(|a, b| b.total_cmp(a));
        let at = |share: f64| of_kind.get((share * of_kind.len() as f64) as usize).copied().unwrap_or_default();
        lines.push(format!("{name:<16}{}", FAILING_SHARES.map(|share| format!("{:>10.2}", at(share))).concat()));
    }
    lines.join("\n")
}
