//! The names of objects: which ones mean the same, which kinds they belong to, and their class, by which the writer
//! chooses tasks.

use super::normalise_name;
use crate::data;
use std::{collections::BTreeMap, sync::LazyLock};

const OBJECT_LIST: &str = include_str!("../languages/en/objects.txt");

/// The class of a thing by its use: a seat, a container, a light. The writer chooses tasks by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)] // The names explain themselves.
pub enum ThingClass {
    Seat,
    Surface,
    Container,
    Bed,
    Textile,
    Drape,
    Floor,
    Furnishing,
    Light,
    Switch,
    WallArt,
    Glass,
    Door,
    /// A fitting of the building.
    Structure,
    /// The building itself: walls, floors, doorways. Most labels leave it out.
    Fabric,
    Stairs,
    Water,
    Plant,
    Ornament,
    Hearth,
    Fan,
    Appliance,
    Cooker,
    Fridge,
    Basin,
    Tap,
    Toilet,
    Tub,
    Screen,
    Music,
    Exercise,
    Vehicle,
    Small,
    /// Not in the lexicon.
    Unknown,
}

/// A thing of the lexicon.
#[derive(Debug, Clone)]
pub struct LexiconThing {
    /// Its usual name.
    pub name: &'static str,
    /// Its class.
    pub class: ThingClass,
    /// From 0 (never a landmark) to 3 (a landmark that is seen from afar).
    pub salience: u8,
    /// The usual name of a more general thing: "chair" of a dining chair.
    parent: Option<&'static str>,
}

/// The things of `languages/en/objects.txt`.
struct ThingLexicon {
    things: Vec<LexiconThing>,
    /// Indices into `things`, by every name in normal spelling.
    by_name: BTreeMap<String, usize>,
    /// The number of words of the longest name.
    longest: usize,
}

static THINGS: LazyLock<ThingLexicon> = LazyLock::new(|| {
    let (mut things, mut by_name): (Vec<LexiconThing>, BTreeMap<String, usize>) = Default::default();
    for line in data::content_lines(OBJECT_LIST) {
        let [name, class, salience, others, parent] = data::row_columns(line);
        let thing = LexiconThing {
            name,
            class: class_named(class),
            salience: salience.parse().unwrap_or(0),
            parent: Some(parent).filter(|parent| !parent.is_empty()),
        };
        for name in
            std::iter::once(name).chain(data::split_names(others)).map(normalise_name).filter(|name| !name.is_empty())
        {
            by_name.entry(name).or_insert(things.len());
        }
        things.push(thing);
    }
    let longest = by_name.keys().map(|name| name.split(' ').count()).max().unwrap_or(1);
    ThingLexicon { things, by_name, longest }
});

/// The class by its name in the list.
pub(super) fn class_named(name: &str) -> ThingClass {
    match name {
        "seat" => ThingClass::Seat,
        "surface" => ThingClass::Surface,
        "container" => ThingClass::Container,
        "bed" => ThingClass::Bed,
        "textile" => ThingClass::Textile,
        "drape" => ThingClass::Drape,
        "floor" => ThingClass::Floor,
        "furnishing" => ThingClass::Furnishing,
        "light" => ThingClass::Light,
        "switch" => ThingClass::Switch,
        "wall_art" => ThingClass::WallArt,
        "glass" => ThingClass::Glass,
        "door" => ThingClass::Door,
        "structure" => ThingClass::Structure,
        "fabric" => ThingClass::Fabric,
        "stairs" => ThingClass::Stairs,
        "water" => ThingClass::Water,
        "plant" => ThingClass::Plant,
        "ornament" => ThingClass::Ornament,
        "hearth" => ThingClass::Hearth,
        "fan" => ThingClass::Fan,
        "appliance" => ThingClass::Appliance,
        "cooker" => ThingClass::Cooker,
        "fridge" => ThingClass::Fridge,
        "basin" => ThingClass::Basin,
        "tap" => ThingClass::Tap,
        "toilet" => ThingClass::Toilet,
        "tub" => ThingClass::Tub,
        "screen" => ThingClass::Screen,
        "music" => ThingClass::Music,
        "exercise" => ThingClass::Exercise,
        "vehicle" => ThingClass::Vehicle,
        "small" => ThingClass::Small,
        _ => ThingClass::Unknown,
    }
}

/// Number of words in the longest name of the lexicon.
#[must_use]
pub fn longest_name() -> usize {
    THINGS.longest
}

/// The thing that a phrase in normal spelling names, exactly.
fn thing_named(normal_name: &str) -> Option<&'static LexiconThing> {
    THINGS.by_name.get(normal_name).map(|at| &THINGS.things[*at])
}

/// The thing that a name means: that of the whole name, or else of its longest known ending ("old oak table" is a
/// table).
#[must_use]
pub fn find_thing(name: &str) -> Option<&'static LexiconThing> {
    let name = normalise_name(name);
    name_tails(&name).find_map(thing_named)
}

/// A name and its endings, the longest first: "old oak table", "oak table", "table".
fn name_tails(name: &str) -> impl Iterator<Item = &str> {
    std::iter::once(name).chain(name.match_indices(' ').map(move |(at, _)| &name[at + 1..]))
}

/// The kinds of thing that a name means, the most specific first: "dining chair" is a dining chair and a chair. A name
/// that the lexicon does not have means itself and its last word.
#[must_use]
pub fn kinds_of(name: &str) -> Vec<String> {
    let name = normalise_name(name);
    let Some(mut thing) = name_tails(&name).find_map(thing_named) else {
        let last = name.rsplit(' ').next().unwrap_or_default().to_owned();
        return if last == name { vec![name] } else { vec![name, last] };
    };
    let mut kinds = vec![thing.name.to_owned()];
    // The bound keeps a mistake in the list from leading in circles.
    while let Some(parent) =
        parent_thing(thing).filter(|parent| kinds.len() < 4 && !kinds.contains(&parent.name.to_owned()))
    {
        kinds.push(parent.name.to_owned());
        thing = parent;
    }
    kinds
}

/// The thing of a thing's parent.
fn parent_thing(thing: &LexiconThing) -> Option<&'static LexiconThing> {
    thing_named(&normalise_name(thing.parent?))
}

/// Whether two names may mean the same thing: the most specific kind of one is a kind of the other.
#[must_use]
pub fn names_agree(a: &str, b: &str) -> bool {
    let (a, b) = (kinds_of(a), kinds_of(b));
    b.contains(&a[0]) || a.contains(&b[0])
}

/// Whether a phrase in normal spelling is the name of a thing.
#[must_use]
pub fn is_thing(normal_name: &str) -> bool {
    THINGS.by_name.contains_key(normal_name)
}

/// Whether a name means a part of the building itself: a wall, a floor, a ceiling, a corner, a doorway. Texts name
/// such parts everywhere and labels hardly ever, so missing evidence of one is no evidence of absence.
#[must_use]
pub fn is_fabric(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::Fabric)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_floors_and_corners_are_of_the_building() {
        for name in ["wall", "brick walls", "tiled floor", "corner", "ceiling", "doorway"] {
            assert!(is_fabric(name), "{name}");
        }
        for name in ["wall lamp", "corner cabinet", "floor lamp", "door", "zorble"] {
            assert!(!is_fabric(name), "{name}");
        }
    }

    #[test]
    fn the_files_that_the_list_names_are_there() {
        let words = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/languages/en");
        let remarks = OBJECT_LIST.lines().filter(|line| line.starts_with('#')).flat_map(str::split_whitespace);
        let names = remarks.map(|word| word.trim_end_matches([')', '.', ',']));
        let files: Vec<&str> = names.filter(|name| name.ends_with(".rs")).collect();
        assert!(!files.is_empty() && files.iter().all(|file| words.join(file).is_file()), "{files:?}");
    }

    #[test]
    fn names_of_one_thing_agree() {
        for (a, b) in
            [("couch", "sofa"), ("chair", "dining chairs"), ("painting", "picture frame"), ("bin", "trashcan")]
        {
            assert!(names_agree(a, b), "{a} and {b}");
        }
    }

    #[test]
    fn names_of_different_things_do_not() {
        for (a, b) in
            [("office chair", "dining chair"), ("sink", "toilet"), ("pool table", "table lamp"), ("bed", "bedroom")]
        {
            assert!(!names_agree(a, b), "{a} and {b}");
        }
    }

    #[test]
    fn a_name_with_adjectives_means_the_thing() {
        assert_eq!(find_thing("old oak dining table").unwrap().name, "dining table");
        assert_eq!(kinds_of("brown leather armchair"), ["armchair", "chair"]);
        assert_eq!(kinds_of("purple gizmo"), ["purple gizmo", "gizmo"]);
    }

    #[test]
    fn every_line_of_the_lexicon_is_whole() {
        for line in data::content_lines(OBJECT_LIST) {
            let columns: Vec<_> = line.split('|').collect();
            assert!((3..=5).contains(&columns.len()), "{line}");
            assert_ne!(class_named(columns[1]), ThingClass::Unknown, "{line}");
            assert!(columns[2].parse::<u8>().is_ok_and(|salience| salience <= 3), "{line}");
            if let Some(parent) = columns.get(4).filter(|parent| !parent.is_empty()) {
                assert!(thing_named(&normalise_name(parent)).is_some(), "unknown parent in {line}");
            }
        }
    }
}
