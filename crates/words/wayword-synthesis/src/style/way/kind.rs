//! The kinds of clauses that describe a way, and how a clause of a reference text is assigned to one.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, Side};
use wayword_language::{
    lexicon::{ThingClass, find_thing, room_name},
    reading::{EventContent, PlaceLink, PlaceMention, PlaceMotion, TextEvent},
};

/// The content of a clause. In its shape, `{s}` is a side, `{l}` a thing, `{r}` a room, `{a}` the room that one leaves,
/// and `{p}` the side on which a thing is.
///
/// `TurnIn` is "turn left in the kitchen", `TurnInto` "turn left into the kitchen", `TurnOut` "turn left out of the
/// kitchen"; `To` is "go to the sofa", `EnterWith` "enter the room with the sofa", `LeaveEnter` "leave the kitchen and
/// enter the hallway".
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)] // The names explain themselves.
pub enum ClauseKind {
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

impl ClauseKind {
    /// Whether it is a turn without any other detail.
    #[must_use]
    pub fn is_bare_turn(self) -> bool {
        matches!(self, Self::Turn | Self::TurnSlightly | Self::TurnAround)
    }

    /// Whether it is a turn, which has a side.
    #[must_use]
    pub fn turns(self) -> bool {
        matches!(
            self,
            Self::Turn
                | Self::TurnSlightly
                | Self::TurnAt
                | Self::TurnIn
                | Self::TurnInto
                | Self::TurnOut
                | Self::TurnThroughDoor
                | Self::TurnAtDoor
                | Self::TurnAtEnd
                | Self::TurnAtTop
                | Self::TurnAtBottom
        )
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
const DOOR_WORDS: &[&str] = &["door", "doorway", "opening", "entrance", "exit"];

/// Whether a word names an opening between rooms.
#[must_use]
pub fn is_door_word(word: &str) -> bool {
    DOOR_WORDS.contains(&word)
}

/// A clause taken apart into its turns, climbs, stops, rooms, things and doors.
pub(super) struct ClauseParts<'a> {
    /// The turns, with the spans of their words in bytes.
    turns: Vec<(Side, [usize; 2])>,
    climb: Option<ClimbDirection>,
    /// Whether it is an order to stop.
    stops: bool,
    /// Whether it sends the walker straight on.
    onward: bool,
    /// Rooms and things that fill a slot, with the spans of their names in bytes.
    rooms: Vec<(&'a PlaceMention, [usize; 2])>,
    things: Vec<(&'a PlaceMention, [usize; 2])>,
    doors: Vec<&'a PlaceMention>,
    /// Whether it names stairs.
    stairs: bool,
}

impl<'a> ClauseParts<'a> {
    /// The parts of a clause from its events; `None` if it has a part that fits no kind.
    pub(super) fn from_events(events: &[&'a TextEvent]) -> Option<Self> {
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
                EventContent::Turn(side) => parts.turns.push((*side, event.span)),
                EventContent::Climb(climb) if parts.climb.is_none() => parts.climb = Some(*climb),
                EventContent::Stop => parts.stops = true,
                EventContent::Onward => parts.onward = true,
                EventContent::Place(place) => parts.add_place(place, event.span)?,
                _ => return None,
            }
        }
        Some(parts)
    }

    /// Adds a place that the clause names; `None` if no kind of clause has such a place.
    fn add_place(&mut self, place: &'a PlaceMention, span: [usize; 2]) -> Option<()> {
        let is_plain = place.ordinal.is_none() && place.count.is_none() && place.colour.is_none();
        let class = find_thing(&place.name).map(|thing| thing.class);
        let is_stairs = class == Some(ThingClass::Stairs) || room_name(&place.name) == Some("stairs");
        match class {
            _ if !is_plain => return None,
            _ if is_stairs => self.stairs = true,
            _ if is_door_word(&place.name) => self.doors.push(place),
            // Walls and floors are in every room, and evidence does not list them.
            Some(ThingClass::Fabric | ThingClass::Unknown | ThingClass::Door) => return None,
            _ if place.several => return None,
            _ if place.is_room => self.rooms.push((place, span)),
            Some(_) => self.things.push((place, span)),
            None => return None,
        }
        Some(())
    }

    /// The byte ranges of its names, with their slots in a shape of this kind.
    pub(super) fn named_slots(&self, kind: ClauseKind) -> Vec<([usize; 2], &'static str)> {
        let things = self.things.iter().map(|(_, span)| (*span, "{l}"));
        let rooms = self.rooms.iter().enumerate().map(|(number, (_, span))| {
            (*span, if kind == ClauseKind::LeaveEnter && number == 0 { "{a}" } else { "{r}" })
        });
        things.chain(rooms).collect()
    }

    /// The span of the words of its first turn, bytes.
    pub(super) fn turn_span(&self) -> Option<[usize; 2]> {
        self.turns.first().map(|(_, span)| *span)
    }

    /// The kind of the clause, by its parts and its words; `None` if it fits no kind. Climbs, stairs, turns and stops
    /// decide first, and then how many rooms, things and doors the clause names.
    pub(super) fn clause_kind(&self, words: &BTreeSet<&str>) -> Option<ClauseKind> {
        let has = |wanted: &[&str]| wanted.iter().any(|word| words.contains(word));
        let (turns, rooms, things, doors) = (self.turns.len(), self.rooms.len(), self.things.len(), self.doors.len());
        let is_hall = |place: &PlaceMention| room_name(&place.name) == Some("hallway");
        if turns > 1 || things > 1 || rooms > 2 || doors > 1 || (self.stops && turns > 0) {
            return None;
        }
        if let Some(climb) = self.climb {
            let alone = turns + rooms + things + doors == 0 && !self.stops && !has(&["top", "bottom"]);
            return alone.then_some(if climb == ClimbDirection::Up { ClauseKind::Up } else { ClauseKind::Down });
        }
        if self.stairs {
            let at_stairs = rooms + things + doors == 0 && !has(&["end"]);
            let kind = match (turns, self.stops, has(&["top"]), has(&["bottom", "foot"])) {
                (1, _, true, false) => ClauseKind::TurnAtTop,
                (1, _, false, true) => ClauseKind::TurnAtBottom,
                (0, true, true, false) => ClauseKind::StopAtTop,
                (0, true, false, true) => ClauseKind::StopAtBottom,
                _ => return None,
            };
            return at_stairs.then_some(kind);
        }
        let at_end = has(&["end"]);
        if let Some((side, _)) = self.turns.first() {
            let says_more = has(&["room", "out", "once", "top", "bottom", "foot"]) && rooms + things + doors == 0;
            let slight = has(&["slight", "slightly", "bear", "veer"]);
            return if says_more { None } else { self.turning_kind(*side, at_end, slight) };
        }
        if self.stops {
            let says_more = has(&["room", "once", "top", "bottom", "foot", "inside"]) && rooms + things + doors == 0;
            return self.stopping_kind(at_end || says_more);
        }
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            // "The room" replaces the name of a room.
            ([], [], []) if has(&["room"]) => {
                let leaves = has(&["exit", "leave", "out", "exiting", "leaving"]);
                let through = has(&["through", "across", "cross"]);
                match (leaves, through, at_end) {
                    (_, _, true) => None,
                    (true, false, _) => Some(ClauseKind::Leave),
                    (false, true, _) => Some(ClauseKind::Through),
                    (false, false, _) if has(&["enter", "into"]) => Some(ClauseKind::Enter),
                    _ => None,
                }
            }
            ([], [], []) => (self.onward && !at_end).then_some(ClauseKind::Straight),
            ([], [(thing, _)], []) if has(&["room"]) && has(&["with"]) => {
                let enters = has(&["enter", "into"]) && !has(&["through", "past"]);
                (enters && thing.going.is_none() && thing.side.is_none() && !at_end).then_some(ClauseKind::EnterWith)
            }
            ([], [], [door]) if !at_end => Self::by_door(door),
            ([], [(thing, _)], []) => Self::by_thing(thing, at_end),
            ([(room, _)], [], [door]) if room.going == Some(PlaceMotion::Leaving) => {
                let through = matches!(door.going, Some(PlaceMotion::Through)) && door.side.is_none();
                (through && !at_end).then_some(ClauseKind::LeaveByDoor)
            }
            ([(room, _)], [(thing, _)], []) if has(&["with"]) => {
                let enters = room.going == Some(PlaceMotion::Entering) && room.side.is_none();
                (enters && thing.going.is_none() && thing.side.is_none() && !at_end).then_some(ClauseKind::EnterWith)
            }
            ([(room, _)], [(thing, _)], []) => {
                let passes = thing.going == Some(PlaceMotion::Past) && thing.side.is_none();
                (passes && room.going == Some(PlaceMotion::Entering) && !at_end).then_some(ClauseKind::PassEnter)
            }
            ([(room, _)], [], [door]) => {
                let enters = room.going == Some(PlaceMotion::Entering) || room.link == PlaceLink::Goal;
                let through = matches!(door.going, Some(PlaceMotion::Through | PlaceMotion::Entering))
                    || door.link == PlaceLink::Along;
                (enters && through && !at_end).then_some(ClauseKind::EnterThroughDoor)
            }
            ([(room, _)], [], []) if is_hall(room) && at_end => match room.going {
                Some(PlaceMotion::Leaving | PlaceMotion::Past | PlaceMotion::Around) => None,
                _ => Some(ClauseKind::AlongToEnd),
            },
            ([(room, _)], [], []) if !at_end && room.side.is_some() => {
                (room.going == Some(PlaceMotion::Entering)).then_some(ClauseKind::EnterOnSide)
            }
            ([(room, _)], [], []) if !at_end => match (room.going, room.link) {
                (Some(PlaceMotion::Entering), _)
                | (Some(PlaceMotion::Towards | PlaceMotion::Until), PlaceLink::Goal) => Some(ClauseKind::Enter),
                (Some(PlaceMotion::Leaving), _) => Some(ClauseKind::Leave),
                (Some(PlaceMotion::Through), _) => Some(ClauseKind::Through),
                (Some(PlaceMotion::Along), _) if is_hall(room) => Some(ClauseKind::Along),
                _ => None,
            },
            ([(from, _), (to, _)], [], []) if !at_end => {
                let enters = to.going == Some(PlaceMotion::Entering) || to.link == PlaceLink::Goal;
                (from.going == Some(PlaceMotion::Leaving) && enters).then_some(ClauseKind::LeaveEnter)
            }
            _ => None,
        }
    }

    /// The kind of a clause with a turn to `side`. `at_end`: it names the end of something; `slight`: the turn is
    /// slight.
    fn turning_kind(&self, side: Side, at_end: bool, slight: bool) -> Option<ClauseKind> {
        let around = side == Side::Behind;
        let place = self.rooms.iter().chain(&self.things).map(|(place, _)| *place).chain(self.doors.iter().copied());
        if place.into_iter().any(|place| place.side.is_some()) {
            return None;
        }
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            ([], [], []) if around => Some(ClauseKind::TurnAround),
            _ if around => None,
            ([], [], []) if slight => Some(ClauseKind::TurnSlightly),
            ([], [], []) if !at_end => Some(ClauseKind::Turn),
            _ if slight => None,
            ([], [(thing, _)], []) if !at_end => {
                let is_at = thing.tells_turn && thing.side.is_none();
                (is_at && !matches!(thing.going, Some(PlaceMotion::Leaving | PlaceMotion::Through)))
                    .then_some(ClauseKind::TurnAt)
            }
            ([], [], [door]) if !at_end => match door.going {
                Some(PlaceMotion::Through) => Some(ClauseKind::TurnThroughDoor),
                None | Some(PlaceMotion::Until) if door.tells_turn => Some(ClauseKind::TurnAtDoor),
                _ => None,
            },
            ([(room, _)], [], []) => match (room.going, room.link, at_end) {
                (None | Some(PlaceMotion::Until | PlaceMotion::Towards), _, true)
                    if room_name(&room.name) == Some("hallway") =>
                {
                    Some(ClauseKind::TurnAtEnd)
                }
                (_, _, true) => None,
                (Some(PlaceMotion::Entering), ..) | (Some(PlaceMotion::Towards), PlaceLink::Goal, _) => {
                    Some(ClauseKind::TurnInto)
                }
                (Some(PlaceMotion::Leaving), ..) => Some(ClauseKind::TurnOut),
                (None, PlaceLink::Within, _) => Some(ClauseKind::TurnIn),
                _ => None,
            },
            _ => None,
        }
    }

    /// The kind of a clause that stops. With `at_end` it has a detail that fits no kind.
    fn stopping_kind(&self, at_end: bool) -> Option<ClauseKind> {
        match (self.rooms.as_slice(), self.things.as_slice(), self.doors.as_slice()) {
            _ if at_end => None,
            ([], [], []) => Some(ClauseKind::Stop),
            ([], [(thing, _)], []) => {
                let is_by =
                    thing.side.is_none() && !matches!(thing.going, Some(PlaceMotion::Past | PlaceMotion::Leaving));
                is_by.then_some(ClauseKind::StopAt)
            }
            ([(room, _)], [(thing, _)], []) => {
                let is_by = thing.side.is_none() && thing.going.is_none();
                let is_in = room.going.is_none() && room.link == PlaceLink::Within && room.side.is_none();
                (is_by && is_in).then_some(ClauseKind::StopAtIn)
            }
            ([], [], [door]) => (door.side.is_none() && door.going.is_none()).then_some(ClauseKind::StopInDoorway),
            ([(room, _)], [], [door]) => {
                let is_still = door.side.is_none() && door.going.is_none() && room.side.is_none();
                (is_still && matches!(room.going, None | Some(PlaceMotion::Towards)))
                    .then_some(ClauseKind::StopInDoorwayOf)
            }
            ([(room, _)], [], []) => {
                let is_in = matches!(room.going, None | Some(PlaceMotion::Entering | PlaceMotion::Until));
                (is_in && matches!(room.link, PlaceLink::Within | PlaceLink::Goal)).then_some(ClauseKind::StopIn)
            }
            _ => None,
        }
    }

    /// The kind of a clause that names a door only.
    fn by_door(door: &PlaceMention) -> Option<ClauseKind> {
        let through = matches!(door.going, Some(PlaceMotion::Through | PlaceMotion::Entering | PlaceMotion::Leaving));
        match (through, door.side.is_some(), door.going) {
            (true, true, _) => Some(ClauseKind::DoorOnSide),
            (true, false, _) => Some(ClauseKind::ThroughDoor),
            (false, false, Some(PlaceMotion::Towards | PlaceMotion::Until)) => Some(ClauseKind::ToDoor),
            _ => None,
        }
    }

    /// The kind of a clause that names a thing only.
    fn by_thing(place: &PlaceMention, at_end: bool) -> Option<ClauseKind> {
        match (place.going, place.side.is_some()) {
            _ if at_end => None,
            (Some(PlaceMotion::Past), false) => Some(ClauseKind::Pass),
            (Some(PlaceMotion::Past), true) => Some(ClauseKind::PassOnSide),
            (Some(PlaceMotion::Towards | PlaceMotion::Until), false) => Some(ClauseKind::To),
            _ => None,
        }
    }
}
