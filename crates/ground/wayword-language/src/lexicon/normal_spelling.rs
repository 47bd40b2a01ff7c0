//! The normal spelling of a name. Names are compared in it, so that "Coffee tables" and "coffee table" agree.

/// A name in normal spelling: lower case, words separated by one space, each in the singular, without punctuation.
#[must_use]
pub fn normalise_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric() && !matches!(c, '\'' | '’')).filter(|word| !word.is_empty());
    words.map(normal_word).collect::<Vec<_>>().join(" ")
}

/// Plurals for which the rules below give a wrong singular.
const IRREGULAR_PLURALS: [(&str, &str); 7] = [
    ("shelves", "shelf"),
    ("knives", "knife"),
    ("leaves", "leaf"),
    ("scarves", "scarf"),
    ("loaves", "loaf"),
    ("axes", "axe"),
    ("buses", "bus"),
];
/// Words that have no singular: to clothe is something else.
const ALWAYS_PLURAL: [&str; 1] = ["clothes"];
/// Words in "-ie". Their plurals look like those of words in "-y".
const IN_IE: [&str; 14] = [
    "cookie", "brownie", "movie", "hoodie", "smoothie", "walkie", "talkie", "veggie", "genie", "zombie", "foodie",
    "calorie", "prairie", "birdie",
];
/// Words in "-che". Their plurals look like those of words in "-ch".
const IN_CHE: [&str; 6] = ["niche", "cache", "quiche", "creche", "brioche", "porsche"];

/// One word in lower case and in the singular.
///
/// It is wrong for some words, but in the same way for a text and for a label, and comparing needs no more than that.
#[must_use]
pub fn normal_word(word: &str) -> String {
    let word = word.to_lowercase();
    let word = word.strip_suffix("'s").or(word.strip_suffix("’s")).unwrap_or(&word);
    // "TVs", but not "bus".
    let is_initials = !word.contains(['a', 'e', 'i', 'o', 'u', 'y']);
    let keeps_its_s = ["ss", "us", "is"].iter().any(|end| word.ends_with(end)) || (word.len() < 4 && !is_initials);
    let keeps_its_s = keeps_its_s || ALWAYS_PLURAL.contains(&word);
    let Some(stem) = word.strip_suffix('s').filter(|_| !keeps_its_s) else { return word.to_owned() };
    if let Some((end, instead)) = IRREGULAR_PLURALS.into_iter().find(|(end, _)| word.ends_with(end)) {
        return format!("{}{instead}", &word[..word.len() - end.len()]);
    }
    let in_list = |list: &[&str]| list.iter().any(|end| stem.ends_with(end));
    match stem.strip_suffix("ie") {
        // "Pies" and "ties" are short, "berries" are long.
        Some(short) if short.len() > 1 && !in_list(&IN_IE) => return format!("{short}y"),
        _ => {}
    }
    let adds_es = ["che", "she", "xe", "sse", "zze", "tze"].iter().any(|end| stem.ends_with(end)) && !in_list(&IN_CHE);
    if adds_es { stem[..stem.len() - 1].to_owned() } else { stem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plurals_and_spellings_come_together() {
        assert_eq!(normalise_name("Book-Shelves"), "book shelf");
        assert_eq!(normalise_name("couches"), normalise_name("couch"));
        for (one, many) in [
            ("tv", "TVs"),
            ("niche", "niches"),
            ("cookie", "cookies"),
            ("size", "sizes"),
            ("box", "boxes"),
            ("dress", "dresses"),
            ("berry", "berries"),
            ("tie", "ties"),
            ("maze", "mazes"),
            ("brush", "brushes"),
            ("waltz", "waltzes"),
            ("axe", "axes"),
            ("bookshelf", "bookshelves"),
            ("bus", "buses"),
            ("shoe", "shoes"),
        ] {
            assert_eq!(normalise_name(many), one);
            assert_eq!(normalise_name(one), one);
        }
        assert_eq!(normalise_name("Clothes"), "clothes");
        assert_eq!(normalise_name("robot’s"), "robot");
        assert_eq!(normalise_name("glass"), "glass");
        assert_eq!(normalise_name("  dining#chairs "), "dining chair");
    }
}
