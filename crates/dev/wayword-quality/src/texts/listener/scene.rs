//! A building as a listener knows it: its objects with their positions, its rooms, and the objects in view of each viewpoint.

use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, ObjectId, ViewpointSurvey, survey::SurveyedViewpoint};
use wayword_language::lexicon::{kinds_of, normalise_name, room_name, same_room};

/// An object may lie in the room of the nearest viewpoint that shows it, and in those of viewpoints that are at most this much farther,
/// metres.
const AS_NEAR_M: f64 = 0.5;
/// Rooms with viewpoints this near to each other are neighbours, metres.
const BESIDE_M: f64 = 3.0;
/// The first guess of the distance between the eye and an object without a known position, metres.
const GUESS_M: f64 = 1.5;
/// How often the estimated position of an object is moved towards the rays from the eyes that see it.
const CROSSING_ROUNDS: usize = 60;

/// A building with its objects and rooms.
pub(super) struct ListenerScene {
    /// Its objects, each once.
    pub(super) objects: Vec<ListenerObject>,
    /// Its rooms.
    pub(super) rooms: Vec<ListenerRoom>,
    /// The positions of its viewpoints.
    pub(super) viewpoints: Vec<DVec3>,
    /// The room of each viewpoint.
    viewpoint_rooms: Vec<usize>,
    /// The names of the objects, in normal spelling.
    pub(super) names: BTreeSet<String>,
    /// The index of each viewpoint by its id.
    places: BTreeMap<String, usize>,
}

/// An object.
pub(super) struct ListenerObject {
    pub(super) id: ObjectId,
    /// The kinds of thing that its name means, the most specific first.
    pub(super) kinds: Vec<String>,
    /// The listed position, or else an estimate from the directions in which it is seen.
    pub(super) position: DVec3,
    /// The viewpoints that show it.
    pub(super) seen_from: BTreeSet<usize>,
    /// The rooms that it may lie in.
    pub(super) rooms: BTreeSet<usize>,
    /// The storey of the nearest viewpoint that shows it.
    pub(super) level: Option<u32>,
}

/// A room: viewpoints of one storey that are joined and have the same name for it.
pub(super) struct ListenerRoom {
    /// The name; empty where the survey has none.
    pub(super) name: String,
    /// The indices of its viewpoints.
    pub(super) viewpoints: Vec<usize>,
    /// The neighbouring rooms.
    pub(super) beside: BTreeSet<usize>,
}

/// A sighting of an object: the viewpoint, and the direction.
type SightingRay = (usize, DVec3);

impl ListenerScene {
    pub(super) fn from_survey(survey: &ViewpointSurvey) -> Self {
        let viewpoints: Vec<DVec3> = survey.viewpoints().iter().map(|viewpoint| viewpoint.position).collect();
        let (rooms, room_of) = join_rooms(survey);
        let mut rays: BTreeMap<&ObjectId, (&str, Option<DVec3>, Vec<SightingRay>)> = BTreeMap::new();
        for (at, viewpoint) in survey.viewpoints().iter().enumerate() {
            for label in viewpoint.known.things.iter().flatten() {
                let flat = label.heading.unit_vector() * libm::cos(label.elevation_rad);
                let ray = flat + DVec3::Z * libm::sin(label.elevation_rad);
                let entry = rays.entry(&label.object).or_insert((&label.name, label.position, Vec::new()));
                entry.2.push((at, ray));
            }
        }
        let object = |(id, (name, position, rays)): (&ObjectId, (&str, Option<DVec3>, Vec<SightingRay>))| {
            let position = position.unwrap_or_else(|| crossing_point(&viewpoints, &rays));
            let with_distance = |(at, _): &SightingRay| (viewpoints[*at].distance(position), *at);
            let mut near: Vec<(f64, usize)> = rays.iter().map(with_distance).collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            let as_near = near.iter().take_while(|(far_m, _)| *far_m <= near[0].0 + AS_NEAR_M);
            ListenerObject {
                id: id.clone(),
                kinds: kinds_of(name),
                position,
                seen_from: rays.iter().map(|(at, _)| *at).collect(),
                rooms: as_near.map(|(_, at)| room_of[*at]).collect(),
                level: near.first().and_then(|(_, at)| survey.viewpoints()[*at].level),
            }
        };
        let names = rays.values().map(|(name, ..)| normalise_name(name)).collect();
        let places =
            survey.viewpoints().iter().enumerate().map(|(at, viewpoint)| (viewpoint.id.to_string(), at)).collect();
        Self {
            objects: rays.into_iter().map(object).collect(),
            rooms,
            viewpoints,
            viewpoint_rooms: room_of,
            names,
            places,
        }
    }

    /// The index of a viewpoint.
    pub(super) fn viewpoint_index(&self, viewpoint: &str) -> Option<usize> {
        self.places.get(viewpoint).copied()
    }

    /// The objects that a name may mean.
    pub(super) fn objects_called<'s>(&'s self, name: &str) -> impl Iterator<Item = usize> + 's {
        let wanted = kinds_of(name);
        (0..self.objects.len()).filter(move |at| self.objects[*at].is_called(&wanted))
    }

    /// The rooms with a name, or else the rooms with a name that people use for the same kind of room.
    pub(super) fn rooms_called(&self, name: &str) -> BTreeSet<usize> {
        let all = |fits: &dyn Fn(&str) -> bool| -> BTreeSet<usize> {
            (0..self.rooms.len()).filter(|at| fits(&self.rooms[*at].name)).collect()
        };
        let exact = all(&|room| room_name(room).unwrap_or(room) == room_name(name).unwrap_or(name));
        if exact.is_empty() { all(&|room| same_room(room, name)) } else { exact }
    }

    /// Whether an object may lie in a room of that name, as people use the word.
    pub(super) fn may_lie_in(&self, object: usize, name: &str) -> bool {
        let object = &self.objects[object];
        let rooms = object.seen_from.iter().map(|at| self.viewpoint_rooms[*at]).chain(object.rooms.iter().copied());
        rooms.map(|at| &self.rooms[at].name).any(|room| same_room(room, name) || room.is_empty())
    }
}

impl ListenerObject {
    /// Whether a name with these kinds may mean this object.
    pub(super) fn is_called(&self, wanted: &[String]) -> bool {
        let first = |a: &[String], b: &[String]| a.first().is_some_and(|kind| b.contains(kind));
        first(wanted, &self.kinds) || first(&self.kinds, wanted)
    }
}

/// The rooms, and the room of each viewpoint. Neighbouring viewpoints without a room name form a room without a name.
fn join_rooms(survey: &ViewpointSurvey) -> (Vec<ListenerRoom>, Vec<usize>) {
    let all = survey.viewpoints();
    let key = |at: usize| (all[at].known.room.as_deref(), all[at].level);
    let (mut rooms, mut room_of): (Vec<ListenerRoom>, _) = (Vec::new(), vec![usize::MAX; all.len()]);
    for first in 0..all.len() {
        if room_of[first] != usize::MAX {
            continue;
        }
        let (mut inside, mut open) = (Vec::new(), vec![first]);
        room_of[first] = rooms.len();
        while let Some(at) = open.pop() {
            inside.push(at);
            for &next in &all[at].neighbours {
                if room_of[next] == usize::MAX && key(next) == key(first) {
                    room_of[next] = rooms.len();
                    open.push(next);
                }
            }
        }
        let name = all[first].known.room.clone().unwrap_or_default();
        rooms.push(ListenerRoom { name, viewpoints: inside, beside: BTreeSet::new() });
    }
    for at in 0..all.len() {
        let near = |other: &usize| is_beside(&all[at], &all[*other]) || all[at].neighbours.contains(other);
        let beside = (0..all.len()).filter(near).map(|other| room_of[other]).filter(|room| *room != room_of[at]);
        rooms[room_of[at]].beside.extend(beside);
    }
    (rooms, room_of)
}

fn is_beside(a: &SurveyedViewpoint, b: &SurveyedViewpoint) -> bool {
    a.level == b.level && a.position.distance(b.position) <= BESIDE_M
}

/// The point nearest to all rays, which is where the object is. It is found by repeatedly averaging the projections onto the rays.
fn crossing_point(eyes: &[DVec3], rays: &[SightingRay]) -> DVec3 {
    let count = rays.len().max(1) as f64;
    let mean = |points: &mut dyn Iterator<Item = DVec3>| points.fold(DVec3::ZERO, |sum, point| sum + point) / count;
    let mut point = mean(&mut rays.iter().map(|(at, ray)| eyes[*at] + *ray * GUESS_M));
    for _ in 0..CROSSING_ROUNDS {
        // The object is at least 0.3 m ahead of each eye.
        let onto = |(at, ray): &SightingRay| eyes[*at] + *ray * (point - eyes[*at]).dot(*ray).max(0.3);
        point = mean(&mut rays.iter().map(onto));
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_finds_the_point_where_the_rays_meet() {
        let eyes = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0)];
        let thing = DVec3::new(1.0, 1.5, 0.5);
        let rays: Vec<SightingRay> = (0..2).map(|at| (at, (thing - eyes[at]).normalize())).collect();
        assert!(crossing_point(&eyes, &rays).distance(thing) < 0.01);
        assert!((crossing_point(&eyes, &rays[..1]).length() - GUESS_M).abs() < 0.01);
    }
}
