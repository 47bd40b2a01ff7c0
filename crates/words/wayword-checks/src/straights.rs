//! Checks claims to go straight on where every move that may be meant makes a sharp turn, and the text tells none.

use super::{CheckWorld, new_finding};
use crate::evidence::Evidence;
use std::ops::Range;
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, Verdict};
use wayword_language::reading::{EventContent, TextEvent, TextReading};

/// A turn from which on nobody calls a move straight, degrees. Words are loose, so this is far above a slight turn.
const SHARP_DEG: f64 = 75.0;
/// A move with a smaller rise is no part of a flight, metres.
const FLIGHT_RISE_M: f64 = 0.1;
/// Words by which a text tells a turn without naming its side.
const BENDING_WORDS: [&str; 14] = [
    "around", "bear", "bend", "bends", "corner", "curve", "curved", "curves", "curving", "follow", "rotate", "spiral",
    "swing", "veer",
];

/// The first claim to go straight on that no move bears out. `frames` are those of the events, where they have one. In an open
/// world, only the word "straight" counts, and the first move of the path fits any, because people start where they look.
pub(super) fn find_false_straight(
    reading: &TextReading,
    evidence: &Evidence,
    frames: &[Option<usize>],
    world: CheckWorld,
) -> Option<CheckFinding> {
    let has_word = |words: &[&str], [from, to]: [usize; 2]| {
        let within = reading.tokens().iter().filter(|token| from <= token.span[0] && token.span[1] <= to);
        within.into_iter().any(|token| words.contains(&token.word.as_str()))
    };
    if has_word(&BENDING_WORDS, [0, usize::MAX]) {
        return None;
    }
    let straights = reading.events.iter().enumerate().filter(|(_, event)| event.what == EventContent::Onward);
    straights.filter(|(_, event)| world == CheckWorld::Closed || has_word(&["straight"], event.span)).find_map(
        |(at, event)| {
            let moves = moves_meant(&reading.events, evidence, frames, at)?;
            if moves.is_empty() || (world == CheckWorld::Open && moves.start == 0) {
                return None;
            }
            let turns_deg = evidence.moves.get(moves)?.iter().map(|step| step.turn_rad.to_degrees());
            let least_deg = turns_deg.min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            let side = if least_deg > 0.0 { "right" } else { "left" };
            (least_deg.abs() >= SHARP_DEG).then(|| {
            let reason = format!(
                "the path turns {side} by {:.0} degrees here, and the text tells no turn before it goes straight on",
                least_deg.abs()
            );
            new_finding(CheckKind::Turns, Verdict::Unverified, reason, Some(event.span))
        })
        },
    )
}

/// The moves that the event `at` may mean: those between the places, climbs and turns around it in the text. `None` where a turn
/// is told before it, or somewhere that is not known.
fn moves_meant(events: &[TextEvent], evidence: &Evidence, frames: &[Option<usize>], at: usize) -> Option<Range<usize>> {
    let is_turn = |at: usize| matches!(events[at].what, EventContent::Turn(_) | EventContent::Compass { .. });
    let anchor = |at: &usize| frames.get(*at).copied().flatten().is_some();
    let (before, after) = ((0..at).rev().find(anchor), (at + 1..events.len()).find(anchor));
    let tells_turn = (before.unwrap_or(0)..at).any(is_turn) || (at + 1..after.unwrap_or(events.len())).any(is_turn);
    if tells_turn {
        return None;
    }
    let frame = |at: usize| frames.get(at).copied().flatten();
    let start = match before.map(|before| (&events[before].what, frame(before))) {
        None => 0,
        Some((EventContent::Climb(climb), Some(first))) => end_of_flight(evidence, first, *climb),
        Some((_, first)) => first?,
    };
    let end = after.and_then(frame).unwrap_or(evidence.moves.len());
    let leads_to_stairs = after.is_some_and(|after| matches!(events[after].what, EventContent::Climb(_)));
    // Before stairs that begin here, the move onto them is meant.
    Some(start..if leads_to_stairs { end.max(start + 1) } else { end })
}

/// The first frame behind a flight of stairs.
fn end_of_flight(evidence: &Evidence, first: usize, climb: ClimbDirection) -> usize {
    let way = if climb == ClimbDirection::Down { -1.0 } else { 1.0 };
    let moves = evidence.moves.iter().skip(first);
    first + moves.take_while(|step| step.rise_m * way >= FLIGHT_RISE_M).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CheckSubject, TextFindings, WorldReach, check_text};
    use wayword_core::{InstructionStyle, PathMotion, PathMove};

    /// A path of moves with these turns, degrees, and rises, metres. Nothing is seen along it but a sofa at frame 2.
    fn path(moves: &[(f64, f64)]) -> Evidence {
        let moves = moves.iter().map(|(turn_deg, rise_m)| PathMove {
            turn_rad: turn_deg.to_radians(),
            distance_m: 2.0,
            rise_m: *rise_m,
        });
        let moves: Vec<PathMove> = moves.collect();
        let mut evidence = crate::tests::to_the_bedroom();
        let frame = crate::FrameEvidence { things: Vec::new(), level: None, ..evidence.frames[0].clone() };
        evidence.frames = vec![frame; moves.len() + 1];
        evidence.motion = PathMotion::Known;
        Evidence { moves, ..evidence }
    }

    fn turns(text: &str, evidence: &Evidence, world: CheckWorld) -> Vec<(Verdict, String)> {
        let style = InstructionStyle::default();
        let subject = match world {
            CheckWorld::Closed => CheckSubject::closed_world(evidence, &style, None),
            CheckWorld::Open => CheckSubject::open_world(evidence, &style, WorldReach::default()),
        };
        let TextFindings { findings, .. } = check_text(text, subject);
        let straights = findings.into_iter().filter(|finding| finding.reason.contains("straight on"));
        straights
            .map(|finding| (finding.verdict, text[finding.span.unwrap()[0]..finding.span.unwrap()[1]].to_owned()))
            .collect()
    }

    #[test]
    fn straight_over_sharp_turns_that_are_not_told_is_unverified() {
        let wrong = |words: &str| vec![(Verdict::Unverified, words.to_owned())];
        let bends = path(&[(122.0, 0.0), (93.0, 0.0), (-87.0, 0.0)]);
        assert_eq!(turns("Go straight. Stop.", &bends, CheckWorld::Closed), wrong("Go straight"));
        assert_eq!(turns("Walk forward and stop.", &bends, CheckWorld::Closed), wrong("Walk forward"));
        let told = crate::check_text(
            "Go straight. Stop.",
            CheckSubject::closed_world(&bends, &InstructionStyle::default(), None),
        );
        let told = told.findings.iter().find(|finding| finding.check == CheckKind::Turns).unwrap();
        assert!(told.reason.contains("the path turns left by 87 degrees here"), "{}", told.reason);
        for text in [
            "Turn right and go straight. Stop.",
            "Go straight, then turn right. Stop.",
            "Follow the hall and go straight. Stop.",
            "Go straight around the corner. Stop.",
            "Walk to the end. Stop.",
        ] {
            assert_eq!(turns(text, &bends, CheckWorld::Closed), [], "{text}");
        }
        // One move that goes straight is enough, and slight turns count as straight.
        for moves in [[(122.0, 0.0), (5.0, 0.0), (90.0, 0.0)], [(60.0, 0.0), (90.0, 0.0), (90.0, 0.0)]] {
            assert_eq!(turns("Go straight. Stop.", &path(&moves), CheckWorld::Closed), []);
        }
    }

    #[test]
    fn straight_before_and_behind_stairs_is_meant_of_the_moves_there() {
        let stairs = |before_deg: f64, after_deg: f64| path(&[(before_deg, -1.5), (90.0, -1.5), (after_deg, 0.0)]);
        let text = "Go straight. Go down the stairs. Go straight. Stop.";
        assert_eq!(turns(text, &stairs(0.0, 3.0), CheckWorld::Closed), []);
        assert_eq!(turns(text, &stairs(120.0, 3.0), CheckWorld::Closed).len(), 1);
        assert_eq!(turns(text, &stairs(0.0, -88.0), CheckWorld::Closed).len(), 1);
    }

    #[test]
    fn other_peoples_words_are_loose() {
        let bends = path(&[(122.0, 0.0), (93.0, 0.0), (-87.0, 0.0)]);
        assert_eq!(turns("Go straight. Stop.", &bends, CheckWorld::Open), []);
        let stairs = path(&[(0.0, -1.5), (3.0, -1.5), (-88.0, 0.0)]);
        assert_eq!(turns("Go down the stairs and walk forward.", &stairs, CheckWorld::Open), []);
        assert_eq!(turns("Go down the stairs and walk straight.", &stairs, CheckWorld::Open).len(), 1);
    }
}
