//! Plans hops that go straight on: past things, and along hallways.

use super::{
    FILLER_WEIGHT, LONG_HOP_M, MAIN_WEIGHT, OfferRole, SIDE_WEIGHT, STRETCH_M, ThingOffer, WayClause, WayPlanner,
    usable_room,
};
use crate::style::way::{ClauseKind, WayWording};
use rand::Rng;
use wayword_checks::memory::WalkBend;
use wayword_core::{Side, motion};
use wayword_language::lexicon::room_name;

/// A style with "go along the hallway" in at least this share of the clauses that go straight on has it wherever it fits.
const ALONG_SHARE: f64 = 0.3;

impl WayPlanner<'_> {
    /// Adds "go along the hallway".
    pub(super) fn go_along(&mut self, at: usize, room: &str, weight: u8) {
        self.push(WayClause::new(ClauseKind::Along, at, weight).with_room(room));
        self.along = true;
    }

    /// Whether the text has "go along the hallway" where "go straight" means the same. Some styles hardly ever name a hallway.
    pub(super) fn says_along(&mut self) -> bool {
        let (along, straight) = (self.kind_count(ClauseKind::Along), self.kind_count(ClauseKind::Straight));
        let share = along / (along + straight).max(f64::EPSILON);
        share >= ALONG_SHARE || self.rng.random_bool(share / ALONG_SHARE)
    }

    /// Whether the walk goes far along the room of a frame before it turns.
    fn goes_far_along(&self, at: usize) -> bool {
        let is_turn = |bend: &&WalkBend| bend.first >= at && bend.turn_rad.to_degrees().abs() >= motion::TOLD_DEG;
        let turn = self.memory.bends.iter().find(is_turn).map_or(usize::MAX, |bend| bend.first);
        let left = self.memory.stay_at(at).map_or(at, |stay| stay.left);
        let knows_way = self.brief.walk.path.motion.is_known();
        self.goes_along(at) && (!knows_way || self.memory.walked_m(at - 1, left.min(turn)) >= STRETCH_M)
    }

    /// Whether the walk goes far enough along the room of a frame, from there on, that "go along the hallway" helps.
    pub(super) fn goes_along(&self, at: usize) -> bool {
        let knows_way = self.brief.walk.path.motion.is_known();
        self.memory.stay_at(at).is_some_and(|stay| !knows_way || self.memory.goes_along(stay, at))
    }

    /// A hop within a room: past a thing, along the hallway, or at least straight on.
    pub(super) fn go_onwards(&mut self, at: usize) {
        if at > 0 && self.stretch_number(at) > 0 && self.stretch_number(at) == self.stretch_number(at - 1) {
            return;
        }
        let is_last = at + 2 >= self.memory.frame_count();
        let offer_share = if is_last { 0.3 } else { 0.5 };
        let offers = self.rng.random_bool(offer_share) || self.is_first_hop_of_untold_turn(at);
        let room = self.memory.room_at(at + 1).and_then(usable_room);
        let hall = room.filter(|room| room_name(room) == Some("hallway"));
        if let Some(hall) = hall.filter(|_| !self.along && self.rng.random_bool(0.5) && self.goes_far_along(at + 1)) {
            if !self.says_along() {
                return self.push(WayClause::new(ClauseKind::Straight, at, SIDE_WEIGHT));
            }
            let left = self.memory.stay_at(at + 1).map_or(at, |stay| stay.left);
            let weight = if self.brief.walk.walked_m(at, left) >= LONG_HOP_M { MAIN_WEIGHT } else { SIDE_WEIGHT };
            return self.go_along(at, &hall, weight);
        }
        let left = self.memory.stay_at(at).map_or(at + 1, |stay| stay.left);
        let is_long = self.brief.walk.moves.is_empty() || self.brief.walk.walked_m(at, left) >= LONG_HOP_M;
        let goes_straight = is_long && !self.along && self.rng.random_bool(0.25);
        if offers {
            let offer = ThingOffer { or_straight: goes_straight, ..ThingOffer::new(OfferRole::Onward, at + 1) };
            self.push(WayClause::for_a_thing(at, offer));
        } else if goes_straight {
            self.push(WayClause::new(ClauseKind::Straight, at, FILLER_WEIGHT));
        }
    }

    /// Whether the text leaves out the turn at the start, so that the first landmark has to show the direction.
    fn is_first_hop_of_untold_turn(&self, at: usize) -> bool {
        at == 0 && self.clauses.is_empty() && self.memory.bends.first().is_some_and(|bend| bend.first == 0)
    }
}

/// The kind of clause for a thing on the way: past a thing that is passed, otherwise to it. `share` from 0 to 1 selects
/// among the possible kinds.
pub(super) fn passing_kind(way: &WayWording, passed: Option<Side>, side: Option<Side>, share: f64) -> ClauseKind {
    let mut kinds = Vec::new();
    if passed.is_some() || side.is_none() {
        kinds.push((way.kind_count(ClauseKind::Pass) * 0.5, ClauseKind::Pass));
    }
    if passed.is_some() {
        kinds.push((way.kind_count(ClauseKind::PassOnSide) * 2.0, ClauseKind::PassOnSide));
    }
    if matches!(side, Some(Side::Ahead) | None) {
        kinds.push((way.kind_count(ClauseKind::To) * 1.5, ClauseKind::To));
    }
    let mut remaining = share * kinds.iter().map(|(weight, _)| weight).sum::<f64>();
    for (weight, kind) in &kinds {
        remaining -= weight;
        if remaining < 0.0 {
            return *kind;
        }
    }
    if passed.is_some() { ClauseKind::Pass } else { ClauseKind::To }
}
