//! Decides how the walker moves relative to a place that a text claims: into it, past it, or not at all.

use wayword_language::{
    lexicon::room_name,
    reading::{EventContent, PlaceLink, PlaceMotion, TextReading},
};

/// How the walker moves relative to a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WalkerRelation {
    /// Goes into it.
    Enter,
    /// Comes out of it.
    Exit,
    /// Goes through it, along it or around it.
    Through,
    /// Stops in it or at it.
    Stop,
    /// Goes up to it, or towards it.
    Towards,
    /// Goes past it.
    Past,
    /// Something else is next to it, or it is only named.
    Beside,
}

impl WalkerRelation {
    /// Its name in the table of weights.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Enter => "enter",
            Self::Exit => "exit",
            Self::Through => "through",
            Self::Stop => "stop",
            Self::Towards => "towards",
            Self::Past => "past",
            Self::Beside => "beside",
        }
    }
}

/// The relation of each event of a reading, where it is a place.
pub(super) fn place_relations(reading: &TextReading) -> Vec<Option<WalkerRelation>> {
    let moving_clause = last_motion(reading);
    // The clause so far: its number, whether the walker stops in it, whether it has named a place since then, and
    // whether that place is stairs.
    let (mut clause, mut stops, mut named, mut at_stairs) = (usize::MAX, false, false, false);
    let relation = |event: &wayword_language::reading::TextEvent| {
        if event.clause != clause {
            (clause, stops, named, at_stairs) = (event.clause, false, false, false);
        }
        let place = match &event.what {
            EventContent::Stop => {
                (stops, named) = (event.clause >= moving_clause, false);
                return None;
            }
            EventContent::Face { .. } => {
                stops = false;
                return None;
            }
            EventContent::Place(place) => place,
            _ => return None,
        };
        let relation = match place.going {
            Some(PlaceMotion::Leaving) => WalkerRelation::Exit,
            // "Stop when you are back in the kitchen".
            Some(PlaceMotion::Entering) if stops && !named => WalkerRelation::Stop,
            Some(PlaceMotion::Entering) => WalkerRelation::Enter,
            Some(PlaceMotion::Through | PlaceMotion::Along | PlaceMotion::Around) => WalkerRelation::Through,
            Some(PlaceMotion::Past) => WalkerRelation::Past,
            Some(PlaceMotion::Towards | PlaceMotion::Until) if stops && !named => WalkerRelation::Stop,
            Some(PlaceMotion::Towards | PlaceMotion::Until) => WalkerRelation::Towards,
            // "Stop by the sofa next to the window": the window only identifies the sofa. Stairs are long, so the walk
            // stops at a thing next to them.
            None if stops && at_stairs && place.link == PlaceLink::Beside => WalkerRelation::Stop,
            None if stops && !(named && place.link == PlaceLink::Beside) => WalkerRelation::Stop,
            None => WalkerRelation::Beside,
        };
        at_stairs = !named && relation == WalkerRelation::Stop && room_name(&place.name) == Some("stairs");
        named = true;
        Some(relation)
    };
    reading.events.iter().map(relation).collect()
}

/// The clause of the last motion by a place or over stairs. A stop before it is not where the walk ends: "stop at the
/// top of the stairs. Turn right and walk into the kitchen".
fn last_motion(reading: &TextReading) -> usize {
    let is_motion = |what: &EventContent| match what {
        EventContent::Climb(_) => true,
        EventContent::Place(place) => matches!(
            place.going,
            Some(
                PlaceMotion::Leaving
                    | PlaceMotion::Entering
                    | PlaceMotion::Through
                    | PlaceMotion::Past
                    | PlaceMotion::Along
                    | PlaceMotion::Towards
            )
        ),
        _ => false,
    };
    reading.events.iter().filter(|event| is_motion(&event.what)).map(|event| event.clause).max().unwrap_or(0)
}
