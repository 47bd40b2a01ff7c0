//! Which words of a text name things and rooms.

use std::{collections::BTreeSet, ops::Range};
use wayword_language::{
    answers::{BRINGS_IN, NO_OBJECTS},
    lexicon::{normal, thing},
    reading::{What, read, vocabulary::ABSTRACT},
    text::Token,
};

/// Longest name that counts as one, bytes.
const MOST_NAME_BYTES: usize = 60;

/// A thing or a room among the words of a text.
pub(super) struct Noun {
    pub(super) at: Range<usize>,
    pub(super) is_thing: bool,
    pub(super) is_room: bool,
    pub(super) colour: Option<String>,
}

/// The things and rooms that a text names, in order. `known` holds names, in normal spelling, that the lexicon may lack.
pub(super) fn nouns(text: &str, tokens: &[Token], words: &[&str], known: &BTreeSet<String>) -> Vec<Noun> {
    let places = read(text, known).events.into_iter().filter_map(|event| match event.what {
        What::Place(place) => Some((event.span, place)),
        _ => None,
    });
    places
        .filter_map(|(span, place)| {
            let from = tokens.partition_point(|token| token.span[0] < span[0]);
            let to = tokens.partition_point(|token| token.span[0] < span[1]);
            let name = words[from..to].join(" ");
            let in_lexicon = thing(&name).is_some() || place.is_room || known.contains(&normal(&name));
            let is_object = if in_lexicon {
                !is_the_picture(words, from, to) && !is_manner_of_speaking(words, from, to)
            } else {
                is_brought_in(words, from, to)
            };
            (is_object && !is_depicted(words, from) && name.len() <= MOST_NAME_BYTES).then_some(Noun {
                at: from..to,
                is_thing: place.is_thing,
                is_room: place.is_room,
                colour: place.colour,
            })
        })
        .collect()
}

/// "The picture shows", "in this photo", "a picture of a kitchen": the view itself and nothing on a wall of it.
fn is_the_picture(words: &[&str], from: usize, to: usize) -> bool {
    let single = to == from + 1 && matches!(words[from], "picture" | "photo" | "photograph");
    let word = |at: usize| words.get(at).copied().unwrap_or("");
    let before = if from > 0 { word(from - 1) } else { "" };
    let hangs = matches!(word(to), "on" | "above" | "over" | "hanging" | "hangs" | "frame" | "frames");
    let brought_in = words[..from].iter().any(|word| matches!(*word, "there" | "see" | "has" | "with"));
    let of_all = word(to) == "of" && from <= 4 && !brought_in;
    let shows = matches!(word(to), "shows" | "depicts" | "features" | "contains" | "captures" | "showing" | "itself");
    single && !hangs && (matches!(before, "the" | "this") || of_all || shows)
}

/// "A painting of a horse": the horse is on it and not there.
fn is_depicted(words: &[&str], from: usize) -> bool {
    let picture = |word: &str| {
        matches!(
            word,
            "picture" | "pictures" | "painting" | "paintings" | "photo" | "photos" | "portrait" | "poster" | "print"
        )
    };
    let near = (from.saturating_sub(4)..from).rev().find(|at| words[*at] == "of").filter(|of| *of > 0);
    near.is_some_and(|of| picture(words[of - 1]) && !is_the_picture(words, of - 1, of))
}

/// "A range of colours", "in shades of blue", "the light from the window", "tasteful decor".
fn is_manner_of_speaking(words: &[&str], from: usize, to: usize) -> bool {
    if to != from + 1 {
        return false;
    }
    match (words[from], words.get(to).copied().unwrap_or("")) {
        ("decor", _) => true,
        ("range" | "shade" | "shades" | "case" | "cover" | "scale" | "stage", "of") => true,
        ("light", next) => {
            matches!(
                next,
                "from" | "streaming" | "coming" | "comes" | "enters" | "shining" | "shines" | "pouring" | "that"
            )
        }
        _ => false,
    }
}

/// A noun that the lexicon lacks counts where it is said to be there or not, and is no word of describing.
fn is_brought_in(words: &[&str], from: usize, to: usize) -> bool {
    let head = normal(words[to - 1]);
    let start = (0..from).rev().find(|at| matches!(words[*at], "." | "!" | "?" | ";")).map_or(0, |at| at + 1);
    let indefinite = from > 0 && matches!(words[from - 1], "a" | "an");
    let stays = |word: &str| !NO_OBJECTS.contains(&normal(word).as_str()) && !word.ends_with("ing") && word != "shows";
    indefinite
        && to - from <= 3
        && words[from..to].iter().all(|word| stays(word))
        && !ABSTRACT.contains(&head.as_str())
        && words[start..from].iter().any(|word| BRINGS_IN.contains(word))
}
