//! Finds the rooms and objects that a text names, by this generator's own word lists and the building's labels.

use super::{
    building::{LabelledBuilding, singular_words, to_singular},
    lists::{OBJECT_WORDS, ROOM_WORDS, SMALL_WORDS, has_word},
    text::PlainWord,
};
use wayword_core::DVec3;

/// The most words that a name has; a longer one is not found.
const MAX_NAME_WORDS: usize = 3;

/// A room or an object that a text names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct BuildingMention {
    /// Byte range of the name, with the adjectives that belong to it, without its article.
    pub(super) span: [usize; 2],
    /// The article "a" or "an" before it.
    pub(super) article: Option<[usize; 2]>,
    /// Whether it is a room.
    pub(super) is_room: bool,
    /// The room's kind in the list of rooms, or the object's name.
    pub(super) name: String,
    /// Whether the name is in the plural.
    pub(super) is_plural: bool,
}

/// The names in a text, in its order. At each word the longest name counts.
pub(super) fn find_mentions(words: &[PlainWord], building: &LabelledBuilding) -> Vec<BuildingMention> {
    let mut names = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let longest = (1..=MAX_NAME_WORDS).rev().find_map(|count| {
            let part = words.get(at..at + count)?;
            let is_whole_name = part[1..].iter().all(|word| word.is_joined) && ends_name(words, at + count);
            let named = if is_whole_name {
                room_mention(words, at, count).or_else(|| object_mention(words, at, count, building))
            } else {
                None
            };
            named.map(|named| (count, named))
        });
        names.extend(longest.clone().map(|(_, named)| named));
        at += longest.map_or(1, |(count, _)| count);
    }
    names
}

/// Whether a name may end before this word: another noun would make it a part of a longer name.
fn ends_name(words: &[PlainWord], next: usize) -> bool {
    words.get(next).is_none_or(|word| !word.is_joined || has_word(&SMALL_WORDS, "after a name", &word.low))
}

/// Words in lower case with a space between them.
fn joined_name(words: &[PlainWord]) -> String {
    words.iter().map(|word| word.low.as_str()).collect::<Vec<_>>().join(" ")
}

/// The kind of room that a name means: its key in the list of rooms.
fn room_kind(name: &str) -> Option<&'static str> {
    // A toilet is a thing where a text names one, and a room where a platform does.
    let mut kinds = ROOM_WORDS.iter().filter(|(kind, _)| !kind.ends_with("stairs"));
    kinds.find(|(_, names)| name != "toilet" && names.contains(&name)).map(|(kind, _)| *kind)
}

/// A room that `count` words from `at` on name, with the modifiers before them.
fn room_mention(words: &[PlainWord], at: usize, count: usize) -> Option<BuildingMention> {
    let kind = room_kind(&joined_name(&words[at..at + count]))?;
    let mut first = at;
    while words[first].is_joined && has_word(&SMALL_WORDS, "room modifiers", &words[first - 1].low) {
        first -= 1;
    }
    let span = [words[first].span[0], words[at + count - 1].span[1]];
    Some(BuildingMention {
        span,
        article: article_before(words, first),
        is_room: true,
        name: kind.to_owned(),
        is_plural: false,
    })
}

/// An object that `count` words from `at` on name, where a determiner comes before it.
fn object_mention(
    words: &[PlainWord],
    at: usize,
    count: usize,
    building: &LabelledBuilding,
) -> Option<BuildingMention> {
    let name = joined_name(&words[at..at + count]);
    let singular = singular_words(&name);
    let named = singular.join(" ");
    let in_list = OBJECT_WORDS.keys().find(|object| **object == named).map(|object| (*object).to_owned());
    let is_known = in_list.is_some() || building.has_label(&singular);
    let is_ignored = has_word(&SMALL_WORDS, "ignored", &named) || has_word(&SMALL_WORDS, "ignored", &name);
    if !is_known || is_ignored || room_kind(&named).is_some() || !is_determined(words, at) {
        return None;
    }
    let last = &words[at + count - 1];
    let span = [words[at].span[0], last.span[1]];
    let is_plural = to_singular(&last.low) != last.low;
    Some(BuildingMention {
        span,
        article: article_before(words, at),
        is_room: false,
        name: in_list.unwrap_or(named),
        is_plural,
    })
}

/// Whether a determiner comes before a name, with at most two adjectives between them.
fn is_determined(words: &[PlainWord], at: usize) -> bool {
    let mut at = at;
    for _ in 0..3 {
        if at == 0 || !words[at].is_joined {
            return false;
        }
        at -= 1;
        let word = words[at].low.as_str();
        if has_word(&SMALL_WORDS, "determiners", word) {
            return true;
        }
        // "The kitchen table" is not any table.
        if room_kind(word).is_some() || has_word(&SMALL_WORDS, "after a name", word) {
            return false;
        }
    }
    false
}

/// The article "a" or "an" right before a word.
fn article_before(words: &[PlainWord], at: usize) -> Option<[usize; 2]> {
    let before = words.get(at.checked_sub(1)?).filter(|_| words[at].is_joined)?;
    matches!(before.low.as_str(), "a" | "an").then_some(before.span)
}

impl BuildingMention {
    /// The positions of all rooms or objects of the building that the name may mean, metres.
    pub(super) fn possible_positions(&self, building: &LabelledBuilding) -> Vec<DVec3> {
        if self.is_room { building.room_positions(&self.name) } else { building.object_positions(&self.name) }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{building::tests::made_up_building, text::split_words},
        *,
    };

    fn told(text: &str) -> Vec<(String, String)> {
        let names = find_mentions(&split_words(text), &made_up_building());
        names.into_iter().map(|named| (text[named.span[0]..named.span[1]].to_owned(), named.name)).collect()
    }

    #[test]
    fn rooms_and_labelled_objects_are_found_as_whole_names() {
        let text =
            "Exit the master bedroom, pass the brown couch and the coffee table, and stop by a piano in the lounge.";
        let expected = [
            ("master bedroom", "bedroom"),
            ("couch", "couch"),
            ("coffee table", "coffee table"),
            ("piano", "piano"),
            ("lounge", "living room"),
        ];
        assert_eq!(told(text), expected.map(|(words, name)| (words.to_owned(), name.to_owned())));
    }

    #[test]
    fn parts_of_longer_names_and_parts_of_every_building_are_no_names() {
        for text in [
            "Open the bedroom door",
            "Pass the kitchen table",
            "Follow the wall to the stairs",
            "Pass the lamp post",
            "Chairs everywhere",
        ] {
            assert_eq!(told(text), [], "{text}");
        }
    }

    #[test]
    fn names_have_their_article_and_their_number() {
        let text = "Pass an old mirror, the towels and a bench";
        let names = find_mentions(&split_words(text), &made_up_building());
        let told: Vec<_> = names.iter().map(|named| (named.article.is_some(), named.is_plural)).collect();
        assert_eq!(told, [(false, false), (false, true), (true, false)]);
    }
}
