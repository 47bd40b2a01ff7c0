//! The reader of the word lists in `languages/en/`.
//!
//! In every file a line that begins with `#` is a comment. Tables have one row per line, with bars between columns and
//! commas between names. A closed list has its name in brackets, and then words separated by spaces, or phrases
//! separated by commas.

use std::sync::LazyLock;

/// A closed list of words.
pub type WordList = LazyLock<Vec<&'static str>>;
/// A closed list of phrases.
pub type PhraseList = LazyLock<Vec<Vec<&'static str>>>;

/// The lines of a file that are not comments or empty.
pub(crate) fn content_lines(file: &'static str) -> impl Iterator<Item = &'static str> {
    file.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty())
}

/// The columns of a table's row. Columns that the row lacks are empty.
pub(crate) fn row_columns<const N: usize>(row: &'static str) -> [&'static str; N] {
    let mut columns = row.split('|').map(str::trim);
    std::array::from_fn(|_| columns.next().unwrap_or_default())
}

/// The names in a column, which commas separate.
pub(crate) fn split_names(column: &'static str) -> impl Iterator<Item = &'static str> {
    column.split(',').map(str::trim).filter(|name| !name.is_empty())
}

/// The words of a closed list; none where the file has no list of this name. The case of the name does not matter.
pub(crate) fn list_words(file: &'static str, name: &str) -> Vec<&'static str> {
    let body = content_lines(file)
        .skip_while(|line| !list_name(line).is_some_and(|list| list.eq_ignore_ascii_case(name)))
        .skip(1);
    body.take_while(|line| list_name(line).is_none()).flat_map(str::split_whitespace).collect()
}

/// The phrases of a closed list. A phrase may continue in the next line.
pub(crate) fn list_phrases(file: &'static str, name: &str) -> Vec<Vec<&'static str>> {
    let words = list_words(file, name);
    let runs = words.split_inclusive(|word| word.ends_with(','));
    runs.map(|run| run.iter().map(|word| word.trim_end_matches(',')).collect()).collect()
}

/// The name of a list, where a line begins one.
pub(crate) fn list_name(line: &'static str) -> Option<&'static str> {
    line.strip_prefix('[')?.strip_suffix(']')
}

/// Makes a static of each closed list of a file, and a test that the names in the code are those of the file.
macro_rules! lists {
    ($file:literal; words: $($words:ident),*; phrases: $($phrases:ident),*;) => {
        const LISTS: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $file));

        $(#[doc = concat!("The list `", stringify!($words), "` of `", $file, "`, which explains it.")]
        pub static $words: $crate::data::WordList =
            std::sync::LazyLock::new(|| $crate::data::list_words(LISTS, stringify!($words)));)*
        $(#[doc = concat!("The list `", stringify!($phrases), "` of `", $file, "`, which explains it.")]
        pub static $phrases: $crate::data::PhraseList =
            std::sync::LazyLock::new(|| $crate::data::list_phrases(LISTS, stringify!($phrases)));)*

        #[cfg(test)]
        #[test]
        fn the_lists_of_the_file_are_those_that_the_code_names() {
            let named = [$(stringify!($words),)* $(stringify!($phrases),)*];
            let mut named: Vec<String> = named.iter().map(|name| name.to_lowercase()).collect();
            let mut held: Vec<&str> = $crate::data::content_lines(LISTS).filter_map($crate::data::list_name).collect();
            named.sort_unstable();
            held.sort_unstable();
            assert_eq!(named, held);
            for name in held {
                assert!(!$crate::data::list_words(LISTS, name).is_empty(), "{name} is empty");
            }
        }
    };
}
pub(crate) use lists;

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "# About the file.\n[one]\n# About the list.\na b\nc\n\n[two]\nnot at\nall, never\n";

    #[test]
    fn a_closed_list_ends_where_the_next_begins() {
        assert_eq!(list_words(FILE, "ONE"), ["a", "b", "c"]);
        assert_eq!(list_words(FILE, "three"), Vec::<&str>::new());
    }

    #[test]
    fn phrases_may_continue_in_the_next_line() {
        assert_eq!(list_phrases(FILE, "two"), [vec!["not", "at", "all"], vec!["never"]]);
    }

    #[test]
    fn a_row_has_its_columns_and_names() {
        let [first, second, third] = row_columns("sofa, couch | seat");
        assert_eq!((split_names(first).collect::<Vec<_>>(), second, third), (vec!["sofa", "couch"], "seat", ""));
    }
}
