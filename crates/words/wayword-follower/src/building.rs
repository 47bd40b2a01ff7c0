//! The follower's knowledge of a building: all of it from a survey, or the part that was seen on the way.

use crate::{
    building_parts::{BuildingThing, BuildingViewpoint},
    nearness::{PlaceNearness, PlaceQuery},
};
use std::{
    cmp::Reverse,
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{DVec3, ObjectLabel, ViewpointSurvey};
use wayword_language::lexicon::{find_thing, names_agree, normalise_name};

/// The known part of a building. Positions are metres, z up, in any one frame of reference.
#[derive(Debug, Default)]
pub struct KnownBuilding {
    pub(crate) viewpoints: Vec<BuildingViewpoint>,
    pub(crate) things: Vec<BuildingThing>,
    /// Number of storeys, where the platform knows them; else 0.
    pub(crate) levels: u32,
    /// The distances from named places that were computed so far.
    near: Mutex<BTreeMap<PlaceQuery, Arc<PlaceNearness>>>,
}

/// A place on a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPlace {
    /// The eye's position, metres.
    pub position: DVec3,
    /// The room, where it is known.
    pub room: Option<String>,
    /// The storey, the lowest being 1, where it is known.
    pub level: Option<u32>,
    /// The objects that are seen.
    pub things: Vec<PathThing>,
}

/// An object that is seen from a place on a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathThing {
    /// Its name.
    pub name: String,
    /// Its position, metres, where that is known.
    pub position: Option<DVec3>,
    /// Its direction, radians from +y clockwise, where that is known.
    pub direction_rad: Option<f64>,
}

impl PathThing {
    /// Where it lies, seen from an eye. If only its direction is known, it is assumed to be near.
    pub(crate) fn position_from(&self, eye: DVec3) -> DVec3 {
        let towards = |rad: f64| DVec3::new(libm::sin(rad), libm::cos(rad), 0.0) * NEARBY_M;
        self.position.unwrap_or_else(|| eye + self.direction_rad.map_or(DVec3::ZERO, towards))
    }
}

/// Assumed distance of an object that is seen from a path, metres.
const NEARBY_M: f64 = 1.5;
/// Shorter hops count as staying at the place, metres: some graphs have two viewpoints at one place.
const MIN_HOP_M: f64 = 0.3;
/// Things that are farther away do not count as seen, metres: the labels to which the weights were fitted reach this far.
const SEEN_WITHIN_M: f64 = 3.0;
/// The least slope (rise over run) of a hop that counts as stairs.
const STAIRS_SLOPE: f64 = 0.25;

impl KnownBuilding {
    /// The building of a survey. A viewpoint's number is its place in the survey.
    #[must_use]
    pub fn from_survey(survey: &ViewpointSurvey) -> Self {
        let mut building = Self::default();
        for viewpoint in survey.viewpoints() {
            let (room, neighbours) = (viewpoint.known.room.clone(), viewpoint.neighbours.clone());
            building.viewpoints.push(BuildingViewpoint {
                position: viewpoint.position,
                neighbours,
                room,
                level: viewpoint.level,
                is_known: true,
                climbs: [false; 2],
            });
        }
        let mut things: BTreeMap<&str, BuildingThing> = BTreeMap::new();
        for (at, viewpoint) in survey.viewpoints().iter().enumerate() {
            for label in viewpoint.known.things.iter().flatten() {
                let thing = things.entry(label.object.as_str()).or_insert_with(|| BuildingThing {
                    name: normalise_name(&label.name),
                    position: label.position.unwrap_or(viewpoint.position),
                    seen_from: Vec::new(),
                });
                if thing.seen_from.last() != Some(&at) && counts_as_seen(label) {
                    thing.seen_from.push(at);
                }
            }
        }
        building.things = things.into_values().collect();
        building.levels = survey.viewpoints().iter().filter_map(|viewpoint| viewpoint.level).max().unwrap_or(0);
        building.find_stairs();
        building
    }

    /// The building along a path, without the rest: a viewpoint for each of its frames, one after another.
    #[must_use]
    pub fn along_path(path: Vec<PathPlace>) -> Self {
        let mut building = Self::default();
        let last = path.len().saturating_sub(1);
        for (at, place) in path.into_iter().enumerate() {
            let neighbours = [at.checked_sub(1), (at < last).then_some(at + 1)];
            let neighbours = neighbours.into_iter().flatten().collect();
            for thing in place.things {
                let (name, position) = (normalise_name(&thing.name), thing.position_from(place.position));
                building.things.push(BuildingThing { name, position, seen_from: vec![at] });
            }
            let PathPlace { position, room, level, .. } = place;
            let viewpoint = BuildingViewpoint { position, neighbours, room, level, is_known: true, climbs: [false; 2] };
            building.viewpoints.push(viewpoint);
        }
        building.find_stairs();
        building
    }

    /// The same viewpoints and things, without the computed distances.
    pub(crate) fn copy_places(&self) -> Self {
        let (viewpoints, things) = (self.viewpoints.clone(), self.things.clone());
        Self { viewpoints, things, levels: self.levels, near: Mutex::default() }
    }

    /// Records at which viewpoints a way up or down begins.
    pub(crate) fn find_stairs(&mut self) {
        for at in 0..self.viewpoints.len() {
            let here = &self.viewpoints[at];
            let slope = |to: &usize| {
                let off = self.viewpoints[*to].position - here.position;
                off.z / libm::hypot(off.x, off.y).max(0.3)
            };
            let climbs = [
                here.neighbours.iter().any(|to| slope(to) > STAIRS_SLOPE),
                here.neighbours.iter().any(|to| slope(to) < -STAIRS_SLOPE),
            ];
            self.viewpoints[at].climbs = climbs;
        }
    }

    /// Discards the computed distances and finds the stairs anew, because the building has changed.
    pub(crate) fn forget_nearness(&mut self) {
        self.near.get_mut().unwrap_or_else(PoisonError::into_inner).clear();
        self.find_stairs();
    }

    /// Number of viewpoints.
    #[must_use]
    pub fn len(&self) -> usize {
        self.viewpoints.len()
    }

    /// Whether there is no viewpoint.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.viewpoints.is_empty()
    }

    /// The distance of each viewpoint from a named place. It is computed once for each name.
    pub(crate) fn find_nearness(&self, what: &PlaceQuery) -> Arc<PlaceNearness> {
        let mut near = self.near.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = near.get(what) {
            return Arc::clone(known);
        }
        let found = Arc::new(PlaceNearness::for_query(&self.viewpoints, &self.things, what));
        near.insert(what.clone(), Arc::clone(&found));
        found
    }

    /// A name that distinguishes a viewpoint from others: its room if none of the others lies in a room of that name,
    /// or else an object that is seen from there alone. `told` are names that the text gives already: a thing does not tell which of
    /// its own kind is meant.
    #[must_use]
    pub fn distinguishing_name(&self, viewpoint: usize, others: &[usize], told: &[&str]) -> Option<&str> {
        let is_new = |name: &&str| !told.iter().any(|told| names_agree(told, name));
        let room = |at: usize| self.viewpoints[at].room.as_deref();
        let own_room = room(viewpoint)
            .filter(is_new)
            .filter(|room_here| others.iter().all(|other| room(*other) != Some(*room_here)));
        let sees =
            |at: usize, name: &str| self.things.iter().any(|thing| thing.name == name && thing.seen_from.contains(&at));
        let here = self.things.iter().filter(|thing| thing.seen_from.contains(&viewpoint));
        own_room.or_else(|| {
            let names = here.map(|thing| thing.name.as_str()).filter(is_new);
            let mut unique: Vec<&str> = names.filter(|name| others.iter().all(|other| !sees(*other, name))).collect();
            unique.sort_by_key(|name| (Reverse(find_thing(name).map_or(0, |thing| thing.salience)), *name));
            unique.first().copied()
        })
    }

    /// The distance between two viewpoints, metres.
    #[must_use]
    pub fn distance_m(&self, a: usize, b: usize) -> f64 {
        self.hop_between(a, b).1
    }

    /// How many viewpoints lie in rooms of the name that a viewpoint's room has: 0 few (below 5 %), 1 some,
    /// 2 many (15 % and more).
    pub(crate) fn commonness_of_room(&self, viewpoint: usize) -> usize {
        let room = &self.viewpoints[viewpoint].room;
        let alike = self.viewpoints.iter().filter(|other| other.room == *room).count();
        let share = alike as f64 / self.len().max(1) as f64;
        usize::from(share >= 0.05) + usize::from(share >= 0.15)
    }

    /// The turns to the neighbours of a viewpoint for a walker that looks along `heading_rad`, radians, positive right.
    /// Neighbours at the same place are left out.
    pub(crate) fn turns_from(&self, viewpoint: usize, heading_rad: f64) -> Vec<f64> {
        let turn = |to: &usize| {
            let (bearing_rad, length_m) = self.hop_between(viewpoint, *to);
            bearing_rad.filter(|_| length_m > MIN_HOP_M).map(|rad| wrap_angle(rad - heading_rad))
        };
        self.viewpoints[viewpoint].neighbours.iter().filter_map(turn).collect()
    }

    /// The direction of a hop (radians from +y, clockwise; `None` straight up or down), and its length in space, metres.
    pub(crate) fn hop_between(&self, from: usize, to: usize) -> (Option<f64>, f64) {
        let off = self.viewpoints[to].position - self.viewpoints[from].position;
        (offset_bearing(off), off.length())
    }
}

/// Whether a label is near enough that its thing counts as seen. One without a distance is.
#[must_use]
pub fn counts_as_seen(label: &ObjectLabel) -> bool {
    label.distance_m.is_none_or(|far_m| far_m <= SEEN_WITHIN_M)
}

/// The direction of an offset, radians from +y clockwise; `None` straight up or down.
pub(crate) fn offset_bearing(off: DVec3) -> Option<f64> {
    (libm::hypot(off.x, off.y) > 1e-6).then(|| libm::atan2(off.x, off.y))
}

/// An angle in (-π, π].
pub(crate) fn wrap_angle(rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let rad = rad.rem_euclid(TAU);
    if rad > PI { rad - TAU } else { rad }
}

#[cfg(test)]
mod tests;
