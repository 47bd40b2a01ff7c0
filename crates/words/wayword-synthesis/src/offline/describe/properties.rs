//! What is true of an object, and which of its rivals it is true of too. Where that is not clear, a rival counts as
//! fitting, so that a description never leaves fewer objects than it should.

use super::listing::{Listing, Object, Place, Sight};
use std::collections::BTreeSet;
use wayword_core::{DVec3, Distinction, Frame, Heading, Relation, Side};
use wayword_language::lexicon::{Class, room_name, same_room};

/// Something that is true of the target.
#[derive(Debug, Clone)]
pub(super) struct Property {
    pub(super) told: Distinction,
    /// For each rival, whether it fits too.
    pub(super) fits: Vec<bool>,
    /// How much it costs to say, about its words.
    pub(super) cost: f64,
}

/// A target, and all that may be called by its name.
pub(super) struct Scene<'a> {
    pub(super) listing: &'a Listing,
    pub(super) place: &'a Place,
    pub(super) heading: Heading,
    pub(super) target: usize,
    pub(super) rivals: Vec<usize>,
}

/// Two things are near each other within this distance, metres.
const NEAR_M: f64 = 1.5;
/// Farther apart than this they are certainly not, metres.
const NOT_NEAR_M: f64 = 1.8;
/// The target has to be nearer than this share of the distance of every rival.
const CLEARLY: f64 = 0.7;
/// And nearer by this, metres.
const CLEARLY_M: f64 = 0.3;
/// Most neighbours of the target that are looked at, the nearest first.
const MOST_NEIGHBOURS: usize = 8;

impl<'a> Scene<'a> {
    pub(super) fn new(listing: &'a Listing, last: &Frame, place: &'a Place, target: usize) -> Self {
        let own = &listing.objects[target];
        let is_rival = |at: &usize| *at != target && listing.objects[*at].is_like(own);
        let rivals = (0..listing.objects.len()).filter(is_rival).collect();
        Self { listing, place, heading: last.pose.heading, target, rivals }
    }

    pub(super) fn object(&self, at: usize) -> &'a Object {
        &self.listing.objects[at]
    }

    pub(super) fn sight(&self, object: usize) -> Option<&'a Sight> {
        self.place.sights.iter().find(|sight| sight.object == object)
    }

    /// The direction of an object from the heading of arrival, radians, positive right, where it is seen at the end.
    pub(super) fn turn_rad(&self, object: usize) -> Option<f64> {
        Some(self.heading.turn_to(self.sight(object)?.heading))
    }

    pub(super) fn distance_m(&self, object: usize) -> Option<f64> {
        let sight = self.sight(object)?;
        sight.distance_m.or_else(|| Some(self.object(object).position?.distance(self.place.eye)))
    }

    /// Whether the target is in the room where the path ends.
    pub(super) fn is_in_end_room(&self) -> bool {
        self.object(self.target).rooms.contains(&self.place.room)
    }

    /// The rivals that are in a room of the same kind; all of them, where the target's room is not the one at the end.
    pub(super) fn rivals_in_kind(&self) -> Vec<bool> {
        let own = self.listing.rooms[self.place.room].name.as_deref().filter(|_| self.is_in_end_room());
        let is_kind = |room: &usize| match (own, self.listing.rooms[*room].name.as_deref()) {
            (Some(own), Some(other)) => same_room(own, other),
            _ => true,
        };
        self.rivals.iter().map(|rival| self.object(*rival).rooms.iter().any(is_kind)).collect()
    }

    fn property(&self, told: Distinction, cost: f64, fits: impl Fn(usize) -> bool) -> Property {
        Property { told, cost, fits: self.rivals.iter().map(|rival| fits(*rival)).collect() }
    }

    /// All properties of the target that do not depend on what else is said.
    pub(super) fn properties(&self) -> Vec<Property> {
        let mut all = self.of_room();
        let own = self.object(self.target);
        if let Some(colour) = &own.colour {
            let told = Distinction::Colour { colour: colour.clone() };
            all.push(self.property(told, 0.8, |rival| {
                self.object(rival)
                    .colour
                    .as_ref()
                    .is_none_or(|other| other.contains(&**colour) || colour.contains(&**other))
            }));
        }
        all.extend(self.side());
        all.extend(self.relations());
        all
    }

    fn of_room(&self) -> Vec<Property> {
        let (listing, own) = (self.listing, self.object(self.target));
        let mut all = Vec::new();
        if !self.is_in_end_room() {
            return all;
        }
        if let Some(level) = own.level.filter(|_| listing.storeys > 1) {
            let told = Distinction::Level { level };
            all.push(self.property(told, 1.0, |rival| self.object(rival).level.is_none_or(|other| other == level)));
        }
        let room = &listing.rooms[self.place.room];
        let Some(name) = room.name.as_deref() else { return all };
        let others: BTreeSet<&String> = room.beside.iter().filter(|other| !same_room(other, name)).collect();
        for other in others.into_iter().filter(|other| room_name(other).is_some()) {
            let is_beside = |at: &usize| listing.rooms[*at].beside.iter().any(|beside| same_room(beside, other));
            let told = Distinction::RoomBy { room: other.clone() };
            all.push(self.property(told, 2.0, |rival| self.object(rival).rooms.iter().any(is_beside)));
        }
        let mut told: Vec<&str> = Vec::new();
        for thing in room.things.iter().map(|at| self.object(*at)) {
            let is_told = |name: &&str| **name == *thing.name;
            if thing.salience < 2
                || thing.class == Class::Stairs
                || thing.is_like(own)
                || told.iter().any(is_told)
                || is_unclear(thing)
            {
                continue;
            }
            told.push(&thing.name);
            let has = |at: &usize| listing.rooms[*at].things.iter().any(|other| self.object(*other).is_like(thing));
            let with = Distinction::RoomWith { thing: thing.name.clone() };
            all.push(self.property(with, 2.2, |rival| self.object(rival).rooms.iter().any(has)));
        }
        all
    }

    fn side(&self) -> Option<Property> {
        let deg = |object: usize| self.turn_rad(object).map(f64::to_degrees);
        let (side, sign) = match deg(self.target)? {
            deg if (25.0..155.0).contains(&deg) => (Side::Right, 1.0),
            deg if (25.0..155.0).contains(&-deg) => (Side::Left, -1.0),
            _ => return None,
        };
        // Who says "on the left" means what one sees on arrival.
        let may_be = |rival: usize| deg(rival).is_some_and(|deg| (5.0..175.0).contains(&(deg * sign)));
        Some(self.property(Distinction::OnSide { side }, 2.4, may_be))
    }

    /// The things beside the target that a walker at the end sees too, the nearest first.
    fn neighbours(&self) -> Vec<(usize, f64)> {
        let own = self.object(self.target);
        let seen = self.place.sights.iter().map(|sight| sight.object);
        let tells = |at: &usize| {
            let thing = self.object(*at);
            *at != self.target && !thing.is_like(own) && !is_unclear(thing)
        };
        let mut near: Vec<(usize, f64)> =
            seen.filter(tells).filter_map(|at| Some((at, apart(own, self.object(at))?))).collect();
        near.retain(|(_, apart_m)| *apart_m <= NEAR_M);
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        near.truncate(MOST_NEIGHBOURS);
        near
    }

    fn relations(&self) -> Vec<Property> {
        let neighbours = self.neighbours();
        let mut all: Vec<Property> = Vec::new();
        for (at, apart_m) in &neighbours {
            let name = &self.object(*at).name;
            if all.iter().any(|property| matches!(&property.told, Distinction::Related { to, .. } if to == name)) {
                continue;
            }
            all.extend(self.relations_to(*at, *apart_m));
        }
        for (index, (one, _)) in neighbours.iter().enumerate() {
            all.extend(neighbours[index + 1..].iter().filter_map(|(other, _)| self.between(*one, *other)));
        }
        all
    }

    /// The listed things of that name, or of a name that means the same.
    fn alike(&self, thing: &Object) -> Vec<&'a Object> {
        self.listing.objects.iter().filter(|other| other.is_like(thing)).collect()
    }

    fn relations_to(&self, at: usize, apart_m: f64) -> Vec<Property> {
        let (own, to) = (self.object(self.target), self.object(at));
        let alike = self.alike(to);
        let nearest = |rival: usize| {
            let from = self.object(rival);
            let all = alike.iter().map(|other| apart(from, other).unwrap_or(0.0));
            all.fold(f64::INFINITY, f64::min)
        };
        let related = |relation| Distinction::Related { relation, to: to.name.clone() };
        let mut all = vec![self.property(related(Relation::Near), 1.6, |rival| nearest(rival) <= NOT_NEAR_M)];
        let is_alone =
            alike.iter().filter(|other| apart(own, other).is_none_or(|m| m <= 2.0 * NOT_NEAR_M)).count() == 1;
        if is_alone {
            let told = Distinction::NextTo { neighbour: to.name.clone() };
            let may_be = |rival: usize| {
                let other_m = apart(self.object(rival), to).unwrap_or(0.0);
                let is_elsewhere = other_m > (apart_m / CLEARLY).max(apart_m + CLEARLY_M);
                let own_one = alike.iter().filter(|other| other.position != to.position);
                let has_own = own_one.filter_map(|other| apart(self.object(rival), other)).any(|m| m <= NOT_NEAR_M);
                !is_elsewhere || has_own
            };
            all.push(self.property(told, 1.5, may_be));
        }
        for relation in [Relation::Above, Relation::Under, Relation::On] {
            if holds(relation, own, to, Strict::Yes) {
                let may_be =
                    |rival: usize| alike.iter().any(|other| holds(relation, self.object(rival), other, Strict::No));
                all.push(self.property(related(relation), 1.4, may_be));
            }
        }
        all.extend(self.beside(at, &alike));
        all
    }

    /// Left or right of a thing, as seen from the end.
    fn beside(&self, at: usize, alike: &[&Object]) -> Option<Property> {
        let (own, to) = (self.object(self.target), self.object(at));
        let level_m = (own.position?.z - to.position?.z).abs();
        let off_rad = self.sight(at)?.heading.turn_to(self.sight(self.target)?.heading);
        let off_deg = off_rad.to_degrees();
        if level_m > 0.9 || !(8.0..70.0).contains(&off_deg.abs()) {
            return None;
        }
        let relation = if off_deg > 0.0 { Relation::RightOf } else { Relation::LeftOf };
        let may_be = |rival: usize| {
            let near = alike.iter().filter(|other| apart(self.object(rival), other).is_none_or(|m| m <= NOT_NEAR_M));
            let seen = self.sight(rival);
            near.into_iter().any(|other| {
                let other_sight =
                    self.place.sights.iter().find(|sight| self.object(sight.object).position == other.position);
                match (seen, other_sight) {
                    (Some(seen), Some(to)) => to.heading.turn_to(seen.heading) * off_rad.signum() > -0.05,
                    _ => true,
                }
            })
        };
        let told = Distinction::Related { relation, to: to.name.clone() };
        Some(self.property(told, 1.9, may_be))
    }

    fn between(&self, one: usize, other: usize) -> Option<Property> {
        let (one, other) = (self.object(one), self.object(other));
        let stands = |object: &Object, degrees: f64| {
            let all_one = self.alike(one);
            let all_other = self.alike(other);
            all_one.iter().any(|a| all_other.iter().any(|b| is_between(object, a, b, degrees).unwrap_or(true)))
        };
        let own = self.object(self.target);
        if one.is_like(other) || !is_between(own, one, other, 140.0)? {
            return None;
        }
        let told = Distinction::Between { one: one.name.clone(), other: other.name.clone() };
        Some(self.property(told, 3.0, |rival| stands(self.object(rival), 100.0)))
    }
}

/// Whether nobody could find an object by this thing: parts of the building, and names that the lexicon does not have.
fn is_unclear(thing: &Object) -> bool {
    matches!(thing.class, Class::Fabric | Class::Unknown | Class::Structure)
        && !matches!(thing.kind(), "window" | "fireplace" | "column" | "railing")
}

/// Metres between two centres.
fn apart(a: &Object, b: &Object) -> Option<f64> {
    Some(a.position?.distance(b.position?))
}

/// Whether a relation has to hold clearly, or may just hold.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Strict {
    Yes,
    No,
}

fn holds(relation: Relation, a: &Object, b: &Object, strict: Strict) -> bool {
    let (Some(from), Some(to)) = (a.position, b.position) else { return strict == Strict::No };
    let rise = from.z - to.z;
    let aside = DVec3::new(from.x - to.x, from.y - to.y, 0.0).length();
    let is_strict = strict == Strict::Yes;
    let wide = if matches!(b.class, Class::Bed | Class::Tub | Class::Surface | Class::Seat) { 0.25 } else { 0.0 };
    match relation {
        Relation::Above if is_strict => (0.25..1.5).contains(&rise) && aside <= 0.45 + wide,
        Relation::Above => (0.0..2.0).contains(&rise) && aside <= 1.2,
        Relation::Under if is_strict => (0.25..1.5).contains(&-rise) && aside <= 0.45 + wide,
        Relation::Under => (0.0..2.0).contains(&-rise) && aside <= 1.2,
        Relation::On => {
            let carried = matches!(a.class, Class::Textile | Class::Small | Class::Ornament | Class::Plant);
            let carries = matches!(b.class, Class::Bed | Class::Surface | Class::Seat);
            let is_there = if is_strict {
                (-0.05..0.6).contains(&rise) && aside <= 0.5 + wide
            } else {
                rise.abs() < 1.2 && aside <= 1.5
            };
            carried && carries && is_there
        }
        _ => false,
    }
}

/// Whether a thing stands between two others, seen from above, at an angle of at least that many degrees.
fn is_between(thing: &Object, one: &Object, other: &Object, degrees: f64) -> Option<bool> {
    let (here, one, other) = (thing.position?, one.position?, other.position?);
    let limit_m = if degrees > 120.0 { NEAR_M } else { NOT_NEAR_M };
    let flat = |to: DVec3| DVec3::new(to.x - here.x, to.y - here.y, 0.0);
    let (one, other) = (flat(one), flat(other));
    let is_near = |way: DVec3| (0.1..=limit_m).contains(&way.length());
    Some(is_near(one) && is_near(other) && one.normalize().dot(other.normalize()) <= libm::cos(degrees.to_radians()))
}
