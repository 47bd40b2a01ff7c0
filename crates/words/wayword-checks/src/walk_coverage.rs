//! Finds how a text tells the decisions of its walk: turns where another way is open, flights of stairs, rooms that are entered.
//!
//! The parts of the text are aligned with the walk. A decision is told where the part of its stretch names it.

use crate::{WalkMemory, memory::WalkBend};
use serde::Serialize;
use wayword_core::{ClimbDirection, InstructionPart, Side, motion};
use wayword_language::{
    lexicon::same_room,
    reading::{EventContent, PlaceLink, TextReading},
};

/// A decision of a walk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum WalkDecision {
    /// A turn where another way is open, as far as that is known.
    Turn {
        /// The side to which the walk turns, [`Side::Behind`] for a turn around.
        side: Side,
    },
    /// A flight of stairs.
    Climb {
        /// Up or down.
        direction: ClimbDirection,
    },
    /// A room that the walk enters.
    Room {
        /// Its name.
        name: String,
    },
}

/// How a text tells a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DecisionTold {
    /// The part of its stretch names it.
    Told,
    /// A part before its stretch names it.
    Early,
    /// A part after its stretch names it.
    Late,
    /// The part of its stretch does not name it, but says where the way leads.
    Merged,
    /// No part near its stretch names it.
    LeftOut,
}

/// A decision of a walk, and how a text tells it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CoveredDecision {
    /// The decision.
    #[serde(flatten)]
    pub decision: WalkDecision,
    /// The frames between which it is made.
    pub frames: [usize; 2],
    /// How the text tells it.
    pub told: DecisionTold,
    /// The words that tell it, as a byte range of the text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span: Option<[usize; 2]>,
}

impl DecisionTold {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Told, Self::Early, Self::Late, Self::Merged, Self::LeftOut];

    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Told => "told",
            Self::Early => "early",
            Self::Late => "late",
            Self::Merged => "merged",
            Self::LeftOut => "left_out",
        }
    }
}

impl WalkDecision {
    /// The name of its kind in reports.
    #[must_use]
    pub fn kind_name(&self) -> &'static str {
        match self {
            Self::Turn { .. } => "turn",
            Self::Climb { .. } => "climb",
            Self::Room { .. } => "room",
        }
    }
}

/// How a text tells the decisions of its walk, in the order of the walk. `parts` are those of the text, aligned with the walk;
/// `is_open` says of a turn whether another way is open there.
#[must_use]
pub fn cover_walk(
    reading: &TextReading,
    parts: &[InstructionPart],
    memory: &WalkMemory,
    is_open: impl Fn(&WalkBend) -> bool,
) -> Vec<CoveredDecision> {
    let mut used = vec![false; reading.events.len()];
    let cover = |(decision, frames): (WalkDecision, [usize; 2])| {
        let (told, event) = find_words(reading, parts, &decision, frames, &used);
        event.into_iter().for_each(|event| used[event] = true);
        CoveredDecision { decision, frames, told, span: event.map(|event| reading.events[event].span) }
    };
    list_decisions(memory, is_open).into_iter().map(cover).collect()
}

/// The decisions of a walk with the frames between which they are made, in order.
fn list_decisions(memory: &WalkMemory, is_open: impl Fn(&WalkBend) -> bool) -> Vec<(WalkDecision, [usize; 2])> {
    // A staircase turns as it is built.
    let is_turn = |bend: &&WalkBend| {
        bend.turn_rad.to_degrees().abs() >= motion::TOLD_DEG && !memory.is_on_stairs(bend) && is_open(bend)
    };
    let turns = memory.bends.iter().filter(is_turn);
    let turns = turns.map(|bend| (WalkDecision::Turn { side: bend.side() }, [bend.first, bend.last + 1]));
    let climbs =
        memory.flights.iter().map(|flight| (WalkDecision::Climb { direction: flight.climb }, [flight.from, flight.to]));
    let rooms = memory.stays.iter().filter(|stay| stay.entered > 0);
    let rooms = rooms
        .map(|stay| (WalkDecision::Room { name: stay.room.clone() }, [stay.entered.saturating_sub(1), stay.entered]));
    let mut all: Vec<(WalkDecision, [usize; 2])> = turns.chain(climbs).chain(rooms).collect();
    all.sort_by_key(|(_, frames)| *frames);
    all
}

/// How the text tells a decision, and the event that does. Events that tell earlier decisions are used.
fn find_words(
    reading: &TextReading,
    parts: &[InstructionPart],
    decision: &WalkDecision,
    [first, last]: [usize; 2],
    used: &[bool],
) -> (DecisionTold, Option<usize>) {
    // The parts whose stretch touches the decision.
    let is_there = |part: &InstructionPart| part.frames[0] <= last && first <= part.frames[1];
    let there = || parts.iter().enumerate().filter(|(_, part)| is_there(part)).map(|(number, _)| number);
    let (Some(from), Some(to)) = (there().min(), there().max()) else { return (DecisionTold::LeftOut, None) };
    let find_in = |part: Option<usize>| {
        let span = parts.get(part?)?.span;
        let mut events =
            reading.events.iter().enumerate().filter(|(_, event)| span[0] <= event.span[0] && event.span[1] <= span[1]);
        events
            .find(|(number, event)| !used[*number] && !event.denied && names_decision(&event.what, decision))
            .map(|(number, _)| number)
    };
    if let Some(event) = (from..=to).find_map(|part| find_in(Some(part))) {
        return (DecisionTold::Told, Some(event));
    }
    if let Some(event) = find_in(from.checked_sub(1)) {
        return (DecisionTold::Early, Some(event));
    }
    if let Some(event) = find_in(Some(to + 1)) {
        return (DecisionTold::Late, Some(event));
    }
    let leads_somewhere = there().any(|number| {
        let span = parts[number].span;
        let mut events = reading.events.iter().filter(|event| span[0] <= event.span[0] && event.span[1] <= span[1]);
        events.any(|event| matches!(&event.what, EventContent::Place(place) if place.link == PlaceLink::Goal))
    });
    (if leads_somewhere { DecisionTold::Merged } else { DecisionTold::LeftOut }, None)
}

/// Whether an event of a text names a decision.
fn names_decision(event: &EventContent, decision: &WalkDecision) -> bool {
    match (event, decision) {
        (EventContent::Turn(told), WalkDecision::Turn { side }) => {
            let turns_around = |side: &Side| matches!(side, Side::Behind | Side::Ahead);
            told == side || turns_around(told) && turns_around(side)
        }
        // "The door on your right" sends the walker to the right, "past the sofa on your right" does not.
        (EventContent::Place(place), WalkDecision::Turn { side }) => {
            place.side == Some(*side) && place.link == PlaceLink::Goal
        }
        (EventContent::Climb(told), WalkDecision::Climb { direction }) => told == direction,
        (EventContent::Steps(_) | EventContent::Storey(_) | EventContent::Floor(_), WalkDecision::Climb { .. }) => true,
        (EventContent::Place(place), WalkDecision::Room { name }) => place.is_room && same_room(&place.name, name),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::{RoomStay, StairFlight};
    use std::{collections::BTreeSet, f64::consts::FRAC_PI_2};
    use wayword_language::reading::read_instruction;

    const TEXT: &str = "Walk down the hallway. Turn left into the kitchen. Go up the stairs and stop.";

    /// A walk that turns left at frame 3, enters the kitchen at 4, climbs from 6 to 8 and turns right at 9.
    #[allow(clippy::field_reassign_with_default, reason = "its other fields are private")]
    fn memory() -> WalkMemory {
        let stay = |room: &str, entered, left| RoomStay { room: room.to_owned(), entered, left };
        let bend = |first: usize, turn_rad| WalkBend { first, last: first, turn_rad };
        let mut memory = WalkMemory::default();
        memory.stays = vec![stay("hallway", 0, 3), stay("kitchen", 4, 10)];
        memory.bends = vec![bend(3, -FRAC_PI_2), bend(9, FRAC_PI_2)];
        memory.flights = vec![StairFlight { climb: ClimbDirection::Up, from: 6, to: 8, to_level: None }];
        memory
    }

    fn cover(frames: [[usize; 2]; 3], is_open: impl Fn(&WalkBend) -> bool) -> Vec<(WalkDecision, DecisionTold)> {
        let ends = [TEXT.find(" Turn").unwrap(), TEXT.find(" Go").unwrap(), TEXT.len()];
        let parts: Vec<InstructionPart> = frames
            .iter()
            .enumerate()
            .map(|(at, frames)| InstructionPart {
                span: [if at == 0 { 0 } else { ends[at - 1] }, ends[at]],
                frames: *frames,
                confidence: None,
            })
            .collect();
        let reading = read_instruction(TEXT, &BTreeSet::new());
        let covered = cover_walk(&reading, &parts, &memory(), is_open);
        covered.into_iter().map(|covered| (covered.decision, covered.told)).collect()
    }

    #[test]
    fn decisions_are_told_by_the_part_of_their_stretch_or_left_out() {
        let told = cover([[0, 3], [3, 5], [5, 10]], |_| true);
        let kitchen = WalkDecision::Room { name: "kitchen".to_owned() };
        assert_eq!(
            told,
            [
                (WalkDecision::Turn { side: Side::Left }, DecisionTold::Told),
                (kitchen, DecisionTold::Told),
                (WalkDecision::Climb { direction: ClimbDirection::Up }, DecisionTold::Told),
                (WalkDecision::Turn { side: Side::Right }, DecisionTold::LeftOut),
            ]
        );
        // Where the way forces a turn there is nothing to decide.
        assert_eq!(cover([[0, 3], [3, 5], [5, 10]], |bend| bend.first < 5).len(), 3);
    }

    #[test]
    fn a_decision_in_the_stretch_of_another_part_is_early_or_late() {
        let late = cover([[0, 5], [5, 5], [5, 10]], |_| true);
        assert_eq!(late[0].1, DecisionTold::Late);
        let early = cover([[0, 0], [0, 1], [1, 10]], |_| true);
        assert_eq!((early[0].1, early[2].1), (DecisionTold::Early, DecisionTold::Told));
    }
}
