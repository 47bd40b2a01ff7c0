//! Checks for worlds with a thing removed, added, or given another colour or material.

use super::{
    AnnotatedText, ExpectationOutcome,
    clauses::{UnexpectedClause, clauses_with_frames, find_unexpected_clause},
};
use wayword_core::MentionKind;
use wayword_language::{
    lexicon::names_agree,
    text::{TextToken, split_tokens},
};

/// The thing that was removed or added: its name, and the frames that see it or a namesake in one of the two worlds.
#[derive(Debug, Clone, Copy)]
pub struct ChangedThing<'a> {
    /// The name.
    pub name: &'a str,
    /// The frames.
    pub seen_from: &'a [usize],
}

/// Checks that the text no longer names the removed thing, and that clauses about frames that did not see it are unchanged.
#[must_use]
pub fn check_removed_thing(
    base: AnnotatedText<'_>,
    changed: AnnotatedText<'_>,
    removed: ChangedThing<'_>,
) -> ExpectationOutcome {
    if !names_thing(base, removed.name) {
        return ExpectationOutcome::NotTold;
    }
    if names_thing(changed, removed.name) {
        return ExpectationOutcome::Differs(format!("the text still tells the {}: \"{}\"", removed.name, changed.text));
    }
    unexpected_difference(base, changed, removed).map_or(ExpectationOutcome::Holds, ExpectationOutcome::Differs)
}

/// Checks that only clauses about frames that see the added thing differ.
#[must_use]
pub fn check_added_thing(
    base: AnnotatedText<'_>,
    changed: AnnotatedText<'_>,
    added: ChangedThing<'_>,
) -> ExpectationOutcome {
    match unexpected_difference(base, changed, added) {
        Some(why) => ExpectationOutcome::Differs(why),
        None if names_thing(changed, added.name) => ExpectationOutcome::Holds,
        None => ExpectationOutcome::NotTold,
    }
}

/// The first difference in a clause about frames that do not see the thing, as a sentence.
fn unexpected_difference(
    base: AnnotatedText<'_>,
    changed: AnnotatedText<'_>,
    thing: ChangedThing<'_>,
) -> Option<String> {
    let (words, how) =
        match find_unexpected_clause(&clauses_with_frames(base), &clauses_with_frames(changed), thing.seen_from)? {
            UnexpectedClause::Lost(words) => (words, "gone"),
            UnexpectedClause::New(words) => (words, "new"),
        };
    let name = thing.name;
    let whole = format!("\"{}\" became \"{}\"", base.text, changed.text);
    Some(format!("\"{words}\" speaks of no frame that sees the {name}, and is {how}: {whole}"))
}

/// Whether a text mentions a thing as a landmark or a target.
fn names_thing(written: AnnotatedText<'_>, name: &str) -> bool {
    let is_thing =
        |mention: &&wayword_core::TextMention| matches!(mention.kind, MentionKind::Landmark | MentionKind::Target);
    let mut thing_mentions = written.mentions.iter().filter(is_thing);
    thing_mentions
        .any(|mention| written.text.get(mention.span[0]..mention.span[1]).is_some_and(|words| names_agree(words, name)))
}

/// Checks that the text has the word for the new colour or material in place of the old one, with the right article ("a red", "an
/// orange"), and that all other words are the same.
#[must_use]
pub fn check_changed_material(
    base: AnnotatedText<'_>,
    changed: AnnotatedText<'_>,
    old: &str,
    new: &str,
) -> ExpectationOutcome {
    let (before, after) = (split_tokens(base.text), split_tokens(changed.text));
    let (old, new): (Vec<TextToken>, Vec<TextToken>) = (split_tokens(old), split_tokens(new));
    // The tokens of each text that are not compared yet.
    let (mut was, mut is) = (before.as_slice(), after.as_slice());
    let mut is_mentioned = false;
    while let ([one, ..], [other, ..]) = (was, is) {
        if begins_with(was, &old) && begins_with(is, &new) {
            is_mentioned = true;
            (was, is) = (&was[old.len()..], &is[new.len()..]);
            continue;
        }
        let precedes_colour = begins_with(&was[1..], &old) && begins_with(&is[1..], &new);
        let is_article = precedes_colour && [one, other].iter().all(|token| matches!(token.word.as_str(), "a" | "an"));
        if base.text[one.span[0]..one.span[1]] != changed.text[other.span[0]..other.span[1]] && !is_article {
            break;
        }
        (was, is) = (&was[1..], &is[1..]);
    }
    match is_mentioned {
        _ if !was.is_empty() || !is.is_empty() => {
            ExpectationOutcome::Differs(format!("\"{}\" became \"{}\"", base.text, changed.text))
        }
        true => ExpectationOutcome::Holds,
        false => ExpectationOutcome::NotTold,
    }
}

/// Whether a text begins with some words.
fn begins_with(text: &[TextToken], with: &[TextToken]) -> bool {
    text.len() >= with.len() && text.iter().zip(with).all(|(a, b)| a.word == b.word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::TextMention;

    /// A text with what it mentions: each name, its kind and its frame.
    fn mentions(text: &str, of: &[(&str, MentionKind, usize)]) -> Vec<TextMention> {
        let mention = |(name, kind, frame): &(&str, MentionKind, usize)| {
            let from = text.find(name).unwrap();
            TextMention { span: [from, from + name.len()], kind: *kind, frame: *frame }
        };
        of.iter().map(mention).collect()
    }

    use MentionKind::{Landmark, Room, Turn};

    const BASE: &str = "Leave the bedroom. Go past the sofa and turn left, then stop by the lamp.";
    const TOLD: [(&str, MentionKind, usize); 4] =
        [("bedroom", Room, 0), ("sofa", Landmark, 2), ("turn left", Turn, 4), ("lamp", Landmark, 6)];

    fn judged(text: &str, told: &[(&str, MentionKind, usize)], name: &str, seen_from: &[usize]) -> ExpectationOutcome {
        let (before, after) = (mentions(BASE, &TOLD), mentions(text, told));
        let (base, changed) = (
            AnnotatedText { text: BASE, mentions: &before, last_frame: 8 },
            AnnotatedText { text, mentions: &after, last_frame: 8 },
        );
        check_removed_thing(base, changed, ChangedThing { name, seen_from })
    }

    #[test]
    fn check_removed_thing_expects_no_mention_of_the_thing_and_unchanged_other_clauses() {
        let text = "Leave the bedroom and go past the table. Turn left, and stop by the lamp.";
        let told = [("bedroom", Room, 0), ("table", Landmark, 2), ("Turn left", Turn, 4), ("lamp", Landmark, 6)];
        assert_eq!(judged(text, &told, "sofa", &[1, 2]), ExpectationOutcome::Holds);
        assert_eq!(judged(text, &told, "piano", &[1, 2]), ExpectationOutcome::NotTold);
        let why = |outcome| if let ExpectationOutcome::Differs(why) = outcome { why } else { String::new() };
        assert!(why(judged(BASE, &TOLD, "sofa", &[1, 2])).contains("still tells the sofa"));
        assert!(why(judged(text, &told, "sofa", &[1])).contains("\"go past the sofa\""));
        let short = "Leave the bedroom and turn left.";
        let told = [("bedroom", Room, 0), ("turn left", Turn, 4)];
        assert!(why(judged(short, &told, "sofa", &[2])).contains("\"stop by the lamp\""));
        let new = "Leave the bedroom, go past the piano and turn left, then stop by the lamp.";
        let told = [("bedroom", Room, 0), ("piano", Landmark, 3), ("turn left", Turn, 4), ("lamp", Landmark, 6)];
        assert!(why(judged(new, &told, "sofa", &[2])).contains("\"go past the piano\""));
    }

    #[test]
    fn a_clause_without_mentions_may_be_about_the_frames_between_its_neighbours() {
        let text = "Leave the bedroom. Go straight and turn left, then stop by the lamp.";
        let told = [("bedroom", Room, 0), ("turn left", Turn, 4), ("lamp", Landmark, 6)];
        assert_eq!(judged(text, &told, "sofa", &[2]), ExpectationOutcome::Holds);
    }

    #[test]
    fn check_added_thing_lets_only_clauses_about_frames_that_see_the_thing_differ() {
        let text = "Leave the bedroom. Go past the piano and turn left, then stop by the lamp.";
        let told = [("bedroom", Room, 0), ("piano", Landmark, 2), ("turn left", Turn, 4), ("lamp", Landmark, 6)];
        let (before, after) = (mentions(BASE, &TOLD), mentions(text, &told));
        let (base, changed) = (
            AnnotatedText { text: BASE, mentions: &before, last_frame: 8 },
            AnnotatedText { text, mentions: &after, last_frame: 8 },
        );
        assert_eq!(
            check_added_thing(base, changed, ChangedThing { name: "piano", seen_from: &[2, 3] }),
            ExpectationOutcome::Holds
        );
        assert_eq!(
            check_added_thing(base, base, ChangedThing { name: "piano", seen_from: &[2, 3] }),
            ExpectationOutcome::NotTold
        );
        assert!(matches!(
            check_added_thing(base, changed, ChangedThing { name: "piano", seen_from: &[6] }),
            ExpectationOutcome::Differs(_)
        ));
    }

    #[test]
    fn check_changed_material_lets_only_the_word_and_its_article_change() {
        let of = |text: &'static str| AnnotatedText { text, mentions: &[], last_frame: 0 };
        let base = of("Pass a red sofa and stop.");
        assert_eq!(
            check_changed_material(base, of("Pass an orange sofa and stop."), "red", "orange"),
            ExpectationOutcome::Holds
        );
        let dark = of("Pass the dark red sofa.");
        assert_eq!(
            check_changed_material(dark, of("Pass the orange sofa."), "dark red", "orange"),
            ExpectationOutcome::Holds
        );
        assert_eq!(
            check_changed_material(of("Pass a sofa."), of("Pass a sofa."), "red", "orange"),
            ExpectationOutcome::NotTold
        );
        for other in ["Pass a sofa and stop.", "Pass an orange sofa and wait.", "Pass the orange sofa and stop."] {
            assert!(
                matches!(check_changed_material(base, of(other), "red", "orange"), ExpectationOutcome::Differs(_)),
                "{other}"
            );
        }
    }
}
