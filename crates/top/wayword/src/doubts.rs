//! What a reader of a checked text should doubt.

use crate::follow::{Followed, followable};
use wayword_checks::{Checked, World};
use wayword_core::{Ambiguity, Doubt, doubt::apart_in};
use wayword_follower::{
    Weights,
    doubt::{Bounds, doubts as by_changes, said},
};

/// The words of a text that its checks, another wording or its ambiguity let doubt. In a closed world the evidence decides about each
/// word, so that no other wording is offered there.
pub(crate) fn doubts(
    followed: Option<&Followed<'_>>,
    (text, tag): (&str, Option<&str>),
    checked: &Checked,
    ambiguity: Option<&Ambiguity>,
) -> Vec<Doubt> {
    let by_checks = || said::of_findings(&checked.findings);
    let doubts = match followed.zip(followable(text, tag).ok()) {
        Some((followed, (guide, reading))) => {
            let found = (&Bounds::default(), &checked.findings[..]);
            let changes = || by_changes(text, &guide, followed.known(), Weights::fitted(), found);
            let mut doubts = if checked.world == World::Open { changes() } else { by_checks() };
            let of_ambiguity = |told| said::of_ambiguity(text, &guide, &reading, told);
            doubts.extend(ambiguity.into_iter().flat_map(of_ambiguity));
            doubts
        }
        None => by_checks(),
    };
    apart_in(text, doubts)
}
