//! Measures how far the follower can be trusted: the calibration of its shares, and how well it separates wrong texts from right ones.
//!
//! Wrong texts are made in two ways: by flipping a turn of a person's text, and by taking the text of another path in the building.

use crate::{
    corrupt_people::flip_one_turn,
    share::{aligned_table, area_under_curve},
};
use clap::Args;
use rand::seq::IndexedRandom;
use rayon::prelude::*;
use std::{collections::BTreeMap, path::PathBuf};
use wayword_core::seeded_rng;
use wayword_fit::fit_follower::texts::{FollowerScene, SUCCESS_M, WalkedText, read_texts};
use wayword_follower::{
    FeatureWeights, Guide, GuideTrial, WalkFit, WalkPrior, WalkTree, best_walk,
    route::{GainThresholds, KnownWalk, judge_route, judge_steps},
    walk_shares,
};
use wayword_run::{error::CommandError, output::CommandOutput};

/// Bins of the calibration error, of equal width.
const BINS: usize = 10;
/// Bounds of ambiguity that are tried: a text is ambiguous if another walk has at least this part of the annotated walk's
/// share.
const AMBIGUITY_BOUNDS: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8];

/// The flags of `reader-figures`.
#[derive(Debug, Args)]
pub struct ReaderFiguresArgs {
    /// File with the texts: a dataset, or the instructions of a run over its paths.
    file: PathBuf,
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// Only the texts of these scans.
    #[arg(long, value_delimiter = ',', conflicts_with = "except")]
    scans: Vec<String>,
    /// All texts but those of these scans.
    #[arg(long, value_delimiter = ',')]
    except: Vec<String>,
    /// Use at most this many texts, spread over the file.
    #[arg(long)]
    limit: Option<usize>,
    /// Seed of the turns that are flipped, and of the other paths.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// The follower's judgement of one text.
struct FollowerJudgement {
    /// The best walk; `None` without one.
    best: Option<BestWalk>,
    /// How much better the best walk to another end fits than the annotated walk, as a natural logarithm of the ratio.
    elsewhere: f64,
    /// The best gain from changing a turn: of the text itself, and of the text with one turn flipped; `None` without a turn.
    turns: Option<[f64; 2]>,
    /// [`Self::elsewhere`] of another path's text; `None` where the building has none.
    other_path: Option<f64>,
}

/// The walk that fits best.
struct BestWalk {
    /// Its share: the probability that the follower takes this walk.
    share: f64,
    /// The share of all walks that end near its end.
    nearby: f64,
    /// How well the best walk that ends elsewhere fits in comparison, as a natural logarithm of the ratio.
    runner_up: f64,
    /// Whether it ends at the goal.
    is_right: bool,
}

/// Prints how far the follower can be believed: its calibration, wrong turns, other paths' texts and ambiguity.
///
/// # Errors
/// When the data or the texts cannot be read.
pub fn measure_reader_figures(flags: &ReaderFiguresArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (scenes, files) = read_texts(&flags.data, std::slice::from_ref(&flags.file))?;
    let mut all: Vec<WalkedText> = files.into_iter().flatten().collect();
    let is_in = |text: &WalkedText, scans: &[String]| scans.iter().any(|name| name == scenes[text.scene].name.as_str());
    all.retain(|text| (flags.scans.is_empty() || is_in(text, &flags.scans)) && !is_in(text, &flags.except));
    let every = flags.limit.map_or(1, |limit| all.len().div_ceil(limit.max(1)));
    let mut by_scene: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (at, text) in all.iter().enumerate() {
        by_scene.entry(text.scene).or_default().push(at);
    }
    let picked: Vec<usize> = (0..all.len()).step_by(every.max(1)).collect();
    let judgements = picked.par_iter().map(|at| judge_text(&scenes, &all, &by_scene[&all[*at].scene], *at, flags.seed));
    let judgements: Vec<FollowerJudgement> = judgements.collect();
    output.print_result(&(), report_lines(&judgements).join("\n"));
    Ok(())
}

/// Judges the text number `at`. `neighbours`: the numbers of all texts of its building.
fn judge_text(
    scenes: &[FollowerScene],
    all: &[WalkedText],
    neighbours: &[usize],
    at: usize,
    seed: u64,
) -> FollowerJudgement {
    let (text, weights) = (&all[at], FeatureWeights::fitted());
    let building = &scenes[text.scene].building;
    let tree = WalkTree::from_prior(building, text.walk[0], text.heading_rad, WalkPrior::default());
    let fit = WalkFit::new(&GuideTrial::new(&text.guide, building), &tree, weights);
    let shares = walk_shares(&fit, &tree);
    let best = best_walk(&fit, &tree).map(|walk| {
        let is_near =
            |other: &usize| building.distance_m(tree.end_viewpoint(*other), tree.end_viewpoint(walk)) < SUCCESS_M;
        let (near, far): (Vec<usize>, Vec<usize>) = (1..tree.len()).partition(is_near);
        let runner_up = far.into_iter().map(|other| shares[other]).fold(0.0, f64::max);
        BestWalk {
            share: shares[walk],
            nearby: near.into_iter().map(|other| shares[other]).sum(),
            runner_up: log_ratio(runner_up, shares[walk]),
            is_right: text.to_goal_m[tree.end_viewpoint(walk)] < SUCCESS_M,
        }
    });
    let known = KnownWalk { building, walk: &text.walk, heading_rad: text.heading_rad };
    let elsewhere = |guide: &Guide| {
        let route = judge_route(guide, known, Some(WalkPrior::default()), weights, GainThresholds::default());
        route.map_or(0.0, |route| log_ratio(route.other, route.share))
    };
    let gain = |guide: &Guide| judge_steps(guide, known, weights, GainThresholds::default()).turn_gain;
    let purpose = |what: &'static str| seeded_rng(seed, &["reader figures", what, &at.to_string()]);
    let turns = flip_one_turn(&text.words, &mut purpose("turn"))
        .and_then(|turned| Some([gain(&text.guide)?, gain(&Guide::read_text(&turned))?]));
    let is_apart = |other: &&usize| {
        let end = all[**other].walk.last();
        end.is_some_and(|end| text.to_goal_m[*end] >= SUCCESS_M)
    };
    let others: Vec<&usize> = neighbours.iter().filter(is_apart).collect();
    let other_path = others.choose(&mut purpose("path")).map(|other| elsewhere(&all[**other].guide));
    FollowerJudgement { best, elsewhere: elsewhere(&text.guide), turns, other_path }
}

/// The natural logarithm of a ratio of shares. Shares that were rounded to 0 count as the smallest positive number.
fn log_ratio(other: f64, own: f64) -> f64 {
    (other.max(f64::MIN_POSITIVE) / own.max(f64::MIN_POSITIVE)).ln()
}

fn report_lines(judgements: &[FollowerJudgement]) -> Vec<String> {
    let best: Vec<&BestWalk> = judgements.iter().filter_map(|judgement| judgement.best.as_ref()).collect();
    let right = best.iter().filter(|best| best.is_right).count();
    let error = |share: fn(&BestWalk) -> f64| {
        calibration_error(&best.iter().map(|best| (share(best), best.is_right)).collect::<Vec<_>>())
    };
    let turns: Vec<[f64; 2]> = judgements.iter().filter_map(|judgement| judgement.turns).collect();
    let paths: Vec<[f64; 2]> =
        judgements.iter().filter_map(|judgement| Some([judgement.elsewhere, judgement.other_path?])).collect();
    let auc_line = |name: &str, pairs: &[[f64; 2]]| match pairwise_auc(pairs) {
        Some(auc) => format!("{name}: AUC {auc:.3} ({} texts)", pairs.len()),
        None => format!("{name}: no such text"),
    };
    let mut lines = vec![
        format!("{} texts; the best walk ends at the goal for {right}", judgements.len()),
        format!("calibration error, {BINS} bins: {:.3} of the share of that walk,", error(|best| best.share)),
        format!(
            "    {:.3} of the share of all walks that end within {SUCCESS_M} m of its end",
            error(|best| best.nearby)
        ),
        auc_line("one turn flipped", &turns),
        auc_line("another path's text", &paths),
    ];
    lines.push(aligned_table(&ambiguity_rows(judgements)));
    lines
}

/// How often texts are called ambiguous at several bounds.
fn ambiguity_rows(judgements: &[FollowerJudgement]) -> Vec<Vec<String>> {
    let head = [
        "another end fits",
        "as well as the annotated one: all",
        "as well as the best: reader wrong",
        "reader right",
        "reader is right of these",
    ];
    let percent = |count: usize, whole: usize| format!("{:.1} %", 100.0 * count as f64 / whole.max(1) as f64);
    let best: Vec<&BestWalk> = judgements.iter().filter_map(|judgement| judgement.best.as_ref()).collect();
    let all_right = best.iter().filter(|best| best.is_right).count();
    let row = |bound: f64| {
        let near_own = judgements.iter().filter(|judgement| judgement.elsewhere >= bound.ln()).count();
        let near_best = best.iter().filter(|best| best.runner_up >= bound.ln());
        let (right, wrong): (Vec<&BestWalk>, Vec<&BestWalk>) = near_best.copied().partition(|best| best.is_right);
        vec![
            format!("{bound:.2}"),
            percent(near_own, judgements.len()),
            percent(wrong.len(), best.len() - all_right),
            percent(right.len(), all_right),
            percent(right.len(), right.len() + wrong.len()),
        ]
    };
    let head = head.map(str::to_owned).to_vec();
    std::iter::once(head).chain(AMBIGUITY_BOUNDS.map(row)).collect()
}

/// The expected calibration error: in each bin, the difference between the mean share and the rate of right cases, averaged over bins
/// by their numbers of cases.
fn calibration_error(cases: &[(f64, bool)]) -> f64 {
    let mut bins = [(0.0, 0.0); BINS];
    for (share, is_right) in cases {
        let bin = ((share * BINS as f64) as usize).min(BINS - 1);
        bins[bin].0 += share;
        bins[bin].1 += f64::from(u8::from(*is_right));
    }
    bins.iter().map(|(shares, right)| (shares - right).abs()).sum::<f64>() / cases.len().max(1) as f64
}

/// How often the second of a pair (of a wrong text) is higher than the first of any pair (of a right one). `None` without pairs.
fn pairwise_auc(pairs: &[[f64; 2]]) -> Option<f64> {
    let cases = pairs.iter().flat_map(|[right, wrong]| [(false, *right), (true, *wrong)]);
    (!pairs.is_empty()).then(|| area_under_curve(cases.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auc_is_one_where_every_wrong_text_is_above_every_right_one() {
        assert_eq!(pairwise_auc(&[[0.0, 2.0], [1.0, 3.0]]), Some(1.0));
        assert_eq!(pairwise_auc(&[[2.0, 0.0], [3.0, 1.0]]), Some(0.0));
        assert_eq!(pairwise_auc(&[[1.0, 1.0], [1.0, 1.0]]), Some(0.5));
        assert_eq!(pairwise_auc(&[[0.0, 1.0], [1.0, 2.0]]), Some(0.875));
        assert_eq!(pairwise_auc(&[]), None);
    }

    #[test]
    fn calibration_error_is_zero_for_shares_that_equal_their_hit_rate() {
        let half = |share: f64| [(share, true), (share, false)];
        assert!(calibration_error(&half(0.5)).abs() < 1e-12);
        assert!((calibration_error(&half(1.0)) - 0.5).abs() < 1e-12, "a share of 1 is in the last bin");
        assert_eq!(calibration_error(&[]), 0.0);
    }
}
