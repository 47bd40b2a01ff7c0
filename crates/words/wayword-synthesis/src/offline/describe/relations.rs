//! Spatial relations between the target and things near it: near, above, left of, between.
//!
//! A relation has to hold clearly for the target, but it excludes a rival only if it clearly does not hold for the
//! rival.

use super::{
    listing::{ListingObject, ListingViewpoint},
    properties::{TargetContext, TargetProperty, is_unclear},
};
use wayword_core::{DVec3, ObjectDistinction, ObjectRelation};
use wayword_language::lexicon::{ThingClass, same_room};

/// Two things are near each other within this distance, metres.
const NEAR_M: f64 = 1.5;
/// Two things farther apart than this are certainly not near each other, metres.
const NOT_NEAR_M: f64 = 1.8;
/// The target has to be nearer than this share of the distance of every rival.
const CLEARLY_NEARER_SHARE: f64 = 0.7;
/// The target also has to be nearer than every rival by this, metres.
const CLEARLY_NEARER_M: f64 = 0.3;
/// Extra cost of a relation to a small thing, in words.
const SMALL_NEIGHBOUR_COST: f64 = 0.9;
/// Distances are compared after rounding to this many units per metre, a tenth of a millimetre each.
const ROUNDING_STEPS_PER_M: f64 = 10_000.0;
/// A thing near another one, beside it or between two is at most so much higher or lower, metres: what hangs above it is on no side.
const MAX_BESIDE_RISE_M: f64 = 0.9;
/// The centre of a thing that stands on another one is at least so much higher, metres.
const MIN_STANDING_RISE_M: f64 = 0.1;
/// The centre of a thing that stands on another one is at most so much higher, and so far aside, metres.
const CARRIED_RISE_M: f64 = 0.9;
/// See [`CARRIED_RISE_M`].
const CARRIED_ASIDE_M: f64 = 0.75;
/// Most neighbours of the target that are considered, the nearest first.
const MAX_NEIGHBOURS: usize = 8;
/// A walker who looks at the target sees a thing at most so far aside, degrees.
const MAX_APART_IN_VIEW_DEG: f64 = 60.0;

impl<'a> TargetContext<'a> {
    /// The things near the target that a walker at the end can see too, the nearest first.
    fn near_neighbours(&self) -> Vec<(usize, f64)> {
        let own = self.object_at(self.target);
        let seen = self.place.sights.iter().map(|sight| sight.object);
        let tells = |at: &usize| {
            let thing = self.object_at(*at);
            // Chairs stand all around a table, and move.
            let is_moved = own.class == ThingClass::Surface && thing.class == ThingClass::Seat;
            // What stands near a rug mostly stands on it.
            let is_rug = thing.class == ThingClass::Floor;
            *at != self.target
                && self.is_beside_in_view(*at)
                && !thing.is_like(own)
                && !is_unclear(thing)
                && !is_moved
                && !is_rug
                && !carries(own, thing)
                && !share_a_word(own, thing)
                && self.may_share_room(*at)
                && self.listing.is_pictured(*at)
        };
        let mut near: Vec<(usize, f64)> =
            seen.filter(tells).filter_map(|at| Some((at, centre_distance_m(own, self.object_at(at))?))).collect();
        near.retain(|(_, apart_m)| *apart_m <= NEAR_M);
        // At equal distance the order of ids decides, not rounding errors of the positions.
        near.sort_by_key(|(_, apart_m)| (apart_m * ROUNDING_STEPS_PER_M).round() as i64);
        near.truncate(MAX_NEIGHBOURS);
        near
    }

    /// Whether labels put a thing in no other room than the target: behind a wall there may be a desk.
    fn may_share_room(&self, at: usize) -> bool {
        let (own, other) = (self.object_at(self.target), self.object_at(at));
        own.room_name.as_deref().zip(other.room_name.as_deref()).is_none_or(|(own, other)| same_room(own, other))
    }

    /// Whether a walker at the end sees a thing and the target without turning away from one of them.
    fn is_beside_in_view(&self, at: usize) -> bool {
        let (to, own) = (self.sight_of_object(at), self.sight_of_object(self.target));
        self.has_panorama
            || to
                .zip(own)
                .is_none_or(|(to, own)| to.heading.turn_to(own.heading).to_degrees().abs() <= MAX_APART_IN_VIEW_DEG)
    }

    /// The relations of the target to its neighbours: one set for each name of a neighbour, and "between" for pairs.
    pub(super) fn relation_properties(&self) -> Vec<TargetProperty> {
        let neighbours = self.near_neighbours();
        let mut all: Vec<TargetProperty> = Vec::new();
        for (at, apart_m) in &neighbours {
            let name = &self.object_at(*at).name;
            if all
                .iter()
                .any(|property| matches!(&property.distinction, ObjectDistinction::Related { to, .. } if to == name))
            {
                continue;
            }
            all.extend(self.relations_to(*at, *apart_m));
        }
        for (index, (one, _)) in neighbours.iter().enumerate() {
            all.extend(neighbours[index + 1..].iter().filter_map(|(other, _)| self.between_property(*one, *other)));
        }
        all
    }

    /// The listed things of that name, or of a name that means the same.
    fn objects_like(&self, thing: &ListingObject) -> Vec<&'a ListingObject> {
        self.listing.objects.iter().filter(|other| other.is_like(thing)).collect()
    }

    /// The relations of the target to the object with this number, which is `apart_m` metres away.
    fn relations_to(&self, at: usize, apart_m: f64) -> Vec<TargetProperty> {
        let (own, to) = (self.object_at(self.target), self.object_at(at));
        let alike = self.objects_like(to);
        let nearest = |rival: usize| {
            let from = self.object_at(rival);
            let all = alike.iter().map(|other| centre_distance_m(from, other).unwrap_or(0.0));
            all.fold(f64::INFINITY, f64::min)
        };
        let related = |relation| ObjectDistinction::Related { relation, to: to.name.clone() };
        let mut all: Vec<TargetProperty> = Vec::new();
        let stands_on_it = relation_holds(ObjectRelation::On, own, to, RelationStrictness::Yes);
        let is_carried = stands_on_it || carries(to, own);
        let is_stacked = is_carried || may_stand_on_rug(to, own);
        // A chandelier is not "next to" the vase on the table below it, nor a lamp "near" the desk on which it stands.
        let is_beside = height_between_m(own, to).is_none_or(|rise_m| rise_m <= MAX_BESIDE_RISE_M) && !is_stacked;
        if is_beside {
            all.push(self.new_property(related(ObjectRelation::Near), 1.6, |rival| nearest(rival) <= NOT_NEAR_M));
        }
        // "Closest to" says that there are several.
        if is_beside && self.has_rival_near() {
            all.extend(self.closest_property(at, apart_m, &alike));
        }
        for relation in [ObjectRelation::Above, ObjectRelation::Under, ObjectRelation::On] {
            let is_on = relation == ObjectRelation::On;
            if relation_holds(relation, own, to, RelationStrictness::Yes) && (is_on || !is_carried) {
                let may_be = |rival: usize| {
                    alike
                        .iter()
                        .any(|other| relation_holds(relation, self.object_at(rival), other, RelationStrictness::No))
                };
                all.push(self.new_property(related(relation), 1.4, may_be));
            }
        }
        if !is_stacked && to.class != ThingClass::Bed {
            all.extend(self.beside_property(at, &alike));
        }
        // A small thing such as a plate is hard to find itself.
        if to.salience < 2 {
            all.iter_mut().for_each(|property| property.cost += SMALL_NEIGHBOUR_COST);
        }
        all
    }

    /// "Closest to" the object with this number: no rival is nearer to it, wherever the rival is. `alike` are the things of its name.
    fn closest_property(&self, at: usize, apart_m: f64, alike: &[&ListingObject]) -> Option<TargetProperty> {
        let (own, to) = (self.object_at(self.target), self.object_at(at));
        let around = alike.iter().filter(|other| centre_distance_m(own, other).is_none_or(|m| m <= 2.0 * NOT_NEAR_M));
        let is_nearest = self
            .rivals
            .iter()
            .all(|rival| centre_distance_m(self.object_at(*rival), to).is_none_or(|m| m > 1.05 * apart_m));
        if around.count() != 1 || !is_nearest {
            return None;
        }
        let may_be = |rival: usize| {
            let other_m = centre_distance_m(self.object_at(rival), to).unwrap_or(0.0);
            let is_elsewhere = other_m > (apart_m / CLEARLY_NEARER_SHARE).max(apart_m + CLEARLY_NEARER_M);
            let own_one = alike.iter().filter(|other| other.position != to.position);
            let has_own =
                own_one.filter_map(|other| centre_distance_m(self.object_at(rival), other)).any(|m| m <= NOT_NEAR_M);
            !is_elsewhere || has_own
        };
        Some(self.new_property(ObjectDistinction::NextTo { neighbour: to.name.clone() }, 1.5, may_be))
    }

    /// Whether no other thing of its kind is near the target: "left of the curtain" where two curtains hang?
    fn is_only_one_near(&self, thing: &ListingObject) -> bool {
        let own = self.object_at(self.target);
        let is_near = |other: &&&ListingObject| centre_distance_m(own, other).is_none_or(|m| m <= 2.0 * NOT_NEAR_M);
        self.objects_like(thing).iter().filter(is_near).count() == 1
    }

    /// Left or right of a thing, as seen from the end.
    fn beside_property(&self, at: usize, alike: &[&ListingObject]) -> Option<TargetProperty> {
        let (own, to) = (self.object_at(self.target), self.object_at(at));
        let rise_m = height_between_m(own, to).filter(|_| self.is_only_one_near(to))?;
        let off_rad = self.sight_of_object(at)?.heading.turn_to(self.sight_of_object(self.target)?.heading);
        let off_deg = off_rad.to_degrees();
        // What lies in front of a thing, or behind it, is on no side of it.
        let (own_m, to_m) = (self.distance_m(self.target)?, self.distance_m(at)?);
        let aside_m = own_m * libm::sin(off_rad.abs());
        let deeper_m = (own_m * libm::cos(off_rad) - to_m).abs();
        if rise_m > MAX_BESIDE_RISE_M || !(8.0..70.0).contains(&off_deg.abs()) || aside_m < deeper_m {
            return None;
        }
        // Whoever enters the room on another side has to see the same.
        let is_opposite = |place: &ListingViewpoint| {
            let towards = |object: usize| place.sights.iter().find(|sight| sight.object == object);
            let turn_rad = towards(at).zip(towards(self.target)).map(|(to, own)| to.heading.turn_to(own.heading));
            turn_rad.is_some_and(|turn_rad| turn_rad * off_rad.signum() < 0.0)
        };
        if self.listing.places.iter().any(is_opposite) {
            return None;
        }
        let relation = if off_deg > 0.0 { ObjectRelation::RightOf } else { ObjectRelation::LeftOf };
        let may_be = |rival: usize| {
            let near = alike
                .iter()
                .filter(|other| centre_distance_m(self.object_at(rival), other).is_none_or(|m| m <= NOT_NEAR_M));
            let seen = self.sight_of_object(rival);
            near.into_iter().any(|other| {
                let other_sight =
                    self.place.sights.iter().find(|sight| self.object_at(sight.object).position == other.position);
                match (seen, other_sight) {
                    (Some(seen), Some(to)) => to.heading.turn_to(seen.heading) * off_rad.signum() > -0.05,
                    _ => true,
                }
            })
        };
        let told = ObjectDistinction::Related { relation, to: to.name.clone() };
        Some(self.new_property(told, 1.9, may_be))
    }

    /// "Between the bed and the window": the directions to both differ by 140 degrees or more for the target; a rival
    /// is excluded below 100.
    fn between_property(&self, one: usize, other: usize) -> Option<TargetProperty> {
        let (one, other) = (self.object_at(one), self.object_at(other));
        let lies_between = |object: &ListingObject, degrees: f64| {
            let all_one = self.objects_like(one);
            let all_other = self.objects_like(other);
            all_one.iter().any(|a| all_other.iter().any(|b| is_between(object, a, b, degrees).unwrap_or(true)))
        };
        let own = self.object_at(self.target);
        let is_level = |thing| height_between_m(own, thing).is_some_and(|rise_m| rise_m <= MAX_BESIDE_RISE_M);
        if [one, other].iter().any(|thing| may_stand_on_rug(thing, own) || !self.is_only_one_near(thing)) {
            return None;
        }
        if one.is_like(other) || !is_between(own, one, other, 140.0)? || !is_level(one) || !is_level(other) {
            return None;
        }
        let told = ObjectDistinction::Between { one: one.name.clone(), other: other.name.clone() };
        Some(self.new_property(told, 3.0, |rival| lies_between(self.object_at(rival), 100.0)))
    }
}

/// Whether the names of two things share a word, so that one says nothing of the other: a tv near a tv stand.
fn share_a_word(one: &ListingObject, other: &ListingObject) -> bool {
    one.kind().split(' ').any(|word| other.kind().split(' ').any(|other| other == word))
}

/// Whether something is a rug on which a thing near it may stand.
fn may_stand_on_rug(thing: &ListingObject, rug: &ListingObject) -> bool {
    use ThingClass::{Container, Drape, Glass, WallArt};
    rug.class == ThingClass::Floor && !matches!(thing.class, WallArt | Glass | Drape | Container)
}

/// Whether a thing stands on another one, so that this is not "next to" it.
fn carries(furniture: &ListingObject, thing: &ListingObject) -> bool {
    let (Some(below), Some(above)) = (furniture.position, thing.position) else { return false };
    let is_furniture =
        matches!(furniture.class, ThingClass::Bed | ThingClass::Surface | ThingClass::Seat | ThingClass::Container);
    let hangs = matches!(thing.class, ThingClass::WallArt | ThingClass::Glass | ThingClass::Drape);
    is_furniture
        && !hangs
        && (MIN_STANDING_RISE_M..CARRIED_RISE_M).contains(&(above.z - below.z))
        && (above - below).truncate().length() <= CARRIED_ASIDE_M
}

/// Metres between two centres; `None` where a position is not known.
fn centre_distance_m(a: &ListingObject, b: &ListingObject) -> Option<f64> {
    Some(a.position?.distance(b.position?))
}

/// How much higher one of two centres is than the other, metres; `None` where a position is not known.
fn height_between_m(a: &ListingObject, b: &ListingObject) -> Option<f64> {
    Some((a.position?.z - b.position?.z).abs())
}

/// Whether a relation has to hold clearly (for the target) or may just hold (for a rival).
#[derive(Clone, Copy, PartialEq, Eq)]
enum RelationStrictness {
    /// The relation has to hold clearly.
    Yes,
    /// The relation may just hold; it also holds where a position is not known.
    No,
}

/// Whether `a` is above, under or on `b`, by how much higher its centre is (`rise`) and how far off to the side
/// (`aside`), both in metres. Other relations never hold here.
fn relation_holds(relation: ObjectRelation, a: &ListingObject, b: &ListingObject, strict: RelationStrictness) -> bool {
    let (Some(from), Some(to)) = (a.position, b.position) else { return strict == RelationStrictness::No };
    let rise = from.z - to.z;
    let aside = DVec3::new(from.x - to.x, from.y - to.y, 0.0).length();
    let is_strict = strict == RelationStrictness::Yes;
    let wide = if matches!(b.class, ThingClass::Bed | ThingClass::Tub | ThingClass::Surface | ThingClass::Seat) {
        0.25
    } else {
        0.0
    };
    match relation {
        ObjectRelation::Above if is_strict => (0.25..1.5).contains(&rise) && aside <= 0.45 + wide,
        ObjectRelation::Above => (0.0..2.0).contains(&rise) && aside <= 1.2,
        ObjectRelation::Under if is_strict => (0.25..1.5).contains(&-rise) && aside <= 0.45 + wide,
        ObjectRelation::Under => (0.0..2.0).contains(&-rise) && aside <= 1.2,
        ObjectRelation::On => {
            let is_small =
                matches!(a.class, ThingClass::Textile | ThingClass::Small | ThingClass::Ornament | ThingClass::Plant);
            // Lamps and screens stand on tables; beside a bed or a seat, they stand on the table there.
            let stands = (a.class == ThingClass::Screen || a.kind() == "lamp")
                && matches!(b.class, ThingClass::Surface | ThingClass::Container)
                && (!is_strict || rise >= MIN_STANDING_RISE_M);
            let is_carrier = matches!(b.class, ThingClass::Bed | ThingClass::Surface | ThingClass::Seat);
            let is_there = if is_strict {
                (-0.05..0.6).contains(&rise) && aside <= 0.5 + wide
            } else {
                rise.abs() < 1.2 && aside <= 1.5
            };
            (is_small && is_carrier || stands) && is_there
        }
        _ => false,
    }
}

/// Whether a thing lies between two others, seen from above: the directions to them differ by at least `degrees`.
fn is_between(thing: &ListingObject, one: &ListingObject, other: &ListingObject, degrees: f64) -> Option<bool> {
    let (here, one, other) = (thing.position?, one.position?, other.position?);
    let limit_m = if degrees > 120.0 { NEAR_M } else { NOT_NEAR_M };
    let flat = |to: DVec3| DVec3::new(to.x - here.x, to.y - here.y, 0.0);
    let (one, other) = (flat(one), flat(other));
    let is_near = |way: DVec3| (0.1..=limit_m).contains(&way.length());
    Some(is_near(one) && is_near(other) && one.normalize().dot(other.normalize()) <= libm::cos(degrees.to_radians()))
}
