//! The dialogue about one view: questions, answers, a caption.
//!
//! A state machine without input or output of its own: [`Dialogue::need`] reports what has to come next, and the caller
//! supplies it. So the same code runs with a model, a recording or a test.

mod answers;
mod clean;
mod faults;
mod news;
mod questions;
mod summary;
mod trouble;

use wayword_core::{Caption, Exchange, ModelError, Trouble};
use wayword_language::text::words;

pub(crate) use answers::{Asked, Wanted, asked, colour_at, room, sightings};
pub use faults::{CaptionFault, caption_faults};
pub use questions::RulesAsker;
pub use summary::RulesSummariser;
pub(crate) use summary::caption_of;
pub(crate) use trouble::{refuses, rephrased};

/// The fixed first request of a dialogue (ChatCaptioner opens every dialogue with a request for a description).
pub const OPENING: &str = "Describe in detail what you see.";

/// The two fixed queries of the variant without a dialogue (arXiv 2403.11487, ablation "BLIP alone").
pub const FIXED_QUERIES: [&str; 2] = ["What objects are there?", "Which room is this?"];

/// Most questions after the opening, by default (ChatCaptioner asks nine).
pub const QUESTIONS: usize = 9;

/// Chooses the questions.
pub trait Asker: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// The next question after this transcript, or `None` if there is none left to ask.
    ///
    /// # Errors
    /// When the model that chooses it fails.
    fn next_question(&self, transcript: &[Exchange]) -> Result<Option<String>, ModelError>;
}

/// Sums a dialogue up.
pub trait Summariser: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// A caption of the answers that `answerer` gave. It names no object that an answer denied.
    ///
    /// # Errors
    /// When the model that writes it fails.
    fn sum_up(&self, transcript: &[Exchange], answerer: &str) -> Result<Caption, ModelError>;

    /// Condenses captions of one place, each with its direction in words ("north"), into one description of fewer than
    /// `fewer_words_than` words. The result names who made it, where that is not this summariser.
    ///
    /// # Errors
    /// When the model that writes it fails.
    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<Condensed, ModelError>;
}

/// Captions of several looks as one description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condensed {
    /// The description.
    pub text: String,
    /// The name of who made it, if the summariser failed and another took over.
    pub by: Option<String>,
}

/// How a view is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// An opening, then the asker's questions, up to a number.
    Dialogue {
        /// Most questions after the opening.
        questions: usize,
    },
    /// [`FIXED_QUERIES`] and no dialogue.
    Fixed,
    /// [`OPENING`] alone: its answer is the caption.
    Single,
    /// One request for JSON ([`crate::seeing`]), then questions about what it leaves open, up to a number.
    Structured {
        /// Most questions after it.
        questions: usize,
    },
}

/// The next thing that a dialogue needs from its caller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Need {
    /// A question from the asker: give it to [`Dialogue::ask`].
    Question,
    /// The answer to this question: give it to [`Dialogue::answer`].
    Answer(String),
    /// A caption from the summariser; the dialogue is over.
    Summary,
}

/// A dialogue about one view.
#[derive(Debug, Clone)]
pub struct Dialogue {
    mode: Mode,
    pending: Option<Pending>,
    exhausted: bool,
    /// Number of consecutive rounds without news.
    stale: usize,
    transcript: Vec<Exchange>,
}

/// A question that waits for its answer.
#[derive(Debug, Clone)]
struct Pending {
    question: String,
    /// Why the first answer was unusable, if there was one.
    trouble: Option<Trouble>,
}

/// Whether a question is the one that asks for a description, the first time or again.
pub(crate) fn is_opening(question: &str) -> bool {
    question == OPENING || question == trouble::rephrased(OPENING)
}

/// The asking ends after this many consecutive rounds without news.
const STALE_ROUNDS: usize = 2;

impl Dialogue {
    /// A dialogue that has not begun.
    #[must_use]
    pub fn new(mode: Mode) -> Self {
        let first = match mode {
            Mode::Dialogue { .. } | Mode::Single | Mode::Structured { .. } => OPENING,
            Mode::Fixed => FIXED_QUERIES[0],
        };
        let mut dialogue = Self { mode, pending: None, exhausted: false, stale: 0, transcript: Vec::new() };
        dialogue.put(Some(first.to_owned()));
        dialogue
    }

    /// The next thing that the dialogue needs.
    #[must_use]
    pub fn need(&self) -> Need {
        match &self.pending {
            Some(Pending { question, trouble: None }) => Need::Answer(question.clone()),
            Some(Pending { question, trouble: Some(_) }) => Need::Answer(trouble::rephrased(question)),
            None if self.exhausted => Need::Summary,
            None => Need::Question,
        }
    }

    /// Takes the asker's question, even with text that a model put around it. The asking ends on `None`, on a text
    /// without a question, and on a question with the same words as an earlier one.
    pub fn ask(&mut self, question: Option<String>) {
        let question = question.and_then(|question| clean::question(&question));
        let is_new = |question: &String| {
            !self.transcript.iter().any(|before| same_words(&before.question) == same_words(question))
        };
        let question = question.filter(is_new);
        self.put(question);
    }

    /// Takes the answer to the pending question. If the answer is unusable (empty, a refusal, an echo), the dialogue
    /// asks the same question once more in other words.
    pub fn answer(&mut self, answer: &str) {
        let Some(Pending { question, trouble }) = self.pending.take() else { return };
        let asked = if trouble.is_some() { trouble::rephrased(&question) } else { question.clone() };
        let answer = clean::answer(answer, &asked);
        let found = trouble::trouble(&asked, &answer, &self.transcript)
            .or_else(|| trouble::trouble(&question, &answer, &self.transcript));
        if found.is_some() && trouble.is_none() {
            self.pending = Some(Pending { question, trouble: found });
            return;
        }
        let answer = if found.is_some() { String::new() } else { answer };
        self.transcript.push(Exchange { question, answer, trouble });
        self.go_on();
    }

    /// Decides whether the dialogue goes on after an exchange.
    fn go_on(&mut self) {
        match self.mode {
            Mode::Dialogue { questions } => {
                // The first two exchanges do not count: the opening has no exchange before it, and the first question
                // is often a formality (which room it is).
                let counts = self.transcript.len() > 2 && !news::is_new(&self.transcript);
                self.stale = if counts { self.stale + 1 } else { 0 };
                self.exhausted = self.transcript.len() > questions || self.stale >= STALE_ROUNDS;
            }
            // A structured request is no dialogue.
            Mode::Single | Mode::Structured { .. } => self.exhausted = true,
            Mode::Fixed => self.put(FIXED_QUERIES.get(self.transcript.len()).map(|query| (*query).to_owned())),
        }
    }

    /// Sets the question that waits for an answer; `None` ends the asking.
    fn put(&mut self, question: Option<String>) {
        self.exhausted = question.is_none();
        self.pending = question.map(|question| Pending { question, trouble: None });
    }

    /// The questions and answers so far.
    #[must_use]
    pub fn transcript(&self) -> &[Exchange] {
        &self.transcript
    }
}

/// The words of a question without articles. Questions with the same words are the same question.
fn same_words(question: &str) -> Vec<String> {
    let is_article = |word: &String| matches!(word.as_str(), "a" | "an" | "the" | "any" | "some");
    words(question).into_iter().filter(|word| !is_article(word)).collect()
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

    #[test]
    fn the_same_question_in_another_case_and_with_another_article_ends_it() {
        let again = ["Is there a lamp?", "is there any LAMP"];
        assert_eq!(run(Mode::Dialogue { questions: 9 }, |step| again.get(step / 2).map(|q| (*q).to_owned())).len(), 2);
    }

    /// A dialogue after its opening and one question, to which these answers are given until it takes one.
    fn asked_twice(answers: &[&str]) -> (Vec<String>, Exchange) {
        let mut dialogue = Dialogue::new(Mode::Dialogue { questions: 9 });
        dialogue.answer("There is a large bed beside a tall window.");
        dialogue.ask(Some("What colour is the bed?".to_owned()));
        let mut asked = Vec::new();
        for answer in answers {
            match dialogue.need() {
                Need::Answer(question) => asked.push(question),
                need => panic!("{need:?}"),
            }
            dialogue.answer(answer);
        }
        assert_eq!(dialogue.need(), Need::Question);
        (asked, dialogue.transcript()[1].clone())
    }

    #[test]
    fn an_answer_that_cannot_be_used_is_asked_for_once_more_in_other_words() {
        for (bad, trouble) in [
            ("  ", Trouble::Empty),
            ("What colour is the bed?", Trouble::Echo),
            ("the bed the bed the bed the bed", Trouble::Loop),
            ("I'm sorry, but I can't assist with that.", Trouble::Refusal),
            ("There is a large bed beside a tall window.", Trouble::Repeat),
        ] {
            let (asked, exchange) = asked_twice(&[bad, "It is red."]);
            assert_eq!(
                asked,
                ["What colour is the bed?", "Look again and answer in one short sentence: What colour is the bed?"]
            );
            assert_eq!(
                exchange,
                Exchange {
                    question: "What colour is the bed?".into(),
                    answer: "It is red.".into(),
                    trouble: Some(trouble)
                }
            );
            let (_, exchange) = asked_twice(&[bad, bad]);
            assert_eq!((exchange.answer.as_str(), exchange.trouble), ("", Some(trouble)));
        }
        assert_eq!(asked_twice(&["It is red."]).1.trouble, None);
    }

    #[test]
    fn additions_of_models_to_questions_and_answers_are_removed() {
        let mut dialogue = Dialogue::new(Mode::Dialogue { questions: 1 });
        dialogue.answer("A bed.\nQuestion: Is there a lamp? Answer: Yes.");
        dialogue.ask(Some("Sure! Question: \"Is there a rug?\" Answer: no".to_owned()));
        assert_eq!(dialogue.need(), Need::Answer("Is there a rug?".to_owned()));
        dialogue.answer("Question: Is there a rug? Answer: No.");
        let said: Vec<_> = dialogue.transcript().iter().map(|exchange| exchange.answer.as_str()).collect();
        assert_eq!(said, ["A bed.", "No."]);
    }

    #[test]
    fn two_rounds_without_news_end_it() {
        let talk = |answers: &[&str]| {
            let mut dialogue = Dialogue::new(Mode::Dialogue { questions: 9 });
            dialogue.answer("There is a bed.");
            let mut asked = 0;
            while let Need::Question = dialogue.need() {
                dialogue.ask(Some(format!("What else can be told of the bed, part {asked}?")));
                dialogue.answer(answers[asked % answers.len()]);
                asked += 1;
            }
            asked
        };
        assert_eq!(talk(&["It is there.", "It is a bed.", "There is a bed.", "I see a bed."]), 3);
        let news = ["Red", "Wood", "Soft", "Old", "Wide", "Clean", "High", "Square", "Royal"];
        assert_eq!(talk(&news), 9);
    }

    #[test]
    fn single_mode_asks_for_a_description_only() {
        assert_eq!(run(Mode::Single, |_| panic!("no asker has a say here")), [OPENING]);
    }
}
