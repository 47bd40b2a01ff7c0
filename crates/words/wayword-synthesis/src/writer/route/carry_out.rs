//! Carries out a plan: fills its places with the things that are there.

use super::{Clause, Kind, MAIN, Role, onward::past};
use crate::writer::{
    Brief,
    dice::Dice,
    landmarks::{Landmark, Landmarks, Spot},
    phrases::draw,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::Side;

/// The clauses of a plan, with a thing in each place where there is one.
pub(in crate::writer) fn carry_out(
    plan: &[Clause],
    brief: &Brief<'_>,
    landmarks: &Landmarks<'_>,
    dice: Dice,
) -> Vec<Clause> {
    let mut things = things_of(plan, landmarks);
    let (mut told, mut passed) = (Vec::new(), 0);
    let mut follows_offer = false;
    for (at, clause) in plan.iter().enumerate() {
        let thing = things.remove(&at);
        let clause = Clause { follows_offer, ..clause.clone() };
        follows_offer = clause.is_offer();
        match (clause.offer.as_ref().map(|offer| offer.role), thing) {
            (Some(role), Some(thing)) => told.extend(with_thing(clause, (role, thing), brief, dice, passed)),
            (Some(_), None) => {
                let goes_straight = told.last().is_some_and(|before: &Clause| before.kind == Kind::Straight);
                let new = without_thing(clause).into_iter();
                told.extend(new.skip_while(|clause| goes_straight && clause.kind == Kind::Straight));
            }
            (None, _) => told.push(clause),
        }
        passed += usize::from(follows_offer);
    }
    told
}

/// The thing of each place, by the number of its clause.
fn things_of(plan: &[Clause], landmarks: &Landmarks<'_>) -> BTreeMap<usize, Landmark> {
    let offers = || plan.iter().enumerate().filter_map(|(at, clause)| Some((at, clause.offer.as_ref()?)));
    let spots: Vec<Spot> = offers().map(|(_, offer)| offer.spot()).collect();
    let found = offers().zip(landmarks.at(&spots)).filter_map(|((at, _), thing)| Some((at, thing?)));
    let mut things: BTreeMap<usize, Landmark> = found.collect();
    let mut told: BTreeSet<usize> = plan
        .iter()
        .enumerate()
        .filter(|(at, clause)| is_own(clause) && things.contains_key(at))
        .map(|(_, clause)| clause.at)
        .collect();
    for (at, offer) in offers() {
        if offer.stands_in_for.is_some_and(|hop| things.contains_key(&at) && !told.insert(hop)) {
            things.remove(&at);
        }
    }
    things
}

/// Whether a clause exists for a thing and is no replacement of another.
fn is_own(clause: &Clause) -> bool {
    clause.is_offer() && clause.offer.as_ref().is_some_and(|offer| offer.stands_in_for.is_none())
}

/// The clauses of a place that got no thing.
fn without_thing(clause: Clause) -> Vec<Clause> {
    let is_straight = clause.offer.as_ref().is_some_and(|offer| offer.or_straight);
    let straight = is_straight.then(|| Clause { kind: Kind::Straight, ..bare(&clause) });
    let own = (!clause.is_offer()).then_some(clause);
    straight.into_iter().chain(own).collect()
}

/// A clause of the same place without the parts that belong to its thing.
fn bare(clause: &Clause) -> Clause {
    let (follows_offer, number) = (clause.follows_offer, clause.number);
    Clause { follows_offer, number, ..Clause::new(clause.kind, clause.at, clause.weight) }
}

/// The clauses of a place with its thing. `passed` is the number of earlier places of the text where something is
/// passed.
fn with_thing(
    clause: Clause,
    (role, thing): (Role, Landmark),
    brief: &Brief<'_>,
    dice: Dice,
    passed: usize,
) -> Vec<Clause> {
    let mut rng = clause.drawn("with", dice);
    match role {
        Role::Turn => {
            let ahead = if thing.side == Some(Side::Ahead) { 1.8 } else { 0.0 };
            if draw(&[(3.0, false), (ahead, true)], &mut rng) == Some(true) {
                let to = Clause { kind: Kind::To, thing: Some(thing), ..bare(&clause) };
                return vec![to, Clause { follows_offer: true, ..clause }];
            }
            let turn = Clause { kind: Kind::TurnAt, side: clause.side, thing: Some(thing), ..bare(&clause) };
            vec![turn]
        }
        Role::PassEnter => vec![Clause { kind: Kind::PassEnter, thing: Some(thing), ..clause }],
        Role::EnterWith => vec![Clause { kind: Kind::EnterWith, thing: Some(thing), ..clause }],
        Role::Stop(kind) => vec![Clause { kind, thing: Some(thing), ..clause }],
        Role::Onward => {
            let hop = clause.at..=clause.at + 1;
            let side = thing.passed.filter(|(frame, _)| hop.contains(frame)).map(|(_, side)| side);
            let tells_side = clause.offer.as_ref().is_some_and(|offer| offer.tells_side);
            let kind = match side {
                Some(_) if tells_side => Kind::PassOnSide,
                _ => past(&brief.profile.way, side, thing.side, dice.in_turn("past", passed)),
            };
            let side = side.filter(|_| kind == Kind::PassOnSide);
            vec![Clause { kind, side, thing: Some(thing), weight: MAIN, ..bare(&clause) }]
        }
    }
}
