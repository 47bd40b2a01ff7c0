//! Makes the tables of the report as text, independent of the output format; Markdown, LaTeX and the page all print these.

use super::{
    Agreed, Handed, Less, Measure, Results, Version,
    inert::name,
    measure::OF_THE_PAPER,
    pairs::{PairRow, Strengths},
    version::CHOICE,
    words::{self, NOTHING, count, number},
};
use crate::Kind;
use serde::Serialize;
use wayword_metrics::wilson;

/// A table of text.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Table {
    pub(super) title: String,
    pub(super) notes: Vec<String>,
    pub(super) heads: Vec<Head>,
    pub(super) rows: Vec<Cells>,
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Head {
    pub(super) text: String,
    pub(super) is_number: bool,
}

/// A row. `opens` marks the first row of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Cells {
    pub(super) cells: Vec<String>,
    pub(super) opens: bool,
}

impl Table {
    /// A table without rows. Its first `texts` columns contain text, the others numbers.
    fn new(title: impl Into<String>, heads: &[&str], texts: usize) -> Self {
        let head = |(at, text): (usize, &&str)| Head { text: (*text).to_owned(), is_number: at >= texts };
        Self {
            title: title.into(),
            notes: Vec::new(),
            heads: heads.iter().enumerate().map(head).collect(),
            rows: Vec::new(),
        }
    }

    fn add(&mut self, opens: bool, cells: impl IntoIterator<Item = String>) {
        self.rows.push(Cells { cells: cells.into_iter().collect(), opens });
    }
}

/// A condition's name, with a note if it is a control.
pub(super) fn title(condition: &str, kind: Kind) -> String {
    let note = match kind {
        Kind::Run => "",
        Kind::People => " (control: people)",
        Kind::OtherPath => " (control: other path)",
    };
    format!("{}{note}", name(condition))
}

/// All figures of a version.
pub(super) fn figures(results: &Results, version: &Version) -> Table {
    let heads = ["Figure", "Condition", "Value", "95 % interval", "Answers", "Persons", "Routes", "Interval by"];
    let mut table = Table::new("All figures", &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for measure in results.measures {
        for (at, row) in version.rows.iter().enumerate() {
            let figure = row.figures.get(measure.name);
            let cell = |of: &dyn Fn(&wayword_metrics::Figure) -> String| figure.map_or_else(|| NOTHING.to_owned(), of);
            let cells = [
                if at == 0 { measure.heading() } else { String::new() },
                title(&row.condition, row.kind),
                cell(&|figure| words::value(measure, figure.value)),
                cell(&|figure| words::interval(measure, figure.interval.as_ref())),
                figure.map_or(0, |figure| figure.answers).to_string(),
                figure.map_or(0, |figure| figure.persons).to_string(),
                figure.map_or(0, |figure| figure.items).to_string(),
                cell(&|figure| words::method(figure.method).to_owned()),
            ];
            table.add(at == 0, cells);
        }
    }
    table
}

/// Each condition minus the first one; `None` where there are no differences.
pub(super) fn differences(results: &Results, version: &Version) -> Option<Table> {
    let first = version.differences.first()?;
    let heads = ["Figure", "Condition", "Difference", "95 % interval", "Interval by"];
    let mut table = Table::new(format!("Minus {}", name(&first.minus)), &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for measure in results.measures {
        for (at, less) in version.differences.iter().enumerate() {
            let heading = if at == 0 { measure.heading() } else { String::new() };
            table.add(at == 0, difference(measure, less, heading, kind_of(version, &less.condition)));
        }
    }
    Some(table)
}

fn kind_of(version: &Version, condition: &str) -> Kind {
    version.rows.iter().find(|row| row.condition == condition).map_or(Kind::Run, |row| row.kind)
}

fn difference(measure: &Measure, less: &Less, heading: String, kind: Kind) -> [String; 5] {
    let figure = less.figures.get(measure.name);
    let nothing = || NOTHING.to_owned();
    [
        heading,
        title(&less.condition, kind),
        figure.map_or_else(nothing, |figure| words::value(measure, figure.value)),
        figure.map_or_else(nothing, |figure| words::interval(measure, figure.interval.as_ref())),
        figure.map_or_else(nothing, |figure| words::method(figure.method).to_owned()),
    ]
}

/// The shares that arXiv 2403.11487 reports for its 30 people, as counts. Its 16.5 % is not a share of 30; the nearest is 5 of 30.
const THE_PAPER: [f64; 4] = [13.0, 25.0, 5.0, 22.0];
const OF_PEOPLE: f64 = 30.0;

/// The four questions evaluated as the paper does it, with the paper's own figures in the last row. `None` unless the mode is rating.
pub(super) fn of_the_paper(results: &Results, version: &Version) -> Option<Table> {
    let find = |name: &&str| results.measures.iter().find(|measure| measure.name == *name);
    let measures: Vec<&Measure> = OF_THE_PAPER.iter().filter_map(find).collect();
    if measures.len() < OF_THE_PAPER.len() {
        return None;
    }
    let headings: Vec<String> = measures.iter().map(|measure| measure.heading()).collect();
    let heads: Vec<&str> = std::iter::once("Condition").chain(headings.iter().map(String::as_str)).collect();
    let mut table = Table::new("As the paper reads the questions", &heads, 1);
    for row in &version.rows {
        let figures = measures.iter().map(|measure| {
            row.figures.get(measure.name).map_or_else(
                || NOTHING.to_owned(),
                |figure| {
                    let value = words::value(measure, figure.value);
                    format!("{value} {}", words::interval(measure, figure.interval.as_ref()))
                },
            )
        });
        table.add(false, std::iter::once(title(&row.condition, row.kind)).chain(figures));
    }
    let told = measures.iter().zip(THE_PAPER).map(|(measure, count)| {
        let interval = wilson(count, OF_PEOPLE, results.level);
        format!("{} {}", words::value(measure, count / OF_PEOPLE), words::interval(measure, interval.as_ref()))
    });
    table.add(true, std::iter::once("arXiv 2403.11487: 30 people, one item each".to_owned()).chain(told));
    table.notes.push(
        "The wording and the scale of the paper's questions are lost, and it showed no text of people or of another path beside. So \
         the last row tells how far its own figures reach (Wilson's interval of 30 answers), not what to expect here."
            .to_owned(),
    );
    Some(table)
}

/// How often each level was chosen. With `in_words` the column headings have the words of the levels, else only their numbers.
pub(super) fn levels(results: &Results, version: &Version, in_words: bool) -> Vec<Table> {
    let head = |level: u8, word: &str| if in_words { format!("{level} {word}") } else { level.to_string() };
    let table = |scale: &crate::wording::Scale| {
        let heads: Vec<String> = (1..).zip(scale.levels).map(|(level, word): (u8, &str)| head(level, word)).collect();
        let heads: Vec<&str> =
            ["Condition"].into_iter().chain(heads.iter().map(String::as_str)).chain(["Answers"]).collect();
        let mut table = Table::new(format!("{}: {}", scale.name, scale.text), &heads, 1);
        for row in &version.rows {
            let counts = row.levels.get(scale.name).copied().unwrap_or_default();
            let all: usize = counts.iter().sum();
            let cells = counts.iter().map(ToString::to_string).chain([all.to_string()]);
            table.add(false, std::iter::once(title(&row.condition, row.kind)).chain(cells));
        }
        table
    };
    results.scales.iter().map(table).collect()
}

/// The tables of comparisons: one row for each pair of conditions, and the strengths of the conditions.
pub(super) fn pairs(version: &Version) -> Vec<Table> {
    let Some(pairs) = &version.pairs else { return Vec::new() };
    let heads = ["First", "Second", "Wins", "Losses", "Ties", "Both bad", "Share, %", "95 % interval", "Interval by"];
    let mut table = Table::new("Comparisons", &heads, 2);
    if let Some(last) = table.heads.last_mut() {
        last.is_number = false;
    }
    for row in &pairs.rows {
        table.add(false, pair(row));
    }
    if let Some(side) = &pairs.side {
        table.notes.push(
            "Wins, losses and the share are of the first one; the share counts half of what has no winner.".to_owned(),
        );
        table.notes.push(format!(
            "Of the comparisons with a preference, {} % preferred the text shown as A, {} ({}).",
            number(100.0 * side.value, 1),
            per_cent(side.interval.as_ref()),
            words::method(side.method)
        ));
    }
    vec![table, strengths(&pairs.strengths)]
}

fn pair(row: &PairRow) -> [String; 9] {
    let nothing = || NOTHING.to_owned();
    [
        name(&row.first),
        name(&row.second),
        row.first_wins.to_string(),
        row.second_wins.to_string(),
        row.ties.to_string(),
        row.both_bad.to_string(),
        row.share.as_ref().map_or_else(nothing, |share| number(100.0 * share.value, 1)),
        row.share.as_ref().map_or_else(nothing, |share| per_cent(share.interval.as_ref())),
        row.share.as_ref().map_or_else(nothing, |share| words::method(share.method).to_owned()),
    ]
}

/// An interval of a share, in per cent.
pub(super) fn per_cent(interval: Option<&wayword_metrics::Interval>) -> String {
    let ends = |interval: &wayword_metrics::Interval| {
        format!("[{}, {}]", number(100.0 * interval.low, 1), number(100.0 * interval.high, 1))
    };
    interval.map_or_else(|| NOTHING.to_owned(), ends)
}

fn strengths(strengths: &Strengths) -> Table {
    let heads = ["Condition", "Wins", "Losses", "Ties", "Both bad", "Strength", "95 % interval"];
    let mut table = Table::new("Strengths (Bradley-Terry, ties after Davidson)", &heads, 1);
    match strengths {
        Strengths::Unknown { why, .. } => {
            table.notes.push(format!("There are no strengths: {}.", name(why)));
        }
        Strengths::Known(known) => {
            for one in &known.strengths {
                let counts = [one.wins, one.losses, one.ties, one.both_bad].map(|count| count.to_string());
                let term = [number(one.term.value, 3), words::ends(Some(&one.term.interval), 3)];
                table.add(false, std::iter::once(name(&one.system)).chain(counts).chain(term));
            }
            table.notes.push(format!(
                "Strengths are logarithms that sum to 0: the difference of two is the log of the odds of the one over the other where \
                 neither ties. The text shown as A gains {} {} on the same scale. {}, {}, {}; the variance is clustered by persons and by \
                 routes.",
                number(known.side.value, 3),
                words::ends(Some(&known.side.interval), 3),
                count(known.comparisons, "comparison", "comparisons"),
                count(known.persons, "person", "persons"),
                count(known.items, "route", "routes"),
            ));
            if let Some(tie) = &known.tie {
                table.notes.push(format!(
                    "The log of Davidson's parameter of ties is {} {}; both bad counts as a tie.",
                    number(tie.value, 3),
                    words::ends(Some(&tie.interval), 3)
                ));
            }
        }
    }
    table
}

/// Krippendorff's alpha of each question.
pub(super) fn agreement(version: &Version) -> Table {
    let heads = ["Question", "Alpha", "95 % interval", "Answers", "Persons", "Items"];
    let mut table = Table::new("Agreement (Krippendorff's alpha)", &heads, 1);
    for Agreed { name, alpha } in &version.agreement {
        let label = if *name == CHOICE { "choice between the texts (nominal)" } else { name };
        let cells = match alpha {
            Some(alpha) => [
                number(alpha.alpha, 3),
                words::ends(alpha.interval.as_ref(), 3),
                alpha.answers.to_string(),
                alpha.persons.to_string(),
                alpha.items.to_string(),
            ],
            None => [NOTHING, NOTHING, "0", "0", "0"].map(str::to_owned),
        };
        table.add(false, std::iter::once(label.to_owned()).chain(cells));
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
pub(super) fn submissions(results: &Results) -> Table {
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
    let mut table = Table::new("Submissions", &["Status", "Participants"], 1);
    for (status, count) in rows {
        table.add(false, [status.to_owned(), count.to_string()]);
    }
    let took = people.median_minutes.map_or_else(
        || "Nobody has finished yet".to_owned(),
        |minutes| format!("Those who finished took {} minutes (median)", number(minutes, 1)),
    );
    table.notes.push(format!("{took}; they were told {}.", people.announced_minutes));
    table
}

/// The attention checks of each participant who failed any.
pub(super) fn attention(results: &Results) -> Table {
    let attention = &results.people.attention;
    let mut table =
        Table::new("Attention checks that were failed", &["Participant", "Checks answered", "Failed", "Submission"], 1);
    for failed in &attention.by_participant {
        let checks: Vec<String> = failed.checks.iter().map(|number| format!("number {number}")).collect();
        let verdict = if failed.is_over { "may be rejected" } else { "passes" };
        table.add(
            false,
            [failed.participant.clone(), failed.answered.to_string(), checks.join(", "), verdict.to_owned()],
        );
    }
    let rule = if attention.most_failed == 0 {
        "A study of less than 5 minutes: one failed check is enough to reject a submission (Prolific's rule)."
    } else {
        "A study of 5 minutes or more: two failed checks are needed to reject a submission (Prolific's rule)."
    };
    let answered = count(attention.answered, "check was answered", "checks were answered");
    table.notes.push(format!("{rule} {answered}, {} failed.", attention.failed));
    table
}

/// What became of the items that were handed out.
pub(super) fn handed(title: &str, label: &str, rows: &[Handed]) -> Table {
    let mut table = Table::new(title, &[label, "Given", "Answered", "Went back", "Still out", "Seconds (median)"], 1);
    for row in rows {
        let seconds = row.median_seconds.map_or_else(|| NOTHING.to_owned(), |seconds| number(seconds, 1));
        let counts = [row.given, row.answered, row.returned, row.live].map(|count| count.to_string());
        table.add(false, std::iter::once(name(&row.of)).chain(counts).chain([seconds]));
    }
    table
}

/// The questions with the words of their levels.
pub(super) fn wording(results: &Results) -> Option<Table> {
    let mut table = Table::new("Questions and scales", &["Name", "Question", "1", "2", "3", "4", "5"], 7);
    for scale in results.scales {
        let cells = [scale.name, scale.text].into_iter().chain(scale.levels);
        table.add(false, cells.map(str::to_owned));
    }
    (!table.rows.is_empty()).then_some(table)
}

/// The meaning of each figure.
pub(super) fn meanings(results: &Results) -> Table {
    let mut table = Table::new("What is measured", &["Figure", "Name in files", "Meaning"], 3);
    for measure in results.measures {
        table.add(false, [measure.heading(), measure.name.to_owned(), measure.meaning.to_owned()]);
    }
    table
}

/// The conditions: their kinds, and the sources of their texts.
pub(super) fn conditions(results: &Results) -> Table {
    let mut table = Table::new("Conditions", &["Condition", "Texts", "Answers", "Persons", "Routes"], 2);
    let [everybody, _] = &results.versions;
    for (condition, row) in results.conditions.iter().zip(&everybody.rows) {
        table.add(
            false,
            [
                title(&condition.name, condition.kind),
                format!("{}{}", name(&condition.source), if condition.shows_doubts { " (doubts marked)" } else { "" }),
                row.answers.to_string(),
                row.persons.to_string(),
                row.items.to_string(),
            ],
        );
    }
    table
}
