//! The memory of a walk: each thing once, the rooms in the order in which one passes them, the bends, the flights of
//! stairs and the openings between rooms. It is made of the evidence and the path alone, for writers and checks alike.

mod doors;
mod openings;
mod stays_and_bends;
#[cfg(test)]
mod tests;
mod things;

pub(crate) use openings::{IN_DOOR_M, frames_at_doors, is_any_door, is_door};
pub use openings::{RoomOpening, is_way_through, leads_through_a_door};
pub use stays_and_bends::{RoomStay, StairFlight, WalkBend};
pub use things::{AHEAD_FRAMES, RememberedThing, ThingGlimpse, ThingPassing};

use crate::{Evidence, EvidenceSource, evidence::WalkEyes};
use std::ops::RangeInclusive;
use wayword_core::{DVec3, Heading, Path, Side, motion};
use wayword_language::lexicon::{names_agree, same_room};

/// What a walker passed so long before the end of a walk is no thing to stop at, metres; what lies behind the walker there has to be so
/// near.
pub(crate) const BEHIND_STOP_M: f64 = 1.0;
/// A walker who comes so near to a thing takes it for the one to stop at, metres.
const FIRST_STOP_M: f64 = 2.0;
/// A walker may go on so far without a word, metres. R2R counts a walker who stops within this of the goal as arrived.
pub const MAX_TOLD_GAP_M: f64 = 3.0;
/// A door "on the left" that is farther than this behind the last thing that was named is not taken for the next one, metres.
pub const MAX_SIDE_DOOR_GAP_M: f64 = 1.0;
/// A text has words for a way that is longer than this, metres.
pub const MAX_SILENT_WAY_M: f64 = 5.0;
/// "Down the hallway" goes at least so far along it, metres.
const MIN_ALONG_M: f64 = 2.0;
/// A stop without any place lies at most so far behind the last thing that was named, metres.
pub const MAX_BARE_STOP_GAP_M: f64 = 1.5;

/// The memory of a walk.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WalkMemory {
    /// The things, in the order in which they are first seen.
    pub things: Vec<RememberedThing>,
    /// The rooms, in order. Frames without a known room belong to none.
    pub stays: Vec<RoomStay>,
    /// The turns, in order: several small turns to one side are one. None where the motion is unknown.
    pub bends: Vec<WalkBend>,
    /// The flights of stairs, in order.
    pub flights: Vec<StairFlight>,
    /// Where the room changes between two frames, in order.
    pub openings: Vec<RoomOpening>,
    /// The eye at each frame, metres; empty where the motion is unknown.
    eyes: Vec<DVec3>,
    /// The heading at each frame, before the turn of its move.
    headings: Vec<Heading>,
    /// Whether the walk goes from viewpoint to viewpoint of a graph.
    is_on_graph: bool,
    /// Whether labels show the doors, with their positions. Then a change of rooms without one leads through none.
    knows_doors: bool,
}

/// Frames lie close together if their mean distance is at most this, metres.
pub(crate) const MAX_DENSE_HOP_M: f64 = 1.3;

/// The mean distance of the frames of a walk, metres; `None` where the motion is unknown.
pub(crate) fn mean_hop_m(evidence: &Evidence) -> Option<f64> {
    let hops = evidence.moves.iter().map(|step| step.distance_m);
    (!evidence.moves.is_empty()).then(|| hops.sum::<f64>() / evidence.moves.len() as f64)
}

/// Whether a walk goes from viewpoint to viewpoint of a graph. The pictures of a recording have names like viewpoints, but lie as close
/// together as the recording asks for, and witnesses tell what they show.
fn is_on_graph(evidence: &Evidence, path: &Path) -> bool {
    let is_wide = || mean_hop_m(evidence).is_none_or(|hop_m| hop_m > MAX_DENSE_HOP_M);
    let has_viewpoints = path.frames.iter().all(|frame| frame.viewpoint.is_some());
    has_viewpoints && (evidence.source == EvidenceSource::Labels || is_wide())
}

impl WalkMemory {
    /// The memory of a path, made from its evidence.
    #[must_use]
    pub fn from_path(evidence: &Evidence, path: &Path) -> Self {
        let is_known = path.motion.is_known();
        let eyes: Vec<DVec3> = match is_known {
            true => path.frames.iter().map(|frame| frame.pose.position).collect(),
            false => Vec::new(),
        };
        let headings: Vec<Heading> = path.frames.iter().map(|frame| frame.pose.heading).collect();
        let things = things::remember_things(evidence, &WalkEyes::along(path));
        let bends = stays_and_bends::find_bends(&evidence.moves);
        let mut stays = stays_and_bends::find_stays(evidence);
        let doors = openings::hops_to_doors(&things, &eyes);
        stays_and_bends::turn_before_rooms(&mut stays, &bends, |hop| doors.contains(&hop));
        let openings = openings::find_openings(&stays, evidence);
        let is_on_graph = is_on_graph(evidence, path);
        let shows_door = |thing: &RememberedThing| thing.position.is_some() && is_any_door(&thing.name);
        let knows_doors = evidence.source == EvidenceSource::Labels && !is_on_graph && things.iter().any(shows_door);
        let mut memory = Self {
            things,
            bends,
            flights: stays_and_bends::find_flights(evidence),
            stays,
            openings,
            eyes,
            headings,
            is_on_graph,
            knows_doors,
        };
        if knows_doors {
            let doors = openings::hops_through(&memory.things, &memory.eyes, is_way_through);
            memory.bends = stays_and_bends::split_at_doors(&memory.bends, &evidence.moves, &doors);
            let has_door: Vec<bool> =
                memory.openings.iter().map(|opening| memory.doors_at(opening).next().is_some()).collect();
            memory.openings.iter_mut().zip(has_door).for_each(|(opening, has_door)| opening.has_door = has_door);
        }
        memory
    }

    /// Whether labels show the doors, with their positions.
    #[must_use]
    pub fn knows_doors(&self) -> bool {
        self.knows_doors
    }

    /// Whether the walk goes from viewpoint to viewpoint of a graph, which are farther apart than the frames of another walk.
    #[must_use]
    pub fn is_on_graph(&self) -> bool {
        self.is_on_graph
    }

    /// Whether a bend lies within a flight of stairs.
    #[must_use]
    pub fn is_on_stairs(&self, bend: &WalkBend) -> bool {
        self.flights.iter().any(|flight| flight.from < bend.first && bend.last < flight.to)
    }

    /// The number of frames of the walk.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.headings.len()
    }

    /// The room in which a frame lies.
    #[must_use]
    pub fn room_at(&self, frame: usize) -> Option<&str> {
        self.stay_at(frame).map(|stay| stay.room.as_str())
    }

    /// The stay to which a frame belongs.
    #[must_use]
    pub fn stay_at(&self, frame: usize) -> Option<&RoomStay> {
        self.stays.iter().find(|stay| (stay.entered..=stay.left).contains(&frame))
    }

    /// The distance of a thing from a frame along the floor, metres, where it is known.
    #[must_use]
    pub fn distance_m(&self, thing: &RememberedThing, frame: usize) -> Option<f64> {
        let glimpsed = || thing.glimpse_from(frame).and_then(|glimpse| glimpse.distance_m);
        match (thing.position, self.eyes.get(frame)) {
            (Some(position), Some(eye)) => {
                let off = position - *eye;
                // What lies on another storey is not near.
                Some(if things::shares_storey(position, *eye) { off.truncate().length() } else { off.length() })
            }
            _ => glimpsed(),
        }
    }

    /// The hops at which the walk comes nearest to a thing, by the floor, and how near that is, metres; `None` where the positions are not
    /// known. A hop is named by the frame at its start; at a corner of the walk these are two hops.
    #[must_use]
    pub fn nearest_hops(&self, thing: &RememberedThing) -> Option<(Vec<usize>, f64)> {
        things::nearest_hops(&self.eyes, thing.position?)
    }

    /// Whether the walk passed a thing long before its end, so that it is no thing to stop at.
    #[must_use]
    pub fn is_left_behind(&self, thing: &RememberedThing) -> bool {
        let last = self.frame_count().saturating_sub(1);
        thing.passed.is_some_and(|passed| self.walked_m(passed.frame, last) > BEHIND_STOP_M)
    }

    /// Whether the walk comes to a thing in its last room more than `gap_m` metres before its end, so that a walker may take that for the
    /// one to stop at.
    #[must_use]
    pub fn is_met_before_end(&self, thing: &RememberedThing, gap_m: f64) -> bool {
        let last = self.frame_count().saturating_sub(1);
        let Some(stay) = self.stay_at(last) else { return false };
        let is_near = |frame: usize| self.distance_m(thing, frame).is_some_and(|far_m| far_m <= FIRST_STOP_M);
        self.shares_room(thing, last..=last)
            && (stay.entered..=last).any(|frame| self.walked_m(frame, last) > gap_m && is_near(frame))
    }

    /// The way between two frames along the walk, metres; 0 where the motion is unknown.
    #[must_use]
    pub fn walked_m(&self, from: usize, to: usize) -> f64 {
        let eyes = self.eyes.get(from..=to).unwrap_or_default();
        eyes.windows(2).map(|hop| hop[0].distance(hop[1])).sum()
    }

    /// Whether the walk goes far enough along the room of a stay, from a frame on, that "along" says something. False where the motion is
    /// unknown.
    #[must_use]
    pub fn goes_along(&self, stay: &RoomStay, from: usize) -> bool {
        let last = self.frame_count().saturating_sub(1);
        self.walked_m(stay.entered.max(from).saturating_sub(1), (stay.left + 1).min(last)) >= MIN_ALONG_M
    }

    /// Whether a walker goes straight on from a frame to another one, but for slight bends. True where the motion is unknown.
    #[must_use]
    pub fn goes_straight(&self, from: usize, to: usize) -> bool {
        // At the start the walker first turns into the way.
        let heading = |frame: usize| self.headings.get(frame.max(usize::from(from == 0)));
        let turned_rad = heading(from).zip(heading(to)).map_or(0.0, |(from, to)| from.turn_to(*to));
        self.eyes.is_empty() || turned_rad.to_degrees().abs() < motion::SLIGHT_DEG
    }

    /// Whether a thing may stand in a room where one of these frames lies; true where a room is not known.
    #[must_use]
    pub fn shares_room(&self, thing: &RememberedThing, mut frames: RangeInclusive<usize>) -> bool {
        let Some(room) = &thing.room else { return true };
        frames.any(|frame| self.room_at(frame).is_none_or(|here| same_room(here, room)))
    }

    /// The side of a walker at a frame on which a thing lies, looking along the frame's heading.
    #[must_use]
    pub fn side_at(&self, thing: &RememberedThing, frame: usize) -> Option<Side> {
        let (eye, heading) = (self.eyes.get(frame)?, self.headings.get(frame)?);
        match thing.position {
            Some(position) => Heading::towards(*eye, position).map(|to| heading.side_of(to)),
            None => thing.glimpse_from(frame)?.turn_rad.map(|turn_rad| heading.side_of(heading.turned_by(turn_rad))),
        }
    }

    /// The direction of a thing from the heading with which the walk arrives at a frame, radians in (-π, π], positive right, by
    /// the thing's position.
    #[must_use]
    pub fn turn_towards(&self, thing: &RememberedThing, frame: usize) -> Option<f64> {
        let (eye, heading) = (self.eyes.get(frame)?, self.headings.get(frame)?);
        Some(heading.turn_to(Heading::towards(*eye, thing.position?)?))
    }

    /// Which one a thing is among those of its name that one passes on the same side in the same stay, the first being 1,
    /// and how many there are. `None` where one does not pass it, or the positions are not known.
    #[must_use]
    pub fn ordinal_among_alike(&self, thing: &RememberedThing) -> Option<(usize, usize)> {
        let passed = thing.passed.filter(|_| thing.position.is_some())?;
        let stay = self.stay_at(passed.frame)?;
        let mut alike: Vec<(f64, &RememberedThing)> = Vec::new();
        for other in self.things.iter().filter(|other| names_agree(&other.name, &thing.name)) {
            let by = other.passed?;
            other.position?;
            if by.side == passed.side && (stay.entered..=stay.left).contains(&by.frame) {
                alike.push((by.along_m, other));
            }
        }
        alike.sort_by(|a, b| a.0.total_cmp(&b.0));
        let place = alike.iter().position(|(_, other)| *other == thing)?;
        Some((place + 1, alike.len()))
    }

    /// The things that are seen from a frame.
    pub fn seen_from(&self, frame: usize) -> impl Iterator<Item = &RememberedThing> {
        self.things.iter().filter(move |thing| thing.glimpse_from(frame).is_some())
    }
}
