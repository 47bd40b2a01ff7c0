//! Which room it is.

use super::{
    listed::listed,
    mentions::mentions,
    question::{Asked, asked},
    verdict::{Verdict, is_unsure, verdict},
};
use std::collections::BTreeSet;
use wayword_core::{Exchange, Witness};
use wayword_language::text::words;

/// Longest name of a room, bytes.
const MOST_BYTES: usize = 40;

/// The room that was told: to a question for it, else in the first description.
pub(in crate::dialogue) fn room(transcript: &[Exchange]) -> Option<String> {
    let asked_for = transcript.iter().find_map(|exchange| match asked(&exchange.question) {
        Asked::Room => answered(&exchange.answer),
        Asked::IsRoom(name) if verdict(&exchange.answer) == Verdict::Yes => Some(name),
        Asked::IsRoom(_) => first_named(&exchange.answer, true),
        _ => None,
    });
    let described = || {
        let opening = transcript.first().filter(|first| asked(&first.question) == Asked::Other(None))?;
        listed(&opening.answer, "").is_none().then(|| first_named(&opening.answer, false)).flatten()
    };
    asked_for.or_else(described)
}

/// "It is an office." gives any name; longer answers give the first room that the lexicon knows.
fn answered(answer: &str) -> Option<String> {
    let said = answer.trim().trim_end_matches('.').to_lowercase();
    let words = words(&said);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    if is_unsure(&words) {
        return None;
    }
    let strip = |said: &str, leads: &[&str]| {
        leads.iter().fold(said.to_owned(), |rest, lead| rest.strip_prefix(lead).map_or(rest.clone(), str::to_owned))
    };
    let bare = strip(&said, &["it is ", "this is ", "a ", "an ", "the ", "some "]);
    let short = |name: &str| !name.is_empty() && name.len() <= MOST_BYTES && !is_sentence(name);
    let exact = said.starts_with("it is ") && short(&bare);
    if exact {
        return Some(bare);
    }
    first_named(answer, true).or_else(|| Some(bare).filter(|bare| short(bare) && words.len() <= 4))
}

/// Whether words say more than a name.
fn is_sentence(said: &str) -> bool {
    const TELLING: [&str; 27] = [
        "with", "and", "or", "not", "there", "because", "is", "it's", "are", "has", "that", "which", "but", "i", "of",
        "in", "likely", "probably", "maybe", "possibly", "yes", "no", "be", "like", "it", "cannot", "can't",
    ];
    said.contains([',', '?', '!', ';', '\n'])
        || said.contains(". ")
        || words(said).iter().any(|word| TELLING.contains(&word.as_str()))
}

/// The first room that a text names as the one it speaks of. `ambiguous`: names that may be a thing's count too ("stairs").
fn first_named(text: &str, ambiguous: bool) -> Option<String> {
    const ELSEWHERE: [&str; 10] =
        ["to", "into", "through", "toward", "towards", "from", "beyond", "adjoining", "next", "onto"];
    let found = mentions(text, &BTreeSet::new()).into_iter().find(|mention| {
        mention.is_room
            && (ambiguous || !mention.is_thing)
            && mention.witness != Witness::Denied
            && !ELSEWHERE.contains(&mention.before.as_str())
    });
    found.map(|mention| mention.name).filter(|name| name.len() <= MOST_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogue::OPENING;

    #[test]
    fn rooms_are_found_in_answers_to_the_question_for_them() {
        for (answer, wanted) in [
            ("It is an office.", Some("office")),
            ("It is an unheard chamber.", Some("unheard chamber")),
            ("kitchen", Some("kitchen")),
            ("A bathroom.", Some("bathroom")),
            ("This is a living room with a sofa and a table.", Some("living room")),
            ("The room appears to be a cozy bedroom.", Some("bedroom")),
            ("It's a hallway leading to a kitchen.", Some("hallway")),
            ("It is not a kitchen but a dining room.", Some("dining room")),
            ("Living Room", Some("living room")),
            ("Observatory.", Some("observatory")),
            ("I am not sure.", None),
            ("It is hard to say, it may be an office.", None),
            ("Yes, there is a lamp on the table and it is lit.", None),
            ("", None),
        ] {
            let told = room(&[Exchange::new("What kind of room is this?", answer)]);
            assert_eq!(told.as_deref(), wanted, "{answer}");
        }
    }

    #[test]
    fn without_a_question_the_first_description_tells_the_room() {
        for (answer, wanted) in [
            ("The picture shows a bedroom with a bed.", Some("bedroom")),
            ("The image depicts a spacious living room. A doorway leads to a kitchen.", Some("living room")),
            ("A door leads to a bathroom.", None),
            ("There is a closet on the left.", None),
            ("There are stairs and a bar.", None),
        ] {
            assert_eq!(room(&[Exchange::new(OPENING, answer)]).as_deref(), wanted, "{answer}");
        }
    }

    #[test]
    fn a_room_that_is_asked_about_is_confirmed_or_corrected() {
        let told = |answer: &str| room(&[Exchange::new("Is this a kitchen?", answer)]);
        assert_eq!(told("Yes.").as_deref(), Some("kitchen"));
        assert_eq!(told("No, it is a laundry room.").as_deref(), Some("laundry room"));
        assert_eq!(told("No."), None);
    }
}
