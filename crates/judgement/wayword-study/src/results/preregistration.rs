//! Writes a sheet for preregistration (Markdown), filled in from the plan, `study.toml` and the outlook. What only the researchers know has a
//! gap to fill in.

use super::{
    PlannedPower, StudyMeasure, StudyOutlook,
    escape::escape_markdown as escaped,
    number_format::{format_number, format_percent},
    scales_for_mode,
    sheets::kind_name,
};
use crate::{ConditionKind, EndQuestionKind, Study, StudyError, StudyTask};
use std::{fmt::Write, path::Path};

impl Study {
    /// Writes a sheet for preregistration into a new file.
    ///
    /// # Errors
    /// When the file exists, or cannot be written.
    pub fn write_preregistration(&self, outlook: &StudyOutlook, file: &Path) -> Result<(), StudyError> {
        Self::write_new_file(file, &preregistration_sheet(self, outlook))
    }
}

/// The sheet. Lines with `TODO` are for the researchers.
fn preregistration_sheet(study: &Study, outlook: &StudyOutlook) -> String {
    let mut sheet = format!(
        "# Preregistration: {}\n\nWritten by Wayword {} before the first participant. Fill in each TODO, and read the rest: it is what the program will do.\n",
        escaped(&study.settings.title),
        env!("CARGO_PKG_VERSION")
    );
    let sections = [
        ("Hypotheses", hypotheses(study, outlook)),
        ("Conditions", conditions(study)),
        ("Procedure", procedure(study, outlook)),
        ("Measures", measures(study)),
        ("Exclusions", exclusions(study)),
        ("Sample size", sample_size(study, outlook)),
        ("Analysis", analysis(study)),
    ];
    for (title, section) in sections {
        // Writing to a text cannot fail.
        let _ = write!(sheet, "\n## {title}\n\n{section}");
    }
    sheet
}

/// The figure that decides, in a study of this task.
fn main_measure(mode: StudyTask) -> &'static str {
    match mode {
        StudyTask::Follow => "success",
        StudyTask::Rate => "accurate_high",
        StudyTask::Pair => "gain",
    }
}

fn hypotheses(study: &Study, outlook: &StudyOutlook) -> String {
    let main = main_measure(study.plan.mode);
    let names: Vec<String> = study.plan.conditions.iter().map(|condition| escaped(&condition.name)).collect();
    let Some((first, others)) = names.split_first() else { return "- TODO\n".to_owned() };
    let mut text = String::new();
    for other in others {
        text.push_str(&format!(
            "- TODO: `{main}` of {other} is higher than, lower than, or equal to that of {first}.\n"
        ));
    }
    if others.is_empty() {
        text.push_str(&format!("- TODO: `{main}` of {first} is above ...\n"));
    }
    text.push_str(&format!(
        "- Smallest difference of interest: {} points. TODO: why.\n",
        format_percent(outlook.effect)
    ));
    text
}

fn conditions(study: &Study) -> String {
    let mut text = "| Condition | Kind | Texts |\n| --- | --- | --- |\n".to_owned();
    for condition in &study.plan.conditions {
        let kind = if condition.kind == ConditionKind::Run { "set of texts" } else { kind_name(condition.kind) };
        let marks = if condition.shows_doubts { " (doubts marked)" } else { "" };
        text.push_str(&format!(
            "| {} | {kind}{} | {}{marks} |\n",
            escaped(&condition.name),
            if condition.kind == ConditionKind::Run { "" } else { " (control)" },
            escaped(&condition.source)
        ));
    }
    text
}

fn procedure(study: &Study, outlook: &StudyOutlook) -> String {
    let settings = &study.settings;
    let task = match study.plan.mode {
        StudyTask::Follow => "walk the viewpoint graph by the text alone, and then judge three statements",
        StudyTask::Rate if settings.write_first => {
            "watch a film of the path, write a text of their own, read the text, and answer four questions"
        }
        StudyTask::Rate => "watch a film of the path, read the text, and answer four questions",
        StudyTask::Pair => "watch a film of the path, and choose between two texts",
    };
    let ethics =
        if settings.ethics.is_empty() { "TODO: ethics approval".to_owned() } else { escaped(&settings.ethics) };
    format!(
        "- Participants {task}.\n- Each gets {} items, each of another route, after one for practice; about {} minutes.\n\
         - The site assigns the least filled item first, then the condition that the person had least, then by the seed {}. The condition is on no page.\n\
         - Questions about the task before the first item: {}; attention checks: {}; questions at the end: {}.\n- Recruiting: TODO. Ethics: {ethics}\n",
        outlook.per_participant,
        settings.minutes,
        study.plan.seed,
        settings.questions.len(),
        settings.attention_checks,
        settings.end.len()
    )
}

fn measures(study: &Study) -> String {
    let main = main_measure(study.plan.mode);
    let mut text = format!(
        "Main measure: `{main}`. TODO: change it here if another one decides.\n\n| Measure | Meaning |\n| --- | --- |\n"
    );
    for measure in StudyMeasure::for_mode(study.plan.mode) {
        text.push_str(&format!("| `{}` | {} |\n", measure.name, escaped(measure.meaning)));
    }
    for scale in scales_for_mode(study.plan.mode) {
        let (words, levels) = study.texts.scale_words(scale);
        text.push_str(&format!("\n`{}`: {} ({})\n", scale.name, escaped(&words), escaped(&levels.join("; "))));
    }
    for question in &study.settings.end {
        let answers = match question.kind {
            EndQuestionKind::Text => "free text".to_owned(),
            EndQuestionKind::Choice | EndQuestionKind::Scale => question.answers.join("; "),
        };
        text.push_str(&format!(
            "\nAt the end, `{}`: {} ({})\n",
            question.name,
            escaped(&question.text),
            escaped(&answers)
        ));
    }
    text
}

fn exclusions(study: &Study) -> String {
    let settings = &study.settings;
    let mut text = "- Who does not understand the task in two tries is screened out, and is in no figure. Practice is in no figure.\n".to_owned();
    if settings.attention_checks > 0 {
        let failed = settings.tolerated_failed_checks() + 1;
        text.push_str(&format!(
            "- Attention: a participant is left out who fails {failed} or more of {} checks.\n",
            settings.attention_checks
        ));
    }
    for (rule, words) in settings.exclusions.in_words() {
        text.push_str(&format!("- `{rule}` leaves out an answer: {words}.\n"));
    }
    if settings.exclusions.is_empty() {
        text.push_str("- No single answers are left out: `[exclusions]` of study.toml has no rule.\n");
    }
    let versions = if settings.exclusions.is_empty() {
        "`everybody` and `finished`"
    } else {
        "`everybody`, `finished` and `kept`"
    };
    text.push_str(&format!("- The results print all figures for {versions}. TODO: which one decides.\n"));
    text
}

fn sample_size(study: &Study, outlook: &StudyOutlook) -> String {
    let mut text = format!(
        "{} participants with {} items each: {} answers, {} of each of {} items on {} routes. Nobody is added after a look at the results.\n\n",
        outlook.participants,
        outlook.per_participant,
        outlook.answers,
        format_number(outlook.per_item, usize::from(outlook.per_item.fract() > 0.0)),
        outlook.items,
        outlook.routes
    );
    let Some(_) = outlook.assumptions.first() else { return text + "There is one condition, so no comparison.\n" };
    text.push_str(&format!(
        "From {} simulated studies for each line, analysed by the rules of the results (seed {}); shares around {} %. The spreads are standard \
         deviations on the logit scale of what a condition does to one person, or on one route.\n\n\
         | Persons differ | Routes differ | Power for {} points | Found with power 0.8 | Participants for {} points |\n| ---: | ---: | ---: | ---: | ---: |\n",
        outlook.simulated_studies,
        study.plan.seed,
        format_percent(outlook.base_share),
        format_percent(outlook.effect),
        format_percent(outlook.effect)
    ));
    outlook.assumptions.iter().for_each(|assumption| text.push_str(&assumption_row(assumption)));
    text + "\nTODO: which line is assumed, and why.\n"
}

fn assumption_row(assumption: &PlannedPower) -> String {
    let missing = || "–".to_owned();
    let power = assumption.power.map_or_else(missing, |found| format!("{} %", format_number(100.0 * found.power, 0)));
    let difference =
        assumption.difference.map_or_else(missing, |share| format!("{} points", format_number(100.0 * share, 0)));
    let participants =
        assumption.participants.map_or_else(|| "more routes needed".to_owned(), |number| number.to_string());
    format!("| {:.2} | {:.2} | {power} | {difference} | {participants} |\n", assumption.person_sd, assumption.route_sd)
}

fn analysis(study: &Study) -> String {
    let comparison = match study.plan.mode {
        StudyTask::Pair => {
            "- The share of comparisons that a condition wins (half of what has no winner). A preference is shown where the interval of 95 % leaves out a half. \
             Strengths by Bradley and Terry's model with ties after Davidson and a term for the side.\n"
        }
        StudyTask::Follow | StudyTask::Rate => {
            "- Each condition minus the first one. A difference is shown where its interval of 95 % leaves out 0. Shares: both intervals combined (MOVER, Zou \
             and Donner 2008); means: Student's t.\n"
        }
    };
    format!(
        "- `wayword study results`, and `analysis.R` beside its files, which computes the same figures.\n{comparison}\
         - Persons and routes are both samples. Variance clustered by both: V(persons) + V(routes) − V(cells), never below the larger of the first two; \
         Student's t with the fewer of persons and routes, less one; shares on the logit scale. Where each person and each route occurs once: Wilson, \
         Newcombe, Student.\n- Differences are not corrected for their number. TODO: which one comparison decides, or which correction.\n\
         - Missing answers stay missing. TODO: further analyses are exploratory.\n"
    )
}
