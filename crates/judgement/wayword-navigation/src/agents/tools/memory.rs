//! The agent's memory of its walk, which each prompt repeats: a map of the visited places, the last steps with their reasons, and
//! the agent's note. A language model has no memory between calls, so everything that it needs is here. All parts are bounded.

use super::observed_scene::ObservedScene;
use crate::one_line::shorten_line;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use wayword_core::{DVec3, Heading, ViewpointId};

/// Most places of the map in a prompt. Other places are only counted.
const MAX_MAP_PLACES: usize = 16;
/// Most characters of all places of the map in a prompt; two places are listed even if they are longer.
const MAX_MAP_CHARS: usize = 2_500;
/// Most ways that are listed for a place on the map. Other ways are only counted.
const MAX_WAYS_OF_PLACE: usize = 8;
/// Longest reason of a step in a later prompt, characters; a longer one is cut.
const MAX_REASON_CHARS: usize = 120;

/// The agent's memory of one walk.
pub(super) struct ToolWalkMemory {
    /// The position and the heading at the start.
    origin: (DVec3, Heading),
    /// The visited places, in the order of the first visits. A place's number is its index plus 1.
    places: Vec<RememberedPlace>,
    /// The number of each visited place.
    numbers: BTreeMap<ViewpointId, usize>,
    /// The numbers of the places along the walk; the last is the current place.
    trail: Vec<usize>,
    /// The last steps, at most `keep` of them, the oldest first.
    last: VecDeque<RememberedHop>,
    keep: usize,
    /// Number of all steps so far.
    hops: usize,
    /// The note that the model last wrote for its next calls.
    pub(super) note: Option<String>,
}

/// A visited place.
struct RememberedPlace {
    /// Its position, metres, world frame.
    at: DVec3,
    /// A summary of the things there; `None` if the agent did not look around.
    seen: Option<String>,
    /// The nodes that its ways lead to, and their positions. The agent could derive both from the lengths and angles of the hops.
    ways: Vec<(ViewpointId, DVec3)>,
}

/// A step of the walk, as prompts repeat it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct RememberedHop {
    /// The step's number in the walk, from 1.
    number: usize,
    /// The numbers of the places from and to which it leads.
    from: usize,
    to: usize,
    /// The model's reason; may be empty.
    why: String,
}

impl ToolWalkMemory {
    /// Begins with an empty memory at a position. Prompts repeat the last `keep` steps.
    pub(super) fn new(at: DVec3, heading: Heading, keep: usize) -> Self {
        let (places, numbers, last, trail) = (Vec::new(), BTreeMap::new(), VecDeque::new(), Vec::new());
        Self { origin: (at, heading), places, numbers, trail, last, keep, hops: 0, note: None }
    }

    /// Records the arrival at a place, for the first time or again. Returns its number, from 1.
    pub(super) fn reach_place(&mut self, id: &ViewpointId, at: DVec3, ways: Vec<(ViewpointId, DVec3)>) -> usize {
        let number = self.place_number(id).unwrap_or_else(|| {
            self.places.push(RememberedPlace { at, seen: None, ways });
            self.numbers.insert(id.clone(), self.places.len());
            self.places.len()
        });
        self.trail.push(number);
        number
    }

    /// The number of a place, if it was visited.
    pub(super) fn place_number(&self, id: &ViewpointId) -> Option<usize> {
        self.numbers.get(id).copied()
    }

    /// Stores the summary of a scene with its place.
    pub(super) fn remember_scene(&mut self, number: usize, scene: &ObservedScene) {
        if let Some(place) = self.places.get_mut(number - 1) {
            place.seen = Some(scene.brief.clone());
        }
    }

    /// Stores a step, and drops the oldest if there are too many.
    pub(super) fn remember_hop(&mut self, from: usize, to: usize, why: &str) {
        self.hops += 1;
        self.last.push_back(RememberedHop { number: self.hops, from, to, why: shorten_line(why, MAX_REASON_CHARS) });
        while self.last.len() > self.keep {
            self.last.pop_front();
        }
    }

    /// The last steps, the oldest first.
    pub(super) fn last_steps(&self) -> impl Iterator<Item = &RememberedHop> {
        self.last.iter()
    }

    /// The turn from the heading at the start to another heading, radians, positive right.
    pub(super) fn turn_from_start(&self, heading: Heading) -> f64 {
        self.origin.1.turn_to(heading)
    }

    /// The map: a line for each place, and how many places are left out. The current place and the start come first, then the
    /// places that were visited last; lines are in the order of the places' numbers.
    pub(super) fn map_lines(&self) -> (Vec<String>, usize) {
        let mut lines: BTreeMap<usize, String> = BTreeMap::new();
        let mut chars = 0;
        let mut seen = BTreeSet::new();
        let here = self.trail.last().copied();
        for number in here.into_iter().chain([1]).chain(self.trail.iter().rev().copied()) {
            let Some(place) = self.places.get(number - 1).filter(|_| seen.insert(number)) else { continue };
            let line = self.describe_place(number, place);
            chars += line.chars().count();
            if lines.len() == MAX_MAP_PLACES || (chars > MAX_MAP_CHARS && lines.len() >= 2) {
                break;
            }
            lines.insert(number, line);
        }
        let left_out = self.places.len() - lines.len();
        (lines.into_values().collect(), left_out)
    }

    /// The line of a place on the map: its position relative to the start, a summary of the things there, and where its ways lead.
    fn describe_place(&self, number: usize, place: &RememberedPlace) -> String {
        let [right_m, ahead_m, up_m] = self.off_start(place.at);
        let way = |(to, end): &(ViewpointId, DVec3)| match self.place_number(to) {
            Some(number) => number.to_string(),
            None => format!("new {}", self.format_spot(*end)),
        };
        // Ways to visited places come first.
        let mut ways: Vec<_> = place.ways.iter().collect();
        ways.sort_by_key(|(to, _)| self.place_number(to).unwrap_or(usize::MAX));
        let more = ways.len().saturating_sub(MAX_WAYS_OF_PLACE);
        let more = (more > 0).then(|| format!("{more} more"));
        let ways: Vec<String> = ways.into_iter().take(MAX_WAYS_OF_PLACE).map(way).chain(more).collect();
        let ways = if ways.is_empty() { "nowhere".to_owned() } else { ways.join(", ") };
        let seen = place.seen.as_deref().unwrap_or("you did not look around");
        format!("place {number}: right {right_m:.1}, ahead {ahead_m:.1}, up {up_m:.1}; {seen}; ways to {ways}")
    }

    /// A point of the map as "(1.2, -3.4)": metres to the right of the start, and metres ahead of it.
    pub(super) fn format_spot(&self, point: DVec3) -> String {
        let [right_m, ahead_m, _] = self.off_start(point);
        format!("({right_m:.1}, {ahead_m:.1})")
    }

    /// A point relative to the start: to the right, ahead and up, by the heading at the start; metres, rounded to 0.1.
    fn off_start(&self, point: DVec3) -> [f64; 3] {
        let (origin, heading) = self.origin;
        let off = point - origin;
        let (ahead, right) = (heading.unit_vector(), heading.turned_by(std::f64::consts::FRAC_PI_2).unit_vector());
        // Adding 0.0 turns minus zero into zero.
        [off.dot(right), off.dot(ahead), off.z].map(|m| (m * 10.0).round() / 10.0 + 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corridor that is walked to its end and back again.
    #[test]
    fn map_has_the_start_and_the_last_places_of_a_long_walk() {
        let id = |at: usize| ViewpointId::new(format!("v{at}")).unwrap();
        let at = |at: usize| DVec3::new(0.0, at as f64, 0.0);
        let mut memory = ToolWalkMemory::new(at(0), Heading::NORTH, 6);
        let ways = |number: usize| vec![(id(number + 1), at(number + 1))];
        for number in (0..200).chain((100..200).rev()) {
            memory.reach_place(&id(number), at(number), ways(number));
        }
        let (places, left_out) = memory.map_lines();
        assert_eq!(places.len() + left_out, 200);
        assert!(places.len() <= MAX_MAP_PLACES && places.len() > 10, "{}", places.len());
        assert!(places[0].starts_with("place 1: ") && places[1].starts_with("place 101: "), "{places:?}");
        assert!(places.iter().map(String::len).sum::<usize>() <= MAX_MAP_CHARS);
    }

    #[test]
    fn ways_that_are_left_out_are_counted() {
        let id = |at: usize| ViewpointId::new(format!("v{at}")).unwrap();
        let mut memory = ToolWalkMemory::new(DVec3::ZERO, Heading::NORTH, 6);
        memory.reach_place(&id(0), DVec3::ZERO, (1..31).map(|at| (id(at), DVec3::new(at as f64, 0.0, 0.0))).collect());
        memory.reach_place(&id(30), DVec3::new(30.0, 0.0, 0.0), vec![]);
        let (places, _) = memory.map_lines();
        assert!(places[0].contains("ways to 2, new (1.0, 0.0), ") && places[0].ends_with("22 more"), "{places:?}");
        assert!(places[1].ends_with("you did not look around; ways to nowhere"), "{places:?}");
    }
}
