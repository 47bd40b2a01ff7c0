//! Corruptions that replace a room or an object of a text by one that is not on the path.

use super::{
    building::{nearest_m, to_plural},
    corruptible_text::CorruptibleText,
    lists::{MOTION_WORDS, OBJECT_WORDS, SMALL_WORDS, has_word, words_under},
    names::{BuildingMention, find_mentions},
    text::split_sentences,
};
use crate::key::WordEdit;
use rand::{Rng, seq::IndexedRandom};
use wayword_core::DVec3;

/// A room could be seen from a path if it is nearer than this, metres.
const ROOM_OFF_M: f64 = 5.0;
/// An object could be seen from a path if it is nearer than this, metres.
const OBJECT_OFF_M: f64 = 8.0;
/// The labels along a path may list an object that is nearer than this, metres.
const OBJECT_NEAR_M: f64 = 3.0;

/// How far from the path the new room or object is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReplacementDistance {
    /// Nowhere in the building.
    Lacking,
    /// In the building, but too far from the path to be seen.
    Far,
    /// Near the path, but too far to be listed on it. Only objects have this.
    Near,
}

impl ReplacementDistance {
    /// Whether a new room may be this far from the path; `None` means that the building has no such room.
    fn has_room(self, off_m: Option<f64>) -> bool {
        match self {
            Self::Lacking => off_m.is_none(),
            Self::Far => off_m.is_some_and(|off_m| off_m >= ROOM_OFF_M),
            Self::Near => false,
        }
    }

    /// Whether a new object may be this far from the path; `None` means that the building has no such object.
    fn has_object(self, off_m: Option<f64>) -> bool {
        match self {
            Self::Lacking => off_m.is_none(),
            Self::Far => off_m.is_some_and(|off_m| off_m >= OBJECT_OFF_M),
            Self::Near => off_m.is_some_and(|off_m| (OBJECT_NEAR_M..OBJECT_OFF_M).contains(&off_m)),
        }
    }
}

/// Replaces one room of the text by another.
pub(super) fn replace_room(
    original: &CorruptibleText<'_>,
    whereabouts: ReplacementDistance,
    rng: &mut impl Rng,
) -> Option<Vec<WordEdit>> {
    let named =
        find_mentions(&original.words, original.building).into_iter().filter(|named| named.is_room).collect::<Vec<_>>();
    let old = named.choose(rng)?;
    Some(vec![replacement_edit(original.text, old, other_room(original, old, whereabouts, &original.path, rng)?)])
}

/// Replaces one object of the text by another.
pub(super) fn replace_object(
    original: &CorruptibleText<'_>,
    whereabouts: ReplacementDistance,
    rng: &mut impl Rng,
) -> Option<Vec<WordEdit>> {
    let named = find_mentions(&original.words, original.building)
        .into_iter()
        .filter(|named| !named.is_room)
        .collect::<Vec<_>>();
    let old = named.choose(rng)?;
    Some(vec![replacement_edit(original.text, old, other_object(original, old, whereabouts, &original.path, rng)?)])
}

/// Replaces the place at which the text's last sentence commands to stop by one that is far from the last viewpoint.
pub(super) fn replace_stop(original: &CorruptibleText<'_>, rng: &mut impl Rng) -> Option<Vec<WordEdit>> {
    let last = split_sentences(original.text).pop()?;
    let stops = |low: &str| has_word(&MOTION_WORDS, "stop", low);
    let verb = original.words.iter().rfind(|word| word.span[0] >= last[0] && stops(&word.low))?;
    let old =
        find_mentions(&original.words, original.building).into_iter().find(|named| named.span[0] > verb.span[1])?;
    let end = original.path.last().map(std::slice::from_ref)?;
    let new = if old.is_room {
        other_room(original, &old, ReplacementDistance::Far, end, rng)?
    } else {
        other_object(original, &old, ReplacementDistance::Far, end, rng)?
    };
    Some(vec![replacement_edit(original.text, &old, new)])
}

/// Another room than `old`, at the asked distance from the positions `from`.
fn other_room(
    original: &CorruptibleText<'_>,
    old: &BuildingMention,
    whereabouts: ReplacementDistance,
    from: &[DVec3],
    rng: &mut impl Rng,
) -> Option<&'static str> {
    let fits = |kind: &&&str| {
        **kind != old.name && whereabouts.has_room(nearest_m(from, &original.building.room_positions(kind)))
    };
    let others: Vec<_> = words_under(&SMALL_WORDS, "rooms to say").iter().filter(fits).collect();
    others.choose(rng).map(|kind| **kind)
}

/// Another object than `old`, at the asked distance from the positions `from`.
fn other_object(
    original: &CorruptibleText<'_>,
    old: &BuildingMention,
    whereabouts: ReplacementDistance,
    from: &[DVec3],
    rng: &mut impl Rng,
) -> Option<&'static str> {
    let last_of_old = old.name.split(' ').next_back()?;
    let fits = |(name, alike): &(&&'static str, &Vec<&'static str>)| {
        let is_same = **name == old.name || alike.contains(&old.name.as_str()) || alike.contains(&last_of_old);
        !is_same && whereabouts.has_object(nearest_m(from, &original.building.object_positions(name)))
    };
    let others: Vec<&str> = OBJECT_WORDS.iter().filter(fits).map(|(name, _)| *name).collect();
    others.choose(rng).copied()
}

/// The edit that replaces a name. It adapts the article before it, and keeps the plural.
fn replacement_edit(text: &str, old: &BuildingMention, new: &str) -> WordEdit {
    let new = if old.is_plural { to_plural(new) } else { new.to_owned() };
    let Some(article) = old.article else { return WordEdit { span: old.span, now: new } };
    let is_capital = text.get(article[0]..).is_some_and(|rest| rest.starts_with('A'));
    let article_now = match (is_capital, new.starts_with(['a', 'e', 'i', 'o', 'u'])) {
        (true, true) => "An",
        (true, false) => "A",
        (false, true) => "an",
        (false, false) => "a",
    };
    WordEdit { span: [article[0], old.span[1]], now: format!("{article_now} {new}") }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            building::{
                LabelledBuilding,
                tests::{made_up_building, path},
            },
            text::split_words,
        },
        *,
    };
    use crate::key::apply_edits;
    use std::collections::BTreeSet;
    use wayword_core::seeded_rng;

    /// Everything that a replacement makes of a text on a path, over many seeds.
    fn all(
        text: &str,
        places: &[usize],
        replace: impl Fn(&CorruptibleText<'_>, u64) -> Option<Vec<WordEdit>>,
    ) -> BTreeSet<String> {
        let building: LabelledBuilding = made_up_building();
        let path = building.viewpoint_positions(&path(places));
        let original = CorruptibleText { text, words: split_words(text), path, building: &building, others: &[] };
        let texts = (0..300).filter_map(|seed| Some(apply_edits(text, replace(&original, seed)?)?.0));
        texts.collect()
    }

    fn rooms(text: &str, places: &[usize], whereabouts: ReplacementDistance) -> BTreeSet<String> {
        all(text, places, |original, seed| replace_room(original, whereabouts, &mut seeded_rng(seed, &["test"])))
    }

    fn objects(text: &str, places: &[usize], whereabouts: ReplacementDistance) -> BTreeSet<String> {
        all(text, places, |original, seed| replace_object(original, whereabouts, &mut seeded_rng(seed, &["test"])))
    }

    #[test]
    fn room_replaces_by_one_that_the_building_lacks_or_has_far_from_the_path() {
        let text = "Wait in an entryway.";
        let lacking = rooms(text, &[0, 1], ReplacementDistance::Lacking);
        let expected = ["dining room", "laundry room", "garage", "gym", "library", "classroom", "spa"];
        assert_eq!(lacking, expected.map(|room| format!("Wait in a {room}.")).into());
        // Upstairs, only the bathroom is 5 m off from the whole path: the office is above the entryway.
        let far = rooms(text, &[0, 2], ReplacementDistance::Far);
        assert!(far.contains("Wait in a bathroom.") && far.contains("Wait in a kitchen."), "{far:?}");
        assert!(!far.contains("Wait in an office.") && !far.contains("Wait in a living room."), "{far:?}");
    }

    #[test]
    fn an_object_is_replaced_by_one_that_no_label_has_or_that_is_far_from_the_path() {
        let text = "Pass the benches";
        let lacking = objects(text, &[0], ReplacementDistance::Lacking);
        assert!(lacking.contains("Pass the pianos") && lacking.contains("Pass the fireplaces"), "{lacking:?}");
        assert!(!lacking.iter().any(|text| text.contains("couch") || text.contains("mirror")), "{lacking:?}");
        let far = objects(text, &[0], ReplacementDistance::Far);
        assert!(far.contains("Pass the refrigerators") && !far.contains("Pass the couches"), "{far:?}");
        let near = objects(text, &[0], ReplacementDistance::Near);
        assert!(near.contains("Pass the couches") && !near.contains("Pass the mirrors"), "{near:?}");
    }

    #[test]
    fn only_the_place_where_the_text_stops_is_replaced_by_one_far_from_the_last_viewpoint() {
        let stops = |text: &str| {
            all(text, &[0, 2, 3], |original, seed| replace_stop(original, &mut seeded_rng(seed, &["test"])))
        };
        let objects = stops("Pass the bench. Stop next to the couch.");
        // Of all listed objects, only the vase is 8 m off.
        assert_eq!(objects, ["Pass the bench. Stop next to the vase.".to_owned()].into());
        assert!(!stops("Wait at the end of the hallway").is_empty());
        for text in ["Stop by the couch. Then walk on.", "Walk to the couch.", "Pass the couch and stop."] {
            assert_eq!(stops(text), BTreeSet::new(), "{text}");
        }
    }
}
