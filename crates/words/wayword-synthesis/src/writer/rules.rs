//! The writer that works by rules, which follow what a style's references are like.

use super::{
    Brief, WriteError, Writer,
    phrases::{drawn, pick},
    place::the_place,
    telling,
};
use rand_chacha::ChaCha8Rng;
use wayword_core::rng;
use wayword_language::text::capital;

/// Writes from captions and moves. Where the references name turns, it describes the way step by step; where they
/// don't, it names the place at the end. Length, sentences, storeys, task and full stop are drawn from the references
/// too.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesWriter;

impl Writer for RulesWriter {
    fn name(&self) -> &str {
        "rules"
    }

    fn write(&self, brief: &Brief<'_>) -> Result<String, WriteError> {
        let (attempt, candidate) = (brief.complaints.len().to_string(), brief.candidate.to_string());
        let mut rng = rng(brief.seed, &["rules", &brief.style.name, &brief.walk.path.id, &attempt, &candidate]);
        if !brief.profile.tells_turns() {
            return the_place(brief, &mut rng);
        }
        let task = telling::ending(brief, &mut rng)?;
        Ok(telling::the_way(brief, task.as_ref(), &mut rng))
    }
}

pub(super) fn sentence_target(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> usize {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    drawn(&brief.profile.sentences, rng).clamp(least, constraints.max_sentences.unwrap_or(usize::MAX).max(least))
}

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

/// Phrases as one sentence without its full stop. Where a phrase has an "and" of its own, "then" joins them.
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
