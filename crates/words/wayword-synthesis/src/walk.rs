//! A path together with the observations along it: the input of every writer.

use serde::{Deserialize, Serialize};
use wayword_checks::{Evidence, WalkMemory};
use wayword_core::{FrameObservation, Heading, ObjectDistinction, ObjectSighting, Path, PathMove, Side, WitnessAnswer};
use wayword_language::lexicon::{find_thing, names_agree};

/// Which views of each frame are captioned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameSelection {
    /// The view along the heading (arXiv 2403.11487, "central").
    #[default]
    Central,
    /// Four views, north east south west, condensed (arXiv 2403.11487, "panoramic").
    Panoramic,
}

/// The answerer's name in sightings that come from labels.
const LABELS_ANSWERER_NAME: &str = "labels";

/// Everything that a writer may use about a path.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedWalk {
    /// The path, with its target where one is given.
    pub path: Path,
    /// The moves between its frames; none where the motion is unknown.
    pub moves: Vec<PathMove>,
    /// One observation per frame.
    pub observations: Vec<FrameObservation>,
}

/// An object that was seen from a frame, in words that a writer can use.
#[derive(Debug, Clone, PartialEq)]
pub struct WalkSighting<'a> {
    /// The sighting in the caption.
    pub sighting: &'a ObjectSighting,
    /// The side of the walker on which it is, where the caption places it and the motion is known.
    pub side: Option<Side>,
}

impl ObservedWalk {
    /// Joins a path and the observations along it. Where the motion is unknown, it drops the storeys of the frames and
    /// every property of the target that depends on the walker's pose, such as its side.
    #[must_use]
    pub fn new(mut path: Path, observations: Vec<FrameObservation>) -> Self {
        if !path.motion.is_known() {
            path.frames.iter_mut().for_each(|frame| frame.level = None);
            if let Some(target) = &mut path.target {
                target.told_by.retain(|by| !by.needs_pose());
                target.descriptions.retain(|description| !description.by.iter().any(ObjectDistinction::needs_pose));
            }
        }
        Self { moves: path.moves(), path, observations }
    }

    /// The objects that were seen from a frame, look by look. A name that a model gave is left out if the lexicon does
    /// not know it: half of a phrase that was read wrongly ("soft") would otherwise become a landmark. Names from
    /// labels are always things.
    pub fn seen_from(&self, frame: usize) -> impl Iterator<Item = WalkSighting<'_>> {
        let heading = self.path.frames.get(frame).map_or(Heading::NORTH, |frame| frame.pose.heading);
        let has_sides = self.path.motion.is_known();
        self.observations.get(frame).into_iter().flat_map(|observation| &observation.looks).flat_map(move |look| {
            let seen = look
                .caption
                .sightings
                .iter()
                .filter(|sighting| sighting.witness == WitnessAnswer::Seen && is_thing(sighting));
            seen.map(move |sighting| WalkSighting {
                sighting,
                side: look.side_of(sighting, heading).filter(|_| has_sides),
            })
        })
    }

    /// Whether the target was seen from the last frame; `true` where the path has no target.
    #[must_use]
    pub fn describes_target(&self) -> bool {
        let last = self.path.frames.len().saturating_sub(1);
        let is_seen = |name: &str| self.seen_from(last).any(|seen| names_agree(&seen.sighting.name, name));
        self.path.target.as_ref().is_none_or(|target| is_seen(&target.name))
    }

    /// The room of a frame, as its captions name it.
    #[must_use]
    pub fn room_at(&self, frame: usize) -> Option<&str> {
        self.observations.get(frame)?.looks.iter().find_map(|look| look.caption.room.as_deref())
    }

    /// The evidence that the captions of the walk give; `None` where no caption names a room or an object.
    #[must_use]
    pub fn evidence(&self) -> Option<Evidence> {
        Evidence::from_captions(&self.path, &self.observations)
    }

    /// The evidence that models who saw give; `None` where the captions are made of labels, or name nothing.
    #[must_use]
    pub fn witnessed(&self) -> Option<Evidence> {
        let sightings = self.observations.iter().flat_map(|seen| &seen.looks).flat_map(|look| &look.caption.sightings);
        // What a detector found has a spot, and it denies without one.
        let is_by_model = |sighting: &ObjectSighting| {
            sighting.by != LABELS_ANSWERER_NAME && sighting.spot.is_none() && sighting.witness == WitnessAnswer::Seen
        };
        let is_seen = sightings.clone().any(is_by_model);
        is_seen.then(|| self.evidence()).flatten()
    }

    /// The length of the way from one frame to a later one, metres along the hops.
    pub(crate) fn walked_m(&self, from: usize, to: usize) -> f64 {
        self.moves.get(from..to).unwrap_or_default().iter().map(|step| step.distance_m).sum()
    }

    /// The memory of the walk: rooms, things, bends and stairs, from its captions.
    #[must_use]
    pub fn memory(&self) -> WalkMemory {
        let evidence = self.evidence().unwrap_or_else(|| Evidence::for_path_alone(&self.path));
        WalkMemory::from_path(&evidence, &self.path)
    }
}

/// Whether a sighting is of a thing: labels name things, and of a model's words those that the lexicon has.
fn is_thing(sighting: &ObjectSighting) -> bool {
    sighting.by == LABELS_ANSWERER_NAME || find_thing(&sighting.name).is_some()
}
