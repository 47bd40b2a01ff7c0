//! Places of a plan where a thing may be named.

use super::{Clause, STOPPED_AT, WALKED_PAST};
use crate::{
    style::way::Kind,
    writer::landmarks::{Search, Spot, Use},
};
use wayword_checks::Memory;

/// A place for a thing. Its existence depends on the way alone, and never on the things that are seen there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::writer) struct Offer {
    /// The role of the thing.
    pub(in crate::writer) role: Role,
    /// The frame for which things are searched.
    pub(super) frame: usize,
    /// Which things are acceptable.
    pub(super) things: Things,
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
pub(in crate::writer) enum Role {
    /// The walker turns there.
    Turn,
    /// The walker passes it and enters a room.
    PassEnter,
    /// It is in a room that the walker enters.
    EnterWith,
    /// The walker goes past it or to it.
    Onward,
    /// The walker stops there; the clause is of this kind.
    Stop(Kind),
}

/// Which things are acceptable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Things {
    /// Landmarks.
    Fair,
    /// Poor landmarks, too.
    Faint,
    /// Any visible thing, to the side or ahead.
    Any,
}

impl Offer {
    /// A place for a thing at a frame, with a role.
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

    /// The spot with the searches for its thing.
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

/// Hops within a room, between the first frame and the last, that have no place for a thing yet.
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

/// Inserts a clause for a thing after the other clauses of its frame: a landmark at a turn comes before it.
pub(super) fn insert(plan: &mut Vec<Clause>, hop: usize, offer: Offer) {
    let at = plan.iter().position(|other| other.at > hop).unwrap_or(plan.len());
    plan.insert(at, Clause::for_a_thing(hop, offer));
}

/// Adds replacements next to each place for a thing on the way; they are used only if that place gets no thing.
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
