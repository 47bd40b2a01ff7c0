//! Computes the positions, labels and captions of the plots on the page: figures with intervals, levels, wins and drop-off.

use super::{
    HandoutCounts, MeasureUnit, ResultVersion, StudyMeasure, StudyReport,
    escape::to_table_name,
    number_format::{self, format_number},
    tables,
};
use serde::Serialize;

/// A forest plot: the figures of the conditions with their intervals, one below the other on a common axis. Positions are in per cent
/// of the plot's width.
#[derive(Debug, Serialize)]
pub(super) struct ForestPlot {
    title: String,
    rows: Vec<ForestPlotRow>,
    ticks: Vec<AxisTick>,
    /// Position of zero, in a plot of differences.
    zero: Option<f64>,
    caption: String,
}

/// The figure of one condition in a forest plot.
#[derive(Debug, Serialize)]
struct ForestPlotRow {
    /// Its id in the page, to which the description is tied.
    id: String,
    label: String,
    is_control: bool,
    /// Position of the dot.
    at: f64,
    /// Both ends of the interval; `None` if there is no interval.
    whisker: Option<[f64; 2]>,
    /// Whether the dot is filled. A difference that may be 0 has an empty one.
    is_filled: bool,
    /// The value and its interval as text.
    figure: String,
    /// The counts behind the figure, and the method of its interval.
    counts: String,
    /// All of it as a sentence, for those who cannot see the plot.
    description: String,
}

#[derive(Debug, Serialize)]
struct AxisTick {
    at: f64,
    label: String,
}

/// Margin on either side, per cent of the plot's width, so that no dot is cut off.
const PLOT_MARGIN_PERCENT: f64 = 3.0;

/// The range of values of a plot, and the distance between two ticks.
struct PlotAxis {
    low: f64,
    high: f64,
    step: f64,
}

impl PlotAxis {
    /// The axis of a measure: its whole range, or from 0 to a round number above all values.
    fn for_measure(measure: &StudyMeasure, ends: &[f64]) -> Self {
        match measure.unit {
            MeasureUnit::PerCent => Self { low: 0.0, high: 1.0, step: 0.25 },
            MeasureUnit::Level => Self { low: 1.0, high: 5.0, step: 1.0 },
            MeasureUnit::Metres | MeasureUnit::Seconds | MeasureUnit::Count => {
                let step = quarter_of_round_number(largest_magnitude(ends));
                Self { low: 0.0, high: 4.0 * step, step }
            }
        }
    }

    /// The axis of differences, which is symmetric around zero.
    fn around_zero(ends: &[f64]) -> Self {
        let step = 2.0 * quarter_of_round_number(largest_magnitude(ends));
        Self { low: -2.0 * step, high: 2.0 * step, step }
    }

    /// The position of a value, per cent of the plot's width.
    fn place_percent(&self, value: f64) -> f64 {
        let along = (value.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        ((PLOT_MARGIN_PERCENT + along * (100.0 - 2.0 * PLOT_MARGIN_PERCENT)) * 100.0).round() / 100.0
    }

    fn axis_ticks(&self, measure: &StudyMeasure) -> Vec<AxisTick> {
        let count = ((self.high - self.low) / self.step).round() as usize;
        let digits = if self.step * display_factor(measure) < 1.0 {
            2
        } else {
            usize::from(self.step * display_factor(measure) < 5.0 && self.step.fract() != 0.0)
        };
        let tick = |at: usize| {
            let value = self.low + at as f64 * self.step;
            AxisTick { at: self.place_percent(value), label: format_number(value * display_factor(measure), digits) }
        };
        (0..=count).map(tick).collect()
    }
}

/// The factor between a value and its display: shares are shown in per cent.
fn display_factor(measure: &StudyMeasure) -> f64 {
    if measure.unit == MeasureUnit::PerCent { 100.0 } else { 1.0 }
}

fn largest_magnitude(ends: &[f64]) -> f64 {
    ends.iter().copied().filter(|end| end.is_finite()).map(f64::abs).fold(0.0, f64::max)
}

/// A quarter of the smallest round number that is at least `bound`.
fn quarter_of_round_number(bound: f64) -> f64 {
    let round = [
        0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0, 250.0, 500.0, 1000.0, 10_000.0,
    ];
    round.into_iter().find(|step| 4.0 * step >= bound).unwrap_or(100_000.0)
}

/// One plot for each measure for which any condition has a figure.
pub(super) fn figure_plots(results: &StudyReport, version: &ResultVersion) -> Vec<ForestPlot> {
    let forest = |measure: &StudyMeasure| {
        let figures: Vec<_> =
            version.rows.iter().filter_map(|row| Some((row, row.figures.get(measure.name)?))).collect();
        let ends: Vec<f64> =
            figures.iter().flat_map(|(_, figure)| with_ends(figure.value, figure.interval.as_ref())).collect();
        let axis = (!figures.is_empty()).then(|| PlotAxis::for_measure(measure, &ends))?;
        let row = |(at, (row, figure)): (usize, &(&super::ConditionRow, &wayword_metrics::StudyFigure))| {
            let shown = figure_text(measure, figure.value, figure.interval.as_ref());
            let label = tables::condition_title(&row.condition, row.kind);
            let counts = format!(
                "{}, {}, {}; {}",
                number_format::count_with_noun(figure.answers, "answer", "answers"),
                number_format::count_with_noun(figure.persons, "person", "persons"),
                number_format::count_with_noun(figure.items, "route", "routes"),
                number_format::method_name(figure.method)
            );
            ForestPlotRow {
                id: format!("f-{}-{}-{at}", version.name, measure.name),
                description: format!("{label}: {shown}. {counts}."),
                label,
                is_control: row.is_control,
                at: axis.place_percent(figure.value),
                whisker: figure
                    .interval
                    .as_ref()
                    .map(|interval| [axis.place_percent(interval.low), axis.place_percent(interval.high)]),
                is_filled: true,
                figure: shown,
                counts,
            }
        };
        Some(ForestPlot {
            title: measure.heading_with_unit(),
            rows: figures.iter().enumerate().map(row).collect(),
            ticks: axis.axis_ticks(measure),
            zero: None,
            caption: to_sentence(measure.meaning),
        })
    };
    results.measures.iter().filter_map(forest).collect()
}

/// One plot of the differences to the first condition for each measure that has any.
pub(super) fn difference_plots(results: &StudyReport, version: &ResultVersion) -> Vec<ForestPlot> {
    let forest = |measure: &StudyMeasure| {
        let figures: Vec<_> = version
            .differences
            .iter()
            .filter_map(|difference| Some((difference, difference.figures.get(measure.name)?)))
            .collect();
        let ends: Vec<f64> =
            figures.iter().flat_map(|(_, figure)| with_ends(figure.value, figure.interval.as_ref())).collect();
        let axis = (!figures.is_empty()).then(|| PlotAxis::around_zero(&ends))?;
        let row = |(at, (difference, figure)): (
            usize,
            &(&super::ConditionDifference, &wayword_metrics::FigureDifference),
        )| {
            let shown = figure_text(measure, figure.value, figure.interval.as_ref());
            let kind = version
                .rows
                .iter()
                .find(|row| row.condition == difference.condition)
                .map_or(crate::ConditionKind::Run, |row| row.kind);
            let label = tables::condition_title(&difference.condition, kind);
            let beside_zero = |interval: &wayword_metrics::ConfidenceInterval| interval.leaves_out(0.0);
            let counts = number_format::method_name(figure.method).to_owned();
            ForestPlotRow {
                id: format!("d-{}-{}-{at}", version.name, measure.name),
                description: format!("{label} minus {}: {shown}. {counts}.", to_table_name(&difference.minus)),
                label,
                is_control: kind != crate::ConditionKind::Run,
                at: axis.place_percent(figure.value),
                whisker: figure
                    .interval
                    .as_ref()
                    .map(|interval| [axis.place_percent(interval.low), axis.place_percent(interval.high)]),
                is_filled: figure.interval.as_ref().is_some_and(beside_zero),
                figure: shown,
                counts,
            }
        };
        let unit = if measure.unit == MeasureUnit::PerCent {
            format!("{}, points", measure.label)
        } else {
            measure.heading_with_unit()
        };
        Some(ForestPlot {
            title: unit,
            rows: figures.iter().enumerate().map(row).collect(),
            ticks: axis.axis_ticks(measure),
            zero: Some(axis.place_percent(0.0)),
            caption: to_sentence(measure.meaning),
        })
    };
    results.measures.iter().filter_map(forest).collect()
}

/// A value and the ends of its interval.
fn with_ends(value: f64, interval: Option<&wayword_metrics::ConfidenceInterval>) -> Vec<f64> {
    std::iter::once(value).chain(interval.into_iter().flat_map(|interval| [interval.low, interval.high])).collect()
}

fn figure_text(measure: &StudyMeasure, value: f64, interval: Option<&wayword_metrics::ConfidenceInterval>) -> String {
    let ends = interval
        .map_or_else(|| "no interval".to_owned(), |interval| number_format::format_interval(measure, Some(interval)));
    format!("{} {ends}", number_format::format_value(measure, value))
}

/// Makes a sentence of a phrase: a capital letter in front and a full stop behind.
fn to_sentence(meaning: &str) -> String {
    let mut letters = meaning.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

/// How often each level of a question was chosen, as one bar for each condition.
#[derive(Debug, Serialize)]
pub(super) struct LevelBars {
    title: String,
    rows: Vec<BarRow>,
    levels: Vec<String>,
}

#[derive(Debug, Serialize)]
struct BarRow {
    id: String,
    label: String,
    description: String,
    parts: Vec<BarSegment>,
    answers: usize,
}

/// A piece of a bar.
#[derive(Debug, Serialize)]
struct BarSegment {
    /// Number of the segment's colour class, from 1.
    class: usize,
    at: f64,
    width: f64,
    /// The count, if there is room for it on the segment; otherwise empty.
    label: String,
}

/// Width of a digit on a phone, per cent of the width of a bar of levels.
const DIGIT_WIDTH_PERCENT: f64 = 4.0;
/// Width of a digit on a phone, per cent of the width of a bar in the matrix, which is narrower.
const NARROW_DIGIT_WIDTH_PERCENT: f64 = 6.0;

/// The pieces of a bar, one for each count above 0. `digit_percent` is the width of a digit, per cent of the bar.
fn bar_segments(counts: &[usize], digit_percent: f64) -> Vec<BarSegment> {
    let all: usize = counts.iter().sum();
    let share = |count: usize| 100.0 * count as f64 / all.max(1) as f64;
    let round = |place: f64| (place * 100.0).round() / 100.0;
    let mut before = 0;
    let mut part = |(class, count): (usize, &usize)| {
        let at = share(before);
        before += count;
        let number = count.to_string();
        let label = if share(*count) < digit_percent * (number.len() + 1) as f64 { String::new() } else { number };
        (*count > 0).then(|| BarSegment { class, at: round(at), width: round(share(*count)), label })
    };
    (1..).zip(counts).filter_map(&mut part).collect()
}

/// One plot of levels for each question.
pub(super) fn level_bars(results: &StudyReport, version: &ResultVersion) -> Vec<LevelBars> {
    let bars = |scale: &crate::wording::RatingScale| LevelBars {
        title: scale.text.to_owned(),
        levels: (1..).zip(scale.levels).map(|(level, word): (u8, &str)| format!("{level} {word}")).collect(),
        rows: version
            .rows
            .iter()
            .enumerate()
            .filter_map(|(at, row)| {
                let counts = row.levels.get(scale.name)?;
                let answers: usize = counts.iter().sum();
                let label = tables::condition_title(&row.condition, row.kind);
                let level_counts: Vec<String> =
                    counts.iter().zip(scale.levels).map(|(count, word)| format!("{word} {count}")).collect();
                (answers > 0).then(|| BarRow {
                    id: format!("b-{}-{}-{at}", version.name, scale.name),
                    description: format!("{label}: {}.", level_counts.join(", ")),
                    label,
                    parts: bar_segments(counts, DIGIT_WIDTH_PERCENT),
                    answers,
                })
            })
            .collect(),
    };
    results.scales.iter().map(bars).filter(|bars| !bars.rows.is_empty()).collect()
}

/// How often each condition wins against each other one.
#[derive(Debug, Serialize)]
pub(super) struct WinMatrix {
    conditions: Vec<String>,
    rows: Vec<MatrixRow>,
}

#[derive(Debug, Serialize)]
struct MatrixRow {
    label: String,
    cells: Vec<Option<MatrixCell>>,
}

#[derive(Debug, Serialize)]
struct MatrixCell {
    id: String,
    share: String,
    interval: String,
    description: String,
    parts: Vec<BarSegment>,
}

/// The matrix of the comparisons of a version; `None` if there are none.
pub(super) fn win_matrix(version: &ResultVersion) -> Option<WinMatrix> {
    let pairs = version.pairs.as_ref().filter(|pairs| !pairs.rows.is_empty())?;
    let names: Vec<&str> = version.rows.iter().map(|row| row.condition.as_str()).collect();
    let cell = |row: usize, column: usize| {
        let (this, other) = (names[row], names[column]);
        let pair = pairs.rows.iter().find(|pair| {
            (pair.first == this && pair.second == other) || (pair.first == other && pair.second == this)
        })?;
        let is_first = pair.first == this;
        let (wins, losses) =
            if is_first { (pair.first_wins, pair.second_wins) } else { (pair.second_wins, pair.first_wins) };
        let share = pair.share.as_ref()?;
        let turn = |value: f64| if is_first { value } else { 1.0 - value };
        let ends = share.interval.as_ref().map(|interval| {
            let (a, b) = (turn(interval.low), turn(interval.high));
            wayword_metrics::ConfidenceInterval { low: a.min(b), high: a.max(b) }
        });
        Some(MatrixCell {
            id: format!("m-{}-{row}-{column}", version.name),
            share: format!("{} %", format_number(100.0 * turn(share.value), 1)),
            interval: tables::format_percent_interval(ends.as_ref()),
            description: format!(
                "{} against {}: {wins} wins, {} ties, {} both bad, {losses} losses.",
                to_table_name(this),
                to_table_name(other),
                pair.ties,
                pair.both_bad
            ),
            parts: bar_segments(&[wins, pair.ties, pair.both_bad, losses], NARROW_DIGIT_WIDTH_PERCENT),
        })
    };
    let row = |row: usize| MatrixRow {
        label: to_table_name(names[row]),
        cells: (0..names.len()).map(|column| cell(row, column)).collect(),
    };
    Some(WinMatrix {
        conditions: names.iter().map(|one| to_table_name(one)).collect(),
        rows: (0..names.len()).map(row).collect(),
    })
}

/// The drop-off plot: how many participants got an item at each position, and how many answered it.
#[derive(Debug, Serialize)]
pub(super) struct DropOff {
    given: String,
    answered: String,
    dots: Vec<[f64; 2]>,
    across: Vec<AxisTick>,
    up: Vec<AxisTick>,
    description: String,
}

/// The inner size of the drop-off plot and its margins, in the units of its SVG.
const PLOT_WIDTH: f64 = 300.0;
const PLOT_HEIGHT: f64 = 140.0;
const PLOT_LEFT_MARGIN: f64 = 34.0;
const PLOT_TOP_MARGIN: f64 = 10.0;

/// Computes the drop-off plot; `None` if no item was handed out.
pub(super) fn drop_off(rows: &[HandoutCounts]) -> Option<DropOff> {
    let most = rows.iter().map(|row| row.given).max().filter(|most| *most > 0)? as f64;
    let top = 4.0 * quarter_of_round_number(most).max(1.0);
    let last = (rows.len().max(2) - 1) as f64;
    let round = |place: f64| (place * 10.0).round() / 10.0;
    let x = |at: usize| round(PLOT_LEFT_MARGIN + PLOT_WIDTH * at as f64 / last);
    let y = |count: f64| round(PLOT_TOP_MARGIN + PLOT_HEIGHT * (1.0 - count / top));
    let line = |count: &dyn Fn(&HandoutCounts) -> usize| {
        let points: Vec<String> =
            rows.iter().enumerate().map(|(at, row)| format!("{} {}", x(at), y(count(row) as f64))).collect();
        format!("M{}", points.join("L"))
    };
    let label_step = rows.len().div_ceil(10).max(1);
    let across =
        (0..rows.len()).filter(|at| at % label_step == 0).map(|at| AxisTick { at: x(at), label: (at + 1).to_string() });
    let up = (0..=4)
        .map(|at| AxisTick { at: y(top / 4.0 * f64::from(at)), label: format_number(top / 4.0 * f64::from(at), 0) });
    let ends = |row: &HandoutCounts| format!("{} were given one and {} answered it", row.given, row.answered);
    let (first, end) = (rows.first()?, rows.last()?);
    Some(DropOff {
        given: line(&|row| row.given),
        answered: line(&|row| row.answered),
        dots: rows.iter().enumerate().map(|(at, row)| [x(at), y(row.answered as f64)]).collect(),
        across: across.collect(),
        up: up.collect(),
        description: format!("At position 1, {}. At position {}, {}.", ends(first), rows.len(), ends(end)),
    })
}
