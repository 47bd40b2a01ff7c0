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

/// Phrases as one sentence without its full stop.
pub(super) fn join(phrases: &[String], rng: &mut ChaCha8Rng) -> String {
    match phrases {
        [] => String::new(),
        [only] => only.clone(),
        [first, second] => format!("{first}{}{second}", pick(rng, &[" and ", ", then ", " and then ", ", "])),
        [before @ .., last] => {
            format!("{}{}{last}", before.join(", "), pick(rng, &[" and ", ", then ", " and then ", ", and "]))
        }
    }
}

/// A text with its first letter as a capital.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
