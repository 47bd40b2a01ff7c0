//! Reads the texts of a study with people and their outcomes from the files that `wayword study results` wrote.

use super::{CriticMaterial, OutcomeText, TextOutcomes};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_run::error::CommandError;

/// The file with the format, the mode and the questions of the study.
pub(super) const RESULTS_FILE: &str = "results.json";
/// The file with the texts.
const ITEMS_FILE: &str = "items.csv";
/// The file with the answers of people.
const ANSWERS_FILE: &str = "answers.csv";
/// The format of `results.json` that is read.
const RESULTS_FORMAT: &str = "wayword-study-results/1";
/// The columns with figures of walks that are correlated. The ratings are correlated too; `results.json` names their
/// questions and statements.
const WALK_MEASURES: [&str; 3] = ["success", "spl", "ndtw"];
/// The kind, in column `kind`, of items with a text that was written for another path.
const OTHER_PATH: &str = "other-path";

/// The fields of `results.json` that are read.
#[derive(Debug, Deserialize)]
struct StudyResultsHead {
    format: String,
    mode: String,
    scales: Vec<ResultsScale>,
}

/// A question, or a statement.
#[derive(Debug, Deserialize)]
struct ResultsScale {
    name: String,
}

/// The texts of a study in mode follow or rate, and the outcomes of their walks and ratings.
///
/// `finished` takes only the answers of people who finished and passed the attention checks.
pub(super) fn read_results(folder: &Path, finished: bool) -> Result<CriticMaterial, CommandError> {
    let about = read_head(folder)?;
    let (texts, numbers, elsewhere) = read_texts(folder)?;
    let walks: &[&str] = if about.mode == "follow" { &WALK_MEASURES } else { &[] };
    let measures: Vec<&str> = walks.iter().copied().chain(about.scales.iter().map(|scale| &*scale.name)).collect();
    let answers = ResultsTable::read_csv(folder.join(ANSWERS_FILE))?;
    let taken = if finished { "in_finished" } else { "in_everybody" };
    let mut outcomes = Vec::new();
    for measure in measures {
        let mut given: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for row in 0..answers.rows.len() {
            let Some(number) = numbers.get(answers.cell(row, "item")?) else { continue };
            // A walk without figures has an empty cell.
            if answers.cell(row, taken)? == "1" && !answers.cell(row, measure)?.is_empty() {
                given.entry(*number).or_default().push(answers.number_cell(row, measure)?);
            }
        }
        let outcomes_for = |who: &str, takes: &dyn Fn(usize) -> bool| {
            let given = given.iter().filter(|(number, _)| takes(**number));
            let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
            TextOutcomes {
                who: who.to_owned(),
                outcome: measure.to_owned(),
                answers: given.clone().map(|(_, values)| values.len()).sum(),
                text_means: given.map(|(number, values)| (*number, mean(values))).collect(),
            }
        };
        outcomes.push(outcomes_for("people", &|_| true));
        // Texts of another path are wrong on purpose. A critic that detects them agrees with people more than it does on real texts.
        if !elsewhere.is_empty() {
            outcomes.push(outcomes_for("people, own path", &|number| !elsewhere.contains(&number)));
        }
    }
    if outcomes.iter().all(|outcome| outcome.answers == 0) {
        let problem = format!("{}: it has no answer that counts", folder.join(ANSWERS_FILE).display());
        return Err(CommandError::usage(problem, "wait until people have answered, and write the results again"));
    }
    Ok(CriticMaterial { texts, outcomes })
}

fn read_head(folder: &Path) -> Result<StudyResultsHead, CommandError> {
    let file = folder.join(RESULTS_FILE);
    let bytes = fs::read(&file).map_err(CommandError::io(&file, "read"))?;
    let wrong = |problem: String| {
        CommandError::usage(
            format!("{}: {problem}", file.display()),
            "give a folder that this version's `wayword study results` wrote",
        )
    };
    let about: StudyResultsHead = serde_json::from_slice(&bytes).map_err(|error| wrong(error.to_string()))?;
    if about.format != RESULTS_FORMAT {
        return Err(wrong(format!("its format is {:?}, and not {RESULTS_FORMAT:?}", about.format)));
    }
    if about.mode == "pair" {
        return Err(CommandError::usage(
            format!("{}: people chose between two texts here, so no text has a figure of its own", folder.display()),
            "give the results of a study with --mode follow or --mode rate",
        ));
    }
    Ok(about)
}

/// The texts, their numbers by item, and the numbers of those that were written for another path.
type ResultsTexts = (Vec<OutcomeText>, BTreeMap<String, usize>, BTreeSet<usize>);

fn read_texts(folder: &Path) -> Result<ResultsTexts, CommandError> {
    let items = ResultsTable::read_csv(folder.join(ITEMS_FILE))?;
    let (mut texts, mut numbers, mut elsewhere) = (Vec::new(), BTreeMap::new(), BTreeSet::new());
    for row in 0..items.rows.len() {
        if items.cell(row, "kind")? == OTHER_PATH {
            elsewhere.insert(texts.len());
        }
        numbers.insert(items.cell(row, "item")?.to_owned(), texts.len());
        texts.push(OutcomeText {
            item: None,
            path: items.text_cell(row, "route")?,
            scene: items.text_cell(row, "scene")?,
            text: items.text_cell(row, "text")?,
        });
    }
    Ok((texts, numbers, elsewhere))
}

/// A CSV file of results.
struct ResultsTable {
    file: PathBuf,
    /// The place of each column by its name.
    columns: BTreeMap<String, usize>,
    rows: Vec<csv::StringRecord>,
}

impl ResultsTable {
    fn read_csv(file: PathBuf) -> Result<Self, CommandError> {
        let wrong = |error: csv::Error| broken_file(&file, &error.to_string());
        let mut reader = csv::Reader::from_path(&file).map_err(wrong)?;
        let columns = reader.headers().map_err(wrong)?.iter().enumerate();
        let columns = columns.map(|(at, name)| (name.to_owned(), at)).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(wrong)?;
        Ok(Self { file, columns, rows })
    }

    fn cell(&self, row: usize, column: &str) -> Result<&str, CommandError> {
        let at =
            self.columns.get(column).ok_or_else(|| broken_file(&self.file, &format!("it has no column {column}")))?;
        Ok(self.rows.get(row).and_then(|row| row.get(*at)).unwrap_or_default())
    }

    /// A cell without the apostrophe that keeps spreadsheets from reading a text as a formula.
    fn text_cell(&self, row: usize, column: &str) -> Result<String, CommandError> {
        let cell = self.cell(row, column)?;
        Ok(cell.strip_prefix('\'').unwrap_or(cell).to_owned())
    }

    fn number_cell(&self, row: usize, column: &str) -> Result<f64, CommandError> {
        let cell = self.cell(row, column)?;
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        // The first line has the names of the columns.
        number.ok_or_else(|| broken_file(&self.file, &format!("row {}: {column}: {cell:?} is no number", row + 2)))
    }
}

fn broken_file(file: &Path, problem: &str) -> CommandError {
    CommandError::usage(
        format!("{}: {problem}", file.display()),
        "write the results again: wayword study results STUDY",
    )
}
