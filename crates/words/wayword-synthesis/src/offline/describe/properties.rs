//! Properties of the target (room, colour, side, relations), each with the rivals that share it. In doubt a rival
//! counts as sharing a property, so a description never seems to fit fewer objects than it does.

use super::{
    approach_frames,
    listing::{BuildingListing, ListingObject, ListingRoom, ListingSighting, ListingViewpoint},
};
use std::collections::BTreeSet;
use wayword_core::{DVec3, Frame, Heading, ObjectDistinction, Pose, Side};
use wayword_language::lexicon::{ThingClass, room_name, same_room};

/// A property that the target has.
#[derive(Debug, Clone)]
pub(super) struct TargetProperty {
    /// The property as a description mentions it.
    pub(super) distinction: ObjectDistinction,
    /// For each rival, in the order of [`TargetContext::rivals`], whether the property fits it too.
    pub(super) fits: Vec<bool>,
    /// The cost of mentioning it, roughly its words.
    pub(super) cost: f64,
}

/// The target, the viewpoint at the end, and the rivals: all objects that could be called by the target's name.
pub(super) struct TargetContext<'a> {
    pub(super) listing: &'a BuildingListing,
    /// The viewpoint where the path ends.
    pub(super) place: &'a ListingViewpoint,
    /// The heading with which the walker arrives there.
    pub(super) heading: Heading,
    /// Whether the walk ends at a viewpoint, where a panorama shows what is all around.
    pub(super) has_panorama: bool,
    /// The rooms through which the walk leads, by number.
    passed_rooms: BTreeSet<usize>,
    /// The poses with which the walker comes near to the end, if there is no panorama.
    approach: Vec<Pose>,
    /// The number of the target in the listing.
    pub(super) target: usize,
    /// The numbers of the rivals in the listing.
    pub(super) rivals: Vec<usize>,
}

/// Greatest distance at which an object in the same room counts as visible, metres.
const IN_SIGHT_M: f64 = 8.0;
/// A thing on a wall counts as hanging if it is less than this far below the eye, metres.
const MAX_BELOW_EYE_M: f64 = 0.4;

impl<'a> TargetContext<'a> {
    /// `frames` are those of the path to the place; there is at least one.
    pub(super) fn new(
        listing: &'a BuildingListing,
        frames: &[Frame],
        place: &'a ListingViewpoint,
        target: usize,
    ) -> Self {
        let own = &listing.objects[target];
        let is_rival = |at: &usize| *at != target && listing.objects[*at].is_like(own);
        let rivals = (0..listing.objects.len()).filter(is_rival).collect();
        let heading = frames.last().map_or(Heading::NORTH, |last| last.pose.heading);
        let has_panorama = frames.last().is_some_and(|last| last.viewpoint.is_some());
        let approach = approach_frames(frames).map(|frame| frame.pose).collect();
        let passed_rooms = frames.iter().filter_map(|frame| listing.room_near(frame)).collect();
        Self { listing, place, heading, has_panorama, passed_rooms, approach, target, rivals }
    }

    pub(super) fn object_at(&self, at: usize) -> &'a ListingObject {
        &self.listing.objects[at]
    }

    /// The object as it is seen at the end; `None` if it is not seen there.
    pub(super) fn sight_of_object(&self, object: usize) -> Option<&'a ListingSighting> {
        self.place.sights.iter().find(|sight| sight.object == object)
    }

    /// Whether an object is seen at the end, in the room there.
    pub(super) fn is_seen_in_room(&self, object: usize) -> bool {
        self.sight_of_object(object).is_some() && self.object_at(object).rooms.contains(&self.place.room)
    }

    /// The direction of an object from the heading of arrival, radians, positive right, where it is seen at the end.
    pub(super) fn turn_rad(&self, object: usize) -> Option<f64> {
        Some(self.heading.turn_to(self.sight_of_object(object)?.heading))
    }

    /// The distance of an object that is seen at the end, metres.
    pub(super) fn distance_m(&self, object: usize) -> Option<f64> {
        let sight = self.sight_of_object(object)?;
        sight.distance_m.or_else(|| Some(self.object_at(object).position?.distance(self.place.eye)))
    }

    /// Whether the target is in the room where the path ends.
    pub(super) fn is_in_end_room(&self) -> bool {
        self.object_at(self.target).rooms.contains(&self.place.room)
    }

    /// The rivals that are in a room of the same kind; all of them, where the target's room is not the one at the end.
    pub(super) fn rivals_in_kind(&self) -> Vec<bool> {
        let own = self.listing.rooms[self.place.room].name.as_deref().filter(|_| self.is_in_end_room());
        let is_kind = |room: &usize| match (own, self.listing.rooms[*room].name.as_deref()) {
            (Some(own), Some(other)) => same_room(own, other),
            _ => true,
        };
        self.rivals.iter().map(|rival| self.object_at(*rival).rooms.iter().any(is_kind)).collect()
    }

    /// A property of the target. `fits` decides for the number of each rival whether the property fits it too.
    pub(super) fn new_property(
        &self,
        told: ObjectDistinction,
        cost: f64,
        fits: impl Fn(usize) -> bool,
    ) -> TargetProperty {
        TargetProperty { distinction: told, cost, fits: self.rivals.iter().map(|rival| fits(*rival)).collect() }
    }

    /// All properties of the target that do not depend on the rest of the description, as superlatives do.
    pub(super) fn all_properties(&self) -> Vec<TargetProperty> {
        let mut all = self.room_properties();
        let own = self.object_at(self.target);
        // "The white whiteboard".
        if let Some(colour) = own.colour.as_ref().filter(|colour| !own.name.contains(&***colour)) {
            let told = ObjectDistinction::Colour { colour: colour.clone() };
            all.push(self.new_property(told, 0.8, |rival| {
                self.object_at(rival)
                    .colour
                    .as_ref()
                    .is_none_or(|other| other.contains(&**colour) || colour.contains(&**other))
            }));
        }
        all.extend(self.side_property());
        all.extend(self.relation_properties());
        all
    }

    /// Whether the target certainly hangs on a wall: a picture or a mirror, high enough, with no object right below
    /// that could carry it.
    pub(super) fn target_hangs(&self) -> bool {
        let own = self.object_at(self.target);
        let Some(here) = own.position else { return false };
        let carries = |at: &ListingObject| {
            let Some(there) = at.position else { return false };
            // It carries the target if it is at most 0.7 m aside and 0.6 m lower.
            let aside = DVec3::new(there.x - here.x, there.y - here.y, 0.0).length();
            !matches!(at.class, ThingClass::WallArt | ThingClass::Glass | ThingClass::Light)
                && aside < 0.7
                && (-0.2..0.6).contains(&(here.z - there.z))
        };
        let is_high = here.z > self.place.eye.z - MAX_BELOW_EYE_M;
        matches!(own.class, ThingClass::WallArt | ThingClass::Glass)
            && own.kind() != "window"
            && is_high
            && !self.listing.objects.iter().any(carries)
    }

    /// Properties of the room where the path ends: its storey, a neighbouring room, a thing in it. None where the
    /// target is in another room.
    fn room_properties(&self) -> Vec<TargetProperty> {
        let (listing, own) = (self.listing, self.object_at(self.target));
        let mut all = Vec::new();
        if !self.is_in_end_room() {
            return all;
        }
        if let Some(level) = own.level.filter(|_| self.level_of_room().is_some()) {
            let told = ObjectDistinction::Level { level };
            all.push(
                self.new_property(told, 1.0, |rival| self.object_at(rival).level.is_none_or(|other| other == level)),
            );
        }
        let room = &listing.rooms[self.place.room];
        let Some(name) = room.name.as_deref() else { return all };
        // "The garage with the garage door" says nothing: a property has to tell the room from another of its kind.
        let is_kind = |other: &&ListingRoom| {
            !std::ptr::eq(*other, room) && other.name.as_deref().is_some_and(|other| same_room(other, name))
        };
        let alike: Vec<&ListingRoom> = listing.rooms.iter().filter(is_kind).collect();
        let others: BTreeSet<&String> = room.beside.iter().filter(|other| !same_room(other, name)).collect();
        // A walker knows the neighbouring room by having come through it.
        let is_known = |other: &str| {
            let mut passed = self.passed_rooms.iter().filter_map(|at| listing.rooms[*at].name.as_deref());
            self.has_panorama || passed.any(|passed| same_room(passed, other))
        };
        for other in others.into_iter().filter(|other| room_name(other).is_some() && is_known(other)) {
            let lies_by = |room: &ListingRoom| room.beside.iter().any(|beside| same_room(beside, other));
            if alike.iter().all(|room| lies_by(room)) {
                continue;
            }
            let is_beside = |at: &usize| lies_by(&listing.rooms[*at]);
            let told = ObjectDistinction::RoomBy { room: other.clone() };
            all.push(self.new_property(told, 2.0, |rival| self.object_at(rival).rooms.iter().any(is_beside)));
        }
        let mut told: Vec<&str> = Vec::new();
        let pictured = room.things.iter().filter(|at| listing.is_pictured(**at));
        for thing in pictured.map(|at| self.object_at(*at)) {
            let has_this_name = |name: &&str| **name == *thing.name;
            if thing.salience < 2
                || thing.class == ThingClass::Stairs
                || thing.is_like(own)
                || told.iter().any(has_this_name)
                || is_unclear(thing)
            {
                continue;
            }
            told.push(&thing.name);
            let holds = |room: &ListingRoom| room.things.iter().any(|other| self.object_at(*other).is_like(thing));
            if alike.iter().all(|room| holds(room)) {
                continue;
            }
            let has = |at: &usize| holds(&listing.rooms[*at]);
            let with = ObjectDistinction::RoomWith { thing: thing.name.clone() };
            all.push(self.new_property(with, 2.2, |rival| self.object_at(rival).rooms.iter().any(has)));
        }
        all
    }

    /// The storey of the target's room, where rooms of its kind lie on several.
    pub(super) fn level_of_room(&self) -> Option<u32> {
        let name = self.listing.rooms[self.place.room].name.as_deref().filter(|_| self.is_in_end_room())?;
        let level = self.place.level?;
        let is_alike = |place: &&ListingViewpoint| {
            self.listing.rooms[place.room].name.as_deref().is_some_and(|other| same_room(name, other))
        };
        let mut levels = self.listing.places.iter().filter(is_alike).filter_map(|place| place.level);
        levels.any(|other| other != level).then_some(level)
    }

    /// Whether another object of the target's name is in sight at the end, or in the same room.
    pub(super) fn has_rival_near(&self) -> bool {
        let is_near = |rival: &usize| {
            self.sight_of_object(*rival).is_some() || self.object_at(*rival).rooms.contains(&self.place.room)
        };
        self.rivals.iter().any(is_near)
    }

    /// "On the left" or "on the right", where the target is clearly to a side: 25 to 155 degrees from the heading.
    fn side_property(&self) -> Option<TargetProperty> {
        let (side, sign) = match self.bearing_deg(self.target)? {
            deg if (25.0..155.0).contains(&deg) => (Side::Right, 1.0),
            deg if (25.0..155.0).contains(&-deg) => (Side::Left, -1.0),
            _ => return None,
        };
        if self.approach.iter().any(|pose| self.lies_opposite(pose, sign)) {
            return None;
        }
        // "On the left" describes the view on arrival.
        let may_be = |rival: usize| self.bearing_deg(rival).is_some_and(|deg| (5.0..175.0).contains(&(deg * sign)));
        Some(self.new_property(ObjectDistinction::OnSide { side }, 3.4, may_be))
    }

    /// Whether a walker on the way to the end sees the target ahead on the other side.
    fn lies_opposite(&self, pose: &Pose, sign: f64) -> bool {
        let towards = self.object_at(self.target).position.and_then(|there| Heading::towards(pose.position, there));
        let deg = towards.map(|towards| pose.heading.turn_to(towards).to_degrees() * sign);
        deg.is_some_and(|deg| (-60.0..-5.0).contains(&deg))
    }

    /// Whether no rival is farther to the target's side.
    pub(super) fn is_outermost(&self) -> bool {
        let Some(own) = self.bearing_deg(self.target) else { return false };
        let others = self.rivals.iter().filter_map(|rival| self.bearing_deg(*rival));
        others.map(|deg| deg * own.signum()).all(|deg| deg <= own.abs() + 1.0)
    }

    /// The direction of an object from the heading of arrival, degrees, positive right. Labels may omit distant objects
    /// of the same room or of one with its name, so their position is used where it is known.
    fn bearing_deg(&self, at: usize) -> Option<f64> {
        let here = || {
            let (object, name) = (self.object_at(at), self.listing.rooms[self.place.room].name.as_ref());
            let is_here = |room: &usize| *room == self.place.room || self.listing.rooms[*room].name.as_ref() == name;
            let there = object
                .position
                .filter(|there| object.rooms.iter().any(is_here) && there.distance(self.place.eye) <= IN_SIGHT_M)?;
            Some(self.heading.turn_to(Heading::towards(self.place.eye, there)?))
        };
        self.turn_rad(at).or_else(here).map(f64::to_degrees)
    }
}

/// Whether an object is too vague to find another one by: parts of the building, and names that the lexicon lacks.
pub(super) fn is_unclear(thing: &ListingObject) -> bool {
    matches!(thing.class, ThingClass::Fabric | ThingClass::Unknown | ThingClass::Structure)
        && !matches!(thing.kind(), "window" | "fireplace" | "column" | "railing")
}
