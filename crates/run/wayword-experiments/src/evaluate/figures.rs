//! The figures of a submission, for the screen and as JSON: means over instructions, as the official evaluators give them, with
//! bootstrap intervals.

use super::SubmissionCoverage;
use crate::{
    compare::followed_set,
    evaluate::args::EvaluateArgs,
    judge::{CONFIDENCE_LEVEL, SubmissionScores},
};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};
use wayword_metrics::{MeanEstimate, TrajectoryMetric, TrajectorySuccessRule};
use wayword_run::count::count_phrase;

/// Figures that depend on the rule of success; the others are the same under every rule.
const RULE_DEPENDENT_METRICS: [TrajectoryMetric; 4] =
    [TrajectoryMetric::SuccessRate, TrajectoryMetric::OracleSuccessRate, TrajectoryMetric::Spl, TrajectoryMetric::Sdtw];

/// The settings of the bootstrap that gives the intervals: the number of resamples and the seed.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct SubmissionResampling {
    pub(super) resamples: usize,
    pub(super) seed: u64,
}

/// All figures of a submission.
#[derive(Debug, Serialize)]
pub(super) struct SubmissionReport {
    submission: String,
    episodes: String,
    /// The set of texts that the agents followed, if a comparison wrote the submission and the set is not that of the episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    followed: Option<String>,
    /// Instructions that were scored, and the items and paths that they belong to.
    instructions: usize,
    items: usize,
    paths: usize,
    /// Instructions and items that the episodes have, with or without a trajectory.
    of_instructions: usize,
    of_items: usize,
    /// Only this many items count, from the beginning of the episodes' file.
    #[serde(skip_serializing_if = "Option::is_none")]
    limit: Option<u32>,
    /// Items that are not scored because their path is one place, as in a test split.
    hidden_items: usize,
    /// Trajectories for later items and for hidden ones, which do not count.
    left_out: usize,
    /// Instructions for which an object was named.
    objects_named: usize,
    /// Confidence level of the intervals, which are clustered by path.
    level: f64,
    #[serde(flatten)]
    drawn: SubmissionResampling,
    rules: Vec<RuleFigures>,
    /// Figures that do not depend on the rule of success.
    whatever_the_rule: BTreeMap<TrajectoryMetric, SubmissionFigure>,
}

/// The figures under one rule of success.
#[derive(Debug, Serialize)]
struct RuleFigures {
    rule: TrajectorySuccessRule,
    /// The rule in words.
    words: &'static str,
    figures: BTreeMap<TrajectoryMetric, SubmissionFigure>,
}

/// A mean over instructions.
#[derive(Debug, Serialize)]
struct SubmissionFigure {
    #[serde(flatten)]
    estimate: MeanEstimate,
    /// Instructions for which the figure cannot be computed. The mean leaves them out.
    left_out: usize,
}

impl SubmissionReport {
    pub(super) fn new(
        args: &EvaluateArgs,
        scores: &SubmissionScores,
        covered: SubmissionCoverage,
        rules: &[TrajectorySuccessRule],
        drawn: SubmissionResampling,
    ) -> Self {
        let has_objects = scores.rows().iter().any(|row| row.score.grounding.is_some());
        let by_rule = |rule: &TrajectorySuccessRule| RuleFigures {
            rule: *rule,
            words: rule_in_words(*rule, has_objects),
            figures: compute_figures(scores, *rule, drawn, |metric| RULE_DEPENDENT_METRICS.contains(&metric)),
        };
        Self {
            submission: args.submission.display().to_string(),
            episodes: args.episodes.display().to_string(),
            followed: followed_set(&args.submission, &args.episodes),
            instructions: scores.rows().len(),
            items: scores.item_ids().collect::<BTreeSet<_>>().len(),
            paths: scores.path_names().collect::<BTreeSet<_>>().len(),
            of_instructions: covered.instructions,
            of_items: covered.items,
            limit: args.limit,
            hidden_items: covered.hidden,
            left_out: covered.left_out,
            objects_named: scores.rows().iter().filter(|row| row.names_object).count(),
            level: CONFIDENCE_LEVEL,
            drawn,
            rules: rules.iter().map(by_rule).collect(),
            whatever_the_rule: compute_figures(scores, TrajectorySuccessRule::Distance, drawn, |metric| {
                !RULE_DEPENDENT_METRICS.contains(&metric)
            }),
        }
    }
}

/// A rule of success in words. It is the official one for REVERIE if episodes have objects, and for R2R if not.
fn rule_in_words(rule: TrajectorySuccessRule, has_objects: bool) -> &'static str {
    match (rule, has_objects) {
        (TrajectorySuccessRule::Visible, _) => {
            "the target is visible from the last viewpoint (REVERIE's official rule)"
        }
        (TrajectorySuccessRule::Distance, true) => {
            "the last viewpoint is under 3 m from the goal (the lenient rule: on REVERIE not the official one)"
        }
        (TrajectorySuccessRule::Distance, false) => {
            "the last viewpoint is under 3 m from the goal (R2R's official rule)"
        }
    }
}

/// The figures that at least one instruction has.
fn compute_figures(
    scores: &SubmissionScores,
    rule: TrajectorySuccessRule,
    drawn: SubmissionResampling,
    is_wanted: impl Fn(TrajectoryMetric) -> bool,
) -> BTreeMap<TrajectoryMetric, SubmissionFigure> {
    let figure = |metric: TrajectoryMetric| {
        let estimate = scores.metric_estimate(metric, rule, drawn.resamples, drawn.seed)?;
        Some((metric, SubmissionFigure { left_out: scores.rows().len() - estimate.values, estimate }))
    };
    TrajectoryMetric::ALL.into_iter().filter(|metric| is_wanted(*metric)).filter_map(figure).collect()
}

impl fmt::Display for SubmissionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {} of {} on {}",
            self.submission,
            count_phrase(self.instructions, "instruction"),
            count_phrase(self.items, "item"),
            count_phrase(self.paths, "path")
        )?;
        if self.instructions < self.of_instructions {
            writeln!(
                f,
                "partial: {} of {} and {} of {} of {} are scored; the figures are of these only",
                self.instructions,
                count_phrase(self.of_instructions, "instruction"),
                self.items,
                count_phrase(self.of_items, "item"),
                self.episodes
            )?;
        }
        if let Some(set) = &self.followed {
            writeln!(
                f,
                "these walks follow the texts of the set {set}: the figures are theirs, on the paths of {}",
                self.episodes
            )?;
        }
        if self.hidden_items > 0 {
            writeln!(
                f,
                "{} of {} not scored: the path is one place, as in a test split, whose way is hidden",
                count_phrase(self.hidden_items, "item"),
                self.episodes
            )?;
        }
        if let Some(limit) = self.limit {
            writeln!(
                f,
                "only the first {} of {} count; left out, because they are for other items: {}",
                count_phrase(u64::from(limit), "item"),
                self.episodes,
                count_phrase(self.left_out, "trajectory")
            )?;
        }
        for RuleFigures { words, figures, .. } in &self.rules {
            writeln!(f, "\nsuccess: {words}")?;
            write_figure_table(f, figures)?;
        }
        writeln!(f, "\nindependent of the rule of success")?;
        write_figure_table(f, &self.whatever_the_rule)?;
        if self.whatever_the_rule.contains_key(&TrajectoryMetric::Rgs) && self.objects_named == 0 {
            writeln!(f, "no trajectory names an object (predObjId), so RGS and RGSPL are 0")?;
        }
        if self.paths == 1 {
            return write!(f, "\nmeans over instructions, without intervals, because all are about one path");
        }
        write!(f, "\nmeans over instructions, with {:.0} % intervals, clustered by path", self.level * 100.0)
    }
}

fn write_figure_table(
    f: &mut fmt::Formatter<'_>,
    figures: &BTreeMap<TrajectoryMetric, SubmissionFigure>,
) -> fmt::Result {
    for (metric, SubmissionFigure { estimate, left_out }) in figures {
        let (name, mean) = (metric.table_name(), estimate.mean);
        match metric {
            TrajectoryMetric::NavigationErrorM | TrajectoryMetric::TrajectoryLengthM => {
                write!(f, "  {name:<7} {mean:>7.2}")?;
                if let Some([low, high]) = estimate.interval() {
                    write!(f, "     {low:.2} to {high:.2}")?;
                }
            }
            _ => {
                write!(f, "  {name:<7} {:>6.1} %", mean * 100.0)?;
                if let Some([low, high]) = estimate.interval() {
                    write!(f, "    {:.1} to {:.1} %", low * 100.0, high * 100.0)?;
                }
            }
        }
        if *left_out > 0 {
            let why = if *metric == TrajectoryMetric::NavigationErrorM {
                "the goal cannot be reached"
            } else {
                "no object is known"
            };
            write!(f, "   ({left_out} left out: {why})")?;
        }
        writeln!(f)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_metrics::{SuccessOutcome, TrajectoryScore};

    fn score(navigation_error_m: Option<f64>) -> TrajectoryScore {
        let nothing = SuccessOutcome { success: false, oracle_success: false, spl: 0.0, sdtw: 0.0 };
        TrajectoryScore {
            length_m: 2.0,
            navigation_error_m,
            oracle_error_m: navigation_error_m,
            distance: nothing,
            visible: None,
            grounding: None,
            ndtw: 0.5,
            cls: 0.5,
        }
    }

    #[test]
    fn compute_figures_leaves_missing_values_out_of_the_mean() {
        let all = SubmissionScores::of_one_path([Some(4.0), None, Some(6.0)].map(score).into());
        let found = compute_figures(
            &all,
            TrajectorySuccessRule::Distance,
            SubmissionResampling { resamples: 100, seed: 0 },
            |_| true,
        );
        let error = &found[&TrajectoryMetric::NavigationErrorM];
        assert!((error.estimate.mean - 5.0).abs() < 1e-12);
        assert_eq!((error.left_out, found[&TrajectoryMetric::SuccessRate].left_out), (1, 0));
        assert!(!found.contains_key(&TrajectoryMetric::Rgs));
        struct Shown(BTreeMap<TrajectoryMetric, SubmissionFigure>);
        impl fmt::Display for Shown {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write_figure_table(f, &self.0)
            }
        }
        let shown = Shown(found).to_string();
        assert!(shown.contains("5.00   (1 left out: the goal cannot be reached)"), "one path has no interval: {shown}");
    }
}
