//! Decides how the walker moves relative to a place that a text claims: into it, past it, or not at all.

use wayword_language::{
    lexicon::room_name,
    reading::{Going, Link, Reading, What},
};

/// How the walker moves relative to a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Relation {
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

impl Relation {
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
pub(super) fn relations(reading: &Reading) -> Vec<Option<Relation>> {
    let goes_on = last_motion(reading);
    // The clause, and whether the next place in it is where the walker stops.
    let (mut clause, mut stops, mut named, mut at_stairs) = (usize::MAX, false, false, false);
    let relation = |event: &wayword_language::reading::Event| {
        if event.clause != clause {
            (clause, stops, named, at_stairs) = (event.clause, false, false, false);
        }
        let place = match &event.what {
            What::Stop => {
                (stops, named) = (event.clause >= goes_on, false);
                return None;
            }
            What::Face { .. } => {
                stops = false;
                return None;
            }
            What::Place(place) => place,
            _ => return None,
        };
        let relation = match place.going {
            Some(Going::Leaving) => Relation::Exit,
            // "Stop when you are back in the kitchen".
            Some(Going::Entering) if stops && !named => Relation::Stop,
            Some(Going::Entering) => Relation::Enter,
            Some(Going::Through | Going::Along | Going::Around) => Relation::Through,
            Some(Going::Past) => Relation::Past,
            Some(Going::Towards | Going::Until) if stops && !named => Relation::Stop,
            Some(Going::Towards | Going::Until) => Relation::Towards,
            // "Stop by the sofa next to the window": the window only identifies the sofa. Stairs are long, so the walk
            // stops at a thing next to them.
            None if stops && at_stairs && place.link == Link::Beside => Relation::Stop,
            None if stops && !(named && place.link == Link::Beside) => Relation::Stop,
            None => Relation::Beside,
        };
        at_stairs = !named && relation == Relation::Stop && room_name(&place.name) == Some("stairs");
        named = true;
        Some(relation)
    };
    reading.events.iter().map(relation).collect()
}

/// The clause of the last motion by a place or over stairs. A stop before it is not where the walk ends: "stop at the
/// top of the stairs. Turn right and walk into the kitchen".
fn last_motion(reading: &Reading) -> usize {
    let is_motion = |what: &What| match what {
        What::Climb(_) => true,
        What::Place(place) => matches!(
            place.going,
            Some(Going::Leaving | Going::Entering | Going::Through | Going::Past | Going::Along | Going::Towards)
        ),
        _ => false,
    };
    reading.events.iter().filter(|event| is_motion(&event.what)).map(|event| event.clause).max().unwrap_or(0)
}
