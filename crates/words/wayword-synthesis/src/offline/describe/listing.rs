//! The objects of a building by their labels: where each one is, in which room, and from where it is seen.

use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DMat3, DVec3, Frame, Heading, ObjectId, ObjectLabel, ViewpointId, ViewpointSurvey};
use wayword_language::lexicon::{ThingClass, find_thing, kinds_of, same_room};

/// Every object that the platform lists in a building, or around one frame.
#[derive(Debug, Clone, Default)]
pub struct BuildingListing {
    pub(super) objects: Vec<ListingObject>,
    /// The viewpoints, or the one frame.
    pub(super) places: Vec<ListingViewpoint>,
    pub(super) rooms: Vec<ListingRoom>,
    /// How many storeys there are.
    pub(super) storeys: usize,
    /// The number of each object in `objects`.
    by_id: BTreeMap<ObjectId, usize>,
    /// The number of each viewpoint in `places`.
    place_of: BTreeMap<ViewpointId, usize>,
    /// The number in `places` of the frame that was added, if it is no viewpoint of the building.
    added_place: Option<usize>,
    /// The numbers of the objects that a walker sees ahead before coming to that frame; `None` where that is not known.
    pictured: Option<BTreeSet<usize>>,
}

/// An object of the building.
#[derive(Debug, Clone)]
pub(super) struct ListingObject {
    pub(super) name: String,
    /// The kinds of thing that its name means, the most specific first: "dining chair", "chair".
    kinds: Vec<String>,
    pub(super) class: ThingClass,
    pub(super) salience: u8,
    pub(super) colour: Option<String>,
    /// The name of its room, where labels say it.
    pub(super) room_name: Option<String>,
    /// Its centre, metres, world frame.
    pub(super) position: Option<DVec3>,
    /// The numbers of the rooms in which it may be.
    pub(super) rooms: Vec<usize>,
    pub(super) level: Option<u32>,
}

/// A viewpoint with its room and the objects that are seen from it.
#[derive(Debug, Clone)]
pub(super) struct ListingViewpoint {
    /// Where the eye is, metres, world frame.
    pub(super) eye: DVec3,
    /// The number of its room.
    pub(super) room: usize,
    pub(super) level: Option<u32>,
    pub(super) sights: Vec<ListingSighting>,
}

/// An object as it is seen from a viewpoint.
#[derive(Debug, Clone, Copy)]
pub(super) struct ListingSighting {
    /// The number of the object.
    pub(super) object: usize,
    pub(super) heading: Heading,
    elevation_rad: f64,
    pub(super) distance_m: Option<f64>,
}

/// Connected viewpoints with the same room name and storey.
#[derive(Debug, Clone, Default)]
pub(super) struct ListingRoom {
    pub(super) name: Option<String>,
    /// Names of the neighbouring rooms.
    pub(super) beside: BTreeSet<String>,
    /// The objects that are certainly in it, by number.
    pub(super) things: Vec<usize>,
}

/// An object may be in the room of each viewpoint that is not farther from it than this many times the nearest one.
const ALSO_IN_ROOM_RATIO: f64 = 1.3;

impl ListingObject {
    /// Whether both could be called by the same name.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        other.kinds.contains(&self.kinds[0]) || self.kinds.contains(&other.kinds[0])
    }

    /// Its most specific kind.
    pub(super) fn kind(&self) -> &str {
        &self.kinds[0]
    }
}

impl BuildingListing {
    /// The listing of a whole building.
    #[must_use]
    pub fn from_survey(survey: &ViewpointSurvey) -> Self {
        let mut listing = Self::default();
        let room_of = number_rooms(survey);
        listing.rooms = vec![ListingRoom::default(); room_of.iter().max().map_or(0, |last| last + 1)];
        for (at, viewpoint) in survey.viewpoints().iter().enumerate() {
            let room = &mut listing.rooms[room_of[at]];
            room.name.clone_from(&viewpoint.known.room);
            let others = viewpoint.neighbours.iter().filter(|other| room_of[**other] != room_of[at]);
            room.beside.extend(others.filter_map(|other| survey.viewpoints()[*other].known.room.clone()));
            let labels = viewpoint.known.things.iter().flatten();
            listing.place_of.insert(viewpoint.id.clone(), at);
            listing.add_place(viewpoint.position, room_of[at], viewpoint.level, labels);
        }
        listing.locate_objects();
        listing
    }

    /// The listing with a frame that is no viewpoint of the building: in the nearest room of that name on its storey, or in a room of
    /// its own.
    #[must_use]
    pub fn with_frame<'a>(
        mut self,
        frame: &Frame,
        room: Option<&str>,
        labels: impl Iterator<Item = &'a ObjectLabel>,
    ) -> Self {
        let is_there = |place: &&ListingViewpoint| {
            let name = self.rooms[place.room].name.as_deref();
            place.level == frame.level && name.zip(room).is_some_and(|(name, room)| same_room(name, room))
        };
        let how_far = |place: &ListingViewpoint| place.eye.distance(frame.pose.position);
        let nearest = self.places.iter().filter(is_there).min_by(|a, b| how_far(a).total_cmp(&how_far(b)));
        let number = nearest.map_or(self.rooms.len(), |place| place.room);
        if number == self.rooms.len() {
            self.rooms.push(ListingRoom { name: room.map(str::to_owned), ..ListingRoom::default() });
        }
        self.added_place = Some(self.places.len());
        self.add_place(frame.pose.position, number, frame.level, labels);
        self.locate_objects();
        self
    }

    /// The listing with the labels of the pictures that a walker sees ahead before coming to the frame that was added. Where they show
    /// nothing, what a walker sees ahead is not known.
    #[must_use]
    pub fn with_pictured<'a>(mut self, labels: impl Iterator<Item = &'a ObjectLabel>) -> Self {
        let mut labels = labels.peekable();
        self.pictured =
            labels.peek().is_some().then(|| labels.filter_map(|label| self.object_index(&label.object)).collect());
        self
    }

    /// Whether a walker on the way sees an object ahead, as far as that is known.
    pub(super) fn is_pictured(&self, object: usize) -> bool {
        self.pictured.as_ref().is_none_or(|pictured| pictured.contains(&object))
    }

    pub(super) fn object_index(&self, id: &ObjectId) -> Option<usize> {
        self.by_id.get(id).copied()
    }

    /// The place of a frame: its viewpoint, or the frame that was added.
    pub(super) fn place_index(&self, frame: &Frame) -> Option<usize> {
        frame.viewpoint.as_ref().and_then(|id| self.place_of.get(id).copied()).or(self.added_place)
    }

    /// The room of the place nearest to a frame on its storey, by number.
    pub(super) fn room_near(&self, frame: &Frame) -> Option<usize> {
        let how_far = |place: &&ListingViewpoint| place.eye.distance(frame.pose.position);
        let places = self.places.iter().filter(|place| place.level == frame.level);
        places.min_by(|a, b| how_far(a).total_cmp(&how_far(b))).map(|place| place.room)
    }

    /// Whether the place of a frame is listed, with something in view.
    #[must_use]
    pub fn knows_frame(&self, frame: &Frame) -> bool {
        self.place_index(frame).is_some_and(|place| !self.places[place].sights.is_empty())
    }

    /// Adds a place, and the objects that its labels show.
    fn add_place<'a>(
        &mut self,
        eye: DVec3,
        room: usize,
        level: Option<u32>,
        labels: impl Iterator<Item = &'a ObjectLabel>,
    ) {
        let mut sights: Vec<ListingSighting> = Vec::new();
        // Labels come in the order of the views' headings. Sorting by object makes the result independent of the first
        // heading.
        let mut labels: Vec<&ObjectLabel> = labels.collect();
        labels.sort_by(|a, b| a.object.cmp(&b.object));
        for label in labels {
            let object = self.add_object(label);
            // Views of one panorama may show an object twice.
            if !sights.iter().any(|sight| sight.object == object) {
                let (heading, elevation_rad) = (label.heading, label.elevation_rad);
                sights.push(ListingSighting { object, heading, elevation_rad, distance_m: label.distance_m });
            }
        }
        self.places.push(ListingViewpoint { eye, room, level, sights });
    }

    /// The number of a label's object, which is added if it is new.
    fn add_object(&mut self, label: &ObjectLabel) -> usize {
        if let Some(at) = self.by_id.get(&label.object) {
            return *at;
        }
        let (class, salience) =
            find_thing(&label.name).map_or((ThingClass::Unknown, 0), |thing| (thing.class, thing.salience));
        self.objects.push(ListingObject {
            name: label.name.clone(),
            kinds: kinds_of(&label.name),
            class,
            salience,
            colour: label.colour.clone(),
            room_name: label.room.clone(),
            position: label.position,
            rooms: Vec::new(),
            level: None,
        });
        self.by_id.insert(label.object.clone(), self.objects.len() - 1);
        self.objects.len() - 1
    }

    /// Estimates the position of objects that have none, and assigns objects to rooms.
    fn locate_objects(&mut self) {
        let mut seen: Vec<Vec<(usize, ListingSighting)>> = vec![Vec::new(); self.objects.len()];
        for (at, place) in self.places.iter().enumerate() {
            place.sights.iter().for_each(|sight| seen[sight.object].push((at, *sight)));
        }
        let levels: BTreeSet<u32> = self.places.iter().filter_map(|place| place.level).collect();
        self.storeys = levels.len();
        self.rooms.iter_mut().for_each(|room| room.things.clear());
        for (object, seen) in seen.iter().enumerate() {
            let rays: Vec<(DVec3, DVec3)> = seen
                .iter()
                .map(|(at, sight)| (self.places[*at].eye, sight.heading.raised_vector(sight.elevation_rad)))
                .collect();
            let position = self.objects[object].position.or_else(|| meeting_point(&rays));
            let how_far = |at: usize| position.map_or(0.0, |position| self.places[at].eye.distance(position));
            // Where labels say in which room a thing is, it is not in the one from which a door shows it.
            let own_room = self.objects[object].room_name.as_deref();
            let is_there = |at: &usize| {
                let here = self.rooms[self.places[*at].room].name.as_deref();
                own_room.zip(here).is_none_or(|(own, here)| same_room(own, here))
            };
            let knows_room = seen.iter().any(|(at, _)| is_there(at));
            let seen = || seen.iter().map(|(at, _)| *at).filter(|at| !knows_room || is_there(at));
            let nearest = seen().min_by(|a, b| how_far(*a).total_cmp(&how_far(*b)));
            let Some(nearest) = nearest else { continue };
            let near = seen().filter(|at| how_far(*at) <= ALSO_IN_ROOM_RATIO * how_far(nearest));
            let rooms: BTreeSet<usize> = near.map(|at| self.places[at].room).collect();
            self.rooms[self.places[nearest].room].things.push(object);
            let level = self.places[nearest].level;
            let located = &mut self.objects[object];
            (located.position, located.level, located.rooms) = (position, level, rooms.into_iter().collect());
        }
    }
}

/// The point nearest to all rays (origin and direction, least squares); `None` unless at least two rays cross at a
/// clear angle, about 15 degrees or more.
fn meeting_point(rays: &[(DVec3, DVec3)]) -> Option<DVec3> {
    // The length is the sine of the angle.
    let crosses = |a: &DVec3, b: &DVec3| a.cross(*b).length() > 0.25;
    rays.iter().find(|(_, way)| crosses(way, &rays[0].1))?;
    let (mut matrix, mut vector) = (DMat3::ZERO, DVec3::ZERO);
    for (origin, way) in rays {
        let outer = DMat3::from_cols(*way * way.x, *way * way.y, *way * way.z);
        let part = DMat3::IDENTITY - outer;
        matrix += part;
        vector += part * *origin;
    }
    let point = matrix.inverse() * vector;
    // A point behind an eye is no meeting.
    let is_ahead = |(origin, way): &(DVec3, DVec3)| (point - *origin).dot(*way) > 0.0;
    (point.is_finite() && rays.iter().all(is_ahead)).then_some(point)
}

/// For each viewpoint, the number of its room: neighbours of one name and storey are in one room.
fn number_rooms(survey: &ViewpointSurvey) -> Vec<usize> {
    let viewpoints = survey.viewpoints();
    let is_same_room = |a: usize, b: usize| {
        let (a, b) = (&viewpoints[a], &viewpoints[b]);
        let names = (a.known.room.as_deref(), b.known.room.as_deref());
        a.level == b.level && matches!(names, (Some(a), Some(b)) if a == b)
    };
    let mut room_of = vec![usize::MAX; viewpoints.len()];
    let mut count = 0;
    for first in 0..viewpoints.len() {
        if room_of[first] != usize::MAX {
            continue;
        }
        let mut open = vec![first];
        room_of[first] = count;
        while let Some(at) = open.pop() {
            for other in &viewpoints[at].neighbours {
                if room_of[*other] == usize::MAX && is_same_room(at, *other) {
                    room_of[*other] = count;
                    open.push(*other);
                }
            }
        }
        count += 1;
    }
    room_of
}
