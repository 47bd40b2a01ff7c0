//! `study.toml`: what the researcher words and sets.

use super::Mode;
use serde::{Deserialize, Serialize};

/// What `study.toml` says. A change counts from the next start of the site.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// What the study is called on its pages.
    pub title: String,
    /// Whom to ask: name, institution, address. The site is not shown to others than this machine without it.
    pub contact: String,
    /// Until when the answers are kept, in words that participants read.
    pub retention: String,
    /// How long it takes, minutes.
    pub minutes: u32,
    /// What participants read before they consent, one paragraph each.
    pub about: Vec<String>,
    /// What they agree to.
    pub agreement: String,
    /// Texts that show the style, to those who rate.
    #[serde(default)]
    pub examples: Vec<String>,
    /// Whether those who rate write an instruction of their own before they see the one they rate.
    #[serde(default)]
    pub write_first: bool,
    /// How many attention checks a participant gets, 0 to 4.
    pub attention_checks: u32,
    /// After how many seconds without a sign of life an item goes to somebody else.
    pub lease_s: u64,
    /// What shows that the task was understood.
    #[serde(default)]
    pub questions: Vec<Question>,
    /// Where participants come from.
    pub recruiter: Recruiter,
    /// What participants take back to the recruiter.
    #[serde(default)]
    pub codes: Codes,
}

/// A question with one right answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// The question.
    pub text: String,
    /// What can be chosen.
    pub answers: Vec<String>,
    /// Index of the right answer.
    pub right: usize,
}

/// How participants come to the site.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", tag = "kind")]
pub enum Recruiter {
    /// Each has a personal link.
    Links,
    /// The recruiter adds parameters to one link: Prolific, MTurk and their like.
    Parameters {
        /// The parameter with the participant's id, as `PROLIFIC_PID` or `workerId`.
        person: String,
        /// The parameter with the session's, as `SESSION_ID` or `assignmentId`.
        session: String,
        /// The parameter with the study's, as `STUDY_ID` or `hitId`; empty where there is none.
        #[serde(default)]
        study: String,
        /// Only links of this study are let in; empty lets in any.
        #[serde(default)]
        only_study: String,
    },
}

/// Codes that tell the recruiter how it went, and the address that takes them.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Codes {
    /// Where participants go back to, with `{code}` in the place of the code; empty shows the code alone.
    pub return_url: String,
    /// All items were answered.
    pub done: String,
    /// The task was not understood.
    pub screened_out: String,
    /// All items were answered, and more attention checks failed than Prolific lets pass.
    pub attention_failed: String,
    /// No consent was given.
    pub no_consent: String,
}

impl Settings {
    /// The settings that a new study begins with.
    #[must_use]
    pub fn of_mode(mode: Mode, per_participant: u32) -> Self {
        let (task, minutes_each) = match mode {
            Mode::Follow => {
                ("You walk through pictures of a building by following a text, and stop where the text ends.", 2)
            }
            Mode::Rate => ("You watch a walk through a building, read a text about it, and answer four questions.", 2),
            Mode::Pair => ("You watch a walk through a building and say which of two texts describes it better.", 1),
        };
        let minutes = 4 + minutes_each * per_participant;
        Self {
            title: "Finding the way by a text".to_owned(),
            contact: String::new(),
            retention: "one year after the study ends".to_owned(),
            minutes,
            about: [
                "We study how well texts describe a way through a building.",
                task,
                "Taking part is voluntary. You can stop at any time, and you need not say why.",
                "We keep your answers and the time they took. We do not keep your name, your address on the internet or your browser. \
                 An id from a recruiting service is kept apart from your answers and deleted when the study is closed.",
            ]
            .map(str::to_owned)
            .to_vec(),
            agreement: "I am at least 18 years old. I have read this, and I want to take part.".to_owned(),
            examples: Vec::new(),
            write_first: mode == Mode::Rate,
            attention_checks: u32::from(per_participant > 2) + u32::from(per_participant > 4),
            lease_s: 20 * 60,
            questions: Question::of_mode(mode),
            recruiter: Recruiter::Links,
            codes: Codes::default(),
        }
    }

    /// What is wrong with the settings, as a sentence about a field.
    ///
    /// # Errors
    /// The first problem.
    pub fn check(&self) -> Result<(), String> {
        for question in &self.questions {
            if question.right >= question.answers.len() {
                return Err(format!(
                    "questions: the right answer of {:?} is not among its answers; they count from 0",
                    question.text
                ));
            }
        }
        if self.attention_checks > 4 {
            return Err("attention_checks: at most 4".to_owned());
        }
        if self.lease_s == 0 || self.lease_s > 7 * 24 * 3600 {
            return Err("lease_s: give 1 to 604800 seconds".to_owned());
        }
        if self.about.is_empty() || self.agreement.is_empty() {
            return Err("about and agreement: participants must read what they consent to".to_owned());
        }
        let url = &self.codes.return_url;
        let is_usable = url.starts_with("https://") && url.contains("{code}");
        if !url.is_empty() && !is_usable {
            return Err("codes.return_url: begin it with https:// and put {code} where the code goes".to_owned());
        }
        if let Recruiter::Parameters { person, session, .. } = &self.recruiter
            && (person.is_empty() || session.is_empty())
        {
            return Err("recruiter: name the parameters `person` and `session`".to_owned());
        }
        Ok(())
    }
}

impl Question {
    fn of_mode(mode: Mode) -> Vec<Self> {
        let question = |text: &str, answers: [&str; 3], right| Self {
            text: text.to_owned(),
            answers: answers.map(str::to_owned).to_vec(),
            right,
        };
        match mode {
            Mode::Follow => vec![
                question(
                    "How do you find the way?",
                    ["I go where I like.", "I do what the text says.", "I visit every room."],
                    1,
                ),
                question(
                    "When do you press the button that stops?",
                    ["Where the text ends.", "After ten steps.", "At once."],
                    0,
                ),
            ],
            Mode::Rate => vec![
                question("What do you do first?", ["I guess.", "I rate the text.", "I watch the walk."], 2),
                question(
                    "What do the questions ask about?",
                    ["The text about the walk.", "The weather.", "My own home."],
                    0,
                ),
            ],
            Mode::Pair => vec![
                question("What do you compare?", ["Two walks.", "Two texts about one walk.", "Two buildings."], 1),
                question(
                    "What if both are equally good?",
                    ["I say that they are about equal.", "I always choose A.", "I stop."],
                    0,
                ),
            ],
        }
    }
}
