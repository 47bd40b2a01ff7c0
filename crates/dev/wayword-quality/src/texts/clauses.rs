//! Splits a text into clauses, and recognises bare turns: clauses such as "turn left" that name no place.

/// Verbs of a turn.
const TURN_VERBS: [&str; 9] = ["turn", "take", "make", "hang", "veer", "bear", "go", "head", "keep"];
/// Words between the verb and the side.
const WORDS_BEFORE_SIDE: [&str; 12] =
    ["back", "a", "an", "another", "again", "slight", "slightly", "sharp", "hard", "to", "the", "your"];
/// The sides of a turn.
const TURN_SIDES: [&str; 3] = ["left", "right", "around"];
/// Words that may come before the verb.
const WORDS_BEFORE_VERB: [&str; 3] = ["then", "and", "next"];

/// The clauses of a text in lower case: between marks, "and" and "then".
pub(super) fn split_clauses(text: &str) -> Vec<String> {
    let lower = text.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let parts = lower.split(['.', ',', ';', '!', '?']).map(|part| format!("{part} "));
    let split = |part: String| part.replace(" and then ", "\n").replace(" then ", "\n").replace(" and ", "\n");
    let clauses = parts.map(split).collect::<Vec<_>>().join("\n");
    clauses.lines().map(str::trim).filter(|clause| !clause.is_empty()).map(str::to_owned).collect()
}

/// Whether a clause is only a turn: "hang a left", "make a slight right turn".
pub(super) fn is_bare_turn(clause: &str) -> bool {
    let mut words: &[&str] = &clause.split(' ').collect::<Vec<_>>();
    while words.first().is_some_and(|first| WORDS_BEFORE_VERB.contains(first)) {
        words = &words[1..];
    }
    let Some((verb, mut words)) = words.split_first() else { return false };
    if !TURN_VERBS.contains(verb) {
        return false;
    }
    while words.first().is_some_and(|word| WORDS_BEFORE_SIDE.contains(word)) {
        words = &words[1..];
    }
    let Some((side, rest)) = words.split_first() else { return false };
    TURN_SIDES.contains(side) && matches!(rest, [] | ["turn"] | ["again"] | ["turn", "again"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clauses_end_at_marks_and_before_and_and_then() {
        assert_eq!(
            split_clauses("Turn left and go on, then\nstop. And then wait"),
            ["turn left", "go on", "stop", "wait"]
        );
    }

    #[test]
    fn a_turn_with_a_place_is_not_bare() {
        for bare in ["hang a left", "make a slight right turn", "then turn left", "go back to the right again"] {
            assert!(is_bare_turn(bare), "{bare}");
        }
        for told in ["turn left at the sofa", "turn into the left room", "take the stairs", "walk left", "turn"] {
            assert!(!is_bare_turn(told), "{told}");
        }
    }
}
