//! Distances from a path to everything that its building lists. An open world uses them to judge how much a missing
//! label means.

use super::building::{BuildingInventory, InventoryName, InventoryObject};
use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    sync::Arc,
};
use wayword_core::{DVec3, Frame, Path};
use wayword_language::lexicon::{ThingClass, kinds_of, room_name, same_room};

/// A thing this near to the path can be seen by a person who walks it, metres.
pub const NEAR_M: f64 = 3.0;
/// Labels of objects on the eye's storey differ from its height by no more than this, metres.
const STOREY_SLACK_M: f64 = 1.9;
/// Beyond [`STOREY_SLACK_M`], a metre of height counts as this many metres along the floor.
const HEIGHT_WEIGHT: f64 = 3.0;

/// The listed objects and rooms around a path, with their distances.
#[derive(Debug, Clone)]
pub struct PathSurroundings {
    building: Arc<BuildingInventory>,
    /// The eyes along the path.
    eyes: Vec<DVec3>,
    /// The heights of the floor along the path, metres; empty where one of them is not known.
    floors_m: Vec<f64>,
    /// For each name of the building, in the order of its names, how far the nearest object of that name is.
    distances: Vec<ListedDistance>,
    /// The names of rooms in the building, each with the distance to the nearest viewpoint in such a room.
    rooms: Vec<(String, ListedDistance)>,
    /// The rooms within reach of the path.
    near_rooms: BTreeSet<String>,
    /// The rooms within reach of its end.
    end_rooms: BTreeSet<String>,
    /// Whether a viewpoint near the path has no room.
    has_gap: bool,
    /// How many objects are listed near the path.
    near_objects: usize,
    /// How many objects are listed near its end.
    end_objects: usize,
}

/// How far something is; infinite where the building lists none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ListedDistance {
    /// From the nearest point of the path, metres.
    pub path_m: f64,
    /// From the last frame of the path, metres.
    pub end_m: f64,
    /// Hops from the nearest viewpoint of the path to a viewpoint next to the thing.
    pub path_hops: usize,
    /// Hops from the last viewpoint of the path to a viewpoint next to the thing.
    pub end_hops: usize,
}

impl ListedDistance {
    /// Listed nowhere in the building.
    pub const NOWHERE: Self =
        Self { path_m: f64::INFINITY, end_m: f64::INFINITY, path_hops: usize::MAX, end_hops: usize::MAX };

    /// The lesser of both in each respect.
    #[must_use]
    pub fn nearer_of(self, other: Self) -> Self {
        Self {
            path_m: self.path_m.min(other.path_m),
            end_m: self.end_m.min(other.end_m),
            path_hops: self.path_hops.min(other.path_hops),
            end_hops: self.end_hops.min(other.end_hops),
        }
    }
}

impl PathSurroundings {
    /// The listed objects and rooms around a path. `None` where the path's motion is unknown or the building lists
    /// neither.
    #[must_use]
    pub fn around_path(building: &Arc<BuildingInventory>, path: &Path) -> Option<Self> {
        if !path.motion.is_known() || building.is_blank() || path.frames.is_empty() {
            return None;
        }
        let eyes: Vec<DVec3> = path.frames.iter().map(|frame| frame.pose.position).collect();
        let starts: Vec<usize> = path.frames.iter().filter_map(|frame| frame_viewpoint(building, frame)).collect();
        let floor_m = |frame: &Frame| building.viewpoints[*building.places.get(frame.viewpoint.as_ref()?)?].floor_m;
        let floors_m = path.frames.iter().map(floor_m).collect::<Option<_>>().unwrap_or_default();
        let path_hops = hops_from(building, &starts);
        let end_hops = hops_from(building, starts.last().map_or(&[], std::slice::from_ref));
        let to_spot = |spot: &InventoryObject| {
            let hops = |hops: &[usize]| spot.beside.iter().map(|at| hops[*at]).min().unwrap_or(usize::MAX);
            ListedDistance {
                path_hops: hops(&path_hops),
                end_hops: hops(&end_hops),
                ..path_distance(&eyes, spot.position)
            }
        };
        let nearest = |name: &InventoryName| {
            name.spots.iter().map(to_spot).fold(ListedDistance::NOWHERE, ListedDistance::nearer_of)
        };
        let distances: Vec<ListedDistance> = building.names.iter().map(nearest).collect();
        let mut rooms: BTreeMap<&str, ListedDistance> = BTreeMap::new();
        let mut has_gap = false;
        for (at, viewpoint) in building.viewpoints.iter().enumerate() {
            let to = path_distance(&eyes, viewpoint.position);
            let to = ListedDistance { path_hops: path_hops[at], end_hops: end_hops[at], ..to };
            match &viewpoint.room {
                Some(room) => {
                    let nearest = rooms.entry(room).or_insert(ListedDistance::NOWHERE);
                    *nearest = nearest.nearer_of(to);
                }
                None => has_gap |= to.path_m <= NEAR_M,
            }
        }
        let rooms_within = |distance_m: fn(&ListedDistance) -> f64| {
            let near = rooms.iter().filter(|(_, distance)| distance_m(distance) <= NEAR_M);
            near.map(|(name, _)| room_name(name).unwrap_or(name).to_owned()).collect::<BTreeSet<String>>()
        };
        let near_rooms = rooms_within(|distance| distance.path_m);
        let end_rooms = rooms_within(|distance| distance.end_m);
        let rooms = rooms.into_iter().map(|(room, distance)| (room.to_owned(), distance)).collect();
        let spots =
            || building.names.iter().flat_map(|name| &name.spots).map(|spot| path_distance(&eyes, spot.position));
        let near_objects = spots().filter(|distance| distance.path_m <= NEAR_M).count();
        let end_objects = spots().filter(|distance| distance.end_m <= NEAR_M).count();
        let building = Arc::clone(building);
        Some(Self {
            building,
            eyes,
            floors_m,
            distances,
            rooms,
            near_rooms,
            end_rooms,
            has_gap,
            near_objects,
            end_objects,
        })
    }

    /// How far the nearest thing is that a name may mean.
    #[must_use]
    pub fn thing_distance(&self, name: &str) -> ListedDistance {
        let wanted = kinds_of(name);
        let agreeing = self.building.names.iter().zip(&self.distances).filter(|(name, _)| name_agrees(name, &wanted));
        agreeing.map(|(_, distance)| *distance).fold(ListedDistance::NOWHERE, ListedDistance::nearer_of)
    }

    /// How far the nearest viewpoint is in a room that a name may mean.
    #[must_use]
    pub fn room_distance(&self, name: &str) -> ListedDistance {
        let meant = self.rooms.iter().filter(|(room, _)| same_room(room, name));
        meant.map(|(_, distance)| *distance).fold(ListedDistance::NOWHERE, ListedDistance::nearer_of)
    }

    /// Where the things are that a name may mean and that lie within some distance of the path.
    #[must_use]
    pub fn thing_spots(&self, name: &str, within_m: f64) -> Vec<DVec3> {
        let wanted = kinds_of(name);
        let agreeing = self.building.names.iter().filter(|name| name_agrees(name, &wanted));
        let spots = agreeing.flat_map(|name| name.spots.iter().map(|spot| spot.position));
        spots.filter(|spot| path_distance(&self.eyes, *spot).path_m <= within_m).collect()
    }

    /// Where the viewpoints are that lie in a room that a name may mean, within some distance of the path.
    #[must_use]
    pub fn room_spots(&self, name: &str, within_m: f64) -> Vec<DVec3> {
        let viewpoints = self.building.viewpoints.iter();
        let in_room = viewpoints.filter(|viewpoint| viewpoint.room.as_ref().is_some_and(|room| same_room(room, name)));
        let spots = in_room.map(|viewpoint| viewpoint.position);
        spots.filter(|spot| path_distance(&self.eyes, *spot).path_m <= within_m).collect()
    }

    /// The eyes along the path.
    #[must_use]
    pub fn eyes(&self) -> &[DVec3] {
        &self.eyes
    }

    /// The heights of the floor along the path, metres; empty where they are not known.
    #[must_use]
    pub fn floors_m(&self) -> &[f64] {
        &self.floors_m
    }

    /// Whether the path comes near a room of a kind that contains a thing of that name somewhere in this building.
    #[must_use]
    pub fn passes_home_of(&self, name: &str) -> bool {
        let wanted = kinds_of(name);
        let mut agreeing = self.building.names.iter().filter(|name| name_agrees(name, &wanted));
        agreeing.any(|name| !name.homes.is_disjoint(&self.near_rooms))
    }

    /// Whether an object of a class is listed near the path, or near its end.
    #[must_use]
    pub fn has_kin(&self, class: ThingClass, at_end: bool) -> bool {
        let mut of_class = self.building.names.iter().zip(&self.distances).filter(|(name, _)| name.class == class);
        of_class.any(|(_, distance)| if at_end { distance.end_m <= NEAR_M } else { distance.path_m <= NEAR_M })
    }

    /// How many things that a name may mean the building lists.
    #[must_use]
    pub fn count_things(&self, name: &str) -> usize {
        let wanted = kinds_of(name);
        self.building.names.iter().filter(|name| name_agrees(name, &wanted)).map(|name| name.spots.len()).sum()
    }

    /// The rooms within reach of the path, by their usual names.
    #[must_use]
    pub fn near_rooms(&self) -> &BTreeSet<String> {
        &self.near_rooms
    }

    /// The rooms within reach of the end of the path, by their usual names.
    #[must_use]
    pub fn end_rooms(&self) -> &BTreeSet<String> {
        &self.end_rooms
    }

    /// Whether a viewpoint within reach of the path lies in no known room.
    #[must_use]
    pub fn has_gap(&self) -> bool {
        self.has_gap
    }

    /// Whether the building's rooms are known at all.
    #[must_use]
    pub fn knows_rooms(&self) -> bool {
        !self.rooms.is_empty()
    }

    /// How many objects are listed near the path, per frame of it.
    #[must_use]
    pub fn objects_per_frame(&self) -> f64 {
        self.near_objects as f64 / self.eyes.len() as f64
    }

    /// How many objects are listed near the end of the path.
    #[must_use]
    pub fn objects_at_end(&self) -> usize {
        self.end_objects
    }

    /// How many viewpoints of the building list objects.
    #[must_use]
    pub fn listing_viewpoints(&self) -> usize {
        self.building.listing_count
    }
}

/// Whether a label can mean a thing of the kinds `wanted` (the most specific first): one of the two names is a more
/// general word for the other, or the same.
fn name_agrees(name: &InventoryName, wanted: &[String]) -> bool {
    wanted.contains(&name.kinds[0]) || wanted.first().is_some_and(|kind| name.kinds.contains(kind))
}

/// The viewpoint of a frame: its own, or else the nearest one.
fn frame_viewpoint(building: &BuildingInventory, frame: &Frame) -> Option<usize> {
    let own = frame.viewpoint.as_ref().and_then(|id| building.places.get(id)).copied();
    let off_m = |at: &usize| building.viewpoints[*at].position.distance(frame.pose.position);
    own.or_else(|| (0..building.viewpoints.len()).min_by(|a, b| off_m(a).total_cmp(&off_m(b))))
}

/// For each viewpoint, the hops to the nearest of `starts`; `usize::MAX` where no way leads there.
fn hops_from(building: &BuildingInventory, starts: &[usize]) -> Vec<usize> {
    let mut hops = vec![usize::MAX; building.viewpoints.len()];
    let mut queue: VecDeque<usize> = starts.iter().copied().collect();
    starts.iter().for_each(|at| hops[*at] = 0);
    while let Some(at) = queue.pop_front() {
        for next in &building.viewpoints[at].neighbours {
            if hops[*next] == usize::MAX {
                hops[*next] = hops[at] + 1;
                queue.push_back(*next);
            }
        }
    }
    hops
}

/// How far a spot is from the path between these eyes. Only height beyond that of one storey counts, and it counts
/// more.
fn path_distance(eyes: &[DVec3], spot: DVec3) -> ListedDistance {
    let to_eye = |eye: &DVec3| weighted_gap_m(spot - *eye);
    let to_hop = |hop: &[DVec3]| {
        let along = hop[1] - hop[0];
        let share = ((spot - hop[0]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        weighted_gap_m(spot - (hop[0] + along * share))
    };
    let end_m = eyes.last().map_or(f64::INFINITY, to_eye);
    ListedDistance { path_m: eyes.windows(2).map(to_hop).fold(end_m, f64::min), end_m, ..ListedDistance::NOWHERE }
}

/// The length of a gap, metres, with its height weighted as above.
fn weighted_gap_m(gap: DVec3) -> f64 {
    libm::hypot(gap.truncate().length(), (gap.z.abs() - STOREY_SLACK_M).max(0.0) * HEIGHT_WEIGHT)
}
