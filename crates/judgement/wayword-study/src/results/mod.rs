//! Computes the results of a study: figures with intervals, agreement between participants, participation, and the files that report
//! them.
//!
//! Everything is computed from [`Data`] alone, so the same answers give the same files. Texts that participants wrote appear only in
//! `answers.csv`, and never in a table or on a page.

mod given;
mod inert;
mod latex;
mod markdown;
mod measure;
mod names;
mod notes;
mod outlook;
mod page;
mod pairs;
mod people;
mod plot;
mod sheet;
mod sheets;
mod tables;
mod version;
mod walks;
mod words;
mod write;

pub use measure::{Measure, MeasureKind, Unit};
pub use outlook::{Found, Outlook, Planned};
pub use pairs::{PairRow, Pairs, Strengths};
pub use people::{Attention, Failed, Handed, People};
pub use version::{Agreed, Less, Row, Version};

use crate::{Data, Mode, StudyError, wording};
use given::Whose;
use names::Names;
use serde::Serialize;
use sheet::Sheet;
use sheets::Sources;

/// Confidence level of all intervals.
const LEVEL: f64 = 0.95;

/// All results of a study, as `results.json` contains them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Name and version of the file format.
    pub format: &'static str,
    /// The version of Wayword that made it.
    pub wayword: &'static str,
    /// What the study is called.
    pub title: String,
    /// What people did.
    pub mode: Mode,
    /// The style of the texts.
    pub style: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether the study is closed.
    pub is_closed: bool,
    /// Whether participants wrote a text of their own first.
    pub write_first: bool,
    /// Confidence level of the intervals.
    pub level: f64,
    /// The conditions of the plan.
    pub conditions: Vec<crate::Condition>,
    /// The questions or statements, with the words of their levels.
    pub scales: &'static [wording::Scale],
    /// The figures of this mode, with their meanings.
    pub measures: &'static [Measure],
    /// The values of the figures: for all participants, and for those who finished and passed the attention checks.
    pub versions: [Version; 2],
    /// Who took part, and where people stopped.
    pub people: People,
    /// Problems of the data, in words.
    pub problems: Vec<String>,
    /// The CSV files.
    #[serde(skip)]
    sheets: Vec<Sheet>,
}

/// The questions or statements of a mode.
fn scales(mode: Mode) -> &'static [wording::Scale] {
    match mode {
        Mode::Follow => &wording::STATEMENTS,
        Mode::Rate => &wording::QUESTIONS,
        Mode::Pair => &[],
    }
}

/// Computes the results. `now_ms` is the Unix time in milliseconds; participants whom the site has not seen for longer than the lease
/// then count as gone quiet.
///
/// # Errors
/// When the study has no conditions.
pub fn results(data: &Data, now_ms: i64) -> Result<Results, StudyError> {
    if data.plan.conditions.is_empty() {
        return Err(StudyError::refused("the study has no conditions", "put back plan.json as `study new` wrote it"));
    }
    let names = Names::new(data);
    let (answered, problems) = given::answered(data, &names);
    let most_failed = data.settings.most_failed();
    let version = |whose| Version::new(data, &answered, whose, most_failed);
    let people = People::new(data, &names, &answered, now_ms);
    let sources = Sources { data, names: &names, answered: &answered, most_failed };
    let sheets = sources.sheets(&people);
    Ok(Results {
        format: "wayword-study-results/1",
        wayword: env!("CARGO_PKG_VERSION"),
        title: data.settings.title.clone(),
        mode: data.plan.mode,
        style: data.plan.style.clone(),
        seed: data.plan.seed,
        is_closed: data.is_closed,
        write_first: data.settings.write_first,
        level: LEVEL,
        conditions: data.plan.conditions.clone(),
        scales: scales(data.plan.mode),
        measures: Measure::of_mode(data.plan.mode),
        versions: [version(Whose::Everybody), version(Whose::Finished)],
        people,
        problems,
        sheets,
    })
}

#[cfg(test)]
mod tests;
