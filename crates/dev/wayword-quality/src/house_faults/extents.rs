//! The fault of extent: to the end of a hallway that the walk leaves before, and a distance that is longer than the
//! walk.

use super::{
    claims::RoomRole, locate::LocatedPiece, planned_walk::PlannedWalk, subject::FaultSubject,
    word_lists::STRAIGHT_PIECES,
};
use wayword_core::DVec3;
use wayword_house::{RectCm, model::RoomKind};

/// A hallway goes on by more than this behind the place where the walk leaves it, metres.
const BEYOND_M: f64 = 3.0;
/// A walk goes along a hallway if it makes at least this distance along it, metres.
const ALONG_M: f64 = 1.0;
/// The distance that a text gives is the walk's length times this.
const LENGTH_FACTOR: f64 = 3.0;
/// The words before a hallway that a walker follows.
const DOWN: &str = " down the ";

/// The text with an extent that is too long, for each piece that can have one.
pub(super) fn lengthen_pieces(subject: &FaultSubject<'_>) -> Vec<String> {
    let lengthen = |(at, piece): (usize, &LocatedPiece)| {
        let words = subject.text.pieces.get(at)?;
        let longer = extend_hallway(&subject.walk, piece, words).or_else(|| add_metres(&subject.walk, words))?;
        Some(subject.text.with_piece(at, longer)?.render())
    };
    subject.pieces.iter().enumerate().filter_map(lengthen).collect()
}

/// "Walk to the end of the hallway" for "walk down the hallway", where the walk leaves the hallway well before its end.
fn extend_hallway(walk: &PlannedWalk<'_>, piece: &LocatedPiece, words: &str) -> Option<String> {
    let claims = &piece.claims;
    let [room] = claims.rooms.as_slice() else { return None };
    let is_plain = room.kind == RoomKind::Hallway && room.role == RoomRole::Inside && room.span[1] == words.len();
    if !is_plain || !claims.turns.is_empty() || !claims.landmarks.is_empty() || claims.is_stop {
        return None;
    }
    let (head, noun) = words.split_once(DOWN)?;
    let stretches = walk.list_stretches(RoomKind::Hallway);
    let mut meant = stretches.iter().filter(|[first, last]| piece.spots.range(*first..=*last).next().is_some());
    let [first, last] = *meant.next()?;
    // The piece may be about either of two hallways.
    if meant.next().is_some() {
        return None;
    }
    let (enters, leaves) = (walk.spots.get(first)?, walk.spots.get(last)?);
    let area = walk.plan.room_area(leaves.room?)?;
    (beyond_m(&area, enters.feet, leaves.feet)? > BEYOND_M).then(|| format!("{head} to the end of the {noun}"))
}

/// How far a room goes on, along its longer side, behind the place where a walk leaves it, metres; `None` where the
/// walk does not go along that side.
fn beyond_m(area: &RectCm, enters: DVec3, leaves: DVec3) -> Option<f64> {
    let (from, to, low, high) = if area.width() >= area.depth() {
        (enters.x, leaves.x, area.x0, area.x1)
    } else {
        (enters.y, leaves.y, area.y0, area.y1)
    };
    let end_m = f64::from(if to > from { high } else { low }) / 100.0;
    ((to - from).abs() >= ALONG_M).then_some((end_m - to).abs())
}

/// "Walk straight for 45 meters" for "walk straight".
fn add_metres(walk: &PlannedWalk<'_>, words: &str) -> Option<String> {
    let metres = (LENGTH_FACTOR * walk.length_m()).ceil();
    STRAIGHT_PIECES.contains(&words).then(|| format!("{words} for {metres} meters"))
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
    fn lengthen_pieces_adds_three_times_the_length_to_a_straight_piece() {
        let plan = HousePlan::new(hallway_house());
        let edited = lengthen_pieces(&hallway_subject(&plan, "Walk straight. Turn left. Stop."));
        assert_eq!(edited, ["Walk straight for 39 meters. Turn left. Stop."]);
    }

    #[test]
    fn lengthen_pieces_needs_a_hallway_that_goes_on() {
        let plan = HousePlan::new(hallway_house());
        let text = "Walk down the hallway. Turn left. Stop.";
        let edited = lengthen_pieces(&hallway_subject(&plan, text));
        assert_eq!(edited, ["Walk to the end of the hallway. Turn left. Stop."]);
        let whole = frames_along(&[[0.5, 0.8], [11.5, 0.8], [11.5, 1.5]]);
        let subject = FaultSubject::new(&plan, &whole, text).unwrap();
        assert!(lengthen_pieces(&subject).is_empty(), "half a metre remains");
        assert!(lengthen_pieces(&hallway_subject(&plan, "Go down the hallway until you reach it. Stop.")).is_empty());
    }

    #[test]
    fn beyond_m_looks_in_the_direction_of_the_walk() {
        let hallway = RectCm::new(0, 0, 1200, 200);
        let at = |x: f64| DVec3::new(x, 1.0, 0.0);
        assert_eq!(beyond_m(&hallway, at(2.0), at(8.0)), Some(4.0));
        assert_eq!(beyond_m(&hallway, at(8.0), at(2.0)), Some(2.0));
        assert_eq!(beyond_m(&hallway, at(2.0), at(2.5)), None);
    }
}
