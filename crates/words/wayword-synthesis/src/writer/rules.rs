//! The writer that works by rules; their parameters are measured on a style's references.

use super::{InstructionWriter, WriteError, WritingBrief, dice::TextDice, place::write_place_text, way};

/// Writes from captions and moves. If the references mention turns, it describes the way step by step; otherwise it
/// names the place at the end. Length, sentences, storeys, task and full stop are drawn from the measured references
/// too.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesWriter;

impl InstructionWriter for RulesWriter {
    fn name(&self) -> &str {
        "rules"
    }

    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError> {
        let dice = TextDice::for_brief(brief);
        if !brief.profile.tells_turns() {
            return write_place_text(brief, dice);
        }
        let task = way::draw_ending(brief, &mut dice.named_rng(&["task"]))?;
        Ok(way::write_way_text(brief, task.as_ref(), dice))
    }
}
