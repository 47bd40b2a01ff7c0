//! Collects the words of a checked text that a reader should doubt, with alternatives: from the follower's other wordings, from
//! the checks, and from ambiguity.

use crate::follow::{FollowedPath, read_followable};
use wayword_checks::TextFindings;
use wayword_core::{TextAmbiguity, TextDoubt, doubt::separate_doubts};
use wayword_follower::{
    FeatureWeights,
    doubt::{DoubtBounds, find_doubts as by_changes, from_checks, is_too_long},
    route::UnfollowedReason,
};
use wayword_language::rewording::TokenisedText;

/// The words of a text that a reader should doubt.
#[derive(Debug, Clone, Default)]
pub struct TextDoubts {
    /// The doubts, without overlaps and in the order of the text.
    pub doubts: Vec<TextDoubt>,
    /// The reason, if the text could not be followed.
    pub unfollowed: Option<&'static str>,
}

/// Finds the words to doubt. With `tries_changes`, as in an open world, other wordings that would fit the walk better are tried.
/// Otherwise, as in a closed world, where the evidence decides about each word, only failed checks and ambiguity count.
pub(crate) fn find_doubts(
    followed: Option<&Result<FollowedPath<'_>, &'static str>>,
    (text, tag): (&str, Option<&str>),
    (checked, tries_changes): (&TextFindings, bool),
    ambiguity: Option<&TextAmbiguity>,
) -> TextDoubts {
    let followed =
        followed.map_or(Err("the texts were not to be followed"), |followed| followed.as_ref().map_err(|why| *why));
    let by_checks = || from_checks::doubts_from_findings(&checked.findings);
    let read = followed.and_then(|followed| Ok((followed, read_followable(text, tag)?)));
    let (doubts, unfollowed) = match read {
        Ok((followed, (guide, reading))) => {
            let spelt = TokenisedText::from_reading(text, &reading);
            let bounds_and_findings = (&DoubtBounds::default(), &checked.findings[..]);
            let changes =
                || by_changes(&spelt, &guide, followed.known_path(), FeatureWeights::fitted(), bounds_and_findings);
            let mut doubts = if tries_changes { changes() } else { by_checks() };
            let from_ambiguity = |ambiguity| from_checks::doubts_from_ambiguity(text, &guide, &reading, ambiguity);
            doubts.extend(ambiguity.into_iter().flat_map(from_ambiguity));
            (doubts, is_too_long(&guide).then(|| UnfollowedReason::TooManySteps.reason_words()))
        }
        Err(why) => (by_checks(), Some(why)),
    };
    TextDoubts { doubts: separate_doubts(text, doubts), unfollowed }
}
