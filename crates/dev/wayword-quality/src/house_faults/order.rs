//! The fault of order: two neighbouring pieces exchanged.

use super::{
    locate::{LocatedPiece, SLIGHT_TURN_DEG, find_anchors},
    planned_walk::count_spots,
    subject::FaultSubject,
    word_lists::SideWord,
};
use std::collections::BTreeSet;
use wayword_house::model::RoomKind;

/// Exchanged pieces are about places that are this far apart along the walk, metres.
const EXCHANGED_M: f64 = 2.0;

/// What a piece is about: the sides of its turns, its things and its rooms.
type PieceContent = (Vec<SideWord>, Vec<&'static str>, Vec<RoomKind>);

/// The text with two neighbouring pieces exchanged, for each pair that is wrong then.
pub(super) fn exchange_pieces(subject: &FaultSubject<'_>) -> Vec<String> {
    let exchange = |(at, first, second): (usize, &LocatedPiece, &LocatedPiece)| {
        // A turn that moves over something else is a fault of its own.
        if first.claims.is_stop || second.claims.is_stop || is_bare_turn(first) != is_bare_turn(second) {
            return None;
        }
        let (one, other) = (find_content_spots(subject, first), find_content_spots(subject, second));
        let gap = count_spots(EXCHANGED_M);
        let is_apart = one.last().zip(other.first()).is_some_and(|(before, after)| before + gap <= *after);
        if !is_apart || list_content(first) == list_content(second) {
            return None;
        }
        subject.refuted(&subject.text.with_exchange(at, at + 1)?)
    };
    subject.neighbours().filter_map(exchange).collect()
}

/// Whether a piece commands a turn and names nothing.
fn is_bare_turn(piece: &LocatedPiece) -> bool {
    !piece.claims.turns.is_empty() && piece.claims.landmarks.is_empty() && piece.claims.rooms.is_empty()
}

/// The spots of what a piece is about.
fn find_content_spots(subject: &FaultSubject<'_>, piece: &LocatedPiece) -> BTreeSet<usize> {
    if is_bare_turn(piece) {
        return subject
            .find_real_turns(piece, SLIGHT_TURN_DEG)
            .iter()
            .flat_map(|real| real.first..=real.last)
            .collect();
    }
    find_anchors(&subject.walk, piece)
}

fn list_content(piece: &LocatedPiece) -> PieceContent {
    let claims = &piece.claims;
    let turns = claims.turns.iter().map(|turn| turn.side).collect();
    let things = claims.landmarks.iter().map(|landmark| landmark.word.one).collect();
    (turns, things, claims.rooms.iter().map(|room| room.kind).collect())
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{hallway_house, hallway_subject},
        },
        *,
    };

    fn exchanged(text: &str) -> Vec<String> {
        let plan = HousePlan::new(hallway_house());
        exchange_pieces(&hallway_subject(&plan, text))
    }

    #[test]
    fn exchange_pieces_takes_pairs_of_places_that_are_apart() {
        assert_eq!(
            exchanged("Walk past the bookshelf, pass the plant. Turn left. Stop."),
            ["Pass the plant, walk past the bookshelf. Turn left. Stop."]
        );
        assert_eq!(exchanged("Pass the plant. Enter the bedroom. Stop."), ["Enter the bedroom. Pass the plant. Stop."]);
    }

    #[test]
    fn exchange_pieces_leaves_turns_stops_and_places_that_are_close() {
        for text in [
            "Walk past the plant. Turn left. Stop.",
            "Leave the hallway. Enter the bedroom. Stop.",
            "Enter the bedroom. Stop by the bed.",
        ] {
            assert!(exchanged(text).is_empty(), "{text}");
        }
    }
}
