//! How well captions fit the labels of their views: objects named correctly, hallucinated objects, and objects missed.
//!
//! The paper (arXiv 2403.11487) claims that its dialogue removes hallucinated objects, and does not measure it. This
//! module does, for any answerer.

use crate::dialogue::{OPENING_REQUEST, dialogue_sightings};
use serde::Serialize;
use wayword_checks::SeenThing;
use wayword_core::{DialogueExchange, WitnessAnswer};
use wayword_language::lexicon::{ThingClass, find_thing, names_agree};

/// How the objects of a caption agree with the labels of its view.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct CaptionScore {
    /// How many different objects the caption names, of those that labels can judge.
    pub named: usize,
    /// The named objects that no label of the view agrees with.
    pub hallucinated: Vec<String>,
    /// How many different names the labels of the view have.
    pub labelled: usize,
    /// How many of the label names the caption mentions.
    pub found: usize,
}

/// Compares the objects that a caption names with the labels of its view.
///
/// Walls, floors, doors and the like are left out on both sides: most label sets lack them, so a caption could neither
/// find nor invent them.
#[must_use]
pub fn score_caption(caption: &str, labels: &[SeenThing]) -> CaptionScore {
    let is_judged =
        |name: &str| !matches!(find_thing(name).map(|thing| thing.class), Some(ThingClass::Fabric | ThingClass::Door));
    // The caption is read as if it were the answer to the opening request of a dialogue.
    let sightings = dialogue_sightings(&[DialogueExchange::new(OPENING_REQUEST, caption)], "");
    let seen = sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Seen);
    let named = distinct_names(seen.map(|sighting| sighting.name.as_str()).filter(|name| is_judged(name)));
    let labelled = distinct_names(labels.iter().map(|label| label.name.as_str()).filter(|name| is_judged(name)));
    let in_list = |list: &[&str], name: &str| list.iter().any(|other| names_agree(other, name));
    let hallucinated = named.iter().filter(|name| !in_list(&labelled, name)).map(|name| (*name).to_owned());
    CaptionScore {
        named: named.len(),
        hallucinated: hallucinated.collect(),
        labelled: labelled.len(),
        found: labelled.iter().filter(|name| in_list(&named, name)).count(),
    }
}

/// The names, without those that mean the same as an earlier one.
fn distinct_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut kept: Vec<&str> = Vec::new();
    for name in names {
        if !kept.iter().any(|before| names_agree(before, name)) {
            kept.push(name);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(names: &[&str]) -> Vec<SeenThing> {
        let label = |name: &&str| SeenThing { name: (*name).to_owned(), ..SeenThing::default() };
        names.iter().map(label).collect()
    }

    #[test]
    fn hallucinated_objects_and_misses_are_counted_by_kind() {
        let score = score_caption(
            "A bedroom with a bed, two lamps and a mirror.",
            &labels(&["bed", "lamp", "lamp", "wardrobe"]),
        );
        assert_eq!((score.named, score.labelled, score.found), (3, 3, 2));
        assert_eq!(score.hallucinated, ["mirror"]);
    }

    #[test]
    fn score_caption_ignores_denied_things_and_walls() {
        let score = score_caption("There is a bed and no mirror. The wall is white.", &labels(&["bed"]));
        assert_eq!((score.named, score.hallucinated.len(), score.found), (1, 0, 1));
    }
}
