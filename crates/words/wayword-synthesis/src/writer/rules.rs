//! The writer that works by rules; their parameters are measured on a style's references.

use super::{
    InstructionWriter, WriteError, WritingBrief,
    dice::TextDice,
    draft::TextDraft,
    place::{PlaceContent, write_place_text},
    way,
};

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
        RulesDraft::write(brief).map(|(text, _)| text)
    }
}

/// What a text by rules tells.
pub(super) enum RulesDraft<'a> {
    /// A way, step by step.
    Way(TextDraft<'a>),
    /// The place at the end.
    Place(PlaceContent),
}

impl<'a> RulesDraft<'a> {
    /// The English text for a brief, and what it tells.
    pub(super) fn write(brief: &'a WritingBrief<'_>) -> Result<(String, Self), WriteError> {
        let dice = TextDice::for_brief(brief);
        if !brief.profile.tells_turns() {
            return write_place_text(brief, dice).map(|(text, content)| (text, Self::Place(content)));
        }
        let task = way::draw_ending(brief, &mut dice.named_rng(&["task"]))?;
        let no_plan = || WriteError::Unusable { text: String::new(), reason: "the way has no plan".to_owned() };
        let (text, draft) = way::write_way_text(brief, task.as_ref(), dice).ok_or_else(no_plan)?;
        Ok((text, Self::Way(draft)))
    }
}
