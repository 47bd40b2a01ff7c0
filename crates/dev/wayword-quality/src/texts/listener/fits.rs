//! Finds the objects of a building that a description fits. Each statement narrows the set of objects; one that fits none is skipped.

use super::{
    scene::ListenerScene,
    target_description::{ArrivalSide, LevelMention, RelationLandmark, TargetDescription, TargetRelation},
    vocabulary::{NamesakeRank, RelationKind},
};
use std::{collections::BTreeSet, f64::consts::PI};
use wayword_core::{DVec3, Heading};

/// Objects that a text relates ("next to the lamp") are at most this far from each other, metres.
pub(super) const NEAR_M: f64 = 1.5;
/// The geometry denies a relation between objects that are farther from each other than this, metres.
pub(super) const FAR_M: f64 = 3.0;
/// A room is near an object up to this distance from one of its viewpoints, metres.
pub(super) const NEAR_ROOM_M: f64 = 3.0;
/// An object is above another if it is at least this much higher, metres.
pub(super) const ABOVE_M: f64 = 0.15;
/// A thing between two others is at most this far from the line between them, metres.
pub(super) const BETWEEN_M: f64 = 0.8;
/// A thing up to this far from straight ahead is on neither side, radians.
pub(super) const AHEAD_RAD: f64 = 0.26;
/// Two directions that differ by less than this do not deny a rank such as "the leftmost", radians.
pub(super) const SLACK_RAD: f64 = 0.15;
/// Two distances that differ by less than this do not deny a rank such as "the nearest", metres.
pub(super) const SLACK_M: f64 = 0.5;
/// Two heights that differ by less than this do not deny a rank such as "the highest", metres.
pub(super) const SLACK_HEIGHT_M: f64 = 0.25;

/// The end of a walk.
#[derive(Debug, Clone, Copy)]
pub(super) struct ListenerArrival {
    /// The index of the last viewpoint.
    pub(super) at: usize,
    /// The position of the eye.
    pub(super) eye: DVec3,
    /// The heading on arrival.
    pub(super) heading: Heading,
    /// The storey of the start, where it is known.
    pub(super) start_level: Option<u32>,
    /// The highest storey of the building, where storeys are known.
    pub(super) top_level: Option<u32>,
}

/// A listener at the end of a walk, who compares a description with the objects of a building.
pub(super) struct TargetListener<'a> {
    /// The building.
    pub(super) scene: &'a ListenerScene,
    /// The description that is compared.
    pub(super) described_target: &'a TargetDescription,
    pub(super) arrival: ListenerArrival,
}

/// The objects that still fit, and the number of statements that were skipped because no object fits them.
#[derive(Debug, Clone, Default)]
pub(super) struct RemainingObjects {
    pub(super) objects: BTreeSet<usize>,
    pub(super) left_out: usize,
}

impl RemainingObjects {
    /// Keeps the objects that a statement fits. Keeps all where it fits none, because labels cannot confirm the statement then.
    pub(super) fn narrow_by(self, fits: impl Fn(usize, &BTreeSet<usize>) -> bool) -> Self {
        let kept: BTreeSet<usize> =
            self.objects.iter().copied().filter(|object| fits(*object, &self.objects)).collect();
        if kept.is_empty() { Self { left_out: self.left_out + 1, ..self } } else { Self { objects: kept, ..self } }
    }
}

impl TargetListener<'_> {
    /// The objects that fit the whole description, as far as labels can confirm it.
    pub(super) fn fitting_objects(&self) -> RemainingObjects {
        let mut remaining = self.related_objects();
        if !self.described_target.ranks.is_empty() {
            let has_all = |object: usize, among: &BTreeSet<usize>| {
                let seen = among.iter().copied().filter(|object| self.is_in_view(*object)).collect();
                let mut ranks = self.described_target.ranks.iter();
                self.is_in_view(object) && ranks.all(|rank| self.has_rank(object, *rank, &seen, false))
            };
            remaining = remaining.narrow_by(has_all);
        }
        let Some(side) = self.described_target.side else { return remaining };
        remaining.narrow_by(|object, among| self.on_side(among, side).contains(&object))
    }

    /// The objects that fit the name, the level and the room.
    pub(super) fn objects_in_room(&self) -> RemainingObjects {
        let remaining =
            RemainingObjects { objects: self.scene.objects_called(&self.described_target.name).collect(), left_out: 0 };
        let remaining = remaining.narrow_by(|object, _| self.fits_level(object));
        let Some(described) = &self.described_target.room else { return remaining };
        let rooms = |object: usize| &self.scene.objects[object].rooms;
        let mut remaining = remaining;
        if !described.name.is_empty() {
            let kinds = self.scene.rooms_called(&described.name);
            remaining = remaining.narrow_by(|object, _| !rooms(object).is_disjoint(&kinds));
        }
        for thing in &described.things {
            remaining = remaining.narrow_by(|object, _| rooms(object).iter().any(|room| self.room_has(*room, thing)));
        }
        for name in &described.beside {
            let kinds = self.scene.rooms_called(name);
            let is_beside = |room: &usize| !kinds.is_disjoint(&self.scene.rooms[*room].beside);
            remaining = remaining.narrow_by(|object, _| rooms(object).iter().any(is_beside));
        }
        remaining
    }

    /// Whether a room has a thing.
    pub(super) fn room_has(&self, room: usize, thing: &str) -> bool {
        self.scene.objects_called(thing).any(|object| self.scene.objects[object].rooms.contains(&room))
    }

    /// The objects that fit the relations too. A relation after the first may belong to the thing before it: in "the vase on the table by
    /// the window" the table is by the window.
    pub(super) fn related_objects(&self) -> RemainingObjects {
        let mut remaining = self.objects_in_room();
        for at in 0..self.described_target.relations.len() {
            remaining = if self.is_unknown(&self.described_target.relations[at]) {
                RemainingObjects { left_out: remaining.left_out + 1, ..remaining }
            } else {
                remaining.narrow_by(|object, among| self.fits_relation(object, at, among))
            };
        }
        remaining
    }

    /// Whether an object has the relation number `at`, or a thing near it does that an earlier relation names.
    pub(super) fn fits_relation(&self, object: usize, at: usize, namesakes: &BTreeSet<usize>) -> bool {
        let relation = &self.described_target.relations[at];
        let place = self.scene.objects[object].position;
        let before =
            self.described_target.relations[..at].iter().flat_map(|relation| &relation.to).filter(|to| !to.is_room);
        let near = |other: &usize| self.scene.objects[*other].position.distance(place) <= NEAR_M;
        let mut holders = before.flat_map(|to| self.scene.objects_called(&to.name)).filter(near);
        self.relation_holds(object, relation, namesakes)
            || holders.any(|holder| self.relation_holds(holder, relation, &BTreeSet::new()))
    }

    /// Whether labels cannot judge a relation, or the building does not list one of its landmarks.
    pub(super) fn is_unknown(&self, relation: &TargetRelation) -> bool {
        let lists = |landmark: &RelationLandmark| !self.landmark_positions(landmark, None).is_empty();
        relation.how == RelationKind::Unknown || !relation.to.iter().all(lists)
    }

    /// Whether an object is on the storey of the description; true where one of the two is not known.
    pub(super) fn fits_level(&self, object: usize) -> bool {
        let (Some(mention), Some(level)) = (self.described_target.level, self.scene.objects[object].level) else {
            return true;
        };
        let than_start = |fits: &dyn Fn(u32) -> bool| self.arrival.start_level.is_none_or(fits);
        match mention {
            LevelMention::Number(number) => level == number,
            LevelMention::Up => than_start(&|start| level > start),
            LevelMention::Down => than_start(&|start| level < start),
            LevelMention::Same => than_start(&|start| level == start),
            LevelMention::Top => self.arrival.top_level.is_none_or(|top| level == top),
        }
    }

    /// The positions of a landmark's objects except one, or the viewpoints of its rooms.
    pub(super) fn landmark_positions(&self, landmark: &RelationLandmark, but: Option<usize>) -> Vec<DVec3> {
        if landmark.is_room {
            let rooms = self.scene.rooms_called(&landmark.name).into_iter();
            return rooms
                .flat_map(|room| &self.scene.rooms[room].viewpoints)
                .map(|at| self.scene.viewpoints[*at])
                .collect();
        }
        let called = self.scene.objects_called(&landmark.name).filter(|object| Some(*object) != but);
        called.map(|object| self.scene.objects[object].position).collect()
    }

    /// Whether an object has a relation to its landmarks, by the positions of both.
    pub(super) fn relation_holds(&self, object: usize, relation: &TargetRelation, namesakes: &BTreeSet<usize>) -> bool {
        let place = self.scene.objects[object].position;
        let spots = self.landmark_positions(&relation.to[0], Some(object));
        let near_m = if relation.to[0].is_room { NEAR_ROOM_M } else { NEAR_M };
        let near = |spot: &DVec3| spot.distance(place) <= near_m;
        let flat = |spot: &DVec3| (*spot - place).truncate().length();
        match relation.how {
            RelationKind::Unknown => true,
            RelationKind::Near => spots.iter().any(near),
            RelationKind::Closest => {
                spots.iter().filter(|spot| near(spot)).any(|spot| self.is_nearest(object, *spot, namesakes, 0.0))
            }
            RelationKind::Farthest => self.is_farthest(object, &spots, namesakes, 0.0),
            RelationKind::Above => spots.iter().any(|spot| flat(spot) <= near_m && place.z - spot.z > ABOVE_M),
            RelationKind::Under => spots.iter().any(|spot| flat(spot) <= near_m && spot.z - place.z > ABOVE_M),
            RelationKind::On => spots.iter().any(|spot| flat(spot) <= near_m),
            RelationKind::LeftOf => spots.iter().any(|spot| near(spot) && self.turn_from(*spot, place) < 0.0),
            RelationKind::RightOf => spots.iter().any(|spot| near(spot) && self.turn_from(*spot, place) > 0.0),
            RelationKind::Between => {
                let others = relation.to.get(1).map(|to| self.landmark_positions(to, Some(object))).unwrap_or_default();
                spots.iter().any(|a| others.iter().any(|b| is_between(place, *a, *b, BETWEEN_M)))
            }
        }
    }

    /// The positions of an object's namesakes in the same room.
    pub(super) fn rival_positions<'s>(
        &'s self,
        object: usize,
        namesakes: &'s BTreeSet<usize>,
    ) -> impl Iterator<Item = DVec3> + 's {
        let rooms = &self.scene.objects[object].rooms;
        let in_room = move |other: &&usize| **other != object && !self.scene.objects[**other].rooms.is_disjoint(rooms);
        namesakes.iter().filter(in_room).map(|other| self.scene.objects[*other].position)
    }

    /// Whether no rival is nearer to a spot, beyond `slack_m`.
    pub(super) fn is_nearest(&self, object: usize, spot: DVec3, namesakes: &BTreeSet<usize>, slack_m: f64) -> bool {
        let own_m = self.scene.objects[object].position.distance(spot);
        self.rival_positions(object, namesakes).all(|other| other.distance(spot) > own_m - slack_m)
    }

    /// Whether no rival is farther from the nearest of some spots, beyond `slack_m`.
    pub(super) fn is_farthest(
        &self,
        object: usize,
        spots: &[DVec3],
        namesakes: &BTreeSet<usize>,
        slack_m: f64,
    ) -> bool {
        let off = |place: DVec3| spots.iter().map(|spot| spot.distance(place)).fold(f64::INFINITY, f64::min);
        let own_m = off(self.scene.objects[object].position);
        self.rival_positions(object, namesakes).all(|other| off(other) < own_m + slack_m)
    }

    /// The turn from one spot to another, seen from the end of the walk, radians, positive to the right.
    pub(super) fn turn_from(&self, spot: DVec3, to: DVec3) -> f64 {
        let towards = |place| Heading::towards(self.arrival.eye, place);
        towards(spot).zip(towards(to)).map_or(0.0, |(from, to)| from.turn_to(to))
    }

    /// The turn from the heading on arrival to an object, radians, positive to the right.
    pub(super) fn turn_to_object(&self, object: usize) -> f64 {
        let towards = Heading::towards(self.arrival.eye, self.scene.objects[object].position);
        towards.map_or(0.0, |towards| self.arrival.heading.turn_to(towards))
    }

    /// Whether an object is in view from the end of the walk.
    pub(super) fn is_in_view(&self, object: usize) -> bool {
        self.scene.objects[object].seen_from.contains(&self.arrival.at)
    }

    /// The other objects in view at the end that have a name in common with the target.
    pub(super) fn namesakes_in_view(&self, target: usize) -> BTreeSet<usize> {
        let kinds = &self.scene.objects[target].kinds;
        let alike = |other: &usize| *other != target && self.scene.objects[*other].is_called(kinds);
        (0..self.scene.objects.len()).filter(alike).filter(|other| self.is_in_view(*other)).collect()
    }

    /// The objects on a side. "On the left" may mean the leftmost of several.
    pub(super) fn on_side(&self, objects: &BTreeSet<usize>, side: ArrivalSide) -> BTreeSet<usize> {
        let is_on_side = |object: &usize| {
            let turn = self.turn_to_object(*object) * if side.is_left { -1.0 } else { 1.0 };
            self.is_in_view(*object) && (AHEAD_RAD..PI - AHEAD_RAD).contains(&turn)
        };
        let there: BTreeSet<usize> = objects.iter().copied().filter(is_on_side).collect();
        if side.is_yours || there.len() == 1 {
            return there;
        }
        let seen: BTreeSet<usize> = objects.iter().copied().filter(|object| self.is_in_view(*object)).collect();
        let rank = if side.is_left { NamesakeRank::Leftmost } else { NamesakeRank::Rightmost };
        seen.iter().copied().filter(|object| self.has_rank(*object, rank, &seen, false)).collect()
    }

    /// Whether an object has a rank among others. With `slack` only a clear violation counts.
    pub(super) fn has_rank(&self, object: usize, rank: NamesakeRank, among: &BTreeSet<usize>, slack: bool) -> bool {
        let slack_of = |amount: f64| if slack { amount } else { 0.0 };
        let middle = self.middle_heading(among);
        let bearing = |object: usize| middle.turn_to(self.heading_to(object));
        let range_m = |object: usize| (self.scene.objects[object].position - self.arrival.eye).length();
        let height_m = |object: usize| self.scene.objects[object].position.z;
        // Whether the object has the least value among the others.
        let first = |value: &dyn Fn(usize) -> f64, slack: f64| {
            among.iter().filter(|other| **other != object).all(|other| value(*other) > value(object) - slack)
        };
        let mut in_order: Vec<usize> = among.iter().copied().collect();
        in_order.sort_by(|a, b| bearing(*a).total_cmp(&bearing(*b)));
        let at = in_order.iter().position(|other| *other == object).unwrap_or(usize::MAX);
        match rank {
            NamesakeRank::Leftmost => first(&bearing, slack_of(SLACK_RAD)),
            NamesakeRank::Rightmost => first(&|other| -bearing(other), slack_of(SLACK_RAD)),
            NamesakeRank::Nearest => first(&range_m, slack_of(SLACK_M)),
            NamesakeRank::Farthest => first(&|other| -range_m(other), slack_of(SLACK_M)),
            NamesakeRank::Highest => first(&|other| -height_m(other), slack_of(SLACK_HEIGHT_M)),
            NamesakeRank::Lowest => first(&height_m, slack_of(SLACK_HEIGHT_M)),
            NamesakeRank::Middle => {
                let is_inner = at > 0 && at + 1 < in_order.len();
                if slack {
                    is_inner || in_order.len() < 3
                } else {
                    in_order.len() % 2 == 1 && in_order.len() > 1 && at == in_order.len() / 2
                }
            }
            NamesakeRank::FromLeft(number) => at == number || slack && at.abs_diff(number) <= 1,
            NamesakeRank::FromRight(number) => {
                at + number + 1 == in_order.len() || slack && (at + number + 1).abs_diff(in_order.len()) <= 1
            }
        }
    }

    /// The direction of an object from the end of the walk.
    pub(super) fn heading_to(&self, object: usize) -> Heading {
        Heading::towards(self.arrival.eye, self.scene.objects[object].position).unwrap_or(self.arrival.heading)
    }

    /// The direction of the middle of some objects.
    pub(super) fn middle_heading(&self, objects: &BTreeSet<usize>) -> Heading {
        let sum = objects
            .iter()
            .map(|object| self.heading_to(*object).unit_vector())
            .fold(DVec3::ZERO, |sum, unit| sum + unit);
        Heading::towards(DVec3::ZERO, sum).unwrap_or(self.arrival.heading)
    }
}

/// Whether a place lies at most `off_m` from the line between two spots, and between them.
pub(super) fn is_between(place: DVec3, a: DVec3, b: DVec3, off_m: f64) -> bool {
    let along = b - a;
    let share = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    (0.05..0.95).contains(&share) && along.length() <= 2.0 * FAR_M && (a + along * share).distance(place) <= off_m
}
