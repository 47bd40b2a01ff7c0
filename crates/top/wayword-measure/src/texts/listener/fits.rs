//! Which objects of a building a description fits, and what of it an object denies.

use super::{
    said::{How, InRoom, Landmark, Level, Rank, Relation, Said, Side},
    scene::Scene,
};
use std::{collections::BTreeSet, f64::consts::PI};
use wayword_core::{DVec3, Heading};

/// Objects that a text relates are this near to each other, metres.
const NEAR_M: f64 = 1.5;
/// Beyond this, the geometry denies it, metres.
const FAR_M: f64 = 3.0;
/// A room is near within this, metres.
const NEAR_ROOM_M: f64 = 3.0;
/// What is above is at least this much higher, metres.
const ABOVE_M: f64 = 0.15;
/// Things between two others are this near to the line, metres.
const BETWEEN_M: f64 = 0.8;
/// Angles within this of ahead are on neither side, radians.
const AHEAD_RAD: f64 = 0.26;
/// Directions and distances that differ by less than this do not deny a rank.
const SLACK_RAD: f64 = 0.15;
const SLACK_M: f64 = 0.5;
const SLACK_HEIGHT_M: f64 = 0.25;

/// Where the walk ends: the viewpoint, the way that one looks on arrival, and the levels of start and end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    pub(super) at: usize,
    pub(super) eye: DVec3,
    pub(super) heading: Heading,
    pub(super) start_level: Option<u32>,
    pub(super) top_level: Option<u32>,
}

/// A description held against a building.
pub(super) struct Listener<'a> {
    pub(super) scene: &'a Scene,
    pub(super) said: &'a Said,
    pub(super) arrival: Arrival,
}

impl Listener<'_> {
    /// The objects that fit all that is said.
    pub(super) fn fitting(&self) -> BTreeSet<usize> {
        let told = self.by_rank(self.placed());
        match self.said.side {
            None => told,
            Some(side) => self.on_side(&told, side),
        }
    }

    /// The objects that fit the name, the room and the level.
    pub(super) fn housed(&self) -> BTreeSet<usize> {
        let called = self.scene.called(&self.said.name);
        called.filter(|object| self.fits_level(*object) && self.fits_room(*object)).collect()
    }

    /// Those that fit the relations too.
    fn placed(&self) -> BTreeSet<usize> {
        let housed = self.housed();
        housed.iter().copied().filter(|object| self.relates(*object, &housed)).collect()
    }

    /// Whether the text names a thing of which the building lists none, or a relation that labels do not tell.
    pub(super) fn has_unknown(&self) -> bool {
        self.said.relations.iter().any(|relation| self.is_unknown(relation))
    }

    fn is_unknown(&self, relation: &Relation) -> bool {
        let lists = |landmark: &Landmark| !self.spots(landmark, None).is_empty();
        relation.how == How::Unknown || !relation.to.iter().all(lists)
    }

    fn fits_level(&self, object: usize) -> bool {
        let (Some(said), Some(level)) = (self.said.level, self.scene.objects[object].level) else { return true };
        let than_start = |fits: &dyn Fn(u32) -> bool| self.arrival.start_level.is_none_or(fits);
        match said {
            Level::Number(number) => level == number,
            Level::Up => than_start(&|start| level > start),
            Level::Down => than_start(&|start| level < start),
            Level::Same => than_start(&|start| level == start),
            Level::Top => self.arrival.top_level.is_none_or(|top| level == top),
        }
    }

    fn fits_room(&self, object: usize) -> bool {
        let Some(said) = &self.said.room else { return true };
        let kinds = if said.name.is_empty() { None } else { Some(self.scene.rooms_called(&said.name)) };
        let rooms = &self.scene.objects[object].rooms;
        rooms.iter().any(|room| kinds.as_ref().is_none_or(|kinds| kinds.contains(room)) && self.has(*room, said))
    }

    /// Whether a room has what is said of it. Things that the building lists nowhere are left out.
    fn has(&self, room: usize, said: &InRoom) -> bool {
        let has = |thing: &String| {
            let mut called = self.scene.called(thing).peekable();
            called.peek().is_none() || called.any(|object| self.scene.objects[object].rooms.contains(&room))
        };
        let beside = |name: &String| {
            let kinds = self.scene.rooms_called(name);
            kinds.is_empty() || !kinds.is_disjoint(&self.scene.rooms[room].beside)
        };
        said.things.iter().all(has) && said.beside.iter().all(beside)
    }

    /// Where the things of a name are, but for one object.
    fn spots(&self, landmark: &Landmark, but: Option<usize>) -> Vec<DVec3> {
        if landmark.is_room {
            let rooms = self.scene.rooms_called(&landmark.name).into_iter();
            return rooms
                .flat_map(|room| &self.scene.rooms[room].viewpoints)
                .map(|at| self.scene.viewpoints[*at])
                .collect();
        }
        let called = self.scene.called(&landmark.name).filter(|object| Some(*object) != but);
        called.map(|object| self.scene.objects[object].position).collect()
    }

    /// Whether all relations that labels can tell hold. A relation after the first may be one of the thing before it.
    fn relates(&self, object: usize, namesakes: &BTreeSet<usize>) -> bool {
        let mut holders = vec![object];
        for relation in self.said.relations.iter().filter(|relation| !self.is_unknown(relation)) {
            let holds = |holder: &usize| {
                let others = if *holder == object { namesakes.clone() } else { BTreeSet::new() };
                self.holds(*holder, relation, &others)
            };
            if !holders.iter().any(holds) {
                return false;
            }
            let place = self.scene.objects[object].position;
            let called = relation.to.iter().filter(|to| !to.is_room).flat_map(|to| self.scene.called(&to.name));
            holders.extend(called.filter(|other| self.scene.objects[*other].position.distance(place) <= NEAR_M));
        }
        true
    }

    fn holds(&self, object: usize, relation: &Relation, namesakes: &BTreeSet<usize>) -> bool {
        let place = self.scene.objects[object].position;
        let spots = self.spots(&relation.to[0], Some(object));
        let near_m = if relation.to[0].is_room { NEAR_ROOM_M } else { NEAR_M };
        let near = |spot: &DVec3| spot.distance(place) <= near_m;
        let flat = |spot: &DVec3| (*spot - place).truncate().length();
        match relation.how {
            How::Unknown => true,
            How::Near => spots.iter().any(near),
            How::Closest => {
                spots.iter().filter(|spot| near(spot)).any(|spot| self.is_nearest(object, *spot, namesakes, 0.0))
            }
            How::Farthest => self.is_farthest(object, &spots, namesakes, 0.0),
            How::Above => spots.iter().any(|spot| flat(spot) <= near_m && place.z - spot.z > ABOVE_M),
            How::Under => spots.iter().any(|spot| flat(spot) <= near_m && spot.z - place.z > ABOVE_M),
            How::On => spots.iter().any(|spot| flat(spot) <= near_m),
            How::LeftOf => spots.iter().any(|spot| near(spot) && self.turn_from(*spot, place) < 0.0),
            How::RightOf => spots.iter().any(|spot| near(spot) && self.turn_from(*spot, place) > 0.0),
            How::Between => {
                let others = relation.to.get(1).map(|to| self.spots(to, Some(object))).unwrap_or_default();
                spots.iter().any(|a| others.iter().any(|b| is_between(place, *a, *b, BETWEEN_M)))
            }
        }
    }

    /// Namesakes in a room with an object.
    fn rivals<'s>(&'s self, object: usize, namesakes: &'s BTreeSet<usize>) -> impl Iterator<Item = DVec3> + 's {
        let rooms = &self.scene.objects[object].rooms;
        let in_room = move |other: &&usize| **other != object && !self.scene.objects[**other].rooms.is_disjoint(rooms);
        namesakes.iter().filter(in_room).map(|other| self.scene.objects[*other].position)
    }

    fn is_nearest(&self, object: usize, spot: DVec3, namesakes: &BTreeSet<usize>, slack_m: f64) -> bool {
        let own_m = self.scene.objects[object].position.distance(spot);
        self.rivals(object, namesakes).all(|other| other.distance(spot) > own_m - slack_m)
    }

    fn is_farthest(&self, object: usize, spots: &[DVec3], namesakes: &BTreeSet<usize>, slack_m: f64) -> bool {
        let off = |place: DVec3| spots.iter().map(|spot| spot.distance(place)).fold(f64::INFINITY, f64::min);
        let own_m = off(self.scene.objects[object].position);
        self.rivals(object, namesakes).all(|other| off(other) < own_m + slack_m)
    }

    /// How far one turns from one spot to another at the end of the walk, positive right.
    fn turn_from(&self, spot: DVec3, to: DVec3) -> f64 {
        let towards = |place| Heading::towards(self.arrival.eye, place);
        towards(spot).zip(towards(to)).map_or(0.0, |(from, to)| from.turn_to(to))
    }

    /// How far an object is turned from the way that one looks on arrival, positive right.
    fn turn(&self, object: usize) -> f64 {
        let towards = Heading::towards(self.arrival.eye, self.scene.objects[object].position);
        towards.map_or(0.0, |towards| self.arrival.heading.turn_to(towards))
    }

    fn is_in_view(&self, object: usize) -> bool {
        self.scene.objects[object].seen_from.contains(&self.arrival.at)
    }

    /// The objects of a name that one sees at the end, but for one.
    pub(super) fn namesakes_in_view(&self, target: usize) -> BTreeSet<usize> {
        let kinds = &self.scene.objects[target].kinds;
        let alike = |other: &usize| *other != target && self.scene.objects[*other].is_called(kinds);
        (0..self.scene.objects.len()).filter(alike).filter(|other| self.is_in_view(*other)).collect()
    }

    /// The objects on a side. "On the left" may mean the leftmost of several.
    fn on_side(&self, objects: &BTreeSet<usize>, side: Side) -> BTreeSet<usize> {
        let on = |object: &usize| {
            let turn = self.turn(*object) * if side.is_left { -1.0 } else { 1.0 };
            self.is_in_view(*object) && (AHEAD_RAD..PI - AHEAD_RAD).contains(&turn)
        };
        let there: BTreeSet<usize> = objects.iter().copied().filter(on).collect();
        if side.is_yours || there.len() == 1 {
            return there;
        }
        let seen: BTreeSet<usize> = objects.iter().copied().filter(|object| self.is_in_view(*object)).collect();
        let rank = if side.is_left { Rank::Leftmost } else { Rank::Rightmost };
        seen.iter().copied().filter(|object| self.has_rank(*object, rank, &seen, false)).collect()
    }

    fn by_rank(&self, objects: BTreeSet<usize>) -> BTreeSet<usize> {
        if self.said.ranks.is_empty() {
            return objects;
        }
        let seen: BTreeSet<usize> = objects.into_iter().filter(|object| self.is_in_view(*object)).collect();
        let has_all = |object: &usize| self.said.ranks.iter().all(|rank| self.has_rank(*object, *rank, &seen, false));
        seen.iter().copied().filter(has_all).collect()
    }

    /// Whether an object has a rank among others; with slack, unless it clearly has not.
    fn has_rank(&self, object: usize, rank: Rank, among: &BTreeSet<usize>, slack: bool) -> bool {
        let slack_of = |amount: f64| if slack { amount } else { 0.0 };
        let middle = self.middle(among);
        let bearing = |object: usize| middle.turn_to(self.heading_to(object));
        let range_m = |object: usize| (self.scene.objects[object].position - self.arrival.eye).length();
        let height_m = |object: usize| self.scene.objects[object].position.z;
        let first = |value: &dyn Fn(usize) -> f64, slack: f64| {
            among.iter().filter(|other| **other != object).all(|other| value(*other) > value(object) - slack)
        };
        let mut in_order: Vec<usize> = among.iter().copied().collect();
        in_order.sort_by(|a, b| bearing(*a).total_cmp(&bearing(*b)));
        let at = in_order.iter().position(|other| *other == object).unwrap_or(usize::MAX);
        match rank {
            Rank::Leftmost => first(&bearing, slack_of(SLACK_RAD)),
            Rank::Rightmost => first(&|other| -bearing(other), slack_of(SLACK_RAD)),
            Rank::Nearest => first(&range_m, slack_of(SLACK_M)),
            Rank::Farthest => first(&|other| -range_m(other), slack_of(SLACK_M)),
            Rank::Highest => first(&|other| -height_m(other), slack_of(SLACK_HEIGHT_M)),
            Rank::Lowest => first(&height_m, slack_of(SLACK_HEIGHT_M)),
            Rank::Middle => {
                let is_inner = at > 0 && at + 1 < in_order.len();
                if slack {
                    is_inner || in_order.len() < 3
                } else {
                    in_order.len() % 2 == 1 && in_order.len() > 1 && at == in_order.len() / 2
                }
            }
            Rank::FromLeft(number) => at == number || slack && at.abs_diff(number) <= 1,
            Rank::FromRight(number) => {
                at + number + 1 == in_order.len() || slack && (at + number + 1).abs_diff(in_order.len()) <= 1
            }
        }
    }

    fn heading_to(&self, object: usize) -> Heading {
        Heading::towards(self.arrival.eye, self.scene.objects[object].position).unwrap_or(self.arrival.heading)
    }

    /// The direction of the middle of some objects.
    fn middle(&self, objects: &BTreeSet<usize>) -> Heading {
        let sum =
            objects.iter().map(|object| self.heading_to(*object).direction()).fold(DVec3::ZERO, |sum, one| sum + one);
        Heading::towards(DVec3::ZERO, sum).unwrap_or(self.arrival.heading)
    }

    /// What of the description the geometry denies of an object, if anything.
    pub(super) fn denial(&self, object: usize) -> Option<&'static str> {
        if !self.fits_level(object) {
            return Some("level");
        }
        let room = self.said.room.as_ref().map(|room| room.name.as_str()).filter(|name| !name.is_empty());
        if room.is_some_and(|name| !self.scene.may_lie_in(object, name)) {
            return Some("room");
        }
        let alike: BTreeSet<usize> = self.scene.called(&self.said.name).chain([object]).collect();
        let first = self.said.relations.first().filter(|relation| !self.is_unknown(relation));
        if first.is_some_and(|relation| self.denies(object, relation, &alike)) {
            return Some("relation");
        }
        let seen: BTreeSet<usize> =
            self.placed().into_iter().chain([object]).filter(|one| self.is_in_view(*one)).collect();
        if !self.is_in_view(object) {
            return None;
        }
        if self.said.ranks.iter().any(|rank| !self.has_rank(object, *rank, &seen, true)) {
            return Some("rank");
        }
        let turn = |side: Side| self.turn(object) * if side.is_left { -1.0 } else { 1.0 };
        self.said
            .side
            .filter(|side| side.is_yours && turn(*side) < -AHEAD_RAD && turn(*side) > AHEAD_RAD - PI)
            .map(|_| "side")
    }

    fn denies(&self, object: usize, relation: &Relation, namesakes: &BTreeSet<usize>) -> bool {
        let place = self.scene.objects[object].position;
        let spots = self.spots(&relation.to[0], Some(object));
        let far_m = if relation.to[0].is_room { 2.0 * FAR_M } else { FAR_M };
        let near = |spot: &&DVec3| spot.distance(place) <= far_m;
        let mut there = spots.iter().filter(near).peekable();
        if there.peek().is_none() {
            return true;
        }
        match relation.how {
            How::Closest => !there.any(|spot| self.is_nearest(object, *spot, namesakes, SLACK_M)),
            How::Farthest => !self.is_farthest(object, &spots, namesakes, SLACK_M),
            How::Above => !there.any(|spot| place.z > spot.z - ABOVE_M),
            How::Under => !there.any(|spot| place.z < spot.z + ABOVE_M),
            How::LeftOf => !there.any(|spot| self.turn_from(*spot, place) < SLACK_RAD),
            How::RightOf => !there.any(|spot| self.turn_from(*spot, place) > -SLACK_RAD),
            How::Between => {
                let others = relation.to.get(1).map(|to| self.spots(to, Some(object))).unwrap_or_default();
                !there.any(|a| others.iter().any(|b| is_between(place, *a, *b, 2.0 * BETWEEN_M)))
            }
            How::Near | How::On | How::Unknown => false,
        }
    }
}

/// Whether a place lies near the line between two spots, and between them.
fn is_between(place: DVec3, a: DVec3, b: DVec3, off_m: f64) -> bool {
    let along = b - a;
    let share = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    (0.05..0.95).contains(&share) && along.length() <= 2.0 * FAR_M && (a + along * share).distance(place) <= off_m
}
