//! The dialogue about one view: questions, answers, a caption.
//!
//! It is a state machine without input or output of its own: it says what it needs and is told. So it runs in the same
//! way against a model, a recording or a test.

mod answers;
mod questions;
mod summary;

use wayword_core::{Caption, Exchange, ModelError};

pub(crate) use answers::{counted, plural, sightings, with_article};
pub use questions::RulesAsker;
pub use summary::RulesSummariser;

/// The fixed first request of a dialogue (ChatCaptioner opens every dialogue with a request for a description).
pub const OPENING: &str = "Describe in detail what you see.";

/// The two fixed queries of the variant without a dialogue (arXiv 2403.11487, ablation "BLIP alone").
pub const FIXED_QUERIES: [&str; 2] = ["What objects are there?", "Which room is this?"];

/// Most questions after the opening, unless told otherwise (ChatCaptioner asks nine).
pub const QUESTIONS: usize = 9;

/// Chooses the questions.
pub trait Asker: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// The next question after what was said so far, or `None` where nothing is left to ask.
    ///
    /// # Errors
    /// When a model was to choose it and gave nothing.
    fn next_question(&self, transcript: &[Exchange]) -> Result<Option<String>, ModelError>;
}

/// Sums a dialogue up.
pub trait Summariser: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// A caption of what `answerer` said. It holds no object that was denied.
    ///
    /// # Errors
    /// When a model was to write it and gave nothing.
    fn sum_up(&self, transcript: &[Exchange], answerer: &str) -> Result<Caption, ModelError>;

    /// Captions of one place, each with its direction in words ("north"), as one description of fewer words than that.
    ///
    /// # Errors
    /// When a model was to write it and gave nothing.
    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<String, ModelError>;
}

/// How a view is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// An opening, then up to so many questions of the asker's.
    Dialogue {
        /// Most questions after the opening.
        questions: usize,
    },
    /// [`FIXED_QUERIES`] and no dialogue.
    Fixed,
    /// [`OPENING`] alone: its answer is the caption.
    Single,
}

/// What a dialogue needs next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Need {
    /// A question from the asker: tell it with [`Dialogue::ask`].
    Question,
    /// The answer to this question: tell it with [`Dialogue::answer`].
    Answer(String),
    /// A caption from the summariser; the dialogue is over.
    Summary,
}

/// A dialogue about one view.
#[derive(Debug, Clone)]
pub struct Dialogue {
    mode: Mode,
    pending: Option<String>,
    exhausted: bool,
    transcript: Vec<Exchange>,
}

impl Dialogue {
    /// A dialogue that has not begun.
    #[must_use]
    pub fn new(mode: Mode) -> Self {
        let first = match mode {
            Mode::Dialogue { .. } | Mode::Single => OPENING,
            Mode::Fixed => FIXED_QUERIES[0],
        };
        Self { mode, pending: Some(first.to_owned()), exhausted: false, transcript: Vec::new() }
    }

    /// What it needs next.
    #[must_use]
    pub fn need(&self) -> Need {
        match &self.pending {
            Some(question) => Need::Answer(question.clone()),
            None if self.exhausted => Need::Summary,
            None => Need::Question,
        }
    }

    /// Tells it the asker's question; `None`, an empty or a repeated one ends the asking.
    pub fn ask(&mut self, question: Option<String>) {
        let question = question.map(|question| question.trim().to_owned()).filter(|question| !question.is_empty());
        let is_new =
            |question: &String| !self.transcript.iter().any(|before| before.question.eq_ignore_ascii_case(question));
        self.pending = question.filter(is_new);
        self.exhausted = self.pending.is_none();
    }

    /// Tells it the answer to the question that it needed one for.
    pub fn answer(&mut self, answer: &str) {
        let Some(question) = self.pending.take() else { return };
        self.transcript.push(Exchange::new(question, answer.trim()));
        match self.mode {
            Mode::Dialogue { questions } => self.exhausted = self.transcript.len() > questions,
            Mode::Single => self.exhausted = true,
            Mode::Fixed => {
                self.pending = FIXED_QUERIES.get(self.transcript.len()).map(|query| (*query).to_owned());
                self.exhausted = self.pending.is_none();
            }
        }
    }

    /// What was said so far.
    #[must_use]
    pub fn transcript(&self) -> &[Exchange] {
        &self.transcript
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(mode: Mode, mut ask: impl FnMut(usize) -> Option<String>) -> Vec<String> {
        let mut dialogue = Dialogue::new(mode);
        for step in 0..100 {
            match dialogue.need() {
                Need::Question => dialogue.ask(ask(step)),
                Need::Answer(_) => dialogue.answer(" I am not sure. "),
                Need::Summary => {
                    return dialogue.transcript().iter().map(|exchange| exchange.question.clone()).collect();
                }
            }
        }
        panic!("the dialogue does not end");
    }

    #[test]
    fn it_opens_asks_so_many_questions_and_ends() {
        let asked = run(Mode::Dialogue { questions: 3 }, |step| Some(format!("Question {step}?")));
        assert_eq!(asked.len(), 4);
        assert_eq!(asked[0], OPENING);
    }

    #[test]
    fn repeated_empty_and_missing_questions_end_it() {
        for last in [None, Some(String::new()), Some("describe in detail what you see.".to_owned())] {
            assert_eq!(run(Mode::Dialogue { questions: 9 }, |_| last.clone()).len(), 1);
        }
    }

    #[test]
    fn the_fixed_variant_asks_its_two_queries_and_no_asker() {
        assert_eq!(run(Mode::Fixed, |_| panic!("no asker has a say here")), FIXED_QUERIES);
    }
}
