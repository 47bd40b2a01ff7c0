//! Forms of a name: with its article, in the singular and the plural, with a number.

use super::normal_word;
use crate::text::split_words;

/// Numbers in words, from two on. The last two mean any greater number.
pub const COUNT_WORDS: [&str; 7] = ["two", "three", "four", "five", "six", "several", "many"];

/// Plural names that mean one thing.
const ONE_THING: [&str; 8] = ["stairs", "steps", "drawers", "clothes", "blinds", "drums", "weights", "toiletries"];

/// A name without the article before it.
#[must_use]
pub fn without_article(name: &str) -> &str {
    ["a ", "an ", "the ", "some "].iter().find_map(|article| name.strip_prefix(article)).unwrap_or(name)
}

/// A name with the last word in the singular.
#[must_use]
pub fn to_singular(name: &str) -> String {
    match name.rsplit_once(' ') {
        Some((before, last)) => format!("{before} {}", normal_word(last)),
        None => normal_word(name),
    }
}

/// Whether a name means several things: "chairs" does, "stairs" does not.
#[must_use]
pub fn means_several(name: &str) -> bool {
    split_words(name).last().is_some_and(|last| normal_word(last) != *last && !ONE_THING.contains(&last.as_str()))
}

/// A name with its article: "a lamp", "an oven", "some shelves".
#[must_use]
pub fn with_article(name: &str) -> String {
    let vowel = name.starts_with(['a', 'e', 'i', 'o', 'u']);
    let article = if is_plural(name) {
        "some"
    } else if vowel {
        "an"
    } else {
        "a"
    };
    format!("{article} {name}")
}

/// Whether a name is a plural already.
#[must_use]
pub fn is_plural(name: &str) -> bool {
    let last = name.rsplit(' ').next().unwrap_or(name);
    last.len() > 3 && last.ends_with('s') && !["ss", "us", "is"].iter().any(|end| last.ends_with(end))
}

/// The plural of a name.
#[must_use]
pub fn to_plural(name: &str) -> String {
    if is_plural(name) {
        return name.to_owned();
    }
    if let Some(stem) = name.strip_suffix("shelf") {
        return format!("{stem}shelves");
    }
    // "Benches", "boxes".
    let ends_in_hiss = ["s", "x", "z", "ch", "sh"].iter().any(|end| name.ends_with(end));
    let consonant_y = name.ends_with('y') && !["ay", "ey", "oy", "uy"].iter().any(|end| name.ends_with(end));
    match (ends_in_hiss, consonant_y) {
        (true, _) => format!("{name}es"),
        (_, true) => format!("{}ies", &name[..name.len() - 1]),
        _ => format!("{name}s"),
    }
}

/// A count of things in words: "a lamp", "two lamps", "several lamps".
#[must_use]
pub fn counted_name(count: usize, name: &str) -> String {
    match count {
        0 | 1 => with_article(name),
        2..=6 => format!("{} {}", COUNT_WORDS[count - 2], to_plural(name)),
        _ => format!("several {}", to_plural(name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn articles_and_plurals_are_english() {
        assert_eq!(with_article("oven"), "an oven");
        assert_eq!(counted_name(2, "bookshelf"), "two bookshelves");
        assert_eq!(counted_name(3, "couch"), "three couches");
        assert_eq!(counted_name(1, "shelves"), "some shelves");
    }

    #[test]
    fn stairs_are_one_thing_and_chairs_are_several() {
        assert!(means_several("dining chairs") && means_several("shelves"));
        assert!(!means_several("stairs") && !means_several("glass") && !means_several("chair"));
    }
}
