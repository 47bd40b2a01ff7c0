//! Enumerations in which each object has its place, as the `labels` answerer gives them.

use super::names::{COUNTS, singular, without_article};
use wayword_core::{Sighting, Where, Witness};

const PLACES: [(&str, Where); 3] =
    [(" on the left", Where::Left), (" in the middle", Where::Middle), (" on the right", Where::Right)];

/// Words that no name of an enumeration holds: with them it is free speech, and is read as such.
const FREE: [&str; 26] = [
    "with", "and", "or", "that", "which", "is", "are", "a", "an", "the", "there", "i", "it", "in", "on", "to", "next",
    "shows", "has", "no", "not", "maybe", "possibly", "also", "see", "be",
];

/// What an answer lists, where the whole of it is an enumeration: "There is a bed in the middle, two lamps on the left and a
/// rug on the right." Names in it may be any words.
pub(super) fn listed(answer: &str, by: &str) -> Option<Vec<Sighting>> {
    let mut rest = ["There is ", "There are "].iter().find_map(|lead| answer.strip_prefix(lead))?;
    let mut found = Vec::new();
    loop {
        let (at, phrase, place) = PLACES
            .iter()
            .filter_map(|(phrase, place)| Some((rest.find(phrase)?, *phrase, *place)))
            .min_by_key(|(at, ..)| *at)?;
        found.push(item(&rest[..at], place, by)?);
        rest = &rest[at + phrase.len()..];
        if matches!(rest, "" | ".") {
            return Some(found);
        }
        rest = [", ", " and "].iter().find_map(|joint| rest.strip_prefix(joint))?;
    }
}

fn item(words: &str, place: Where, by: &str) -> Option<Sighting> {
    let (count, name) = words.split_once(' ')?;
    let several = COUNTS.contains(&count);
    let has_article = matches!(count, "a" | "an" | "some");
    let is_free = name.split(' ').any(|word| FREE.contains(&word)) || name.contains([',', '.', ';']);
    if is_free || name.is_empty() || name.len() > 60 || !(several || has_article) {
        return None;
    }
    let name = if several { singular(name) } else { without_article(name).to_owned() };
    Some(Sighting { name, witness: Witness::Seen, place: Some(place), colour: None, several, by: by.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_enumeration_gives_names_places_and_numbers() {
        let told = listed(
            "There is a wide desk in the middle, two office chairs on the left and some shelves on the right.",
            "test",
        )
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
            assert_eq!(listed(answer, "test"), None, "{answer}");
        }
    }
}
