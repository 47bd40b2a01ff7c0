//! Finds denials: actions that an instruction forbids, and things that it declares absent. The checks must not take
//! "do not turn right" for a turn.

use super::{tokens::TokenSlice, vocabulary as v};

/// For each token, whether the text denies it: "do not turn right", "without going up the stairs", "there is no piano",
/// "if you reach the stairs you have gone too far".
pub(super) fn denied_tokens(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<bool> {
    let mut denied = denied_by_words(tokens, clauses);
    deny_wrong_ways(tokens, clauses, &mut denied);
    denied
}

/// How far a denial reaches.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DenialReach {
    /// There is no denial.
    Nothing,
    /// To the end of the noun phrase: "no piano in the hall".
    Phrase,
    /// To the next "and": "straight without turning and into the hall".
    And,
    /// To the end of the clause.
    Clause,
}

/// For each token, whether a word of denial before it ("not", "no", "without") reaches it.
fn denied_by_words(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<bool> {
    // The denial that is in force, and its clause.
    let mut reach = DenialReach::Nothing;
    let mut clause = 0;
    let is_denied = |at: usize| {
        let word = tokens.word_at(at);
        if clauses[at] != clause || matches!(word, "but" | "until" | "till") {
            (reach, clause) = (DenialReach::Nothing, clauses[at]);
        }
        let goes_on = v::DETERMINERS.contains(&word) || matches!(word, "or" | "nor" | "of");
        if reach == DenialReach::Phrase && v::BREAKERS.contains(&word) && !goes_on {
            reach = DenialReach::Nothing;
        }
        if reach == DenialReach::And && word == "and" {
            reach = DenialReach::Nothing;
        }
        match denial_at(tokens, at) {
            DenialReach::Nothing => {}
            DenialReach::Phrase if reach == DenialReach::Clause => {}
            begun => reach = begun,
        }
        reach != DenialReach::Nothing
    };
    (0..tokens.len()).map(is_denied).collect()
}

/// How far the denial reaches that begins at a token, if one does.
fn denial_at(tokens: TokenSlice<'_>, at: usize) -> DenialReach {
    let (word, next) = (tokens.word_at(at), tokens.word_at(at + 1));
    let is_not = matches!(word, "not" | "cannot" | "dont" | "cant") || word.ends_with("n't") || word.ends_with("n’t");
    match word {
        _ if is_not && affirms_anyway(tokens, at) => DenialReach::Nothing,
        _ if is_not => DenialReach::Clause,
        "without" => DenialReach::And,
        "never" | "neither" | "nor" | "avoid" | "avoiding" => DenialReach::Clause,
        "ignore" | "ignoring" | "disregard" => DenialReach::Clause,
        "instead" | "rather" if matches!(next, "of" | "than") => DenialReach::And,
        // "There is no need to turn".
        "no" if next == "need" => DenialReach::Clause,
        // "No more than two doors", "no longer", "no later than the sofa": a limit.
        "no" if matches!(
            next,
            "more"
                | "less"
                | "longer"
                | "further"
                | "farther"
                | "later"
                | "sooner"
                | "matter"
                | "other"
                | "problem"
                | "doubt"
                | "fewer"
                | "trouble"
        ) =>
        {
            DenialReach::Nothing
        }
        "no" if tokens.is_word(at + 1) => DenialReach::Phrase,
        _ => DenialReach::Nothing,
    }
}

/// "You can't miss the sofa", "not far from the sofa", "not only", "don't forget to turn left": a "not" that affirms.
fn affirms_anyway(tokens: TokenSlice<'_>, at: usize) -> bool {
    // "Until you can't go any further turn left": an impossible action is no command.
    let is_can = matches!(tokens.word_at(at), "cannot" | "cant" | "can't" | "can’t") || tokens.word_before(at) == "can";
    if is_can && v::GOING.contains(&tokens.word_at(at + 1)) {
        return true;
    }
    let next = at + 1 + usize::from(matches!(tokens.word_at(at + 1), "to" | "quite" | "too" | "very" | "so" | "that"));
    matches!(
        tokens.word_at(next),
        "miss"
            | "far"
            | "only"
            | "just"
            | "merely"
            | "simply"
            | "solely"
            | "forget"
            | "fail"
            | "hesitate"
            | "help"
            | "more"
            | "less"
            | "fewer"
            | "unlike"
            | "until"
            | "till"
            | "long"
            | "much"
    )
}

/// Marks conditions of having gone wrong: in "if you reach the stairs, you have gone too far", the stairs are not part of
/// the walk.
fn deny_wrong_ways(tokens: TokenSlice<'_>, clauses: &[usize], denied: &mut [bool]) {
    let mut from = 0;
    while from < tokens.len() {
        let ends = |at: &usize| tokens.get(*at).is_some_and(crate::text::TextToken::ends_sentence);
        let end = (from..tokens.len()).find(ends).unwrap_or(tokens.len());
        let is_far = |at: &usize| {
            let gone = matches!(tokens.word_before(*at), "gone" | "went" | "walked" | "come" | "go");
            tokens.word_at(*at) == "too" && tokens.word_at(at + 1) == "far" && gone
        };
        let begins = |at: &usize| matches!(tokens.word_at(*at), "if" | "when" | "once");
        if let Some(far) = (from..end).find(is_far) {
            // "If you see the bed you have gone too far", or "you have gone too far if you see the bed".
            let before = (from..far).rev().find(begins).map(|start| start..far);
            let behind = || (far..end).find(begins).map(|start| start..end_of_clause(clauses, start, end));
            if let Some(range) = before.or_else(behind) {
                denied[range].fill(true);
            }
        }
        from = end + 1;
    }
}

/// The token behind the clause of `start`, at most `end`.
fn end_of_clause(clauses: &[usize], start: usize, end: usize) -> usize {
    start + clauses[start..end].iter().take_while(|clause| **clause == clauses[start]).count()
}

#[cfg(test)]
mod tests {
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    /// The places that a text claims, and those that it denies.
    fn told(text: &str) -> (Vec<String>, Vec<String>) {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let places = events.filter_map(|event| match event.what {
            EventContent::Place(place) => Some((event.denied, place.name)),
            _ => None,
        });
        let (denied, claimed): (Vec<_>, Vec<_>) = places.partition(|(denied, _)| *denied);
        let names = |places: Vec<(bool, String)>| places.into_iter().map(|(_, name)| name).collect();
        (names(claimed), names(denied))
    }

    #[test]
    fn absent_things_and_forbidden_actions_are_denied() {
        for (text, claimed, denied) in [
            ("There is no piano.", &[][..], &["piano"][..]),
            ("There is no piano in the kitchen.", &["kitchen"], &["piano"]),
            ("Enter the room with no windows or doors on the left.", &[], &["window", "door"]),
            ("If you reach the stairs you have gone too far.", &[], &["stair"]),
            ("Stop at the sofa. If you see the bed, you've gone too far.", &["sofa"], &["bed"]),
            ("If you see the bed, you went too far.", &[], &["bed"]),
            ("You went too far if you see the bed.", &[], &["bed"]),
            ("If you pass the bed you went too far, go back to the sofa.", &["sofa"], &["bed"]),
            ("Ignore the sofa and go to the bed.", &["bed"], &["sofa"]),
            ("Go to the bed without passing the sofa.", &["bed"], &["sofa"]),
            ("Don't go to the sofa.", &[], &["sofa"]),
            ("Take not the first door but the second door.", &["door"], &["door"]),
            ("Take the second door, not the first door.", &["door"], &["door"]),
            ("There is no need to pass the sofa.", &[], &["sofa"]),
            ("Go to the bed instead of the sofa.", &["bed"], &["sofa"]),
            ("Go on without passing the sofa and into the kitchen.", &["kitchen"], &["sofa"]),
        ] {
            let found = told(text);
            let found: [Vec<&str>; 2] = [&found.0, &found.1].map(|names| names.iter().map(String::as_str).collect());
            assert_eq!(found, [claimed.to_vec(), denied.to_vec()], "{text}");
        }
    }

    #[test]
    fn a_walk_too_far_is_understood_in_any_tense() {
        for text in ["If you see the bed, you went too far.", "You have gone too far if you see the bed."] {
            assert!(read_instruction(text, &BTreeSet::new()).clauses.iter().all(|clause| clause.understood), "{text}");
        }
    }

    #[test]
    fn denial_ignores_a_not_that_affirms() {
        for text in [
            "You can't miss the sofa.",
            "You cannot miss the sofa.",
            "It is not far from the sofa.",
            "It is not too far from the sofa.",
            "Walk no more than two metres past the sofa.",
            "Pass not only the sofa but the bed.",
            "Don't forget to pass the sofa.",
            "Go no further than the sofa.",
            "Walk until you can't go any further past the sofa.",
            "Go to the sofa, it is not too far.",
            "Walk far, if you see the sofa stop.",
        ] {
            assert_eq!(told(text).1, Vec::<String>::new(), "{text}");
        }
    }
}
