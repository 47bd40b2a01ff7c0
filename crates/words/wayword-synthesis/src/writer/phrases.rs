//! Helpers for words and random choices that the writers of ways and of places share. In templates `{s}` is a side,
//! `{l}` a landmark, `{r}` a room.

use crate::weighted_draw::draw_weighted;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::PathMotion;
use wayword_language::lexicon::room_name;

/// Phrases for a path that goes nowhere.
const STAY_PHRASES: &[&str] = &["stay where you are", "remain where you are", "stay here", "remain here"];
/// The same with the room.
const STAY_IN_ROOM_PHRASES: &[&str] = &["stay in {r}", "remain in {r}", "stay here in {r}"];

/// Draws one of several options, all with the same probability.
pub(super) fn pick_any<'a, T: ?Sized>(rng: &mut ChaCha8Rng, options: &[&'a T]) -> &'a T {
    options[rng.random_range(0..options.len())]
}

/// The phrases that fit a motion: without "straight" if the motion is unknown.
pub(super) fn phrases_for_motion(phrases: &[&'static str], motion: PathMotion) -> Vec<&'static str> {
    phrases.iter().copied().filter(|way| motion.is_known() || !way.contains("straight")).collect()
}

/// A room with its article.
pub(super) fn with_the(room: &str) -> String {
    format!("the {room}")
}

/// Draws one of several options with their weights; `None` if no weight is over 0.
pub(super) fn draw_option<T: Clone>(options: &[(f64, T)], rng: &mut ChaCha8Rng) -> Option<T> {
    let possible: Vec<&(f64, T)> = options.iter().filter(|(weight, _)| *weight > 0.0).collect();
    let weights: Vec<f64> = possible.iter().map(|(weight, _)| *weight).collect();
    // If there is no option, no random number is consumed.
    let at = if weights.is_empty() { None } else { draw_weighted(&weights, rng) };
    at.map(|at| possible[at].1.clone())
}

/// Draws one of several measured numbers; 1 if there are none.
pub(super) fn draw_measure(values: &[usize], rng: &mut ChaCha8Rng) -> usize {
    if values.is_empty() { 1 } else { values[rng.random_range(0..values.len())] }
}

/// The ordinal of a storey or place, from "first" to "fifth"; `None` beyond.
pub(super) fn ordinal_of(level: u32) -> Option<&'static str> {
    ["first", "second", "third", "fourth", "fifth"].get(level.checked_sub(1)? as usize).copied()
}

/// A phrase for a path that goes nowhere, with its room where the name is known.
pub(super) fn stay_phrase(room: Option<&str>, rng: &mut ChaCha8Rng) -> String {
    match room {
        Some(room) => fill_gaps(pick_any(rng, STAY_IN_ROOM_PHRASES), &[("{r}", &with_the(room))]),
        None => pick_any(rng, STAY_PHRASES).to_owned(),
    }
}

/// A template with its gaps filled. One is "on" a balcony or porch, not "in" it.
pub(super) fn fill_gaps(template: &str, gaps: &[(&str, &str)]) -> String {
    let text = gaps.iter().fold(template.to_owned(), |text, (gap, value)| text.replace(gap, value));
    let open_air = gaps.iter().any(|(gap, room)| {
        *gap == "{r}" && matches!(room_name(room.trim_start_matches("the ")), Some("porch" | "balcony"))
    });
    if open_air {
        // But one stands in its doorway.
        let parts =
            text.replace("into the", "onto the").replace(" inside the", " on the").replace(" in the", " on the");
        parts.replace(" on the doorway", " in the doorway").replace(" on the entrance", " in the entrance")
    } else {
        text
    }
}
