//! Places of a text at which a thing may be told.

use super::{Clause, STOPPED_AT, WALKED_PAST};
use crate::{
    style::way::Kind,
    writer::landmarks::{Search, Spot, Use},
};
use wayword_checks::Memory;

/// Where a thing may be told. Whether there is such a place goes by the way alone, and never by what is seen there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::writer) struct Offer {
    /// What the thing is told for.
    pub(in crate::writer) role: Role,
    /// The frame at which things are looked for.
    pub(super) frame: usize,
    /// Which things will do.
    pub(super) things: Things,
    /// Whether the side is told on which one passes the thing.
    pub(in crate::writer) tells_side: bool,
    /// Whether a second thing beside it is told, too.
    pub(in crate::writer) pair: bool,
    /// Whether the text says that one goes straight on where there is no thing.
    pub(super) or_straight: bool,
    /// The hop of the offer for which it stands in: it tells a thing only where that one has none.
    pub(super) stands_in_for: Option<usize>,
}

/// What a thing is told for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::writer) enum Role {
    /// One turns there.
    Turn,
    /// One passes it and enters a room.
    PassEnter,
    /// It stands in a room that one enters.
    EnterWith,
    /// One goes past it or to it.
    Onward,
    /// One stops there, in words of this kind.
    Stop(Kind),
}

/// Which things will do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Things {
    /// Landmarks.
    Fair,
    /// Things that are hardly landmarks, too.
    Faint,
    /// Whatever shows, beside the walker or ahead.
    Any,
}

impl Offer {
    /// Where a thing at a frame is told for some purpose.
    pub(super) fn new(role: Role, frame: usize) -> Self {
        Self {
            role,
            frame,
            things: Things::Fair,
            tells_side: false,
            pair: false,
            or_straight: false,
            stands_in_for: None,
        }
    }

    pub(super) fn taking(self, things: Things) -> Self {
        Self { things, ..self }
    }

    /// Where its things are looked for.
    pub(super) fn spot(&self) -> Spot {
        let at = |frame, salience, to| Search { frame, salience, to };
        let frame = self.frame;
        let mut searches = match self.role {
            Role::Turn | Role::EnterWith => vec![at(frame, WALKED_PAST, Use::Here)],
            Role::PassEnter | Role::Onward => vec![at(frame, WALKED_PAST, Use::Onward)],
            Role::Stop(_) => vec![at(frame, WALKED_PAST, Use::Stop), at(frame, STOPPED_AT, Use::Stop)],
        };
        if self.role == Role::Onward && self.things != Things::Fair {
            searches.push(at(frame, STOPPED_AT, Use::Onward));
        }
        if self.role == Role::Onward && self.things == Things::Any {
            let before = frame.saturating_sub(1);
            searches.extend([at(before, WALKED_PAST, Use::Onward), at(frame, STOPPED_AT, Use::Beside)]);
        }
        Spot { searches, pair: self.pair, is_spare: self.stands_in_for.is_some() }
    }
}

/// Hops within a room, between the first frame and the last, at which no thing may be told yet.
pub(super) fn free_hops(plan: &[Clause], memory: &Memory) -> Vec<usize> {
    let last = memory.frames().saturating_sub(2);
    let is_free = |hop: &usize| {
        let on_stairs = memory.flights.iter().any(|flight| (flight.from..flight.to).contains(hop));
        let changes_room = memory.openings.iter().any(|opening| opening.before == *hop);
        let is_offered = plan.iter().any(|clause| clause.at == *hop && clause.is_offer());
        !on_stairs && !changes_room && !is_offered
    };
    (0..last).filter(is_free).collect()
}

/// Puts a clause for a thing on a hop behind the others of its frame: what one turns by there comes before it.
pub(super) fn insert(plan: &mut Vec<Clause>, hop: usize, offer: Offer) {
    let at = plan.iter().position(|other| other.at > hop).unwrap_or(plan.len());
    plan.insert(at, Clause::for_a_thing(hop, offer));
}

/// Beside each place for a thing on the way others that stand in where it has none.
pub(in crate::writer) fn with_stand_ins(mut plan: Vec<Clause>, memory: &Memory) -> Vec<Clause> {
    let offered: Vec<(usize, Offer)> = plan
        .iter()
        .filter(|clause| clause.is_offer())
        .filter_map(|clause| Some((clause.at, clause.offer.clone()?)))
        .collect();
    let free = free_hops(&plan, memory);
    for hop in free {
        let beside = offered.iter().find(|(other, _)| other.abs_diff(hop) == 1);
        if let Some((other, offer)) = beside {
            let own = Offer { stands_in_for: Some(*other), or_straight: false, frame: hop + 1, ..offer.clone() };
            insert(&mut plan, hop, own);
        }
    }
    plan
}
