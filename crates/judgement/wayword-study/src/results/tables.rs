//! Makes the tables of the report as text, independent of the output format; Markdown, LaTeX and the page all print these.

use super::{
    ConditionDifference, EndQuestionCounts, HandoutCounts, QuestionAgreement, ResultVersion, StudyMeasure, StudyReport,
    escape::{self, to_table_name},
    measure::PAPER_MEASURE_NAMES,
    number_format::{self, NO_FIGURE, count_with_noun, format_number},
    pairs::{ConditionStrengths, PairRow},
    version::CHOICE_QUESTION_NAME,
};
use crate::{ConditionKind, EndQuestionKind};
use serde::Serialize;
use wayword_metrics::wilson_interval;

/// A table of text.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ResultTable {
    pub(super) title: String,
    pub(super) notes: Vec<String>,
    pub(super) heads: Vec<ColumnHeading>,
    pub(super) rows: Vec<ResultRow>,
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ColumnHeading {
    pub(super) text: String,
    pub(super) is_number: bool,
}

/// A row. `opens` marks the first row of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ResultRow {
    pub(super) cells: Vec<String>,
    pub(super) opens: bool,
}

impl ResultTable {
    /// A table without rows. Its first `texts` columns contain text, the others numbers.
    fn new(title: impl Into<String>, heads: &[&str], texts: usize) -> Self {
        let head = |(at, text): (usize, &&str)| ColumnHeading { text: (*text).to_owned(), is_number: at >= texts };
        Self {
            title: title.into(),
            notes: Vec::new(),
            heads: heads.iter().enumerate().map(head).collect(),
            rows: Vec::new(),
        }
    }

    fn add_row(&mut self, opens: bool, cells: impl IntoIterator<Item = String>) {
        self.rows.push(ResultRow { cells: cells.into_iter().collect(), opens });
    }
}

/// A condition's name, with a note if it is a control.
pub(super) fn condition_title(condition: &str, kind: ConditionKind) -> String {
    let note = match kind {
        ConditionKind::Run => "",
        ConditionKind::People => " (control: people)",
        ConditionKind::OtherPath => " (control: other path)",
        ConditionKind::Corrupted => " (control: corrupted)",
    };
    format!("{}{note}", to_table_name(condition))
}

/// All figures of a version.
pub(super) fn figure_table(results: &StudyReport, version: &ResultVersion) -> ResultTable {
    let heads = ["Figure", "Condition", "Value", "95 % interval", "Answers", "Persons", "Routes", "Interval by"];
    let mut table = ResultTable::new("All figures", &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for measure in results.measures {
        for (at, row) in version.rows.iter().enumerate() {
            let figure = row.figures.get(measure.name);
            let cell =
                |of: &dyn Fn(&wayword_metrics::StudyFigure) -> String| figure.map_or_else(|| NO_FIGURE.to_owned(), of);
            let cells = [
                if at == 0 { measure.heading_with_unit() } else { String::new() },
                condition_title(&row.condition, row.kind),
                cell(&|figure| number_format::format_value(measure, figure.value)),
                cell(&|figure| number_format::format_interval(measure, figure.interval.as_ref())),
                figure.map_or(0, |figure| figure.answers).to_string(),
                figure.map_or(0, |figure| figure.persons).to_string(),
                figure.map_or(0, |figure| figure.items).to_string(),
                cell(&|figure| number_format::method_name(figure.method).to_owned()),
            ];
            table.add_row(at == 0, cells);
        }
    }
    table
}

/// Each condition minus the first one; `None` where there are no differences.
pub(super) fn difference_table(results: &StudyReport, version: &ResultVersion) -> Option<ResultTable> {
    let first = version.differences.first()?;
    let heads = ["Figure", "Condition", "Difference", "95 % interval", "Interval by"];
    let mut table = ResultTable::new(format!("Minus {}", to_table_name(&first.minus)), &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for measure in results.measures {
        for (at, difference) in version.differences.iter().enumerate() {
            let heading = if at == 0 { measure.heading_with_unit() } else { String::new() };
            table.add_row(
                at == 0,
                difference_row(measure, difference, heading, condition_kind(version, &difference.condition)),
            );
        }
    }
    Some(table)
}

/// The kind of a condition, by its name.
fn condition_kind(version: &ResultVersion, condition: &str) -> ConditionKind {
    version.rows.iter().find(|row| row.condition == condition).map_or(ConditionKind::Run, |row| row.kind)
}

/// The cells of one figure of a condition minus the first one.
fn difference_row(
    measure: &StudyMeasure,
    difference: &ConditionDifference,
    heading: String,
    kind: ConditionKind,
) -> [String; 5] {
    let figure = difference.figures.get(measure.name);
    let nothing = || NO_FIGURE.to_owned();
    [
        heading,
        condition_title(&difference.condition, kind),
        figure.map_or_else(nothing, |figure| number_format::format_value(measure, figure.value)),
        figure.map_or_else(nothing, |figure| number_format::format_interval(measure, figure.interval.as_ref())),
        figure.map_or_else(nothing, |figure| number_format::method_name(figure.method).to_owned()),
    ]
}

/// The shares that arXiv 2403.11487 reports for its 30 people, as counts. Its 16.5 % is not a share of 30; the nearest is 5 of 30.
const PAPER_COUNTS: [f64; 4] = [13.0, 25.0, 5.0, 22.0];
/// How many people answered in that paper, each about one item.
const PAPER_PARTICIPANTS: f64 = 30.0;

/// The four questions evaluated as the paper does it, with the paper's own figures in the last row. `None` unless the mode is rating.
pub(super) fn paper_table(results: &StudyReport, version: &ResultVersion) -> Option<ResultTable> {
    let find = |name: &&str| results.measures.iter().find(|measure| measure.name == *name);
    let measures: Vec<&StudyMeasure> = PAPER_MEASURE_NAMES.iter().filter_map(find).collect();
    if measures.len() < PAPER_MEASURE_NAMES.len() {
        return None;
    }
    let headings: Vec<String> = measures.iter().map(|measure| measure.heading_with_unit()).collect();
    let heads: Vec<&str> = std::iter::once("Condition").chain(headings.iter().map(String::as_str)).collect();
    let mut table = ResultTable::new("As the paper reads the questions", &heads, 1);
    for row in &version.rows {
        let figures = measures.iter().map(|measure| {
            row.figures.get(measure.name).map_or_else(
                || NO_FIGURE.to_owned(),
                |figure| {
                    let value = number_format::format_value(measure, figure.value);
                    format!("{value} {}", number_format::format_interval(measure, figure.interval.as_ref()))
                },
            )
        });
        table.add_row(false, std::iter::once(condition_title(&row.condition, row.kind)).chain(figures));
    }
    let paper_figures = measures.iter().zip(PAPER_COUNTS).map(|(measure, count)| {
        let interval = wilson_interval(count, PAPER_PARTICIPANTS, results.level);
        format!(
            "{} {}",
            number_format::format_value(measure, count / PAPER_PARTICIPANTS),
            number_format::format_interval(measure, interval.as_ref())
        )
    });
    table.add_row(true, std::iter::once("arXiv 2403.11487: 30 people, one item each".to_owned()).chain(paper_figures));
    table.notes.push(
        "The wording and the scale of the paper's questions are lost, and it showed no text of people or of another path beside. So \
         the last row tells how far its own figures reach (Wilson's interval of 30 answers), not what to expect here."
            .to_owned(),
    );
    Some(table)
}

/// How often each level was chosen. With `in_words` the column headings have the words of the levels, else only their numbers.
pub(super) fn level_tables(results: &StudyReport, version: &ResultVersion, in_words: bool) -> Vec<ResultTable> {
    let head = |level: u8, word: &str| if in_words { format!("{level} {word}") } else { level.to_string() };
    let table = |scale: &crate::wording::RatingScale| {
        let heads: Vec<String> = (1..).zip(scale.levels).map(|(level, word): (u8, &str)| head(level, word)).collect();
        let heads: Vec<&str> =
            ["Condition"].into_iter().chain(heads.iter().map(String::as_str)).chain(["Answers"]).collect();
        let mut table = ResultTable::new(format!("{}: {}", scale.name, scale.text), &heads, 1);
        for row in &version.rows {
            let counts = row.levels.get(scale.name).copied().unwrap_or_default();
            let all: usize = counts.iter().sum();
            let cells = counts.iter().map(ToString::to_string).chain([all.to_string()]);
            table.add_row(false, std::iter::once(condition_title(&row.condition, row.kind)).chain(cells));
        }
        table
    };
    results.scales.iter().map(table).collect()
}

/// The tables of comparisons: one row for each pair of conditions, and the strengths of the conditions.
pub(super) fn pair_tables(version: &ResultVersion) -> Vec<ResultTable> {
    let Some(pairs) = &version.pairs else { return Vec::new() };
    let heads = ["First", "Second", "Wins", "Losses", "Ties", "Both bad", "Share, %", "95 % interval", "Interval by"];
    let mut table = ResultTable::new("Comparisons", &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for row in &pairs.rows {
        table.add_row(false, pair_cells(row));
    }
    if let Some(side) = &pairs.side {
        table.notes.push(
            "Wins, losses and the share are of the first one; the share counts half of what has no winner.".to_owned(),
        );
        table.notes.push(format!(
            "Of the comparisons with a preference, {} % preferred the text shown as A, {} ({}).",
            format_number(100.0 * side.value, 1),
            format_percent_interval(side.interval.as_ref()),
            number_format::method_name(side.method)
        ));
    }
    vec![table, strength_table(&pairs.strengths)]
}

fn pair_cells(row: &PairRow) -> [String; 9] {
    let nothing = || NO_FIGURE.to_owned();
    [
        to_table_name(&row.first),
        to_table_name(&row.second),
        row.first_wins.to_string(),
        row.second_wins.to_string(),
        row.ties.to_string(),
        row.both_bad.to_string(),
        row.share.as_ref().map_or_else(nothing, |share| format_number(100.0 * share.value, 1)),
        row.share.as_ref().map_or_else(nothing, |share| format_percent_interval(share.interval.as_ref())),
        row.share.as_ref().map_or_else(nothing, |share| number_format::method_name(share.method).to_owned()),
    ]
}

/// An interval of a share, in per cent.
pub(super) fn format_percent_interval(interval: Option<&wayword_metrics::ConfidenceInterval>) -> String {
    let ends = |interval: &wayword_metrics::ConfidenceInterval| {
        format!("[{}, {}]", format_number(100.0 * interval.low, 1), format_number(100.0 * interval.high, 1))
    };
    interval.map_or_else(|| NO_FIGURE.to_owned(), ends)
}

fn strength_table(strengths: &ConditionStrengths) -> ResultTable {
    let heads = ["Condition", "Wins", "Losses", "Ties", "Both bad", "Strength", "95 % interval"];
    let mut table = ResultTable::new("Strengths (Bradley-Terry, ties after Davidson)", &heads, 1);
    match strengths {
        ConditionStrengths::Unknown { why, .. } => {
            table.notes.push(format!("There are no strengths: {}.", to_table_name(why)));
        }
        ConditionStrengths::Known(known) => {
            for one in &known.strengths {
                let counts = [one.wins, one.losses, one.ties, one.both_bad].map(|count| count.to_string());
                let term = [format_number(one.term.value, 3), number_format::format_ends(Some(&one.term.interval), 3)];
                table.add_row(false, std::iter::once(to_table_name(&one.system)).chain(counts).chain(term));
            }
            table.notes.push(format!(
                "Strengths are logarithms that sum to 0: the difference of two is the log of the odds of the one over the other where \
                 neither ties. The text shown as A gains {} {} on the same scale. {}, {}, {}; the variance is clustered by persons and by \
                 routes.",
                format_number(known.side.value, 3),
                number_format::format_ends(Some(&known.side.interval), 3),
                count_with_noun(known.comparisons, "comparison", "comparisons"),
                count_with_noun(known.persons, "person", "persons"),
                count_with_noun(known.items, "route", "routes"),
            ));
            if let Some(tie) = &known.tie {
                table.notes.push(format!(
                    "The log of Davidson's parameter of ties is {} {}; both bad counts as a tie.",
                    format_number(tie.value, 3),
                    number_format::format_ends(Some(&tie.interval), 3)
                ));
            }
        }
    }
    table
}

/// Krippendorff's alpha of each question.
pub(super) fn agreement_table(version: &ResultVersion) -> ResultTable {
    let heads = ["Question", "Alpha", "95 % interval", "Answers", "Persons", "Items"];
    let mut table = ResultTable::new("Agreement (Krippendorff's alpha)", &heads, 1);
    for QuestionAgreement { name, alpha } in &version.agreement {
        let label = if *name == CHOICE_QUESTION_NAME { "choice between the texts (nominal)" } else { name };
        let cells = match alpha {
            Some(alpha) => [
                format_number(alpha.alpha, 3),
                number_format::format_ends(alpha.interval.as_ref(), 3),
                alpha.answers.to_string(),
                alpha.persons.to_string(),
                alpha.items.to_string(),
            ],
            None => [NO_FIGURE, NO_FIGURE, "0", "0", "0"].map(str::to_owned),
        };
        table.add_row(false, std::iter::once(label.to_owned()).chain(cells));
    }
    table.notes.push(
        "1: those who judged the same item always agree; 0: as often as by chance. The interval is a jackknife's over persons and \
         items. Answers that nobody else gave to the same item \
         do not count; an item is a text, so conditions are apart. No value: no item has two answers, or all are the same."
            .to_owned(),
    );
    table
}

/// How many participants there are, by how far they came.
pub(super) fn submission_table(results: &StudyReport) -> ResultTable {
    let people = &results.people;
    let lease = format!("Started, gone quiet for more than {} minutes", people.lease_s.div_ceil(60));
    let rows: [(&str, u64); 9] = [
        ("Consented", people.consented as u64),
        ("Complete", people.complete as u64),
        ("Complete, but failed attention checks", people.attention_failed as u64),
        ("Started, still here", people.live as u64),
        (&lease, people.quiet as u64),
        ("Withdrawn, answers kept", people.withdrawn as u64),
        ("Screened out: did not understand the task in two tries", people.screened_out as u64),
        ("Forgotten: answers deleted, in no other number", people.forgotten),
        ("Understood the task at the second try only", people.misunderstood[1] as u64),
    ];
    let mut table = ResultTable::new("Submissions", &["Status", "Participants"], 1);
    for (status, count) in rows {
        table.add_row(false, [status.to_owned(), count.to_string()]);
    }
    let took = people.median_minutes.map_or_else(
        || "Nobody has finished yet".to_owned(),
        |minutes| format!("Those who finished took {} minutes (median)", format_number(minutes, 1)),
    );
    table.notes.push(format!("{took}; they were told {}.", people.announced_minutes));
    table
}

/// The attention checks of each participant who failed any.
pub(super) fn attention_table(results: &StudyReport) -> ResultTable {
    let attention = &results.people.attention;
    let mut table = ResultTable::new(
        "Attention checks that were failed",
        &["Participant", "Checks answered", "Failed", "Submission"],
        1,
    );
    for failed in &attention.by_participant {
        let checks: Vec<String> = failed.checks.iter().map(|number| format!("number {number}")).collect();
        let verdict = if failed.is_over { "may be rejected" } else { "passes" };
        table.add_row(
            false,
            [failed.participant.clone(), failed.answered.to_string(), checks.join(", "), verdict.to_owned()],
        );
    }
    let rule = if attention.most_failed == 0 {
        "A study of less than 5 minutes: one failed check is enough to reject a submission (Prolific's rule)."
    } else {
        "A study of 5 minutes or more: two failed checks are needed to reject a submission (Prolific's rule)."
    };
    let answered = count_with_noun(attention.answered, "check was answered", "checks were answered");
    table.notes.push(format!("{rule} {answered}, {} failed.", attention.failed));
    table
}

/// What the exclusion rules leave out; `None` where there are no rules.
pub(super) fn exclusion_table(results: &StudyReport) -> Option<ResultTable> {
    let heads = ["Rule", "Left out if", "Answers", "Persons", "Not known"];
    let mut table = ResultTable::new("Answers that an exclusion rule leaves out", &heads, 2);
    for one in &results.exclusions {
        let counts = [one.answers, one.persons, one.unknown].map(|count| count.to_string());
        table.add_row(false, [one.rule.to_owned(), one.words.clone()].into_iter().chain(counts));
    }
    let everybody = results.everybody().answers;
    table.notes.push(format!(
        "Of {}. An answer can break several rules. \"Not known\": the participant was away in between, or the page could not count pictures.",
        count_with_noun(everybody, "answer", "answers")
    ));
    (!table.rows.is_empty()).then_some(table)
}

/// The answers to each question at the end.
pub(super) fn end_tables(results: &StudyReport) -> Vec<ResultTable> {
    let table = |question: &EndQuestionCounts| {
        let title = format!("{}: {}", question.name, escape::to_single_line(&question.text));
        let mut table = ResultTable::new(title, &["Answer", "Participants"], 1);
        for (number, chosen) in (1..).zip(&question.chosen) {
            let words = escape::to_single_line(&chosen.answer);
            let answer = if question.kind == EndQuestionKind::Scale { format!("{number} {words}") } else { words };
            table.add_row(false, [answer, chosen.count.to_string()]);
        }
        let answered = count_with_noun(question.answered, "participant", "participants");
        let texts = if question.kind == EndQuestionKind::Text { " The texts are in end.csv." } else { "" };
        table.notes.push(format!("Answered by {answered}, left out by {}.{texts}", question.left_out));
        table
    };
    results.end.iter().map(table).collect()
}

/// The wording in the language of the pages; `None` where it is the English one.
pub(super) fn shown_wording_table(results: &StudyReport) -> Option<ResultTable> {
    let title = format!("As participants read them (language {})", to_table_name(&results.language));
    let mut table = ResultTable::new(title, &["Name", "Question", "1", "2", "3", "4", "5"], 7);
    for shown in &results.shown_wording {
        let cells = [shown.name, shown.text.as_str()].into_iter().chain(shown.levels.iter().map(String::as_str));
        table.add_row(false, cells.map(escape::to_single_line));
    }
    (!table.rows.is_empty()).then_some(table)
}

/// What became of the items that were handed out.
pub(super) fn handout_table(title: &str, label: &str, rows: &[HandoutCounts]) -> ResultTable {
    let mut table =
        ResultTable::new(title, &[label, "Given", "Answered", "Went back", "Still out", "Seconds (median)"], 1);
    for row in rows {
        let seconds = row.median_seconds.map_or_else(|| NO_FIGURE.to_owned(), |seconds| format_number(seconds, 1));
        let counts = [row.given, row.answered, row.returned, row.live].map(|count| count.to_string());
        table.add_row(false, std::iter::once(to_table_name(&row.of)).chain(counts).chain([seconds]));
    }
    table
}

/// The questions with the words of their levels.
pub(super) fn wording_table(results: &StudyReport) -> Option<ResultTable> {
    let mut table = ResultTable::new("Questions and scales", &["Name", "Question", "1", "2", "3", "4", "5"], 7);
    for scale in results.scales {
        let cells = [scale.name, scale.text].into_iter().chain(scale.levels);
        table.add_row(false, cells.map(str::to_owned));
    }
    (!table.rows.is_empty()).then_some(table)
}

/// The meaning of each figure.
pub(super) fn meaning_table(results: &StudyReport) -> ResultTable {
    let mut table = ResultTable::new("What is measured", &["Figure", "Name in files", "Meaning"], 3);
    for measure in results.measures {
        table.add_row(false, [measure.heading_with_unit(), measure.name.to_owned(), measure.meaning.to_owned()]);
    }
    table
}

/// The conditions: their kinds, and the sources of their texts.
pub(super) fn condition_table(results: &StudyReport) -> ResultTable {
    let mut table = ResultTable::new("Conditions", &["Condition", "Texts", "Answers", "Persons", "Routes"], 2);
    let everybody = results.everybody();
    for (condition, row) in results.conditions.iter().zip(&everybody.rows) {
        table.add_row(
            false,
            [
                condition_title(&condition.name, condition.kind),
                format!(
                    "{}{}",
                    to_table_name(&condition.source),
                    if condition.shows_doubts { " (doubts marked)" } else { "" }
                ),
                row.answers.to_string(),
                row.persons.to_string(),
                row.items.to_string(),
            ],
        );
    }
    table
}
