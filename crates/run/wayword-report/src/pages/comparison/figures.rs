//! Computes the lines and rounded figures of a comparison's tables. Every format (screen, Markdown, LaTeX, page) shows the same.

use std::{collections::BTreeMap, fmt};
use wayword_metrics::{Estimate, McNemar, Metric};
use wayword_navigation::{
    comparison::{AgentKind, Comparison, EMPTY, Efforts, Listening, Row, Swapped},
    swap::Swap,
    walk::{End, Useless},
};

/// The metrics of the short table. The full table has all.
pub(super) const SHOWN: [Metric; 3] = [Metric::SuccessRate, Metric::OracleSuccessRate, Metric::Spl];
/// Longest name, characters, because names come from files.
const MOST_NAME_CHARS: usize = 80;

/// A figure with its interval, rounded: shares in per cent, lengths in metres.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Figure {
    pub(super) mean: String,
    pub(super) low: String,
    pub(super) high: String,
}

impl Figure {
    pub(super) fn of(metric: Metric, estimate: &Estimate) -> Self {
        let rounded = |value| rounded(metric, value);
        Self { mean: rounded(estimate.mean), low: rounded(estimate.low), high: rounded(estimate.high) }
    }

    /// As `[low, high]`.
    pub(super) fn interval(&self) -> String {
        format!("[{}, {}]", self.low, self.high)
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.mean, self.interval())
    }
}

/// The heading of a column. Shares are in per cent.
pub(super) fn heading(metric: Metric) -> String {
    if is_share(metric) { format!("{} %", metric.short()) } else { metric.short().to_owned() }
}

fn is_share(metric: Metric) -> bool {
    !matches!(metric, Metric::NavigationErrorM | Metric::TrajectoryLengthM)
}

fn rounded(metric: Metric, value: f64) -> String {
    let value = if is_share(metric) { 100.0 * value } else { value };
    // A comparison's file can contain any number.
    if value.abs() >= 1e6 {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_owned() } else { text }
}

/// McNemar's p as papers write it.
fn p(test: &McNemar) -> String {
    match test.p {
        _ if test.only_first + test.only_second == 0 => "-".to_owned(),
        p if p < 0.001 => "< 0.001".to_owned(),
        p => format!("{p:.3}"),
    }
}

/// A line of a table: an agent with one set of instructions or one swap.
#[derive(Debug, Clone)]
pub(super) struct Line<'a> {
    pub(super) agent: String,
    pub(super) kind: AgentKind,
    /// Whether it is the agent's first line, which shows the agent's name.
    pub(super) opens: bool,
    /// Whether the agent is not shown to do worse with another path's instruction.
    pub(super) is_deaf: bool,
    /// The set, or the swap.
    pub(super) label: String,
    figures: &'a BTreeMap<Metric, Estimate>,
    /// Cells to the right of the figures.
    pub(super) beside: Vec<String>,
}

impl Line<'_> {
    pub(super) fn estimate(&self, metric: Metric) -> Option<&Estimate> {
        self.figures.get(&metric)
    }

    pub(super) fn figure(&self, metric: Metric) -> Option<Figure> {
        Some(Figure::of(metric, self.estimate(metric)?))
    }

    /// The agent with its kind.
    pub(super) fn who(&self) -> String {
        let kind = match self.kind {
            AgentKind::LowerBound => ", lower bound",
            AgentKind::Agent => "",
            AgentKind::Informed => ", knows the map",
            AgentKind::UpperBound => ", upper bound",
        };
        format!("{}{}{kind}", self.agent, if self.is_deaf { DEAF } else { "" })
    }
}

/// Marks an agent that is not shown to do worse with another path's instruction.
pub(super) const DEAF: &str = "†";
/// The label of an agent that reads no set.
pub(super) const READS_NOTHING: &str = "reads nothing";
/// Columns to the right of the differences.
pub(super) const BESIDE_DIFFERENCES: [&str; 3] = ["only this", "only first", "p"];
/// Columns to the right of the swaps.
pub(super) const BESIDE_SWAPS: [&str; 3] = ["texts changed", "p", "follows"];

/// The lines of the main table.
pub(super) fn rows(comparison: &Comparison) -> Vec<Line<'_>> {
    opened(comparison.rows.iter().map(|row| of_row(comparison, row, &row.figures, vec![])))
}

/// Each set minus the first, with the numbers of items on which only one of the two succeeds.
pub(super) fn differences(comparison: &Comparison) -> Vec<Line<'_>> {
    opened(comparison.rows.iter().filter_map(|row| {
        let difference = row.against_first.as_ref()?;
        let mcnemar = difference.mcnemar;
        let beside = vec![mcnemar.only_first.to_string(), mcnemar.only_second.to_string(), p(&mcnemar)];
        Some(of_row(comparison, row, &difference.figures, beside))
    }))
}

/// The lines of the swaps: how much success each swap of the first set costs.
pub(super) fn swaps(comparison: &Comparison) -> Vec<Line<'_>> {
    opened(comparison.swaps.iter().map(|swapped| Line {
        agent: name(&swapped.agent),
        kind: comparison.rows.iter().find(|row| row.agent == swapped.agent).map_or(AgentKind::Agent, |row| row.kind),
        opens: false,
        is_deaf: is_deaf(comparison, &swapped.agent),
        label: swap_words(swapped.swap).to_owned(),
        figures: &swapped.lost.figures,
        beside: vec![
            format!("{} of {}", swapped.changed, swapped.texts),
            p(&swapped.lost.mcnemar),
            match swapped.listening {
                Listening::Shown => "yes",
                Listening::NotShown => "not shown",
                Listening::TooFew => "too few paths",
            }
            .to_owned(),
        ],
    }))
}

/// Columns for the effort of walks.
pub(super) const BESIDE_EFFORTS: [&str; 7] =
    ["calls", "tokens in", "tokens out", "US$", "hops", "seconds", "largest prompt"];
/// Columns for problems in walks.
pub(super) const BESIDE_TROUBLE: [&str; 8] = [
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
pub(super) fn efforts(comparison: &Comparison) -> Vec<Line<'_>> {
    of_efforts(comparison, |effort| {
        let means = [&effort.calls, &effort.tokens_in, &effort.tokens_out].map(|estimate| plain(estimate, 1));
        let usd = effort.usd.as_ref().map_or_else(|| "-".to_owned(), |usd| plain(usd, 4));
        let rest = [plain(&effort.hops, 1), plain(&effort.seconds, 1), effort.most_tokens_in.to_string()];
        means.into_iter().chain([usd]).chain(rest).collect()
    })
}

/// The problems in those walks: counts of useless replies, then of walks.
pub(super) fn trouble(comparison: &Comparison) -> Vec<Line<'_>> {
    of_efforts(comparison, |effort| {
        let Useless { no_call, no_way, idle, failed } = effort.useless;
        let by_a_limit: usize = effort
            .ended
            .iter()
            .filter(|(end, _)| !matches!(end, End::Stopped | End::DeadEnd))
            .map(|(_, walks)| walks)
            .sum();
        [effort.walks, no_call, no_way, idle, failed, effort.undescribed, effort.at_once, by_a_limit]
            .map(|count| count.to_string())
            .to_vec()
    })
}

fn of_efforts(comparison: &Comparison, beside: impl Fn(&Efforts) -> Vec<String>) -> Vec<Line<'_>> {
    let line = |row: &'_ Row| Some(of_row(comparison, row, &NONE, beside(row.effort.as_ref()?)));
    opened(comparison.rows.iter().filter_map(line))
}

/// A line without figures.
static NONE: BTreeMap<Metric, Estimate> = BTreeMap::new();

/// A mean with its interval, with that many decimals.
fn plain(estimate: &Estimate, decimals: usize) -> String {
    let Estimate { mean, low, high, .. } = estimate;
    if mean.abs() >= 1e9 {
        return format!("{mean:.1e}");
    }
    format!("{mean:.decimals$} [{low:.decimals$}, {high:.decimals$}]")
}

fn of_row<'a>(
    comparison: &Comparison,
    row: &Row,
    figures: &'a BTreeMap<Metric, Estimate>,
    beside: Vec<String>,
) -> Line<'a> {
    Line {
        agent: name(&row.agent),
        kind: row.kind,
        opens: false,
        is_deaf: row.set.is_some() && is_deaf(comparison, &row.agent),
        label: row.set.as_deref().map_or_else(|| READS_NOTHING.to_owned(), set_words),
        figures,
        beside,
    }
}

fn opened<'a>(lines: impl Iterator<Item = Line<'a>>) -> Vec<Line<'a>> {
    let mut before = None;
    let open = |mut line: Line<'a>| {
        line.opens = before.as_ref() != Some(&line.agent);
        before = Some(line.agent.clone());
        line
    };
    lines.map(open).collect()
}

/// The agents that are not shown to do worse with another path's instruction.
pub(super) fn deaf(comparison: &Comparison) -> impl Iterator<Item = &Swapped> {
    other_path(comparison).filter(|swapped| swapped.listening == Listening::NotShown)
}

/// The results of the swap with another path's instruction, for each agent.
pub(super) fn other_path(comparison: &Comparison) -> impl Iterator<Item = &Swapped> {
    comparison.swaps.iter().filter(|swapped| swapped.swap == Swap::OtherPath)
}

fn is_deaf(comparison: &Comparison, agent: &str) -> bool {
    deaf(comparison).any(|swapped| swapped.agent == agent)
}

/// A set in words. `SET~SWAP` is a control set, which shows how much an agent reaches without its own instruction.
fn set_words(set: &str) -> String {
    match set.split_once('~') {
        Some((_, EMPTY)) => "an empty text".to_owned(),
        Some((_, swap)) if swap == Swap::OtherPath.name() => swap_words(Swap::OtherPath).to_owned(),
        _ => name(set),
    }
}

/// A swap in words.
fn swap_words(swap: Swap) -> &'static str {
    match swap {
        Swap::Directions => "directions swapped",
        Swap::Landmarks => "landmarks replaced",
        Swap::Sentences => "sentences shuffled",
        Swap::OtherPath => "another path's instruction",
    }
}

/// A name without control characters, because names come from files and a terminal would obey them.
pub(super) fn name(name: &str) -> String {
    let mut shown: String =
        name.chars().take(MOST_NAME_CHARS).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if name.chars().nth(MOST_NAME_CHARS).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_in_per_cent_and_lengths_in_metres() {
        let estimate = Estimate { mean: -0.0001, low: -0.123, high: 0.456, values: 1, clusters: 1 };
        assert_eq!(Figure::of(Metric::Spl, &estimate).to_string(), "0.0 [-12.3, 45.6]");
        assert_eq!(Figure::of(Metric::NavigationErrorM, &estimate).to_string(), "0.0 [-0.1, 0.5]");
        let wild = Estimate { mean: f64::MAX, ..estimate };
        assert!(Figure::of(Metric::TrajectoryLengthM, &wild).mean.len() < 10);
    }

    #[test]
    fn name_removes_control_characters_and_cuts_long_names() {
        assert_eq!(name("a\u{1b}[31m\nb"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(name(&"x".repeat(500)).chars().count(), MOST_NAME_CHARS + 1);
    }
}
