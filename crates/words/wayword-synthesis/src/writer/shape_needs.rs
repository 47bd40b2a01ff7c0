//! Decides which shapes fit a clause, by what the walk and the other clauses of the text ask of its words.

use super::{WritingBrief, route::WayClause};
use crate::style::way::{ClauseKind, ShapeTraits};
use wayword_core::Side;
use wayword_language::lexicon::{ThingClass, find_thing, names_agree, room_name};

/// Distance into a room up to which the walker is "just inside", metres.
const JUST_INSIDE_M: f64 = 1.5;

/// What a clause's context asks of its shape.
#[derive(Debug, Clone)]
pub(super) struct ShapeNeeds {
    knows_motion: bool,
    /// Whether the walk goes from viewpoint to viewpoint, which lie far apart.
    pub(super) is_on_graph: bool,
    /// Whether its change of rooms has a door or a doorway.
    pub(super) has_door: bool,
    /// Whether the clause has a room that its words can name.
    has_room: bool,
    /// Whether it may say "the room" without a name.
    may_say_room: bool,
    /// Whether its room is in the open air.
    is_open_air: bool,
    /// Whether the walker has just come into the room.
    is_near_door: bool,
    /// Whether the walker is in the room already.
    is_inside: bool,
    /// Whether it leaves the room of the start, or names the room that it leaves.
    leaves: bool,
    /// Whether it may limit the clause before it ("until you reach ...").
    may_run: bool,
    /// Whether its thing is in front of the walker.
    is_thing_ahead: bool,
    /// Whether its thing is passed before the turn.
    is_passed_before: bool,
    /// The names of the doors at its change of rooms; `None` where they are not known.
    doors: Option<Vec<String>>,
    /// Which of the doors on its side it means, where that is not the first.
    pub(super) door_number: Option<usize>,
}

impl ShapeNeeds {
    /// What the context of clause number `at` asks.
    pub(super) fn of_clause(
        clauses: &[WayClause],
        at: usize,
        door_number: Option<usize>,
        brief: &WritingBrief<'_>,
    ) -> Self {
        let clause = &clauses[at];
        let is_on_graph = brief.memory.is_on_graph();
        let before = at.checked_sub(1).map(|before| clauses[before].kind).filter(|_| !clause.follows_offer);
        // A thing may limit a plain "go straight", so that the text stays complete without the thing.
        let may_run = match clause.thing {
            Some(_) => before == Some(ClauseKind::Straight),
            None => before.is_some_and(ClauseKind::goes_on),
        };
        let walked_in_m = walked_in_m(clause.at, brief);
        let usual = clause.room.as_deref().and_then(room_name);
        let is_open_air = matches!(usual, Some("porch" | "balcony" | "outdoor area"));
        // A hallway is not called "the room", and a porch has no walls to leave it by.
        let has_walls = !is_open_air && !matches!(usual, Some("hallway" | "entryway"));
        let is_passed = |passed: (usize, Side)| passed.0 < clause.at || is_on_graph && passed.0 == clause.at;
        let is_passed_before = clause.kind != ClauseKind::TurnAt
            || clause.thing.as_ref().is_none_or(|thing| {
                thing.side.is_none() || !is_long(&thing.name) && thing.passed.is_some_and(is_passed)
            });
        Self {
            knows_motion: brief.walk.path.motion.is_known(),
            is_on_graph,
            has_door: brief.memory.openings.iter().any(|opening| opening.before == clause.at && opening.has_door),
            has_room: clause.room.is_some(),
            may_say_room: has_walls && !has_to_name(clauses, at, brief),
            is_open_air,
            is_near_door: clause.kind != ClauseKind::StopIn || walked_in_m <= JUST_INSIDE_M,
            is_inside: clause.kind == ClauseKind::TurnIn && walked_in_m > JUST_INSIDE_M,
            leaves: goes_out(clause, brief),
            may_run,
            is_thing_ahead: clause.thing.as_ref().is_none_or(|thing| thing.in_front),
            is_passed_before,
            doors: door_names(clause, brief),
            door_number,
        }
    }

    /// Whether a shape with these traits fits.
    pub(super) fn admit(&self, shape: &ShapeTraits) -> bool {
        let names_door = |word: &String| self.doors.iter().flatten().any(|door| names_agree(word, door));
        (self.knows_motion || !shape.goes_straight)
            && (self.is_thing_ahead || !shape.says_front)
            && (self.has_room || !shape.names_room)
            && (self.may_say_room || !shape.says_room)
            && (self.is_open_air || !shape.goes_outside)
            && (self.is_near_door || !shape.is_at_door)
            && (self.leaves || !shape.leaves)
            && (self.may_run || !shape.is_until)
            && (self.is_passed_before || !shape.says_past)
            && (self.doors.is_none() || shape.doors.iter().all(names_door))
            && !(self.is_inside && shape.is_at_room)
            && (self.is_on_graph || !shape.goes_all_the_way)
    }
}

/// Whether a shape with "exit" or "out" fits a clause: it names the room that it leaves, or its door leads out of the
/// first room and not into the last.
fn goes_out(clause: &WayClause, brief: &WritingBrief<'_>) -> bool {
    let openings = &brief.memory.openings;
    let is_first = openings.len() > 1 && openings[0].before == clause.at;
    clause.from.is_some()
        || is_first
        || !matches!(clause.kind, ClauseKind::ThroughDoor | ClauseKind::DoorOnSide | ClauseKind::ToDoor)
}

/// Whether a thing is so long that one may still be beside it when its middle is passed.
pub(super) fn is_long(name: &str) -> bool {
    find_thing(name)
        .is_some_and(|thing| matches!(thing.class, ThingClass::Bed | ThingClass::Seat | ThingClass::Surface))
}

/// How far the walker has gone in the room of a frame when arriving there, metres.
fn walked_in_m(at: usize, brief: &WritingBrief<'_>) -> f64 {
    let before = brief.memory.stay_at(at).map_or(0, |stay| stay.entered.saturating_sub(1));
    brief.walk.walked_m(before, at)
}

/// The names of the doors and doorways at the change of rooms of a clause; `None` where it has no such change, or the positions of doors
/// are not known.
fn door_names(clause: &WayClause, brief: &WritingBrief<'_>) -> Option<Vec<String>> {
    let memory = brief.memory;
    let opening = memory.openings.iter().find(|opening| opening.before == clause.at)?;
    memory.knows_doors().then(|| memory.doors_at(opening).map(|door| door.name.clone()).collect())
}

/// Whether a clause has to name its room, because "the room" would be unclear: it is the room of the end, a later
/// clause mentions it, or no earlier clause named it.
fn has_to_name(clauses: &[WayClause], at: usize, brief: &WritingBrief<'_>) -> bool {
    let Some(room) = &clauses[at].room else { return false };
    let on_graph = brief.memory.is_on_graph();
    let speaks_of_it = |clause: &WayClause| {
        let names_it = clause.room.as_ref() == Some(room) && (!on_graph || clause.kind.names_room());
        names_it || clause.from.as_ref() == Some(room)
    };
    let (before, after) = (clauses[..at].iter().any(speaks_of_it), clauses[at + 1..].iter().any(speaks_of_it));
    // On a graph, a thing or a doorway to stop at fixes the end as well.
    let fixes_end = |stop: &WayClause| on_graph && (stop.thing.is_some() || stop.kind == ClauseKind::StopInDoorway);
    let end = brief.memory.room_at(brief.memory.frame_count().saturating_sub(1));
    match clauses[at].kind {
        ClauseKind::Leave | ClauseKind::LeaveByDoor => at > 0 && !before,
        ClauseKind::StopIn => !before,
        // The thing in the room identifies it.
        ClauseKind::EnterWith => after,
        _ => after || end == Some(room) && !clauses.last().is_some_and(fixes_end),
    }
}
