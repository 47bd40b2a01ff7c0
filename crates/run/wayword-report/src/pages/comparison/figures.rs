//! Computes the lines and rounded figures of a comparison's tables. Every format (screen, Markdown, LaTeX, page) shows the same.

use std::{collections::BTreeMap, fmt};
use wayword_metrics::{McNemar, MeanEstimate, TrajectoryMetric};
use wayword_navigation::{
    comparison::{
        AgentComparison, AgentKind, ComparisonRow, EMPTY_SET_SUFFIX, EffortSummary, ListeningVerdict, SwapEffect,
    },
    swap::InstructionSwap,
    walk::{UselessReplies, WalkEnd},
};

/// The metrics of the short table. The full table has all.
pub(super) const SHORT_TABLE_METRICS: [TrajectoryMetric; 3] =
    [TrajectoryMetric::SuccessRate, TrajectoryMetric::OracleSuccessRate, TrajectoryMetric::Spl];
/// Most characters of a name, because names come from files. The rest is cut off.
const MAX_NAME_CHARS: usize = 80;

/// A figure with its interval, rounded: shares in per cent, lengths in metres.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RoundedFigure {
    pub(super) mean: String,
    pub(super) low: String,
    pub(super) high: String,
}

impl RoundedFigure {
    pub(super) fn from_estimate(metric: TrajectoryMetric, estimate: &MeanEstimate) -> Self {
        let rounded = |value| round_figure(metric, value);
        Self { mean: rounded(estimate.mean), low: rounded(estimate.low), high: rounded(estimate.high) }
    }

    /// As `[low, high]`.
    pub(super) fn interval(&self) -> String {
        format!("[{}, {}]", self.low, self.high)
    }
}

impl fmt::Display for RoundedFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.mean, self.interval())
    }
}

/// The heading of a column. Shares are in per cent.
pub(super) fn metric_heading(metric: TrajectoryMetric) -> String {
    if is_share(metric) { format!("{} %", metric.table_name()) } else { metric.table_name().to_owned() }
}

fn is_share(metric: TrajectoryMetric) -> bool {
    !matches!(metric, TrajectoryMetric::NavigationErrorM | TrajectoryMetric::TrajectoryLengthM)
}

fn round_figure(metric: TrajectoryMetric, value: f64) -> String {
    let value = if is_share(metric) { 100.0 * value } else { value };
    // A comparison's file can contain any number.
    if value.abs() >= 1e6 {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_owned() } else { text }
}

/// McNemar's p as papers write it.
fn p_value_text(test: &McNemar) -> String {
    match test.p {
        _ if test.only_first + test.only_second == 0 => "-".to_owned(),
        p if p < 0.001 => "< 0.001".to_owned(),
        p => format!("{p:.3}"),
    }
}

/// A line of a table: an agent with one set of instructions or one swap.
#[derive(Debug, Clone)]
pub(super) struct ComparisonLine<'a> {
    pub(super) agent: String,
    pub(super) kind: AgentKind,
    /// Whether it is the agent's first line, which shows the agent's name.
    pub(super) opens: bool,
    /// Whether the agent is not shown to do worse with another path's instruction.
    pub(super) is_deaf: bool,
    /// The set, or the swap.
    pub(super) label: String,
    figures: &'a BTreeMap<TrajectoryMetric, MeanEstimate>,
    /// Cells to the right of the figures.
    pub(super) beside: Vec<String>,
}

impl ComparisonLine<'_> {
    pub(super) fn estimate(&self, metric: TrajectoryMetric) -> Option<&MeanEstimate> {
        self.figures.get(&metric)
    }

    pub(super) fn rounded_figure(&self, metric: TrajectoryMetric) -> Option<RoundedFigure> {
        Some(RoundedFigure::from_estimate(metric, self.estimate(metric)?))
    }

    /// The agent with its kind.
    pub(super) fn agent_with_kind(&self) -> String {
        let kind = match self.kind {
            AgentKind::LowerBound => ", lower bound",
            AgentKind::Agent => "",
            AgentKind::Informed => ", knows the map",
            AgentKind::UpperBound => ", upper bound",
        };
        format!("{}{}{kind}", self.agent, if self.is_deaf { DEAF_MARK } else { "" })
    }
}

/// Marks an agent that is not shown to do worse with another path's instruction.
pub(super) const DEAF_MARK: &str = "†";
/// The label of an agent that reads no set.
pub(super) const READS_NOTHING: &str = "reads nothing";
/// Columns to the right of the differences.
pub(super) const DIFFERENCE_COLUMNS: [&str; 3] = ["only this", "only first", "p"];
/// Columns to the right of the swaps.
pub(super) const SWAP_COLUMNS: [&str; 3] = ["texts changed", "p", "follows"];

/// The lines of the main table.
pub(super) fn comparison_lines(comparison: &AgentComparison) -> Vec<ComparisonLine<'_>> {
    mark_first_lines(comparison.rows.iter().map(|row| line_for_row(comparison, row, &row.figures, vec![])))
}

/// Each set minus the first, with the numbers of items on which only one of the two succeeds.
pub(super) fn difference_lines(comparison: &AgentComparison) -> Vec<ComparisonLine<'_>> {
    mark_first_lines(comparison.rows.iter().filter_map(|row| {
        let difference = row.against_first.as_ref()?;
        let mcnemar = difference.mcnemar;
        let beside = vec![mcnemar.only_first.to_string(), mcnemar.only_second.to_string(), p_value_text(&mcnemar)];
        Some(line_for_row(comparison, row, &difference.figures, beside))
    }))
}

/// The lines of the swaps: how much success each swap of the first set costs.
pub(super) fn swap_lines(comparison: &AgentComparison) -> Vec<ComparisonLine<'_>> {
    mark_first_lines(comparison.swaps.iter().map(|swapped| ComparisonLine {
        agent: printable_name(&swapped.agent),
        kind: comparison.rows.iter().find(|row| row.agent == swapped.agent).map_or(AgentKind::Agent, |row| row.kind),
        opens: false,
        is_deaf: is_deaf(comparison, &swapped.agent),
        label: swap_words(swapped.swap).to_owned(),
        figures: &swapped.lost.figures,
        beside: vec![
            format!("{} of {}", swapped.changed, swapped.texts),
            p_value_text(&swapped.lost.mcnemar),
            match swapped.listening {
                ListeningVerdict::Shown => "yes",
                ListeningVerdict::NotShown => "not shown",
                ListeningVerdict::TooFew => "too few paths",
            }
            .to_owned(),
        ],
    }))
}

/// Columns for the effort of walks.
pub(super) const EFFORT_COLUMNS: [&str; 7] =
    ["calls", "tokens in", "tokens out", "US$", "hops", "seconds", "largest prompt"];
/// Columns for problems in walks.
pub(super) const TROUBLE_COLUMNS: [&str; 8] = [
    "walks",
    "no call",
    "no such way",
    "looks twice",
    "refused or empty",
    "views not described",
    "stops at once",
    "ended by a limit",
];

/// The average effort of walks by a language model: calls, tokens, money, time.
pub(super) fn effort_lines(comparison: &AgentComparison) -> Vec<ComparisonLine<'_>> {
    lines_with_efforts(comparison, |effort| {
        let means =
            [&effort.calls, &effort.tokens_in, &effort.tokens_out].map(|estimate| mean_with_interval(estimate, 1));
        let usd = effort.usd.as_ref().map_or_else(|| "-".to_owned(), |usd| mean_with_interval(usd, 4));
        let rest = [
            mean_with_interval(&effort.hops, 1),
            mean_with_interval(&effort.seconds, 1),
            effort.most_tokens_in.to_string(),
        ];
        means.into_iter().chain([usd]).chain(rest).collect()
    })
}

/// The problems in walks by a language model: counts of useless replies, then counts of walks.
pub(super) fn trouble_lines(comparison: &AgentComparison) -> Vec<ComparisonLine<'_>> {
    lines_with_efforts(comparison, |effort| {
        let UselessReplies { no_call, no_way, idle, failed } = effort.useless;
        let by_a_limit: usize = effort
            .ended
            .iter()
            .filter(|(end, _)| !matches!(end, WalkEnd::Stopped | WalkEnd::DeadEnd))
            .map(|(_, walks)| walks)
            .sum();
        [effort.walks, no_call, no_way, idle, failed, effort.undescribed, effort.at_once, by_a_limit]
            .map(|count| count.to_string())
            .to_vec()
    })
}

/// A line without figures for each row that has an effort, with the cells that `beside` makes of it.
fn lines_with_efforts(
    comparison: &AgentComparison,
    beside: impl Fn(&EffortSummary) -> Vec<String>,
) -> Vec<ComparisonLine<'_>> {
    let line = |row: &'_ ComparisonRow| Some(line_for_row(comparison, row, &NO_FIGURES, beside(row.effort.as_ref()?)));
    mark_first_lines(comparison.rows.iter().filter_map(line))
}

/// A line without figures.
static NO_FIGURES: BTreeMap<TrajectoryMetric, MeanEstimate> = BTreeMap::new();

/// A mean with its interval, with that many decimals.
fn mean_with_interval(estimate: &MeanEstimate, decimals: usize) -> String {
    let MeanEstimate { mean, low, high, .. } = estimate;
    if mean.abs() >= 1e9 {
        return format!("{mean:.1e}");
    }
    format!("{mean:.decimals$} [{low:.decimals$}, {high:.decimals$}]")
}

/// The line for a row of the comparison.
fn line_for_row<'a>(
    comparison: &AgentComparison,
    row: &ComparisonRow,
    figures: &'a BTreeMap<TrajectoryMetric, MeanEstimate>,
    beside: Vec<String>,
) -> ComparisonLine<'a> {
    ComparisonLine {
        agent: printable_name(&row.agent),
        kind: row.kind,
        opens: false,
        is_deaf: row.set.is_some() && is_deaf(comparison, &row.agent),
        label: row.set.as_deref().map_or_else(|| READS_NOTHING.to_owned(), set_words),
        figures,
        beside,
    }
}

/// Marks the first of the consecutive lines of each agent, which shows the agent's name.
fn mark_first_lines<'a>(lines: impl Iterator<Item = ComparisonLine<'a>>) -> Vec<ComparisonLine<'a>> {
    let mut before = None;
    let open = |mut line: ComparisonLine<'a>| {
        line.opens = before.as_ref() != Some(&line.agent);
        before = Some(line.agent.clone());
        line
    };
    lines.map(open).collect()
}

/// The agents that are not shown to do worse with another path's instruction.
pub(super) fn deaf_agents(comparison: &AgentComparison) -> impl Iterator<Item = &SwapEffect> {
    other_path_swaps(comparison).filter(|swapped| swapped.listening == ListeningVerdict::NotShown)
}

/// The results of the swap with another path's instruction, for each agent.
pub(super) fn other_path_swaps(comparison: &AgentComparison) -> impl Iterator<Item = &SwapEffect> {
    comparison.swaps.iter().filter(|swapped| swapped.swap == InstructionSwap::OtherPath)
}

fn is_deaf(comparison: &AgentComparison, agent: &str) -> bool {
    deaf_agents(comparison).any(|swapped| swapped.agent == agent)
}

/// A set in words. `SET~SWAP` is a control set, which shows how much an agent reaches without its own instruction.
fn set_words(set: &str) -> String {
    match set.split_once('~') {
        Some((_, EMPTY_SET_SUFFIX)) => "an empty text".to_owned(),
        Some((_, swap)) if swap == InstructionSwap::OtherPath.name() => {
            swap_words(InstructionSwap::OtherPath).to_owned()
        }
        _ => printable_name(set),
    }
}

/// A swap in words.
fn swap_words(swap: InstructionSwap) -> &'static str {
    match swap {
        InstructionSwap::Directions => "directions swapped",
        InstructionSwap::Landmarks => "landmarks replaced",
        InstructionSwap::Sentences => "sentences shuffled",
        InstructionSwap::OtherPath => "another path's instruction",
    }
}

/// A name without control characters, because names come from files and a terminal would obey them.
pub(super) fn printable_name(name: &str) -> String {
    let mut shown: String =
        name.chars().take(MAX_NAME_CHARS).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if name.chars().nth(MAX_NAME_CHARS).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_in_per_cent_and_lengths_in_metres() {
        let estimate = MeanEstimate { mean: -0.0001, low: -0.123, high: 0.456, values: 1, clusters: 1 };
        assert_eq!(RoundedFigure::from_estimate(TrajectoryMetric::Spl, &estimate).to_string(), "0.0 [-12.3, 45.6]");
        assert_eq!(
            RoundedFigure::from_estimate(TrajectoryMetric::NavigationErrorM, &estimate).to_string(),
            "0.0 [-0.1, 0.5]"
        );
        let wild = MeanEstimate { mean: f64::MAX, ..estimate };
        assert!(RoundedFigure::from_estimate(TrajectoryMetric::TrajectoryLengthM, &wild).mean.len() < 10);
    }

    #[test]
    fn name_removes_control_characters_and_cuts_long_names() {
        assert_eq!(printable_name("a\u{1b}[31m\nb"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(printable_name(&"x".repeat(500)).chars().count(), MAX_NAME_CHARS + 1);
    }
}
