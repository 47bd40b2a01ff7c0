//! Computes the results of a study: figures with intervals, agreement between participants, participation, and the files that report
//! them.
//!
//! Everything is computed from [`StudyData`] alone, so the same answers give the same files. Texts that participants wrote appear only in
//! `answers.csv`, and never in a table or on a page.

mod analysis_script;
mod end_questions;
mod escape;
mod exclusions;
mod judgements;
mod latex;
mod markdown;
mod measure;
mod names;
mod notes;
mod number_format;
mod outlook;
mod outlook_text;
mod page;
mod pairs;
mod people;
mod planned_answers;
mod plot;
mod preregistration;
mod sheet;
mod sheets;
mod tables;
mod version;
mod walks;
mod write;

pub use end_questions::{EndAnswerCount, EndQuestionCounts};
pub use exclusions::ExclusionCount;
pub use measure::{MeasureKind, MeasureUnit, StudyMeasure};
pub use outlook::{PlanQuestion, PlannedCondition, PlannedPower, StudyOutlook};
pub use pairs::{ConditionStrengths, PairResults, PairRow};
pub use people::{AttentionSummary, FailedChecks, HandoutCounts, ParticipantSummary};
pub use version::{ConditionDifference, ConditionRow, QuestionAgreement, ResultVersion};

use crate::{StudyData, StudyError, StudyTask, wording};
use judgements::ParticipantFilter;
use names::ParticipantNames;
use serde::Serialize;
use sheet::DataSheet;
use sheets::SheetSources;

/// Confidence level of all intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// All results of a study, as `results.json` contains them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudyReport {
    /// Name and version of the file format.
    pub format: &'static str,
    /// The version of Wayword that made it.
    pub wayword: &'static str,
    /// The title of the study.
    pub title: String,
    /// The task of the participants.
    pub mode: StudyTask,
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
    pub conditions: Vec<crate::StudyCondition>,
    /// The questions or statements, with the words of their levels.
    pub scales: &'static [wording::RatingScale],
    /// The figures of this mode, with their meanings.
    pub measures: &'static [StudyMeasure],
    /// The language of the pages.
    pub language: String,
    /// The questions or statements as participants read them, if the pages were translated.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shown_wording: Vec<ShownWording>,
    /// The values of the figures: of all answers; of those of participants who finished and passed the attention checks; and, if study.toml
    /// has exclusion rules, of those among these that no rule leaves out.
    pub versions: Vec<ResultVersion>,
    /// What the exclusion rules leave out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub exclusions: Vec<ExclusionCount>,
    /// The answers to the questions at the end.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub end: Vec<EndQuestionCounts>,
    /// Who took part, and where people stopped.
    pub people: ParticipantSummary,
    /// Problems of the data, in words.
    pub problems: Vec<String>,
    /// The CSV files.
    #[serde(skip)]
    sheets: Vec<DataSheet>,
}

/// A question or statement in the language of the pages.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ShownWording {
    /// Its short name in tables and files.
    pub name: &'static str,
    /// The question or statement.
    pub text: String,
    /// The words of the five levels.
    pub levels: [String; 5],
}

impl StudyReport {
    /// The version of all answers.
    fn everybody(&self) -> &ResultVersion {
        &self.versions[0]
    }
}

/// The wording that participants read, if it is not the English one.
fn shown_wording(data: &StudyData) -> Vec<ShownWording> {
    if data.texts.is_english() {
        return Vec::new();
    }
    let shown = |scale: &wording::RatingScale| {
        let (text, levels) = data.texts.scale_words(scale);
        ShownWording { name: scale.name, text, levels }
    };
    scales_for_mode(data.plan.mode).iter().map(shown).collect()
}

/// The questions or statements of a mode.
fn scales_for_mode(mode: StudyTask) -> &'static [wording::RatingScale] {
    match mode {
        StudyTask::Follow => &wording::FOLLOW_STATEMENTS,
        StudyTask::Rate => &wording::RATE_QUESTIONS,
        StudyTask::Pair => &[],
    }
}

/// Computes the results. `now_ms` is the Unix time in milliseconds; participants whom the site has not seen for longer than the lease
/// then count as gone quiet.
///
/// # Errors
/// When the study has no conditions.
pub fn compute_results(data: &StudyData, now_ms: i64) -> Result<StudyReport, StudyError> {
    if data.plan.conditions.is_empty() {
        return Err(StudyError::refused_request(
            "the study has no conditions",
            "put back plan.json as `study new` wrote it",
        ));
    }
    let names = ParticipantNames::new(data);
    let (answered, problems) = judgements::collect_answers(data, &names);
    let most_failed = data.settings.tolerated_failed_checks();
    let version = |filter: &ParticipantFilter| ResultVersion::new(data, &answered, *filter, most_failed);
    let filters = ParticipantFilter::for_rules(&data.settings.exclusions);
    let people = ParticipantSummary::new(data, &names, &answered, now_ms);
    let sources = SheetSources { data, names: &names, answered: &answered, most_failed };
    let sheets = sources.all_sheets(&people);
    Ok(StudyReport {
        format: "wayword-study-results/1",
        wayword: env!("CARGO_PKG_VERSION"),
        title: data.settings.title.clone(),
        mode: data.plan.mode,
        style: data.plan.style.clone(),
        seed: data.plan.seed,
        is_closed: data.is_closed,
        write_first: data.settings.write_first,
        level: CONFIDENCE_LEVEL,
        conditions: data.plan.conditions.clone(),
        scales: scales_for_mode(data.plan.mode),
        measures: StudyMeasure::for_mode(data.plan.mode),
        language: data.texts.language.clone(),
        shown_wording: shown_wording(data),
        versions: filters.iter().map(version).collect(),
        exclusions: exclusions::count_exclusions(data, &answered),
        end: end_questions::count_end_answers(data),
        people,
        problems,
        sheets,
    })
}

#[cfg(test)]
mod tests;
