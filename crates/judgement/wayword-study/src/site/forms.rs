//! Reads and checks the forms that the pages send. The checks of a browser can be bypassed, so all of them are made here again.

use crate::{
    store::{Given, LONGEST_TEXT},
    study::{Choice, Mode},
};
use std::collections::BTreeMap;

/// The fields of a form. If a name occurs twice, the last one counts.
pub(super) type Fields = BTreeMap<String, String>;

/// Reads the answers to the questions about the task.
///
/// # Errors
/// A message for the participant that names the missing part.
pub(super) fn understood(fields: &Fields, questions: usize) -> Result<Given, &'static str> {
    let all = (0..questions).map(|at| number(fields, &format!("q{at}"))).collect::<Option<Vec<usize>>>();
    let attempt = number(fields, "try").unwrap_or(0);
    Ok(Given::Understood { attempt, answers: all.ok_or("Please answer every question.")? })
}

pub(super) fn own_text(fields: &Fields) -> Result<Given, &'static str> {
    let text = fields.get("own_text").map_or("", String::as_str).trim();
    if text.is_empty() {
        return Err("Please write a text.");
    }
    if text.chars().count() > LONGEST_TEXT {
        return Err("Your text is too long. Please write at most 1000 characters.");
    }
    Ok(Given::OwnText { slot: slot(fields)?, text: text.to_owned() })
}

pub(super) fn step(fields: &Fields) -> Result<Given, &'static str> {
    let (seq, to) = (number(fields, "seq"), number(fields, "to"));
    Ok(Given::Move { slot: slot(fields)?, seq: seq.ok_or(WAY)?, to: to.ok_or(WAY)? })
}

const WAY: &str = "Please choose a way.";

pub(super) fn stop(fields: &Fields) -> Result<Given, &'static str> {
    let seq = number(fields, "seq").ok_or("This page is old. Please load it again.")?;
    Ok(Given::Stop { slot: slot(fields)?, seq, looks: number(fields, "looks").unwrap_or(0) })
}

pub(super) fn answer(fields: &Fields, mode: Mode) -> Result<Given, &'static str> {
    let slot = slot(fields)?;
    match mode {
        Mode::Follow => Ok(Given::Followed {
            slot,
            statements: levels(fields, 's').ok_or("Please choose one answer for every statement.")?,
        }),
        Mode::Rate => Ok(Given::Rated {
            slot,
            ratings: levels(fields, 'q').ok_or("Please choose one answer for every question.")?,
        }),
        Mode::Pair => {
            let choice = match fields.get("choice").map(String::as_str) {
                Some("a") => Choice::A,
                Some("b") => Choice::B,
                Some("tie") => Choice::Tie,
                Some("bad") => Choice::Bad,
                _ => return Err("Please choose one of the four answers."),
            };
            Ok(Given::Chosen { slot, choice })
        }
    }
}

pub(super) fn attention(fields: &Fields) -> Result<Given, &'static str> {
    let choice = number(fields, "choice").filter(|level| (1..=5).contains(level)).ok_or("Please choose one answer.")?;
    Ok(Given::Attention { number: number(fields, "number").ok_or("Please choose one answer.")?, choice })
}

fn slot(fields: &Fields) -> Result<String, &'static str> {
    fields.get("slot").cloned().ok_or("This page is old. Please load it again.")
}

fn levels<const N: usize>(fields: &Fields, letter: char) -> Option<[u8; N]> {
    let mut levels = [0; N];
    for (at, level) in levels.iter_mut().enumerate() {
        *level = number(fields, &format!("{letter}{at}")).filter(|level| (1..=5).contains(level))?;
    }
    Some(levels)
}

fn number<T: std::str::FromStr>(fields: &Fields, name: &str) -> Option<T> {
    fields.get(name)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(pairs: &[(&str, &str)]) -> Fields {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn a_level_outside_the_scale_is_refused() {
        for level in ["0", "6", "-1", "256", "", "3.5", "<b>"] {
            let all = fields(&[("slot", "s"), ("q0", "1"), ("q1", "2"), ("q2", level), ("q3", "5")]);
            assert!(answer(&all, Mode::Rate).is_err(), "{level}");
        }
        let all = fields(&[("slot", "s"), ("q0", "1"), ("q1", "2"), ("q2", "3"), ("q3", "5")]);
        assert_eq!(answer(&all, Mode::Rate), Ok(Given::Rated { slot: "s".into(), ratings: [1, 2, 3, 5] }));
    }

    #[test]
    fn a_text_of_spaces_is_no_text() {
        assert!(own_text(&fields(&[("slot", "s"), ("own_text", " \n ")])).is_err());
        assert!(own_text(&fields(&[("slot", "s"), ("own_text", &"é".repeat(1001))])).is_err());
        assert!(own_text(&fields(&[("slot", "s"), ("own_text", &"é".repeat(1000))])).is_ok());
    }
}
