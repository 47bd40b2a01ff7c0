//! BLEU-1 to BLEU-4 as `pycocoevalcap`'s `bleu_scorer.py` computes them: over the whole corpus, the share of the texts' n-grams (runs
//! of n words) that a reference has too. The score is lowered if the texts are shorter than the references closest in length.

use super::numbered_text::{GRAM_ORDER_COUNT, NumberedText};
use std::ops::{Add, AddAssign};

/// Added to denominators so that none is zero, as `pycocoevalcap` does.
const DENOMINATOR_EPSILON: f64 = 1e-9;
/// Added to numerators so that no product is zero, as `pycocoevalcap` does.
const NUMERATOR_EPSILON: f64 = 1e-15;

/// The counts that BLEU divides. For a corpus, the counts of all texts are added first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BleuCounts {
    /// N-grams that a reference has too, by their length.
    pub correct: [u64; GRAM_ORDER_COUNT],
    /// N-grams, by their length.
    pub guessed: [u64; GRAM_ORDER_COUNT],
    /// Words.
    pub words: u64,
    /// Words of the reference that is closest in length.
    pub reference: u64,
}

impl BleuCounts {
    /// Counts a text against its references.
    #[must_use]
    pub fn for_text(text: &NumberedText, references: &[&NumberedText]) -> Self {
        let mut correct = [0; GRAM_ORDER_COUNT];
        for (gram, most) in text.grams().iter().zip(highest_reference_counts(text, references)) {
            correct[gram.order()] += u64::from(gram.count.min(most));
        }
        let lengths = references.iter().map(|reference| (reference.len().abs_diff(text.len()), reference.len()));
        Self {
            correct,
            guessed: std::array::from_fn(|order| text.len().saturating_sub(order) as u64),
            words: text.len() as u64,
            reference: lengths.min().map_or(0, |(_, length)| length as u64),
        }
    }

    /// BLEU-1 to BLEU-4 of these counts.
    #[must_use]
    pub fn bleu_scores(&self) -> [f64; GRAM_ORDER_COUNT] {
        let ratio = (self.words as f64 + NUMERATOR_EPSILON) / (self.reference as f64 + DENOMINATOR_EPSILON);
        let brevity = if ratio < 1.0 { (1.0 - 1.0 / ratio).exp() } else { 1.0 };
        let mut product = 1.0;
        std::array::from_fn(|order| {
            product *=
                (self.correct[order] as f64 + NUMERATOR_EPSILON) / (self.guessed[order] as f64 + DENOMINATOR_EPSILON);
            f64::powf(product, 1.0 / (order as f64 + 1.0)) * brevity
        })
    }
}

/// For each n-gram of a text, its highest count in any one reference.
fn highest_reference_counts(text: &NumberedText, references: &[&NumberedText]) -> Vec<u32> {
    let mut highest = vec![0; text.grams().len()];
    for reference in references {
        // Both lists of n-grams are sorted, so one pass over both finds the common ones.
        let mut reference_grams = reference.grams().iter().peekable();
        for (gram, count) in text.grams().iter().zip(&mut highest) {
            while reference_grams.next_if(|other| other.key < gram.key).is_some() {}
            if let Some(same) = reference_grams.next_if(|other| other.key == gram.key) {
                *count = same.count.max(*count);
            }
        }
    }
    highest
}

impl Add for BleuCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: [u64; GRAM_ORDER_COUNT], b: [u64; GRAM_ORDER_COUNT]| std::array::from_fn(|at| a[at] + b[at]);
        Self {
            correct: sum(self.correct, other.correct),
            guessed: sum(self.guessed, other.guessed),
            words: self.words + other.words,
            reference: self.reference + other.reference,
        }
    }
}

impl AddAssign for BleuCounts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
