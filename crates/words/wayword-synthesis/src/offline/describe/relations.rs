//! Spatial relations between the target and things near it: near, above, left of, between.
//!
//! A relation has to hold clearly for the target, but it excludes a rival only if it clearly does not hold for the
//! rival.

use super::{
    listing::Object,
    properties::{Property, Scene, is_unclear},
};
use wayword_core::{DVec3, Distinction, Relation};
use wayword_language::lexicon::Class;

/// Two things are near each other within this distance, metres.
const NEAR_M: f64 = 1.5;
/// Two things farther apart than this are certainly not near each other, metres.
const NOT_NEAR_M: f64 = 1.8;
/// The target has to be nearer than this share of the distance of every rival.
const CLEARLY: f64 = 0.7;
/// The target also has to be nearer by this, metres.
const CLEARLY_M: f64 = 0.3;
/// Extra cost of a relation to a small thing.
const SMALL: f64 = 0.9;
/// Distances are compared after rounding to this many units per metre, a tenth of a millimetre each.
const PER_M: f64 = 10_000.0;
/// Most neighbours of the target that are considered, the nearest first.
const MOST_NEIGHBOURS: usize = 8;

impl<'a> Scene<'a> {
    /// The things near the target that a walker at the end can see too, the nearest first.
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
        // At equal distance the order of ids decides, not rounding errors of the positions.
        near.sort_by_key(|(_, apart_m)| (apart_m * PER_M).round() as i64);
        near.truncate(MOST_NEIGHBOURS);
        near
    }

    pub(super) fn relations(&self) -> Vec<Property> {
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
        // No rival may be nearer to it, wherever the rival is.
        let is_nearest =
            self.rivals.iter().all(|rival| apart(self.object(*rival), to).is_none_or(|m| m > 1.05 * apart_m));
        if is_alone && is_nearest {
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
        // A small thing such as a plate is hard to find itself.
        if to.salience < 2 {
            all.iter_mut().for_each(|property| property.cost += SMALL);
        }
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

/// Metres between two centres.
fn apart(a: &Object, b: &Object) -> Option<f64> {
    Some(a.position?.distance(b.position?))
}

/// Whether a relation has to hold clearly (for the target) or may just hold (for a rival).
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

/// Whether a thing lies between two others, seen from above: the directions to them differ by at least `degrees`.
fn is_between(thing: &Object, one: &Object, other: &Object, degrees: f64) -> Option<bool> {
    let (here, one, other) = (thing.position?, one.position?, other.position?);
    let limit_m = if degrees > 120.0 { NEAR_M } else { NOT_NEAR_M };
    let flat = |to: DVec3| DVec3::new(to.x - here.x, to.y - here.y, 0.0);
    let (one, other) = (flat(one), flat(other));
    let is_near = |way: DVec3| (0.1..=limit_m).contains(&way.length());
    Some(is_near(one) && is_near(other) && one.normalize().dot(other.normalize()) <= libm::cos(degrees.to_radians()))
}
