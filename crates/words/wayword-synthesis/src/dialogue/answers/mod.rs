//! Reads answers: which room, what is there, where, in which colour, and what is not there.

mod colour;
mod join;
mod listed;
mod mentions;
mod names;
mod nouns;
mod place;
mod question;
mod room;
mod scope;
#[cfg(test)]
mod tests;
mod verdict;

mod wanted;

use colour::{bare_colour, first_colour};
use join::Told;
use listed::listed;
use std::collections::BTreeSet;
use verdict::{Verdict, is_unsure, verdict};
use wayword_core::{Exchange, Sighting, Where, Witness};
use wayword_language::lexicon::{agree, normal, thing};

pub(super) use {
    join::denies,
    mentions::{Mention, mentions},
    room::room,
};
pub(crate) use {
    names::{counted, is_plural, plural, with_article},
    question::{Asked, asked},
    wanted::Wanted,
};

/// Everything that a dialogue says of objects, each once, in the order in which it was told.
///
/// Any denial outweighs whatever else is said of a thing, before or after it.
pub(crate) fn sightings(transcript: &[Exchange], by: &str) -> Vec<Sighting> {
    join::join(transcript.iter().map(|exchange| of_exchange(exchange, by)))
}

fn of_exchange(exchange: &Exchange, by: &str) -> Vec<Told> {
    let answer = &exchange.answer.replace('’', "'");
    match asked(&exchange.question) {
        _ if answer.trim().is_empty() => Vec::new(),
        Asked::Presence { wanted, or } => presence(&wanted, or, answer, by),
        Asked::Colour { name, guesses } => colour(&name, &guesses, answer, by),
        Asked::Number(wanted) => number(wanted, answer, by),
        Asked::Place(wanted) => place(&wanted, answer, by),
        Asked::Room | Asked::IsRoom(_) => beside_the_room(answer, by),
        Asked::Other(place) => match listed(answer, by) {
            Some(listed) => listed.into_iter().map(|sighting| Told { sighting, direct: false }).collect(),
            None => told(things(answer, &BTreeSet::new()), place, by),
        },
    }
}

/// The things that an answer names. Walls, floors, ceilings and corners are everywhere, and are none.
fn things(answer: &str, known: &BTreeSet<String>) -> Vec<Mention> {
    let everywhere =
        |name: &str| thing(name).is_some_and(|thing| matches!(thing.name, "wall" | "floor" | "ceiling" | "corner"));
    let of_note =
        |mention: &Mention| mention.is_thing && (known.contains(&normal(&mention.name)) || !everywhere(&mention.name));
    mentions(answer, known).into_iter().filter(of_note).collect()
}

fn told(mentions: Vec<Mention>, place: Option<Where>, by: &str) -> Vec<Told> {
    let sighting = |mention: Mention| Sighting {
        name: mention.name,
        witness: mention.witness,
        place: mention.place.or(place),
        colour: mention.colour,
        several: mention.several,
        by: by.to_owned(),
    };
    mentions.into_iter().map(|mention| Told { sighting: sighting(mention), direct: false }).collect()
}

fn sighting(name: &str, witness: Witness, by: &str) -> Sighting {
    Sighting { name: name.to_owned(), witness, place: None, colour: None, several: false, by: by.to_owned() }
}

/// Mentions of a wanted thing, and the others.
fn of_wanted(name: &str, mentions: Vec<Mention>) -> (Vec<Mention>, Vec<Mention>) {
    mentions.into_iter().partition(|mention| agree(&mention.name, name))
}

/// The answer to "Is there a lamp?" or "Is there a bed or a sofa?".
fn presence(wanted: &[Wanted], or: bool, answer: &str, by: &str) -> Vec<Told> {
    let known = wanted.iter().map(|wanted| normal(&wanted.name)).collect();
    let mut rest = things(answer, &known);
    let lower = answer.to_lowercase();
    let place = place::phrases(&words(&lower)).first().map(|phrase| phrase.place);
    let verdict = match verdict(answer) {
        // A place alone: "On the left."
        Verdict::Open if rest.is_empty() && place.is_some() => Verdict::Yes,
        verdict => verdict,
    };
    let both = words(&lower).contains(&"both");
    let mut found = Vec::new();
    for one in wanted {
        let (own, others) = of_wanted(&one.name, rest);
        rest = others;
        let witness = witness(&own, verdict, or && !both && wanted.len() > 1, wanted.len() > 1);
        found.extend(witness.map(|witness| Told { sighting: of_one(one, witness, &own, place, by), direct: true }));
    }
    found.extend(told(rest, None, by));
    found
}

/// What an answer says of one wanted thing; nothing where a yes or no to several leaves it open.
fn witness(own: &[Mention], verdict: Verdict, or: bool, of_several: bool) -> Option<Witness> {
    let says = |witness| own.iter().any(|mention| mention.witness == witness);
    match verdict {
        _ if says(Witness::Denied) => Some(Witness::Denied),
        Verdict::No if of_several && !or => says(Witness::Seen).then_some(Witness::Seen),
        Verdict::No => Some(Witness::Denied),
        // "Yes, there might be one": how the thing itself is spoken of tells more.
        Verdict::Yes if says(Witness::Unsure) && !says(Witness::Seen) => Some(Witness::Unsure),
        Verdict::Yes if !or => Some(Witness::Seen),
        Verdict::Unsure => Some(Witness::Unsure),
        _ if says(Witness::Seen) => Some(Witness::Seen),
        Verdict::Open if !of_several => Some(Witness::Unsure),
        _ => None,
    }
}

fn of_one(wanted: &Wanted, witness: Witness, own: &[Mention], place: Option<Where>, by: &str) -> Sighting {
    let mention = own.iter().find(|mention| mention.witness == witness);
    match witness {
        Witness::Seen => Sighting {
            place: mention.map_or(place, |mention| mention.place).or(wanted.place),
            colour: mention.and_then(|mention| mention.colour.clone()).or_else(|| wanted.colour.clone()),
            several: mention.map_or(wanted.several, |mention| mention.several),
            ..sighting(&wanted.name, witness, by)
        },
        Witness::Denied => {
            // "Is there a red chair?" "There is no chair." says more than a no.
            let all = mention.is_some_and(|mention| normal(&mention.name) == normal(&wanted.name));
            let name = wanted.colour.as_ref().filter(|_| !all).map(|colour| format!("{colour} {}", wanted.name));
            Sighting { place: wanted.place, ..sighting(&name.unwrap_or(wanted.name.clone()), witness, by) }
        }
        Witness::Unsure => sighting(&wanted.name, witness, by),
    }
}

fn words(answer: &str) -> Vec<&str> {
    answer.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect()
}

/// The answer to "What colour is the lamp?": the question takes the lamp to be there, and the answer may deny it.
fn colour(name: &str, guesses: &[String], answer: &str, by: &str) -> Vec<Told> {
    // The form of our own `labels`, in which names may be any words. Shades are left out: the light brown of one eye is the
    // brown of another.
    let exact = answer.strip_prefix("The ").and_then(|rest| rest.strip_prefix(name)?.strip_prefix(" is "));
    if let Some(word) = exact.and_then(|said| bare_colour(said.trim_end_matches('.'))) {
        let colour = Some(word.to_lowercase());
        return vec![Told { sighting: Sighting { colour, ..sighting(name, Witness::Seen, by) }, direct: true }];
    }
    let known = BTreeSet::from([normal(name)]);
    let (own, others) = of_wanted(name, things(answer, &known));
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let seen = own.iter().find(|mention| mention.witness == Witness::Seen);
    let denied = own.iter().any(|mention| mention.witness == Witness::Denied);
    let guessed = || guesses.first().filter(|_| guesses.len() == 1 && verdict(answer) == Verdict::Yes).cloned();
    let colour = seen.and_then(|mention| mention.colour.clone());
    let colour = colour.or_else(|| first_colour(&said)).or_else(guessed).filter(|_| !is_unsure(&said));
    let absent = guesses.is_empty() && verdict(answer) == Verdict::No && colour.is_none();
    let mut found = Vec::new();
    if denied || absent {
        found.push(Told { sighting: sighting(name, Witness::Denied, by), direct: true });
    } else if colour.is_some() || seen.is_some() {
        let place = seen.and_then(|mention| mention.place);
        let several = seen.is_some_and(|mention| mention.several);
        let sighting = Sighting { colour, place, several, ..sighting(name, Witness::Seen, by) };
        found.push(Told { sighting, direct: true });
    }
    found.extend(told(others, None, by));
    found
}

/// The answer to "How many chairs are there?".
fn number(wanted: Wanted, answer: &str, by: &str) -> Vec<Told> {
    const NONE: [&str; 4] = ["no", "none", "zero", "0"];
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let one = said.iter().any(|word| matches!(*word, "one" | "1" | "single"));
    let many = said.iter().any(|word| names::COUNTS.contains(word) || word.parse::<u32>().is_ok_and(|count| count > 1));
    if said.first().is_some_and(|first| NONE.contains(first)) {
        return presence(&[wanted], false, "No.", by);
    }
    if !(one || many) {
        return presence(&[wanted], false, answer, by);
    }
    presence(&[Wanted { several: many, ..wanted }], false, &format!("Yes, {answer}"), by)
}

/// The answer to "Where is the lamp?".
fn place(wanted: &Wanted, answer: &str, by: &str) -> Vec<Told> {
    let lower = answer.to_lowercase();
    let said = words(&lower);
    let bare = match said.first() {
        Some(&("left" | "right" | "middle" | "center" | "centre")) if said.len() <= 3 => format!("on the {lower}"),
        _ => lower.clone(),
    };
    let told = presence(std::slice::from_ref(wanted), false, &bare, by);
    // Without a place or a no the answer tells nothing of the thing itself.
    told.into_iter().filter(|told| !told.direct || told.sighting.witness != Witness::Unsure).collect()
}

/// What the answer to a question for the room names besides it.
fn beside_the_room(answer: &str, by: &str) -> Vec<Told> {
    let more = words(answer).len() > 4;
    let named = things(answer, &BTreeSet::new()).into_iter().filter(|mention| more && !mention.is_room);
    told(named.collect(), None, by)
}
