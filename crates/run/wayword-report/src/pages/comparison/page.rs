//! The values of a comparison for its HTML template.

use super::{
    figures::{
        BESIDE_DIFFERENCES, BESIDE_EFFORTS, BESIDE_SWAPS, BESIDE_TROUBLE, Figure, Line, READS_NOTHING, SHOWN,
        differences, efforts, heading, name, rows, swaps, trouble,
    },
    forest::{Forest, Plot},
    notes,
};
use serde::Serialize;
use wayword_metrics::Metric;
use wayword_navigation::comparison::{AgentKind, Comparison};

/// The comparison as its template takes it.
#[derive(Debug, Serialize)]
pub(in super::super) struct PageView {
    subject: String,
    success: String,
    warnings: Vec<String>,
    listeners: Vec<String>,
    sets: Vec<String>,
    notes: Vec<String>,
    table: TableView,
    /// Effort of and problems in walks by a language model; empty without an agent of this kind.
    efforts: Vec<TableView>,
    forests: Vec<Forest>,
    /// Titles of the folded tables, with the tables.
    folded: Vec<(String, TableView)>,
    parameters: Vec<(String, Vec<(String, String)>)>,
}

#[derive(Debug, Serialize)]
struct TableView {
    label: &'static str,
    headings: Vec<String>,
    beside: Vec<&'static str>,
    lines: Vec<LineView>,
}

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

impl PageView {
    pub(in super::super) fn new(comparison: &Comparison) -> Self {
        let (table, less, lost) = (rows(comparison), differences(comparison), swaps(comparison));
        let first = comparison.sets.first().map_or_else(String::new, |set| name(&set.name));
        let mut folded =
            vec![("All figures".to_owned(), TableView::new("Instructions", &table, &present(&table), vec![]))];
        if !less.is_empty() {
            let view = TableView::new("Instructions", &less, &present(&less), BESIDE_DIFFERENCES.to_vec());
            folded.push((format!("All differences to {first}, and McNemar's test"), view));
        }
        if !lost.is_empty() {
            let view = TableView::new("Swap", &lost, &present(&lost), BESIDE_SWAPS.to_vec());
            folded.push((format!("All losses by swaps of {first}"), view));
        }
        Self {
            subject: notes::subject(&comparison.about),
            success: notes::success(comparison.about.rule),
            warnings: notes::warnings(comparison),
            listeners: notes::listeners(comparison),
            sets: comparison.sets.iter().map(notes::set).collect(),
            notes: notes::notes(comparison),
            table: TableView::new("Instructions", &table, &SHOWN, vec![]),
            efforts: [(efforts(comparison), BESIDE_EFFORTS.to_vec()), (trouble(comparison), BESIDE_TROUBLE.to_vec())]
                .into_iter()
                .filter(|(lines, _)| !lines.is_empty())
                .map(|(lines, beside)| TableView::new("Instructions", &lines, &[], beside))
                .collect(),
            forests: forests(&first, &table, &less, &lost),
            folded,
            parameters: parameters(comparison),
        }
    }
}

impl TableView {
    fn new(label: &'static str, lines: &[Line<'_>], metrics: &[Metric], beside: Vec<&'static str>) -> Self {
        let cells = |line: &Line<'_>| {
            let cell = |figure: Figure| (number(&figure.mean), number(&figure.interval()));
            metrics.iter().map(|metric| line.figure(*metric).map(cell)).collect()
        };
        let line = |line: &Line<'_>| LineView {
            agent: line.who(),
            opens: line.opens,
            kind: line.kind,
            is_deaf: line.is_deaf,
            label: line.label.clone(),
            cells: cells(line),
            beside: line.beside.clone(),
        };
        Self {
            label,
            headings: metrics.iter().map(|metric| heading(*metric)).collect(),
            beside,
            lines: lines.iter().map(line).collect(),
        }
    }
}

/// The metrics that at least one line has.
fn present(lines: &[Line<'_>]) -> Vec<Metric> {
    Metric::ALL.into_iter().filter(|metric| lines.iter().any(|line| line.estimate(*metric).is_some())).collect()
}

/// Numbers with a minus instead of a hyphen.
fn number(text: &str) -> String {
    text.replace('-', "−")
}

fn forests(first: &str, table: &[Line<'_>], less: &[Line<'_>], lost: &[Line<'_>]) -> Vec<Forest> {
    let read: Vec<Line<'_>> = table.iter().filter(|line| line.kind == AgentKind::Agent).cloned().collect();
    let mark = |line: &Line<'_>| {
        let class = match line.kind {
            AgentKind::LowerBound => "lower-bound",
            AgentKind::Agent => return None,
            AgentKind::Informed | AgentKind::UpperBound => "upper-bound",
        };
        let figure = line.figure(Metric::SuccessRate)?;
        let by = if line.label == READS_NOTHING { String::new() } else { format!(" by {}", line.label) };
        Some((class, format!("{}{by} {}", line.agent, figure.mean), line.estimate(Metric::SuccessRate)?.mean))
    };
    let plots = [
        Plot {
            title: "Success rate, %".to_owned(),
            label: "Instructions",
            lines: &read,
            marks: table.iter().filter_map(mark).collect(),
            has_zero: false,
            caption: "Dot: mean over items. Bar: its interval.",
        },
        Plot {
            title: format!("Success rate minus that of {first}, points"),
            label: "Instructions",
            lines: less,
            marks: vec![],
            has_zero: true,
            caption: "Right of the line: better than the first set. Hollow: the interval includes 0, so no difference is shown.",
        },
        Plot {
            title: format!("Success rate lost when {first} is swapped, points"),
            label: "Swap",
            lines: lost,
            marks: vec![],
            has_zero: true,
            caption: "Right of the line: the agent does worse by swapped texts, so it follows what was swapped. Hollow: the interval includes 0, so that is not shown.",
        },
    ];
    plots.into_iter().filter_map(Plot::draw).collect()
}

fn parameters(comparison: &Comparison) -> Vec<(String, Vec<(String, String)>)> {
    let of_agent = |(agent, values): (&String, &std::collections::BTreeMap<String, String>)| {
        (name(agent), values.iter().map(|(key, value)| (name(key), name(value))).collect())
    };
    comparison.about.parameters.iter().map(of_agent).collect()
}
