//! Counts the answers to the questions at the end.

use crate::{EndQuestionKind, Participant, ParticipantStatus, StudyData};
use serde::Serialize;

/// The answers to a question at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EndQuestionCounts {
    /// Its name.
    pub name: String,
    /// The question.
    pub text: String,
    /// How it is answered.
    pub kind: EndQuestionKind,
    /// How often each answer was chosen; empty for free text.
    pub chosen: Vec<EndAnswerCount>,
    /// How many participants answered it.
    pub answered: usize,
    /// How many left it out.
    pub left_out: usize,
}

/// How often an answer was chosen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct EndAnswerCount {
    /// The words of the answer.
    pub answer: String,
    /// How many participants chose it.
    pub count: usize,
}

/// Counts the answers of all participants who were not screened out.
pub(super) fn count_end_answers(data: &StudyData) -> Vec<EndQuestionCounts> {
    let people: Vec<&Participant> =
        data.participants.iter().filter(|person| person.status != ParticipantStatus::ScreenedOut).collect();
    let count = |question: &crate::EndQuestion| {
        let given: Vec<&crate::EndAnswer> =
            people.iter().flat_map(|person| &person.end).filter(|answer| answer.name == question.name).collect();
        let chosen = (1..).zip(&question.answers).map(|(number, words)| EndAnswerCount {
            answer: words.clone(),
            count: given.iter().filter(|answer| answer.number == Some(number)).count(),
        });
        let left_out = given.iter().filter(|answer| answer.answer.is_empty()).count();
        EndQuestionCounts {
            name: question.name.clone(),
            text: question.text.clone(),
            kind: question.kind,
            chosen: chosen.collect(),
            answered: given.len() - left_out,
            left_out,
        }
    };
    data.settings.end.iter().map(count).collect()
}
