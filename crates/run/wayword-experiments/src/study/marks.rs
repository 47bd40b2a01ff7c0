//! Marks doubtful words in the texts of a study, for the conditions that show such marks to people.

use super::walks::Walk;
use std::collections::BTreeSet;
use wayword_core::{Path, Platform};
use wayword_run::{check::doubts_of, error::Error, output::Output};
use wayword_study::{Condition, Mark, Told};

/// Finds the words to doubt in the texts of the conditions that show them, and marks them. Texts are checked in the open world,
/// like texts of unknown origin.
///
/// # Errors
/// When the platform cannot give the views along a path.
pub(super) fn mark(
    walks: &mut [Walk],
    conditions: &[Condition],
    platform: &dyn Platform,
    output: &Output,
) -> Result<(), Error> {
    let shown: BTreeSet<&str> =
        conditions.iter().filter(|condition| condition.shows_doubts).map(|condition| condition.name.as_str()).collect();
    let is_shown = |told: &&Told| shown.contains(told.condition.as_str());
    let texts: Vec<(Path, String)> = walks
        .iter()
        .flat_map(|walk| walk.told.iter().filter(is_shown).map(|told| (walk.path.clone(), told.text.clone())))
        .collect();
    if texts.is_empty() {
        return Ok(());
    }
    let mut doubts = doubts_of(texts, platform, output)?.into_iter();
    for told in walks.iter_mut().flat_map(|walk| &mut walk.told).filter(|told| shown.contains(told.condition.as_str()))
    {
        told.marks = doubts.next().unwrap_or_default().into_iter().map(Mark::from).collect();
    }
    Ok(())
}
