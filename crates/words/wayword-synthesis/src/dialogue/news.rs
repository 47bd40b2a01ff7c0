//! Decides whether an exchange brings news, that is, new information; a dialogue without news is ended early.

use super::answers::{QuestionSubject, dialogue_room, dialogue_sightings, read_question};
use std::collections::BTreeSet;
use wayword_core::{DialogueExchange, WitnessAnswer};
use wayword_language::{
    answers::EMPTY,
    lexicon::{names_agree, normal_word},
    text::split_words,
};

/// Whether the last exchange of a transcript changes the sightings or the room, settles a doubt, or has a word that
/// neither its question nor any earlier exchange contains.
pub(super) fn is_new(transcript: &[DialogueExchange]) -> bool {
    let Some((last, before)) = transcript.split_last() else { return false };
    if last.answer.is_empty() {
        return false;
    }
    let texts = before.iter().flat_map(|exchange| [&exchange.question, &exchange.answer]).chain([&last.question]);
    let known: BTreeSet<String> = texts.flat_map(|text| split_words(text)).map(|word| normal_word(&word)).collect();
    let has_new_word = || {
        split_words(&last.answer)
            .iter()
            .any(|word| !EMPTY.contains(&word.as_str()) && !known.contains(&normal_word(word)))
    };
    has_new_word()
        || dialogue_sightings(transcript, "") != dialogue_sightings(before, "")
        || dialogue_room(transcript) != dialogue_room(before)
        || settles_a_doubt(last, before)
}

/// Whether the exchange is the first to ask directly for a thing ("Is there really a bed?"), and its answer is sure. A
/// confirmed object is worth knowing even if no sighting changes.
fn settles_a_doubt(last: &DialogueExchange, before: &[DialogueExchange]) -> bool {
    let asked_for = |exchange: &DialogueExchange| match read_question(&exchange.question) {
        QuestionSubject::Presence { wanted, .. } => wanted.into_iter().map(|wanted| wanted.name).collect(),
        _ => Vec::new(),
    };
    let earlier: Vec<String> = before.iter().flat_map(asked_for).collect();
    let sightings = dialogue_sightings(std::slice::from_ref(last), "");
    let answered = |name: &String| {
        sightings.iter().any(|sighting| sighting.witness != WitnessAnswer::Unsure && names_agree(&sighting.name, name))
    };
    asked_for(last).iter().any(|name| answered(name) && !earlier.iter().any(|other| names_agree(other, name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_is_new(answers: &[(&str, &str)]) -> bool {
        is_new(&answers.iter().map(|(question, answer)| DialogueExchange::new(*question, *answer)).collect::<Vec<_>>())
    }

    #[test]
    fn new_words_denials_and_colours_are_news() {
        let opening = ("Describe.", "There is a bed and a red chair.");
        for last in [
            ("Is there a lamp?", "Yes."),
            ("Is there a lamp?", "No."),
            ("Is there a bed?", "No."),
            ("What colour is the bed?", "Red."),
            ("What is the bed made of?", "It is made of wood."),
            ("Is this a bedroom?", "Yes."),
            ("Is there a rug?", "I am not sure."),
        ] {
            assert!(last_is_new(&[opening, last]), "{last:?}");
        }
    }

    #[test]
    fn repeated_information_is_no_news() {
        let opening = ("Describe.", "There is a bed and a red chair.");
        for last in [
            ("What else is there?", "I am not sure."),
            ("What else is there?", "There is a red chair."),
            ("What is the bed made of?", ""),
            ("What is the bed made of?", "It is not clear."),
        ] {
            assert!(!last_is_new(&[opening, last]), "{last:?}");
        }
        assert!(!is_new(&[]));
    }

    #[test]
    fn a_doubt_that_is_settled_is_news_once() {
        let opening = ("Describe.", "There is a bed and a red chair.");
        let doubt = ("Is there really a bed?", "Yes.");
        assert!(last_is_new(&[opening, doubt]));
        assert!(!last_is_new(&[opening, doubt, ("Is the bed you mentioned really there?", "Yes.")]));
    }
}
