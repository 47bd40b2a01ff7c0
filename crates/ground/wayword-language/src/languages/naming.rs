//! The words of a language for what has a name in English.

use super::{PACKS, PackFiles, READ_PACKS};
use crate::Language;
use crate::data;
use crate::lexicon::{kinds_of, normalise_name, room_name};
use std::collections::HashMap;
use std::sync::LazyLock;

/// Whether a name is meant as that of a thing or of a room: "toilet" is both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameSense {
    /// A thing, a door or stairs.
    Thing,
    /// A room.
    Room,
}

/// The classes of words that name things, rooms and their parts.
const NAME_CLASSES: [(&str, NameSense); 4] =
    [("thing", NameSense::Thing), ("room", NameSense::Room), ("door", NameSense::Thing), ("stairs", NameSense::Thing)];
/// The class of words for colours and materials.
const LOOK: &str = "look";

/// The words of a language by their English words, the first of each row.
struct NamingWords {
    language: &'static str,
    things: HashMap<String, &'static str>,
    rooms: HashMap<String, &'static str>,
    looks: HashMap<String, &'static str>,
}

static NAMING_WORDS: LazyLock<Vec<NamingWords>> = LazyLock::new(|| PACKS.iter().map(NamingWords::of_pack).collect());

impl NamingWords {
    fn of_pack(files: &PackFiles) -> Self {
        let (things, rooms, looks) = (HashMap::new(), HashMap::new(), HashMap::new());
        let mut words = Self { language: files.language, things, rooms, looks };
        for line in data::content_lines(files.words) {
            let [class, english, own] = data::row_columns(line);
            let Some(first) = own.split(|c: char| if files.is_spaced { c == ',' } else { c.is_whitespace() }).next()
            else {
                continue;
            };
            if let Some((_, sense)) = NAME_CLASSES.iter().find(|(name, _)| *name == class) {
                let names = if *sense == NameSense::Room { &mut words.rooms } else { &mut words.things };
                names.entry(normalise_name(english)).or_insert(first.trim());
                if let Some(usual) = room_name(english) {
                    names.entry(normalise_name(usual)).or_insert(first.trim());
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

/// The usual word of a language, by its tag, for a thing or a room with this English name; a more general word where the language has none
/// for the name itself.
#[must_use]
pub fn word_for_name(tag: &str, english: &str, sense: NameSense) -> Option<&'static str> {
    let words = NamingWords::of_language(tag)?;
    let whole = normalise_name(english);
    let room = room_name(english).map(normalise_name);
    let kinds = kinds_of(english).into_iter().map(|kind| normalise_name(&kind));
    let names: Vec<String> = [whole].into_iter().chain(room).chain(kinds).collect();
    let (first, other) = match sense {
        NameSense::Thing => (&words.things, &words.rooms),
        NameSense::Room => (&words.rooms, &words.things),
    };
    [first, other].into_iter().find_map(|table| names.iter().find_map(|name| table.get(name))).copied()
}

/// The word of a language, by its tag, for a colour or a material with this English name.
#[must_use]
pub fn word_for_look(tag: &str, english: &str) -> Option<String> {
    let looks = &NamingWords::of_language(tag)?.looks;
    let english = &english.replace("gray", "grey");
    if let Some(own) = looks.get(english) {
        return Some((*own).to_owned());
    }
    // "Light blue" is made of the beginning of "light-coloured" and "blue".
    let (shade, colour) = english.split_once([' ', '-'])?;
    let shade = looks.get(shade)?.chars().next().filter(|_| ["light", "dark"].contains(&shade))?;
    Some(format!("{shade}{}", looks.get(colour)?))
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
            assert_eq!(word_for_name("zh-CN", english, NameSense::Thing), Some(chinese), "{english}");
        }
        let toilet = [NameSense::Thing, NameSense::Room].map(|sense| word_for_name("zh", "toilet", sense));
        assert_eq!(toilet, [Some("马桶"), Some("厕所")]);
        assert_eq!(word_for_name("zh", "zorble", NameSense::Thing), None);
        assert_eq!(word_for_name("en", "sofa", NameSense::Thing), None);
        assert_eq!(names_within("zh", "走到{l}旁边的卧室"), ["bedroom"]);
    }

    #[test]
    fn every_colour_has_a_chinese_word() {
        let colours = include_str!("en/colours.txt");
        let all = data::content_lines(colours).flat_map(|line| line.split(',')).map(str::trim);
        let shades = all.flat_map(|colour| ["", "light ", "dark "].map(|shade| format!("{shade}{colour}")));
        let missing: Vec<String> = shades.filter(|colour| word_for_look("zh", colour).is_none()).collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert_eq!(word_for_look("zh", "dark grey").as_deref(), Some("深灰色"));
        assert_eq!(word_for_look("zh", "plaid"), None);
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
        let wrong: Vec<&str> = landmarks
            .filter(|name| !word_for_name("zh", name, NameSense::Thing).is_some_and(|word| is_read(name, word)))
            .collect();
        assert!(wrong.is_empty(), "{wrong:?}");
    }
}
