//! CIDEr-D as `pycocoevalcap`'s `cider_scorer.py` computes it (under the name CIDEr): the cosine of two texts' n-gram counts,
//! with weights that make n-grams count more if few items' references have them.

use super::numbered_text::{CountedGram, GRAM_ORDER_COUNT, NumberedText};
use std::{
    collections::HashMap,
    hash::{BuildHasherDefault, Hasher},
};

/// Standard deviation of the Gaussian penalty for a difference in length, words.
const LENGTH_SIGMA_WORDS: f64 = 6.0;
/// Scores are ten times a cosine.
const CIDER_SCALE: f64 = 10.0;

/// For each n-gram, the number of items with a reference that contains it.
#[derive(Debug, Default)]
struct GramOccurrences(HashMap<u128, u32, BuildHasherDefault<GramKeyHasher>>);

/// Hashes the key of an n-gram by two multiplications. That is fast, and safe enough: keys come from our own numbering of words,
/// so an attacker cannot choose keys that collide.
#[derive(Debug, Default)]
struct GramKeyHasher(u64);

impl Hasher for GramKeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u128(u128::from(*byte)));
    }

    fn write_u128(&mut self, key: u128) {
        let product = (self.0 ^ key as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (key >> 64) as u64;
        let product = u128::from(product) * 0xd6e8_feb8_6659_fd93;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }
}

impl GramOccurrences {
    /// Counts the n-grams of one item's references, each n-gram once.
    fn count_references(&mut self, references: &[&NumberedText]) {
        let mut keys: Vec<u128> = references.iter().flat_map(|text| text.grams()).map(|gram| gram.key).collect();
        keys.sort_unstable();
        keys.dedup();
        for key in keys {
            *self.0.entry(key).or_default() += 1;
        }
    }

    /// The text's n-grams, weighted by how rare they are among `items` items.
    fn weigh_text<'a>(&self, text: &'a NumberedText, items: f64) -> WeightedText<'a> {
        let mut squares = [0.0; GRAM_ORDER_COUNT];
        let weight = |gram: &CountedGram| {
            let items_with_gram = self.0.get(&gram.key).map_or(1.0, |count| f64::from(*count));
            let weight = f64::from(gram.count) * (items.ln() - items_with_gram.ln());
            squares[gram.order()] += weight * weight;
            weight
        };
        let weights = text.grams().iter().map(weight).collect();
        // `pycocoevalcap` counts pairs of words here where it should count words; we do the same.
        let length = text.len().saturating_sub(1) as f64;
        WeightedText { grams: text.grams(), weights, norms: squares.map(f64::sqrt), length }
    }
}

/// A text as a vector over n-grams.
struct WeightedText<'a> {
    /// The n-grams, sorted by their keys.
    grams: &'a [CountedGram],
    /// The weight of each n-gram: its count times how rare it is.
    weights: Vec<f64>,
    /// The length of the vector of weights, for the n-grams of 1 to 4 words.
    norms: [f64; GRAM_ORDER_COUNT],
    /// The length of the text, pairs of words.
    length: f64,
}

impl WeightedText<'_> {
    /// The sum over the lengths of n-grams of the clipped cosines, times the penalty for a difference in length.
    fn similarity_to(&self, reference: &Self) -> f64 {
        let mut products = [0.0; GRAM_ORDER_COUNT];
        let mut reference_grams = reference.grams.iter().zip(&reference.weights).peekable();
        for (gram, weight) in self.grams.iter().zip(&self.weights) {
            while reference_grams.next_if(|(other, _)| other.key < gram.key).is_some() {}
            if let Some((_, other_weight)) = reference_grams.next_if(|(other, _)| other.key == gram.key) {
                products[gram.order()] += weight.min(*other_weight) * other_weight;
            }
        }
        let difference = self.length - reference.length;
        let penalty = (-(difference * difference) / (2.0 * LENGTH_SIGMA_WORDS * LENGTH_SIGMA_WORDS)).exp();
        let cosine = |order: usize| match self.norms[order] * reference.norms[order] {
            norms if norms > 0.0 => products[order] / norms,
            _ => products[order],
        };
        (0..GRAM_ORDER_COUNT).map(cosine).sum::<f64>() * penalty
    }
}

/// CIDEr-D of each text against its references. How rare an n-gram is comes from the references of all these texts, so the
/// figure of one text depends on the others.
#[must_use]
pub fn cider_d(rows: &[super::CaptionRow<'_>]) -> Vec<f64> {
    let mut occurrences = GramOccurrences::default();
    rows.iter().for_each(|row| occurrences.count_references(&row.references));
    let items = rows.len() as f64;
    let score_row = |row: &super::CaptionRow<'_>| {
        let text = occurrences.weigh_text(row.text, items);
        let similarities =
            row.references.iter().map(|reference| text.similarity_to(&occurrences.weigh_text(reference, items)));
        similarities.sum::<f64>() / GRAM_ORDER_COUNT as f64 / row.references.len().max(1) as f64 * CIDER_SCALE
    };
    rows.iter().map(score_row).collect()
}
