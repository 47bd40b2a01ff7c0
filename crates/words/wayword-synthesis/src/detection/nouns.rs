//! The names that a detector looks for even when no caption mentions them: a list of household things, and what the
//! reference texts of a style name often.

use std::collections::{BTreeMap, BTreeSet};
use wayword_core::InstructionStyle;
use wayword_language::{
    lexicon::{find_thing, normalise_name},
    reading::{EventContent, read_instruction},
};

/// The built-in list of household things, one name per line.
const HOUSEHOLD_NOUNS: &str = include_str!("nouns.txt");

/// Most names that one style adds; the rarer ones are left out.
const MAX_STYLE_NOUNS: usize = 30;

/// Most names of a list, because each costs time in every view. A longer list is refused.
const MAX_NOUNS: usize = 300;

/// Parses a list of names: one per line, `#` begins a comment. `None` if the list is empty or longer than the limit.
#[must_use]
pub fn parse_noun_list(text: &str) -> Option<Vec<String>> {
    let names = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    let names: BTreeSet<String> = names.filter(|name| !name.is_empty()).map(normalise_name).collect();
    (1..=MAX_NOUNS).contains(&names.len()).then(|| names.into_iter().collect())
}

/// The household things of the built-in list, and the things that the texts of these styles name most often.
#[must_use]
pub fn usual_nouns<'a>(styles: impl Iterator<Item = &'a InstructionStyle>) -> Vec<String> {
    let mut names: BTreeSet<String> = parse_noun_list(HOUSEHOLD_NOUNS).unwrap_or_default().into_iter().collect();
    styles.for_each(|style| names.extend(style_nouns(style)));
    names.into_iter().collect()
}

/// The things that the reference texts of a style name more than once, the most frequent first.
fn style_nouns(style: &InstructionStyle) -> Vec<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for text in &style.references {
        for event in read_instruction(text, &BTreeSet::new()).events {
            if let EventContent::Place(place) = event.what
                && place.is_thing
                && !place.is_room
                && let Some(thing) = find_thing(&place.name).filter(|thing| thing.salience >= 1)
            {
                *counts.entry(thing.name.to_owned()).or_default() += 1;
            }
        }
    }
    let mut names: Vec<(String, usize)> = counts.into_iter().filter(|(_, count)| *count > 1).collect();
    names.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    names.into_iter().take(MAX_STYLE_NOUNS).map(|(name, _)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_of_the_list_is_one_that_the_lexicon_has() {
        let names = parse_noun_list(HOUSEHOLD_NOUNS).unwrap();
        let strange: Vec<&String> =
            names.iter().filter(|name| find_thing(name).is_none_or(|thing| thing.salience == 0)).collect();
        assert!(strange.is_empty() && names.len() > 40, "{strange:?}");
    }

    #[test]
    fn usual_nouns_adds_things_that_a_style_names_repeatedly() {
        let references = ["Stop at the canoe.", "Pass the guitar and the sofa.", "Stop beside the guitar."];
        let style =
            InstructionStyle { references: references.map(str::to_owned).to_vec(), ..InstructionStyle::default() };
        let names = usual_nouns(std::iter::once(&style));
        assert!(names.contains(&"guitar".to_owned()) && names.contains(&"sofa".to_owned()), "{names:?}");
        assert!(!names.contains(&"canoe".to_owned()));
    }

    #[test]
    fn a_list_has_one_name_a_line_and_is_neither_empty_nor_endless() {
        assert_eq!(parse_noun_list("# mine\nRed Sofas\n\nlamp # tall").unwrap(), ["lamp", "red sofa"]);
        assert_eq!(parse_noun_list("# nothing"), None);
        let endless: String = (0..=MAX_NOUNS).map(|at| format!("thing{at}\n")).collect();
        assert_eq!(parse_noun_list(&endless), None);
    }
}
