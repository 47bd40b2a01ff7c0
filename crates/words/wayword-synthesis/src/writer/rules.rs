//! The writer that works by rules, which follow what a style's references are like.

use super::{Brief, WriteError, Writer, place::the_place, telling};
use wayword_core::rng;

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
