//! Worlds with a thing less, a thing more, or a thing of another material or colour.

use super::{
    Outcome, Written,
    clauses::{Astray, astray, clauses},
};
use wayword_core::MentionKind;
use wayword_language::{
    lexicon::agree,
    text::{Token, tokens},
};

/// What is gone, or has come: its name, and the frames that see it or a namesake in one of the two worlds.
#[derive(Debug, Clone, Copy)]
pub struct Gone<'a> {
    /// The name.
    pub name: &'a str,
    /// The frames.
    pub seen_from: &'a [usize],
}

/// The name of what is gone is gone from the text, and clauses that speak of other frames than those that saw it are as they
/// were.
#[must_use]
pub fn remove(base: Written<'_>, changed: Written<'_>, gone: Gone<'_>) -> Outcome {
    if !tells(base, gone.name) {
        return Outcome::NotTold;
    }
    if tells(changed, gone.name) {
        return Outcome::Differs(format!("the text still tells the {}: \"{}\"", gone.name, changed.text));
    }
    local(base, changed, gone).map_or(Outcome::Holds, Outcome::Differs)
}

/// Only clauses that speak of frames that see what has come may differ.
#[must_use]
pub fn add(base: Written<'_>, changed: Written<'_>, come: Gone<'_>) -> Outcome {
    match local(base, changed, come) {
        Some(why) => Outcome::Differs(why),
        None if tells(changed, come.name) => Outcome::Holds,
        None => Outcome::NotTold,
    }
}

/// What differs in clauses that speak of no frame that sees the thing.
fn local(base: Written<'_>, changed: Written<'_>, thing: Gone<'_>) -> Option<String> {
    let (words, how) = match astray(&clauses(base), &clauses(changed), thing.seen_from)? {
        Astray::Lost(words) => (words, "gone"),
        Astray::New(words) => (words, "new"),
    };
    let name = thing.name;
    let whole = format!("\"{}\" became \"{}\"", base.text, changed.text);
    Some(format!("\"{words}\" speaks of no frame that sees the {name}, and is {how}: {whole}"))
}

/// Whether a text names a thing as one that is seen.
fn tells(written: Written<'_>, name: &str) -> bool {
    let is_thing =
        |mention: &&wayword_core::Mention| matches!(mention.kind, MentionKind::Landmark | MentionKind::Target);
    let mut said = written.mentions.iter().filter(is_thing);
    said.any(|mention| written.text.get(mention.span[0]..mention.span[1]).is_some_and(|words| agree(words, name)))
}

/// Where a thing's colour or material is another one, the text has the new word where it had the old one, with the article
/// that this takes, and nothing else has changed.
#[must_use]
pub fn material(base: Written<'_>, changed: Written<'_>, old: &str, new: &str) -> Outcome {
    let (before, after) = (tokens(base.text), tokens(changed.text));
    let (old, new): (Vec<Token>, Vec<Token>) = (tokens(old), tokens(new));
    let (mut was, mut is) = (before.as_slice(), after.as_slice());
    let mut is_told = false;
    while let ([one, ..], [other, ..]) = (was, is) {
        if begins(was, &old) && begins(is, &new) {
            is_told = true;
            (was, is) = (&was[old.len()..], &is[new.len()..]);
            continue;
        }
        let takes_article = begins(&was[1..], &old) && begins(&is[1..], &new);
        let is_article = takes_article && [one, other].iter().all(|token| matches!(token.word.as_str(), "a" | "an"));
        if base.text[one.span[0]..one.span[1]] != changed.text[other.span[0]..other.span[1]] && !is_article {
            break;
        }
        (was, is) = (&was[1..], &is[1..]);
    }
    match is_told {
        _ if !was.is_empty() || !is.is_empty() => {
            Outcome::Differs(format!("\"{}\" became \"{}\"", base.text, changed.text))
        }
        true => Outcome::Holds,
        false => Outcome::NotTold,
    }
}

/// Whether a text begins with some words.
fn begins(text: &[Token], with: &[Token]) -> bool {
    text.len() >= with.len() && text.iter().zip(with).all(|(a, b)| a.word == b.word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::Mention;

    /// A text with what it mentions: each name, its kind and its frame.
    fn mentions(text: &str, of: &[(&str, MentionKind, usize)]) -> Vec<Mention> {
        let mention = |(name, kind, frame): &(&str, MentionKind, usize)| {
            let from = text.find(name).unwrap();
            Mention { span: [from, from + name.len()], kind: *kind, frame: *frame }
        };
        of.iter().map(mention).collect()
    }

    use MentionKind::{Landmark, Room, Turn};

    const BASE: &str = "Leave the bedroom. Go past the sofa and turn left, then stop by the lamp.";
    const TOLD: [(&str, MentionKind, usize); 4] =
        [("bedroom", Room, 0), ("sofa", Landmark, 2), ("turn left", Turn, 4), ("lamp", Landmark, 6)];

    fn judged(text: &str, told: &[(&str, MentionKind, usize)], name: &str, seen_from: &[usize]) -> Outcome {
        let (before, after) = (mentions(BASE, &TOLD), mentions(text, told));
        let (base, changed) = (
            Written { text: BASE, mentions: &before, last_frame: 8 },
            Written { text, mentions: &after, last_frame: 8 },
        );
        remove(base, changed, Gone { name, seen_from })
    }

    #[test]
    fn what_is_gone_is_not_told_and_other_clauses_stay() {
        let text = "Leave the bedroom and go past the table. Turn left, and stop by the lamp.";
        let told = [("bedroom", Room, 0), ("table", Landmark, 2), ("Turn left", Turn, 4), ("lamp", Landmark, 6)];
        assert_eq!(judged(text, &told, "sofa", &[1, 2]), Outcome::Holds);
        assert_eq!(judged(text, &told, "piano", &[1, 2]), Outcome::NotTold);
        let why = |outcome| if let Outcome::Differs(why) = outcome { why } else { String::new() };
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
    fn a_clause_that_mentions_nothing_may_speak_of_the_frames_between_its_neighbours() {
        let text = "Leave the bedroom. Go straight and turn left, then stop by the lamp.";
        let told = [("bedroom", Room, 0), ("turn left", Turn, 4), ("lamp", Landmark, 6)];
        assert_eq!(judged(text, &told, "sofa", &[2]), Outcome::Holds);
    }

    #[test]
    fn what_has_come_changes_only_what_speaks_of_frames_that_see_it() {
        let text = "Leave the bedroom. Go past the piano and turn left, then stop by the lamp.";
        let told = [("bedroom", Room, 0), ("piano", Landmark, 2), ("turn left", Turn, 4), ("lamp", Landmark, 6)];
        let (before, after) = (mentions(BASE, &TOLD), mentions(text, &told));
        let (base, changed) = (
            Written { text: BASE, mentions: &before, last_frame: 8 },
            Written { text, mentions: &after, last_frame: 8 },
        );
        assert_eq!(add(base, changed, Gone { name: "piano", seen_from: &[2, 3] }), Outcome::Holds);
        assert_eq!(add(base, base, Gone { name: "piano", seen_from: &[2, 3] }), Outcome::NotTold);
        assert!(matches!(add(base, changed, Gone { name: "piano", seen_from: &[6] }), Outcome::Differs(_)));
    }

    #[test]
    fn of_a_material_only_the_word_changes() {
        let of = |text: &'static str| Written { text, mentions: &[], last_frame: 0 };
        let base = of("Pass a red sofa and stop.");
        assert_eq!(material(base, of("Pass an orange sofa and stop."), "red", "orange"), Outcome::Holds);
        let dark = of("Pass the dark red sofa.");
        assert_eq!(material(dark, of("Pass the orange sofa."), "dark red", "orange"), Outcome::Holds);
        assert_eq!(material(of("Pass a sofa."), of("Pass a sofa."), "red", "orange"), Outcome::NotTold);
        for other in ["Pass a sofa and stop.", "Pass an orange sofa and wait.", "Pass the orange sofa and stop."] {
            assert!(matches!(material(base, of(other), "red", "orange"), Outcome::Differs(_)), "{other}");
        }
    }
}
