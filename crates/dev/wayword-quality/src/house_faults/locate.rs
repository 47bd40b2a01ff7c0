//! Finds where on a walk the pieces of a text may be true, in the order of the text. This is how the generator
//! knows that an edited text is wrong: then there is no such place for some piece.

use super::{
    claims::{LandmarkClaim, LandmarkRole, PieceClaims, RoomClaim, RoomRole, read_claims},
    planned_walk::{PlannedWalk, SIGHT_M, count_spots},
    word_lists::SideWord,
};
use std::collections::BTreeSet;
use wayword_house::model::RoomKind;

/// A claim is true at most this far along the walk from the place that it is about, metres.
pub(super) const REACH_M: f64 = 1.0;
/// A text may call a bend from this angle on a turn, degrees.
pub(super) const SLIGHT_TURN_DEG: f64 = 12.0;
/// A thing at the place of a turn or of the stop is at most this far away, metres.
const NEAR_M: f64 = 4.0;
/// A walker may go towards a thing from this far along the walk before the place where it is passed, metres.
const APPROACH_M: f64 = SIGHT_M;

/// A piece of a text with the spots of the walk at which it may be true.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LocatedPiece {
    /// What it claims.
    pub(super) claims: PieceClaims,
    /// The spots, at least one. At each of them the other pieces have places too, in the order of the text.
    pub(super) spots: BTreeSet<usize>,
}

/// The places of all pieces; `None` where they have none in this order, so that the text is wrong about the walk.
pub(super) fn locate_pieces(walk: &PlannedWalk<'_>, pieces: &[String]) -> Option<Vec<LocatedPiece>> {
    let mut located: Vec<LocatedPiece> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let claims = read_claims(piece);
        located.push(LocatedPiece { spots: find_fitting_spots(walk, &claims), claims });
    }
    let mut earliest = 0;
    for piece in &mut located {
        piece.spots.retain(|spot| *spot >= earliest);
        earliest = *piece.spots.first()?;
    }
    let mut latest = walk.last_spot();
    for piece in located.iter_mut().rev() {
        piece.spots.retain(|spot| *spot <= latest);
        latest = *piece.spots.last()?;
    }
    Some(located)
}

/// The spots at which the walker passes the things, and enters or leaves the rooms, that a piece names.
pub(super) fn find_anchors(walk: &PlannedWalk<'_>, piece: &LocatedPiece) -> BTreeSet<usize> {
    let around = walk.widen(&piece.spots, REACH_M);
    let things = piece.claims.landmarks.iter().flat_map(|landmark| walk.find_passing_spots(landmark.word));
    let rooms = piece.claims.rooms.iter().filter(|room| room.role != RoomRole::Inside);
    let rooms = rooms.flat_map(|room| find_room_spots(walk, room));
    things.chain(rooms).filter(|spot| around.contains(spot)).collect()
}

/// The spots at which the walk enters rooms of a kind, the room of the start left out.
pub(super) fn find_entries(walk: &PlannedWalk<'_>, kind: RoomKind) -> Vec<usize> {
    walk.list_stretches(kind).into_iter().map(|[first, _]| first).filter(|first| *first > 0).collect()
}

/// The last spots in rooms of a kind, the room of the end left out.
pub(super) fn find_exits(walk: &PlannedWalk<'_>, kind: RoomKind) -> Vec<usize> {
    walk.list_stretches(kind).into_iter().map(|[_, last]| last).filter(|last| *last < walk.last_spot()).collect()
}

/// The spots at which everything that a piece claims may be true.
fn find_fitting_spots(walk: &PlannedWalk<'_>, claims: &PieceClaims) -> BTreeSet<usize> {
    let mut fitting: BTreeSet<usize> = (0..=walk.last_spot()).collect();
    for places in list_claim_places(walk, claims) {
        let reach = walk.widen(&places, REACH_M);
        fitting.retain(|spot| reach.contains(spot));
    }
    fitting
}

/// The places that each claim of a piece is about. A thing or a room that the generator cannot find is left out,
/// because it would refute every text; a turn that the walk does not make is not.
fn list_claim_places(walk: &PlannedWalk<'_>, claims: &PieceClaims) -> Vec<BTreeSet<usize>> {
    let turns = claims.turns.iter().map(|turn| find_turn_spots(walk, turn.side));
    let stop = claims.is_stop.then(|| BTreeSet::from([walk.last_spot()]));
    let things = claims.landmarks.iter().map(|landmark| find_landmark_spots(walk, landmark));
    let rooms = claims.rooms.iter().map(|room| find_room_spots(walk, room));
    let stairs = claims.has_stairs.then(|| find_spots_inside(walk, RoomKind::Staircase));
    let known = things.chain(rooms).chain(stairs).filter(|places| !places.is_empty());
    turns.chain(stop).chain(known).collect()
}

/// The spots of turns to a side.
fn find_turn_spots(walk: &PlannedWalk<'_>, side: SideWord) -> BTreeSet<usize> {
    walk.list_turns_to(side, SLIGHT_TURN_DEG).flat_map(|turn| turn.first..=turn.last).collect()
}

/// The spots that a piece with a thing may be about.
fn find_landmark_spots(walk: &PlannedWalk<'_>, landmark: &LandmarkClaim) -> BTreeSet<usize> {
    match landmark.role {
        LandmarkRole::Pass => walk.find_passing_spots(landmark.word),
        LandmarkRole::Near => walk.find_spots_near(landmark.word, NEAR_M),
        LandmarkRole::Toward => {
            let approach = count_spots(APPROACH_M);
            let passing = walk.find_passing_spots(landmark.word).into_iter();
            passing.flat_map(|spot| spot.saturating_sub(approach)..=spot).collect()
        }
    }
}

/// The spots that a piece with a room may be about.
fn find_room_spots(walk: &PlannedWalk<'_>, room: &RoomClaim) -> BTreeSet<usize> {
    match room.role {
        RoomRole::Enter => find_entries(walk, room.kind).into_iter().collect(),
        RoomRole::Leave => find_exits(walk, room.kind).into_iter().collect(),
        RoomRole::Inside => find_spots_inside(walk, room.kind),
    }
}

/// The spots in rooms of a kind.
fn find_spots_inside(walk: &PlannedWalk<'_>, kind: RoomKind) -> BTreeSet<usize> {
    walk.list_stretches(kind).into_iter().flat_map(|[first, last]| first..=last).collect()
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{hallway_house, hallway_walk},
        },
        *,
    };

    /// The places of pieces on the walk through the hallway into the bedroom.
    fn located(pieces: &[&str]) -> Option<Vec<LocatedPiece>> {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        locate_pieces(&walk, &pieces.iter().map(|piece| (*piece).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn locate_pieces_finds_the_place_of_each_piece() {
        let pieces = ["walk past the bookshelf", "turn left", "enter the bedroom", "wait by the bed"];
        let located = located(&pieces).unwrap();
        for (piece, range) in located.iter().zip([1..=11, 28..=36, 33..=41, 47..=51]) {
            assert!(piece.spots.iter().all(|spot| range.contains(spot)), "{:?} {range:?}", piece.spots);
        }
    }

    #[test]
    fn locate_pieces_refuses_turns_and_orders_that_the_walk_does_not_have() {
        assert!(located(&["walk past the bookshelf", "walk past the plant", "turn left"]).is_some());
        for pieces in [
            &["turn right"][..],
            &["turn left", "walk past the plant"],
            &["walk past the plant", "walk past the bookshelf"],
            &["enter the bedroom", "walk past the plant"],
            &["wait by the bed", "walk past the plant"],
        ] {
            assert_eq!(located(pieces), None, "{pieces:?}");
        }
    }

    #[test]
    fn locate_pieces_takes_things_that_it_cannot_find_for_unknown() {
        assert!(located(&["walk past the piano", "turn left", "enter the office"]).is_some());
    }

    #[test]
    fn find_anchors_are_those_near_the_place_of_the_piece() {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        let pieces = ["leave the hallway", "enter the bedroom"].map(str::to_owned);
        let located = locate_pieces(&walk, &pieces).unwrap();
        let anchors: Vec<BTreeSet<usize>> = located.iter().map(|piece| find_anchors(&walk, piece)).collect();
        assert_eq!(anchors, [BTreeSet::from([36]), BTreeSet::from([37])]);
    }
}
