//! The fault of something that is commanded twice and can be done once.

use super::{
    claims::RoomRole,
    locate::{LocatedPiece, SLIGHT_TURN_DEG, find_entries, find_exits},
    planned_walk::count_spots,
    subject::FaultSubject,
};
use std::ops::Range;

/// A second turn to the same side counts from this angle on, degrees.
const SECOND_TURN_DEG: f64 = 25.0;
/// A second turn to the same side may be meant up to this distance along the walk, metres.
const SECOND_TURN_M: f64 = 3.0;
/// A text that is repeated leads on from the end, so its walk is not in a circle: the ends are this far apart, metres.
const ENDS_APART_M: f64 = 3.0;

/// The text with one sentence repeated right after itself, for each sentence with something that happens once; and
/// the whole text twice.
pub(super) fn repeat_texts(subject: &FaultSubject<'_>) -> Vec<String> {
    let once = subject.text.sentences().into_iter().filter(|sentence| happens_once(subject, sentence));
    let mut edited: Vec<String> =
        once.filter_map(|sentence| Some(subject.text.with_sentence_twice(&sentence)?.render())).collect();
    let text = subject.text.render();
    let start = subject.walk.spots.first();
    let is_circle = start.is_none_or(|start| start.feet.distance(subject.walk.end()) < ENDS_APART_M);
    let moves = subject.pieces.iter().any(|piece| !piece.claims.is_stop);
    if text.ends_with(['.', '!']) && moves && !is_circle {
        edited.push(format!("{text} {text}"));
    }
    edited
}

/// Whether a sentence commands something that the walk does once, and no stop.
fn happens_once(subject: &FaultSubject<'_>, sentence: &Range<usize>) -> bool {
    let pieces = subject.pieces.get(sentence.clone()).unwrap_or_default();
    let has_stop = pieces.iter().any(|piece| piece.claims.is_stop);
    !has_stop && pieces.iter().any(|piece| turns_once(subject, piece) || changes_room_once(subject, piece))
}

/// Whether a piece commands a turn, and the walk makes no second one to that side nearby.
fn turns_once(subject: &FaultSubject<'_>, piece: &LocatedPiece) -> bool {
    let turns = subject.find_real_turns(piece, SLIGHT_TURN_DEG);
    let ([turn], [real]) = (piece.claims.turns.as_slice(), turns.as_slice()) else { return false };
    let margin = count_spots(SECOND_TURN_M);
    let around = real.first.saturating_sub(margin)..=real.last + margin;
    let mut others = subject.walk.list_turns_to(turn.side, SECOND_TURN_DEG).filter(|other| *other != real);
    !others.any(|other| other.first <= *around.end() && other.last >= *around.start())
}

/// Whether a piece enters or leaves a room, and the walk does so once with rooms of that kind.
fn changes_room_once(subject: &FaultSubject<'_>, piece: &LocatedPiece) -> bool {
    piece.claims.rooms.iter().any(|room| match room.role {
        RoomRole::Enter => find_entries(&subject.walk, room.kind).len() == 1,
        RoomRole::Leave => find_exits(&subject.walk, room.kind).len() == 1,
        RoomRole::Inside => false,
    })
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{frames_along, hallway_house, hallway_subject},
        },
        *,
    };

    #[test]
    fn repeat_texts_repeats_sentences_that_happen_once_and_the_whole_text() {
        let plan = HousePlan::new(hallway_house());
        let text = "Walk past the plant. Turn left. Enter the bedroom. Stop.";
        let expected = [
            "Walk past the plant. Turn left. Turn left. Enter the bedroom. Stop.".to_owned(),
            "Walk past the plant. Turn left. Enter the bedroom. Enter the bedroom. Stop.".to_owned(),
            format!("{text} {text}"),
        ];
        assert_eq!(repeat_texts(&hallway_subject(&plan, text)), expected);
    }

    #[test]
    fn repeat_texts_leaves_a_turn_that_the_walk_makes_twice() {
        let plan = HousePlan::new(hallway_house());
        let twice = frames_along(&[[4.5, 0.3], [8.5, 0.3], [8.5, 1.6], [7.2, 1.6]]);
        let subject = FaultSubject::new(&plan, &twice, "Turn left. Stop.").unwrap();
        let edited = repeat_texts(&subject);
        assert!(!edited.contains(&"Turn left. Turn left. Stop.".to_owned()), "{edited:?}");
    }

    #[test]
    fn repeat_texts_does_not_repeat_the_text_of_a_circle() {
        let plan = HousePlan::new(hallway_house());
        let circle = frames_along(&[[4.5, 0.3], [8.5, 0.3], [8.5, 1.6], [4.5, 1.6]]);
        let subject = FaultSubject::new(&plan, &circle, "Turn left. Stop.").unwrap();
        assert!(repeat_texts(&subject).is_empty());
    }
}
