//! Replaces the things and rooms that a text names by others. Names are found by reading the text as the checks do, and the result is
//! read again to make sure that no old name is left.

use super::casing::{LetterCase, replace_spans};
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::seeded_rng;
use wayword_language::{
    lexicon::{ThingClass, find_thing, names_agree, normal_word, room_name, same_room, to_plural},
    reading::{EventContent, PlaceMention, read_instruction},
};

/// What one does at a thing, or how it stands in a room. A thing is replaced by one of its role, so that the text stays one that somebody could
/// have written: one goes through an arch and not through a lamp, and walks up a ladder and not up a rug.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ThingRole {
    /// One goes through it.
    Passage,
    /// One goes up and down on it.
    Climb,
    /// It stands on the floor, and one walks past it or around it.
    Furniture,
    /// It has water or a plug.
    Fixture,
    /// It hangs on a wall, or is in one.
    Wall,
    /// It stands or lies about.
    Ornament,
}

/// Things that replace others of their role: common in homes, and clearly different from each other.
const REPLACEMENT_THINGS: [(ThingRole, &str); 37] = [
    (ThingRole::Passage, "door"),
    (ThingRole::Passage, "doorway"),
    (ThingRole::Passage, "gate"),
    (ThingRole::Passage, "arch"),
    (ThingRole::Climb, "ramp"),
    (ThingRole::Climb, "ladder"),
    (ThingRole::Furniture, "sofa"),
    (ThingRole::Furniture, "bed"),
    (ThingRole::Furniture, "dining table"),
    (ThingRole::Furniture, "piano"),
    (ThingRole::Furniture, "desk"),
    (ThingRole::Furniture, "bookshelf"),
    (ThingRole::Furniture, "wardrobe"),
    (ThingRole::Furniture, "bench"),
    (ThingRole::Furniture, "ottoman"),
    (ThingRole::Furniture, "armchair"),
    (ThingRole::Furniture, "pool table"),
    (ThingRole::Fixture, "refrigerator"),
    (ThingRole::Fixture, "bathtub"),
    (ThingRole::Fixture, "toilet"),
    (ThingRole::Fixture, "sink"),
    (ThingRole::Fixture, "washing machine"),
    (ThingRole::Fixture, "stove"),
    (ThingRole::Fixture, "microwave"),
    (ThingRole::Wall, "fireplace"),
    (ThingRole::Wall, "television"),
    (ThingRole::Wall, "mirror"),
    (ThingRole::Wall, "clock"),
    (ThingRole::Wall, "curtain"),
    (ThingRole::Wall, "window"),
    (ThingRole::Wall, "picture"),
    (ThingRole::Ornament, "lamp"),
    (ThingRole::Ornament, "plant"),
    (ThingRole::Ornament, "vase"),
    (ThingRole::Ornament, "statue"),
    (ThingRole::Ornament, "basket"),
    (ThingRole::Ornament, "column"),
];
/// Rooms that replace others.
const REPLACEMENT_ROOMS: [&str; 13] = [
    "kitchen",
    "bedroom",
    "bathroom",
    "living room",
    "dining room",
    "office",
    "garage",
    "laundry room",
    "gym",
    "closet",
    "balcony",
    "entryway",
    "attic",
];
/// What replaces a hallway, because one walks along it.
const LONG_ROOM: &str = "balcony";
/// Most rounds of reading and replacing. One round is not enough, because the reader finds some names only after others are replaced.
const MAX_REPLACEMENT_ROUNDS: usize = 3;
/// How far before a name the names that specify it are looked for ("bathroom" in "bathroom door"), bytes.
const SPECIFIER_REACH_BYTES: usize = 60;

/// Most different names of a text; a text with more is not swapped. Texts by people have up to about 30.
const MAX_NAMES: usize = 60;

/// The text with each of its things and rooms replaced by another of the kind that it does not name, equal names by
/// equal ones. `None` where it names none, or where no name is left to replace one.
pub(super) fn swap_landmarks(text: &str, seed: u64, item: &str) -> Option<String> {
    let mut others = LandmarkReplacements::new(seed, item);
    let mut new = text.to_owned();
    for _ in 0..MAX_REPLACEMENT_ROUNDS {
        let named = find_names(&new);
        others.avoid_names(&named);
        let old: Vec<&NameMention> = named.iter().filter(|named| others.is_old(named)).collect();
        let edits: Option<Vec<_>> = old.into_iter().map(|named| others.edits_for_name(&new, named)).collect();
        let edits = edits?.concat();
        if edits.is_empty() {
            break;
        }
        new = replace_spans(&new, &edits);
    }
    let stays = find_names(&new).iter().any(|named| others.is_old(named));
    (new != text && !stays).then_some(new)
}

/// A name in a text.
#[derive(Debug, Clone)]
struct NameMention {
    name: String,
    is_room: bool,
    /// The bytes of the name together with the names before it that specify it, as in "bathroom door".
    span: [usize; 2],
    /// Those specifying names.
    specifiers: Vec<String>,
}

/// The names of a text in their order, whether the text affirms or denies them.
fn find_names(text: &str) -> Vec<NameMention> {
    let mut all: Vec<NameMention> = Vec::new();
    for event in read_instruction(text, &BTreeSet::new()).events {
        let EventContent::Place(PlaceMention { name, is_room, is_thing, .. }) = event.what else { continue };
        if !is_known(&name) && ends_in_joint(&name) {
            continue;
        }
        let mut named = NameMention { name, is_room: is_room && !is_thing, span: event.span, specifiers: Vec::new() };
        let end = all.last().map_or(0, |before| before.span[1]);
        while let Some((start, name)) = closing_name(&text[end..named.span[0]]) {
            named.span[0] = end + start;
            named.specifiers.push(name);
        }
        all.push(named);
    }
    all
}

/// Whether the lexicon has a name for a thing or a room.
fn is_known(name: &str) -> bool {
    find_thing(name).is_some() || room_name(name).is_some()
}

/// Whether a name ends in a word that joins it to the next one. The reader takes such runs for names in "exit the building via the
/// door" or "exit the room using the door".
fn ends_in_joint(name: &str) -> bool {
    let last = name.rsplit(' ').next().unwrap_or_default();
    matches!(last, "via" | "thru" | "passed") || (last.ends_with("ing") && last.len() > 5)
}

/// The name with which a text ends, if the lexicon has it, and the byte at which the name begins.
fn closing_name(text: &str) -> Option<(usize, String)> {
    let from = text.ceil_char_boundary(text.len().saturating_sub(SPECIFIER_REACH_BYTES));
    let last = read_instruction(&text[from..], &BTreeSet::new()).events.pop()?;
    let EventContent::Place(place) = last.what else { return None };
    let gap = &text[from + last.span[1]..];
    (is_known(&place.name) && !gap.is_empty() && gap.trim().is_empty()).then_some((from + last.span[0], place.name))
}

/// The role of a thing by its name. What the lexicon does not have stands about like furniture.
fn role_of(name: &str) -> ThingRole {
    use ThingClass as Class;
    let Some(thing) = find_thing(name) else { return ThingRole::Furniture };
    match thing.class {
        _ if matches!(thing.name, "doorway" | "arch") => ThingRole::Passage,
        _ if matches!(thing.name, "ramp" | "ladder") => ThingRole::Climb,
        _ if matches!(thing.name, "basket" | "box" | "trash can") => ThingRole::Ornament,
        Class::Door => ThingRole::Passage,
        Class::Stairs => ThingRole::Climb,
        Class::Appliance | Class::Cooker | Class::Fridge | Class::Basin | Class::Tap | Class::Toilet | Class::Tub => {
            ThingRole::Fixture
        }
        Class::WallArt | Class::Glass | Class::Drape | Class::Screen | Class::Hearth | Class::Switch => ThingRole::Wall,
        Class::Textile
        | Class::Light
        | Class::Plant
        | Class::Ornament
        | Class::Small
        | Class::Fan
        | Class::Structure
        | Class::Fabric => ThingRole::Ornament,
        Class::Seat
        | Class::Surface
        | Class::Container
        | Class::Bed
        | Class::Floor
        | Class::Furnishing
        | Class::Water
        | Class::Music
        | Class::Exercise
        | Class::Vehicle
        | Class::Unknown => ThingRole::Furniture,
    }
}

/// The replacements of names in one text.
struct LandmarkReplacements {
    /// Names that can replace others, in random order.
    things: Vec<(ThingRole, &'static str)>,
    rooms: Vec<&'static str>,
    /// The names that the text itself has, to be replaced.
    own_names: BTreeSet<String>,
    /// The replacement chosen for each name so far.
    replacements: BTreeMap<String, &'static str>,
}

impl LandmarkReplacements {
    fn new(seed: u64, item: &str) -> Self {
        let mut rng = seeded_rng(seed, &["swap", "landmarks", item]);
        let (mut things, mut rooms) = (REPLACEMENT_THINGS.to_vec(), REPLACEMENT_ROOMS.to_vec());
        things.shuffle(&mut rng);
        rooms.shuffle(&mut rng);
        Self { things, rooms, own_names: BTreeSet::new(), replacements: BTreeMap::new() }
    }

    /// Remembers names of the text as old, except for those that are replacements.
    fn avoid_names(&mut self, named: &[NameMention]) {
        let names = named.iter().flat_map(|named| named.specifiers.iter().chain([&named.name]));
        let given: Vec<&str> = self.replacements.values().copied().collect();
        self.own_names.extend(names.filter(|name| !given.contains(&name.as_str())).cloned());
    }

    /// Whether a name, or one that specifies it, may mean something that the text itself named.
    fn is_old(&self, named: &NameMention) -> bool {
        named.specifiers.iter().chain([&named.name]).any(|name| self.conflicts_with(name))
    }

    /// Whether a name may mean something that the text itself named.
    fn conflicts_with(&self, name: &str) -> bool {
        self.own_names.iter().any(|old| names_agree(old, name) || same_room(old, name))
    }

    /// The replacement of a name. It is one that replaces no other name, as long as there are any.
    fn choose_replacement(&mut self, named: &NameMention) -> Option<&'static str> {
        if let Some(given) = self.replacements.get(&named.name) {
            return Some(given);
        }
        if self.own_names.len() > MAX_NAMES {
            return None;
        }
        let kind = if named.is_room { self.rooms_for(&named.name) } else { self.things_for(&named.name) };
        let free: Vec<&'static str> = kind.into_iter().filter(|name| !self.conflicts_with(name)).collect();
        let is_new = |name: &&&'static str| !self.replacements.values().any(|given| *given == **name);
        let other = *free.iter().find(is_new).or(free.first())?;
        self.replacements.insert(named.name.clone(), other);
        Some(other)
    }

    /// What may replace a room, the best first.
    fn rooms_for(&self, name: &str) -> Vec<&'static str> {
        let is_long = same_room(name, "hallway");
        let (long, others): (Vec<_>, Vec<_>) =
            self.rooms.iter().copied().partition(|room| is_long && *room == LONG_ROOM);
        [long, others].concat()
    }

    /// What may replace a thing, the best first: those of its role. A text with more things of a role than there are gets some of other
    /// roles, but nobody goes through or up any other thing.
    fn things_for(&self, name: &str) -> Vec<&'static str> {
        let role = role_of(name);
        let is_moved_on = |role: ThingRole| matches!(role, ThingRole::Passage | ThingRole::Climb);
        let (same, others): (Vec<_>, Vec<_>) = self.things.iter().copied().partition(|(other, _)| *other == role);
        let others = others.into_iter().filter(|(other, _)| !is_moved_on(role) && !is_moved_on(*other));
        same.into_iter().chain(others).map(|(_, name)| name).collect()
    }

    /// The edits that write another name for one: its article, if that is right before it, and the name itself.
    fn edits_for_name(&mut self, text: &str, named: &NameMention) -> Option<Vec<([usize; 2], String)>> {
        let [from, to] = named.span;
        let other = self.choose_replacement(named)?;
        let before = &text[..from];
        let word = before.trim_end().rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let replacement =
            if is_plural(word, &text[from..to], &named.name) { to_plural(other) } else { other.to_owned() };
        let name = ([from, to], LetterCase::for_text(&text[from..to]).apply_to(&replacement));
        let start = before.trim_end().len() - word.len();
        if !word.eq_ignore_ascii_case("a") && !word.eq_ignore_ascii_case("an") {
            return Some(vec![name]);
        }
        let article = if other.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        Some(vec![([start, start + word.len()], LetterCase::for_text(word).apply_to(article)), name])
    }
}

/// Whether a name is written in the plural. `before` is the word before it: "the stairs" are one flight, "three stairs" are not.
fn is_plural(before: &str, written: &str, name: &str) -> bool {
    let last = written.rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_lowercase();
    let is_flight = find_thing(name).is_some_and(|thing| thing.class == ThingClass::Stairs);
    let is_counted = matches!(before.to_lowercase().as_str(), "two" | "three" | "four" | "five" | "few" | "several")
        || before.bytes().all(|byte| byte.is_ascii_digit()) && !before.is_empty();
    normal_word(&last) != last && last.ends_with('s') && !last.ends_with("'s") && (!is_flight || is_counted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn names(text: &str) -> Vec<String> {
        find_names(text).into_iter().map(|named| named.name).collect()
    }

    #[test]
    fn every_replacement_is_read_as_itself() {
        let things = REPLACEMENT_THINGS.iter().map(|(_, name)| (*name, false));
        for (name, is_room) in things.chain(REPLACEMENT_ROOMS.iter().map(|name| (*name, true))) {
            for written in [name.to_owned(), to_plural(name)] {
                let read = find_names(&format!("go past the {written} and wait"));
                assert_eq!((read.len(), read[0].name.as_str(), read[0].is_room), (1, name, is_room), "{written}");
            }
        }
        let mut own = REPLACEMENT_THINGS.iter().filter(|(role, name)| role_of(name) != *role);
        assert_eq!(own.next(), None, "each has its own role");
    }

    #[test]
    fn one_goes_only_through_passages_and_only_up_what_can_be_climbed() {
        let text = "Enter the doorway. Go through the glass door into the den, up the stairs and past the pink bed. Turn right at the \
                    silver sink, and stop under the painting beside the plant.";
        for item in 0..40 {
            let new = swap_landmarks(text, 1, &item.to_string()).unwrap();
            let roles = |text: &str| -> Vec<Option<ThingRole>> {
                find_names(text).iter().map(|named| (!named.is_room).then(|| role_of(&named.name))).collect()
            };
            assert_eq!(roles(&new), roles(text), "{new}");
        }
    }

    #[test]
    fn one_walks_along_what_is_long() {
        let new = swap_landmarks("Walk down the hall and enter the kitchen.", 1, "item").unwrap();
        assert!(new.starts_with("Walk down the balcony and enter the "), "{new}");
    }

    #[test]
    fn things_stay_things_and_rooms_stay_rooms() {
        let text = "Go to the kitchen, pass two sofas and the other sofa and wait by the Coffee Machine.";
        let new = swap_landmarks(text, 1, "item").unwrap();
        let kinds: Vec<bool> = find_names(&new).iter().map(|named| named.is_room).collect();
        assert_eq!(kinds, [true, false, false, false]);
        let names = names(&new);
        assert!(names[1] == names[2] && names[1] != names[3], "{new}");
        assert!(new.starts_with("Go to the ") && new.contains("s and the other "), "{new}");
        assert_ne!(swap_landmarks(text, 2, "item"), swap_landmarks(text, 1, "item"));
        assert_eq!(swap_landmarks(text, 1, "item"), swap_landmarks(text, 1, "item"));
    }

    #[test]
    fn replacement_adapts_articles_and_drops_specifying_names() {
        let of = |item: &str| swap_landmarks("Open an oven in a bathroom cabinet", 3, item).unwrap();
        let texts: Vec<String> = (0..20).map(|item| of(&item.to_string())).collect();
        for text in &texts {
            assert!(!text.contains("bathroom"), "{text}");
            for pair in text.split(' ').collect::<Vec<_>>().windows(2).filter(|pair| matches!(pair[0], "a" | "an")) {
                assert_eq!(pair[0] == "an", pair[1].starts_with(['a', 'e', 'i', 'o', 'u']), "{text}");
            }
        }
        assert!(texts.iter().any(|text| text.starts_with("Open a ")));
    }

    #[test]
    fn a_text_without_names_is_not_swapped() {
        assert_eq!(swap_landmarks("Turn left and walk on.", 1, "item"), None);
        assert!(
            swap_landmarks("Exit the building via the door", 1, "item")
                .unwrap()
                .starts_with("Exit the building via the ")
        );
    }

    proptest! {
        #[test]
        fn no_old_name_is_read_any_more(text in "((go|to|the|a|an|two|shiny|light|blue|sofa|Sofas|kitchen|bathroom|door|stairs|table|coffee|study|gizmo|exit|of|in|with|and|ß|[,.'’-])  ?){0,20}|\\PC{0,60}", seed in 0..9u64) {
            if let Some(new) = swap_landmarks(&text, seed, "item") {
                let old = names(&text);
                for name in names(&new) {
                    prop_assert!(!old.iter().any(|old| names_agree(old, &name) || same_room(old, &name)), "{name:?} in {new:?}");
                }
            }
        }
    }
}
