//! From phrases to a text.

use super::phrases::pick;
use rand_chacha::ChaCha8Rng;

/// Phrases as sentences, shared out evenly, in their order.
pub(super) fn sentences(phrases: &[String], count: usize, full_stop: bool, rng: &mut ChaCha8Rng) -> String {
    let count = count.clamp(1, phrases.len().max(1));
    let bounds: Vec<usize> = (0..=count).map(|at| at * phrases.len() / count).collect();
    let parts: Vec<String> = bounds.windows(2).map(|pair| capital(&join(&phrases[pair[0]..pair[1]], rng))).collect();
    let mut text = parts.join(". ");
    if full_stop || count > 1 {
        text.push('.');
    }
    text
}

/// Phrases as one sentence without its full stop. A phrase that holds an "and" of its own is set off by "then".
pub(super) fn join(phrases: &[String], rng: &mut ChaCha8Rng) -> String {
    let Some((last, before)) = phrases.split_last() else { return String::new() };
    if before.is_empty() {
        return last.clone();
    }
    let has_and = phrases.iter().any(|phrase| phrase.contains(" and "));
    let link = if has_and {
        pick(rng, &[", then ", ", and then "])
    } else {
        pick(rng, &[" and ", ", then ", " and then ", " and "])
    };
    format!("{}{link}{last}", before.join(", "))
}

/// A text with its first letter as a capital.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
