//! Collects the words of a checked text that a reader should doubt, with alternatives: from the follower's other wordings, from
//! the checks, and from ambiguity.

use crate::follow::{Followed, followable};
use wayword_checks::{Checked, World};
use wayword_core::{Ambiguity, Doubt, doubt::apart_in};
use wayword_follower::{
    Weights,
    doubt::{Bounds, doubts as by_changes, is_too_long, said},
    route::Unfollowed,
};

/// The words of a text that a reader should doubt.
#[derive(Debug, Clone, Default)]
pub struct Doubted {
    /// The doubts, without overlaps and in the order of the text.
    pub doubts: Vec<Doubt>,
    /// The reason, if the text could not be followed.
    pub unfollowed: Option<&'static str>,
}

/// Finds the words to doubt. In an open world, other wordings that would fit the walk better are tried; in a closed world the
/// evidence decides about each word, so only failed checks and ambiguity count.
pub(crate) fn doubts(
    followed: Option<&Result<Followed<'_>, &'static str>>,
    (text, tag): (&str, Option<&str>),
    checked: &Checked,
    ambiguity: Option<&Ambiguity>,
) -> Doubted {
    let followed =
        followed.map_or(Err("the texts were not to be followed"), |followed| followed.as_ref().map_err(|why| *why));
    let by_checks = || said::of_findings(&checked.findings);
    let read = followed.and_then(|followed| Ok((followed, followable(text, tag)?)));
    let (doubts, unfollowed) = match read {
        Ok((followed, (guide, reading))) => {
            let found = (&Bounds::default(), &checked.findings[..]);
            let changes = || by_changes(text, &guide, followed.known(), Weights::fitted(), found);
            let mut doubts = if checked.world == World::Open { changes() } else { by_checks() };
            let of_ambiguity = |told| said::of_ambiguity(text, &guide, &reading, told);
            doubts.extend(ambiguity.into_iter().flat_map(of_ambiguity));
            (doubts, is_too_long(&guide).then(|| Unfollowed::TooManySteps.why()))
        }
        Err(why) => (by_checks(), Some(why)),
    };
    Doubted { doubts: apart_in(text, doubts), unfollowed }
}
