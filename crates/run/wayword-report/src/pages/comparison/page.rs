//! The values of a comparison for its HTML template.

use super::{
    figures::{
        ComparisonLine, DIFFERENCE_COLUMNS, EFFORT_COLUMNS, READS_NOTHING, RoundedFigure, SHORT_TABLE_METRICS,
        SWAP_COLUMNS, TROUBLE_COLUMNS, comparison_lines, difference_lines, effort_lines, metric_heading,
        printable_name, swap_lines, trouble_lines,
    },
    forest::{ForestContent, ForestView},
    notes,
};
use serde::Serialize;
use wayword_metrics::TrajectoryMetric;
use wayword_navigation::comparison::{AgentComparison, AgentKind};

/// The comparison as its template takes it.
#[derive(Debug, Serialize)]
pub(in super::super) struct ComparisonPageView {
    subject: String,
    success: String,
    warnings: Vec<String>,
    listeners: Vec<String>,
    sets: Vec<String>,
    notes: Vec<String>,
    table: TableView,
    /// Effort of and problems in walks by a language model; empty without an agent of this kind.
    efforts: Vec<TableView>,
    forests: Vec<ForestView>,
    /// Titles of the folded tables, with the tables.
    folded: Vec<(String, TableView)>,
    parameters: Vec<(String, Vec<(String, String)>)>,
}

/// A table with its headings; `beside` has the headings to the right of the figures.
#[derive(Debug, Serialize)]
struct TableView {
    label: &'static str,
    headings: Vec<String>,
    beside: Vec<&'static str>,
    lines: Vec<LineView>,
}

/// A line of a table. Each of its `cells` has a figure and its interval.
#[derive(Debug, Serialize)]
struct LineView {
    agent: String,
    opens: bool,
    kind: AgentKind,
    is_deaf: bool,
    label: String,
    cells: Vec<Option<(String, String)>>,
    beside: Vec<String>,
}

impl ComparisonPageView {
    pub(in super::super) fn new(comparison: &AgentComparison) -> Self {
        let (table, differences, swap_losses) =
            (comparison_lines(comparison), difference_lines(comparison), swap_lines(comparison));
        let first = comparison.sets.first().map_or_else(String::new, |set| printable_name(&set.name));
        let mut folded =
            vec![("All figures".to_owned(), TableView::new("Instructions", &table, &present_metrics(&table), vec![]))];
        if !differences.is_empty() {
            let view = TableView::new(
                "Instructions",
                &differences,
                &present_metrics(&differences),
                DIFFERENCE_COLUMNS.to_vec(),
            );
            folded.push((format!("All differences to {first}, and McNemar's test"), view));
        }
        if !swap_losses.is_empty() {
            let view = TableView::new("Swap", &swap_losses, &present_metrics(&swap_losses), SWAP_COLUMNS.to_vec());
            folded.push((format!("All losses by swaps of {first}"), view));
        }
        Self {
            subject: notes::describe_subject(&comparison.about),
            success: notes::describe_success(comparison.about.rule),
            warnings: notes::list_warnings(comparison),
            listeners: notes::listener_notes(comparison),
            sets: comparison.sets.iter().map(notes::describe_set).collect(),
            notes: notes::all_notes(comparison),
            table: TableView::new("Instructions", &table, &SHORT_TABLE_METRICS, vec![]),
            efforts: [
                (effort_lines(comparison), EFFORT_COLUMNS.to_vec()),
                (trouble_lines(comparison), TROUBLE_COLUMNS.to_vec()),
            ]
            .into_iter()
            .filter(|(lines, _)| !lines.is_empty())
            .map(|(lines, beside)| TableView::new("Instructions", &lines, &[], beside))
            .collect(),
            forests: draw_forests(&first, &table, &differences, &swap_losses),
            folded,
            parameters: parameter_lists(comparison),
        }
    }
}

impl TableView {
    fn new(
        label: &'static str,
        lines: &[ComparisonLine<'_>],
        metrics: &[TrajectoryMetric],
        beside: Vec<&'static str>,
    ) -> Self {
        let cells = |line: &ComparisonLine<'_>| {
            let cell = |figure: RoundedFigure| (number_with_minus(&figure.mean), number_with_minus(&figure.interval()));
            metrics.iter().map(|metric| line.rounded_figure(*metric).map(cell)).collect()
        };
        let line = |line: &ComparisonLine<'_>| LineView {
            agent: line.agent_with_kind(),
            opens: line.opens,
            kind: line.kind,
            is_deaf: line.is_deaf,
            label: line.label.clone(),
            cells: cells(line),
            beside: line.beside.clone(),
        };
        Self {
            label,
            headings: metrics.iter().map(|metric| metric_heading(*metric)).collect(),
            beside,
            lines: lines.iter().map(line).collect(),
        }
    }
}

/// The metrics that at least one line has.
fn present_metrics(lines: &[ComparisonLine<'_>]) -> Vec<TrajectoryMetric> {
    TrajectoryMetric::ALL
        .into_iter()
        .filter(|metric| lines.iter().any(|line| line.estimate(*metric).is_some()))
        .collect()
}

/// Numbers with a minus instead of a hyphen.
fn number_with_minus(text: &str) -> String {
    text.replace('-', "−")
}

fn draw_forests(
    first: &str,
    table: &[ComparisonLine<'_>],
    differences: &[ComparisonLine<'_>],
    swap_losses: &[ComparisonLine<'_>],
) -> Vec<ForestView> {
    let read: Vec<ComparisonLine<'_>> = table.iter().filter(|line| line.kind == AgentKind::Agent).cloned().collect();
    let mark = |line: &ComparisonLine<'_>| {
        let class = match line.kind {
            AgentKind::LowerBound => "lower-bound",
            AgentKind::Agent => return None,
            AgentKind::Informed | AgentKind::UpperBound => "upper-bound",
        };
        let figure = line.rounded_figure(TrajectoryMetric::SuccessRate)?;
        let by = if line.label == READS_NOTHING { String::new() } else { format!(" by {}", line.label) };
        Some((class, format!("{}{by} {}", line.agent, figure.mean), line.estimate(TrajectoryMetric::SuccessRate)?.mean))
    };
    let plots = [
        ForestContent {
            title: "Success rate, %".to_owned(),
            label: "Instructions",
            lines: &read,
            marks: table.iter().filter_map(mark).collect(),
            has_zero: false,
            caption: "Dot: mean over items. Bar: its interval.",
        },
        ForestContent {
            title: format!("Success rate minus that of {first}, points"),
            label: "Instructions",
            lines: differences,
            marks: vec![],
            has_zero: true,
            caption: "Right of the line: better than the first set. Hollow: the interval includes 0, so no difference is shown.",
        },
        ForestContent {
            title: format!("Success rate lost when {first} is swapped, points"),
            label: "Swap",
            lines: swap_losses,
            marks: vec![],
            has_zero: true,
            caption: "Right of the line: the agent does worse by swapped texts, so it follows what was swapped. Hollow: the interval includes 0, so that is not shown.",
        },
    ];
    plots.into_iter().filter_map(ForestContent::draw_forest).collect()
}

fn parameter_lists(comparison: &AgentComparison) -> Vec<(String, Vec<(String, String)>)> {
    let of_agent = |(agent, values): (&String, &std::collections::BTreeMap<String, String>)| {
        (
            printable_name(agent),
            values.iter().map(|(key, value)| (printable_name(key), printable_name(value))).collect(),
        )
    };
    comparison.about.parameters.iter().map(of_agent).collect()
}
