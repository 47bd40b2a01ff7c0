//! Finds the distances that a text asks to walk ("500 meters", "a few steps"), as ranges in metres.

use super::{EventContent, TextEvent, numbers::cardinal_number, tokens::TokenSlice, vocabulary as v};

/// A foot, metres.
const FOOT_M: f64 = 0.3048;
/// Length of a person's step, metres: a short one and a long one.
const STEP_M: [f64; 2] = [0.4, 0.9];
/// Farther than any text asks to walk, metres. A greater distance is a mistake and is not read.
const MAX_DISTANCE_M: f64 = 100_000.0;

/// The distances that a text asks to walk. A distance that only locates something ("two feet from the sofa") is none,
/// and neither are the steps of stairs.
pub(super) fn read_distances(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let mut events = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let distance = distance_at(tokens, at);
        if let Some(walked) = distance.as_ref().filter(|distance| is_walked(tokens, at, distance)) {
            let [metres_low, metres_high] = walked.metres;
            let what = EventContent::Distance { metres_low, metres_high };
            let span = tokens.span_of(at, walked.end - 1);
            events.push(TextEvent { what, span, clause: clauses[at], denied: false });
        }
        at = distance.map_or(at + 1, |distance| distance.end);
    }
    events
}

/// A number with a unit.
struct DistanceWords {
    /// The least and the greatest distance that the words can mean.
    metres: [f64; 2],
    /// Whether the unit is a step.
    in_steps: bool,
    /// The token behind it.
    end: usize,
}

/// The distance that begins at a token: "500 meters", "10ft", "a few steps", "two or three paces".
fn distance_at(tokens: TokenSlice<'_>, at: usize) -> Option<DistanceWords> {
    let word = |at: usize| tokens.word_at(at);
    if let Some((number, unit)) = joined_number(word(at)) {
        return Some(DistanceWords { metres: in_metres([number; 2], unit)?, in_steps: false, end: at + 1 });
    }
    let (numbers, behind) = number_range(tokens, at)?;
    let behind = behind + usize::from(matches!(word(behind), "more" | "big" | "small" | "short" | "of" | "full"));
    let behind = behind + usize::from(word(behind - 1) == "of" && word(behind) == "a");
    let in_steps = matches!(word(behind), "step" | "steps" | "pace" | "paces" | "stride" | "strides");
    let unit = if in_steps { STEP_M } else { [unit_m(word(behind))?; 2] };
    Some(DistanceWords { metres: in_metres(numbers, unit)?, in_steps, end: behind + 1 })
}

/// Numbers of a unit in metres; `None` where they are no distance. `unit` is the least and the greatest length of one.
fn in_metres(numbers: [f64; 2], unit: [f64; 2]) -> Option<[f64; 2]> {
    let metres = [numbers[0] * unit[0], numbers[1] * unit[1]];
    (0.0 < metres[0] && metres[0] <= metres[1] && metres[1] <= MAX_DISTANCE_M).then_some(metres)
}

/// The number and the unit of one word: "10ft", "3.5m".
fn joined_number(word: &str) -> Option<(f64, [f64; 2])> {
    let unit = word.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let number = word[..word.len() - unit.len()].parse().ok()?;
    Some((number, [unit_m(unit)?; 2]))
}

/// The least and the greatest number that words can mean, and the token behind them.
fn number_range(tokens: TokenSlice<'_>, at: usize) -> Option<([f64; 2], usize)> {
    let word = |at: usize| tokens.word_at(at);
    let exact = |number: f64, end| Some(([number; 2], end));
    match (word(at), word(at + 1)) {
        ("a" | "another", "few") => Some(([2.0, 5.0], at + 2)),
        ("a" | "another", "couple") => Some(([2.0, 3.0], at + 2)),
        ("half", "a" | "an") => exact(0.5, at + 2),
        ("few", _) => Some(([2.0, 5.0], at + 1)),
        ("couple", _) => Some(([2.0, 3.0], at + 1)),
        ("several" | "some", _) => Some(([3.0, 8.0], at + 1)),
        ("half", _) => exact(0.5, at + 1),
        _ => {
            let (low, end) = number_at(tokens, at)?;
            // "Two or three", "5-10".
            let joint = usize::from(matches!(word(end), "or" | "to"));
            let high =
                number_at(tokens, end + joint).filter(|(high, _)| *high > low && !matches!(word(at), "a" | "an"));
            match high {
                Some((high, end)) => Some(([low, high], end)),
                None => exact(low, end),
            }
        }
    }
}

/// "Five", "two hundred", "three hundred and fifty": a number, and the token behind it.
fn number_at(tokens: TokenSlice<'_>, at: usize) -> Option<(f64, usize)> {
    let few = number_word(tokens.word_at(at))?;
    let (many, end) = match tokens.word_at(at + 1) {
        "hundred" => (few * 100.0, at + 2),
        "thousand" => (few * 1000.0, at + 2),
        _ => return Some((few, at + 1)),
    };
    let rest = end + usize::from(tokens.word_at(end) == "and");
    let more = number_word(tokens.word_at(rest)).filter(|more| *more < 100.0);
    Some(more.map_or((many, end), |more| (many + more, rest + 1)))
}

/// The number that one word means.
fn number_word(word: &str) -> Option<f64> {
    let many = match word {
        "a" | "an" | "one" => 1.0,
        "eleven" => 11.0,
        "fifteen" => 15.0,
        "twenty" => 20.0,
        "thirty" => 30.0,
        "forty" => 40.0,
        "fifty" => 50.0,
        "sixty" => 60.0,
        "seventy" => 70.0,
        "eighty" => 80.0,
        "ninety" => 90.0,
        "hundred" => 100.0,
        _ => {
            let parsed = word.starts_with(|c: char| c.is_ascii_digit()).then(|| word.parse::<f64>().ok()).flatten();
            parsed.or(cardinal_number(word).filter(|_| word != "both").map(f64::from))?
        }
    };
    many.is_finite().then_some(many)
}

/// Whether the words from a token on are a unit behind a number: "100 yards". They name no place.
pub(super) fn is_unit(tokens: TokenSlice<'_>, at: usize) -> bool {
    let is_number = |word: &str| !matches!(word, "a" | "an") && number_word(word).is_some();
    at > 0 && is_number(tokens.word_at(at - 1)) && unit_m(tokens.word_at(at)).is_some()
}

/// A unit in metres.
fn unit_m(word: &str) -> Option<f64> {
    match word {
        "m" | "metre" | "metres" | "meter" | "meters" => Some(1.0),
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => Some(1000.0),
        "cm" | "centimetres" | "centimeters" => Some(0.01),
        "ft" | "foot" | "feet" => Some(FOOT_M),
        "yd" | "yds" | "yard" | "yards" => Some(3.0 * FOOT_M),
        "mile" | "miles" => Some(1609.344),
        "inch" | "inches" => Some(FOOT_M / 12.0),
        _ => None,
    }
}

/// Whether the walker walks that far, and the distance does not locate or measure a thing.
fn is_walked(tokens: TokenSlice<'_>, at: usize, distance: &DistanceWords) -> bool {
    // "Three feet from the sofa", "two metres to the left of it", "a ten foot ladder".
    let next = tokens.word_at(distance.end);
    let placed = matches!(
        next,
        "from"
            | "away"
            | "of"
            | "tall"
            | "long"
            | "wide"
            | "high"
            | "apart"
            | "off"
            | "behind"
            | "below"
            | "above"
            | "thick"
    ) || matches!((next, tokens.word_at(distance.end + 1)), ("in", "front"))
        || (next == "to"
            && (distance.end + 2..distance.end + 4).any(|at| matches!(tokens.word_at(at), "left" | "right" | "side")));
    // "Up three steps", "the two steps", "two steps up": stairs.
    let climbs = |word: &str| {
        matches!(word, "up" | "down" | "climb" | "climbing" | "ascend" | "descend" | "the" | "these" | "those" | "of")
    };
    let leads_up = matches!(next, "up" | "down" | "upwards" | "downwards" | "upward" | "downward" | "leading")
        || tokens.word_at(distance.end + 2) == "stairs";
    let stairs = distance.in_steps && ((at.saturating_sub(2)..at).any(|at| climbs(tokens.word_at(at))) || leads_up);
    let start = at.saturating_sub(6);
    let mut words = (start..at).rev().take_while(|at| tokens.is_word(*at)).map(|at| tokens.word_at(at));
    let verb = words.find(|word| v::WALKING.contains(word) || v::TURNING.contains(word) || word.ends_with("ing"));
    let goes = verb.is_some_and(|verb| {
        v::GOING.contains(&verb) || v::CLIMBING.contains(&verb) || matches!(verb, "take" | "taking" | "march" | "make")
    });
    let ahead = matches!(next, "forward" | "forwards" | "ahead" | "straight" | "onward");
    !placed && !stairs && (goes || ahead)
}

#[cfg(test)]
mod tests {
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    fn told(text: &str) -> Vec<[f64; 2]> {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let metres = events.filter_map(|event| match event.what {
            EventContent::Distance { metres_low, metres_high } => Some([metres_low, metres_high]),
            _ => None,
        });
        metres.map(|range| range.map(|metres| (metres * 100.0).round() / 100.0)).collect()
    }

    #[test]
    fn distances_to_walk_are_read_with_their_range() {
        for (text, metres) in [
            ("Walk 500 meters.", [500.0, 500.0]),
            ("Go forward three feet and stop.", [0.91, 0.91]),
            ("Walk 10 ft ahead.", [3.05, 3.05]),
            ("Walk 10ft.", [3.05, 3.05]),
            ("Take five steps forward.", [2.0, 4.5]),
            ("Walk forward five paces.", [2.0, 4.5]),
            ("Go a few steps into the kitchen.", [0.8, 4.5]),
            ("Walk two or three metres.", [2.0, 3.0]),
            ("Walk 5-10 metres, then stop.", [5.0, 10.0]),
            ("Walk a couple of yards.", [1.83, 2.74]),
            ("Move forward half a metre.", [0.5, 0.5]),
            ("Turn left and walk 2.5 metres.", [2.5, 2.5]),
            ("Two steps forward.", [0.8, 1.8]),
            ("Walk 500 meters to the bathroom.", [500.0, 500.0]),
            ("Walk two hundred meters.", [200.0, 200.0]),
            ("Walk one hundred and fifty meters to your bed.", [150.0, 150.0]),
            ("Walk two or three hundred meters.", [2.0, 300.0]),
            ("Walk 100 yards to the sofa.", [91.44, 91.44]),
            ("Go three miles to the sofa.", [4828.03, 4828.03]),
        ] {
            assert_eq!(told(text), [metres], "{text}");
        }
    }

    #[test]
    fn locations_and_steps_of_stairs_are_no_distances() {
        for text in [
            "Stop three feet from the sofa.",
            "Stop two metres in front of the sofa.",
            "Walk up three steps.",
            "Go down the two steps.",
            "Take two steps up.",
            "Walk up a few steps.",
            "Go down exactly two steps.",
            "Take three steps upwards.",
            "Take a few steps on the stairs.",
            "Pass the ten foot tall statue.",
            "Walk to the sofa 2 metres away.",
            "Wait 5 minutes.",
            "Walk 99999999999999999999999999 miles.",
            "Stop at the foot of the bed.",
            "Stop two metres to the left of the sofa.",
            "Go to the sofa two metres to your immediate right.",
            "Turn 90 degrees.",
        ] {
            assert_eq!(told(text), Vec::<[f64; 2]>::new(), "{text}");
        }
    }

    #[test]
    fn a_unit_behind_a_number_is_no_place() {
        let names = |text: &str| {
            let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
            let name = |what| if let EventContent::Place(place) = what { Some(place.name) } else { None };
            events.filter_map(|event| name(event.what)).collect::<Vec<_>>()
        };
        assert_eq!(names("Walk 100 yards to the sofa."), ["sofa"]);
        assert_eq!(names("Stop 20 yards from the sofa."), ["sofa"]);
        assert_eq!(names("It is three miles behind the sofa."), ["sofa"]);
        assert_eq!(names("Walk into the yard."), ["yard"]);
    }

    #[test]
    fn steps_that_are_walked_are_no_stairs() {
        let places = |text: &str| {
            let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
            events.filter(|event| matches!(event.what, EventContent::Place(_))).count()
        };
        assert_eq!(places("Take two steps forward."), 0);
        assert_eq!(places("Walk up the two steps."), 1);
    }
}
