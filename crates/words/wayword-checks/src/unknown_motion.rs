//! Finds statements about the motion in texts of our own writers where the motion is unknown. The writer cannot know
//! them, so it invented them.

use super::new_finding;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    reading::{EventContent, TextEvent, TextReading},
    text::TextToken,
};

/// Words that count how far one walks.
const DISTANCE_COUNT_WORDS: &[&str] =
    &["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "twenty", "few", "several"];
/// Units of how far one walks.
const DISTANCE_UNIT_WORDS: &[&str] = &[
    "m", "metre", "metres", "meter", "meters", "ft", "foot", "feet", "yard", "yards", "pace", "paces", "step", "steps",
];

/// Failures for turns, sides, stairs, storeys and distances, even where the text denies them: "do not turn left" claims
/// to know of a turn. `reading` still has its denied events.
pub(super) fn find_made_up(text: &str, reading: &TextReading) -> Vec<CheckFinding> {
    let tokens = reading.tokens();
    let stated = reading.events.iter().filter_map(|event| Some((unknown_motion_fact(event)?, event.span)));
    let straight = tokens
        .iter()
        .filter(|token| token.word == "straight")
        .map(|token| ((CheckKind::Turns, "which way the path goes"), token.span));
    let distances = distance_spans(tokens).map(|span| ((CheckKind::Turns, "how far the path goes"), span));
    let all = stated.chain(straight).chain(distances);
    all.map(|((check, what), span)| {
        let words = text.get(span[0]..span[1]).unwrap_or_default();
        let reason = format!("{words:?}: it is not known {what}; describe the way by rooms and objects alone");
        new_finding(check, Verdict::Fail, reason, Some(span))
    })
    .collect()
}

/// The fact that an author needs to know for a statement, and the check that decides it where the motion is known.
fn unknown_motion_fact(event: &TextEvent) -> Option<(CheckKind, &'static str)> {
    match &event.what {
        EventContent::Turn(_) => Some((CheckKind::Turns, "how the path turns")),
        EventContent::Climb(_) | EventContent::Steps(_) => {
            Some((CheckKind::Floors, "whether the path goes up or down"))
        }
        EventContent::Storey(_) | EventContent::Floor(_) => Some((CheckKind::Floors, "on which storey the path is")),
        EventContent::Place(place) => place.side.map(|_| (CheckKind::Landmarks, "on which side of the walker that is")),
        EventContent::Onward
        | EventContent::Stop
        | EventContent::Face { .. }
        | EventContent::Compass { .. }
        | EventContent::Distance { .. } => None,
    }
}

/// "Three metres", "3m", "a few steps".
fn distance_spans(tokens: &[TextToken]) -> impl Iterator<Item = [usize; 2]> {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let is_number = move |word: &str| word.chars().all(is_digit) || DISTANCE_COUNT_WORDS.contains(&word);
    let pairs =
        tokens.windows(2).filter(move |pair| is_number(&pair[0].word) && DISTANCE_UNIT_WORDS.contains(&&*pair[1].word));
    let joined = tokens.iter().filter(move |token| {
        let unit = token.word.trim_start_matches(is_digit);
        unit.len() < token.word.len() && DISTANCE_UNIT_WORDS.contains(&unit)
    });
    pairs.map(|pair| [pair[0].span[0], pair[1].span[1]]).chain(joined.map(|token| token.span))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_language::reading::read_instruction;

    fn findings(text: &str) -> Vec<CheckFinding> {
        find_made_up(text, &read_instruction(text, &BTreeSet::new()))
    }

    fn made_up(text: &str) -> Vec<(CheckKind, &str)> {
        let found = findings(text);
        assert!(found.iter().all(|finding| finding.verdict == Verdict::Fail), "{found:?}");
        found.iter().map(|finding| (finding.check, finding.span.map_or("", |[from, to]| &text[from..to]))).collect()
    }

    #[test]
    fn find_made_up_lists_distances_with_a_number_and_a_unit() {
        for (text, words) in [
            ("Walk past the sofa for 3 metres", "3 metres"),
            ("Walk past the sofa for three yards", "three yards"),
            ("Walk past the sofa for several paces", "several paces"),
            ("Walk past the sofa for 1.5 m", "1.5 m"),
            ("Walk past the sofa for 1.5m", "1.5m"),
            ("Walk past the sofa for 10ft", "10ft"),
        ] {
            assert_eq!(made_up(text), [(CheckKind::Turns, words)], "{text}");
        }
        for text in
            ["Walk past 2 sofas", "Walk to the foot of the bed", "Walk past the sofa on foot", "Walk to room 3a"]
        {
            assert_eq!(made_up(text), [], "{text}");
        }
    }

    #[test]
    fn find_made_up_gives_the_fact_that_is_not_known() {
        let reason = |text: &str| findings(text).remove(0).reason;
        for (text, words, fact) in [
            ("Go straight to the sofa", "straight", "which way the path goes"),
            ("Go 3 metres to the sofa", "3 metres", "how far the path goes"),
            ("Go upstairs to the sofa", "upstairs", "whether the path goes up or down"),
            ("Go to the sofa on your left", "sofa", "on which side of the walker that is"),
        ] {
            let wanted = format!("{words:?}: it is not known {fact}; describe the way by rooms and objects alone");
            assert_eq!(reason(text), wanted, "{text}");
        }
        assert!(reason("Turn left").contains("how the path turns"));
        assert!(reason("Go to the sofa on the second floor").contains("on which storey the path is"));
    }

    #[test]
    fn find_made_up_keeps_places_without_a_side() {
        assert_eq!(made_up("Walk past the sofa into the bedroom and stop facing the bed."), []);
        assert_eq!(made_up("Pass the sofa on your left."), [(CheckKind::Landmarks, "sofa")]);
    }
}
