//! One structured request about a view: the room, the ways out, the things, and how sure the model is of each.
//!
//! A capable model answers in one call. Its answer is parsed leniently and turned into a caption by rules. If it cannot
//! be parsed, the request is repeated once with the reason, and the second answer is read as free text if necessary.

mod caption;
mod names;
mod read_answer;
#[cfg(test)]
mod tests;

pub(crate) use caption::caption_text;

use crate::dialogue::{
    CaptionSummariser, OPENING_REQUEST, ObservationRoles, RulesSummariser, dialogue_room, dialogue_sightings,
    refuses_to_look, rephrase_question,
};
use wayword_core::{
    AnswerForm, AnswerTrouble, Caption, DialogueExchange, FormOutcome, ModelError, ObjectSighting, ReplySchema, View,
    ViewQuestion, WitnessAnswer,
};
use wayword_language::lexicon::{names_agree, with_article};

/// The JSON schema of the answer.
pub const VIEW_SCHEMA: ReplySchema = ReplySchema { name: "view", json: include_str!("schema.json") };

/// The request in the form that the transcript shows.
pub const VIEW_REQUEST: &str = "What does the view show a walker?";

/// A thing farther away than this counts as far, metres.
pub(crate) const FAR_M: f64 = 4.0;

/// The words before the reason in a repeated request.
const REPEAT_REQUEST_PREFIX: &str =
    "What does it show, in the form that was asked for? The last answer could not be read: ";

/// Longest answer that a transcript keeps, bytes; the end of a longer one is cut off.
const MAX_TRANSCRIPT_ANSWER_BYTES: usize = 8 * 1024;

/// The reason in a repeated request; `None` for any other question.
pub(crate) fn complaint_in_question(question: &str) -> Option<&str> {
    question.strip_prefix(REPEAT_REQUEST_PREFIX)
}

/// Asks about a view, and then at most `questions` questions about what the answer left open: the room, and things that
/// are only perhaps there.
///
/// # Errors
/// When a role does not answer.
pub(crate) fn see_view(view: &View, observers: ObservationRoles<'_>, questions: usize) -> Result<Caption, ModelError> {
    let by = observers.answerer.name();
    let mut transcript = Vec::new();
    let first = ask_in_form(view, VIEW_REQUEST, observers)?;
    transcript.push(DialogueExchange::new(VIEW_REQUEST, cut_answer(&first)));
    let (seen, form) = match read_answer::read_view_answer(&first, false) {
        Ok(seen) => (Some(seen), None),
        Err(fault) => {
            let question = format!("{REPEAT_REQUEST_PREFIX}{fault}");
            let second = ask_in_form(view, &question, observers)?;
            let trouble = if refuses_to_look(&first) { AnswerTrouble::Refusal } else { AnswerTrouble::Form };
            transcript.push(DialogueExchange { question, answer: cut_answer(&second), trouble: Some(trouble) });
            match read_answer::read_view_answer(&second, false) {
                Ok(seen) => (Some(seen), Some(FormOutcome::Mended)),
                // The complete part of a cut answer is better than no answer.
                Err(_) => (
                    read_answer::read_view_answer(&second, true)
                        .or_else(|_| read_answer::read_view_answer(&first, true))
                        .ok(),
                    Some(FormOutcome::Broken),
                ),
            }
        }
    };
    let Some(seen) = seen else { return Ok(Caption { form, ..caption_from_words(transcript, by)? }) };
    let mut caption = caption::caption_from_view(seen, by);
    for exchange in ask_open_questions(view, open_questions(&caption).into_iter().take(questions).collect(), observers)?
    {
        apply_answer(&mut caption, &exchange, by);
        transcript.push(exchange);
    }
    Ok(Caption { transcript, form, ..caption })
}

/// Sends the structured request. A repeated one includes only the reason and not the wrong answer, which the model
/// would copy.
fn ask_in_form(view: &View, question: &str, observers: ObservationRoles<'_>) -> Result<String, ModelError> {
    let ask = ViewQuestion { view, question, history: &[], answer: AnswerForm::Json(VIEW_SCHEMA) };
    observers.answerer.answer_questions(&[ask]).pop().unwrap_or_else(|| Err(observers.unanswered_error()))
}

/// Asks the open questions. They do not depend on each other, so they are sent together; refused ones are sent once
/// more in other words.
fn ask_open_questions(
    view: &View,
    questions: Vec<String>,
    observers: ObservationRoles<'_>,
) -> Result<Vec<DialogueExchange>, ModelError> {
    let answers = ask_in_words(view, &questions, observers)?;
    let is_refused: Vec<bool> = answers.iter().map(|answer| refuses_to_look(answer)).collect();
    let refused = questions.iter().zip(&is_refused).filter(|(_, refused)| **refused);
    let again: Vec<String> = refused.map(|(question, _)| rephrase_question(question)).collect();
    let mut second = ask_in_words(view, &again, observers)?.into_iter();
    let exchange = |((question, first), is_refused): ((String, String), bool)| {
        let answer = if is_refused { second.next().filter(|answer| !refuses_to_look(answer)) } else { Some(first) };
        let trouble = is_refused.then_some(AnswerTrouble::Refusal);
        DialogueExchange { question, answer: cut_answer(&answer.unwrap_or_default()), trouble }
    };
    Ok(questions.into_iter().zip(answers).zip(is_refused).map(exchange).collect())
}

/// Asks questions about a view for answers in words, one answer each.
fn ask_in_words(view: &View, questions: &[String], observers: ObservationRoles<'_>) -> Result<Vec<String>, ModelError> {
    if questions.is_empty() {
        return Ok(Vec::new());
    }
    let asks: Vec<ViewQuestion<'_>> = questions
        .iter()
        .map(|question| ViewQuestion { view, question, history: &[], answer: AnswerForm::Words })
        .collect();
    let mut answers = observers.answerer.answer_questions(&asks).into_iter();
    asks.iter().map(|_| answers.next().unwrap_or_else(|| Err(observers.unanswered_error()))).collect()
}

/// An answer as a transcript keeps it, cut to the limit.
fn cut_answer(answer: &str) -> String {
    answer[..answer.floor_char_boundary(MAX_TRANSCRIPT_ANSWER_BYTES)].to_owned()
}

/// The caption where no answer is in the requested form: the words of the last one are read as a description. A refusal
/// yields an empty caption.
fn caption_from_words(transcript: Vec<DialogueExchange>, by: &str) -> Result<Caption, ModelError> {
    let answer = transcript.last().map_or("", |last| last.answer.as_str());
    let answer = if refuses_to_look(answer) { "" } else { answer };
    let caption = RulesSummariser.sum_up(&[DialogueExchange::new(OPENING_REQUEST, answer)], by)?;
    Ok(Caption { transcript, ..caption })
}

/// The questions about what the answer left open: the room first.
fn open_questions(caption: &Caption) -> Vec<String> {
    let room = caption.room.is_none().then(|| "Which room is this?".to_owned());
    let doubtful = caption.sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Unsure);
    let things = doubtful.map(|sighting| format!("Is there {}?", with_article(&sighting.name)));
    room.into_iter().chain(things).collect()
}

/// Updates the caption with the answer to an open question.
fn apply_answer(caption: &mut Caption, exchange: &DialogueExchange, by: &str) {
    if caption.room.is_none()
        && let Some(room) = dialogue_room(std::slice::from_ref(exchange))
    {
        caption.room = Some(room);
        caption.perhaps_rooms.clear();
    }
    for ObjectSighting { name, witness, .. } in dialogue_sightings(std::slice::from_ref(exchange), by) {
        let doubted = caption.sightings.iter_mut().filter(|before| before.witness == WitnessAnswer::Unsure);
        doubted.filter(|before| names_agree(&before.name, &name)).for_each(|before| before.witness = witness);
    }
    caption.text =
        caption::caption_text(caption.room.as_deref(), &caption.perhaps_rooms, &caption.sightings, &caption.ways);
}
