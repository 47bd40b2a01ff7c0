//! The words of a language for what has a name in English.

use super::{PACKS, PackFiles, READ_PACKS};
use crate::Language;
use crate::data;
use crate::lexicon::{kinds_of, normalise_name, room_name};
use std::collections::HashMap;
use std::sync::LazyLock;

/// The classes of words that name things, rooms and their parts.
const NAME_CLASSES: [&str; 4] = ["thing", "room", "door", "stairs"];
/// The class of words for colours and materials.
const LOOK: &str = "look";

/// The words of a language by their English words, the first of each row.
struct NamingWords {
    language: &'static str,
    names: HashMap<String, &'static str>,
    looks: HashMap<String, &'static str>,
}

static NAMING_WORDS: LazyLock<Vec<NamingWords>> = LazyLock::new(|| PACKS.iter().map(NamingWords::of_pack).collect());

impl NamingWords {
    fn of_pack(files: &PackFiles) -> Self {
        let mut words = Self { language: files.language, names: HashMap::new(), looks: HashMap::new() };
        for line in data::content_lines(files.words) {
            let [class, english, own] = data::row_columns(line);
            let Some(first) = own.split(|c: char| if files.is_spaced { c == ',' } else { c.is_whitespace() }).next()
            else {
                continue;
            };
            if NAME_CLASSES.contains(&class) {
                words.names.entry(normalise_name(english)).or_insert(first.trim());
                if let Some(usual) = room_name(english) {
                    words.names.entry(normalise_name(usual)).or_insert(first.trim());
                }
            } else if class == LOOK {
                words.looks.entry(english.to_owned()).or_insert(first.trim());
            }
        }
        words
    }

    fn of_language(tag: &str) -> Option<&'static Self> {
        let Language::Other(language) = Language::from_tag(tag) else { return None };
        NAMING_WORDS.iter().find(|words| words.language == language)
    }
}

/// The usual word of a language, by its tag, for a thing, a room, a door or stairs with this English name; a more general word where the
/// language has none for the name itself.
#[must_use]
pub fn word_for_name(tag: &str, english: &str) -> Option<&'static str> {
    let words = NamingWords::of_language(tag)?;
    let whole = normalise_name(english);
    let room = room_name(english).map(normalise_name);
    let kinds = kinds_of(english).into_iter().map(|kind| normalise_name(&kind));
    let mut names = [whole].into_iter().chain(room).chain(kinds);
    names.find_map(|name| words.names.get(&name).copied())
}

/// The word of a language, by its tag, for a colour or a material with this English name.
#[must_use]
pub fn word_for_look(tag: &str, english: &str) -> Option<&'static str> {
    NamingWords::of_language(tag)?.looks.get(english).copied()
}

/// The English words of the things and rooms that words of a language, by its tag, name.
#[must_use]
pub fn names_within(tag: &str, words: &str) -> Vec<String> {
    let Language::Other(language) = Language::from_tag(tag) else { return Vec::new() };
    let pack = READ_PACKS.iter().find(|pack| pack.language == language);
    pack.map(|pack| pack.named_in(words)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::languages::ReadableText;
    use crate::lexicon::{LexiconThing, ThingClass, find_thing, names_agree, same_room};
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    #[test]
    fn a_name_has_its_own_word_or_that_of_its_kind() {
        for (english, chinese) in [
            ("sofa", "沙发"),
            ("couch", "沙发"),
            ("old oak table", "桌子"),
            ("dining room", "餐厅"),
            ("corridor", "走廊"),
            ("doorway", "门口"),
        ] {
            assert_eq!(word_for_name("zh-CN", english), Some(chinese), "{english}");
        }
        assert_eq!(word_for_name("zh", "zorble"), None);
        assert_eq!(word_for_name("en", "sofa"), None);
        assert_eq!(names_within("zh", "走到{l}旁边的卧室"), ["bedroom"]);
        assert_eq!((word_for_look("zh", "red"), word_for_look("zh", "plaid")), (Some("红色"), None));
    }

    #[test]
    fn every_landmark_of_the_lexicon_has_a_chinese_name_that_is_read_as_it() {
        let names = data::content_lines(include_str!("en/objects.txt")).map(|line| data::row_columns::<1>(line)[0]);
        let is_landmark = |thing: &LexiconThing| thing.salience > 0 && thing.class != ThingClass::Fabric;
        let is_read = |name: &str, word: &str| {
            let text = format!("经过{word}。");
            let reading = read_instruction(ReadableText::new(&text, Some("zh")).english(), &BTreeSet::new());
            reading.events.iter().any(|event| {
                matches!(&event.what, EventContent::Place(place) if names_agree(&place.name, name) || same_room(&place.name, name))
            })
        };
        let landmarks = names.filter(|name| find_thing(name).is_some_and(is_landmark));
        let wrong: Vec<&str> =
            landmarks.filter(|name| !word_for_name("zh", name).is_some_and(|word| is_read(name, word))).collect();
        assert!(wrong.is_empty(), "{wrong:?}");
    }
}
