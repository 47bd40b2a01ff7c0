//! Recognises unusable answers (empty, refusal, echo, loop, repeat), and words the question anew.

use wayword_core::{AnswerTrouble, DialogueExchange};
use wayword_language::{
    chatter::{BARE_REFUSAL, REFUSING, UNHELPING},
    text::split_words,
};

/// Longest phrase of an answer that repeats itself, words. A repetition of a longer phrase is not looked for.
const MAX_LOOP_PHRASE_WORDS: usize = 8;
/// Least number of times in a row that such an answer has the phrase.
const MIN_LOOP_REPETITIONS: usize = 3;
/// Least number of words of an answer for which a repetition counts as a fault: a shorter one may well fit two
/// questions ("It is made of wood").
const MIN_REPEATED_WORDS: usize = 6;

/// How many words at the beginning of an answer are examined for a refusal.
const MAX_REFUSAL_WORDS: usize = 40;

/// The reason why an answer is unusable; `None` if it is usable.
pub(super) fn answer_trouble(question: &str, answer: &str, before: &[DialogueExchange]) -> Option<AnswerTrouble> {
    let words = split_words(&answer.replace('’', "'"));
    if words.is_empty() {
        Some(AnswerTrouble::Empty)
    } else if is_refusal(&words) {
        Some(AnswerTrouble::Refusal)
    } else if is_echo(&split_words(question), &words) {
        Some(AnswerTrouble::Echo)
    } else if is_loop(&words) {
        Some(AnswerTrouble::Loop)
    } else {
        is_repeat(question, &words, before).then_some(AnswerTrouble::Repeat)
    }
}

/// Whether a model refuses to look at the picture. "Sorry, I can't see a bed" is an answer and no refusal.
pub(crate) fn refuses_to_look(answer: &str) -> bool {
    is_refusal(&split_words(&answer.replace('’', "'")))
}

/// Whether an answer begins like a refusal and declines, or consists of words of refusal only.
fn is_refusal(words: &[String]) -> bool {
    let begins = REFUSING.iter().any(|phrase| phrase_begins_at(words, 0, phrase));
    let beginning = &words[..words.len().min(MAX_REFUSAL_WORDS)];
    let declines = |at| UNHELPING.iter().any(|phrase| phrase_begins_at(beginning, at, phrase));
    let is_bare = || words.iter().all(|word| BARE_REFUSAL.contains(&word.as_str()));
    begins && ((0..beginning.len()).any(declines) || is_bare())
}

/// Whether a phrase begins at this word.
fn phrase_begins_at(words: &[String], at: usize, phrase: &[&str]) -> bool {
    words.len() >= at + phrase.len() && words[at..].iter().zip(phrase).all(|(word, wanted)| word == wanted)
}

/// The question in other words, for a second try.
pub(crate) fn rephrase_question(question: &str) -> String {
    if question == super::OPENING_REQUEST {
        return "Look at the picture again and say in one sentence which room and which objects it shows.".to_owned();
    }
    format!("Look again and answer in one short sentence: {question}")
}

/// Whether the answer only repeats the question, once or more, or at least two thirds of its words in a row.
fn is_echo(asked: &[String], answer: &[String]) -> bool {
    if asked.is_empty() {
        return false;
    }
    let is_again =
        answer.len() >= asked.len() && answer.iter().zip(asked.iter().cycle()).all(|(answer, asked)| answer == asked);
    let is_part = answer.len() >= 3
        && 3 * answer.len() >= 2 * asked.len()
        && asked.windows(answer.len()).any(|run| run == answer);
    is_again || is_part
}

/// Whether a run of up to eight words, repeated at least three times in a row, makes up most of the answer.
fn is_loop(answer: &[String]) -> bool {
    (1..=MAX_LOOP_PHRASE_WORDS.min(answer.len() / MIN_LOOP_REPETITIONS)).any(|length| {
        let mut longest = 0;
        let mut run = 0;
        for at in length..answer.len() {
            run = if answer[at] == answer[at - length] { run + 1 } else { 0 };
            longest = longest.max(run);
        }
        let words = longest + length;
        words >= length * MIN_LOOP_REPETITIONS && longest > 0 && 2 * words > answer.len()
    })
}

/// Whether the answer is long enough, and word for word the answer to an earlier and different question.
fn is_repeat(question: &str, answer: &[String], before: &[DialogueExchange]) -> bool {
    // A short "I am not sure" may come again.
    let is_unsure = answer.len() <= 8 && answer.windows(2).any(|pair| pair[0] == "not" && pair[1] == "sure");
    answer.len() >= MIN_REPEATED_WORDS
        && !is_unsure
        && before.iter().any(|exchange| {
            split_words(&exchange.question) != split_words(question) && split_words(&exchange.answer) == answer
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ASKED: &str = "What colour is the sofa in the room?";

    #[test]
    fn answers_that_cannot_be_used_are_recognised() {
        let before = [DialogueExchange::new("What is on the left?", "There is a tall lamp on the left.")];
        let of = |answer: &str| answer_trouble(ASKED, answer, &before);
        for (answer, wanted) in [
            ("", Some(AnswerTrouble::Empty)),
            (" ... ", Some(AnswerTrouble::Empty)),
            ("what colour is the sofa in the room", Some(AnswerTrouble::Echo)),
            ("What colour is the sofa in the room? What colour is the sofa in the room?", Some(AnswerTrouble::Echo)),
            ("the sofa in the room colour is the sofa", None),
            ("is the sofa in the room", Some(AnswerTrouble::Echo)),
            ("the sofa", None),
            ("a chair a chair a chair a chair", Some(AnswerTrouble::Loop)),
            ("There is a bed, and a lamp, and a lamp, and a lamp, and a lamp, and a lamp", Some(AnswerTrouble::Loop)),
            ("red red red", Some(AnswerTrouble::Loop)),
            ("The sofa is very very red.", None),
            ("a chair, a table, a lamp and a rug", None),
            ("there is a tall lamp on the left", Some(AnswerTrouble::Repeat)),
            ("It is red.", None),
            ("I'm sorry, but I can't help with that.", Some(AnswerTrouble::Refusal)),
            ("I’m sorry, I cannot assist with identifying what this shows.", Some(AnswerTrouble::Refusal)),
            ("As an AI, I do not have the ability to view images.", Some(AnswerTrouble::Refusal)),
            ("I'm sorry.", Some(AnswerTrouble::Refusal)),
            ("I'm sorry, but I can't.", Some(AnswerTrouble::Refusal)),
            ("Sorry, I can't see a sofa anywhere in this room.", None),
            ("I am not able to tell the colour of the sofa from here.", None),
            ("I don't have a clear look at the sofa, but it seems red.", None),
            ("A sorry-looking red sofa.", None),
            ("Sorry, no.", None),
            ("I can't see one.", None),
            ("I cannot tell.", None),
        ] {
            assert_eq!(of(answer), wanted, "{answer}");
        }
    }

    #[test]
    fn short_answers_may_come_again() {
        let before = [
            DialogueExchange::new("Is there a bed?", "Yes, in the middle."),
            DialogueExchange::new("Is there a rug?", "I am not sure about that, sorry."),
        ];
        assert_eq!(answer_trouble(ASKED, "Yes, in the middle.", &before), None);
        assert_eq!(answer_trouble(ASKED, "I am not sure about that, sorry.", &before), None);
    }

    proptest! {
        #[test]
        fn any_answer_is_judged(question in "\\PC{0,60}", answer in "(\\PC| ){0,200}") {
            let empty = !answer.chars().any(char::is_alphanumeric);
            prop_assert_eq!(answer_trouble(&question, &answer, &[]) == Some(AnswerTrouble::Empty), empty);
        }

        #[test]
        fn a_phrase_repeated_three_times_is_a_loop(phrase in "[a-z]{1,5}( [a-z]{1,5}){0,7}", times in 3_usize..9) {
            let said = vec![phrase; times].join(", ");
            prop_assert_eq!(answer_trouble("Which one?", &said, &[]), Some(AnswerTrouble::Loop));
        }
    }
}
