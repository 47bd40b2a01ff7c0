//! Reads the texts of a study with people and their outcomes from the files that `wayword study results` wrote.

use super::{Material, Outcomes, Told};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_run::error::Error;

/// The file with the format, the mode and the questions of the study.
pub(super) const RESULTS: &str = "results.json";
const ITEMS: &str = "items.csv";
const ANSWERS: &str = "answers.csv";
/// The format of `results.json` that is read.
const FORMAT: &str = "wayword-study-results/1";
/// The figures of walks that are correlated. The ratings are correlated too; `results.json` names their questions and statements.
const OF_WALKS: [&str; 3] = ["success", "spl", "ndtw"];
/// The kind of items with a text that was written for another path.
const OTHER_PATH: &str = "other-path";

/// The fields of `results.json` that are read.
#[derive(Debug, Deserialize)]
struct About {
    format: String,
    mode: String,
    scales: Vec<Scale>,
}

/// A question, or a statement.
#[derive(Debug, Deserialize)]
struct Scale {
    name: String,
}

/// The texts of a study in mode follow or rate, and the outcomes of their walks and ratings.
///
/// `finished` takes only the answers of people who finished and passed the attention checks.
pub(super) fn read(folder: &Path, finished: bool) -> Result<Material, Error> {
    let about = about(folder)?;
    let (texts, numbers, elsewhere) = texts(folder)?;
    let walks: &[&str] = if about.mode == "follow" { &OF_WALKS } else { &[] };
    let measures: Vec<&str> = walks.iter().copied().chain(about.scales.iter().map(|scale| &*scale.name)).collect();
    let answers = Table::read(folder.join(ANSWERS))?;
    let taken = if finished { "in_finished" } else { "in_everybody" };
    let mut outcomes = Vec::new();
    for measure in measures {
        let mut given: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for row in 0..answers.rows.len() {
            let Some(number) = numbers.get(answers.cell(row, "item")?) else { continue };
            // A walk without figures has an empty cell.
            if answers.cell(row, taken)? == "1" && !answers.cell(row, measure)?.is_empty() {
                given.entry(*number).or_default().push(answers.number(row, measure)?);
            }
        }
        let of = |who: &str, takes: &dyn Fn(usize) -> bool| {
            let given = given.iter().filter(|(number, _)| takes(**number));
            let mean = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
            Outcomes {
                who: who.to_owned(),
                outcome: measure.to_owned(),
                answers: given.clone().map(|(_, values)| values.len()).sum(),
                of_texts: given.map(|(number, values)| (*number, mean(values))).collect(),
            }
        };
        outcomes.push(of("people", &|_| true));
        // Texts of another path are wrong on purpose. A critic that detects them agrees with people more than it does on real texts.
        if !elsewhere.is_empty() {
            outcomes.push(of("people, own path", &|number| !elsewhere.contains(&number)));
        }
    }
    if outcomes.iter().all(|one| one.answers == 0) {
        let problem = format!("{}: it has no answer that counts", folder.join(ANSWERS).display());
        return Err(Error::usage(problem, "wait until people have answered, and write the results again"));
    }
    Ok(Material { texts, outcomes })
}

fn about(folder: &Path) -> Result<About, Error> {
    let file = folder.join(RESULTS);
    let bytes = fs::read(&file).map_err(Error::io(&file, "read"))?;
    let wrong = |problem: String| {
        Error::usage(
            format!("{}: {problem}", file.display()),
            "give a folder that this version's `wayword study results` wrote",
        )
    };
    let about: About = serde_json::from_slice(&bytes).map_err(|error| wrong(error.to_string()))?;
    if about.format != FORMAT {
        return Err(wrong(format!("its format is {:?}, and not {FORMAT:?}", about.format)));
    }
    if about.mode == "pair" {
        return Err(Error::usage(
            format!("{}: people chose between two texts here, so no text has a figure of its own", folder.display()),
            "give the results of a study with --mode follow or --mode rate",
        ));
    }
    Ok(about)
}

/// The texts, their numbers by item, and the numbers of those that were written for another path.
type Texts = (Vec<Told>, BTreeMap<String, usize>, BTreeSet<usize>);

fn texts(folder: &Path) -> Result<Texts, Error> {
    let items = Table::read(folder.join(ITEMS))?;
    let (mut texts, mut numbers, mut elsewhere) = (Vec::new(), BTreeMap::new(), BTreeSet::new());
    for row in 0..items.rows.len() {
        if items.cell(row, "kind")? == OTHER_PATH {
            elsewhere.insert(texts.len());
        }
        numbers.insert(items.cell(row, "item")?.to_owned(), texts.len());
        texts.push(Told {
            item: None,
            path: items.text(row, "route")?,
            scene: items.text(row, "scene")?,
            text: items.text(row, "text")?,
        });
    }
    Ok((texts, numbers, elsewhere))
}

/// A CSV file of results.
struct Table {
    file: PathBuf,
    columns: BTreeMap<String, usize>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    fn read(file: PathBuf) -> Result<Self, Error> {
        let wrong = |error: csv::Error| broken(&file, &error.to_string());
        let mut reader = csv::Reader::from_path(&file).map_err(wrong)?;
        let columns = reader.headers().map_err(wrong)?.iter().enumerate();
        let columns = columns.map(|(at, name)| (name.to_owned(), at)).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(wrong)?;
        Ok(Self { file, columns, rows })
    }

    fn cell(&self, row: usize, column: &str) -> Result<&str, Error> {
        let at = self.columns.get(column).ok_or_else(|| broken(&self.file, &format!("it has no column {column}")))?;
        Ok(self.rows.get(row).and_then(|row| row.get(*at)).unwrap_or_default())
    }

    /// A cell without the apostrophe that keeps spreadsheets from reading a text as a formula.
    fn text(&self, row: usize, column: &str) -> Result<String, Error> {
        let cell = self.cell(row, column)?;
        Ok(cell.strip_prefix('\'').unwrap_or(cell).to_owned())
    }

    fn number(&self, row: usize, column: &str) -> Result<f64, Error> {
        let cell = self.cell(row, column)?;
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        // The first line has the names of the columns.
        number.ok_or_else(|| broken(&self.file, &format!("row {}: {column}: {cell:?} is no number", row + 2)))
    }
}

fn broken(file: &Path, problem: &str) -> Error {
    Error::usage(format!("{}: {problem}", file.display()), "write the results again: wayword study results STUDY")
}
