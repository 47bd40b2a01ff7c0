//! Marks doubtful words in the texts of a study, for the conditions that show such marks to people.

use super::choose_paths::StudyWalk;
use std::collections::BTreeSet;
use wayword_core::{Path, Platform};
use wayword_run::{check::find_text_doubts, error::CommandError, output::CommandOutput};
use wayword_study::{StudyCondition, StudyText, TextMark};

/// Finds the words to doubt in the texts of the conditions that show them, and marks them. Texts are checked in the open world,
/// like texts of unknown origin.
///
/// # Errors
/// When the platform cannot give the views along a path.
pub(super) fn mark_doubts(
    walks: &mut [StudyWalk],
    conditions: &[StudyCondition],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let shown: BTreeSet<&str> =
        conditions.iter().filter(|condition| condition.shows_doubts).map(|condition| condition.name.as_str()).collect();
    let is_shown = |text: &&StudyText| shown.contains(text.condition.as_str());
    let texts: Vec<(Path, String)> = walks
        .iter()
        .flat_map(|walk| {
            walk.condition_texts.iter().filter(is_shown).map(|text| (walk.path.clone(), text.text.clone()))
        })
        .collect();
    if texts.is_empty() {
        return Ok(());
    }
    // The doubts come in the order of the texts, which is that of the loop below.
    let mut doubts = find_text_doubts(texts, platform, output)?.into_iter();
    for text in walks
        .iter_mut()
        .flat_map(|walk| &mut walk.condition_texts)
        .filter(|text| shown.contains(text.condition.as_str()))
    {
        text.marks = doubts.next().unwrap_or_default().into_iter().map(TextMark::from).collect();
    }
    Ok(())
}
