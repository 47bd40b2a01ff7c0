//! Makes short texts that each claim one true or false thing about a path, such as "Walk past the sofa."

use rand::{
    Rng,
    seq::{IndexedRandom, SliceRandom},
};
use std::collections::BTreeSet;
use wayword_checks::{Evidence, FrameEvidence};
use wayword_core::{Side, WitnessAnswer};
use wayword_language::lexicon::{ThingClass, find_thing, names_agree, room_name, same_room};
use wayword_synthesis::walk::ObservedWalk;

/// A path with the evidence from its labels and the evidence from its captions.
pub(super) struct ClaimedPath {
    /// The path, with the views that the eye looked at.
    pub(super) walk: ObservedWalk,
    /// The evidence from the labels, which is the truth.
    pub(super) labels: Evidence,
    /// The evidence from the captions of the eye.
    pub(super) captions: Evidence,
}

/// Whether a claim is true, and in which way it is false.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SeededClaimKind {
    /// A thing in a view that the eye looked at, or a room of the path.
    True,
    /// A thing or a room at the end, as the goal.
    TrueGoal,
    /// A thing that is not along the path and that no caption names.
    False,
    /// A thing that the eye named although it is not there.
    Hallucinated,
    /// The goal is a thing that is not at the end and that the captions do not name there.
    WrongThing,
    /// The goal is another room.
    WrongRoom,
}

impl SeededClaimKind {
    /// Whether claims of this kind are true.
    pub(super) fn is_true(self) -> bool {
        matches!(self, Self::True | Self::TrueGoal)
    }

    /// Its name in the table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::True => "true",
            Self::TrueGoal => "true, of the end",
            Self::False => "false",
            Self::Hallucinated => "hallucinated by the eye",
            Self::WrongThing => "wrong goal: a thing",
            Self::WrongRoom => "wrong goal: a room",
        }
    }
}

/// A short text that makes one claim.
pub(super) struct SeededClaim {
    pub(super) kind: SeededClaimKind,
    pub(super) text: String,
}

/// The names of all things and rooms along all paths, from which false claims are drawn.
pub(super) struct ClaimNamePool {
    things: Vec<String>,
    rooms: Vec<String>,
}

impl ClaimNamePool {
    pub(super) fn from_paths(known: &[ClaimedPath]) -> Self {
        let frames = || known.iter().flat_map(|path| &path.labels.frames);
        let things: BTreeSet<&str> = frames().flat_map(thing_names).filter(|name| is_landmark(name)).collect();
        let rooms: BTreeSet<&str> = frames()
            .flat_map(|frame| &frame.rooms)
            .map(String::as_str)
            .filter(|room| room_name(room).is_some())
            .collect();
        let owned = |names: BTreeSet<&str>| names.into_iter().map(str::to_owned).collect();
        Self { things: owned(things), rooms: owned(rooms) }
    }
}

fn thing_names(frame: &FrameEvidence) -> impl Iterator<Item = &str> {
    frame.things.iter().map(|thing| thing.name.as_str())
}

/// Whether a text would use the thing as a landmark. Walls, doors and stairs are checked in other ways.
fn is_landmark(name: &str) -> bool {
    let is_of_the_building = |class| matches!(class, ThingClass::Fabric | ThingClass::Door | ThingClass::Stairs);
    find_thing(name).is_some_and(|thing| !is_of_the_building(thing.class)) && room_name(name).is_none()
}

/// Draws at most `most` claims of each kind about a path.
pub(super) fn make_claims(
    known: &ClaimedPath,
    names: &ClaimNamePool,
    most: usize,
    rng: &mut impl Rng,
) -> Vec<SeededClaim> {
    let mut made = Vec::new();
    let Some((last, last_seen)) = known.labels.frames.last().zip(known.captions.frames.last()) else { return made };
    let mut add = |kind: SeededClaimKind, mut texts: Vec<String>, rng: &mut _| {
        texts.sort();
        texts.dedup();
        texts.shuffle(rng);
        made.extend(texts.into_iter().take(most).map(|text| SeededClaim { kind, text }));
    };
    let (past, stop) = (
        |name: &str| format!("Walk past the {name}."),
        |name: &str| format!("Walk ahead and stop next to the {name}."),
    );
    let enter = |room: &str| format!("Walk through the {room}.");
    let stop_in = |room: &str| format!("Walk ahead and stop in the {room}.");

    let looked = looked_at(known);
    let mut real: Vec<String> = looked.iter().map(|(_, name, side)| with_side(past(name), *side)).collect();
    real.extend(
        known
            .labels
            .frames
            .iter()
            .flat_map(|frame| &frame.rooms)
            .filter(|room| room_name(room).is_some())
            .map(|room| enter(room)),
    );
    add(SeededClaimKind::True, real, rng);

    let end = known.labels.frames.len() - 1;
    let mut goals: Vec<String> = looked.iter().filter(|(at, ..)| *at == end).map(|(_, name, _)| stop(name)).collect();
    goals.extend(last.rooms.iter().filter(|room| room_name(room).is_some()).map(|room| stop_in(room)));
    add(SeededClaimKind::TrueGoal, goals, rng);

    let is_there =
        |name: &str| known.labels.frames.iter().flat_map(self::thing_names).any(|other| names_agree(other, name));
    let named = |frame: &FrameEvidence, name: &str| {
        self::thing_names(frame)
            .chain(frame.perhaps.things.iter().map(|thing| thing.name.as_str()))
            .any(|other| names_agree(other, name))
    };
    let was_named = |name: &str| known.captions.frames.iter().any(|frame| named(frame, name));
    let elsewhere = names.things.iter().filter(|name| !is_there(name) && !was_named(name)).map(|name| past(name));
    add(SeededClaimKind::False, elsewhere.collect(), rng);

    let sightings =
        known.walk.observations.iter().flat_map(|seen| &seen.looks).flat_map(|look| &look.caption.sightings);
    let hallucinated = sightings
        .filter(|seen| seen.witness != WitnessAnswer::Denied && is_landmark(&seen.name) && !is_there(&seen.name));
    add(SeededClaimKind::Hallucinated, hallucinated.map(|seen| past(&seen.name)).collect(), rng);

    let at_end = |name: &str| self::thing_names(last).any(|other| names_agree(other, name)) || named(last_seen, name);
    let wrong = names.things.iter().filter(|name| !at_end(name)).map(|name| stop(name));
    add(SeededClaimKind::WrongThing, wrong.collect(), rng);
    let other = names
        .rooms
        .iter()
        .filter(|room| !last.rooms.is_empty() && !last.rooms.iter().any(|here| same_room(here, room)));
    let others: Vec<&String> = other.collect();
    add(SeededClaimKind::WrongRoom, others.choose(rng).map(|room| stop_in(room)).into_iter().collect(), rng);
    made
}

/// The labelled landmarks in the views that the eye looked at: the frame, the name, and the side unless the thing is ahead.
fn looked_at(known: &ClaimedPath) -> Vec<(usize, &str, Option<Side>)> {
    let mut found = Vec::new();
    for (at, (frame, seen)) in known.walk.path.frames.iter().zip(&known.walk.observations).enumerate() {
        for thing in known.labels.frames[at].things.iter().filter(|thing| is_landmark(&thing.name)) {
            let Some(turn_rad) = thing.turn_rad else { continue };
            let is_in_view = seen.looks.iter().any(|look| {
                let off_rad = look.gaze.heading.turn_to(frame.pose.heading.turned_by(turn_rad));
                off_rad.abs() < look.gaze.horizontal_fov_rad / 2.0
            });
            let side = if turn_rad < 0.0 { Side::Left } else { Side::Right };
            // Within 0.4 radians of the heading, the thing counts as ahead.
            let side = (turn_rad.abs() > 0.4).then_some(side);
            if is_in_view {
                found.push((at, thing.name.as_str(), side));
            }
        }
    }
    found
}

/// The text with a side added to its end.
fn with_side(text: String, side: Option<Side>) -> String {
    let side = match side {
        Some(Side::Left) => " on your left.",
        Some(Side::Right) => " on your right.",
        _ => return text,
    };
    text.trim_end_matches('.').to_owned() + side
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_landmarks_are_claimed() {
        assert!(is_landmark("sofa") && is_landmark("lamp"));
        for name in ["wall", "door", "stairs", "zorble"] {
            assert!(!is_landmark(name), "{name}");
        }
        assert_eq!(with_side("Walk past the sofa.".into(), Some(Side::Left)), "Walk past the sofa on your left.");
    }
}
