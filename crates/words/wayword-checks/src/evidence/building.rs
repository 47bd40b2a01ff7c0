//! The inventory of a building: its listed objects, sorted by name, and its viewpoints with their rooms.

use super::Beyond;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, Label, ObjectId, Path, Survey, ViewpointId, survey::Surveyed};
use wayword_language::lexicon::{Class, kinds, room_name, thing};

/// An object belongs to the nearest viewpoint if that is no farther off, metres.
const BESIDE_M: f64 = 4.0;

/// The listed objects and rooms of a building: made once from a survey, for all paths of the building.
#[derive(Debug, Clone, Default)]
pub struct Building {
    /// The names of objects.
    pub(super) names: Vec<Name>,
    /// The viewpoints.
    pub(super) viewpoints: Vec<Viewpoint>,
    /// Their places in the list.
    pub(super) places: BTreeMap<ViewpointId, usize>,
    /// The number of viewpoints that list at least one object.
    pub(super) listing: usize,
}

/// A viewpoint of the building.
#[derive(Debug, Clone)]
pub(super) struct Viewpoint {
    pub(super) position: DVec3,
    pub(super) floor_m: Option<f64>,
    pub(super) room: Option<String>,
    pub(super) neighbours: Vec<usize>,
}

/// A name that labels of the building have.
#[derive(Debug, Clone)]
pub(super) struct Name {
    /// The kinds of thing that it means, the most specific first.
    pub(super) kinds: Vec<String>,
    /// Its class.
    pub(super) class: Class,
    /// The objects of that name.
    pub(super) spots: Vec<Spot>,
    /// The rooms of the viewpoints next to them.
    pub(super) homes: BTreeSet<String>,
}

/// An object.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    pub(super) position: DVec3,
    /// The viewpoints that list it, or else the nearest one.
    pub(super) beside: BTreeSet<usize>,
}

impl Building {
    /// Sorts a survey. An object that several viewpoints list is one object.
    #[must_use]
    pub fn of(survey: &Survey) -> Self {
        let mut spots: BTreeMap<&str, BTreeMap<&ObjectId, Spot>> = BTreeMap::new();
        for (at, viewpoint) in survey.viewpoints().iter().enumerate() {
            for label in viewpoint.known.things.iter().flatten() {
                let of_name = spots.entry(&label.name).or_default();
                let new = || Spot { position: position(viewpoint, label), beside: BTreeSet::new() };
                of_name.entry(&label.object).or_insert_with(new).beside.insert(at);
            }
        }
        for placed in survey.objects() {
            let new = || Spot { position: placed.position, beside: nearest(survey, placed.position) };
            spots.entry(&placed.name).or_default().entry(&placed.object).or_insert_with(new);
        }
        let viewpoints = survey.viewpoints();
        let room = |at: &usize| viewpoints[*at].known.room.as_deref().map(|room| room_name(room).unwrap_or(room));
        let name = |(name, spots): (&str, BTreeMap<&ObjectId, Spot>)| Name {
            kinds: meanings(name),
            class: thing(name).map_or(Class::Unknown, |thing| thing.class),
            homes: spots.values().flat_map(|spot| &spot.beside).filter_map(room).map(str::to_owned).collect(),
            spots: spots.into_values().collect(),
        };
        let lists = |viewpoint: &&Surveyed| viewpoint.known.things.as_ref().is_some_and(|things| !things.is_empty());
        let viewpoint = |viewpoint: &Surveyed| Viewpoint {
            position: viewpoint.position,
            floor_m: viewpoint.floor_m,
            room: viewpoint.known.room.clone(),
            neighbours: viewpoint.neighbours.clone(),
        };
        Self {
            names: spots.into_iter().map(name).collect(),
            viewpoints: viewpoints.iter().map(viewpoint).collect(),
            places: viewpoints.iter().enumerate().map(|(at, viewpoint)| (viewpoint.id.clone(), at)).collect(),
            listing: viewpoints.iter().filter(lists).count(),
        }
    }

    /// Rooms and things around the end of a path that its frames need not show.
    #[must_use]
    pub fn beyond(&self, path: &Path) -> Beyond {
        let last = path.frames.last().and_then(|frame| self.places.get(frame.viewpoint.as_ref()?));
        let Some(last) = last.copied() else { return Beyond::default() };
        let (mut room, mut open, mut rooms) = (BTreeSet::from([last]), vec![last], BTreeSet::new());
        while let Some(at) = open.pop() {
            for other in &self.viewpoints[at].neighbours {
                let name = &self.viewpoints[*other].room;
                if *name != self.viewpoints[last].room {
                    rooms.extend(name.clone());
                } else if room.insert(*other) {
                    open.push(*other);
                }
            }
        }
        let is_there = |name: &&Name| name.spots.iter().any(|spot| !spot.beside.is_disjoint(&room));
        let things = self.names.iter().filter(is_there).filter_map(|name| name.kinds.first().cloned());
        Beyond { rooms: rooms.into_iter().collect(), things: things.collect() }
    }

    /// Whether the platform lists neither objects nor rooms there.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.names.is_empty() && self.viewpoints.iter().all(|viewpoint| viewpoint.room.is_none())
    }
}

/// The kinds of thing that a label may mean, the most specific first. Annotators' compounds also mean their first
/// words if these are of the same class: a "sofa chair" may be a sofa.
fn meanings(name: &str) -> Vec<String> {
    let mut meant = kinds(name);
    let Some(whole) = thing(name) else { return meant };
    let starts = name.match_indices(' ').map(|(at, _)| &name[..at]);
    let alike = starts.filter(|start| thing(start).is_some_and(|thing| thing.class == whole.class));
    for kind in alike.flat_map(kinds) {
        if !meant.contains(&kind) {
            meant.push(kind);
        }
    }
    meant
}

/// The position of an object: its own, or else as far from the eye as its label's distance, or else at the eye.
fn position(viewpoint: &Surveyed, label: &Label) -> DVec3 {
    let ray = || {
        let flat_m = label.distance_m? * libm::cos(label.elevation_rad);
        let rad = label.heading.rad();
        Some(viewpoint.position + DVec3::new(libm::sin(rad) * flat_m, libm::cos(rad) * flat_m, 0.0))
    };
    label.position.or_else(ray).unwrap_or(viewpoint.position)
}

/// The viewpoint nearest to an object that no viewpoint shows.
fn nearest(survey: &Survey, spot: DVec3) -> BTreeSet<usize> {
    let near = survey.viewpoints().iter().map(|viewpoint| viewpoint.position.distance(spot)).enumerate();
    let near = near.filter(|(_, distance_m)| *distance_m <= BESIDE_M).min_by(|a, b| a.1.total_cmp(&b.1));
    near.into_iter().map(|(at, _)| at).collect()
}
