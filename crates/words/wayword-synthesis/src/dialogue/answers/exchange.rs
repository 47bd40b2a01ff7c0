//! Interprets one answer in the light of its question: which things are there, where, in which colour, and which are
//! not there.

use super::{
    AnswerSighting,
    mentions::{AnswerMention, find_mentions},
    phrases::{QuestionThing, bare_colour, colour_at, first_colour, place_phrases},
    polarity::{AnswerPolarity, is_unsure, polarity_of},
    question::{QuestionSubject, read_question},
};
use std::{collections::BTreeSet, convert::Infallible, sync::LazyLock};
use wayword_core::{DialogueExchange, ObjectSighting, RecentCache, ViewThird, WitnessAnswer};
use wayword_language::{
    answers::FREE_SPEECH,
    lexicon::{COUNT_WORDS, find_thing, is_thing, names_agree, normalise_name, to_singular, without_article},
};

/// Most exchanges whose sightings are kept. A dialogue is read again after each answer, and answers about several views are alike.
const MAX_KEPT_EXCHANGES: usize = 1024;

/// The sightings of the exchanges that were read last, by question and answer.
static READ_EXCHANGES: LazyLock<RecentCache<[String; 2], Vec<AnswerSighting>>> =
    LazyLock::new(|| RecentCache::new(MAX_KEPT_EXCHANGES));

/// All sightings of an exchange, attributed to `by`.
pub(super) fn read_exchange(exchange: &DialogueExchange, by: &str) -> Vec<AnswerSighting> {
    let key = [exchange.question.clone(), exchange.answer.clone()];
    let Ok(read) = READ_EXCHANGES.get_or_make(key, || Ok::<_, Infallible>(sightings_from_answer(exchange)));
    let mut sightings = Vec::clone(&read);
    for answered in &mut sightings {
        by.clone_into(&mut answered.sighting.by);
    }
    sightings
}

/// The sightings of an answer, without the name of the answerer.
fn sightings_from_answer(exchange: &DialogueExchange) -> Vec<AnswerSighting> {
    let answer = &exchange.answer.replace('’', "'");
    match read_question(&exchange.question) {
        _ if answer.trim().is_empty() => Vec::new(),
        QuestionSubject::Presence { wanted, are_alternatives: or } => read_presence(&wanted, or, answer),
        QuestionSubject::Colour { name, guesses } => read_colour(&name, &guesses, answer),
        QuestionSubject::Number(wanted) => read_number(wanted, answer),
        QuestionSubject::Place(wanted) => read_place(&wanted, answer),
        QuestionSubject::Room | QuestionSubject::IsRoom(_) => things_beside_room(answer),
        QuestionSubject::Other(place) => match parse_enumeration(answer) {
            Some(listed) => listed.into_iter().map(aside_sighting).collect(),
            None => asides_from_mentions(mentioned_things(answer, &BTreeSet::new()), place),
        },
    }
}

/// The things that an answer names. Walls, floors, ceilings and corners are in every room, so they only count if they
/// are in `known`.
fn mentioned_things(answer: &str, known: &BTreeSet<String>) -> Vec<AnswerMention> {
    let is_everywhere = |name: &str| {
        find_thing(name).is_some_and(|thing| matches!(thing.name, "wall" | "floor" | "ceiling" | "corner"))
    };
    let is_of_note = |mention: &AnswerMention| {
        mention.is_thing && (known.contains(&normalise_name(&mention.name)) || !is_everywhere(&mention.name))
    };
    find_mentions(answer, known).into_iter().filter(is_of_note).collect()
}

/// Sightings of things that the question did not ask for. `place` is for mentions without a place of their own.
fn asides_from_mentions(mentions: Vec<AnswerMention>, place: Option<ViewThird>) -> Vec<AnswerSighting> {
    let aside = |AnswerMention { name, witness, place: own_place, colour, several, .. }| {
        aside_sighting(ObjectSighting { place: own_place.or(place), colour, several, ..new_sighting(&name, witness) })
    };
    mentions.into_iter().map(aside).collect()
}

/// A sighting of the thing that the question asks for.
fn direct_sighting(sighting: ObjectSighting) -> AnswerSighting {
    AnswerSighting { sighting, direct: true }
}

/// A sighting of some other thing that the answer mentions.
fn aside_sighting(sighting: ObjectSighting) -> AnswerSighting {
    AnswerSighting { sighting, direct: false }
}

fn new_sighting(name: &str, witness: WitnessAnswer) -> ObjectSighting {
    ObjectSighting::new(name, witness, "")
}

/// The mentions of the thing with this name, and the other mentions.
fn split_by_name(name: &str, mentions: Vec<AnswerMention>) -> (Vec<AnswerMention>, Vec<AnswerMention>) {
    mentions.into_iter().partition(|mention| names_agree(&mention.name, name))
}

/// The answer to "Is there a lamp?" or "Is there a bed or a sofa?". With `or`, the wanted things are alternatives.
fn read_presence(wanted: &[QuestionThing], or: bool, answer: &str) -> Vec<AnswerSighting> {
    let known = wanted.iter().map(|wanted| normalise_name(&wanted.name)).collect();
    let mut rest = mentioned_things(answer, &known);
    let lower = answer.to_lowercase();
    let place = place_phrases(&answer_words(&lower)).first().map(|phrase| phrase.place);
    let polarity = match polarity_of(answer) {
        // A place alone: "On the left."
        AnswerPolarity::Open if rest.is_empty() && place.is_some() => AnswerPolarity::Yes,
        polarity => polarity,
    };
    let both = answer_words(&lower).contains(&"both");
    let mut found = Vec::new();
    for thing in wanted {
        let (own, others) = split_by_name(&thing.name, rest);
        rest = others;
        let witness = presence_witness(&own, polarity, or && !both && wanted.len() > 1, wanted.len() > 1);
        found.extend(witness.map(|witness| direct_sighting(presence_sighting(thing, witness, &own, place))));
    }
    found.extend(asides_from_mentions(rest, None));
    found
}

/// The witness of an answer for one wanted thing; `None` where a yes or no to several things leaves it open. `own` are
/// the mentions of this thing in the answer, and `polarity` is that of the whole answer.
fn presence_witness(
    own: &[AnswerMention],
    polarity: AnswerPolarity,
    or: bool,
    of_several: bool,
) -> Option<WitnessAnswer> {
    let is_mentioned = |witness| own.iter().any(|mention| mention.witness == witness);
    match polarity {
        _ if is_mentioned(WitnessAnswer::Denied) => Some(WitnessAnswer::Denied),
        AnswerPolarity::No if of_several && !or => is_mentioned(WitnessAnswer::Seen).then_some(WitnessAnswer::Seen),
        AnswerPolarity::No => Some(WitnessAnswer::Denied),
        // "Yes, there might be one": the wording about the thing itself counts more than the yes.
        AnswerPolarity::Yes if is_mentioned(WitnessAnswer::Unsure) && !is_mentioned(WitnessAnswer::Seen) => {
            Some(WitnessAnswer::Unsure)
        }
        AnswerPolarity::Yes if !or => Some(WitnessAnswer::Seen),
        AnswerPolarity::Unsure => Some(WitnessAnswer::Unsure),
        _ if is_mentioned(WitnessAnswer::Seen) => Some(WitnessAnswer::Seen),
        AnswerPolarity::Open if !of_several => Some(WitnessAnswer::Unsure),
        _ => None,
    }
}

/// The sighting of a wanted thing. What the answer does not mention of it is taken from the question.
fn presence_sighting(
    wanted: &QuestionThing,
    witness: WitnessAnswer,
    own: &[AnswerMention],
    place: Option<ViewThird>,
) -> ObjectSighting {
    let mention = own.iter().find(|mention| mention.witness == witness);
    match witness {
        WitnessAnswer::Seen => ObjectSighting {
            place: mention.map_or(place, |mention| mention.place).or(wanted.place),
            colour: mention.and_then(|mention| mention.colour.clone()).or_else(|| wanted.colour.clone()),
            several: mention.map_or(wanted.several, |mention| mention.several),
            ..new_sighting(&wanted.name, witness)
        },
        WitnessAnswer::Denied => {
            // "Is there a red chair?" "There is no chair." denies every chair, not only a red one.
            let all = mention.is_some_and(|mention| normalise_name(&mention.name) == normalise_name(&wanted.name));
            let name = wanted.colour.as_ref().filter(|_| !all).map(|colour| format!("{colour} {}", wanted.name));
            ObjectSighting { place: wanted.place, ..new_sighting(&name.unwrap_or(wanted.name.clone()), witness) }
        }
        WitnessAnswer::Unsure => new_sighting(&wanted.name, witness),
    }
}

/// The words of an answer without punctuation marks. An apostrophe belongs to its word.
fn answer_words(answer: &str) -> Vec<&str> {
    answer.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect()
}

/// The answer to "What colour is the lamp?": the question takes the lamp to be there, and the answer may deny it.
fn read_colour(name: &str, guesses: &[String], answer: &str) -> Vec<AnswerSighting> {
    // The form in which `labels` answers, where names may be any words. Shades are left out, because what one model
    // calls light brown another calls brown.
    let exact = answer.strip_prefix("The ").and_then(|rest| rest.strip_prefix(name)?.strip_prefix(" is "));
    if let Some(word) = exact.and_then(|phrase| bare_colour(phrase.trim_end_matches('.'))) {
        let colour = Some(word.to_lowercase());
        return vec![direct_sighting(ObjectSighting { colour, ..new_sighting(name, WitnessAnswer::Seen) })];
    }
    let known = BTreeSet::from([normalise_name(name)]);
    let (own, others) = split_by_name(name, mentioned_things(answer, &known));
    let lower = answer.to_lowercase();
    let said = answer_words(&lower);
    let seen = own.iter().find(|mention| mention.witness == WitnessAnswer::Seen);
    let denied = own.iter().any(|mention| mention.witness == WitnessAnswer::Denied);
    let guessed =
        || guesses.first().filter(|_| guesses.len() == 1 && polarity_of(answer) == AnswerPolarity::Yes).cloned();
    let colour = seen.and_then(|mention| mention.colour.clone());
    let colour = colour.or_else(|| first_colour(&said)).or_else(guessed).filter(|_| !is_unsure(&said));
    let is_absent = guesses.is_empty() && polarity_of(answer) == AnswerPolarity::No && colour.is_none();
    let mut found = Vec::new();
    if denied || is_absent {
        found.push(direct_sighting(new_sighting(name, WitnessAnswer::Denied)));
    } else if colour.is_some() || seen.is_some() {
        let place = seen.and_then(|mention| mention.place);
        let several = seen.is_some_and(|mention| mention.several);
        found.push(direct_sighting(ObjectSighting {
            colour,
            place,
            several,
            ..new_sighting(name, WitnessAnswer::Seen)
        }));
    }
    found.extend(asides_from_mentions(others, None));
    found
}

/// The answer to "How many chairs are there?".
fn read_number(wanted: QuestionThing, answer: &str) -> Vec<AnswerSighting> {
    const NO_NUMBER_WORDS: [&str; 4] = ["no", "none", "zero", "0"];
    let lower = answer.to_lowercase();
    let words = answer_words(&lower);
    let one = words.iter().any(|word| matches!(*word, "one" | "1" | "single"));
    let many = words.iter().any(|word| COUNT_WORDS.contains(word) || word.parse::<u32>().is_ok_and(|count| count > 1));
    if words.first().is_some_and(|first| NO_NUMBER_WORDS.contains(first)) {
        return read_presence(&[wanted], false, "No.");
    }
    if !(one || many) {
        return read_presence(&[wanted], false, answer);
    }
    read_presence(&[QuestionThing { several: many, ..wanted }], false, &format!("Yes, {answer}"))
}

/// The answer to "Where is the lamp?".
fn read_place(wanted: &QuestionThing, answer: &str) -> Vec<AnswerSighting> {
    let lower = answer.to_lowercase();
    let words = answer_words(&lower);
    let bare = match words.first() {
        Some(&("left" | "right" | "middle" | "center" | "centre")) if words.len() <= 3 => format!("on the {lower}"),
        _ => lower.clone(),
    };
    let answered = read_presence(std::slice::from_ref(wanted), false, &bare);
    // Without a place or a no, the answer leaves open whether the thing is there.
    answered.into_iter().filter(|one| !one.direct || one.sighting.witness != WitnessAnswer::Unsure).collect()
}

/// The things that the answer to a question for the room mentions besides the room. An answer of up to four words ("It
/// is an office") names the room only.
fn things_beside_room(answer: &str) -> Vec<AnswerSighting> {
    let is_long = answer_words(answer).len() > 4;
    let named = mentioned_things(answer, &BTreeSet::new()).into_iter().filter(|mention| is_long && !mention.is_room);
    asides_from_mentions(named.collect(), None)
}

/// The phrases of place that end an item of an enumeration.
const PLACE_ENDINGS: [(&str, ViewThird); 3] =
    [(" on the left", ViewThird::Left), (" in the middle", ViewThird::Middle), (" on the right", ViewThird::Right)];

/// The items of an answer that consists of an enumeration only, as rules and labels write it: "There is a bed in the
/// middle, two lamps on the left and a rug on the right." The names may be any words. `None` for free text.
pub(super) fn parse_enumeration(answer: &str) -> Option<Vec<ObjectSighting>> {
    let mut rest = ["There is ", "There are "].iter().find_map(|lead| answer.strip_prefix(lead))?;
    let mut found = Vec::new();
    loop {
        let (at, phrase, place) = PLACE_ENDINGS
            .iter()
            .filter_map(|(phrase, place)| Some((rest.find(phrase)?, *phrase, *place)))
            .min_by_key(|(at, ..)| *at)?;
        found.push(parse_item(&rest[..at], place)?);
        rest = &rest[at + phrase.len()..];
        if matches!(rest, "" | ".") {
            return Some(found);
        }
        rest = [", ", " and "].iter().find_map(|joint| rest.strip_prefix(joint))?;
    }
}

/// One item of an enumeration, such as "two lamps". `None` if it reads like free text or its name has over 60 bytes.
fn parse_item(words: &str, place: ViewThird) -> Option<ObjectSighting> {
    let (count, name) = words.split_once(' ')?;
    let several = COUNT_WORDS.contains(&count);
    let has_article = matches!(count, "a" | "an" | "some");
    let is_free = name.split(' ').any(|word| FREE_SPEECH.contains(&word)) || name.contains([',', '.', ';']);
    if is_free || name.is_empty() || name.len() > 60 || !(several || has_article) {
        return None;
    }
    let name = if several { to_singular(name) } else { without_article(name).to_owned() };
    let (colour, name) = split_colour(&name);
    Some(ObjectSighting { place: Some(place), several, colour, ..new_sighting(name, WitnessAnswer::Seen) })
}

/// Splits a name into its colour and the rest, if the rest is a thing: "tall grey armchair" is a grey armchair.
fn split_colour(name: &str) -> (Option<String>, &str) {
    if is_thing(&normalise_name(name)) {
        return (None, name);
    }
    let words: Vec<&str> = name.split(' ').collect();
    let starts = name.match_indices(' ').map(|(at, _)| at + 1);
    let starts: Vec<usize> = std::iter::once(0).chain(starts).collect();
    let found = (0..words.len()).find_map(|at| {
        let (colour, length) = colour_at(&words[at..])?;
        let rest = &name[*starts.get(at + length)?..];
        is_thing(&normalise_name(rest)).then_some((Some(colour), rest))
    });
    found.unwrap_or((None, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enumeration_gives_names_places_and_numbers() {
        let told = parse_enumeration(
            "There is a wide desk in the middle, two office chairs on the left and some shelves on the right.",
        )
        .unwrap();
        let short: Vec<_> = told.iter().map(|s| (s.name.as_str(), s.place.unwrap(), s.several)).collect();
        assert_eq!(
            short,
            [
                ("wide desk", ViewThird::Middle, false),
                ("office chair", ViewThird::Left, true),
                ("shelves", ViewThird::Right, false)
            ]
        );
    }

    #[test]
    fn free_speech_is_no_enumeration() {
        for answer in [
            "The image shows a bedroom with a bed on the left.",
            "There is a bed on the left. There is a lamp on the right.",
            "There is a bed with a red blanket in the middle.",
            "There is a bed on the left and a lamp.",
            "There is no bed on the left.",
            "",
        ] {
            assert_eq!(parse_enumeration(answer), None, "{answer}");
        }
    }
}
