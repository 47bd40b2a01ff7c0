//! How diverse a set of texts is: how little they repeat themselves and each other.

use super::{
    bleu::BleuCounts,
    numbered_text::{GRAM_ORDER_COUNT, NumberedText, gram_order},
    rouge::rouge_l,
};
use rand::Rng;
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use wayword_core::seeded_rng;

/// Words in a window of the type-token ratio.
const WINDOW_WORDS: usize = 50;
/// Pairs of texts that are compared at random.
const RANDOM_PAIR_COUNT: usize = 2_000;

/// How diverse texts are. There are no intervals: all but the last are figures of the whole set, and grow or fall with
/// its size, so that only sets of about the same size can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TextDiversity {
    /// How many texts.
    pub texts: usize,
    /// Mean BLEU-4 of each text against all others (Zhu 2018); lower is more diverse.
    pub self_bleu_4: Option<f64>,
    /// Different n-grams over all n-grams, for single words, pairs and triples (Li 2016).
    pub distinct: [Option<f64>; 3],
    /// Moving-average type-token ratio (Covington 2010) in windows of 50 words over the texts in their order.
    pub mattr_50: Option<f64>,
    /// Mean ROUGE-L of a text against one of another path, over pairs drawn at random; lower is more diverse.
    pub homogenisation: Option<f64>,
}

/// How diverse texts are, each with the path that it is about.
#[must_use]
pub fn measure_diversity(texts: &[(&str, &NumberedText)], seed: u64) -> TextDiversity {
    let all: Vec<&NumberedText> = texts.iter().map(|(_, text)| *text).collect();
    TextDiversity {
        texts: all.len(),
        self_bleu_4: self_bleu_4(&all),
        distinct: std::array::from_fn(|order| distinct_share(&all, order)),
        mattr_50: type_token_ratio(&all),
        homogenisation: measure_homogenisation(texts, seed),
    }
}

/// The two highest counts of an n-gram in any text, and which text has the highest. A text is compared with all others, so for the
/// owner of the highest count the second highest is used.
#[derive(Debug, Clone, Copy, Default)]
struct TopGramCounts {
    first: u32,
    owner: usize,
    second: u32,
}

/// Mean BLEU-4 of each text against all others; `None` for fewer than two texts.
fn self_bleu_4(texts: &[&NumberedText]) -> Option<f64> {
    let mut top_counts: BTreeMap<u128, TopGramCounts> = BTreeMap::new();
    let mut lengths: BTreeMap<usize, usize> = BTreeMap::new();
    for (owner, text) in texts.iter().enumerate() {
        *lengths.entry(text.len()).or_default() += 1;
        for gram in text.grams() {
            let top = top_counts.entry(gram.key).or_default();
            *top = if gram.count > top.first {
                TopGramCounts { first: gram.count, owner, second: top.first }
            } else {
                TopGramCounts { second: top.second.max(gram.count), ..*top }
            };
        }
    }
    let score_text = |(owner, text): (usize, &&NumberedText)| {
        let mut counts = BleuCounts::for_text(text, &[]);
        for gram in text.grams() {
            let top = top_counts.get(&gram.key).copied().unwrap_or_default();
            let others = if top.owner == owner { top.second } else { top.first };
            counts.correct[gram.order()] += u64::from(gram.count.min(others));
        }
        counts.reference = closest_length(&lengths, text.len()) as u64;
        counts.bleu_scores()[GRAM_ORDER_COUNT - 1]
    };
    let scores: Vec<f64> = texts.iter().enumerate().map(score_text).collect();
    (texts.len() > 1).then(|| scores.iter().sum::<f64>() / scores.len() as f64)
}

/// The length closest to `length` among the other texts; of two equally close ones the shorter. `lengths` counts the texts of each
/// length, the text itself included.
fn closest_length(lengths: &BTreeMap<usize, usize>, length: usize) -> usize {
    let shared = lengths.get(&length).is_some_and(|count| *count > 1);
    let below = lengths.range(..length).next_back();
    let above = lengths.range(length + 1..).next();
    let near = [below, above].into_iter().flatten().map(|(other, _)| (other.abs_diff(length), *other)).min();
    if shared { length } else { near.map_or(0, |(_, other)| other) }
}

/// Different n-grams over all n-grams. `order` is n less one.
fn distinct_share(texts: &[&NumberedText], order: usize) -> Option<f64> {
    let grams = texts.iter().flat_map(|text| text.grams()).filter(|gram| gram_order(gram.key) == order);
    let (mut different, mut all) = (HashSet::new(), 0u64);
    for gram in grams {
        different.insert(gram.key);
        all += u64::from(gram.count);
    }
    (all > 0).then(|| different.len() as f64 / all as f64)
}

/// The mean share of different words in windows of [`WINDOW_WORDS`] words, which move by one word at a time.
fn type_token_ratio(texts: &[&NumberedText]) -> Option<f64> {
    let words: Vec<u32> = texts.iter().flat_map(|text| text.words()).copied().collect();
    let width = WINDOW_WORDS.min(words.len());
    if width == 0 {
        return None;
    }
    let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
    let mut types = 0usize;
    for (at, word) in words.iter().enumerate() {
        *counts.entry(*word).or_default() += 1;
        if at >= width {
            let leaving = words[at - width];
            if let Some(count) = counts.get_mut(&leaving) {
                *count -= 1;
                if *count == 0 {
                    counts.remove(&leaving);
                }
            }
        }
        if at + 1 >= width {
            types += counts.len();
        }
    }
    Some(types as f64 / (words.len() - width + 1) as f64 / width as f64)
}

/// Mean ROUGE-L of random pairs of texts about different paths; `None` where there is a single path.
fn measure_homogenisation(texts: &[(&str, &NumberedText)], seed: u64) -> Option<f64> {
    let paths: HashSet<&str> = texts.iter().map(|(path, _)| *path).collect();
    if paths.len() < 2 {
        return None;
    }
    let mut rng = seeded_rng(seed, &["homogenisation"]);
    let mut drawn = Vec::with_capacity(RANDOM_PAIR_COUNT);
    while drawn.len() < RANDOM_PAIR_COUNT {
        let [(path, text), (other_path, other)] = [0; 2].map(|_| texts[rng.random_range(0..texts.len())]);
        if path != other_path {
            drawn.push(rouge_l(text, &[other]));
        }
    }
    Some(drawn.iter().sum::<f64>() / drawn.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::captions::CaptionVocabulary;

    fn texts(said: &[&str]) -> Vec<NumberedText> {
        let mut vocabulary = CaptionVocabulary::default();
        said.iter().map(|text| vocabulary.number_text(&text.split(' ').collect::<Vec<_>>())).collect()
    }

    fn of(said: &[&str]) -> TextDiversity {
        let texts = texts(said);
        let names: Vec<String> = (0..texts.len()).map(|at| at.to_string()).collect();
        let pairs: Vec<(&str, &NumberedText)> = names.iter().map(String::as_str).zip(&texts).collect();
        measure_diversity(&pairs, 7)
    }

    #[test]
    fn the_same_text_again_and_again_is_not_diverse() {
        let same = of(&["go up the long stairs now"; 3]);
        assert!((same.self_bleu_4.unwrap() - 1.0).abs() < 1e-6 && (same.homogenisation.unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(same.distinct, [Some(1.0 / 3.0); 3]);
        assert_eq!(same.mattr_50, Some(6.0 / 18.0));
    }

    #[test]
    fn texts_without_a_common_word_are_diverse() {
        let other = of(&["go up the stairs", "walk past every door"]);
        assert!(other.self_bleu_4.unwrap() < 1e-6);
        assert_eq!((other.homogenisation, other.distinct), (Some(0.0), [Some(1.0); 3]));
    }

    /// The fast way of self-BLEU gives what the definition gives.
    #[test]
    fn self_bleu_is_the_mean_against_all_others() {
        let texts =
            texts(&["go up the stairs", "go up the long stairs", "go past the the door", "wait by the door up"]);
        let all: Vec<&NumberedText> = texts.iter().collect();
        let one = |at: usize| {
            let others: Vec<&NumberedText> =
                (0..all.len()).filter(|other| *other != at).map(|other| all[other]).collect();
            BleuCounts::for_text(all[at], &others).bleu_scores()[3]
        };
        let expected = (0..all.len()).map(one).sum::<f64>() / all.len() as f64;
        assert!((self_bleu_4(&all).unwrap() - expected).abs() < 1e-15);
    }

    #[test]
    fn windows_move_by_one_word() {
        let long: Vec<String> = (0..60).map(|n| if n < 10 { "same".to_owned() } else { n.to_string() }).collect();
        let found = of(&[&long.join(" ")]).mattr_50.unwrap();
        // Windows from 0 to 10: ten of the same word less one for each step.
        let expected =
            (0..=10).map(|start| (if start < 10 { 1 } else { 0 }) + 40 + start).sum::<usize>() as f64 / 11.0 / 50.0;
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn diversity_is_none_for_too_few_texts() {
        let nothing = measure_diversity(&[], 0);
        assert_eq!((nothing.self_bleu_4, nothing.mattr_50, nothing.homogenisation), (None, None, None));
        assert_eq!(of(&["alone"]).self_bleu_4, None);
    }
}
