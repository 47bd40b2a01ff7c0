//! Interprets one answer in the light of its question: which things are there, where, in which colour, and which are
//! not there.

use super::{
    Told,
    mentions::{Mention, mentions},
    phrases::{Wanted, bare_colour, colour_at, first_colour, place_phrases},
    polarity::{Polarity, is_unsure, polarity_of},
    question::{Asked, asked},
};
use std::collections::BTreeSet;
use wayword_core::{Exchange, Sighting, Where, Witness};
use wayword_language::{
    answers::FREE_SPEECH,
    lexicon::{COUNTS, agree, is_thing, normal, singular, thing, without_article},
};

/// All sightings of an exchange, attributed to `by`.
pub(super) fn said(exchange: &Exchange, by: &str) -> Vec<Told> {
    let mut said = of_answer(exchange);
    for told in &mut said {
        by.clone_into(&mut told.sighting.by);
    }
    said
}

fn of_answer(exchange: &Exchange) -> Vec<Told> {
    let answer = &exchange.answer.replace('’', "'");
    match asked(&exchange.question) {
        _ if answer.trim().is_empty() => Vec::new(),
        Asked::Presence { wanted, or } => presence(&wanted, or, answer),
        Asked::Colour { name, guesses } => colour(&name, &guesses, answer),
        Asked::Number(wanted) => number(wanted, answer),
        Asked::Place(wanted) => place(&wanted, answer),
        Asked::Room | Asked::IsRoom(_) => beside_the_room(answer),
        Asked::Other(place) => match listed(answer) {
            Some(listed) => listed.into_iter().map(aside).collect(),
            None => told(things(answer, &BTreeSet::new()), place),
        },
    }
}

/// The things that an answer names. Walls, floors, ceilings and corners are in every room, so they only count if they
/// are in `known`.
fn things(answer: &str, known: &BTreeSet<String>) -> Vec<Mention> {
    let everywhere =
        |name: &str| thing(name).is_some_and(|thing| matches!(thing.name, "wall" | "floor" | "ceiling" | "corner"));
    let of_note =
        |mention: &Mention| mention.is_thing && (known.contains(&normal(&mention.name)) || !everywhere(&mention.name));
    mentions(answer, known).into_iter().filter(of_note).collect()
}

fn told(mentions: Vec<Mention>, place: Option<Where>) -> Vec<Told> {
    let aside = |Mention { name, witness, place: own, colour, several, .. }| {
        aside(Sighting { place: own.or(place), colour, several, ..sighting(&name, witness) })
    };
    mentions.into_iter().map(aside).collect()
}

/// A sighting of the thing that the question asks for.
fn direct(sighting: Sighting) -> Told {
    Told { sighting, direct: true }
}

/// A sighting of some other thing that the answer mentions.
fn aside(sighting: Sighting) -> Told {
    Told { sighting, direct: false }
}

fn sighting(name: &str, witness: Witness) -> Sighting {
    Sighting::new(name, witness, "")
}

/// Mentions of a wanted thing, and the others.
fn of_wanted(name: &str, mentions: Vec<Mention>) -> (Vec<Mention>, Vec<Mention>) {
    mentions.into_iter().partition(|mention| agree(&mention.name, name))
}

/// The answer to "Is there a lamp?" or "Is there a bed or a sofa?".
fn presence(wanted: &[Wanted], or: bool, answer: &str) -> Vec<Told> {
    let known = wanted.iter().map(|wanted| normal(&wanted.name)).collect();
    let mut rest = things(answer, &known);
    let lower = answer.to_lowercase();
    let place = place_phrases(&words(&lower)).first().map(|phrase| phrase.place);
    let polarity = match polarity_of(answer) {
        // A place alone: "On the left."
        Polarity::Open if rest.is_empty() && place.is_some() => Polarity::Yes,
        polarity => polarity,
    };
    let both = words(&lower).contains(&"both");
    let mut found = Vec::new();
    for one in wanted {
        let (own, others) = of_wanted(&one.name, rest);
        rest = others;
        let witness = witness(&own, polarity, or && !both && wanted.len() > 1, wanted.len() > 1);
        found.extend(witness.map(|witness| direct(of_one(one, witness, &own, place))));
    }
    found.extend(told(rest, None));
    found
}

/// The witness of an answer for one wanted thing; `None` where a yes or no to several things leaves it open.
fn witness(own: &[Mention], polarity: Polarity, or: bool, of_several: bool) -> Option<Witness> {
    let says = |witness| own.iter().any(|mention| mention.witness == witness);
    match polarity {
        _ if says(Witness::Denied) => Some(Witness::Denied),
        Polarity::No if of_several && !or => says(Witness::Seen).then_some(Witness::Seen),
        Polarity::No => Some(Witness::Denied),
        // "Yes, there might be one": the wording about the thing itself counts more than the yes.
        Polarity::Yes if says(Witness::Unsure) && !says(Witness::Seen) => Some(Witness::Unsure),
        Polarity::Yes if !or => Some(Witness::Seen),
        Polarity::Unsure => Some(Witness::Unsure),
        _ if says(Witness::Seen) => Some(Witness::Seen),
        Polarity::Open if !of_several => Some(Witness::Unsure),
        _ => None,
    }
}

fn of_one(wanted: &Wanted, witness: Witness, own: &[Mention], place: Option<Where>) -> Sighting {
    let mention = own.iter().find(|mention| mention.witness == witness);
    match witness {
        Witness::Seen => Sighting {
            place: mention.map_or(place, |mention| mention.place).or(wanted.place),
            colour: mention.and_then(|mention| mention.colour.clone()).or_else(|| wanted.colour.clone()),
            several: mention.map_or(wanted.several, |mention| mention.several),
            ..sighting(&wanted.name, witness)
        },
        Witness::Denied => {
            // "Is there a red chair?" "There is no chair." denies every chair, not only a red one.
            let all = mention.is_some_and(|mention| normal(&mention.name) == normal(&wanted.name));
            let name = wanted.colour.as_ref().filter(|_| !all).map(|colour| format!("{colour} {}", wanted.name));
            Sighting { place: wanted.place, ..sighting(&name.unwrap_or(wanted.name.clone()), witness) }
        }
        Witness::Unsure => sighting(&wanted.name, witness),
    }
}

fn words(answer: &str) -> Vec<&str> {
    answer.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect()
}

/// The answer to "What colour is the lamp?": the question takes the lamp to be there, and the answer may deny it.
fn colour(name: &str, guesses: &[String], answer: &str) -> Vec<Told> {
    // The form in which `labels` answers, where names may be any words. Shades are left out, because what one model
    // calls light brown another calls brown.
    let exact = answer.strip_prefix("The ").and_then(|rest| rest.strip_prefix(name)?.strip_prefix(" is "));
    if let Some(word) = exact.and_then(|said| bare_colour(said.trim_end_matches('.'))) {
        let colour = Some(word.to_lowercase());
        return vec![direct(Sighting { colour, ..sighting(name, Witness::Seen) })];
    }
    let known = BTreeSet::from([normal(name)]);
    let (own, others) = of_wanted(name, things(answer, &known));
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let seen = own.iter().find(|mention| mention.witness == Witness::Seen);
    let denied = own.iter().any(|mention| mention.witness == Witness::Denied);
    let guessed = || guesses.first().filter(|_| guesses.len() == 1 && polarity_of(answer) == Polarity::Yes).cloned();
    let colour = seen.and_then(|mention| mention.colour.clone());
    let colour = colour.or_else(|| first_colour(&said)).or_else(guessed).filter(|_| !is_unsure(&said));
    let absent = guesses.is_empty() && polarity_of(answer) == Polarity::No && colour.is_none();
    let mut found = Vec::new();
    if denied || absent {
        found.push(direct(sighting(name, Witness::Denied)));
    } else if colour.is_some() || seen.is_some() {
        let place = seen.and_then(|mention| mention.place);
        let several = seen.is_some_and(|mention| mention.several);
        found.push(direct(Sighting { colour, place, several, ..sighting(name, Witness::Seen) }));
    }
    found.extend(told(others, None));
    found
}

/// The answer to "How many chairs are there?".
fn number(wanted: Wanted, answer: &str) -> Vec<Told> {
    const NONE: [&str; 4] = ["no", "none", "zero", "0"];
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let one = said.iter().any(|word| matches!(*word, "one" | "1" | "single"));
    let many = said.iter().any(|word| COUNTS.contains(word) || word.parse::<u32>().is_ok_and(|count| count > 1));
    if said.first().is_some_and(|first| NONE.contains(first)) {
        return presence(&[wanted], false, "No.");
    }
    if !(one || many) {
        return presence(&[wanted], false, answer);
    }
    presence(&[Wanted { several: many, ..wanted }], false, &format!("Yes, {answer}"))
}

/// The answer to "Where is the lamp?".
fn place(wanted: &Wanted, answer: &str) -> Vec<Told> {
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let bare = match said.first() {
        Some(&("left" | "right" | "middle" | "center" | "centre")) if said.len() <= 3 => format!("on the {lower}"),
        _ => lower.clone(),
    };
    let told = presence(std::slice::from_ref(wanted), false, &bare);
    // Without a place or a no, the answer leaves open whether the thing is there.
    told.into_iter().filter(|told| !told.direct || told.sighting.witness != Witness::Unsure).collect()
}

/// The things that the answer to a question for the room mentions besides the room.
fn beside_the_room(answer: &str) -> Vec<Told> {
    let more = words(answer).len() > 4;
    let named = things(answer, &BTreeSet::new()).into_iter().filter(|mention| more && !mention.is_room);
    told(named.collect(), None)
}

const PLACES: [(&str, Where); 3] =
    [(" on the left", Where::Left), (" in the middle", Where::Middle), (" on the right", Where::Right)];

/// The items of an answer that consists of an enumeration only, as rules and labels write it: "There is a bed in the
/// middle, two lamps on the left and a rug on the right." The names may be any words. `None` for free text.
pub(super) fn listed(answer: &str) -> Option<Vec<Sighting>> {
    let mut rest = ["There is ", "There are "].iter().find_map(|lead| answer.strip_prefix(lead))?;
    let mut found = Vec::new();
    loop {
        let (at, phrase, place) = PLACES
            .iter()
            .filter_map(|(phrase, place)| Some((rest.find(phrase)?, *phrase, *place)))
            .min_by_key(|(at, ..)| *at)?;
        found.push(item(&rest[..at], place)?);
        rest = &rest[at + phrase.len()..];
        if matches!(rest, "" | ".") {
            return Some(found);
        }
        rest = [", ", " and "].iter().find_map(|joint| rest.strip_prefix(joint))?;
    }
}

fn item(words: &str, place: Where) -> Option<Sighting> {
    let (count, name) = words.split_once(' ')?;
    let several = COUNTS.contains(&count);
    let has_article = matches!(count, "a" | "an" | "some");
    let is_free = name.split(' ').any(|word| FREE_SPEECH.contains(&word)) || name.contains([',', '.', ';']);
    if is_free || name.is_empty() || name.len() > 60 || !(several || has_article) {
        return None;
    }
    let name = if several { singular(name) } else { without_article(name).to_owned() };
    let (colour, name) = apart(&name);
    Some(Sighting { place: Some(place), several, colour, ..sighting(name, Witness::Seen) })
}

/// Splits a name into its colour and the rest, if the rest is a thing: "tall grey armchair" is a grey armchair.
fn apart(name: &str) -> (Option<String>, &str) {
    if is_thing(&normal(name)) {
        return (None, name);
    }
    let words: Vec<&str> = name.split(' ').collect();
    let starts = name.match_indices(' ').map(|(at, _)| at + 1);
    let starts: Vec<usize> = std::iter::once(0).chain(starts).collect();
    let found = (0..words.len()).find_map(|at| {
        let (colour, length) = colour_at(&words[at..])?;
        let rest = &name[*starts.get(at + length)?..];
        is_thing(&normal(rest)).then_some((Some(colour), rest))
    });
    found.unwrap_or((None, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enumeration_gives_names_places_and_numbers() {
        let told =
            listed("There is a wide desk in the middle, two office chairs on the left and some shelves on the right.")
                .unwrap();
        let short: Vec<_> = told.iter().map(|s| (s.name.as_str(), s.place.unwrap(), s.several)).collect();
        assert_eq!(
            short,
            [
                ("wide desk", Where::Middle, false),
                ("office chair", Where::Left, true),
                ("shelves", Where::Right, false)
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
            assert_eq!(listed(answer), None, "{answer}");
        }
    }
}
