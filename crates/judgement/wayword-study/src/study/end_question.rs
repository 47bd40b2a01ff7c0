//! Questions of the researcher's own, which participants answer after their last item: free text, one choice of several, or a scale.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A question at the end, a table `[[end]]` of `study.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndQuestion {
    /// Its name in the results, as `age_group`.
    pub name: String,
    /// The question.
    pub text: String,
    /// How it is answered.
    pub kind: EndQuestionKind,
    /// The answers to choose from, or the levels of the scale from the lowest to the highest. Empty for free text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub answers: Vec<String>,
    /// Whether it may be left empty.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub optional: bool,
    /// Longest free text, characters. 0 stands for 1000.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub max_chars: usize,
}

/// How a question at the end is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EndQuestionKind {
    /// By a text.
    Text,
    /// By one of the answers.
    Choice,
    /// By one of the levels, which the results count from 1.
    Scale,
}

/// A participant's answer to a question at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndAnswer {
    /// The name of the question.
    pub name: String,
    /// The words of the chosen answer or level, or the text. Empty where the question was left out.
    pub answer: String,
    /// For a choice and a scale: which answer, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<usize>,
}

/// Most questions at the end.
const MAX_END_QUESTIONS: usize = 30;
/// Most answers of a choice, and most levels of a scale.
const MAX_END_ANSWERS: usize = 20;
/// Longest name, bytes: it is a name in files.
const MAX_NAME_BYTES: usize = 40;
/// Longest question and longest answer to choose, characters.
const MAX_WORDS_CHARS: usize = 500;
/// Longest free text if a question does not say.
const DEFAULT_TEXT_CHARS: usize = 1000;
/// Longest free text that a question may allow, characters.
const MAX_TEXT_CHARS: usize = 5000;

// Serde hands a reference to this function.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_zero(number: &usize) -> bool {
    *number == 0
}

impl EndQuestion {
    /// Longest free text, characters.
    #[must_use]
    pub fn text_limit(&self) -> usize {
        if self.max_chars == 0 { DEFAULT_TEXT_CHARS } else { self.max_chars }
    }

    /// Checks all questions at the end.
    ///
    /// # Errors
    /// The first problem, as a sentence that names the question.
    pub(super) fn check_all(questions: &[Self]) -> Result<(), String> {
        if questions.len() > MAX_END_QUESTIONS {
            return Err(format!("end: {} questions, and at most {MAX_END_QUESTIONS} are asked", questions.len()));
        }
        let mut names = BTreeSet::new();
        for question in questions {
            question.check().map_err(|problem| format!("end, question {:?}: {problem}", question.name))?;
            if !names.insert(&question.name) {
                return Err(format!("end, question {:?}: there are two of this name", question.name));
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), String> {
        let is_letter = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
        let begins = self.name.bytes().next().is_some_and(|byte| byte.is_ascii_lowercase());
        if !begins || !self.name.bytes().all(is_letter) || self.name.len() > MAX_NAME_BYTES {
            return Err(
                "give a `name` of at most 40 small letters, digits and _, which begins with a letter".to_owned()
            );
        }
        let is_bad = |words: &String| words.trim().is_empty() || words.chars().count() > MAX_WORDS_CHARS;
        if is_bad(&self.text) {
            return Err(format!("give a `text` of 1 to {MAX_WORDS_CHARS} characters"));
        }
        if self.kind == EndQuestionKind::Text {
            if !self.answers.is_empty() {
                return Err("kind = \"text\" has no `answers`; give kind = \"choice\" or \"scale\"".to_owned());
            }
            if self.max_chars > MAX_TEXT_CHARS {
                return Err(format!("max_chars: at most {MAX_TEXT_CHARS}"));
            }
            return Ok(());
        }
        if self.max_chars != 0 {
            return Err("`max_chars` is for kind = \"text\"".to_owned());
        }
        let different: BTreeSet<&String> = self.answers.iter().collect();
        if !(2..=MAX_END_ANSWERS).contains(&self.answers.len()) || different.len() < self.answers.len() {
            return Err(format!("give 2 to {MAX_END_ANSWERS} different `answers`"));
        }
        if self.answers.iter().any(is_bad) {
            return Err(format!("each of the `answers` needs 1 to {MAX_WORDS_CHARS} characters"));
        }
        Ok(())
    }

    /// Reads the answer that a form sent: a text, or the number of an answer from 1.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn read_answer(&self, sent: Option<&str>) -> Result<EndAnswer, EndAnswerFault> {
        let sent = sent.unwrap_or("").trim();
        let answer = |answer: &str, number| EndAnswer { name: self.name.clone(), answer: answer.to_owned(), number };
        if sent.is_empty() {
            return if self.optional { Ok(answer("", None)) } else { Err(EndAnswerFault::Missing) };
        }
        if self.kind == EndQuestionKind::Text {
            let is_long = sent.chars().count() > self.text_limit();
            return if is_long { Err(EndAnswerFault::Long) } else { Ok(answer(sent, None)) };
        }
        let number = sent.parse::<usize>().ok().filter(|number| *number > 0).ok_or(EndAnswerFault::Missing)?;
        let words = self.answers.get(number - 1).ok_or(EndAnswerFault::Missing)?;
        Ok(answer(words, Some(number)))
    }
}

/// Why an answer to a question at the end is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EndAnswerFault {
    /// There is none, or it is none of the answers.
    Missing,
    /// The text is too long.
    Long,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question(kind: EndQuestionKind, answers: &[&str]) -> EndQuestion {
        EndQuestion {
            name: "age".to_owned(),
            text: "How old are you?".to_owned(),
            kind,
            answers: answers.iter().map(|one| (*one).to_owned()).collect(),
            optional: false,
            max_chars: 0,
        }
    }

    #[test]
    fn check_names_the_question_and_what_it_lacks() {
        let (text, choice) = (question(EndQuestionKind::Text, &[]), question(EndQuestionKind::Choice, &["a", "b"]));
        EndQuestion::check_all(&[text.clone(), EndQuestion { name: "b2".into(), ..choice.clone() }]).unwrap();
        for (wrong, said) in [
            (EndQuestion { name: "Age".into(), ..text.clone() }, "name"),
            (EndQuestion { name: "1a".into(), ..text.clone() }, "name"),
            (EndQuestion { text: " ".into(), ..text.clone() }, "text"),
            (EndQuestion { answers: vec!["a".into()], ..text.clone() }, "answers"),
            (EndQuestion { max_chars: 9999, ..text.clone() }, "max_chars"),
            (EndQuestion { max_chars: 9, ..choice.clone() }, "max_chars"),
            (EndQuestion { answers: vec!["a".into(); 2], ..choice.clone() }, "different"),
            (EndQuestion { answers: vec!["a".into()], ..choice }, "answers"),
        ] {
            let told = EndQuestion::check_all(std::slice::from_ref(&wrong)).unwrap_err();
            assert!(told.contains(said) && told.contains(&wrong.name), "{told}");
        }
        assert!(EndQuestion::check_all(&[text.clone(), text]).unwrap_err().contains("two of this name"));
    }

    #[test]
    fn answers_are_read_by_number_and_texts_by_length() {
        let choice = question(EndQuestionKind::Scale, &["never", "often"]);
        let read = choice.read_answer(Some("2")).unwrap();
        assert_eq!((read.answer.as_str(), read.number), ("often", Some(2)));
        for wrong in [None, Some(""), Some("0"), Some("3"), Some("often"), Some("-1")] {
            assert_eq!(choice.read_answer(wrong), Err(EndAnswerFault::Missing), "{wrong:?}");
        }
        let text = EndQuestion { max_chars: 5, optional: true, ..question(EndQuestionKind::Text, &[]) };
        assert_eq!(text.read_answer(Some(" é<b>é ")).map(|read| read.answer), Ok("é<b>é".to_owned()));
        assert_eq!(text.read_answer(Some("123456")), Err(EndAnswerFault::Long));
        assert_eq!(text.read_answer(None).map(|read| read.answer), Ok(String::new()));
    }
}
