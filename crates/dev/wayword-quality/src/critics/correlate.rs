//! Rank correlations of critics with outcomes of texts. The intervals come from a bootstrap that resamples whole scenes, because texts
//! about one scene are not independent.

use super::{CriticsArgs, OutcomeText, TextOutcomes, figures::CriticFigures};
use rand::Rng;
use serde::Serialize;
use std::collections::BTreeMap;
use wayword_core::seeded_rng;
use wayword_metrics::{kendall_tau_b, percentile_interval, spearman_correlation};

/// Confidence level of the intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// How well a critic agrees with an outcome of texts. A correlation is given as value, low end and high end of its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct CriticCorrelation {
    /// The agent, or the group of people, that walked or rated.
    pub(super) who: String,
    /// The measure of success or quality.
    pub(super) outcome: String,
    pub(super) critic: &'static str,
    /// Texts that have the critic's figure and an outcome.
    pub(super) texts: usize,
    /// Answers to all texts of the outcome.
    pub(super) answers: usize,
    /// Scenes of these texts.
    pub(super) scenes: usize,
    pub(super) tau_b: Option<[f64; 3]>,
    pub(super) spearman: Option<[f64; 3]>,
}

/// Correlates one critic with one outcome. The intervals resample whole scenes.
pub(super) fn correlate_critic(
    texts: &[OutcomeText],
    outcomes: &TextOutcomes,
    critic: &CriticFigures,
    flags: &CriticsArgs,
) -> CriticCorrelation {
    let mut scenes: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for (at, outcome) in &outcomes.text_means {
        if let Some(figure) = critic.figures[*at] {
            scenes.entry(&texts[*at].scene).or_default().push((figure, *outcome));
        }
    }
    let scenes: Vec<Vec<(f64, f64)>> = scenes.into_values().collect();
    // The same draws for each critic of one outcome.
    let mut dice = seeded_rng(flags.seed, &["critics", &outcomes.who]);
    let draw = |_| (0..scenes.len()).map(|_| dice.random_range(0..scenes.len())).collect::<Vec<usize>>();
    let drawn: Vec<Vec<usize>> = (0..flags.resamples).map(draw).collect();
    let whole: Vec<usize> = (0..scenes.len()).collect();
    let with_interval = |correlation: fn(&[f64], &[f64]) -> Option<f64>| {
        let correlate_scenes = |drawn: &Vec<usize>| {
            let (figures, outcomes): (Vec<f64>, Vec<f64>) =
                drawn.iter().flat_map(|at| scenes[*at].iter().copied()).unzip();
            correlation(&figures, &outcomes)
        };
        let value = correlate_scenes(&whole)?;
        let [low, high] = percentile_interval(drawn.iter().filter_map(correlate_scenes).collect(), CONFIDENCE_LEVEL)?;
        Some([value, low, high])
    };
    CriticCorrelation {
        who: outcomes.who.clone(),
        outcome: outcomes.outcome.clone(),
        critic: critic.name,
        texts: scenes.iter().map(Vec::len).sum(),
        answers: outcomes.answers,
        scenes: scenes.len(),
        tau_b: with_interval(kendall_tau_b),
        spearman: with_interval(spearman_correlation),
    }
}

/// The lines of the table that is printed.
pub(super) fn table_lines(found: &[CriticCorrelation]) -> Vec<String> {
    let cell = |correlation: Option<[f64; 3]>| match correlation {
        Some([value, low, high]) => format!("{value:+.2} [{low:+.2}, {high:+.2}]"),
        None => "- (it never varies)".to_owned(),
    };
    let heading = format!(
        "{:<20} {:<11} {:<15} {:>22} {:>22} {:>6} {:>7} {:>6}",
        "who", "outcome", "critic", "Kendall's tau-b", "Spearman", "texts", "answers", "scenes"
    );
    let row = |correlation: &CriticCorrelation| {
        let CriticCorrelation { who, outcome, critic, texts, answers, scenes, .. } = correlation;
        let (tau_b, spearman) = (cell(correlation.tau_b), cell(correlation.spearman));
        format!("{who:<20} {outcome:<11} {critic:<15} {tau_b:>22} {spearman:>22} {texts:>6} {answers:>7} {scenes:>6}")
    };
    [heading].into_iter().chain(found.iter().map(row)).collect()
}
