//! Faults of things on the way: the other side, and a thing of another piece.

use super::{
    claims::{LandmarkClaim, LandmarkRole, SideMention},
    locate::{LocatedPiece, REACH_M},
    plan::PlanThing,
    planned_walk::{PlannedSpot, count_spots},
    subject::FaultSubject,
    word_lists::SideWord,
};
use std::f64::consts::FRAC_PI_2;

/// All things of the name within this distance of the place where one is passed lie on its side, metres.
const SIDE_REACH_M: f64 = 5.0;
/// A thing lies on a side if all of it is this far beside the walker, metres.
const BESIDE_M: f64 = 0.3;
/// The side is looked at from this far before the place where the thing is passed, metres along the walk.
const SIDE_BEFORE_M: f64 = 1.0;
/// The side is looked at up to this far behind the place where the thing is passed, metres along the walk.
const SIDE_AFTER_M: f64 = 0.25;
/// The piece that a thing is taken from is this far away along the walk, metres.
const OTHER_PIECE_M: f64 = 3.0;
/// No thing of the name that is put in lies within this distance of the piece's stretch, metres.
const ABSENT_M: f64 = 4.0;

/// The text with one thing on the other side, for each thing for which that is wrong.
pub(super) fn exchange_sides(subject: &FaultSubject<'_>) -> Vec<String> {
    let mut edited = Vec::new();
    for (at, piece) in subject.pieces.iter().enumerate() {
        for landmark in &piece.claims.landmarks {
            let is_right = |mention: &SideMention| is_on_side(subject, piece, landmark, mention.side);
            let Some(mention) = landmark.side.filter(is_right) else { continue };
            let text = subject.text.with_words(at, mention.span, mention.side.opposite().word());
            edited.extend(text.map(|text| text.render()));
        }
    }
    edited
}

/// Whether all things that a piece may mean lie on a side of the walk, wherever the piece is true.
fn is_on_side(subject: &FaultSubject<'_>, piece: &LocatedPiece, landmark: &LandmarkClaim, side: SideWord) -> bool {
    let walk = &subject.walk;
    let around = walk.widen(&piece.spots, REACH_M);
    let passing: Vec<usize> =
        walk.find_passing_spots(landmark.word).into_iter().filter(|spot| around.contains(spot)).collect();
    let is_right = |passed: &usize| {
        let from = passed.saturating_sub(count_spots(SIDE_BEFORE_M));
        let to = (passed + count_spots(SIDE_AFTER_M)).min(walk.last_spot());
        let Some((place, looks)) = walk.spots.get(*passed).zip(walk.spots.get(from..=to)) else { return false };
        let meant = walk.plan.things.iter().filter(|thing| landmark.word.can_mean(&thing.name));
        let mut near = meant.filter(|thing| thing.distance_m(place.feet) <= SIDE_REACH_M);
        near.all(|thing| looks.iter().all(|spot| lies_beside(thing, spot, side)))
    };
    !passing.is_empty() && passing.iter().all(is_right)
}

/// Whether all corners of a thing lie on a side of the walker.
fn lies_beside(thing: &PlanThing, spot: &PlannedSpot, side: SideWord) -> bool {
    let to_the_right = spot.heading.turned_by(FRAC_PI_2).unit_vector();
    thing.corners_m(spot.feet.z).into_iter().all(|corner| {
        let off_m = (corner - spot.feet).dot(to_the_right);
        side.has_sign(off_m) && off_m.abs() >= BESIDE_M
    })
}

/// The text with a thing of one piece in place of a thing of another piece, near which there is none.
pub(super) fn take_other_things(subject: &FaultSubject<'_>) -> Vec<String> {
    let mut edited = Vec::new();
    for (at, piece) in subject.pieces.iter().enumerate().filter(|(_, piece)| !piece.claims.is_stop) {
        for (other_at, other) in subject.pieces.iter().enumerate().filter(|(other, _)| *other != at) {
            if !are_apart(piece, other) {
                continue;
            }
            for (old, new) in pair_landmarks(&piece.claims.landmarks, &other.claims.landmarks) {
                if is_absent(subject, piece, old, new) {
                    edited.extend(replace_phrase(subject, (at, old), (other_at, new)));
                }
            }
        }
    }
    edited
}

/// Each thing of one piece with each of another.
fn pair_landmarks<'c>(
    ones: &'c [LandmarkClaim],
    others: &'c [LandmarkClaim],
) -> impl Iterator<Item = (&'c LandmarkClaim, &'c LandmarkClaim)> {
    ones.iter().flat_map(move |one| others.iter().map(move |other| (one, other)))
}

/// Whether two pieces are far apart, wherever they are true.
fn are_apart(one: &LocatedPiece, other: &LocatedPiece) -> bool {
    let gap = count_spots(OTHER_PIECE_M);
    let is_before = |a: &LocatedPiece, b: &LocatedPiece| {
        a.spots.last().zip(b.spots.first()).is_some_and(|(last, first)| last + gap <= *first)
    };
    is_before(one, other) || is_before(other, one)
}

/// Whether no thing that the word of `new` may mean is where a piece names `old`, so that it cannot replace it.
fn is_absent(subject: &FaultSubject<'_>, piece: &LocatedPiece, old: &LandmarkClaim, new: &LandmarkClaim) -> bool {
    let walk = &subject.walk;
    let is_named_too = piece.claims.landmarks.iter().any(|landmark| landmark.word.overlaps(new.word));
    let stretch = subject.stretch(piece);
    let mut spots = stretch.iter().filter_map(|spot| walk.spots.get(*spot));
    let is_near = spots.any(|spot| subject.measure_nearest_m(new.word, spot.feet) <= ABSENT_M);
    // What one only goes towards may be far away, but not out of sight.
    let is_in_sight = walk
        .list_things(new.word)
        .any(|sighted| stretch.iter().filter_map(|spot| sighted.sight_m.get(*spot)).any(|off_m| off_m.is_finite()));
    let is_far_aim = old.role == LandmarkRole::Toward && is_in_sight;
    old.has_article && new.has_article && !is_named_too && !is_near && !is_far_aim
}

/// The text with the phrase of `new` in place of that of `old`; each is given with the number of its piece.
fn replace_phrase(
    subject: &FaultSubject<'_>,
    (at, old): (usize, &LandmarkClaim),
    (other_at, new): (usize, &LandmarkClaim),
) -> Option<String> {
    let phrase = subject.text.pieces.get(other_at)?.get(new.phrase[0]..new.phrase[1])?;
    Some(subject.text.with_words(at, old.phrase, phrase)?.render())
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
    use wayword_house::{House, RectCm};

    fn sides(house: House, text: &str) -> Vec<String> {
        let plan = HousePlan::new(house);
        exchange_sides(&hallway_subject(&plan, text))
    }

    #[test]
    fn exchange_sides_needs_all_things_of_the_name_on_one_side() {
        let text = "Walk past the plant on your left. Turn left. Stop.";
        assert_eq!(sides(hallway_house(), text), ["Walk past the plant on your right. Turn left. Stop."]);
        let mut house = hallway_house();
        let mut other = house.furniture[1].clone();
        other.footprint = RectCm::new(520, 6, 570, 40);
        house.furniture.push(other);
        assert!(sides(house, text).is_empty(), "a second plant is on the right");
    }

    #[test]
    fn exchange_sides_leaves_a_side_that_is_wrong_already() {
        assert!(sides(hallway_house(), "Walk past the plant on your right. Turn left. Stop.").is_empty());
    }

    #[test]
    fn take_other_things_needs_a_thing_that_is_far_from_the_piece() {
        let plan = HousePlan::new(hallway_house());
        let take = |text: &str| take_other_things(&hallway_subject(&plan, text));
        let text = "Walk past the bookshelf. Turn left, pass the large bed. Stop.";
        let expected = [
            "Walk past the large bed. Turn left, pass the large bed. Stop.",
            "Walk past the bookshelf. Turn left, pass the bookshelf. Stop.",
        ];
        assert_eq!(take(text), expected);
        let near = "Walk past the bookshelf. Pass the plant. Stop.";
        assert!(take(near).is_empty(), "{:?}", take(near));
    }
}
