//! Moves the marks of the places at which a text stops to where the walk stops.

use crate::landmarks::ShownFrames;
use wayword_language::reading::{EventContent, TextReading};

/// For each place in the clause with the last stop of a text ("stop in front of the refrigerator"), takes the last frame that shows it:
/// the walk ends there, and not where the place was first seen. `shown` and `frames` have an entry for each event of the reading.
/// A text that goes on after its last stop is left as it is.
pub(super) fn move_stop_marks(reading: &TextReading, shown: &[ShownFrames], frames: &mut [Option<usize>]) {
    let events = &reading.events;
    let Some(stop) = events.iter().rposition(|event| event.what == EventContent::Stop) else { return };
    let clause = events[stop].clause;
    let goes_on = |what: &EventContent| {
        matches!(what, EventContent::Turn(_) | EventContent::Onward | EventContent::Climb(_) | EventContent::Steps(_))
    };
    if events[stop..].iter().any(|event| event.clause > clause && goes_on(&event.what)) {
        return;
    }
    for ((event, shown), frame) in events.iter().zip(shown).zip(frames) {
        if event.clause == clause && matches!(event.what, EventContent::Place(_)) {
            *frame = frame.map(|first| shown.frames.last().map_or(first, |last| first.max(*last)));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        CheckSubject, check_text,
        tests::{frame, style, walk},
    };

    /// The words that a text marks, with their frames, along a walk on which a sink is seen from frame 1 on, and a sofa at frame 1.
    fn marks(text: &str) -> Vec<(&str, usize)> {
        let kitchen = |things: &[&str]| frame("kitchen", Some(things), 1);
        let frames = vec![
            frame("hallway", Some(&["rug"]), 1),
            frame("hallway", Some(&["sofa", "sink"]), 1),
            kitchen(&["sink"]),
            kitchen(&["sink", "oven"]),
            kitchen(&["sink", "oven"]),
        ];
        let evidence = walk(frames, &[(0.0, 0.0); 4]);
        let checked = check_text(text, CheckSubject::closed_world(&evidence, &style(false), None));
        checked.mentions.iter().map(|mention| (&text[mention.span[0]..mention.span[1]], mention.frame)).collect()
    }

    #[test]
    fn the_place_of_a_stop_is_marked_where_the_walk_stops() {
        for (text, expected) in [
            ("Stop in front of the sink.", vec![("sink", 4)]),
            (
                "Walk past the sofa into the kitchen and stop by the sink.",
                vec![("sofa", 1), ("kitchen", 2), ("sink", 4)],
            ),
            ("Walk past the sofa. Wait in the kitchen next to the oven.", vec![("sofa", 1), ("kitchen", 4)]),
            // A place that is passed is marked where it comes into view, and a stop on the way is not the end.
            ("Walk towards the sink.", vec![("sink", 1)]),
            ("Stop at the sofa. Then go on to the oven.", vec![("sofa", 1), ("oven", 3)]),
            ("Stop at the sink. Then go straight to the oven.", vec![("sink", 1), ("oven", 3)]),
        ] {
            let found: Vec<_> = marks(text)
                .into_iter()
                .filter(|(words, _)| !words.contains("straight") && !words.contains("on"))
                .collect();
            let found: Vec<_> =
                found.into_iter().map(|(words, at)| (words.rsplit(' ').next().unwrap_or_default(), at)).collect();
            assert_eq!(found, expected, "{text}");
        }
    }
}
