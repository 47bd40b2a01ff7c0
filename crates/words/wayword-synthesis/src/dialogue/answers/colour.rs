//! Colours in answers.

use wayword_language::reading::vocabulary::COLOURS;

/// Colours that the reader of instructions does not look for.
const MORE: [&str; 24] = [
    "maroon",
    "burgundy",
    "charcoal",
    "ivory",
    "khaki",
    "olive",
    "bronze",
    "copper",
    "violet",
    "magenta",
    "lavender",
    "mustard",
    "peach",
    "coral",
    "indigo",
    "crimson",
    "mahogany",
    "taupe",
    "golden",
    "silvery",
    "greyish",
    "brownish",
    "multicoloured",
    "multicolored",
];

/// The colour that begins at a word, with its shade, and the number of its words.
pub(super) fn colour_at(words: &[&str]) -> Option<(String, usize)> {
    let is_colour = |word: &&&str| COLOURS.contains(word) || MORE.contains(word);
    let plain = |word: &str| match word {
        "gray" => "grey".to_owned(),
        "golden" => "gold".to_owned(),
        word => word.to_owned(),
    };
    match words {
        [shade @ ("dark" | "light"), rest @ ..] => {
            rest.first().filter(is_colour).map(|colour| (format!("{shade} {}", plain(colour)), 2))
        }
        [..] => words.first().filter(is_colour).map(|colour| (plain(colour), 1)),
    }
}

/// The colour that a phrase is, without its shade, where it is nothing else.
pub(super) fn bare_colour(phrase: &str) -> Option<&str> {
    let words: Vec<&str> = phrase.split(' ').collect();
    colour_at(&words).filter(|(_, length)| *length == words.len()).and_then(|_| words.last().copied())
}

/// The first colour of a run of words.
pub(super) fn first_colour(words: &[&str]) -> Option<String> {
    (0..words.len()).find_map(|at| colour_at(&words[at..])).map(|(colour, _)| colour)
}

/// The colour that a sentence gives to what it has just named: "is dark green", "appears to be mostly white".
pub(super) fn said_of(after: &[&str]) -> Option<String> {
    const LINKS: [&str; 9] = ["is", "are", "was", "were", "looks", "look", "appears", "appear", "painted"];
    const BETWEEN: [&str; 14] =
        ["to", "be", "a", "an", "very", "mostly", "mainly", "also", "painted", "of", "in", "all", "large", "colour"];
    let (first, rest) = after.split_first()?;
    if !LINKS.contains(first) {
        return None;
    }
    let skipped = rest.iter().take(4).take_while(|word| BETWEEN.contains(word)).count();
    colour_at(&rest[skipped..]).map(|(colour, _)| colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_found_with_their_shades() {
        let first = |text: &str| first_colour(&text.split(' ').collect::<Vec<_>>());
        assert_eq!(first("it is dark gray"), Some("dark grey".into()));
        assert_eq!(first("a light wooden table and a red one"), Some("red".into()));
        assert_eq!(first("burgundy"), Some("burgundy".into()));
        assert_eq!(first("light"), None);
        assert_eq!(first(""), None);
    }

    #[test]
    fn only_a_link_gives_a_colour_to_what_was_named() {
        let said = |text: &str| said_of(&text.split(' ').collect::<Vec<_>>());
        assert_eq!(said("is red"), Some("red".into()));
        assert_eq!(said("appears to be mostly light blue"), Some("light blue".into()));
        assert_eq!(said("and a red chair"), None);
        assert_eq!(said("is on a red rug"), None);
    }
}
