//! Recognises phrases within a question or an answer: places in the view, colours, and the names of things that a
//! question asks for.

use wayword_core::ViewThird;
use wayword_language::{
    answers::{ANYTHING, BEFORE_SIDE, FILLERS, MORE_COLOURS, PREPOSITIONS, SIDE_PARTS, WHOLES},
    lexicon::{is_room, is_thing, means_several, normalise_name, to_singular},
    reading::vocabulary::{ABSTRACT, BREAKERS, COLOURS},
};

/// A phrase that places something in the view: the range of its words (`from` up to `to`, without `to`), and the third
/// of the view that it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PlacePhrase {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) place: ViewThird,
}

/// The place that the phrase beginning at a word means, and where the phrase ends. `Some((None, _))` for a place
/// relative to another thing ("to the left of the sofa"); `None` if no phrase of place begins there.
fn phrase_at(words: &[&str], from: usize) -> Option<(Option<ViewThird>, usize)> {
    let word = |at: usize| words.get(at).copied().unwrap_or("");
    match (word(from), word(from + 1), word(from + 2)) {
        ("straight" | "directly" | "right", "ahead", _) => return Some((Some(ViewThird::Middle), from + 2)),
        ("ahead", ..) => return Some((Some(ViewThird::Middle), from + 1)),
        ("in", "front", "of") if matches!(word(from + 3), "you" | "us" | "me") => {
            return Some((Some(ViewThird::Middle), from + 4));
        }
        _ => {}
    }
    if !PREPOSITIONS.contains(&word(from)) {
        return None;
    }
    let mut at = from + 1;
    while at < from + 4 && BEFORE_SIDE.contains(&word(at)) {
        at += 1;
    }
    let place = match word(at) {
        "left" | "lefthand" => ViewThird::Left,
        "right" | "righthand" => ViewThird::Right,
        "middle" | "centre" | "center" | "background" | "distance" => ViewThird::Middle,
        _ => return None,
    };
    // "On left" without "the" is no phrase of place.
    if at == from + 1 {
        return None;
    }
    at += 1;
    while SIDE_PARTS.contains(&word(at)) {
        at += 1;
    }
    if word(at) != "of" {
        return Some((Some(place), at));
    }
    let whole = if matches!(word(at + 1), "the" | "this" | "your" | "my") { at + 2 } else { at + 1 };
    let room = is_room(word(whole)) || word(whole + 1) == "room";
    let is_of_view = WHOLES.contains(&word(whole)) || room;
    Some(if is_of_view { (Some(place), whole + 1) } else { (None, at + 1) })
}

/// The phrases of place among these words.
pub(super) fn place_phrases(words: &[&str]) -> Vec<PlacePhrase> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let next = phrase_at(words, at);
        if let Some((Some(place), to)) = next {
            found.push(PlacePhrase { from: at, to, place });
        }
        at = next.map_or(at + 1, |(_, to)| to);
    }
    found
}

/// The colour that begins at a word, with its shade, and the number of its words.
pub(crate) fn colour_at(words: &[&str]) -> Option<(String, usize)> {
    let is_colour = |word: &&&str| COLOURS.contains(word) || MORE_COLOURS.contains(word);
    let plain = |word: &str| match word {
        "gray" => "grey".to_owned(),
        "golden" => "gold".to_owned(),
        word => word.to_owned(),
    };
    match words {
        [shade @ ("dark" | "light"), rest @ ..] => {
            rest.first().filter(is_colour).map(|colour| (format!("{shade} {}", plain(colour)), 2))
        }
        [..] => words.first().filter(is_colour).map(|colour| (plain(colour), 1)),
    }
}

/// The colour of a phrase that consists of a colour only, without its shade ("light", "dark").
pub(super) fn bare_colour(phrase: &str) -> Option<&str> {
    let words: Vec<&str> = phrase.split(' ').collect();
    colour_at(&words).filter(|(_, length)| *length == words.len()).and_then(|_| words.last().copied())
}

/// The first colour of a run of words.
pub(super) fn first_colour(words: &[&str]) -> Option<String> {
    (0..words.len()).find_map(|at| colour_at(&words[at..])).map(|(colour, _)| colour)
}

/// The colour that a sentence gives to the thing that it has just named: "is dark green", "appears to be mostly white".
/// `after` has the words after the name.
pub(super) fn colour_said_of(after: &[&str]) -> Option<String> {
    const COLOUR_LINK_VERBS: [&str; 9] = ["is", "are", "was", "were", "looks", "look", "appears", "appear", "painted"];
    const WORDS_BEFORE_COLOUR: [&str; 14] =
        ["to", "be", "a", "an", "very", "mostly", "mainly", "also", "painted", "of", "in", "all", "large", "colour"];
    let (first, rest) = after.split_first()?;
    if !COLOUR_LINK_VERBS.contains(first) {
        return None;
    }
    let skipped = rest.iter().take(4).take_while(|word| WORDS_BEFORE_COLOUR.contains(word)).count();
    colour_at(&rest[skipped..]).map(|(colour, _)| colour)
}

/// Longest name that is asked for, bytes; a question for a longer one asks for nothing that we know.
const MAX_NAME_BYTES: usize = 60;
/// Most things that one question asks for; further ones are ignored.
const MAX_QUESTION_THINGS: usize = 8;

/// A thing that a question asks for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuestionThing {
    /// Its name in the words of the question, without article and adjectives of size.
    pub(crate) phrase: String,
    /// The name without its colour, in the singular where it has one.
    pub(crate) name: String,
    /// The colour that is asked for.
    pub(crate) colour: Option<String>,
    /// Whether the question speaks of several.
    pub(crate) several: bool,
    /// The part of the view that is asked about.
    pub(crate) place: Option<ViewThird>,
}

/// The things that these words ask for, separated by "or", "and" or commas, and whether one of the separators is an "or".
pub(super) fn all_wanted(words: &[&str]) -> Option<(Vec<QuestionThing>, bool)> {
    let place = place_phrases(words).first().map(|phrase| phrase.place);
    let mut found: Vec<QuestionThing> = Vec::new();
    let mut at = 0;
    let mut has_or = false;
    loop {
        let name = noun_phrase(words, &mut at)?;
        found.push(question_thing(&name, place)?);
        match words.get(at) {
            Some(&"or") => has_or = true,
            Some(&"and") => {}
            Some(&",") if words[at..].iter().any(|word| matches!(*word, "or" | "and")) => {
                at += usize::from(matches!(words.get(at + 1), Some(&"or" | &"and")));
                has_or |= words[at] == "or";
            }
            _ => return Some((found, has_or)),
        }
        at += 1;
        // Looks ahead: the words behind the separator must name a thing too.
        if found.len() == MAX_QUESTION_THINGS
            || noun_phrase(words, &mut at.clone()).and_then(|name| question_thing(&name, None)).is_none()
        {
            return Some((found, has_or));
        }
    }
}

/// The words of the noun phrase that begins at `at`, without fillers before it. Moves `at` to the next "or", "and" or
/// comma.
pub(super) fn noun_phrase<'a>(words: &[&'a str], at: &mut usize) -> Option<Vec<&'a str>> {
    while words.get(*at).is_some_and(|word| FILLERS.contains(word)) {
        *at += 1;
    }
    let start = *at;
    let in_name = |at: usize| {
        let word = words[at];
        // "Of" belongs to the name only in names that the lexicon has, such as "chest of drawers".
        let is_of_in_name = word == "of"
            && at > start
            && (1..=3).any(|more| {
                words.get(start..at + 1 + more).is_some_and(|name| is_thing(&normalise_name(&name.join(" "))))
            });
        let is_word = word.starts_with(char::is_alphanumeric);
        is_word
            && at < start + 6
            && (is_of_in_name || !BREAKERS.contains(&word) || (at == start && matches!(word, "hanging" | "standing")))
            && !matches!(word, "visible" | "present" | "mentioned" | "really" | "actually" | "here" | "anywhere")
    };
    while *at < words.len() && in_name(*at) {
        *at += 1;
    }
    let found = words[start..*at].to_vec();
    // "The lamp you mentioned": behind the name, up to the next separator.
    while words.get(*at).is_some_and(|word| !matches!(*word, "or" | "and" | ",")) {
        *at += 1;
    }
    (!found.is_empty()).then_some(found)
}

/// The thing that these words begin with.
pub(super) fn first_wanted(words: &[&str]) -> Option<QuestionThing> {
    question_thing(&noun_phrase(words, &mut 0)?, None)
}

/// Makes a wanted thing of the words of a name; `None` for vague words such as "anything", and for too long a name.
pub(super) fn question_thing(name: &[&str], place: Option<ViewThird>) -> Option<QuestionThing> {
    let head = normalise_name(name.last()?);
    let is_vague_word = |word: &str| ANYTHING.contains(&word);
    let is_vague = ABSTRACT.contains(&head.as_str()) && !is_thing(&normalise_name(&name.join(" ")));
    if is_vague || is_vague_word(&head) || name.iter().any(|word| is_vague_word(word)) {
        return None;
    }
    let said = name.join(" ");
    if said.len() > MAX_NAME_BYTES {
        return None;
    }
    let in_lexicon = is_thing(&normalise_name(&said));
    let (colour, length) =
        colour_at(name).filter(|_| !in_lexicon).map_or((None, 0), |(colour, length)| (Some(colour), length));
    let bare = name[length..].join(" ");
    if bare.is_empty() {
        return None;
    }
    let several = means_several(&bare);
    Some(QuestionThing { phrase: said, name: if several { to_singular(&bare) } else { bare }, colour, several, place })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ViewThird::{Left, Middle, Right};

    fn places(text: &str) -> Vec<ViewThird> {
        place_phrases(&text.split(' ').collect::<Vec<_>>()).into_iter().map(|phrase| phrase.place).collect()
    }

    #[test]
    fn places_in_the_view_are_found() {
        for (text, wanted) in [
            ("a bed on the left", vec![Left]),
            ("on the left side of the room there is a bed", vec![Left]),
            ("a bed to the right and a lamp in the centre", vec![Right, Middle]),
            ("in the center of the image", vec![Middle]),
            ("a door straight ahead", vec![Middle]),
            ("a kitchen in the background", vec![Middle]),
            ("in the far left corner", vec![Left]),
            ("on your right", vec![Right]),
            ("against the right wall", vec![Right]),
            ("on the left side of the kitchen", vec![Left]),
            ("a chair in front of you", vec![Middle]),
        ] {
            assert_eq!(places(text), wanted, "{text}");
        }
    }

    #[test]
    fn places_in_relation_to_things_are_not_places_in_the_view() {
        for text in [
            "to the left of the sofa",
            "on the right side of the bed",
            "in the middle of the table",
            "to its left",
            "in front of the sofa",
            "right next to the bed",
            "what is left",
            "",
        ] {
            assert_eq!(places(text), [], "{text}");
        }
    }

    #[test]
    fn colours_are_found_with_their_shades() {
        let first = |text: &str| first_colour(&text.split(' ').collect::<Vec<_>>());
        assert_eq!(first("it is dark gray"), Some("dark grey".into()));
        assert_eq!(first("a light wooden table and a red one"), Some("red".into()));
        assert_eq!(first("burgundy"), Some("burgundy".into()));
        assert_eq!(first("light"), None);
        assert_eq!(first(""), None);
    }

    #[test]
    fn colour_said_of_needs_a_link_verb() {
        let said = |text: &str| colour_said_of(&text.split(' ').collect::<Vec<_>>());
        assert_eq!(said("is red"), Some("red".into()));
        assert_eq!(said("appears to be mostly light blue"), Some("light blue".into()));
        assert_eq!(said("and a red chair"), None);
        assert_eq!(said("is on a red rug"), None);
    }
}
