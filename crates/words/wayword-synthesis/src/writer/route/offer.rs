//! Offers: places of a plan where a thing may be named, if there is one.

use super::{MIN_PASSED_SALIENCE, MIN_STOP_SALIENCE, WayClause};
use crate::{
    style::way::ClauseKind,
    writer::landmarks::{LandmarkSearch, LandmarkSpot, LandmarkUse},
};
use wayword_checks::WalkMemory;

/// A place for a thing. Its existence depends on the way alone, and never on the things that are seen there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::writer) struct ThingOffer {
    /// The role of the thing.
    pub(in crate::writer) role: OfferRole,
    /// The frame for which things are searched.
    pub(super) frame: usize,
    /// Which things are acceptable.
    pub(super) things: OfferThings,
    /// Whether the side on which the walker passes the thing is named.
    pub(in crate::writer) tells_side: bool,
    /// Whether a second thing near it is named too.
    pub(in crate::writer) pair: bool,
    /// Whether the text falls back to "go straight" if there is no thing.
    pub(super) or_straight: bool,
    /// The hop of another offer that it replaces: it is used only if that one gets no thing.
    pub(super) stands_in_for: Option<usize>,
}

/// The role of a thing in a clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::writer) enum OfferRole {
    /// The walker turns there.
    Turn,
    /// The walker passes it and enters a room.
    PassEnter,
    /// It is in a room that the walker enters.
    EnterWith,
    /// The walker goes past it or to it.
    Onward,
    /// The walker stops there; the clause is of this kind.
    Stop(ClauseKind),
}

/// Which things are acceptable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OfferThings {
    /// Landmarks.
    Fair,
    /// Poor landmarks, too.
    Faint,
    /// Poor landmarks, and those of the hop before.
    Any,
}

impl ThingOffer {
    /// A place for a thing at a frame, with a role.
    pub(super) fn new(role: OfferRole, frame: usize) -> Self {
        Self {
            role,
            frame,
            things: OfferThings::Fair,
            tells_side: false,
            pair: false,
            or_straight: false,
            stands_in_for: None,
        }
    }

    pub(super) fn with_things(self, things: OfferThings) -> Self {
        Self { things, ..self }
    }

    /// The spot with the searches for its thing; `since` is the frame behind what the plan tells before it.
    pub(super) fn landmark_spot(&self, since: usize) -> LandmarkSpot {
        let at = |frame, salience, to| LandmarkSearch { frame, since, salience, purpose: to };
        let frame = self.frame;
        let mut searches = match self.role {
            OfferRole::Turn => vec![at(frame, MIN_PASSED_SALIENCE, LandmarkUse::Turn)],
            OfferRole::EnterWith => vec![at(frame, MIN_PASSED_SALIENCE, LandmarkUse::Here)],
            OfferRole::PassEnter | OfferRole::Onward => vec![at(frame, MIN_PASSED_SALIENCE, LandmarkUse::Onward)],
            OfferRole::Stop(_) => {
                let purposes = [LandmarkUse::Stop, LandmarkUse::StopAtAny];
                let at_end = |purpose| [MIN_PASSED_SALIENCE, MIN_STOP_SALIENCE].map(|least| at(frame, least, purpose));
                purposes.into_iter().flat_map(at_end).collect()
            }
        };
        if self.role == OfferRole::Onward && self.things != OfferThings::Fair {
            searches.push(at(frame, MIN_STOP_SALIENCE, LandmarkUse::Onward));
        }
        if self.role == OfferRole::Onward && self.things == OfferThings::Any {
            searches.push(at(frame.saturating_sub(1), MIN_PASSED_SALIENCE, LandmarkUse::Onward));
        }
        LandmarkSpot { searches, pair: self.pair, is_spare: self.stands_in_for.is_some() }
    }
}

/// Hops within a room, between the first frame and the last, that have no place for a thing yet.
pub(super) fn free_hops(plan: &[WayClause], memory: &WalkMemory) -> Vec<usize> {
    let last = memory.frame_count().saturating_sub(2);
    let is_free = |hop: &usize| {
        let on_stairs = memory.flights.iter().any(|flight| (flight.from..flight.to).contains(hop));
        let changes_room = memory.openings.iter().any(|opening| opening.before == *hop);
        let is_offered = plan.iter().any(|clause| clause.at == *hop && clause.is_offer());
        !on_stairs && !changes_room && !is_offered
    };
    (0..last).filter(is_free).collect()
}

/// Inserts a clause for a thing after the other clauses of its frame: a landmark at a turn comes before it.
pub(super) fn insert_offer(plan: &mut Vec<WayClause>, hop: usize, offer: ThingOffer) {
    let at = plan.iter().position(|other| other.at > hop).unwrap_or(plan.len());
    plan.insert(at, WayClause::for_a_thing(hop, offer));
}

/// Adds replacements next to each place for a thing on the way; they are used only if that place gets no thing.
pub(in crate::writer) fn with_stand_ins(mut plan: Vec<WayClause>, memory: &WalkMemory) -> Vec<WayClause> {
    let offered: Vec<(usize, ThingOffer)> = plan
        .iter()
        .filter(|clause| clause.is_offer())
        .filter_map(|clause| Some((clause.at, clause.offer.clone()?)))
        .collect();
    let free = free_hops(&plan, memory);
    for hop in free {
        let beside = offered.iter().find(|(other, _)| other.abs_diff(hop) == 1);
        if let Some((other, offer)) = beside {
            let own = ThingOffer { stands_in_for: Some(*other), or_straight: false, frame: hop + 1, ..offer.clone() };
            insert_offer(&mut plan, hop, own);
        }
    }
    plan
}
