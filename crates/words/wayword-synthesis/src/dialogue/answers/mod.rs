//! Turns the transcript of a dialogue into sightings, one for each thing, and the name of the room.
//!
//! [`question`] finds out what a question asks for, and [`exchange`] interprets one answer to it. Both build on
//! [`find_mentions`] (the things named in free text), [`polarity`] (affirmed or denied) and [`phrases`] (places,
//! colours, names).

mod exchange;
mod mentions;
mod phrases;
mod polarity;
mod question;
#[cfg(test)]
mod tests;

use exchange::{parse_enumeration, read_exchange};
use polarity::{AnswerPolarity, is_unsure, polarity_of};
use std::collections::BTreeSet;
use wayword_core::{DialogueExchange, ObjectSighting, WitnessAnswer};
use wayword_language::{
    answers::TELLING,
    lexicon::{is_thing, kinds_of, normalise_name},
    text::split_words,
};

pub(super) use mentions::{AnswerMention, find_mentions};
pub(crate) use {
    phrases::{QuestionThing, colour_at},
    question::{QuestionSubject, read_question},
};

/// A sighting from one answer, and whether the question was about that very thing.
#[derive(Clone)]
pub(super) struct AnswerSighting {
    pub(super) sighting: ObjectSighting,
    /// Whether the question asked for this thing; `false` where the answer mentions the thing in passing.
    pub(super) direct: bool,
}

/// All sightings of a dialogue, one for each thing, in the order in which the things were first mentioned.
///
/// A denial outweighs every other answer about a thing, earlier or later, because leaving out a real object harms a
/// robot less than sending it to a hallucinated one. Between seen and not sure, the later answer to a direct question
/// about the thing decides; doubt in passing changes no sighting.
pub(crate) fn dialogue_sightings(transcript: &[DialogueExchange], by: &str) -> Vec<ObjectSighting> {
    let mut joined: Vec<ObjectSighting> = Vec::new();
    for exchange in transcript {
        let earlier = joined.len();
        for answered in read_exchange(exchange, by) {
            if answered.sighting.witness == WitnessAnswer::Denied {
                add_denial(&mut joined, answered.sighting);
            } else {
                add_sighting(&mut joined, earlier, answered);
            }
        }
    }
    joined
}

/// Whether a denial covers a thing: "no chair" covers a dining chair, but "no dining chair" and "no red chair" do not
/// cover a plain chair.
pub(super) fn denial_covers(denial: &ObjectSighting, name: &str, colour: Option<&str>) -> bool {
    if denial.witness != WitnessAnswer::Denied {
        return false;
    }
    let (denied, name) = (normalise_name(&denial.name), normalise_name(name));
    if denied == name || colour.is_some_and(|colour| denied == normalise_name(&format!("{colour} {name}"))) {
        return true;
    }
    let general = kinds_of(&denied);
    // A name with more words than the lexicon's entry means a special kind of the thing.
    let is_one_of_many = !is_thing(&denied) && general[0] != denied;
    !is_one_of_many && kinds_of(&name).contains(&general[0])
}

/// Whether two sightings may be of one place; a sighting without a place agrees with all.
fn places_agree(a: &ObjectSighting, b: &ObjectSighting) -> bool {
    a.place == b.place || a.place.is_none() || b.place.is_none()
}

/// Denies the things that a denial covers, and adds the denial itself unless an earlier sighting
/// of the same kind shows it already.
fn add_denial(joined: &mut Vec<ObjectSighting>, denial: ObjectSighting) {
    let mut is_covered = false;
    for before in joined.iter_mut() {
        let is_elsewhere = before.witness != WitnessAnswer::Denied && !places_agree(before, &denial);
        if denial_covers(&denial, &before.name, before.colour.as_deref()) {
            // "No chair on the left" does not touch a chair on the right, and needs no entry of its own.
            is_covered |=
                is_elsewhere || kinds_of(&before.name)[0] == kinds_of(&denial.name)[0] || before.name == denial.name;
            if !is_elsewhere {
                before.witness = WitnessAnswer::Denied;
            }
        }
    }
    if !is_covered {
        joined.push(denial);
    }
}

/// Joins a sighting with the one of the same thing, or adds it. Only the first `earlier` sightings, those of earlier
/// exchanges, may name the same thing more precisely ("dining chair" for "chair").
fn add_sighting(joined: &mut Vec<ObjectSighting>, earlier: usize, answered: AnswerSighting) {
    let AnswerSighting { mut sighting, direct } = answered;
    let colours_agree = |before: &ObjectSighting| {
        before.colour.is_none() || sighting.colour.is_none() || before.colour == sighting.colour
    };
    let fits = |before: &ObjectSighting| places_agree(before, &sighting) && colours_agree(before);
    let exact = joined.iter().position(|before| before.name == sighting.name && fits(before));
    let of_kind = || {
        let kind = kinds_of(&sighting.name);
        joined[..earlier].iter().position(|before| fits(before) && kinds_of(&before.name).contains(&kind[0]))
    };
    if let Some(at) = exact.or_else(of_kind) {
        let before = &mut joined[at];
        before.place = before.place.or(sighting.place);
        before.colour = before.colour.take().or(sighting.colour);
        before.several |= sighting.several;
        before.witness = match (before.witness, sighting.witness) {
            (WitnessAnswer::Denied, _) => WitnessAnswer::Denied,
            (WitnessAnswer::Seen, WitnessAnswer::Unsure) if direct => WitnessAnswer::Unsure,
            (WitnessAnswer::Unsure, later) => later,
            (before, _) => before,
        };
        return;
    }
    let is_denied = |denial: &ObjectSighting| {
        places_agree(denial, &sighting) && denial_covers(denial, &sighting.name, sighting.colour.as_deref())
    };
    if joined.iter().any(is_denied) {
        sighting.witness = WitnessAnswer::Denied;
    }
    joined.push(sighting);
}

/// Longest name of a room, bytes; a longer text names none.
const MAX_ROOM_NAME_BYTES: usize = 40;

/// The name of the room: from the answer to a question for it, or else from the first description.
pub(crate) fn dialogue_room(transcript: &[DialogueExchange]) -> Option<String> {
    let asked_for = transcript.iter().find_map(|exchange| match read_question(&exchange.question) {
        QuestionSubject::Room => room_from_answer(&exchange.answer),
        QuestionSubject::IsRoom(name) if polarity_of(&exchange.answer) == AnswerPolarity::Yes => Some(name),
        QuestionSubject::IsRoom(_) => first_named_room(&exchange.answer, true),
        _ => None,
    });
    let described = || {
        let opening =
            transcript.first().filter(|first| read_question(&first.question) == QuestionSubject::Other(None))?;
        parse_enumeration(&opening.answer).is_none().then(|| first_named_room(&opening.answer, false)).flatten()
    };
    asked_for.or_else(described)
}

/// "It is an office." names a room in any words; of a longer answer, the first room that the lexicon knows is taken.
fn room_from_answer(answer: &str) -> Option<String> {
    let said = answer.trim().trim_end_matches('.').to_lowercase();
    let words = split_words(&said);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    if is_unsure(&words) {
        return None;
    }
    let leads = ["it is ", "this is ", "a ", "an ", "the ", "some "];
    let bare = leads.iter().fold(said.as_str(), |rest, lead| rest.strip_prefix(lead).unwrap_or(rest));
    let short = |name: &str| !name.is_empty() && name.len() <= MAX_ROOM_NAME_BYTES && !is_sentence(name);
    let exact = said.starts_with("it is ") && short(bare);
    if exact {
        return Some(bare.to_owned());
    }
    first_named_room(answer, true).or_else(|| (short(bare) && words.len() <= 4).then(|| bare.to_owned()))
}

/// Whether a text is a sentence and not just a name.
fn is_sentence(said: &str) -> bool {
    said.contains([',', '?', '!', ';', '\n'])
        || said.contains(". ")
        || split_words(said).iter().any(|word| TELLING.contains(&word.as_str()))
}

/// The first room that a text names as the one in view. `ambiguous`: whether names count that can also be a thing's
/// ("stairs").
fn first_named_room(text: &str, ambiguous: bool) -> Option<String> {
    const ELSEWHERE_PREPOSITIONS: [&str; 10] =
        ["to", "into", "through", "toward", "towards", "from", "beyond", "adjoining", "next", "onto"];
    let found = find_mentions(text, &BTreeSet::new()).into_iter().find(|mention| {
        mention.is_room
            && (ambiguous || !mention.is_thing)
            && mention.witness != WitnessAnswer::Denied
            && !mention.is_beyond
            && !ELSEWHERE_PREPOSITIONS.contains(&mention.before.as_str())
    });
    found.map(|mention| mention.name).filter(|name| name.len() <= MAX_ROOM_NAME_BYTES)
}
