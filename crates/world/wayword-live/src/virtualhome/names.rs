//! Splits VirtualHome's class names, which run words together: `coffeetable` becomes "coffee table".

use std::{collections::BTreeMap, sync::LazyLock};

/// The classes that VirtualHome has.
const CLASS_LIST: &str = include_str!("classes.txt");

/// The words for each class of the list: a line is `class: words`, or several classes that are words themselves.
static CLASS_WORDS: LazyLock<BTreeMap<&str, &str>> = LazyLock::new(|| {
    let lines = CLASS_LIST.lines().filter(|line| !line.starts_with('#'));
    let named = |line: &'static str| match line.split_once(": ") {
        Some(pair) => vec![pair],
        None => line.split_whitespace().map(|word| (word, word)).collect(),
    };
    lines.flat_map(named).collect()
});

/// First words of names that are not in the list: classes that users add, and those of the stand-in. The rest of the name
/// must have at least three letters, so that it can be a word.
const FIRST_WORDS: [&str; 35] = [
    "bathroom",
    "bath",
    "bedroom",
    "cardboard",
    "ceiling",
    "clothes",
    "coffee",
    "closet",
    "console",
    "cutting",
    "desk",
    "dining",
    "dish",
    "door",
    "floor",
    "front",
    "fruit",
    "garage",
    "garbage",
    "kitchen",
    "laundry",
    "light",
    "living",
    "metal",
    "office",
    "picture",
    "power",
    "range",
    "remote",
    "side",
    "table",
    "toilet",
    "tv",
    "wall",
    "washing",
];
/// Names that begin with one of these words but are one word.
const WHOLE_WORDS: [&str; 12] = [
    "bathrobe",
    "bathtub",
    "closets",
    "doormat",
    "doorway",
    "floors",
    "kitchens",
    "lights",
    "sideboard",
    "tables",
    "tablet",
    "tablets",
];

/// `coffeetable` as "coffee table", `clothes_pants` as "pants".
pub(super) fn split_class_name(class_name: &str) -> String {
    let name: String = class_name.to_lowercase().chars().filter(|c| !matches!(c, '_' | '-' | ' ')).collect();
    match CLASS_WORDS.get(name.as_str()) {
        Some(words) => (*words).to_owned(),
        None => split_unlisted_name(&class_name.to_lowercase().replace('_', " ")),
    }
}

/// Splits a name that is not in the list, after each word of [`FIRST_WORDS`] at its beginning.
fn split_unlisted_name(name: &str) -> String {
    let (mut rest, mut words) = (name, Vec::new());
    while !WHOLE_WORDS.contains(&rest) {
        let cut =
            FIRST_WORDS.iter().find_map(|first| rest.strip_prefix(first).filter(|rest| rest.chars().count() >= 3));
        let Some(after) = cut else { break };
        words.push(rest[..rest.len() - after.len()].to_owned());
        rest = after;
    }
    words.push(rest.to_owned());
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::{CLASS_WORDS, split_class_name};

    #[test]
    fn every_class_of_the_list_has_words_that_are_spelled_as_words() {
        assert!(CLASS_WORDS.len() > 400, "{}", CLASS_WORDS.len());
        for (class, name) in CLASS_WORDS.iter() {
            assert!(class.bytes().all(|byte| byte.is_ascii_lowercase()), "{class}");
            assert!(!name.is_empty() && !name.contains("  "), "{class}: {name:?}");
            assert!(name.split(' ').all(|word| word.len() < 12), "{class}: {name} still runs words together");
        }
    }

    #[test]
    fn names_come_apart_where_words_meet() {
        let expected = [
            ("coffeetable", "coffee table"),
            ("wallpictureframe", "picture frame"),
            ("filingcabinet", "filing cabinet"),
            ("Filing_Cabinet", "filing cabinet"),
            ("clothes_pants", "pants"),
            ("dishbowl", "bowl"),
            ("food_ice_cream", "ice cream"),
            ("kitchenisland", "kitchen island"),
            ("umbrella_stand", "umbrella stand"),
            ("livingroom", "living room"),
            ("Bathroomcabinet", "bathroom cabinet"),
            ("tvstand", "tv stand"),
            ("tv", "tv"),
            ("bookshelf", "bookshelf"),
            ("tablet", "tablet"),
            ("closet", "closet"),
            ("doorjamb", "door jamb"),
            ("table\u{e9}\u{e9}\u{e9}", "table \u{e9}\u{e9}\u{e9}"),
        ];
        for (name, apart) in expected {
            assert_eq!(split_class_name(name), apart);
        }
    }
}
