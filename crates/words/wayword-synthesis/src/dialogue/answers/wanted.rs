//! The things that a question asks for.

use super::{
    colour::colour_at,
    names::{says_several, singular},
    place::phrases,
};
use wayword_core::Where;
use wayword_language::{
    answers::{ANYTHING, FILLERS},
    lexicon::{is_thing, normal},
    reading::vocabulary::{ABSTRACT, BREAKERS},
};

/// Longest name that is asked for, bytes.
const MOST_NAME_BYTES: usize = 60;
/// Most things that one question asks for.
const MOST_THINGS: usize = 8;

/// A thing that a question asks for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wanted {
    /// Its name as it is asked for, without article and adjectives of size.
    pub(crate) said: String,
    /// The name without its colour, in the singular where it is no plural by nature.
    pub(crate) name: String,
    /// The colour that is asked for.
    pub(crate) colour: Option<String>,
    /// Whether the question speaks of several.
    pub(crate) several: bool,
    /// The part of the view that is asked about.
    pub(crate) place: Option<Where>,
}

/// The things that words ask for, with "or", "and" or commas between them, and whether it is an "or".
pub(super) fn list(words: &[&str]) -> Option<(Vec<Wanted>, bool)> {
    let place = phrases(words).first().map(|phrase| phrase.place);
    let mut found: Vec<Wanted> = Vec::new();
    let mut at = 0;
    let mut or = false;
    loop {
        let name = noun(words, &mut at)?;
        found.push(wanted(&name, place)?);
        match words.get(at) {
            Some(&"or") => or = true,
            Some(&"and") => {}
            Some(&",") if words[at..].iter().any(|word| matches!(*word, "or" | "and")) => {
                at += usize::from(matches!(words.get(at + 1), Some(&"or" | &"and")));
                or |= words[at] == "or";
            }
            _ => return Some((found, or)),
        }
        at += 1;
        if found.len() == MOST_THINGS || noun(words, &mut at.clone()).and_then(|name| wanted(&name, None)).is_none() {
            return Some((found, or));
        }
    }
}

/// The words of a noun phrase from `at` on, and `at` moved behind it.
pub(super) fn noun<'a>(words: &[&'a str], at: &mut usize) -> Option<Vec<&'a str>> {
    while words.get(*at).is_some_and(|word| FILLERS.contains(word)) {
        *at += 1;
    }
    let start = *at;
    let in_name = |at: usize| {
        let word = words[at];
        let of = word == "of"
            && at > start
            && (1..=3)
                .any(|more| words.get(start..at + 1 + more).is_some_and(|name| is_thing(&normal(&name.join(" ")))));
        let is_word = word.starts_with(char::is_alphanumeric);
        is_word
            && at < start + 6
            && (of || !BREAKERS.contains(&word) || (at == start && matches!(word, "hanging" | "standing")))
            && !matches!(word, "visible" | "present" | "mentioned" | "really" | "actually" | "here" | "anywhere")
    };
    while *at < words.len() && in_name(*at) {
        *at += 1;
    }
    let found = words[start..*at].to_vec();
    // "The lamp you mentioned": behind the name, up to the next joint.
    while words.get(*at).is_some_and(|word| !matches!(*word, "or" | "and" | ",")) {
        *at += 1;
    }
    (!found.is_empty()).then_some(found)
}

/// The thing that words begin with.
pub(super) fn phrase(words: &[&str]) -> Option<Wanted> {
    wanted(&noun(words, &mut 0)?, None)
}

/// A name as a wanted thing; `None` where it names nothing in particular.
pub(super) fn wanted(name: &[&str], place: Option<Where>) -> Option<Wanted> {
    let head = normal(name.last()?);
    let nothing = |word: &str| ANYTHING.contains(&word);
    let vague = ABSTRACT.contains(&head.as_str()) && !is_thing(&normal(&name.join(" ")));
    if vague || nothing(&head) || name.iter().any(|word| nothing(word)) {
        return None;
    }
    let said = name.join(" ");
    if said.len() > MOST_NAME_BYTES {
        return None;
    }
    let in_lexicon = is_thing(&normal(&said));
    let (colour, length) =
        colour_at(name).filter(|_| !in_lexicon).map_or((None, 0), |(colour, length)| (Some(colour), length));
    let bare = name[length..].join(" ");
    if bare.is_empty() {
        return None;
    }
    let several = says_several(&bare);
    Some(Wanted { said, name: if several { singular(&bare) } else { bare }, colour, several, place })
}
