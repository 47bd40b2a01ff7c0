//! How far the follower can be believed: its calibration, and how well it tells wrong texts from right ones.

use crate::{
    corrupt_people::turned,
    fit_follower::texts::{Scene, Text, texts},
    share::table,
};
use clap::Args;
use rand::seq::IndexedRandom;
use rayon::prelude::*;
use std::{collections::BTreeMap, path::PathBuf};
use wayword::{error::Error, output::Output};
use wayword_core::rng;
use wayword_follower::{
    Fit, Guide, Prior, Tree, Trial, Weights, best,
    route::{Known, Thresholds, judge},
    shares,
};

/// The walks that are thought of.
const PRIOR: Prior = Prior::Shortest(8);
/// A walk that ends nearer than this to the goal succeeds, metres.
const SUCCESS_M: f64 = 3.0;
/// Bins of the calibration error, of equal width.
const BINS: usize = 10;
/// Bounds of ambiguity that are tried: another walk's share of the annotated one's.
const BOUNDS: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8];

#[derive(Debug, Args)]
pub(super) struct Flags {
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
    #[arg(long, default_value_t = usize::MAX)]
    limit: usize,
    /// Seed of the turns that are flipped, and of the other paths.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// What the follower says of a text.
struct Said {
    /// The share of the best walk, and whether it ends at the goal; `None` without a walk.
    best: Option<(f64, bool)>,
    /// How much better another walk fits than the annotated one, natural logs.
    elsewhere: f64,
    /// The best gain of a turn changed, of the text and of the same with one turn flipped; `None` without a turn.
    turns: Option<[f64; 2]>,
    /// [`Self::elsewhere`] of another path's text; `None` where the building has none.
    other_path: Option<f64>,
}

pub(super) fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let (scenes, files) = texts(&flags.data, std::slice::from_ref(&flags.file))?;
    let mut all: Vec<Text> = files.into_iter().flatten().collect();
    let is_in = |text: &Text, scans: &[String]| scans.iter().any(|one| one == scenes[text.scene].name.as_str());
    all.retain(|text| (flags.scans.is_empty() || is_in(text, &flags.scans)) && !is_in(text, &flags.except));
    let every = all.len().div_ceil(flags.limit.clamp(1, all.len().max(1)));
    let mut by_scene: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (at, text) in all.iter().enumerate() {
        by_scene.entry(text.scene).or_default().push(at);
    }
    let picked: Vec<usize> = (0..all.len()).step_by(every.max(1)).collect();
    let said = picked.par_iter().map(|at| said(&scenes, &all, &by_scene[&all[*at].scene], *at, flags.seed));
    let said: Vec<Said> = said.collect();
    output.data(&(), lines(&said).join("\n"));
    Ok(())
}

fn said(scenes: &[Scene], all: &[Text], neighbours: &[usize], at: usize, seed: u64) -> Said {
    let (text, weights) = (&all[at], Weights::fitted());
    let building = &scenes[text.scene].building;
    let tree = Tree::of(building, text.walk[0], text.heading_rad, PRIOR);
    let fit = Fit::new(&Trial::new(&text.guide, building), &tree, weights);
    let shares = shares(&fit, &tree);
    let best = best(&fit, &tree).map(|walk| (shares[walk], text.to_goal_m[tree.end(walk)] < SUCCESS_M));
    let known = Known { building, walk: &text.walk, heading_rad: text.heading_rad };
    let elsewhere = |guide: &Guide| {
        let judged = judge(guide, known, Some(PRIOR), weights, Thresholds::default());
        judged.route.map_or(0.0, |route| log_ratio(route.other, route.share))
    };
    let gain = |guide: &Guide| judge(guide, known, None, weights, Thresholds::default()).turn_gain;
    let purpose = |what: &'static str| rng(seed, &["reader figures", what, &at.to_string()]);
    let turns = turned(&text.words, &mut purpose("turn"))
        .and_then(|turned| Some([gain(&text.guide)?, gain(&Guide::read(&turned))?]));
    let is_apart = |other: &&usize| {
        let end = all[**other].walk.last();
        end.is_some_and(|end| text.to_goal_m[*end] >= SUCCESS_M)
    };
    let others: Vec<&usize> = neighbours.iter().filter(is_apart).collect();
    let other_path = others.choose(&mut purpose("path")).map(|other| elsewhere(&all[**other].guide));
    Said { best, elsewhere: elsewhere(&text.guide), turns, other_path }
}

/// The logarithm of a ratio of shares, which may be too small to be told from 0.
fn log_ratio(other: f64, own: f64) -> f64 {
    (other.max(f64::MIN_POSITIVE) / own.max(f64::MIN_POSITIVE)).ln()
}

fn lines(said: &[Said]) -> Vec<String> {
    let best: Vec<(f64, bool)> = said.iter().filter_map(|said| said.best).collect();
    let right = best.iter().filter(|(_, is_right)| *is_right).count();
    let turns: Vec<[f64; 2]> = said.iter().filter_map(|said| said.turns).collect();
    let paths: Vec<[f64; 2]> = said.iter().filter_map(|said| Some([said.elsewhere, said.other_path?])).collect();
    let told = |name: &str, pairs: &[[f64; 2]]| match auc(pairs) {
        Some(auc) => format!("{name}: AUC {auc:.3} ({} texts)", pairs.len()),
        None => format!("{name}: no such text"),
    };
    let mut lines = vec![
        format!("{} texts; the best walk ends at the goal for {right}", said.len()),
        format!("calibration error of its share, {BINS} bins: {:.3}", calibration_error(&best)),
        told("one turn flipped", &turns),
        told("another path's text", &paths),
    ];
    let mut rows = vec![
        ["another walk fits this well", "where the reader is wrong", "where it is right"].map(str::to_owned).to_vec(),
    ];
    let is_right = |said: &&Said| said.best.is_some_and(|(_, is_right)| is_right);
    let share = |part: &[&Said], bound: f64| {
        let ambiguous = part.iter().filter(|said| said.elsewhere >= bound.ln()).count();
        format!("{:.1} %", 100.0 * ambiguous as f64 / part.len().max(1) as f64)
    };
    let (right, wrong): (Vec<&Said>, Vec<&Said>) = said.iter().partition(is_right);
    rows.extend(BOUNDS.map(|bound| vec![format!("{bound:.2} of its own"), share(&wrong, bound), share(&right, bound)]));
    lines.push(table(&rows));
    lines
}

/// How far shares are from how often they are right, averaged over bins by their numbers of cases.
fn calibration_error(cases: &[(f64, bool)]) -> f64 {
    let mut bins = [(0.0, 0.0); BINS];
    for (share, is_right) in cases {
        let bin = ((share * BINS as f64) as usize).min(BINS - 1);
        bins[bin].0 += share;
        bins[bin].1 += f64::from(u8::from(*is_right));
    }
    bins.iter().map(|(shares, right)| (shares - right).abs()).sum::<f64>() / cases.len().max(1) as f64
}

/// How often the second of a pair (of a wrong text) is higher than the first of any pair (of a right one); a tie counts
/// half. `None` without pairs.
fn auc(pairs: &[[f64; 2]]) -> Option<f64> {
    let mut values: Vec<(f64, bool)> =
        pairs.iter().flat_map(|[right, wrong]| [(*right, false), (*wrong, true)]).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut below, mut wins) = (0.0, 0.0);
    for tied in values.chunk_by(|a, b| a.0 == b.0) {
        let wrong = tied.iter().filter(|(_, is_wrong)| *is_wrong).count() as f64;
        let right = tied.len() as f64 - wrong;
        wins += wrong * (below + right / 2.0);
        below += right;
    }
    (!pairs.is_empty()).then(|| wins / (pairs.len() * pairs.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auc_is_one_where_every_wrong_text_is_above_every_right_one() {
        assert_eq!(auc(&[[0.0, 2.0], [1.0, 3.0]]), Some(1.0));
        assert_eq!(auc(&[[2.0, 0.0], [3.0, 1.0]]), Some(0.0));
        assert_eq!(auc(&[[1.0, 1.0], [1.0, 1.0]]), Some(0.5));
        assert_eq!(auc(&[[0.0, 1.0], [1.0, 2.0]]), Some(0.875));
        assert_eq!(auc(&[]), None);
    }

    #[test]
    fn shares_that_are_right_as_often_as_they_say_have_no_error() {
        let half = |share: f64| [(share, true), (share, false)];
        assert!(calibration_error(&half(0.5)).abs() < 1e-12);
        assert!((calibration_error(&half(1.0)) - 0.5).abs() < 1e-12, "a share of 1 is in the last bin");
        assert_eq!(calibration_error(&[]), 0.0);
    }
}
