//! What the agent remembers of its walk: a map of where it was, its last steps with their reasons, and its note.

use super::scene::Scene;
use serde::Serialize;
use std::collections::{BTreeMap, VecDeque};
use wayword_core::{DVec3, Heading, ViewpointId};

/// Places of the map that a prompt tells, the last ones. The others are only counted.
const MOST_PLACES: usize = 16;
/// Ends of ways not taken of a place on the map.
const MOST_NEW: usize = 8;
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
    /// The nodes that its ways lead to, and where these lie: both are known from the hops.
    ways: Vec<(ViewpointId, DVec3)>,
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
    pub(super) fn reach(&mut self, id: &ViewpointId, at: DVec3, ways: Vec<(ViewpointId, DVec3)>) -> usize {
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

    /// How far a direction is turned from the way that the agent looked at the start, radians, positive right.
    pub(super) fn turned(&self, heading: Heading) -> f64 {
        self.origin.1.turn_to(heading)
    }

    /// A place, told by where it lies from the start, what was seen there, and where its ways lead.
    fn told(&self, number: usize, place: &Place) -> String {
        let [right_m, ahead_m, up_m] = self.from_start(place.at);
        let (mut known, mut new) = (Vec::new(), Vec::new());
        for (way, end) in &place.ways {
            match self.number(way) {
                Some(number) => known.push(number),
                None => new.push(self.from_start(*end)),
            }
        }
        known.sort_unstable();
        let new = new.iter().take(MOST_NEW).map(|[right_m, ahead_m, _]| format!("new ({right_m:.1}, {ahead_m:.1})"));
        let ways: Vec<String> = known.iter().map(ToString::to_string).chain(new).collect();
        let ways = if ways.is_empty() { "nowhere".to_owned() } else { ways.join(", ") };
        let seen = place.seen.as_deref().unwrap_or("you did not look around");
        format!("place {number}: right {right_m:.1}, ahead {ahead_m:.1}, up {up_m:.1}; {seen}; ways to {ways}")
    }

    /// A point by its distance from the start to the right, ahead and up, as the agent looked there; metres, rounded.
    fn from_start(&self, point: DVec3) -> [f64; 3] {
        let (origin, heading) = self.origin;
        let off = point - origin;
        let (ahead, right) = (heading.direction(), heading.turned(std::f64::consts::FRAC_PI_2).direction());
        // Without minus zero.
        [off.dot(right), off.dot(ahead), off.z].map(|m| (m * 10.0).round() / 10.0 + 0.0)
    }
}
