//! Reads answers: which room, what is there, where, in which colour, and what is not there.

use crate::{
    lexicon::{agree, normal, normal_word},
    reading::{What, read},
};
use std::collections::BTreeSet;
use wayword_core::{Exchange, Side, Sighting, Where, Witness};

const COUNTS: [&str; 7] = ["two", "three", "four", "five", "six", "several", "many"];

/// Everything that a dialogue says of objects, each once, in the order in which it was told.
pub(crate) fn sightings(transcript: &[Exchange], by: &str) -> Vec<Sighting> {
    let mut told: Vec<Sighting> = Vec::new();
    for exchange in transcript {
        for sighting in of_exchange(exchange, by) {
            let same = told.iter_mut().find(|before| {
                before.name == sighting.name
                    && (before.place == sighting.place || before.place.is_none() || sighting.place.is_none())
            });
            match same {
                Some(before) => join(before, sighting),
                None => told.push(sighting),
            }
        }
    }
    told
}

/// A later answer adds to an earlier one, and a denial outweighs it.
fn join(before: &mut Sighting, later: Sighting) {
    before.place = before.place.or(later.place);
    before.colour = before.colour.take().or(later.colour);
    before.several |= later.several;
    if later.witness == Witness::Denied {
        before.witness = Witness::Denied;
    }
}

fn of_exchange(exchange: &Exchange, by: &str) -> Vec<Sighting> {
    let Exchange { question, answer, .. } = exchange;
    let sighting = |name: &str, witness| Sighting {
        name: name.to_owned(),
        witness,
        place: None,
        colour: None,
        several: false,
        by: by.to_owned(),
    };
    let unsure = answer.to_lowercase().contains("not sure");
    if let Some(name) = between(question, "Is there ", "?").map(without_article) {
        let witness = match answer.to_lowercase() {
            answer if unsure || !(answer.starts_with("yes") || answer.starts_with("no")) => Witness::Unsure,
            answer if answer.starts_with("yes") => Witness::Seen,
            _ => Witness::Denied,
        };
        return vec![Sighting {
            place: place_in(answer).filter(|_| witness == Witness::Seen),
            ..sighting(name, witness)
        }];
    }
    if let Some(name) = between(question, "What colour is the ", "?") {
        let colour = answer.trim_end_matches('.').rsplit(' ').next().filter(|_| !unsure).map(str::to_lowercase);
        return colour
            .map_or_else(Vec::new, |colour| vec![Sighting { colour: Some(colour), ..sighting(name, Witness::Seen) }]);
    }
    if unsure || room_asked(question) {
        return Vec::new();
    }
    let listed = listed(answer, by);
    if listed.is_empty() { named(answer, by) } else { listed }
}

fn room_asked(question: &str) -> bool {
    question.to_lowercase().contains("room")
}

/// The room that was told.
pub(super) fn room(transcript: &[Exchange]) -> Option<String> {
    let answer = &transcript.iter().find(|exchange| room_asked(&exchange.question))?.answer;
    let said = answer.trim_end_matches('.').to_lowercase();
    let name = ["it is ", "this is ", "a ", "an ", "the ", "some "]
        .iter()
        .fold(said.as_str(), |rest, lead| rest.strip_prefix(lead).unwrap_or(rest));
    (!name.is_empty() && !said.contains("not sure") && name.len() <= 40).then(|| name.to_owned())
}

/// An enumeration in which each object has a place: "There is a bed in the middle, two lamps on the left and ...".
fn listed(answer: &str, by: &str) -> Vec<Sighting> {
    const PLACES: [(&str, Where); 3] =
        [(" on the left", Where::Left), (" in the middle", Where::Middle), (" on the right", Where::Right)];
    let mut found = Vec::new();
    let mut rest = answer;
    while let Some((at, phrase, place)) = PLACES
        .iter()
        .filter_map(|(phrase, place)| Some((rest.find(phrase)?, *phrase, *place)))
        .min_by_key(|(at, ..)| *at)
    {
        let item = rest[..at]
            .trim_start_matches([',', ' '])
            .trim_start_matches("There is ")
            .trim_start_matches("There are ")
            .trim_start_matches("and ");
        let (count, name) = item.split_once(' ').unwrap_or(("", item));
        let several = COUNTS.contains(&count);
        let name = if several { singular(name) } else { without_article(item).to_owned() };
        if !name.is_empty() && name.len() <= 60 {
            found.push(Sighting {
                name,
                witness: Witness::Seen,
                place: Some(place),
                colour: None,
                several,
                by: by.to_owned(),
            });
        }
        rest = &rest[at + phrase.len()..];
    }
    found
}

/// Free words: whatever is named as a place or thing.
fn named(answer: &str, by: &str) -> Vec<Sighting> {
    let reading = read(answer, &BTreeSet::new());
    let things = reading.events.into_iter().filter_map(|event| match event.what {
        What::Place(place) if place.is_thing => {
            Some((answer[event.span[0]..event.span[1]].to_lowercase(), place, event.span[0]))
        }
        _ => None,
    });
    things
        .map(|(name, place, at)| {
            let before = answer[..at].trim_end().rsplit(' ').next().unwrap_or_default().to_lowercase();
            let several = COUNTS.contains(&before.as_str());
            let denied = matches!(before.as_str(), "no" | "not" | "without");
            let witness = if denied { Witness::Denied } else { Witness::Seen };
            let third = place.side.map(|side| if side == Side::Left { Where::Left } else { Where::Right });
            Sighting {
                name: if several { singular(&name) } else { name },
                witness,
                place: third,
                colour: None,
                several,
                by: by.to_owned(),
            }
        })
        .collect()
}

/// Whether a denial speaks of a name.
pub(super) fn is_denied(name: &str, told: &[Sighting]) -> bool {
    told.iter().any(|sighting| {
        sighting.witness == Witness::Denied && (normal(&sighting.name) == normal(name) || agree(&sighting.name, name))
    })
}

fn between<'a>(text: &'a str, lead: &str, tail: &str) -> Option<&'a str> {
    text.strip_prefix(lead)?.strip_suffix(tail)
}

fn place_in(answer: &str) -> Option<Where> {
    let says = |word: &str| answer.contains(word);
    if says("left") {
        Some(Where::Left)
    } else if says("right") {
        Some(Where::Right)
    } else {
        says("middle").then_some(Where::Middle)
    }
}

fn without_article(name: &str) -> &str {
    ["a ", "an ", "the ", "some "].iter().find_map(|article| name.strip_prefix(article)).unwrap_or(name)
}

/// A name with the last word in the singular.
fn singular(name: &str) -> String {
    match name.rsplit_once(' ') {
        Some((before, last)) => format!("{before} {}", normal_word(last)),
        None => normal_word(name),
    }
}

/// A name with its article: "a lamp", "an oven", "some shelves".
pub(crate) fn with_article(name: &str) -> String {
    let vowel = name.starts_with(['a', 'e', 'i', 'o', 'u']);
    let article = if is_plural(name) {
        "some"
    } else if vowel {
        "an"
    } else {
        "a"
    };
    format!("{article} {name}")
}

/// Whether a name is a plural already.
pub(crate) fn is_plural(name: &str) -> bool {
    let last = name.rsplit(' ').next().unwrap_or(name);
    last.len() > 3 && last.ends_with('s') && !["ss", "us", "is"].iter().any(|end| last.ends_with(end))
}

/// The plural of a name.
pub(crate) fn plural(name: &str) -> String {
    if is_plural(name) {
        return name.to_owned();
    }
    if let Some(stem) = name.strip_suffix("shelf") {
        return format!("{stem}shelves");
    }
    let hisses = ["s", "x", "z", "ch", "sh"].iter().any(|end| name.ends_with(end));
    let consonant_y = name.ends_with('y') && !["ay", "ey", "oy", "uy"].iter().any(|end| name.ends_with(end));
    match (hisses, consonant_y) {
        (true, _) => format!("{name}es"),
        (_, true) => format!("{}ies", &name[..name.len() - 1]),
        _ => format!("{name}s"),
    }
}

/// A count of things in words: "a lamp", "two lamps", "several lamps".
pub(crate) fn counted(count: usize, name: &str) -> String {
    match count {
        0 | 1 => with_article(name),
        2..=6 => format!("{} {}", COUNTS[count - 2], plural(name)),
        _ => format!("several {}", plural(name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_all(pairs: &[(&str, &str)]) -> Vec<Sighting> {
        let transcript: Vec<_> = pairs.iter().map(|(question, answer)| Exchange::new(*question, *answer)).collect();
        sightings(&transcript, "test")
    }

    #[test]
    fn an_enumeration_gives_names_places_and_numbers() {
        let told = read_all(&[(
            super::super::OPENING,
            "There is a wide desk in the middle, two office chairs on the left and some shelves on the right.",
        )]);
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
    fn no_is_kept_and_outweighs_what_was_said_before() {
        let told = read_all(&[
            (super::super::OPENING, "I can see a bed and a mirror."),
            ("Is there a mirror?", "No."),
            ("Is there a lamp?", "I am not sure."),
        ]);
        let witness = |name: &str| told.iter().find(|s| s.name == name).unwrap().witness;
        assert_eq!(
            (witness("bed"), witness("mirror"), witness("lamp")),
            (Witness::Seen, Witness::Denied, Witness::Unsure)
        );
    }

    #[test]
    fn colours_join_the_things_they_belong_to() {
        let told = read_all(&[
            (super::super::OPENING, "There is a sofa in the middle."),
            ("What colour is the sofa?", "The sofa is green."),
        ]);
        assert_eq!(told.len(), 1);
        assert_eq!(told[0].colour.as_deref(), Some("green"));
    }

    #[test]
    fn articles_and_plurals_are_english() {
        assert_eq!(with_article("oven"), "an oven");
        assert_eq!(counted(2, "bookshelf"), "two bookshelves");
        assert_eq!(counted(3, "couch"), "three couches");
        assert_eq!(counted(1, "shelves"), "some shelves");
    }
}
