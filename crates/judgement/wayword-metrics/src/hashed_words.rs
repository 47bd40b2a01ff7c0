//! A text encoder without a model: it counts words, so texts are similar if they share words.

use wayword_core::{ModelError, TextEncoder, seed};

/// How many slots words are hashed to. Different words in one slot count as the same word.
const HASH_SLOT_COUNT: u64 = 1024;

/// Encodes a text as counts of hashed words. Paraphrases in other words come out far apart, so its figures are comparable with each
/// other, but not with those of a sentence encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct HashedWordEncoder;

impl TextEncoder for HashedWordEncoder {
    fn name(&self) -> &str {
        "words"
    }

    fn encode_texts(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, ModelError> {
        Ok(texts.iter().map(|text| hashed_counts(text)).collect())
    }
}

/// How many words of a text fall into each slot, scaled to a vector of length 1.
fn hashed_counts(text: &str) -> Vec<f32> {
    // Texts without words have a slot of their own, because every vector has length 1.
    let mut counts = vec![0.0f32; HASH_SLOT_COUNT as usize + 1];
    let lower = text.to_lowercase();
    for word in lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()) {
        counts[(seed::derive_seed(0, &[word]) % HASH_SLOT_COUNT) as usize] += 1.0;
    }
    let length = counts.iter().map(|count| count * count).sum::<f32>().sqrt();
    if length == 0.0 {
        counts[HASH_SLOT_COUNT as usize] = 1.0;
        return counts;
    }
    counts.into_iter().map(|count| count / length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alike(a: &str, b: &str) -> f32 {
        hashed_counts(a).iter().zip(hashed_counts(b)).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn only_words_count_in_the_vector() {
        assert!((alike("Go to the sink.", "to the SINK go") - 1.0).abs() < 1e-6);
        assert!((alike("open the door", "open a window") - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(alike("open", "close"), 0.0);
    }

    #[test]
    fn a_text_without_words_has_a_vector_too() {
        assert_eq!(alike("", "?!"), 1.0);
        assert_eq!(alike("", "word"), 0.0);
    }
}
