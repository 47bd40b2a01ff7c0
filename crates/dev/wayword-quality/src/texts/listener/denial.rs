//! Finds the part of a description that an object's geometry contradicts. A part is denied only if it is surely wrong: the bounds leave
//! slack for rough positions and for objects without a label.

use super::{
    fits::{ABOVE_M, AHEAD_RAD, BETWEEN_M, FAR_M, Listener, SLACK_M, SLACK_RAD, is_between},
    said::{How, Relation, Side},
};
use std::{collections::BTreeSet, f64::consts::PI};
use wayword_core::DVec3;

impl Listener<'_> {
    /// The first part of the description that an object's geometry contradicts, if any.
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
            self.placed().objects.into_iter().chain([object]).filter(|one| self.is_in_view(*one)).collect();
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
            // Not every thing has a label. Only where the room lists one elsewhere, it is surely not here.
            let rooms = &self.scene.objects[object].rooms;
            return !relation.to[0].is_room && rooms.iter().any(|room| self.has(*room, &relation.to[0].name));
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
