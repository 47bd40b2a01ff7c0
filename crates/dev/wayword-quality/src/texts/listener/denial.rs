//! Finds the part of a description that an object's geometry contradicts. A part is denied only if it is surely wrong: the bounds leave
//! slack for rough positions and for objects without a label.

use super::{
    fits::{ABOVE_M, AHEAD_RAD, BETWEEN_M, FAR_M, SLACK_M, SLACK_RAD, TargetListener, is_between},
    target_description::{ArrivalSide, TargetRelation},
    vocabulary::RelationKind,
};
use std::{collections::BTreeSet, f64::consts::PI};
use wayword_core::DVec3;

impl TargetListener<'_> {
    /// The first part of the description that an object's geometry contradicts, if any.
    pub(super) fn denied_part(&self, object: usize) -> Option<&'static str> {
        if !self.fits_level(object) {
            return Some("level");
        }
        let room = self.described_target.room.as_ref().map(|room| room.name.as_str()).filter(|name| !name.is_empty());
        if room.is_some_and(|name| !self.scene.may_lie_in(object, name)) {
            return Some("room");
        }
        let alike: BTreeSet<usize> = self.scene.objects_called(&self.described_target.name).chain([object]).collect();
        let first = self.described_target.relations.first().filter(|relation| !self.is_unknown(relation));
        if first.is_some_and(|relation| self.denies_relation(object, relation, &alike)) {
            return Some("relation");
        }
        let seen: BTreeSet<usize> = self
            .related_objects()
            .objects
            .into_iter()
            .chain([object])
            .filter(|other| self.is_in_view(*other))
            .collect();
        if !self.is_in_view(object) {
            return None;
        }
        if self.described_target.ranks.iter().any(|rank| !self.has_rank(object, *rank, &seen, true)) {
            return Some("rank");
        }
        let turn = |side: ArrivalSide| self.turn_to_object(object) * if side.is_left { -1.0 } else { 1.0 };
        self.described_target
            .side
            .filter(|side| side.is_yours && turn(*side) < -AHEAD_RAD && turn(*side) > AHEAD_RAD - PI)
            .map(|_| "side")
    }

    /// Whether the positions of the landmarks surely contradict a relation of an object. `namesakes`: the objects of its
    /// name.
    fn denies_relation(&self, object: usize, relation: &TargetRelation, namesakes: &BTreeSet<usize>) -> bool {
        let place = self.scene.objects[object].position;
        let spots = self.landmark_positions(&relation.to[0], Some(object));
        let far_m = if relation.to[0].is_room { 2.0 * FAR_M } else { FAR_M };
        let near = |spot: &&DVec3| spot.distance(place) <= far_m;
        let mut there = spots.iter().filter(near).peekable();
        if there.peek().is_none() {
            // Not every thing has a label. Only where the room lists one elsewhere, it is surely not here.
            let rooms = &self.scene.objects[object].rooms;
            return !relation.to[0].is_room && rooms.iter().any(|room| self.room_has(*room, &relation.to[0].name));
        }
        match relation.how {
            RelationKind::Closest => !there.any(|spot| self.is_nearest(object, *spot, namesakes, SLACK_M)),
            RelationKind::Farthest => !self.is_farthest(object, &spots, namesakes, SLACK_M),
            RelationKind::Above => !there.any(|spot| place.z > spot.z - ABOVE_M),
            RelationKind::Under => !there.any(|spot| place.z < spot.z + ABOVE_M),
            RelationKind::LeftOf => !there.any(|spot| self.turn_from(*spot, place) < SLACK_RAD),
            RelationKind::RightOf => !there.any(|spot| self.turn_from(*spot, place) > -SLACK_RAD),
            RelationKind::Between => {
                let others = relation.to.get(1).map(|to| self.landmark_positions(to, Some(object))).unwrap_or_default();
                !there.any(|a| others.iter().any(|b| is_between(place, *a, *b, 2.0 * BETWEEN_M)))
            }
            RelationKind::Near | RelationKind::On | RelationKind::Unknown => false,
        }
    }
}
