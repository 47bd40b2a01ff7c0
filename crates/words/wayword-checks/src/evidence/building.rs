//! The inventory of a building: its listed objects, sorted by name, and its viewpoints with their rooms.

use super::EndSurroundings;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, ObjectId, ObjectLabel, Path, ViewpointId, ViewpointSurvey, survey::SurveyedViewpoint};
use wayword_language::lexicon::{ThingClass, find_thing, kinds_of, room_name};

/// An object that no viewpoint lists belongs to the nearest viewpoint up to this far away, metres, or else to none.
const BESIDE_M: f64 = 4.0;

/// The listed objects and rooms of a building: made once from a survey, for all paths of the building.
#[derive(Debug, Clone, Default)]
pub struct BuildingInventory {
    /// The names of its objects, each once.
    pub(super) names: Vec<InventoryName>,
    /// The viewpoints.
    pub(super) viewpoints: Vec<InventoryViewpoint>,
    /// The index of each viewpoint in `viewpoints`.
    pub(super) places: BTreeMap<ViewpointId, usize>,
    /// The number of viewpoints that list at least one object.
    pub(super) listing_count: usize,
}

/// A viewpoint of the building.
#[derive(Debug, Clone)]
pub(super) struct InventoryViewpoint {
    /// The position of the eye, metres, world frame.
    pub(super) position: DVec3,
    /// The height of the floor below it, metres, where that is known.
    pub(super) floor_m: Option<f64>,
    /// The room in which it lies, as the platform names it.
    pub(super) room: Option<String>,
    /// The indices of the viewpoints one hop away.
    pub(super) neighbours: Vec<usize>,
}

/// A name that labels of the building have.
#[derive(Debug, Clone)]
pub(super) struct InventoryName {
    /// The kinds of thing that it means, the most specific first.
    pub(super) kinds: Vec<String>,
    /// Its class.
    pub(super) class: ThingClass,
    /// The objects of that name.
    pub(super) spots: Vec<InventoryObject>,
    /// The rooms of the viewpoints next to them.
    pub(super) homes: BTreeSet<String>,
}

/// An object.
#[derive(Debug, Clone)]
pub(super) struct InventoryObject {
    pub(super) position: DVec3,
    /// The viewpoints that list it, or else the nearest one.
    pub(super) beside: BTreeSet<usize>,
}

impl BuildingInventory {
    /// Sorts a survey. An object that several viewpoints list is one object.
    #[must_use]
    pub fn from_survey(survey: &ViewpointSurvey) -> Self {
        let mut spots: BTreeMap<&str, BTreeMap<&ObjectId, InventoryObject>> = BTreeMap::new();
        for (at, viewpoint) in survey.viewpoints().iter().enumerate() {
            for label in viewpoint.known.things.iter().flatten() {
                let objects = spots.entry(&label.name).or_default();
                let new = || InventoryObject { position: object_position(viewpoint, label), beside: BTreeSet::new() };
                objects.entry(&label.object).or_insert_with(new).beside.insert(at);
            }
        }
        for placed in survey.objects() {
            let new =
                || InventoryObject { position: placed.position, beside: nearest_viewpoint(survey, placed.position) };
            spots.entry(&placed.name).or_default().entry(&placed.object).or_insert_with(new);
        }
        let viewpoints = survey.viewpoints();
        let room = |at: &usize| viewpoints[*at].known.room.as_deref().map(|room| room_name(room).unwrap_or(room));
        let name = |(name, spots): (&str, BTreeMap<&ObjectId, InventoryObject>)| InventoryName {
            kinds: label_kinds(name),
            class: find_thing(name).map_or(ThingClass::Unknown, |thing| thing.class),
            homes: spots.values().flat_map(|spot| &spot.beside).filter_map(room).map(str::to_owned).collect(),
            spots: spots.into_values().collect(),
        };
        let lists =
            |viewpoint: &&SurveyedViewpoint| viewpoint.known.things.as_ref().is_some_and(|things| !things.is_empty());
        let viewpoint = |viewpoint: &SurveyedViewpoint| InventoryViewpoint {
            position: viewpoint.position,
            floor_m: viewpoint.floor_m,
            room: viewpoint.known.room.clone(),
            neighbours: viewpoint.neighbours.clone(),
        };
        Self {
            names: spots.into_iter().map(name).collect(),
            viewpoints: viewpoints.iter().map(viewpoint).collect(),
            places: viewpoints.iter().enumerate().map(|(at, viewpoint)| (viewpoint.id.clone(), at)).collect(),
            listing_count: viewpoints.iter().filter(lists).count(),
        }
    }

    /// Rooms and things around the end of a path that its frames need not show.
    #[must_use]
    pub fn beyond_end(&self, path: &Path) -> EndSurroundings {
        let last = path.frames.last().and_then(|frame| self.places.get(frame.viewpoint.as_ref()?));
        let Some(last) = last.copied() else { return EndSurroundings::default() };
        // From neighbour to neighbour, all viewpoints in the room at the end, and the rooms next to it.
        let (mut in_room, mut open, mut rooms) = (BTreeSet::from([last]), vec![last], BTreeSet::new());
        while let Some(at) = open.pop() {
            for other in &self.viewpoints[at].neighbours {
                let name = &self.viewpoints[*other].room;
                if *name != self.viewpoints[last].room {
                    rooms.extend(name.clone());
                } else if in_room.insert(*other) {
                    open.push(*other);
                }
            }
        }
        let is_there = |name: &&InventoryName| name.spots.iter().any(|spot| !spot.beside.is_disjoint(&in_room));
        let things = self.names.iter().filter(is_there).filter_map(|name| name.kinds.first().cloned());
        EndSurroundings { rooms: rooms.into_iter().collect(), things: things.collect() }
    }

    /// Whether the platform lists neither objects nor rooms in the building.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.names.is_empty() && self.viewpoints.iter().all(|viewpoint| viewpoint.room.is_none())
    }
}

/// The kinds of thing that a label may mean, the most specific first. Annotators' compounds also mean their first
/// words if these are of the same class: a "sofa chair" may be a sofa.
fn label_kinds(name: &str) -> Vec<String> {
    let mut meant = kinds_of(name);
    let Some(whole) = find_thing(name) else { return meant };
    let starts = name.match_indices(' ').map(|(at, _)| &name[..at]);
    let alike = starts.filter(|start| find_thing(start).is_some_and(|thing| thing.class == whole.class));
    for kind in alike.flat_map(kinds_of) {
        if !meant.contains(&kind) {
            meant.push(kind);
        }
    }
    meant
}

/// The position of an object: its own, or else as far from the eye as its label's distance, or else at the eye.
fn object_position(viewpoint: &SurveyedViewpoint, label: &ObjectLabel) -> DVec3 {
    let ray = || {
        let flat_m = label.distance_m? * libm::cos(label.elevation_rad);
        let rad = label.heading.rad();
        Some(viewpoint.position + DVec3::new(libm::sin(rad) * flat_m, libm::cos(rad) * flat_m, 0.0))
    };
    label.position.or_else(ray).unwrap_or(viewpoint.position)
}

/// The viewpoint nearest to an object that no viewpoint shows.
fn nearest_viewpoint(survey: &ViewpointSurvey, spot: DVec3) -> BTreeSet<usize> {
    let near = survey.viewpoints().iter().map(|viewpoint| viewpoint.position.distance(spot)).enumerate();
    let near = near.filter(|(_, distance_m)| *distance_m <= BESIDE_M).min_by(|a, b| a.1.total_cmp(&b.1));
    near.into_iter().map(|(at, _)| at).collect()
}
