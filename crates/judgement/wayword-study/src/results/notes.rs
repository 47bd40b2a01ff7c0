//! Writes the sentences around the tables: a summary of the study, warnings, and how to read the figures.

use super::{ResultVersion, StudyReport, number_format};
use crate::StudyTask;
use std::collections::BTreeSet;
use wayword_metrics::IntervalMethod;

/// A summary of the study: task, answers, persons, and whether it is closed.
pub(super) fn describe_study(results: &StudyReport) -> String {
    let everybody = results.everybody();
    let task = match results.mode {
        StudyTask::Follow => "people followed the text alone",
        StudyTask::Rate => "people watched a walk and rated a text about it",
        StudyTask::Pair => "people watched a walk and chose between two texts about it",
    };
    let answers = number_format::count_with_noun(everybody.answers, "answer", "answers");
    let persons = number_format::count_with_noun(everybody.persons, "person", "persons");
    let state = if results.is_closed { "closed" } else { "not closed yet, so the figures can change" };
    let style = if results.style.is_empty() {
        String::new()
    } else {
        format!(" Style of the texts: {}.", super::escape::to_table_name(&results.style))
    };
    format!("Mode {}: {task}. {answers} of {persons}. The study is {state}.{style}", results.mode.name())
}

/// The number of answers and persons of a version, as a sentence.
pub(super) fn count_answers(version: &ResultVersion) -> String {
    let answers = number_format::count_with_noun(version.answers, "answer", "answers");
    format!("{answers} of {}.", number_format::count_with_noun(version.persons, "person", "persons"))
}

/// Warnings that a reader has to see first: problems of the data, no answers, no control condition.
pub(super) fn collect_warnings(results: &StudyReport) -> Vec<String> {
    let everybody = results.everybody();
    let mut warnings = Vec::new();
    if everybody.answers == 0 {
        warnings.push("There are no answers yet.".to_owned());
    }
    if results.mode != StudyTask::Pair
        && !results.conditions.iter().any(|condition| condition.kind != crate::ConditionKind::Run)
    {
        warnings.push(
            "There is no control: no text of people and none of another path. So nothing shows how well a good or a wrong text does \
             here.".to_owned(),
        );
    }
    warnings.extend(results.problems.iter().cloned());
    warnings
}

/// The names of the methods by which any interval of the tables was computed.
fn used_method_names(versions: &[ResultVersion]) -> BTreeSet<&'static str> {
    let row_methods = versions
        .iter()
        .flat_map(|version| &version.rows)
        .flat_map(|row| row.figures.values().map(|figure| figure.method));
    let differences = versions.iter().flat_map(|version| &version.differences);
    let difference_methods = differences.flat_map(|difference| difference.figures.values().map(|figure| figure.method));
    let pairs = versions.iter().filter_map(|version| version.pairs.as_ref());
    let pair_methods =
        pairs.flat_map(|pairs| pairs.rows.iter().filter_map(|row| row.share.as_ref()).map(|share| share.method));
    row_methods.chain(difference_methods).chain(pair_methods).map(number_format::method_name).collect()
}

/// The methods by which intervals were computed, in the order in which the notes explain them.
pub(super) fn used_methods(versions: &[ResultVersion]) -> Vec<IntervalMethod> {
    let used = used_method_names(versions);
    number_format::ALL_METHODS.into_iter().filter(|method| used.contains(number_format::method_name(*method))).collect()
}

/// Explains how to read the figures, one note for each point.
pub(super) fn collect_notes(results: &StudyReport) -> Vec<String> {
    let mut notes = vec![
        "Practice is in no figure. Neither are answers of those who did not understand the task in two tries.".to_owned(),
        if results.versions.len() > 2 {
            "Every figure is given three times: from all answers, without those who failed attention checks or did not finish, and besides \
             without the answers that an exclusion rule leaves out. Decide before the study which one counts, and report all."
        } else {
            "Every figure is given twice: from all answers, and without those who failed attention checks or did not finish. Decide before the \
             study which one counts, and report both."
        }
        .to_owned(),
        "Intervals hold for other persons and other routes than these. Conditions share routes, so a route is the item. An interval ends \
         where the scale ends."
            .to_owned(),
    ];
    for method in used_methods(&results.versions) {
        notes.push(format!(
            "Interval by {}: {}.",
            number_format::method_name(method),
            number_format::method_meaning(method)
        ));
    }
    if results.versions.iter().any(|version| !version.differences.is_empty()) {
        notes.push(
            "A difference is shown where its interval leaves out 0. Many \
             differences are printed, and none is corrected for that: about one in twenty leaves out 0 by chance."
                .to_owned(),
        );
    }
    if results.mode == StudyTask::Follow {
        notes.push(
            "Distances go along the viewpoint graph. A success is less than 3 m from the \
             goal. A walk to a goal that cannot be reached has no NE and is in no mean of it."
                .to_owned(),
        );
    }
    if results.mode == StudyTask::Rate {
        notes.push(
            "A ghost is a thing that the text names and the participant did not see; whoever \
             overlooked it in the film reports one too."
                .to_owned(),
        );
        let first = if results.write_first {
            "Participants wrote a text of their own first, which is what they compare with in the first question."
        } else {
            "Participants did not write a text of their own first."
        };
        notes.push(first.to_owned());
    }
    notes.push(format!("Wayword {}; seed {}; {}.", results.wayword, results.seed, results.format));
    notes
}
