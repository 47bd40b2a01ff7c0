//! A walk through the plan of a house: its places at equal distances, its turns, and the things along it.

use super::{
    plan::{HousePlan, PlanThing},
    word_lists::{LandmarkWord, SideWord},
};
use std::{collections::BTreeSet, ops::RangeInclusive};
use wayword_core::{DVec3, Frame, Heading};
use wayword_house::{EYE_M, model::RoomKind};

/// Distance along the walk between two spots, metres.
const SPOT_M: f64 = 0.25;
/// A longer walk is not looked at: no house is so large, metres.
const MAX_WALK_M: f64 = 500.0;
/// A change of direction counts from this angle on, degrees.
const MIN_BEND_DEG: f64 = 8.0;
/// Bends to one side make one turn if they are at most this far apart, metres.
const MAX_BEND_GAP_M: f64 = 0.9;
/// A thing is in sight up to this distance, metres.
pub(super) const SIGHT_M: f64 = 8.0;
/// A thing is passed if it comes this near, metres.
const PASS_M: f64 = 5.0;
/// A thing is passed where its distance grows by this much to both sides before it shrinks again, metres.
const PASS_DEPTH_M: f64 = 0.7;

/// A place on a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlannedSpot {
    /// The walker's feet, metres.
    pub(super) feet: DVec3,
    /// The direction of the walk.
    pub(super) heading: Heading,
    /// The room of the house, by its index.
    pub(super) room: Option<usize>,
}

/// A turn of a walk: one bend, or several to the same side close together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlanTurn {
    /// The spot of its first bend.
    pub(super) first: usize,
    /// The spot of its last bend.
    pub(super) last: usize,
    /// Its angle, degrees, positive to the right.
    pub(super) angle_deg: f64,
    /// The direction before it.
    pub(super) before: Heading,
}

/// A thing that comes into sight on a walk.
#[derive(Debug)]
pub(super) struct SightedThing<'p> {
    /// The thing.
    pub(super) thing: &'p PlanThing,
    /// Its distance from each spot, metres; infinite where it is not in sight.
    pub(super) sight_m: Vec<f64>,
}

/// A walk with everything that the plan tells about it.
#[derive(Debug)]
pub(super) struct PlannedWalk<'p> {
    /// The house.
    pub(super) plan: &'p HousePlan,
    /// Its places, from start to end, [`SPOT_M`] apart.
    pub(super) spots: Vec<PlannedSpot>,
    /// Its turns, in order.
    pub(super) turns: Vec<PlanTurn>,
    /// The things that come into sight.
    pub(super) things: Vec<SightedThing<'p>>,
}

/// A straight stretch of a walk.
struct PlanHop {
    /// The feet at its start, metres.
    from: DVec3,
    /// The feet at its end, metres.
    to: DVec3,
    /// Its direction.
    heading: Heading,
    /// Where on the walk it begins, metres.
    begins_m: f64,
    /// Its length, metres.
    length_m: f64,
}

/// A turn by its distance from the start of the walk.
struct MeasuredTurn {
    /// Where its first bend is, metres.
    first_m: f64,
    /// Where its last bend is, metres.
    last_m: f64,
    /// Its angle, degrees, positive to the right.
    angle_deg: f64,
    /// The direction before it.
    before: Heading,
}

/// How many spots make a distance along a walk, metres.
pub(super) fn count_spots(distance_m: f64) -> usize {
    (distance_m / SPOT_M).round() as usize
}

impl<'p> PlannedWalk<'p> {
    /// The walk along frames; `None` where there is no way between them, or its positions are not usable.
    pub(super) fn new(plan: &'p HousePlan, frames: &[Frame]) -> Option<Self> {
        let hops = list_hops(frames);
        let last = hops.last()?;
        let length_m = last.begins_m + last.length_m;
        if !(SPOT_M..=MAX_WALK_M).contains(&length_m) {
            return None;
        }
        let count = count_spots(length_m);
        let spots: Vec<PlannedSpot> = (0..=count)
            .filter_map(|number| {
                let at_m = length_m * number as f64 / count as f64;
                let hop = hops.iter().rfind(|hop| hop.begins_m <= at_m)?;
                let feet = hop.from.lerp(hop.to, ((at_m - hop.begins_m) / hop.length_m).clamp(0.0, 1.0));
                Some(PlannedSpot { feet, heading: hop.heading, room: plan.room_index(feet) })
            })
            .collect();
        let spot_at = |at_m: f64| (at_m / length_m * count as f64).round() as usize;
        let turns = measure_turns(frames.first()?.pose.heading, &hops).into_iter().map(|turn| PlanTurn {
            first: spot_at(turn.first_m),
            last: spot_at(turn.last_m),
            angle_deg: turn.angle_deg,
            before: turn.before,
        });
        let things = plan.things.iter().filter_map(|thing| sight_thing(plan, &spots, thing)).collect();
        Some(Self { plan, turns: turns.collect(), things, spots })
    }

    /// The number of the last spot.
    pub(super) fn last_spot(&self) -> usize {
        self.spots.len().saturating_sub(1)
    }

    /// The feet at the end, metres.
    pub(super) fn end(&self) -> DVec3 {
        self.spots.last().map_or(DVec3::ZERO, |spot| spot.feet)
    }

    /// Its length, metres.
    pub(super) fn length_m(&self) -> f64 {
        self.last_spot() as f64 * SPOT_M
    }

    /// How far its end lies above its start, metres.
    pub(super) fn rise_m(&self) -> f64 {
        self.spots.first().map_or(0.0, |first| self.end().z - first.feet.z)
    }

    /// The turns to a side of at least an angle, degrees.
    pub(super) fn list_turns_to(&self, side: SideWord, least_deg: f64) -> impl Iterator<Item = &PlanTurn> {
        self.turns.iter().filter(move |turn| side.has_sign(turn.angle_deg) && turn.angle_deg.abs() >= least_deg)
    }

    /// Whether there is a turn to a side of at least an angle, degrees, at any of these spots.
    pub(super) fn has_turn(&self, side: SideWord, least_deg: f64, spots: &RangeInclusive<usize>) -> bool {
        self.list_turns_to(side, least_deg).any(|turn| turn.first <= *spots.end() && turn.last >= *spots.start())
    }

    /// The spots at most a distance along the walk, metres, from any of `spots`.
    pub(super) fn widen(&self, spots: &BTreeSet<usize>, reach_m: f64) -> BTreeSet<usize> {
        let reach = count_spots(reach_m);
        let around = |spot: &usize| spot.saturating_sub(reach)..=(spot + reach).min(self.last_spot());
        spots.iter().flat_map(around).collect()
    }

    /// The things in sight that a word may mean.
    pub(super) fn list_things(&self, word: &LandmarkWord) -> impl Iterator<Item = &SightedThing<'p>> {
        self.things.iter().filter(move |sighted| word.can_mean(&sighted.thing.name))
    }

    /// The spots at which the walk passes a thing that a word may mean: nowhere near them is it closer.
    pub(super) fn find_passing_spots(&self, word: &LandmarkWord) -> BTreeSet<usize> {
        self.list_things(word).flat_map(|sighted| find_lowest_spots(&sighted.sight_m)).collect()
    }

    /// The spots from which a thing that a word may mean is in sight at most this far away, metres.
    pub(super) fn find_spots_near(&self, word: &LandmarkWord, reach_m: f64) -> BTreeSet<usize> {
        let near = |sighted: &SightedThing<'p>| {
            let spots = sighted.sight_m.iter().enumerate().filter(|(_, off_m)| **off_m <= reach_m);
            spots.map(|(spot, _)| spot).collect::<Vec<_>>()
        };
        self.list_things(word).flat_map(near).collect()
    }

    /// The stretches of the walk in rooms of a kind: first and last spot of each.
    pub(super) fn list_stretches(&self, kind: RoomKind) -> Vec<[usize; 2]> {
        let mut stretches: Vec<[usize; 2]> = Vec::new();
        let mut last_room = None;
        for (number, spot) in self.spots.iter().enumerate() {
            let room = spot.room.filter(|room| self.plan.room_kind(*room) == Some(kind));
            match stretches.last_mut() {
                Some(stretch) if room.is_some() && room == last_room => stretch[1] = number,
                _ if room.is_some() => stretches.push([number, number]),
                _ => {}
            }
            last_room = room;
        }
        stretches
    }
}

/// The straight stretches between frames.
fn list_hops(frames: &[Frame]) -> Vec<PlanHop> {
    let mut hops: Vec<PlanHop> = Vec::new();
    let mut begins_m = 0.0;
    for pair in frames.windows(2) {
        let [one, next] = pair else { continue };
        let [from, to] = [one, next].map(|frame| frame.pose.position - DVec3::Z * EYE_M);
        let length_m = from.distance(to);
        if length_m <= 0.0 {
            continue;
        }
        let before = hops.last().map_or(one.pose.heading, |hop| hop.heading);
        hops.push(PlanHop { from, to, heading: Heading::towards(from, to).unwrap_or(before), begins_m, length_m });
        begins_m += length_m;
    }
    hops
}

/// The turns between hops. Bends to one side that follow each other closely are one turn.
fn measure_turns(start: Heading, hops: &[PlanHop]) -> Vec<MeasuredTurn> {
    let mut turns: Vec<MeasuredTurn> = Vec::new();
    let mut before = start;
    for hop in hops {
        let angle_deg = before.turn_to(hop.heading).to_degrees();
        if angle_deg.abs() >= MIN_BEND_DEG {
            match turns.last_mut() {
                Some(turn) if turn.angle_deg * angle_deg > 0.0 && hop.begins_m - turn.last_m <= MAX_BEND_GAP_M => {
                    turn.angle_deg += angle_deg;
                    turn.last_m = hop.begins_m;
                }
                _ => turns.push(MeasuredTurn { first_m: hop.begins_m, last_m: hop.begins_m, angle_deg, before }),
            }
        }
        before = hop.heading;
    }
    turns
}

/// A thing with its distance from each spot; `None` where it is never in sight.
fn sight_thing<'p>(plan: &HousePlan, spots: &[PlannedSpot], thing: &'p PlanThing) -> Option<SightedThing<'p>> {
    let sight = |spot: &PlannedSpot| {
        let off_m = thing.distance_m(spot.feet);
        if off_m > SIGHT_M {
            return f64::INFINITY;
        }
        let corners = thing.corners_m(spot.feet.z);
        let middle = (corners[0] + corners[2]) / 2.0;
        let is_seen = spot.room == Some(thing.room)
            || [middle].into_iter().chain(corners).any(|place| plan.is_clear(spot.feet, place));
        if is_seen { off_m } else { f64::INFINITY }
    };
    let sight_m: Vec<f64> = spots.iter().map(sight).collect();
    sight_m.iter().any(|off_m| off_m.is_finite()).then_some(SightedThing { thing, sight_m })
}

/// The spots at which a thing is passed, by its distance from each spot.
fn find_lowest_spots(sight_m: &[f64]) -> Vec<usize> {
    let spots = sight_m.iter().enumerate().filter(|(spot, off_m)| {
        let before = sight_m.get(..*spot).unwrap_or_default().iter().rev();
        let after = sight_m.get(spot + 1..).unwrap_or_default().iter();
        **off_m <= PASS_M && grows_first(**off_m, before) && grows_first(**off_m, after)
    });
    spots.map(|(spot, _)| spot).collect()
}

/// Whether distances grow by [`PASS_DEPTH_M`] before one is smaller than the first. They may also end before that.
fn grows_first<'d>(first_m: f64, mut further_m: impl Iterator<Item = &'d f64>) -> bool {
    further_m.find(|off_m| **off_m < first_m || **off_m > first_m + PASS_DEPTH_M).is_none_or(|off_m| *off_m > first_m)
}

#[cfg(test)]
mod tests {
    use super::{
        super::test_plan::{east, frames_along, hallway_house, hallway_walk},
        *,
    };
    use wayword_core::{PathRequest, Platform};
    use wayword_house::{HousePlatform, generate_house};

    fn word(name: &str) -> &'static LandmarkWord {
        LandmarkWord::for_name(name).unwrap()
    }

    #[test]
    fn new_finds_the_turn_and_the_rooms_of_a_walk() {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        let [turn] = walk.turns.as_slice() else { panic!("{:?}", walk.turns) };
        assert!((turn.angle_deg + 90.0).abs() < 1e-6 && turn.before == east(), "{turn:?}");
        assert!((turn.first as f64 * SPOT_M - 8.0).abs() < SPOT_M && turn.first == turn.last, "{turn:?}");
        assert!(walk.has_turn(SideWord::Left, 40.0, &(30..=34)) && !walk.has_turn(SideWord::Left, 40.0, &(0..=30)));
        assert!(!walk.has_turn(SideWord::Right, 1.0, &(0..=99)) && !walk.has_turn(SideWord::Left, 91.0, &(0..=99)));
        assert!((walk.length_m() - 12.7).abs() < SPOT_M && walk.rise_m() == 0.0);
        let [[begin, end]] = walk.list_stretches(RoomKind::Bedroom)[..] else { panic!("one bedroom") };
        assert!((begin as f64 * SPOT_M - 9.2).abs() < 0.3 && end == walk.last_spot(), "{begin}");
        assert!(walk.list_stretches(RoomKind::Kitchen).is_empty());
    }

    #[test]
    fn new_refuses_frames_without_a_way() {
        let plan = HousePlan::new(hallway_house());
        for corners in [vec![], vec![[1.0, 1.0]], vec![[1.0, 1.0], [1.0, 1.0]], vec![[1.0, 1.0], [1e9, 1.0]]] {
            assert!(PlannedWalk::new(&plan, &frames_along(&corners)).is_none(), "{corners:?}");
        }
        assert!(PlannedWalk::new(&plan, &frames_along(&[[0.0, 0.0], [f64::NAN, 1.0]])).is_none());
    }

    #[test]
    fn bends_close_together_are_one_turn() {
        let plan = HousePlan::new(hallway_house());
        let near = PlannedWalk::new(&plan, &frames_along(&[[1.0, 0.5], [3.0, 0.5], [3.5, 1.0], [3.5, 1.9]])).unwrap();
        assert_eq!(near.turns.len(), 1, "{:?}", near.turns);
        assert!((near.turns[0].angle_deg + 90.0).abs() < 1e-6);
        let apart = PlannedWalk::new(&plan, &frames_along(&[[1.0, 0.3], [3.0, 0.3], [4.0, 1.3], [4.0, 1.9]])).unwrap();
        assert_eq!(apart.turns.len(), 2, "{:?}", apart.turns);
    }

    #[test]
    fn find_passing_spots_are_beside_the_thing_and_end_at_walls() {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        let plant = walk.find_passing_spots(word("plant"));
        assert!(!plant.is_empty() && plant.iter().all(|spot| (19..=21).contains(spot)), "{plant:?}");
        let bookshelf = walk.find_passing_spots(word("bookcase"));
        assert!(!bookshelf.is_empty() && bookshelf.iter().all(|spot| (4..=8).contains(spot)), "{bookshelf:?}");
        assert!(walk.find_passing_spots(word("piano")).is_empty());
    }

    #[test]
    fn find_spots_near_are_those_from_which_the_thing_is_in_sight() {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        let bed = walk.find_spots_near(word("bed"), SIGHT_M);
        assert!(bed.contains(&walk.last_spot()) && !bed.contains(&0), "{bed:?}");
        assert!(walk.find_spots_near(word("bed"), 0.1).is_empty());
    }

    #[test]
    fn widen_stays_on_the_walk() {
        let plan = HousePlan::new(hallway_house());
        let walk = PlannedWalk::new(&plan, &hallway_walk()).unwrap();
        let last = walk.last_spot();
        assert_eq!(walk.widen(&BTreeSet::from([0, last]), 0.25), BTreeSet::from([0, 1, last - 1, last]));
    }

    #[test]
    fn walks_of_generated_houses_stay_in_rooms_and_turn_as_their_frames_do() {
        let plan = HousePlan::new(generate_house(7));
        let (platform, scene) = (HousePlatform::default(), HousePlatform::scene_of(7).unwrap());
        for seed in 0..5 {
            let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
            let walk = PlannedWalk::new(&plan, &path.frames).unwrap();
            let indoors = walk.spots.iter().filter(|spot| spot.room.is_some()).count();
            assert!(indoors * 10 >= walk.spots.len() * 9, "{indoors} of {}", walk.spots.len());
            assert!((walk.length_m() - path.length_m().unwrap()).abs() < SPOT_M, "path {seed}");
            assert!(walk.turns.iter().all(|turn| turn.first <= turn.last && turn.last <= walk.last_spot()));
            assert!(!walk.things.is_empty());
        }
    }
}
