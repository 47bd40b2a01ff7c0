//! Finds the objects and rooms that a text names. It uses only the names of the lexicon, and none of the reader's rules.

use std::collections::BTreeSet;
use wayword_language::lexicon::{ThingClass, find_thing, is_room, is_thing, longest_name, normal_word};

/// Words that begin a phrase that names something.
const DETERMINERS: [&str; 36] = [
    "the", "a", "an", "your", "this", "that", "another", "each", "any", "some", "its", "first", "second", "third",
    "fourth", "last", "next", "one", "two", "three", "four", "five", "six", "of", "with", "by", "beside", "near",
    "both", "past", "between", "above", "below", "under", "all", "nearest",
];
/// A determiner is at most this many words before its name.
const DETERMINER_REACH_WORDS: usize = 4;

/// The word for a room of any kind.
const ANY_ROOM: &str = "room";

/// A name in a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LexiconName {
    /// The index of its first word.
    pub(super) start: usize,
    /// The index of the word after its last one.
    pub(super) end: usize,
    /// The name as the lexicon spells it.
    pub(super) name: String,
    /// Whether the name can be a room's.
    pub(super) is_room: bool,
    /// Whether the name can be an object's.
    pub(super) is_thing: bool,
}

impl LexiconName {
    /// Whether it is a visible object: neither stairs, nor a door, nor a wall.
    pub(super) fn is_object(&self) -> bool {
        self.is_seen() && !matches!(self.thing_class(), Some(ThingClass::Stairs | ThingClass::Door))
    }

    /// Whether it is visible and no room: an object, stairs or a door.
    pub(super) fn is_seen(&self) -> bool {
        let is_stairs = self.thing_class() == Some(ThingClass::Stairs);
        self.is_thing && (is_stairs || !self.is_room) && !matches!(self.thing_class(), Some(ThingClass::Fabric) | None)
    }

    /// The name of a room; empty for "the room".
    pub(super) fn room_word(&self) -> String {
        if self.name == ANY_ROOM { String::new() } else { self.name.clone() }
    }

    /// Whether it is a wall, a floor, or another part of the building itself.
    pub(super) fn is_fabric_part(&self) -> bool {
        self.thing_class() == Some(ThingClass::Fabric)
    }

    fn thing_class(&self) -> Option<ThingClass> {
        find_thing(&self.name).map(|thing| thing.class)
    }
}

/// The words of a text, without marks, in lower case.
pub(super) fn split_words(text: &str) -> Vec<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '\'').filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// The names among words: the longest at each place. A word that may be a verb is a name only after an article.
pub(super) fn find_names(words: &[String]) -> Vec<LexiconName> {
    let mut found = all_names(words, &BTreeSet::new());
    found.retain(|name| is_introduced(words, name));
    found
}

/// The names among words, also those without an article. `known` adds names of things in normal spelling; "room" alone counts too.
pub(super) fn find_names_with(words: &[String], known: &BTreeSet<String>) -> Vec<LexiconName> {
    all_names(words, known)
}

fn all_names(words: &[String], known: &BTreeSet<String>) -> Vec<LexiconName> {
    let normal: Vec<String> = words.iter().map(|word| normal_word(word)).collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let most = longest_name().max(3).min(words.len() - at);
        let longest = (1..=most).rev().find_map(|length| {
            let name = normal[at..at + length].join(" ");
            let is_any_room = name == ANY_ROOM && !known.is_empty();
            let (is_room, is_thing) = (is_room(&name) || is_any_room, is_thing(&name) || known.contains(&name));
            (is_room || is_thing).then_some(LexiconName { start: at, end: at + length, name, is_room, is_thing })
        });
        match longest {
            Some(name) => {
                at = name.end;
                found.push(name);
            }
            None => at += 1,
        }
    }
    found
}

/// Whether a name has more than one word, or a determiner comes before it.
fn is_introduced(words: &[String], name: &LexiconName) -> bool {
    let before = &words[name.start.saturating_sub(DETERMINER_REACH_WORDS)..name.start];
    name.end - name.start > 1 || before.iter().any(|word| DETERMINERS.contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<(String, bool)> {
        find_names(&split_words(text)).into_iter().map(|name| (name.name.clone(), name.is_object())).collect()
    }

    #[test]
    fn the_longest_name_counts_and_stairs_are_no_object() {
        let found = names("Walk past the Coffee Tables, up the stairs into the bedroom.");
        assert_eq!(
            found,
            [("coffee table", true), ("stair", false), ("bedroom", false)].map(|(n, o)| (n.to_owned(), o))
        );
    }

    #[test]
    fn a_verb_is_no_name() {
        assert!(names("stand still, light up").is_empty());
    }
}
