//! Corruptions that repeat a sentence, swap two names, or take the text of another path.

use super::{
    building::nearest_m,
    corruptible_text::CorruptibleText,
    lists::{MOTION_WORDS, has_word},
    names::{BuildingMention, find_mentions},
    text::{split_clauses, split_sentences, split_words},
};
use crate::key::WordEdit;
use rand::{Rng, seq::IndexedRandom};

/// A sentence needs at least this many words to be repeated.
const MIN_SENTENCE_WORDS: usize = 4;
/// A room or an object is at a viewpoint if it is at most this far away, metres.
const AT_VIEWPOINT_M: f64 = 3.0;

/// Repeats a sentence that commands a motion.
pub(super) fn repeat_sentence(original: &CorruptibleText<'_>, rng: &mut impl Rng) -> Option<Vec<WordEdit>> {
    let moves = |sentence: &&[usize; 2]| {
        let words = split_words(&original.text[sentence[0]..sentence[1]]);
        words.len() >= MIN_SENTENCE_WORDS && words.iter().any(|word| has_word(&MOTION_WORDS, "motion", &word.low))
    };
    let all = split_sentences(original.text);
    let span = **all.iter().filter(moves).collect::<Vec<_>>().choose(rng)?;
    let sentence = &original.text[span[0]..span[1]];
    let stop = if sentence.ends_with(['.', '!', '?']) { "" } else { "." };
    Some(vec![WordEdit { span, now: format!("{sentence}{stop} {sentence}") }])
}

/// Swaps two rooms or two objects that are in different clauses. Both must be on the path, and no viewpoint may have both, because
/// the swapped text would be true there.
pub(super) fn swap_mentions(original: &CorruptibleText<'_>, rng: &mut impl Rng) -> Option<Vec<WordEdit>> {
    let clauses = split_clauses(original.text);
    let clause = |named: &BuildingMention| clauses.iter().position(|clause| named.span[0] < clause[1]);
    let names = find_mentions(&original.words, original.building);
    let known: Vec<(&BuildingMention, Vec<usize>)> =
        names.iter().map(|named| (named, places_on_path(original, named))).collect();
    let mut pairs = Vec::new();
    for (first, (a, at_a)) in known.iter().enumerate() {
        for (b, at_b) in &known[first + 1..] {
            let is_known = !at_a.is_empty() && !at_b.is_empty();
            let is_apart = !at_a.iter().any(|at| at_b.contains(at));
            let is_alike = a.is_room == b.is_room && a.name != b.name;
            if is_known && is_apart && is_alike && clause(a) != clause(b) {
                pairs.push((*a, *b));
            }
        }
    }
    let (a, b) = *pairs.choose(rng)?;
    let words = |named: &BuildingMention| original.text[named.span[0]..named.span[1]].to_owned();
    Some(vec![WordEdit { span: a.span, now: words(b) }, WordEdit { span: b.span, now: words(a) }])
}

/// The indices of the path's viewpoints at which the named room or object is.
fn places_on_path(original: &CorruptibleText<'_>, named: &BuildingMention) -> Vec<usize> {
    let places = named.possible_positions(original.building);
    let is_at = |at: &usize| nearest_m(&original.path[*at..=*at], &places).is_some_and(|off_m| off_m <= AT_VIEWPOINT_M);
    (0..original.path.len()).filter(is_at).collect()
}

/// Replaces the whole text by that of another path.
pub(super) fn take_other_path(original: &CorruptibleText<'_>, rng: &mut impl Rng) -> Option<Vec<WordEdit>> {
    let other = original.others.choose(rng).filter(|other| **other != original.text)?;
    Some(vec![WordEdit { span: [0, original.text.len()], now: (*other).to_owned() }])
}

#[cfg(test)]
mod tests {
    use super::{
        super::building::tests::{made_up_building, path},
        *,
    };
    use crate::key::apply_edits;
    use std::collections::BTreeSet;
    use wayword_core::seeded_rng;

    fn all(text: &str, change: impl Fn(&CorruptibleText<'_>, u64) -> Option<Vec<WordEdit>>) -> BTreeSet<String> {
        let building = made_up_building();
        let path = building.viewpoint_positions(&path(&[0, 2, 3]));
        let original =
            CorruptibleText { text, words: split_words(text), path, building: &building, others: &["Go home."] };
        (0..40).filter_map(|seed| Some(apply_edits(text, change(&original, seed)?)?.0)).collect()
    }

    #[test]
    fn twice_repeats_only_a_sentence_that_moves() {
        let twice =
            |text: &str| all(text, |original, seed| repeat_sentence(original, &mut seeded_rng(seed, &["test"])));
        let of_two = twice("Walk past the couch. The tv is on the left. Stop.");
        assert_eq!(
            of_two,
            ["Walk past the couch. Walk past the couch. The tv is on the left. Stop.".to_owned()].into()
        );
        assert_eq!(twice("Go to the couch"), ["Go to the couch. Go to the couch".to_owned()].into());
    }

    /// The bench is at the first viewpoint, the couch at the second, and the coffee table at the second and third.
    #[test]
    fn swapped_exchanges_names_only_if_the_text_becomes_wrong() {
        let swapped =
            |text: &str| all(text, |original, seed| swap_mentions(original, &mut seeded_rng(seed, &["test"])));
        assert_eq!(swapped("Pass the bench, then the couch."), ["Pass the couch, then the bench.".to_owned()].into());
        for text in
            ["Pass the bench to the couch.", "Pass the couch, then the coffee table.", "Pass the bench, then the sink."]
        {
            assert_eq!(swapped(text), BTreeSet::new(), "{text}");
        }
    }

    #[test]
    fn take_other_path_replaces_the_whole_text_by_a_different_one() {
        let other =
            |text: &str| all(text, |original, seed| take_other_path(original, &mut seeded_rng(seed, &["test"])));
        assert_eq!(other("Walk past the couch."), ["Go home.".to_owned()].into());
        assert_eq!(other("Go home."), BTreeSet::new());
    }
}
