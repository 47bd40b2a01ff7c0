//! Faults of turns: the other side, a place too early or too late, and a turn that is left out.

use super::{
    claims::RoomRole,
    locate::{LocatedPiece, find_anchors, find_entries},
    planned_walk::{PlanTurn, count_spots},
    subject::FaultSubject,
    word_lists::SideWord,
    words::list_words,
};

/// A turn of this angle is one for every reader, degrees.
const SHARP_TURN_DEG: f64 = 40.0;
/// A turn of this angle may be another turn that a text means, degrees.
const OTHER_TURN_DEG: f64 = 25.0;
/// A turn that a text may mean instead is at most this far away along the walk, metres.
const OTHER_TURN_M: f64 = 3.0;
/// A turn is before a room if it ends this far before the room begins, metres along the walk.
const BEFORE_ROOM_M: f64 = 0.5;
/// A turn is moved over something that is this far away along the walk, metres.
const MOVED_TURN_M: f64 = 2.5;
/// A turn of this angle cannot be left out, degrees.
const NEEDED_TURN_DEG: f64 = 50.0;
/// Where a turn is left out, a person can walk straight on for this distance, metres.
const STRAIGHT_ON_M: f64 = 1.5;

/// The directions in which a turn is moved in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TurnMove {
    /// Before the piece that comes before it.
    Earlier,
    /// Behind the piece that comes after it.
    Later,
}

/// The text with one turn to the other side, for each turn for which that is wrong.
pub(super) fn flip_turns(subject: &FaultSubject<'_>) -> Vec<String> {
    let flip = |(at, piece): (usize, &LocatedPiece)| {
        let [turn] = piece.claims.turns.as_slice() else { return None };
        let turns = subject.find_real_turns(piece, SHARP_TURN_DEG);
        let other = turn.side.opposite();
        if turns.is_empty() || !turns.iter().all(|real| is_alone(subject, real, other)) {
            return None;
        }
        subject.refuted(&subject.text.with_words(at, turn.span, other.word())?)
    };
    subject.pieces.iter().enumerate().filter_map(flip).collect()
}

/// Whether no turn to a side is near a turn.
fn is_alone(subject: &FaultSubject<'_>, real: &PlanTurn, side: SideWord) -> bool {
    let margin = count_spots(OTHER_TURN_M);
    !subject.walk.has_turn(side, OTHER_TURN_DEG, &(real.first.saturating_sub(margin)..=real.last + margin))
}

/// The text with a turn behind the room that is entered after it.
pub(super) fn put_turns_after_rooms(subject: &FaultSubject<'_>) -> Vec<String> {
    let exchange = |(at, turning, entering): (usize, &LocatedPiece, &LocatedPiece)| {
        let [turn] = turning.claims.turns.as_slice() else { return None };
        if !is_movable(turning) || !entering.claims.turns.is_empty() || entering.claims.is_stop {
            return None;
        }
        let turns = subject.find_real_turns(turning, SHARP_TURN_DEG);
        let entries = list_entries(subject, entering);
        let is_before = |entry: &usize| turns.iter().all(|real| real.last + count_spots(BEFORE_ROOM_M) <= *entry);
        let is_unturned = |entry: &usize| {
            let after = *entry..=entry + count_spots(OTHER_TURN_M);
            !subject.walk.has_turn(turn.side, OTHER_TURN_DEG, &after)
        };
        let is_wrong = entries.iter().all(|entry| is_before(entry) && is_unturned(entry));
        if turns.is_empty() || entries.is_empty() || !is_wrong {
            return None;
        }
        Some(subject.text.with_exchange(at, at + 1)?.render())
    };
    subject.neighbours().filter_map(exchange).collect()
}

/// The spots at which a piece may enter the rooms that it names, near the places of the piece.
fn list_entries(subject: &FaultSubject<'_>, piece: &LocatedPiece) -> Vec<usize> {
    let around = subject.stretch(piece);
    let entered = piece.claims.rooms.iter().filter(|room| room.role == RoomRole::Enter);
    let entries = entered.flat_map(|room| find_entries(&subject.walk, room.kind));
    entries.filter(|entry| around.contains(entry)).collect()
}

/// Whether a piece is a turn, and neither a stop nor about rooms, so that it can be anywhere in a text.
fn is_movable(piece: &LocatedPiece) -> bool {
    piece.claims.turns.len() == 1 && piece.claims.rooms.is_empty() && !piece.claims.is_stop
}

/// The text with a turn before something that is passed before it, or behind something that is passed after it.
pub(super) fn move_turns(subject: &FaultSubject<'_>, direction: TurnMove) -> Vec<String> {
    let exchange = |(at, first, second): (usize, &LocatedPiece, &LocatedPiece)| {
        let (turning, other) = match direction {
            TurnMove::Earlier => (second, first),
            TurnMove::Later => (first, second),
        };
        if !is_movable(turning) || other.claims.is_stop {
            return None;
        }
        let turns = subject.find_real_turns(turning, SHARP_TURN_DEG);
        let anchors = find_anchors(&subject.walk, other);
        let gap = count_spots(MOVED_TURN_M);
        let is_apart = |real: &PlanTurn| match direction {
            TurnMove::Earlier => anchors.last().is_some_and(|anchor| anchor + gap <= real.first),
            TurnMove::Later => anchors.first().is_some_and(|anchor| real.last + gap <= *anchor),
        };
        if turns.is_empty() || !turns.iter().all(is_apart) {
            return None;
        }
        subject.refuted(&subject.text.with_exchange(at, at + 1)?)
    };
    subject.neighbours().filter_map(exchange).collect()
}

/// The text without a turn, where a person would walk straight on.
pub(super) fn leave_out_turns(subject: &FaultSubject<'_>) -> Vec<String> {
    let leave_out = |(at, piece): (usize, &LocatedPiece)| {
        let turns = subject.find_real_turns(piece, NEEDED_TURN_DEG);
        let neighbours = [at.checked_sub(1), at.checked_add(1)].into_iter().flatten();
        let mut neighbours = neighbours.filter_map(|other| subject.pieces.get(other));
        let turns_again = neighbours.any(|other| !other.claims.turns.is_empty());
        let is_open = |real: &PlanTurn| {
            let spot = subject.walk.spots.get(real.first);
            spot.is_some_and(|spot| subject.walk.plan.can_walk(spot.feet, real.before.unit_vector(), STRAIGHT_ON_M))
        };
        if !is_movable(piece) || turns.is_empty() || turns_again || names_side(subject, at + 1) {
            return None;
        }
        if subject.text.pieces.len() < 3 || !turns.iter().all(is_open) {
            return None;
        }
        Some(subject.text.without(at)?.render())
    };
    subject.pieces.iter().enumerate().filter_map(leave_out).collect()
}

/// Whether a piece names a side: "enter the door on the left" gives the turn away.
fn names_side(subject: &FaultSubject<'_>, at: usize) -> bool {
    let words = subject.text.pieces.get(at).map(|piece| list_words(piece)).unwrap_or_default();
    words.iter().any(|word| SideWord::from_word(&word.low).is_some())
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

    /// What a function makes of a text about the walk through the hallway into the bedroom.
    fn edited(text: &str, edit: impl Fn(&FaultSubject<'_>) -> Vec<String>) -> Vec<String> {
        let plan = HousePlan::new(hallway_house());
        edit(&hallway_subject(&plan, text))
    }

    #[test]
    fn flip_turns_changes_the_side_of_a_turn_and_not_that_of_a_thing() {
        let flipped = edited("Walk past the plant on your left and turn left. Enter the bedroom. Stop.", flip_turns);
        assert_eq!(flipped, ["Walk past the plant on your left and turn right. Enter the bedroom. Stop."]);
        assert!(edited("Walk past the plant on your left. Stop.", flip_turns).is_empty());
    }

    #[test]
    fn flip_turns_leaves_a_turn_next_to_one_to_the_other_side() {
        let plan = HousePlan::new(hallway_house());
        let bent = frames_along(&[[0.5, 0.5], [4.5, 0.5], [4.5, 1.3], [8.5, 1.3]]);
        let subject = FaultSubject::new(&plan, &bent, "Turn left. Go on. Stop.").unwrap();
        assert!(flip_turns(&subject).is_empty());
    }

    #[test]
    fn put_turns_after_rooms_exchanges_a_turn_and_the_room_behind_it() {
        let text = "Walk past the plant. Turn left and enter the bedroom. Stop.";
        let after = edited(text, put_turns_after_rooms);
        assert_eq!(after, ["Walk past the plant. Enter the bedroom and turn left. Stop."]);
        assert!(edited("Turn left into the bedroom and walk past the bed. Stop.", put_turns_after_rooms).is_empty());
    }

    #[test]
    fn move_turns_needs_something_far_enough_away() {
        let earlier = |text: &str| edited(text, |subject| move_turns(subject, TurnMove::Earlier));
        assert_eq!(earlier("Walk past the plant. Turn left. Stop."), ["Turn left. Walk past the plant. Stop."]);
        assert!(earlier("Walk straight. Turn left. Stop.").is_empty(), "nothing is passed");
        let later = |text: &str| edited(text, |subject| move_turns(subject, TurnMove::Later));
        assert_eq!(
            later("Turn left. Walk past the bed. Stop by the dresser."),
            ["Walk past the bed. Turn left. Stop by the dresser."]
        );
        assert!(later("Turn left. Enter the bedroom. Stop.").is_empty(), "the door is 1.2 m behind the turn");
    }

    #[test]
    fn leave_out_turns_needs_a_way_straight_on() {
        let text = "Walk past the plant. Turn left. Enter the bedroom. Stop.";
        assert_eq!(edited(text, leave_out_turns), ["Walk past the plant. Enter the bedroom. Stop."]);
        let beside = "Walk past the plant. Turn left. Enter the bedroom on the left. Stop.";
        assert!(edited(beside, leave_out_turns).is_empty(), "the next piece gives the turn away");
        let plan = HousePlan::new(hallway_house());
        let to_the_wall = frames_along(&[[5.0, 0.5], [11.5, 0.5], [11.5, 1.5]]);
        let subject = FaultSubject::new(&plan, &to_the_wall, "Go straight. Turn left. Go straight. Stop.").unwrap();
        assert!(leave_out_turns(&subject).is_empty(), "a wall is ahead");
    }
}
