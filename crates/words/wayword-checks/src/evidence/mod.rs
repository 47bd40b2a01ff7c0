//! The evidence that a text about a path is checked against: rooms, objects and storeys frame by frame, and the moves
//! between frames.

mod building;
mod from_all_sources;
mod from_captions;
mod from_labels;
mod identity;
mod surroundings;
#[cfg(test)]
mod tests;

use from_captions::denies_name;
pub(crate) use identity::{SightingGroup, WalkEyes, group_sightings};

pub use building::BuildingInventory;
pub use surroundings::{ListedDistance, NEAR_M, PathSurroundings};

use wayword_core::{ClimbDirection, DVec3, ObjectId, Path, PathMotion, PathMove, motion};
use wayword_language::lexicon::{ThingClass, find_thing, is_fabric, names_agree, room_name, same_room};

/// Everything that is known of a path, frame by frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// One per frame of the path.
    pub frames: Vec<FrameEvidence>,
    /// The moves between them; none where the motion is unknown.
    pub moves: Vec<PathMove>,
    /// Whether the walker's motion is known. If not, `moves` is empty although the path may move.
    pub motion: PathMotion,
    /// The source of `frames`.
    pub source: EvidenceSource,
    /// Whether witnesses added what they saw to the labels ([`Evidence::add_witnesses`]).
    pub has_witnesses: bool,
    /// Rooms and things around the end that no frame has to show.
    pub beyond: EndSurroundings,
}

/// Rooms and things around the end of a path that its frames need not show. A text may use them to distinguish the
/// room.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EndSurroundings {
    /// The names of the rooms next to the one at the end.
    pub rooms: Vec<String>,
    /// The names of the things in the room at the end.
    pub things: Vec<String>,
}

/// The rooms, objects and storey that are known for one frame, all around.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameEvidence {
    /// The room, or the rooms where witnesses differ; empty where it is not known.
    pub rooms: Vec<String>,
    /// The objects that are seen from it.
    pub things: Vec<SeenThing>,
    /// Whether the objects are known. If not, an empty list of objects is no evidence of absence.
    pub knows_things: bool,
    /// Whether the witness listed all that it noticed. If it only described the view, a missing object means little.
    pub lists_things: bool,
    /// Rooms and objects that the witnesses were not sure of.
    pub perhaps: UnsureSightings,
    /// Names of objects that a witness declared absent.
    pub denied: Vec<String>,
    /// The storey, the lowest being 1.
    pub level: Option<u32>,
}

/// Guesses of witnesses. They make no text right, and none wrong.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UnsureSightings {
    /// Rooms: guesses of the frame's own room, and rooms that are seen through openings.
    pub rooms: Vec<String>,
    /// Objects.
    pub things: Vec<SeenThing>,
}

/// An object that is seen from a frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeenThing {
    /// Its name.
    pub name: String,
    /// Its id, where it comes from labels.
    pub object: Option<ObjectId>,
    /// Its colour, where that is known.
    pub colour: Option<String>,
    /// Its further colours.
    pub more_colours: Vec<String>,
    /// A colour that another witness gives it.
    pub disputed_colour: Option<String>,
    /// Its material, where a witness named it.
    pub material: Option<String>,
    /// Its pattern, or what it shows, where a witness named it.
    pub detail: Option<String>,
    /// Whether only a witness named it: the platform's labels lack it.
    pub is_unlisted: bool,
    /// Whether a witness named it, and a label lists it too.
    pub is_witnessed: bool,
    /// Whether a witness thought that it catches the eye.
    pub stands_out: bool,
    /// Its direction from the frame's heading, radians in (-π, π], positive right.
    pub turn_rad: Option<f64>,
    /// By how much the direction may be off to either side, radians: a witness names only a third of a view.
    pub turn_slack_rad: f64,
    /// Its distance from the eye, metres, where it is known: of a label to its centre, of a detector's find over the floor.
    pub distance_m: Option<f64>,
    /// Whether a witness who knows no distance called it far.
    pub is_far: bool,
    /// Whether a witness saw several of its kind there.
    pub several: bool,
    /// Its centre, metres, world frame, where it is known.
    pub position: Option<DVec3>,
    /// The room that it stands in, where that is known.
    pub room: Option<String>,
}

impl FrameEvidence {
    /// Whether its witness may have seen a thing of that name, without being sure.
    pub(crate) fn may_show(&self, name: &str) -> bool {
        self.perhaps.things.iter().any(|thing| names_agree(&thing.name, name))
    }
}

/// Whether a thing of that name is too conspicuous to be overlooked.
fn stands_out(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.salience >= 3)
}

/// Whether the centre of such a thing may be far from a walker that is near it.
pub(crate) fn is_wide(name: &str) -> bool {
    let class = find_thing(name).map_or(ThingClass::Unknown, |thing| thing.class);
    matches!(class, ThingClass::Stairs | ThingClass::Fabric | ThingClass::Floor | ThingClass::Unknown)
}

/// The source of evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EvidenceSource {
    /// The platform's ground truth.
    Labels,
    /// Captions of the views.
    Captions,
    /// The finds and misses of a detector.
    Detector,
    /// None: only the path itself is known.
    Nothing,
}

impl EvidenceSource {
    /// Its name in provenance and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Labels => "labels",
            Self::Captions => "captions",
            Self::Detector => "detector",
            Self::Nothing => "nothing",
        }
    }

    /// Whether its witnesses leave out many of the things that are there.
    #[must_use]
    pub fn leaves_out(self) -> bool {
        matches!(self, Self::Captions | Self::Detector)
    }
}

/// The lowest rise that counts as a step, metres.
const STEP_M: f64 = 0.1;

impl Evidence {
    fn from_frames(path: &Path, mut frames: Vec<FrameEvidence>, source: EvidenceSource) -> Self {
        for (evidence, frame) in frames.iter_mut().zip(&path.frames) {
            evidence.level = frame.level.filter(|_| path.motion.is_known());
        }
        Self {
            frames,
            moves: path.moves(),
            motion: path.motion,
            source,
            has_witnesses: false,
            beyond: EndSurroundings::default(),
        }
    }

    /// The name of its sources in provenance and on the screen.
    #[must_use]
    pub fn source_name(&self) -> &'static str {
        if self.has_witnesses { "labels, captions" } else { self.source.name() }
    }

    /// Evidence of a path without labels and captions: only turns and storeys can be checked.
    #[must_use]
    pub fn for_path_alone(path: &Path) -> Self {
        Self::from_frames(path, vec![FrameEvidence::default(); path.frames.len()], EvidenceSource::Nothing)
    }

    /// Whether the path goes from one place to another. If not, it cannot decide what a text says of a way.
    #[must_use]
    pub fn goes_anywhere(&self) -> bool {
        self.motion.goes_anywhere(&self.moves, self.frames.len())
    }

    /// For a thing that no frame shows: whether it is certainly nowhere along the path. That is so where the objects of
    /// every frame are known, and the witnesses could have named it. Captions leave things out, so there it must
    /// have been denied, or be too conspicuous to be missing in lists of every frame.
    #[must_use]
    pub fn denies_thing(&self, name: &str) -> bool {
        let overlooked = || !(stands_out(name) && self.frames.iter().all(|frame| frame.lists_things));
        self.is_named_nowhere(name) && (!self.source.leaves_out() || self.is_denied(name) || !overlooked())
    }

    /// For a thing that no frame shows: whether every frame's witnesses spoke and none of them named it, not even as a
    /// guess, although they could have.
    #[must_use]
    pub fn is_named_nowhere(&self, name: &str) -> bool {
        self.frames_without_things().is_empty() && self.could_name(name) && !self.may_show(name)
    }

    /// For a thing that the last frame does not show: whether it is certainly not seen from there, by the rules of
    /// [`Self::denies_thing`].
    #[must_use]
    pub fn denies_thing_at_end(&self, name: &str) -> bool {
        let Some(last) = self.frames.last().filter(|last| last.knows_things && self.could_name(name)) else {
            return false;
        };
        let listed = || last.lists_things && !self.may_show(name) && find_thing(name).is_some();
        let denied = || last.denied.iter().any(|denied| denies_name(denied, name));
        !last.may_show(name) && (!self.source.leaves_out() || denied() || listed())
    }

    /// Whether some witness may have seen a thing of that name, without being sure.
    #[must_use]
    pub fn may_show(&self, name: &str) -> bool {
        self.frames.iter().any(|frame| frame.may_show(name))
    }

    /// Whether some frame's witness denied a thing of that name.
    fn is_denied(&self, name: &str) -> bool {
        self.frames.iter().flat_map(|frame| &frame.denied).any(|denied| denies_name(denied, name))
    }

    /// Whether the witnesses could have named a thing of that name. Most leave out doors and walls: where they name
    /// none at all, that denies none.
    fn could_name(&self, name: &str) -> bool {
        let class = find_thing(name).map(|thing| thing.class);
        let is_left_out = is_fabric(name) || class == Some(ThingClass::Door);
        let mut things = self.frames.iter().flat_map(|frame| &frame.things);
        self.source != EvidenceSource::Nothing
            && (!is_left_out || things.any(|seen| find_thing(&seen.name).map(|thing| thing.class) == class))
    }

    /// For a room in which no frame lies: whether it is certainly nowhere along the path. That is so where the room of
    /// every frame is known. A basement or an attic is a storey, and its rooms have names of their own, so known rooms
    /// do not rule it out; only a path above the lowest storey rules out a basement.
    #[must_use]
    pub fn denies_room(&self, name: &str) -> bool {
        match room_name(name) {
            Some("basement") => self.frames.iter().all(|frame| frame.level.is_some_and(|level| level > 1)),
            Some("attic") => false,
            _ => {
                let is_perhaps = |room: &String| same_room(room, name);
                self.source != EvidenceSource::Nothing
                    && self.frames_without_room().is_empty()
                    && !self.frames.iter().flat_map(|frame| &frame.perhaps.rooms).any(is_perhaps)
            }
        }
    }

    /// The frames with unknown objects.
    #[must_use]
    pub fn frames_without_things(&self) -> Vec<usize> {
        self.frames_where(|frame| !frame.knows_things)
    }

    /// The frames with an unknown room.
    #[must_use]
    pub fn frames_without_room(&self) -> Vec<usize> {
        self.frames_where(|frame| frame.rooms.is_empty())
    }

    /// The frames from which something of that name is seen.
    #[must_use]
    pub fn frames_with_thing(&self, name: &str) -> Vec<usize> {
        self.frames_where(|frame| frame.things.iter().any(|thing| names_agree(&thing.name, name)))
    }

    /// The frames from which a witness may have seen something of that name, without being sure.
    #[must_use]
    pub fn frames_perhaps_with(&self, name: &str) -> Vec<usize> {
        self.frames_where(|frame| frame.may_show(name))
    }

    /// The frames that lie in a room of that name.
    #[must_use]
    pub fn frames_in_room(&self, name: &str) -> Vec<usize> {
        self.frames_where(|frame| frame.rooms.iter().any(|room| same_room(room, name)))
    }

    /// The frames for which something holds, ascending.
    fn frames_where(&self, holds: impl Fn(&FrameEvidence) -> bool) -> Vec<usize> {
        (0..self.frames.len()).filter(|at| holds(&self.frames[*at])).collect()
    }

    /// The frames at which a flight of stairs begins, up or down. Small rises add up.
    #[must_use]
    pub fn frames_with_climb(&self, climb: ClimbDirection) -> Vec<usize> {
        let climbs = |at: &usize| self.flight_from(*at, climb).is_some();
        (0..self.moves.len()).filter(climbs).collect()
    }

    /// Whether some move gains or loses the height of a step.
    #[must_use]
    pub fn has_steps(&self, climb: ClimbDirection) -> bool {
        let way = if climb == ClimbDirection::Down { -1.0 } else { 1.0 };
        self.moves.iter().any(|step| step.rise_m * way >= STEP_M)
    }

    /// The frames on a flight of stairs in either direction, with those at its foot and its head.
    #[must_use]
    pub fn frames_on_stairs(&self) -> Vec<usize> {
        let flights = [ClimbDirection::Up, ClimbDirection::Down].into_iter().flat_map(|climb| {
            self.frames_with_climb(climb).into_iter().filter_map(move |at| Some(at..=self.flight_from(at, climb)? + 1))
        });
        flights.flatten().collect()
    }

    /// The last move of the flight of stairs that begins at a move; `None` where it does not climb enough in that
    /// direction.
    fn flight_from(&self, first: usize, climb: ClimbDirection) -> Option<usize> {
        motion::flight_from(&self.moves, first).filter(|(_, way)| *way == climb).map(|(last, _)| last)
    }

    /// The things that are seen from the last frame.
    #[must_use]
    pub fn final_things(&self) -> &[SeenThing] {
        self.frames.last().map_or(&[], |frame| &frame.things)
    }
}
