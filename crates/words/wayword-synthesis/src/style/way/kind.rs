//! The kinds of clauses that describe a way, and how a clause of a reference text is assigned to one.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_core::{Climb, Side};
use wayword_language::{
    lexicon::{Class, room_name, thing},
    reading::{Event, Going, Link, Place, What},
};

/// The content of a clause. In its shape, `{s}` is a side, `{l}` a thing, `{r}` a room, `{a}` the room that one leaves,
/// and `{p}` the side on which a thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // The names explain themselves.
pub enum Kind {
    Turn,
    TurnSlightly,
    TurnAround,
    TurnAt,
    TurnIn,
    TurnInto,
    TurnOut,
    TurnThroughDoor,
    TurnAtDoor,
    TurnAtEnd,
    TurnAtTop,
    TurnAtBottom,
    Up,
    Down,
    Enter,
    EnterOnSide,
    EnterThroughDoor,
    EnterWith,
    ThroughDoor,
    DoorOnSide,
    ToDoor,
    Leave,
    LeaveByDoor,
    LeaveEnter,
    Through,
    Along,
    AlongToEnd,
    Pass,
    PassOnSide,
    PassEnter,
    To,
    Straight,
    StopAt,
    StopAtIn,
    StopIn,
    StopInDoorway,
    StopInDoorwayOf,
    StopAtTop,
    StopAtBottom,
    Stop,
}

impl Kind {
    /// Whether it is a turn without any other detail.
    #[must_use]
    pub fn is_bare_turn(self) -> bool {
        matches!(self, Self::Turn | Self::TurnSlightly | Self::TurnAround)
    }

    /// Whether its words name the room that it leads to or takes place in.
    #[must_use]
    pub fn names_room(self) -> bool {
        !matches!(
            self,
            Self::DoorOnSide
                | Self::TurnThroughDoor
                | Self::ThroughDoor
                | Self::ToDoor
                | Self::TurnAtDoor
                | Self::StopAt
                | Self::Stop
                | Self::StopInDoorway
        )
    }

    /// Whether a limit may follow it, as in "walk straight until you reach the sofa".
    #[must_use]
    pub fn goes_on(self) -> bool {
        matches!(self, Self::Straight | Self::Along | Self::Pass | Self::PassOnSide)
    }
}

/// The names of openings between rooms.
const DOORS: &[&str] = &["door", "doorway", "opening", "entrance", "exit"];

/// A clause taken apart.
pub(super) struct Parts<'a> {
    turns: Vec<(Side, [usize; 2])>,
    climb: Option<Climb>,
    stops: bool,
    onward: bool,
    /// Rooms and things that fill a slot, with the spans of their names.
    pub(super) rooms: Vec<(&'a Place, [usize; 2])>,
    pub(super) things: Vec<(&'a Place, [usize; 2])>,
    doors: Vec<&'a Place>,
    stairs: bool,
}

impl<'a> Parts<'a> {
    /// The parts of a clause from its events; `None` if it has a part that fits no kind.
    pub(super) fn of(events: &[&'a Event]) -> Option<Self> {
        let mut parts = Self {
            turns: Vec::new(),
            climb: None,
            stops: false,
            onward: false,
            rooms: Vec::new(),
            things: Vec::new(),
            doors: Vec::new(),
            stairs: false,
        };
        for event in events {
            match &event.what {
                _ if event.denied => return None,
                What::Turn(side) => parts.turns.push((*side, event.span)),
                What::Climb(climb) if parts.climb.is_none() => parts.climb = Some(*climb),
                What::Stop => parts.stops = true,
                What::Onward => parts.onward = true,
                What::Place(place) => parts.place(place, event.span)?,
                _ => return None,
            }
        }
        Some(parts)
    }

    fn place(&mut self, place: &'a Place, span: [usize; 2]) -> Option<()> {
        let is_plain = place.ordinal.is_none() && place.count.is_none() && place.colour.is_none();
        let class = thing(&place.name).map(|thing| thing.class);
        let is_stairs = class == Some(Class::Stairs) || room_name(&place.name) == Some("stairs");
        match class {
            _ if !is_plain => return None,
            _ if is_stairs => self.stairs = true,
            _ if DOORS.contains(&place.name.as_str()) => self.doors.push(place),
            // Walls and floors are in every room, and evidence does not list them.
            Some(Class::Fabric | Class::Unknown | Class::Door) => return None,
            _ if place.several => return None,
            _ if place.is_room => self.rooms.push((place, span)),
            Some(_) => self.things.push((place, span)),
            None => return None,
        }
        Some(())
    }

    /// The span of the words of its only turn.
    pub(super) fn turn_span(&self) -> Option<[usize; 2]> {
        self.turns.first().map(|(_, span)| *span)
    }

    /// The kind of the clause, by its parts and its words.
    pub(super) fn kind(&self, words: &BTreeSet<&str>) -> Option<Kind> {
        let has = |of: &[&str]| of.iter().any(|word| words.contains(word));
        let (turns, rooms, things, doors) = (self.turns.len(), self.rooms.len(), self.things.len(), self.doors.len());
        let is_hall = |place: &Place| room_name(&place.name) == Some("hallway");
        if turns > 1 || things > 1 || rooms > 2 || doors > 1 || (self.stops && turns > 0) {
            return None;
        }
        if let Some(climb) = self.climb {
            let alone = turns + rooms + things + doors == 0 && !self.stops && !has(&["top", "bottom"]);
            return alone.then_some(if climb == Climb::Up { Kind::Up } else { Kind::Down });
        }
        if self.stairs {
            let at_stairs = rooms + things + doors == 0 && !has(&["end"]);
            let kind = match (turns, self.stops, has(&["top"]), has(&["bottom", "foot"])) {
                (1, _, true, false) => Kind::TurnAtTop,
                (1, _, false, true) => Kind::TurnAtBottom,
                (0, true, true, false) => Kind::StopAtTop,
                (0, true, false, true) => Kind::StopAtBottom,
                _ => return None,
            };
            return at_stairs.then_some(kind);
        }
        let at_end = has(&["end"]);
        if let Some((side, _)) = self.turns.first() {
            let says_more = has(&["room", "out", "once", "top", "bottom", "foot"]) && rooms + things + doors == 0;
            let slight = has(&["slight", "slightly", "bear", "veer"]);
            return if says_more { None } else { self.turning(*side, at_end, slight) };
        }
        if self.stops {
            let says_more = has(&["room", "once", "top", "bottom", "foot", "inside"]) && rooms + things + doors == 0;
            return self.stopping(at_end || says_more);
        }
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            ([], [], []) if has(&["room"]) => {
                let leaves = has(&["exit", "leave", "out", "exiting", "leaving"]);
                let through = has(&["through", "across", "cross"]);
                match (leaves, through, at_end) {
                    (_, _, true) => None,
                    (true, false, _) => Some(Kind::Leave),
                    (false, true, _) => Some(Kind::Through),
                    (false, false, _) if has(&["enter", "into"]) => Some(Kind::Enter),
                    _ => None,
                }
            }
            ([], [], []) => (self.onward && !at_end).then_some(Kind::Straight),
            ([], [(thing, _)], []) if has(&["room"]) && has(&["with"]) => {
                let enters = has(&["enter", "into"]) && !has(&["through", "past"]);
                (enters && thing.going.is_none() && thing.side.is_none() && !at_end).then_some(Kind::EnterWith)
            }
            ([], [], [door]) if !at_end => Self::by_door(door),
            ([], [(thing, _)], []) => Self::by_thing(thing, at_end),
            ([(room, _)], [], [door]) if room.going == Some(Going::Leaving) => {
                let through = matches!(door.going, Some(Going::Through)) && door.side.is_none();
                (through && !at_end).then_some(Kind::LeaveByDoor)
            }
            ([(room, _)], [(thing, _)], []) if has(&["with"]) => {
                let enters = room.going == Some(Going::Entering) && room.side.is_none();
                (enters && thing.going.is_none() && thing.side.is_none() && !at_end).then_some(Kind::EnterWith)
            }
            ([(room, _)], [(thing, _)], []) => {
                let passes = thing.going == Some(Going::Past) && thing.side.is_none();
                (passes && room.going == Some(Going::Entering) && !at_end).then_some(Kind::PassEnter)
            }
            ([(room, _)], [], [door]) => {
                let enters = room.going == Some(Going::Entering) || room.link == Link::Goal;
                let through = matches!(door.going, Some(Going::Through | Going::Entering)) || door.link == Link::Along;
                (enters && through && !at_end).then_some(Kind::EnterThroughDoor)
            }
            ([(room, _)], [], []) if is_hall(room) && at_end => match room.going {
                Some(Going::Leaving | Going::Past | Going::Around) => None,
                _ => Some(Kind::AlongToEnd),
            },
            ([(room, _)], [], []) if !at_end && room.side.is_some() => {
                (room.going == Some(Going::Entering)).then_some(Kind::EnterOnSide)
            }
            ([(room, _)], [], []) if !at_end => match (room.going, room.link) {
                (Some(Going::Entering), _) | (Some(Going::Towards | Going::Until), Link::Goal) => Some(Kind::Enter),
                (Some(Going::Leaving), _) => Some(Kind::Leave),
                (Some(Going::Through), _) => Some(Kind::Through),
                (Some(Going::Along), _) if is_hall(room) => Some(Kind::Along),
                _ => None,
            },
            ([(from, _), (to, _)], [], []) if !at_end => {
                let enters = to.going == Some(Going::Entering) || to.link == Link::Goal;
                (from.going == Some(Going::Leaving) && enters).then_some(Kind::LeaveEnter)
            }
            _ => None,
        }
    }

    fn turning(&self, side: Side, at_end: bool, slight: bool) -> Option<Kind> {
        let around = side == Side::Behind;
        let place = self.rooms.iter().chain(&self.things).map(|(place, _)| *place).chain(self.doors.iter().copied());
        if place.into_iter().any(|place| place.side.is_some()) {
            return None;
        }
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            ([], [], []) if around => Some(Kind::TurnAround),
            _ if around => None,
            ([], [], []) if slight => Some(Kind::TurnSlightly),
            ([], [], []) if !at_end => Some(Kind::Turn),
            _ if slight => None,
            ([], [(thing, _)], []) if !at_end => {
                let is_at = thing.tells_turn && thing.side.is_none();
                (is_at && !matches!(thing.going, Some(Going::Leaving | Going::Through))).then_some(Kind::TurnAt)
            }
            ([], [], [door]) if !at_end => match door.going {
                Some(Going::Through) => Some(Kind::TurnThroughDoor),
                None | Some(Going::Until) if door.tells_turn => Some(Kind::TurnAtDoor),
                _ => None,
            },
            ([(room, _)], [], []) => match (room.going, room.link, at_end) {
                (None | Some(Going::Until | Going::Towards), _, true) if room_name(&room.name) == Some("hallway") => {
                    Some(Kind::TurnAtEnd)
                }
                (_, _, true) => None,
                (Some(Going::Entering), ..) | (Some(Going::Towards), Link::Goal, _) => Some(Kind::TurnInto),
                (Some(Going::Leaving), ..) => Some(Kind::TurnOut),
                (None, Link::Within, _) => Some(Kind::TurnIn),
                _ => None,
            },
            _ => None,
        }
    }

    fn stopping(&self, at_end: bool) -> Option<Kind> {
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            _ if at_end => None,
            ([], [], []) => Some(Kind::Stop),
            ([], [(thing, _)], []) => {
                let is_by = thing.side.is_none() && !matches!(thing.going, Some(Going::Past | Going::Leaving));
                is_by.then_some(Kind::StopAt)
            }
            ([(room, _)], [(thing, _)], []) => {
                let is_by = thing.side.is_none() && thing.going.is_none();
                let is_in = room.going.is_none() && room.link == Link::Within && room.side.is_none();
                (is_by && is_in).then_some(Kind::StopAtIn)
            }
            ([], [], [door]) => (door.side.is_none() && door.going.is_none()).then_some(Kind::StopInDoorway),
            ([(room, _)], [], [door]) => {
                let is_still = door.side.is_none() && door.going.is_none() && room.side.is_none();
                (is_still && matches!(room.going, None | Some(Going::Towards))).then_some(Kind::StopInDoorwayOf)
            }
            ([(room, _)], [], []) => {
                let is_in = matches!(room.going, None | Some(Going::Entering | Going::Until));
                (is_in && matches!(room.link, Link::Within | Link::Goal)).then_some(Kind::StopIn)
            }
            _ => None,
        }
    }

    fn by_door(door: &Place) -> Option<Kind> {
        let through = matches!(door.going, Some(Going::Through | Going::Entering | Going::Leaving));
        match (through, door.side.is_some(), door.going) {
            (true, true, _) => Some(Kind::DoorOnSide),
            (true, false, _) => Some(Kind::ThroughDoor),
            (false, false, Some(Going::Towards | Going::Until)) => Some(Kind::ToDoor),
            _ => None,
        }
    }

    fn by_thing(place: &Place, at_end: bool) -> Option<Kind> {
        match (place.going, place.side.is_some()) {
            _ if at_end => None,
            (Some(Going::Past), false) => Some(Kind::Pass),
            (Some(Going::Past), true) => Some(Kind::PassOnSide),
            (Some(Going::Towards | Going::Until), false) => Some(Kind::To),
            _ => None,
        }
    }
}
