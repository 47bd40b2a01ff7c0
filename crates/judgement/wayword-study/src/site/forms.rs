//! Reads and checks the forms that the pages send. The checks of a browser can be bypassed, so all of them are made here again.

use crate::{
    store::{MAX_OWN_TEXT_CHARS, ParticipantInput},
    study::{EndAnswerFault, EndQuestion, PairChoice, StudyTask, WindowSize},
};
use std::collections::BTreeMap;

/// The fields of a form. If a name occurs twice, the last one counts.
pub(super) type FormFields = BTreeMap<String, String>;

/// Reads the answers to the questions about the task.
///
/// # Errors
/// The key of a message for the participant that names the missing part; the section `error` of the texts has the words.
pub(super) fn read_comprehension(fields: &FormFields, questions: usize) -> Result<ParticipantInput, &'static str> {
    let choices = (0..questions).map(|at| number_field(fields, &format!("q{at}"))).collect::<Option<Vec<usize>>>();
    let attempt = number_field(fields, "try").unwrap_or(0);
    Ok(ParticipantInput::Understood { attempt, answers: choices.ok_or("every_question")? })
}

pub(super) fn read_own_text(fields: &FormFields) -> Result<ParticipantInput, &'static str> {
    let text = fields.get("own_text").map_or("", String::as_str).trim();
    if text.is_empty() {
        return Err("write_text");
    }
    if text.chars().count() > MAX_OWN_TEXT_CHARS {
        return Err("long_text");
    }
    let pictures = number_field(fields, "pictures");
    Ok(ParticipantInput::OwnText { slot: slot_field(fields)?, text: text.to_owned(), pictures })
}

pub(super) fn read_move(fields: &FormFields) -> Result<ParticipantInput, &'static str> {
    let (seq, to) = (number_field(fields, "seq"), number_field(fields, "to"));
    Ok(ParticipantInput::Move {
        slot: slot_field(fields)?,
        seq: seq.ok_or(MISSING_WAY_MESSAGE)?,
        to: to.ok_or(MISSING_WAY_MESSAGE)?,
    })
}

const MISSING_WAY_MESSAGE: &str = "choose_way";

pub(super) fn read_stop(fields: &FormFields) -> Result<ParticipantInput, &'static str> {
    let seq = number_field(fields, "seq").ok_or("old_page")?;
    Ok(ParticipantInput::Stop { slot: slot_field(fields)?, seq, looks: number_field(fields, "looks").unwrap_or(0) })
}

/// Reads the wish to walk the practice item again.
pub(super) fn read_again(fields: &FormFields) -> Result<ParticipantInput, &'static str> {
    Ok(ParticipantInput::WalkAgain { slot: slot_field(fields)? })
}

pub(super) fn read_answer(fields: &FormFields, mode: StudyTask) -> Result<ParticipantInput, &'static str> {
    let (slot, pictures) = (slot_field(fields)?, number_field(fields, "pictures"));
    match mode {
        StudyTask::Follow => Ok(ParticipantInput::Followed {
            slot,
            window: fields.get("window").and_then(|window| WindowSize::from_form(window)),
            statements: level_fields(fields, 's').ok_or("every_statement")?,
        }),
        StudyTask::Rate => {
            Ok(ParticipantInput::Rated { slot, ratings: level_fields(fields, 'q').ok_or("every_question")?, pictures })
        }
        StudyTask::Pair => {
            let choice = match fields.get("choice").map(String::as_str) {
                Some("a") => PairChoice::A,
                Some("b") => PairChoice::B,
                Some("tie") => PairChoice::Tie,
                Some("bad") => PairChoice::Bad,
                _ => return Err("four_answers"),
            };
            Ok(ParticipantInput::Chosen { slot, choice, pictures })
        }
    }
}

pub(super) fn read_attention(fields: &FormFields) -> Result<ParticipantInput, &'static str> {
    let choice = number_field(fields, "choice").filter(|level| (1..=5).contains(level)).ok_or("one_answer")?;
    Ok(ParticipantInput::Attention { number: number_field(fields, "number").ok_or("one_answer")?, choice })
}

/// Reads the answers to the questions at the end, from the fields `end_` and the name of the question.
pub(super) fn read_end(fields: &FormFields, questions: &[EndQuestion]) -> Result<ParticipantInput, &'static str> {
    let answer = |question: &EndQuestion| {
        let sent = fields.get(&format!("end_{}", question.name)).map(String::as_str);
        question.read_answer(sent).map_err(|fault| match fault {
            EndAnswerFault::Missing => "every_question",
            EndAnswerFault::Long => "long_text",
        })
    };
    Ok(ParticipantInput::End { answers: questions.iter().map(answer).collect::<Result<_, _>>()? })
}

fn slot_field(fields: &FormFields) -> Result<String, &'static str> {
    fields.get("slot").cloned().ok_or("old_page")
}

/// Reads levels from 1 to 5 from the fields `s0`, `s1` and so on, where `s` is `letter`. `None` if one is missing or wrong.
fn level_fields<const N: usize>(fields: &FormFields, letter: char) -> Option<[u8; N]> {
    let mut levels = [0; N];
    for (at, level) in levels.iter_mut().enumerate() {
        *level = number_field(fields, &format!("{letter}{at}")).filter(|level| (1..=5).contains(level))?;
    }
    Some(levels)
}

fn number_field<T: std::str::FromStr>(fields: &FormFields, name: &str) -> Option<T> {
    fields.get(name)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(pairs: &[(&str, &str)]) -> FormFields {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn a_level_outside_the_scale_is_refused() {
        for level in ["0", "6", "-1", "256", "", "3.5", "<b>"] {
            let all = fields(&[("slot", "s"), ("q0", "1"), ("q1", "2"), ("q2", level), ("q3", "5")]);
            assert!(read_answer(&all, StudyTask::Rate).is_err(), "{level}");
        }
        let all = fields(&[("slot", "s"), ("q0", "1"), ("q1", "2"), ("q2", "3"), ("q3", "5")]);
        assert_eq!(
            read_answer(&all, StudyTask::Rate),
            Ok(ParticipantInput::Rated { slot: "s".into(), ratings: [1, 2, 3, 5], pictures: None })
        );
    }

    #[test]
    fn a_text_of_spaces_is_no_text() {
        assert!(read_own_text(&fields(&[("slot", "s"), ("own_text", " \n ")])).is_err());
        assert!(read_own_text(&fields(&[("slot", "s"), ("own_text", &"é".repeat(1001))])).is_err());
        assert!(read_own_text(&fields(&[("slot", "s"), ("own_text", &"é".repeat(1000))])).is_ok());
    }
}
