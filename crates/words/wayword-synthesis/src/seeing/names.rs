//! Reads the names that models give to things and rooms, and separates colour, material and number from the name
//! itself.

use crate::dialogue::colour_at;
use wayword_language::{
    answers::{ANYTHING, BUNCHES, GUESSING, MATERIALS, NO_OBJECTS, NUMBERS, PATTERNS, QUALITIES, TELLS_NOTHING},
    lexicon::{find_thing, is_room, is_thing, means_several, normalise_name, to_singular},
    reading::vocabulary::{ABSTRACT, ADJECTIVES, BREAKERS},
};

/// Longest name, bytes; a longer text is no name.
const MAX_NAME_BYTES: usize = 40;
/// Most words of a name; a text with more is no name.
const MAX_NAME_WORDS: usize = 4;
/// Most words of a detail; later ones are left out.
pub(super) const MAX_DETAIL_WORDS: usize = 6;
/// Most names that one thing may have ("sofa or bench" has two); further ones are ignored.
const MAX_NAMES: usize = 3;

/// A name taken apart: "two small red chairs" is the name "chair", several of them, red.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct NameReading {
    /// The names that the text may mean, each in the singular; a single one if the model is sure which.
    pub(crate) names: Vec<String>,
    /// Whether the text expresses doubt, by a question mark or a word such as "maybe".
    pub(crate) is_guess: bool,
    /// Whether the text means more than one.
    pub(crate) several: bool,
    pub(crate) colours: Vec<String>,
    pub(crate) material: Option<String>,
    /// Its pattern, or what it shows: "checkered", "of a ship".
    pub(crate) detail: Option<String>,
}

/// Reads a name; the result has no names if the text is no name.
pub(crate) fn read_name(said: &str) -> NameReading {
    let said = &said[..said.floor_char_boundary(4 * MAX_NAME_BYTES)].to_lowercase().replace('’', "'");
    let said = &said.replace("-and-", " and ");
    let mut named = NameReading { is_guess: said.contains('?'), ..NameReading::default() };
    let plain = said.split('(').next().unwrap_or_default().replace('/', " or ");
    let words: Vec<&str> = plain.split(|c: char| !(c.is_alphanumeric() || "-'".contains(c))).collect();
    let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
    for alternative in words.split(|word| *word == "or") {
        if let Some(name) = read_one_name(alternative, &mut named).filter(|name| !named.names.contains(name))
            && named.names.len() < MAX_NAMES
        {
            named.names.push(name);
        }
    }
    named
}

/// Reads one of the names between "or": takes colours, materials, numbers and qualities off its beginning and notes
/// them in `named`. `None` if no name of a thing is left.
fn read_one_name(words: &[&str], named: &mut NameReading) -> Option<String> {
    let mut words = words;
    if let Some(start) = detail_start(words) {
        let detail = &words[start..];
        named.detail.get_or_insert(detail[..detail.len().min(MAX_DETAIL_WORDS)].join(" "));
        words = &words[..start];
    }
    words = before_the_place(words);
    loop {
        let (first, rest) = words.split_first()?;
        if is_thing(&normalise_name(&words.join(" "))) {
            break;
        }
        if GUESSING.contains(first) {
            named.is_guess = true;
        } else if let Some((colour, length)) = colour_at(words) {
            named.add_colour(colour);
            words = &words[length..];
            continue;
        } else if *first == "and" && colour_at(rest).is_some() && !named.colours.is_empty() {
        } else if PATTERNS.contains(first) && !rest.is_empty() {
            named.detail.get_or_insert((*first).to_owned());
        } else if MATERIALS.contains(first) {
            named.material.get_or_insert((*first).to_owned());
        } else if NUMBERS.contains(first) || first.parse::<u32>().is_ok_and(|count| count > 1) {
            named.several = true;
        } else if BUNCHES.contains(first) && rest.first() == Some(&"of") {
            named.several = true;
            words = &rest[1..];
            continue;
        } else if !is_quality(first) || rest.is_empty() {
            break;
        }
        words = rest;
    }
    let name = words.join(" ");
    let several = means_several(&name);
    named.several |= several;
    let name = if several { to_singular(&name) } else { name };
    is_name(&name).then_some(name)
}

impl NameReading {
    /// Adds a colour; more than four are ignored.
    pub(crate) fn add_colour(&mut self, colour: String) {
        if !self.colours.contains(&colour) && self.colours.len() < 4 {
            self.colours.push(colour);
        }
    }
}

/// The words before a phrase of place: "television on the wall" is a television. "Chest of drawers" stays whole.
fn before_the_place<'a, 'b>(words: &'a [&'b str]) -> &'a [&'b str] {
    let ends = |at: &usize| {
        let of_bunch = words[*at] == "of" && BUNCHES.contains(&words[at - 1]);
        BREAKERS.contains(&words[*at]) && !of_bunch && !is_quality(words[*at])
    };
    let end = (1..words.len()).find(ends).unwrap_or(words.len());
    let longer = (end..=words.len()).rev().find(|end| is_thing(&normalise_name(&words[..*end].join(" "))));
    &words[..longer.unwrap_or(end)]
}

/// Where a detail of a thing begins in a name: "picture of a ship", "lamp with a red shade". "Chest of drawers" has none.
fn detail_start(words: &[&str]) -> Option<usize> {
    const LEADS: [&str; 4] = ["of", "with", "showing", "depicting"];
    let names = |from: usize, to: usize| is_thing(&normalise_name(&words[from..to].join(" ")));
    let starts = |at: &usize| {
        let is_whole = (at + 1..=words.len()).any(|end| names(0, end) || names(at - 1, end));
        LEADS.contains(&words[*at]) && names(at - 1, *at) && !is_whole
    };
    (1..words.len().saturating_sub(1)).find(starts)
}

/// Whether a word only describes a thing ("large", "wooden") or means nothing.
fn is_quality(word: &str) -> bool {
    QUALITIES.contains(&word) || ADJECTIVES.contains(&word) || TELLS_NOTHING.contains(&word)
}

/// Whether words can name a thing: within the limits, and no words for qualities, materials or nothing at all.
fn is_name(name: &str) -> bool {
    let head = name.rsplit(' ').next().unwrap_or_default();
    let is_nothing = |word: &str| {
        let word = &normalise_name(word);
        let lists: [&[&str]; 4] = [&NO_OBJECTS, &ANYTHING, &ABSTRACT, &BUNCHES];
        lists.iter().any(|list| list.contains(&word.as_str())) || is_quality(word) || MATERIALS.contains(&word.as_str())
    };
    let fits = name.len() <= MAX_NAME_BYTES
        && name.split(' ').count() <= MAX_NAME_WORDS
        && name.chars().filter(|c| c.is_alphabetic()).count() >= 2;
    // The lexicon takes "image" for a picture on a wall, but a model means the view.
    let in_lexicon = is_thing(&normalise_name(name))
        && find_thing(name).is_some_and(|thing| thing.name != "picture" || head != "image");
    fits && (in_lexicon || !(is_nothing(head) || colour_at(&[head]).is_some()))
}

/// The rooms that a text may mean, and whether it is a guess.
pub(crate) fn read_rooms(said: &str) -> (Vec<String>, bool) {
    let said = &said[..said.floor_char_boundary(4 * MAX_NAME_BYTES)].to_lowercase();
    let words: Vec<&str> =
        said.split(|c: char| !(c.is_alphanumeric() || c == '\'')).filter(|word| !word.is_empty()).collect();
    let is_guess = said.contains('?') || words.iter().any(|word| GUESSING.contains(word));
    let mut names: Vec<String> = Vec::new();
    for alternative in words.split(|word| *word == "or") {
        let is_content_word = |word: &&str| !GUESSING.contains(word) && !matches!(*word, "a" | "an" | "the");
        let room_words: Vec<&str> = alternative.iter().copied().filter(is_content_word).collect();
        if let Some(name) = read_room(&room_words).filter(|name| !names.contains(name))
            && names.len() < MAX_NAMES
        {
            names.push(name);
        }
    }
    (names, is_guess)
}

/// The longest known room among the words, the last one if there are several; or else up to three words that end in "room".
fn read_room(words: &[&str]) -> Option<String> {
    // "n" is the rest of "n/a".
    const NO_ROOM_WORDS: [&str; 12] =
        ["unknown", "unclear", "none", "n", "null", "not", "cannot", "no", "nowhere", "room", "another", "indoors"];
    // A text that ends in "room" may name one in spite of such a word.
    let is_denied = words.iter().any(|word| NO_ROOM_WORDS.contains(word)) && words.last() != Some(&"room");
    let is_bare_room = words == ["room"];
    if is_denied || is_bare_room {
        return None;
    }
    let known = |from: usize, to: usize| is_room(&normalise_name(&words[from..to].join(" ")));
    for length in (1..=words.len().min(MAX_NAME_WORDS)).rev() {
        if let Some(from) = (0..=words.len() - length).rev().find(|from| known(*from, from + length)) {
            return Some(words[from..from + length].join(" "));
        }
    }
    let name = words.join(" ");
    let is_short = (1..=3).contains(&words.len()) && name.len() <= MAX_NAME_BYTES;
    let is_word = words.iter().all(|word| word.chars().all(char::is_alphabetic) && word.len() > 2);
    (is_short && is_word && words.last() == Some(&"room")).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_name_separates_a_name_from_its_surroundings() {
        for (said, names) in [
            ("Sofa", vec!["sofa"]),
            ("the large flat-screen television on the wall", vec!["television"]),
            ("two tall grey armchairs", vec!["armchair"]),
            ("a row of kitchen cabinets", vec!["kitchen cabinet"]),
            ("light wooden floor", vec!["floor"]),
            ("chest of drawers", vec!["chest of drawers"]),
            ("sofa or bench", vec!["sofa", "bench"]),
            ("sofa/couch", vec!["sofa", "couch"]),
            ("stainless steel refrigerator", vec!["refrigerator"]),
            ("soft, blotchy pattern", vec![]),
            ("soft", vec![]),
            ("white", vec![]),
            ("wooden", vec![]),
            ("item", vec![]),
            ("", vec![]),
            ("12", vec![]),
            ("\u{1f6cb}", vec![]),
        ] {
            assert_eq!(read_name(said).names, names, "{said}");
        }
    }

    #[test]
    fn read_name_returns_colours_material_number_and_doubt() {
        let told = read_name("possibly two dark grey leather armchairs");
        assert!(told.is_guess && told.several);
        assert_eq!((told.colours, told.material), (vec!["dark grey".to_owned()], Some("leather".to_owned())));
        assert!(read_name("piano?").is_guess && !read_name("piano").is_guess);
    }

    #[test]
    fn rooms_are_named_or_not_known() {
        for (said, wanted, guess) in [
            ("Living Room", vec!["living room"], false),
            ("kitchen or dining room", vec!["kitchen", "dining room"], false),
            ("possibly a hallway", vec!["hallway"], true),
            ("a large master bedroom", vec!["master bedroom"], false),
            ("unknown", vec![], false),
            ("not sure", vec![], false),
            ("the room", vec![], false),
            ("music room", vec!["music room"], false),
            ("I'm sorry, I cannot tell", vec![], false),
        ] {
            assert_eq!(read_rooms(said), (wanted.into_iter().map(str::to_owned).collect(), guess), "{said}");
        }
    }
}
