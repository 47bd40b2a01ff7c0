//! What the agent remembers of its walk: a map of where it was, its last steps with their reasons, and its note.

use super::scene::Scene;
use serde::Serialize;
use std::collections::{BTreeMap, VecDeque};
use wayword_core::{DVec3, Heading, ViewpointId};

/// Places of the map that a prompt tells, the last ones. The others are only counted.
const MOST_PLACES: usize = 16;
/// Names of things of a place on the map.
const MOST_NAMES: usize = 6;

/// What the agent remembers.
pub(super) struct Memory {
    /// Where it began, and which way it looked.
    origin: (DVec3, Heading),
    /// In the order in which it first came to them.
    places: Vec<Place>,
    numbers: BTreeMap<ViewpointId, usize>,
    last: VecDeque<Hopped>,
    keep: usize,
    hops: usize,
    pub(super) note: Option<String>,
}

/// A place where it was.
struct Place {
    at: DVec3,
    seen: Option<String>,
    ways: Vec<ViewpointId>,
}

/// A step that it made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Hopped {
    number: usize,
    from: usize,
    to: usize,
    why: String,
}

impl Memory {
    /// Of a walk that begins at a place; `keep` steps are told again.
    pub(super) fn new(at: DVec3, heading: Heading, keep: usize) -> Self {
        let (places, numbers, last) = (Vec::new(), BTreeMap::new(), VecDeque::new());
        Self { origin: (at, heading), places, numbers, last, keep, hops: 0, note: None }
    }

    /// Comes to a place, for the first time or again. Returns its number, from 1.
    pub(super) fn reach(&mut self, id: &ViewpointId, at: DVec3, ways: Vec<ViewpointId>) -> usize {
        if let Some(number) = self.numbers.get(id) {
            return *number;
        }
        self.places.push(Place { at, seen: None, ways });
        self.numbers.insert(id.clone(), self.places.len());
        self.places.len()
    }

    /// The number of a place where it was.
    pub(super) fn number(&self, id: &ViewpointId) -> Option<usize> {
        self.numbers.get(id).copied()
    }

    /// Keeps in short what it saw at a place.
    pub(super) fn saw(&mut self, number: usize, scene: &Scene) {
        if let Some(place) = self.places.get_mut(number - 1) {
            let names: Vec<&str> = scene.names.iter().take(MOST_NAMES).map(String::as_str).collect();
            let room = scene.room.as_deref();
            let parts: Vec<&str> = room.into_iter().chain(names).collect();
            place.seen = Some(if parts.is_empty() { "nothing with a name".to_owned() } else { parts.join(", ") });
        }
    }

    /// Keeps a step.
    pub(super) fn hopped(&mut self, from: usize, to: usize, why: String) {
        self.hops += 1;
        self.last.push_back(Hopped { number: self.hops, from, to, why });
        while self.last.len() > self.keep {
            self.last.pop_front();
        }
    }

    /// The last steps, the oldest first.
    pub(super) fn last_steps(&self) -> impl Iterator<Item = &Hopped> {
        self.last.iter()
    }

    /// The last places of the map, a line each, and how many before them are left out.
    pub(super) fn map(&self) -> (Vec<String>, usize) {
        let from = self.places.len().saturating_sub(MOST_PLACES);
        (self.places.iter().enumerate().skip(from).map(|(at, place)| self.told(at + 1, place)).collect(), from)
    }

    /// A place, told by where it lies from the start, what was seen there, and where its ways lead.
    fn told(&self, number: usize, place: &Place) -> String {
        let (origin, heading) = self.origin;
        let off = place.at - origin;
        let (ahead, right) = (heading.direction(), heading.turned(std::f64::consts::FRAC_PI_2).direction());
        // Without minus zero.
        let [right_m, ahead_m, up_m] = [off.dot(right), off.dot(ahead), off.z].map(|m| (m * 10.0).round() / 10.0 + 0.0);
        let mut known: Vec<usize> = place.ways.iter().filter_map(|way| self.number(way)).collect();
        known.sort_unstable();
        let open = place.ways.len() - known.len();
        let open = (open > 0).then(|| format!("{open} new"));
        let ways: Vec<String> = known.iter().map(ToString::to_string).chain(open).collect();
        let ways = if ways.is_empty() { "nowhere".to_owned() } else { ways.join(", ") };
        let seen = place.seen.as_deref().unwrap_or("you did not look around");
        format!("place {number}: right {right_m:.1}, ahead {ahead_m:.1}, up {up_m:.1}; {seen}; ways to {ways}")
    }
}
