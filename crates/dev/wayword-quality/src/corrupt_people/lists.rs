//! The word lists of this generator. The program does not use them, because they serve to measure it.

use std::{collections::BTreeMap, sync::LazyLock};

/// Lists of words, each under a name.
type NamedWordLists = BTreeMap<&'static str, Vec<&'static str>>;

/// Words of motions, such as "turn verbs" and "stairs".
pub(super) static MOTION_WORDS: LazyLock<NamedWordLists> =
    LazyLock::new(|| parse_word_lists(include_str!("lists/motions.txt")));
/// Small words around names, such as "determiners" and "room modifiers".
pub(super) static SMALL_WORDS: LazyLock<NamedWordLists> =
    LazyLock::new(|| parse_word_lists(include_str!("lists/small_words.txt")));
/// The names of each kind of room.
pub(super) static ROOM_WORDS: LazyLock<NamedWordLists> =
    LazyLock::new(|| parse_word_lists(include_str!("lists/rooms.txt")));
/// The names that can mean each object.
pub(super) static OBJECT_WORDS: LazyLock<NamedWordLists> =
    LazyLock::new(|| parse_word_lists(include_str!("lists/objects.txt")));

/// The lists of a file. Each line is a name, a colon, and its words.
fn parse_word_lists(list: &'static str) -> NamedWordLists {
    let lines = list.lines().filter(|line| !line.starts_with('#'));
    let line = |line: &'static str| {
        let (name, words) = line.split_once(':')?;
        Some((name.trim(), words.split(',').map(str::trim).collect()))
    };
    lines.filter_map(line).collect()
}

/// The words of a list under a name.
pub(super) fn words_under<'l>(list: &'l NamedWordLists, name: &str) -> &'l [&'static str] {
    list.get(name).map_or(&[], |words| words.as_slice())
}

/// Whether a list has a word under a name.
pub(super) fn has_word(list: &NamedWordLists, name: &str, word: &str) -> bool {
    words_under(list, name).contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fs, path::Path};

    #[test]
    fn every_line_of_a_list_is_a_name_with_its_words() {
        for (list, least) in [(&*MOTION_WORDS, 13), (&*SMALL_WORDS, 5), (&*ROOM_WORDS, 18), (&*OBJECT_WORDS, 60)] {
            assert!(list.len() >= least, "{}", list.len());
            for (name, words) in list {
                assert!(words.iter().all(|word| !word.is_empty() && *word == word.to_lowercase()), "{name}: {words:?}");
            }
        }
    }

    /// A generator with the reader's own words could never make a text that the reader misunderstands.
    #[test]
    fn this_generator_shares_no_word_with_the_reader() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/corrupt_people");
        let readers = ["language", "checks", "synthesis", "navigation"].map(|name| format!("wayword_{name}"));
        let mut files = 0;
        for entry in fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().path();
            if file.is_file() {
                let text = fs::read_to_string(&file).unwrap();
                assert!(!readers.iter().any(|reader| text.contains(reader)), "{}", file.display());
                files += 1;
            }
        }
        assert!(files > 5, "{files}");
    }
}
