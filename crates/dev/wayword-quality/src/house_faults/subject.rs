//! A text with its walk: what a fault is planted into.

use super::{
    edit::FaultText,
    locate::{LocatedPiece, REACH_M, SLIGHT_TURN_DEG, locate_pieces},
    plan::HousePlan,
    planned_walk::{PlanTurn, PlannedWalk, count_spots},
    word_lists::LandmarkWord,
};
use wayword_core::{DVec3, Frame};

/// A turn above this angle may be taken for one to the other side, degrees.
const MAX_TURN_DEG: f64 = 150.0;

/// A text in pieces, its walk, and the places of the pieces.
#[derive(Debug)]
pub(super) struct FaultSubject<'p> {
    /// The walk.
    pub(super) walk: PlannedWalk<'p>,
    /// The text.
    pub(super) text: FaultText,
    /// The places of the pieces, in the order of the text.
    pub(super) pieces: Vec<LocatedPiece>,
}

impl<'p> FaultSubject<'p> {
    /// A text about a walk; `None` where the text cannot be cut, or its pieces have no places on the walk.
    pub(super) fn new(plan: &'p HousePlan, frames: &[Frame], text: &str) -> Option<Self> {
        let text = FaultText::from_text(text)?;
        let walk = PlannedWalk::new(plan, frames)?;
        let pieces = locate_pieces(&walk, &text.pieces)?;
        Some(Self { walk, text, pieces })
    }

    /// The edited text, if it is wrong about the walk.
    pub(super) fn refuted(&self, edited: &FaultText) -> Option<String> {
        locate_pieces(&self.walk, &edited.pieces).is_none().then(|| edited.render())
    }

    /// The turns of the walk that a piece with one turn may mean. Empty unless each of them has at least an angle,
    /// degrees, and none is nearly a turn around.
    pub(super) fn find_real_turns(&self, piece: &LocatedPiece, least_deg: f64) -> Vec<PlanTurn> {
        let [turn] = piece.claims.turns.as_slice() else { return Vec::new() };
        let reach = count_spots(REACH_M);
        let is_near =
            |real: &&PlanTurn| piece.spots.iter().any(|spot| spot + reach >= real.first && *spot <= real.last + reach);
        let turns = self.walk.list_turns_to(turn.side, SLIGHT_TURN_DEG).filter(is_near);
        let turns: Vec<PlanTurn> = turns.copied().collect();
        let are_sharp = turns.iter().all(|real| (least_deg..=MAX_TURN_DEG).contains(&real.angle_deg.abs()));
        if are_sharp { turns } else { Vec::new() }
    }

    /// Each piece with the next one, and the number of the first.
    pub(super) fn neighbours(&self) -> impl Iterator<Item = (usize, &LocatedPiece, &LocatedPiece)> {
        let pairs = self.pieces.iter().zip(self.pieces.iter().skip(1)).enumerate();
        pairs.map(|(at, (first, second))| (at, first, second))
    }

    /// The distance from a place of the floor to the nearest thing of the house that a word may mean, metres.
    pub(super) fn measure_nearest_m(&self, word: &LandmarkWord, place: DVec3) -> f64 {
        let things = self.walk.plan.things.iter().filter(|thing| word.can_mean(&thing.name));
        things.map(|thing| thing.distance_m(place)).fold(f64::INFINITY, f64::min)
    }

    /// The spots from a metre before the first place of a piece to a metre behind its last one.
    pub(super) fn stretch(&self, piece: &LocatedPiece) -> Vec<usize> {
        self.walk.widen(&piece.spots, REACH_M).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::test_plan::{hallway_house, hallway_subject, hallway_walk},
        *,
    };

    #[test]
    fn new_refuses_a_text_that_is_wrong_already() {
        let plan = HousePlan::new(hallway_house());
        assert!(FaultSubject::new(&plan, &hallway_walk(), "Turn right. Stop.").is_none());
        assert!(FaultSubject::new(&plan, &hallway_walk(), "Turn left. Stop.").is_some());
    }

    #[test]
    fn find_real_turns_are_those_of_the_side_with_the_angle() {
        let plan = HousePlan::new(hallway_house());
        let subject = hallway_subject(&plan, "Go straight. Turn left. Stop.");
        let angles = |at: usize, least_deg| -> Vec<f64> {
            let turns = subject.find_real_turns(&subject.pieces[at], least_deg);
            turns.iter().map(|turn| turn.angle_deg.round()).collect()
        };
        assert_eq!(angles(1, 40.0), [-90.0]);
        assert!(angles(1, 100.0).is_empty() && angles(0, 40.0).is_empty());
    }

    #[test]
    fn refuted_gives_only_texts_that_are_wrong() {
        let plan = HousePlan::new(hallway_house());
        let subject = hallway_subject(&plan, "Walk past the plant. Turn left. Stop.");
        let edited = subject.text.with_exchange(0, 1).unwrap();
        assert_eq!(subject.refuted(&edited).as_deref(), Some("Turn left. Walk past the plant. Stop."));
        assert_eq!(subject.refuted(&subject.text), None);
    }

    #[test]
    fn measure_nearest_m_counts_all_things_of_the_house() {
        let plan = HousePlan::new(hallway_house());
        let subject = hallway_subject(&plan, "Turn left. Stop.");
        let word = |name: &str| LandmarkWord::for_name(name).unwrap();
        assert!((subject.measure_nearest_m(word("bed"), subject.walk.end()) - 1.5).abs() < 1e-9);
        assert_eq!(subject.measure_nearest_m(word("piano"), subject.walk.end()), f64::INFINITY);
        assert_eq!(subject.neighbours().count(), 1);
    }
}
