//! Carries out a plan: fills its places for things (offers) with the things that are there.

use super::{ClauseKind, MAIN_WEIGHT, OfferRole, WayClause, onward::passing_kind};
use crate::writer::{
    WritingBrief,
    dice::TextDice,
    landmarks::{ChosenLandmark, LandmarkChooser, LandmarkSpot},
    phrases::draw_option,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::WalkMemory;
use wayword_core::Side;

/// The clauses of a plan, with a thing in each place where there is one.
pub(in crate::writer) fn carry_out(
    plan: &[WayClause],
    brief: &WritingBrief<'_>,
    landmarks: &LandmarkChooser<'_>,
    dice: TextDice,
) -> Vec<WayClause> {
    let mut things = choose_things(plan, landmarks, brief.memory);
    let (mut clauses, mut passed) = (Vec::new(), 0);
    let mut follows_offer = false;
    for (at, clause) in plan.iter().enumerate() {
        let thing = things.remove(&at);
        let clause = WayClause { follows_offer, ..clause.clone() };
        follows_offer = clause.is_offer();
        match (clause.offer.as_ref().map(|offer| offer.role), thing) {
            (Some(role), Some(thing)) => clauses.extend(with_thing(clause, (role, thing), brief, dice, passed)),
            (Some(_), None) => {
                let goes_straight =
                    clauses.last().is_some_and(|before: &WayClause| before.kind == ClauseKind::Straight);
                let new = without_thing(clause).into_iter();
                clauses.extend(new.skip_while(|clause| goes_straight && clause.kind == ClauseKind::Straight));
            }
            (None, _) => clauses.push(clause),
        }
        passed += usize::from(follows_offer);
    }
    clauses
}

/// The thing of each place, by the number of its clause. An offer that replaces another one keeps its thing only if no
/// other offer of that hop got one.
fn choose_things(
    plan: &[WayClause],
    landmarks: &LandmarkChooser<'_>,
    memory: &WalkMemory,
) -> BTreeMap<usize, ChosenLandmark> {
    let offers = || plan.iter().enumerate().filter_map(|(at, clause)| Some((at, clause.offer.as_ref()?)));
    let spots: Vec<LandmarkSpot> =
        offers().map(|(at, offer)| offer.landmark_spot(told_until(&plan[..at], memory))).collect();
    let found = offers().zip(landmarks.landmarks_at(&spots)).filter_map(|((at, _), thing)| Some((at, thing?)));
    let mut things: BTreeMap<usize, ChosenLandmark> = found.collect();
    let mut served_hops: BTreeSet<usize> = plan
        .iter()
        .enumerate()
        .filter(|(at, clause)| is_original_offer(clause) && things.contains_key(at))
        .map(|(_, clause)| clause.at)
        .collect();
    for (at, offer) in offers() {
        if offer.stands_in_for.is_some_and(|hop| things.contains_key(&at) && !served_hops.insert(hop)) {
            things.remove(&at);
        }
    }
    things
}

/// The frame behind what these clauses tell, places for things left out.
pub(in crate::writer) fn told_until(before: &[WayClause], memory: &WalkMemory) -> usize {
    let last = before.iter().rfind(|clause| !clause.is_offer() && !clause.kind.goes_on());
    last.map_or(0, |clause| {
        let bend = memory.bends.iter().find(|bend| bend.first == clause.at && clause.side.is_some());
        bend.map_or(clause.at, |bend| bend.last) + 1
    })
}

/// Whether a clause exists for a thing and is no replacement of another.
fn is_original_offer(clause: &WayClause) -> bool {
    clause.is_offer() && clause.offer.as_ref().is_some_and(|offer| offer.stands_in_for.is_none())
}

/// The clauses of a place that got no thing.
fn without_thing(clause: WayClause) -> Vec<WayClause> {
    let is_straight = clause.offer.as_ref().is_some_and(|offer| offer.or_straight);
    let straight = is_straight.then(|| WayClause { kind: ClauseKind::Straight, ..bare_clause(&clause) });
    let own = (!clause.is_offer()).then_some(clause);
    straight.into_iter().chain(own).collect()
}

/// A clause of the same place without the parts that belong to its thing.
fn bare_clause(clause: &WayClause) -> WayClause {
    let (follows_offer, number) = (clause.follows_offer, clause.number);
    WayClause { follows_offer, number, ..WayClause::new(clause.kind, clause.at, clause.weight) }
}

/// The clauses of a place with its thing. `passed` is the number of earlier places of the text where something is
/// passed.
fn with_thing(
    clause: WayClause,
    (role, thing): (OfferRole, ChosenLandmark),
    brief: &WritingBrief<'_>,
    dice: TextDice,
    passed: usize,
) -> Vec<WayClause> {
    let mut rng = clause.clause_rng("with", dice);
    match role {
        OfferRole::Turn => {
            // "Go to the lamp. Turn left" where the thing is ahead, or else "turn left at the lamp".
            let ahead = if thing.side == Some(Side::Ahead) { 1.8 } else { 0.0 };
            // "Turn left at the lamp" is no slight turn.
            let is_slight = clause.kind == ClauseKind::TurnSlightly;
            if is_slight && ahead == 0.0 {
                return without_thing(clause);
            }
            if is_slight || draw_option(&[(3.0, false), (ahead, true)], &mut rng) == Some(true) {
                let to = WayClause { kind: ClauseKind::To, thing: Some(thing), ..bare_clause(&clause) };
                return vec![to, WayClause { follows_offer: true, ..clause }];
            }
            let turn =
                WayClause { kind: ClauseKind::TurnAt, side: clause.side, thing: Some(thing), ..bare_clause(&clause) };
            vec![turn]
        }
        OfferRole::PassEnter => vec![WayClause { kind: ClauseKind::PassEnter, thing: Some(thing), ..clause }],
        OfferRole::EnterWith => vec![WayClause { kind: ClauseKind::EnterWith, thing: Some(thing), ..clause }],
        OfferRole::Stop(kind) => vec![WayClause { kind, thing: Some(thing), ..clause }],
        OfferRole::Onward => {
            let hop = clause.at..=clause.at + 1;
            let side = thing.passed.filter(|(frame, _)| hop.contains(frame)).map(|(_, side)| side);
            let tells_side = clause.offer.as_ref().is_some_and(|offer| offer.tells_side);
            let kind = match side {
                Some(_) if tells_side => ClauseKind::PassOnSide,
                _ => passing_kind(&brief.profile.way, side, thing.side, dice.spread_share("past", passed)),
            };
            let side = side.filter(|_| kind == ClauseKind::PassOnSide);
            vec![WayClause { kind, side, thing: Some(thing), weight: MAIN_WEIGHT, ..bare_clause(&clause) }]
        }
    }
}
