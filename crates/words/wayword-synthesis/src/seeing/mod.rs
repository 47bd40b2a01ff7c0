//! One structured request about a view: the room, the ways out, the things, and how sure the model is of each.
//!
//! Models that can talk answer it in one call. [`read`] reads the answer as far as it can be understood, [`told`] makes a
//! caption of it by rules. An answer that cannot be read is asked for once more, with what was wrong, and then read as
//! words like any description.

mod json;
mod names;
mod read;
#[cfg(test)]
mod tests;
mod told;

use crate::{
    dialogue::{OPENING, RulesSummariser, Summariser, room, sightings},
    observe::{Observers, unanswered},
};
use wayword_core::{AnswerForm, Ask, Caption, Exchange, Form, ModelError, Schema, Sighting, Trouble, View, Witness};
use wayword_language::lexicon::{agree, with_article};

/// The form of the answer.
pub const SCHEMA: Schema = Schema { name: "view", json: include_str!("schema.json") };

/// The request, as the transcript has it.
pub const REQUEST: &str = "What does the view show a walker?";

/// What precedes the reason for which an answer is asked for once more.
const AGAIN: &str = "What does it show, in the form that was asked for? The last answer could not be read: ";

/// Longest answer that a transcript keeps, bytes.
const MOST_KEPT: usize = 8 * 1024;

/// Why an answer is asked for once more, where the question says so.
pub(crate) fn complaint(question: &str) -> Option<&str> {
    question.strip_prefix(AGAIN)
}

/// Asks about a view, and at most so many questions about what stays open: the room, and what is only perhaps there.
///
/// # Errors
/// When a role does not answer.
pub(crate) fn see(view: &View, observers: Observers<'_>, questions: usize) -> Result<Caption, ModelError> {
    let by = observers.answerer.name();
    let mut transcript = Vec::new();
    let first = ask(view, REQUEST, &transcript, AnswerForm::Json(SCHEMA), observers)?;
    transcript.push(Exchange::new(REQUEST, kept(&first)));
    let (seen, form) = match read::read(&first, false) {
        Ok(seen) => (Some(seen), None),
        Err(fault) => {
            let question = format!("{AGAIN}{fault}");
            let second = ask(view, &question, &transcript, AnswerForm::Json(SCHEMA), observers)?;
            transcript.push(Exchange { question, answer: kept(&second), trouble: Some(Trouble::Form) });
            match read::read(&second, false) {
                Ok(seen) => (Some(seen), Some(Form::Mended)),
                // What was complete before it was cut off is better than nothing.
                Err(_) => (read::read(&second, true).or_else(|_| read::read(&first, true)).ok(), Some(Form::Broken)),
            }
        }
    };
    let Some(seen) = seen else { return Ok(Caption { form, ..as_words(transcript, by)? }) };
    let mut caption = told::caption(seen, by);
    for question in open_questions(&caption).into_iter().take(questions) {
        let answer = ask(view, &question, &transcript, AnswerForm::Words, observers)?;
        let exchange = Exchange::new(question, kept(&answer));
        settle(&mut caption, &exchange, by);
        transcript.push(exchange);
    }
    Ok(Caption { transcript, form, ..caption })
}

fn ask(
    view: &View,
    question: &str,
    history: &[Exchange],
    answer: AnswerForm,
    observers: Observers<'_>,
) -> Result<String, ModelError> {
    // The question about the form says what was wrong, and the whole wrong answer would only be repeated. JSON among
    // the answers would make a model answer the next question in JSON.
    let history = if matches!(answer, AnswerForm::Json(_)) { &[] } else { &history[1..] };
    let ask = Ask { view, question, history, answer };
    observers.answerer.answer(&[ask]).pop().unwrap_or_else(|| Err(unanswered(observers.answerer)))
}

fn kept(answer: &str) -> String {
    answer[..answer.floor_char_boundary(MOST_KEPT)].to_owned()
}

/// The caption of an answer that does not have the form: what it says in words, if anything.
fn as_words(transcript: Vec<Exchange>, by: &str) -> Result<Caption, ModelError> {
    let said = transcript.last().map_or("", |last| last.answer.as_str());
    let caption = RulesSummariser.sum_up(&[Exchange::new(OPENING, said)], by)?;
    Ok(Caption { transcript, ..caption })
}

/// What an answer leaves open, as questions: the room first.
fn open_questions(caption: &Caption) -> Vec<String> {
    let room = caption.room.is_none().then(|| "Which room is this?".to_owned());
    let doubtful = caption.sightings.iter().filter(|sighting| sighting.witness == Witness::Unsure);
    let things = doubtful.map(|sighting| format!("Is there {}?", with_article(&sighting.name)));
    room.into_iter().chain(things).collect()
}

/// Takes in the answer to an open question.
fn settle(caption: &mut Caption, exchange: &Exchange, by: &str) {
    if caption.room.is_none()
        && let Some(room) = room(std::slice::from_ref(exchange))
    {
        caption.room = Some(room);
        caption.perhaps_rooms.clear();
    }
    for Sighting { name, witness, .. } in sightings(std::slice::from_ref(exchange), by) {
        let doubted = caption.sightings.iter_mut().filter(|before| before.witness == Witness::Unsure);
        doubted.filter(|before| agree(&before.name, &name)).for_each(|before| before.witness = witness);
    }
    caption.text = told::text(caption.room.as_deref(), &caption.perhaps_rooms, &caption.sightings, &caption.ways);
}
