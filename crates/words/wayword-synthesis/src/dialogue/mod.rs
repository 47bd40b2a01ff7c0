//! The dialogue about one view: questions, answers, a caption.
//!
//! A state machine without input or output of its own: [`Dialogue::next_need`] reports what has to come next, and the
//! caller supplies it. So the same code runs with a model, a recording or a test.

mod answers;
mod extract;
mod faults;
mod news;
mod questions;
mod roles;
mod summary;
mod trouble;

use wayword_core::{AnswerTrouble, DialogueExchange};
use wayword_language::text::split_words;

pub(crate) use answers::{QuestionSubject, QuestionThing, colour_at, dialogue_room, dialogue_sightings, read_question};
pub use faults::{CaptionFault, caption_faults};
pub use questions::RulesAsker;
pub use roles::{CaptionSummariser, CondensedCaption, ObservationRoles, QuestionAsker};
pub use summary::RulesSummariser;
pub(crate) use summary::caption_from_sightings;
pub(crate) use trouble::{refuses_to_look, rephrase_question};

/// The fixed first request of a dialogue (ChatCaptioner opens every dialogue with a request for a description).
pub const OPENING_REQUEST: &str = "Describe in detail what you see.";

/// The two fixed queries of the variant without a dialogue (arXiv 2403.11487, ablation "BLIP alone").
pub const FIXED_QUERIES: [&str; 2] = ["What objects are there?", "Which room is this?"];

/// Most questions after the opening, by default (ChatCaptioner asks nine).
pub const DEFAULT_MAX_QUESTIONS: usize = 9;

/// How a view is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DialogueMode {
    /// An opening, then the asker's questions, up to a number.
    Dialogue {
        /// Most questions after the opening.
        questions: usize,
    },
    /// [`FIXED_QUERIES`] and no dialogue.
    Fixed,
    /// [`OPENING_REQUEST`] alone: its answer is the caption.
    Single,
    /// One request for JSON ([`crate::seeing`]), then questions about what it leaves open, up to a number.
    Structured {
        /// Most questions after that request.
        questions: usize,
    },
}

/// The next thing that a dialogue needs from its caller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DialogueNeed {
    /// A question from the asker: give it to [`Dialogue::take_question`].
    Question,
    /// The answer to this question: give it to [`Dialogue::take_answer`].
    Answer(String),
    /// A caption from the summariser; the dialogue is over.
    Summary,
}

/// A dialogue about one view.
#[derive(Debug, Clone)]
pub struct Dialogue {
    mode: DialogueMode,
    /// The question that waits for its answer, if there is one.
    pending: Option<PendingQuestion>,
    /// Whether no question is left to ask, so that only the caption is missing.
    exhausted: bool,
    /// Number of consecutive rounds without news, that is, without anything that earlier answers lack (`news.rs`).
    stale: usize,
    /// The questions and answers so far.
    transcript: Vec<DialogueExchange>,
}

/// A question that waits for its answer.
#[derive(Debug, Clone)]
struct PendingQuestion {
    question: String,
    /// Why the first answer was unusable, if there was one.
    trouble: Option<AnswerTrouble>,
}

/// Whether a question is the one that asks for a description, the first time or again.
pub(crate) fn is_opening(question: &str) -> bool {
    question == OPENING_REQUEST || question == trouble::rephrase_question(OPENING_REQUEST)
}

/// The asking ends after this many consecutive rounds without news.
const STALE_ROUNDS: usize = 2;

impl Dialogue {
    /// A dialogue that has not begun.
    #[must_use]
    pub fn new(mode: DialogueMode) -> Self {
        let first = match mode {
            DialogueMode::Dialogue { .. } | DialogueMode::Single | DialogueMode::Structured { .. } => OPENING_REQUEST,
            DialogueMode::Fixed => FIXED_QUERIES[0],
        };
        let mut dialogue = Self { mode, pending: None, exhausted: false, stale: 0, transcript: Vec::new() };
        dialogue.set_pending(Some(first.to_owned()));
        dialogue
    }

    /// The next thing that the dialogue needs.
    #[must_use]
    pub fn next_need(&self) -> DialogueNeed {
        match &self.pending {
            Some(PendingQuestion { question, trouble: None }) => DialogueNeed::Answer(question.clone()),
            Some(PendingQuestion { question, trouble: Some(_) }) => {
                DialogueNeed::Answer(trouble::rephrase_question(question))
            }
            None if self.exhausted => DialogueNeed::Summary,
            None => DialogueNeed::Question,
        }
    }

    /// Takes the asker's question, even with text that a model put around it. The asking ends on `None`, on a text
    /// without a question, and on a question with the same words as an earlier one.
    pub fn take_question(&mut self, question: Option<String>) {
        let question = question.and_then(|question| extract::extract_question(&question));
        let is_new = |question: &String| {
            !self
                .transcript
                .iter()
                .any(|before| words_without_articles(&before.question) == words_without_articles(question))
        };
        let question = question.filter(is_new);
        self.set_pending(question);
    }

    /// Takes the answer to the pending question. If the answer is unusable (empty, a refusal, an echo), the dialogue
    /// asks the same question once more in other words.
    pub fn take_answer(&mut self, answer: &str) {
        let Some(PendingQuestion { question, trouble }) = self.pending.take() else { return };
        let asked = if trouble.is_some() { trouble::rephrase_question(&question) } else { question.clone() };
        let answer = extract::extract_answer(answer, &asked);
        let new_trouble = trouble::answer_trouble(&asked, &answer, &self.transcript)
            .or_else(|| trouble::answer_trouble(&question, &answer, &self.transcript));
        if new_trouble.is_some() && trouble.is_none() {
            self.pending = Some(PendingQuestion { question, trouble: new_trouble });
            return;
        }
        let answer = if new_trouble.is_some() { String::new() } else { answer };
        self.transcript.push(DialogueExchange { question, answer, trouble });
        self.go_on();
    }

    /// Decides after an exchange whether the dialogue goes on, and in fixed mode with which query.
    fn go_on(&mut self) {
        match self.mode {
            DialogueMode::Dialogue { questions } => {
                // The first two exchanges do not count: the opening has no exchange before it, and the first question
                // is often a formality (which room it is).
                let counts = self.transcript.len() > 2 && !news::is_new(&self.transcript);
                self.stale = if counts { self.stale + 1 } else { 0 };
                self.exhausted = self.transcript.len() > questions || self.stale >= STALE_ROUNDS;
            }
            // A structured request is no dialogue.
            DialogueMode::Single | DialogueMode::Structured { .. } => self.exhausted = true,
            DialogueMode::Fixed => {
                self.set_pending(FIXED_QUERIES.get(self.transcript.len()).map(|query| (*query).to_owned()));
            }
        }
    }

    /// Sets the question that waits for an answer; `None` ends the asking.
    fn set_pending(&mut self, question: Option<String>) {
        self.exhausted = question.is_none();
        self.pending = question.map(|question| PendingQuestion { question, trouble: None });
    }

    /// The questions and answers so far.
    #[must_use]
    pub fn transcript(&self) -> &[DialogueExchange] {
        &self.transcript
    }
}

/// The words of a question without articles. Questions with the same words are the same question.
fn words_without_articles(question: &str) -> Vec<String> {
    let is_article = |word: &String| matches!(word.as_str(), "a" | "an" | "the" | "any" | "some");
    split_words(question).into_iter().filter(|word| !is_article(word)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(mode: DialogueMode, mut ask: impl FnMut(usize) -> Option<String>) -> Vec<String> {
        let mut dialogue = Dialogue::new(mode);
        for step in 0..100 {
            match dialogue.next_need() {
                DialogueNeed::Question => dialogue.take_question(ask(step)),
                DialogueNeed::Answer(_) => dialogue.take_answer(" I am not sure. "),
                DialogueNeed::Summary => {
                    return dialogue.transcript().iter().map(|exchange| exchange.question.clone()).collect();
                }
            }
        }
        panic!("the dialogue does not end");
    }

    #[test]
    fn it_opens_asks_so_many_questions_and_ends() {
        let asked = run(DialogueMode::Dialogue { questions: 3 }, |step| Some(format!("Question {step}?")));
        assert_eq!(asked.len(), 4);
        assert_eq!(asked[0], OPENING_REQUEST);
    }

    #[test]
    fn repeated_empty_and_missing_questions_end_it() {
        for last in [None, Some(String::new()), Some("describe in detail what you see.".to_owned())] {
            assert_eq!(run(DialogueMode::Dialogue { questions: 9 }, |_| last.clone()).len(), 1);
        }
    }

    #[test]
    fn the_fixed_variant_asks_its_two_queries_and_no_asker() {
        assert_eq!(run(DialogueMode::Fixed, |_| panic!("no asker has a say here")), FIXED_QUERIES);
    }

    #[test]
    fn the_same_question_in_another_case_and_with_another_article_ends_it() {
        let again = ["Is there a lamp?", "is there any LAMP"];
        assert_eq!(
            run(DialogueMode::Dialogue { questions: 9 }, |step| again.get(step / 2).map(|q| (*q).to_owned())).len(),
            2
        );
    }

    /// A dialogue after its opening and one question, to which these answers are given until it takes one.
    fn asked_twice(answers: &[&str]) -> (Vec<String>, DialogueExchange) {
        let mut dialogue = Dialogue::new(DialogueMode::Dialogue { questions: 9 });
        dialogue.take_answer("There is a large bed beside a tall window.");
        dialogue.take_question(Some("What colour is the bed?".to_owned()));
        let mut asked = Vec::new();
        for answer in answers {
            match dialogue.next_need() {
                DialogueNeed::Answer(question) => asked.push(question),
                need => panic!("{need:?}"),
            }
            dialogue.take_answer(answer);
        }
        assert_eq!(dialogue.next_need(), DialogueNeed::Question);
        (asked, dialogue.transcript()[1].clone())
    }

    #[test]
    fn an_answer_that_cannot_be_used_is_asked_for_once_more_in_other_words() {
        for (bad, trouble) in [
            ("  ", AnswerTrouble::Empty),
            ("What colour is the bed?", AnswerTrouble::Echo),
            ("the bed the bed the bed the bed", AnswerTrouble::Loop),
            ("I'm sorry, but I can't assist with that.", AnswerTrouble::Refusal),
            ("There is a large bed beside a tall window.", AnswerTrouble::Repeat),
        ] {
            let (asked, exchange) = asked_twice(&[bad, "It is red."]);
            assert_eq!(
                asked,
                ["What colour is the bed?", "Look again and answer in one short sentence: What colour is the bed?"]
            );
            assert_eq!(
                exchange,
                DialogueExchange {
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
        let mut dialogue = Dialogue::new(DialogueMode::Dialogue { questions: 1 });
        dialogue.take_answer("A bed.\nQuestion: Is there a lamp? Answer: Yes.");
        dialogue.take_question(Some("Sure! Question: \"Is there a rug?\" Answer: no".to_owned()));
        assert_eq!(dialogue.next_need(), DialogueNeed::Answer("Is there a rug?".to_owned()));
        dialogue.take_answer("Question: Is there a rug? Answer: No.");
        let said: Vec<_> = dialogue.transcript().iter().map(|exchange| exchange.answer.as_str()).collect();
        assert_eq!(said, ["A bed.", "No."]);
    }

    #[test]
    fn two_rounds_without_news_end_it() {
        let talk = |answers: &[&str]| {
            let mut dialogue = Dialogue::new(DialogueMode::Dialogue { questions: 9 });
            dialogue.take_answer("There is a bed.");
            let mut asked = 0;
            while let DialogueNeed::Question = dialogue.next_need() {
                dialogue.take_question(Some(format!("What else can be told of the bed, part {asked}?")));
                dialogue.take_answer(answers[asked % answers.len()]);
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
        assert_eq!(run(DialogueMode::Single, |_| panic!("no asker has a say here")), [OPENING_REQUEST]);
    }
}
